/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What NAME_retune computes against the generator's own coefficients for the same values:
 *
 *     coefficients [-n SETS] [-m SETS] [-s SEED] [-v] MODEL.spec ...
 *
 * n sets of params for each family of pair.spec, m for each other model. The generator builds each model anew from the
 * spec without its statement `tunable`, with the values as -D and --step, all exact.  Bounds, in units in the last
 * place (ulp):
 *
 *     states x states      16 ulp of the largest entry of Phi
 *     a load, an input     16 ulp of the largest entry of its column, in each segment of time
 *     outputs              16 ulp of the largest factor of the row
 *     phases, envelopes      bit for bit; where a frequency is 2 pi f, what rounds to it is within 2^-104, in
 *                          floats 2^-45, of w h / (2 pi)
 *
 * NAME_nominal is what the generator has for the spec's values, bit for bit. The largest met is printed for each
 * family; for states also in ulp of the largest entry of Phi - I, for ramps in ulp of that of both columns.
 */
#include "families.h"
#include "cases.h"
#include "drawn.h"
#include "../emitted/worse.h"
#include "emit/steps.h"
#include "model/linear/inner.h"
#include "model/linear/modal_truncation.h"
#include "model/tunable/tuning.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { MISMATCHES_SHOWN = 10 };

/* What was off by most in some 10^4 sets, and values that make a pivot small in another order of elimination */
static const struct known {
	const char *name;
	double h, value[LIMIT_TUNABLES];
} known[] = {
	/* ramps whose value before the step has what is left of two larger numbers: in one word, 28 and 256 ulp, in
	 * floats 19 and 206 */
	{"held", 0x1.bbae5cp-6, {0x1.955db4p+2, 0x1.30045p+4, 0x1.08p+1, 0x1.9p+5, 0x1.6p-1}},
	{"held", 0x1.bbae5b0a1cd08p-6, {0x1.955db4811cc5p+2, 0x1.300450ac6c6f3p+4, 0x1.08p+1, 0x1.9p+5, 0x1.6p-1}},
	{"sketch", 0x1.aa943ap-6, {0x1.068p+11, 0x1.65cc4cp+4, 0x1.4b4c34p+14, 0x1.c2443ep+11, 0x1.1c4efep+16}},
	/* balanced, nearly, and far from the spec's values */
	{"order", 0x1p-6, {2, 2, 0.5, 2, 2}},
	{"order", 0x1p-7, {1, 0x1.0000000000004p+0, 0.5, 0x1.0000000000004p+0, 1}},
	{"order", 0x1p-6, {16, 0.125, 0.0625, 0.5, 8}}};
enum { KNOWN = sizeof known / sizeof *known };

/* ---- the generator's own ---- */

static const char *exact(real x)
{
	mpq_t q;
	mpq_init(q);
	mpq_set_d(q, (double)x);
	return mpq_get_str(NULL, 10, q);
}

/* The spec, tunable params and all, and the coordinates that its target keeps, whatever they are */
static char whole[1 << 14];
static const struct relative *kept;

/* Reduced, where the spec asks for that */
static struct model *made(const char *text, struct request *request)
{
	request->reduce = strstr(whole, "#always --reduce");
	struct spec *spec = spec_of("spec", text);
	struct model *model = spec ? model_build(spec, request) : NULL;
	return model ? model_reduce(model) : NULL;
}

static void find_kept(void)
{
	struct request *request = NEW(struct request);
	struct model *model = made(format("%s", whole), request);
	model = model && model->written == model ? find_tuning(model, request) : NULL;
	kept = model ? relative_of(model) : NULL;
}

/* p NULL: the spec's values and step */
static const struct step *generator(const struct tuned *m, const char *text, const real *p, real h)
{
	struct request *request = NEW(struct request);
	*request = (struct request){.again.relative = kept,
								.form = m->direct ? FORM_DIRECT : FORM_DELTA,
								.single = BITS == 24,
								.step = p ? exact(h) : NULL};
	for (int k = 0; k < m->model->params && p; k++)
		definitions_add(format("%s=%s", m->model->param_names[k], exact(p[k])), &request->definitions);
	struct model *model = made(text, request);
	return model ? step_build(model) : NULL;
}

/* ---- comparing ---- */

static struct {
	double states, increment, loads, inputs, ramps, outputs; /* largest, in ulp */
	double least_angle, most_angle;                   /* |p| h */
	int compared, failed;
} met;

static const struct tuned *model_now;
static const real *params_now;
static real h_now;

