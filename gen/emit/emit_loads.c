/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loads on the target: phases as turns, growths as exponents of 2, and the load states made of them at a step's start. */
#include "emit/emit.h"

/* What an angle is measured in, 2 pi, or what an exponent is, ln 2 */
static void set_unit(mpfr_ptr unit, bool turns)
{
	if (turns)
		mpfr_const_pi(unit, MPFR_RNDN);
	else
		mpfr_const_log2(unit, MPFR_RNDN);
	mpfr_mul_2ui(unit, unit, turns ? 1 : 0, MPFR_RNDN);
}

/* Bits of a phase or an exponent on the target */
static int load_bits(const struct emitter *e)
{
	return e->model->asked.single ? 64 : 128;
}

/* q / unit as so many bits with `fraction` of them behind the point, wrapped; the unit is 2 pi for turns, else ln 2 */
static void fixed_point(mpq_srcptr q, bool turns, int bits, int fraction, uint64_t word[2])
{
	long above = (long)mpz_sizeinbase(mpq_numref(q), 2) - (long)mpz_sizeinbase(mpq_denref(q), 2);
	mpfr_t x, unit;
	mpz_t fixed, part;
	mpfr_inits2(512 + (above > 0 ? above : 0), x, unit, NULL);
	mpz_inits(fixed, part, NULL);
	set_unit(unit, turns);
	mpfr_set_q(x, q, MPFR_RNDN);
	mpfr_div(x, x, unit, MPFR_RNDN);
	mpfr_mul_2si(x, x, fraction, MPFR_RNDN);
	mpfr_get_z(fixed, x, MPFR_RNDN);
	mpz_ui_pow_ui(part, 2, (unsigned long)bits - 1);
	mpz_sub_ui(part, part, 1);
	if (!turns && mpz_cmpabs(fixed, part) > 0)      /* an exponent beyond any double is saturated, not wrapped */
		mpz_mul_si(fixed, part, mpz_sgn(fixed));
	mpz_fdiv_r_2exp(fixed, fixed, (mp_bitcnt_t)bits);
	mpz_fdiv_r_2exp(part, fixed, 64);
	word[1] = mpz_get_ui(part);
	mpz_fdiv_q_2exp(part, fixed, 64);
	word[0] = mpz_get_ui(part);
	mpz_clears(fixed, part, NULL);
	mpfr_clears(x, unit, NULL);
}

/* |q| / unit as three words, for float two, and a power of two; unit is 2 pi or ln 2 */
static void print_rate(const struct emitter *e, mpq_srcptr q, bool turns, const char *note)
{
	mpfr_t rate, unit, wide;
	mpz_t word, digits;
	int words = e->model->asked.single ? 2 : 3;
	mpfr_init2(rate, 64 * words);
	mpfr_inits2(512, unit, wide, NULL);
	mpz_inits(word, digits, NULL);
	set_unit(unit, turns);
	mpfr_set_q(wide, q, MPFR_RNDN);
	mpfr_abs(wide, wide, MPFR_RNDN);
	mpfr_div(rate, wide, unit, MPFR_RNDN);
	long binary = mpfr_get_z_2exp(digits, rate);
	fputs("    {{", e->to);
	for (int k = words - 1; k >= 0; k--) {
		mpz_fdiv_q_2exp(word, digits, (mp_bitcnt_t)k * 64);
		mpz_fdiv_r_2exp(word, word, 64);
		fprintf(e->to, "UINT64_C(0x%016llx)%s", (unsigned long long)mpz_get_ui(word), k ? ", " : "");
	}
	fprintf(e->to, "}, %ld},  /* %s */\n", -binary, note);
	mpz_clears(word, digits, NULL);
	mpfr_clears(rate, unit, wide, NULL);
}

/* ---- tables ---- */

/* What the exponent of a load's growth gains in so many seconds: units of 2^-112, for float of 2^-48 */
static const char *growth_text(const struct emitter *e, const struct load *load, mpq_srcptr seconds)
{
	mpq_t product;
	uint64_t word[2];
	int bits = load_bits(e);
	mpq_init(product);
	mpq_mul(product, load->wave->a, seconds);
	fixed_point(product, false, bits, bits - 16, word);
	mpq_clear(product);
	bool negative = word[bits == 64] >> 63;
	uint64_t high = word[bits == 64];
	const char *text = format(negative ? "-INT64_C(0x%llx) - 1" : "INT64_C(0x%llx)", (unsigned long long)(negative ? ~high : high));
	return bits == 64 ? text : format("{%s, UINT64_C(0x%016llx)}", text, (unsigned long long)word[1]);
}

