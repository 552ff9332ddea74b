/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The state in emitted code: its locals, what is kept of it, how it is stored and read. */
#include "emit/series/series.h"
#include "state.h"
#include "steps.h"
#include "model/reads.h"
#include "model/regions/regions.h"
#include "model/tunable/tuning.h"
#include "step/series/expansion.h"
#include "step/linear/rows.h"

const struct model *written_model(const struct model *model)
{
	return model->relative ? model : model->written;
}

bool outputs_read(const struct emitter *e, int load)
{
	const struct model *model = e->model;
	const size_t columns = (size_t)(e->system->load[load].columns * e->system->segments);
	bool read = false;
	for (int o = 0; o < model->outputs; o++) {
		const struct form *left = model->output[o].left;
		read = read || (left && reads_of(written_model(model), 1, &left).load[load]);
		read = read || !rationals_zero(columns, model->output[o].load[load]);
	}
	for (int i = 0; model->equations.highest && i < model->n; i++)
		read = read || (model->equations.highest[i] &&
				!rationals_zero(columns, model->equations.highest[i]->load[load]));
	return read;
}

bool has_peaks(const struct emitter *e)
{
	return peak_outputs(e->model) > 0;
}

bool has_peak_rows(const struct emitter *e)
{
	return has_peaks(e) && !peaks_by_values(e->step);
}

bool has_ranges(const struct emitter *e)
{
	return e->model->written->ranges > 0;
}

bool has_floors(const struct emitter *e)
{
	return mpq_sgn(e->model->truncation.tolerance) != 0 && e->model->truncation.absolute;
}

bool tells_tolerance(const struct emitter *e)
{
	return mpq_sgn(e->model->truncation.tolerance) != 0 && (e->step->taylor.expansion || e->step->collocation) &&
	       !e->model->relative && !e->model->delays;
}

bool keeps_status(const struct emitter *e)
{
	return !is_linear_alone(e->step) || has_ranges(e);
}

bool has_jump(const struct emitter *e)
{
	return !step_objection(e->step, CAN_JUMP);
}

const char *state_list(const struct model *model)
{
	return name_list(model->system.states, model->names.state);
}

const char *carried_text(const struct emitter *e)
{
	const char *list = "";
	for (int i = 0; i < e->system->states; i++)
		if (e->step->carried.place[i] >= 0)
			list = format("%s%s%s", list, *list ? ", " : "", e->model->names.state[i]);
	return list;
}

int most_samples_before(const struct emitter *e)
{
	int most = 0;
	for (int i = 0; i < e->system->inputs; i++) {
		int hold = e->system->input[i].hold;
		most = hold > 1 && hold > most ? hold : most;
	}
	return most;
}

const char *param_text(const struct emitter *e, int param)
{
	const int lead = param - e->model->spec->tuned.count;
	return lead >= 0 ? format("s->lead[%d].angle", lead) : format("s->coeffs.params[%d]", param);
}

const char *param_local(const struct emitter *e, int param)
{
	const struct symbol *symbol = held_symbol(e->model, param);
	return param < e->model->spec->tuned.count ? c_name(e->c, symbol, 0) : symbol->name;
}

int given_inputs(const struct emitter *e)
{
	int given = 0;
	for (int i = 0; i < e->system->inputs; i++)
		given += place_of_input(e, i) < e->model->spec->count.inputs;
	return given;
}

const char *sample_now(const struct emitter *e, int input)
{
	const int param = param_of_input(e->model->spec, input);
	return param < 0 ? format("u[%d]", input) : param_text(e, param);
}

const char *sample_kept(const struct emitter *e, int input)
{
	const int param = param_of_input(e->model->spec, input);
	return param < 0 ? format("s->u[%d]", input) : param_text(e, param);
}

const char *sample_text(const struct emitter *e, int input, int sample)
{
	int hold = e->system->input[input].hold;
	if (sample == hold)
		return sample_now(e, input);
	return hold == 1 ? format("s->u[%d]", input) : format("s->past[%d][%d]", input, sample);
}

/* Held: the sample that the step is given. A ramp: the previous sample, then the one given; further samples likewise.
 * */
