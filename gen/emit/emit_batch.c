/* SPDX-License-Identifier: GPL-3.0-or-later */
/* NAME_batch: the step of a linear model over lanes, each an instance. What instances share of a step (load states,
 * samples) is computed once, for some steps ahead; then each group of instances goes through these, its states in
 * locals. The sums are those of NAME_step, in its order, so that an instance gets the bits of one that steps alone. */
#include "emit/emit.h"

#include <string.h>

enum { STEPS_AHEAD = 64, STEPS_OF_PEAKS = 256, MOST_GROUPS = 4 };

struct batch {
	const struct emitter *e;
	int shared;                     /* numbers that instances share in a step: `now` */
	const char **shared_text;       /* first those that the step reads, before it; */
	int after;                      /* from here on those of the outputs, after it */
	/* per column, of the step and of the outputs: index in `now`; -1: none; of the outputs inputs and slopes */
	int *load[2], *input[2];
	int forced;                     /* index of the forced part; -1: none */
	/* Of peaks: what acts on the states before the step, then how far it bends each; is that computed only where
	 * it is read, elsewhere bounded by the samples? */
	int acting;
	bool sampled;
	int lanes;                      /* factors of the instance that lanes have; */
	int factors;                    /* of an instance, that its params decide */
	const char **factor_text;       /* s->coeffs.step[0][1] */
};

/* ---- what instances share, and what each has ---- */

static int share(struct batch *b, const char *text)
{
	ENLARGE(b->shared_text, (size_t)b->shared + 1);
	b->shared_text[b->shared] = text;
	return b->shared++;
}

static void share_load(struct batch *b, int which, int column)
{
	const char *text = column_operand(b->e, column);
	if (text && b->load[which][column] < 0)
		b->load[which][column] = share(b, text);
}

static void share_operands_of_step(struct batch *b)
{
	const struct program *program = b->e->step->program;
	for (int i = 0; i < program->assignments; i++)
		for (int k = 0; k < program->assignment[i].terms; k++) {
			const struct operand *o = &program->assignment[i].term[k].operand;
			if (o->kind == OPERAND_LOAD)
				share_load(b, 0, o->index);
			else if (o->kind == OPERAND_INPUT && b->input[0][o->index] < 0)
				b->input[0][o->index] = share(b, input_operand(b->e, o->index));
		}
}

/* Column k of an output's row over loads, over inputs and their slopes: is it read? */
static bool reads_load(const struct emitter *e, const struct output *output, int column)
{
	if (is_tuned_output(e, output))
		return tuned_output_reads(e, output, e->system->states + column);
	int l = 0;
	for (; column >= e->system->load[l].columns; l++)
		column -= e->system->load[l].columns;
	return mpq_sgn(output->load[l][column]) != 0;
}

/* Of input i, or of its slope; struct tuning has columns for both of a ramp alone */
static bool reads_input(const struct emitter *e, const struct output *output, int i, int slope)
{
	if (!is_tuned_output(e, output))
		return mpq_sgn(output->input[slope][i]) != 0;
	int column = e->system->states + load_columns(e->system);
	for (int k = 0; k < i; k++)
		column += e->system->input[k].hold + 1;
	return (slope == 0 || e->system->input[i].hold) && tuned_output_reads(e, output, column + slope);
}

static void share_operands_of_output(struct batch *b, const struct output *output)
{
	for (int k = 0; k < load_columns(b->e->system); k++)
		if (reads_load(b->e, output, k))
			share_load(b, 1, k);
	for (int k = 0; k < 2 * b->e->system->inputs; k++) {
		int i = k / 2, slope = k % 2;
		if (reads_input(b->e, output, i, slope) && b->input[1][k] < 0)
			b->input[1][k] = share(b, format(slope ? "s->slope[%d]" : "s->u[%d]", i));
	}
}

/* The name of a factor of the instance's own, in a function over lanes */
static const char *own_factor(struct batch *b, const char *text)
{
	int k = 0;
	while (k < b->factors && strcmp(b->factor_text[k], text) != 0)
		k++;
	if (k == b->factors) {
		ENLARGE(b->factor_text, (size_t)b->factors + 1);
		b->factor_text[b->factors++] = text;
	}
	return format("factor[%d]", k);
}

static int *no_places(int count)
{
	int *place = ARRAY(int, (size_t)count + 1);
	for (int i = 0; i < count; i++)
		place[i] = -1;
	return place;
}

static void number_factors(struct batch *b);

/* Is there more in x than the states? */
static bool acts(const struct emitter *e)
{
	return e->step->layout.size > e->system->states;
}

/* ... all of it polynomials through samples, of which the derivatives take long? */
static bool only_samples_act(const struct emitter *e)
{
	int columns = 0;
	for (int i = 0; i < e->system->inputs; i++)
		columns += e->system->input[i].hold > 1 ? e->system->input[i].hold + 1 : 0;
	return e->system->states + columns == e->step->layout.size;
}

static struct batch plan(const struct emitter *e)
{
	struct batch b = { .e = e, .forced = -1 };
	for (int which = 0; which < 2; which++)
		b.load[which] = no_places(load_columns(e->system));
	b.input[0] = no_places(input_columns(e->system));
	b.input[1] = no_places(2 * e->system->inputs);
	share_operands_of_step(&b);
	b.after = b.shared;
	for (int i = 0; i < e->model->outputs; i++)
		share_operands_of_output(&b, &e->model->output[i]);
	if (e->step->forced) {
		b.forced = b.shared;
		b.shared += e->system->states;
	}
	if (has_peaks(e) && acts(e))
		b.acting = e->step->layout.size - e->system->states + peak_outputs(e->model);
	b.sampled = b.acting && only_samples_act(e);
	if (e->kind->own_factors)
		number_factors(&b);
	return b;
}

/* Rows of an instance's memory, as in its struct: what a step changes, then what only get and set read */
struct member { const char *name; int rows; };

static int members_of(const struct emitter *e, struct member member[5])
{
	int states = e->system->states, count = 0;
	bool compensated = e->step->program->compensated;
	member[count++] = (struct member){ "y", states };
	if (compensated)
		member[count++] = (struct member){ "rest", states };
	if (e->step->carries)
		member[count++] = (struct member){ "carry", e->step->carries };
	if (e->step->forced && !compensated)
		member[count++] = (struct member){ "rest", states };
	if (e->model->relative) {
		member[count++] = (struct member){ "set", states };
		member[count++] = (struct member){ "from", states };
	}
	return count;
}

static int rows_of(const struct emitter *e)
{
	struct member member[5];
	int count = members_of(e, member), rows = 0;
	for (int i = 0; i < count; i++)
		rows += member[i].rows;
	return rows;
}

