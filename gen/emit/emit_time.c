/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Any time: NAME_at inside a step by a Taylor series, NAME_jump over many steps by powers of the step. */
#include "emit/emit.h"

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
		const char **term = ARRAY(const char *, (size_t)states);
		int terms = 0;
		for (int j = 0; j < states; j++)
			if (!force[i * states + j].zero)
				term[terms++] = scaled(force[i * states + j].value, format("s->y[%d]", j));
		say(e, "    x[%d] = %s;  /* held for %s */\n", e->step->layout.held + i,
		    terms ? tree(terms, term, 12) : "0.0", e->model->coord_name[i]);
	}
}

/* x[...] = the load states, from index[l] on */
static void store_loads(const struct emitter *e, const int *index, const char *member)
{
	for (int l = 0; l < e->system->loads; l++)
		for (int k = 0; k < e->system->load[l].columns && index[l] >= 0; k++) {
			const char *value = load_operand(e, l, k);
			say(e, "    x[%d]%s = %s;\n", index[l] + k, member, value ? value : "1.0");
		}
}

static bool *wanted_loads(const struct emitter *e, const int *index)
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
	const char **term = ARRAY(const char *, (size_t)hold + 1), *power = "";
	mpq_t weight, one;
	mpq_inits(weight, one, NULL);
	mpq_set_ui(one, 1, 1);
	for (int i = 0; i < input; i++)
		before += e->system->input[i].hold + 1;
	for (int m = 0; m <= hold; m++) {
		int terms = 0;
		for (int c = 0; c <= hold; c++) {
			tap_derivative(hold, m, c, one, weight);
			if (mpq_sgn(weight) != 0)
				term[terms++] = scaled(round_rational(weight), input_operand(e, before + c));
		}
		say(e, "    x[%d] = (%s)%s;\n", at + m, tree(terms, term, 13),
		    m > 1 ? format(" / (%s)", power) : m ? format(" / %s", power) : "");
		power = m ? format("%s * %s", power, step_length(e)) : step_length(e);
	}
	mpq_clears(weight, one, NULL);
}

static void store_inputs(const struct emitter *e, const int *index)
{
	for (int i = 0; i < e->system->inputs; i++) {
		bool ramp = e->system->input[i].hold;
		if (e->system->input[i].hold > 1) {
			store_derivatives(e, i, index[i]);
			continue;
		}
		say(e, "    x[%d] = %s[%d];\n", index[i], ramp ? "s->u" : "u", i);
		if (ramp)
			say(e, "    x[%d] = %s;\n", index[i] + 1, ramp_slope(e, i));
	}
}

/* Of a bank: one matrix for each operator */
void emit_series_slopes(const struct emitter *e)
{
	const struct layout *layout = &e->step->layout;
	int size = layout->size;
	bool bank = e->step->branches > 1;
	say(e, "\n"
	       "/* x' = A x; x = y%s%s */\n"
	       "static const double $n_slope%s[%d][%d] = {\n",
	    size > e->system->states ? ", then what acts on it" : "", bank ? "; for each operator" : "",
	    bank ? format("[%d]", e->step->branches) : "", size, size);
	for (int k = 0; k < e->step->branches; k++) {
		say(e, bank ? "  {\n" : "");
		emit_number_rows(e, size, size, slopes_of(e->step, k), series_names(e));
		say(e, bank ? "  },\n" : "");
	}
	say(e, "};\n");
}

static const char *slope_text(const struct emitter *e)
{
	return e->step->branches > 1 ? format("%s_slope[which]", e->name) : format("%s_slope", e->name);
}

/* ---- loads that change their formula: A's columns of the loads, for each segment of time ---- */

/* vector += x[...] of the loads that the step leaves out, each times its place in a table [segment][state][column] */
static void emit_forced_sum(const struct emitter *e, const char *table, const char *vector)
{
	for (int l = 0, column = 0; l < e->system->loads; column += e->system->load[l++].columns)
		if (e->step->forced->load[l])
			say(e, "        for (i = 0; i < $N_STATES; i++)\n"
			       "            for (j = 0; j < %d; j++)\n"
			       "                %s[i] += $n_%s[segment][i][%d + j] * x[%d + j];\n",
			    e->system->load[l].columns, vector, table, column, e->step->layout.load[l]);
}

