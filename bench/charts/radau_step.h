/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Radau IIA for one right-hand side, compiled into it: included once a model (instances.h; `d` is the run). The number
 * of stages s is a constant wherever these functions are inlined. */

#define EACH _Pragma("GCC unroll 4") for (int m = 0; m < COORDINATES; m++)
#define STAGES(i) _Pragma("GCC unroll 8") for (int i = 0; i < s; i++)

/* By forward differences; of entries of the state from `first` on, of others 0 */
INLINE void INSTANCE(differences)(struct radau *d, const int first)
{
	const int n = COORDINATES, size = 2 * n;
	double moved[2 * EXTENT], f[2 * EXTENT];
	memcpy(moved, d->y, (size_t)size * sizeof *moved);
	for (int j = first; j < size; j++) {
		volatile double sum = d->y[j] + sqrt(DBL_EPSILON) * (d->adaptive.scale[j] + fabs(d->y[j]));
		moved[j] = sum;
		SLOPES(d->t, moved, f);
		d->adaptive.run.asked++;
		for (int i = 0; i < n; i++)
			(j < n ? d->Jq : d->Jv)[i * n + j % n] = (f[n + i] - d->slope[n + i]) / (sum - d->y[j]);
		moved[j] = d->y[j];
	}
}

/* (I - h mu Jv - h^2 mu^2 Jq) of each eigenvalue, factored */
INLINE void INSTANCE(factor)(struct radau *d, double h, const int s)
{
	const struct radau_table *table = d->table;
	const double g = h * table->real;
	const int n = COORDINATES;
	for (int i = 0; i < n * n; i++)
		d->matrix[i] = (i % (n + 1) == 0) - g * d->Jv[i] - g * g * d->Jq[i];
	factor_real(n, d->matrix, d->row);
	for (int k = 0; k < s / 2; k++) {
		const double complex z = h * table->pair[k];
		for (int i = 0; i < n * n; i++)
			d->complex_matrix[k][i] = (i % (n + 1) == 0) - z * d->Jv[i] - z * z * d->Jq[i];
		factor_complex(n, d->complex_matrix[k], d->complex_row[k]);
	}
}

/* What the accelerations K lack at the stages; the last stage's state into `end` */
INLINE void INSTANCE(residual)(struct radau *d, double h, const double *y, double K[][EXTENT], double r[][EXTENT],
							   double *end, const int s)
{
	const struct radau_table *table = d->table;
	double x[2 * EXTENT], f[2 * EXTENT];
	STAGES(i) {
		EACH {
			double sum = 0.0, sum2 = 0.0;
			STAGES(j) {
				sum += table->A[i][j] * K[j][m];
				sum2 += table->A2[i][j] * K[j][m];
			}
			x[m] = y[m] + h * (table->c[i] * y[COORDINATES + m] + h * sum2);
			x[COORDINATES + m] = y[COORDINATES + m] + h * sum;
		}
		SLOPES(d->t + table->c[i] * h, x, f);
		EACH
			r[i][m] = f[COORDINATES + m] - K[i][m];
	}
	EACH {
		end[m] = x[m];
		end[COORDINATES + m] = x[COORDINATES + m];
	}
	d->adaptive.run.asked += s;
}

/* r becomes the correction of K: by eigenvectors of A, a system for each eigenvalue */
INLINE void INSTANCE(solve)(struct radau *d, double r[][EXTENT], const int s)
{
	const struct radau_table *table = d->table;
	double right[EXTENT], x[EXTENT];
	double complex turned[RADAU_MOST / 2][EXTENT], z[RADAU_MOST / 2][EXTENT];
	EACH {
		double sum = 0.0;
		STAGES(i)
			sum += table->real_left[i] * r[i][m];
		right[m] = sum;
		for (int k = 0; k < s / 2; k++) {
			double complex turn = 0.0;
			STAGES(i)
				turn += table->left[k][i] * r[i][m];
			turned[k][m] = turn;
		}
	}
	solve_real(COORDINATES, d->matrix, d->row, right, x);
	for (int k = 0; k < s / 2; k++)
		solve_complex(COORDINATES, d->complex_matrix[k], d->complex_row[k], turned[k], z[k]);
	STAGES(i)
		EACH {
			double sum = table->real_right[i] * x[m];
			for (int k = 0; k < s / 2; k++)
				sum += 2.0 * (creal(table->right[k][i]) * creal(z[k][m]) -
				              cimag(table->right[k][i]) * cimag(z[k][m]));
			r[i][m] = sum;
		}
}

/* Accelerations to begin with: those of the last step's polynomial, or the one at the start */
INLINE void INSTANCE(predict)(struct radau *d, double h, double K[][EXTENT], const int s)
{
	STAGES(i) {
		const double theta = 1.0 + d->table->c[i] * h / d->last;
		EACH {
			double sum = 0.0;
			for (int k = s - 1; k >= 0; k--)
				sum = sum * theta + d->poly[k][m];
			K[i][m] = d->last > 0.0 ? sum : d->slope[COORDINATES + m];
		}
	}
}

