/* SPDX-License-Identifier: GPL-3.0-or-later */
/* convergence [--quick] VARIANTS FOLDER: how fast errors fall with the number N of intervals in 30 s, as Fang, Wang,
 * Dai and Zhang show it (Science Progress 2020): both readings of their method, pl (coupling held over an interval)
 * and exact (nothing held), beside Euler, the explicit trapezoid and RK4, in FOLDER/convergence.csv; slopes over the
 * range in FOLDER/convergence_orders.csv.
 *
 * The error is the largest of any displacement, over the initial displacement, at the ends of the 1000 intervals of
 * 0.03 s that every N has in common, until 30 s and until 0.6 s. VARIANTS holds what variants.sh made. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "charts.h"

enum { COMMON = 1000, HORIZONS = 2, MOST_N = 10 };
static const double whole = 30;                 /* [s] */
static const int horizons[HORIZONS] = { COMMON, COMMON / 50 }; /* 30 s and 0.6 s, in units of 0.03 s */

static const int all_intervals[] = { 1000, 2000, 3000, 5000, 7000, 10000, 14000, 20000, 50000, 100000, 0 };
static const int quick_intervals[] = { 1000, 2000, 5000, 20000, 0 };

static const struct { const char *name; double frequency; } systems[] = { { "scs", 0 }, { "sdcs", 0 }, { "sdcsf", 5 } };

static const struct method readings[] = {
	{ .name = "pl", .family = OURS, .linear_only = true, .order = 1,
	  .settings = "plgen --scheme pl: coupling held over each interval" },
	{ .name = "exact", .family = OURS, .linear_only = true, .order = 0,
	  .settings = "plgen --scheme exact: nothing held" },
};
static const char *const peers[] = { "explicit Euler", "explicit trapezoid", "RK4" };

/* Errors of one method on one system; infinite where the state left the finite numbers */
struct curve {
	const struct method *method;
	double error[HORIZONS][MOST_N];
	char *refused;
};

/* Below this an error is the rounding of a double's steps, and its slope says nothing. */
static const double rounding = 1e-12;

static struct run *open_run(const struct method *method, const struct problem *p, const char *variants, int n)
{
	char file[4096];
	if (method->family != OURS)
		return method->open(method, p, whole / n);
	snprintf(file, sizeof file, "%s/convergence_%s_%s_%d.so", variants, p->name, method->name, n);
	return generated_open(method, p, file);
}

static char *refusal(const struct method *method, const struct problem *p, const char *variants, int n)
{
	char file[4096];
	snprintf(file, sizeof file, "%s/convergence_%s_%s_%d.so", variants, p->name, method->name, n);
	return method->family == OURS ? variant_refused(file) : NULL;
}

static double largest_error(const struct problem *p, const struct truth *truth, const double *rows, int units)
{
	double worst = 0;
	for (int u = 0; u < units; u++)
		for (int i = 0; i < p->n; i++) {
			const double off = fabs(rows[u * 2 * p->n + i] - truth->at_end[u * 2 * p->n + i]);
			worst = off <= worst ? worst : isfinite(off) ? off : INFINITY;
		}
	return worst / fabs(p->start[0]);
}

static void follow(struct curve *curve, const struct problem *p, const struct truth *truth, const char *variants,
                   const int *intervals)
{
	double *rows = calloc((size_t)COMMON * 2 * (size_t)p->n, sizeof *rows);
	for (int k = 0; intervals[k]; k++) {
		struct run *run = open_run(curve->method, p, variants, intervals[k]);
		if (!run) {
			curve->refused = refusal(curve->method, p, variants, intervals[k]);
			fprintf(stderr, "convergence: %s, %s, N = %d: %s\n", p->name, curve->method->name, intervals[k],
				curve->refused ? curve->refused : "cannot");
			curve->error[0][k] = curve->error[1][k] = NAN;
			continue;
		}
		for (int i = 0; i < COMMON * 2 * p->n; i++)
			rows[i] = NAN;          /* what a run that gives up leaves */
		run->advance(run, COMMON, rows);
		for (int i = 0; i < HORIZONS; i++)
			curve->error[i][k] = largest_error(p, truth, rows, horizons[i]);
		run->close(run);
	}
	free(rows);
}

