/* SPDX-License-Identifier: GPL-3.0-or-later */
/* e^{A tau} for models whose residues would be slow: e^B by its Taylor series, B = A tau / 2^s, then s squarings.
 *
 * Every entry is a ball: a middle of `limbs` 64-bit digits with an exponent of its own, and a radius of its own. With
 * relative rounding all errors stay below a small multiple of 2^-p (e^{|A| tau})_ij, entry by entry: |XY| <= |X||Y|,
 * and e^{|A|tau/2} e^{|A|tau/2} = e^{|A|tau}. So an entry of size 1e-200 (the far end of a chain, a short step) has as
 * many good digits as the largest, in whatever units the states are. The radii are not that bound but what the operands
 * at hand give, which is far less where the motion is damped.
 *
 * The series is summed in blocks of q powers (Paterson and Stockmeyer, SIAM J. Comput. 2, 1973); q = 1 is Horner's rule
 * with the sparse B. Its tail needs a norm: with D a diagonal of powers of two and b = ||D^-1 |B| D||, |sum_{k>=m}
 * B^k/k!|_ij <= (d_i/d_j) b^m/m! / (1 - b/(m+1)), and D only serves this estimate. Where no path of A leads from i to j
 * the entry is exactly 0 and stays so. */
#include "math/math.h"

#include <limits.h>
#include <string.h>

enum {
	LIMB = 64,
	MAGNITUDE_BITS = 24,
	LARGEST_HALVINGS = 512,
	LARGEST_BLOCK = 32,             /* powers of B kept */
	LARGEST_DEGREE = 1 << 16,
	LARGEST_WORK = 4 * LIMIT_PRECISION,
	BALANCING_SWEEPS = 24
};
static const long LARGEST_EXPONENT = 1L << 56;      /* bits; entries below 2^-this become 0 with that radius */

_Static_assert(sizeof(mp_limb_t) == 8 && GMP_NAIL_BITS == 0, "limbs are 64 bits");

/* ---- magnitudes: upper bounds m 2^e, 2^23 <= m < 2^24 or m = 0; every operation rounds up ---- */

struct magnitude {
	uint64_t m;
	long e;
};

static struct magnitude magnitude(uint64_t m, long e)
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

static struct magnitude magnitude_mul(struct magnitude a, struct magnitude b)
{
	return magnitude(a.m * b.m, a.e + b.e);
}

static struct magnitude magnitude_add(struct magnitude a, struct magnitude b)
{
	enum { ROOM = 32 };
	if (a.m == 0 || b.m == 0)
		return a.m ? a : b;
	struct magnitude large = a.e >= b.e ? a : b, small = a.e >= b.e ? b : a;
	long gap = large.e - small.e;
	uint64_t moved = gap >= LIMB ? 1 : (small.m << ROOM >> gap) + 1;
	return magnitude((large.m << ROOM) + moved, large.e - ROOM);
}

static struct magnitude magnitude_div(struct magnitude a, uint64_t divisor)
{
	enum { ROOM = 40 };
	return a.m ? magnitude((a.m << ROOM) / divisor + 1, a.e - ROOM) : a;
}

static bool magnitude_above(struct magnitude a, struct magnitude b)
{
	if (a.m == 0 || b.m == 0)
		return a.m != 0;
	return a.e != b.e ? a.e > b.e : a.m > b.m;
}

/* a < 2^result */
static long magnitude_log(struct magnitude a)
{
	return a.e + MAGNITUDE_BITS;
}

static struct magnitude magnitude_of_rational(mpq_srcptr q)
{
	mpz_t quotient;
	if (mpq_sgn(q) == 0)
		return (struct magnitude){ 0, 0 };
	mpz_init(quotient);
	long shift = (long)mpz_sizeinbase(mpq_denref(q), 2) - (long)mpz_sizeinbase(mpq_numref(q), 2) + 40;
	if (shift >= 0) {
		mpz_mul_2exp(quotient, mpq_numref(q), (mp_bitcnt_t)shift);
		mpz_tdiv_q(quotient, quotient, mpq_denref(q));
	} else {
		mpz_mul_2exp(quotient, mpq_denref(q), (mp_bitcnt_t)-shift);
		mpz_tdiv_q(quotient, mpq_numref(q), quotient);
	}
	struct magnitude result = magnitude(mpz_get_ui(quotient) + 1, -shift);      /* the quotient has 40 or 41 bits */
	mpz_clear(quotient);
	return result;
}

/* ---- balls ---- */

struct balls {                      /* a matrix, or a few scalars; row-major */
	int limbs;
	mp_limb_t *limb;            /* of each: least first, the top one not 0 unless `sign` is */
	long *exponent;             /* middle = sign * 0.limbs * 2^(64 exponent) */
	signed char *sign;
	struct magnitude *radius;
	struct magnitude *size;     /* >= |middle| + radius; m = 0: the entry is exactly 0 */
	int n;                      /* of a matrix: where its rows are not exactly 0, */
	int *count, *column;        /* so many columns of each, n places for each */
};

static void scalars_init(struct balls *x, size_t count, int limbs)
{
	*x = (struct balls){ limbs,
			     ARRAY(mp_limb_t, count * (size_t)limbs),
			     ARRAY(long, count),
			     ARRAY(signed char, count),
			     ARRAY(struct magnitude, count),
			     ARRAY(struct magnitude, count),
			     0, NULL, NULL };
}

