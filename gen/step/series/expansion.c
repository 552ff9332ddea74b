/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The solution as a Taylor series: a sequence of coefficients for each state, which of them there are, and which are
 * read. */
#include "inner.h"
#include "model/checks.h"
#include "model/contacts/contacts.h"
#include "model/reads.h"
#include "step/contacts/series_contacts.h"
#include "step/cost.h"
#include "step/exponential/recipe.h"

/* ---- the states ---- */

static void expand_state(struct sequencing *w, int state)
{
	RATIONALS *scale = integral_scale(w, true);
	struct sum sum = held_slope(w, state);  /* makes sequences: the array may move */
	sum_numbers(w, &w->x->sequence[state], &sum, scale);
	if (loads_change(w->system) && !is_bare(w, state))
		add_changing_loads(w, &w->x->sequence[state], state, scale);
}

/* ---- which coefficients there are, and are read ---- */

static bool raise(struct expansion *x, int sequence, int top)
{
	struct sequence *s = sequence == NONE ? NULL : &x->sequence[sequence];
	top = top > x->order ? x->order : top;
	if (!s || top <= s->top)
		return false;
	s->top = top;
	return true;
}

/* What a sequence reads up to its top */
static bool raise_operands(struct expansion *x, const struct sequence *s)
{
	SCRATCH int *operand = NULL;
	bool integral = s->kind == SEQUENCE_INTEGRAL, changed = false;
	int top = s->top - integral + (s->kind == SEQUENCE_RATE);
	if (s->top < 0)
		return false;
	for (int i = sequence_operands(s, &operand) - 1; i >= 0; i--)
		changed |= raise(x, operand[i], top);
	if (integral)
		changed |= raise(x, s->a, 0) | raise(x, s->b, 0);
	if (s->kind == SEQUENCE_CHOICE && s->choice == CHOICE_BY_SEQUENCE)
		changed |= raise(x, s->test, 0);
	for (int i = 0; s->equations && i < s->equations->n * (s->equations->n + 1); i++)
		changed |= raise(x, i < s->equations->n ? s->equations->right[i]
							: s->equations->matrix[i - s->equations->n], 0);
	return changed;
}

static void find_tops(struct expansion *x, int states)
{
	for (int i = 0; i < x->count; i++)
		x->sequence[i].top = -1;
	for (int i = 0; i < states; i++)
		x->sequence[i].top = x->order;
	for (int i = 0; i < x->columns; i++)
		raise(x, x->column[i], x->column_top[i]);
	for (bool changed = true; changed;) {
		changed = false;
		for (int i = x->count - 1; i >= 0; i--) /* most operands precede what is made of them */
			changed |= raise_operands(x, &x->sequence[i]);
	}
}

/* ---- from where on coefficients are 0 ---- */

static int last_factor(const struct sequence_term *t, int last)
{
	while (last >= 0 && t->factor && t->factor[last] == 0)
		last--;
	return last;
}

/* Of the sum that it is, or that its derivative is; -1: of no terms */
static int degree_of_sum(const struct expansion *x, const int *degree, const struct sequence *s)
{
	int most = -1;
	for (int i = 0; i < s->terms; i++) {
		const struct sequence_term *t = &s->term[i];
		bool pair = t->kind == TERM_PRODUCT, made = pair || t->kind == TERM_SEQUENCE;
		int last = made ? degree[t->a] + (pair ? degree[t->b] : 0) : x->order;
		last = last_factor(t, last > x->order ? x->order : last);
		most = last > most ? last : most;
	}
	return most;
}

static bool varies(const int *degree, int sequence)
{
	return sequence != NONE && degree[sequence] > 0;
}

static int degree_of_solution(const struct expansion *x, const int *degree, const struct linear_equations *e)
{
	bool any = false;
	for (int i = 0; i < e->n * (e->n + 1); i++)
		any = any || varies(degree, i < e->n ? e->right[i] : e->matrix[i - e->n]);
	return any ? x->order : 0;
}

/* Of the last that is not 0 for all states and times, as far as its recurrence tells */
static int degree_of(const struct expansion *x, const int *degree, const struct sequence *s)
{
	const bool a = varies(degree, s->a), b = varies(degree, s->b);
	switch (s->kind) {
	case SEQUENCE_SUM:      return degree_of_sum(x, degree, s);
	case SEQUENCE_INTEGRAL: return s->state != NONE || a || b ? 1 + degree_of_sum(x, degree, s) : 0;
	case SEQUENCE_QUOTIENT: return b ? x->order : a ? degree[s->a] : 0;
	case SEQUENCE_ROOT:
	case SEQUENCE_POWER:    return a ? x->order : 0;
	case SEQUENCE_RATE:     return degree[s->a] - 1;
	case SEQUENCE_SOLUTION: return degree_of_solution(x, degree, s->equations);
	default:                return b && !(a && degree[s->a] > degree[s->b]) ? degree[s->b] : a ? degree[s->a] : 0;
	}
}

