/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The beams by Taylor series in quadruple precision. Its fastest mode turns 12 times as far in a step as the series'
 * terms need to begin to fall, so that some 70 terms are taken; w, which changes slowly, needs nine. */
#include "quad_beam.h"

#include <quadmath.h>
#include <stdlib.h>
#include <string.h>

enum { N = BEAM_N, ORDER = 120, SPEED_TERMS = 9, PARTS = 8 };

/* Matrix Market: coordinate real symmetric or general, or array real general; entries of `columns` columns */
static void read_matrix(const char *name, int columns, quad *entries)
{
	char file[100], line[400], text[100];
	snprintf(file, sizeof file, "models/beam/%s.mtx", name);
	FILE *f = fopen(file, "r");
	if (!f || !fgets(line, sizeof line, f))
		leave(file, "no Matrix Market file of a beam's matrix");
	const bool symmetric = strstr(line, " symmetric"), array = strstr(line, " array ");
	while (fgets(line, sizeof line, f) && line[0] == '%')
		continue;
	int rows, width, count;
	if (array) {
		count = sscanf(line, "%d %d", &rows, &width) == 2 && rows == N && width == columns ? rows * width : 0;
	} else if (sscanf(line, "%d %d %d", &rows, &width, &count) != 3 || rows != N || width != columns) {
		count = 0;
	}
	if (count == 0)
		leave(file, "no Matrix Market file of a beam's matrix");
	memset(entries, 0, (size_t)(N * columns) * sizeof *entries);
	for (int k = 0; k < count; k++) {
		int i = k % N + 1, j = k / N + 1;
		if (array ? fscanf(f, "%99s", text) != 1 : fscanf(f, "%d %d %99s", &i, &j, text) != 3)
			leave(file, "no Matrix Market file of a beam's matrix");
		if (i < 1 || i > N || j < 1 || j > columns)
			leave(file, "no Matrix Market file of a beam's matrix");
		entries[(i - 1) * columns + j - 1] = strtoflt128(text, NULL);
		if (symmetric)
			entries[(j - 1) * columns + i - 1] = entries[(i - 1) * columns + j - 1];
	}
	fclose(f);
}

/* Gauss and Jordan; M positive definite, destroyed */
static void invert(quad M[N][N], quad inverse[N][N])
{
	for (int i = 0; i < N; i++)
		for (int j = 0; j < N; j++)
			inverse[i][j] = i == j;
	for (int k = 0; k < N; k++) {
		const quad pivot = M[k][k];
		for (int j = 0; j < N; j++) {
			M[k][j] /= pivot;
			inverse[k][j] /= pivot;
		}
		for (int i = 0; i < N; i++) {
			const quad factor = M[i][k];
			for (int j = 0; j < N && i != k; j++) {
				M[i][j] -= factor * M[k][j];
				inverse[i][j] -= factor * inverse[k][j];
			}
		}
	}
}

const struct quad_beam *quad_beam_matrices(void)
{
	static struct quad_beam beam;
	static bool made;
	quad M[N][N];
	if (made)
		return &beam;
	read_matrix("M", N, &M[0][0]);
	read_matrix("K", N, &beam.K[0][0]);
	read_matrix("G", N, &beam.G[0][0]);
	read_matrix("D", N, &beam.DM[0][0]);
	read_matrix("fu", 1, beam.fu);
	read_matrix("fw", 1, beam.fw);
	for (int i = 0; i < N; i++)
		for (int j = 0; j < N; j++)
			beam.DM[i][j] -= M[i][j];
	invert(M, beam.inverse);
	made = true;
	return &beam;
}

/* ---- the series ---- */

/* A matrix's entries that are not zero, row after row */
struct sparse { int first[N + 1], column[N * N]; quad entry[N * N]; };

static void gather(struct sparse *s, const quad A[N][N])
{
	int count = 0;
	for (int i = 0; i < N; i++) {
		s->first[i] = count;
		for (int j = 0; j < N; j++)
			if (A[i][j] != 0) {
				s->column[count] = j;
				s->entry[count++] = A[i][j];
			}
	}
	s->first[N] = count;
}

static void apply(const struct sparse *s, const quad *x, quad *y)
{
	for (int i = 0; i < N; i++) {
		y[i] = 0;
		for (int k = s->first[i]; k < s->first[i + 1]; k++)
			y[i] += s->entry[k] * x[s->column[k]];
	}
}

/* Coefficients of (t - t0)^k h^k; after the spin-up w is constant: `terms` is 1 then */
struct speed { int terms; quad w[SPEED_TERMS], square[SPEED_TERMS], slope[SPEED_TERMS]; };

