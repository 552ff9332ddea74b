/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Any time: NAME_at inside a step by a Taylor series, NAME_jump over many steps by powers of the step. */
#include "inner.h"
#include "emit/series/series.h"
#include "emit/steps.h"
#include "step/linear/forms.h"

#include <string.h>

/* ---- at ---- */

/* Names of the entries of the series' vector; `slopes`: of the states' rows. */
/* Rows of x' */
static const char **series_names(const struct emitter *e)
{
	const char **name = layout_names(&e->step->layout, e->system, e->model);
	for (int i = 0; i < e->system->states; i++)
		name[i] = format("%s'", name[i]);
	return name;
}

static void emit_held(const struct emitter *e)
{
	if (e->step->layout.held < 0)
		return;
	int states = e->system->states;
	const struct coefficient *force = held_forces_of(e->step);
	for (int i = 0; i < e->model->n; i++) {
		struct summands s = { 0 };
		for (int j = 0; j < states; j++)
			if (!force[i * states + j].zero)
				add_summand(&s, scaled(force[i * states + j].value, format("s->y[%d]", j)));
		say(e, "    x[%d] = %s;  /* held for %s */\n", e->step->layout.held + i, sum_of(&s, 12),
		    e->model->names.coord[i]);
	}
}

/* x[...] = the load states, from index[l] on */
void store_loads(const struct emitter *e, const int *index)
{
	for (int l = 0; l < e->system->loads; l++)
		for (int k = 0; k < e->system->load[l].columns && index[l] >= 0; k++) {
			const char *value = load_operand(e, l, k);
			say(e, "    x[%d] = %s;\n", index[l] + k, value ? value : "1.0");
		}
}

bool *wanted_loads(const struct emitter *e, const int *index)
{
	bool *wanted = ARRAY(bool, (size_t)e->system->loads);
	for (int l = 0; l < e->system->loads; l++)
		wanted[l] = index[l] >= 0;
	return wanted;
}

/* An input and its derivatives at the start of the step */
static void store_derivatives(const struct emitter *e, int input, int at)
{
	int hold = e->system->input[input].hold, before = 0;
	const char *power = "";
	RATIONAL weight = ZERO, one = RATIO(1, 1);
	for (int i = 0; i < input; i++)
		before += e->system->input[i].hold + 1;
	for (int m = 0; m <= hold; m++) {
		struct summands s = { 0 };
		for (int c = 0; c <= hold; c++) {
			sample_derivative(hold, m, c, one, weight);
			if (mpq_sgn(weight) != 0)
				add_summand(&s, scaled(round_rational(weight), input_operand(e, before + c)));
		}
		say(e, "    x[%d] = (%s)%s;\n", at + m, sum_of(&s, 13),
		    m > 1 ? format(" / (%s)", power) : m ? format(" / %s", power) : "");
		power = m ? format("%s * %s", power, step_length(e)) : step_length(e);
	}
}

void store_inputs(const struct emitter *e, const int *index)
{
	for (int i = 0, column = 0; i < e->system->inputs; column += e->system->input[i++].hold + 1) {
		bool ramp = e->system->input[i].hold;
		if (e->system->input[i].hold > 1) {
			store_derivatives(e, i, index[i]);
			continue;
		}
		say(e, "    x[%d] = %s;\n", index[i],
		    e->sample ? e->sample[column] : format("%s[%d]", ramp ? "s->u" : "u", i));
		if (ramp)
			say(e, "    x[%d] = %s;\n", index[i] + 1,
			    e->sample ? slope_of_samples(e, e->sample[column + 1], e->sample[column])
				      : ramp_slope(e, i));
	}
}

/* Of a schedule: one matrix for each operator */
void emit_series_slopes(const struct emitter *e)
{
	const int size = e->step->layout.size, branches = e->step->branches, each = size * size;
	const char *acts = size > e->system->states ? ", then load states and inputs" : "";
	double *value = ARRAY(double, (size_t)(branches * each));
	for (int k = 0; k < branches; k++)
		memcpy(value + k * each, slopes_of(e->step, k), (size_t)each * sizeof *value);
	const int sizes[] = { branches, size, size };
	if (branches > 1)
		emit_array(e, format("A of x' = A x, for each operator; x: the states%s", acts), "slope",
			   3, sizes, value,
			   series_names(e));
	else
		emit_array(e, format("A of x' = A x; x: the states%s", acts), "slope",
			   2, sizes + 1, value, series_names(e));
}

static const char *slope_text(const struct emitter *e)
{
	return e->step->branches > 1 ? format("%s_slope[which]", e->name) : format("%s_slope", e->name);
}

