/* SPDX-License-Identifier: GPL-3.0-or-later */
/* spectrum: displacement spectra, 100 periods from 0.02 to 10 s, damping 5 %, of a record of 20,000 samples at 200 Hz
 * that is band-limited to 25 Hz. NAME_batch with ramps and peaks at samples, with hold fifth or seventh and peak(x);
 * beside them what is in use: a recursive filter for each period (SciPy's lfilter: direct form II transposed,
 * ramp-invariant coefficients), one after the other and side by side, and the recurrence of Nigam and Jennings (1969),
 * all with ramps and peaks at samples. What is true is another integration: the record's formula at 32 and 64 times the
 * rate, Richardson's extrapolation of ramps, parabolas through the tops. In samples that take turns, CPU time, the
 * shortest of each. Prints a table; with an argument writes period, true values, errors and the residual spectrum to
 * that file as CSV. */
#include "fifth_pl.h"
#include "ramp_pl.h"
#include "seventh_pl.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "timing.h"

enum { PERIODS = 100, SAMPLES = 20000, WAVES = 40, REPEATS = 15, FINE = 64, AHEAD = 8 };
static const double zeta = 0.05, h = 0.005, pi = 3.14159265358979323846;
static double period[PERIODS], truth[PERIODS], record[SAMPLES + AHEAD];
static double amplitude[WAVES], frequency[WAVES], phase[WAVES];

static double draw(void)
{
	static uint32_t state = 1;
	state = state * 1664525u + 1013904223u;
	return (double)state / 4294967296.0;
}

/* ---- the record: waves up to 25 Hz under an envelope that rises as t^4, is largest after 5 s and decays ---- */

static double ground(double t)
{
	const double s = t / 5;
	double sum = 0;
	for (int i = 0; i < WAVES; i++)
		sum += amplitude[i] * cos(2 * pi * frequency[i] * t + phase[i]);
	return s * s * s * s * exp(4 - 4 * s) * sum;
}

static void make_record(void)
{
	for (int i = 0; i < WAVES; i++) {
		frequency[i] = 0.1 * pow(240, (i + draw()) / WAVES);
		amplitude[i] = 0.2 + draw();
		phase[i] = 2 * pi * draw();
	}
	for (int i = 0; i < SAMPLES; i++)
		record[i] = ground(i * h);
	for (int i = 0; i < PERIODS; i++)
		period[i] = 0.02 * pow(500, i / (PERIODS - 1.0));
}

/* ---- one oscillator over a ramp, in closed form (Nigam and Jennings 1969) ---- */

struct step {                           /* y1 = phi y0 + before u0 + after u1 */
	double phi[2][2], before[2], after[2];
};

static struct step step_of(double w, double d)
{
	struct step s;
	double r = w * sqrt(1 - zeta * zeta), e = exp(-zeta * w * d), c = e * cos(r * d), n = e * sin(r * d) / r;
	double w2 = w * w, lag = 2 * zeta / (w2 * w);
	s.phi[0][0] = c + zeta * w * n;
	s.phi[0][1] = n;
	s.phi[1][0] = -w2 * n;
	s.phi[1][1] = c - zeta * w * n;
	/* The forced part of x'' + 2 zeta w x' + w^2 x = -u0 - r t: x = -u/w^2 + 2 zeta r/w^3, x' = -r/w^2 */
	double x0[2] = { -1 / w2 - lag / d, lag / d }, v[2] = { 1 / (w2 * d), -1 / (w2 * d) };
	double x1[2] = { -lag / d, -1 / w2 + lag / d };
	for (int i = 0; i < 2; i++) {
		s.before[i] = (i ? v[0] : x1[0]) - s.phi[i][0] * x0[0] - s.phi[i][1] * v[0];
		s.after[i] = (i ? v[1] : x1[1]) - s.phi[i][0] * x0[1] - s.phi[i][1] * v[1];
	}
	return s;
}

/* The largest |x| after the record: a free vibration from x, v has its largest extreme where v is first 0. */
static double residual(double w, double x, double v)
{
	double r = w * sqrt(1 - zeta * zeta), angle = atan2(v * r, w * w * x + zeta * w * v);
	double t = (angle > 0 ? angle : angle + pi) / r;
	double later = exp(-zeta * w * t) * (x * cos(r * t) + (v + zeta * w * x) / r * sin(r * t));
	return fmax(fabs(x), fabs(later));
}

/* ---- what is true ---- */

static double top(double a, double b, double c)
{
	double bend = a - 2 * b + c, slope = (c - a) / 2;
	return fabs(bend == 0 ? b : b - slope * slope / (2 * bend));
}

