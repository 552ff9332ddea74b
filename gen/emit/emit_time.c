/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Any time: NAME_at inside a step by a Taylor series, NAME_jump over many steps by powers of the step. */
#include "emit/emit.h"

/* ---- at ---- */

/* Names of the entries of the series' vector; `slopes`: of the states' rows. */
static const char **series_names(const struct emitter *e)
{
	const struct series *series = &e->step->series;
	const char **name = ARRAY(const char *, (size_t)series->size);
	for (int i = 0; i < e->system->states; i++)
		name[i] = format("%s'", e->model->state_name[i]);
	for (int i = 0; i < e->model->n && series->held >= 0; i++)
		name[series->held + i] = format("held for %s", e->model->coord_name[i]);
	for (int l = 0; l < e->system->loads; l++)
		for (int k = 0; k < e->system->load[l].columns && series->load[l] >= 0; k++)
			name[series->load[l] + k] = column_text(&e->system->load[l], k);
	for (int i = 0; i < e->system->inputs; i++) {
		name[series->input[i]] = e->system->input[i].name;
		if (e->system->input[i].first_order)
			name[series->input[i] + 1] = format("%s'", e->system->input[i].name);
	}
	for (int c = 0; c < e->system->channels * series->powers; c++)
		name[series->channel + c] = format("leftover %d", c + 1);
	return name;
}

static void emit_held(const struct emitter *e)
{
	const struct series *series = &e->step->series;
	int n = e->model->n;
	for (int i = 0; i < n && series->held >= 0; i++) {
		const char **term = ARRAY(const char *, (size_t)e->system->states);
		int terms = 0;
		for (int j = 0; j < e->system->states; j++) {
			const mpq_t *held = j < n ? e->system->heldK : e->system->heldC;
			int cell = i * n + e->system->coord[j];
			if (mpq_sgn(held[cell]) != 0)
				term[terms++] = scaled(-finite_number(e, held[cell]), format("s->y[%d]", j));
		}
		fprintf(e->to, "    x[%d] = %s;  /* held for %s */\n", series->held + i, terms ? tree(terms, term, 12) : "0.0", e->model->coord_name[i]);
	}
}

/* x[...] = the load states, from index[l] on */
static void store_loads(const struct emitter *e, const int *index, const char *member)
{
	for (int l = 0; l < e->system->loads; l++)
		for (int k = 0; k < e->system->load[l].columns && index[l] >= 0; k++) {
			const char *value = load_operand(e, l, k);
			fprintf(e->to, "    x[%d]%s = %s;\n", index[l] + k, member, value ? value : "1.0");
		}
}

static bool *wanted_loads(const struct emitter *e, const int *index)
{
	bool *wanted = ARRAY(bool, (size_t)e->system->loads);
	for (int l = 0; l < e->system->loads; l++)
		wanted[l] = index[l] >= 0;
	return wanted;
}

static void store_inputs(const struct emitter *e, const int *index)
{
	for (int i = 0; i < e->system->inputs; i++) {
		bool ramp = e->system->input[i].first_order;
		fprintf(e->to, ramp ? "    x[%d] = s->u[%d];\n" : "    x[%d] = u[%d];\n", index[i], i);
		if (ramp)
			fprintf(e->to, "    x[%d] = (u[%d] - s->u[%d]) / %s;\n", index[i] + 1, i, i, step_length(e));
	}
}

/* Of a bank: one matrix for each operator */
static void emit_slopes(const struct emitter *e)
{
	const struct series *series = &e->step->series;
	size_t cells = (size_t)series->size * (size_t)series->size;
	double *A = ARRAY(double, cells);
	bool bank = e->step->branches > 1;
	fprintf(e->to, "\n/* x' = A x; x = y%s%s */\nstatic const double %s_slope%s[%d][%d] = {\n",
		series->size > e->system->states ? ", then what acts on it" : "", bank ? "; for each operator" : "", e->name,
		bank ? format("[%d]", e->step->branches) : "", series->size, series->size);
	for (int o = 0; o < e->step->branches; o++) {
		mpq_t *exact = series_matrix(series, &e->step->branch[o].system, 0);
		for (size_t i = 0; i < cells; i++)
			A[i] = round_rational(exact[i]);
		fputs(bank ? "  {\n" : "", e->to);
		emit_number_rows(e, series->size, series->size, A, series_names(e));
		fputs(bank ? "  },\n" : "", e->to);
	}
	fputs("};\n", e->to);
}