/* An angle in units of 2^-128 turn, for float of 2^-64 */
static const char *turn_text(const struct emitter *e, mpq_srcptr angle)
{
	uint64_t word[2];
	int bits = load_bits(e);
	fixed_point(angle, true, bits, bits, word);
	const char *low = format("UINT64_C(0x%016llx)", (unsigned long long)word[1]);
	return bits == 64 ? low : format("{UINT64_C(0x%016llx), %s}", (unsigned long long)word[0], low);
}

static const char *phase_text(const struct emitter *e, const struct load *load, mpq_srcptr seconds)
{
	mpq_t angle;
	mpq_init(angle);
	mpq_mul(angle, load->wave->w, seconds);
	const char *text = turn_text(e, angle);
	mpq_clear(angle);
	return text;
}

const char *phase_step_text(const struct emitter *e, int load)
{
	return phase_text(e, &e->system->load[load], e->model->h);
}

const char *growth_step_text(const struct emitter *e, int load)
{
	return growth_text(e, &e->system->load[load], e->model->h);
}

static void print_turns(const struct emitter *e, const char *name, const char *what, bool per_step)
{
	fprintf(e->to, "\nstatic const pl_turn %s_%s[%d] = {  /* %s */\n", e->name, name, e->phases, what);
	for (int l = 0; l < e->system->loads; l++) {
		const struct load *load = &e->system->load[l];
		if (e->phase[l] >= 0)
			fprintf(e->to, "    %s,  /* %s */\n", per_step ? phase_step_text(e, l) : turn_text(e, load->wave->p), column_text(load, 0));
	}
	fputs("};\n", e->to);
}

static void print_growths(const struct emitter *e)
{
	fprintf(e->to, "\nstatic const pl_growth %s_growth_step[%d] = {  /* a h / ln 2, in units of 2^-%d */\n", e->name, e->growths, load_bits(e) - 16);
	for (int l = 0; l < e->system->loads; l++)
		if (e->growth[l] >= 0)
			fprintf(e->to, "    %s,  /* %s */\n", growth_step_text(e, l), column_text(&e->system->load[l], 0));
	fputs("};\n", e->to);
}

/* One row for each node; loads that are not read there keep their place. */
static void print_node_rows(const struct emitter *e, const char *type, const char *name, const int *index, int count,
			    const char *(*text)(const struct emitter *, const struct load *, mpq_srcptr))
{
	const struct program *program = e->step->program;
	mpq_t seconds;
	mpq_init(seconds);
	fprintf(e->to, "\nstatic const %s %s_%s[%d][%d] = {  /* from the start of a step to each node */\n", type, e->name, name, program->nodes, count);
	for (int i = 0; i < program->nodes; i++) {
		const char *row = "";
		mpq_mul(seconds, program->node[i], e->model->h);
		for (int l = 0; l < e->system->loads; l++)
			if (index[l] >= 0)
				row = format("%s%s%s", row, *row ? ",\n     " : "", text(e, &e->system->load[l], seconds));
		fprintf(e->to, "    {%s},  /* %s h */\n", row, exact_text(program->node[i]));
	}
	fputs("};\n", e->to);
	mpq_clear(seconds);
}

void emit_node_phases(const struct emitter *e, const bool *loads)
{
	bool turning = false, growing = false;
	for (int l = 0; l < e->system->loads; l++) {
		turning = turning || (loads[l] && e->phase[l] >= 0);
		growing = growing || (loads[l] && e->growth[l] >= 0);
	}
	if (turning)
		print_node_rows(e, "pl_turn", "node_phase", e->phase, e->phases, phase_text);
	if (growing)
		print_node_rows(e, "pl_growth", "node_growth", e->growth, e->growths, growth_text);
}

static void print_rate_rows(const struct emitter *e, bool turns)
{
	for (int l = 0; l < e->system->loads; l++) {
		const struct wave *wave = e->system->load[l].wave;
		if ((turns ? e->phase : e->growth)[l] >= 0)
			print_rate(e, turns ? wave->w : wave->a, turns, column_text(&e->system->load[l], 0));
	}
}

