/* SPDX-License-Identifier: GPL-3.0-or-later */
/* peers VARIANTS: the peers that are written in bench/charts are what they are called.
 *
 *   DOP853       its coefficients meet the order conditions of all 200 rooted trees to order 8, its interpolant those
 *                of the 85 to order 7, anywhere in a step
 *   Radau IIA    nodes and matrix meet Butcher's simplifying conditions B(2s - 1), C(s), by which the order is 2s - 1
 *   e^{A h}      by Pade's approximant, against its closed form
 *   equations    right-hand sides and Jacobians compiled into the peers are those of NAME_rhs and of its differences
 *   errors       of each peer, everywhere in a history, against its tolerance
 *
 * VARIANTS: what truths.sh made. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "adaptive.h"
#include "dop853_table.h"
#include "equations.h"
#include "tap.h"

/* ---- rooted trees: Hairer, Norsett, Wanner I, II.2 ---- */

enum { MOST_ORDER = 8, TREES = 200, STAGES = DOP853_STAGES };

struct tree {
	int order;
	double density;                         /* gamma */
	double phi[STAGES + 1];                 /* elementary weight at each stage */
};
static struct tree trees[TREES];
static int tree_count;

/* A phi(child) at each stage: what a branch is a factor of */
static void branch(const struct tree *child, double *factor)
{
	for (int i = 1; i <= STAGES; i++) {
		factor[i] = 0;
		for (int j = 1; j < i; j++)
			factor[i] += dop853_a[i][j] * child->phi[j];
	}
}

/* All multisets of trees from `least` on whose orders add up to `left`, onto the root that `so_far` is */
static void grow(struct tree so_far, int left, int least)
{
	double factor[STAGES + 1];
	if (left == 0) {
		if (tree_count < TREES)
			trees[tree_count] = so_far;
		tree_count++;
		return;
	}
	const int known = tree_count;
	for (int k = least; k < known && trees[k].order <= left; k++) {
		struct tree next = so_far;
		branch(&trees[k], factor);
		for (int i = 1; i <= STAGES; i++)
			next.phi[i] *= factor[i];
		next.density *= trees[k].density;
		grow(next, left - trees[k].order, k);
	}
}

static void make_trees(void)
{
	for (int order = 1; order <= MOST_ORDER; order++) {
		struct tree root = { .order = order, .density = order };
		for (int i = 1; i <= STAGES; i++)
			root.phi[i] = 1;
		grow(root, order - 1, 0);
	}
}

static double dot(const double *weights, const struct tree *t)
{
	double sum = 0;
	for (int i = 1; i <= STAGES; i++)
		sum += weights[i] * t->phi[i];
	return sum;
}

/* The interpolant's weights on the slopes at the part s of a step, over h */
static void weights_inside(double s, double *b)
{
	const double r = 1 - s;
	double across[STAGES + 1] = { 0 }, bend[STAGES + 1] = { 0 };
	for (int j = 1; j <= STAGES; j++) {
		across[j] = dop853_a[13][j];
		bend[j] = (j == 1) - across[j];
	}
	for (int j = 1; j <= STAGES; j++) {
		const double fourth = across[j] - (j == 13) - bend[j];
		const double inner = dop853_d[0][j] + s * (dop853_d[1][j] + r * (dop853_d[2][j] + s * dop853_d[3][j]));
		b[j] = s * (across[j] + r * (bend[j] + s * (fourth + r * inner)));
	}
}

static void check_dop853(void)
{
	double most = 0, most_inside = 0, most_row = 0, b[STAGES + 1];
	make_trees();
	ok(close_to(tree_count, TREES, 0, "rooted trees to order 8"), "200 rooted trees");
	for (int k = 0; k < tree_count && k < TREES; k++) {
		const struct tree *t = &trees[k];
		most = fmax(most, fabs(dot(dop853_a[13], t) - 1 / t->density));
		for (int part = 1; part < 8 && t->order <= 7; part++) {
			weights_inside(part / 8.0, b);
			most_inside = worse(most_inside, fabs(dot(b, t) - pow(part / 8.0, t->order) / t->density));
		}
	}
	for (int i = 2; i <= STAGES; i++) {
		double sum = 0;
		for (int j = 1; j < i; j++)
			sum += dop853_a[i][j];
		most_row = worse(most_row, fabs(sum - dop853_c[i]));
	}
	ok(close_to(most_row, 0, 1e-14, "largest difference of a row sum"), "DOP853: rows add up to the nodes");
	ok(close_to(most, 0, 2e-14, "largest residual"), "DOP853: order 8, by 200 conditions: %.1e", most);
	ok(close_to(most_inside, 0, 2e-14, "largest residual"), 
	   "DOP853: interpolant of order 7, by 85 conditions: %.1e", most_inside);
	double first = 0;
	for (int j = 1; j <= DOP853_PLAIN; j++)
		first += dop853_error5[j];
	ok(close_to(first, 0, 1e-15, "sum of the weights") &&
	   close_to(dop853_error3[1] + dop853_error3[9] + dop853_error3[12], 1, 1e-15, "sum of the weights"),
	   "DOP853: both errors are none of a constant slope");
}

