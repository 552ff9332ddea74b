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

/* Nothing stays of what a row has at the pivot of another. */
static void clear_pivot(const struct echelon *e, mpq_t *row, int by)
{
	RATIONAL factor = ZERO;
	mpq_set(factor, row[e->pivot[by]]);
	if (mpq_sgn(factor) != 0)
		rational_subtract_row(e->width, row, e->row[by], factor);
}

void echelon_pivot(struct echelon *e, int r, int pivot)
{
	RATIONAL scale = ZERO;
	mpq_set(scale, e->row[r][pivot]);
	for (int j = 0; j < e->width; j++)
		mpq_div(e->row[r][j], e->row[r][j], scale);
	e->pivot[r] = pivot;
	for (int i = 0; i < e->rank; i++)
		if (i != r)
			clear_pivot(e, e->row[i], r);
}

void echelon_add(struct echelon *e, mpq_t *row)
{
	int pivot = 0;
	for (int r = 0; r < e->rank; r++)
		clear_pivot(e, row, r);
	while (pivot < e->width && mpq_sgn(row[pivot]) == 0)
		pivot++;
	if (pivot == e->width)
		return;
	e->row[e->rank] = row;
	echelon_pivot(e, e->rank++, pivot);
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
