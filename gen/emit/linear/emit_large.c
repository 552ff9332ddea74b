/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The step of a large model by its independent blocks: rows as everywhere; a loop over blocks that are alike; the
 * columns of a large block's matrix, summed in a form that compilers make vectors of. */
#include "inner.h"
#include "step/linear/forms.h"

enum {
	ROW_MULTIPLE = 8,           /* columns are as long: no vector has a rest */
	COLUMNS_AT_ONCE = 4
};

static int padded(int count, int multiple)
{
	return (count + multiple - 1) / multiple * multiple;
}

static bool changes(const struct emitter *e, const struct group *g)
{
	return loads_change(e->system) && g->loads > 0;
}

/* Loads and inputs: those of a group are handed to its function in one vector. */
static int acting(const struct group *g)
{
	return g->loads + g->inputs;
}

static struct operand acting_operand(const struct group *g, int k)
{
	return k < g->loads ? (struct operand){ OPERAND_LOAD, g->load[k] }
			    : (struct operand){ OPERAND_INPUT, g->input[k - g->loads] };
}

static double group_number(const struct emitter *e, const struct group *g, int row, int block,
			const struct operand *operand, int segment)
{
	const struct coefficient *factor = group_factor(e->step, g, row, block, operand, segment);
	return factor->zero ? 0 : factor->value;
}

/* Where a group's numbers stand: in a table of the code, or in the instance's coefficients */
static const char *group_table(const struct emitter *e, const struct group *g, const char *what, int index)
{
	if (g->tuned && e->wide)
		return "own";
	return g->tuned ? format("s->coeffs.%s%d", what, index) : spell(e, "$n_%s%d", what, index);
}

/* C has no pointer to const rows of an array that is not const. */
static const char *own_or_const(const struct group *g)
{
	return g->tuned ? "" : "const ";
}

static const char *matrix_name(const struct emitter *e)
{
	return e->step->program->products_added ? "Phi - I" : "Phi";
}

static const char *name_of_column(const struct emitter *e, const struct operand *operand)
{
	return operand->kind == OPERAND_INPUT ? "an input" : text_of_column(e->system, operand->index);
}

/* ---- a large block by its columns ---- */

/* One column of the table: its factors row by row, 0 behind the last */
static void fill_column(const struct emitter *e, const struct group *g, const struct operand *operand, int segment,
			double *value)
{
	for (int i = 0; i < g->states; i++)
		value[i] = group_number(e, g, i, 0, operand, segment);
}

static void emit_column_numbers(const struct emitter *e, const struct group *g)
{
	const int rows = padded(g->states, ROW_MULTIPLE), first = changes(e, g) ? g->loads : 0;
	const int operands = g->states + acting(g) - first, columns = padded(operands, COLUMNS_AT_ONCE);
	double *value = ARRAY(double, (size_t)(rows * columns));
	const char **note = ARRAY(const char *, (size_t)columns);
	for (int k = 0; k < columns; k++) {
		const struct operand operand = k < g->states ? (struct operand){ OPERAND_STATE, k }
					       : k < operands ? acting_operand(g, first + k - g->states)
							      : (struct operand){ 0 };
		note[k] = k < g->states ? e->model->names.state[g->state[k]]
			  : k < operands ? name_of_column(e, &operand) : "none";
		if (k < operands)
			fill_column(e, g, &operand, 0, &value[k * rows]);
	}
	emit_number_rows(e, columns, rows, value, note);
}

static const char *column_note(const struct emitter *e, const struct group *g)
{
	return format("%s by columns%s, each padded to %d rows", matrix_name(e),
		      acting(g) > (changes(e, g) ? g->loads : 0) ? ", then those of what acts on it" : "",
		      padded(g->states, ROW_MULTIPLE));
}

static void emit_changing_columns(const struct emitter *e, const struct group *g)
{
	const int rows = padded(g->states, ROW_MULTIPLE), columns = padded(g->loads, COLUMNS_AT_ONCE);
	const char **note = ARRAY(const char *, (size_t)columns);
	for (int s = 0; s < e->system->segments; s++) {
		double *value = ARRAY(double, (size_t)(rows * columns));
		for (int k = 0; k < columns; k++) {
			const struct operand operand = { OPERAND_LOAD, k < g->loads ? g->load[k] : 0 };
			note[k] = k < g->loads ? name_of_column(e, &operand) : "none";
			if (k < g->loads)
				fill_column(e, g, &operand, s, &value[k * rows]);
		}
		say(e, "  {\n");
		emit_number_rows(e, columns, rows, value, note);
		say(e, "  },\n");
	}
}