const char *input_operand(const struct emitter *e, int column)
{
	if (e->sample)
		return e->sample[column];
	for (int i = 0; i < e->system->inputs; i++) {
		int columns = e->system->input[i].hold + 1;
		if (column < columns)
			return sample_text(e, i, column);
		column -= columns;
	}
	return NULL;
}

const char *input_name(const struct emitter *e, int input, int order)
{
	if (input >= e->model->spec->count.inputs)
		return param_local(e, param_of_input(e->model->spec, input));
	for (const struct symbol *s = e->model->spec->first; s; s = s->next)
		if (s->kind == SYMBOL_INPUT && s->index == input)
			return c_name(e->c, s, order);
	return NULL;
}

/* The table Phi of the states as they are kept */
const char *stepped_table(const struct emitter *e)
{
	return format(e->model->relative ? "%s_Phi_kept" : "%s_Phi", e->name);
}

/* The mass that a kept velocity is multiplied with; NULL: 1 */
const char *factor_of_momentum(const struct emitter *e, int state)
{
	const struct kicks *kicks = &e->step->linear.kicks;
	if (!kicks->momenta || state < e->model->n || mpq_cmp_ui(kicks->mass[e->system->coord[state]], 1, 1) == 0)
		return NULL;
	return shortest(finite_number(e, kicks->mass[e->system->coord[state]]));
}

int place_of_state(const struct emitter *e, int state)
{
	return e->part ? e->part->state[state] : state;
}

int place_of_input(const struct emitter *e, int input)
{
	return e->part ? e->part->input[input] : input;
}

const char *own_states(const struct emitter *e)
{
	return e->part ? format("%d", e->system->states) : spell(e, "$N_STATES");
}

const char *place_in_loop(const struct emitter *e)
{
	return e->part ? spell(e, "$o_state[i]") : "i";
}

bool keeps_modes(const struct emitter *e)
{
	return e->step->normal && !e->step->event_split;
}

/* s->y is not the state as it is known outside: NAME_get makes that */
static bool is_read_full(const struct emitter *e)
{
	return (e->step->forced && !rows_sustained(e->step)) || e->step->modal || keeps_modes(e);
}

/* The states wanted. `velocities`: without masses; else as the struct has them. */
static void write_locals(const struct emitter *e, const bool *reads, const char *vector, bool velocities)
{
	const char *list = "";
	bool forced = velocities && is_read_full(e);

	for (int i = 0; i < e->system->states; i++) {
		const char *mass = velocities && !forced ? factor_of_momentum(e, i) : NULL;
		if (!reads || reads[i])
			list = format("%s%s%s = %s%s%s", list, *list ? ", " : "const double ", e->local[i],
				      e->at ? e->at->state[i] : format("%s[%d]", vector, place_of_state(e, i)),
				      mass ? " / " : "", mass ? mass : "");
	}
	say_wrapped(e, *list ? format("%s;\n", list) : "");
}

void emit_locals(const struct emitter *e, const bool *reads)
{
	bool any = false;
	for (int i = 0; i < e->system->states; i++)
		any = any || reads[i];
	bool full = is_read_full(e);
	if (full && any)
		say(e, "    double now[$N_STATES];\n"
		       "    $n_%s(s, now);\n", e->model->relative ? "kept" : "get");
	write_locals(e, reads, full ? "now" : "s->y", true);
}

void emit_raw_locals(const struct emitter *e, const bool *reads)
{
	write_locals(e, reads, "s->y", false);
}

void emit_locals_of(const struct emitter *e, const bool *reads, const char *vector)
{
	write_locals(e, reads, vector, false);
}

const char *step_length(const struct emitter *e)
{
	return e->step->is.tuned ? "s->coeffs.h" : spell(e, "$N_H");
}

/* 1/h is rounded once, as h is: a product with it is as good as a quotient by that, and cheaper. */
const char *slope_of_samples(const struct emitter *e, const char *to, const char *from)
{
	const char *gain = format("(%s - %s)", to, from);
	RATIONAL rate = ZERO;
	mpq_inv(rate, e->model->h);
	bool quotient = e->step->is.tuned || beyond_range(rate);
	return quotient ? format("%s / %s", gain, step_length(e))
			: format("%s * %s", gain, shortest(round_rational(rate)));
}

