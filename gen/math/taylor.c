/* SPDX-License-Identifier: GPL-3.0-or-later */
/* e^{A tau} for models whose residues would be slow: e^B by its Taylor series, B = A tau / 2^s, then s squarings.
 *
 * Entries are balls, with exponents and radii of their own. Errors stay below a small multiple of
 * 2^-p (e^{|A| tau})_ij, entry by entry: |XY| <= |X||Y|, and e^{|A|tau/2} e^{|A|tau/2} = e^{|A|tau}. So an entry of
 * size 1e-200 (the far end of a chain, a short step) has as many good digits as the largest, in whatever units the
 * states are.
 *
 * The series is summed in blocks of q powers (Paterson and Stockmeyer, SIAM J. Comput. 2, 1973); q = 1 is Horner's rule
 * with the sparse B. Its tail needs a norm: with D a diagonal of powers of two and b = ||D^-1 |B| D||, |sum_{k>=m}
 * B^k/k!|_ij <= (d_i/d_j) b^m/m! / (1 - b/(m+1)), and D only serves this estimate. Where no path of A leads from i to j
 * the entry is exactly 0 and stays so. */
#include "math/taylor.h"

#include <limits.h>
#include <string.h>

enum {
	LARGEST_HALVINGS = 512,
	LARGEST_DEGREE = 1 << 16,
	LARGEST_WORK = 4 * LIMIT_PRECISION,
	BALANCING_SWEEPS = 24
};
static const long LARGEST_EXPONENT = LONG_MAX / 128;        /* bits; entries below 2^-this become 0 with that radius */

/* ---- the problem and its plan ---- */

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
	SCRATCH struct magnitude *power = ARRAY(struct magnitude, (size_t)(n * n)),
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
			      .scale = ARRAY(long, n),
			      .least = ARRAY(long, n + 1) };
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
static int64_t cost(const struct taylor *t, long halvings, int block, int length)
{
	int64_t fill = t->filled / t->n + 1, sum = halvings * t->filled * fill;
	for (int q = 2; q <= block; q++)
		sum += t->density[1] * (t->density[q - 1] / t->n + 1);
	int64_t blocks = (length + block - 1) / block;
	return sum + (blocks - 1) * (t->density[block] * (fill + 1) + (block - 1) * t->filled);
}

/* The cheapest way to 2^-bits of each entry: its least size is some first-reached one's, and an estimate is enough. */
static bool find_plan(const struct taylor *t, long bits, struct plan *best)
{
	enum { FURTHER = 48 };
	long log = t->norm.m ? magnitude_log(t->norm) : 0, from = log > 3 ? log - 3 : 0;
	int64_t least_cost = INT64_MAX;
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
			int64_t price = cost(t, halvings, plan.block, length);
			plan.blocks = (length + plan.block - 1) / plan.block;
			if (price < least_cost) {
				*best = plan;
				least_cost = price;
			}
		}
	}
	return least_cost != INT64_MAX;
}

/* ---- the exponential ---- */

static void multiply(struct row *row, struct balls *z, const struct balls *x, const struct balls *y)
{
	for (int i = 0; i < x->n; i++) {
		progress("e^{A h}, row of a product", i, x->n);
		for (int k = 0; k < x->count[i]; k++) {
			int m = x->column[i * x->n + k];
			row_add_part(row, x, (size_t)(i * x->n + m), y, m);
		}
		row_finish(row, z, i);
	}
}

/* z <- c x, for the scalar c[at] */
static void scale(struct row *row, struct balls *z, const struct balls *c, size_t at, const struct balls *x)
{
	for (int i = 0; i < x->n; i++) {
		row_add_part(row, c, at, x, i);
		row_finish(row, z, i);
	}
}

/* c_r = (q j)!/(q j + r)!, r = 0 .. q */
static void block_factors(struct balls *c, int q, int j)
{
	RATIONAL factor = ZERO;
	INTEGER divisor = INTEGER_ZERO;
	mpz_set_ui(divisor, 1);
	for (int r = 0; r <= q; r++) {
		if (r > 0)
			mpz_mul_ui(divisor, divisor, (unsigned long)q * (unsigned long)j + (unsigned long)r);
		mpq_set_ui(factor, 1, 1);
		mpz_set(mpq_denref(factor), divisor);
		ball_set_rational(c, (size_t)r, factor, 0);
	}
}

/* U_j = sum_{r<q} c_r B^r + c_q B^q U_{j+1}; `leading` is c_q B^q, `after` is U_{j+1}, both NULL in the last block */
static void sum_block(struct row *row, struct balls *U, int q, const struct balls *c, const struct balls *power,
		      const struct balls *leading, const struct balls *after)
{
	for (int i = 0; i < U->n; i++) {
		for (int k = 0; leading && k < leading->count[i]; k++) {
			int m = leading->column[i * U->n + k];
			row_add_part(row, leading, (size_t)(i * U->n + m), after, m);
		}
		row_add_one(row, c, 0, c, 0, i);    /* c_0 = 1 */
		for (int r = 1; r < q; r++)
			row_add_part(row, c, (size_t)r, &power[r], i);
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
	struct balls *power = ARRAY(struct balls, q + 1), leading, c;   /* power[r] = B^r, r >= 1 */
	for (int r = 1; r <= q; r++)
		balls_init_matrix(&power[r], n, row->limbs);
	balls_init_matrix(&leading, n, row->limbs);
	balls_init(&c, (size_t)q + 1, row->limbs);
	for (size_t i = 0; i < cells; i++)
		ball_set_rational(&power[1], i, t->B[i], plan->halvings);
	for (int i = 0; i < n; i++)
		balls_find_row(&power[1], i);
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
				ball_update_size(U, at);
			}
		}
	for (int i = 0; i < t->n; i++)
		balls_find_row(U, i);
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
		ball_update_size(U, i);
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
	balls_init_matrix(U, n, limbs);
	balls_init_matrix(&other, n, limbs);
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
	balls_init_matrix(U, t->n, t->half->value.limbs);
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
	INTEGER left = INTEGER_ZERO, right = INTEGER_ZERO, radius = INTEGER_ZERO;
	mpfi_set_prec(value, LIMB * (U->limbs + 1));
	struct magnitude bound = U->radius[at];
	long last = LIMB * (U->exponent[at] - U->limbs);        /* of the middle's last digit */
	if (U->sign[at] == 0 || bound.e - last > LIMB * U->limbs) {
		bound = U->size[at];    /* a middle too uncertain to matter: the interval is about 0 */
		last = bound.e;
	} else {
		mpz_import(left, (size_t)U->limbs, -1, sizeof(mp_limb_t), 0, 0, ball_limbs(U, at));
		if (U->sign[at] < 0)
			mpz_neg(left, left);
	}
	mpz_import(radius, 1, -1, sizeof bound.m, 0, 0, &bound.m);
	if (bound.e >= last)
		mpz_mul_2exp(radius, radius, (mp_bitcnt_t)(bound.e - last));
	else
		mpz_cdiv_q_2exp(radius, radius, (mp_bitcnt_t)(last - bound.e));
	mpz_add(right, left, radius);
	mpz_sub(left, left, radius);
	set_interval(value, left, right, last);
}
