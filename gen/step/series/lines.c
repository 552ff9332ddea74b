/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A long series as a loop over k, not as a statement for each coefficient of each sequence: the coefficients stand in a
 * table, and turn k of the loop makes the next of every sequence from those that the table has. Not all of them have
 * the same place: of a derivative in time less are there, of an integral more, as Pryce's offsets say (BIT 41, 2001).
 * What precedes the first turn is made as in a short series. */
#include "inner.h"

#include <string.h>

/* ---- which coefficient of a sequence a turn makes ---- */

static bool lower(int *offset, int most)
{
	const bool lowered = *offset > most;
	*offset = lowered ? most : *offset;
	return lowered;
}

/* Of what a sequence reads at offset o it has to be made by then: o, of an integral o - 1, of a rate o + 1. */
static int read_at(const struct sequence *s, int offset)
{
	return offset - (s->kind == SEQUENCE_INTEGRAL) + (s->kind == SEQUENCE_RATE);
}

static bool lower_offset(const struct expansion *x, int *offset, int index)
{
	const struct sequence *s = &x->sequence[index];
	SCRATCH int *operand = NULL;
	bool lowered = false;
	for (int i = sequence_operands(s, &operand) - 1; i >= 0; i--)
		lowered |= lower(&offset[index], offset[operand[i]] - read_at(s, 0));
	return lowered;
}

static int *find_offsets(const struct expansion *x)
{
	int *offset = ARRAY(int, x->count);
	for (int i = 0; i < x->count; i++)
		offset[i] = x->sequence[i].kind == SEQUENCE_INTEGRAL || x->sequence[i].ahead;
	for (bool lowered = true; lowered;) {
		lowered = false;
		for (int i = 0; i < x->count; i++)
			lowered |= x->sequence[i].top > 0 && lower_offset(x, offset, i);
	}
	return offset;
}

/* ---- which sequences have a row ---- */

static void keep(struct lines *l, int sequence)
{
	l->row[sequence] = 0;
}

/* Factors of products, divisors and bases are read at all k so far; and what was made in a turn before. */
static void keep_operands(const struct expansion *x, struct lines *l, int index)
{
	const struct sequence *s = &x->sequence[index];
	SCRATCH int *operand = NULL;
	for (int i = sequence_operands(s, &operand) - 1; i >= 0; i--)
		if (read_at(s, l->offset[index]) < l->offset[operand[i]])
			keep(l, operand[i]);
	for (int i = 0; i < s->terms; i++)
		if (s->term[i].kind == TERM_PRODUCT) {
			keep(l, s->term[i].a);
			keep(l, s->term[i].b);
		}
	if (s->kind == SEQUENCE_QUOTIENT || s->kind == SEQUENCE_ROOT || s->kind == SEQUENCE_POWER)
		keep(l, index);
	if (s->kind == SEQUENCE_QUOTIENT)
		keep(l, s->b);
	if (s->kind == SEQUENCE_POWER)
		keep(l, s->a);
	if (s->kind == SEQUENCE_SOLUTION)
		keep(l, index);
}

static void number_rows(const struct expansion *x, struct lines *l)
{
	for (int i = 0; i < x->count; i++)
		l->row[i] = l->row[i] == NONE ? NONE : l->rows++;
}

struct lines *lines_of(const struct expansion *x, int states)
{
	struct lines *l = NEW(struct lines);
	int deepest = 0, last = x->order - 1;
	l->offset = find_offsets(x);
	l->row = ARRAY(int, x->count);
	for (int i = 0; i < x->count; i++)
		l->row[i] = i < states ? 0 : NONE;
	for (int i = 0; i < x->columns; i++) {
		const int turns = x->column_top[i] - l->offset[x->column[i]];
		keep(l, x->column[i]);
		last = turns > last ? turns : last;
	}
	for (int i = 0; i < x->count; i++) {
		if (x->sequence[i].top <= 0)    /* no turn makes it */
			continue;
		keep_operands(x, l, i);
		deepest = l->offset[i] < deepest ? l->offset[i] : deepest;
	}
	number_rows(x, l);
	l->first = 1 - deepest;
	l->last = last;
	l->width = (last > l->first ? last : l->first) + 2;
	return l;
}

/* ---- what the loop reads ---- */

int stage_value(struct lines *l, struct stage_value value)
{
	for (int i = 0; i < l->values; i++) {
		const struct stage_value *known = &l->value[i];
		if (known->kind == value.kind && known->a == value.a && known->b == value.b &&
		    known->offset == value.offset && known->exponent == value.exponent)
			return i;
	}
	*MORE(l->value, l->values) = value;
	return l->values - 1;
}

int stage_factors(struct lines *l, const double *factor, int count)
{
	SCRATCH double *all = ARRAY(double, l->width);
	for (int k = 0; k < count && k < l->width; k++)
		all[k] = factor[k];
	for (int i = 0; i < l->factors; i++)
		if (memcmp(l->factor[i], all, (size_t)l->width * sizeof *all) == 0)
			return i;
	double *own = ARRAY(double, l->width);
	memcpy(own, all, (size_t)l->width * sizeof *all);
	*MORE(l->factor, l->factors) = own;
	return l->factors - 1;
}

/* ---- equations that are solved by lists ---- */

bool is_listed(const struct linear_equations *e)
{
	return e->n > LISTED_EQUATIONS;
}

bool is_symmetric_system(const struct linear_equations *e)
{
	for (int i = 0; i < e->n; i++)
		for (int j = 0; j < i; j++)
			if (e->matrix[i * e->n + j] != e->matrix[j * e->n + i])
				return false;
	return true;
}

int *system_columns(const struct linear_equations *e, int *first)
{
	const int n = e->n;
	SCRATCH bool *filled = ARRAY(bool, n * n);
	for (int i = 0; i < n * n; i++)
		filled[i] = e->matrix[i] != NONE || e->matrix[i % n * n + i / n] != NONE;
	return factor_columns(n, filled, first);
}

/* ---- its C ---- */

const char *stage_index(int offset)
{
	return offset == 0 ? "k_by_0" : offset > 0 ? format("k_by_0 + %d", offset) : format("k_by_0 - %d", -offset);
}