/* Those that a step changes */
static int stepped_rows(const struct emitter *e)
{
	return e->system->states * (e->step->program->compensated ? 2 : 1) + e->step->carries;
}

/* Groups of lanes that step in turns, so that sums of one wait for none of their own */
static int groups_of(const struct emitter *e)
{
	int groups = 8 / stepped_rows(e);
	return groups < 1 ? 1 : groups > MOST_GROUPS ? MOST_GROUPS : groups;
}

/* ---- the header ---- */

static const char *row_list(const struct emitter *e)
{
	struct member member[5];
	int count = members_of(e, member);
	const char *list = "";
	for (int i = 0; i < count; i++)
		list = format("%s%s%s", list, i ? ", " : "", member[i].name);
	return list;
}

static void declare_instances(const struct emitter *e, const struct batch *b)
{
	say(e, "\n"
	       "/* Many instances in one call, all at one time%s. In each array the instance is the fastest: entry i\n"
	       " * of instance j stands at [i * count + j]. Set count and the arrays, then call $n_batch_init. */\n",
	    e->system->inputs ? " and under the same inputs" : "");
	say(e, "enum { $N_BATCH_ROWS = %d%s };\n", rows_of(e),
	    b->factors ? format(", %s_BATCH_FACTORS = %d", e->upper, b->factors) : "");
	say(e, "typedef struct $n_instances {\n"
	       "    size_t count;\n"
	       "    double *y;        /* [$N_BATCH_ROWS][count]: of each %s, as in struct $n */\n", row_list(e));
	if (b->factors)
		say(e, "    double *factors;  /* [$N_BATCH_FACTORS][count]: its own, by $n_batch_use; NULL: all have "
		       "those of shared */\n");
	say(e, "    double *peak;     /* [$N_OUTPUTS][count]: the largest |output| at ends of steps; "
	       "NULL: not kept */\n"
	       "    $n shared;        /* what all share: time%s%s; its states are not used */\n"
	       "} $n_instances;\n", e->system->inputs ? ", the last sample" : "",
	    e->phases || e->growths ? ", phases of loads" : "");
}

void emit_batch_declarations(const struct emitter *e)
{
	struct batch b = plan(e);
	bool inputs = e->system->inputs > 0;
	declare_instances(e, &b);
	say(e, "void   $n_batch_init($n_instances *b);%31s/* t = 0; of each the spec's initial values%s */\n", "",
	    b.factors ? " and coefficients" : "");
	say(e, "void   $n_batch_set($n_instances *b, size_t j, const double y[$N_STATES]);  /* of instance j, now */\n"
	       "void   $n_batch_get(const $n_instances *b, size_t j, double y[$N_STATES]);\n");
	if (b.factors)
		say(e, "/* Instance j goes on with c; PL_NO_STEP: its h is not that of shared, or b has no factors */\n"
		       "int    $n_batch_use($n_instances *b, size_t j, const $n_coeffs *c);\n");
	say(e, "/* n steps%s; out: [n][$N_OUTPUTS][count], or NULL */\n"
	       "void   $n_batch($n_instances *b, size_t n, %sdouble *out);\n\n",
	    inputs ? ", n rows of u for all" : "", inputs ? "const double *u, " : "");
}

/* ---- the step over lanes ---- */

static const char *shared_place(int place)
{
	return place < 0 ? NULL : format("now[%d]", place);
}

static const char *operand_over_lanes(const struct batch *b, const struct operand *o)
{
	switch (o->kind) {
	case OPERAND_STATE: return b->e->local[o->index];
	case OPERAND_LOAD:  return shared_place(b->load[0][o->index]);
	default:            return shared_place(b->input[0][o->index]);
	}
}

static const char *term_over_lanes(struct batch *b, const struct assignment *a, const struct product *p)
{
	const char *operand = operand_over_lanes(b, &p->operand);
	if (!b->e->step->program->tuned)
		return scaled(p->factor->value, operand);
	const char *factor = own_factor(b, tuned_factor(b->e, a->target, &p->operand));
	return operand ? format("%s * %s", factor, operand) : factor;
}

/* Some term of a sum is over lanes, not a number that all share. */
static bool is_over_lanes(const struct batch *b, const struct assignment *a)
{
	bool any = b->e->step->program->tuned && a->terms;
	for (int k = 0; k < a->terms; k++)
		any = any || a->term[k].operand.kind == OPERAND_STATE;
	return any;
}

static const char *sum_over_lanes(struct batch *b, const struct assignment *a, bool second)
{
	const char **term = ARRAY(const char *, (size_t)a->terms + 1);
	int terms = 0;
	bool lanes = is_over_lanes(b, a);
	for (int k = 0; k < a->terms; k++)
		if (!second)
			term[terms++] = term_over_lanes(b, a, &a->term[k]);
		else if (has_second_word(&a->term[k], b->e->step))
			term[terms++] = scaled(a->term[k].factor->low, operand_over_lanes(b, &a->term[k].operand));
	const char *sum = terms ? tree(terms, term, 14) : "0.0";
	return lanes && !second ? sum : format("pl_lanes_all(0.0) + (%s)", sum);
}

/* Where of the rows an assignment keeps what rounding takes */
static int rest_row(const struct emitter *e, const struct assignment *a)
{
	int states = e->system->states;
	return a->carried ? stepped_rows(e) - e->step->carries + e->step->carry[a->target] : states + a->target;
}

static void say_assignment(struct batch *b, const struct assignment *a)
{
	const struct emitter *e = b->e;
	const struct program *program = e->step->program;
	const char *old = e->local[a->target], *target = program->in_order ? old : format("y[%d]", a->target);
	const char *name = e->model->state_name[a->target], *sum = sum_over_lanes(b, a, false);
	if (program->compensated || a->carried)
		say(e, "    %s = pl_lanes_accumulate(%s,  /* %s */\n"
		       "              %s,\n"
		       "              %s, &y[%d]);\n", target, old, name, sum,
		    a->carried ? "pl_lanes_all(0.0)" : sum_over_lanes(b, a, true), rest_row(e, a));
	else if (program->in_order)
		say(e, "    %s += %s;\n", target, sum);
	else if (a->added && a->terms > 1)
		say(e, "    %s = %s + (%s);  /* %s */\n", target, old, sum, name);
	else
		say(e, "    %s = %s%s;  /* %s */\n", target, a->added ? format("%s + ", old) : "", sum, name);
}

