/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Impacts: where a guard comes true by crossing, the state jumps, linearly. One that turns the speed of its guard, s to
 * -e s, along one direction, v -> v - (1 + e) d s, is a bounce; after infinitely many of them in finite time, or after
 * one where e is 0, its contact rests. */
#include "model/model.h"

/* ---- guards and jumps as forms ---- */

static struct form *scalar_form(struct building *b, struct node *node)
{
	struct value *value = collect(&b->collector, node);
	if (value->rows != 1 || value->columns != 1)
		error(node->start, NULL, "expected a scalar, found a %d x %d matrix", value->rows, value->columns);
	return value->cell[0];
}

static bool is_highest(const struct building *b, const struct basis *basis)
{
	return basis->kind == BASIS_COORD && basis->order >= b->model->frame.coord[basis->index]->highest;
}

static void check_linear(const struct building *b, const struct node *node, const struct form *form, const char *what)
{
	for (int i = 0; i < form->terms; i++) {
		if (form->term[i].basis.kind == BASIS_ATOM)
			error(node->start, NULL, "%s is linear in states, loads and inputs, and '%s' is not", what,
			      text_between(node->start, node->end));
		if (is_highest(b, &form->term[i].basis))
			error(node->start, "it follows from the equations, which change there",
			      "%s cannot read the highest derivative of %s", what,
			      b->model->coord_name[form->term[i].basis.index]);
	}
}

static bool is_rising(const struct when *when)
{
	return when->guard->comparison == CMP_GT || when->guard->comparison == CMP_GE;
}

/* The gap of a stop is a length, and what comes back of the speed a part of it. */
static void check_stop(struct building *b, const struct when *when, mpq_ptr restitution, mpq_ptr gap)
{
	collect_constant(&b->collector, when->restitution, restitution);
	if (mpq_sgn(restitution) < 0 || mpq_cmp_ui(restitution, 1, 1) > 0)
		error(when->restitution->start, "the part of the speed that comes back, 0 to 1",
		      "restitution %s is not within 0 and 1", readable_text(restitution));
	struct form *form = scalar_form(b, when->gap);
	if (is_constant(form))
		constant_value(&b->collector, form, gap);
	if (mpq_sgn(gap) < 0)
		error(when->gap->start, "a gap is 0 or more: what stands first comes up to the second",
		      "a gap of %s is below 0", readable_text(gap));
}

struct collecting {
	struct building *b;
	const struct when *when;
	struct impact *impact;
};

static int state_at(const struct building *b, const struct node *target)
{
	const struct symbol *s = target->symbol;
	int coord = s->index + (target->component ? target->component - 1 : 0);
	if (target->primes >= s->highest)
		error(target->at, NULL, "'%s' follows from the equations: it cannot jump",
		      text_between(target->start, target->end));
	return target->primes ? b->model->system.velocity[coord] : coord;
}

static bool is_ramp(const struct building *b, int input)
{
	bool ramp = false;
	for (const struct symbol *s = b->spec->first; s; s = s->next)
		ramp = ramp || (s->kind == SYMBOL_INPUT && s->index == input && s->hold > 0);
	return ramp;
}

static void collect_impact(void *context)
{
	struct collecting *work = context;
	struct building *b = work->b;
	const struct when *when = work->when;
	struct impact *impact = work->impact;
	struct node *const *side = when->guard->child;
	mpq_inits(impact->restitution, impact->gap, impact->answer, impact->at, impact->factor, NULL);
	impact->when = when;
	if (when->restitution)
		check_stop(b, when, impact->restitution, impact->gap);
	struct form *left = scalar_form(b, side[0]), *right = scalar_form(b, side[1]);
	check_linear(b, side[0], left, "a guard");
	check_linear(b, side[1], right, "a guard");
	impact->rising = is_rising(when);
	impact->guard = impact->rising ? form_difference(left, right) : form_difference(right, left);
	if (is_constant(impact->guard))
		error(when->guard->start, "a coordinate, a velocity, a load or an input against a constant",
		      "this guard never changes");
	for (int i = 0; i < impact->guard->terms; i++)
		if (impact->guard->term[i].basis.kind == BASIS_INPUT && !is_ramp(b, impact->guard->term[i].basis.index))
			error(when->guard->start, "as a ramp it moves: input ... hold first",
			      "this guard jumps with an input that is held");
	impact->jump = ARRAY(struct jump, (size_t)when->jumps + (size_t)b->model->n);
	for (int i = 0; i < when->jumps; i++) {
		struct jump *jump = &impact->jump[impact->jumps++];
		jump->state = state_at(b, when->jump[i].target);
		jump->form = scalar_form(b, when->jump[i].value);
		check_linear(b, when->jump[i].value, jump->form, "a jump");
	}
}

