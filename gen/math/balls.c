/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Balls, and sums of products of them.
 *
 * With relative rounding all errors of a product of matrices stay below a small multiple of 2^-p |X||Y|, entry by
 * entry. The radii are not that bound but what the operands at hand give, which is far less where the motion is
 * damped. */
#include "math/balls.h"

#include <limits.h>
#include <string.h>

enum { MAGNITUDE_BITS = 24 };

_Static_assert(sizeof(mp_limb_t) == 8 && GMP_NAIL_BITS == 0, "limbs are 64 bits");

/* ---- magnitudes: upper bounds m 2^e, 2^23 <= m < 2^24 or m = 0; every operation rounds up ---- */

struct magnitude magnitude(uint64_t m, long e)
{
	if (m == 0)
		return (struct magnitude){ 0, 0 };
	int shift = LIMB - MAGNITUDE_BITS - __builtin_clzll(m);
	if (shift <= 0)
		return (struct magnitude){ m << -shift, e + shift };
	uint64_t top = (m >> shift) + ((m & ((1ULL << shift) - 1)) != 0);
	if (top >> MAGNITUDE_BITS)
		return (struct magnitude){ top >> 1, e + shift + 1 };
	return (struct magnitude){ top, e + shift };
}

struct magnitude magnitude_mul(struct magnitude a, struct magnitude b)
{
	return magnitude(a.m * b.m, a.e + b.e);
}

struct magnitude magnitude_add(struct magnitude a, struct magnitude b)
{
	enum { ROOM = 32 };
	if (a.m == 0 || b.m == 0)
		return a.m ? a : b;
	struct magnitude large = a.e >= b.e ? a : b, small = a.e >= b.e ? b : a;
	long gap = large.e - small.e;
	uint64_t moved = gap >= LIMB ? 1 : (small.m << ROOM >> gap) + 1;
	return magnitude((large.m << ROOM) + moved, large.e - ROOM);
}

struct magnitude magnitude_div(struct magnitude a, uint64_t divisor)
{
	enum { ROOM = 40 };
	return a.m ? magnitude((a.m << ROOM) / divisor + 1, a.e - ROOM) : a;
}

bool magnitude_above(struct magnitude a, struct magnitude b)
{
	if (a.m == 0 || b.m == 0)
		return a.m != 0;
	return a.e != b.e ? a.e > b.e : a.m > b.m;
}

long magnitude_log(struct magnitude a)
{
	return a.e + MAGNITUDE_BITS;
}

struct magnitude magnitude_of_rational(mpq_srcptr q)
{
	if (mpq_sgn(q) == 0)
		return (struct magnitude){ 0, 0 };
	INTEGER quotient = INTEGER_ZERO;
	long shift = 40 - rational_bits(q);
	if (shift >= 0) {
		mpz_mul_2exp(quotient, mpq_numref(q), (mp_bitcnt_t)shift);
		mpz_tdiv_q(quotient, quotient, mpq_denref(q));
	} else {
		mpz_mul_2exp(quotient, mpq_denref(q), (mp_bitcnt_t)-shift);
		mpz_tdiv_q(quotient, mpq_numref(q), quotient);
	}
	return magnitude(mpz_getlimbn(quotient, 0) + 1, -shift);        /* the quotient has 40 or 41 bits */
}

/* ---- balls ---- */

void balls_init(struct balls *x, size_t count, int limbs)
{
	*x = (struct balls){ limbs,
			     ARRAY(mp_limb_t, count * (size_t)limbs),
			     ARRAY(long, count),
			     ARRAY(signed char, count),
			     ARRAY(struct magnitude, count),
			     ARRAY(struct magnitude, count),
			     0, NULL, NULL };
}

void balls_init_matrix(struct balls *x, int n, int limbs)
{
	balls_init(x, (size_t)n * (size_t)n, limbs);
	x->n = n;
	x->count = ARRAY(int, n);
	x->column = ARRAY(int, (size_t)n * (size_t)n);
}

void balls_clear(struct balls *x)
{
	discard(x->limb);
	discard(x->exponent);
	discard(x->sign);
	discard(x->radius);
	discard(x->size);
	discard(x->count);
	discard(x->column);
}

void balls_find_row(struct balls *x, int row)
{
	int count = 0;
	for (int j = 0; j < x->n; j++)
		if (x->size[row * x->n + j].m)
			x->column[row * x->n + count++] = j;
	x->count[row] = count;
}

mp_limb_t *ball_limbs(const struct balls *x, size_t at)
{
	return x->limb + at * (size_t)x->limbs;
}