static void number_factors(struct batch *b)
{
	const struct emitter *e = b->e;
	const struct program *program = e->step->program;
	for (int i = 0; i < program->assignments; i++)
		for (int k = 0; k < program->assignment[i].terms; k++)
			term_over_lanes(b, &program->assignment[i], &program->assignment[i].term[k]);
	for (int i = 0; i < e->model->outputs; i++)
		for (int k = 0; is_tuned_output(e, &e->model->output[i]) && k < e->model->tuning->x.size; k++)
			if (tuned_output_reads(e, &e->model->output[i], k))
				own_factor(b, tuned_output_factor(e, &e->model->output[i], k));
	for (int p = 0; p < peak_outputs(e->model); p++) {
		for (int i = 0; i < e->system->states; i++)
			own_factor(b, format("s->coeffs.bend[%d][%d]", p, i));
		if (acts(e))
			own_factor(b, format("s->coeffs.reach[%d]", p));
	}
	b->lanes = b->factors;
	for (int p = 0; p < peak_outputs(e->model); p++)
		for (int i = e->system->states; i < e->step->layout.size; i++)
			own_factor(b, format("s->coeffs.bend[%d][%d]", p, i));
	for (int i = 0; i < e->system->states && has_peaks(e); i++)
		for (int j = 0; j < e->step->layout.size; j++)
			own_factor(b, format("s->coeffs.slope[%d][%d]", i, j));
}

static void emit_lanes_step(struct batch *b)
{
	const struct emitter *e = b->e;
	const struct program *program = e->step->program;
	say(e, "\n/* One step of as many instances as there are lanes; now: what they share */\n"
	       "PL_LANES_INLINE void $n_lanes_step(pl_lanes *y, %sconst double *now)\n"
	       "{\n", b->factors ? "const pl_lanes *factor, " : "");
	for (int i = 0; i < e->system->states; i++)
		if (program->reads[i])
			say(e, "    %spl_lanes %s = y[%d];\n", program->in_order ? "" : "const ", e->local[i], i);
	for (int i = 0; i < program->assignments; i++)
		say_assignment(b, &program->assignment[i]);
	for (int i = 0; i < e->system->states && program->in_order; i++)
		if (program->reads[i])
			say(e, "    y[%d] = %s;\n", i, e->local[i]);
	say(e, "    (void)now;\n"
	       "}\n");
}

/* ---- outputs over lanes ---- */

static const char *output_term(struct batch *b, const struct output *output, int column, mpq_srcptr fixed,
			       const char *operand)
{
	if (!is_tuned_output(b->e, output))
		return scaled(round_rational(fixed), operand);
	const char *factor = own_factor(b, tuned_output_factor(b->e, output, column));
	return operand ? format("%s * %s", factor, operand) : factor;
}

static bool reads_state(const struct emitter *e, const struct output *output, int i)
{
	return is_tuned_output(e, output) ? tuned_output_reads(e, output, i) : mpq_sgn(output->state[i]) != 0;
}

static int add_load_terms(struct batch *b, const struct output *output, const char **term)
{
	const struct linear *system = b->e->system;
	int terms = 0;
	for (int l = 0, column = 0; l < system->loads; l++)
		for (int k = 0; k < system->load[l].columns; k++, column++)
			if (reads_load(b->e, output, column))
				term[terms++] = output_term(b, output, system->states + column, output->load[l][k],
							    shared_place(b->load[1][column]));
	return terms;
}

static int add_input_terms(struct batch *b, const struct output *output, const char **term)
{
	const struct linear *system = b->e->system;
	int terms = 0, column = system->states + load_columns(system);
	for (int i = 0; i < system->inputs; i++) {
		for (int k = 0; k < 2; k++)
			if (reads_input(b->e, output, i, k))
				term[terms++] = output_term(b, output, column + k, output->input[k][i],
							    shared_place(b->input[1][2 * i + k]));
		column += system->input[i].hold + 1;
	}
	return terms;
}

static const char *output_over_lanes(struct batch *b, const struct output *output)
{
	const struct linear *system = b->e->system;
	int terms = 0;
	const char **term =
		ARRAY(const char *, (size_t)(system->states + load_columns(system) + 2 * system->inputs) + 1);
	for (int i = 0; i < system->states; i++)
		if (reads_state(b->e, output, i))
			term[terms++] = output_term(b, output, i, output->state[i], b->e->local[i]);
	bool lanes = terms > 0 || is_tuned_output(b->e, output);
	terms += add_load_terms(b, output, term + terms);
	terms += add_input_terms(b, output, term + terms);
	const char *sum = terms ? tree(terms, term, 13) : "0.0";
	return lanes && terms ? sum : format("pl_lanes_all(%s)", sum);
}

/* A state as outputs read it: of momenta the velocity, of what is kept less its forced part the whole */
static const char *state_over_lanes(const struct batch *b, int i)
{
	const char *mass = factor_of_momentum(b->e, i), *kept = format("y[%d]", i);
	if (mass)
		kept = format("%s / %s", kept, mass);
	return b->forced >= 0 ? format("%s + now[%d]", kept, b->forced + i) : kept;
}

static void emit_lanes_out(struct batch *b)
{
	const struct emitter *e = b->e;
	say(e, "\nPL_LANES_INLINE void $n_lanes_out(const pl_lanes *y, %sconst double *now, pl_lanes *out)\n"
	       "{\n", b->factors ? "const pl_lanes *factor, " : "");
	for (int i = 0; i < e->system->states; i++) {
		bool read = false;
		for (int o = 0; o < e->model->outputs; o++)
			read = read || reads_state(e, &e->model->output[o], i);
		if (read)
			say(e, "    const pl_lanes %s = %s;\n", e->local[i], state_over_lanes(b, i));
	}
	for (int o = 0; o < e->model->outputs; o++)
		say(e, "    out[%d] = %s;  /* %s */\n", o, output_over_lanes(b, &e->model->output[o]),
		    e->model->output[o].name);
	say(e, "    (void)now;\n"
	       "%s"
	       "}\n", b->factors ? "    (void)factor;\n" : "");
}

/* ---- what instances share ---- */

static bool *loads_of_outputs(const struct batch *b)
{
	const struct linear *system = b->e->system;
	bool *wanted = ARRAY(bool, (size_t)system->loads);
	for (int l = 0, column = 0; l < system->loads; l++)
		for (int k = 0; k < system->load[l].columns; k++, column++)
			wanted[l] = wanted[l] || b->load[1][column] >= 0;
	return wanted;
}

static int shared_rows(const struct batch *b)
{
	return b->shared ? b->shared : 1;
}

static const char *nominal_bend(const struct emitter *e)
{
	return e->kind->own_factors ? spell(e, "$n_nominal.bend") : spell(e, "$n_peak_bend");
}