static void lower_tops(struct expansion *x)
{
	SCRATCH int *degree = ARRAY(int, x->count);
	for (bool changed = true; changed;) {
		changed = false;
		for (int i = 0; i < x->count; i++) {
			int now = degree_of(x, degree, &x->sequence[i]);
			now = now > x->order ? x->order : now;
			changed = changed || now > degree[i];
			degree[i] = now > degree[i] ? now : degree[i];
		}
	}
	for (int i = 0; i < x->count; i++)
		x->sequence[i].top = x->sequence[i].top < degree[i] ? x->sequence[i].top : degree[i];
}

/* What precedes the loop, and the loop */
void set_lines(struct recurrences *r, const struct expansion *x)
{
	const struct lines *l = x->lines;
	struct tape *t = tape_of_recurrences(r);
	for (int i = 0; i < x->count; i++)
		for (int k = 0; k < l->first + l->offset[i] && l->row[i] != NONE; k++)
			recurrence_set(r, line_place(l, i, format("%d", k)), i, k);
	tape_statement(t, format("for (k_by_0 = %d; k_by_0 <= %d; k_by_0++) {", l->first, l->last));
	recurrences_begin_turn(r);
	for (int i = 0; i < x->count; i++)
		if (l->row[i] != NONE)
			recurrence_set(r, line_place(l, i, stage_index(l->offset[i])), i, STAGE + l->offset[i]);
	tape_statement(t, "}");
}

static void set_series(struct recurrences *r, const struct expansion *x, int states)
{
	if (x->lines)
		set_lines(r, x);
	for (int i = 0; i < states && !x->lines; i++)
		for (int k = 0; k <= x->order; k++)
			recurrence_set(r, "", i, k);
	for (int i = 0; i < x->columns && !x->lines; i++)
		for (int k = 0; k <= x->column_top[i]; k++)
			recurrence_set(r, "", x->column[i], k);
}

/* Of what is kept: its tape says so. */
static void read_off(const struct step *step, struct expansion *x)
{
	const struct linear *system = &step->branch->system;
	struct recurrences *r = recurrences_new(step, x, (struct series_names){ .looped = true });
	struct tape *t = tape_of_recurrences(r);
	set_series(r, x, x->alone ? 0 : system->states);
	const char *broken = tape_check(t);
	if (broken)
		internal_error(step, broken);
	x->time = tape_reads(t, TAPE_TIME, -1, 0);
	x->choices = tape_reads(t, TAPE_TIME, -1, 1);
	x->slots = tape_reads(t, TAPE_TABLE, -1, -1) ? x->slots : 0;
	x->load = ARRAY(bool, system->loads);
	for (int l = 0; l < system->loads; l++)
		x->load[l] = tape_reads(t, TAPE_LOAD, l, -1);
	x->input = ARRAY(bool, system->inputs);
	x->slope = ARRAY(bool, system->inputs);
	tape_mark(t, TAPE_INPUT, 0, x->input);
	tape_mark(t, TAPE_INPUT, 1, x->slope);
}

static void find_extent(const struct step *step, struct expansion *x)
{
	const int states = x->alone ? 0 : step->branch->system.states;
	find_tops(x, states);
	lower_tops(x);
	if (!x->alone && multiplications_of_series(x) > LOOPED_SERIES)
		x->lines = lines_of(x, states);
	read_off(step, x);
}

/* ---- the whole ---- */

/* Their arguments, and behind these columns what bounds a series but is no part of its error */
static void place_unresolved(struct sequencing *w)
{
	struct expansion *x = w->x;
	x->measured = x->columns;
	for (int i = 0; i < x->unresolved_functions; i++) {
		int sequence = sequence_of_form(w, x->unresolved[i].form);
		x->unresolved[i].column = column_of_sequence(x, sequence, order_of_form(w, x->unresolved[i].form));
	}
}

static struct layout place_all(struct sequencing *w)
{
	struct reads reads = { 0 };
	const struct model *model = w->step->model;
	reads = reads_of(model, model->remainder.force_columns,
			 (const struct form *const *)model->schedule.operator[0].left);
	bool *needed = ARRAY(bool, w->system->loads);
	for (int l = 0; l < w->system->loads; l++)
		needed[l] = has_contacts(model) || reads.load[l] || load_acts(w->system, &w->system->load[l]);
	return layout_with(w->system, 1, needed);
}