static void show_case(void)
{
	printf("#     %s, h=%a", model_now->name, (double)h_now);
	for (int k = 0; k < model_now->model->params; k++)
		printf(" %s=%a", model_now->model->param_names[k], (double)params_now[k]);
	putchar('\n');
}

static void complain(const char *what)
{
	if (met.failed++ >= MISMATCHES_SHOWN)
		return;
	printf("# %s\n", what);
	show_case();
}

static double ulp(double x)
{
	int exponent;
	if (x == 0)
		return 0;
	frexp(x, &exponent);
	return ldexp(1, exponent - BITS);
}

static double bound = 16;               /* ulp */

/* Raises *most; complains where found is off by more than the bound, or not finite. */
static void compare(double *most, double found, double expected, double largest, const char *what, int i, int j)
{
	const double difference = fabs(found - expected), error = difference == 0 ? 0 : difference / ulp(largest);
	met.compared++;
	if (!(error <= *most))
		*most = error;
	if (!(error <= bound))
		complain(format("%s [%d][%d]: found %.17g, expected %.17g, off by %.3g ulp of %.17g", what, i, j, found,
						expected, error, largest));
}

static const real *row_of(const struct tuned *m, const char *coeffs, size_t member, int row)
{
	return (const real *)(const void *)(coeffs + member) + row * m->columns;
}

static void compare_states(const struct tuned *m, const char *coeffs, const struct table *table)
{
	const int n = table->states;
	const struct coefficient *square = m->direct ? table->Phi : table->increment;
	double Phi = 0, increment = 0, off = 0;
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++) {
			const double value = square[i * n + j].value, one = i == j;
			Phi = fmax(Phi, fabs(m->direct ? value : value + one));
			increment = fmax(increment, fabs(m->direct ? value - one : value));
		}
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++) {
			const double found = (double)row_of(m, coeffs, m->step, i)[j],
					expected = square[i * n + j].value;
			compare(&met.states, found, expected, Phi, "states", i, j);
			off = worse(off, fabs(found - expected));
		}
	if (off > 0 && !m->direct)
		met.increment = worse(met.increment, off / ulp(increment));
}

/* A column of factors: one row for each state */
static void compare_column(const struct tuned *m, const char *coeffs, double *most, const struct coefficient *from,
						   int stride, int column, const char *what)
{
	double largest = 0;
	for (int i = 0; i < m->step_entries; i++)
		largest = fmax(largest, fabs(from[i * stride].value));
	for (int i = 0; i < m->step_entries; i++)
		compare(most, (double)row_of(m, coeffs, m->step, i)[column], from[i * stride].value, largest, what, i,
				column);
}

/* Both columns of a ramp against the largest of both: not judged, only printed */
static void measure_ramp(const struct tuned *m, const char *coeffs, const struct coefficient *from, int stride,
						 int column)
{
	double largest = 0, off = 0;
	for (int i = 0; i < m->step_entries; i++)
		for (int k = 0; k < 2; k++) {
			largest = fmax(largest, fabs(from[i * stride + k].value));
			off = worse(off, fabs((double)row_of(m, coeffs, m->step, i)[column + k] - from[i * stride
					+ k].value));
		}
	if (off > 0)
		met.ramps = worse(met.ramps, off / ulp(largest));
}

static void compare_columns(const struct tuned *m, const char *coeffs, const struct table *table,
							const struct linear *system)
{
	int column = table->states;
	for (int s = 0; s < system->segments; s++)
		for (int k = 0; k < table->columns; k++)
			compare_column(m, coeffs, &met.loads, table->load + s * table->states * table->columns + k,
					table->columns,
						   column++, "load");
	for (int i = 0, k = 0; i < system->inputs; i++) {
		if (system->input[i].hold)
			measure_ramp(m, coeffs, table->input + k, table->inputs, column);
		for (int end = k + (system->input[i].hold ? 2 : 1); k < end; k++)
			compare_column(m, coeffs, &met.inputs, table->input + k, table->inputs, column++, "input");
	}
	if (column != m->columns)
		complain(format("%d columns, the generator has %d", m->columns, column));
}

static double rounded(mpq_srcptr q)
{
	mpfr_t x;
	mpfr_init2(x, BITS);
	mpfr_set_q(x, q, MPFR_RNDN);
	const double value = mpfr_get_d(x, MPFR_RNDN);
	mpfr_clear(x);
	return value;
}