static void check_radau(int s)
{
	double c[7], A[49], most = 0;
	radau_numbers(s, c, A);
	for (int k = 1; k <= 2 * s - 1; k++)
		for (int i = 0; i < s; i++) {
			double sum = 0;
			for (int j = 0; j < s; j++)
				sum += A[i * s + j] * pow(c[j], k - 1);
			if (k <= s || i == s - 1)
				most = fmax(most, fabs(sum - pow(c[i], k) / k));
		}
	ok(close_to(most, 0, 1e-14, "largest residual"), "Radau IIA, %d stages: order %d, by B(%d) and C(%d): %.1e", s,
	   2 * s - 1, 2 * s - 1, s, most);
	if (s == 3)
		ok(close_to(c[0], (4 - sqrt(6)) / 10, 1e-15, "first node") && close_to(c[2], 1, 0, "last node"),
		   "Radau IIA, 3 stages: the published nodes");
}

/* ---- the matrix exponential ---- */

/* Of a damped turn, known in closed form, at lengths that take no squaring, and some */
static void check_exponential(double length)
{
	const double w = 3, d = 0.1, A[4] = { -d, w, -w, -d };
	const double size = exp(-d * length), c = size * cos(w * length), s = size * sin(w * length);
	double E[4], off = NAN;
	if (pade_exponential(2, A, length, E))
		off = fmax(fmax(fabs(E[0] - c), fabs(E[3] - c)), fmax(fabs(E[1] - s), fabs(E[2] + s))) / size;
	ok(close_to(off, 0, 2e-15 * (1 + w * length), "error"), "e^{A h} by Pade, |A h| %g: error %.1e", w * length,
	   off);
}

/* ---- equations ---- */

struct equation {
	const char *name;
	int n;
	void (*slopes)(double t, const double *y, double *f);
	void (*jacobian)(double t, const double *y, double *Jq, double *Jv);
};
#define CALLABLE(NAME, N) \
static void NAME##_f(double t, const double *y, double *f) \
{ \
	NAME##_slopes(t, y, f); \
} \
static void NAME##_J(double t, const double *y, double *Jq, double *Jv) \
{ \
	NAME##_jacobian(t, y, Jq, Jv); \
}
EQUATIONS(CALLABLE)
#define ROW(NAME, N) { #NAME, N, NAME##_f, NAME##_J },
static const struct equation equations[] = { EQUATIONS(ROW) };

/* At states and times of a fixed sequence of numbers in [-1.5, 1.5] */
static void check_equation(const struct equation *e, const struct problem *p)
{
	const double h = 1e-6;
	double off = 0, off_J = 0, y[4], f[4], g[4], J[2][4], up[4], down[4];
	unsigned long seed = 12345;
	for (int turn = 0; turn < 50; turn++) {
		for (int i = 0; i < 2 * e->n; i++) {
			seed = seed * 6364136223846793005ul + 1442695040888963407ul;
			y[i] = (double)(seed >> 40) / (1ul << 24) * 3 - 1.5;
		}
		y[0] = fabs(y[0]) + 0.2;        /* off the pole of the spherical pendulum */
		e->slopes(0.37 * turn, y, f);
		problem_slope(p, 0.37 * turn, y, g);
		for (int i = 0; i < 2 * e->n; i++)
			off = worse(off, fabs(f[i] - g[i]) / (1 + fabs(g[i])));
		e->jacobian(0.37 * turn, y, J[0], J[1]);
		for (int j = 0; j < 2 * e->n; j++) {
			const double kept = y[j];
			y[j] = kept + h;
			problem_slope(p, 0.37 * turn, y, up);
			y[j] = kept - h;
			problem_slope(p, 0.37 * turn, y, down);
			y[j] = kept;
			for (int i = 0; i < e->n; i++) {
				const double by_hand = J[j / e->n][i * e->n + j % e->n];
				off_J = worse(off_J, fabs((up[e->n + i] - down[e->n + i]) / (2 * h) - by_hand) /
				             (1 + fabs(by_hand)));
			}
		}
	}
	ok(close_to(off, 0, 1e-13, "largest difference"), "%s: the peers' equations are NAME_rhs: %.1e", e->name, off);
	ok(close_to(off_J, 0, 1e-7, "largest difference"), "%s: their Jacobian is its differences': %.1e", e->name,
	   off_J);
}

