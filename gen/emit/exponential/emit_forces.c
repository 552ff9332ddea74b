/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Of steps in normal modes: tables of a schedule, between coordinates and modes, functions of time, forces on the
 * modes. */
#include "inner.h"
#include "emit/steps.h"
#include "emit/tunable/tunable.h"
#include "model/reads.h"
#include "step/exponential/normal.h"

#include <math.h>

enum { TERMS = 20 };                /* of one sum in a loop */

const struct normal *normal_of_step(const struct emitter *e)
{
	return e->step->normal;
}

int functions_of_time(const struct emitter *e)
{
	return e->model->remainder.split->functions - 1;
}

bool has_schedule(const struct emitter *e)
{
	return normal_of_step(e)->operators > 1;
}

static bool has_changes(const struct emitter *e)
{
	return loads_change(e->system);
}

/* ---- tables: one of all operators where they are alike ---- */

struct schedule_table {
	int size;                   /* of one schedule's */
	const double *value;
	bool alike;
};

static struct schedule_table table_of_operators(const struct emitter *e, int size, const double *value)
{
	struct schedule_table t = { size, value, true };
	for (int b = 1; b < normal_of_step(e)->operators; b++)
		for (int i = 0; i < size; i++)
			t.alike = t.alike && value[b * size + i] == value[i];
	return t;
}

/* static const double NAME_name[operators][outer][row]; its name with the schedule's index */
static const char *emit_schedule_table(const struct emitter *e, const char *name, const char *note, int outer, int row,
				   const double *value)
{
	const struct schedule_table t = table_of_operators(e, (outer ? outer : 1) * row, value);
	const int operators = t.alike ? 1 : normal_of_step(e)->operators;
	const int *size = outer ? (const int[]){ operators, outer, row } : (const int[]){ operators, row };
	emit_array(e, note, name, outer ? 3 : 2, size, value, NULL);
	return spell(e, t.alike ? "$n_%s[0]" : "$n_%s[which]", name);
}

/* By which a table of so many numbers of each operator is read */
static const char *schedule_index(const struct emitter *e, const double *value, int size)
{
	return table_of_operators(e, size, value).alike ? "0" : "which";
}

/* ---- sums over the rows of a block ---- */

/* target[i] = sum for so many i, in as many loops as its terms ask for */
void say_row_sum(const struct emitter *e, const char *target, int rows, const struct summands *s)
{
	if (s->terms == 0)
		say(e, "    for (i = 0; i < %d; i++) { %s = 0.0; }\n", rows, target);
	for (int first = 0; first < s->terms; first += TERMS) {
		int count = s->terms - first < TERMS ? s->terms - first : TERMS;
		say(e, "    for (i = 0; i < %d; i++) { %s %s %s; }\n",
		    rows, target, first ? "+=" : "=", sum_of(&(struct summands){ count, s->term + first }, 12));
	}
}

/* Rows place .. of a matrix of modes by blocks, as columns: [schedule][column][row] */
static double *block_columns(const struct emitter *e, const double *matrix, const struct mode_block *rows, int row,
			     const struct mode_block *columns, int column)
{
	int n = normal_of_step(e)->modes;
	double *value = ARRAY(double, (size_t)(normal_of_step(e)->operators * columns->modes * rows->rows));
	for (int b = 0; b < normal_of_step(e)->operators; b++)
		for (int j = 0; j < columns->modes; j++)
			for (int i = 0; i < rows->modes; i++)
				value[(b * columns->modes + j) * rows->rows + i] =
					matrix[(b * n + row + i) * n + column + j];
	return value;
}

static int first_mode(const struct emitter *e, int block)
{
	int first = 0;
	for (int b = 0; b < block; b++)
		first += normal_of_step(e)->block[b].modes;
	return first;
}

/* ---- between coordinates and modes ---- */

