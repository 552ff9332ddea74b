/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How large states and an output become over so many samples that they are not walked through. What a load sustains is
 * p lambda^m, lambda = e^{(a + i w) h}, with (lambda - Phi) p = b; what is left of the start rings in powers of Phi,
 * whose sums are bounded by those of two levels. No formula counts on how long it lasts. */
#include "inner.h"

#include <complex.h>
#include <math.h>

enum { WALKED = 30000000 };          /* operations of a walk through all samples */

bool is_lasting(const struct step_map *k, long steps)
{
	return (double)steps * (k->n * k->n + 32 * k->columns + 32) > WALKED;
}

/* ---- what a load sustains ---- */

static double complex root_of_forcing(const struct forcing_of_column *forcing, double h)
{
	return cexp((forcing->a + I * (forcing->turns ? forcing->w : 0)) * h);
}

static void find_defect(const struct step_map *k, double complex root, const double complex *b, const double complex *p,
			double *defect)
{
	const int n = k->n;
	for (int i = 0; i < n; i++) {
		double complex rest = root * p[i] - b[i];
		double size = cabs(p[i]) + cabs(b[i]);
		for (int j = 0; j < n; j++) {
			rest -= k->Phi[i * n + j] * p[j];
			size += fabs(k->Phi[i * n + j]) * cabs(p[j]);
		}
		defect[i] = cabs(rest) + (n + 8) * 0x1p-50 * size;
	}
}

/* The complex amplitude that the pair of columns from `column` sustains; defects are added. false: there is none, the
 * load grows as t, or is at a pole */
static bool sustained(const struct step_map *k, int column, double h, double complex *p, double *defect)
{
	const struct forcing_of_column *forcing = &k->forcing[column];
	const int n = k->n;
	const size_t cells = (size_t)n * (size_t)n;
	const double complex root = root_of_forcing(forcing, h), turn = forcing->turns ? cexp(I * forcing->p) : 1;
	SCRATCH double complex *A = ARRAY(double complex, cells), *b = ARRAY(double complex, n);
	SCRATCH double *own = ARRAY(double, n);
	double largest = 0;
	for (int i = 0; i < n; i++) {
		b[i] = turn * (k->load[i * k->columns + column] -
			       (forcing->turns ? I * k->load[i * k->columns + column + 1] : 0));
		p[i] = b[i];
		for (int j = 0; j < n; j++)
			A[i * n + j] = (i == j ? root : 0) - k->Phi[i * n + j];
	}
	solve_complex(n, A, p);                 /* where p is not finite, its defect is not */
	find_defect(k, root, b, p, own);
	for (int i = 0; i < n; i++)
		largest = own[i] <= largest ? largest : own[i];
	const bool good = forcing->power == 0 && isfinite(largest);
	for (int i = 0; i < n && good; i++)
		defect[i] += own[i] * k->amplitude[column];
	return good;
}

/* ---- over all samples ---- */

struct lasting {                    /* |x_i| <= most_ij |ringing_j| + sum_ij steady_j, and what loads sustain */
	const struct step_map *k;
	double *ringing, *steady;
	double complex *row;        /* per column: what its load sustains in the output, what it reads itself counted */
	double *size;               /* per state: sustained */
};

/* Of what sustains nothing: its force at each sample */
static void add_force(struct lasting *l, int column)
{
	const struct step_map *k = l->k;
	for (int i = 0; i < k->n; i++)
		l->steady[i] += fabs(k->load[i * k->columns + column]) * k->amplitude[column];
	l->row[column] = k->direct[column];
}

static struct lasting lasting_of(const struct step_map *k, double h)
{
	const size_t n = (size_t)k->n, columns = (size_t)k->columns;
	struct lasting l = { k, ARRAY(double, n), ARRAY(double, n), ARRAY(double complex, columns), ARRAY(double, n) };
	SCRATCH double complex *p = ARRAY(double complex, n);
	SCRATCH double *start = ARRAY(double, n);
	for (int i = 0; i < k->n; i++)
		start[i] = k->start[i];
	for (int c = 0, pair; c < k->columns; c += pair) {
		pair = k->forcing[c].turns ? 2 : 1;
		if (!sustained(k, c, h, p, l.steady)) {
			for (int j = 0; j < pair; j++)
				add_force(&l, c + j);
			continue;
		}
		const double complex turn = pair == 2 ? cexp(I * k->forcing[c].p) : 1;
		l.row[c] = turn * (k->direct[c] - (pair == 2 ? I * k->direct[c + 1] : 0));
		for (int i = 0; i < k->n; i++) {
			l.row[c] += k->row[i] * p[i];
			l.size[i] += cabs(p[i]) * k->amplitude[c];
			start[i] -= creal(p[i]);
		}
	}
	for (int i = 0; i < k->n; i++)
		l.ringing[i] = fabs(start[i]) * (1 + 1e-12) + l.size[i] * 1e-14;
	return l;
}

static void lasting_free(const struct lasting *l)
{
	discard(l->ringing);
	discard(l->steady);
	discard(l->row);
	discard(l->size);
}

double lasting_output(const struct step_map *k, const struct spread *spread, double h)
{
	const struct lasting l = lasting_of(k, h);
	SCRATCH double *sum = ARRAY(double, k->n), *most = ARRAY(double, k->n);
	double out = 0;
	reach_of_row(spread, k->Phi, k->row, false, sum, most);
	for (int c = 0; c < k->columns; c++)
		out += cabs(l.row[c]) * k->amplitude[c];
	for (int i = 0; i < k->n; i++)
		out += most[i] * l.ringing[i] + sum[i] * l.steady[i];
	lasting_free(&l);
	return out * (1 + 1e-9);
}

void lasting_sizes(const struct spread *spread, struct step_map *k, double h)
{
	const struct lasting l = lasting_of(k, h);
	for (int i = 0; i < k->n; i++) {
		double size = l.size[i];
		for (int j = 0; j < k->n; j++)
			size += spread->most[i * k->n + j] * l.ringing[j] + spread->sum[i * k->n + j] * l.steady[j];
		k->size[i] = size * (1 + 1e-9);
	}
	lasting_free(&l);
}

double lasting_input(const struct linear *system, const struct spread *spread, const struct step_map *k, int input,
		     int first)
{
	const int samples = system->input[input].hold + 1;
	SCRATCH double *sum = ARRAY(double, k->n), *most = ARRAY(double, k->n);
	double out = fabs(k->feed[0][input]);
	reach_of_row(spread, k->Phi, k->row, false, sum, most);
	for (int i = 0; i < k->n; i++)
		for (int c = first; c < first + samples; c++)
			out += sum[i] * fabs(k->input[i * k->inputs + c]);
	return out * k->most[first] * (1 + 1e-9);
}
