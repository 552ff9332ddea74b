/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Models with crossings, in the tables that the generator would emit, by Taylor series in long double. */
#include "runtime_switched.h"

double uniform(double lo, double hi)
{
	return lo + (hi - lo) * (double)(random_word() >> 11) * 0x1p-53;
}

int below(int n)
{
	return (int)uniform(0.0, n);
}

/* Memory of just the size used, for the sanitizers and valgrind */
static real *reals(int count)
{
	real *x = (real *)malloc(sizeof *x * (size_t)count);
	assert_non_null(x);
	memset(x, 0xFF, sizeof *x * (size_t)count);
	return x;
}

model *new_model(int states, int size, int switches)
{
	model *s = (model *)calloc(1, sizeof *s);
	assert_non_null(s);
	s->m.size = size;
	s->states = states;
	s->m.switches = switches;
	return s;
}

static void unbuild(model *s)
{
	free(s->A);
	free(s->Phi);
	free(s->tangent);
	free(s->chord_error);
	free(s->cubic_error);
	free(s->rungs);
	free(s->reach);
	free(s->work);
	free(s->crossing);
}

void free_model(model *s)
{
	unbuild(s);
	free(s);
}

/* ---- tables, by the Taylor series in long double ---- */

static void product(int n, const long double *a, const long double *b, long double *c)
{
	int i, j, k;
	for (i = 0; i < n; i++)
		for (j = 0; j < n; j++)
			for (c[i * n + j] = 0.0L, k = 0; k < n; k++)
				c[i * n + j] += a[i * n + k] * b[k * n + j];
}

/* e^{A tau}, or e^{|A| tau} */
void exponential(int n, const real *A, long double tau, int absolute, long double *E)
{
	long double P[N * N], Q[N * N], T[N * N];
	int i, k, squarings = 0, r;
	long double norm = 0.0L;
	for (i = 0; i < n * n; i++)
		norm += fabsl(A[i] * tau);
	while (norm > 0.5L)
		norm /= 2.0L, squarings++;
	for (i = 0; i < n * n; i++) {
		P[i] = (absolute ? fabsl((long double)A[i]) : A[i]) * tau / powl(2.0L, squarings);
		T[i] = E[i] = i % (n + 1) == 0;
	}
	for (k = 1; k <= 22; k++) {
		product(n, T, P, Q);
		for (i = 0; i < n * n; i++)
			E[i] += T[i] = Q[i] / k;
	}
	for (r = 0; r < squarings; r++) {
		product(n, E, E, Q);
		memcpy(E, Q, sizeof *E * (size_t)(n * n));
	}
}

/* max |pole| from above, to a few percent: |A^64|^(1/64) */
static double fastest(int n, const real *A)
{
	long double P[N * N], Q[N * N], norm, log_scale = 0.0L;
	int i, k;
	for (i = 0; i < n * n; i++)
		P[i] = A[i];
	for (k = 0; k <= 6; k++) {
		norm = 0.0L;
		for (i = 0; i < n * n; i++)
			norm += fabsl(P[i]);
		if (norm < 1e-300L)
			return 0.0; /* nilpotent */
		log_scale += logl(norm) / powl(2.0L, k);
		for (i = 0; i < n * n; i++)
			P[i] /= norm;
		product(n, P, P, Q);
		memcpy(P, Q, sizeof *P * (size_t)(n * n));
	}
	return (double)expl(log_scale);
}

/* row A^k e^{|A| h}, entrywise absolute, times factor */
static void bound(int n, const real *row, const real *A, int k, const long double *growth, double factor, real *found)
{
	long double v[N], w[N];
	int i, j;
	for (i = 0; i < n; i++)
		v[i] = row[i];
	for (; k > 0; k--) {
		for (j = 0; j < n; j++)
			for (w[j] = 0.0L, i = 0; i < n; i++)
				w[j] += v[i] * A[i * n + j];
		memcpy(v, w, sizeof v);
	}
	for (j = 0; j < n; j++) {
		w[j] = 0.0L;
		for (i = 0; i < n; i++)
			w[j] += fabsl(v[i]) * growth[i * n + j];
		found[j] = (real)(w[j] * factor * (1.0L + 8.0L * REAL_EPSILON));
	}
}

/* Pieces by e^{A d} - I where that is the smaller number, and what is off their chords as retuned models have it */
static void ladder_of(model *s, int r, double step)
{
	const int n = s->m.size, switches = s->m.switches;
	const real *A = s->A + r * n * n;
	real *rung = s->rungs + r * RUNGS * (n + 1) * n, *work = reals(PL_REACH_WORK(n, switches));
	long double E[N * N];
	int down, i, j;
	s->rung[r] = r * RUNGS;
	s->spacing[r] = s->halvings[r] > RUNGS ? (s->halvings[r] + RUNGS - 1) / RUNGS : 1 + r % 3;
	for (down = s->halvings[r]; down > 0; down -= s->spacing[r], rung += (n + 1) * n) {
		exponential(n, A, ldexp(step, -down), 0, E);
		for (i = 0; i < n; i++) {
			rung[n * n + i] = E[i * n + i] > 0.5L;
			E[i * n + i] -= rung[n * n + i];
			for (j = 0; j < n; j++)
				rung[i * n + j] = (real)E[i * n + j];
		}
	}
	pl_region_reach(n, s->m.h, s->halvings[r], s->spacing[r], A, switches, s->row,
					s->reach + r * RUNGS * switches * n, work);
	free(work);
}

