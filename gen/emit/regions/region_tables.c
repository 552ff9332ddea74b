/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Of regions: tables that there is one of for each matrix, and sums over their rows as text. */
#include "inner.h"
#include "emit/steps.h"
#include "model/regions/switching_functions.h"
#include "model/regions/regions.h"

int functions_of(const struct emitter *e)
{
	return e->model->switching->functions;
}

/* ---- tables: of the file, or where params are tunable of an instance ---- */

static void open_as(const struct emitter *e, bool own, const char *type, const char *name, const char *shape,
		    const char *note)
{
	if (own) {
		open_member(e, type, name, shape, note);
		return;
	}
	say(e, "\n");
	say_comment(e, "", note);
	say(e, "static const %s $o_%s%s = {\n", type, name, shape);
}

static void close_as(const struct emitter *e, bool own)
{
	if (own)
		close_member(e);
	else
		say(e, "};\n");
}

void open_table(const struct emitter *e, const char *type, const char *name, const char *shape, const char *note)
{
	open_as(e, e->model->params.retuned, type, name, shape, note);
}

void close_table(const struct emitter *e)
{
	close_as(e, e->model->params.retuned);
}

static void put_items(const struct emitter *e, int count, int in_line, const char *const *item)
{
	for (int i = 0; i < count; i++)
		say(e, "%s%s%s", i == 0 ? "    " : i % in_line ? ", " : ",\n    ", item[i], i == count - 1 ? "\n" : "");
}

/* A list of the file on one line, where it is short */
static void put_list(const struct emitter *e, bool own, const char *type, const char *name, const char *note, int count,
		     int in_line, const char *const *item)
{
	if (own || count > in_line) {
		open_as(e, own, type, name, format("[%d]", count), note);
		put_items(e, count, in_line, item);
		close_as(e, own);
		return;
	}
	say(e, "\n");
	say_comment(e, "", note);
	say(e, "static const %s $o_%s[%d] = {", type, name, count);
	for (int i = 0; i < count; i++)
		say(e, "%s%s", i > 0 ? ", " : "", item[i]);
	say(e, "};\n");
}

void put_wholes(const struct emitter *e, bool own, const char *name, const char *note, int count, const int *number)
{
	const char **item = ARRAY(const char *, (size_t)count + 1);
	item[0] = "0";
	for (int i = 0; i < count; i++)
		item[i] = integer_text(number[i]);
	put_list(e, own, "int", name, note, count > 0 ? count : 1, 20, item);
}

void put_numbers(const struct emitter *e, const char *name, const char *note, int count, const double *number)
{
	const char **item = ARRAY(const char *, (size_t)count + 1);
	for (int i = 0; i < count; i++)
		item[i] = shortest(number[i]);
	put_list(e, e->model->params.retuned, "double", name, note, count, 6, item);
}

void put_matrix(const struct emitter *e, const char *name, const char *note, int rows, int columns,
		 const double *value, const char *const *row_name)
{
	open_table(e, "double", name, format("[%d][%d]", rows, columns), note);
	emit_number_rows(e, rows, columns, value, row_name);
	close_table(e);
}

void put_matrices(const struct emitter *e, const char *name, const char *note, int count, int rows, int columns,
		   double *const *value, const char *const *row_name)
{
	open_table(e, "double", name, format("[%d][%d][%d]", count, rows, columns), note);
	for (int k = 0; k < count; k++)
		emit_inner_matrix(e, rows, columns, value[k], row_name);
	close_table(e);
}

double **of_branches(const struct emitter *e, const struct pieces *p, size_t of)
{
	double **value = ARRAY(double *, (size_t)e->step->branches);
	for (int k = 0; k < e->step->branches; k++)
		value[k] = *(double *const *)((const char *)&p->piece[k] + of);
	return value;
}

void emit_of_branches(const struct emitter *e, const struct pieces *p, const char *name, const char *note, int columns,
		      size_t of)
{
	const char **row = ARRAY(const char *, (size_t)e->step->branches);
	double **value = of_branches(e, p, of), *all = ARRAY(double, (size_t)(e->step->branches * columns));
	for (int k = 0; k < e->step->branches; k++) {
		row[k] = format("system %d", k);
		for (int i = 0; i < columns; i++)
			all[k * columns + i] = value[k][i];
	}
	put_matrix(e, name, note, e->step->branches, columns, all, row);
}