static void start_states(struct sequencing *w)
{
	for (int i = 0; i < w->system->states; i++)
		new_sequence(w, (struct sequence){ .kind = SEQUENCE_INTEGRAL, .state = i, .a = NONE, .b = NONE });
}

static void make_forces(struct sequencing *w)
{
	const struct model *model = w->step->model;
	int *force = ARRAY(int, model->remainder.force_columns), *held = ARRAY(int, model->remainder.force_columns);
	for (int e = 0; e < model->remainder.force_columns; e++) {
		const int solved = solved_force(w, e);
		force[e] = solved != NONE ? solved : sequence_of_form(w, model->schedule.operator[0].left[e]);
	}
	w->x->force = force;
	for (int e = 0; e < model->remainder.force_columns; e++)
		held[e] = held_force(w, e);
	w->x->held = held;
}

/* How often each atom is read */
static void count_uses(struct sequencing *w, const struct form *form)
{
	for (int i = 0; i < form->terms; i++) {
		const struct atom *atom = form->term[i].basis.atom;
		if (!atom || w->uses[atom->index]++ > 0)
			continue;
		for (int k = 0; k < atom->operands; k++)
			count_uses(w, atom->operand[k]);
		for (int k = 0; atom->written && k < atom->written->rows; k++)
			count_uses(w, atom->written->residual[k]);
	}
}

static struct expansion *expand(const struct step *step, int order, bool with_forces)
{
	const struct linear *system = &step->branch->system;
	const struct model *model = step->model;
	int atoms = atoms_count(model->equations.atoms);
	struct sequencing work = { .step = step, .system = system, .x = NEW(struct expansion) }, *w = &work;
	w->x->order = order;
	w->uses = ARRAY(int, atoms);
	w->atom = ARRAY(int, atoms);
	for (int i = 0; i < atoms; i++)
		w->atom[i] = NONE;
	mpq_init(w->pi);
	constant_pi(w->pi);
	mpq_init(w->unit);
	unit_of_expansion(model, w->unit);
	w->layout = place_all(w);
	w->slopes = ARRAY(mpq_t *, system->segments);
	for (int k = 0; k < system->segments; k++)
		w->slopes[k] = augmented_matrix(&w->layout, system, k);
	for (int e = 0; e < model->remainder.force_columns; e++)
		count_uses(w, model->schedule.operator[0].left[e]);
	const int unknowns = system->n + w->step->model->spec->count.multipliers;
	w->highest = ARRAY(int, unknowns);
	for (int j = 0; j < unknowns; j++)
		w->highest[j] = NONE;
	start_states(w);
	hold_contacts(w);
	if (with_forces)
		make_forces(w);
	for (int i = 0; i < system->states; i++)
		expand_state(w, i);
	w->x->motion = w->x->contacts ? motion_sequences(w) : NULL;
	rank_breakpoints(w);
	w->x->unresolved = unresolved_of(model, &w->x->unresolved_functions, &w->x->looks);
	w->x->crowded = model->truncation.adaptive ? crowded_frequency(system) : 0;
	place_unresolved(w);
	find_implicit(w->x);
	find_extent(step, w->x);
	return w->x;
}

struct expansion *expansion_of(const struct step *step, int order)
{
	return expand(step, order, false);
}

struct expansion *expansion_with_forces(const struct step *step, int order)
{
	return expand(step, order, true);
}

/* ---- some of its sequences alone ---- */

struct expansion *part_of_expansion(const struct step *step, const struct expansion *full, int order, int columns,
				    int *column)
{
	struct expansion *x = NEW(struct expansion);
	*x = (struct expansion){ .order = order, .count = full->count, .functions = full->functions,
				 .function = full->function, .columns = columns, .column = column, .alone = true,
				 .slots = full->slots, .equations = full->equations };
	x->sequence = ARRAY(struct sequence, x->count);
	x->column_top = ARRAY(int, x->columns);
	for (int i = 0; i < x->count; i++)
		x->sequence[i] = full->sequence[i];
	for (int c = 0; c < x->columns; c++)
		x->column_top[c] = order;
	find_extent(step, x);
	return x;
}

struct expansion *motion_of_expansion(const struct step *step, const struct expansion *full)
{
	const struct model *model = step->model;
	const int count = model->n + model->spec->count.multipliers + model->contacts.drags;
	int *column = ARRAY(int, count), columns = 0;
	for (int i = 0; i < count; i++)
		if (full->motion[i] != NONE)
			column[columns++] = full->motion[i];
	struct expansion *x = part_of_expansion(step, full, 1, columns, column);
	x->motion = full->motion;
	return x;
}