static void print_rates(const struct emitter *e, bool turns, const char *name, int count, const char *what)
{
	fprintf(e->to, "\nstatic const pl_rate %s_%s[%d] = {  /* %s */\n", e->name, name, count, what);
	print_rate_rows(e, turns);
	fputs("};\n", e->to);
}

void emit_phase_rates(const struct emitter *e)
{
	print_rate_rows(e, true);
}

static bool has_tuned_rates(const struct emitter *e)
{
	return e->model->tuning && e->model->tuning->frequencies > 0;
}

void emit_load_tables(const struct emitter *e)
{
	if (e->phases) {
		print_turns(e, "phase_start", format("at t = 0, in turns of 2^-%d", load_bits(e)), false);
		if (!e->model->tuning)
			print_turns(e, "phase_step", "in one step", true);
		if (!has_tuned_rates(e))
			print_rates(e, true, "phase_rate", e->phases, "turns per second");
	}
	if (e->growths) {
		if (!e->model->tuning)
			print_growths(e);
		print_rates(e, false, "growth_rate", e->growths, "|a| / ln 2 [1/s]");
	}
}

/* ---- in the state ---- */

void emit_load_members(const struct emitter *e)
{
	if (e->phases)
		fprintf(e->to, "    pl_turn phase[%d];    /* of the loads */\n", e->phases);
	if (e->growths)
		fprintf(e->to, "    pl_growth growth[%d]; /* of the loads */\n", e->growths);
}

void emit_load_set(const struct emitter *e)
{
	if (e->phases)
		fprintf(e->to, "    for (i = 0; i < %d; i++)\n        s->phase[i] = pl_turn_add(%s_phase_start[i], pl_turn_at(&%sphase_rate[i], t));\n", e->phases,
			e->name, has_tuned_rates(e) ? "s->coeffs." : format("%s_", e->name));
	for (int l = 0; l < e->system->loads; l++)
		if (e->growth[l] >= 0)
			fprintf(e->to, "    s->growth[%d] = pl_growth_at(&%s_growth_rate[%d], %d, t);\n", e->growth[l], e->name, e->growth[l],
				mpq_sgn(e->system->load[l].wave->a) < 0);
}

void emit_load_advance(const struct emitter *e, const char *steps)
{
	const char *owner = e->model->tuning ? "s->coeffs." : format("%s_", e->name);
	const char *turn = steps ? "pl_turn_times(%sphase_step[%d], %s)" : "%sphase_step[%d]";
	const char *growth = steps ? "pl_growth_times(%sgrowth_step[%d], %s)" : "%sgrowth_step[%d]";
	for (int i = 0; i < e->phases; i++) {
		fprintf(e->to, "    s->phase[%d] = pl_turn_add(s->phase[%d], ", i, i);
		fprintf(e->to, turn, owner, i, steps);
		fputs(");\n", e->to);
	}
	for (int i = 0; i < e->growths; i++) {
		fprintf(e->to, "    s->growth[%d] = pl_growth_add(s->growth[%d], ", i, i);
		fprintf(e->to, growth, owner, i, steps);
		fputs(");\n", e->to);
	}
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
	return e->at_node ? format("pl_turn_add(s->phase[%d], %s_node_phase[node][%d])", i, e->name, i) : format("s->phase[%d]", i);
}

static const char *growth_now(const struct emitter *e, int i)
{
	return e->at_node ? format("pl_growth_add(s->growth[%d], %s_node_growth[node][%d])", i, e->name, i) : format("s->growth[%d]", i);
}

