/* SPDX-License-Identifier: MIT-0 */
/* Coefficients of a step from other params: those of the equations, in two words, and from them e^{A tau} - I. */
#include "two.h"

/* sum + a b.  The error of a sum of n such terms is about n 2^-104, or n 2^-46, of the sum of their sizes; what comes
 * out is not yet normal: lo may have grown beyond half a unit of hi. */
static inline pl_two plus_product(pl_two sum, pl_two a, pl_two b)
{
	const pl_two p = two_product(a.hi, b.hi), s = two_sum(sum.hi, p.hi);
	return two(s.hi, sum.lo + (s.lo + (p.lo + (a.hi * b.lo + a.lo * b.hi))));
}

static inline pl_two normal(pl_two a)
{
	return two_sum(a.hi, a.lo);
}

/* a / b within 2^-103, or 2^-45, of itself */
static PL_APART pl_two quotient(pl_two a, pl_two b)
{
	const real q = rounded(a.hi / b.hi);
	const pl_two p = two_product(q, b.hi);
	return two_sum(q, (((a.hi - p.hi) - p.lo) + (a.lo - q * b.lo)) / b.hi);
}

static real larger(real a, real b)
{
	return a > b ? a : b;
}

/* ---- equations ---- */

/* sum + a b; 0 where so much cancels that rounding alone could have left the rest: else what is singular would show
 * only in huge numbers */
static PL_APART pl_two reduced(pl_two sum, pl_two a, pl_two b)
{
	const pl_two rest = normal(plus_product(sum, a, b));
	return pl_magnitude(rest.hi) < 8 * REAL_EPSILON * REAL_EPSILON * pl_magnitude(sum.hi) ? two(0, 0) : rest;
}

static int finite_entries(int rows, int columns, int width, const pl_two *value)
{
	int i, j;
	for (i = 0; i < rows; i++) {
		for (j = 0; j < columns; j++) {
			if (!is_finite(value[i * width + j].hi)) {
				return 0;
			}
		}
	}
	return 1;
}

/* Number i; made: those behind the constants */
static pl_two number_of(const pl_formulas *f, const real *params, const pl_two *made, int i)
{
	if (i < f->params) {
		return two(params[i], 0);
	}
	i -= f->params;
	return i < f->constants ? f->constant[i] : made[i - f->constants];
}

/* Off, measured over 6 10^4 sets of equations, by 2^-103.7 and in floats 2^-45.9 of what the bound is given. */
int pl_formulas_at(const pl_formulas *f, const real *params, pl_two *made)
{
	int i;
	for (i = 0; i < f->params; i++) {
		if (!is_finite(params[i])) {
			return PL_NOT_FINITE;
		}
	}
	for (i = 0; i < f->operations; i++) {
		const pl_operation *const o = f->operation + i;
		const pl_two a = number_of(f, params, made, o->a), b = number_of(f, params, made, o->b);
		if (o->what != PL_QUOTIENT) {
			const int product = o->what == PL_PRODUCT;
			made[i] = reduced(product ? two(0, 0) : a, product ? a : two(o->what == PL_SUM ? 1 : -1, 0), b);
		} else if (b.hi != 0) {
			made[i] = quotient(a, b);
		} else {
			return PL_SINGULAR;
		}
	}
	return 0;
}

/* The derivative of number i */
static pl_two slope_of(const pl_formulas *f, const real *by, const pl_two *slope, int i)
{
	const int first = f->params + f->constants;
	return i < f->params ? two(by[i], 0) : i < first ? two(0, 0) : slope[i - first];
}

void pl_formulas_slope(const pl_formulas *f, const real *params, const pl_two *made, const real *by,
					   pl_two *slope)
{
	int i;
	for (i = 0; i < f->operations; i++) {
		const pl_operation *const o = f->operation + i;
		const pl_two a = number_of(f, params, made, o->a), b = number_of(f, params, made, o->b);
		const pl_two da = slope_of(f, by, slope, o->a), db = slope_of(f, by, slope, o->b);
		const real sign = o->what == PL_SUM ? 1 : -1;
		if (o->what == PL_PRODUCT) {
			slope[i] = normal(plus_product(plus_product(two(0, 0), da, b), a, db));
		} else if (o->what == PL_QUOTIENT) {
			slope[i] = quotient(normal(plus_product(da, two(-made[i].hi, -made[i].lo), db)), b);
		} else {
			slope[i] = normal(plus_product(da, two(sign, 0), db));
		}
	}
}