/* ---- what stands at an entry of tables that there are one of for each matrix ---- */

bool acts_at(const struct region_tables *t, int row, int column)
{
	bool any = t->own && t->own[row * t->columns + column];
	for (int k = t->from; k < t->to; k++)
		any = any || t->value[k][row * t->columns + column] != 0;
	return any;
}

bool agree_at(const struct region_tables *t, int row, int column)
{
	int at = row * t->columns + column;
	bool same = !t->own || !t->own[at];
	for (int k = t->from; k < t->to; k++)
		same = same && t->value[k][at] == t->value[t->from][at];
	return same;
}

/* A number where all agree */
static const char *entry_times(const struct region_tables *t, int row, int column, const char *operand)
{
	if (agree_at(t, row, column))
		return scaled(t->value[t->from][row * t->columns + column], operand);
	const char *text = format("%s[%d][%d]", t->text, row, column);
	return operand ? format("%s * %s", text, operand) : text;
}

const char *row_text(const struct region_tables *t, int row, const char *const *operand,
			    const char *further, int indent)
{
	struct summands s = { 0 };
	for (int j = 0; j < t->columns; j++)
		if (operand[j] && acts_at(t, row, j))
			add_summand(&s, entry_times(t, row, j, *operand[j] ? operand[j] : NULL));
	if (further)
		add_summand(&s, further);
	return sum_of(&s, indent);
}

struct region_tables tables_of_regions(const struct emitter *e, const struct pieces *p, const char *text, int rows,
		      size_t of)
{
	return (struct region_tables){ text, rows, e->step->layout.size, 0, e->step->branches, of_branches(e, p, of),
				       NULL };
}

struct region_tables steps_of_regions(const struct emitter *e, const struct pieces *p, const char *text)
{
	int size = e->step->layout.size;
	return is_compensated(e) ? tables_of_regions(e, p, text, 2 * size, OF_PIECE(gain))
			     : tables_of_regions(e, p, text, size, OF_PIECE(Phi));
}

bool is_table(const struct region_tables *t)
{
	bool differs = false;
	for (int i = 0; i < t->rows; i++)
		for (int j = 0; j < t->columns; j++)
			differs = differs || !agree_at(t, i, j);
	return differs;
}

struct region_tables of_branch(struct region_tables t, int branch)
{
	t.from = branch;
	t.to = branch + 1;
	return t;
}

const char *off_text(const struct emitter *e, const struct pieces *p, int branch, int function,
			    const char *const *size, int indent)
{
	int n = functions_of(e);
	struct region_tables off = tables_of_regions(e, p, spell(e, "$o_chord_off[which]"), n, OF_PIECE(off)),
		      still = tables_of_regions(e, p, spell(e, "$o_still[which]"), 1, OF_PIECE(still));
	still.columns = n;
	if (branch >= 0) {
		off = of_branch(off, branch);
		still = of_branch(still, branch);
	}
	const char *further = NULL;
	if (acts_at(&still, 0, function))
		further = agree_at(&still, 0, function) ? shortest(still.value[still.from][function])
							  : spell(e, "$o_still[which][%d]", function);
	return row_text(&off, function, size, further, indent);
}

/* ---- of a step that is checked for events over h ---- */

static void emit_of_each(const struct emitter *e, const struct region_tables *t, const char *name, const char *note,
			 const char *const *row_name)
{
	put_matrices(e, name, note, e->step->branches, t->rows, t->columns, t->value, row_name);
}

bool any_pieces(const struct emitter *e)
{
	bool any = false;
	for (int k = 0; k < e->step->branches; k++)
		any = any || e->step->branch[k].halvings > 0;
	return any;
}

/* Of each region and switching function */
typedef const char *entry_text(const struct emitter *e, const struct pieces *p, int region, int function);

static void emit_of_regions(const struct emitter *e, const char *type, const char *name, const char *note,
			    const char *inner, entry_text *text, const struct pieces *p)
{
	int regions = e->model->switching->regions, n = functions_of(e);
	open_as(e, false, type, name, format("[%d][%d]%s", regions, n, inner), note);
	for (int r = 0; r < regions; r++)
		for (int i = 0; i < n; i++)
			say(e, "%s%s%s", i == 0 ? "    {" : ", ", text(e, p, r, i), i == n - 1 ? "},\n" : "");
	close_as(e, false);
}

