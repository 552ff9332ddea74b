/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Friction of what has no mass: friction(v, F) where v has the highest derivative of a coordinate of first order, as
 * in an element of Jenkins (a spring and a slider in series). The coordinate's equation gives the force that friction
 * has to bear, q. Up to F the slider sticks and v = 0; beyond, it slides so that q stays F, which gives its place; it
 * sticks again where v would turn round (W. D. Iwan, Journal of Applied Mechanics 33, 1966). With a damper beside it v
 * is what the damper makes of what q has above F, a function of straight pieces. */
#include "model/building.h"
#include "friction.h"

/* ---- which it is ---- */

static bool is_rate(const struct building *b, const struct basis *basis)
{
	return basis->kind == BASIS_COORD && basis->order == 1 && b->model->frame.coord[basis->index]->highest == 1;
}

static bool has_rate(const struct building *b, const struct form *form, int coord)
{
	for (int i = 0; i < form->terms; i++)
		if (is_rate(b, &form->term[i].basis) && (coord < 0 || form->term[i].basis.index == coord))
			return true;
	return false;
}

bool has_slider(const struct building *b, const struct form *form, int coord)
{
	for (int i = 0; i < form->terms; i++) {
		const struct atom *a = form->term[i].basis.atom;
		if (is_friction(a) && has_rate(b, a->operand[0], coord))
			return true;
	}
	return false;
}

static int coord_of_row(const struct building *b, int row)
{
	int coord = 0;
	while (b->owner[coord] != row)
		coord++;
	return coord;
}

/* The only slider of a row, in the velocity of which is the row's coordinate; NULL: there is none, or several */
static const struct form_term *only_slider(const struct building *b, const struct form *form, int coord)
{
	const struct form_term *found = NULL;
	for (int i = 0; i < form->terms; i++) {
		const struct atom *a = form->term[i].basis.atom;
		if (!is_friction(a) || !has_rate(b, a->operand[0], -1))
			continue;
		if (found || !has_rate(b, a->operand[0], coord))
			return NULL;
		found = &form->term[i];
	}
	return found;
}

/* ---- its equation ---- */

struct slider_row {
	struct building *b;
	struct segment_equations *segment_equations;
	const struct atom *atom;
	const struct form *velocity, *force;
	int row, coord;
	mpq_t factor;               /* of friction in the row */
};

static mpq_srcptr rate_factor(const struct form *form, int coord)
{
	struct basis basis = { .kind = BASIS_COORD, .index = coord, .order = 1 };
	const struct form_term *term = form_find(form, &basis);
	return term ? term->factor : NULL;
}

static struct form *scaled_form(const struct form *form, mpq_srcptr by, bool inverse, bool minus)
{
	RATIONAL factor = ZERO;
	inverse ? mpq_inv(factor, by) : mpq_set(factor, by);
	if (minus)
		mpq_neg(factor, factor);
	return form_scale(form, factor);
}

/* In other equations and in outputs the friction is the force through the slider. */
static void put_in_others(const struct slider_row *r, const struct form *slider_force)
{
	struct basis basis = { .kind = BASIS_ATOM, .index = r->atom->index, .atom = r->atom };
	struct model *model = r->b->model;
	*MORE(model->contacts.massless_slider, model->contacts.massless_sliders) =
		(struct massless_slider){ r->atom, slider_force };
	for (int i = 0; i < r->segment_equations->residuals; i++) {
		struct residual *residual = &r->segment_equations->residual[i];
		const struct form_term *term = form_find(residual->form, &basis);
		if (i == r->row || !term)
			continue;
		struct form *rest = form_difference(residual->form, form_single(basis, term->factor));
		residual->form = form_sum(rest, form_scale(slider_force, term->factor), false);
	}
}

/* The force through the slider becomes less as it slides. */
static void check_borne(const struct slider_row *r, const struct form *slider_force)
{
	struct basis place = { .kind = BASIS_COORD, .index = r->coord };
	const struct form_term *term = form_find(slider_force, &place);
	if (term && mpq_sgn(term->factor) * mpq_sgn(rate_factor(r->velocity, r->coord)) > 0)
		report_drives(r->atom->node);
}

/* c f + rest = 0: q = -rest/c */
static void slide_alone(const struct slider_row *r, const struct form *rest)
{
	struct form *slider_force = scaled_form(rest, r->factor, true, true), *operand[] = { slider_force, NULL };
	check_borne(r, slider_force);
	operand[1] = form_alias(r->force);
	struct form *slides = kept_call(&r->b->collector, r->atom->node, FN_SLIDE, 2, operand);
	r->segment_equations->residual[r->row].form = form_difference(r->velocity, slides);
	put_in_others(r, slider_force);
}

/* F of a slider with a damper, and 0 where it falls below */
static const struct form *force_beside_damper(const struct slider_row *r)
{
	struct form *force[] = { form_alias(r->force), form_number(0) };
	RATIONAL start = ZERO;
	check_force(r->atom->node->child[1], r->force, start, NULL);
	return never_falls_below(r->force) ? r->force : kept_call(&r->b->collector, r->atom->node, FN_MAX, 2, force);
}

