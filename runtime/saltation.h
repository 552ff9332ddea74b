/* SPDX-License-Identifier: MIT-0 */
/* saltation.h: what an event does to derivatives S = x_p at fixed time: part of plreal.h, for every flow.  A guard g
 * comes to 0 while g' = g_x f- + g_t > 0, the state jumps, x+ = R(t, x-, p), and goes on with the field f+ in place of
 * f-.  Then (Aizerman and Gantmakher 1958; Leine and Nijmeijer 2004)
 *
 *     t*_p = -(g_x S- + g_p)/g'            S+ = R_x S- + R_p + q t*_p,      q = R_x f- + R_t - f+
 *
 * A flow gives directional derivatives alone: of g and R along the solution, (f-, 1), and along columns, (S-, p). */

/* The derivative of the event's time: dg of that column, rate: g' */
static inline PL_REAL pl_saltation_time(PL_REAL dg, PL_REAL rate)
{
	return -dg / rate;
}

/* S becomes S+, from R_x S- + R_p.  when: t*_p */
static inline void pl_saltation_pass(int n, const PL_REAL *q, PL_REAL when, PL_REAL *S)
{
	int i;
	for (i = 0; i < n; i++) {
		S[i] += q[i] * when;
	}
}

/* Whether a guard that turns back, g'' = bend < 0, is met so flatly that S+ is not known: the rounding of g, whose
 * terms have this size, is not small beside the depth rate^2/(2 |bend|) that would be reached behind it.  S+ itself
 * grows as 1/rate there, and depends on whether the guard is met at all. */
static inline int pl_saltation_grazes(PL_REAL size, PL_REAL rate, PL_REAL bend)
{
	const PL_REAL known = sizeof(PL_REAL) == sizeof(float) ? (PL_REAL)0x1p-16 : (PL_REAL)0x1p-33;
	return bend < 0 && rate * rate < -bend * size * known;
}

/* The same of a guard that is not met: `gap`, its distance where it turns back; below 0 it is met before. */
static inline int pl_saltation_misses(PL_REAL size, PL_REAL gap)
{
	const PL_REAL known = sizeof(PL_REAL) == sizeof(float) ? (PL_REAL)0x1p-17 : (PL_REAL)0x1p-34;
	return gap < size * known && gap > -size * known;
}

/* ---- beside steps of regions ---- */

/* An entry that is not 0 of the derivative of a table by one column: `column` is that of x, or `size` for the number
 * that row . x is compared with. */
typedef struct pl_varied {
	unsigned short row, column;
	PL_REAL value;
} pl_varied;

/* Derivatives of x at fixed time, S' = A S + A_p x, columns of `size` entries.  Of column p and block b the entries are
 * entry[first[k]] to entry[first[k + 1] - 1], k = p (matrices + 5) + b.  Blocks are A of each matrix; behind them
 * switching functions, of each segment of time in turn, breakpoints, guards, assignments, and the times of changes. */
typedef struct pl_variation {
	int columns, matrices, degree; /* degree: of Taylor polynomials */
	const int *first;
	const pl_varied *entry;
	const PL_REAL *over;           /* derivatives of e^{A h}, of each column those of each matrix; or NULL */
	PL_REAL *S;                    /* columns + 1, the last one for work */
	PL_REAL *scale;                /* the largest size of each entry of x so far */
	PL_REAL *when, *dg;            /* columns each, for work */
	PL_REAL *noise;                /* size, for work */
	PL_REAL *work;                 /* PL_VARIATION_WORK(size, degree) */
	pl_varied *acting;             /* size x size + 1, for work */
	int segment;                   /* of time */
	pl_doubt doubt;                /* PL_D_... bits are added; times are after the start of the step */
	/* An event that has begun, and what met before it: */
	int pending, function, before, sticks, upward, last;
	int jumped;
	uint32_t acted;                /* impacts, as bits */
	PL_REAL rate, bend, size, time, last_time;
} pl_variation;

