/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Regions whose matrices tunable params change: an instance has the tables of its search, which NAME_retune, of
 * retuned.h, computes anew. Here is what both hold. */
#include "inner.h"
#include "emit/regions/regions.h"
#include "step/regions/regions.h"
#include "model/contacts/contacts.h"
#include "step/regions/guards.h"

static const struct tuning *retuned_of(const struct emitter *e)
{
	return e->model->params.retuned;
}

static bool has_guards(const struct emitter *e)
{
	return has_events(e->model->switching);
}

static struct guards own_guards(const struct emitter *e)
{
	struct pieces pieces = pieces_of(e->step);
	return guards_of(e->step, &pieces);
}

/* Of derivatives, whose tables follow from params, too */
static int columns_of(const struct emitter *e)
{
	const struct derivatives *d = e->step->shown->derivatives;
	return d && d->varied ? d->columns : 0;
}

/* Of e^{A h}, at most */
static bool has_varied_steps(const struct emitter *e)
{
	const int cells = e->step->layout.size * e->step->layout.size;
	return columns_of(e) && columns_of(e) * e->step->branches <= LIMIT_TUNED_NUMBERS / cells;
}

/* ---- the equations ---- */

static const struct tuned_equations **list_equations(const struct emitter *e)
{
	const struct tuned_equations **list = ARRAY(const struct tuned_equations *,
						    (size_t)(e->step->branches + 1 + columns_of(e)));
	list[0] = &retuned_of(e)->all;
	for (int k = 0; k < e->step->branches; k++)
		list[k + 1] = &retuned_of(e)->system[k];
	return list;
}

/* Of each column what its entries are the slopes of, in rows that count the entries of all columns */
static struct tuned_equations *slopes_of_tables(const struct emitter *e, const struct variation *v)
{
	const int columns = columns_of(e), blocks = e->step->branches + VARIED_TABLES;
	struct tuned_equations *by = ARRAY(struct tuned_equations, (size_t)columns + 1);
	for (int p = 0; p < columns; p++) {
		by[p].rows = v->entries;
		by[p].columns = 1;
		for (int i = v->first[p * blocks]; i < v->first[(p + 1) * blocks]; i++)
			if (v->entry[i].made.number >= 0)
				*MORE(by[p].entry, by[p].entries) = (struct tuned_entry){ i, 0, v->entry[i].made, 0 };
	}
	return by;
}

static void emit_columns(const struct emitter *e, const struct equations_text *text)
{
	const int columns = columns_of(e);
	say(e, "static const pl_entries $n_varied_number[%d] = {\n", columns);
	for (int p = 0; p < columns; p++)
		say(e, "    %s,\n", text[p].entries);
	say(e, "};\n");
}

/* Of the numbers, then of each system, all by the same formulas; how many these are */
static int emit_numbers(const struct emitter *e, const struct variation *v)
{
	const struct tuning *r = retuned_of(e);
	const int systems = e->step->branches, columns = columns_of(e), count = systems + 1 + columns;
	SCRATCH const struct tuned_equations **list = list_equations(e);
	struct tuned_equations *slopes = slopes_of_tables(e, v);
	for (int p = 0; p < columns; p++)
		list[systems + 1 + p] = &slopes[p];
	struct equations_text *text = ARRAY(struct equations_text, (size_t)count);
	emit_equations(e, r, true, count, list, text);
	say(e, "\nstatic const pl_formulas $n_formulas = %s;\n", text[0].formulas);
	if (r->all.rows)
		say(e, "static const pl_entries $n_numbers = %s;\n", text[0].entries);
	say(e, "static const pl_entries $n_system[%d] = {\n", systems);
	for (int k = 1; k <= systems; k++)
		say(e, "    %s,\n", text[k].entries);
	say(e, "};\n");
	if (columns)
		emit_columns(e, text + systems + 1);
	return operations_behind(r, systems + 1, list);
}

/* ---- which of them go where ---- */

struct list { int count, *number; };

static void add(struct list *l, int number)
{
	ENLARGE(l->number, (size_t)l->count + 1);
	l->number[l->count++] = number;
}