real pl_entries_slope(const pl_place *p, const pl_formulas *f, const real *by, const pl_two *slope)
{
	const real s = slope_of(f, by, slope, p->number).hi;
	return p->negative ? -s : s;
}

int pl_entries_in(const pl_entries *m, const pl_formulas *f, const real *params, const pl_two *made, int before,
				  int loads, int segments, int segment, pl_two *value)
{
	const int columns = m->columns - (segments - 1) * loads;
	int i, status = 0;
	for (i = 0; i < m->rows * columns; i++) {
		value[i] = two(0, 0);
	}
	for (i = 0; i < m->places; i++) {
		const pl_place *const p = m->place + i;
		const pl_two n = number_of(f, params, made, p->number);
		int column = p->column, skipped = 0;
		for (; column >= before + loads && skipped < segments - 1; skipped++) {
			column -= loads;
		}
		if (column < before || column >= before + loads || p->row >= before || skipped == segment) {
			value[p->row * columns + column] = p->negative ? two(-n.hi, -n.lo) : n;
			status = is_finite(n.hi) ? status : PL_NOT_FINITE;
		}
	}
	return status;
}

int pl_entries_at(const pl_entries *m, const pl_formulas *f, const real *params, const pl_two *made, pl_two *value)
{
	return pl_entries_in(m, f, params, made, 0, 0, 1, 0, value);
}

/* ---- e^{A tau} - I ---- */

/* Taylor's polynomial has degree BLOCK^2, so it is made of BLOCK powers of X and BLOCK - 1 products with the last of
 * them.  MOST: the square of a norm of A tau beyond which it is refused. */
#ifdef REAL_IS_FLOAT
enum { BLOCK = 3 };
#define MOST 0x1p64f
#else
enum { BLOCK = 4 };
#define MOST 0x1p128
#endif

static int exponent(real a)
{
	real_parts u;
	u.value = a;
	return (int)(u.bits >> (REAL_DIGITS - 1)) - (REAL_EXPONENTS - 1);
}

static real power_of_2(int e)
{
	real_parts u;
	u.bits = (real_bits)(e + REAL_EXPONENTS - 1) << (REAL_DIGITS - 1);
	return u.value;
}

/* Gives row and column i of B, n x n, about the same sum off the diagonal, by a power of 2.  1: that changed something.
 * What has no way back to itself has no part in any pole: its row and column are left out, and counted. */
static int balance(int n, pl_two *B, int i, int *isolated)
{
	real row = 0, column = 0, up, down;
	int j, e;
	for (j = 0; j < n; j++) {
		if (j != i) {
			row += B[i * n + j].hi;
			column += B[j * n + i].hi;
		}
	}
	if (row == 0 && column == 0) {
		return 0;
	}
	if (row == 0 || column == 0) {
		up = down = 0;
		++*isolated;
	} else {
		e = (exponent(row) - exponent(column)) / 2;
		if (e == 0) {
			return 0;
		}
		up = power_of_2(e);
		down = power_of_2(-e);
	}
	for (j = 0; j < n; j++) {
		if (j != i) {
			B[i * n + j].hi *= down;
			B[j * n + i].hi *= up;
		}
	}
	return 1;
}

/* The square of a norm of A tau, A an n x n block on the diagonal of a larger matrix, `stride` wide: |B^2| for |A tau|
 * in units in which it is well balanced (Osborne), which one entry alone cannot blow up.  Not finite if A is not.  B:
 * work, n x n */
