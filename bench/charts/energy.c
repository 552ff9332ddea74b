/* SPDX-License-Identifier: GPL-3.0-or-later */
/* energy [--quick] VARIANTS FOLDER: what must stay constant, over 1e8 steps (--quick: 1e6), in FOLDER/energy_raw.csv
 * and FOLDER/decay.csv.
 *
 *     undamped   scs: the energy, relative to that at the start
 *     moving     free_pair with v2 = 0: the momentum, relative to sum m |v| at the start
 *     resting    free_pair with v2 = -0.5: the same, where the momentum is 0
 *     damped     sdcs with c = 1e-6: how fast the energy of each mode falls, beside -2 Re(pole)
 *
 * The peers are measured on the equations of each that is `double`, a matrix exponential rounded to float on each that
 * is `float`. energy --list prints the generated code that is opened in VARIANTS, a line each: FILE SPEC options; what
 * it was refused with is in FILE.refused (variant.sh). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "charts.h"

enum { PER_DECADE = 5, STATES = 4 };    /* every case has two coordinates */

struct code { const char *test, *method, *real, *file; double h; };

#define DAMPED "models/sdcs.spec -D c1=1e-6 -D c2=1e-6 -D c3=1e-6"
#define PAIR "bench/charts/specs/free_pair.spec"
static const struct test { const char *name, *real, *h, *spec; } tests[] = {
	{"undamped", "double", "0.01", "models/scs.spec"}, {"moving", "double", "0.01", PAIR " -D v2=0"},
	{"resting", "double", "0.01", PAIR}, {"undamped", "float", "0.01", "models/scs.spec"},
	{"moving", "float", "0.01", PAIR " -D v2=0"}, {"resting", "float", "0.01", PAIR},
	{"undamped", "float", "0.0001", "models/scs.spec"}, {"damped", "double", "0.0001", DAMPED},
	{"damped", "float", "0.0001", DAMPED},
};
/* The equations, the form that plgen chooses, then every form */
static const struct { const char *name, *options; } forms[] = {
	{NULL, ""}, {"", ""}, {", direct", " --form direct"}, {", delta", " --form delta"},
	{", kick-drift-kick", " --form kick-drift-kick"}, {", compensated", " --accuracy compensated"},
};
enum { TESTS = sizeof tests / sizeof *tests, FORMS = sizeof forms / sizeof *forms };


/* ---- what must stay ---- */

/* Equal masses of 1 kg and three springs of 100 N/m, as in models/scs.spec. */
static long double energy_of_chain(const double *y)
{
	const long double x1 = y[0], x2 = y[1], v1 = y[2], v2 = y[3], stretch = x2 - x1;
	return (v1 * v1 + v2 * v2) / 2 + 100 * (x1 * x1 + x2 * x2 + stretch * stretch) / 2;
}

/* Of the mode that moves both masses alike (sign 1, w^2 = 100) or apart (sign -1, w^2 = 300). */
static long double energy_of_mode(const double *y, int sign)
{
	const long double x = y[0] + sign * (long double)y[1], v = y[2] + sign * (long double)y[3];
	return (v * v + (sign > 0 ? 100 : 300) * x * x) / 4;
}

/* Masses 1 and 2, as in specs/free_pair.spec. */
static long double momentum_of_pair(const double *y)
{
	return y[2] + 2 * (long double)y[3];
}

static double change_since(const char *test, const double *start, const double *y)
{
	if (strcmp(test, "undamped") == 0)
		return (double)((energy_of_chain(y) - energy_of_chain(start)) / energy_of_chain(start));
	return (double)((momentum_of_pair(y) - momentum_of_pair(start)) / (fabsl(start[2]) + 2 * fabsl(start[3])));
}

/* ---- one method over all steps ---- */

/* Samples at 1, 2, 3, 4, 6, 10, ... steps.  `largest`: of the samples so far, since a change passes through 0 now and
 * then. */
static void follow(struct run *run, const struct code *v, double steps, FILE *out)
{
	double start[STATES], y[STATES], largest = 0;
	long done = 0;
	run->restart(run);
	run->get(run, start);
	for (int k = 0; ; k++) {
		const long next = lround(pow(10, (double)k / PER_DECADE));
		if ((double)next > steps)
			break;
		const bool good = run->advance(run, (int)(next - done), NULL);
		done = next;
		run->get(run, y);
		const double change = good ? change_since(v->test, start, y) : NAN;
		largest = fmax(largest, fabs(change));
		fprintf(out, "%s,\"%s\",%s,%s,%g,%ld,", v->test, run->method->name, family_names[run->method->family],
		        v->real, v->h, done);
		put_number(out, "%.6g", change, "failed");
		put_number(out, "%.6g", isfinite(change) ? largest : NAN, "failed");
		fputs(isfinite(change) ? "\n" : "nan\n", out);
		if (!isfinite(change))
			break;
	}
}