static const char *span_text(const struct emitter *e, const struct pieces *p, int region, int function)
{
	(void)p;
	return integer_text(interval_of(e->model->switching, region, function));
}

static const char *within_text(const struct emitter *e, const struct pieces *p, int region, int function)
{
	int at = region * functions_of(e) + function;
	return format("{%s, %s}", shortest(p->low[at]), shortest(p->high[at]));
}

static const char *beyond_text(const struct emitter *e, const struct pieces *p, int region, int function)
{
	const struct switching *s = e->model->switching;
	int interval = interval_of(s, region, function), stride = s->function[function].stride;
	bool below = interval > 0 && s->region[region - stride].possible,
	     above = interval < s->function[function].breaks && s->region[region + stride].possible;
	(void)p;
	return format("{%d, %d}", below ? region - stride : -1, above ? region + stride : -1);
}

void emit_spans(const struct emitter *e)
{
	emit_of_regions(e, "int", "span",
		     "Number of the interval of each switching function in each region, from the lowest one",
		     "", span_text, NULL);
}

static void emit_neighbours(const struct emitter *e, const struct pieces *p)
{
	emit_of_regions(e, "double", "within",
		     "Lower and upper end of each switching function's interval in each region", "[2]", within_text, p);
	emit_of_regions(e, "int", "beyond",
		     "Regions across those ends, below and above; -1: none that can occur", "[2]", beyond_text, p);
	emit_spans(e);
}

void emit_fast_path_tables(const struct emitter *e, const struct pieces *p, const char *const *function)
{
	int n = functions_of(e);
	struct region_tables off = tables_of_regions(e, p, "", n, OF_PIECE(off)),
			     slack = tables_of_regions(e, p, "", n, OF_PIECE(slack)),
			     third = tables_of_regions(e, p, "", n, OF_PIECE(third)),
		      still = tables_of_regions(e, p, "", 1, OF_PIECE(still));
	still.columns = n;
	if (any_pieces(e)) {
		struct region_tables turn = tables_of_regions(e, p, "", n, OF_PIECE(turn)),
			      bend = tables_of_regions(e, p, "", n, OF_PIECE(bend));
		emit_of_each(e, &turn, "step_tangent",
			     "Slope of each switching function over all of h, in place of a piece: times x, h/3 e'",
			     function);
		emit_of_each(e, &bend, "step_cubic_error",
			     "Bound of its fourth derivative over all of h: times |x|, at least h^4/384 |e''''|",
			     function);
	}
	bool reads = any_pieces(e) || is_checked_by_tables(e->step);    /* what they are off their chords */
	if (reads && is_table(&off))
		emit_of_each(e, &off, "chord_off",
			     CHORD_NOTE, function);
	if (reads && is_table(&still))
		emit_of_branches(e, p, "still",
			     "What the entries of x that are never above 1 (1, cos, sin) add to that bound",
			     n, OF_PIECE(still));
	emit_of_each(e, &slack, "slack",
		     "Rounding error of each switching function and of h e': at most this row times |x|", function);
	emit_of_each(e, &third, "jerk",
		     "Bound of the third derivative of each switching function: times |x|, at least h^3/24 |e'''|",
		     function);
	emit_neighbours(e, p);
}

/* ---- sums as text ---- */

const char **places(const struct emitter *e, const char *layout)
{
	const char **text = ARRAY(const char *, (size_t)e->step->layout.size);
	for (int j = 0; j < e->step->layout.size; j++)
		text[j] = format(layout, j);
	return text;
}

const char **entries(const struct emitter *e, const char *layout)
{
	const char **text = places(e, layout);
	for (int l = 0; l < e->system->loads; l++)
		if (e->step->layout.load[l] >= 0 && !load_operand(e, l, 0))
			text[e->step->layout.load[l]] = "";
	return text;
}

const char *text_of_switching(const struct emitter *e, const struct pieces *p, int function,
				   const char *const *operand, int indent)
{
	int size = e->step->layout.size;
	struct summands s = { 0 };
	for (int j = 0; j < size; j++)
		if (p->row[function * size + j] != 0)
			add_summand(&s, scaled(p->row[function * size + j], *operand[j] ? operand[j] : NULL));
	return sum_of(&s, indent);
}

const char *size_of_x(const struct emitter *e, const struct pieces *p, const char *const *size, int indent)
{
	struct summands s = { 0 };
	for (int j = 0; j < e->step->layout.size; j++)
		if (!p->bounded[j] && *size[j])         /* 1 counts for nothing */
			add_summand(&s, size[j]);
	return sum_of(&s, indent);
}