void ball_update_size(struct balls *x, size_t at)
{
	x->size[at] = x->radius[at];
	if (!x->sign[at])
		return;
	mp_limb_t top = ball_limbs(x, at)[x->limbs - 1];
	struct magnitude middle = magnitude((top >> 32) + 1, LIMB * (x->exponent[at] - 1) + 32);
	if (top >> 32 == 0)             /* few bits in the top digit: the next one counts */
		middle = magnitude((top << 24 | (x->limbs > 1 ? ball_limbs(x, at)[x->limbs - 2] >> 40 : 0)) + 1,
				   LIMB * (x->exponent[at] - 1) - 24);
	x->size[at] = magnitude_add(middle, x->radius[at]);
}

void ball_set_rational(struct balls *x, size_t at, mpq_srcptr q, long halvings)
{
	x->sign[at] = (signed char)mpq_sgn(q);
	x->radius[at] = (struct magnitude){ 0, 0 };
	if (x->sign[at] == 0) {
		ball_update_size(x, at);
		return;
	}
	INTEGER middle = INTEGER_ZERO, scaled = INTEGER_ZERO;
	/* |x| < 2^bits */
	long bits = rational_bits(q) + 1 - halvings;
	long exponent = bits >= 0 ? (bits + LIMB - 1) / LIMB : -(-bits / LIMB);
	bool exact;
	for (;;) {
		long shift = LIMB * (x->limbs - exponent) - halvings;
		mpz_abs(middle, mpq_numref(q));
		mpz_mul_2exp(middle, middle, (mp_bitcnt_t)(shift > 0 ? shift : 0));
		mpz_mul_2exp(scaled, mpq_denref(q), (mp_bitcnt_t)(shift < 0 ? -shift : 0));
		mpz_tdiv_qr(middle, scaled, middle, scaled);
		exact = mpz_sgn(scaled) == 0;
		if (mpz_size(middle) == (size_t)x->limbs)
			break;
		exponent--;
	}
	memcpy(ball_limbs(x, at), mpz_limbs_read(middle), (size_t)x->limbs * sizeof(mp_limb_t));
	x->exponent[at] = exponent;
	if (!exact)
		x->radius[at] = magnitude(1, LIMB * (exponent - x->limbs));
	ball_update_size(x, at);
}

/* ---- a row of sums of products: the one operation ---- */

void row_init(struct row *row, int n, int capacity, int limbs)
{
	*row = (struct row){ .n = n,
			     .limbs = limbs,
			     .part = ARRAY(struct part, capacity),
			     .cell = ARRAY(struct cell, n),
			     .accumulator = ARRAY(mp_limb_t, (size_t)n * ((size_t)limbs + 2)),
			     .product = ARRAY(mp_limb_t, 2 * (size_t)limbs) };
}

void row_clear(struct row *row)
{
	discard(row->part);
	discard(row->cell);
	discard(row->accumulator);
	discard(row->product);
}

void row_add_part(struct row *row, const struct balls *x, size_t at, const struct balls *y, int i)
{
	row->part[row->parts++] = (struct part){ .x = x, .y = y, .at = at, .offset = (ptrdiff_t)i * y->n,
						 .count = y->count[i], .column = y->column + (ptrdiff_t)i * y->n };
}

void row_add_one(struct row *row, const struct balls *x, size_t at, const struct balls *y, size_t b, int j)
{
	row->unit = j;
	row->part[row->parts++] = (struct part){ .x = x, .y = y, .at = at, .offset = (ptrdiff_t)b - j, .count = 1,
						 .column = &row->unit };
}

static void lift(long *top, long exponent)
{
	*top = exponent > *top ? exponent : *top;
}

static void find_tops(struct row *row, const struct part *p)
{
	struct magnitude size = p->x->size[p->at], radius = p->x->radius[p->at];
	const struct balls *y = p->y;
	bool product = p->x->sign[p->at] != 0;
	for (int k = 0; k < p->count; k++) {
		struct cell *cell = &row->cell[p->column[k]];
		ptrdiff_t b = p->offset + p->column[k];
		if (product && y->sign[b]) {
			lift(&cell->top, p->x->exponent[p->at] + y->exponent[b]);
			cell->terms++;
		}
		if (y->radius[b].m)
			lift(&cell->error_top, size.e + y->radius[b].e);
		if (radius.m)
			lift(&cell->error_top, radius.e + y->size[b].e);
	}
}