static void emit_acting(const struct batch *b)
{
	const struct emitter *e = b->e;
	int size = e->step->layout.size, acting = size - e->system->states;
	if (!b->acting)
		return;
	say(e, "\n/* What acts on the states at the start of a step, then how far with the spec's values it bends\n"
	       " * outputs */\n"
	       "static void $n_share_acting(const $n *s, %sdouble *acting)\n"
	       "{\n"
	       "    double x[%d];\n"
	       "    size_t j;\n"
	       "    $n_begin_step(s, %sx);\n"
	       "    for (j = $N_STATES; j < %d; j++)\n"
	       "        acting[j - $N_STATES] = x[j];\n", e->system->inputs ? "const double *u, " : "", size,
	    e->system->inputs ? "u, " : "", size);
	for (int p = 0; p < peak_outputs(e->model); p++)
		say(e, "    acting[%d] = 0.0;\n"
		       "    for (j = $N_STATES; j < %d; j++)\n"
		       "        acting[%d] += %s[%d][j] * (x[j] < 0.0 ? -x[j] : x[j]);\n", acting + p, size, acting + p,
		    nominal_bend(e), p);
	say(e, "}\n");
}

/* How far samples no larger than `most` bend an output: by each derivative of the polynomial through them */
static const char *reach_of_samples(const struct emitter *e, int input, int place)
{
	int hold = e->system->input[input].hold;
	const char **term = ARRAY(const char *, (size_t)hold + 1), *power = "";
	for (int m = 0; m <= hold; m++) {
		const char *bend = format("%s[%d][%d]", nominal_bend(e), place, e->step->layout.input[input] + m);
		term[m] = format("%s%s", scaled(tap_reach(hold, m), bend), power);
		power = format("%s / %s", power, step_length(e));
	}
	return tree(hold + 1, term, 16);
}

static void emit_reach(const struct batch *b)
{
	const struct emitter *e = b->e;
	if (!b->sampled)
		return;
	say(e, "\n/* How far at most the samples of n steps bend outputs */\n"
	       "static void $n_share_reach(const $n *s, const double *u, size_t n, double *reach)\n"
	       "{\n"
	       "    double most;\n"
	       "    size_t k;\n");
	for (int p = 0; p < peak_outputs(e->model); p++)
		say(e, "    reach[%d] = 0.0;\n", p);
	for (int i = 0; i < e->system->inputs; i++) {
		say(e, "    most = 0.0;\n"
		       "    for (k = 0; k < %d; k++)\n"
		       "        most = pl_larger_size(most, s->past[%d][k]);\n"
		       "    for (k = 0; k < n; k++)\n"
		       "        most = pl_larger_size(most, u[k * $N_INPUTS + %d]);\n", e->system->input[i].hold, i, i);
		for (int p = 0; p < peak_outputs(e->model); p++)
			say(e, "    reach[%d] += most * (%s);\n", p, reach_of_samples(e, i, p));
	}
	say(e, "    (void)s;\n"
	       "}\n"
	       "\n/* What acts on the states in the steps ahead */\n"
	       "static void $n_ahead_acting(struct $n_ahead *ahead)\n"
	       "{\n"
	       "    double now[%d];\n"
	       "    size_t k;\n"
	       "    for (k = 1; k <= ahead->steps && !ahead->known; k++) {\n"
	       "        $n_share_acting(&ahead->from, ahead->u, ahead->acting[k]);\n"
	       "        $n_share_step(&ahead->from, ahead->u, now);\n"
	       "        ahead->u += $N_INPUTS;\n"
	       "    }\n"
	       "    ahead->known = 1;\n"
	       "}\n", shared_rows(b));
}

static int steps_ahead(const struct emitter *e)
{
	return has_peaks(e) ? STEPS_OF_PEAKS : STEPS_AHEAD;
}

static void emit_ahead(const struct batch *b)
{
	const struct emitter *e = b->e;
	say(e, "\n/* What instances share in some steps ahead: [0] before the first, [k] in step k and behind it */\n"
	       "struct $n_ahead {\n"
	       "    size_t steps;\n"
	       "    double now[%d][%d];\n", steps_ahead(e) + 1, shared_rows(b));
	if (b->acting)
		say(e, "    double acting[%d][%d];  /* on the states, then how far it bends outputs */\n"
		       "    double reach[%d];       /* that at most */\n", steps_ahead(e) + 1, b->acting,
		    peak_outputs(e->model));
	if (b->sampled)
		say(e, "    int known;             /* is `acting` filled in? From these, the samples of the steps: */\n"
		       "    $n from;\n"
		       "    const double *u;\n");
	say(e, "};\n");
}

static void emit_shared(const struct batch *b)
{
	const struct emitter *e = b->e;
	say(e, "\n/* What instances share in a step, which is taken: before it, */\n"
	       "static void $n_share_step(%s, double *now)\n"
	       "{\n", step_parameters(e));
	emit_load_states(e, loads_of_step(e), false);
	for (int i = 0; i < b->after; i++)
		say(e, "    now[%d] = %s;\n", i, b->shared_text[i]);
	emit_step_end(e);
	say(e, "    (void)now;\n"
	       "}\n"
	       "\n/* and in the outputs behind it */\n"
	       "static void $n_share_out(const $n *s, double *now)\n"
	       "{\n");
	emit_load_states(e, loads_of_outputs(b), false);
	for (int i = b->after; i < (b->forced >= 0 ? b->forced : b->shared); i++)
		say(e, "    now[%d] = %s;\n", i, b->shared_text[i]);
	if (b->forced >= 0)
		say(e, "    $n_forced(s, now + %d);\n", b->forced);
	say(e, "    (void)s;\n"
	       "    (void)now;\n"
	       "}\n");
}

/* ---- lanes from the arrays and back ---- */

static void emit_take_own(const struct batch *b)
{
	const struct emitter *e = b->e;
	if (!b->factors)
		return;
	say(e, "    if (b->factors) {\n"
	       "        size_t i;\n"
	       "        for (i = 0; i < %d; i++)\n"
	       "            factor[i] = pl_lanes_load(b->factors + i * b->count + j, left);\n"
	       "    } else {\n"
	       "        const $n *s = &b->shared;\n", b->lanes);
	for (int k = 0; k < b->lanes; k++)
		say(e, "        factor[%d] = pl_lanes_all(%s);\n", k, b->factor_text[k]);
	say(e, "    }\n");
}

/* For the lanes from instance j on; beyond the last there are none. */
static void say_left(const struct emitter *e)
{
	say(e, "    const size_t left = j < b->count ? b->count - j : 0;\n"
	       "    j = left ? j : 0;\n");
}

