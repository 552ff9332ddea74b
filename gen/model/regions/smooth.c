/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How smooth the equations are. A function or condition that divides its argument's range decides on the sign of a
 * form; where that form is 0 lies a surface. The equations are written down as they are on either side of it,
 * everything else left open; how fast the difference of the two vanishes towards the surface, as distance^p, says
 * what they have there: a jump for p = 0, a kink for p = 1, more than that beyond, as x*abs(x) at 0 with p = 2. A
 * scheme is then of order p + 1 at most: a step across the surface errs by h^{p+1}, and crossings do not become more
 * as h shrinks. The difference is written symbolically and measured at points of the surface, in 320 bits. */
#include "model/building.h"
#include "model/reads.h"
#include "inner.h"

#include <string.h>

enum {
	PRECISION = 320, POINTS = 48, SCALES = 12,
	NEAR = 32,                  /* the difference is measured 2^-32 and 2^-64 away, */
	GONE = -230,                /* and vanishes fast enough where it falls below 2^-230 */
	SURE = 990,                 /* tenths of an order that limits nothing, */
	HIGHEST = 40,               /* of that of the schemes, */
	JUMP = 10, KINK = 20,       /* and of those that are left here */
	LIMIT_WORK = 2000000        /* terms measured in all, before what is left is judged by its kind */
};

struct surface {
	const struct form *g;       /* its first factor is 1 */
	const struct atom *full;    /* what decides on it, for a message: a product or choice in place of its operand */
	const struct node *test;    /* the comparison itself */
	bool equality;              /* some == or != does */
	bool abrupt;                /* something decides that is no abs, min, max, clip, deadzone or table */
	bool implicit;              /* g reads what equations are solved for: it is judged by its kind */
};

struct search {
	struct building *b;
	bool *seen;                 /* per atom */
	int surfaces;
	struct surface *surface;
	int count;                  /* of atoms, those apart that are made here */
	signed char *touched;       /* per atom, and the next: see struct side */
	struct form **known;
	struct sample *sample;
	struct spot *spot;
};

/* ---- which surfaces ---- */

/* Inputs that are held change between steps only. */
static bool moves_in_a_step(const struct model *model, const struct form *form)
{
	bool ramps = false;
	for (int i = 0; i < model->system.inputs; i++)
		ramps = ramps || model->system.input[i].hold;
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		if (basis->kind == BASIS_FORCING || basis->kind == BASIS_COORD ||
		    (basis->atom && (basis->atom->time || basis->atom->state)))
			return true;
		if (ramps && ((basis->kind == BASIS_INPUT && basis->order == 0) || (basis->atom && basis->atom->input)))
			return true;
	}
	return false;
}

static mpq_srcptr first_factor(const struct form *form)
{
	int i = 0;
	while (i + 1 < form->terms && form->term[i].basis.kind <= BASIS_PI)
		i++;
	return form->term[i].factor;
}

struct finding {
	struct search *s;
	const struct atom *atom, *full;
};

static void add_surface(void *context, const struct form *d)
{
	struct finding *f = context;
	struct search *s = f->s;
	const struct atom *a = f->atom;
	if (!moves_in_a_step(s->b->model, d))
		return;
	RATIONAL scale = ZERO;
	mpq_inv(scale, first_factor(d));
	const struct form *g = form_scale(d, scale);
	int at = 0;
	while (at < s->surfaces && !same_form(s->surface[at].g, g))
		at++;
	if (at == s->surfaces)
		*MORE(s->surface, s->surfaces) = (struct surface){ .g = g, .full = f->full, .test = a->node };
	s->surface[at].equality |= (a->kind == ATOM_COMPARE && a->comparison >= CMP_EQ) || a->kind == ATOM_CHOOSE;
	s->surface[at].abrupt |= a->kind != ATOM_CALL || a->function == FN_SGN;
	s->surface[at].implicit |= a->highest;
}