/* Rows in the order of modes, columns in that of coordinates (to), or the other way */
static double *sorted(const struct emitter *e, const double *matrix, int block, bool to)
{
	const struct normal *m = normal_of_step(e);
	const struct mode_block *own = &m->block[block];
	int n = m->modes, first = first_mode(e, block);
	double *value = ARRAY(double, (size_t)(m->operators * own->modes * own->rows));
	for (int b = 0; b < m->operators; b++)
		for (int j = 0; j < own->modes; j++)
			for (int i = 0; i < own->modes; i++)
				value[(b * own->modes + j) * own->rows + i] =
					to ? matrix[(b * n + first + i) * n + own->coord[j]]
					   : matrix[(b * n + own->coord[i]) * n + first + j];
	return value;
}

/* The names of the tables, one of each block */
static const char **emit_shape_tables(const struct emitter *e, const char *name, const char *what, bool to)
{
	const struct normal *m = normal_of_step(e);
	const char **table = ARRAY(const char *, (size_t)m->blocks);
	for (int b = 0; b < m->blocks; b++)
		table[b] = emit_schedule_table(e, format("%s%d", name, b + 1), what, m->block[b].modes,
					       m->block[b].rows, sorted(e, to ? m->to : m->from, b, to));
	return table;
}

void emit_to_modes(const struct emitter *e)
{
	const struct normal *m = normal_of_step(e);
	const char **table = emit_shape_tables(
		e, "to_modes", "Modal coordinates from coordinates: the inverse mode shapes, by columns", true);
	open_function(e, "Modal coordinates of coordinates, or modal velocities of velocities",
		      "static void $n_modes_of(int which, const double q[%d], double mode[%d])", m->modes, m->width);
	say(e, "    int i;\n");
	for (int b = 0; b < m->blocks; b++) {
		const struct mode_block *own = &m->block[b];
		struct summands s = { 0 };
		for (int j = 0; j < own->modes; j++)
			add_summand(&s, format("%s[%d][i] * q[%d]", table[b], j, own->coord[j]));
		say_row_sum(e, own->place ? format("mode[%d + i]", own->place) : "mode[i]", own->rows, &s);
	}
	close_function(e, "which");
}

void emit_from_modes(const struct emitter *e)
{
	const struct normal *m = normal_of_step(e);
	const char **table = emit_shape_tables(
		e, "from_modes", "Coordinates from modal coordinates: mode shapes, by columns", false);
	open_function(e, "Coordinates of modal coordinates, or velocities of modal velocities",
		      "static void $n_of_modes(int which, const double mode[%d], double q[%d])", m->width, m->modes);
	say(e, "    double x[%d];\n"
	       "    int i;\n", m->width);
	for (int b = 0; b < m->blocks; b++) {
		const struct mode_block *own = &m->block[b];
		struct summands s = { 0 };
		for (int j = 0; j < own->modes; j++)
			add_summand(&s, format("%s[%d][i] * mode[%d]", table[b], j, own->place + j));
		say_row_sum(e, own->place ? format("x[%d + i]", own->place) : "x[i]", own->rows, &s);
		for (int i = 0; i < own->modes; i++)
			say(e, "%sq[%d] = x[%d];%s", i % 6 ? " " : "    ", own->coord[i], own->place + i,
			    i % 6 == 5 || i == own->modes - 1 ? "\n" : "");
	}
	close_function(e, "which");
}

/* ---- functions of time ---- */

void emit_function_values(const struct emitter *e)
{
	const struct splitting *split = e->model->remainder.split;
	int count = functions_of_time(e);
	const struct form **form = ARRAY(const struct form *, (size_t)count + 1);
	for (int k = 0; k < count; k++)
		form[k] = split->function[k + 1].form;
	struct reads r = reads_of(e->model, count, form);
	struct emitter here = *e;
	here.at_node = true;
	if (r.time)
		emit_node_times(e);
	if (any_of(r.load, e->system->loads))
		emit_node_phases(e, r.load);
	open_function(e, format("What forces and factors of forces are at a node, as functions of time%s",
				has_changes(e) ? ", their\n * formulas those that hold at another time" : ""),
		      "static void $n_functions(const $n *s, int node, double start, double remainder[%d])", count);
	emit_param_locals(e, r.param);
	if (r.time)
		say(e, "    const double t = $n_time(s) + $n_node[node];\n");
	emit_load_states(&here, r.load, true);
	struct reading how = { .when = has_changes(e) ? "start" : NULL };
	struct formulas *f = formulas_new(&here, how, count, form);
	for (int k = 0; k < count; k++)
		tape_set(formulas_tape(f), format("remainder[%d]", k), formula(f, form[k]), 14, NULL);
	emit_formulas(f, 4);
	/* conditions alone may read t */
	close_function(e, r.time && has_changes(e) ? "t s node start" : "s node start");
}