static real norm_squared(int n, const pl_two *A, int stride, real tau, pl_two *B, int *isolated)
{
	enum { SWEEPS = 4 };
	real most = 0, all = 0;
	int i, j, sweep, changed = 1;

	for (i = 0; i < n; i++) {
		for (j = 0; j < n; j++) {
			B[i * n + j].hi = pl_magnitude(A[i * stride + j].hi * tau);
		}
	}
	for (sweep = 0; sweep < SWEEPS && changed; sweep++) {
		for (i = changed = 0; i < n; i++) {
			changed |= balance(n, B, i, isolated);
		}
	}
	for (i = 0; i < n; i++) {
		real sum = 0;
		for (j = 0; j < n; j++) {
			sum += B[i * n + j].hi;
		}
		B[i].lo = sum;
	}
	for (i = 0; i < n; i++) {
		real sum = 0;
		for (j = 0; j < n; j++) {
			sum += B[i * n + j].hi * B[j].lo;
		}
		if (sum > most) {
			most = sum;
		}
		all += sum;
	}
	return is_finite(all) ? most : all;
}

/* The longest of the shortest ways from a load's column to the states, in powers of A: 1 where it acts on them.  mark:
 * work, `size` */
static int load_depth(int size, int states, const pl_two *A, pl_two *mark)
{
	int i, j, found, depth = 0;
	for (j = 0; j < size; j++) {
		mark[j].hi = j < states;
	}
	do {
		found = 0;
		for (j = states; j < size; j++) {
			if (mark[j].hi == 0) {
				for (i = depth == 0 ? 0 : states; i < (depth == 0 ? states : size); i++) {
					if (mark[i].hi == 1 && A[i * size + j].hi != 0) {
						mark[j].hi = 2;
						found = 1;
						break;
					}
				}
			}
		}
		for (j = states; j < size; j++) {
			if (mark[j].hi != 0) {
				mark[j].hi = 1;
			}
		}
		depth += found;
	} while (found);
	return depth;
}

/* What follows is in one word, the high one, or in two.  Matrices are size x size and 0 below the first `states` rows
 * and left of column `states`, where nothing is read or written. */
typedef struct layout {
	int words, size, states;
} layout;

static int first_column(const layout *m, int i)
{
	return i < m->states ? 0 : m->states;
}

static void product_one(const layout *m, int rows, real factor, const pl_two *d, const pl_two *a, const pl_two *b,
						pl_two *c)
{
	const int size = m->size;
	int i, j, k;
	for (i = 0; i < rows; i++, a += size, c += size, d += size) {
		for (j = first_column(m, i); j < size; j++) {
			const int to = j < m->states ? m->states : size;
			real sum = 0;
			for (k = first_column(m, i); k < to; k++) {
				sum += a[k].hi * b[k * size + j].hi;
			}
			c[j].hi = factor * d[j].hi + sum;
		}
	}
}

static void product_two(const layout *m, int rows, real factor, const pl_two *d, const pl_two *a, const pl_two *b,
						pl_two *c)
{
	const int size = m->size;
	int i, j, k;
	for (i = 0; i < rows; i++, a += size, c += size, d += size) {
		for (j = first_column(m, i); j < size; j++) {
			const int to = j < m->states ? m->states : size;
			pl_two sum = two(factor * d[j].hi, factor * d[j].lo);
			for (k = first_column(m, i); k < to; k++) {
				sum = plus_product(sum, a[k], b[k * size + j]);
			}
			c[j] = normal(sum);
		}
	}
}

/* c <- factor d + a b, its first `rows` rows; the factor is 0 or a power of 2, and c may be d */
static void product(const layout *m, int rows, real factor, const pl_two *d, const pl_two *a, const pl_two *b,
					pl_two *c)
{
	if (m->words == 1) {
		product_one(m, rows, factor, d, a, b, c);
	} else {
		product_two(m, rows, factor, d, a, b, c);
	}
}

