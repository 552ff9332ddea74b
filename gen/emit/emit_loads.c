/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loads on the target: phases as turns, growths as exponents of 2, load states made of them at a step's start. */
#include "emit/emit.h"

/* ---- tables ---- */

/* |q| / unit as words, the first the highest, and a power of two */
static void print_rate(const struct emitter *e, const struct rate *rate, const char *note)
{
	say(e, "    {{");
	for (int k = 0; k < rate->words; k++)
		say(e, "%sUINT64_C(0x%016llx)", k ? ", " : "", (unsigned long long)rate->word[k]);
	say(e, "}, %ld},  /* %s */\n", -rate->exponent, note);
}

static const char *growth_text(const struct emitter *e, const struct advance *advance)
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
	return phase_text(e, &e->step->phase[load].step);
}

const char *growth_step_text(const struct emitter *e, int load)
{
	return growth_text(e, &e->step->phase[load].step);
}

static void print_turns(const struct emitter *e, const char *name, const char *what, bool per_step)
{
	say(e, "\nstatic const pl_turn $n_%s[%d] = {  /* %s */\n", name, e->phases, what);
	for (int l = 0; l < e->system->loads; l++) {
		const struct load_phase *phase = &e->step->phase[l];
		if (e->phase[l] >= 0)
			say(e, "    %s,  /* %s */\n", turn_text(e, per_step ? &phase->step.turn : &phase->start),
			    column_text(&e->system->load[l], 0));
	}
	say(e, "};\n");
}

static void print_growths(const struct emitter *e)
{
	say(e, "\n"
	       "static const pl_growth $n_growth_step[%d] = {  /* a h / ln 2, in units of 2^-%d */\n",
	    e->growths, growth_bits(e->step));
	for (int l = 0; l < e->system->loads; l++)
		if (e->growth[l] >= 0)
			say(e, "    %s,  /* %s */\n", growth_step_text(e, l), column_text(&e->system->load[l], 0));
	say(e, "};\n");
}

/* Phases or growths at the nodes: one row for each node; loads that are not read there keep their place. */
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
				say(e, "%s%s", shown++ ? ",\n     " : "", table->text(e, &e->step->phase[l].node[i]));
		say(e, "},  /* %s h */\n", exact_text(program->node[i]));
	}
	say(e, "};\n");
}

void emit_node_phases(const struct emitter *e, const bool *loads)
{
	bool turning = false, growing = false;
	for (int l = 0; l < e->system->loads; l++) {
		turning = turning || (loads[l] && e->phase[l] >= 0);
		growing = growing || (loads[l] && e->growth[l] >= 0);
	}
	struct node_table phases = { "pl_turn", "node_phase", e->phase, e->phases, phase_text };
	struct node_table growths = { "pl_growth", "node_growth", e->growth, e->growths, growth_text };
	if (turning)
		print_node_rows(e, &phases);
	if (growing)
		print_node_rows(e, &growths);
}

static void print_rate_rows(const struct emitter *e, bool turns)
{
	for (int l = 0; l < e->system->loads; l++) {
		const struct load_phase *phase = &e->step->phase[l];
		if ((turns ? e->phase : e->growth)[l] >= 0)
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
	return e->kind->own_factors && e->model->tuning->frequencies > 0;
}

void emit_load_tables(const struct emitter *e)
{
	if (e->phases) {
		print_turns(e, "phase_start", format("at t = 0, in turns of 2^-%d", phase_bits(e->step)), false);
		if (!e->kind->own_factors)
			print_turns(e, "phase_step", "in one step", true);
		if (!has_tuned_rates(e))
			print_rates(e, true, "phase_rate", e->phases, "turns per second");
	}
	if (e->growths) {
		if (!e->kind->own_factors)
			print_growths(e);
		print_rates(e, false, "growth_rate", e->growths, "|a| / ln 2 [1/s]");
	}
}

/* ---- in the state ---- */

void emit_load_members(const struct emitter *e)
{
	if (e->phases)
		say(e, "    pl_turn phase[%d];    /* of the loads */\n", e->phases);
	if (e->growths)
		say(e, "    pl_growth growth[%d]; /* of the loads */\n", e->growths);
}

void emit_load_set(const struct emitter *e)
{
	if (e->phases)
		say(e, "    for (i = 0; i < %d; i++)\n"
		       "        s->phase[i] = pl_turn_add($n_phase_start[i], pl_turn_at(&%sphase_rate[i], t));\n",
		    e->phases, has_tuned_rates(e) ? "s->coeffs." : format("%s_", e->name));
	for (int l = 0; l < e->system->loads; l++)
		if (e->growth[l] >= 0)
			say(e, "    s->growth[%d] = pl_growth_at(&$n_growth_rate[%d], %d, t);\n",
			    e->growth[l], e->growth[l], mpq_sgn(e->system->load[l].wave->a) < 0);
}

/* s->phase[i], or s->growth[i], gains what it does in one step, or `steps` times that */
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
		advance_one(e, "phase", "pl_turn", i, steps);
	for (int i = 0; i < e->growths; i++)
		advance_one(e, "growth", "pl_growth", i, steps);
}