/* In the first interval of time: beside loads that change their formula there are none. */
void collect_impacts(struct building *b)
{
	struct model *model = b->model;
	const struct spec *spec = b->spec;
	model->impacts = spec->whens;
	model->impact = ARRAY(struct impact, (size_t)spec->whens);
	for (int i = 0; i < spec->whens; i++)
		statement_guard(collect_impact, &(struct collecting){ b, &spec->when[i], &model->impact[i] });
}

void tell_no_impacts(const struct building *b)
{
	const struct model *model = b->model;
	struct place at = b->spec->when->at;
	if (b->request->solution)
		error(at, "the C that is printed without it goes from event to event",
		      "there is no closed form where the state jumps");
	if (b->request->loads_left)
		error(at, "without --loads leftover they are exact",
		      "scheme exact, which impacts need, leaves no load over");
	if (model->system.segments > 1)
		error(at, "the load as an input is exact beside it",
		      "impacts beside loads that change their formula in time are not built yet");
	if (model->scheme != SCHEME_EXACT)
		error(at, "scheme exact goes from event to event", "scheme %s has no impacts",
		      scheme_name(model->scheme));
	error(at, "scheme exact goes from event to event, and takes what is piecewise linear",
	      "impacts stand beside what is not piecewise linear: no scheme has both");
}

/* ---- what a jump does to a form ---- */

static const struct jump *jump_of(const struct building *b, const struct impact *impact, const struct basis *basis)
{
	for (int i = 0; i < impact->jumps && basis->kind == BASIS_COORD; i++) {
		int state = basis->order ? b->model->system.velocity[basis->index] : basis->index;
		if (impact->jump[i].state == state)
			return &impact->jump[i];
	}
	return NULL;
}

/* The form of the state behind the jump, over the state before it */
static struct form *behind(const struct building *b, const struct impact *impact, const struct form *form)
{
	struct form *sum = NEW(struct form);
	for (int i = 0; i < form->terms; i++) {
		const struct jump *jump = jump_of(b, impact, &form->term[i].basis);
		if (jump)
			form_add_to(sum, jump->form, form->term[i].factor);
		else
			form_add_basis(sum, form->term[i].basis, form->term[i].factor);
	}
	return sum;
}

/* a = ratio b + rest, rest constant; b has terms that are not */
static bool is_along(struct building *b, const struct form *a, const struct form *along, mpq_ptr ratio, mpq_ptr rest)
{
	const struct form_term *last = &along->term[along->terms - 1], *same = form_find(a, &last->basis);
	mpq_set_ui(ratio, 0, 1);
	if (same)
		mpq_div(ratio, same->factor, last->factor);
	const struct form *off = form_difference(a, form_scale(along, ratio));
	if (!is_constant(off))
		return false;
	constant_value(&b->collector, off, rest);
	return true;
}

static bool reads_highest(const struct building *b, const struct form *form)
{
	bool any = false;
	for (int i = 0; i < form->terms; i++)
		any = any || is_highest(b, &form->term[i].basis);
	return any;
}

static _Noreturn void tell_again(const struct when *when, const char *why)
{
	error(when->guard->start, "x' = -0.8*x' turns back what x >= 0.1 has met",
	      "its own jump triggers this 'when' again at once: %s", why);
}