/* v, what p has beyond -kF and kF, and k f, the rest of it. A force that changes is taken on either side by itself: as
 * one function of three pieces it would jump where both sides are passed, which a force that is never below 0 does not
 * let happen. */
static void divide_drive(const struct slider_row *r, const struct form *p, mpq_srcptr k, struct form **slides,
			 struct form **slider_force)
{
	struct collector *c = &r->b->collector;
	const struct node *node = r->atom->node;
	const struct form *force = force_beside_damper(r);
	struct form *x[] = { form_alias(p), scaled_form(force, k, false, true), form_scale(force, k) };
	if (is_constant(force)) {
		*slides = kept_call(c, node, FN_DEADZONE, 3, x);
		*slider_force = kept_call(c, node, FN_CLIP, 3, x);
		return;
	}
	struct form *above[] = { form_difference(p, x[2]), form_number(0) },
		    *below[] = { form_difference(p, x[1]), form_number(0) };
	*slides = form_sum(kept_call(c, node, FN_MAX, 2, above), kept_call(c, node, FN_MIN, 2, below), false);
	*slider_force = form_difference(p, *slides);
}

/* c f + a z' + rest = 0 and v = d z' + w: v + k f = p, where k = c d/a and p = w - (d/a) rest; v is what p has beyond
 * kF */
static void slide_damped(const struct slider_row *r, const struct form *rest, mpq_srcptr damping)
{
	mpq_srcptr along = rate_factor(r->velocity, r->coord);
	struct basis rate = { .kind = BASIS_COORD, .index = r->coord, .order = 1 };
	RATIONAL ratio = ZERO, k = ZERO;
	mpq_div(ratio, along, damping);
	mpq_mul(k, ratio, r->factor);
	if (mpq_sgn(k) < 0)
		report_drives(r->atom->node);
	rest = form_difference(rest, form_single(rate, damping));
	struct form *drive = form_difference(form_difference(r->velocity, form_single(rate, along)),
					     form_scale(rest, ratio));
	struct form *slides, *slider_force;
	divide_drive(r, drive, k, &slides, &slider_force);
	r->segment_equations->residual[r->row].form = form_difference(r->velocity, slides);
	put_in_others(r, scaled_form(slider_force, k, true, false));
}

static void slide(struct building *b, struct segment_equations *segment_equations, int row,
		  const struct form_term *term)
{
	struct slider_row r =
		{ .b = b, .segment_equations = segment_equations, .row = row, .coord = coord_of_row(b, row),
				.atom = term->basis.atom, .velocity = term->basis.atom->operand[0],
				.force = term->basis.atom->operand[1] };
	const struct node *node = r.atom->node;
	const struct form *residual = segment_equations->residual[row].form;
	if (r.atom->operands > 2)
		error(node->child[2]->start, "friction(v, F)",
		      "what has no mass holds as much as it brakes: it would leave its place at once");
	mpq_init(r.factor);
	mpq_set(r.factor, term->factor);
	struct form *rest = form_difference(residual, form_single(term->basis, term->factor));
	mpq_srcptr damping = rate_factor(rest, r.coord);
	if (damping)
		slide_damped(&r, rest, damping);
	else
		slide_alone(&r, rest);
	mpq_clear(r.factor);
}

struct form *borne_form(const struct building *b, const struct form *form)
{
	struct form *sum = NEW(struct form);
	for (int i = 0; i < form->terms; i++) {
		const struct form_term *term = &form->term[i];
		const struct form *slider_force = NULL;
		for (int k = 0; k < b->model->contacts.massless_sliders && term->basis.atom; k++)
			if (b->model->contacts.massless_slider[k].atom == term->basis.atom)
				slider_force = b->model->contacts.massless_slider[k].slider_force;
		if (slider_force)
			form_add_to(sum, slider_force, term->factor);
		else
			form_add_basis(sum, term->basis, term->factor);
	}
	return sum;
}

struct sliding { struct building *b; struct segment_equations *segment_equations; };

static void resolve_all(void *context)
{
	struct sliding *w = context;
	struct building *b = w->b;
	struct segment_equations *s = w->segment_equations;
	bool any = true;
	while (any) {
		any = false;
		for (int i = 0; i < s->residuals; i++) {
			int coord = coord_of_row(b, i);
			const struct form_term *term = only_slider(b, s->residual[i].form, coord);
			any = any || term;
			if (term)
				slide(b, s, i, term);
		}
	}
	for (int i = 0; i < s->residuals; i++)
		for (int k = 0; k < s->residual[i].form->terms; k++) {
			const struct atom *a = s->residual[i].form->term[k].basis.atom;
			if (is_friction(a) && has_rate(b, a->operand[0], -1))
				error(a->node->at, "the equation of a massless slider gives the force through it",
				      "no equation gives the force of this friction");
		}
}

void resolve_sliders(struct building *b, struct segment_equations *segment_equations)
{
	bool any = false;
	for (int i = 0; i < segment_equations->residuals; i++)
		any = any || has_slider(b, segment_equations->residual[i].form, -1);
	if (any)
		statement_guard(resolve_all, &(struct sliding){ b, segment_equations });
}