/* ---- errors ---- */

/* At a tolerance, or with a step of a unit, everywhere, also between outputs */
static void check_error(const char *name, struct problem *p, const struct truth *t, double setting, double most)
{
	const struct method *m = method_find(name);
	struct run *run = m ? m->open(m, p, m->tolerance ? setting : p->unit) : NULL;
	const struct error e = run ? error_of(run, t) : (struct error){ .failed = true };
	const double found = e.failed ? NAN : e.largest;
	ok(close_to(found, 0, most, "largest error of %s", name),
	   "%s on %s at %g: error %.1e", name, p->name, setting, found);
	if (run)
		run->close(run);
}

static struct problem *load(const char *folder, const char *name, double unit, int units)
{
	char file[4096];
	snprintf(file, sizeof file, "%s/%s.so", folder, name);
	return problem_load(file, name, unit, units, false, 0);
}

static void check_errors(struct problem *p, const char *const *names, double setting, double most)
{
	struct truth *t = truth_of(p);
	for (; *names; names++)
		check_error(*names, p, t, setting, most);
	truth_free(t);
	problem_free(p);
}

/* Methods of fixed step that are compiled with their right-hand sides: twice the step, at ends of steps. And over
 * several units the same steps, with outputs inside that the polynomial of degree 5 gives */
static void check_orders(struct problem *p)
{
	struct truth *t = truth_of(p);
	for (const struct method *const *m = inlined_methods; *m; m++) {
		const int order = (*m)->order, parts = order == 2 ? 16 : order == 4 ? 4 : 1;
		double error[2] = { NAN, NAN };
		for (int k = 0; k < 2; k++) {
			const double coarse = order > 4 ? 4 * p->unit : p->unit / parts;
			struct run *run = (*m)->open(*m, p, coarse / (1 << k));
			double y[4], most = 0;
			for (int u = 0; u < p->units && run; u++) {
				run->advance(run, 1, y);
				for (int i = 0; i < 2 * p->n && u % 4 == 3; i++)
					most = fmax(most, fabs(y[i] - t->at_end[u * 2 * p->n + i]));
			}
			error[k] = most;
			if (run)
				run->close(run);
		}
		ok(close_to(log2(error[0] / error[1]), order, 0.35, "errors %.3g and %.3g: order", error[0], error[1]),
		   "%s on %s: order %d", (*m)->name, p->name, order);
	}
	truth_free(t);
	problem_free(p);
}

int main(int argc, char **argv)
{
	static const char *const all[] = { "DOP853", "RADAU5", "RADAU9", "RADAU13", "ARKODE DIRK", "GSL bsimp",
	                                  NULL };
	static const char *const stiff[] = { "RADAU5", "RADAU9", "RADAU13", NULL };
	static const char *const regions[] = { "CVODE Adams, roots", "exact in regions, bisection", NULL };
	if (argc != 2) {
		fputs("usage: peers VARIANTS\n", stderr);
		return 2;
	}
	check_dop853();
	for (int s = 3; s <= 7; s += 2)
		check_radau(s);
	check_exponential(0.01);
	check_exponential(1.5);
	check_exponential(20);
	for (size_t k = 0; k < sizeof equations / sizeof *equations; k++) {
		struct problem *p = load(argv[1], equations[k].name, 0.1, 10);
		check_equation(&equations[k], p);
		problem_free(p);
	}
	check_orders(load(argv[1], "pendulum", 0.1, 100));
	check_orders(load(argv[1], "henon_heiles", 0.1, 100));
	check_errors(load(argv[1], "pendulum", 0.1, 100), all, 1e-9, 3e-7);
	check_errors(load(argv[1], "mathieu", 0.1, 100), all, 1e-9, 3e-7);
	check_errors(load(argv[1], "duffing_pair", 0.1, 100), all, 1e-8, 3e-6);
	check_errors(load(argv[1], "vanderpol_stiff", 0.1, 1000), stiff, 1e-9, 1e-5);
	check_errors(load(argv[1], "beam4", 0.01, 100), stiff, 1e-6, 1e-4);
	check_errors(load(argv[1], "gear1", 0.1, 200), regions, 1e-12, 1e-9);
	check_errors(load(argv[1], "gear2", 0.1, 200), regions, 1e-12, 1e-9);
	check_errors(load(argv[1], "gear3", 0.01, 500), regions, 1e-12, 1e-8);
	return tap_end();
}