static const char *input_parameter(const struct emitter *e)
{
	return given_inputs(e) ? format("const double u[%s_INPUTS], ", e->upper) : "";
}

static void emit_remainder_now(const struct emitter *e)
{
	if (e->step->layout.powers == 1)
		say(e, "    %s\n", remainder_of_step(e, 0, "s->y", "remainder"));
}

void emit_series_vector(const struct emitter *e, bool looped)
{
	const struct layout *layout = &e->step->layout;
	const bool full = e->step->forced && !loads_change(e->system) && !e->model->relative;
	emit_load_states(e, wanted_loads(e, layout->load), false);
	const int force_columns = layout->powers ? layout->powers * e->system->force_columns : 0;
	if (looped || force_columns)
		say(e, "    int i;\n");
	if (!loads_change(e->system))
		emit_remainder_now(e);
	say(e, "    $n_%s(s, x);\n", full ? "kept" : "stored_state");
	emit_held(e);
	store_loads(e, layout->load);
	store_inputs(e, layout->input);
	if (force_columns)
		say(e, "    for (i = 0; i < %d; i++) { x[%d + i] = %s; }\n", force_columns, layout->force_column,
		    layout->powers > 1 ? "0.0"
		    : loads_change(e->system) ? "remainder ? remainder[i] : 0.0" : "remainder[i]");
}

void emit_vector_now(const struct emitter *e)
{
	open_function(e, "x now: the states, load states and inputs",
		   "static void $n_vector_now(const $n *s, const double u[], double x[%d])",
		      e->step->layout.size);
	emit_series_vector(e, false);
	close_function(e, "u");
}

/* ---- loads that change their formula ---- */

/* Of the load states that the step leaves out: their places in rows of what they add, and in x; returns how many */
static int emit_forced_places(const struct emitter *e)
{
	int *place = ARRAY(int, 2 * (size_t)e->step->branch->full->columns), count = 0;
	for (int l = 0, column = 0; l < e->system->loads; column += e->system->load[l++].columns)
		for (int j = 0; e->step->forced && e->step->forced->load[l] && j < e->system->load[l].columns; j++) {
			place[2 * count] = column + j;
			place[2 * count++ + 1] = e->step->layout.load[l] + j;
		}
	if (count)
		emit_integer_rows(e, "int", format("forced_at[%d][2]", count), count, 2, place);
	return count;
}

/* Columns of A that each segment has its own of */
static void emit_load_slopes(const struct emitter *e, const struct load_slopes *slopes)
{
	const int states = e->system->states, sizes[] = { e->system->segments, states, slopes->columns };
	const int each = states * slopes->columns;
	double *value = ARRAY(double, (size_t)(e->system->segments * each));
	for (int s = 0; s < e->system->segments; s++)
		memcpy(value + s * each, slopes->segment[s], (size_t)each * sizeof *value);
	emit_array(e, format("Input matrix: the columns of A from %d on, in each segment of time", slopes->first),
		   "load_slope", 3,
		   sizes, value, series_names(e));
}

static void emit_passing_algorithm(const struct emitter *e)
{
	const struct forced *forced = e->step->forced;
	const int acting = e->step->layout.size - e->system->states;
	const bool changes = loads_change(e->system);
	const int blocks = !changes && is_blockwise(e) ? count_blocks(e) : 0;
	const struct load_slopes slopes = changes ? load_slopes_of(e->step) : (struct load_slopes){ .first = -1 };
	if (slopes.first >= 0)
		emit_load_slopes(e, &slopes);
	emit_sizes(e, "changes.h", { "STATES", e->system->states }, { "SIZE", e->step->layout.size },
		   { "BLOCKS", blocks }, { "LARGEST", blocks ? states_of_largest_block(e) + acting : 0 },
		   { "SEGMENTS", e->system->segments },
		   { "DEGREE", e->step->series.degree }, { "HALVINGS", e->step->series.halvings },
		   { "CHANGING", slopes.columns }, { "FIRST", slopes.first },
		   { "FORCED", blocks ? 0 : emit_forced_places(e) }, { "LOAD_STATES", e->step->branch->full->columns },
		   { "LOSES", forced && forced->changes });
	say(e, "#include \"changes.h\"\n");
}