static const char *slope_text(const struct emitter *e)
{
	return e->step->branches > 1 ? format("%s_slope[which]", e->name) : format("%s_slope", e->name);
}

/* ---- loads that change their formula: A's columns of the loads, for each segment of time ---- */

static int first_load_state(const struct emitter *e, int *columns)
{
	int first = -1;
	*columns = 0;
	for (int l = 0; l < e->system->loads; l++) {
		int at = e->step->series.load[l];
		if (at < 0)
			continue;
		first = first < 0 ? at : first;
		*columns += e->system->load[l].columns;
	}
	return first;
}

/* Does this entry of x belong to a load that the step leaves out? */
static bool forced_entry(const struct emitter *e, int entry)
{
	for (int l = 0; l < e->system->loads; l++)
		if (e->step->forced && e->step->forced->load[l] && entry >= e->step->series.load[l] && entry < e->step->series.load[l] + e->system->load[l].columns)
			return true;
	return false;
}

/* x[...] of the loads that the step leaves out, each times its place in a table of factors[...][state][column]: into `vector` */
static void emit_forced_sum(const struct emitter *e, const char *table, const char *vector, const char *indent)
{
	for (int l = 0, column = 0; l < e->system->loads; column += e->system->load[l++].columns)
		if (e->step->forced->load[l])
			fprintf(e->to, "%sfor (i = 0; i < %s_STATES; i++)\n%s    for (j = 0; j < %d; j++)\n%s        %s[i] += %s_%s[segment][i][%d + j] * x[%d + j];\n",
				indent, e->upper, indent, e->system->load[l].columns, indent, vector, e->name, table, column, e->step->series.load[l]);
}

static void emit_segment_slopes(const struct emitter *e, int first, int columns)
{
	const struct series *series = &e->step->series;
	int states = e->system->states;
	fprintf(e->to, "\n/* The columns of A from %d on, in each segment of time */\nstatic const double %s_load_slope[%d][%s_STATES][%d] = {\n", first,
		e->name, e->system->segments, e->upper, columns);
	for (int s = 0; s < e->system->segments; s++) {
		mpq_t *exact = series_matrix(series, e->system, s);
		fputs("  {\n", e->to);
		double *value = ARRAY(double, (size_t)(states * columns));
		for (int i = 0; i < states; i++)
			for (int j = 0; j < columns; j++)
				value[i * columns + j] = forced_entry(e, first + j) ? 0 : round_rational(exact[i * series->size + first + j]);
		emit_number_rows(e, states, columns, value, series_names(e));
		fputs("  },\n", e->to);
	}
	fputs("};\n", e->to);
}

static void emit_use_segment(const struct emitter *e, int first, int columns)
{
	fprintf(e->to, "\nstatic void %s_use_segment(double A[][%d], int segment)\n{\n    int i, j;\n", e->name, e->step->series.size);
	fprintf(e->to, "    for (i = 0; i < %s_STATES; i++)\n        for (j = 0; j < %d; j++)\n            A[i][%d + j] = %s_load_slope[segment][i][j];\n}\n",
		e->upper, columns, first, e->name);
}

static const char *input_parameter(const struct emitter *e)
{
	return e->system->inputs ? format("const double u[%s_INPUTS], ", e->upper) : "";
}

static void emit_leftover_now(const struct emitter *e)
{
	if (e->step->series.powers)
		fprintf(e->to, "    %s\n", leftover_of_step(e));
}