/* c <- sum_l coefficient_l X^{l + 1}, its first `rows` rows */
static void combine(const layout *m, int rows, const real *coefficient, const pl_two *X, pl_two *c)
{
	const int entries = m->size * m->size;
	int i, j, l;
	for (i = 0; i < rows; i++, X += m->size, c += m->size) {
		for (j = first_column(m, i); j < m->size; j++) {
			const pl_two *x = X + j;
			pl_two sum = two(0, 0);
			if (m->words == 1) {
				for (l = 0; l < BLOCK; l++, x += entries) {
					sum.hi += coefficient[l] * x->hi;
				}
			} else {
				for (l = 0; l < BLOCK; l++, x += entries) {
					sum = plus_product(sum, two(coefficient[l], 0), *x);
				}
			}
			c[j] = sum;
		}
	}
}

/* e^X - I, its first `rows` rows; X is followed by room for its powers up to the BLOCKth.  The result is *sum; *sum and
 * *other change places on the way. */
static void taylor(const layout *m, int rows, pl_two *X, pl_two **sum, pl_two **other)
{
	const int entries = m->size * m->size;
	real coefficient[BLOCK], factor = 1; /* degree! / l! */
	int l, i, j, block, degree = BLOCK * BLOCK;

	for (l = 2; l <= BLOCK; l++) {
		product(m, m->size, 0, X, X + (l / 2 - 1) * entries, X + (l - l / 2 - 1) * entries, X
				+ (l - 1) * entries);
	}
	for (block = BLOCK - 1; block >= 0; block--) {
		pl_two *const from = *sum, *const to = *other;
		for (l = BLOCK - 1; l >= 0; l--, degree--) {
			coefficient[l] = factor;
			factor *= (real)degree;
		}
		combine(m, rows, coefficient, X, to);
		if (block != BLOCK - 1) {
			product(m, rows, 1, to, from, X + (BLOCK - 1) * entries, to);
		}
		*sum = to;
		*other = from;
	}
	for (i = 0; i < rows; i++) {
		for (j = first_column(m, i); j < m->size; j++) {
			pl_two *const s = *sum + i * m->size + j;
			*s = m->words == 1 ? two(s->hi / factor, 0) : quotient(*s, two(factor, 0));
		}
	}
}

/* Adds `one` to the diagonal, or takes it off: in two words */
static void shift(int size, int rows, pl_two *a, real one)
{
	int i;
	for (i = 0; i < rows; i++) {
		a[i * size + i] = add(a[i * size + i], two(one, 0));
	}
}

/* Do terms of the series meet that leave less than half of the largest?  In the states' block, or in a load's column.
 * One word has then lost too much.  Of X^2 the sizes of its own terms count: they may have met before.  X and its
 * powers as taylor() leaves them, D what became of them */
static int cancelled(const layout *m, int halvings, const pl_two *X, const pl_two *D)
{
	const int size = m->size, states = m->states, entries = size * size;
	const real whole = power_of_2(halvings);
	int from, to, i, j, k, l;
	for (from = 0; from < size; from = to) {
		real left = 0, first = 0, second = 0, most, factor = whole * whole / 2;
		to = from < states ? states : from + 1;
		for (i = 0; i < states * size; i += size) {
			for (j = from; j < to; j++) {
				real sum = 0;
				for (k = 0; k < (from < states ? states : size); k++) {
					sum += pl_magnitude(X[i + k].hi * X[k * size + j].hi);
				}
				left = larger(left, pl_magnitude(D[i + j].hi));
				first = larger(first, pl_magnitude(X[i + j].hi));
				second = larger(second, sum);
			}
		}
		most = larger(whole * first, factor * second);
		for (l = 2; l < BLOCK; l++) {
			real term = 0;
			for (i = l * entries; i < l * entries + states * size; i += size) {
				for (j = from; j < to; j++) {
					term = larger(term, pl_magnitude(X[i + j].hi));
				}
			}
			factor *= whole / (real)(l + 1);
			most = larger(most, factor * term);
		}
		if (most > 2 * left) {
			return 1;
		}
	}
	return 0;
}

/* e^{A tau} - I, its first `states` rows, by `halvings` halvings of tau, of which the first `far` bring |A tau| below
 * 1/2.  The result is one of two matrices behind those of taylor(), or NULL if it is not finite. */