static void matrix_init(struct balls *x, int n, int limbs)
{
	scalars_init(x, (size_t)n * (size_t)n, limbs);
	x->n = n;
	x->count = ARRAY(int, (size_t)n);
	x->column = ARRAY(int, (size_t)n * (size_t)n);
}

static void balls_clear(struct balls *x)
{
	discard(x->limb);
	discard(x->exponent);
	discard(x->sign);
	discard(x->radius);
	discard(x->size);
	discard(x->count);
	discard(x->column);
}

static void find_pattern(struct balls *x, int row)
{
	int count = 0;
	for (int j = 0; j < x->n; j++)
		if (x->size[row * x->n + j].m)
			x->column[row * x->n + count++] = j;
	x->count[row] = count;
}

static mp_limb_t *limbs_of(const struct balls *x, size_t at)
{
	return x->limb + at * (size_t)x->limbs;
}

static void update_size(struct balls *x, size_t at)
{
	x->size[at] = x->radius[at];
	if (!x->sign[at])
		return;
	mp_limb_t top = limbs_of(x, at)[x->limbs - 1];
	struct magnitude middle = magnitude((top >> 32) + 1, LIMB * (x->exponent[at] - 1) + 32);
	if (top >> 32 == 0)             /* few bits in the top digit: the next one counts */
		middle = magnitude((top << 24 | (x->limbs > 1 ? limbs_of(x, at)[x->limbs - 2] >> 40 : 0)) + 1,
				   LIMB * (x->exponent[at] - 1) - 24);
	x->size[at] = magnitude_add(middle, x->radius[at]);
}

/* q / 2^halvings: truncated, the radius being one unit in the last place, or 0 where that is exact */
static void ball_set_rational(struct balls *x, size_t at, mpq_srcptr q, long halvings)
{
	mpz_t middle, scaled;
	x->sign[at] = (signed char)mpq_sgn(q);
	x->radius[at] = (struct magnitude){ 0, 0 };
	if (x->sign[at] == 0) {
		update_size(x, at);
		return;
	}
	mpz_inits(middle, scaled, NULL);
	/* |x| < 2^bits */
	long bits = (long)mpz_sizeinbase(mpq_numref(q), 2) - (long)mpz_sizeinbase(mpq_denref(q), 2) + 1 - halvings;
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
	memcpy(limbs_of(x, at), mpz_limbs_read(middle), (size_t)x->limbs * sizeof(mp_limb_t));
	x->exponent[at] = exponent;
	if (!exact)
		x->radius[at] = magnitude(1, LIMB * (exponent - x->limbs));
	update_size(x, at);
	mpz_clears(middle, scaled, NULL);
}

/* ---- a row of sums of products: the one operation ---- */

struct row {
	int n, limbs, parts;
	struct part {               /* x[at] times a row of y, which begins at `offset` */
		const struct balls *x, *y;
		size_t at;
		ptrdiff_t offset;
		int count;
		const int *column;
	} *part;
	struct cell {               /* of each sum: largest exponents of its products, of what radii make */
		long top, error_top;
		uint64_t terms, error;
	} *cell;
	mp_limb_t *accumulator, *product;
	int unit;                   /* a column, as a pattern */
};

static void row_init(struct row *row, int n, int capacity, int limbs)
{
	*row = (struct row){ .n = n,
			     .limbs = limbs,
			     .part = ARRAY(struct part, (size_t)capacity),
			     .cell = ARRAY(struct cell, (size_t)n),
			     .accumulator = ARRAY(mp_limb_t, (size_t)n * ((size_t)limbs + 2)),
			     .product = ARRAY(mp_limb_t, 2 * (size_t)limbs) };
}

static void row_clear(struct row *row)
{
	discard(row->part);
	discard(row->cell);
	discard(row->accumulator);
	discard(row->product);
}

/* += x[at] times row i of y; the radii grow by (|x| + r_x) r_y + r_x |y| */
static void add_part(struct row *row, const struct balls *x, size_t at, const struct balls *y, int i)
{
	row->part[row->parts++] = (struct part){ .x = x, .y = y, .at = at, .offset = (ptrdiff_t)i * y->n,
						 .count = y->count[i], .column = y->column + (ptrdiff_t)i * y->n };
}

/* += x[at] y[b] in column j alone */
static void add_one(struct row *row, const struct balls *x, size_t at, const struct balls *y, size_t b, int j)
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
	const mp_limb_t *x = limbs_of(p->x, p->at);
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
		mpn_mul_n(row->product, x + limbs - digits, limbs_of(y, (size_t)b) + limbs - digits, digits);
		add_limbs(row->accumulator + j * (window + 1) + room - length, window + 1 - room + length,
			  row->product + 2 * digits - length, length, sign != y->sign[b]);
	}
}

/* z[at] <- the sum. Radius: inherited, 3 units of the window per product, 1 unit of the result. */
static void round_sum(const struct row *row, int j, struct balls *z, size_t at)
{
	const struct cell *cell = &row->cell[j];
	int limbs = row->limbs, window = limbs + 1, used = window + 1;
	mp_limb_t *accumulator = row->accumulator + j * (window + 1), *result = limbs_of(z, at);
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

/* Row i of z <- the sums, which are empty afterwards */
static void row_finish(struct row *row, struct balls *z, int i)
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
		update_size(z, at);
	}
	find_pattern(z, i);
	row->parts = 0;
}