static void emit_load_slopes(const struct emitter *e, const struct load_slopes *slopes)
{
	int columns = slopes->columns;
	say(e, "\n"
	       "/* The columns of A from %d on, in each segment of time */\n"
	       "static const double $n_load_slope[%d][$N_STATES][%d] = {\n",
	    slopes->first, e->system->segments, columns);
	for (int s = 0; s < e->system->segments; s++) {
		say(e, "  {\n");
		emit_number_rows(e, e->system->states, columns, slopes->segment[s], series_names(e));
		say(e, "  },\n");
	}
	say(e, "};\n"
	       "\n"
	       "static void $n_use_segment(double A[][%d], int segment)\n"
	       "{\n"
	       "    int i, j;\n"
	       "    for (i = 0; i < $N_STATES; i++)\n"
	       "        for (j = 0; j < %d; j++)\n"
	       "            A[i][%d + j] = $n_load_slope[segment][i][j];\n"
	       "}\n",
	    e->step->layout.size, columns, slopes->first);
}

static const char *input_parameter(const struct emitter *e)
{
	return given_inputs(e) ? format("const double u[%s_INPUTS], ", e->upper) : "";
}

static void emit_leftover_now(const struct emitter *e)
{
	if (e->step->layout.powers)
		say(e, "    %s\n", leftover_of_step(e));
}

void emit_series_vector(const struct emitter *e)
{
	const struct layout *layout = &e->step->layout;
	emit_load_states(e, wanted_loads(e, layout->load), false);
	say(e, "    int i;\n");
	if (e->system->segments == 1)
		emit_leftover_now(e);
	if (e->step->forced && e->system->segments > 1)
		emit_get_kept_state(e, "x");
	else
		emit_get_state(e, "x");
	emit_held(e);
	store_loads(e, layout->load, "");
	store_inputs(e, layout->input);
	if (layout->powers)
		say(e, "    for (i = 0; i < %d; i++)\n"
		       "        x[%d + i] = %s;\n",
		    e->system->channels, layout->channel, e->system->segments > 1 ? "left ? left[i] : 0.0" : "left[i]");
}

static void emit_pass_head(const struct emitter *e)
{
	const struct series *series = &e->step->series;
	const struct layout *layout = &e->step->layout;
	int size = layout->size;
	say(e, "\n"
	       "/* The state tau after now, from change to change of the loads on the way. */\n"
	       "static %s $n_pass(const $n *s, %s%s%sdouble tau, %sdouble y[$N_STATES])\n"
	       "{\n"
	       "    double A[%d][%d], done = 0.0, x[%d], work[%d];\n"
	       "    int j, segment = s->segment;\n"
	       "    pl_series series;\n",
	    e->step->forced ? "int" : "void", e->step->branches > 1 ? "int which, " : "", input_parameter(e),
	    layout->powers ? "const double *left, " : "", e->step->forced ? "int whole, " : "",
	    size, size, size, 2 * size);
	emit_series_vector(e);
	say(e, "    for (i = 0; i < %d; i++)\n"
	       "        for (j = 0; j < %d; j++)\n"
	       "            A[i][j] = %s[i][j];\n"
	       "    series.size = %d;\n"
	       "    series.states = $N_STATES;\n"
	       "    series.degree = %d;\n"
	       "    series.halvings = %d;\n"
	       "    series.A = A[0];\n",
	    size, size, slope_text(e), size, series->degree, series->halvings);
}

static void emit_pass_end(const struct emitter *e)
{
	say(e, "    pl_series_advance(&series, tau - done, x, work);\n"
	       "    for (i = 0; i < $N_STATES; i++)\n"
	       "        y[i] = x[i];\n");
	if (e->step->forced) {
		say(e, "    if (whole) {\n");
		emit_forced_sum(e, "forced_part", "y");
		say(e, "    }\n"
		       "    return segment;\n");
	}
	say(e, "}\n");
}