bool is_compensated(const struct emitter *e)
{
	return e->step->program->compensated;
}

int size_of_vector(const struct emitter *e)
{
	return e->step->layout.size * (is_compensated(e) ? 2 : 1);
}

void emit_state_of_x(const struct emitter *e)
{
	say(e, "    for (i = 0; i < %s; i++) {\n"
	       "        s->y[%s] = x[i];\n", own_states(e), place_in_loop(e));
	if (is_compensated(e))
		say(e, "        s->low[%s] = x[%d + i];\n", place_in_loop(e), e->step->layout.size);
	say(e, "    }\n");
}

const char **listed_twice(int count, const char *const *text)
{
	const char **both = ARRAY(const char *, 2 * (size_t)count);
	for (int i = 0; i < 2 * count; i++)
		both[i] = text[i % count];
	return both;
}

bool regions_change(const struct emitter *e)
{
	return e->model->switching->segments > 1;
}

/* ---- how tables vary with what derivatives are by ---- */

bool has_variation(const struct emitter *e)
{
	return e->step->shown->derivatives && e->step->shown->derivatives->varied;
}

void put_entries(const struct emitter *e, bool own, const char *name, const struct variation *v)
{
	open_as(e, own, "pl_varied", name, format("[%d]", v->entries ? v->entries : 1),
		   "Derivatives of the tables above, where they are not 0: row, column");
	for (int i = 0; i < v->entries; i++)
		say(e, "    { %d, %d, %s },\n", v->entry[i].row, v->entry[i].column, shortest(v->entry[i].value));
	if (!v->entries)
		say(e, "    { 0, 0, 0.0 }\n");
	close_as(e, own);
}

static void emit_varied_steps(const struct emitter *e, const double *over)
{
	const struct derivatives *d = e->step->shown->derivatives;
	const int branches = e->step->branches, rows = d->columns * branches, size = e->step->layout.size;
	const char **note = ARRAY(const char *, (size_t)rows);
	for (int i = 0; i < rows; i++)
		note[i] = format("%s, %d", d->column[i / branches].name, i % branches);
	open_table(e, "double", "varied_step", format("[%d][%d]", rows, size * size),
		   "Derivatives of e^{A h}: of each column those of each linear system");
	emit_number_rows(e, rows, size * size, over, note);
	close_table(e);
}

int varies_params(const struct emitter *e)
{
	const struct derivatives *d = e->step->shown->derivatives;
	return d && d->varied && (e->model->params.retuned || e->model->spec->tuned.derived > 0);
}

bool vary_load(const struct emitter *e, int column, int load, struct varied_load *by)
{
	const struct varied_model *v = &e->step->shown->derivatives->varied[column];
	const struct forcing *more = v->more->system.load[load].forcing, *less = v->less->system.load[load].forcing;
	*by = (struct varied_load){ varied_number(v, more->a, less->a), varied_number(v, more->w, less->w),
				    varied_number(v, more->p, less->p) };
	return by->a != 0 || by->w != 0 || by->p != 0;
}

bool acts_beside(const struct emitter *e, int column)
{
	const struct derivatives *d = e->step->shown->derivatives;
	struct varied_load by;
	bool any = d->column[column].symbol->kind == SYMBOL_INPUT || varies_params(e) ||
		   tunable_of_column(e->step, column) >= 0;
	for (int l = 0; l < e->system->loads && !any; l++)
		any = e->step->layout.load[l] >= 0 && vary_load(e, column, l, &by);
	return any;
}

/* Bit p of a macro: whether in column p e^{A h} varies, or loads and inputs do */
static void emit_columns_that(const struct emitter *e, const char *macro, const double *over, bool move)
{
	const int columns = e->step->shown->derivatives->columns, size = e->step->layout.size,
		  cells = e->step->branches * size * size;
	unsigned long long bits = 0;
	for (int p = 0; p < columns && over; p++) {
		bool any = !move && acts_beside(e, p);
		for (int i = 0; i < cells && move; i++)
			any = any || over[p * cells + i] != 0;
		bits |= (unsigned long long)any << p;
	}
	say_macro(e, macro, format("(UINT64_C(0x%llx) >> (p) & 1u)", bits));
}