/* y at tau after now, from change to change */
void emit_passing(const struct emitter *e)
{
	const struct layout *layout = &e->step->layout;
	const bool forced = e->step->forced != NULL;
	emit_series_slopes(e);
	emit_passing_algorithm(e);
	open_function(e, "The state tau after now; split where loads change their formula",
		      "static %s $n_pass(const $n *s, %s%s%sdouble tau, %sdouble y[$N_STATES])",
		      forced ? "int" : "void", e->step->branches > 1 ? "int which, " : "", input_parameter(e),
		      layout->powers == 1 ? "const double *remainder, " : "", forced ? "int whole, " : "");
	say(e, "    double x[%d];\n", layout->size);
	emit_series_vector(e, true);
	say(e, "    %s$n_pass_changes(s, %s, %s, tau, x);\n"
	       "    for (i = 0; i < $N_STATES; i++) { y[i] = x[i]; }\n"
	       "%s}\n", forced ? "const int segment = " : "(void)", slope_text(e), forced ? "whole" : "0",
	    forced ? "    return segment;\n" : "");
}

void emit_changes(const struct emitter *e)
{
	say(e, "\n"
	       "static const pl_two $n_change[%d] = {  /* times when loads change their formula [s] */\n",
	    e->system->segments - 1);
	for (int i = 0; i < e->system->segments - 1; i++) {
		finite_number(e, e->system->change[i]);
		say(e, "    %s,\n", two_text(e->system->change[i]));
	}
	say(e, "};\n");
	open_function(e, "Time from now to a change [s]", "static double $n_until(const $n *s, int change)");
	say(e, "    %sconst pl_two h = %s;\n"
	       "    return pl_until(s->t0, s->k, h, $n_change[change]);\n", e->step->is.tuned ? "" : "static ",
	    e->step->is.tuned ? "{s->coeffs.h, s->coeffs.h_low}" : two_text(e->model->h));
	close_function(e, "");
}

void emit_held_remainder(const struct emitter *e)
{
	emit_samples(e);
	if (e->step->branches > 1)
		say(e, "    const int which = %s;\n", selection_call(e));
	say(e, "    double remainder[%d];\n", e->system->force_columns);
}

/* Differences are kept, and what loads sustain is added to the states as written. */
static bool adds_sustained(const struct emitter *e)
{
	return e->step->forced && e->model->relative;
}

/* By the load states in x */
static void emit_sustained_then(const struct emitter *e)
{
	const char **text = ARRAY(const char *, (size_t)e->step->branch->full->columns);
	int column = 0;
	for (int l = 0; l < e->system->loads; l++)
		for (int j = 0; j < e->system->load[l].columns; j++)
			text[column++] = e->step->forced->load[l] ? format("x[%d]", e->step->layout.load[l] + j)
								  : "0.0";
	say_vector(e, "load", column, text);
	say(e, "    $n_add_sustained(s, $n_forced_part[%s] + $N_STATES, load, y);\n",
	    loads_change(e->system) ? "segment" : "0");
}

/* y, for the user, from the head of x; behind it the load states */
void emit_hand_over(const struct emitter *e)
{
	if (e->model->relative)
		say(e, "    $n_written(s, x, y);\n");
	if (adds_sustained(e))
		emit_sustained_then(e);
	if (!e->model->relative)
		say(e, "    for (i = 0; i < $N_STATES; i++) { y[i] = x[i]; }\n");
}

/* At the start of the step the state is what $n_get gives, to the last bit. */
void emit_at_start(const struct emitter *e)
{
	say(e, "    if (!(tau > 0.0)) {\n"
	       "        $n_get(s, y);\n"
	       "        return;\n"
	       "    }\n");
}

void emit_at_by(const struct emitter *e, const char *function)
{
	const bool relative = e->model->relative != NULL;
	open_function(e, NULL, "void $n_at(const $n *s, %sdouble tau, double y[$N_STATES])", driven_parameter(e));
	if (relative)
		say(e, "    double x[$N_STATES];\n");
	say(e, "    $n_%s(s, %s, tau, %s);\n", function, e->system->inputs ? "u" : "NULL", relative ? "x" : "y");
	if (relative)
		say(e, "    $n_written(s, x, y);\n");
	close_function(e, "");
}

/* Where the loads change their formula on the way */
static void emit_passing_at(const struct emitter *e)
{
	const char *which = e->step->branches > 1 ? "which, " : "", *u = given_inputs(e) ? "u, " : "";
	const char *remainder = e->step->layout.powers == 1 ? "remainder, " : "", *full = e->step->forced ? "1, " : "";
	bool relative = e->model->relative != NULL;
	emit_remainder_now(e);
	if (relative)
		say(e, "    double x[$N_STATES];\n");
	if (e->step->forced)            /* of what is kept and its forced part $n_get takes what rounding loses too */
		emit_at_start(e);
	say(e, "    $n_pass(s, %s%s%stau, %s%s);\n", which, u, remainder, full, relative ? "x" : "y");
	if (relative)
		say(e, "    $n_written(s, x, y);\n");
}