/* ---- forces on the modes ---- */

enum shape { SHAPE_ZERO, SHAPE_DIAGONAL, SHAPE_DENSE };

static enum shape shape_of(const struct emitter *e, const double *matrix, int row, int column)
{
	const struct normal *m = normal_of_step(e);
	const struct mode_block *rows = &m->block[row], *columns = &m->block[column];
	int i0 = first_mode(e, row), j0 = first_mode(e, column);
	enum shape shape = SHAPE_ZERO;
	for (int b = 0; b < m->operators; b++)
		for (int i = 0; i < rows->modes; i++)
			for (int j = 0; j < columns->modes; j++) {
				bool zero = matrix[(b * m->modes + i0 + i) * m->modes + j0 + j] == 0;
				if (!zero && (row != column || i != j))
					return SHAPE_DENSE;
				shape = zero ? shape : SHAPE_DIAGONAL;
			}
	return shape;
}

static double *diagonal_of(const struct emitter *e, const double *matrix, int block)
{
	const struct normal *m = normal_of_step(e);
	const struct mode_block *own = &m->block[block];
	int first = first_mode(e, block);
	double *value = ARRAY(double, (size_t)(m->operators * own->rows));
	for (int b = 0; b < m->operators; b++)
		for (int i = 0; i < own->modes; i++)
			value[b * own->rows + i] = matrix[(b * m->modes + first + i) * m->modes + first + i];
	return value;
}

/* The terms of one block of a matrix, its table printed */
static void add_block(const struct emitter *e, struct summands *s, int matrix, int row, int column)
{
	const struct normal *m = normal_of_step(e);
	const double *value = m->matrix[matrix].value;
	const struct mode_block *rows = &m->block[row], *columns = &m->block[column];
	const char *name = format("remainder%d_%d_%d", matrix + 1, row + 1, column + 1);
	switch (shape_of(e, value, row, column)) {
	case SHAPE_ZERO:
		return;
	case SHAPE_DIAGONAL:
		name = emit_schedule_table(e, name, "Remainder of a mode: a force on itself", 0, rows->rows,
				       diagonal_of(e, value, row));
		add_summand(s, format("%s[i] * x%d[%d + i]", name, matrix + 1, rows->place));
		return;
	case SHAPE_DENSE:
		value = block_columns(e, value, rows, first_mode(e, row), columns, first_mode(e, column));
		name = emit_schedule_table(e, name, "Remainder: forces on modes, by columns", columns->modes,
				       rows->rows, value);
		for (int j = 0; j < columns->modes; j++)
			add_summand(s, format("%s[%d][i] * x%d[%d]", name, j, matrix + 1, columns->place + j));
	}
}

static const char *function_text(int function)
{
	return function ? format("f[%d]", function - 1) : "1.0";
}

/* factor[schedule] times a function; a table is printed where it differs from schedule to schedule */
static const char *factor_text(const struct emitter *e, const char *name, int function, const double *factor)
{
	struct schedule_table t = table_of_operators(e, 1, factor);
	const char *text;
	if (t.alike) {
		text = scaled(factor[0], function ? function_text(function) : NULL);
	} else {
		emit_array(e, "Of each operator", name, 1, &normal_of_step(e)->operators, factor, NULL);
		text = spell(e, function ? "$n_%s[which] * %s" : "$n_%s[which]", name, function_text(function));
	}
	return text;
}

struct combination { const char *position, *velocity; };

static struct combination combination_of(const struct emitter *e, int matrix)
{
	const struct normal_matrix *m = &normal_of_step(e)->matrix[matrix];
	struct summands part[2] = { { 0 }, { 0 } };
	for (int k = 0; k < m->terms; k++) {
		const char *name = format("factor%d_%d", matrix + 1, k + 1);
		add_summand(&part[m->term[k].velocity], factor_text(e, name, m->term[k].function, m->term[k].factor));
	}
	return (struct combination){ part[0].terms ? sum_of(&part[0], 20) : NULL,
				     part[1].terms ? sum_of(&part[1], 20) : NULL };
}