/* The order that errors at two numbers of intervals show; NAN where either is no error of the method. */
static double slope(const double *error, const int *intervals, int from, int to)
{
	if (!(error[from] > rounding && error[to] > rounding && isfinite(error[from]) && isfinite(error[to])))
		return NAN;
	return log(error[from] / error[to]) / log((double)intervals[to] / intervals[from]);
}

static void print_order(FILE *csv, const struct method *method, double order)
{
	if (isfinite(order))
		fprintf(csv, "%.3f", order);
	else
		fputs(method->order == 0 ? "rounding" : "none", csv);
}

static void write_curve(FILE *csv, const struct curve *curve, const char *system, const int *intervals)
{
	for (int i = 0; i < HORIZONS; i++)
		for (int k = 0; intervals[k]; k++) {
			const double error = curve->error[i][k];
			fprintf(csv, "%s,%g,%d,%.6g,%s,", system, whole * horizons[i] / COMMON, intervals[k],
				whole / intervals[k], curve->method->name);
			if (isnan(error))
				fputs("refused,none", csv);
			else if (isinf(error))
				fputs("diverged,none", csv);
			else
				fprintf(csv, "%.6g,", error);
			if (isfinite(error) && k > 0)
				print_order(csv, curve->method, slope(curve->error[i], intervals, k - 1, k));
			fprintf(csv, ",\"%s\"\n", curve->refused ? curve->refused : curve->method->settings);
		}
}

/* The last: between the two largest N. */
static void write_orders(FILE *csv, const struct curve *curve, const char *system, const int *intervals)
{
	int count = 0;
	while (intervals[count])
		count++;
	for (int i = 0; i < HORIZONS; i++) {
		fprintf(csv, "%s,%g,%s,", system, whole * horizons[i] / COMMON, curve->method->name);
		if (curve->method->order)
			fprintf(csv, "%d,", curve->method->order);
		else
			fputs("exact,", csv);
		print_order(csv, curve->method, slope(curve->error[i], intervals, 0, count - 1));
		fputc(',', csv);
		print_order(csv, curve->method, slope(curve->error[i], intervals, count - 2, count - 1));
		fputc('\n', csv);
	}
}

static void converge(const char *system, double frequency, const char *variants, const int *intervals, FILE *csv,
                     FILE *orders)
{
	char file[4096];
	snprintf(file, sizeof file, "%s/convergence_%s_exact_%d.so", variants, system, intervals[0]);
	struct problem *p = problem_load(file, system, whole / COMMON, COMMON, true, frequency);
	struct truth *truth = truth_of(p);
	const struct method *methods[5] = { &readings[0], &readings[1] };
	for (int i = 0; i < 3; i++)
		methods[2 + i] = method_find(peers[i]);
	for (int i = 0; i < 5; i++) {
		struct curve curve = { .method = methods[i] };
		say_progress("convergence: %s, %s", system, methods[i]->name);
		follow(&curve, p, truth, variants, intervals);
		write_curve(csv, &curve, system, intervals);
		write_orders(orders, &curve, system, intervals);
		free(curve.refused);
	}
	problem_free(p);
}

static FILE *create(const char *folder, const char *name)
{
	char file[4096];
	snprintf(file, sizeof file, "%s/%s", folder, name);
	FILE *f = fopen(file, "w");
	if (!f) {
		perror(file);
		exit(1);
	}
	return f;
}

static void finish(FILE *f)
{
	if (ferror(f) || fclose(f) != 0) {
		perror("convergence");
		exit(1);
	}
}

int main(int argc, char **argv)
{
	const bool quick = argc > 1 && strcmp(argv[1], "--quick") == 0;
	if (argc != 3 + quick) {
		fputs("usage: convergence [--quick] VARIANTS FOLDER\n", stderr);
		return 2;
	}
	const char *variants = argv[1 + quick], *folder = argv[2 + quick];
	FILE *csv = create(folder, "convergence.csv"), *orders = create(folder, "convergence_orders.csv");
	fputs("system,horizon_s,intervals_in_30_s,h_s,method,error_over_initial_displacement,order_since_last,"
	      "settings\n", csv);
	fputs("system,horizon_s,method,order_expected,order_over_range,order_at_last\n", orders);
	for (size_t i = 0; i < sizeof systems / sizeof *systems; i++)
		converge(systems[i].name, systems[i].frequency, variants, quick ? quick_intervals : all_intervals, csv,
		         orders);
	finish(csv);
	finish(orders);
	return 0;
}
