/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The coefficients of a series as C: their tape under the names of states and letters. */
#include "inner.h"
#include "emit/steps.h"
#include "step/collocation/collocation.h"
#include "step/series/expansion.h"

#include <string.h>

/* ---- names ---- */

/* Of the sequences that are no states: a letter that no state's local starts with */
static const char *prefix(const struct emitter *e)
{
	static const char *const letters[] = { "a", "b", "p", "q", "w", "z", "part", "sequence" };
	for (size_t i = 0; i < sizeof letters / sizeof *letters; i++) {
		bool free = true;
		for (int k = 0; k < e->system->states; k++)
			free = free && strncmp(e->local[k], letters[i], strlen(letters[i])) != 0;
		if (free)
			return letters[i];
	}
	return "coefficient_of_sequence_";
}

static const char *base_name(const void *context, int sequence)
{
	const struct emitter *e = context;
	int state = own_expansion(e)->sequence[sequence].state;
	return state != NONE ? e->local[state] : format("%s%d", prefix(e), sequence - e->system->states + 1);
}

const char *coefficient(const struct emitter *e, int sequence, int k)
{
	return k > own_expansion(e)->sequence[sequence].top ? NULL : format("%s_%d", base_name(e, sequence), k);
}

/* ---- operands ---- */

static const char *row_of_line(const struct lines *l, int sequence)
{
	return format(l->across ? "&table_by_0[0][%d]" : "table_by_0[%d]", l->row[sequence]);
}

/* What the loop over k reads of a long series */
static const char *stage_operand(const struct emitter *e, const struct stage_value *v)
{
	static const char *const function[] = { [STAGE_INNER] = "inner", [STAGE_QUOTIENT] = "inner_of_quotient",
						[STAGE_POWER] = "inner_of_power" };
	const struct lines *l = own_expansion(e)->lines;
	const int made = l->place[v - l->value];
	const char *k = stage_index(v->offset);
	if (made != NONE)
		return format("inner_by_0[%d]", made);
	switch (v->kind) {
	case STAGE_COEFFICIENT: return line_place(l, v->a, k);
	case STAGE_FACTOR:      return spell(e, "$n_series_factor[%d][%s]", v->a, k);
	case STAGE_FORCE:       return format("force[%s][%d]", k, v->a);
	case STAGE_NUMBER:      return format("(double)(%s)", k);
	case STAGE_SOLVED:      return format("solved_by_%d[%d]", v->a, v->b);
	case STAGE_SQUARE:      return spell(e, "$n_inner_square(%s, %s)", row_of_line(l, v->a), k);
	default:                break;
	}
	const char *more = v->kind == STAGE_POWER ? format(", %s", shortest(v->exponent)) : "";
	return spell(e, "$n_%s(%s, %s, %s%s)", function[v->kind], row_of_line(l, v->a), row_of_line(l, v->b), k, more);
}

static const char *operand(const void *context, const struct tape_node *n)
{
	const struct emitter *e = context;
	if (n->op == TAPE_TABLE && n->part == STAGED)
		return stage_operand(e, &own_expansion(e)->lines->value[n->index]);
	switch (n->op) {
	case TAPE_STATE: return format("y[%d]", n->index);
	case TAPE_LOAD:  return load_operand(e, n->index, n->part);
	case TAPE_INPUT: return input_name(e, n->index, n->part);
	case TAPE_PARAM: return e->at_state ? param_local(e, n->index) : param_text(e, n->index);
	case TAPE_TIME:  return n->part ? "when" : "t";
	case TAPE_ABOVE: return format("interval[%d] > %d", n->index, n->part);
	case TAPE_HELD:  return format("interval[%d] == %d", n->index, n->part);
	default:         return spell(e, "force%s[%d]", e->at_state ? "" : format("[%d]", n->part), n->index);
	}
}

/* ---- the whole ---- */

struct recurrences *series_new(const struct emitter *e)
{
	return recurrences_new(e->step, own_expansion(e), (struct series_names){ .name = base_name, .context = e });
}

static void print_series(const struct emitter *e, const struct recurrences *r, bool locals_first)
{
	const struct tape *t = tape_of_recurrences(r);
	const struct lines *l = own_expansion(e)->lines;
	const bool across = !locals_first && l && l->across;
	const struct tape_target to = { .real = "double", .operand = operand, .size = "pl_magnitude",
					.context = e, .indent = 4, .locals_first = locals_first,
					.across = !across ? 0 : e->model->request.single ? 16 : 8,
					.rolls = locals_first || e->device ? 0 : across ? RUN_ALIKE : LONG_RUN };
	tape_print(t, &to, e->to);
}

void emit_series_tape(const struct emitter *e, const struct recurrences *r)
{
	print_series(e, r, true);
}

/* ---- a long one ---- */

static struct listed_matrix matrix_of(const struct linear_equations *q)
{
	return (struct listed_matrix){ q->n, is_symmetric_system(q), "of", q->number };
}

static const char *solver(const void *context, const struct linear_equations *q, bool factors)
{
	return factors ? factor_by_lists(context, matrix_of(q)) : solve_by_lists(context, matrix_of(q), 1, q->number);
}

struct recurrences *series_in_loop(const struct emitter *e)
{
	const struct series_names names = { .name = base_name, .context = e, .looped = true, .solver = solver,
					    .turn = spell(e, "$n_inners_of_turn(table_by_0[0], k_by_0, inner_by_0);") };
	return recurrences_new(e->step, own_expansion(e), names);
}

/* Each system once: its first component has the place of the first */
static const struct linear_equations *listed_at(const struct expansion *x, int sequence)
{
	const struct sequence *s = &x->sequence[sequence];
	return s->equations && s->component == 0 && s->top >= 0 && is_listed(s->equations) ? s->equations : NULL;
}

