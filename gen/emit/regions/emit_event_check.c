/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Regions: an event-free step, as sums with a bound for each switching function. */
#include "inner.h"
#include "emit/steps.h"
#include "model/regions/switching_functions.h"
#include "model/regions/regions.h"
#include "step/exponential/recipe.h"
#include "step/tunable/tuned.h"

#include <string.h>

/* Of each entry of x, "" of 1; slopes of ramps in locals */
const char **operands_of_x(const struct emitter *e)
{
	const struct layout *layout = &e->step->layout;
	const char **text = entries(e, "x[%d]");
	for (int i = 0; i < e->system->states; i++)
		text[i] = e->local[i];
	for (int l = 0; l < e->system->loads; l++)
		for (int k = 0; k < e->system->load[l].columns && layout->load[l] >= 0; k++)
			if (load_operand(e, l, k))
				text[layout->load[l] + k] = load_operand(e, l, k);
	for (int i = 0; i < e->system->inputs; i++) {
		bool ramp = e->system->input[i].hold;
		int of = place_of_input(e, i);
		text[layout->input[i]] = ramp ? sample_kept(e, of) : sample_now(e, of);
		if (ramp)
			text[layout->input[i] + 1] = format("part%d", of);
	}
	return text;
}

/* ---- what a step looks with: numbers, or where params are tunable tables of an instance ---- */

struct check {
	bool own;                   /* tables of an instance; what stays of x is gathered */
	int branch;                 /* of one region; -1: `which` */
	struct region_tables full, row, off;
	const char **x, **end, **size; /* of each entry of x: now, at the end; for bounds its size; NULL: gathered */
	const char *const *whole;   /* now, with what is gathered for rows of states alone */
};

/* Without what stays */
static const char **moving(const struct emitter *e, const char *const *x)
{
	int stays = 0;
	const int *column = e->model->params.retuned ? staying_columns(e->step, &stays) : NULL;
	const char **text = ARRAY(const char *, (size_t)e->step->layout.size);
	for (int j = 0; j < e->step->layout.size; j++)
		text[j] = x[j];
	for (int k = 0; k < stays; k++)
		text[column[k]] = NULL;
	return text;
}

static const char **magnitudes(const struct emitter *e, const char *const *x)
{
	const char **text = ARRAY(const char *, (size_t)e->step->layout.size);
	for (int j = 0; j < e->step->layout.size; j++)
		text[j] = x[j] && *x[j] ? format("pl_magnitude(%s)", x[j]) : "";
	return text;
}

static struct region_tables rows_of_pieces(const struct emitter *e, const struct pieces *p)
{
	struct region_tables rows = {
		"c->row", functions_of(e), e->step->layout.size, 0, 1, ARRAY(double *, 1), NULL
	};
	rows.value[0] = p->row;
	return rows;
}

static bool changes(const struct emitter *e, int branch)
{
	bool any = false;
	for (int k = 0; k < e->step->branches; k++)
		if (branch < 0 || k == branch)
			any = any || e->model->params.retuned->system[k].entries > 0;
	return any;
}

/* What may be other than 0 for some values of the params is read from the tables; what none of them changes is a
 * number. */
static void mark_own(const struct emitter *e, const struct pieces *p, struct check *l)
{
	const struct tuning *r = e->model->params.retuned;
	int size = e->step->layout.size, n = functions_of(e);
	const bool *reached = reached_elsewhere(e->step, l->branch), systems = changes(e, l->branch);
	bool *full = ARRAY(bool, (size_t)(size * size)), *row = ARRAY(bool, (size_t)(n * size)),
	     *off = ARRAY(bool, (size_t)(n * size));
	for (int i = 0; i < e->system->states * size && systems; i++)
		full[i] = reached[i] || i % (size + 1) == 0;
	for (int i = 0; i < n; i++) {
		int place = retuned_place(r, RETUNED_FUNCTION, 0, i);
		for (int k = 0; k < size; k++) {
			int at = i * size + k;
			row[at] = place >= 0 && r->acts[place * size + k];
			for (int j = 0; j < size && (row[at] || p->row[at] != 0) && (systems || place >= 0); j++)
				off[i * size + j] = off[i * size + j] || reached[k * size + j];
		}
	}
	l->full.own = full;
	l->row.own = row;
	l->off.own = off;
	for (int j = 0; j < size; j++)
		l->size[j] = *l->size[j] && !p->bounded[j] ? l->size[j] : NULL;
}

