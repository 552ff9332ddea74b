/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Regions with dry friction as C: their guards, what holds states in them, and the search that goes from event to
 * event. */
#include "inner.h"
#include "emit/text.h"
#include "model/contacts/contacts.h"
#include "model/reads.h"
#include "step/regions/guards.h"

static void emit_guard_list(const struct emitter *e, const struct guards *g)
{
	put_wholes(e, false, "first",
		     "First guard of each region in the list below",
		     e->model->switching->regions + 1, g->first);
	say(e, "\n"
	       "/* Guards, whose events end a region: number of the guard function; switching function, breakpoint\n"
	       " * and direction of its crossing; number of the next region less this; impact that begins, or -1 */\n"
	       "static const pl_guard $o_guard[%d] = {\n", g->guards);
	for (int i = 0; i < g->guards; i++)
		say(e, "    { %d, %d, %d, %d, %d, %d },\n", g->guard[i].row, g->guard[i].function,
		    g->guard[i].breakpoint, g->guard[i].upward, g->guard[i].leads, g->guard[i].impact);
	say(e, "};\n");
}

static void emit_limits(const struct emitter *e, const struct guards *g)
{
	const struct switching *s = e->model->switching;
	double *limit = ARRAY(double, (size_t)g->guards);
	for (int i = 0; i < g->guards; i++)
		limit[i] = g->guard[i].limit;
	put_numbers(e, "limit",
		     "Limit of each guard: its event is where the guard function rises to it",
		     g->guards, limit);
	put_numbers(e, "amplitude",
		     format("Amplitude of cos and sin of loads in each switching function%s, which bounds its rounding",
			    regions_change(e) ? ", segment of time by segment" : ""),
		     s->segments * s->functions, g->amplitude);
	put_numbers(e, "guard_amplitude", "Amplitude of cos and sin of loads in each guard function", g->rows,
		    g->row_amplitude);
}

/* Of each row: a switching function, or what it takes to hold one */
static const char **guard_notes(const struct emitter *e, const struct guards *g)
{
	const struct switching *s = e->model->switching;
	const char **note = ARRAY(const char *, (size_t)g->rows);
	for (int r = 0; r < s->regions; r++)
		for (int i = g->first[r]; i < g->first[r + 1]; i++) {
			int function = g->guard[i].function;
			const char *name = form_text(e->step->shown->model, s->function[function].form);
			bool held = is_stick(&s->function[function], interval_of(s, r, function));
			note[g->guard[i].row] =
				format("system %d: %s%s", g->branch[g->guard[i].row],
				       held                   ? g->guard[i].upward ? "holding force - limit, up: "
										   : "holding force - limit, down: "
				       : g->guard[i].upward ? ""
							    : "less ",
				       name);
		}
	return note;
}

static void emit_guard_rows(const struct emitter *e, const struct guards *g)
{
	const char **note = guard_notes(e, g);
	const struct { const char *name, *note; const double *value; } all[] = {
		{ "guard_row",
		 "Guard functions g = guard_row . x: while a contact slips its switching function, while it "
			  "sticks or rests the holding force less its limit", g->row },
		{ "guard_tangent", "Slope of each guard function along the solution: this row times x is d/3 g', "
			       "d = h/2^halvings", g->slope },
		{ "guard_chord_error", "Bound of its curvature: within d, g leaves its chord by at most d^2/8 |g''|, "
			      "this row times |x|", g->second },
		{ "guard_cubic_error", "Bound of its fourth derivative: g leaves the cubic through its ends and slopes "
			       "by at most d^4/384 |g''''|, this row times |x|", g->fourth }
	};
	for (size_t i = 0; i < sizeof all / sizeof *all; i++)
		put_matrix(e, all[i].name, all[i].note, g->rows, e->step->layout.size, all[i].value, note);
}

static void emit_assignments(const struct emitter *e, const struct guards *g)
{
	int *state = ARRAY(int, (size_t)g->assignments);
	for (int i = 0; i < g->assignments; i++)
		state[i] = g->assignment[i].state;
	put_wholes(e, false, "holding",
		    "Constraint in each region, by friction that sticks or a contact at rest: a set of the assignments "
		    "below; -1: none",
		    e->model->switching->regions, g->hold);
	put_wholes(e, false, "sets", "First assignment of each set", g->sets + 1, g->set);
	put_wholes(e, false, "held", "The state that each assignment holds", g->assignments, state);
}