/* ---- the problem and its plan ---- */

struct taylor {
	int n;
	struct taylor *half;        /* the same A at half the time: this is its square; NULL: a series */
	mpq_t *B;                   /* A tau */
	mpq_t *A, tau;
	struct magnitude *B_size;
	int *distance;              /* n x n: length of the shortest path in B; -1: none */
	long *scale;                /* log2 d_i */
	struct magnitude norm;      /* ||D^-1 |A tau| D|| */
	int depth;                  /* largest distance */
	/* per distance: log2 of the least entry of D^-1 |A tau|^k/k! D first reached there */
	long *least;
	long density[LARGEST_BLOCK + 1];    /* nonzeros of B^q */
	long filled;                /* and of e^B */
	int precision;              /* what `value` is known to; 0: nothing */
	long loss;                  /* bits lost on the way, as far as known */
	struct balls value;
	bool *cyclic;               /* taylor_exact: per state, whether a cycle leads through it; NULL: not yet found */
	bool *survivor;             /* n x n: (A^k)_ij = 0 for n <= k < 2n modulo a prime; NULL: not yet found */
	struct exact_row *row;      /* the last one proved, or NULL */
};

/* Osborne's balancing, on the exponents alone. A state that nothing leads into or out of is scaled until its entries
 * are below 1. */
static void balance(struct taylor *t)
{
	int n = t->n;
	bool moved = true;
	for (int sweep = 0; sweep < BALANCING_SWEEPS && moved; sweep++) {
		moved = false;
		for (int i = 0; i < n; i++) {
			long row = LONG_MIN, column = LONG_MIN, change = 0;
			for (int j = 0; j < n; j++) {
				struct magnitude in_row = t->B_size[i * n + j], in_column = t->B_size[j * n + i];
				long gap = t->scale[j] - t->scale[i];
				if (i != j && in_row.m && magnitude_log(in_row) + gap > row)
					row = magnitude_log(in_row) + gap;
				if (i != j && in_column.m && magnitude_log(in_column) - gap > column)
					column = magnitude_log(in_column) - gap;
			}
			if (row != LONG_MIN && column != LONG_MIN)
				change = (row - column) / 2;
			else if (row > 0)
				change = row;
			else if (column > 0)
				change = -column;
			t->scale[i] += change;
			moved = moved || change != 0;
		}
	}
}

/* the smaller of the row and column sum norms */
static void find_norm(struct taylor *t)
{
	int n = t->n;
	struct magnitude rows = { 0, 0 }, columns = { 0, 0 };
	for (int i = 0; i < n; i++) {
		struct magnitude row = { 0, 0 }, column = { 0, 0 };
		for (int j = 0; j < n; j++) {
			struct magnitude in_row = t->B_size[i * n + j], in_column = t->B_size[j * n + i];
			in_row.e += t->scale[j] - t->scale[i];
			in_column.e += t->scale[i] - t->scale[j];
			row = magnitude_add(row, in_row);
			column = magnitude_add(column, in_column);
		}
		rows = magnitude_above(row, rows) ? row : rows;
		columns = magnitude_above(column, columns) ? column : columns;
	}
	t->norm = magnitude_above(rows, columns) ? columns : rows;
}

/* power <- |B| power / k */
static void next_power(const struct taylor *t, struct magnitude *power, struct magnitude *next, int k)
{
	int n = t->n;
	memset(next, 0, (size_t)n * (size_t)n * sizeof *next);
	for (int i = 0; i < n; i++)
		for (int m = 0; m < n; m++)
			if (t->B_size[i * n + m].m)
				for (int j = 0; j < n; j++)
					if (power[m * n + j].m)
						next[i * n + j] = magnitude_add(next[i * n + j],
										magnitude_mul(t->B_size[i * n + m],
											      power[m * n + j]));
	for (int i = 0; i < n * n; i++)
		power[i] = magnitude_div(next[i], (uint64_t)k);
}

/* Distances, and how small the entries first reached at each distance are: what the length of the series must allow
 * for. */
static void find_distances(struct taylor *t)
{
	int n = t->n;
	struct magnitude *power = ARRAY(struct magnitude, (size_t)(n * n)),
			 *next = ARRAY(struct magnitude, (size_t)(n * n));
	for (int i = 0; i < n * n; i++)
		t->distance[i] = -1;
	for (int i = 0; i < n; i++)
		power[i * n + i] = magnitude(1, 0);
	bool news = true;
	t->depth = -1;
	for (int k = 0; news; k++) {
		if (k > 0)
			next_power(t, power, next, k);
		news = false;
		long count = 0;
		for (int i = 0; i < n; i++)
			for (int j = 0; j < n; j++) {
				struct magnitude size = power[i * n + j];
				count += size.m != 0;
				if (!size.m || t->distance[i * n + j] >= 0)
					continue;
				long log = magnitude_log(size) + t->scale[j] - t->scale[i];
				t->distance[i * n + j] = k;
				t->least[k] = news && t->least[k] < log ? t->least[k] : log;
				t->depth = k;
				news = true;
				t->filled++;
			}
		if (k <= LARGEST_BLOCK)
			for (int q = k; q <= LARGEST_BLOCK; q++)    /* later powers: as this one, until known */
				t->density[q] = count;
	}
	discard(power);
	discard(next);
}