/* ---- load states ---- */

static bool is_plain_constant(const struct load *load)
{
	return is_polynomial(load->wave) && load->powers == 1;
}

const char *load_operand(const struct emitter *e, int load, int column)
{
	if (is_polynomial(e->system->load[load].wave) && column < 2)
		return column ? "t" : NULL;
	return format("load%d[%d]", load + 1, column);
}

const char *column_operand(const struct emitter *e, int column)
{
	int l = 0;
	for (; column >= e->system->load[l].columns; l++)
		column -= e->system->load[l].columns;
	return load_operand(e, l, column);
}

static const char *phase_now(const struct emitter *e, int i)
{
	const char *layout = e->at_node ? "pl_turn_add(s->phase[%d], %s_node_phase[node][%d])" : "s->phase[%d]";
	return format(layout, i, e->name, i);
}

static const char *growth_now(const struct emitter *e, int i)
{
	const char *layout = e->at_node ? "pl_growth_add(s->growth[%d], %s_node_growth[node][%d])" : "s->growth[%d]";
	return format(layout, i, e->name, i);
}

/* t^k and e^{at} and cos, sin from their parts: load[0] (and [1]), then each power from the one before */
static void emit_one_load(const struct emitter *e, int l)
{
	const struct load *load = &e->system->load[l];
	int trig = oscillates(load->wave) ? 2 : 1, number = l + 1;
	if (is_polynomial(load->wave) && load->powers <= 2)
		return;                         /* 1 and t need no array */
	say(e, "    double load%d[%d];  /* %s", number, load->columns, column_text(load, 0));
	for (int k = 1; k < load->columns; k++)
		say(e, ", %s", column_text(load, k));
	say(e, " */\n");
	if (trig == 2)
		say(e, "    pl_cossin(%s, load%d);\n", phase_now(e, e->phase[l]), number);
	if (trig == 2 && e->growth[l] >= 0)
		say(e, "    growth = pl_growth_value(%s);\n"
		       "    load%d[0] *= growth;\n"
		       "    load%d[1] *= growth;\n",
		    growth_now(e, e->growth[l]), number, number);
	else if (trig == 1)
		say(e, "    load%d[0] = %s;\n", number,
		    e->growth[l] >= 0 ? format("pl_growth_value(%s)", growth_now(e, e->growth[l])) : "1.0");
	for (int k = trig; k < load->columns; k++)
		say(e, "    load%d[%d] = t * load%d[%d];\n", number, k, number, k - trig);
}

void emit_load_states(const struct emitter *e, const bool *loads, bool time_is_there)
{
	bool time = false, growth = false;
	for (int l = 0; l < e->system->loads; l++) {
		time = time || (loads[l] && e->system->load[l].powers > 1);
		growth = growth || (loads[l] && e->growth[l] >= 0 && e->phase[l] >= 0);
	}
	if (time && !time_is_there)
		say(e, "    const double t = $n_time(s);\n");
	if (growth)
		say(e, "    double growth;\n");
	for (int l = 0; l < e->system->loads; l++)
		if (loads[l] && !is_plain_constant(&e->system->load[l]))
			emit_one_load(e, l);
}