static void emit_series_at(const struct emitter *e)
{
	const struct series *series = &e->step->series;
	const struct layout *layout = &e->step->layout;
	const bool changes = loads_change(e->system), blocks = !changes && is_blockwise(e);
	if (adds_sustained(e))
		emit_at_start(e);
	if (!blocks && !changes)
		say(e, "    %sconst pl_series series = {%d, $N_STATES, %d, %d, %s[0]};  "
		       "/* size, states, degree, halvings */\n"
		       "    double work[%d];\n", e->step->branches > 1 ? "" : "static ", layout->size, series->degree,
		    series->halvings, slope_text(e), 2 * layout->size);
	say(e, "    double x[%d];\n", layout->size);
	emit_series_vector(e, !e->model->relative);
	say(e, "    %s;\n", changes ? format("const int segment = %s_pass_changes(s, %s, 0, tau, x)", e->name,
					     slope_text(e))
			    : blocks ? format("%s_pass_blocks(%s, tau, x)", e->name, slope_text(e))
				     : "pl_series_advance(&series, tau, x, work)");
	emit_hand_over(e);
}

/* The point of a step that is p/2 h after its start, as the remainder counts them */
static int point_at(const struct step *step, int p)
{
	RATIONAL part = ZERO;
	int point = 0;
	mpq_set_ui(part, (unsigned)p, 2);
	mpq_canonicalize(part);
	while (!mpq_equal(step->program->node[point], part))
		point++;
	return point;
}

static void emit_remainder_at(const struct emitter *e)
{
	open_function(e, NULL, "static void $n_remainder_at(const $n *s, int which, int point, const double *u, "
		      "const double y[$N_STATES], double remainder[%d])", e->system->force_columns);
	emit_samples(e);
	say(e, "    $n_remainder(s, which, point, %s, y, remainder);\n", samples_of_step(e));
	close_function(e, "u");
}

/* Which operator serves */
static void emit_choice(const struct emitter *e)
{
	open_function(e, NULL, "static int $n_choice(const $n *s, const double *u)");
	emit_samples(e);
	say(e, "    (void)u;\n"
	       "    return %s;\n", selection_call(e));
	close_function(e, "");
}

static void emit_go_on(const struct emitter *e, bool blocks)
{
	open_function(e, NULL, "static void $n_go_on(const $n *s, int which, double tau, double *x)");
	say(e, blocks ? "    $n_pass_blocks(%s, tau, x);\n" : "    (void)$n_pass_changes(s, %s, 0, tau, x);\n",
	    slope_text(e));
	close_function(e, "s which");
}

/* States under the parabola through the remainder at three points */
static void emit_parabola(const struct emitter *e, bool blocks)
{
	const struct layout *layout = &e->step->layout;
	emit_vector_now(e);
	emit_remainder_at(e);
	if (e->step->branches > 1)
		emit_choice(e);
	emit_go_on(e, blocks);
	emit_sizes(e, "parabola.h", { "STATES", e->system->states }, { "SIZE", layout->size },
		   { "INPUTS", given_inputs(e) },
		   { "FORCE_COLUMN", layout->force_column }, { "FORCES", e->system->force_columns },
		   { "MIDDLE", point_at(e->step, 1) }, { "END", point_at(e->step, 2) });
	say_macro(e, "BARE", spell(e, has_peaks(e) ? "$n_one_step" : "$n_step"));
	say_macro(e, "CHOICE(s, u)", e->step->branches > 1 ? spell(e, "$n_choice(s, u)") : "0");
	say_include(e, "parabola.h");
	emit_at_by(e, "state_at");
}

void emit_at(const struct emitter *e)
{
	bool changes = loads_change(e->system);
	if (e->step->layout.powers == PARABOLA) {
		if (!changes)
			emit_series_slopes(e);
		if (!changes)
			emit_passing_algorithm(e);
		emit_parabola(e, !changes && is_blockwise(e));
		return;
	}
	if (!changes && !has_peak_rows(e))
		emit_series_slopes(e);
	if (!changes && is_blockwise(e))
		emit_passing_algorithm(e);
	open_function(e, NULL, "void $n_at(const $n *s, %sdouble tau, double y[$N_STATES])", input_parameter(e));
	emit_if_any(e->prints->held, e);
	if (changes && !adds_sustained(e))
		emit_passing_at(e);
	else
		emit_series_at(e);
	close_function(e, "");
}