static void add_decision(void *context, const struct form *d)
{
	visit_surfaces(d, add_surface, context);
}

static void find_surfaces(struct search *s, const struct form *form, const struct atom *full)
{
	for (int i = 0; i < form->terms; i++) {
		const struct atom *a = form->term[i].basis.atom;
		if (!a || s->seen[a->index])
			continue;
		s->seen[a->index] = true;
		visit_decisions(a, add_decision, &(struct finding){ s, a, full ? full : a });
		const struct written_system *written = a->written && a->written->slope ? a->written : NULL;
		for (int k = 0; written && k < written->rows; k++)      /* operands have iterates */
			find_surfaces(s, written->residual[k], NULL);
		for (int k = 0; k < (written ? 0 : a->operands); k++)
			find_surfaces(s, a->operand[k],
				      a->kind == ATOM_PRODUCT || a->kind == ATOM_POWER ? full ? full : a
				      : a->kind == ATOM_CHOOSE && k == 0               ? a
										       : NULL);
	}
}

/* ---- what the difference does towards the surface ---- */

struct spot {                       /* a point of the surface: what lies there is drawn once, and kept */
	int draw;
	const struct basis *moved;  /* along this; NULL: t */
	mpfr_t value, t;            /* of what is moved; of t elsewhere */
	int scales;                 /* sizes of numbers in conditions, near which things happen */
	mpq_t *scale;
};

static uint64_t scattered(uint64_t a, uint64_t b)
{
	uint64_t x = a * 0x9e3779b97f4a7c15u + b * 0xd1b54a32d192ed03u + 0x632be59bd9b4e019u;
	x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
	x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
	return x ^ (x >> 31);
}

static void draw_number(const struct spot *p, unsigned long which, mpfr_ptr value)
{
	uint64_t random = scattered(which, (uint64_t)p->draw);
	int scales = p->scales + 3;
	int scale = (int)(random % (uint64_t)scales);
	mpfr_set_ui(value, (unsigned long)((random >> 8) % 4096 + 1), MPFR_RNDN);
	mpfr_div_2ui(value, value, 11, MPFR_RNDN);      /* 0 .. 2 times a size */
	if (scale < p->scales)
		mpfr_mul_q(value, value, p->scale[scale], MPFR_RNDN);
	else
		mpfr_mul_2si(value, value, 4 * (scale - p->scales) - 3, MPFR_RNDN);
	if ((random >> 24) % 2)
		mpfr_neg(value, value, MPFR_RNDN);
}

static void spot_leaf(void *context, const struct basis *basis, mpfr_ptr value)
{
	const struct spot *p = context;
	if (p->moved && basis_order(p->moved, basis) == 0)
		mpfr_set(value, p->value, MPFR_RNDN);
	else
		draw_number(p,
			    (unsigned long)basis->kind * 1000003 + (unsigned long)basis->index * 4 +
				    (unsigned long)basis->order + 1,
			    value);
}

/* g, or the difference, with what is moved at `at` */
static void measure(struct sample *sample, struct spot *p, const struct form *form, mpfr_srcptr at, mpfr_ptr value)
{
	mpfr_set(p->value, at, MPFR_RNDN);
	sample_at(sample, p->moved ? p->t : p->value);
	sample_form(sample, form, value);
}

/* Where g is 0 along what is moved: by a secant, which is exact where g is linear in it, else between two points of
 * different sign. */