struct taylor *taylor_of(int n, const mpq_t *A, mpq_srcptr tau)
{
	struct taylor *t = NEW(struct taylor);
	size_t cells = (size_t)n * (size_t)n;
	*t = (struct taylor){ .n = n,
			      .A = rationals(cells),
			      .B = rationals(cells),
			      .B_size = ARRAY(struct magnitude, cells),
			      .distance = ARRAY(int, cells),
			      .scale = ARRAY(long, (size_t)n),
			      .least = ARRAY(long, (size_t)n + 1) };
	mpq_init(t->tau);
	mpq_set(t->tau, tau);
	for (size_t i = 0; i < cells; i++) {
		mpq_set(t->A[i], A[i]);
		mpq_mul(t->B[i], A[i], tau);
		t->B_size[i] = magnitude_of_rational(t->B[i]);
	}
	balance(t);
	find_norm(t);
	find_distances(t);
	return t;
}

struct taylor *taylor_doubled(struct taylor *half)
{
	struct taylor *t = NEW(struct taylor);
	*t = (struct taylor){ .n = half->n, .half = half, .A = half->A, .distance = half->distance };
	mpq_init(t->tau);
	mpq_add(t->tau, half->tau, half->tau);
	return t;
}

struct plan {
	long halvings;
	int block, blocks;          /* q; degree + 1 = q * blocks */
	struct magnitude tail;      /* of D^-1 e^B D */
};

/* The least m with b^m/m! < 2^bits and b <= (m + 1)/2, and 2 b^m/m!, which then bounds the tail; 0: none in
 * reason */
static int series_length(struct magnitude b, long bits, struct magnitude *tail)
{
	struct magnitude term = magnitude(1, 0);
	for (int m = 1; m < LARGEST_DEGREE; m++) {
		term = magnitude_div(magnitude_mul(term, b), (uint64_t)m);
		bool short_step = !magnitude_above(b, magnitude((uint64_t)m + 1, -1));
		if (short_step && (term.m == 0 || magnitude_log(term) < bits)) {
			*tail = magnitude_mul(term, magnitude(2, 0));
			return m;
		}
	}
	return 0;
}

/* Products of balls that a plan takes: powers, blocks, squarings */
static long cost(const struct taylor *t, long halvings, int block, int length)
{
	long fill = t->filled / t->n + 1, sum = halvings * t->filled * fill;
	for (int q = 2; q <= block; q++)
		sum += t->density[1] * (t->density[q - 1] / t->n + 1);
	long blocks = (length + block - 1) / block;
	return sum + (blocks - 1) * (t->density[block] * (fill + 1) + (long)(block - 1) * t->filled);
}

/* The cheapest way to 2^-bits of each entry: its least size is some first-reached one's, and an estimate is enough. */
static bool find_plan(const struct taylor *t, long bits, struct plan *best)
{
	enum { FURTHER = 48 };
	long log = t->norm.m ? magnitude_log(t->norm) : 0, from = log > 3 ? log - 3 : 0, least_cost = LONG_MAX;
	if (from + FURTHER > LARGEST_HALVINGS)
		return false;
	for (long halvings = from; halvings <= from + FURTHER; halvings++) {
		struct plan plan = { .halvings = halvings };
		long target = 0;
		for (int k = 0; k <= t->depth; k++)
			target = t->least[k] - halvings * k < target ? t->least[k] - halvings * k : target;
		struct magnitude b = t->norm;
		b.e -= halvings;
		int length = series_length(b, target - bits, &plan.tail);
		for (plan.block = 1; length && plan.block <= LARGEST_BLOCK && plan.block <= length; plan.block++) {
			long price = cost(t, halvings, plan.block, length);
			plan.blocks = (length + plan.block - 1) / plan.block;
			if (price < least_cost) {
				*best = plan;
				least_cost = price;
			}
		}
	}
	return least_cost != LONG_MAX;
}

/* ---- the exponential ---- */

static void multiply(struct row *row, struct balls *z, const struct balls *x, const struct balls *y)
{
	for (int i = 0; i < x->n; i++) {
		progress("e^{A h}, row of a product", i, x->n);
		for (int k = 0; k < x->count[i]; k++) {
			int m = x->column[i * x->n + k];
			add_part(row, x, (size_t)(i * x->n + m), y, m);
		}
		row_finish(row, z, i);
	}
}

/* z <- c x, for the scalar c[at] */
static void scale(struct row *row, struct balls *z, const struct balls *c, size_t at, const struct balls *x)
{
	for (int i = 0; i < x->n; i++) {
		add_part(row, c, at, x, i);
		row_finish(row, z, i);
	}
}

/* c_r = (q j)!/(q j + r)!, r = 0 .. q */
static void block_factors(struct balls *c, int q, int j)
{
	mpq_t factor;
	mpz_t divisor;
	mpq_init(factor);
	mpz_init_set_ui(divisor, 1);
	for (int r = 0; r <= q; r++) {
		if (r > 0)
			mpz_mul_ui(divisor, divisor, (unsigned long)q * (unsigned long)j + (unsigned long)r);
		mpq_set_ui(factor, 1, 1);
		mpz_set(mpq_denref(factor), divisor);
		ball_set_rational(c, (size_t)r, factor, 0);
	}
	mpq_clear(factor);
	mpz_clear(divisor);
}