static void emit_take(const struct batch *b)
{
	const struct emitter *e = b->e;
	say(e, "\n/* As many instances as there are lanes, from j on */\n"
	       "PL_LANES_INLINE void $n_lanes_take(const $n_instances *b, size_t j, pl_lanes *y,%s pl_lanes *peak)\n"
	       "{\n", b->factors ? " pl_lanes *factor," : "");
	say_left(e);
	for (int i = 0; i < stepped_rows(e); i++)
		say(e, "    y[%d] = pl_lanes_load(b->y + %d * b->count + j, left);\n", i, i);
	for (int o = 0; o < e->model->outputs; o++)
		say(e, "    peak[%d] = pl_lanes_load(b->peak + %d * b->count + j, b->peak ? left : 0);\n", o, o);
	emit_take_own(b);
	say(e, "}\n"
	       "\nPL_LANES_INLINE void $n_lanes_give($n_instances *b, size_t j, const pl_lanes *y, "
	       "const pl_lanes *peak)\n"
	       "{\n");
	say_left(e);
	for (int i = 0; i < stepped_rows(e); i++)
		say(e, "    pl_lanes_store(b->y + %d * b->count + j, y[%d], left);\n", i, i);
	say(e, "    if (!b->peak)\n"
	       "        return;\n");
	for (int o = 0; o < e->model->outputs; o++)
		say(e, "    pl_lanes_store(b->peak + %d * b->count + j, peak[%d], left);\n", o, o);
	say(e, "}\n");
}

/* ---- peaks ---- */

static bool reads_rows(const struct emitter *e)
{
	bool any = false;
	for (int o = 0; o < e->model->outputs; o++)
		any = any || (e->model->output[o].peak && is_tuned_output(e, &e->model->output[o]));
	return any;
}

/* One lane that may have passed its peaks inside the step: as NAME_step looks for them */
static void emit_look(const struct batch *b)
{
	const struct emitter *e = b->e;
	int size = e->step->layout.size, states = e->system->states;
	bool own = e->kind->own_factors;
	say(e, "\n/* Instance j by itself, from the states y on: larger values inside the step that ends at value */\n"
	       "static void $n_batch_look(const $n_instances *b, size_t j, const double *y, %sconst double *value,\n"
	       "    double *peak)\n"
	       "{\n"
	       "    double x[%d], work[PL_PEAK_WORK(%d)]%s;\n"
	       "    size_t i;\n", b->acting ? "const double *acting, " : "", size, size,
	    own && reads_rows(e) ? format(", row[%d]", size) : "");
	say(e, own ? "    $n one = b->shared, *s = &one;\n" : "");
	for (int k = 0; k < b->factors; k++)
		say(e, "%s    %s = b->factors[%d * b->count + j];\n", k ? "    " : "    if (b->factors) {\n    ",
		    b->factor_text[k], k);
	say(e, "%s    for (i = 0; i < %d; i++)\n"
	       "        x[i] = %s;\n", b->factors ? "    }\n" : "", size,
	    b->acting ? spell(e, "i < $N_STATES ? y[i] : acting[i - $N_STATES]") : "y[i]");
	for (int i = 0; i < states; i++)
		if (factor_of_momentum(e, i))
			say(e, "    x[%d] = y[%d] / %s;\n", i, i, factor_of_momentum(e, i));
	for (int o = 0; o < e->model->outputs; o++)
		if (e->model->output[o].peak)
			emit_peak_look(e, &e->model->output[o], format("peak[%d]", o), format("value[%d]", o));
	say(e, "    (void)b;\n"
	       "    (void)j;\n"
	       "}\n");
}

static const char *bend_over_lanes(struct batch *b, int p)
{
	const struct emitter *e = b->e;
	const char **term = ARRAY(const char *, (size_t)e->system->states + 1);
	const struct peaks peaks = peaks_of(e->step);
	int terms = 0;
	for (int i = 0; i < e->system->states; i++) {
		const char *size = format("pl_lanes_peak(pl_lanes_all(0.0), state[%d]%s%s)", i,
					  factor_of_momentum(e, i) ? " / " : "",
					  factor_of_momentum(e, i) ? factor_of_momentum(e, i) : "");
		term[terms++] = e->kind->own_factors
			? format("%s * %s", own_factor(b, format("s->coeffs.bend[%d][%d]", p, i)), size)
			: scaled(peaks.bend[p * e->step->layout.size + i], size);
	}
	if (acts(e) && e->kind->own_factors)
		term[terms++] = format("%s * reach[%d]", own_factor(b, format("s->coeffs.reach[%d]", p)), p);
	else if (acts(e))
		term[terms++] = format("reach[%d]", p);
	return tree(terms, term, 15);
}

/* Of what lanes' states and outputs are at most, in a step or in some: may values in between have passed a peak? */
static void emit_may_pass(struct batch *b)
{
	const struct emitter *e = b->e;
	say(e, "\nPL_LANES_INLINE int $n_lanes_may_pass(const pl_lanes *state, %s%sconst pl_lanes *top,\n"
	       "    const pl_lanes *peak, pl_lanes *most)\n"
	       "{\n"
	       "    int any = 0;\n", b->factors ? "const pl_lanes *factor, " : "",
	    b->acting ? "const double *reach, " : "");
	for (int o = 0; o < e->model->outputs; o++)
		if (e->model->output[o].peak)
			say(e, "    most[%d] = top[%d] + (%s);  /* %s */\n"
			       "    any |= pl_lanes_above(most[%d], peak[%d]);\n", o, o,
			    bend_over_lanes(b, peak_place(e->model, &e->model->output[o])),
			    e->model->output[o].name, o, o);
		else
			say(e, "    most[%d] = peak[%d];\n", o, o);
	say(e, "    return any;\n"
	       "}\n");
}

/* Where a lane may have passed a peak, each is looked at by itself. */
static void emit_lanes_look(struct batch *b)
{
	const struct emitter *e = b->e;
	int states = e->system->states, outputs = e->model->outputs;
	emit_look(b);
	say(e, "\nstatic void $n_lanes_look(const $n_instances *b, size_t j, const pl_lanes *start,\n"
	       "    %sconst pl_lanes *most, const pl_lanes *value, pl_lanes *peak)\n"
	       "{\n"
	       "    double y[%d], end[%d], largest[%d], bound;\n"
	       "    const size_t lanes = sizeof(pl_lanes) / sizeof(double);\n"
	       "    size_t l, i;\n", b->acting ? "const double *acting, " : "", states, outputs, outputs);
	say(e, "    for (l = 0; l < lanes && j + l < b->count; l++) {\n"
	       "        int any = 0;\n"
	       "        for (i = 0; i < %d; i++)\n"
	       "            memcpy(&y[i], (const char *)&start[i] + l * sizeof(double), sizeof(double));\n"
	       "        for (i = 0; i < %d; i++) {\n"
	       "            memcpy(&end[i], (const char *)&value[i] + l * sizeof(double), sizeof(double));\n"
	       "            memcpy(&largest[i], (const char *)&peak[i] + l * sizeof(double), sizeof(double));\n"
	       "            memcpy(&bound, (const char *)&most[i] + l * sizeof(double), sizeof(double));\n"
	       "            any |= !(bound <= largest[i]);\n"
	       "        }\n"
	       "        if (any)\n"
	       "            $n_batch_look(b, j + l, y, %send, largest);\n"
	       "        for (i = 0; i < %d; i++)\n"
	       "            memcpy((char *)&peak[i] + l * sizeof(double), &largest[i], sizeof(double));\n"
	       "    }\n"
	       "}\n", states, outputs, b->acting ? "acting, " : "", outputs);
}