static bool find_zero(struct sample *sample, struct spot *p, const struct form *g, mpfr_ptr root)
{
	enum { CELLS = 48 };
	REAL a = WITH_BITS(PRECISION), b = WITH_BITS(PRECISION), low = WITH_BITS(PRECISION),
	     high = WITH_BITS(PRECISION), middle = WITH_BITS(PRECISION), value = WITH_BITS(PRECISION);
	mpfr_set_ui(low, 0, MPFR_RNDN);
	mpfr_set_ui(high, 1, MPFR_RNDN);
	measure(sample, p, g, low, a);
	measure(sample, p, g, high, b);
	mpfr_sub(b, b, a, MPFR_RNDN);
	mpfr_div(root, a, b, MPFR_RNDN);
	mpfr_neg(root, root, MPFR_RNDN);
	measure(sample, p, g, root, value);
	bool found = mpfr_number_p(value) && (mpfr_zero_p(value) || mpfr_get_exp(value) < GONE);
	draw_number(p, 7, high);
	mpfr_abs(high, high, MPFR_RNDN);
	for (int k = -CELLS; k < CELLS && !found; k++) {
		mpfr_mul_si(low, high, k, MPFR_RNDN);
		mpfr_div_ui(low, low, 8, MPFR_RNDN);
		mpfr_div_ui(middle, high, 8, MPFR_RNDN);
		mpfr_add(middle, low, middle, MPFR_RNDN);
		measure(sample, p, g, low, a);
		measure(sample, p, g, middle, b);
		if (!mpfr_number_p(a) || !mpfr_number_p(b) || (!p->moved && k < 0) || mpfr_sgn(a) * mpfr_sgn(b) > 0)
			continue;
		for (int bit = 0; bit < PRECISION; bit++) {
			mpfr_add(root, low, middle, MPFR_RNDN);
			mpfr_div_2ui(root, root, 1, MPFR_RNDN);
			measure(sample, p, g, root, value);
			mpfr_set(mpfr_sgn(value) * mpfr_sgn(a) > 0 ? low : middle, root, MPFR_RNDN);
		}
		/* not at a pole */
		found = mpfr_number_p(value) && (mpfr_zero_p(value) || mpfr_get_exp(value) < GONE);
	}
	return found;
}

/* |value| as a power of two; GONE where it is nothing */
static long size_of(mpfr_srcptr value)
{
	return mpfr_zero_p(value) || mpfr_get_exp(value) < GONE ? GONE : mpfr_get_exp(value);
}

/* From its sizes 2^-32 and 2^-64 away: 1 + p in tenths, rounded down; 0: it grows, which is a singularity and no
 * matter of smoothness */
static int order_of_sizes(long first, long second)
{
	if (second <= GONE)
		return SURE;
	return first - second < -4 ? 0 : (int)((10 * (first - second) + 15) / NEAR) + 10;
}

/* The difference is not defined off the surface, as in abs(x)^1.5: what each side does as it leaves it */
static int order_of_growth(struct sample *sample, struct spot *p, const struct form *side, mpfr_srcptr root,
			   int direction)
{
	long size[2];
	REAL at = WITH_BITS(PRECISION), here = WITH_BITS(PRECISION), there = WITH_BITS(PRECISION);
	measure(sample, p, side, root, here);
	for (int k = 0; k < 2; k++) {
		mpfr_set_si_2exp(at, direction, -NEAR * (k + 1), MPFR_RNDN);
		mpfr_add(at, at, root, MPFR_RNDN);
		measure(sample, p, side, at, there);
		mpfr_sub(there, there, here, MPFR_RNDN);
		size[k] = mpfr_number_p(there) ? size_of(there) : GONE;
	}
	return order_of_sizes(size[0], size[1]);
}

struct sides { const struct form *g, *above, *below, *difference, *isolated; };