/* U_j = sum_{r<q} c_r B^r + c_q B^q U_{j+1}; `leading` is c_q B^q, `after` is U_{j+1}, both NULL in the last block */
static void sum_block(struct row *row, struct balls *U, int q, const struct balls *c, const struct balls *power,
		      const struct balls *leading, const struct balls *after)
{
	for (int i = 0; i < U->n; i++) {
		for (int k = 0; leading && k < leading->count[i]; k++) {
			int m = leading->column[i * U->n + k];
			add_part(row, leading, (size_t)(i * U->n + m), after, m);
		}
		add_one(row, c, 0, c, 0, i);    /* c_0 = 1 */
		for (int r = 1; r < q; r++)
			add_part(row, c, (size_t)r, &power[r], i);
		row_finish(row, U, i);
	}
}

static void swap(struct balls *x, struct balls *y)
{
	struct balls kept = *x;
	*x = *y;
	*y = kept;
}

/* e^B without its tail: U_0; `other` is room for a matrix */
static void sum_series(struct row *row, const struct taylor *t, const struct plan *plan, struct balls *U,
		       struct balls *other)
{
	int n = t->n, q = plan->block;
	size_t cells = (size_t)n * (size_t)n;
	struct balls *power = ARRAY(struct balls, (size_t)q + 1), leading, c;   /* power[r] = B^r, r >= 1 */
	for (int r = 1; r <= q; r++)
		matrix_init(&power[r], n, row->limbs);
	matrix_init(&leading, n, row->limbs);
	scalars_init(&c, (size_t)q + 1, row->limbs);
	for (size_t i = 0; i < cells; i++)
		ball_set_rational(&power[1], i, t->B[i], plan->halvings);
	for (int i = 0; i < n; i++)
		find_pattern(&power[1], i);
	for (int r = 2; r <= q; r++)
		multiply(row, &power[r], &power[1], &power[r - 1]);
	for (int j = plan->blocks - 1; j >= 0; j--) {
		bool last = j == plan->blocks - 1;
		block_factors(&c, q, j);
		if (!last)
			scale(row, &leading, &c, (size_t)q, &power[q]);
		sum_block(row, other, q, &c, power, last ? NULL : &leading, last ? NULL : U);
		swap(U, other);
	}
	for (int r = 1; r <= q; r++)
		balls_clear(&power[r]);
	balls_clear(&leading);
	balls_clear(&c);
	discard(power);
}

/* The tail: (d_i/d_j) times that of D^-1 e^B D, where a path leads from i to j */
static void add_tail(const struct taylor *t, struct magnitude tail, struct balls *U)
{
	for (int i = 0; i < t->n; i++)
		for (int j = 0; j < t->n; j++) {
			size_t at = (size_t)(i * t->n + j);
			struct magnitude here = tail;
			here.e += t->scale[i] - t->scale[j];
			if (t->distance[at] >= 0 && here.m) {
				U->radius[at] = magnitude_add(U->radius[at], here);
				update_size(U, at);
			}
		}
	for (int i = 0; i < t->n; i++)
		find_pattern(U, i);
}

/* Keeps exponents far from the limits of a long: what is tiny becomes 0 with a radius. False: some are too large. */
static bool keep_in_range(struct balls *U, size_t cells)
{
	for (size_t i = 0; i < cells; i++) {
		if (!U->size[i].m)
			continue;
		if (magnitude_log(U->size[i]) > LARGEST_EXPONENT)
			return false;
		if (magnitude_log(U->size[i]) < -LARGEST_EXPONENT) {
			U->sign[i] = 0;
			U->radius[i] = magnitude(1, -LARGEST_EXPONENT);
		} else if (U->radius[i].m && magnitude_log(U->radius[i]) < -2 * LARGEST_EXPONENT) {
			U->radius[i] = magnitude(1, -2 * LARGEST_EXPONENT);
		}
		update_size(U, i);
	}
	return true;
}

/* U, which is initialised here, encloses e^{A tau} whatever comes of the precision */
static bool exponential(const struct taylor *t, const struct plan *plan, int limbs, struct balls *U)
{
	int n = t->n;
	size_t cells = (size_t)n * (size_t)n;
	struct balls other;
	struct row row;
	row_init(&row, n, n + LARGEST_BLOCK + 1, limbs);
	matrix_init(U, n, limbs);
	matrix_init(&other, n, limbs);
	sum_series(&row, t, plan, U, &other);
	add_tail(t, plan->tail, U);
	bool in_range = keep_in_range(U, cells);
	for (long k = 0; k < plan->halvings && in_range; k++) {
		multiply(&row, &other, U, U);
		swap(U, &other);
		in_range = keep_in_range(U, cells);
	}
	balls_clear(&other);
	row_clear(&row);
	return in_range;
}

/* log2 of the largest entry over the largest radius */
static long bits_known(const struct balls *U, size_t cells)
{
	struct magnitude size = { 0, 0 }, radius = { 0, 0 };
	for (size_t i = 0; i < cells; i++) {
		size = magnitude_above(U->size[i], size) ? U->size[i] : size;
		radius = magnitude_above(U->radius[i], radius) ? U->radius[i] : radius;
	}
	return radius.m ? magnitude_log(size) - magnitude_log(radius) - 2 : LONG_MAX;
}