static struct check check_of(const struct emitter *e, const struct pieces *p, const char *const *x, int branch)
{
	const bool own = e->model->params.retuned;
	struct check l = { .own = own, .branch = branch, .row = rows_of_pieces(e, p), .x = moving(e, x),
			  .end = moving(e, entries(e, "end%d")), .whole = x };
	l.size = magnitudes(e, l.x);
	l.full = steps_of_regions(e, p, own && branch >= 0 ? format("c->pieces[%d]", branch) : "factor");
	l.off = tables_of_regions(e, p, own && branch >= 0 ? format("c->chord_off[%d]", branch) : "c->chord_off[which]",
				  functions_of(e), OF_PIECE(off));
	if (branch >= 0) {
		l.full = of_branch(l.full, branch);
		l.off = of_branch(l.off, branch);
	}
	if (own)
		mark_own(e, p, &l);
	return l;
}

static const char *end_text(const struct emitter *e, const struct check *l, int i)
{
	const char *added = NULL;
	if (l->own && any_stays(e->step) && i < e->system->states)
		added = l->branch < 0 ? format("c->added[which][%d]", i) : format("c->added[%d][%d]", l->branch, i);
	return row_text(&l->full, i, i < e->system->states ? l->x : l->whole, added, 22);
}

static const char *bound_text(const struct emitter *e, const struct pieces *p, const struct check *l, int i, int indent)
{
	const char *still = NULL;
	if (!l->own)
		return off_text(e, p, l->branch, i, l->size, indent);
	if (any_still(e->step))
		still = l->branch < 0 ? format("c->still[which][%d]", i) : format("c->still[%d][%d]", l->branch, i);
	return row_text(&l->off, i, l->size, still, indent);
}

/* Of an instance, gathered, switching functions may be one and the same: the first of them */
static int leader(const struct check *l, int function)
{
	const struct region_tables *t = &l->row;
	int i = 0;
	for (; i < function && l->own; i++) {
		const double *a = t->value[0] + i * t->columns, *b = t->value[0] + function * t->columns;
		bool same = true;
		for (int j = 0; j < t->columns && same; j++)
			same = !t->own[i * t->columns + j] && !t->own[function * t->columns + j] &&
			       (!l->x[j] || a[j] == b[j]);
		if (same)
			return i;
	}
	return function;
}

static bool is_read_at_end(const struct emitter *e, const struct check *l, int entry)
{
	bool read = false;
	for (int i = 0; i < functions_of(e); i++)
		read = read || acts_at(&l->row, i, entry);
	return read && l->x[entry];
}

/* ---- by tables of all regions, or region by region ---- */

/* What a row's second words add, and its first ones of what rounding has taken */
static const char *small_text(const struct emitter *e, const struct region_tables *full, int row,
			      const char *const *x, int indent)
{
	const char **rest = ARRAY(const char *, (size_t)full->columns);
	for (int i = 0; i < e->system->states; i++)
		rest[i] = format("s->low[%d]", place_of_state(e, i));
	const char *of_rest = row_text(full, row, rest, NULL, indent + 1), *further = NULL;
	if (strcmp(of_rest, "0.0") != 0)
		further = format("(%s)", of_rest);
	return row_text(full, e->step->layout.size + row, x, further, indent);
}

static void emit_end(const struct emitter *e, const struct check *l, int row, const char *before, const char *name)
{
	int indent = 24 + (int)strlen(before);
	const struct region_tables *full = &l->full;
	const char **x = l->x;
	if (!is_compensated(e))
		say(e, "    %send%d = %s;  /* %s */\n", before, row, end_text(e, l, row), name);
	else if (row >= e->system->states)
		say(e, "    %send%d = %s + (%s);  /* %s */\n", before, row, *x[row] ? x[row] : "1.0",
		    row_text(full, row, x, NULL, indent), name);
	else
		say(e, "    %send%d = pl_accumulate(%s,  /* %s */\n"
		       "%*s%s,\n"
		       "%*s%s, &low%d);\n", before, row, x[row], name, indent, "",
		    row_text(full, row, x, NULL, indent), indent, "", small_text(e, full, row, x, indent), row);
}

