/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The linear equations of a model at a point: at an equilibrium, found by Newton's method from the initial values, or
 * at given states. They are written as a spec of their own, over the deviations from the point, in which matrices stand
 * as exact numbers; whatever is asked of a linear model is then asked of that one.
 *
 * With F(q'', q', q, u, t) = 0 the equations as written, M = dF/dq'', C = dF/dq', K = dF/dq, and the inputs act by
 * -dF/du and -dF/du'. Derivatives are exact forms, evaluated in rationals, functions in 256 bits. What depends on time
 * alone stays a load; what else depends on time is taken at t = 0. */
#define _GNU_SOURCE
#include "capability.h"
#include "checks.h"
#include "linearise.h"

#include <stdlib.h>
#include <string.h>

enum { BITS = 256, SHORT = 24, NAMED = 8 };

/* ---- given values ---- */

static int state_called(const struct model *model, const char *name, size_t length)
{
	for (int i = 0; i < model->system.states; i++)
		if (strlen(model->names.state[i]) == length && strncmp(model->names.state[i], name, length) == 0)
			return i;
	return -1;
}

/* Of NAME=EXPR at `text`: the state that it names; what is no state, or was given, is an error at `place`. */
static int state_given(const struct linearising *l, const char *text, size_t name, struct place place, bool *given)
{
	if (!text[name])
		error(place, NULL, "--at takes rest, or NAME=EXPR with commas between");
	while (name > 0 && text[name - 1] == ' ')
		name--;
	const int state = state_called(l->b->model, text, name);
	if (state < 0)
		error(place, "states are coordinates, and their velocities: --at x=0.1,x'=2",
		      "no state is called '%.*s'", (int)name, text);
	if (given[state])
		error(place, NULL, "%s is given twice", l->b->model->names.state[state]);
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

/* NAME=EXPR,... in `at` */
static void take_values(struct linearising *l, const char *at)
{
	struct source *source = source_argument(at);
	bool *given = ARRAY(bool, (size_t)l->states);
	const char *text = source->text;
	do {
		text += strspn(text, ", ");
		const size_t name = strcspn(text, "="), end = end_of_value(text, name);
		struct place place = { source, (size_t)(text - source->text) };
		mpq_ptr value = l->state[state_given(l, text, name, place, given)];
		struct node *node = parse_argument(l->b->spec, source, place.offset + name + 1, place.offset + end);
		if (!node)
			abandon();
		collect_constant(&l->b->collector, node, value);
		if (beyond_range(value))
			error(place, NULL, "the value is beyond the range of %s", target_name());
		text += end;
	} while (*text);
	find_residuals(l);
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

static const char *number_text(mpq_srcptr q)
{
	const char *exact = exact_text(q);
	if (strlen(exact) <= SHORT)
		return exact;
	REAL value = WITH_BITS(BITS);
	char *text;
	mpfr_set_q(value, q, MPFR_RNDN);
	if (mpfr_asprintf(&text, "%.40Rg", value) < 0)
		give_up("out of memory");
	exact = format("%s", text);
	mpfr_free_str(text);
	return exact;
}

/* 3, (1/3), (-2) */
static const char *factor_text(mpq_srcptr q)
{
	const char *number = number_text(q);
	return strchr(number, '/') || mpq_sgn(q) < 0 ? format("(%s)", number) : number;
}

/* 3*x', - x, behind others + 3*x'; nothing where the factor is 0. `begun`: others stand before it */
static void print_term(FILE *to, mpq_srcptr factor, const char *name, int primes, bool *begun)
{
	const bool negative = mpq_sgn(factor) < 0;
	RATIONAL size = ZERO;
	if (mpq_sgn(factor) == 0)
		return;
	mpq_abs(size, factor);
	fputs(negative ? *begun ? " - " : "-" : *begun ? " + " : "", to);
	if (mpq_cmp_ui(size, 1, 1) != 0)
		fprintf(to, "%s*", factor_text(size));
	fprintf(to, "%s%.*s", name, primes, "''");
	*begun = true;
}

static const char *coordinate_name(const struct linearising *l, int coord)
{
	return plain_name(l->b->model->names.coord[coord]);
}

static void print_declarations(FILE *to, const struct linearising *l)
{
	const struct spec *spec = l->b->spec;
	fprintf(to, "model %s\n", l->b->model->name);
	for (const struct symbol *s = spec->first; s; s = s->next) {
		const char *name = s->name ? plain_name(s->name) : "";
		if (s->kind == SYMBOL_COORD && s->length)
			fprintf(to, "coord %s[%d]\n", name, s->length);
		else if (s->kind == SYMBOL_COORD)
			fprintf(to, "coord %s\n", name);
	}
	static const char *const hold[] = { [0] = "", [1] = " hold first", [3] = " hold third", [5] = " hold fifth",
					    [7] = " hold seventh" };
	for (int i = 0; i < l->inputs; i++)
		fprintf(to, "input %s%s\n", plain_name(l->input[i]->name), hold[l->input[i]->hold]);
}

/* f t^k e^{a t} cos(w t + p), which stands on the left side with the other sign */
static void print_load(FILE *to, const struct form_term *term, bool *begun)
{
	const struct wave *wave = term->basis.wave;
	const char *name = term->basis.power ? format("t^%d", term->basis.power) : "";
	RATIONAL factor = ZERO;
	if (mpq_sgn(wave->a) != 0)
		name = format("%s%sexp(%s*t)", name, *name ? "*" : "", factor_text(wave->a));
	if (oscillates(wave))
		name = format("%s%s%s(%s*t%s)", name, *name ? "*" : "", term->basis.sine ? "sin" : "cos",
			      factor_text(wave->w),
			      mpq_sgn(wave->p) == 0 ? "" : format(" + %s", factor_text(wave->p)));
	mpq_neg(factor, term->factor);
	print_term(to, factor, name, 0, begun);
}

static void print_loads(FILE *to, const struct form *form, bool *begun)
{
	for (int i = 0; i < form->terms; i++)
		if (form->term[i].basis.kind == BASIS_WAVE)
			print_load(to, &form->term[i], begun);
}

/* By all that is fixed but time: [fixing][form] */
static mpq_t **all_slopes(struct linearising *l, int count, const struct form *const *form)
{
	mpq_t **slope = ARRAY(mpq_t *, l->fixings);
	for (int f = 0; f < l->fixings - 1; f++) {
		slope[f] = rationals((size_t)count);
		slopes_at(l, count, form, f, slope[f]);
	}
	return slope;
}

/* Terms of all that is fixed from `first` to `end`, from the last one to the first */
static void print_terms(FILE *to, const struct linearising *l, mpq_t *const *slope, int row, const int *order,
			bool negative, bool *begun)
{
	RATIONAL factor = ZERO;
	for (; *order >= 0; order++) {
		const struct fixing *what = &l->fixing[*order];
		const bool input = what->symbol->kind == SYMBOL_INPUT;
		mpq_set(factor, slope[*order][row]);
		if (negative)
			mpq_neg(factor, factor);
		print_term(to, factor, input ? plain_name(what->symbol->name) : coordinate_name(l, what->coord),
			   what->order, begun);
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
	for (int f = l->states + l->n; f < l->fixings - 1; f++)
		order[count++] = f;
	order[count] = -1;
	return order;
}

static void print_equations(FILE *to, struct linearising *l)
{
	const struct form **form = ARRAY(const struct form *, l->n);
	for (int i = 0; i < l->n; i++)
		form[i] = l->b->whole->residual[i].form;
	mpq_t **slope = all_slopes(l, l->n, form);
	for (int i = 0; i < l->n; i++) {
		bool left = false, right = false;
		print_terms(to, l, slope, i, states_in_order(l), false, &left);
		fputs(left ? " = " : "0 = ", to);
		print_terms(to, l, slope, i, inputs_in_order(l), true, &right);
		print_loads(to, form[i], &right);
		fputs(right ? "\n" : "0\n", to);
	}
}

/* x, q[1]', x'': what needs no expression */
static bool names_itself(const struct model *model, const char *name)
{
	const size_t length = strlen(name);
	if (state_called(model, name, length) >= 0)
		return true;
	for (int i = 0; i < model->n; i++) {
		const size_t own = strlen(model->names.coord[i]);
		if (strncmp(model->names.coord[i], name, own) == 0 && name[own] == '\'' &&
		    strspn(name + own, "'") == length - own)
			return true;
	}
	return false;
}

/* v[1], of a vector that is no coordinate: v_1_ */
static const char *output_name(const char *name)
{
	char *text = format("%s", plain_name(name));
	for (char *c = text; *c; c++)
		*c = *c == '[' || *c == ']' ? '_' : *c;
	return text;
}

/* A peak over time is of no linear model. */
static void print_output(FILE *to, struct linearising *l, const struct output *output)
{
	const struct form *form = output->form ? output->form : output->left;
	bool begun = false;
	if (output->peak || !form)
		return;
	if (names_itself(l->b->model, output->name)) {
		fprintf(to, "output %s\n", plain_name(output->name));
		return;
	}
	mpq_t **slope = all_slopes(l, 1, &form);
	fprintf(to, "output %s = ", output_name(output->name));
	print_terms(to, l, slope, 0, states_in_order(l), false, &begun);
	print_terms(to, l, slope, 0, inputs_in_order(l), false, &begun);
	fputs(begun ? "\n" : "0\n", to);
}

static void print_outputs(FILE *to, struct linearising *l)
{
	const struct model *model = l->b->model;
	for (int i = 0; i < model->outputs && model->declared_outputs; i++)
		print_output(to, l, &model->output[i]);
}

/* The deviations with which the model starts: its initial values less the point */
static void print_initials(FILE *to, const struct linearising *l)
{
	const struct model *model = l->b->model;
	RATIONAL value = ZERO;
	for (int i = 0; i < l->states; i++) {
		mpq_sub(value, model->initial[i], l->state[i]);
		if (mpq_sgn(value) != 0)
			fprintf(to, "init %s = %s\n", plain_name(model->names.state[i]), number_text(value));
	}
}

/* ---- the whole ---- */

/* Without what depends on time alone, which no equilibrium is sought for */
static const struct form *without_loads(const struct form *form)
{
	struct form *kept = NEW(struct form);
	for (int i = 0; i < form->terms; i++)
		if (form->term[i].basis.kind != BASIS_WAVE)
			form_add_basis(kept, form->term[i].basis, form->term[i].factor);
	return kept;
}

static void list_inputs(struct linearising *l)
{
	l->inputs = l->b->spec->count.inputs;
	l->input = ARRAY(const struct symbol *, l->inputs);
	for (const struct symbol *s = l->b->spec->first; s; s = s->next)
		if (s->kind == SYMBOL_INPUT)
			l->input[s->index] = s;
}

static void say_point(const struct linearising *l, bool rest)
{
	const char *list = "";
	const struct model *model = l->b->model;
	const int states = rest ? l->n : l->states;
	for (int i = 0; i < states && i < NAMED; i++)
		list = format("%s%s%s = %s", list, i ? ", " : "", model->names.state[i],
			      format("%.6g", mpq_get_d(l->state[i])));
	if (states > NAMED)
		list = format("%s and %d more", list, states - NAMED);
	const bool varies = l->varies || loads_change(&model->system);
	say_note(l->b->spec->name_at, "linearised at %s%s%s%s%s", rest ? "rest: " : "", list,
		 rest || is_equilibrium(l) ? "" : "; the motion does not stay there, and its constant acceleration is "
						  "left out",
		 varies ? "; what depends on time is as at t = 0" : "",
		 model->switching ? "; --amplitude A sweeps through all regions" : "");
}

static void check_contacts(const struct building *b)
{
	const struct facts facts = facts_of_model(b->model);
	if (facts.contacts)
		error(b->spec->name_at, "plrun runs any model, also with a record that sweeps",
		      "friction, impacts and jumps have no linear equations");
	if (facts.delays)
		error(b->spec->name_at, NULL, "delayed inputs have no linear equations without delay");
}

void linearise(void *building)
{
	struct building *b = building;
	struct model *model = b->model;
	const bool rest = strcmp(b->request->linearise, "rest") == 0;
	struct linearising l = { .b = b, .n = model->n, .states = model->system.states, .fall = 1e-4 };
	size_t length;
	char *text;
	check_contacts(b);
	list_inputs(&l);
	if (!b->whole)
		collect_whole(b);
	if (diagnostics_errors())
		abandon();
	list_fixings(&l);
	l.state = rationals((size_t)l.states);
	l.F = rationals((size_t)l.n);
	l.residual = ARRAY(const struct form *, l.n);
	for (int i = 0; i < l.states; i++)
		mpq_set(l.state[i], model->initial[i]);
	for (int i = 0; i < l.n; i++)
		l.residual[i] = without_loads(b->whole->residual[i].form);
	if (rest)
		find_equilibrium(&l);
	else
		take_values(&l, b->request->linearise);
	find_highest(&l);
	check_kinks(&l);
	l.looks = true;
	FILE *to = need_memory(open_memstream(&text, &length));
	print_declarations(to, &l);
	print_initials(to, &l);
	print_equations(to, &l);
	print_outputs(to, &l);
	if (mpq_sgn(model->h) > 0)
		fprintf(to, "step %s\n", number_text(model->h));
	fclose(to);
	model->equations.linearised = format("%s", text);
	free(text);
	say_point(&l, rest);
}
