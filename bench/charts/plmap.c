/* SPDX-License-Identifier: GPL-3.0-or-later */
/* plmap [--quick] VARIANTS FOLDER: the Piecewise-Laplace method with its coupling held (pl) against RK4 at the same
 * step, on two masses of 1 between walls, undamped, the first let go (wall -k1- m -k2- m -k3- wall): the ratio of
 * their largest displacement errors over w h and k2/k1, w = sqrt(k1/m), until 6 and 60 periods 2 pi/w, for equal walls
 * (k3 = k1) and for unequal ones (k3 = k1/2), in FOLDER/plmap_raw.csv. Errors are over the initial displacement, at the
 * ends of steps, in long double. Below 1: pl is the more accurate. FOLDER/plmap_check.csv: this step of pl beside the
 * generated code, on what variants.sh made in VARIANTS. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "charts.h"

typedef long double real;
enum { STATES = 4 };
typedef real matrix[STATES][STATES];

/* Masses of 1 */
struct chain { real k1, k2, k3; };

/* y' = A y, y = x1, x2, x1', x2' */
static void slopes(const struct chain *c, matrix A)
{
	memset(A, 0, sizeof(matrix));
	A[0][2] = A[1][3] = 1;
	A[2][0] = -(c->k1 + c->k2);
	A[3][1] = -(c->k2 + c->k3);
	A[2][1] = A[3][0] = c->k2;
}

/* Each mass on its own spring of stiffness own = (wall + k2), pushed by k2 times where the other was at the start of
 * the step */
static void pl_step(const struct chain *c, real h, matrix P)
{
	memset(P, 0, sizeof(matrix));
	for (int i = 0; i < 2; i++) {
		const real own = c->k2 + (i == 0 ? c->k1 : c->k3), w = sqrtl(own), half = sinl(w * h / 2);
		P[i][i] = P[i + 2][i + 2] = cosl(w * h);
		P[i][i + 2] = sinl(w * h) / w;
		P[i + 2][i] = -w * sinl(w * h);
		P[i][1 - i] = c->k2 * 2 * half * half / own;
		P[i + 2][1 - i] = c->k2 * sinl(w * h) / w;
	}
}

/* I + hA (I + hA/2 (I + hA/3 (I + hA/4))) */
static void rk4_step(const struct chain *c, real h, matrix P)
{
	matrix A, next;
	slopes(c, A);
	memset(P, 0, sizeof(matrix));
	for (int i = 0; i < STATES; i++)
		P[i][i] = 1;
	for (int order = 4; order >= 1; order--) {
		for (int i = 0; i < STATES; i++)
			for (int j = 0; j < STATES; j++) {
				next[i][j] = i == j;
				for (int k = 0; k < STATES; k++)
					next[i][j] += h / order * A[i][k] * P[k][j];
			}
		memcpy(P, next, sizeof next);
	}
}

static void advance(matrix P, real y[STATES])
{
	real next[STATES];
	for (int i = 0; i < STATES; i++)
		next[i] = P[i][0] * y[0] + P[i][1] * y[1] + P[i][2] * y[2] + P[i][3] * y[3];
	memcpy(y, next, sizeof next);
}

/* ---- the closed form: two modes of the symmetric stiffness matrix ---- */

/* x_i(t) = sum over modes of part[mode][i] cos(w t), from x = (1, 0) at rest */
struct modes { real w[2], part[2][2]; };

static struct modes modes_of(const struct chain *c)
{
	struct modes m;
	const real a = c->k1 + c->k2, d = c->k2 + c->k3, middle = (a + d) / 2, apart = hypotl((a - d) / 2, c->k2);
	m.w[1] = sqrtl(middle + apart);
	m.w[0] = sqrtl((a * d - c->k2 * c->k2) / (middle + apart));     /* det over the larger root: no cancellation */
	const real turn = atan2l(c->k2, (d - a) / 2) / 2;               /* the soft mode is (cos, sin) of it */
	m.part[0][0] = cosl(turn) * cosl(turn);
	m.part[0][1] = cosl(turn) * sinl(turn);
	m.part[1][0] = sinl(turn) * sinl(turn);
	m.part[1][1] = -m.part[0][1];
	return m;
}

/* ---- errors ---- */

static const real beyond = 1e9L;            /* times the initial displacement: diverged, looked at no further */
enum { PL, RK4, METHODS, HORIZONS = 2 };
static const int periods[HORIZONS] = { 6, 60 };

struct errors { real of[METHODS][HORIZONS]; };