static void emit_ends(const struct emitter *e, const struct check *l, const char *before)
{
	const char **name = layout_names(&e->step->layout, e->system, e->model);
	for (int i = 0; i < e->step->layout.size; i++)
		if (i < e->system->states || is_read_at_end(e, l, i))
			emit_end(e, l, i, before, name[i]);
}

/* Whether it is between two bounds, with how far it may be off the chord between */
static void emit_within(const struct emitter *e, const struct check *l)
{
	const struct switching *s = e->model->switching;
	say(e, "    if (");
	for (int i = 0, first = 0; i < s->functions; first += s->function[i++].breaks + 2) {
		int k = leader(l, i);
		const char *low = l->own ? format("c->edge[%d + span[%d]]", first, i)
					 : spell(e, "$o_within[s->contact$p.region][%d][0]", i);
		const char *high = l->own ? format("c->edge[%d + span[%d]]", first + 1, i)
					  : spell(e, "$o_within[s->contact$p.region][%d][1]", i);
		say(e, "(from%d < to%d ? from%d : to%d) - off%d > %s &&\n"
		       "        (from%d > to%d ? from%d : to%d) + off%d < %s &&\n"
		       "        ", k, k, k, k, k, low, k, k, k, k, k, high);
	}
}

static void emit_table_step(const struct emitter *e, const struct pieces *p, const char *const *x)
{
	const struct check l = check_of(e, p, x, -1);
	say(e, "    const int which = s->contact$p.matrix;\n");
	if (l.own)
		say(e, "    const int *const span = $o_span[s->contact$p.region];\n");
	say(e, "    const double (*const factor)[%d] = %s[which];\n", e->step->layout.size,
	    l.own ? "c->pieces" : spell(e, "$o_pieces"));
	emit_ends(e, &l, "const double ");
	for (int i = 0; i < functions_of(e); i++) {
		if (leader(&l, i) != i)
			continue;
		say(e, "    const double from%d = %s;\n", i, row_text(&l.row, i, l.x, NULL, 24));
		say(e, "    const double to%d = %s;\n", i, row_text(&l.row, i, l.end, NULL, 24));
		say(e, "    const double off%d = %s;\n", i, bound_text(e, p, &l, i, 24));
	}
	emit_within(e, &l);
}

/* Of a switching function at the start and at the end: the state itself, or a local */
static const char *short_text(const char *text, const char *local, int function)
{
	return strchr(text, ' ') ? format("%s%d", local, function) : text;
}

/* An end of an interval, with what comes before it in the condition: beyond it is `than` */
static void emit_side(const struct emitter *e, bool first, const char *from, const char *to, int function, bool upper,
		      const char *than)
{
	say(e, "%s(%s %c %s ? %s : %s) %c off%d %c %s", first ? "" : " &&\n                     ", from,
	    upper ? '>' : '<', to, from, to, upper ? '+' : '-', function, upper ? '<' : '>', than);
}

/* Whether all switching functions keep inside their intervals */
static void emit_inside(const struct emitter *e, const struct pieces *p, const struct check *l, int region)
{
	const struct switching *s = e->model->switching;
	bool first = true;
	say(e, "        event_free = ");
	for (int i = 0, edge = 0; i < s->functions; edge += s->function[i++].breaks + 2) {
		int k = leader(l, i), interval = interval_of(s, region, i), at = region * s->functions + i;
		const char *from = short_text(row_text(&l->row, k, l->x, NULL, 0), "from", k),
			   *to = short_text(row_text(&l->row, k, l->end, NULL, 0), "to", k);
		if (interval > 0) {
			emit_side(e, first, from, to, k, false,
				  l->own ? format("c->edge[%d]", edge + interval) : shortest(p->low[at]));
			first = false;
		}
		if (interval < s->function[i].breaks) {
			emit_side(e, first, from, to, k, true,
				  l->own ? format("c->edge[%d]", edge + interval + 1) : shortest(p->high[at]));
			first = false;
		}
	}
	say(e, ";\n"
	       "        break;\n");
}