/* ---- the forced part ---- */

/* A factor of a load state; where formulas change, its place in the table forced_part[segment][state][column] */
static const char *forced_term(const struct emitter *e, int state, int column)
{
	const struct table *table = e->step->branch->whole;
	const char *operand = column_operand(e, column);
	if (e->system->segments == 1)
		return scaled(e->step->forced->part[state * table->columns + column].value, operand);
	const char *text = format("%s_forced_part[s->segment][%d][%d]", e->name, state, column);
	return operand ? format("%s * %s", text, operand) : text;
}

static bool forces(const struct emitter *e, int state, int column)
{
	const struct table *table = e->step->branch->whole;
	bool any = false;
	for (int s = 0; s < e->system->segments && is_forced(e->step, column); s++)
		any = any || e->step->forced->part[(s * table->states + state) * table->columns + column].value != 0;
	return any;
}

/* [segment][state][column] */
static void print_forced(const struct emitter *e, const char *name, const char *what, int segments,
			 const struct coefficient *factor)
{
	const struct table *table = e->step->branch->whole;
	int cells = table->states * table->columns;
	double *value = ARRAY(double, (size_t)cells);
	say(e, "\nstatic const double $n_%s[%d][$N_STATES][%d] = {  /* %s */\n", name, segments, table->columns, what);
	for (int s = 0; s < segments; s++) {
		for (int i = 0; i < cells; i++)
			value[i] = is_forced(e->step, i % table->columns) ? factor[s * cells + i].value : 0;
		say(e, "  {\n");
		emit_number_rows(e, table->states, table->columns, value, e->model->state_name);
		say(e, "  },\n");
	}
	say(e, "};\n");
}

/* A change at the end of a step */
static void emit_rebase(const struct emitter *e)
{
	int count = e->step->branch->whole->columns;
	say(e, "\n"
	       "static void $n_rebase($n *s)\n"
	       "{\n");
	emit_load_states(e, e->step->forced->load, false);
	say(e, "    const double load[%d] = {", count);
	for (int k = 0; k < count; k++) {
		const char *operand = is_forced(e->step, k) ? column_operand(e, k) : "0.0";
		say(e, "%s%s", k ? ", " : "", operand ? operand : "1.0");
	}
	say(e, "};\n"
	       "    int i, j;\n"
	       "    for (i = 0; i < $N_STATES; i++)\n"
	       "        for (j = 0; j < %d; j++)\n"
	       "            s->y[i] += $n_forced_change[s->segment][i][j] * load[j];\n"
	       "}\n",
	    count);
}

static void emit_forced_tables(const struct emitter *e)
{
	const struct forced *forced = e->step->forced;
	int segments = e->system->segments;
	if (segments > 1)
		print_forced(e, "forced_part", "factors of the load states in each segment of time", segments,
			     forced->part);
	if (forced->changes) {
		print_forced(e, "forced_change", "what they lose from each to the next", segments - 1, forced->change);
		emit_rebase(e);
	}
}

void emit_forced(const struct emitter *e)
{
	const struct table *table = e->step->branch->whole;
	const char **term = ARRAY(const char *, (size_t)table->columns);
	emit_forced_tables(e);
	say(e, "\n"
	       "/* What the loads that the step leaves out sustain now */\n"
	       "static void $n_forced(const $n *s, double now[$N_STATES])\n"
	       "{\n");
	emit_load_states(e, e->step->forced->load, false);
	for (int i = 0; i < table->states; i++) {
		int terms = 0;
		for (int k = 0; k < table->columns; k++)
			if (forces(e, i, k))
				term[terms++] = forced_term(e, i, k);
		say(e, "    now[%d] = %s;  /* %s */\n", i, terms ? tree(terms, term, 13) : "0.0",
		    e->model->state_name[i]);
	}
	say(e, "    (void)s;\n"
	       "}\n");
}
