/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Numbers with bounds for e^{A tau}: every entry is a ball, a middle of `limbs` 64-bit digits with an exponent of its
 * own and a radius of its own. Of math/ alone. */
#ifndef PLGEN_BALLS_H
#define PLGEN_BALLS_H

#include "math/math.h"

enum { LIMB = 64 };

/* ---- magnitudes: upper bounds m 2^e, 2^23 <= m < 2^24 or m = 0; every operation rounds up ---- */

struct magnitude {
	uint64_t m;
	long e;
};

struct magnitude magnitude(uint64_t m, long e);
struct magnitude magnitude_mul(struct magnitude a, struct magnitude b);
struct magnitude magnitude_add(struct magnitude a, struct magnitude b);
struct magnitude magnitude_div(struct magnitude a, uint64_t divisor);
bool magnitude_above(struct magnitude a, struct magnitude b);
long magnitude_log(struct magnitude a);         /* a < 2^result */
struct magnitude magnitude_of_rational(mpq_srcptr q);

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

void balls_init(struct balls *x, size_t count, int limbs);
void balls_init_matrix(struct balls *x, int n, int limbs);
void balls_clear(struct balls *x);
void balls_find_row(struct balls *x, int row);          /* where it is not exactly 0 */
mp_limb_t *ball_limbs(const struct balls *x, size_t at);
void ball_update_size(struct balls *x, size_t at);
/* q / 2^halvings: truncated, the radius being one unit in the last place, or 0 where that is exact */
void ball_set_rational(struct balls *x, size_t at, mpq_srcptr q, long halvings);

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

void row_init(struct row *row, int n, int capacity, int limbs);
void row_clear(struct row *row);
/* += x[at] times row i of y; the radii grow by (|x| + r_x) r_y + r_x |y| */
void row_add_part(struct row *row, const struct balls *x, size_t at, const struct balls *y, int i);
/* += x[at] y[b] in column j alone */
void row_add_one(struct row *row, const struct balls *x, size_t at, const struct balls *y, size_t b, int j);
/* Row i of z <- the sums, which are empty afterwards */
void row_finish(struct row *row, struct balls *z, int i);

#endif