static void emit_region_case(const struct emitter *e, const struct pieces *p, const char *const *x, int region)
{
	const struct check l = check_of(e, p, x, e->model->switching->region[region].system);
	say(e, "    case %d:\n", region);
	emit_ends(e, &l, "    ");
	for (int i = 0; i < functions_of(e); i++) {
		const char *from = row_text(&l.row, i, l.x, NULL, 15), *to = row_text(&l.row, i, l.end, NULL, 15);
		if (leader(&l, i) != i)
			continue;
		if (strchr(from, ' '))
			say(e, "        from%d = %s;\n", i, from);
		if (strchr(to, ' '))
			say(e, "        to%d = %s;\n", i, to);
		say(e, "        off%d = %s;\n", i, bound_text(e, p, &l, i, 15));
	}
	emit_inside(e, p, &l, region);
}

static void emit_case_begin(const struct emitter *e, const char *locals)
{
	say(e, "    double %s;\n"
	       "    int event_free = 0;\n"
	       "    switch (s->contact$p.region) {\n", locals);
}

static void emit_case_end(const struct emitter *e)
{
	say(e, "    default:\n"
	       "        break;\n"
	       "    }\n"
	       "    if (event_free && ");
}

/* ends, and how far switching functions may be off their chords: in each region its own numbers */
static void emit_cases(const struct emitter *e, const struct pieces *p, const char *const *x)
{
	const struct switching *s = e->model->switching;
	const struct check l = check_of(e, p, x, -1);
	const char *list = "";
	for (int i = 0; i < e->step->layout.size; i++)
		if (i < e->system->states || is_read_at_end(e, &l, i))
			list = format("%s%send%d = 0.0", list, *list ? ", " : "", i);
	for (int i = 0; i < s->functions; i++) {
		if (leader(&l, i) != i)
			continue;
		list = format("%s, off%d", list, i);
		if (strchr(row_text(&l.row, i, l.x, NULL, 0), ' '))
			list = format("%s, from%d", list, i);
		if (strchr(row_text(&l.row, i, l.end, NULL, 0), ' '))
			list = format("%s, to%d", list, i);
	}
	say(e, "    /* In each region: the state after h; how far a switching function may leave its chord */\n");
	emit_case_begin(e, list);
	for (int r = 0; r < s->regions; r++)
		if (s->region[r].possible)
			emit_region_case(e, p, x, r);
	emit_case_end(e);
}

void emit_slopes_of_ramps(const struct emitter *e)
{
	for (int i = 0; i < e->system->inputs; i++) {
		int of = place_of_input(e, i);
		if (e->system->input[i].hold)
			say(e, "    const double part%d = %s;  /* its slope */\n", of,
			    spell(e, "(u[%d] - s->u[%d]) / $N_H", of, of));
	}
}