void emit_variation(const struct emitter *e, const struct guards *g)
{
	if (!has_variation(e))
		return;
	const int part = e->part ? (int)(e->part - e->step->shown->model->switching->part) : -1;
	const struct variation v = variation_of(e->step, part, g);
	put_wholes(e, false, "varied_first", "Where the derivatives of each table begin, column by column: A of each "
		   "linear system, switching functions, breakpoints, guards, assignments, times of changes",
		   v.blocks + 1, v.first);
	if (!e->model->params.retuned) {
		put_entries(e, false, "varied", &v);
		if (v.over)
			emit_varied_steps(e, v.over);
	}
	say_macro(e, "VARIED_STEP", v.over ? "PL_OF(varied_step)[0]" : "NULL");
	emit_columns_that(e, "ACTING_D(p)", v.over, false);
	emit_columns_that(e, "MOVING_D(p)", v.over, true);
}

void emit_own_variation(const struct emitter *e, const struct guards *g)
{
	if (!has_variation(e))
		return;
	const struct variation v = variation_of(e->step, -1, g);
	put_entries(e, true, "varied", &v);
	if (v.over)
		emit_varied_steps(e, v.over);
}

void emit_variation_macros(const struct emitter *e)
{
	if (!has_variation(e))
		return;
	say_macro(e, "COLUMNS_D", integer_text(e->step->shown->derivatives->columns));
	say_macro(e, "D", spell(e, "$n_d"));
	say_macro(e, "MATRICES_D", integer_text(e->step->branches));
	say_macro(e, "DEGREE_D", integer_text(e->step->series.degree + 3));
	say_macro(e, "SHARED", integer_text(shares_step(e) && functions_of(e) > 0));
	say_macro(e, "RELATIVE", integer_text(e->model->relative != NULL));
}

bool shares_step(const struct emitter *e)
{
	const struct step *all = e->step->shown;
	return has_variation(e) && !all->derivatives->regions && !has_peaks(e) && !all->carried.count;
}

const char *no_variation(const struct emitter *e)
{
	return has_variation(e) ? ", (pl_variation *)0" : "";
}

/* ---- a step that derivatives share ---- */

static const char *samples_text(const struct emitter *e, const char *type, const char *size)
{
	const char *u = given_inputs(e) ? spell(e, format(", %su%s", type, size)) : "";
	return e->step->shown->derivatives->seeded ? spell(e, format("%s, %sdu%s", u, type, size)) : u;
}

const char *sample_parameters(const struct emitter *e)
{
	return samples_text(e, "const double ", "[$N_INPUTS]");
}

const char *sample_arguments(const struct emitter *e)
{
	return samples_text(e, "", "");
}

void declare_shared_step(const struct emitter *e)
{
	const int size = size_of_vector(e);
	if (e->step->regions.event_check.is_made)
		say(e, "static void $o_vary_clear(const $n *s, $n_d *ds%s, const double x[%d]);\n",
		    sample_parameters(e), size);
	say(e, "static void $o_vary_met($n *s, $n_d *ds%s, double x[%d]);\n", sample_parameters(e), size);
	if (e->step->regions.event_check.fast_path)
		say(e, "static void $o_vary_crossed(const $n *s, $n_d *ds%s, double x[%d], pl_contact from);\n",
		    sample_parameters(e), size);
}

void open_shared_step(const struct emitter *e)
{
	open_function(e, "A step, and unless ds is NULL that of derivatives: its events are looked for once",
		      "static PL_INLINE void $n_step_both($n *s, $n_d *ds%s)", sample_parameters(e));
}

void emit_shared_call(const struct emitter *e, const char *function, const char *last)
{
	say(e, "        if (ds != NULL) { $o_%s(s, ds%s, %s); }\n", function, sample_arguments(e), last);
}

void emit_shared_search(const struct emitter *e, const char *x, const char *own)
{
	emit_shared_call(e, "vary_met", x);
	say(e, "        else { $o_%s(s, %s); }\n", own, x);
}

void close_shared_step(const struct emitter *e)
{
	const char *seeds = e->step->shown->derivatives->seeded ? ", NULL" : "";
	close_function(e, e->step->shown->derivatives->seeded ? "du" : "");
	open_function(e, NULL, "%s", head_of_step(e));
	say(e, "    $n_step_both(s, NULL%s%s);\n", given_inputs(e) ? ", u" : "", seeds);
	close_function(e, "");
}