void emit_series_vector(const struct emitter *e)
{
	const struct series *series = &e->step->series;
	emit_load_states(e, wanted_loads(e, series->load), false);
	fprintf(e->to, "    int i;\n");
	if (e->system->segments == 1)
		emit_leftover_now(e);
	if (e->step->forced && e->system->segments > 1)
		emit_kept_state(e, "x");
	else
		emit_load_state(e, "x");
	emit_held(e);
	store_loads(e, series->load, "");
	store_inputs(e, series->input);
	if (series->powers)
		fprintf(e->to, "    for (i = 0; i < %d; i++)\n        x[%d + i] = %s;\n", e->system->channels, series->channel,
			e->system->segments > 1 ? "left ? left[i] : 0.0" : "left[i]");
}

/* y at tau after now, from change to change */
static void emit_pass(const struct emitter *e)
{
	const struct series *series = &e->step->series;
	FILE *to = e->to;
	int columns, first = first_load_state(e, &columns), size = series->size;
	if (first >= 0) {
		emit_segment_slopes(e, first, columns);
		emit_use_segment(e, first, columns);
	}
	fprintf(to, "\n/* The state tau after now, from change to change of the loads on the way. */\n");
	fprintf(to, "static %s %s_pass(const %s *s, %s%s%sdouble tau, %sdouble y[%s_STATES])\n{\n", e->step->forced ? "int" : "void", e->name, e->name,
		e->step->branches > 1 ? "int which, " : "", input_parameter(e), series->powers ? "const double *left, " : "", e->step->forced ? "int whole, " : "", e->upper);
	fprintf(to, "    double A[%d][%d], done = 0.0, x[%d], work[%d];\n    int j, segment = s->segment;\n    pl_series series;\n", size, size, size, 2 * size);
	emit_series_vector(e);
	fprintf(to, "    for (i = 0; i < %d; i++)\n        for (j = 0; j < %d; j++)\n            A[i][j] = %s[i][j];\n", size, size, slope_text(e));
	fprintf(to, "    series.size = %d;\n    series.states = %s_STATES;\n    series.degree = %d;\n    series.halvings = %d;\n    series.A = A[0];\n", size,
		e->upper, series->degree, series->halvings);
	fprintf(to, "    for (; segment < %d && %s_until(s, segment) < tau; segment++) {\n        const double ahead = %s_until(s, segment);\n",
		e->system->segments - 1, e->name, e->name);
	if (first >= 0)
		fprintf(to, "        %s_use_segment(A, segment);\n", e->name);
	fputs("        if (ahead > done) {\n            pl_series_advance(&series, ahead - done, x, work);\n            done = ahead;\n        }\n", to);
	if (e->step->forced && e->step->forced->changes)
		emit_forced_sum(e, "forced_change", "x", "        ");
	fputs("    }\n", to);
	if (first >= 0)
		fprintf(to, "    %s_use_segment(A, segment);\n", e->name);
	fprintf(to, "    pl_series_advance(&series, tau - done, x, work);\n    for (i = 0; i < %s_STATES; i++)\n        y[i] = x[i];\n", e->upper);
	if (e->step->forced) {
		fputs("    if (whole) {\n", to);
		emit_forced_sum(e, "forced_part", "y", "        ");
		fputs("    }\n    return segment;\n", to);
	}
	fputs("}\n", to);
}

void emit_changes(const struct emitter *e)
{
	FILE *to = e->to;
	const char *n = e->name;
	fprintf(to, "\nstatic const pl_two %s_change[%d] = {  /* [s]: where loads change their formula */\n", n, e->system->segments - 1);
	for (int i = 0; i < e->system->segments - 1; i++) {
		finite_number(e, e->system->change[i]);
		fprintf(to, "    %s,\n", two_text(e->system->change[i]));
	}
	fprintf(to, "};\n\n/* Time from now to a change */\nstatic double %s_until(const %s *s, int change)\n{\n", n, n);
	if (e->model->tuning)
		fputs("    pl_two h;\n    h.hi = s->coeffs.h;\n    h.lo = s->coeffs.h_low;\n", to);
	else
		fprintf(to, "    static const pl_two h = %s;\n", two_text(e->model->h));
	fprintf(to, "    return pl_until(s->t0, s->k, h, %s_change[change]);\n}\n", n);
}

