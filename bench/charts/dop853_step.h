/* SPDX-License-Identifier: GPL-3.0-or-later */
/* DOP853 for one right-hand side, compiled into it: included once a model (instances.h; `d` is the run). Loops over a
 * state's entries are unrolled where their number is a constant. */
#ifndef SIZE
#define SIZE (2 * COORDINATES)
#endif

#define EACH _Pragma("GCC unroll 4") for (int m = 0; m < SIZE; m++)
/* row . k of the stages before one, its zeros left out: they are known when it is unrolled */
#define SUM_OF_STAGES(sum, row, before) \
	double sum = (row)[1] * k[1][m]; \
	_Pragma("GCC unroll 16") for (int j = 2; j < (before); j++) \
		if ((row)[j] != 0.0) \
			sum += (row)[j] * k[j][m];
#define STAGES(from, to) \
	_Pragma("GCC unroll 16") for (int i = (from); i <= (to); i++) { \
		EACH { \
			SUM_OF_STAGES(sum, dop853_a[i], i) \
			x[m] = y[m] + h * sum; \
		} \
		SLOPES(t + dop853_c[i] * h, x, k[i]); \
	}

/* The interpolant of the step just taken, from y to `next`: three more stages. Their nest of factors: II.6 (6.20) */
static inline void INSTANCE(dense)(struct dop853 *d, double t, double h, const double *y, const double *next,
								   double (*k)[2 * EXTENT])
{
	double x[2 * EXTENT];
	STAGES(14, 16)
	d->adaptive.run.asked += 3;
	EACH {
		const double across = next[m] - y[m], bend = h * k[1][m] - across;
		d->dense[0][m] = y[m];
		d->dense[1][m] = across;
		d->dense[2][m] = bend;
		d->dense[3][m] = across - h * k[13][m] - bend;
	}
	_Pragma("GCC unroll 4") for (int row = 0; row < DOP853_DENSE; row++)
		EACH {
			SUM_OF_STAGES(sum, dop853_d[row], DOP853_STAGES + 1)
			d->dense[4 + row][m] = h * sum;
		}
}

/* A step from y, whose slope is k[1], to `next`; returns its weighted error */
INLINE double INSTANCE(try)(struct dop853 *d, double t, double h, const double *y, double *next,
							double (*k)[2 * EXTENT])
{
	const double tolerance = d->tolerance, *scale = d->adaptive.scale;
	double x[2 * EXTENT];
	STAGES(2, DOP853_PLAIN)
	double sum5 = 0.0, sum3 = 0.0;
	EACH {
		SUM_OF_STAGES(slope, dop853_a[13], 13)
		next[m] = y[m] + h * slope;
		const double over = 1.0 / (tolerance * (scale[m] + larger(fabs(y[m]), fabs(next[m]))));
		const double error3 = slope - dop853_error3[1] * k[1][m] - dop853_error3[9] * k[9][m] -
		                      dop853_error3[12] * k[12][m];
		SUM_OF_STAGES(error5, dop853_error5, DOP853_PLAIN + 1)
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

static inline bool INSTANCE(reach)(struct adaptive *a, double end, double *row)
{
	struct dop853 *d = (struct dop853 *)a;
	if (d->t < end && !INSTANCE(advance)(d, end))
		return false;
	const double s = d->last > 0.0 ? (end - d->from) / d->last : 0.0, r = 1.0 - s;
	double (*c)[MOST_ENTRIES] = d->dense;
	EACH
		row[m] = c[0][m] + s * (c[1][m] + r * (c[2][m] + s * (c[3][m] + r * (c[4][m] + s * (c[5][m] + r *
		         (c[6][m] + s * c[7][m]))))));
	return true;
}

static bool INSTANCE(walk)(struct adaptive *a, int units, double *rows)
{
	const struct dop853 *d = (const struct dop853 *)a;
	(void)d;
	return walk_by(a, units, rows, SIZE, INSTANCE(reach));
}

#undef EACH
#undef SUM_OF_STAGES
#undef STAGES
#undef INSTANCE
#undef COORDINATES
#undef EXTENT
#undef SIZE
#undef SLOPES
#undef JACOBIAN