static void find_truth(void)
{
	const size_t count = (size_t)(SAMPLES - 1) * FINE + 1;
	double *fine = malloc(count * sizeof *fine);
	if (!fine)
		exit(1);
	for (size_t i = 0; i < count; i++)
		fine[i] = ground((double)i * h / FINE);
	for (int p = 0; p < PERIODS; p++) {
		double w = 2 * pi / period[p], x[2] = { 0 }, v[2] = { 0 }, last[3] = { 0 };
		const struct step s[2] = { step_of(w, h / FINE), step_of(w, 2 * h / FINE) };
		truth[p] = 0;
		for (size_t i = 1; i < count; i++) {
			double u0 = fine[i - 1], u1 = fine[i], old = x[0];
			x[0] = s[0].phi[0][0] * x[0] + s[0].phi[0][1] * v[0] + s[0].before[0] * u0 + s[0].after[0] * u1;
			v[0] = s[0].phi[1][0] * old + s[0].phi[1][1] * v[0] + s[0].before[1] * u0 + s[0].after[1] * u1;
			if (i % 2)
				continue;
			u0 = fine[i - 2];
			old = x[1];
			x[1] = s[1].phi[0][0] * x[1] + s[1].phi[0][1] * v[1] + s[1].before[0] * u0 + s[1].after[0] * u1;
			v[1] = s[1].phi[1][0] * old + s[1].phi[1][1] * v[1] + s[1].before[1] * u0 + s[1].after[1] * u1;
			last[0] = last[1];
			last[1] = last[2];
			last[2] = x[0] + (x[0] - x[1]) / 3;
			if (fabs(last[1]) >= fabs(last[0]) && fabs(last[1]) > fabs(last[2]))
				truth[p] = fmax(truth[p], top(last[0], last[1], last[2]));
		}
	}
	free(fine);
}

/* ---- what is in use ---- */

static double end_x[PERIODS], end_v[PERIODS];

struct filter { double a1, a2, b0, b1, b2; };

static struct filter filter_of(int p)
{
	const struct step s = step_of(2 * pi / period[p], h);
	struct filter f = { .a1 = -s.phi[0][0] - s.phi[1][1], .b0 = s.after[0] };
	const double g0 = s.phi[0][0] * s.after[0] + s.phi[0][1] * s.after[1] + s.before[0];
	const double g1 = s.phi[1][0] * s.after[0] + s.phi[1][1] * s.after[1] + s.before[1];
	f.a2 = s.phi[0][0] * s.phi[1][1] - s.phi[0][1] * s.phi[1][0];
	f.b1 = f.b0 * f.a1 + g0;
	f.b2 = f.b0 * f.a2 - s.phi[1][1] * g0 + s.phi[0][1] * g1;
	return f;
}

static void by_filter(double *sd)
{
	for (int p = 0; p < PERIODS; p++) {
		const struct filter f = filter_of(p);
		double z0 = 0, z1 = 0, most = 0;
		for (int i = 0; i < SAMPLES; i++) {
			const double u = record[i], x = f.b0 * u + z0;
			z0 = f.b1 * u - f.a1 * x + z1;
			z1 = f.b2 * u - f.a2 * x;
			most = fabs(x) > most ? fabs(x) : most;
		}
		sd[p] = most;
	}
}

/* The same filters side by side, so that none waits for its own last sample: as many periods in a vector as the machine
 * that is compiled for has, some vectors in turns */
#if defined __AVX512F__
enum { VECTOR = 64 };
#elif defined __AVX__
enum { VECTOR = 32 };
#else
enum { VECTOR = 16 };
#endif
typedef double lanes __attribute__((vector_size(VECTOR)));
typedef long long masks __attribute__((vector_size(VECTOR)));
enum { LANES = VECTOR / sizeof(double), TURNS = 4, AT_ONCE = LANES * TURNS };

/* most, or |x| */
static inline lanes larger(lanes most, lanes x)
{
	const lanes size = (lanes)((masks)x & INT64_MAX);
	const masks it = size > most;
	return (lanes)(((masks)size & it) | ((masks)most & ~it));
}

static void by_filters(double *sd)
{
	for (int p = 0; p < PERIODS; p += AT_ONCE) {
		lanes a1[TURNS], a2[TURNS], b0[TURNS], b1[TURNS], b2[TURNS], z0[TURNS], z1[TURNS], most[TURNS];
		for (int k = 0; k < AT_ONCE; k++) {
			const struct filter f = filter_of(p + k < PERIODS ? p + k : PERIODS - 1);
			const int turn = k / LANES, lane = k % LANES;
			a1[turn][lane] = f.a1, a2[turn][lane] = f.a2;
			b0[turn][lane] = f.b0, b1[turn][lane] = f.b1, b2[turn][lane] = f.b2;
			z0[turn][lane] = z1[turn][lane] = most[turn][lane] = 0;
		}
		for (int i = 0; i < SAMPLES; i++) {
			const double u = record[i];
#pragma GCC unroll 4
			for (int k = 0; k < TURNS; k++) {
				const lanes x = b0[k] * u + z0[k];
				z0[k] = b1[k] * u - a1[k] * x + z1[k];
				z1[k] = b2[k] * u - a2[k] * x;
				most[k] = larger(most[k], x);
			}
		}
		for (int k = 0; k < AT_ONCE && p + k < PERIODS; k++)
			sd[p + k] = most[k / LANES][k % LANES];
	}
}