const char *ramp_slope(const struct emitter *e, int input)
{
	return slope_of_samples(e, format("u[%d]", input), format("s->u[%d]", input));
}

const char *of_step(const struct emitter *e, const char *table)
{
	return e->step->is.tuned ? format("s->coeffs.%s", table) : spell(e, "$n_%s", table);
}

bool has_place(const struct emitter *e)
{
	return e->prints->places && e->prints->places(e);
}

bool has_unresolved(const struct emitter *e)
{
	return e->step->taylor.unresolved != NULL;
}

bool traces(const struct emitter *e)
{
	return has_unresolved(e) && e->step->taylor.unresolved->unresolved_functions > 0;
}

bool crowds(const struct emitter *e)
{
	return has_unresolved(e) && e->step->taylor.unresolved->crowded > 0;
}

void open_algorithm(const struct emitter *e, const char *algorithm, const struct size *size)
{
	say_purpose(e, algorithm);
	say(e, "#define PL(name) $n_##name\n"
	       "#define PL_TYPE $n\n"
	       "#define PL_H %s\n", step_length(e));
	say_macro(e, "SINGLE", integer_text(e->model->request.single));
	for (; size->name; size++)
		say_macro(e, size->name, integer_text(size->value));
}

/* ---- tunable params ---- */

bool has_param_ranges(const struct emitter *e)
{
	for (int k = 0; k < tunables_of(e->model)->given; k++)
		if (e->model->params.range[k])
			return true;
	return false;
}

bool wraps_retune(const struct emitter *e)
{
	return has_param_ranges(e) || e->model->spec->tuned.derived > 0;
}

static const char *range_text(const struct param_range *range)
{
	return range ? format(" in [%s, %s]", readable_text(range->low), readable_text(range->high)) : "";
}

const char *param_list(const struct emitter *e)
{
	const struct tuning *t = tunables_of(e->model);
	const char *list = "";
	for (int k = 0; k < t->given; k++)
		list = format("%s%s%s%s", list, k ? ", " : "", t->param[k].symbol->name,
			      range_text(e->model->params.range[k]));
	return list;
}

void emit_nominal_params(const struct emitter *e)
{
	const struct tuning *t = tunables_of(e->model);
	const char *shape = t->params > t->given ? format(" + %d", t->params - t->given) : "";
	open_member(e, "double", "params", format("[%s_PARAMS%s]", e->upper, shape),
		    format("%s%s", param_list(e), *shape ? ", what follows from them" : ""));
	for (int k = 0; k < t->params; k++)
		say(e, k ? ", %s" : "    %s", finite_text(t->param[k].at, t->nominal[k]));
	say(e, "\n");
	close_member(e);
}

void emit_param_locals(const struct emitter *e, const bool *reads)
{
	for (int k = 0; k < held_values(e->model); k++)
		if (reads[k])
			say(e, "    const double %s = %s;\n", param_local(e, k), param_text(e, k));
}

void emit_nominal_params_read(const struct emitter *e, const struct reads *reads)
{
	const struct tuning *t = tunables_of(e->model);
	if (!t)
		return;
	bool *read = ARRAY(bool, (size_t)t->params);
	for (int k = 0; k < t->params; k++)
		read[k] = reads->param[k];
	for (int i = e->model->spec->count.inputs; i < e->system->inputs; i++)
		if (reads->input[i])
			read[param_of_input(e->model->spec, i)] = true;
	for (int k = 0; k < t->params; k++)
		if (read[k])
			say(e, "    const double %s = %s;\n", param_local(e, k),
			    finite_text(t->param[k].at, t->nominal[k]));
	for (int k = t->params; k < held_values(e->model); k++)
		if (reads->param[k])
			say(e, "    const double %s = 0.0;\n", param_local(e, k));
}

const struct expansion *own_expansion(const struct emitter *e)
{
	return e->step->taylor.expansion;
}

const struct truncation *truncation_of(const struct emitter *e)
{
	return &e->model->truncation;
}