/* z += table times x */
static void emit_column_sums(const struct emitter *e, const char *table, const char *x, int rows, int columns)
{
	say(e, "    for (j = 0; j < %d; j += %d) {\n"
	       "        const double *const a = %s[j], *const b = %s[j + 1];\n"
	       "        const double *const c = %s[j + 2], *const d = %s[j + 3];\n"
	       "        const double p = %s[j], q = %s[j + 1], r = %s[j + 2], w = %s[j + 3];\n"
	       "        for (i = 0; i < %d; i++) { z[i] += (a[i] * p + b[i] * q) + (c[i] * r + d[i] * w); }\n"
	       "    }\n",
	    columns, COLUMNS_AT_ONCE, table, table, table, table, x, x, x, x, rows);
}

static bool in_a_row(const struct group *g)
{
	for (int i = 1; i < g->states; i++)
		if (g->state[i] != g->state[0] + i)
			return false;
	return true;
}

/* Where the states of the blocks stand in y, [state][block] */
static void emit_places(const struct emitter *e, const struct group *g, int index)
{
	say(e, "\n");
	emit_integers(e, "unsigned short", format("states%d", index), g->states * g->blocks, g->state);
}

static const char *place_of_row(const struct emitter *e, const struct group *g, int index)
{
	if (!in_a_row(g))
		return spell(e, "$n_states%d[i]", index);
	return g->state[0] ? format("%d + i", g->state[0]) : "i";
}

static void emit_parameters(const struct emitter *e, const struct group *g, const char *kind, int index)
{
	say(e, "\nstatic void $n_%s%d_step($n *s%s)\n"
	       "{\n", kind, index, acting(g) ? format(", const double act[%d]", acting(g)) : "");
}

/* act[from ...] to x[to ...], and 0 up to the end */
static void emit_acting(const struct emitter *e, const char *x, int to, int from, int count, int end)
{
	if (count > 0)
		say(e, "    for (i = 0; i < %d; i++) { %s[%s] = act[%s]; }\n",
		    count, x, to ? format("%d + i", to) : "i", from ? format("%d + i", from) : "i");
	for (int k = to + count; k < end; k++)
		say(e, "    %s[%d] = 0.0;\n", x, k);
}

static void emit_columns_function(const struct emitter *e, const struct group *g, int index)
{
	const int rows = padded(g->states, ROW_MULTIPLE), first = changes(e, g) ? g->loads : 0;
	const int operands = g->states + acting(g) - first, columns = padded(operands, COLUMNS_AT_ONCE);
	const int loads = padded(first, COLUMNS_AT_ONCE);
	const char *place = place_of_row(e, g, index);
	emit_parameters(e, g, "columns", index);
	say(e, "    double x[%d], z[%d];\n", columns, rows);
	if (loads)
		say(e, "    %sdouble (*const changing)[%d] = %s[s->segment];\n"
		       "    double load[%d];\n", own_or_const(g), rows, group_table(e, g, "loads", index), loads);
	say(e, "    int i, j;\n"
	       "    for (i = 0; i < %d; i++) { x[i] = s->y[%s]; }\n",
	    g->states, place);
	emit_acting(e, "x", g->states, first, operands - g->states, columns);
	emit_acting(e, "load", 0, 0, first, loads);
	say(e, "    for (i = 0; i < %d; i++) { z[i] = 0.0; }\n",
	    rows);
	emit_column_sums(e, group_table(e, g, "columns", index), "x", rows, columns);
	if (loads)
		emit_column_sums(e, "changing", "load", rows, loads);
	say(e, "    for (i = 0; i < %d; i++) { s->y[%s] %s z[i]; }\n"
	       "}\n",
	    g->states, place, e->step->program->products_added ? "+=" : "=");
}

/* ---- blocks that are alike ---- */

/* The terms of a row; one that acts on some block has a place in the table. */
struct alike_term {
	int row;
	struct operand operand;
	int acting;                 /* place among what acts; -1: a state of the block */
};