static void emit_values(const struct emitter *e, const struct guards *g)
{
	int count = g->assignments > 0 ? g->assignments : 1, size = size_of_vector(e);
	double *value = ARRAY(double, (size_t)count * (size_t)size);
	const char **note = ARRAY(const char *, (size_t)count);
	note[0] = "none";
	for (int i = 0; i < g->assignments; i++) {
		note[i] = e->model->names.state[g->assignment[i].state];
		for (int j = 0; j < size; j++)
			value[i * size + j] = g->assignment[i].value[j];
	}
	put_matrix(e, "value",
		    format("Value of each assignment: x[held] = value . x%s",
			   is_compensated(e) ? "; low parts after the high parts" : ""),
		    count, size, value, note);
}

static void emit_impacts(const struct emitter *e, const struct guards *g)
{
	const struct switching *s = e->model->switching;
	int size = e->step->layout.size, all = s->segments * g->impacts, count = all > 0 ? all : 1;
	double *speed = ARRAY(double, (size_t)count * (size_t)size);
	double *back = ARRAY(double, (size_t)count * (size_t)size);
	const char **note = ARRAY(const char *, (size_t)count);
	note[0] = "none";
	open_table(e, "pl_impact", "impact", format("[%d]", count),
		   "Impacts: switching function, breakpoint and direction; interval in which its contact rests; "
		   "assignments of its jump, and of that without restitution; restitution; amplitude of loads in its "
		   "speed");
	for (int i = 0; i < all; i++) {
		const struct impact_row *impact = &g->impact[i];
		say(e, "    { %d, %d, %d, %d, %d, %d, %s, %s },\n", impact->function, impact->breakpoint,
		    impact->upward, impact->rest, impact->jump, impact->still, shortest(impact->restitution),
		    shortest(impact->amplitude));
		note[i] = impact->rest < 0 ? "none"
					   : form_text(e->step->shown->model,
						       s->impact[i % s->impacts].in[i / s->impacts].speed);
		for (int j = 0; j < size; j++) {
			speed[i * size + j] = impact->speed[j];
			back[i * size + j] = impact->back[j];
		}
	}
	if (!all)
		say(e, "    { 0, 0, 0, -1, -1, -1, 0.0, 0.0 }\n");
	close_table(e);
	put_matrix(e, "speed", "Approach speed of each impact: speed . x", count, size, speed, note);
	put_matrix(e, "retreat",
		     "Correction of the state for a penetration of 1, times the depth",
		     count, size, back, note);
}

void emit_guards(const struct emitter *e, const struct guards *g)
{
	emit_guard_list(e, g);
	emit_assignments(e, g);
}

void emit_guards_beside(const struct emitter *e, const struct guards *g)
{
	const struct switching *s = e->model->switching;
	const int count = g->assignments > 0 ? g->assignments : 1;
	SCRATCH int *owner = ARRAY(int, (size_t)count);
	for (int i = 0; i < g->assignments; i++)
		owner[i] = owner_of_hold(s, g->assignment[i].state);
	emit_guards(e, g);
	put_wholes(e, false, "owner", "The switching function by which each assignment holds", count, owner);
	emit_limits(e, g);
	put_matrix(e, "guard_row", "Guard functions g = guard_row . x, in the lowest region and those beside it: what "
		   "one switching function does in its interval", g->rows, e->step->layout.size, g->row,
		   guard_notes(e, g));
	emit_values(e, g);
	emit_impacts(e, g);
}

void emit_numbers_of_guards(const struct emitter *e, const struct guards *g)
{
	emit_limits(e, g);
	emit_guard_rows(e, g);
	emit_values(e, g);
	emit_impacts(e, g);
}

void emit_friction_forces(const struct emitter *e)
{
	const struct switching *s = e->model->switching;
	int size = e->step->layout.size;
	double *friction_force = friction_forces_of(e->step), **row = ARRAY(double *, (size_t)s->regions);
	const char **name = ARRAY(const char *, (size_t)s->transmitted_forces);
	for (int i = 0; i < s->transmitted_forces; i++) {
		const struct atom *a = s->transmitted[i];
		const char *text = a ? text_between(a->node->start, a->node->end) : "a highest derivative";
		name[i] = a && a->function == FN_SLIDE ? format("velocity of %s", text) : text;
	}
	for (int r = 0; r < s->regions; r++)
		row[r] = friction_force + r * s->transmitted_forces * size;
	put_matrices(e, "friction_forces",
		     "Forces of friction and of contacts at rest that outputs read, in each region: this row times x",
		     s->regions, s->transmitted_forces, size, row, name);
}