/* The energy of a mode falls as e^{-c t}, of the other as e^{-3 c t}: C = c [2, -1; -1, 2], and that is -2 Re(pole) to
 * 1e-14 of it. */
static void decay(struct run *run, const struct code *v, double steps, FILE *out)
{
	const double c = 1e-6, time = v->h * steps;
	double start[STATES], y[STATES];
	run->restart(run);
	run->get(run, start);
	const bool good = run->advance(run, (int)steps, NULL);
	run->get(run, y);
	for (int sign = 1; sign >= -1; sign -= 2) {
		const double rate = sign > 0 ? c : 3 * c;
		const double measured = good ? -(double)logl(energy_of_mode(y, sign) / energy_of_mode(start, sign)) /
		                        time : NAN;
		fprintf(out, "\"%s\",%s,%s,%g,%.0f,%g,%.6g,", run->method->name, family_names[run->method->family],
			v->real, v->h, steps, sign > 0 ? 10 : sqrt(300), rate);
		put_number(out, "%.6g", measured, "failed");
		put_number(out, "%.4g", 100 * (measured - rate) / rate, "failed");
		fputs(isfinite(measured) ? "\n" : "nan\n", out);
	}
}

static void enter_refusal(const struct code *v, const char *why, FILE *changes, FILE *decays)
{
	const bool damped = strcmp(v->test, "damped") == 0;
	FILE *out = damped ? decays : changes;
	fprintf(out, "%s%s\"%s\",ours,%s,%g,0,%srefused,refused,", damped ? "" : v->test, damped ? "" : ",", v->method,
	        v->real, v->h, damped ? "0,0," : "");
	put_quoted(out, why);
	putc('\n', out);
}

static void measure(struct run *run, const struct code *v, double steps, FILE *changes, FILE *decays)
{
	if (!run)
		return;
	say_progress("%s %s h = %g: %s", v->test, v->real, v->h, run->method->name);
	if (strcmp(v->test, "damped") == 0)
		decay(run, v, steps, decays);
	else
		follow(run, v, steps, changes);
	run->close(run);
}

static void measure_peers(const struct problem *p, const struct code *v, double steps, FILE *changes, FILE *decays)
{
	static const char *const peers[] = { "RK4", "Newmark", "central difference", "exp(A h), loop", NULL };
	static const char *const float_peers[] = { "exp(A h), loop, float", NULL };
	for (const char *const *name = strcmp(v->real, "float") == 0 ? float_peers : peers; *name; name++) {
		const struct method *m = method_find(*name);
		measure(m->open(m, p, v->h), v, steps, changes, decays);
	}
}

static void measure_ours(const struct problem *p, const struct code *v, double steps, FILE *changes, FILE *decays)
{
	const struct method ours = { v->method, OURS, false, true, 0, "", NULL };
	char *refusal = variant_refused(v->file);
	struct run *run = refusal ? NULL : generated_open(&ours, p, v->file);
	if (refusal)
		enter_refusal(v, refusal, changes, decays);
	else if (!run)
		leave(v->file, "cannot be opened");
	measure(run, v, steps, changes, decays);
	free(refusal);
}

static void list(void)
{
	for (int i = 0; i < TESTS; i++)
		for (int k = 0; k < FORMS; k++)
			printf("energy%d_%d.so %s%s%s --step %s\n", i, k, tests[i].spec, forms[k].options,
			       k > 0 && strcmp(tests[i].real, "float") == 0 ? " --real float" : "", tests[i].h);
}

int main(int argc, char **argv)
{
	const unsigned flags = flags_of(argc, &argv, "--quick --list", 0, 2,
	                                "energy [--quick] VARIANTS FOLDER\n       energy --list");
	const double steps = flags & 1 ? 1e6 : 1e8;
	if (flags & 2) {
		list();
		return 0;
	}
	FILE *changes = table_open(argv[1], "energy_raw.csv",
		"case,method,family,real,step_s,steps,change,largest,word");
	FILE *decays = table_open(argv[1], "decay.csv", "method,family,real,step_s,steps,mode_rad_per_s,rate_per_s,"
	                          "measured_per_s,error_percent,word");
	for (int i = 0; i < TESTS; i++) {
		const struct test *of = &tests[i];
		char file[4096], method[64];
		struct code v = { of->name, method, of->real, file, atof(of->h) };
		snprintf(file, sizeof file, "%s/energy%d_0.so", argv[0], i);
		struct problem *p = problem_load(file, "energy", v.h, (int)steps, true, 0);
		measure_peers(p, &v, steps, changes, decays);
		for (int k = 1; k < FORMS; k++) {
			snprintf(file, sizeof file, "%s/energy%d_%d.so", argv[0], i, k);
			snprintf(method, sizeof method, "exact%s%s",
			         strcmp(of->real, "float") == 0 ? ", float" : "", forms[k].name);
			measure_ours(p, &v, steps, changes, decays);
		}
	}
	table_close(changes, "energy_raw.csv");
	table_close(decays, "decay.csv");
	return 0;
}