/* Each shift rounds up; < 2^48 per error, fewer than 2^16 errors */
static void add_error(struct cell *cell, struct magnitude a, struct magnitude b)
{
	if (!a.m || !b.m)
		return;
	long gap = cell->error_top - (a.e + b.e);
	cell->error += (gap < LIMB ? a.m * b.m >> gap : 0) + 1;
}

/* at[0 .. rest-1] +- x[0 .. length-1] */
static void add_limbs(mp_limb_t *at, int rest, const mp_limb_t *x, int length, bool minus)
{
	mp_limb_t carry = (minus ? mpn_sub_n : mpn_add_n)(at, at, x, length);
	for (int i = length; i < rest && carry; i++) {
		mp_limb_t before = at[i];
		at[i] = minus ? before - 1 : before + 1;
		carry = minus ? before == 0 : at[i] == 0;
	}
}

/* The products go into windows of limbs + 1 digits below 2^(64 top), with one digit above for carries and sign. A
 * product that starts g digits below the top needs only the first limbs + 1 - g digits of its factors: cutting each
 * factor costs less than one unit of the window's last digit, cutting the product another. */
static void add_products(struct row *row, const struct part *p)
{
	struct magnitude size = p->x->size[p->at], radius = p->x->radius[p->at];
	int limbs = row->limbs, window = limbs + 1, sign = p->x->sign[p->at];
	const mp_limb_t *x = ball_limbs(p->x, p->at);
	const struct balls *y = p->y;
	for (int k = 0; k < p->count; k++) {
		int j = p->column[k];
		ptrdiff_t b = p->offset + j;
		struct cell *cell = &row->cell[j];
		add_error(cell, size, y->radius[b]);
		add_error(cell, radius, y->size[b]);
		if (!sign || !y->sign[b])
			continue;
		long gap = cell->top - (p->x->exponent[p->at] + y->exponent[b]);
		if (gap >= window)
			continue;       /* below one unit */
		int room = window - (int)gap, digits = room < limbs ? room : limbs;
		int length = 2 * digits < room ? 2 * digits : room;
		mpn_mul_n(row->product, x + limbs - digits, ball_limbs(y, (size_t)b) + limbs - digits, digits);
		add_limbs(row->accumulator + j * (window + 1) + room - length, window + 1 - room + length,
			  row->product + 2 * digits - length, length, sign != y->sign[b]);
	}
}

/* z[at] <- the sum. Radius: inherited, 3 units of the window per product, 1 unit of the result. */
static void round_sum(const struct row *row, int j, struct balls *z, size_t at)
{
	const struct cell *cell = &row->cell[j];
	int limbs = row->limbs, window = limbs + 1, used = window + 1;
	mp_limb_t *accumulator = row->accumulator + j * (window + 1), *result = ball_limbs(z, at);
	bool minus = accumulator[window] >> (LIMB - 1);
	if (minus)
		mpn_neg(accumulator, accumulator, window + 1);
	while (used > 0 && accumulator[used - 1] == 0)
		used--;
	if (used > 0) {
		int kept = used < limbs ? used : limbs;
		memset(result, 0, (size_t)(limbs - kept) * sizeof(mp_limb_t));
		memcpy(result + limbs - kept, accumulator + used - kept, (size_t)kept * sizeof(mp_limb_t));
		z->sign[at] = minus ? -1 : 1;
		z->exponent[at] = cell->top - window + used;
		if (used > limbs)
			z->radius[at] = magnitude_add(z->radius[at], magnitude(1, LIMB * (z->exponent[at] - limbs)));
	}
	z->radius[at] = magnitude_add(z->radius[at], magnitude(3 * cell->terms, LIMB * (cell->top - window)));
}

void row_finish(struct row *row, struct balls *z, int i)
{
	for (int j = 0; j < row->n; j++)
		row->cell[j] = (struct cell){ LONG_MIN, LONG_MIN, 0, 0 };
	memset(row->accumulator, 0, (size_t)row->n * ((size_t)row->limbs + 2) * sizeof(mp_limb_t));
	for (int k = 0; k < row->parts; k++)
		find_tops(row, &row->part[k]);
	for (int k = 0; k < row->parts; k++)
		add_products(row, &row->part[k]);
	for (int j = 0; j < row->n; j++) {
		size_t at = (size_t)(i * row->n + j);
		struct cell *cell = &row->cell[j];
		z->radius[at] = magnitude(cell->error, cell->error ? cell->error_top : 0);
		z->sign[at] = 0;
		if (cell->terms)
			round_sum(row, j, z, at);
		ball_update_size(z, at);
	}
	balls_find_row(z, i);
	row->parts = 0;
}