/* How one column varies in time in a region, of the states alone: A S + A_p x; A_p is entry[first[0]] to
 * entry[first[1] - 1]. */
static inline void pl_variation_rate(int size, int states, const PL_REAL *A, const int *first, const pl_varied *entry,
								 const PL_REAL *x, const PL_REAL *S, PL_REAL *rate)
{
	int k;
	pl_multiply(states, size, A, S, rate);
	for (k = first[0]; k < first[1]; k++) {
		if (entry[k].row < states) {
			rate[entry[k].row] += entry[k].value * x[entry[k].column];
		}
	}
}

/* A change of the loads at the end of a segment of time begins: x' = A x up to then.  The next call ends it. */
static inline void pl_variation_change(pl_variation *v, int size, const PL_REAL *A, const PL_REAL *x)
{
	PL_REAL *const slope = v->S + (ptrdiff_t)v->columns * size;
	int p, k;
	pl_multiply(size, size, A, x, slope);
	for (k = 0; k < size; k++, A += size) {
		v->noise[k] = 0;
		for (p = 0; p < size; p++) {
			v->noise[k] += A[p] * x[p] < 0 ? -A[p] * x[p] : A[p] * x[p];
		}
	}
	for (p = 0; p < v->columns; p++) {
		const int *first = v->first + p * (v->matrices + 5) + v->matrices + 4;
		v->when[p] = 0;
		for (k = first[0]; k < first[1]; k++) {
			v->when[p] += v->entry[k].row == v->segment ? v->entry[k].value : 0;
		}
	}
	v->pending = 1;
	v->function = -1;
	v->sticks = 0;
}

/* As pl_switching_start and so on; v NULL: without derivatives. */
void pl_switching_start_d(const pl_switching *m, const PL_REAL *x, pl_contact *c, PL_REAL *work);
void pl_switching_advance_d(const pl_switching *m, PL_REAL tau, PL_REAL *x, pl_contact *c, pl_crossing *crossing,
							PL_REAL *work, pl_variation *v);
/* Through so many crossings over h, which are all that it has */
void pl_switching_follow_d(const pl_switching *m, int count, const pl_crossing *crossing, PL_REAL *x, pl_contact *c,
						   pl_variation *v);
void pl_guards_start_d(const pl_guards *m, const PL_REAL *x, pl_contact *c, PL_REAL *work);
void pl_guards_advance_d(const pl_guards *m, PL_REAL tau, PL_REAL *x, pl_contact *c, pl_crossing *crossing,
						 PL_REAL *work, pl_variation *v);
void pl_guards_change_d(const pl_guards *m, PL_REAL time, PL_REAL *x, pl_contact *c, pl_crossing *crossing,
						PL_REAL *work, pl_variation *v);

/* The same beside a double-double x, whose derivatives have one word */
void pl_switching_compensated_start_d(const pl_switching *m, const PL_REAL *x, pl_contact *c, PL_REAL *work);
void pl_switching_compensated_advance_d(const pl_switching *m, PL_REAL tau, PL_REAL *x, pl_contact *c,
								pl_crossing *crossing, PL_REAL *work, pl_variation *v);
void pl_switching_compensated_follow_d(const pl_switching *m, int count, const pl_crossing *crossing, PL_REAL *x,
									   pl_contact *c, pl_variation *v);
void pl_guards_compensated_start_d(const pl_guards *m, const PL_REAL *x, pl_contact *c, PL_REAL *work);
void pl_guards_compensated_advance_d(const pl_guards *m, PL_REAL tau, PL_REAL *x, pl_contact *c, pl_crossing *crossing,
									 PL_REAL *work, pl_variation *v);
void pl_guards_compensated_change_d(const pl_guards *m, PL_REAL time, PL_REAL *x, pl_contact *c, pl_crossing *crossing,
									PL_REAL *work, pl_variation *v);