static void by_recurrence(double *sd)
{
	for (int p = 0; p < PERIODS; p++) {
		const struct step s = step_of(2 * pi / period[p], h);
		double x = 0, v = 0, most = 0;
		for (int i = 1; i < SAMPLES; i++) {
			const double u0 = record[i - 1], u1 = record[i], old = x;
			x = s.phi[0][0] * old + s.phi[0][1] * v + s.before[0] * u0 + s.after[0] * u1;
			v = s.phi[1][0] * old + s.phi[1][1] * v + s.before[1] * u0 + s.after[1] * u1;
			most = fabs(x) > most ? fabs(x) : most;
		}
		sd[p] = most;
		end_x[p] = x;
		end_v[p] = v;
	}
}

/* ---- by plgen: retuned to each period, then all in one call; rows 0 .. ahead - 1 of the record come first ---- */

#define BY_BATCH(NAME, UPPER, ROWS_AHEAD)                                                                              \
	static void by_##NAME(double *sd)                                                                              \
	{                                                                                                              \
		static double y[UPPER##_BATCH_ROWS * PERIODS], factors[UPPER##_BATCH_FACTORS * PERIODS];               \
		NAME##_instances b = { .count = PERIODS, .y = y, .factors = factors, .peak = sd };                     \
		NAME##_batch_init(&b);                                                                                 \
		for (int p = 0; p < PERIODS; p++) {                                                                    \
			static NAME##_coeffs c;                                                                        \
			const double params[2] = { 2 * pi / period[p], zeta };                                         \
			if (NAME##_retune(&c, params, h) != 0 || NAME##_batch_use(&b, (size_t)p, &c) != 0)             \
				exit(1);                                                                               \
		}                                                                                                      \
		for (int i = 0; i < ROWS_AHEAD; i++)                                                                   \
			NAME##_hold(&b.shared, record + i);                                                            \
		NAME##_batch(&b, SAMPLES - 1, record + ROWS_AHEAD, NULL);                                              \
	}
BY_BATCH(ramp, RAMP, 1)
BY_BATCH(fifth, FIFTH, 3)
BY_BATCH(seventh, SEVENTH, 4)

/* ---- the table ---- */

static struct method {
	const char *name;
	void (*run)(double *sd);
	double sd[PERIODS], best;
} methods[] = {
	{ "lfilter's algorithm, a filter a period", by_filter, { 0 }, 1e99 },
	{ "the same filters side by side", by_filters, { 0 }, 1e99 },
	{ "Nigam and Jennings' recurrence", by_recurrence, { 0 }, 1e99 },
	{ "plgen, hold first, peaks at samples", by_ramp, { 0 }, 1e99 },
	{ "plgen, hold fifth, peak(x)", by_fifth, { 0 }, 1e99 },
	{ "plgen, hold seventh, peak(x)", by_seventh, { 0 }, 1e99 }
};
enum { METHODS = sizeof methods / sizeof *methods };

static double error_of(const struct method *m, int p)
{
	return fabs(m->sd[p] - truth[p]) / truth[p];
}

static void tell(const struct method *m)
{
	double error[PERIODS];
	for (int p = 0; p < PERIODS; p++)
		error[p] = error_of(m, p);
	const double half = median(error);
	printf("%-42s %8.2f ms %7.2f ns  %8.1e  %8.1e\n", m->name, 1e3 * m->best, 1e9 * m->best / PERIODS / SAMPLES,
	       error[PERIODS - 1], half);
}

static void write_file(const char *name)
{
	FILE *to = fopen(name, "w");
	if (!to)
		exit(1);
	fprintf(to, "period,truth,residual,filter,filters,recurrence,ramp,fifth,seventh\n");
	for (int p = 0; p < PERIODS; p++) {
		fprintf(to, "%.17g,%.17g,%.17g", period[p], truth[p], residual(2 * pi / period[p], end_x[p], end_v[p]));
		for (int m = 0; m < METHODS; m++)
			fprintf(to, ",%.3g", error_of(&methods[m], p));
		fputc('\n', to);
	}
	if (fclose(to) != 0)
		exit(1);
}

int main(int argc, char **argv)
{
	make_record();
	find_truth();
	for (int r = 0; r < REPEATS; r++)
		for (int m = 0; m < METHODS; m++) {
			double start = own_nanoseconds();
			methods[m].run(methods[m].sd);
			methods[m].best = fmin(methods[m].best, 1e-9 * (own_nanoseconds() - start));
		}
	printf("%-42s %11s %10s  %8s  %8s\n", "", "record", "a step", "worst", "median");
	for (int m = 0; m < METHODS; m++)
		tell(&methods[m]);
	if (argc > 1)
		write_file(argv[1]);
	return 0;
}