/* U, which is initialised here, by a series; false: beyond its limits */
static bool enclose_by_series(struct taylor *t, long bits, struct balls *U)
{
	struct plan plan = { 0 };
	int limbs = (int)((bits + LIMB - 1) / LIMB) + 1;
	if (!find_plan(t, LIMB * (limbs - 1), &plan))
		return false;
	if (exponential(t, &plan, limbs, U))
		return true;
	balls_clear(U);
	return false;
}

/* The same as the square of what it is at half the time */
static bool enclose_by_half(struct taylor *t, long bits, struct balls *U)
{
	struct row row;
	if (!taylor_enclose(t->half, (int)bits))
		return false;
	row_init(&row, t->n, t->n, t->half->value.limbs);
	matrix_init(U, t->n, t->half->value.limbs);
	multiply(&row, U, &t->half->value, &t->half->value);
	row_clear(&row);
	if (keep_in_range(U, (size_t)t->n * (size_t)t->n))
		return true;
	balls_clear(U);
	return false;
}

bool taylor_enclose(struct taylor *t, int precision)
{
	enum { SPARE = 8 };
	size_t cells = (size_t)t->n * (size_t)t->n;
	if (t->precision >= precision)
		return true;
	if (!t->loss)
		t->loss = 2 * SPARE + (t->norm.m && magnitude_log(t->norm) > 0 ? 2 * magnitude_log(t->norm) : 0);
	while (precision + t->loss <= LARGEST_WORK) {
		struct balls U;
		if (!(t->half ? enclose_by_half : enclose_by_series)(t, precision + t->loss, &U))
			return false;
		long known = bits_known(&U, cells);
		if (known >= precision) {
			if (t->precision)
				balls_clear(&t->value);
			t->value = U;
			t->precision = precision;
			return true;
		}
		t->loss += known > 0 ? precision - known + SPARE : t->loss + precision;
		balls_clear(&U);
	}
	return false;
}

/* Bounds are rounded once: MPFR's exponents end at 2^30, and an interval [largest, infinity] still says on which side
 * it is. */
static void set_interval(mpfi_ptr value, mpz_srcptr left, mpz_srcptr right, long exponent)
{
	mpfr_set_z_2exp(&value->left, left, exponent, MPFR_RNDD);
	mpfr_set_z_2exp(&value->right, right, exponent, MPFR_RNDU);
}

void taylor_entry(const struct taylor *t, int i, int j, mpfi_ptr value)
{
	const struct balls *U = &t->value;
	size_t at = (size_t)(i * t->n + j);
	mpz_t left, right, radius;
	mpz_inits(left, right, NULL);
	mpfi_set_prec(value, LIMB * (U->limbs + 1));
	struct magnitude bound = U->radius[at];
	long last = LIMB * (U->exponent[at] - U->limbs);        /* of the middle's last digit */
	if (U->sign[at] == 0 || bound.e - last > LIMB * U->limbs) {
		bound = U->size[at];    /* a middle too uncertain to matter: the interval is about 0 */
		last = bound.e;
	} else {
		mpz_import(left, (size_t)U->limbs, -1, sizeof(mp_limb_t), 0, 0, limbs_of(U, at));
		if (U->sign[at] < 0)
			mpz_neg(left, left);
	}
	mpz_init_set_ui(radius, (unsigned long)bound.m);
	if (bound.e >= last)
		mpz_mul_2exp(radius, radius, (mp_bitcnt_t)(bound.e - last));
	else
		mpz_cdiv_q_2exp(radius, radius, (mp_bitcnt_t)(last - bound.e));
	mpz_add(right, left, radius);
	mpz_sub(left, left, radius);
	set_interval(value, left, right, last);
	mpz_clears(left, right, radius, NULL);
}

/* ---- what is exactly known ----
 * Walks from i to j stay among the states S that i leads to and that lead to j; with N = |S|, Cayley and Hamilton make
 * (A^k)_ij a recurrence of order N in k. If it is 0 for N <= k < 2N, it is 0 for all k >= N, and (e^{A tau})_ij is the
 * polynomial sum_{k<N} (A^k)_ij tau^k/k!; without a cycle in S that needs no test. Otherwise the entry has a pole other
 * than 0. */

static bool leads(const struct taylor *t, int i, int j)
{
	return t->distance[i * t->n + j] >= 0;
}

/* What does not depend on the time is found once. */
static struct taylor *shortest_time(struct taylor *t)
{
	while (t->half)
		t = t->half;
	return t;
}

static bool *find_cyclic(const struct taylor *t)
{
	bool *cyclic = ARRAY(bool, (size_t)t->n);
	for (int i = 0; i < t->n; i++)
		for (int j = 0; j < t->n; j++)
			cyclic[i] = cyclic[i] || (t->B_size[i * t->n + j].m && leads(t, j, i));
	return cyclic;
}

/* S in increasing order; returns N, and whether a cycle lies in it */
static int walked_states(const struct taylor *t, int i, int j, int *state, bool *cycle)
{
	int count = 0;
	*cycle = false;
	for (int k = 0; k < t->n; k++)
		if (leads(t, i, k) && leads(t, k, j)) {
			state[count++] = k;
			*cycle = *cycle || t->cyclic[k];
		}
	return count;
}

