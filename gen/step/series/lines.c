/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A long series as a loop over k, not as a statement for each coefficient of each sequence: the coefficients stand in a
 * table, and turn k of the loop makes the next of every sequence from those that the table has. Not all of them have
 * the same place: of a derivative in time less are there, of an integral more, as Pryce's offsets say (BIT 41, 2001).
 * What precedes the first turn is made as in a short series. */
#include "inner.h"

#include <stdlib.h>
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

/* ---- rows of like elements, side by side ---- */

enum { SQUARED = 1, FIRST = 2, SECOND = 4, FEWEST_ALIKE = 4 };

/* Products that turns make, by their sequences; use: per sequence, in what products it stands */
static int list_products(const struct expansion *x, struct product_run **product, int *use)
{
	int count = 0;
	for (int i = 0; i < x->count; i++)
		for (int k = 0; k < x->sequence[i].terms && x->sequence[i].top > 0; k++) {
			const struct sequence_term *term = &x->sequence[i].term[k];
			if (term->kind != TERM_PRODUCT)
				continue;
			use[term->a] |= term->a == term->b ? SQUARED : FIRST;
			use[term->b] |= term->a == term->b ? SQUARED : SECOND;
			*MORE(*product, count) = (struct product_run){ .a = term->a, .b = term->b, .count = 1 };
		}
	return count;
}

static bool is_alike(const struct expansion *x, const struct lines *l, const int *use, int i, int j)
{
	const struct sequence *a = &x->sequence[i], *b = &x->sequence[j];
	if (a->state != NONE || b->state != NONE)
		return a->state != NONE && b->state != NONE;
	bool alike = a->kind == b->kind && a->terms == b->terms && use[i] == use[j] && l->offset[i] == l->offset[j];
	for (int k = 0; alike && k < a->terms; k++)
		alike = a->term[k].kind == b->term[k].kind;
	return alike;
}

/* Rows that follow those of the first that is like them */
static int *rows_by_kind(const struct expansion *x, const struct lines *l, const int *use)
{
	int *row = ARRAY(int, x->count), rows = 0;
	for (int i = 0; i < x->count; i++)
		row[i] = NONE;
	for (int i = 0; i < x->count; i++)
		for (int j = i, first = row[i]; j < x->count && first == NONE && l->row[i] != NONE; j++)
			if (l->row[j] != NONE && row[j] == NONE && is_alike(x, l, use, i, j))
				row[j] = rows++;
	return row;
}

/* As runs join them: those of one distance between the factors together, rising */
static int by_rows(const void *a, const void *b)
{
	const struct product_run *p = a, *q = b;
	const int distance = (p->b - p->a) - (q->b - q->a);
	return p->offset != q->offset ? p->offset - q->offset : distance ? distance : p->a - q->a;
}

/* Products of which each follows the one before in both rows become one run; said is how many runs are left. */
static int join_products(int count, struct product_run *product)
{
	int runs = 0;
	qsort(product, (size_t)count, sizeof *product, by_rows);
	for (int i = 0; i < count; i++) {
		struct product_run *last = runs ? &product[runs - 1] : NULL;
		const bool follows = last && product[i].a == last->a + last->count &&
				     product[i].b == last->b + last->count && product[i].offset == last->offset;
		if (follows)
			last->count++;
		else
			product[runs++] = product[i];
	}
	return runs;
}

/* Where most products are those of like elements rows are numbered so that these are made side by side. */
static void place_alike(const struct expansion *x, struct lines *l)
{
	SCRATCH int *use = ARRAY(int, x->count);
	struct product_run *product = NULL;
	const int count = list_products(x, &product, use);
	int *row = rows_by_kind(x, l, use), joined = 0;
	for (int i = 0; i < count; i++) {
		product[i].a = row[product[i].a];
		product[i].b = row[product[i].b];
	}
	for (int i = join_products(count, product) - 1; i >= 0; i--)
		joined += product[i].count >= FEWEST_ALIKE ? product[i].count : 0;
	l->across = 4 * joined >= 3 * count && count > 0;
	l->row = l->across ? row : l->row;
}

void find_runs(struct lines *l)
{
	struct product_run *product = NULL;
	int count = 0;
	l->place = ARRAY(int, l->values + 1);
	l->runs = l->inners = 0;
	for (int i = 0; i < l->values; i++) {
		const struct stage_value *v = &l->value[i];
		const bool made = l->offset[v->a] >= v->offset && l->offset[v->b] >= v->offset;
		l->place[i] = NONE;
		if (l->across && made && (v->kind == STAGE_INNER || v->kind == STAGE_SQUARE))
			*MORE(product, count) = (struct product_run){ l->row[v->a], l->row[v->b], v->offset, 1, i };
	}
	SCRATCH struct product_run *run = ARRAY(struct product_run, count + 1);
	for (int i = 0; i < count; i++)
		run[i] = product[i];
	const int runs = join_products(count, run);
	if (count > 0)
		qsort(product, (size_t)count, sizeof *product, by_rows);
	for (int i = 0, k = 0; i < runs; k += run[i++].count) {
		if (run[i].count < FEWEST_ALIKE)
			continue;
		*MORE(l->run, l->runs) = run[i];
		for (int j = 0; j < run[i].count; j++)
			l->place[product[k + j].value] = l->inners++;
	}
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
	place_alike(x, l);
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

const char *line_place(const struct lines *l, int sequence, const char *k)
{
	const int row = l->row[sequence];
	return l->across ? format("table_by_0[%s][%d]", k, row) : format("table_by_0[%d][%s]", row, k);
}

const char *stage_index(int offset)
{
	return offset == 0 ? "k_by_0" : offset > 0 ? format("k_by_0 + %d", offset) : format("k_by_0 - %d", -offset);
}
