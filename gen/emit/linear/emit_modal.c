/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A step of modes: s->y holds the real parts of the pairs, then their imaginary parts, then what is real. */
#include "inner.h"
#include "step/linear/forms.h"
#include "step/tapes.h"

#include <string.h>

static const char **mode_names(const struct emitter *e)
{
	const struct modal *modal = e->step->modal;
	const char **name = ARRAY(const char *, (size_t)modal->states);
	for (int i = 0; i < modal->states; i++)
		name[i] = i < modal->pairs	 ? format("mode %d, real part", i + 1)
			  : i < 2 * modal->pairs ? format("mode %d, imaginary part", i - modal->pairs + 1)
						 : format("mode %d", i - modal->pairs + 1);
	return name;
}

/* Rows over all modes */
static void emit_mode_rows(const struct emitter *e, const char *what, const char *name, int rows, const double *value,
			   const char *const *note)
{
	emit_array(e, what, name, 2, (const int[]){ rows, e->step->modal->states }, value, note);
}

static const double *column_of(const struct emitter *e, const struct operand *operand)
{
	const struct modal *modal = e->step->modal;
	const bool load = operand->kind == OPERAND_LOAD;
	const int columns = load ? modal->loads : modal->inputs;
	double *value = ARRAY(double, (size_t)modal->states);
	for (int i = 0; i < modal->states; i++)
		value[i] = (load ? modal->load : modal->input)[i * columns + operand->index];
	return value;
}

/* The loads and inputs that move some mode; returns how many */
static int driving(const struct emitter *e, struct operand *list)
{
	const struct modal *modal = e->step->modal;
	int count = 0;
	for (int k = 0; k < modal->loads + modal->inputs; k++) {
		const struct operand operand = k < modal->loads ? (struct operand){ OPERAND_LOAD, k }
								 : (struct operand){ OPERAND_INPUT, k - modal->loads };
		const double *value = column_of(e, &operand);
		bool moves = false;
		for (int i = 0; i < modal->states; i++)
			moves = moves || value[i] != 0;
		if (moves)
			list[count++] = operand;
	}
	return count;
}

static struct operand *operands(const struct emitter *e)
{
	return ARRAY(struct operand, (size_t)(e->step->modal->loads + e->step->modal->inputs));
}

static void emit_driving(const struct emitter *e)
{
	const struct modal *modal = e->step->modal;
	struct operand *list = operands(e);
	const int count = driving(e, list), states = modal->states;
	if (count == 0)
		return;
	double *value = ARRAY(double, (size_t)(count * states));
	const char **note = ARRAY(const char *, (size_t)count);
	for (int k = 0; k < count; k++) {
		const double *column = column_of(e, &list[k]);
		for (int i = 0; i < states; i++)
			value[k * states + i] = column[i];
		note[k] = list[k].kind == OPERAND_LOAD ? "a load" : "an input";
	}
	emit_mode_rows(e, "What loads and inputs add to the modes in a step", "driven", count, value, note);
}

static void emit_output_modes(const struct emitter *e)
{
	const struct model *model = e->model;
	const char **note = ARRAY(const char *, (size_t)model->outputs);
	for (int i = 0; i < model->outputs; i++)
		note[i] = model->output[i].name;
	emit_mode_rows(e, "What the outputs see of the modes", "seen", model->outputs, e->step->modal->output, note);
}

