/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Exact in regions, bisection, of the kept charts (clearance.c), for any model of regions. A, and where regions end,
 * are those of the tables that its C has, turned back to its states as written. And a matrix as constants in code,
 * compiled while the chart is made (literals.c). */
#include "own.h"
#include "../exponential.c"
#include "../literals.c"
#include "subject_regions.h"

#include <dlfcn.h>

#if REGIONS > 0
#include "subject_pl.c"

enum { SIZE = sizeof *subject_row / sizeof **subject_row, LEVELS = 28 + 9,
	   EXPRESSIONS = sizeof subject_breaks / sizeof *subject_breaks };
static double row[EXPRESSIONS][SIZE], generator[REGIONS][SIZE * SIZE], *Phi[REGIONS][LEVELS];

/* Of columns: x = T y, its inverse; of states kept otherwise than they are written */
static void turned(double *T, double *back)
{
	subject s;
	double y[N];
	for (int i = 0; i < SIZE; i++)
		T[i * SIZE + i] = back[i * SIZE + i] = 1.0;
	for (int j = 0; j < N; j++) {
		for (int i = 0; i < N; i++)
			y[i] = i == j;
		subject_set(&s, 0.0, y);
		for (int i = 0; i < N; i++)
			T[i * SIZE + j] = s.y[i];
	}
	for (int j = 0; j < N; j++) {
		for (int i = 0; i < N; i++)
			y[i] = 0.0;
		subject_set(&s, 0.0, y);
		s.y[j] = 1.0;
		subject_get(&s, y);
		for (int i = 0; i < N; i++)
			back[i * SIZE + j] = y[i];
	}
}

static void product(int rows, const double *a, const double *b, double *c)
{
	for (int i = 0; i < rows; i++)
		for (int j = 0; j < SIZE; j++) {
			c[i * SIZE + j] = 0.0;
			for (int k = 0; k < SIZE; k++)
				c[i * SIZE + j] += a[i * SIZE + k] * b[k * SIZE + j];
		}
}

bool has_regions(void)
{
	double T[SIZE * SIZE] = {0}, back[SIZE * SIZE] = {0}, half[SIZE * SIZE];
	turned(T, back);
	product(EXPRESSIONS, *subject_row, T, *row);
	for (int region = 0; region < REGIONS; region++)
		if (subject_matrix[region] >= 0) {
			product(SIZE, *subject_slopes[subject_matrix[region]], T, half);
			product(SIZE, back, half, generator[region]);
		}
	return true;
}

static int region_of(const double *z)
{
	const double *at = subject_breakpoint;
	int region = 0, stride = 1;
	for (int e = 0; e < EXPRESSIONS; at += subject_breaks[e++]) {
		double sum = 0.0;
		for (int i = 0; i < SIZE; i++)
			sum += row[e][i] * z[i];
		for (int b = 0; b < subject_breaks[e]; b++)
			region += (sum > at[b]) * stride;
		stride *= subject_breaks[e] + 1;
	}
	return region;
}

/* 2^-level of an output on: at once where it ends in the same region, else in halves; the least part may end in
 * another */
static void part(int *region, int level, int least, double *z)
{
	double **E = &Phi[*region][level], next[SIZE];
	if (!*E && (*E = malloc(sizeof generator[0])))
		rounded_exponential(SIZE, generator[*region], ldexp(history.every, -level), *E);
	for (int i = 0; i < SIZE; i++) {
		double sum = 0.0;
		for (int j = 0; j < SIZE; j++)
			sum += (*E)[i * SIZE + j] * z[j];
		next[i] = sum;
	}
	const int end = region_of(next);
	if (end == *region || level == least) {
		memcpy(z, next, sizeof next);
		*region = end;
		return;
	}
	part(region, level + 1, least, z);
	part(region, level + 1, least, z);
}

bool own_regions(double setting, double *rows)
{
	static const double loads[] = {LOADS_AT_0};
	const int steps = (int)setting, level = ilogb(setting), columns = sizeof loads / sizeof *loads;
	double z[SIZE];
	memcpy(z, history.start, sizeof history.start);
	memcpy(z + N, loads, sizeof loads);
	for (int k = 0, region = -1; k < history.units; k++, rows += N) {
		double *u = z + N + columns;
		for (int i = 0; i < INPUTS; i++) {
			const double *now = history.sample + (size_t)k * INPUTS + i;
			*u++ = *now;
			if (history.ramp[i])
				*u++ = (now[INPUTS] - *now) / history.every;
		}
		if (INPUTS > 0 || k == 0)
			region = region_of(z);
		for (int j = 0; j < steps; j++)
			part(&region, level, level + 27, z);
		memcpy(rows, z, N * sizeof *rows);
	}
	return isfinite(z[0]);
}
#else
bool has_regions(void)
{
	return false;
}

bool own_regions(double setting, double *rows)
{
	(void)setting, (void)rows;
	return false;
}
#endif

void *own_literals(int own, const double *Phi)
{
	const struct literals l = {.own = own, .size = own + 1, .steps = 1, .Phi = Phi};
	void *handle = literals_load(&l);
	return handle ? dlsym(handle, "advance") : NULL;
}