/* Peaks of which values inside the step may pass are looked for. */
static void say_look(const struct batch *b)
{
	const struct emitter *e = b->e;
	for (int o = 0; o < e->model->outputs; o++)
		if (e->model->output[o].peak)
			say(e, "    top[%d] = pl_lanes_peak(pl_lanes_peak(pl_lanes_all(0.0), before[%d]), "
			       "value[%d]);\n", o, o, o);
		else
			say(e, "    top[%d] = peak[%d];\n", o, o);
	say(e, "    if ($n_lanes_may_pass(start, %s%stop, peak, most)) {\n"
	       "        const pl_lanes from[$N_STATES] = {", b->factors ? "factor, " : "",
	    b->acting ? format("acting + %d, ", e->step->layout.size - e->system->states) : "");
	for (int i = 0; i < e->system->states; i++)
		say(e, "%sstart[%d]", i ? ", " : "", i);
	say(e, "};  /* these are in memory here only */\n"
	       "        pl_lanes to[$N_OUTPUTS], bound[$N_OUTPUTS], largest[$N_OUTPUTS];\n"
	       "        memcpy(to, value, sizeof to);\n"
	       "        memcpy(bound, most, sizeof bound);\n"
	       "        memcpy(largest, peak, sizeof largest);\n"
	       "        $n_lanes_look(b, j, from, %sbound, to, largest);\n"
	       "        memcpy(peak, largest, sizeof largest);\n"
	       "    }\n", b->acting ? "acting, " : "");
}

/* Outputs of a step's end into peak and out, where they are wanted */
static void emit_tell(struct batch *b)
{
	const struct emitter *e = b->e;
	bool peaks = has_peaks(e);
	say(e, "\nPL_LANES_INLINE void $n_lanes_tell(const $n_instances *b, size_t j,\n"
	       "    %sconst pl_lanes *y,%s const double *now, %s%spl_lanes *peak, double *out)\n"
	       "{\n"
	       "    pl_lanes value[$N_OUTPUTS];\n"
	       "%s"
	       "    $n_lanes_out(y, %snow, value);\n", peaks ? "const pl_lanes *start, " : "",
	    b->factors ? " const pl_lanes *factor," : "", b->acting ? "const double *acting, " : "",
	    peaks ? "pl_lanes *before, " : "",
	    peaks ? spell(e, "    pl_lanes top[$N_OUTPUTS], most[$N_OUTPUTS];  /* at its ends, in it */\n") : "",
	    b->factors ? "factor, " : "");
	if (peaks)
		say_look(b);
	for (int o = 0; o < e->model->outputs; o++) {
		say(e, "    peak[%d] = pl_lanes_peak(peak[%d], value[%d]);\n", o, o, o);
		if (e->model->output[o].peak)
			say(e, "    before[%d] = value[%d];\n"
			       "    value[%d] = peak[%d];\n", o, o, o, o);
	}
	say(e, "    if (out && j < b->count) {\n");
	for (int o = 0; o < e->model->outputs; o++)
		say(e, "        pl_lanes_store(out + %d * b->count + j, value[%d], b->count - j);\n", o, o);
	say(e, "    }\n"
	       "}\n");
}

/* ---- groups of lanes over some steps ---- */

static const char *from_group(int group)
{
	return group > 1 ? format("first + %d * lanes", group) : group ? "first + lanes" : "first";
}

/* A line for each group: # its number, @ its first instance, ! its factors where there are some */
static void say_groups(const struct batch *b, int groups, const char *layout)
{
	const struct emitter *e = b->e;
	for (int g = 0; g < groups; g++) {
		say(e, "    ");
		for (const char *text = layout; *text; text++)
			if (*text == '#')
				say(e, "%d", g);
			else if (*text == '@')
				say(e, "%s", from_group(g));
			else if (*text == '!')
				say(e, b->factors ? "factor[%d], " : "", g);
			else if (*text == '\t')
				say(e, "    ");
			else
				say(e, "%c", *text);
		say(e, "\n");
	}
}

static void say_locals(const struct batch *b, int groups)
{
	const struct emitter *e = b->e;
	say(e, "%s"
	       "    pl_lanes y[%d][%d], peak[%d][$N_OUTPUTS];\n",
	    groups > 1 ? "    const size_t lanes = sizeof(pl_lanes) / sizeof(double);\n" : "", groups,
	    stepped_rows(e), groups);
	if (b->factors)
		say(e, "    pl_lanes factor[%d][%d];\n", groups, b->lanes);
}

/* Step by step, with outputs of each */
static void emit_block(const struct batch *b, const char *name, int groups)
{
	const struct emitter *e = b->e;
	bool peaks = has_peaks(e);
	say(e, "\n/* Instances from `first` on, %s, over the steps ahead */\n"
	       "static void $n_batch_%s($n_instances *b, size_t first, %sstruct $n_ahead *ahead, double *out)\n"
	       "{\n", groups > 1 ? format("%d a lane", groups) : "one a lane", name, b->sampled ? "" : "const ");
	say_locals(b, groups);
	if (peaks)
		say(e, "    pl_lanes start[%d][$N_STATES], before[%d][$N_OUTPUTS];\n", groups, groups);
	say(e, "    size_t k;\n");
	say_groups(b, groups, spell(e, "$n_lanes_take(b, @, y[#], !peak[#]);"));
	if (peaks)
		say_groups(b, groups, spell(e, "$n_lanes_out(y[#], !ahead->now[0], before[#]);"));
	if (b->sampled)
		say(e, "    $n_ahead_acting(ahead);\n");
	say(e, "    for (k = 1; k <= ahead->steps; k++) {\n");
	for (int i = 0; i < e->system->states && peaks; i++)
		say_groups(b, groups, format("\tstart[#][%d] = y[#][%d];", i, i));
	say_groups(b, groups, spell(e, "\t$n_lanes_step(y[#], !ahead->now[k]);"));
	say(e, "        if (b->peak || out) {\n");
	say_groups(b, groups, spell(e, "\t\t$n_lanes_tell(b, @, %sy[#], !ahead->now[k], %s%speak[#], out);",
				    peaks ? "start[#], " : "", b->acting ? "ahead->acting[k], " : "",
				    peaks ? "before[#], " : ""));
	say(e, "            out = out ? out + $N_OUTPUTS * b->count : NULL;\n"
	       "        }\n"
	       "    }\n");
	say_groups(b, groups, spell(e, "$n_lanes_give(b, @, y[#], peak[#]);"));
	say(e, "}\n");
}