/* Whether a number may have any value, as retuned.h says it */
static int kind_of_check(const struct emitter *e, const struct retuned_row *row)
{
	switch (row->kind) {
	case RETUNED_LEAST: return 0;
	case RETUNED_RESTITUTION:
		return e->model->contacts.impact[row->of % e->model->contacts.impacts].when->restitution ? 1 : 0;
	case RETUNED_SIGN: return row->positive ? 2 : 3;
	default: return -1;
	}
}

static int emit_checks(const struct emitter *e)
{
	const struct tuning *r = retuned_of(e);
	struct list check = { 0 };
	for (int i = 0; i < r->rows; i++) {
		const int kind = kind_of_check(e, &r->row[i]);
		if (r->row[i].place < 0 || kind < 0)
			continue;
		add(&check, r->row[i].place);
		add(&check, kind);
	}
	if (check.count)
		emit_integers(e, "short", "check", check.count, check.number);
	return check.count / 2;
}

static void from(const struct emitter *e, struct list *l, enum retuned_kind kind, int of, int index, bool rotated)
{
	const int number = retuned_place(retuned_of(e), kind, of, index) + 1;
	add(l, rotated ? -number : number);
}

static void list_guard_rows(const struct emitter *e, struct list *l, const struct guards *g)
{
	for (int i = 0; i < g->rows; i++) {
		const struct guard_key *guard_row = &g->guard_row[i];
		if (guard_row->function >= 0)
			from(e, l, RETUNED_FUNCTION, guard_row->segment, guard_row->function, !guard_row->upward);
		else
			from(e, l, RETUNED_RELEASE, guard_row->region, guard_row->release, false);
	}
	for (int i = 0; i < g->guards; i++) {
		const struct guard *guard = &g->guard[i];
		if (g->guard_row[guard->row].function >= 0)
			from(e, l, RETUNED_BREAK, guard->function, guard->breakpoint, !guard->upward);
		else
			add(l, 0);
	}
}

static void list_jumps(const struct emitter *e, struct list *l, const struct guards *g)
{
	const struct switching *s = e->model->switching;
	for (int i = 0; i < g->assignments; i++)
		from(e, l, g->assignment[i].kind, g->assignment[i].of, g->assignment[i].index, false);
	for (int i = 0; i < s->segments * g->impacts; i++) {
		from(e, l, RETUNED_RESTITUTION, i, 0, false);
		from(e, l, RETUNED_SPEED, i, 0, false);
		from(e, l, RETUNED_BACK, i, 0, false);
	}
}

static int emit_from(const struct emitter *e, const struct guards *g)
{
	const struct switching *s = e->model->switching;
	struct list l = { 0 };
	for (int segment = 0; segment < s->segments; segment++)
		for (int i = 0; i < s->functions; i++)
			from(e, &l, RETUNED_FUNCTION, segment, i, false);
	for (int i = 0; i < s->functions; i++)
		for (int k = 0; k < s->function[i].breaks; k++)
			from(e, &l, RETUNED_BREAK, i, k, false);
	if (has_guards(e)) {
		list_guard_rows(e, &l, g);
		list_jumps(e, &l, g);
	}
	for (int k = 0; k < s->regions; k++)
		for (int i = 0; i < s->transmitted_forces; i++)
			from(e, &l, RETUNED_FRICTION, k, i, false);
	bool any = false;
	for (int i = 0; i < l.count; i++)
		any = any || l.number[i] != 0;
	if (any)
		emit_integers(e, "short", "from", l.count, l.number);
	return any ? l.count : 0;
}

/* ---- matrices ---- */

static bool rows_change(const struct emitter *e)
{
	const struct tuning *r = retuned_of(e);
	bool change = false;
	for (int i = 0; i < r->rows; i++)
		change = change || (r->row[i].place >= 0 &&
				    (r->row[i].kind == RETUNED_FUNCTION || r->row[i].kind == RETUNED_RELEASE));
	return change;
}

static int emit_bounded(const struct emitter *e)
{
	struct list l = { 0 };
	for (int m = 0; m < e->system->loads; m++)
		for (int k = 0; k < e->system->load[m].columns && is_bounded_load(e->step, m); k++)
			add(&l, e->step->layout.load[m] + k);
	if (l.count)
		emit_integers(e, "short", "bounded", l.count, l.number);
	return l.count;
}