/* The row of an output over the columns */
static void output_row(const struct linear *system, const struct output *output, double *row)
{
	int column = 0;
	for (int j = 0; j < system->states; j++)
		row[column++] = rounded(output->state[j]);
	for (int s = 0; s < system->segments; s++)
		for (int l = 0; l < system->loads; l++)
			for (int k = 0; k < system->load[l].columns; k++)
				row[column++] = rounded(output->load[l][k * system->segments + s]);
	for (int i = 0; i < system->inputs; i++)
		for (int k = 0; k < (system->input[i].hold ? 2 : 1); k++)
			row[column++] = rounded(output->input[k][i]);
}

/* Only outputs that some param changes are held. */
static void compare_outputs(const struct tuned *m, const char *coeffs, const struct step *step, const bool *varies)
{
	double *row = ARRAY(double, (size_t)m->columns);
	int at = 0;
	for (int o = 0; o < step->model->outputs; o++) {
		double largest = 0;
		if (!varies[o])
			continue;
		output_row(&step->branch->system, &step->model->output[o], row);
		for (int j = 0; j < m->columns; j++)
			largest = fmax(largest, fabs(row[j]));
		for (int j = 0; j < m->columns && at < m->out_entries; j++)
			compare(&met.outputs, (double)row_of(m, coeffs, m->out, at)[j], row[j], largest,
					step->model->output[o].name, at, j);
		at++;
	}
	if (at != m->out_entries)
		complain(format("%d rows of outputs, expected %d", m->out_entries, at));
}

/* The integers of an initialiser, as bits: UINT64_C(0x...), INT64_C(0x...), -INT64_C(0x...) - 1 */
static int integers_of(const char *text, uint64_t *word)
{
	int count = 0;
	for (const char *at = text; (at = strstr(at, "INT64_C(")) != NULL; at += 8) {
		const uint64_t value = strtoull(at + 8, NULL, 16);
		word[count++] = at > text && at[-1] == '-' ? ~value : value;
	}
	return count;
}

/* w h / (2 pi) in units of a phase's last word: turns, and what is beyond whole ones */
static void exact_phase(mpfr_t turns, mpfr_t phase, mpq_srcptr w, mpq_srcptr h, int words)
{
	mpfr_t pi;
	mpfr_init2(pi, mpfr_get_prec(phase));
	mpfr_const_pi(pi, MPFR_RNDN);
	mpfr_set_q(turns, w, MPFR_RNDN);
	mpfr_mul_q(turns, turns, h, MPFR_RNDN);
	mpfr_div(turns, turns, pi, MPFR_RNDN);
	mpfr_div_2ui(turns, turns, 1, MPFR_RNDN);
	mpfr_frac(phase, turns, MPFR_RNDN);
	mpfr_mul_2ui(turns, turns, (unsigned long)(64 * words), MPFR_RNDN);
	mpfr_mul_2ui(phase, phase, (unsigned long)(64 * words), MPFR_RNDN);
	mpfr_clear(pi);
}

/* A frequency 2 pi f is known in two words on the target: a phase of sweep is the nearest number of units to one that
 * is off by 2^-104 of the turns of a step, in floats 2^-45. */
static bool nearly(const uint64_t *found, int words, mpq_srcptr w, mpq_srcptr h)
{
	mpz_t units;
	mpfr_t phase, most;
	if (!w || !strstr(model_now->name, "sweep"))
		return false;
	mpz_init(units);
	mpfr_inits2(400, phase, most, NULL);
	mpz_import(units, (size_t)words, 1, sizeof *found, 0, 0, found);
	exact_phase(most, phase, w, h, words);
	mpfr_div_2ui(most, most, BITS == 53 ? 104 : 45, MPFR_RNDN);
	mpfr_add_d(most, most, 0.5, MPFR_RNDN);
	mpfr_sub_z(phase, phase, units, MPFR_RNDN);
	const bool near = mpfr_cmpabs(phase, most) <= 0;
	mpz_clear(units);
	mpfr_clears(phase, most, NULL);
	return near;
}

/* w: of a phase, its frequency; else NULL */
static void compare_words(const char *coeffs, size_t place, int index, const char *text, mpq_srcptr w, mpq_srcptr h)
{
	const char *what = w ? "phase" : "envelope";
	uint64_t word[2], found[2];
	const int words = integers_of(text, word), expected = BITS == 53 ? 2 : 1;
	if (words != expected) {
		complain(format("%s: cannot read %s", what, text));
		return;
	}
	memcpy(found, coeffs + place + (size_t)(index * words) * sizeof *word, (size_t)words * sizeof *word);
	met.compared++;
	if (memcmp(found, word, (size_t)words * sizeof *word) != 0 && !nearly(found, words, w, h))
		complain(format("%s %d: found %016llx %016llx, expected %s", what, index, (unsigned long long)found[0],
						(unsigned long long)found[words - 1], text));
}