static void tables_of(model *s, int r, double step)
{
	const int n = s->m.size;
	real *A = s->A + r * n * n;
	double most, h;
	long double E[N * N], growth[N * N];
	int i, j, k, code;
	for (j = 0; j < n * n; j++) {
		double sum = s->base[j];
		for (code = r, i = 0; i < s->m.switches; code /= s->breaks[i] + 1, i++)
			sum += s->add[i][code % (s->breaks[i] + 1)][j];
		A[j] = (real)sum;
	}
	most = fastest(n, A) * step;
	s->halvings[r] = most > 1.0 ? (int)ceil(log2(most)) : 0;
	h = ldexp(step, -s->halvings[r]);
	exponential(n, A, step, 0, E);
	for (j = 0; j < n * n; j++)
		s->Phi[r * n * n + j] = (real)E[j];
	ladder_of(s, r, step);
	exponential(n, A, h, 1, growth);
	for (i = 0; i < s->m.switches; i++) {
		const int at = (r * s->m.switches + i) * n;
		const real *row = s->row + i * n;
		for (j = 0; j < n; j++) {
			double sum = 0.0;
			for (k = 0; k < n; k++)
				sum += h / 3.0 * row[k] * A[k * n + j];
			s->tangent[at + j] = (real)sum;
		}
		bound(n, row, A, 2, growth, h * h / 8.0, s->chord_error + at);
		bound(n, row, A, 4, growth, h * h * h * h / 384.0, s->cubic_error + at);
	}
}

void build(model *s, double h)
{
	const int n = s->m.size, switches = s->m.switches;
	int i;
	unbuild(s);
	for (s->regions = 1, i = 0; i < switches; i++)
		s->regions *= s->breaks[i] + 1;
	s->A = reals(s->regions * n * n);
	s->Phi = reals(s->regions * n * n);
	s->tangent = reals(s->regions * n * switches);
	s->chord_error = reals(s->regions * n * switches);
	s->cubic_error = reals(s->regions * n * switches);
	s->rungs = reals(s->regions * RUNGS * (n + 1) * n);
	s->reach = reals(s->regions * RUNGS * switches * n);
	s->m.h = (real)h;
	for (i = 0; i < s->regions; i++) {
		s->matrix[i] = i;
		tables_of(s, i, (double)(real)h);
	}
	s->m.degree = DEGREE;
	s->m.row = s->row;
	s->m.breaks = s->breaks;
	s->m.at = s->at;
	s->m.matrix = s->matrix;
	s->m.A = s->A;
	s->m.Phi = s->Phi;
	s->m.tangent = s->tangent;
	s->m.chord_error = s->chord_error;
	s->m.cubic_error = s->cubic_error;
	s->m.halvings = s->halvings;
	s->m.ladder.first = s->rung;
	s->m.ladder.spacing = s->spacing;
	s->m.ladder.pieces = s->rungs;
	s->m.ladder.reach = s->reach;
	s->m.max_events = EVENTS;
	s->m.max_splits = SPLITS;
	s->work = reals(PL_SWITCHING_WORK(n, switches, s->m.degree));
	s->crossing = (pl_crossing *)malloc(sizeof *s->crossing * EVENTS);
	assert_non_null(s->crossing);
}

void start_here(model *s)
{
	memset(&s->c, 0xFF, sizeof s->c);
	pl_switching_start(&s->m, s->x, &s->c, s->work);
}

void start(model *s, const double *x)
{
	int i;
	for (i = 0; i < s->m.size; i++)
		s->x[i] = (real)x[i];
	start_here(s);
}

void step(model *s)
{
	pl_switching_step(&s->m, s->x, &s->c, s->crossing, s->work);
}

void steps(model *s, int n)
{
	while (n-- > 0)
		step(s);
}

void assert_near(double found, double expected, double tolerance, const char *what, double h)
{
	if (!(fabs(found - expected) <= COARSER * tolerance))
		fail_msg("%s, h = %g: found %.17g, expected %.17g, off by %.3g, tolerance %.3g", what, h, found,
				expected,
				 found - expected, COARSER * tolerance);
}

void assert_count(const model *s, uint64_t expected, const char *what, double at)
{
	if (s->c.total != expected || s->c.status != 0)
		fail_msg("%s at %g: %d crossings, status %d; expected %d and 0", what, at, (int)s->c.total, s->c.status,
				 (int)expected);
}

/* ---- models ---- */

/* q' = v; then 1, and cos w t, sin w t */
model *oscillator(int dof, int switches, double w)
{
	model *s = new_model(2 * dof, 2 * dof + 3, switches);
	const int n = s->m.size, one = 2 * dof;
	int i;
	for (i = 0; i < dof; i++)
		s->base[i * n + dof + i] = 1.0;
	s->base[(one + 1) * n + one + 2] = -w;
	s->base[(one + 2) * n + one + 1] = w;
	return s;
}

/* dof x dof entries of -M^-1 K or -M^-1 C into the rows of v' */
void couple(model *s, int column, int i, int j, double value)
{
	const int dof = s->states / 2;
	s->base[(dof + i) * s->m.size + column + j] += value;
}

/* In `interval` of switch i: v'_j -= k (e - b) */
void spring(model *s, int i, int interval, int j, double k, double b)
{
	const int dof = s->states / 2, n = s->m.size;
	double *to = s->add[i][interval] + (dof + j) * n;
	int l;
	for (l = 0; l < n; l++)
		to[l] -= k * s->row[i * n + l];
	to[2 * dof] += k * b;
}

/* One degree of freedom with a switch on q - a cos w t at the breakpoints */
model *single(double k, double c, double force, double w, double shaken, int breaks, double lo, double hi)
{
	model *s = oscillator(1, 1, w);
	couple(s, 0, 0, 0, -k);
	couple(s, 1, 0, 0, -c);
	couple(s, 2, 0, 0, force);
	s->row[0] = 1;
	s->row[3] = (real)-shaken;
	s->breaks[0] = breaks;
	s->at[0] = (real)lo;
	s->at[1] = (real)hi;
	return s;
}
