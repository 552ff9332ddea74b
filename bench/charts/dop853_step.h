/* SPDX-License-Identifier: GPL-3.0-or-later */
/* DOP853 for one right-hand side, compiled into it: included once a model (instances.h; `d` is the run). Loops over a
 * state's entries are unrolled where their number is a constant. */
#ifndef SIZE
#define SIZE (2 * COORDINATES)
#endif

#define EACH _Pragma("GCC unroll 4") for (int m = 0; m < SIZE; m++)
#define A(i, j) dop853_a[i][j] * k[j][m]
#define STAGE(i, SUM) \
	do { \
		EACH \
			x[m] = y[m] + h * (SUM); \
		SLOPES(t + dop853_c[i] * h, x, k[i]); \
	} while (0)
#define D(j) dop853_d[row][j] * k[j][m]

/* The interpolant of the step just taken, from y to `next`: three more stages. Their nest of factors: II.6 (6.20) */
static inline void INSTANCE(dense)(struct dop853 *d, double t, double h, const double *y, const double *next,
                                   double (*k)[2 * EXTENT])
{
	double x[2 * EXTENT];
	STAGE(14, A(14, 1) + A(14, 7) + A(14, 8) + A(14, 9) + A(14, 10) + A(14, 11) + A(14, 12) + A(14, 13));
	STAGE(15, A(15, 1) + A(15, 6) + A(15, 7) + A(15, 8) + A(15, 11) + A(15, 12) + A(15, 13) + A(15, 14));
	STAGE(16, A(16, 1) + A(16, 6) + A(16, 7) + A(16, 8) + A(16, 9) + A(16, 13) + A(16, 14) + A(16, 15));
	d->adaptive.run.asked += 3;
	EACH {
		const double across = next[m] - y[m], bend = h * k[1][m] - across;
		d->dense[0][m] = y[m];
		d->dense[1][m] = across;
		d->dense[2][m] = bend;
		d->dense[3][m] = across - h * k[13][m] - bend;
	}
	_Pragma("GCC unroll 4") for (int row = 0; row < DOP853_DENSE; row++)
		EACH
			d->dense[4 + row][m] = h * (D(1) + D(6) + D(7) + D(8) + D(9) + D(10) + D(11) + D(12) + D(13) +
			                            D(14) + D(15) + D(16));
}

/* A step from y, whose slope is k[1], to `next`; returns its weighted error */
INLINE double INSTANCE(try)(struct dop853 *d, double t, double h, const double *y, double *next,
                            double (*k)[2 * EXTENT])
{
	const double tolerance = d->tolerance, *scale = d->adaptive.scale;
	double x[2 * EXTENT];
	STAGE(2, A(2, 1));
	STAGE(3, A(3, 1) + A(3, 2));
	STAGE(4, A(4, 1) + A(4, 3));
	STAGE(5, A(5, 1) + A(5, 3) + A(5, 4));
	STAGE(6, A(6, 1) + A(6, 4) + A(6, 5));
	STAGE(7, A(7, 1) + A(7, 4) + A(7, 5) + A(7, 6));
	STAGE(8, A(8, 1) + A(8, 4) + A(8, 5) + A(8, 6) + A(8, 7));
	STAGE(9, A(9, 1) + A(9, 4) + A(9, 5) + A(9, 6) + A(9, 7) + A(9, 8));
	STAGE(10, A(10, 1) + A(10, 4) + A(10, 5) + A(10, 6) + A(10, 7) + A(10, 8) + A(10, 9));
	STAGE(11, A(11, 1) + A(11, 4) + A(11, 5) + A(11, 6) + A(11, 7) + A(11, 8) + A(11, 9) + A(11, 10));
	STAGE(12, A(12, 1) + A(12, 4) + A(12, 5) + A(12, 6) + A(12, 7) + A(12, 8) + A(12, 9) + A(12, 10) +
	          A(12, 11));
	double sum5 = 0.0, sum3 = 0.0;
	EACH {
		const double slope = A(13, 1) + A(13, 6) + A(13, 7) + A(13, 8) + A(13, 9) + A(13, 10) +
		                     A(13, 11) + A(13, 12);
		next[m] = y[m] + h * slope;
		const double over = 1.0 / (tolerance * (scale[m] + larger(fabs(y[m]), fabs(next[m]))));
		const double error3 = slope - dop853_error3[1] * k[1][m] - dop853_error3[9] * k[9][m] -
		                      dop853_error3[12] * k[12][m];
		double error5 = 0.0;
		_Pragma("GCC unroll 12") for (int j = 1; j <= DOP853_PLAIN; j++)
			if (j == 1 || j > 5)
				error5 += dop853_error5[j] * k[j][m];
		sum5 += error5 * over * (error5 * over);
		sum3 += error3 * over * (error3 * over);
	}
	d->adaptive.run.asked += 11;
	/* the error of order 5 where that of order 3 is not much larger: II.5 (5.27) */
	const double whole = sum5 + 0.01 * sum3;
	return whole > 0.0 ? h * sum5 / sqrt(SIZE * whole) : 0.0;
}