/* row . x, in eight sums that compilers keep in registers */
static void emit_dot(const struct emitter *e)
{
	enum { SUMS = 8 };
	const int states = e->system->states, full = states / SUMS * SUMS;
	if (e->wide)
		open_function(e, NULL, "PL_LANES_INLINE pl_lanes $n_lanes_dot(%sconst double *row, const pl_lanes *x)",
			      e->device && strncmp(e->device, "__", 2) == 0 ? "__constant " : "");
	else
		open_function(e, NULL, "static double $n_dot(const double row[$N_STATES], const double x[$N_STATES])");
	say(e, e->wide ? "    pl_lanes a = pl_lanes_all(0.0), b = a, c = a, d = a, e = a, f = a, g = a, h = a;\n"
		       : "    double a = 0.0, b = 0.0, c = 0.0, d = 0.0, e = 0.0, f = 0.0, g = 0.0, h = 0.0;\n");
	if (full)
		say(e, "    int i;\n"
		       "    for (i = 0; i < %d; i += %d) {\n", full, SUMS);
	for (int k = 0; k < SUMS && full; k++)
		say(e, "        %c += row[%s] * x[%s];\n", 'a' + k, k ? format("i + %d", k) : "i",
		    k ? format("i + %d", k) : "i");
	if (full)
		say(e, "    }\n");
	for (int k = full; k < states; k++)
		say(e, "    %c += row[%d] * x[%d];\n", 'a' + k - full, k, k);
	say(e, "    return ((a + e) + (b + f)) + ((c + g) + (d + h));\n");
	close_function(e, "");
}

void emit_modes(const struct emitter *e)
{
	const struct modal *modal = e->step->modal;
	if (!modal)
		return;
	if (e->wide && !e->device) {
		emit_dot(e);
		return;
	}
	emit_array(e, format("e^{p h} of each mode's pole p: real parts, imaginary parts%s",
			     modal->reals ? ", what is real" : ""), "turn", 1, &modal->states, modal->turn, NULL);
	if (!e->device)
		emit_mode_rows(e, "Modes from states", "to_modes", modal->states, modal->to, mode_names(e));
	if (!e->device || !modal->output)
		emit_mode_rows(e, "States from modes", "from_modes", modal->states, modal->from, e->model->names.state);
	emit_driving(e);
	struct tape *rows = tape_new();
	for (int i = 0; i < e->model->outputs; i++)
		tape_set(rows, "", tape_of_row(rows, e->step, &e->model->output[i]), 0, NULL);
	if (modal->output && tape_reads(rows, TAPE_TABLE, -1, TABLE_SEEN))
		emit_output_modes(e);
	emit_dot(e);
}

/* + D[0][at] * driven0 ... */
static const char *driven_sum(const struct emitter *e, int count, const char *at)
{
	struct summands s = { 0 };
	for (int k = 0; k < count; k++)
		add_summand(&s, spell(e, "$n_driven[%d][%s] * driven%d", k, at, k));
	return count ? format(count > 1 ? " + (%s)" : " + %s", sum_of(&s, 22)) : "";
}

void emit_modal_step(const struct emitter *e, const char *const *acting_text)
{
	const struct modal *modal = e->step->modal;
	struct operand *list = operands(e);
	const int count = driving(e, list), pairs = modal->pairs;
	const char *y = state_vector(e);
	for (int k = 0; k < count; k++)
		say(e, "    const double driven%d = %s;\n", k,
		    acting_text[list[k].index + (list[k].kind == OPERAND_INPUT ? modal->loads : 0)]);
	say(e, "    int i;\n");
	if (pairs) {
		const char *at = format("%d + i", pairs), *turn = spell(e, "$n_turn");
		say(e, "    for (i = 0; i < %d; i++) {  /* p + i q, turned and damped */\n"
		       "        const %s p = %s[i], q = %s[%s];\n"
		       "        %s[i] = %s[i] * p - %s[%s] * q%s;\n"
		       "        %s[%s] = %s[%s] * p + %s[i] * q%s;\n"
		       "    }\n",
		    pairs, e->wide ? "pl_lanes" : "double", y, y, at, y, turn, turn, at, driven_sum(e, count, "i"),
		    y, at, turn, at, turn, driven_sum(e, count, at));
	}
	if (modal->reals)
		say(e, "    for (i = %d; i < %d; i++) { %s[i] = $n_turn[i] * %s[i]%s; }\n",
		    2 * pairs, modal->states, y, y, driven_sum(e, count, "i"));
}