/* ---- event-free steps ---- */

static void emit_gathering(const struct emitter *e)
{
	int stays, *column = staying_columns(e->step, &stays), *param = ARRAY(int, (size_t)stays);
	struct list pair = { 0 };
	for (int l = 0; l < e->system->loads; l++)
		if (is_bounded_load(e->step, l) && e->system->load[l].columns == 2)
			add(&pair, e->step->layout.load[l]);
	for (int k = 0; k < stays; k++)
		param[k] = param_of_column(e->step, column[k]);
	emit_int_list(e, "stays", stays, column);
	emit_int_list(e, "stay_param", stays, param);
	if (any_still(e->step))
		emit_int_list(e, "pair", pair.count, pair.number);
	say_macro(e, "STAYS", integer_text(stays));
	say_macro(e, "PAIRS", integer_text(pair.count));
	say_macro(e, "STILL", integer_text(any_still(e->step)));
	say_macro(e, "LARGE", shortest(LARGE_ENOUGH));
	say_macro(e, "FOLDED", shortest(FOLDED));
	say_macro(e, "OPEN_END", shortest(OPEN_END));
}

/* ---- retune ---- */

void emit_retuned(const struct emitter *e)
{
	const struct switching *s = e->model->switching;
	const struct guards g = has_guards(e) ? own_guards(e) : (struct guards){ 0 };
	const struct variation v = columns_of(e) ? variation_of(e->step, -1, has_guards(e) ? &g : NULL)
						 : (struct variation){ 0 };
	const int operations = emit_numbers(e, &v), taken = emit_from(e, &g);
	if (has_guards(e))
		emit_integers(e, "short", "guard_branch", g.rows, g.branch);
	if (s->segments > 1)
		emit_integers(e, "short", "segment", e->step->branches, s->system_segment);
	const int checks = emit_checks(e), bounded = has_guards(e) && taken ? emit_bounded(e) : 0;
	emit_sizes(e, "retuned.h", { "PARAMS", e->model->params.held->params }, { "WRAPPED", wraps_retune(e) },
		   { "SIZE", e->step->layout.size },
		   { "STATES", e->system->states }, { "SWITCHING_FUNCTIONS", s->functions },
		   { "BREAKS", breaks_of_all(s) },
		   { "SEGMENTS", s->segments }, { "BRANCHES", e->step->branches },
		   { "ROWS", retuned_of(e)->all.rows }, { "OPERATIONS", operations },
		   { "FROM", taken }, { "CHECKS", checks }, { "BOUNDS", rows_change(e) },
		   { "HALVINGS", LIMIT_PIECES }, { "RUNGS", room_for_rungs(e->step) }, { "GUARDS", g.guards },
		   { "GUARD_ROWS", g.rows }, { "VALUES", g.assignments }, { "IMPACTS", s->segments * g.impacts },
		   { "FRICTION_FORCES", s->regions * s->transmitted_forces },
		   { "BOUNDED", bounded }, { "COLUMNS_D", columns_of(e) }, { "STEPS_D", v.over != NULL },
		   { "EVENT_FREE", e->step->regions.event_check.is_made });
	if (e->step->regions.event_check.is_made)
		emit_gathering(e);
	say_include(e, "retuned.h");
}

int retuned_numbers(const struct emitter *e)
{
	const int size = e->step->layout.size, columns = has_varied_steps(e) ? columns_of(e) : 0;
	return (2 + columns) * e->step->branches * size * size + rungs_of_all(e) * (size + 1) * size;
}

int retuned_kilobytes(const struct emitter *e)
{
	const int size = e->step->layout.size, cells = size * size, real = e->model->request.single ? 4 : 8;
	SCRATCH const struct tuned_equations **list = list_equations(e);
	int twos = operations_behind(retuned_of(e), e->step->branches + 1, list) + retuned_of(e)->all.rows * size +
		   8 * cells;
	twos += has_varied_steps(e) ? 32 * cells : 0;
	return 1 + real * (2 * twos + 4 * cells + 5 * size) / 1024;
}