/* A modulo a prime of 62 bits that divides no denominator */
static uint64_t reduce(const struct taylor *t, uint64_t *residue)
{
	mpz_t prime, inverse;
	mpz_init_set_ui(prime, 1);
	mpz_init(inverse);
	mpz_mul_2exp(prime, prime, 61);
	int cells = t->n * t->n, done = 0;
	while (done < cells) {
		mpz_nextprime(prime, prime);
		for (done = 0; done < cells && mpz_invert(inverse, mpq_denref(t->A[done]), prime); done++) {
			mpz_mul(inverse, inverse, mpq_numref(t->A[done]));
			mpz_mod(inverse, inverse, prime);
			residue[done] = mpz_get_ui(inverse);
		}
	}
	uint64_t result = mpz_get_ui(prime);
	mpz_clears(prime, inverse, NULL);
	return result;
}

/* row <- x A modulo the prime; eight products of 62-bit factors fit into 127 bits */
static void modular_row(int n, uint64_t prime, const uint64_t *x, const uint64_t *A, unsigned __int128 *sum,
			uint64_t *row)
{
	memset(sum, 0, (size_t)n * sizeof *sum);
	int products = 0;
	for (int k = 0; k < n; k++) {
		if (!x[k])
			continue;
		for (int j = 0; j < n; j++)
			sum[j] += (unsigned __int128)x[k] * A[k * n + j];
		if (++products % 8 == 0)
			for (int j = 0; j < n; j++)
				sum[j] %= prime;
	}
	for (int j = 0; j < n; j++)
		row[j] = (uint64_t)(sum[j] % prime);
}

/* power <- A^exponent modulo the prime */
static void modular_power(int n, uint64_t prime, const uint64_t *A, int exponent, unsigned __int128 *sum,
			  uint64_t *power)
{
	size_t cells = (size_t)n * (size_t)n;
	uint64_t *next = ARRAY(uint64_t, cells);
	memset(power, 0, cells * sizeof *power);
	for (int i = 0; i < n; i++)
		power[i * n + i] = 1;
	int bit = 1;
	while (bit <= exponent / 2)
		bit *= 2;
	for (; bit; bit /= 2) {
		for (int i = 0; i < n; i++)
			modular_row(n, prime, power + i * n, power, sum, next + i * n);
		if (exponent & bit)
			for (int i = 0; i < n; i++)
				modular_row(n, prime, next + i * n, A, sum, power + i * n);
		else
			memcpy(power, next, cells * sizeof *power);
	}
	discard(next);
}

static bool *find_survivors(const struct taylor *t)
{
	int n = t->n;
	size_t cells = (size_t)n * (size_t)n;
	bool *survivor = ARRAY(bool, cells);
	uint64_t *A = ARRAY(uint64_t, cells), *power = ARRAY(uint64_t, cells), *row = ARRAY(uint64_t, (size_t)n);
	unsigned __int128 *sum = ARRAY(unsigned __int128, (size_t)n);
	int *state = ARRAY(int, (size_t)n);
	uint64_t prime = reduce(t, A);
	modular_power(n, prime, A, n, sum, power);
	for (int i = 0; i < n; i++) {
		int left = 0;
		for (int j = 0; j < n; j++) {
			bool cycle = false;
			if (power[i * n + j] == 0 && leads(t, i, j))
				walked_states(t, i, j, state, &cycle);
			survivor[i * n + j] = cycle;
			left += cycle;
		}
		for (int k = n + 1; k < 2 * n && left; k++) {
			modular_row(n, prime, power + i * n, A, sum, row);
			memcpy(power + i * n, row, (size_t)n * sizeof *row);
			for (int j = 0; j < n; j++)
				if (survivor[i * n + j] && row[j]) {
					survivor[i * n + j] = false;
					left--;
				}
		}
	}
	discard(A);
	discard(power);
	discard(row);
	discard(sum);
	discard(state);
	return survivor;
}

/* The block of A over S as integers over their common denominator */
static mpz_t *integer_block(const struct taylor *t, int N, const int *state, mpz_ptr denominator)
{
	mpz_t *block = integers((size_t)N * (size_t)N);
	mpz_set_ui(denominator, 1);
	for (int a = 0; a < N; a++)
		for (int b = 0; b < N; b++)
			mpz_lcm(denominator, denominator, mpq_denref(t->A[state[a] * t->n + state[b]]));
	for (int a = 0; a < N; a++)
		for (int b = 0; b < N; b++) {
			mpq_srcptr entry = t->A[state[a] * t->n + state[b]];
			mpz_divexact(block[a * N + b], denominator, mpq_denref(entry));
			mpz_mul(block[a * N + b], block[a * N + b], mpq_numref(entry));
		}
	return block;
}

/* next <- row block; swapped, so that row is the new one. False: it is 0. */
static bool integer_row(int N, mpz_t *row, mpz_t *next, mpz_t *block)
{
	bool any = false;
	for (int b = 0; b < N; b++)
		mpz_set_ui(next[b], 0);
	for (int a = 0; a < N; a++)
		if (mpz_sgn(row[a]))
			for (int b = 0; b < N; b++)
				if (mpz_sgn(block[a * N + b]))
					mpz_addmul(next[b], row[a], block[a * N + b]);
	for (int b = 0; b < N; b++) {
		mpz_swap(row[b], next[b]);
		any = any || mpz_sgn(row[b]);
	}
	return any;
}