/* ---- steps of which only the peaks are wanted: mostly clear by what states and outputs are at most ---- */

/* Of these, what lanes have before the first step, and after each */
static void emit_lanes_widen(const struct batch *b)
{
	const struct emitter *e = b->e;
	int states = e->system->states, outputs = e->model->outputs;
	const char *own = b->factors ? "const pl_lanes *factor, " : "", *given = b->factors ? "factor, " : "";
	say(e, "\n/* The largest |state| and |output| so far */\n"
	       "PL_LANES_INLINE void $n_lanes_first(const pl_lanes *y, %sconst double *now, pl_lanes *state,\n"
	       "    pl_lanes *top)\n"
	       "{\n"
	       "    $n_lanes_out(y, %snow, top);\n", own, given);
	for (int i = 0; i < states; i++)
		say(e, "    state[%d] = pl_lanes_peak(pl_lanes_all(0.0), y[%d]);\n", i, i);
	for (int o = 0; o < outputs; o++)
		say(e, e->model->output[o].peak ? "    top[%d] = pl_lanes_peak(pl_lanes_all(0.0), top[%d]);\n"
						: "    top[%d] = pl_lanes_all(0.0);\n", o, o);
	say(e, "}\n"
	       "\nPL_LANES_INLINE void $n_lanes_widen(const pl_lanes *y, %sconst double *now, pl_lanes *state,\n"
	       "    pl_lanes *top)\n"
	       "{\n"
	       "    pl_lanes value[$N_OUTPUTS];\n"
	       "    $n_lanes_out(y, %snow, value);\n", own, given);
	for (int i = 0; i < states; i++)
		say(e, "    state[%d] = pl_lanes_peak(state[%d], y[%d]);\n", i, i, i);
	for (int o = 0; o < outputs; o++)
		say(e, "    top[%d] = pl_lanes_peak(top[%d], value[%d]);\n", o, o, o);
	say(e, "}\n");
}

/* The peaks at ends of steps are known before extremes are looked for: few are larger. */
static void emit_lanes_end(const struct batch *b)
{
	const struct emitter *e = b->e;
	int outputs = e->model->outputs;
	say(e, "\n/* After these steps: where there may be more in between they are taken again, one by one. */\n"
	       "PL_LANES_INLINE void $n_lanes_end($n_instances *b, size_t j, %sstruct $n_ahead *ahead,\n"
	       "    const pl_lanes *y, %sconst pl_lanes *state, const pl_lanes *top, pl_lanes *peak)\n"
	       "{\n"
	       "    pl_lanes most[$N_OUTPUTS];\n", b->sampled ? "" : "const ",
	    b->factors ? "const pl_lanes *factor, " : "");
	for (int o = 0; o < outputs; o++)
		say(e, "    peak[%d] = pl_lanes_peak(peak[%d], top[%d]);\n", o, o, o);
	say(e, "    if (!b->peak || !$n_lanes_may_pass(state, %s%stop, peak, most)) {\n"
	       "        $n_lanes_give(b, j, y, peak);\n"
	       "        return;\n"
	       "    }\n", b->factors ? "factor, " : "", b->acting ? "ahead->reach, " : "");
	for (int o = 0; o < outputs; o++)
		say(e, "    pl_lanes_store(b->peak + %d * b->count + j, peak[%d], b->count - j);\n", o, o);
	say(e, "    $n_batch_one_by_one(b, j, ahead, NULL);\n"
	       "}\n");
}

static void emit_swift_block(const struct batch *b, const char *name, int groups)
{
	const struct emitter *e = b->e;
	say(e, "\n/* Instances from `first` on, %s, over the steps ahead */\n"
	       "static void $n_batch_%s($n_instances *b, size_t first, %sstruct $n_ahead *ahead)\n"
	       "{\n", groups > 1 ? format("%d a lane", groups) : "one a lane", name, b->sampled ? "" : "const ");
	say_locals(b, groups);
	say(e, "    pl_lanes state[%d][$N_STATES], top[%d][$N_OUTPUTS];\n"
	       "    size_t k;\n", groups, groups);
	say_groups(b, groups, spell(e, "$n_lanes_take(b, @, y[#], !peak[#]);"));
	say_groups(b, groups, spell(e, "$n_lanes_first(y[#], !ahead->now[0], state[#], top[#]);"));
	say(e, "    for (k = 1; k <= ahead->steps; k++) {\n");
	say_groups(b, groups, spell(e, "\t$n_lanes_step(y[#], !ahead->now[k]);"));
	say_groups(b, groups, spell(e, "\t$n_lanes_widen(y[#], !ahead->now[k], state[#], top[#]);"));
	say(e, "    }\n");
	say_groups(b, groups, spell(e, "$n_lanes_end(b, @, ahead, y[#], !state[#], top[#], peak[#]);"));
	say(e, "}\n");
}

/* ---- NAME_batch ---- */

static void emit_blocks(struct batch *b)
{
	const struct emitter *e = b->e;
	int groups = groups_of(e);
	if (!has_peaks(e)) {
		emit_block(b, "block", groups);
		if (groups > 1)
			emit_block(b, "group", 1);
		return;
	}
	emit_block(b, "one_by_one", 1);
	emit_lanes_widen(b);
	emit_lanes_end(b);
	emit_swift_block(b, "block", groups);
	if (groups > 1)
		emit_swift_block(b, "group", 1);
}

/* ... computed, or of samples bounded, for as many steps as there are, u at the first */
static void say_shared_steps(const struct batch *b)
{
	const struct emitter *e = b->e;
	bool inputs = e->system->inputs > 0;
	int peaks = peak_outputs(e->model);
	say(e, "        ahead.steps = n < %d ? n : %d;\n"
	       "        $n_share_out(&b->shared, ahead.now[0]);\n", steps_ahead(e), steps_ahead(e));
	if (b->sampled)
		say(e, "        ahead.known = 0;\n"
		       "        ahead.from = b->shared;\n"
		       "        ahead.u = u;\n"
		       "        $n_share_reach(&b->shared, u, ahead.steps, ahead.reach);\n");
	for (int p = 0; p < peaks && b->acting && !b->sampled; p++)
		say(e, "        ahead.reach[%d] = 0.0;\n", p);
	say(e, "        for (k = 1; k <= ahead.steps; k++) {\n");
	if (b->acting && !b->sampled)
		say(e, "            $n_share_acting(&b->shared, %sahead.acting[k]);\n", inputs ? "u, " : "");
	for (int p = 0; p < peaks && b->acting && !b->sampled; p++)
		say(e, "            ahead.reach[%d] = pl_larger_size(ahead.reach[%d], ahead.acting[k][%d]);\n", p, p,
		    b->acting - peaks + p);
	say(e, "            $n_share_step(&b->shared, %sahead.now[k]);\n"
	       "            $n_share_out(&b->shared, ahead.now[k]);\n", inputs ? "u, " : "");
	if (inputs)
		say(e, "            u += $N_INPUTS;\n");
	say(e, "        }\n");
}

