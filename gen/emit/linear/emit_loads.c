/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loads on the target: phases as turns, envelopes as exponents of 2, load states made of them at a step's start. */
#include "inner.h"
#include "emit/steps.h"
#include "emit/tunable/tunable.h"
#include "model/reads.h"
#include "model/tunable/tuning.h"

#include <string.h>

/* ---- tables ---- */

/* |q| / unit as words, the first the highest, and a power of two */
static void print_rate(const struct emitter *e, const struct rate *rate, const char *note)
{
	say(e, "    {{");
	for (int k = 0; k < rate->words; k++)
		say(e, "%sUINT64_C(0x%016llx)", k ? ", " : "", (unsigned long long)rate->word[k]);
	say(e, "}, %ld},  /* %s */\n", -rate->exponent, note);
}

static const char *envelope_text(const struct emitter *e, const struct advance *advance)
{
	bool one_word = phase_bits(e->step) == 64;
	uint64_t high = one_word ? advance->growth.low : advance->growth.high;
	bool negative = high >> 63;
	const char *text = format(negative ? "-INT64_C(0x%llx) - 1" : "INT64_C(0x%llx)",
				  (unsigned long long)(negative ? ~high : high));
	return one_word ? text : format("{%s, UINT64_C(0x%016llx)}", text, (unsigned long long)advance->growth.low);
}

static const char *turn_text(const struct emitter *e, const struct fixed_point *turn)
{
	const char *low = format("UINT64_C(0x%016llx)", (unsigned long long)turn->low);
	if (phase_bits(e->step) == 64)
		return low;
	return format("{UINT64_C(0x%016llx), %s}", (unsigned long long)turn->high, low);
}

static const char *phase_text(const struct emitter *e, const struct advance *advance)
{
	return turn_text(e, &advance->turn);
}

const char *phase_step_text(const struct emitter *e, int load)
{
	return phase_text(e, &e->step->linear.phase[load].step);
}

const char *envelope_step_text(const struct emitter *e, int load)
{
	return envelope_text(e, &e->step->linear.phase[load].step);
}

static void print_turns(const struct emitter *e, const char *name, const char *what, bool per_step)
{
	say(e, "\nstatic const pl_phase $n_%s[%d] = {  /* %s */\n", name, e->phases, what);
	for (int l = 0; l < e->system->loads; l++) {
		const struct load_phase *phase = &e->step->linear.phase[l];
		if (e->phase[l] >= 0)
			say(e, "    %s,  /* %s */\n", turn_text(e, per_step ? &phase->step.turn : &phase->start),
			    column_text(&e->system->load[l], 0));
	}
	say(e, "};\n");
}

static void print_envelopes(const struct emitter *e)
{
	say(e, "\n"
	       "static const pl_envelope $n_envelope_step[%d] = {  /* a h / ln 2, in units of 2^-%d */\n",
	    e->envelopes, growth_bits(e->step));
	for (int l = 0; l < e->system->loads; l++)
		if (e->envelope[l] >= 0)
			say(e, "    %s,  /* %s */\n", envelope_step_text(e, l), column_text(&e->system->load[l], 0));
	say(e, "};\n");
}

/* Phases or envelopes at the nodes: one row for each node; loads that are not read there keep their place. */
struct node_table {
	const char *type, *name;
	const int *index;
	int count;
	const char *(*text)(const struct emitter *e, const struct advance *advance);
};

static void print_node_rows(const struct emitter *e, const struct node_table *table)
{
	const struct program *program = e->step->program;
	say(e, "\n"
	       "static const %s $n_%s[%d][%d] = {  /* from the start of a step to each node */\n",
	    table->type, table->name, program->nodes, table->count);
	for (int i = 0; i < program->nodes; i++) {
		int shown = 0;
		say(e, "    {");
		for (int l = 0; l < e->system->loads; l++)
			if (table->index[l] >= 0)
				say(e, "%s%s", shown++ ? ",\n     " : "",
				    table->text(e, &e->step->linear.phase[l].node[i]));
		say(e, "},  /* %s h */\n", readable_text(program->node[i]));
	}
	say(e, "};\n");
}

void emit_node_times(const struct emitter *e)
{
	const struct program *program = e->step->program;
	double *after = ARRAY(double, (size_t)program->nodes);
	for (int i = 0; i < program->nodes; i++)
		after[i] = time_in_step(e->model, program->node[i]);
	emit_array(e, "Times of nodes after the start of the step [s]", "node", 1, &program->nodes, after, NULL);
}

