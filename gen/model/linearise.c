/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The linear equations of a model at a point: at an equilibrium, found by Newton's method from the initial values, or
 * at given states. They are written as a spec of their own, over the deviations from the point, in which matrices stand
 * as exact numbers; whatever is asked of a linear model is then asked of that one.
 *
 * With F(q'', q', q, u, t) = 0 the equations as written, M = dF/dq'', C = dF/dq', K = dF/dq, and the inputs act by
 * -dF/du and -dF/du'. Derivatives are exact forms, evaluated in rationals, functions in 256 bits. What depends on time
 * alone stays a load; what else depends on time is taken at t, 0 unless another time was asked for. */
#define _GNU_SOURCE
#include "capability.h"
#include "checks.h"
#include "linearise.h"
#include "reads.h"
#include "state_mass.h"
#include "model/contacts/friction.h"
#include "model/regions/switching_functions.h"
#include "model/regions/regions.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BITS = 256, SHORT = 24, NAMED = 8 };

/* ---- given values ---- */

/* Of NAME=EXPR at `text`: the place that it names, behind the states t; what is no state, or was given, is an error. */
static int state_given(const struct linearising *l, const char *text, size_t name, struct place place, bool *given)
{
	if (!text[name])
		error(place, NULL, "--at takes rest, or NAME=EXPR with commas between");
	while (name > 0 && text[name - 1] == ' ')
		name--;
	const bool time = name == 1 && *text == 't';
	const int state = time ? l->states : place_among(l->states, l->b->model->names.state, text, name);
	if (state < 0)
		error(place, "states are coordinates, and their velocities: --at x=0.1,x'=2",
		      "no state is called '%.*s'", (int)name, text);
	if (given[state])
		error(place, NULL, "%s is given twice", time ? "t" : l->b->model->names.state[state]);
	given[state] = true;
	return state;
}

/* Up to the comma that no bracket holds */
static size_t end_of_value(const char *text, size_t end)
{
	for (int depth = 0; text[end] && (text[end] != ',' || depth > 0); end++)
		depth += text[end] == '(' ? 1 : text[end] == ')' ? -1 : 0;
	return end;
}

static mpq_ptr time_of(const struct linearising *l)
{
	return l->fixing[l->fixings - 1].value;
}

/* Onto the constraints: what was not given first. What was given and is moved all the same is warned of. */
static void meet_constraints_at(struct linearising *l, const struct source *source, const bool *given)
{
	mpq_t *before = rationals_copied((size_t)l->states, (const mpq_t *)l->state);
	meet_constraints_near(l->b, l->state, given, l->timed ? time_of(l) : NULL);
	for (int i = 0; i < l->states; i++) {
		const double from = mpq_get_d(before[i]), to = mpq_get_d(l->state[i]);
		if (given[i] && fabs(to - from) > 1e-9 * fmax(1, fabs(from)))
			say_warning((struct place){ source, 0 }, NULL,
				    "no state near these values meets the constraints: %s moved from %.6g to %.6g",
				    l->b->model->names.state[i], from, to);
	}
}

/* NAME=EXPR,... in `at`; returns how many */
static int take_values(struct linearising *l, const char *at)
{
	struct source *source = source_argument(at);
	bool *given = ARRAY(bool, (size_t)l->states + 1);
	const char *text = source->text;
	int count = 0;
	do {
		text += strspn(text, ", ");
		const size_t name = strcspn(text, "="), end = end_of_value(text, name);
		struct place place = { source, (size_t)(text - source->text) };
		const int state = state_given(l, text, name, place, given);
		mpq_ptr value = state < l->states ? l->state[state] : time_of(l);
		struct node *node = parse_argument(l->b->spec, source, place.offset + name + 1, place.offset + end);
		if (!node)
			abandon();
		check_unit(l, node, state);
		collect_constant(&l->b->collector, node, value);
		if (beyond_range(value))
			error(place, NULL, "the value is beyond the range of %s", target_name());
		if (state == l->states && mpq_sgn(value) < 0)
			error(place, NULL, "a motion begins at t = 0");
		text += end;
		count++;
	} while (*text);
	l->timed = given[l->states];
	l->fixing[l->fixings - 1].form = form_constant(time_of(l));
	if (l->held > 0 && !(l->timed && count == 1))
		meet_constraints_at(l, source, given);
	return count;
}

/* ---- the spec ---- */

/* front.wheel: front_wheel */
static const char *plain_name(const char *name)
{
	char *text = format("%s", name);
	for (char *c = text; *c; c++)
		*c = *c == '.' ? '_' : *c;
	return text;
}

/* v[1], of a vector that is no coordinate, momentum(x), x'': v_1_, momentum_x_, x_dot_dot */
static const char *output_name(const char *name)
{
	const size_t length = strcspn(name, "'");
	const char *dots = name[length] == '\0' ? "" : name[length + 1] ? "_dot_dot" : "_dot";
	char *text = format("%.*s%s", (int)length, plain_name(name), dots);
	for (char *c = text; *c; c++)
		*c = strchr("[]()", *c) ? '_' : *c;
	return text;
}

static const char *decimal_text(mpq_srcptr q, int digits)
{
	const char *exact = exact_text(q);
	if (strlen(exact) <= SHORT)
		return exact;
	REAL value = WITH_BITS(2 * BITS);
	char *text;
	mpfr_set_q(value, q, MPFR_RNDN);
	if (mpfr_asprintf(&text, "%.*Rg", digits, value) < 0)
		give_up("out of memory");
	exact = format("%s", text);
	mpfr_free_str(text);
	return exact;
}

static const char *number_text(mpq_srcptr q)
{
	return decimal_text(q, 40);
}

/* 3, (1/3), (-2) */
static const char *factor_text(mpq_srcptr q)
{
	const char *number = number_text(q);
	return strchr(number, '/') || mpq_sgn(q) < 0 ? format("(%s)", number) : number;
}

/* 3*x', - x, behind others + 3*x'; nothing where the factor is 0. `begun`: others stand before it */
static void print_term(FILE *to, mpq_srcptr factor, const char *name, bool *begun)
{
	const bool negative = mpq_sgn(factor) < 0;
	RATIONAL size = ZERO;
	if (mpq_sgn(factor) == 0)
		return;
	mpq_abs(size, factor);
	fputs(negative ? *begun ? " - " : "-" : *begun ? " + " : "", to);
	if (mpq_cmp_ui(size, 1, 1) != 0)
		fprintf(to, "%s*", factor_text(size));
	fputs(name, to);
	*begun = true;
}

static bool is_dependent(const struct linearising *l, int coord)
{
	return l->tangent && l->tangent->follows[0][coord].slope;
}

/* Whether components of the vector are coordinates of their own, since others depend on them */
static bool is_divided(const struct linearising *l, const struct symbol *s)
{
	bool divided = false;
	for (int i = 0; i < s->length; i++)
		divided = divided || is_dependent(l, s->index + i);
	return divided;
}

/* Of an independent one: q[1], q_1_ of a vector that is divided */
static const char *coordinate_name(const struct linearising *l, int coord)
{
	const char *name = l->b->model->names.coord[coord];
	return is_divided(l, l->b->model->frame.coord[coord]) ? output_name(name) : plain_name(name);
}

/* x'', u', u(t - 0.1): of a coordinate or an input */
static const char *name_of_fixing(const struct linearising *l, const struct fixing *what)
{
	const struct symbol *s = what->symbol;
	const struct delays *delays = l->b->model->delays;
	const bool input = s->kind == SYMBOL_INPUT;
	const char *name = input ? plain_name(s->delayed ? s->delayed->name : s->name)
				 : coordinate_name(l, what->coord);
	name = format("%s%.*s", name, what->order, "''");
	if (!input || !s->delayed)
		return name;
	RATIONAL delay = ZERO;
	mpq_set_si(delay, delays->delay[s->index - delays->inputs].back, 1);
	mpq_mul(delay, delay, l->b->model->h);
	return format("%s(t - %s)", name, number_text(delay));
}

static void print_declarations(FILE *to, const struct linearising *l)
{
	const struct spec *spec = l->b->spec;
	const struct delays *delays = l->b->model->delays;
	fprintf(to, "model %s\n", delays ? delays->name : l->b->model->name);
	for (const struct symbol *s = spec->first; s; s = s->next) {
		if (s->kind != SYMBOL_COORD)
			continue;
		if (s->length && !is_divided(l, s))
			fprintf(to, "coord %s[%d]\n", plain_name(s->name), s->length);
		for (int i = s->index; i < s->index + (!s->length ? 1 : is_divided(l, s) ? s->length : 0); i++)
			if (!is_dependent(l, i))
				fprintf(to, "coord %s\n", coordinate_name(l, i));
	}
	static const char *const hold[] = { [0] = "", [1] = " hold first", [3] = " hold third", [5] = " hold fifth",
					    [7] = " hold seventh" };
	for (int i = 0; i < (delays ? delays->inputs : l->inputs); i++)
		fprintf(to, "input %s%s\n", plain_name(l->input[i]->name), hold[l->input[i]->hold]);
}

/* f t^k e^{a t} cos(w t + p), which stands on the left side with the other sign */
static void print_load(FILE *to, const struct form_term *term, bool *begun)
{
	const struct forcing *forcing = term->basis.forcing;
	const char *name = term->basis.power ? format("t^%d", term->basis.power) : "";
	RATIONAL factor = ZERO;
	if (mpq_sgn(forcing->a) != 0)
		name = format("%s%sexp(%s*t)", name, *name ? "*" : "", factor_text(forcing->a));
	if (oscillates(forcing))
		name = format("%s%s%s(%s*t%s)", name, *name ? "*" : "", term->basis.sine ? "sin" : "cos",
			      factor_text(forcing->w),
			      mpq_sgn(forcing->p) == 0 ? "" : format(" + %s", factor_text(forcing->p)));
	mpq_neg(factor, term->factor);
	print_term(to, factor, name, begun);
}

static void print_loads(FILE *to, const struct form *form, bool *begun)
{
	for (int i = 0; i < form->terms; i++)
		print_load(to, &form->term[i], begun);
}

static void print_terms(FILE *to, const struct linearising *l, const struct tangent_row *row, const int *order,
			bool negative, bool *begun)
{
	RATIONAL factor = ZERO;
	for (; *order >= 0; order++) {
		(negative ? mpq_neg : mpq_set)(factor, row->slope[*order]);
		print_term(to, factor, name_of_fixing(l, &l->fixing[*order]), begun);
	}
}

/* Highest derivatives, then velocities, then coordinates */
static const int *states_in_order(const struct linearising *l)
{
	int *order = ARRAY(int, l->states + l->n + 1), count = 0;
	for (int f = l->states; f < l->states + l->n; f++)
		order[count++] = f;
	for (int f = l->n; f < l->states; f++)
		order[count++] = f;
	for (int f = 0; f < l->n; f++)
		order[count++] = f;
	order[count] = -1;
	return order;
}

static const int *inputs_in_order(const struct linearising *l)
{
	int *order = ARRAY(int, 2 * l->inputs + 1), count = 0;
	for (int f = l->states + l->rows; f < l->fixings - 1; f++)
		order[count++] = f;
	order[count] = -1;
	return order;
}

static void print_equation(FILE *to, const struct linearising *l, const struct tangent_row *row)
{
	bool left = false, right = false;
	print_terms(to, l, row, states_in_order(l), false, &left);
	fputs(left ? " = " : "0 = ", to);
	print_terms(to, l, row, inputs_in_order(l), true, &right);
	print_loads(to, row->load, &right);
	fputs(right ? "\n" : "0\n", to);
}

/* v' - what it follows from = 0: of a coordinate that a constraint on velocities leaves */
static void print_velocity(FILE *to, const struct linearising *l, int coord)
{
	RATIONAL minus = RATIO(-1, 1);
	struct tangent_row *follows = &l->tangent->follows[1][coord];
	for (int f = 0; f < l->fixings; f++)
		mpq_neg(follows->slope[f], follows->slope[f]);
	follows->load = form_scale(follows->load, minus);
	mpq_set_ui(follows->slope[l->b->model->system.velocity[coord]], 1, 1);
	print_equation(to, l, follows);
}

static void print_equations(FILE *to, struct linearising *l)
{
	const struct tangent_row *row = l->tangent ? l->tangent->row : rows_at(l, l->n, NULL);
	for (int i = 0; i < l->n; i++)
		if (row[i].slope)
			print_equation(to, l, &row[i]);
	for (int j = 0; j < l->n && l->tangent; j++)
		if (l->tangent->follows[1][j].slope && !l->tangent->follows[0][j].slope)
			print_velocity(to, l, j);
}

/* x, q[1]', x'': what needs no expression, as the spec has it; NULL: it needs one */
static const char *name_of_itself(const struct linearising *l, const char *name)
{
	const struct model *model = l->b->model;
	for (int i = 0; i < model->n; i++) {
		const size_t own = strlen(model->names.coord[i]);
		if (strncmp(model->names.coord[i], name, own) != 0)
			continue;
		const char *behind = name + own;
		const size_t primes = strspn(behind, "'");
		if (primes == strlen(behind) && !(l->tangent && l->tangent->follows[primes < 2 ? primes : 2][i].slope))
			return format("%s%s", coordinate_name(l, i), behind);
	}
	return NULL;
}

static void print_output_of(FILE *to, struct linearising *l, const char *name, const struct form *form)
{
	bool begun = false;
	RATIONAL minus = RATIO(-1, 1);
	struct tangent_row *row = rows_at(l, 1, &form);
	put_dependent(l, l->tangent, row);
	fprintf(to, "output %s = ", output_name(name));
	print_terms(to, l, row, states_in_order(l), false, &begun);
	print_terms(to, l, row, inputs_in_order(l), false, &begun);
	print_loads(to, form_scale(row->load, minus), &begun);
	fputs(begun ? "\n" : "0\n", to);
}

/* With multipliers as unknowns of the equations, like highest derivatives */
static const struct form *form_of_output(const struct linearising *l, const struct output *output)
{
	struct collector *c = &l->b->collector;
	if (!output->value || !l->tangent)
		return output->form ? output->form : output->left;
	c->whole_time = c->output = c->reading = true;
	forget_lets(l->b->spec);
	const struct form *form = collect(c, output->value)->cell[output->cell];
	c->whole_time = c->output = c->reading = false;
	return form;
}

/* A peak over time is of no linear model. */
static void print_output(FILE *to, struct linearising *l, const struct output *output)
{
	if (output->peak || !(output->value || output->form || output->left))
		return;
	const char *own = name_of_itself(l, output->name);
	if (own) {
		const bool scaled = output->unit && !is_coherent(output->unit);
		fprintf(to, "output %s%s\n", own,
			scaled ? format(" \"%s\"", output->unit->text) : "");
		return;
	}
	print_output_of(to, l, output->name, form_of_output(l, output));
}

static void print_outputs(FILE *to, struct linearising *l)
{
	const struct model *model = l->b->model;
	for (int i = 0; i < model->outputs && model->declared_outputs; i++)
		print_output(to, l, &model->output[i]);
	for (int i = 0; i < l->states && l->tangent && !model->declared_outputs; i++)
		print_output(to, l, &(struct output){ .name = model->names.state[i], .form =
			     coordinate_form(&model->frame, model->system.coord[i], i >= l->n) });
}

/* The deviations with which the model starts: its initial values less the point */
static void print_initials(FILE *to, const struct linearising *l)
{
	const struct model *model = l->b->model;
	RATIONAL value = ZERO;
	for (int i = 0; i < l->states; i++) {
		const int coord = model->system.coord[i];
		mpq_sub(value, model->initial[i], l->state[i]);
		if (mpq_sgn(value) != 0 && !(l->tangent && l->tangent->follows[i >= l->n][coord].slope))
			fprintf(to, "init %s%s = %s\n", coordinate_name(l, coord), i >= l->n ? "'" : "",
				number_text(value));
	}
}

static void list_inputs(struct linearising *l)
{
	l->inputs = l->b->spec->count.inputs;
	l->input = ARRAY(const struct symbol *, l->inputs);
	for (const struct symbol *s = l->b->spec->first; s; s = s->next)
		if (s->kind == SYMBOL_INPUT)
			l->input[s->index] = s;
}

static int segment_at(const struct linearising *l)
{
	const struct linear *system = &l->b->model->system;
	int segment = 0;
	while (segment < system->segments - 1 && mpq_cmp(system->change[segment], time_of(l)) < 0)
		segment++;
	return segment;
}

/* 0 < x - y < 0.1: between which of its breakpoints it is there; *interval counts them from below */
static const char *side_text(struct linearising *l, const struct switching_function *e, struct point *point,
			     int *interval)
{
	const struct form *form = form_in(e, e->segments > 1 ? segment_at(l) : 0);
	RATIONAL value = ZERO;
	int k = 0;
	value_at(l, point, l->timed ? form : terms_of_kinds(form, ~(1u << BASIS_FORCING)), value);
	while (k < e->breaks && mpq_cmp(e->at[k], value) < 0)
		k++;
	*interval = k;
	return format("%s%s%s", k > 0 ? format("%s < ", readable_text(e->at[k - 1])) : "",
		      form_text(l->b->model, form), k < e->breaks ? format(" < %s", readable_text(e->at[k])) : "");
}

/* ; in region 1, where 0 < x - y */
static const char *region_text(struct linearising *l)
{
	const struct switching *s = l->b->model->switching;
	const char *list = "";
	int region = 0, interval;
	if (!s || s->functions == 0)
		return "";
	struct point *point = point_of(l);
	for (int i = 0; i < s->functions; i++) {
		const char *side = side_text(l, &s->function[i], point, &interval);
		region += interval * s->function[i].stride;
		if (i < NAMED)
			list = format("%s%s%s", list, i ? ", " : "", side);
	}
	if (s->functions > NAMED)
		list = format("%s and %d more inequalities", list, s->functions - NAMED);
	return format("; in region %d, where %s", region, list);
}

/* ; loads are as there: cos(5*t) = 0.28: their functions of time, in the equations */
static const char *loads_text(struct linearising *l)
{
	const char *list = "";
	RATIONAL value = ZERO;
	struct point *point = point_of(l);
	struct form *all = NEW(struct form), *one;
	for (int i = 0; i < l->rows; i++)
		for (int k = 0; k < l->residual[i]->terms; k++)
			if (l->residual[i]->term[k].basis.kind == BASIS_FORCING &&
			    !form_find(all, &l->residual[i]->term[k].basis))
				all = form_sum(all, form_unit(l->residual[i]->term[k].basis), false);
	for (int k = 0; k < all->terms && k < NAMED; k++) {
		one = form_unit(all->term[k].basis);
		value_at(l, point, one, value);
		list = format("%s%s%s = %.6g", list, *list ? ", " : "; loads are as there: ",
			      form_text(l->b->model, one), mpq_get_d(value));
	}
	return all->terms > NAMED ? format("%s and %d more", list, all->terms - NAMED) : list;
}

/* rest: x = 0.1; t = 3 of the motion from the initial values, by scheme taylor: x = 0.1, x' = 2 */
static const char *point_text(struct linearising *l)
{
	const struct model *model = l->b->model;
	const char *list = l->rest ? "rest: " : "", *moved = l->b->request->linear.moved_by;
	const int states = l->rest ? l->n : l->states;
	if (l->timed)
		list = format("t = %.6g%s", mpq_get_d(time_of(l)),
			      moved ? format(" of the motion from the initial values, %s: ", moved) : ", ");
	for (int i = 0; i < states && i < NAMED; i++)
		list = format("%s%s%s = %s", list, i ? ", " : "", model->names.state[i],
			      format("%.6g", mpq_get_d(l->state[i])));
	if (states > NAMED)
		list = format("%s and %d more", list, states - NAMED);
	return format("%s%s%s", list, region_text(l), l->timed ? loads_text(l) : "");
}

static void say_point(struct linearising *l)
{
	const struct model *model = l->b->model;
	const bool varies = !l->timed && (l->varies || loads_change(&model->system));
	say_note(l->b->spec->name_at, "linearised at %s%s%s%s", model->equations.point,
		 l->rest || l->stays ? ""
		 : l->timed ? "; coefficients are those of that time"
			    : "; the motion does not stay there, and its constant acceleration is left out",
		 varies ? "; what depends on time is as at t = 0" : "",
		 model->switching ? "; --amplitude A sweeps through all regions" : "");
}

static void check_contacts(const struct building *b)
{
	const struct facts facts = facts_of_model(b->model);
	if (facts.contacts || holds_friction(b))
		error(b->spec->name_at, "plrun runs any model, also with a record that sweeps",
		      "friction, impacts and jumps have no linear equations");
}

/* The point and what F is of; false: the states there are those of a motion that has to be run first */
static bool find_point(struct linearising *l)
{
	struct model *model = l->b->model;
	const char *place = l->b->request->linear.where;
	l->rest = strcmp(place, "rest") == 0 || strcmp(place, EQUILIBRIA) == 0;
	for (int i = 0; i < l->states; i++)
		mpq_set(l->state[i], model->initial[i]);
	const int given = l->rest ? 0 : take_values(l, place);
	list_residuals(l);
	if (l->timed && given == 1) {
		model->equations.motion_end = time_of(l);
		return false;
	}
	if (l->rest)
		(strcmp(place, EQUILIBRIA) == 0 ? find_equilibria : find_equilibrium)(l);
	return true;
}

static void print_spec(FILE *to, struct linearising *l)
{
	const struct model *model = l->b->model;
	print_declarations(to, l);
	if (!l->timed)
		print_initials(to, l);
	print_equations(to, l);
	print_outputs(to, l);
	if (mpq_sgn(model->h) > 0)
		fprintf(to, "step %s\n", number_text(model->delays ? model->delays->h : model->h));
}

static void spell_places(const struct linearising *l)
{
	const struct equations *e = &l->b->model->equations;
	for (int k = 0; k < e->equilibria; k++) {
		const char *text = "";
		for (int i = 0; i < l->states; i++)
			text = format("%s%s%s=%s", text, i ? "," : "", l->b->model->names.state[i],
				      i < l->n ? decimal_text(e->equilibrium[k].state[i], 80) : "0");
		e->equilibrium[k].place = text;
	}
}

static struct linearising linearising_of(struct building *b)
{
	const int held = b->spec->count.multipliers;
	struct linearising l = { .b = b, .n = b->model->n, .states = b->model->system.states, .held = held,
				 .rows = b->model->n + held, .fall = 1e-4 };
	list_inputs(&l);
	if (!b->full)
		collect_full(b);
	if (diagnostics_errors())
		abandon();
	b->collector.equation = true;           /* highest derivatives have factors in rows as written */
	b->collector.keep = KEEP_ALL;
	list_fixings(&l);
	l.state = rationals((size_t)l.states);
	l.F = rationals((size_t)l.rows);
	return l;
}

void find_symmetries(void *building)
{
	struct collector *c = &((struct building *)building)->collector, kept = *c;
	struct linearising l = linearising_of(building);
	list_residuals(&l);
	find_free_directions(&l);
	c->equation = kept.equation;
	c->keep = kept.keep;
}

void linearise(void *building)
{
	struct building *b = building;
	struct model *model = b->model;
	size_t length;
	char *text;
	check_contacts(b);
	struct linearising l = linearising_of(b);
	if (!find_point(&l))
		return;
	spell_places(&l);
	if (strcmp(b->request->linear.where, EQUILIBRIA) == 0)
		return;
	find_highest(&l);
	check_kinks(&l);
	look_for_time(&l);
	l.tangent = tangent_of(&l);
	FILE *to = need_memory(open_memstream(&text, &length));
	print_spec(to, &l);
	fclose(to);
	model->equations.linearised = format("%s", text);
	model->equations.point = point_text(&l);
	free(text);
	say_point(&l);
}