/* Behind its own jump a guard may not stand where it is true, nor go on to there. */
static void check_jump(void *context)
{
	struct collecting *work = context;
	struct building *b = work->b;
	const struct impact *impact = work->impact;
	mpq_t ratio, rest;
	mpq_inits(ratio, rest, NULL);
	bool known = is_along(b, behind(b, impact, impact->guard), impact->guard, ratio, rest);
	if (known && mpq_sgn(rest) > 0)
		tell_again(impact->when, "behind it the guard is true, by a constant");
	bool stays = known && mpq_sgn(rest) == 0;
	if (stays && !reads_highest(b, impact->speed) && !is_constant(impact->speed) &&
	    is_along(b, behind(b, impact, impact->speed), impact->speed, ratio, rest) && mpq_sgn(rest) == 0 &&
	    mpq_sgn(ratio) > 0)
		tell_again(impact->when, "behind it the guard goes on as it came");
	mpq_clears(ratio, rest, NULL);
}

/* ---- bounces ---- */

/* Whether each jump is v -> v - (1 + e) d s of velocities v, s the speed of the guard; then e and d */
static bool find_bounce(struct building *b, struct impact *impact)
{
	const struct linear *system = &b->model->system;
	mpq_t *part = rationals((size_t)b->model->n), turned, product, rest;
	bool bounce = !reads_highest(b, impact->speed) && !is_constant(impact->speed);
	mpq_inits(turned, product, rest, NULL);
	for (int i = 0; i < impact->jumps && bounce; i++) {
		int state = impact->jump[i].state, coord = system->coord[state];
		struct basis basis = { .kind = BASIS_COORD, .index = coord, .order = 1 };
		bounce = state >= b->model->n &&
			 is_along(b, form_difference(form_unit(basis), impact->jump[i].form), impact->speed,
				  part[coord], rest) &&
			 mpq_sgn(rest) == 0;
		const struct form_term *term = bounce ? form_find(impact->speed, &basis) : NULL;
		if (term)
			mpq_mul(product, term->factor, part[coord]);
		if (term)
			mpq_add(turned, turned, product);
	}
	mpq_set_ui(rest, 1, 1);
	bounce = bounce && mpq_cmp(turned, rest) >= 0;
	for (int j = 0; j < b->model->n && bounce; j++)
		mpq_div(part[j], part[j], turned);
	if (bounce)
		mpq_sub(impact->restitution, turned, rest);
	impact->direction = bounce ? part : NULL;
	mpq_clears(turned, product, rest, NULL);
	return bounce;
}

/* ---- stops: the force between two coordinates does it, by the equations' masses ---- */

static void add_row(const struct building *b, const struct node *end, int sign, mpq_t *force)
{
	if (!end)
		return;
	int coord = end->symbol->index + (end->component ? end->component - 1 : 0);
	if (b->model->system.velocity[coord] < 0)
		error(end->at, "a mass, or an equation with its second derivative",
		      "an impact needs a mass: %s is of first order", b->model->coord_name[coord]);
	mpq_set_si(force[b->owner[coord]], sign, 1);
}

/* v -> v - (1 + e) d s; returns how many */
static int velocity_jumps(const struct building *b, const struct impact *impact, mpq_srcptr e, struct jump *jump)
{
	int jumps = 0;
	mpq_t factor;
	mpq_init(factor);
	for (int j = 0; j < b->model->n; j++) {
		if (mpq_sgn(impact->direction[j]) == 0)
			continue;
		struct basis basis = { .kind = BASIS_COORD, .index = j, .order = 1 };
		mpq_set_si(factor, -1, 1);
		mpq_sub(factor, factor, e);
		mpq_mul(factor, factor, impact->direction[j]);
		jump[jumps++] = (struct jump){
			.state = b->model->system.velocity[j],
			.form = form_sum(form_unit(basis), form_scale(impact->speed, factor), false)
		};
	}
	mpq_clear(factor);
	return jumps;
}

/* Of highest derivatives, as the equations have them */
static mpq_t *inverse_masses(const struct building *b)
{
	struct linear shape = linear_like(&b->model->system);
	int n = shape.n, column;
	mpq_t *inverse = rationals((size_t)(n * n));
	for (int i = 0; i < n; i++) {
		const struct form *form = b->snapshot->residual[i].form;
		for (int k = 0; k < form->terms; k++) {
			const struct basis *basis = &form->term[k].basis;
			mpq_t *matrix[] = { shape.K, shape.C, shape.M };
			if (basis->kind == BASIS_COORD)
				mpq_set(matrix[basis->order][i * n + basis->index], form->term[k].factor);
		}
	}
	if (!leading_inverse(&shape, inverse, &column))
		abandon();                      /* told with the equations */
	return inverse;
}

