/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Regions with dry friction as C: their guards, what holds states in them, and the search that goes from event to
 * event. */
#include "emit/emit.h"

static void emit_numbers(const struct emitter *e, int count, const int *number)
{
	for (int i = 0; i < count; i++)
		say(e, "%s%d", i == 0 ? "" : i % 20 ? ", " : ",\n    ", number[i]);
}

static void emit_list(const struct emitter *e, const char *name, const char *note, int count, const double *number)
{
	open_table(e, name, format("[%d]", count), note);
	say(e, "    ");
	for (int i = 0; i < count; i++)
		say(e, "%s%s", i == 0 ? "" : i % 8 ? ", " : ",\n    ", shortest(number[i]));
	say(e, "\n");
	close_table(e);
}

static void emit_guard_list(const struct emitter *e, const struct guards *g)
{
	const struct switching *s = e->model->switching;
	say(e, "\n"
	       "static const int $o_first[%d] = {  /* guards of each region */\n"
	       "    ", s->regions + 1);
	emit_numbers(e, s->regions + 1, g->first);
	say(e, "\n"
	       "};\n"
	       "\n"
	       "static const pl_guard $o_guard[%d] = {  /* row, expression, breakpoint, upward, leads, impact */\n",
	    g->guards);
	for (int i = 0; i < g->guards; i++)
		say(e, "    { %d, %d, %d, %d, %d, %d },\n", g->guard[i].row, g->guard[i].expression,
		    g->guard[i].breakpoint, g->guard[i].upward, g->guard[i].leads, g->guard[i].impact);
	say(e, "};\n");
}

static void emit_limits(const struct emitter *e, const struct guards *g)
{
	const struct switching *s = e->model->switching;
	double *limit = ARRAY(double, (size_t)g->guards);
	for (int i = 0; i < g->guards; i++)
		limit[i] = g->guard[i].limit;
	emit_list(e, "limit", "of each guard", g->guards, limit);
	emit_list(e, "play",
		  regions_change(e) ? "factors of cos and sin in each expression, segment of time by segment"
				    : "factors of cos and sin in each expression",
		  s->segments * s->expressions, g->play);
	emit_list(e, "gate_play", "in each row of guards", g->rows, g->row_play);
}

/* Of each row: an expression, or what it takes to hold one */
static const char **gate_notes(const struct emitter *e, const struct guards *g)
{
	const struct switching *s = e->model->switching;
	const char **note = ARRAY(const char *, (size_t)g->rows);
	for (int r = 0; r < s->regions; r++)
		for (int i = g->first[r]; i < g->first[r + 1]; i++) {
			int expression = g->guard[i].expression;
			const char *name = form_text(e->step->shown->model, s->expression[expression].form);
			bool held = is_stick(&s->expression[expression], interval_of(s, r, expression));
			note[g->guard[i].row] =
				format("system %d: %s%s", g->branch[g->guard[i].row],
				       held                   ? g->guard[i].upward ? "what holds, less what can, back: "
										   : "what holds, less what can, on: "
				       : g->guard[i].upward ? ""
							    : "less ",
				       name);
		}
	return note;
}

static void emit_gates(const struct emitter *e, const struct guards *g)
{
	const char **note = gate_notes(e, g);
	const struct { const char *name, *note; const double *value; } all[] = {
		{ "gate", "rows of guards", g->row },
		{ "gate_lean", "d/3 times the slope of each", g->slope },
		{ "gate_sag", "d^2/8 times its second derivative, at most", g->second },
		{ "gate_sway", "d^4/384 times its fourth derivative, at most", g->fourth }
	};
	for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
		open_table(e, all[i].name, format("[%d][%d]", g->rows, e->step->layout.size), all[i].note);
		emit_number_rows(e, g->rows, e->step->layout.size, all[i].value, note);
		close_table(e);
	}
}