/* ---- jump ---- */

/* The second words of Phi: the table has the first */
static void emit_second_words(const struct emitter *e)
{
	int n = e->system->states;
	double *low = ARRAY(double, (size_t)n * (size_t)n);
	for (int i = 0; i < n * n; i++)
		low[i] = e->step->branch->full->Phi[i].low;
	emit_array(e, format("Low parts of the transfer matrix: %s has the high parts",
		   stepped_table(e)), "Phi_low", 2,
		   (const int[]){ n, n }, low, e->model->names.state);
}

/* What the load states add to the one-step matrix, in two words: the columns beyond Phi, in each segment of time */
static void emit_power_entries(const struct emitter *e, int entries, const struct leap_entry *entry)
{
	bool segments = loads_change(e->system);
	if (entries == 0)
		return;
	say(e, "\n"
	       "/* Further columns of the transfer matrix, from %d on: those of the load states */\n"
	       "static const struct { unsigned short %srow, column; pl_two value; } $n_power_entry[] = {\n",
	    e->system->states, segments ? "segment, " : "");
	for (int i = 0; i < entries; i++) {
		const struct leap_entry *cell = &entry[i];
		say(e, "    {%s%d, %d, {%s, %s}},\n", segments ? format("%d, ", cell->segment) : "", cell->row,
		    cell->column, shortest(cell->value.value), shortest(cell->value.low));
	}
	say(e, "};\n");
}

/* What is kept is made of the states, in one word */
static bool converts(const struct emitter *e)
{
	return e->step->linear.kicks.momenta || e->step->modal;
}

/* Of the states that have a low word, in its order; returns how many */
static int emit_carried(const struct emitter *e)
{
	int *state = ARRAY(int, (size_t)e->step->carried.count);
	for (int i = 0; i < e->system->states; i++)
		if (e->step->carried.place[i] >= 0)
			state[e->step->carried.place[i]] = i;
	if (e->step->carried.count)
		emit_int_list(e, "carried", e->step->carried.count, state);
	return e->step->carried.count;
}

/* load[...] = the load states that the step reads */
static void emit_leap_loads(const struct emitter *e, const struct leap *leap)
{
	const int loads = leap->size - e->system->states;
	if (loads == 0)
		return;
	open_function(e, NULL, "static void $n_leap_loads(const $n *s, pl_two load[%d])", loads);
	emit_load_states(e, wanted_loads(e, leap->load), false);
	for (int l = 0; l < e->system->loads; l++)
		for (int k = 0; k < e->system->load[l].columns && leap->load[l] >= 0; k++) {
			const char *value = load_operand(e, l, k);
			const int at = leap->load[l] + k - e->system->states;
			say(e, "    load[%d].hi = %s;\n"
			       "    load[%d].lo = 0.0;\n", at, value ? value : "1.0", at);
		}
	close_function(e, "s");
}

static void emit_pass_steps(const struct emitter *e)
{
	open_function(e, NULL, "static void $n_pass_steps($n *s, uint64_t n)");
	emit_load_advance(e, "n");
	say(e, "    s->k += n;\n");
	if (e->step->refresh)
		say(e, "    $n_refresh_phasors(s);\n");
	close_function(e, "");
}

void emit_jump(const struct emitter *e)
{
	if (e->step->is.tuned) {     /* retune.h has it */
		emit_pass_steps(e);
		return;
	}
	const struct leap leap = leap_of(e->step);
	struct leap_entry *entry;
	const int entries = leap_entries_of(e->step, &leap, &entry);
	const int blocks = is_blockwise(e) ? count_blocks(e) : 1, loads = leap.size - e->system->states;
	emit_second_words(e);
	emit_power_entries(e, entries, entry);
	emit_pass_steps(e);
	emit_leap_loads(e, &leap);
	emit_sizes(e, "jump.h", { "STATES", e->system->states }, { "LOAD_STATES", loads },
		   { "SIZE", (blocks > 1 ? states_of_largest_block(e) : e->system->states) + loads },
		   { "SEGMENTS", e->system->segments }, { "BLOCKS", blocks }, { "CONVERTED", converts(e) },
		   { "COMPENSATED", !converts(e) && e->step->program->compensated },
		   { "CARRIES", converts(e) ? 0 : emit_carried(e) }, { "ENTRIES", entries });
	say(e, "#define PL_PHI %s\n"
	       "#include \"jump.h\"\n", stepped_table(e));
}