void emit_passing(const struct emitter *e)
{
	emit_slopes(e);
	emit_pass(e);
}

/* What is held over the step: which operator, and what is left over now */
static void emit_held_leftover(const struct emitter *e)
{
	if (!has_leftover(e->step))
		return;
	emit_samples(e);
	if (e->step->branches > 1)
		fprintf(e->to, "    const int which = %s;\n", selection_call(e));
	fprintf(e->to, "    double left[%d];\n", e->system->channels);
}

/* y, for the user, from the head of x */
void emit_hand_over(const struct emitter *e)
{
	if (e->model->relative)
		fprintf(e->to, "    %s_written(s, x, y);\n", e->name);
	else
		fprintf(e->to, "    for (i = 0; i < %s_STATES; i++)\n        y[i] = x[i];\n", e->upper);
}

void emit_at(const struct emitter *e)
{
	const struct series *series = &e->step->series;
	FILE *to = e->to;
	bool changes = e->system->segments > 1;
	if (!changes)
		emit_slopes(e);
	fprintf(to, "\nvoid %s_at(const %s *s, %sdouble tau, double y[%s_STATES])\n{\n", e->name, e->name, input_parameter(e), e->upper);
	emit_held_leftover(e);
	if (changes) {
		emit_leftover_now(e);
		if (e->model->relative)
			fprintf(to, "    double x[%s_STATES];\n", e->upper);
		fprintf(to, "    %s_pass(s, %s%s%stau, %s%s);\n", e->name, e->step->branches > 1 ? "which, " : "", e->system->inputs ? "u, " : "",
			series->powers ? "left, " : "", e->step->forced ? "1, " : "", e->model->relative ? "x" : "y");
		if (e->model->relative)
			fprintf(to, "    %s_written(s, x, y);\n", e->name);
		fputs("}\n", to);
		return;
	}
	fprintf(to, "    %sconst pl_series series = {%d, %s_STATES, %d, %d, %s[0]};  /* size, states, degree, halvings */\n",
		e->step->branches > 1 ? "" : "static ", series->size, e->upper, series->degree, series->halvings, slope_text(e));
	fprintf(to, "    double x[%d], work[%d];\n", series->size, 2 * series->size);
	emit_series_vector(e);
	fputs("    pl_series_advance(&series, tau, x, work);\n", to);
	emit_hand_over(e);
	fputs("}\n", to);
}

/* ---- jump ---- */

struct power {                      /* the one-step matrix of y, then of the load states */
	int size;
	int *load;                  /* index of the first entry of each load; -1: no effect */
	struct coefficient *cell;
};

static void place_load_states(const struct emitter *e, struct power *p)
{
	p->size = e->system->states;
	p->load = ARRAY(int, (size_t)e->system->loads);
	for (int l = 0, column = 0; l < e->system->loads; column += e->system->load[l++].columns) {
		bool used = false;
		for (int k = 0; k < e->system->load[l].columns; k++)
			used = used || e->step->program->uses[column + k];
		p->load[l] = used ? p->size : -1;
		p->size += used ? e->system->load[l].columns : 0;
	}
}