static void compare_loads(const struct tuned *m, const char *coeffs, const struct step *step)
{
	const struct emitter e = { .step = step, .model = step->model, .system = &step->branch->system };
	int phases = 0, envelopes = 0;
	for (int l = 0; l < step->branch->system.loads; l++) {
		const struct forcing *forcing = step->branch->system.load[l].forcing;
		if (mpq_sgn(forcing->w) != 0)
			compare_words(coeffs, m->phase_step, phases++, phase_step_text(&e, l), forcing->w,
					step->model->h);
		if (mpq_sgn(forcing->a) != 0)
			compare_words(coeffs, m->envelope_step, envelopes++, envelope_step_text(&e, l), NULL, NULL);
	}
	if (phases != m->phase_step_entries || envelopes != m->envelope_step_entries)
		complain(format("%d phases and %d envelopes, expected %d and %d", m->phase_step_entries,
						m->envelope_step_entries, phases, envelopes));
}

/* Whether any param changes the row of an output: from the spec and from values that are all different */
static bool *output_varies(const struct tuned *m, const char *text)
{
	real *p = ARRAY(real, (size_t)m->model->params);
	for (int k = 0; k < m->model->params; k++)
		p[k] = m->model->param_values[k];
	const struct step *one = generator(m, text, p, m->model->h);
	for (int k = 0; k < m->model->params; k++)
		p[k] += (real)(1 + k) / 4;
	const struct step *two = generator(m, text, p, m->model->h);
	bool *varies = ARRAY(bool, (size_t)one->model->outputs);
	double *row = ARRAY(double, 2 * (size_t)m->columns);
	for (int o = 0; o < one->model->outputs; o++) {
		output_row(&one->branch->system, &one->model->output[o], row);
		output_row(&two->branch->system, &two->model->output[o], row + m->columns);
		varies[o] = memcmp(row, row + m->columns, (size_t)m->columns * sizeof *row) != 0;
	}
	return varies;
}

static void try_values(const struct tuned *m, const char *text, const bool *varies, const real *p, real h)
{
	char *coeffs = ARRAY(char, m->size);
	model_now = m;
	params_now = p;
	h_now = h;
	const struct step *step = generator(m, text, p, h);
	if (!step) {
		complain(format("the generator refuses it: %s", first_line(diagnostics())));
		return;
	}
	const int status = m->retune(coeffs, p, h);
	bool negative = false;
	for (int k = 0; k < m->model->params; k++)
		negative = negative || p[k] < 0;
	if (status == PL_NO_RATE && negative)   /* a frequency below 0, which the generator turns around */
		return;
	if (status != 0) {
		complain(format("retune: status %d", status));
		return;
	}
	const double angle = largest_pole_angle(step);
	met.least_angle = met.compared == 0 ? angle : fmin(met.least_angle, angle);
	met.most_angle = worse(met.most_angle, angle);
	compare_states(m, coeffs, step->branch->full);
	compare_columns(m, coeffs, step->branch->full, &step->branch->system);
	if (m->out_entries > 0)
		compare_outputs(m, coeffs, step, varies);
	compare_loads(m, coeffs, step);
	if (memcmp(coeffs + m->params, p, (size_t)m->model->params * sizeof *p) != 0 ||
		memcmp(coeffs + m->h, &h, sizeof h) != 0)
		complain("params and h are not those given");
}

/* ---- the whole ---- */

static bool verbose;

static void finish(const char *name)
{
	printf("# %s: states %.2f ulp of Phi, %.2f of Phi - I; loads %.2f, inputs %.2f (a ramp's two as one: %.2f), "
		   "outputs %.2f; "
		   "|p| h %.2g to %.3g; %d numbers\n",
		   name, met.states, met.increment, met.loads, met.inputs, met.ramps, met.outputs, met.least_angle,
		   met.most_angle, met.compared);
	if (met.failed > MISMATCHES_SHOWN)
		printf("# %s: %d failures in all\n", name, met.failed);
}

static char *text_of(const char *path)
{
	static char text[1 << 14];
	char line[1 << 10];
	FILE *f = fopen(path, "r");
	text[0] = whole[0] = 0;
	if (!f) {
		printf("Bail out! cannot read %s\n", path);
		exit(1);
	}
	while (fgets(line, sizeof line, f)) {
		if (strlen(whole) + strlen(line) < sizeof whole)
			strcat(whole, line);
		if (strncmp(line, "tunable", 7) != 0 && strlen(text) + strlen(line) < sizeof text)
			strcat(text, line);
	}
	fclose(f);
	find_kept();
	return text;
}