static int alike_terms(const struct emitter *e, const struct group *g, int row, bool changing, struct alike_term *term)
{
	int terms = 0;
	for (int k = 0; k < g->states + acting(g); k++) {
		const int act = k - g->states;
		const struct operand operand = act < 0 ? (struct operand){ OPERAND_STATE, k } : acting_operand(g, act);
		const bool other = operand.kind == OPERAND_LOAD && changes(e, g);
		if (other == changing && group_acts(e->step, g, row, &operand))
			term[terms++] = (struct alike_term){ row, operand, act < 0 ? -1 : act };
	}
	return terms;
}

static int all_terms(const struct emitter *e, const struct group *g, bool changing, struct alike_term *term)
{
	int terms = 0;
	for (int i = 0; i < g->states; i++)
		terms += alike_terms(e, g, i, changing, term + terms);
	return terms;
}

static void emit_alike_rows(const struct emitter *e, const struct group *g, int terms, const struct alike_term *term,
			    int segment)
{
	double *value = ARRAY(double, (size_t)(terms * g->blocks));
	const char **note = ARRAY(const char *, (size_t)terms);
	for (int k = 0; k < terms; k++) {
		const struct operand *operand = &term[k].operand;
		const char *by = operand->kind == OPERAND_STATE
					 ? e->model->names.state[g->state[operand->index * g->blocks]]
					 : name_of_column(e, operand);
		note[k] = format("%s by %s, and so on", e->model->names.state[g->state[term[k].row * g->blocks]], by);
		for (int b = 0; b < g->blocks; b++)
			value[k * g->blocks + b] = group_number(e, g, term[k].row, b, operand, segment);
	}
	emit_number_rows(e, terms, g->blocks, value, note);
}

static int count_alike_terms(const struct emitter *e, const struct group *g, bool changing)
{
	struct alike_term *term = ARRAY(struct alike_term, (size_t)(g->states * (g->states + acting(g))));
	return all_terms(e, g, changing, term);
}

static void emit_alike_numbers(const struct emitter *e, const struct group *g, bool changing)
{
	struct alike_term *term = ARRAY(struct alike_term, (size_t)(g->states * (g->states + acting(g))));
	const int terms = all_terms(e, g, changing, term);
	if (!changing)
		emit_alike_rows(e, g, terms, term, 0);
	for (int s = 0; s < e->system->segments && changing; s++) {
		say(e, "  {\n");
		emit_alike_rows(e, g, terms, term, s);
		say(e, "  },\n");
	}
}

/* Of a row, from one block to the next; 0: at no constant distance */
static int stride_of(const struct group *g, int row)
{
	const int *state = &g->state[row * g->blocks], stride = state[1] - state[0];
	for (int b = 1; b < g->blocks; b++)
		if (state[b] - state[b - 1] != stride)
			return 0;
	return stride;
}

static const char *place_of_block(const struct emitter *e, const struct group *g, int row, int index)
{
	const int stride = stride_of(g, row), first = stride ? g->state[row * g->blocks] : row * g->blocks;
	const char *block = stride > 1 ? format("%d * i", stride) : "i";
	const char *place = first ? format("%d + %s", first, block) : block;
	return stride ? place : spell(e, "$n_states%d[%s]", index, place);
}

static const char *alike_row(const struct emitter *e, const struct group *g, int row, int index, int *count)
{
	struct alike_term *term = ARRAY(struct alike_term, (size_t)(g->states + acting(g)));
	struct summands s = { 0 };
	for (int changing = 0; changing < 2; changing++) {
		const int here = alike_terms(e, g, row, changing, term);
		for (int k = 0; k < here; k++) {
			const char *table = group_table(e, g, "alike", index);
			const char *factor = changing ? format("changing[%d][i]", count[1]++)
						      : format("%s[%d][i]", table, count[0]++);
			add_summand(&s, format("%s * %s%d", factor, term[k].acting < 0 ? "y" : "act",
					       term[k].acting < 0 ? term[k].operand.index : term[k].acting));
		}
	}
	return s.terms ? sum_of(&s, 22) : NULL;
}

/* Of one instance, or over lanes, where its own numbers are some of the factors */
static void emit_alike_head(const struct emitter *e, const struct group *g, int index)
{
	if (!e->wide) {
		emit_parameters(e, g, "alike", index);
		return;
	}
	say(e, "\nPL_LANES_INLINE void $n_lanes_alike%d(pl_lanes *y, const pl_lanes *factor, const double *act)\n"
	       "{\n", index);
	if (g->tuned)
		say(e, "    const pl_lanes (*const own)[%d] = (const pl_lanes (*)[%d])(factor + %d);\n", g->blocks,
		    g->blocks, e->own[index]);
}