/* Filtered by the real eigenvalue's system: IV.8 (8.19), (8.20); `slope` is that at the start */
INLINE double INSTANCE(error)(struct radau *d, double h, const double *y, const double *end, double K[][EXTENT],
							  const double *slope, double *error, const int s)
{
	const struct radau_table *table = d->table;
	const double g = h * table->real;
	double rq[EXTENT], rv[EXTENT], right[EXTENT], total = 0.0;
	EACH {
		double sum = 0.0, sum2 = 0.0;
		STAGES(i) {
			double above = 0.0;     /* the velocity of the stage, less that at the start */
			STAGES(j)
				above += table->A[i][j] * K[j][m];
			sum += table->error[i] * K[i][m];
			sum2 += table->error[i] * above;
		}
		/* the error weights of the stages sum to minus that of the start */
		rq[m] = g * (slope[m] - y[COORDINATES + m]) + h * h * sum2;
		rv[m] = g * slope[COORDINATES + m] + h * sum;
	}
	EACH {
		double sum = rv[m];
		for (int j = 0; j < COORDINATES; j++)
			sum += g * d->Jq[m * COORDINATES + j] * rq[j];
		right[m] = sum;
	}
	solve_real(COORDINATES, d->matrix, d->row, right, error + COORDINATES);
	EACH
		error[m] = rq[m] + g * error[COORDINATES + m];
	for (int m = 0; m < 2 * COORDINATES; m++) {
		const double weight = d->adaptive.scale[m] + larger(fabs(y[m]), fabs(end[m]));
		const double share = error[m] / (d->tolerance * weight);
		total += share * share;
	}
	return sqrt(total / (2 * COORDINATES));
}

INLINE void INSTANCE(keep)(struct radau *d, double h, double K[][EXTENT], const double *end, const int s)
{
	const struct radau_table *table = d->table;
	for (int k = 0; k < s; k++)
		EACH {
			double sum = 0.0;
			STAGES(i)
				sum += table->W[k][i] * K[i][m];
			d->poly[k][m] = sum;
		}
	for (int m = 0; m < 2 * COORDINATES; m++) {
		d->start[m] = d->y[m];
		d->y[m] = end[m];
	}
	d->from = d->t;
	d->last = h;
	d->t += h;
}

/* Simplified Newton; returns iterations, 0 where it does not converge: then d->h is what to try */
INLINE int INSTANCE(newton)(struct radau *d, double h, double K[][EXTENT], double *end, const int s)
{
	const int most = 7 + (s - 3) * 5 / 2;           /* as RADAU: 7, 12, 17 */
	double r[RADAU_MOST][EXTENT], before = 0.0, ratio = 0.0, weight[EXTENT];
	const double *y = d->y;
	EACH {
		const double q = d->tolerance * (d->adaptive.scale[m] + fabs(y[m]));
		const double v = d->tolerance * (d->adaptive.scale[COORDINATES + m] + fabs(y[COORDINATES + m]));
		weight[m] = larger(h / v, 0.5 * h * h / q);
	}
	d->factor_of_contraction = pow(larger(d->factor_of_contraction, 2.2e-16), 0.8);
	d->contraction = 0.001;
	for (int newt = 0; newt < most; newt++) {
		INSTANCE(residual)(d, h, y, K, r, end, s);
		INSTANCE(solve)(d, r, s);
		double now = 0.0;
		STAGES(i)
			EACH {
				now += r[i][m] * weight[m] * (r[i][m] * weight[m]);
				K[i][m] += r[i][m];
			}
		now = sqrt(now / (s * COORDINATES));
		if (!isfinite(now))
			break;
		if (newt > 0) {
			const double last = ratio;
			ratio = now / before;
			d->contraction = newt == 1 ? ratio : sqrt(ratio * last);
			if (!(d->contraction < 0.99))
				break;
			d->factor_of_contraction = d->contraction / (1.0 - d->contraction);
			const double to_come = d->factor_of_contraction * now *
			                       pow(d->contraction, most - 2 - newt) / d->newton_tolerance;
			if (to_come >= 1.0) {
				d->h = h * 0.8 * pow(smaller(20.0, to_come), -1.0 / (4 + most - 2 - newt));
				return 0;
			}
		}
		before = larger(now, 1e-300);
		if (d->factor_of_contraction * now <= d->newton_tolerance) {
			/* the end with the last correction in it */
			EACH {
				double sum = 0.0, sum2 = 0.0;
				STAGES(j) {
					sum += d->table->A[s - 1][j] * K[j][m];
					sum2 += d->table->A2[s - 1][j] * K[j][m];
				}
				end[m] = y[m] + h * (y[COORDINATES + m] + h * sum2);
				end[COORDINATES + m] = y[COORDINATES + m] + h * sum;
			}
			return newt + 1;
		}
	}
	d->h = 0.5 * h;
	return 0;
}