void emit_event_check(const struct emitter *e)
{
	struct pieces pieces = pieces_of(e->step);
	const struct layout *layout = &e->step->layout;
	const char **x = operands_of_x(e);
	emit_slopes_of_ramps(e);
	for (int i = 0; i < e->system->states && is_compensated(e); i++)
		say(e, "    double low%d = s->low[%d];\n", i, place_of_state(e, i));
	if (e->model->params.retuned)
		say(e, "    const $n_coeffs *const c = &s->coeffs;\n");
	if (is_checked_by_tables(e->step))
		emit_table_step(e, &pieces, x);
	else
		emit_cases(e, &pieces, x);
	say(e, "%s < %s) {\n", size_of_x(e, &pieces, magnitudes(e, moving(e, x)), 12),
	    !e->model->params.retuned              ? shortest(pieces.large)
	    : is_checked_by_tables(e->step) ? "c->large[which]"
					    : "c->large[s->contact.matrix]");
	if (shares_step(e)) {
		say(e, "        if (ds != NULL) {\n"
		       "            double now[%d];\n", size_of_vector(e));
		for (int j = 0; j < layout->size; j++)
			say(e, "            now[%d] = %s;\n", j, *x[j] ? x[j] : "1.0");
		emit_shared_call(e, "vary_clear", "now");
		say(e, "        }\n");
	}
	for (int i = 0; i < e->system->states; i++)
		say(e, "        s->y[%d] = end%d;\n", place_of_state(e, i), i);
	for (int i = 0; i < e->system->states && is_compensated(e); i++)
		say(e, "        s->low[%d] = low%d;\n", place_of_state(e, i), i);
	say(e, "        s->contact$p.crossings = 0;\n"
	       "    } else {\n"
	       "        double now[%d];\n", size_of_vector(e));
	for (int j = 0; j < layout->size; j++)
		say(e, "        now[%d] = %s;\n", j, *x[j] ? x[j] : "1.0");
	for (int j = 0; j < layout->size && is_compensated(e); j++)
		say(e, "        now[%d] = %s;\n", layout->size + j,
		    j < e->system->states ? format("s->low[%d]", place_of_state(e, j)) : "0.0");
	const bool fast = e->step->regions.event_check.fast_path;
	if (shares_step(e)) {
		if (fast)
			say(e, "        const pl_contact from = s->contact$p;\n"
			       "        if ($o_cross(s, now)) {\n"
			       "        if (ds != NULL) { $o_vary_crossed(s, ds%s, now, from); }\n"
			       "        } else\n", sample_arguments(e));
		emit_shared_search(e, "now", "seek");
		say(e, "    }\n");
		return;
	}
	say(e, fast ? "        if (!$o_cross(s, now)) { $o_seek(s, now); }\n"
		      "    }\n"
		    : "        $o_seek(s, now);\n"
		      "    }\n");
}

/* ---- the same over lanes of a batch: each in its region, those left that may have an event ---- */

const char **params_in_x(const struct emitter *e, int *count)
{
	const char **x = operands_of_x(e);
	int first = e->step->layout.size;
	while (first > e->system->states && strncmp(x[first - 1], "s->coeffs.", 10) == 0)
		first--;
	for (int j = e->system->states; j < first; j++)
		if (strncmp(x[j], "s->coeffs.", 10) == 0)
			internal_error(e->step, "params are the last entries of x");
	*count = e->step->layout.size - first;
	return x + first;
}

/* Is an entry of x of each instance: a state, a param? */
static bool is_own_entry(const struct emitter *e, int j)
{
	int params;
	params_in_x(e, &params);
	return j < e->system->states || j >= e->step->layout.size - params;
}

/* A sum of what all instances share is one number for all lanes. */
static const char *over_lanes(const struct emitter *e, const struct region_tables *t, int row,
			      const char *const *operand, const char *text)
{
	bool any = false;
	for (int j = 0; j < e->step->layout.size; j++)
		any = any || (is_own_entry(e, j) && operand[j] && acts_at(t, row, j));
	return any ? text : format("pl_lanes_all(%s)", text);
}

/* Of states and params lanes, of what all instances share numbers */
static const char **operands_over_lanes(const struct emitter *e)
{
	const char **x = operands_of_x(e);
	int params, size = e->step->layout.size;
	params_in_x(e, &params);
	for (int j = e->system->states; j < size - params; j++)
		x[j] = *x[j] ? format("now[%d]", j - e->system->states) : "";
	for (int k = 0; k < params; k++)
		x[size - params + k] = format("factor[%d]", k);
	return x;
}

static const char **sizes_over_lanes(const struct emitter *e, const char *const *x)
{
	const char **size = magnitudes(e, x);
	for (int j = 0; j < e->step->layout.size; j++)
		if (is_own_entry(e, j))
			size[j] = format("pl_lanes_size(%s)", x[j]);
	return size;
}

static void emit_side_over_lanes(const struct emitter *e, const char *from, const char *to, int function, bool upper,
				 double than)
{
	const char *ends = format("pl_lanes_%s(%s, %s)", upper ? "larger" : "smaller", from, to);
	const char *reached = format("%s %c off%d", ends, upper ? '+' : '-', function);
	const char *edge = format("pl_lanes_all(%s)", shortest(than));
	say(e, "        here = pl_lanes_both(here, pl_lanes_below(%s, %s));\n", upper ? reached : edge,
	    upper ? edge : reached);
}