/* The order that a crossing at this point leaves; -1: nothing is defined there */
static int order_at(struct sample *sample, struct spot *p, const struct sides *f)
{
	long size[2] = { 0, 0 };
	REAL root = WITH_BITS(PRECISION), at = WITH_BITS(PRECISION), value = WITH_BITS(PRECISION);
	int order = -1;
	bool found = find_zero(sample, p, f->g, root);
	for (int direction = 1; direction >= -1 && found && order < 0; direction -= 2) {
		bool defined = true;
		for (int k = 0; k < 2; k++) {
			mpfr_set_si_2exp(at, direction, -NEAR * (k + 1), MPFR_RNDN);
			mpfr_add(at, at, root, MPFR_RNDN);
			measure(sample, p, f->difference, at, value);
			defined = defined && mpfr_number_p(value);
			size[k] = defined ? size_of(value) : 0;
		}
		order = defined ? order_of_sizes(size[0], size[1]) : -1;
	}
	if (found && order < 0) {
		measure(sample, p, f->difference, root, value);
		int above = order_of_growth(sample, p, f->above, root, 1),
		    below = order_of_growth(sample, p, f->below, root, -1);
		if (mpfr_number_p(value))
			order = size_of(value) > GONE ? JUMP : above < below ? above : below;
	}
	if (found && f->isolated) {
		measure(sample, p, f->isolated, root, value);
		if (mpfr_number_p(value) && size_of(value) > GONE)
			order = JUMP;
	}
	return order;
}

/* ---- the judgement on one surface ---- */

struct judging {
	struct search *s;
	const struct surface *surface;
	const struct form *form;
	struct sides sides;
};

static void write_sides(void *context)
{
	struct judging *j = context;
	struct collector *c = &j->s->b->collector;
	struct search *s = j->s;
	struct side side = { .c = c, .g = j->surface->g, .count = s->count, .touched = s->touched, .known = s->known };
	memset(s->touched, 0, (size_t)s->count);
	struct form *form[3];
	for (int sign = -1; sign <= 1; sign++) {
		side.sign = sign;
		memset(s->known, 0, (size_t)s->count * sizeof *s->known);
		form[sign + 1] = sign || j->surface->equality ? form_on_side(&side, j->form) : NULL;
	}
	j->sides = (struct sides){ j->surface->g, form[2], form[0], form_difference(form[2], form[0]), NULL };
	if (j->surface->equality)
		j->sides.isolated = form_difference(form[1], form[2]);
}

static void add_scale(struct spot *p, const struct form *form)
{
	mpq_t *scale = rationals(p->scales + 1);
	if (form->terms < 2 || form->term[0].basis.kind != BASIS_ONE)
		return;
	for (int i = 0; i < p->scales; i++)
		mpq_set(scale[i], p->scale[i]);
	mpq_set(scale[p->scales++], form->term[0].factor);
	p->scale = scale;
}

static bool is_number(const struct form *form)
{
	return form->terms > 0 && is_constant(form);
}

/* What the surface leaves, in tenths: JUMP, KINK or more; `sure` where it was measured */
static int order_on(struct search *s, const struct surface *surface, const struct form *form, bool *sure)
{
	struct judging j = { .s = s, .surface = surface, .form = form };
	int worst = surface->abrupt ? JUMP : KINK, order = SURE;
	*sure = false;
	if (surface->implicit || !silent_guard(write_sides, &j))
		return worst;
	*sure = true;
	if (is_number(j.sides.difference) || (j.sides.isolated && is_number(j.sides.isolated)))
		return JUMP;
	if (j.sides.difference->terms == 0 && (!j.sides.isolated || j.sides.isolated->terms == 0))
		return SURE;
	struct spot *p = s->spot;
	bool measured = false;
	p->moved = NULL;                        /* t, where nothing else moves */
	for (int i = 0; i < surface->g->terms; i++)
		p->moved = moved_basis(p->moved, &surface->g->term[i].basis);
	p->scales = 0;
	for (int i = 0; i < s->surfaces && i < SCALES; i++)
		add_scale(p, s->surface[i].g);
	for (p->draw = 1; p->draw <= POINTS && order > JUMP && sample_work(s->sample) < LIMIT_WORK; p->draw++) {
		draw_number(p, 3, p->t);
		mpfr_abs(p->t, p->t, MPFR_RNDN);
		int here = order_at(s->sample, p, &j.sides);
		measured = measured || here >= 0;
		order = here > 0 && here < order ? here : order;
	}
	*sure = measured;
	return measured ? order : worst;
}