/* Until the end of a step is at `limit` or after it. The step control is IV.8's, with Gustafsson's prediction. */
INLINE bool INSTANCE(advance)(struct radau *d, double limit, const int s)
{
	const int most = 7 + (s - 3) * 5 / 2;
	double K[RADAU_MOST][EXTENT], end[2 * EXTENT], error[2 * EXTENT];
	for (int tries = MOST_STEPS; d->t < limit;) {
		const double h = d->h;
		if (tries-- == 0 || d->t + 0.1 * h == d->t || !isfinite(h))
			return false;
		if (!d->jacobian_is_new && !d->keeps_jacobian) {
			JACOBIAN(d->t, d->y, d->Jq, d->Jv);
			d->jacobian_is_new = true;
			d->factored = 0.0;
		}
		if (d->factored != h) {
			INSTANCE(factor)(d, h, s);
			d->factored = h;
		}
		INSTANCE(predict)(d, h, K, s);
		const int iterations = INSTANCE(newton)(d, h, K, end, s);
		if (iterations == 0) {
			d->keeps_jacobian = d->jacobian_is_new;
			d->rejected = true;
			if (!d->keeps_jacobian)
				d->factor_of_contraction = 1.0;
			continue;
		}
		double size = INSTANCE(error)(d, h, d->y, end, K, d->slope, error, s);
		if (size >= 1.0 && (d->first || d->rejected)) {
			double moved[2 * EXTENT], there[2 * EXTENT];
			for (int m = 0; m < 2 * COORDINATES; m++)
				moved[m] = d->y[m] + error[m];
			SLOPES(d->t, moved, there);
			d->adaptive.run.asked++;
			size = INSTANCE(error)(d, h, d->y, end, K, there, error, s);
		}
		size = larger(1e-10, size);
		const double safe = smaller(0.9, 0.9 * (1 + 2 * most) / (iterations + 2 * most));
		double shrink = larger(0.125, smaller(5.0, pow(size, 1.0 / (s + 1)) / safe));
		if (!(size < 1.0)) {
			d->rejected = true;
			d->h = d->first ? 0.1 * h : h / shrink;
			d->keeps_jacobian = d->jacobian_is_new;
			continue;
		}
		if (!d->first) {
			const double ahead = d->accepted_h / h * pow(size * size / d->accepted_error, 1.0 / (s + 1));
			shrink = larger(shrink, larger(0.125, smaller(5.0, ahead / 0.9)));
		}
		d->accepted_h = h;
		d->accepted_error = larger(1e-2, size);
		INSTANCE(keep)(d, h, K, end, s);
		SLOPES(d->t, d->y, d->slope);
		d->adaptive.run.asked++;
		double next = h / shrink;
		if (d->rejected)
			next = smaller(next, h);
		d->first = d->rejected = false;
		d->keeps_jacobian = d->contraction <= 0.001;
		d->jacobian_is_new = false;
		if (!(d->keeps_jacobian && shrink <= 1.0 && next <= 1.2 * h))
			d->h = next;
	}
	return true;
}

INLINE bool INSTANCE(inside)(struct radau *d, double at, double *row, const int s)
{
	if (d->t < at && !INSTANCE(advance)(d, at, s))
		return false;
	const double theta = d->last > 0.0 ? (at - d->from) / d->last : 0.0, h = d->last;
	EACH {
		double sum = 0.0, sum2 = 0.0;
		_Pragma("GCC unroll 8") for (int k = s - 1; k >= 0; k--) {
			sum = sum * theta + d->poly[k][m] * (1.0 / (k + 1));
			sum2 = sum2 * theta + d->poly[k][m] * (1.0 / ((k + 1) * (k + 2)));
		}
		const double v = d->start[COORDINATES + m];
		row[m] = d->start[m] + h * theta * (v + h * theta * sum2);
		row[COORDINATES + m] = v + h * theta * sum;
	}
	return true;
}

#define BY_STAGES(S) \
	static bool INSTANCE(reach##S)(struct adaptive *a, double end, double *row) \
	{ \
		return INSTANCE(inside)((struct radau *)a, end, row, S); \
	} \
	static bool INSTANCE(walk##S)(struct adaptive *a, int units, double *rows) \
	{ \
		const struct radau *d = (const struct radau *)a; \
		(void)d; \
		return walk_by(a, units, rows, 2 * COORDINATES, INSTANCE(reach##S)); \
	}
BY_STAGES(3)
BY_STAGES(5)
BY_STAGES(7)

#undef BY_STAGES
#undef EACH
#undef STAGES
#undef INSTANCE
#undef COORDINATES
#undef EXTENT
#undef SLOPES
#undef JACOBIAN