static struct power power_matrix(const struct emitter *e, int segment)
{
	const struct table *table = e->step->branch->whole;
	const struct model *model = e->model;
	int n = table->states;
	struct power p;
	place_load_states(e, &p);
	p.cell = ARRAY(struct coefficient, (size_t)p.size * (size_t)p.size);
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++)
			p.cell[i * p.size + j] = table->Phi[i * n + j];
	for (int l = 0, column = 0; l < e->system->loads; column += e->system->load[l++].columns) {
		const struct load *load = &e->system->load[l];
		for (int k = 0; k < load->columns && p.load[l] >= 0; k++) {
			for (int i = 0; i < n; i++)
				p.cell[i * p.size + p.load[l] + k] = table->load[(segment * n + i) * table->columns + column + k];
			for (int from = 0; from < load->columns; from++)
				p.cell[(p.load[l] + k) * p.size + p.load[l] + from] =
					response_value(response_of_load_state(load, k, from), model->h, true, model->asked.step_at, column_text(load, k));
		}
	}
	return p;
}

/* The second words of Phi: the table has the first */
static void emit_second_words(const struct emitter *e)
{
	int n = e->system->states;
	double *low = ARRAY(double, (size_t)n * (size_t)n);
	for (int i = 0; i < n * n; i++)
		low[i] = e->step->branch->whole->Phi[i].low;
	fprintf(e->to, "\n/* %s + %s_Phi_low is the transfer matrix in two words */\n", stepped_table(e, "Phi"), e->name);
	fprintf(e->to, "static const double %s_Phi_low[%s_STATES][%s_STATES] = {\n", e->name, e->upper, e->upper);
	emit_number_rows(e, n, n, low, e->model->state_name);
	fputs("};\n", e->to);
}

/* What the load states add to the one-step matrix, in two words: the columns beyond Phi, in each segment of time */
static int emit_power_entries(const struct emitter *e)
{
	int entries = 0, states = e->system->states;
	for (int segment = 0; segment < e->system->segments; segment++) {
		struct power p = power_matrix(e, segment);
		for (int i = 0; i < p.size; i++)
			for (int j = states; j < p.size; j++) {
				const struct coefficient *c = &p.cell[i * p.size + j];
				if (c->value == 0 && c->low == 0)
					continue;
				if (entries++ == 0)
					fprintf(e->to, "\n/* ... and what the load states add, from column %d on */\nstatic const struct {%s int row, column; "
						       "pl_two value; } %s_power_entry[] = {\n", states, e->system->segments > 1 ? " int segment;" : "", e->name);
				fputs("    {", e->to);
				if (e->system->segments > 1)
					fprintf(e->to, "%d, ", segment);
				fprintf(e->to, "%d, %d, {%s, %s}},\n", i, j, shortest(c->value), shortest(c->low));
			}
	}
	if (entries)
		fputs("};\n", e->to);
	return entries;
}

static void emit_fill_power(const struct emitter *e, int size, int entries)
{
	const char *n = e->name, *N = e->upper;
	fprintf(e->to, "    for (i = 0; i < %d; i++)\n        power[i].hi = power[i].lo = 0.0;\n", size * size);
	fprintf(e->to, "    for (i = 0; i < %s_STATES; i++)\n        for (j = 0; j < %s_STATES; j++) {\n", N, N);
	fprintf(e->to, "            power[%d * i + j].hi = %s[i][j];\n            power[%d * i + j].lo = %s_Phi_low[i][j];\n        }\n", size, stepped_table(e, "Phi"), size, n);
	if (entries && e->system->segments > 1)
		fprintf(e->to, "    for (i = 0; i < %d; i++)\n        if (%s_power_entry[i].segment == s->segment)\n"
			       "            power[%d * %s_power_entry[i].row + %s_power_entry[i].column] = %s_power_entry[i].value;\n", entries, n, size, n, n, n);
	else if (entries)
		fprintf(e->to, "    for (i = 0; i < %d; i++)\n        power[%d * %s_power_entry[i].row + %s_power_entry[i].column] = %s_power_entry[i].value;\n",
			entries, size, n, n, n);
}