/* t^k and e^{at} and cos, sin from their parts: load[0] (and [1]), then each power from the one before */
static void emit_one_load(const struct emitter *e, int l)
{
	const struct load *load = &e->system->load[l];
	int trig = oscillates(load->wave) ? 2 : 1;
	FILE *to = e->to;
	if (is_polynomial(load->wave) && load->powers <= 2)
		return;                         /* 1 and t need no array */
	fprintf(to, "    double load%d[%d];  /* %s", l + 1, load->columns, column_text(load, 0));
	for (int k = 1; k < load->columns; k++)
		fprintf(to, ", %s", column_text(load, k));
	fputs(" */\n", to);
	if (trig == 2)
		fprintf(to, "    pl_cossin(%s, load%d);\n", phase_now(e, e->phase[l]), l + 1);
	if (trig == 2 && e->growth[l] >= 0) {
		fprintf(to, "    growth = pl_growth_value(%s);\n", growth_now(e, e->growth[l]));
		fprintf(to, "    load%d[0] *= growth;\n    load%d[1] *= growth;\n", l + 1, l + 1);
	} else if (trig == 1 && e->growth[l] >= 0) {
		fprintf(to, "    load%d[0] = pl_growth_value(%s);\n", l + 1, growth_now(e, e->growth[l]));
	} else if (trig == 1) {
		fprintf(to, "    load%d[0] = 1.0;\n", l + 1);
	}
	for (int k = trig; k < load->columns; k++)
		fprintf(to, "    load%d[%d] = t * load%d[%d];\n", l + 1, k, l + 1, k - trig);
}

void emit_load_states(const struct emitter *e, const bool *loads, bool time_is_there)
{
	bool time = false, growth = false;
	for (int l = 0; l < e->system->loads; l++) {
		time = time || (loads[l] && e->system->load[l].powers > 1);
		growth = growth || (loads[l] && e->growth[l] >= 0 && e->phase[l] >= 0);
	}
	if (time && !time_is_there)
		fprintf(e->to, "    const double t = %s_time(s);\n", e->name);
	if (growth)
		fputs("    double growth;\n", e->to);
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
static void print_forced(const struct emitter *e, const char *name, const char *what, int segments, const struct coefficient *factor)
{
	const struct table *table = e->step->branch->whole;
	double *value = ARRAY(double, (size_t)(table->states * table->columns));
	fprintf(e->to, "\nstatic const double %s_%s[%d][%s_STATES][%d] = {  /* %s */\n", e->name, name, segments, e->upper, table->columns, what);
	for (int s = 0; s < segments; s++) {
		for (int i = 0; i < table->states * table->columns; i++)
			value[i] = is_forced(e->step, i % table->columns) ? factor[s * table->states * table->columns + i].value : 0;
		fputs("  {\n", e->to);
		emit_number_rows(e, table->states, table->columns, value, e->model->state_name);
		fputs("  },\n", e->to);
	}
	fputs("};\n", e->to);
}

/* A change at the end of a step */
static void emit_rebase(const struct emitter *e)
{
	const char *columns = "";
	int count = e->step->branch->whole->columns;
	for (int k = 0; k < count; k++) {
		const char *operand = is_forced(e->step, k) ? column_operand(e, k) : "0.0";
		columns = format("%s%s%s", columns, k ? ", " : "", operand ? operand : "1.0");
	}
	fprintf(e->to, "\nstatic void %s_rebase(%s *s)\n{\n", e->name, e->name);
	emit_load_states(e, e->step->forced->load, false);
	fprintf(e->to, "    const double load[%d] = {%s};\n    int i, j;\n", count, columns);
	fprintf(e->to, "    for (i = 0; i < %s_STATES; i++)\n        for (j = 0; j < %d; j++)\n            s->y[i] += %s_forced_change[s->segment][i][j] * load[j];\n", e->upper, count,
		e->name);
	fputs("}\n", e->to);
}

void emit_forced(const struct emitter *e)
{
	const struct table *table = e->step->branch->whole;
	const char **term = ARRAY(const char *, (size_t)table->columns);
	if (e->system->segments > 1)
		print_forced(e, "forced_part", "factors of the load states in each segment of time", e->system->segments, e->step->forced->part);
	if (e->step->forced->changes) {
		print_forced(e, "forced_change", "what they lose from each to the next", e->system->segments - 1, e->step->forced->change);
		emit_rebase(e);
	}
	fprintf(e->to, "\n/* What the loads that the step leaves out sustain now */\nstatic void %s_forced(const %s *s, double now[%s_STATES])\n{\n", e->name, e->name, e->upper);
	emit_load_states(e, e->step->forced->load, false);
	for (int i = 0; i < table->states; i++) {
		int terms = 0;
		for (int k = 0; k < table->columns; k++)
			if (forces(e, i, k))
				term[terms++] = forced_term(e, i, k);
		fprintf(e->to, "    now[%d] = %s;  /* %s */\n", i, terms ? tree(terms, term, 13) : "0.0", e->model->state_name[i]);
	}
	fputs("    (void)s;\n}\n", e->to);
}