void emit_node_phases(const struct emitter *e, const bool *loads)
{
	bool turning = false, growing = false;
	for (int l = 0; l < e->system->loads; l++) {
		turning = turning || (loads[l] && e->phase[l] >= 0);
		growing = growing || (loads[l] && e->envelope[l] >= 0);
	}
	struct node_table phases = { "pl_phase", "node_phase", e->phase, e->phases, phase_text };
	struct node_table envelopes = { "pl_envelope", "node_envelope", e->envelope, e->envelopes, envelope_text };
	if (turning)
		print_node_rows(e, &phases);
	if (growing)
		print_node_rows(e, &envelopes);
}

static void print_rate_rows(const struct emitter *e, bool turns)
{
	for (int l = 0; l < e->system->loads; l++) {
		const struct load_phase *phase = &e->step->linear.phase[l];
		if ((turns ? e->phase : e->envelope)[l] >= 0)
			print_rate(e, turns ? &phase->turns : &phase->growth, column_text(&e->system->load[l], 0));
	}
}

static void print_rates(const struct emitter *e, bool turns, const char *name, int count, const char *what)
{
	say(e, "\nstatic const pl_rate $n_%s[%d] = {  /* %s */\n", name, count, what);
	print_rate_rows(e, turns);
	say(e, "};\n");
}

void emit_phase_rates(const struct emitter *e)
{
	print_rate_rows(e, true);
}

static bool has_tuned_rates(const struct emitter *e)
{
	return e->step->is.tuned && e->model->params.tuning->frequencies > 0;
}

void emit_load_tables(const struct emitter *e)
{
	if (e->phases) {
		print_turns(e, "phase_start",
			    format("phases of the loads at t = 0, in units of 2^-%d of a cycle", phase_bits(e->step)),
			    false);
		if (!e->step->is.tuned)
			print_turns(e, "phase_step", "by how much they advance in a step", true);
		if (!has_tuned_rates(e))
			print_rates(e, true, "phase_rate", e->phases,
				    "their frequencies: cycles per second, mantissa and exponent");
	}
	if (e->envelopes) {
		if (!e->step->is.tuned)
			print_envelopes(e);
		print_rates(e, false, "envelope_rate", e->envelopes, "|a| / ln 2 [1/s]");
	}
}

/* ---- in the state ---- */

void emit_load_members(const struct emitter *e)
{
	const char *when = e->step->refresh ? " at the refresh" : "";
	if (e->phases)
		say(e, "    pl_phase phase[%d];    /* of the loads%s */\n", e->phases, when);
	if (e->envelopes)
		say(e, "    pl_envelope envelope[%d]; /* of the loads%s */\n", e->envelopes, when);
}

const char *phase_rate_text(const struct emitter *e)
{
	return has_tuned_rates(e) ? "s->coeffs.phase_rate" : spell(e, "$n_phase_rate");
}

/* s->phase[i], or s->envelope[i], gains what it does in one step, or `steps` times that */
static void advance_one(const struct emitter *e, const char *what, const char *type, int i, const char *steps)
{
	const char *gain = format("%s[%d]", of_step(e, format("%s_step", what)), i);
	if (steps)
		gain = format("%s_times(%s, %s)", type, gain, steps);
	say(e, "    s->%s[%d] = %s_add(s->%s[%d], %s);\n", what, i, type, what, i, gain);
}

void emit_load_advance(const struct emitter *e, const char *steps)
{
	for (int i = 0; i < e->phases; i++)
		advance_one(e, "phase", "pl_phase", i, steps);
	for (int i = 0; i < e->envelopes; i++)
		advance_one(e, "envelope", "pl_envelope", i, steps);
}

/* ---- load states ---- */

const char *load_operand(const struct emitter *e, int load, int column)
{
	if (is_polynomial(e->system->load[load].forcing) && column < 2)
		return column ? "t" : NULL;
	return format("load%d[%d]", load + 1, column);
}

const char *column_operand(const struct emitter *e, int column)
{
	int first, load = load_of_column(e->system, column, &first);
	return load_operand(e, load, column - first);
}