static void emit_leap_start(const struct emitter *e)
{
	if (e->step->momenta) {
		if (e->step->forced)
			emit_kept_state(e, "y");
		else if (e->model->relative)
			emit_load_state(e, "y");
		else
			fprintf(e->to, "    %s_get(s, y);\n", e->name);
		fprintf(e->to, "    for (i = 0; i < %s_STATES; i++)\n        x[i].hi = y[i];\n", e->upper);
		return;
	}
	bool rest = e->step->program->compensated;
	fprintf(e->to, "    for (i = 0; i < %s_STATES; i++)%s\n        x[i].hi = s->y[i];\n", e->upper, rest ? " {" : "");
	if (rest)
		fputs("        x[i].lo = s->rest[i];\n    }\n", e->to);
	for (int i = 0; i < e->system->states; i++)
		if (e->step->carry[i] >= 0)
			fprintf(e->to, "    x[%d].lo = s->carry[%d];\n", i, e->step->carry[i]);
}

static void emit_leap_end(const struct emitter *e)
{
	if (e->step->momenta) {
		fprintf(e->to, "    for (i = 0; i < %s_STATES; i++)\n        y[i] = x[i].hi;\n", e->upper);
		emit_store(e, "y", "    ");
		return;
	}
	bool rest = e->step->program->compensated;
	fprintf(e->to, "    for (i = 0; i < %s_STATES; i++)%s\n        s->y[i] = x[i].hi;\n", e->upper, rest ? " {" : "");
	if (rest)
		fputs("        s->rest[i] = x[i].lo;\n    }\n", e->to);
	for (int i = 0; i < e->system->states; i++)
		if (e->step->carry[i] >= 0)
			fprintf(e->to, "    s->carry[%d] = x[%d].lo;\n", e->step->carry[i], i);
}

/* n steps without a change of the loads: by powers of the one-step matrix */
static void emit_leap(const struct emitter *e, const char *declaration)
{
	FILE *to = e->to;
	struct power p;
	place_load_states(e, &p);
	int size = p.size, entries = emit_power_entries(e);
	fprintf(to, "\n%s(%s *s, uint64_t n)\n{\n", declaration, e->name);
	fprintf(to, "    pl_two power[%d], work[%d], x[%d], w[%d];\n", size * size, size * size, size, size);
	if (e->step->momenta)
		fprintf(to, "    double y[%s_STATES];\n", e->upper);
	emit_load_states(e, wanted_loads(e, p.load), false);
	fputs("    int i, j;\n", to);
	emit_fill_power(e, size, entries);
	fprintf(to, "    for (i = 0; i < %d; i++)\n        x[i].lo = 0.0;\n", size);
	emit_leap_start(e);
	store_loads(e, p.load, ".hi");
	fprintf(to, "    pl_power_apply(%d, power, work, x, w, n);\n", size);
	emit_leap_end(e);
	emit_load_advance(e, "n");
	fputs("    s->k += n;\n}\n", to);
}

void emit_jump(const struct emitter *e)
{
	const char *n = e->name;
	int changes = e->system->segments - 1;
	emit_second_words(e);
	if (changes == 0) {
		emit_leap(e, format("void %s_jump", n));
		return;
	}
	emit_leap(e, format("static void %s_leap", n));
	fprintf(e->to, "\n/* Leaps up to one step before each change of the loads, and steps across it. */\nvoid %s_jump(%s *s, uint64_t n)\n{\n", n, n);
	fprintf(e->to, "    while (n > 0 && s->segment < %d) {\n", changes);
	fprintf(e->to, "        const double ahead = %s_until(s, s->segment) / %s_H - 1.0;\n", n, e->upper);
	fprintf(e->to, "        const uint64_t free = ahead < 1.0 ? 0 : ahead < (double)n ? (uint64_t)ahead : n;\n        if (free > 0) {\n");
	fprintf(e->to, "            %s_leap(s, free);\n            n -= free;\n        } else {\n            %s_step(s);\n            n--;\n        }\n    }\n", n, n);
	fprintf(e->to, "    if (n > 0)\n        %s_leap(s, n);\n}\n", n);
}