/* ---- the whole ---- */

bool reads_velocity(const struct model *model, const struct form *form)
{
	for (int i = 0; i < form->terms; i++)
		if (is_velocity(&model->frame, &form->term[i].basis))
			return true;
	return false;
}

/* g without its constant, and what it is at the surface: x, 0.5 */
static const char *surface_text(const struct model *model, const struct form *g)
{
	mpq_srcptr one = factor_of(g, BASIS_ONE);
	RATIONAL at = ZERO;
	if (one)
		mpq_neg(at, one);
	const char *text =
		format("%s passes %s", form_text(model, form_sum(g, form_constant(at), false)), readable_text(at));
	return text;
}

void report_friction(const struct node *node, const char *where)
{
	error(node->start,
	      "dry friction, which sticks and slips, is written friction(v, F) in place of F*sgn(v); a force that is "
	      "continuous in the velocity is treated, such as clip(100*x', -1, 1), and one that jumps with a position",
	      "the force jumps where %s, and as a formula it cannot stick", where);
}

/* A time that is no later than the start is passed by no step, and what is continuous at the end of a step may
 * change there. */
static bool is_harmless_time(const struct model *model, const struct form *g, int order)
{
	struct form phase;
	mpq_srcptr factor, constant;
	if (!linear_in_time(g, &factor, &phase) || factor_of(&phase, BASIS_PI))
		return false;
	RATIONAL t = ZERO;
	constant = factor_of(&phase, BASIS_ONE);
	if (constant)
		mpq_div(t, constant, factor);
	mpq_neg(t, t);
	bool harmless = mpq_sgn(t) <= 0;
	mpq_div(t, t, model->h);
	harmless = harmless || (order > JUMP && mpz_cmp_ui(mpq_denref(t), 1) == 0);
	return harmless;
}

static void judge_surface(struct search *s, const struct surface *surface, const struct form *form)
{
	struct model *model = s->b->model;
	struct smoothness *smooth = &model->remainder.smooth;
	struct form phase;
	mpq_srcptr factor;
	bool sure;
	int order = order_on(s, surface, form, &sure);
	if (is_harmless_time(model, surface->g, order))
		return;
	/* what a kink does to a derivative is a jump, and no friction */
	if (order == JUMP && sure && !model->switching && reads_velocity(model, surface->g) &&
	    s->b->request->again.derivatives == 0)
		report_friction(surface->test, surface_text(model, surface->g));
	bool timed = linear_in_time(surface->g, &factor, &phase), full = order % 10 == 0 || order == SURE;
	if (!full && !timed && !smooth->singular) {
		smooth->singular = surface->full->node;
		smooth->singular_where = surface_text(model, surface->g);
	}
	if (order >= HIGHEST || (smooth->tenths && smooth->tenths <= order))
		return;
	smooth->tenths = order;
	smooth->kind = order == JUMP ? SMOOTH_JUMP : SMOOTH_KINK;
	smooth->node = surface->full->node;
	smooth->where = surface_text(model, surface->g);
	smooth->piecewise = is_piecewise_form(form_unit((struct basis){ .kind = BASIS_ATOM, .atom = surface->full }));
	smooth->timed = timed;
}

/* The part of an equation that is not carried exactly for all time */
static const struct form *moving_part(const struct form *residual)
{
	return form_difference(residual, time_part(residual, false));
}

static struct search new_search(struct building *b, struct spot *spot)
{
	struct search s = { .b = b, .count = atoms_count(b->collector.atoms), .spot = spot };
	mpfr_inits2(PRECISION, spot->value, spot->t, NULL);
	s.touched = ARRAY(signed char, s.count);
	s.known = ARRAY(struct form *, s.count);
	s.seen = ARRAY(bool, s.count);
	s.sample = sample_new(PRECISION, spot_leaf, spot);
	return s;
}