/* For every state of S that may have a polynomial entry in row i: value <- sum_{k<N} (A^k) tau^k/k!, polynomial <-
 * whether all later powers are 0. Kept for the next column, whose S is mostly the same. */
struct exact_row {
	int i, N;
	int *state;                 /* S */
	bool *polynomial;
	mpq_t *value;
};

static void add_power(struct exact_row *found, mpz_t *row, mpq_srcptr weight)
{
	mpq_t term;
	mpq_init(term);
	for (int a = 0; a < found->N; a++)
		if (found->polynomial[a] && mpz_sgn(row[a])) {
			mpq_set_z(term, row[a]);
			mpq_mul(term, term, weight);
			mpq_add(found->value[a], found->value[a], term);
		}
	mpq_clear(term);
}

/* weight <- weight tau/(k denominator) */
static void next_weight(mpq_ptr weight, mpq_srcptr tau, int k, mpz_srcptr denominator)
{
	mpq_t factor;
	mpq_init(factor);
	mpq_set_z(factor, denominator);
	mpq_inv(factor, factor);
	mpq_mul(weight, weight, factor);
	mpq_set_ui(factor, 1, (unsigned long)k);
	mpq_mul(weight, weight, factor);
	mpq_mul(weight, weight, tau);
	mpq_clear(factor);
}

/* Drops the entries whose power is not 0; returns how many are left. */
static int keep_zeros(struct exact_row *found, mpz_t *row)
{
	int left = 0;
	for (int a = 0; a < found->N; a++) {
		found->polynomial[a] = found->polynomial[a] && mpz_sgn(row[a]) == 0;
		left += found->polynomial[a];
	}
	return left;
}

static void find_row(const struct taylor *t, struct exact_row *found)
{
	int N = found->N, left = 1;
	mpz_t denominator, *block, *row = integers((size_t)N), *next = integers((size_t)N);
	mpq_t weight;
	mpz_init(denominator);
	mpq_init(weight);
	mpq_set_ui(weight, 1, 1);
	block = integer_block(t, N, found->state, denominator);
	for (int a = 0; a < N; a++)
		mpz_set_ui(row[a], found->state[a] == found->i);
	for (int k = 0; k < 2 * N && left; k++) {
		if (k > 0 && !integer_row(N, row, next, block))
			break;
		if (k >= N) {
			left = keep_zeros(found, row);
			continue;
		}
		if (k > 0)
			next_weight(weight, t->tau, k, denominator);
		add_power(found, row, weight);
	}
	integers_free(block, (size_t)N * (size_t)N);
	integers_free(row, (size_t)N);
	integers_free(next, (size_t)N);
	mpz_clear(denominator);
	mpq_clear(weight);
}

static struct exact_row *exact_row_of(const struct taylor *t, int i, int N, const int *state, bool cycle)
{
	struct exact_row *found = NEW(struct exact_row);
	*found = (struct exact_row){ i, N, ARRAY(int, (size_t)N), ARRAY(bool, (size_t)N), rationals((size_t)N) };
	for (int a = 0; a < N; a++) {
		found->state[a] = state[a];
		found->polynomial[a] = !cycle || t->survivor[i * t->n + state[a]];
	}
	find_row(t, found);
	return found;
}

static void exact_row_clear(struct exact_row *found)
{
	for (int a = 0; a < found->N; a++)
		mpq_clear(found->value[a]);
	discard(found->value);
	discard(found->polynomial);
	discard(found->state);
	discard(found);
}

/* From the row as found for the same S; sets `exact` if the entry is a polynomial */
static bool polynomial_entry(struct taylor *t, int i, int j, int N, const int *state, bool cycle, mpq_ptr exact)
{
	struct exact_row *found = t->row;
	if (!found || found->i != i || found->N != N || memcmp(found->state, state, (size_t)N * sizeof *state)) {
		if (found)
			exact_row_clear(found);
		found = t->row = exact_row_of(t, i, N, state, cycle);
	}
	for (int a = 0; a < N; a++)
		if (state[a] == j && found->polynomial[a]) {
			mpq_set(exact, found->value[a]);
			return true;
		}
	return false;
}

bool taylor_exact(struct taylor *t, int i, int j, mpq_ptr exact)
{
	mpq_set_ui(exact, mpq_sgn(t->tau) == 0 && i == j, 1);
	if (!leads(t, i, j) || mpq_sgn(t->tau) == 0)
		return true;
	struct taylor *first = shortest_time(t);
	if (!t->cyclic)
		t->cyclic = first->cyclic = first->cyclic ? first->cyclic : find_cyclic(first);
	int *state = ARRAY(int, (size_t)t->n);
	bool cycle;
	int N = walked_states(t, i, j, state, &cycle);
	if (cycle && !t->survivor)
		t->survivor = first->survivor = first->survivor ? first->survivor : find_survivors(first);
	bool polynomial = (!cycle || t->survivor[i * t->n + j]) && polynomial_entry(t, i, j, N, state, cycle, exact);
	discard(state);
	return polynomial;
}