/* y at tau after now, from change to change */
static void emit_pass(const struct emitter *e)
{
	struct load_slopes slopes = load_slopes_of(e->step);
	bool acts = slopes.first >= 0;
	if (acts)
		emit_load_slopes(e, &slopes);
	emit_pass_head(e);
	say(e, "    for (; segment < %d && $n_until(s, segment) < tau; segment++) {\n"
	       "        const double ahead = $n_until(s, segment);\n",
	    e->system->segments - 1);
	if (acts)
		say(e, "        $n_use_segment(A, segment);\n");
	say(e, "        if (ahead > done) {\n"
	       "            pl_series_advance(&series, ahead - done, x, work);\n"
	       "            done = ahead;\n"
	       "        }\n");
	if (e->step->forced && e->step->forced->changes)
		emit_forced_sum(e, "forced_change", "x");
	say(e, "    }\n");
	if (acts)
		say(e, "    $n_use_segment(A, segment);\n");
	emit_pass_end(e);
}

void emit_changes(const struct emitter *e)
{
	say(e, "\n"
	       "static const pl_two $n_change[%d] = {  /* [s]: where loads change their formula */\n",
	    e->system->segments - 1);
	for (int i = 0; i < e->system->segments - 1; i++) {
		finite_number(e, e->system->change[i]);
		say(e, "    %s,\n", two_text(e->system->change[i]));
	}
	say(e, "};\n"
	       "\n"
	       "/* Time from now to a change */\n"
	       "static double $n_until(const $n *s, int change)\n"
	       "{\n");
	if (e->kind->own_factors)
		say(e, "    pl_two h;\n"
		       "    h.hi = s->coeffs.h;\n"
		       "    h.lo = s->coeffs.h_low;\n");
	else
		say(e, "    static const pl_two h = %s;\n", two_text(e->model->h));
	say(e, "    return pl_until(s->t0, s->k, h, $n_change[change]);\n"
	       "}\n");
}

void emit_passing(const struct emitter *e)
{
	emit_series_slopes(e);
	emit_pass(e);
}

void emit_held_leftover(const struct emitter *e)
{
	emit_samples(e);
	if (e->step->branches > 1)
		say(e, "    const int which = %s;\n", selection_call(e));
	say(e, "    double left[%d];\n", e->system->channels);
}

/* y, for the user, from the head of x */
void emit_hand_over(const struct emitter *e)
{
	if (e->model->relative)
		say(e, "    $n_written(s, x, y);\n");
	else
		say(e, "    for (i = 0; i < $N_STATES; i++)\n"
		       "        y[i] = x[i];\n");
}

/* At the start of the step the state is what $n_get gives, to the last bit. */
void emit_at_start(const struct emitter *e)
{
	say(e, "    if (!(tau > 0.0)) {\n"
	       "        $n_get(s, y);\n"
	       "        return;\n"
	       "    }\n");
}

/* Where the loads change their formula on the way */
static void emit_passing_at(const struct emitter *e)
{
	const char *which = e->step->branches > 1 ? "which, " : "", *u = given_inputs(e) ? "u, " : "";
	const char *left = e->step->layout.powers ? "left, " : "", *whole = e->step->forced ? "1, " : "";
	bool relative = e->model->relative != NULL;
	emit_leftover_now(e);
	if (relative)
		say(e, "    double x[$N_STATES];\n");
	if (e->step->forced)            /* of what is kept and its forced part $n_get takes what rounding loses too */
		emit_at_start(e);
	say(e, "    $n_pass(s, %s%s%stau, %s%s);\n", which, u, left, whole, relative ? "x" : "y");
	if (relative)
		say(e, "    $n_written(s, x, y);\n");
}

static void emit_series_at(const struct emitter *e)
{
	if (is_blockwise(e)) {
		declare_blockwise_at(e);
		emit_series_vector(e);
		emit_blockwise_at(e);
		emit_hand_over(e);
		return;
	}
	const struct series *series = &e->step->series;
	const struct layout *layout = &e->step->layout;
	say(e, "    %sconst pl_series series = {%d, $N_STATES, %d, %d, %s[0]};  /* size, states, degree, halvings */\n"
	       "    double x[%d], work[%d];\n",
	    e->step->branches > 1 ? "" : "static ", layout->size, series->degree, series->halvings, slope_text(e),
	    layout->size, 2 * layout->size);
	emit_series_vector(e);
	say(e, "    pl_series_advance(&series, tau, x, work);\n");
	emit_hand_over(e);
}