/* d = M^-1 f/(s M^-1 f), f the force of contact on the equations of the two */
static void find_jumps(void *context)
{
	struct collecting *work = context;
	struct building *b = work->b;
	struct impact *impact = work->impact;
	int n = b->model->n;
	mpq_t *inverse = inverse_masses(b), *force = rationals((size_t)n), *d = rationals((size_t)n), speed, factor;
	mpq_inits(speed, factor, NULL);
	add_row(b, work->when->from, 1, force);
	add_row(b, work->when->to, -1, force);
	rational_product(n, n, 1, (const mpq_t *)inverse, (const mpq_t *)force, d);
	for (int i = 0; i < impact->speed->terms; i++) {
		const struct basis *basis = &impact->speed->term[i].basis;
		if (basis->kind != BASIS_COORD)
			continue;
		mpq_mul(factor, impact->speed->term[i].factor, d[basis->index]);
		mpq_add(speed, speed, factor);
	}
	if (mpq_sgn(speed) <= 0)
		error(impact->when->at, NULL, "the masses at this stop do not make a force part them");
	for (int j = 0; j < n; j++)
		mpq_div(d[j], d[j], speed);
	mpq_set(impact->answer, speed);
	impact->direction = d;
	impact->jumps = velocity_jumps(b, impact, impact->restitution, impact->jump);
	mpq_clears(speed, factor, NULL);
}

/* What is left where nothing comes back */
static void still_jumps(struct building *b, struct impact *impact)
{
	mpq_t none;
	mpq_init(none);
	impact->still = ARRAY(struct jump, (size_t)b->model->n);
	impact->jump = ARRAY(struct jump, (size_t)b->model->n);
	velocity_jumps(b, impact, none, impact->still);
	impact->jumps = velocity_jumps(b, impact, impact->restitution, impact->jump);
	mpq_clear(none);
}

struct indexed {
	struct building *b;
	int index;
};

/* Two that one crossing starts would leave open which of them acts. */
static void check_alike(void *context)
{
	struct indexed *work = context;
	struct building *b = work->b;
	const struct impact *all = b->model->impact, *impact = &all[work->index];
	mpq_t ratio, rest;
	mpq_inits(ratio, rest, NULL);
	for (int i = 0; i < work->index; i++)
		if (is_along(b, impact->guard, all[i].guard, ratio, rest) && mpq_sgn(rest) == 0)
			error(impact->when->guard->start, "all that jumps there belongs into one 'when', with commas",
			      "another 'when' or stop has this guard already");
	mpq_clears(ratio, rest, NULL);
}

/* Once masses are known: which guards bounce, and how */
void build_impacts(struct building *b)
{
	for (int i = 0; i < b->model->impacts; i++) {
		struct impact *impact = &b->model->impact[i];
		impact->speed = rate_of_form(b, impact->guard);
		if (!impact->when->restitution)
			impact->bounces = find_bounce(b, impact);
		else
			impact->bounces = statement_guard(find_jumps, &(struct collecting){ b, impact->when, impact });
		statement_guard(check_jump, &(struct collecting){ b, impact->when, impact });
		if (impact->bounces)
			still_jumps(b, impact);
	}
	for (int i = 1; i < b->model->impacts; i++)
		statement_guard(check_alike, &(struct indexed){ b, i });
}

/* ---- in regions ---- */

void place_impact_loads(struct building *b, const struct switching *s)
{
	for (int i = 0; i < s->impacts; i++) {
		place_loads(b, s->impact[i].speed);
		for (int k = 0; k < s->impact[i].jumps; k++)
			place_loads(b, s->impact[i].jump[k].form);
	}
}

void build_impact_rows(struct building *b, struct switching *s)
{
	for (int i = 0; i < s->impacts; i++) {
		struct impact *impact = &s->impact[i];
		for (int k = 0; k < impact->jumps; k++)
			impact->jump[k].row = row_of_form(b, impact->jump[k].form);
		for (int k = 0; k < impact->jumps && impact->bounces; k++)
			impact->still[k].row = row_of_form(b, impact->still[k].form);
		if (impact->bounces)
			impact->speed_row = row_of_form(b, impact->speed);
	}
}