static bool calls_stage(const struct expansion *x, enum stage_kind kind)
{
	bool any = false;
	for (int i = 0; i < x->lines->values; i++)
		any = any || x->lines->value[i].kind == kind;
	return any;
}

/* Like elements side by side: lanes, and which sums of products these begin a turn with */
static void emit_runs(const struct emitter *e, const struct lines *l)
{
	SCRATCH int *run = ARRAY(int, 4 * l->runs + 4);
	for (int i = 0; i < l->runs; i++) {
		const int *const from = (const int[]){ l->run[i].a, l->run[i].b, l->run[i].offset, l->run[i].count };
		for (int k = 0; k < 4; k++)
			run[4 * i + k] = from[k];
	}
	say(e, "\n/* Sums of products of like elements: the first two rows, beside k, how many */\n");
	emit_integers(e, "short", "alike", 4 * l->runs, run);
	open_algorithm(e, "lanes.h", &(struct size){ NULL, 0 });
	say(e, "#include \"lanes.h\"\n");
}

void emit_series_loop_tables(const struct emitter *e)
{
	const struct expansion *x = own_expansion(e);
	struct lines *l = x->lines;
	const int states = e->system->states;
	bool solves = false;
	find_runs(l);
	double *factor = ARRAY(double, (size_t)(l->factors * l->width) + 1);
	int *row = ARRAY(int, (size_t)(states + x->columns));
	for (int i = 0; i < l->factors * l->width; i++)
		factor[i] = l->factor[i / l->width][i % l->width];
	if (l->factors)
		emit_array(e, "Factors of terms of the series, of each coefficient", "series_factor", 2,
			   (const int[]){ l->factors, l->width }, factor, NULL);
	for (int i = 0; i < states + x->columns; i++)
		row[i] = l->row[i < states ? i : x->column[i - states]];
	say(e, "\n/* The rows of the table of coefficients that are kept */\n");
	emit_integers(e, "short", "kept_row", states + x->columns, row);
	for (int i = 0; i < states + x->columns; i++)
		row[i] = i < states ? x->order : x->column_top[i - states];
	say(e, "\n/* As far as this coefficient; those behind it would bound the step for what nobody reads */\n");
	emit_integers(e, "short", "kept_top", states + x->columns, row);
	for (int i = 0; i < x->count; i++) {
		const struct linear_equations *q = listed_at(x, i);
		if (q) {
			SCRATCH int *first = ARRAY(int, q->n + 1);
			emit_factor_lists(e, matrix_of(q), first, system_columns(q, first));
		}
		solves = solves || (q && !(e->step->collocation && e->step->collocation->motion->listed));
	}
	if (l->across)
		emit_runs(e, l);
	emit_sizes(e, "lines.h", { "INNERS", calls_stage(x, STAGE_INNER) }, { "SQUARES", calls_stage(x, STAGE_SQUARE) },
		   { "DIVIDED", calls_stage(x, STAGE_QUOTIENT) }, { "POWERS", calls_stage(x, STAGE_POWER) },
		   { "SOLVES", solves }, { "ACROSS", l->across ? l->rows : 0 }, { "RUNS", l->runs });
	say_include(e, "lines.h");
}

void emit_series_loop(const struct emitter *e, const struct recurrences *r)
{
	const struct expansion *x = own_expansion(e);
	const struct lines *l = x->lines;
	say(e, "    double table_by_0[%d][%d]%s;\n"
	       "    int k_by_0, i_by_0;\n", l->across ? l->width : l->rows, l->across ? l->rows : l->width,
	    l->across ? format(", inner_by_0[%d]", l->inners + 1) : "");
	for (int i = 0; i < x->count; i++) {
		const struct linear_equations *q = listed_at(x, i);
		if (q)
			say(e, "    double matrix_by_%d[%d] = {0.0}, solved_by_%d[%d];\n", q->number, q->n * q->n,
			    q->number, q->n);
	}
	print_series(e, r, false);
	say(e, "    for (k_by_0 = 0; k_by_0 <= %d; k_by_0++) {\n", x->order);
	if (l->across)          /* the first rows are the states */
		say(e, "        memcpy(c[k_by_0], table_by_0[k_by_0], $N_STATES * sizeof c[0][0]);\n");
	say(e, "        for (i_by_0 = %d; i_by_0 < %d; i_by_0++) {\n"
	       "            c[k_by_0][i_by_0] = k_by_0 <= $n_kept_top[i_by_0]\n"
	       "                                ? table_by_0%s : 0;\n"
	       "        }\n"
	       "    }\n", l->across ? e->system->states : 0, e->system->states + x->columns,
	    spell(e, l->across ? "[k_by_0][$n_kept_row[i_by_0]]" : "[$n_kept_row[i_by_0]][k_by_0]"));
}

void emit_series_locals(const struct emitter *e)
{
	const struct expansion *x = own_expansion(e);
	struct recurrences *r = series_new(e);
	struct tape *t = tape_of_recurrences(r);
	for (int k = 0; k <= x->order; k++) {
		for (int i = 0; i < e->system->states && !x->alone; i++)
			if (coefficient(e, i, k))
				tape_set_local(t, coefficient(e, i, k), recurrence_number(r, i, k));
		for (int i = 0; i < x->columns; i++)
			if (k <= x->column_top[i] && coefficient(e, x->column[i], k))
				tape_set_local(t, coefficient(e, x->column[i], k),
					       recurrence_number(r, x->column[i], k));
	}
	emit_series_tape(e, r);
}