/* Until the end of a step is at `end` or after it */
static bool INSTANCE(advance)(struct dop853 *d, double end)
{
	double y[2 * EXTENT], next[2 * EXTENT], k[DOP853_STAGES + 1][2 * EXTENT];
	double t = d->t;
	bool rejected = false;
	EACH {
		y[m] = d->y[m];
		k[1][m] = d->slope[m];
	}
	for (int tries = MOST_STEPS; t < end;) {
		const double h = d->h;
		if (tries-- == 0 || t + 0.1 * h == t)
			return false;
		const double error = INSTANCE(try)(d, t, h, y, next, k);
		if (!isfinite(error))
			return false;
		const double shrink = larger(1.0 / 6.0, smaller(3.0, pow(error, 0.125) / 0.9));
		if (!(error <= 1.0)) {
			rejected = true;
			d->h = h / shrink;
			continue;
		}
		SLOPES(t + h, next, k[13]);
		d->adaptive.run.asked++;
		if (t + h >= end)
			INSTANCE(dense)(d, t, h, y, next, k);
		d->from = t;
		d->last = h;
		t += h;
		d->h = rejected ? smaller(h, h / shrink) : h / shrink;
		rejected = false;
		EACH {
			y[m] = next[m];
			k[1][m] = k[13][m];
		}
	}
	d->t = t;
	EACH {
		d->y[m] = y[m];
		d->slope[m] = k[1][m];
	}
	return true;
}

static inline bool INSTANCE(inside)(struct dop853 *d, double end, double *row)
{
	if (d->t < end && !INSTANCE(advance)(d, end))
		return false;
	const double s = d->last > 0.0 ? (end - d->from) / d->last : 0.0, r = 1.0 - s;
	double (*c)[MOST_ENTRIES] = d->dense;
	EACH
		row[m] = c[0][m] + s * (c[1][m] + r * (c[2][m] + s * (c[3][m] + r * (c[4][m] + s * (c[5][m] + r *
		         (c[6][m] + s * c[7][m]))))));
	return true;
}

static bool INSTANCE(reach)(struct adaptive *a, double end, double *row)
{
	return INSTANCE(inside)((struct dop853 *)a, end, row);
}

static bool INSTANCE(walk)(struct adaptive *a, int units, double *rows)
{
	struct dop853 *d = (struct dop853 *)a;
	const double unit = a->run.problem->unit;
	double kept[2 * EXTENT];
	long at = a->units;
	for (int u = 0; u < units; u++) {
		double *row = rows ? rows + (ptrdiff_t)u * SIZE : kept;
		if (!INSTANCE(inside)(d, (double)++at * unit, row))
			return false;
		if (u == units - 1)
			memcpy(a->now, row, SIZE * sizeof *row);
	}
	a->units = at;
	return all_finite(SIZE, a->now);
}

#undef EACH
#undef A
#undef STAGE
#undef D
#undef INSTANCE
#undef COORDINATES
#undef EXTENT
#undef SIZE
#undef SLOPES
#undef JACOBIAN