/* ... and what it gains up to a time after now */
static const char *later(const struct emitter *e, const char *what, const char *type, int i)
{
	int load = 0;
	while ((strcmp(what, "phase") == 0 ? e->phase : e->envelope)[load] != i)
		load++;
	const char *falls = mpq_sgn(e->system->load[load].forcing->a) < 0 ? "1, " : "0, ";
	return format("%s_add(s->%s[%d], %s_at(&%s_%s_rate[%d], %s%s))", type, what, i, type, e->name, what, i,
		      strcmp(what, "phase") == 0 ? "" : falls, e->after);
}

/* s->phase[i] or s->envelope[i], and what it has gained since: up to the node, or from the refresh up to now */
static const char *now_of(const struct emitter *e, const char *what, const char *type, int i)
{
	const char *kept = format("s->%s[%d]", what, i);
	if (e->at_node)
		return format("%s_add(%s, %s_node_%s[node][%d])", type, kept, e->name, what, i);
	if (e->after)
		return later(e, what, type, i);
	if ((!e->step->refresh && !(e->at && e->at->since)) || e->refresh.keeps)
		return kept;
	return format("%s_add(%s, %s_times(%s_%s_step[%d], s->since))", type, kept, type, e->name, what, i);
}

static const char *envelope_now(const struct emitter *e, int i)
{
	return now_of(e, "envelope", "pl_envelope", i);
}

/* load1[0]; in the refresh s->phasor[0] */
static const char *load_cell(const struct emitter *e, int load, int column)
{
	return e->refresh.keeps ? format("s->phasor[%d]", e->refresh.phasor[load] + column)
			    : format("load%d[%d]", load + 1, column);
}

void emit_load_array(const struct emitter *e, int l)
{
	const struct load *load = &e->system->load[l];
	say(e, "    double load%d[%d];  /* %s", l + 1, load->columns, column_text(load, 0));
	for (int k = 1; k < load->columns; k++)
		say(e, ", %s", column_text(load, k));
	say(e, " */\n");
}

void emit_load_powers(const struct emitter *e, int l)
{
	const struct load *load = &e->system->load[l];
	int trig = oscillates(load->forcing) ? 2 : 1;
	for (int k = trig; k < load->columns; k++)
		say(e, "    %s = t * %s;\n", load_cell(e, l, k), load_cell(e, l, k - trig));
}

void emit_load_functions(const struct emitter *e, int l)
{
	const struct load *load = &e->system->load[l];
	bool turns = oscillates(load->forcing), grows = e->envelope[l] >= 0;
	const char *pair = e->refresh.keeps ? format("&%s", load_cell(e, l, 0)) : format("load%d", l + 1);
	if (turns)
		say(e, "    pl_cossin(%s, %s);\n", now_of(e, "phase", "pl_phase", e->phase[l]), pair);
	if (turns && grows)
		say(e, "    envelope = pl_envelope_value(%s);\n"
		       "    %s *= envelope;\n"
		       "    %s *= envelope;\n",
		    envelope_now(e, e->envelope[l]), load_cell(e, l, 0), load_cell(e, l, 1));
	else if (!turns)
		say(e, "    %s = %s;\n", load_cell(e, l, 0),
		    grows ? format("pl_envelope_value(%s)", envelope_now(e, e->envelope[l])) : "1.0");
	emit_load_powers(e, l);
}

/* t^k and e^{at} and cos, sin from their parts: load[0] (and [1]), then each power from the one before */
static void emit_one_load(const struct emitter *e, int l)
{
	const struct load *load = &e->system->load[l];
	if (is_polynomial(load->forcing) && load->powers <= 2)
		return;                         /* 1 and t need no array */
	emit_load_array(e, l);
	emit_load_functions(e, l);
}

void emit_load_states(const struct emitter *e, const bool *loads, bool time_is_there)
{
	bool time = false, envelope = false;
	for (int l = 0; l < e->system->loads; l++) {
		time = time || (loads[l] && e->system->load[l].powers > 1);
		envelope = envelope || (loads[l] && e->envelope[l] >= 0 && e->phase[l] >= 0);
	}
	if (time && !time_is_there)
		say(e, "    const double t = $n_time(s);\n");
	if (envelope)
		say(e, "    double envelope;\n");
	for (int l = 0; l < e->system->loads; l++)
		if (loads[l] && !(is_polynomial(e->system->load[l].forcing) && e->system->load[l].powers == 1))
			emit_one_load(e, l);
}