/* Om/T t - Om/(2 pi) sin(2 pi t/T), or Om */
static void speed_at(struct speed *s, quad Om, quad t, quad h)
{
	const quad T = 15, turn = 2 * M_PIq / T, sine = sinq(turn * t), cosine = cosq(turn * t);
	const quad wave[4] = { sine, cosine, -sine, -cosine };
	quad power = 1;
	memset(s, 0, sizeof *s);
	s->terms = t < T ? SPEED_TERMS : 1;
	if (t >= T) {
		s->w[0] = Om;
		s->square[0] = Om * Om;
		return;
	}
	for (int k = 0; k < SPEED_TERMS; k++) {
		s->w[k] = -Om / (2 * M_PIq) * wave[k % 4] * power;
		s->slope[k] = -Om / T * wave[(k + 1) % 4] * power;
		power *= turn * h / (k + 1);
	}
	s->w[0] += Om / T * t;
	s->w[1] += Om / T * h;
	s->slope[0] += Om / T;
	for (int k = 0; k < SPEED_TERMS; k++)
		for (int j = 0; j <= k; j++)
			s->square[k] += s->w[j] * s->w[k - j];
}

struct beam_series {
	struct sparse inverse, K, G, DM;
	quad q[ORDER + 1][N], v[ORDER + 1][N];                  /* of (t - t0)^k h^k */
	quad Gq[ORDER + 1][N], Gv[ORDER + 1][N], DMq[ORDER + 1][N];
};

static void next_coefficient(struct beam_series *x, const struct quad_beam *beam, const struct speed *s, quad h, int k)
{
	quad force[N], a[N];
	apply(&x->G, x->q[k], x->Gq[k]);
	apply(&x->G, x->v[k], x->Gv[k]);
	apply(&x->DM, x->q[k], x->DMq[k]);
	apply(&x->K, x->q[k], force);
	for (int i = 0; i < N; i++) {
		quad sum = -force[i];
		for (int j = 0; j < s->terms && j <= k; j++)
			sum -= s->square[j] * x->DMq[k - j][i] + 2 * s->w[j] * x->Gv[k - j][i] +
			       s->slope[j] * x->Gq[k - j][i];
		if (k < s->terms)
			sum += s->square[k] * beam->fu[i] - s->slope[k] * beam->fw[i];
		force[i] = sum;
	}
	apply(&x->inverse, force, a);
	for (int i = 0; i < N; i++) {
		x->q[k + 1][i] = h * x->v[k][i] / (k + 1);
		x->v[k + 1][i] = h * a[i] / (k + 1);
	}
}

static quad largest_of(const quad *x)
{
	quad most = 0;
	for (int i = 0; i < N; i++)
		most = fmaxq(most, fabsq(x[i]));
	return most;
}

/* y(t + h) into y. Terms until two of them no longer matter to the largest values so far. */
static void step(struct beam_series *x, const struct quad_beam *beam, quad Om, quad t, quad h, quad *y,
				 const quad *largest)
{
	struct speed s;
	int k = 0;
	speed_at(&s, Om, t, h);
	memcpy(x->q[0], y, sizeof x->q[0]);
	memcpy(x->v[0], y + N, sizeof x->v[0]);
	for (int small = 0; k < ORDER && (k <= SPEED_TERMS || small < 2); k++) {
		next_coefficient(x, beam, &s, h, k);
		const bool matters = largest_of(x->q[k + 1]) > 1e-30Q * largest[0] ||
		                     largest_of(x->v[k + 1]) > 1e-30Q * largest[1];
		small = matters ? 0 : small + 1;
	}
	if (k == ORDER)
		leave("quad_beam", "a series does not end");
	for (; k > 0; k--)
		for (int i = 0; i < N; i++) {
			y[i] += x->q[k][i];
			y[N + i] += x->v[k][i];
		}
}

static double speed_of(const struct problem *p)
{
	return strcmp(p->name, "beam4") == 0 ? 4 : strcmp(p->name, "beam15") == 0 ? 15 : 0;
}

bool quad_beam_has(const struct problem *p)
{
	return p->n == N && speed_of(p) > 0;
}

void quad_beam(const struct problem *p, struct truth *t)
{
	static struct beam_series x;
	const struct quad_beam *beam = quad_beam_matrices();
	const quad unit = exactly(p->unit), h = unit / PARTS;
	quad y[2 * N] = { 0 }, largest[2] = { 1e-3Q, 1e-3Q };
	gather(&x.inverse, beam->inverse);
	gather(&x.K, beam->K);
	gather(&x.G, beam->G);
	gather(&x.DM, beam->DM);
	for (int i = 0; i < 2 * N; i++)
		y[i] = exactly(p->start[i]);
	for (int k = 0; k < p->units; k++)
		for (int part = 0; part < PARTS; part++) {
			step(&x, beam, speed_of(p), (k + (quad)part / PARTS) * unit, h, y, largest);
			largest[0] = fmaxq(largest[0], largest_of(y));
			largest[1] = fmaxq(largest[1], largest_of(y + N));
			if (part + 1 != TRUTH_BETWEEN * PARTS && part + 1 != PARTS)
				continue;
			double *kept = (part + 1 == PARTS ? t->at_end : t->between) + k * 2 * N;
			for (int i = 0; i < 2 * N; i++)
				kept[i] = (double)y[i];
		}
	t->scale_q = (double)largest[0];
	t->scale_v = (double)largest[1];
}