static const struct tuned *tuned_of(const char *path, bool direct)
{
	const char *base = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
	for (const struct tuned *m = tuned; m->name; m++) {
		const char *name = m->name + (m->direct ? strlen("direct_") : 0);
		if (!m->direct == !direct && strlen(base) == strlen(name) + strlen(".spec") &&
			strncmp(base, name, strlen(name)) == 0)
			return m;
	}
	printf("Bail out! %s is not in the table\n", path);
	exit(1);
}

struct trial_batch {
	const struct tuned *m;
	const char *text;
	const bool *varies;                 /* per output */
	uint64_t seed;
	unsigned long first, sets;          /* 0 sets: the nominal coefficients */
	const struct family *family;        /* NULL: draw_near */
};

static void try_batch(const struct trial_batch *b)
{
	real p[LIMIT_TUNABLES];
	for (unsigned long k = b->first; k < b->first + b->sets; k++) {
		random_state = (b->seed + k) * UINT64_C(0x9e3779b97f4a7c15) + 7;
		below(2);
		const real h = b->family ? b->family->draw(p) : draw_near(b->m, p);
		const int before = met.failed;
		try_values(b->m, b->text, b->varies, p, h);
		if (verbose && met.failed == before)
			show_case();
	}
	for (int i = 0; i < KNOWN && !b->family && b->first == 0; i++)
		if (strcmp(known[i].name, b->m->name) == 0) {
			for (int k = 0; k < b->m->model->params; k++)
				p[k] = (real)known[i].value[k];
			try_values(b->m, b->text, b->varies, p, (real)known[i].h);
		}
}

/* The coefficients that an instance starts with */
static void try_nominal(const struct trial_batch *b)
{
	const struct tuned *m = b->m;
	const struct step *step = generator(m, b->text, NULL, 0);
	model_now = m;
	params_now = m->model->param_values;
	h_now = m->model->h;
	bound = 0;
	compare_states(m, m->nominal, step->branch->full);
	compare_columns(m, m->nominal, step->branch->full, &step->branch->system);
	if (m->out_entries > 0)
		compare_outputs(m, m->nominal, step, b->varies);
	compare_loads(m, m->nominal, step);
}

static const char *name_of(const struct trial_batch *b)
{
	return b->family ? format("%s, %s", b->m->name, b->family->name) : b->m->name;
}

static bool try_case(void *context)
{
	const struct trial_batch *b = context;
	(b->sets ? try_batch : try_nominal)(b);
	finish(name_of(b));
	return met.failed == 0 && met.compared > 0;
}

static void run_piece(struct trial_batch *b)
{
	const char *what = b->sets ? format("sets of params %lu to %lu", b->first, b->first + b->sets - 1)
		: "nominal coefficients, bit for bit";
	run_case(format(TYPE ", %s: %s", name_of(b), what), 0, try_case, b);
}

/* The generator gives nothing back before it ends: in pieces, each a process */
static void run(struct trial_batch *b)
{
	enum { AT_A_TIME = 50 };
	const unsigned long all = b->sets;
	b->first = 0;
	do {
		b->sets = all - b->first < AT_A_TIME ? all - b->first : AT_A_TIME;
		run_piece(b);
		b->first += b->sets;
	} while (b->first < all);
}

int main(int argc, char **argv)
{
	unsigned long pairs = 50, others = 40, seed = 1;
	memory_open();
	take_options(argc, argv, (struct command_option[]){
		{ 'n', .number = &pairs }, { 'm', .number = &others }, { 's', .number = &seed },
				{ 'v', .on = &verbose }, { 0 }
	});
	if (BITS == 24)
		target_float();
	for (int i = optind; i < argc; i++) {
		struct trial_batch b = { .m = tuned_of(argv[i], false), .text = text_of(argv[i]) };
		b.varies = output_varies(b.m, b.text);
		for (int f = 0; f < family_count && strcmp(b.m->name, "pair") == 0; f++) {
			b.family = &families[f];
			b.seed = seed * 1000000 + (uint64_t)f * 10000;
			b.sets = pairs;
			run(&b);
		}
		b.family = NULL;
		b.sets = 0;
		run(&b);
		b.seed = seed * 1000000 + 500000;
		b.sets = others;
		run(&b);
		b.m = tuned_of(argv[i], true);
		b.sets = 0;
		run(&b);
		b.seed += 100000;
		b.sets = others / 4;
		run(&b);
	}
	memory_close();
	printf("1..%d\n", cases_reported());
	return cases_failed() > 0;
}