/* ---- what is not linear ---- */

static struct reads reads_of_rest(const struct emitter *e)
{
	const struct splitting *split = e->model->remainder.split;
	const struct form **form = ARRAY(const struct form *, (size_t)split->rests + 1);
	for (int k = 0; k < split->rests; k++)
		form[k] = split->rest[k].form;
	return reads_of(e->model, split->rests, form);
}

static void emit_rest_forces(const struct emitter *e)
{
	const struct splitting *split = e->model->remainder.split;
	const struct form **form = ARRAY(const struct form *, (size_t)split->rests + 1);
	struct reads r = reads_of_rest(e);
	if (split->rests == 0)
		return;
	for (int k = 0; k < split->rests; k++)
		form[k] = split->rest[k].form;
	open_function(e, "Nonlinear terms, each without its factor that depends on time alone",
		      "static void $n_rest(const $n *s, const double y[$N_STATES], double remainder[%d])",
		      split->rests);
	emit_locals_of(e, r.state, "y");
	emit_param_locals(e, r.param);
	struct formulas *f = formulas_new(e, (struct reading){ 0 }, split->rests, form);
	for (int k = 0; k < split->rests; k++)
		tape_set(formulas_tape(f), format("remainder[%d]", k), formula(f, form[k]), 15,
			 e->model->names.coord[split->rest[k].coord]);
	emit_formulas(f, 4);
	close_function(e, "s");
}

/* Of a coordinate: its block, and its place in that */
static int block_of_coordinate(const struct emitter *e, int coord, int *place)
{
	const struct normal *m = normal_of_step(e);
	for (int b = 0; b < m->blocks; b++)
		for (*place = 0; *place < m->block[b].modes; ++*place)
			if (m->block[b].coord[*place] == coord)
				return b;
	return 0;
}

/* V's row of a coordinate: what a force on it is on the modes, of which the text says what it is */
static void add_force_on(const struct emitter *e, struct summands *sum, int k, int coord, const char *force)
{
	const struct normal *m = normal_of_step(e);
	int n = m->modes, place, block = block_of_coordinate(e, coord, &place), first = first_mode(e, block);
	const struct mode_block *own = &m->block[block];
	double *row = ARRAY(double, (size_t)(m->operators * own->rows));
	for (int b = 0; b < m->operators; b++)
		for (int j = 0; j < own->modes; j++)
			row[b * own->rows + j] = m->from[(b * n + coord) * n + first + j];
	const char *name = emit_schedule_table(e, format("rest%d", k + 1), "Modal forces of a unit force", 0,
					   own->rows, row);
	add_summand(&sum[block], format("%s[i] * %s", name, force));
}

static void add_rest_forces(const struct emitter *e, struct summands *sum)
{
	for (int k = 0; k < e->model->remainder.split->rests; k++)
		add_force_on(e, sum, k, e->model->remainder.split->rest[k].coord, format("rest%d", k + 1));
}

/* The states that it reads, and its values times functions of time */
static void emit_rest_values(const struct emitter *e)
{
	const struct normal *m = normal_of_step(e);
	const struct splitting *split = e->model->remainder.split;
	struct reads r = reads_of_rest(e);
	if (split->rests == 0)
		return;
	say(e, "    double y[$N_STATES], remainder[%d];\n", split->rests);
	for (int i = 0; i < e->system->states; i++) {
		int place, block = block_of_coordinate(e, e->system->coord[i], &place);
		const struct mode_block *own = &m->block[block];
		struct summands s = { 0 };
		if (!r.state[i])
			continue;
		const char *table = spell(e, "$n_from_modes%d[%s]", block + 1,
					  schedule_index(e, sorted(e, m->from, block, false), own->modes * own->rows));
		for (int j = 0; j < own->modes; j++)
			add_summand(&s, format("%s[%d][%d] * %s[%d]", table, j, place, i < m->modes ? "eta" : "rate",
					       own->place + j));
		say(e, "    y[%d] = %s;\n", i, sum_of(&s, 11));
	}
	say(e, "    $n_rest(s, y, remainder);\n");
	for (int k = 0; k < split->rests; k++)
		say(e, "    const double rest%d = remainder[%d]%s%s;\n", k + 1, k, split->rest[k].function ? " * " : "",
		    split->rest[k].function ? function_text(split->rest[k].function) : "");
}