static struct errors compare(const struct chain *c, real h)
{
	struct errors e = { 0 };
	struct modes m = modes_of(c);
	matrix P[METHODS];
	real y[METHODS][STATES] = { { 1 }, { 1 } }, worst[METHODS] = { 0 };
	const real period = 2 * acosl(-1) / sqrtl(c->k1);
	pl_step(c, h, P[PL]);
	rk4_step(c, h, P[RK4]);
	long step = 0;
	for (int horizon = 0; horizon < HORIZONS; horizon++) {
		for (; (real)(step + 1) * h <= periods[horizon] * period; step++) {
			const real t = (real)(step + 1) * h, soft = cosl(m.w[0] * t), stiff = cosl(m.w[1] * t);
			for (int k = 0; k < METHODS; k++) {
				if (worst[k] >= beyond)
					continue;
				advance(P[k], y[k]);
				for (int i = 0; i < 2; i++)
					worst[k] = fmaxl(worst[k],
					                 fabsl(y[k][i] - (m.part[0][i] * soft + m.part[1][i] * stiff)));
			}
		}
		for (int k = 0; k < METHODS; k++)
			e.of[k][horizon] = fminl(worst[k], beyond);
	}
	return e;
}

/* ---- the map ---- */

static const struct layout { const char *name; real k3; } layouts[] = { { "k3 = k1", 1 }, { "k3 = k1/2", 0.5L } };

/* A cell with what ends it; the word has its own end, which is a comma's or a line's */
static void put(FILE *csv, real x, bool is_word, const char *word)
{
	if (is_word)
		fputs(word, csv);
	else
		fprintf(csv, "%.5Lg%c", x, word[strlen(word) - 1]);
}

static void map_layout(FILE *csv, const struct layout *layout, int per_decade)
{
	for (int j = -4 * per_decade; j <= per_decade; j++)
		for (int i = -2 * per_decade; 2 * i <= per_decade; i++) {
			const real coupling = powl(10, (real)j / per_decade), wh = powl(10, (real)i / per_decade);
			const struct errors e = compare(&(struct chain){ 1, coupling, layout->k3 }, wh);
			for (int horizon = 0; horizon < HORIZONS; horizon++) {
				fprintf(csv, "%s,%d,%.5Lg,%.5Lg,", layout->name, periods[horizon], wh, coupling);
				const real pl = e.of[PL][horizon], rk4 = e.of[RK4][horizon];
				put(csv, pl, pl >= beyond, "diverged,");
				put(csv, rk4, rk4 >= beyond, "diverged,");
				put(csv, pl / rk4, pl >= beyond && rk4 >= beyond, "none\n");
			}
		}
}

/* ---- the generated code ---- */

static const struct point { const char *name; struct chain c; real h; } points[] = {
	{ "scs", { 100, 100, 100 }, 0.01L }, { "weak", { 4000, 40, 2000 }, 0.01L },
	{ "slow", { 1, 0.001L, 0.5L }, 0.1L },
	{ "fast", { 1, 0.1L, 1 }, 2 }, { "stiff", { 1, 8, 0.5L }, 1 },
};

/* Column by column: a step from a unit state */
static void check_point(FILE *csv, const struct point *point, const char *variants)
{
	double off = 0, largest = 0;
	matrix P;
	const pl_model *model = variant_model(variants, text("plmap_%s", point->name));
	void *state = calloc(1, model->size);
	pl_step(&point->c, point->h, P);
	for (int j = 0; j < STATES; j++) {
		double y[STATES] = { 0 };
		y[j] = 1;
		model->set(state, 0, y);
		model->step(state, NULL);
		model->get(state, y);
		for (int i = 0; i < STATES; i++) {
			off = fmax(off, (double)fabsl(y[i] - P[i][j]));
			largest = fmax(largest, (double)fabsl(P[i][j]));
		}
	}
	fprintf(csv, "%Lg,%Lg,%Lg,%Lg,%.3g\n", point->c.k1, point->c.k2, point->c.k3, point->h, off / largest);
	free(state);
}

int main(int argc, char **argv)
{
	const bool quick = flags_of(argc, &argv, "--quick", 2, 2, "plmap [--quick] VARIANTS FOLDER");
	FILE *csv = table_open(argv[1], "plmap_check.csv",
	                       "k1,k2,k3,h_s,largest_difference_of_generated_step_over_largest_entry");
	for (size_t i = 0; i < sizeof points / sizeof *points; i++)
		check_point(csv, &points[i], argv[0]);
	table_close(csv, "plmap_check.csv");
	csv = table_open(argv[1], "plmap_raw.csv",
	                 "layout,periods,w_h,coupling_k2_over_k1,error_pl,error_RK4,ratio_pl_over_RK4");
	for (size_t i = 0; i < sizeof layouts / sizeof *layouts; i++) {
		say_progress("plmap: %s", layouts[i].name);
		map_layout(csv, &layouts[i], quick ? 6 : 12);
	}
	table_close(csv, "plmap_raw.csv");
	return 0;
}