static const pl_two *increment(const layout *m, const pl_two *A, real tau, int halvings, int far, pl_two *work)
{
	const int size = m->size, entries = size * size;
	const real part = tau * power_of_2(-halvings);
	pl_two *const X = work, *sum = work + BLOCK * entries, *other = sum + entries;
	int less = 1, i, j;

	for (i = 0; i < size; i++) {
		for (j = first_column(m, i); j < size; j++) {
			const pl_two a = A[i * size + j];
			X[i * size + j] = m->words == 1 ? two(a.hi * part,
					0) : normal(plus_product(two(0, 0), a, two(part, 0)));
		}
	}
	taylor(m, halvings == 0 ? m->states : size, X, &sum, &other);
	for (; halvings > 0; halvings--) {
		pl_two *const from = sum;
		/* I + D, from here on: what decays would be lost in D, which is then close to -I */
		if (m->words == 2 && halvings == far) {
			shift(size, size, from, 1);
			less = 0;
		}
		product(m, halvings == 1 ? m->states : size, less ? 2 : 0, from, from, from, other);
		sum = other;
		other = from;
		if (!finite_entries(m->states, size, size, sum)) {
			return NULL;
		}
	}
	if (!less) {
		shift(size, m->states, sum, -1);
	}
	return finite_entries(m->states, size, size, sum) ? sum : NULL;
}

/* Taylor's series of A tau 2^-k, then k times D <- 2 D + D^2, which keeps small entries that I + D would lose.  In one
 * word where |A| tau is below 2.  In two beyond, and where terms of the series meet that leave little; there it is I +
 * D that is squared from |A| tau 2^-k = 1/2 on, which keeps what decays.
 *
 * Measured: 7.2 units, over 2 10^5 models with and without damping, stiff, near confluence and free, with all kinds of
 * loads; 0.5 where two words are used.  In floats for |A| tau up to 2^10: 11.5 units; up to 2^12 one in 2 10^4 damped
 * models was off by 16.7 in units that are far apart. */
int pl_increment(int size, int states, const pl_two *A, real tau, int words, pl_two *D, pl_two *work)
{
	const pl_two *result = NULL;
	int far, extra, depth = 0, ignored = 0, i;
	real norm = norm_squared(states, A, size, tau, work, &depth), loads = 0;
	layout m;

	if (states < size) {
		loads = norm_squared(size - states, A + states * size + states, size, tau, work, &ignored);
	}
	if (!is_finite(norm) || !is_finite(loads)) {
		return PL_NOT_FINITE;
	}
	norm = larger(norm, loads);
	if (norm > MOST) {
		return PL_NOT_FINITE;
	}
	m.words = norm <= 4 ? words : 2;
	m.size = size;
	m.states = states;
	far = exponent(norm) < -4 ? 0 : (exponent(norm) + 4) / 2;
	depth += load_depth(size, states, A, work);
	extra = depth < BLOCK * BLOCK ? (depth + 1) / BLOCK : BLOCK;
	if (m.words == 1) {
		result = increment(&m, A, tau, far + extra, far, work);
		if (result != NULL && cancelled(&m, far + extra, work, result)) {
			m.words = 2;
		}
	}
	if (m.words == 2) {
		result = increment(&m, A, tau, far + 2 + extra, far, work);
	}
	if (result == NULL) {
		return PL_NOT_FINITE;
	}
	for (i = 0; i < states * size; i++) {
		D[i] = result[i];
	}
	return 0;
}

int pl_ramp_cancels(int size, int states, const pl_two *D, int column, real h)
{
	real most = 0, before = 0;
	int i;
	for (i = 0; i < states; i++) {
		const pl_two *const d = D + i * size + column;
		most = larger(most, larger(pl_magnitude(d[0].hi), pl_magnitude(d[1].hi / h)));
		before = larger(before, pl_magnitude(d[0].hi - d[1].hi / h));
	}
	return 2 * most > 5 * before;
}

real pl_ramp_before(pl_two whole, pl_two slope, real h)
{
	const pl_two after = quotient(slope, two(h, 0));
	return (whole.hi - after.hi) + (whole.lo - after.lo);
}