/* As many whole blocks as there are, then single groups */
static void say_blocks(const struct batch *b)
{
	const struct emitter *e = b->e;
	bool single = groups_of(e) > 1;
	const char *wanted = has_peaks(e) ? "!out && " : "", *last = has_peaks(e) ? "" : ", out";
	if (has_peaks(e))
		say(e, "        for (first = 0; out && first < b->count; first += lanes)\n"
		       "            $n_batch_one_by_one(b, first, &ahead, out);\n");
	say(e, "        for (first = 0; %sfirst < b->count%s; first += block)\n"
	       "            $n_batch_block(b, first, &ahead%s);\n", wanted,
	    single ? " && b->count - first > block - lanes" : "", last);
	if (single)
		say(e, "        for (; %sfirst < b->count; first += lanes)\n"
		       "            $n_batch_group(b, first, &ahead%s);\n", wanted, last);
}

static void emit_batch_function(const struct batch *b)
{
	const struct emitter *e = b->e;
	int groups = groups_of(e);
	bool single = groups > 1, lanes = single || has_peaks(e);
	say(e, "\nvoid $n_batch($n_instances *b, size_t n, %sdouble *out)\n"
	       "{\n"
	       "    const size_t %sblock = %s%s;\n"
	       "    struct $n_ahead ahead;\n"
	       "    size_t first, k;\n", e->system->inputs ? "const double *u, " : "",
	    lanes ? "lanes = sizeof(pl_lanes) / sizeof(double), " : "", single ? format("%d * ", groups) : "",
	    lanes ? "lanes" : "sizeof(pl_lanes) / sizeof(double)");
	say(e, "    for (; n > 0; n -= ahead.steps) {\n");
	say_shared_steps(b);
	say_blocks(b);
	say(e, "        out = out ? out + ahead.steps * $N_OUTPUTS * b->count : NULL;\n"
	       "    }\n"
	       "}\n");
}

/* ---- init, set, get, use ---- */

/* Rows of instance j from those of one alone, or into it */
static void say_rows(const struct emitter *e, bool into)
{
	struct member member[5];
	int count = members_of(e, member), row = 0;
	for (int i = 0; i < count; i++) {
		const char *from = row ? format("(%d + i)", row) : "i";
		const char *there = format("b->y[%s * b->count + j]", from);
		const char *here = format("one.%s[i]", member[i].name);
		say(e, "    for (i = 0; i < %d; i++)\n"
		       "        %s = %s;\n", member[i].rows, into ? there : here, into ? here : there);
		row += member[i].rows;
	}
}

static void emit_write(const struct batch *b)
{
	const struct emitter *e = b->e;
	say(e, "\n/* One instance alone as instance j; its peaks are what its outputs are now. */\n"
	       "static void $n_batch_write($n_instances *b, size_t j, const $n *s)\n"
	       "{\n"
	       "    %s$n one = *s;\n"
	       "    double out[$N_OUTPUTS];\n"
	       "    size_t i;\n", b->factors ? "" : "const ");
	say_rows(e, true);
	if (b->factors)
		say(e, "    if (b->factors) {\n");
	for (int k = 0; k < b->factors; k++)
		say(e, "        one.%s = b->factors[%d * b->count + j];\n", strchr(b->factor_text[k], '>') + 1, k);
	if (b->factors)
		say(e, "    }\n");
	say(e, "    $n_out(&one, out);\n"
	       "    for (i = 0; i < $N_OUTPUTS && b->peak; i++)\n"
	       "        b->peak[i * b->count + j] = out[i] < 0.0 ? -out[i] : out[i];\n"
	       "}\n");
}

static void emit_use(const struct batch *b)
{
	const struct emitter *e = b->e;
	if (!b->factors)
		return;
	say(e, "\nint $n_batch_use($n_instances *b, size_t j, const $n_coeffs *c)\n"
	       "{\n"
	       "    $n one = b->shared, *s = &one;\n"
	       "    if (!b->factors || !(c->h == b->shared.coeffs.h))\n"
	       "        return PL_NO_STEP;\n"
	       "    s->coeffs = *c;\n");
	for (int k = 0; k < b->factors; k++)
		say(e, "    b->factors[%d * b->count + j] = %s;\n", k, b->factor_text[k]);
	say(e, "    return 0;\n"
	       "}\n");
}

static void emit_batch_access(const struct batch *b)
{
	const struct emitter *e = b->e;
	emit_write(b);
	emit_use(b);
	say(e, "\nvoid $n_batch_init($n_instances *b)\n"
	       "{\n"
	       "    size_t j;\n"
	       "    $n_init(&b->shared);\n"
	       "    for (j = 0; j < b->count; j++) {\n"
	       "%s"
	       "        $n_batch_write(b, j, &b->shared);\n"
	       "    }\n"
	       "}\n", b->factors ? spell(e, "        (void)$n_batch_use(b, j, &b->shared.coeffs);\n") : "");
	say(e, "\nvoid $n_batch_set($n_instances *b, size_t j, const double y[$N_STATES])\n"
	       "{\n"
	       "    $n one = b->shared;\n"
	       "    $n_set(&one, $n_time(&b->shared), y);\n"
	       "    $n_batch_write(b, j, &one);\n"
	       "}\n"
	       "\nvoid $n_batch_get(const $n_instances *b, size_t j, double y[$N_STATES])\n"
	       "{\n"
	       "    $n one = b->shared;\n"
	       "    size_t i;\n");
	say_rows(e, false);
	say(e, "    $n_get(&one, y);\n"
	       "}\n");
}

void emit_batch(const struct emitter *e)
{
	struct batch b = plan(e);
	emit_ahead(&b);
	emit_acting(&b);
	emit_shared(&b);
	emit_reach(&b);
	emit_lanes_step(&b);
	emit_lanes_out(&b);
	emit_take(&b);
	if (has_peaks(e)) {
		emit_may_pass(&b);
		emit_lanes_look(&b);
	}
	emit_tell(&b);
	emit_blocks(&b);
	emit_batch_function(&b);
	emit_batch_access(&b);
}