static void emit_assignments(const struct emitter *e, const struct guards *g)
{
	int count = g->assignments;
	const struct switching *s = e->model->switching;
	say(e, "\n"
	       "static const int $o_holding[%d] = {  /* of each region: what holds its states, a set; -1: nothing */\n"
	       "    ", s->regions);
	emit_numbers(e, s->regions, g->hold);
	say(e, "\n"
	       "};\n"
	       "static const int $o_sets[%d] = {", g->sets + 1);
	emit_numbers(e, g->sets + 1, g->set);
	say(e, "};\n"
	       "static const int $o_held[%d] = {", count > 0 ? count : 1);
	for (int i = 0; i < count; i++)
		say(e, "%s%d", i ? ", " : "", g->assignment[i].state);
	say(e, "%s};\n", count > 0 ? "" : "0");
}

static void emit_values(const struct emitter *e, const struct guards *g)
{
	int count = g->assignments > 0 ? g->assignments : 1, size = size_of_vector(e);
	double *value = ARRAY(double, (size_t)count * (size_t)size);
	const char **note = ARRAY(const char *, (size_t)count);
	note[0] = "none";
	for (int i = 0; i < g->assignments; i++) {
		note[i] = e->model->state_name[g->assignment[i].state];
		for (int j = 0; j < size; j++)
			value[i * size + j] = g->assignment[i].value[j];
	}
	open_table(e, "value", format("[%d][%d]", count, size),
		   keeps_rest(e) ? "x[held] = value . x; second words behind the first ones" : "x[held] = value . x");
	emit_number_rows(e, count, size, value, note);
	close_table(e);
}

static void emit_impacts(const struct emitter *e, const struct guards *g)
{
	const struct switching *s = e->model->switching;
	int size = e->step->layout.size, all = s->segments * g->impacts, count = all > 0 ? all : 1;
	double *speed = ARRAY(double, (size_t)count * (size_t)size);
	double *back = ARRAY(double, (size_t)count * (size_t)size);
	const char **note = ARRAY(const char *, (size_t)count);
	note[0] = "none";
	if (e->model->retuned)
		say(e, "    {");
	else
		say(e, "\nstatic const pl_impact $o_impact[%d] = {", count);
	say(e, "  /* expression, breakpoint, upward, rest, jump, still, restitution, play%s */\n",
	    regions_change(e) ? "; segment of time by segment" : "");
	for (int i = 0; i < all; i++) {
		const struct struck *impact = &g->impact[i];
		say(e, "    { %d, %d, %d, %d, %d, %d, %s, %s },\n", impact->expression, impact->breakpoint,
		    impact->upward, impact->rest, impact->jump, impact->still, shortest(impact->restitution),
		    shortest(impact->play));
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
	open_table(e, "speed", format("[%d][%d]", count, size), "of what bounces");
	emit_number_rows(e, count, size, speed, note);
	close_table(e);
	open_table(e, "back", format("[%d][%d]", count, size),
		   "times how far its expression is beyond: onto the guard");
	emit_number_rows(e, count, size, back, note);
	close_table(e);
}

void emit_guards(const struct emitter *e, const struct guards *g)
{
	emit_guard_list(e, g);
	emit_assignments(e, g);
}

void emit_numbers_of_guards(const struct emitter *e, const struct guards *g)
{
	emit_limits(e, g);
	emit_gates(e, g);
	emit_values(e, g);
	emit_impacts(e, g);
	if (e->model->retuned && e->model->switching->felts > 0)
		emit_grips(e);
}

void emit_grips(const struct emitter *e)
{
	const struct switching *s = e->model->switching;
	int size = e->step->layout.size;
	const double *grip = grips_of(e->step);
	const char **name = ARRAY(const char *, (size_t)s->felts);
	for (int i = 0; i < s->felts; i++) {
		const struct node *node = s->felt[i]->node;
		const char *text = text_between(node->start, node->end);
		name[i] = s->felt[i]->function == FN_SLIDE ? format("velocity of %s", text) : text;
	}
	if (e->model->retuned)
		say(e, "    {  /* grips: of each region: what friction carries */\n");
	else
		say(e, "\n"
		       "static const double $n_grips[%d][%d][%d] = {  /* of each region: what friction carries */\n",
		    s->regions, s->felts, size);
	for (int r = 0; r < s->regions; r++) {
		say(e, "  {\n");
		emit_number_rows(e, s->felts, size, grip + r * s->felts * size, name);
		say(e, "  },\n");
	}
	close_table(e);
}
