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

#include "charts.h"

enum { COMMON = 1000, HORIZONS = 2, MOST_N = 10, METHODS = 5 };
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

/* Errors of one method on one system; infinite where the state left the finite numbers */
struct curve {
	const struct method *method;
	double error[HORIZONS][MOST_N];
	char *refused;
};

/* Below this an error is the rounding of a double's steps, and its slope says nothing. */
static const double rounding = 1e-12;

static void follow(struct curve *curve, const struct problem *p, const struct truth *truth, const char *variants,
				   const int *intervals)
{
	const struct method *method = curve->method;
	const bool ours = method->family == OURS;
	for (int k = 0; intervals[k]; k++) {
		const char *file = text("%s/convergence_%s_%s_%d.so", variants, p->name, method->name, intervals[k]);
		struct run *run = ours ? generated_open(method, p, file) : method->open(method, p,
			whole / intervals[k]);
		if (!run) {
			curve->refused = ours ? variant_refused(file) : NULL;
			fprintf(stderr, "convergence: %s, %s, N = %d: %s\n", p->name, method->name, intervals[k],
				curve->refused ? curve->refused : "cannot");
			curve->error[0][k] = curve->error[1][k] = NAN;
			continue;
		}
		double *rows = history_rows(run, COMMON);
		for (int i = 0; i < HORIZONS; i++)
			curve->error[i][k] = largest_off(p->n, p->n, rows, truth->at_end, horizons[i]) /
				fabs(p->start[0]);
		run->close(run);
		free(rows);
	}
}

/* The order that errors at two numbers of intervals show */
static void print_order(FILE *csv, const struct curve *curve, int horizon, const int *intervals, int from, int to)
{
	const double *e = curve->error[horizon];
	if (e[from] > rounding && e[to] > rounding && isfinite(e[from]) && isfinite(e[to]))
		fprintf(csv, "%.3f", log(e[from] / e[to]) / log((double)intervals[to] / intervals[from]));
	else    /* either is no error of the method */
		fputs(curve->method->order == 0 ? "rounding" : "none", csv);
}

static void write_curve(FILE *csv, const struct curve *curve, const char *system, const int *intervals)
{
	for (int i = 0; i < HORIZONS; i++)
		for (int k = 0; intervals[k]; k++) {
			const double error = curve->error[i][k];
			fprintf(csv, "%s,%g,%d,%.6g,%s,", system, whole * horizons[i] / COMMON, intervals[k],
				whole / intervals[k], curve->method->name);
			put_number(csv, "%.6g", error, isnan(error) ? "refused" : "diverged");
			if (!isfinite(error))
				fputs("none", csv);
			else if (k > 0)
				print_order(csv, curve, i, intervals, k - 1, k);
			fputc('\n', csv);
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
		put_number(csv, "%g", curve->method->order ? curve->method->order : NAN, "exact");
		print_order(csv, curve, i, intervals, 0, count - 1);
		fputc(',', csv);
		print_order(csv, curve, i, intervals, count - 2, count - 1);
		fprintf(csv, ",\"%s\"\n", curve->refused ? curve->refused : curve->method->settings);
	}
}

static void converge(const char *system, double frequency, const char *variants, const int *intervals, FILE *csv,
					 FILE *orders)
{
	struct problem *p = problem_load(text("%s/convergence_%s_exact_%d.so", variants, system, intervals[0]), system,
	                                 whole / COMMON, COMMON, true, frequency);
	struct truth *truth = truth_of(p);
	const struct method *methods[METHODS] = { &readings[0], &readings[1], method_find("explicit Euler"),
	                                          method_find("explicit trapezoid"), method_find("RK4") };
	for (int i = 0; i < METHODS; i++) {
		struct curve curve = { .method = methods[i] };
		say_progress("convergence: %s, %s", system, methods[i]->name);
		follow(&curve, p, truth, variants, intervals);
		write_curve(csv, &curve, system, intervals);
		write_orders(orders, &curve, system, intervals);
		free(curve.refused);
	}
	problem_free(p);
}

int main(int argc, char **argv)
{
	const bool quick = flags_of(argc, &argv, "--quick", 2, 2, "convergence [--quick] VARIANTS FOLDER");
	FILE *csv = table_open(argv[1], "convergence.csv", "system,horizon_s,intervals_in_30_s,h_s,method,"
	                       "error_over_initial_displacement,order_since_last");
	FILE *orders = table_open(argv[1], "convergence_orders.csv",
	                          "system,horizon_s,method,order_expected,order_over_range,order_at_last,settings");
	for (size_t i = 0; i < sizeof systems / sizeof *systems; i++)
		converge(systems[i].name, systems[i].frequency, argv[0], quick ? quick_intervals : all_intervals, csv,
		         orders);
	table_close(csv, "convergence.csv");
	table_close(orders, "convergence_orders.csv");
	return 0;
}