/* A switching function at the start, or the end: the state itself, or a local */
static const char *function_over_lanes(const struct emitter *e, const struct check *l, int i, const char *local,
				       const char *const *x)
{
	const char *text = row_text(&l->row, i, x, NULL, 22);
	bool lanes = strncmp(over_lanes(e, &l->row, i, x, text), "pl_lanes_all", 12) != 0;
	if (lanes && !strchr(text, ' '))
		return text;
	say(e, "        const pl_lanes %s%d = %s;\n", local, i, over_lanes(e, &l->row, i, x, text));
	return format("%s%d", local, i);
}

static void emit_function_over_lanes(const struct emitter *e, const struct pieces *p, const struct check *l, int region,
				     int i)
{
	const struct switching *s = e->model->switching;
	const int interval = interval_of(s, region, i), at = region * s->functions + i;
	const char *from = function_over_lanes(e, l, i, "from", l->x), *to = function_over_lanes(e, l, i, "to", l->end);
	say(e, "        const pl_lanes off%d = %s;\n", i,
	    over_lanes(e, &l->off, i, l->size, off_text(e, p, l->branch, i, l->size, 22)));
	if (interval > 0)
		emit_side_over_lanes(e, from, to, i, false, p->low[at]);
	if (interval < s->function[i].breaks)
		emit_side_over_lanes(e, from, to, i, true, p->high[at]);
}

static void emit_region_over_lanes(const struct emitter *e, const struct pieces *p, const char *const *x, int region)
{
	struct check l = check_of(e, p, x, e->model->switching->region[region].system);
	const char **name = layout_names(&e->step->layout, e->system, e->model);
	const int states = e->system->states;
	l.size = sizes_over_lanes(e, x);
	say(e, "    here = pl_lanes_both(small, pl_lanes_equal(y[%d], pl_lanes_all(%d.0)));\n"
	       "    if (pl_lanes_flags(here) != 0) {\n", states, region);
	for (int i = 0; i < e->step->layout.size; i++) {
		const char *end = row_text(&l.full, i, x, NULL, 22);
		if (i < states || is_read_at_end(e, &l, i))
			say(e, "        const %s end%d = %s;  /* %s */\n",
			    is_own_entry(e, i) ? "pl_lanes" : "double", i,
			    is_own_entry(e, i) ? over_lanes(e, &l.full, i, x, end) : end, name[i]);
	}
	for (int i = 0; i < functions_of(e); i++)
		emit_function_over_lanes(e, p, &l, region, i);
	for (int i = 0; i < states; i++)
		say(e, "        y[%d] = pl_lanes_choose(here, end%d, y[%d]);\n", i, i, i);
	say(e, "        stepped = pl_lanes_either(stepped, here);\n"
	       "    }\n");
}

void emit_lanes_check(const struct emitter *e)
{
	const struct switching *s = e->model->switching;
	struct pieces pieces = pieces_of(e->step);
	const char **x = operands_over_lanes(e);
	open_function(e, "One step of the lanes that have no event in it; behind the states y has the region",
		      "PL_LANES_INLINE pl_lanes_truth $n_lanes_step(pl_lanes *y, const pl_lanes *factor, "
		      "const double *now)");
	for (int i = 0; i < e->system->states; i++)
		say(e, "    const pl_lanes %s = y[%d];\n", x[i], i);
	say(e, "    const pl_lanes_truth small = pl_lanes_below(%s, pl_lanes_all(%s));\n"
	       "    pl_lanes_truth here, stepped = pl_lanes_below(pl_lanes_all(0.0), "
	       "pl_lanes_all(-1.0));\n",
	    size_of_x(e, &pieces, sizes_over_lanes(e, x), 22), shortest(pieces.large));
	for (int r = 0; r < s->regions; r++)
		if (s->region[r].possible)
			emit_region_over_lanes(e, &pieces, x, r);
	say(e, "    (void)factor;\n"
	       "    (void)now;\n"
	       "    return stepped;\n"
	       "}\n");
}