void emit_at(const struct emitter *e)
{
	bool changes = e->system->segments > 1;
	if (!changes && !has_peaks(e))
		emit_series_slopes(e);
	say(e, "\n"
	       "void $n_at(const $n *s, %sdouble tau, double y[$N_STATES])\n"
	       "{\n",
	    input_parameter(e));
	e->kind->held(e);
	if (changes)
		emit_passing_at(e);
	else
		emit_series_at(e);
	say(e, "}\n");
}

/* ---- jump ---- */

/* The second words of Phi: the table has the first */
static void emit_second_words(const struct emitter *e)
{
	int n = e->system->states;
	double *low = ARRAY(double, (size_t)n * (size_t)n);
	for (int i = 0; i < n * n; i++)
		low[i] = e->step->branch->whole->Phi[i].low;
	say(e, "\n"
	       "/* %s + $n_Phi_low is the transfer matrix in two words */\n"
	       "static const double $n_Phi_low[$N_STATES][$N_STATES] = {\n",
	    stepped_table(e, "Phi"));
	emit_number_rows(e, n, n, low, e->model->state_name);
	say(e, "};\n");
}

/* What the load states add to the one-step matrix, in two words: the columns beyond Phi, in each segment of time */
static void emit_power_entries(const struct emitter *e, int entries, const struct leap_entry *entry)
{
	bool segments = e->system->segments > 1;
	if (entries == 0)
		return;
	say(e, "\n"
	       "/* ... and what the load states add, from column %d on */\n"
	       "static const struct {%s int row, column; pl_two value; } $n_power_entry[] = {\n",
	    e->system->states, segments ? " int segment;" : "");
	for (int i = 0; i < entries; i++) {
		const struct leap_entry *cell = &entry[i];
		say(e, "    {%s%d, %d, {%s, %s}},\n", segments ? format("%d, ", cell->segment) : "", cell->row,
		    cell->column, shortest(cell->value.value), shortest(cell->value.low));
	}
	say(e, "};\n");
}

static void emit_fill_power(const struct emitter *e, int size, int entries)
{
	say(e, "    for (i = 0; i < %d; i++) {\n"
	       "        power[i].hi = 0.0;\n"
	       "        power[i].lo = 0.0;\n"
	       "    }\n"
	       "    for (i = 0; i < $N_STATES; i++)\n"
	       "        for (j = 0; j < $N_STATES; j++) {\n"
	       "            power[%d * i + j].hi = %s[i][j];\n"
	       "            power[%d * i + j].lo = $n_Phi_low[i][j];\n"
	       "        }\n",
	    size * size, size, stepped_table(e, "Phi"), size);
	if (entries == 0)
		return;
	say(e, "    for (i = 0; i < %d; i++)\n", entries);
	if (e->system->segments > 1)
		say(e, "        if ($n_power_entry[i].segment == s->segment)\n    ");
	say(e, "        power[%d * $n_power_entry[i].row + $n_power_entry[i].column] = $n_power_entry[i].value;\n",
	    size);
}

/* y in one word, without masses */
static void emit_leap_from_velocities(const struct emitter *e)
{
	if (e->step->forced)
		emit_get_kept_state(e, "y");
	else if (e->model->relative)
		emit_get_state(e, "y");
	else
		say(e, "    $n_get(s, y);\n");
	say(e, "    for (i = 0; i < $N_STATES; i++)\n"
	       "        x[i].hi = y[i];\n");
}

static void emit_leap_start(const struct emitter *e)
{
	if (e->step->momenta || e->step->modal) {
		emit_leap_from_velocities(e);
		return;
	}
	bool rest = e->step->program->compensated;
	say(e, "    for (i = 0; i < $N_STATES; i++)%s\n"
	       "        x[i].hi = s->y[i];\n",
	    rest ? " {" : "");
	if (rest)
		say(e, "        x[i].lo = s->rest[i];\n"
		       "    }\n");
	for (int i = 0; i < e->system->states; i++)
		if (e->step->carry[i] >= 0)
			say(e, "    x[%d].lo = s->carry[%d];\n", i, e->step->carry[i]);
}