/* What a state becomes; without a term of a state a sum over lanes is one number for all. */
static const char *alike_value(const struct emitter *e, const struct group *g, int row, int index, int *count)
{
	struct alike_term *term = ARRAY(struct alike_term, (size_t)(g->states + acting(g)));
	const bool added = e->step->program->products_added;
	const char *sum = alike_row(e, g, row, index, count);
	const bool alone = alike_terms(e, g, row, false, term) == 0 || term[0].acting >= 0;
	if (added)
		return sum ? format("y%d + (%s)", row, sum) : format("y%d", row);
	return e->wide && alone && !g->tuned ? format("pl_lanes_all(%s)", sum ? sum : "0.0") : sum ? sum : "0.0";
}

static void emit_alike_function(const struct emitter *e, const struct group *g, int index)
{
	int count[2] = { 0, 0 };
	emit_alike_head(e, g, index);
	if (changes(e, g))
		say(e, "    %sdouble (*const changing)[%d] = %s[s->segment];\n", own_or_const(g), g->blocks,
		    group_table(e, g, "loads", index));
	for (int k = 0; k < acting(g); k++)
		say(e, "    const double act%d = act[%d];\n", k, k);
	say(e, "    int i;\n"
	       "    for (i = 0; i < %d; i++) {\n",
	    g->blocks);
	for (int row = 0; row < g->states; row++)
		say(e, "        const %s y%d = %s[%s];\n", e->wide ? "pl_lanes" : "double", row, state_vector(e),
		    place_of_block(e, g, row, index));
	for (int row = 0; row < g->states; row++)
		say(e, "        %s[%s] = %s;\n", state_vector(e), place_of_block(e, g, row, index),
		    alike_value(e, g, row, index, count));
	say(e, "    }\n");
	close_function(e, e->wide ? "factor act" : "");
}

/* ---- the numbers of a group ---- */

/* Of a row in the instance: states, load states in each segment of time, inputs */
static int row_width(const struct emitter *e, const struct group *g)
{
	return g->states + e->system->segments * g->loads + g->inputs;
}

struct group_shape shape_of_group(const struct emitter *e, const struct group *g)
{
	const bool changing = changes(e, g);
	const int first = changing ? g->loads : 0, rows = padded(g->states, ROW_MULTIPLE);
	if (g->kind == GROUP_ROWS)
		return (struct group_shape){ "rows", g->states, row_width(e, g), 0 };
	if (g->kind == GROUP_COLUMNS)
		return (struct group_shape){ "columns", padded(g->states + acting(g) - first, COLUMNS_AT_ONCE), rows,
					     changing ? padded(g->loads, COLUMNS_AT_ONCE) : 0 };
	return (struct group_shape){ "alike", count_alike_terms(e, g, false), g->blocks,
				     changing ? count_alike_terms(e, g, true) : 0 };
}

static void emit_row_numbers(const struct emitter *e, const struct group *g)
{
	const int width = row_width(e, g), segments = e->system->segments;
	double *value = ARRAY(double, (size_t)(g->states * width)), *to = value;
	const char **note = ARRAY(const char *, (size_t)g->states);
	for (int i = 0; i < g->states; i++) {
		note[i] = e->model->names.state[g->state[i]];
		for (int j = 0; j < g->states; j++)
			*to++ = group_number(e, g, i, 0, &(struct operand){ OPERAND_STATE, j }, 0);
		for (int s = 0; s < segments; s++)
			for (int k = 0; k < g->loads; k++)
				*to++ = group_number(e, g, i, 0, &(struct operand){ OPERAND_LOAD, g->load[k] }, s);
		for (int k = 0; k < g->inputs; k++)
			*to++ = group_number(e, g, i, 0, &(struct operand){ OPERAND_INPUT, g->input[k] }, 0);
	}
	emit_number_rows(e, g->states, width, value, note);
}

