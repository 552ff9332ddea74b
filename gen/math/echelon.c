/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows of rationals that come one by one, reduced as they come (Gauss and Jordan), and what all of them annihilate. */
#include "math/math.h"

void rational_subtract_row(int n, mpq_t *target, const mpq_t *row, mpq_srcptr factor)
{
	for (int j = 0; j < n; j++) {
		if (mpq_sgn(row[j]) == 0)
			continue;
		rational_submul(target[j], row[j], factor);
	}
}

struct echelon echelon_new(int width)
{
	return (struct echelon){ width, 0, ARRAY(mpq_t *, width), ARRAY(int, width) };
}

void echelon_add(struct echelon *e, mpq_t *row)
{
	int pivot = 0;
	RATIONAL factor = ZERO;
	for (int r = 0; r < e->rank; r++) {
		mpq_set(factor, row[e->pivot[r]]);
		if (mpq_sgn(factor) != 0)
			rational_subtract_row(e->width, row, e->row[r], factor);
	}
	while (pivot < e->width && mpq_sgn(row[pivot]) == 0)
		pivot++;
	if (pivot < e->width) {
		mpq_inv(factor, row[pivot]);
		for (int j = 0; j < e->width; j++)
			mpq_mul(row[j], row[j], factor);
		for (int r = 0; r < e->rank; r++) {
			mpq_set(factor, e->row[r][pivot]);
			if (mpq_sgn(factor) != 0)
				rational_subtract_row(e->width, e->row[r], row, factor);
		}
		e->row[e->rank] = row;
		e->pivot[e->rank++] = pivot;
	}
}

int echelon_null_space(const struct echelon *e, mpq_t ***basis)
{
	int count = 0;
	bool *pivot = ARRAY(bool, e->width);
	*basis = ARRAY(mpq_t *, e->width);
	for (int r = 0; r < e->rank; r++)
		pivot[e->pivot[r]] = true;
	for (int j = 0; j < e->width; j++) {
		if (pivot[j])
			continue;
		mpq_t *v = rationals(e->width);
		mpq_set_ui(v[j], 1, 1);
		for (int r = 0; r < e->rank; r++)
			mpq_neg(v[e->pivot[r]], e->row[r][j]);
		(*basis)[count++] = v;
	}
	return count;
}