static void emit_combinations(const struct emitter *e, const struct combination *made)
{
	const struct normal *m = normal_of_step(e);
	for (int k = 0; k < m->matrices; k++) {
		if (made[k].position)
			say(e, "    const double position%d = %s;\n", k + 1, made[k].position);
		if (made[k].velocity)
			say(e, "    const double velocity%d = %s;\n", k + 1, made[k].velocity);
	}
	for (int k = 0; k < m->matrices; k++)
		say(e, "    double x%d[%d];\n", k + 1, m->width);
	say(e, "    int i;\n");
	for (int k = 0; k < m->matrices; k++) {
		const char *position = format("position%d * eta[i]", k + 1);
		const char *velocity = format("velocity%d * rate[i]", k + 1);
		const char *both = !made[k].velocity   ? position
				   : !made[k].position ? velocity
						       : format("%s + %s", position, velocity);
		say(e, "    for (i = 0; i < %d; i++) { x%d[i] = %s; }\n", m->width, k + 1, both);
	}
}

void emit_forces(const struct emitter *e)
{
	const struct normal *m = normal_of_step(e);
	struct summands *sum = ARRAY(struct summands, (size_t)m->blocks);
	struct combination *made = ARRAY(struct combination, (size_t)m->matrices);
	for (int k = 0; k < m->matrices; k++)
		made[k] = combination_of(e, k);
	for (int f = 0; f < e->model->remainder.split->functions; f++) {
		if (!m->force[f])
			continue;
		const char *name =
			emit_schedule_table(e, format("force%d", f), "Forces of time alone", 0, m->width, m->force[f]);
		for (int b = 0; b < m->blocks; b++)
			add_summand(&sum[b], format("%s[%d + i]%s", name, m->block[b].place,
						    f ? format(" * now%d", f) : ""));
	}
	for (int b = 0; b < m->blocks; b++)
		for (int k = 0; k < m->matrices; k++)
			for (int c = 0; c < m->blocks; c++)
				add_block(e, &sum[b], k, b, c);
	emit_rest_forces(e);
	add_rest_forces(e, sum);
	open_function(e, "Forces on the modes: the remainder, with the loads that are part of it",
		      "static void $n_mode_forces(const $n *s, int which, const double f[], const double eta[%d],\n"
		      "    const double rate[%d], double force[%d])", m->width, m->width, m->width);
	/* what a loop reads through a pointer might be what it writes, and compilers would leave it as it is */
	for (int f = 1; f < e->model->remainder.split->functions; f++)
		if (m->force[f])
			say(e, "    const double now%d = %s;\n", f, function_text(f));
	emit_combinations(e, made);
	emit_rest_values(e);
	for (int b = 0; b < m->blocks; b++)
		say_row_sum(e, format("force[%d + i]", m->block[b].place), m->block[b].rows, &sum[b]);
	close_function(e, "s which f eta rate");
}

void emit_forces_on_modes(const struct emitter *e)
{
	const struct normal *m = normal_of_step(e);
	const struct model *model = e->model;
	struct summands *sum = ARRAY(struct summands, (size_t)m->blocks);
	for (int c = 0; c < model->remainder.force_columns; c++)
		add_force_on(e, sum, c, coordinate_of_row(model, model->remainder.row[c]), format("remainder[%d]", c));
	open_function(e, "The remainder as forces on the modes",
		      "static void $n_on_modes(int which, const double remainder[%d], double force[%d])",
		      model->remainder.force_columns, m->width);
	say(e, "    int i;\n");
	for (int b = 0; b < m->blocks; b++)
		say_row_sum(e, format("force[%d + i]", m->block[b].place), m->block[b].rows, &sum[b]);
	close_function(e, "which remainder");
}