void emit_group_numbers(const struct emitter *e, const struct group *g, bool changing)
{
	if (g->kind == GROUP_ROWS)
		emit_row_numbers(e, g);
	else if (g->kind == GROUP_ALIKE)
		emit_alike_numbers(e, g, changing);
	else if (changing)
		emit_changing_columns(e, g);
	else
		emit_column_numbers(e, g);
}

const char *group_note(const struct emitter *e, const struct group *g)
{
	if (g->kind == GROUP_ROWS)
		return format("%s%s of a block", matrix_name(e), acting(g) ? ", then what acts on it:" : "");
	return g->kind == GROUP_COLUMNS
		       ? column_note(e, g)
		       : format("%s of %d independent blocks alike: each term of theirs, block by block",
				matrix_name(e), g->blocks);
}

int alike_entry(const struct emitter *e, const struct group *g, bool changing, int index, int *column)
{
	struct alike_term *term = ARRAY(struct alike_term, (size_t)(g->states * (g->states + acting(g))));
	all_terms(e, g, changing, term);
	*column = term[index].acting < 0 ? term[index].operand.index : g->states + term[index].acting;
	return term[index].row;
}

static void emit_tables_of_group(const struct emitter *e, const struct group *g, int index)
{
	const struct group_shape shape = shape_of_group(e, g);
	if (shape.rows) {
		say(e, "\n"
		       "/* %s */\n"
		       "%s double $n_%s%d[%d][%d] = {\n",
		    group_note(e, g), table_words(e), shape.name, index, shape.rows, shape.columns);
		emit_group_numbers(e, g, false);
		say(e, "};\n");
	}
	if (!shape.changing)
		return;
	say(e, "\n"
	       "/* %s, in each segment of time */\n"
	       "static const double $n_loads%d[%d][%d][%d] = {\n",
	    g->kind == GROUP_ALIKE ? "What their loads add" : "The columns of its loads", index, e->system->segments,
	    shape.changing, shape.columns);
	emit_group_numbers(e, g, true);
	say(e, "};\n");
}

/* ---- the whole ---- */

static bool needs_places(const struct group *g)
{
	if (g->kind == GROUP_COLUMNS)
		return !in_a_row(g);
	for (int row = 0; row < g->states; row++)
		if (stride_of(g, row) == 0)
			return true;
	return false;
}

static void emit_group(const struct emitter *e, const struct group *g, int index)
{
	const bool tables = !e->wide || e->device;
	if (g->kind == GROUP_ROWS)
		return;
	if (needs_places(g) && tables)
		emit_places(e, g, index);
	if (!g->tuned && tables)
		emit_tables_of_group(e, g, index);
	if (g->kind == GROUP_COLUMNS)
		emit_columns_function(e, g, index);
	else
		emit_alike_function(e, g, index);
}

void emit_groups(const struct emitter *e)
{
	for (int k = 0; k < e->step->program->groups; k++)
		emit_group(e, &e->step->program->group[k], k);
}

/* What acts on a group, in one vector: `acting_text` has the loads' columns, then the inputs'. */
static void emit_driven(const struct emitter *e, const struct group *g, int index, const char *const *acting_text)
{
	const char **text = ARRAY(const char *, (size_t)acting(g));
	for (int k = 0; k < acting(g); k++) {
		const struct operand operand = acting_operand(g, k);
		const bool input = operand.kind == OPERAND_INPUT;
		text[k] = acting_text[operand.index + (input ? e->step->branch->full->columns : 0)];
	}
	say_vector(e, format("driven%d", index), acting(g), text);
}

void emit_group_steps(const struct emitter *e, const char *const *acting_text)
{
	static const char *const kind[] = { [GROUP_ALIKE] = "alike", [GROUP_COLUMNS] = "columns" };
	const struct program *program = e->step->program;
	for (int k = 0; k < program->groups; k++)
		if (program->group[k].kind != GROUP_ROWS && acting(&program->group[k]))
			emit_driven(e, &program->group[k], k, acting_text);
	for (int k = 0; k < program->groups; k++)
		if (program->group[k].kind != GROUP_ROWS && e->wide)
			say(e, "    $n_lanes_alike%d(y, factor, %s);\n", k,
			    acting(&program->group[k]) ? format("driven%d", k) : "now");
		else if (program->group[k].kind != GROUP_ROWS)
			say(e, "    $n_%s%d_step(s%s);\n", kind[program->group[k].kind], k,
			    acting(&program->group[k]) ? format(", driven%d", k) : "");
}