static void emit_leap_end(const struct emitter *e)
{
	if (e->step->momenta || e->step->modal) {
		say(e, "    for (i = 0; i < $N_STATES; i++)\n"
		       "        y[i] = x[i].hi;\n");
		emit_set_state(e, "y", "    ");
		return;
	}
	bool rest = e->step->program->compensated;
	say(e, "    for (i = 0; i < $N_STATES; i++)%s\n"
	       "        s->y[i] = x[i].hi;\n",
	    rest ? " {" : "");
	if (rest)
		say(e, "        s->rest[i] = x[i].lo;\n"
		       "    }\n");
	for (int i = 0; i < e->system->states; i++)
		if (e->step->carry[i] >= 0)
			say(e, "    s->carry[%d] = x[%d].lo;\n", e->step->carry[i], i);
}

/* load[...] = the load states that the step reads, behind the states */
static void emit_leap_loads(const struct emitter *e, const struct leap *leap, const char *vector)
{
	emit_load_states(e, wanted_loads(e, leap->load), false);
	for (int l = 0; l < e->system->loads; l++)
		for (int k = 0; k < e->system->load[l].columns && leap->load[l] >= 0; k++) {
			const char *value = load_operand(e, l, k);
			const int at = leap->load[l] + k - e->system->states;
			say(e, "    %s[%d].hi = %s;\n"
			       "    %s[%d].lo = 0.0;\n", vector, at, value ? value : "1.0", vector, at);
		}
}

static void emit_leap_end_of_all(const struct emitter *e)
{
	emit_load_advance(e, "n");
	say(e, "    s->k += n;\n");
	if (e->step->anchors)
		say(e, "    $n_drop_anchor(s);\n");
	say(e, "}\n");
}

/* n steps without a change of the loads: by powers of the one-step matrix */
static void emit_leap(const struct emitter *e, const char *declaration)
{
	struct leap leap = leap_of(e->step);
	struct leap_entry *entry;
	int size = leap.size, entries = leap_entries_of(e->step, &leap, &entry);
	emit_power_entries(e, entries, entry);
	say(e, "\n"
	       "%s($n *s, uint64_t n)\n"
	       "{\n", declaration);
	if (is_blockwise(e)) {
		declare_blockwise_leap(e, &leap);
		emit_leap_loads(e, &leap, "load");
		emit_blockwise_leap(e, &leap, entries);
		emit_leap_end_of_all(e);
		return;
	}
	say(e, "    pl_two power[%d], work[%d], x[%d], w[%d];\n", size * size, size * size, size, size);
	if (e->step->momenta || e->step->modal)
		say(e, "    double y[$N_STATES];\n");
	emit_load_states(e, wanted_loads(e, leap.load), false);
	say(e, "    int i, j;\n");
	emit_fill_power(e, size, entries);
	say(e, "    for (i = 0; i < %d; i++)\n"
	       "        x[i].lo = 0.0;\n",
	    size);
	emit_leap_start(e);
	store_loads(e, leap.load, ".hi");
	say(e, "    pl_power_apply(%d, power, work, x, w, n);\n", size);
	emit_leap_end(e);
	emit_leap_end_of_all(e);
}

void emit_jump(const struct emitter *e)
{
	int changes = e->system->segments - 1;
	emit_second_words(e);
	if (changes == 0) {
		emit_leap(e, format("void %s_jump", e->name));
		return;
	}
	emit_leap(e, format("static void %s_leap", e->name));
	say(e, "\n"
	       "/* Leaps up to one step before each change of the loads, and steps across it. */\n"
	       "void $n_jump($n *s, uint64_t n)\n"
	       "{\n"
	       "    while (n > 0 && s->segment < %d) {\n"
	       "        const double ahead = $n_until(s, s->segment) / $N_H - 1.0;\n"
	       "        const uint64_t free = ahead < 1.0 ? 0 : ahead < (double)n ? (uint64_t)ahead : n;\n"
	       "        if (free > 0) {\n"
	       "            $n_leap(s, free);\n"
	       "            n -= free;\n"
	       "        } else {\n"
	       "            $n_step(s);\n"
	       "            n--;\n"
	       "        }\n"
	       "    }\n"
	       "    if (n > 0)\n"
	       "        $n_leap(s, n);\n"
	       "}\n",
	    changes);
}