static void judge(void *context)
{
	struct building *b = context;
	struct model *model = b->model;
	bool left = model->remainder.force_columns > 0;
	int count = left ? model->remainder.force_columns : model->n;
	struct spot spot = { 0 };
	struct search s = new_search(b, &spot);
	for (int i = 0; i < count; i++) {
		const struct form *form = left ? model->schedule.operator[0].left[i]
		    : moving_part(b->full->residual[i].form);
		memset(s.seen, 0, (size_t)s.count);
		s.surfaces = 0;
		find_surfaces(&s, form, NULL);
		for (int k = 0; k < s.surfaces; k++)
			judge_surface(&s, &s.surface[k], form);
	}
}

void judge_smoothness(struct building *b)
{
	struct collector *c = &b->collector;
	const struct irrationals used = c->irrationals;
	if (!b->full || (b->model->remainder.force_columns == 0 && !b->model->switching))
		return;
	c->whole_time = true;           /* conditions on t stay open */
	statement_guard(judge, b);
	c->whole_time = false;
	c->irrationals = used;
}

static bool reads_state(const struct form *form)
{
	bool reads = false;
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		reads = reads || basis->kind == BASIS_COORD || (basis->atom && basis->atom->state);
	}
	return reads;
}

struct jump { struct building *b; const struct form *form; const char *where; };

static void find_jump(void *context)
{
	struct jump *jump = context;
	struct spot spot = { 0 };
	struct search s = new_search(jump->b, &spot);
	bool sure;
	find_surfaces(&s, jump->form, NULL);
	for (int k = 0; k < s.surfaces && !jump->where; k++)
		if (s.surface[k].abrupt && reads_state(s.surface[k].g) &&
		    order_on(&s, &s.surface[k], jump->form, &sure) == JUMP && sure)
			jump->where = surface_text(jump->b->model, s.surface[k].g);
}

const char *jump_with_state(struct building *b, const struct form *form)
{
	struct collector *c = &b->collector;
	const struct irrationals used = c->irrationals;
	struct jump jump = { b, form, NULL };
	c->whole_time = true;
	silent_guard(find_jump, &jump);
	c->whole_time = false;
	c->irrationals = used;
	return jump.where;
}

int order_of_scheme(const struct model *model)
{
	const struct scheme_row *row = scheme_row(model->scheme);
	return row->order ? row->order : model->truncation.order;
}

int order_that_holds(const struct model *model)
{
	int order = model->remainder.force_columns > 0 || scheme_row(model->scheme)->holds_coupling
		? order_of_scheme(model)
											       : 0;
	return loses_order(model) ? model->remainder.smooth.tenths / 10 : order;
}

bool loses_order(const struct model *model)
{
	const struct scheme_row *row = scheme_row(model->scheme);
	if ((row->expands || row->modes) && model->remainder.smooth.timed)
		return false;                   /* a step ends where formulas change in time */
	if (row->expands)
		return false;                   /* and where the state chooses others */
	if (follows_crossings(model))
		return false;
	return model->remainder.force_columns > 0 && model->remainder.smooth.tenths > 0 &&
	       model->remainder.smooth.tenths < 10 * order_of_scheme(model);
}

const char *order_text(const struct model *model)
{
	int tenths = model->remainder.smooth.tenths;
	return tenths % 10 ? format("%d.%d", tenths / 10, tenths % 10) : format("%d", tenths / 10);
}

const char *smoothness_text(const struct model *model)
{
	const struct smoothness *smooth = &model->remainder.smooth;
	return format("%s %s where %s", text_between(smooth->node->start, smooth->node->end),
		      smooth->kind == SMOOTH_JUMP ? "jumps"
		      : smooth->tenths <= KINK    ? "has a kink"
						  : "is not smooth",
		      smooth->where);
}
