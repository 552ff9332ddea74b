/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "reference.h"

#include "equations.h"

#include "../accuracy/evaluator.h"
#include "../accuracy/rationals.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Entries after the states, with their own rows: "1"; "t" after 1; "tt" after t; "cA,W sA,W" e^{A t} cos(W t) and sin,
 * W with "pi" in front is multiplied by pi; "u v" inputs and "p q" their slopes. */
static const struct reference_table {
	const char *name;
	int states;
	const char *left;                   /* states x states, what multiplies x'; NULL: unity */
	const char *entries, *changes;
	const char *rows[REFERENCE_MOST_SEGMENTS];  /* states x size */
} tables[] = {
	{"maxwell", 3, NULL, "c0,4 s0,4", "",
	 {"0 0 1 0 0  0 -25/2 50 0 0  -15 -1/2 0 3/2 0"}},
	{"resonance", 2, NULL, "c-1,3 s-1,3", "",
	 {"0 1 0 0  -10 -2 4 0"}},
	{"ramps", 4, NULL, "1 t tt", "",
	 {"0 0 1 0 0 0 0  0 0 0 1 0 0 0  0 0 0 0 0 2/3 -1/12  0 -9 0 -2/5 1 -1 1"}},
	{"vector3", 6, "1 0 0 0 0 0  0 1 0 0 0 0  0 0 1 0 0 0  0 0 0 3 0.5 0.25  0 0 0 0.5 2 0.5  0 0 0 0.25 0.5 1",
		"c0,3 s0,3", "",
	 {"0 0 0 1 0 0 0 0  0 0 0 0 1 0 0 0  0 0 0 0 0 1 0 0 "
	  "-70 30 5  -0.85 0.275 0.0375  0 1 "
	  "30 -60 20  0.275 -0.7 0.175  0 0 "
	  "5 20 -40  0.0375 0.175 -0.45  0 -2"}},
	{"growing", 2, NULL, "c0.05,0 s0.05,0", "",
	 {"0 1 0 0  -4 0.1 1 0"}},
	{"far_free", 4, NULL, "", "",
	 {"0 0 1 0  0 0 0 1  -200 100 0 0  100 -200 0 0"}},
	{"far_wave", 4, NULL, "c0,5.3 s0,5.3", "",
	 {"0 0 1 0 0 0  0 0 0 1 0 0  -200 100 0 0 20 0  100 -200 0 0 0 0"}},
	{"far_damped", 4, NULL, "c0,5.3 s0,5.3", "",
	 {"0 0 1 0 0 0  0 0 0 1 0 0  -200 100 -1e-9 0 20 0  100 -200 0 -1e-9 0 0"}},
	{"pulse", 2, NULL, "c0,pi5/3 s0,pi5/3 c0,1 s0,1 1 t", "3/5 1 1003/1000 201/200 403/400",
	 {"0 1 0 0 0 0 0 0  -20 -0.3 0 10 0 0 1 -1",
	  "0 1 0 0 0 0 0 0  -20 -0.3 0 0 0 0 1 -1",
	  "0 1 0 0 0 0 0 0  -20 -0.3 0 0 0 0 -1 1",
	  "0 1 0 0 0 0 0 0  -20 -0.3 0 0 0 0 39 1",
	  "0 1 0 0 0 0 0 0  -20 -0.3 0 0 0 0 -1 -19",
	  "0 1 0 0 0 0 0 0  -20 -0.3 0 0 1 0 -1 1"}},
	{"held2", 4, NULL, "u v p q", "",
	 {"0 0 1 0 0 0 0 0  0 0 0 1 0 0 0 0  -80/3 20/3 -1/5 0 4/3 -2/3 0 0  10 -25 1/10 -1/5 1/2 3 0 0"}},
	{"ramped2", 4, NULL, "u v p q", "",
	 {"0 0 1 0 0 0 0 0  0 0 0 1 0 0 0 0  -80/3 20/3 -1/5 0 4/3 -2/3 4/15 0  10 -25 1/10 -1/5 1/2 3 0 0"}},
	{"first2", 4, NULL, "u v p q", "",
	 {"0 0 1 0 0 0 0 0  0 0 0 1 0 0 0 0  -49/2 9/2 -3/200 0 20 0 3/200 0  9 -34 0 -1/5 1/2 25 0 1/5"}}};

static const char *next_rational(const char *text, mpq_t q)
{
	char word[60];
	int length = 0;
	if (sscanf(text, "%59s%n", word, &length) != 1 || rational_parse(q, word) != 0)
		abort();
	return text + length;
}

struct entry {
	char kind[60];
	mpq_t a, w;
};

/* false after the last one */
static bool next_entry(const char **text, struct entry *e)
{
	int length = 0;
	if (sscanf(*text, "%59s%n", e->kind, &length) != 1)
		return false;
	*text += length;
	if ((e->kind[0] == 'c' || e->kind[0] == 's')) {
		char *w = strchr(e->kind, ',');
		*w++ = '\0';
		const bool pi = strncmp(w, "pi", 2) == 0;
		if (rational_parse(e->a, e->kind + 1) != 0 || rational_parse(e->w, pi ? w + 2 : w) != 0)
			abort();
		if (pi) {
			mpfr_t x;
			mpfr_init2(x, REFERENCE_PRECISION);
			mpfr_const_pi(x, MPFR_RNDN);
			mpfr_mul_q(x, x, e->w, MPFR_RNDN);
			mpfr_get_q(e->w, x);
			mpfr_clear(x);
		}
	}
	return true;
}

static void fill_entries(const struct reference *r, mpq_t *A)
{
	const int n = r->size;
	const char *text = r->table->entries;
	struct entry e;
	mpq_inits(e.a, e.w, NULL);
	for (int i = r->states; next_entry(&text, &e); i++) {
		mpq_t *row = A + i * n;
		switch (e.kind[0]) {
		case 't': mpq_set_ui(row[i - 1], e.kind[1] ? 2 : 1, 1); break;
		case 'c': mpq_set(row[i], e.a); mpq_neg(row[i + 1], e.w); break;
		case 's': mpq_set(row[i], e.a); mpq_set(row[i - 1], e.w); break;
		case 'u': case 'v': mpq_set_ui(row[i + 2], 1, 1); break;
		default: break;
		}
	}
	mpq_clears(e.a, e.w, NULL);
}

/* rows <- left^-1 rows, by elimination without pivoting: left is positive definite */
static void solve_left(const struct reference *r, mpq_t *A)
{
	const int n = r->size, m = r->states;
	mpq_t *left = new_rationals(m * m), *f = new_rationals(2);
	const char *text = r->table->left;
	for (int i = 0; i < m * m; i++)
		text = next_rational(text, left[i]);
	for (int k = 0; k < m; k++)
		for (int i = 0; i < m; i++) {
			if (i == k)
				continue;
			mpq_div(f[0], left[i * m + k], left[k * m + k]);
			for (int j = 0; j < n; j++) {
				mpq_mul(f[1], f[0], A[k * n + j]);
				mpq_sub(A[i * n + j], A[i * n + j], f[1]);
			}
			for (int j = 0; j < m; j++) {
				mpq_mul(f[1], f[0], left[k * m + j]);
				mpq_sub(left[i * m + j], left[i * m + j], f[1]);
			}
		}
	for (int k = 0; k < m; k++)
		for (int j = 0; j < n; j++)
			mpq_div(A[k * n + j], A[k * n + j], left[k * m + k]);
	free_rationals(left, m * m);
	free_rationals(f, 2);
}

struct reference *reference_of(const char *name)
{
	const struct reference_table *table = NULL;
	for (size_t i = 0; i < sizeof tables / sizeof *tables; i++)
		if (strcmp(tables[i].name, name) == 0)
			table = &tables[i];
	struct reference *r = calloc(1, sizeof *r);
	if (!table || !r)
		abort();
	r->name = name;
	r->table = table;
	r->states = r->size = table->states;
	char word[60];
	int length;
	for (const char *s = table->entries; sscanf(s, "%59s%n", word, &length) == 1; s += length)
		r->size++;
	const char *change = table->changes;
	for (; r->segments < REFERENCE_MOST_SEGMENTS && table->rows[r->segments]; r->segments++) {
		const char *text = table->rows[r->segments];
		mpq_t *A = r->A[r->segments] = new_rationals(r->size * r->size);
		for (int i = 0; i < r->states * r->size; i++)
			text = next_rational(text, A[i]);
		if (table->left)
			solve_left(r, A);
		fill_entries(r, A);
		mpq_init(r->change[r->segments]);
		if (table->rows[r->segments + 1])
			change = next_rational(change, r->change[r->segments]);
	}
	return r;
}

void reference_free(struct reference *r)
{
	for (int i = 0; i < r->segments; i++) {
		free_rationals(r->A[i], r->size * r->size);
		mpq_clear(r->change[i]);
	}
	free(r);
}

mpfr_t *new_floats(int count)
{
	mpfr_t *x = malloc((size_t)count * sizeof *x);
	if (!x)
		abort();
	for (int i = 0; i < count; i++) {
		mpfr_init2(x[i], REFERENCE_PRECISION);
		mpfr_set_zero(x[i], 1);
	}
	return x;
}

void free_floats(mpfr_t *x, int count)
{
	for (int i = 0; i < count; i++)
		mpfr_clear(x[i]);
	free(x);
}

void reference_start(const struct reference *r, const mpq_t t, const double *y, mpfr_t *x)
{
	struct entry e;
	mpfr_t angle;
	const char *text = r->table->entries;
	mpq_inits(e.a, e.w, NULL);
	mpfr_init2(angle, REFERENCE_PRECISION);
	for (int i = 0; i < r->states; i++)
		mpfr_set_d(x[i], y[i], MPFR_RNDN);
	for (int i = r->states; next_entry(&text, &e); i++) {
		switch (e.kind[0]) {
		case '1': mpfr_set_ui(x[i], 1, MPFR_RNDN); break;
		case 't':
			mpfr_set_q(x[i], t, MPFR_RNDN);
			if (e.kind[1])
				mpfr_sqr(x[i], x[i], MPFR_RNDN);
			break;
		case 'c': case 's':
			mpq_mul(e.w, e.w, t);
			mpq_mul(e.a, e.a, t);
			mpfr_set_q(angle, e.w, MPFR_RNDN);
			(e.kind[0] == 'c' ? mpfr_cos : mpfr_sin)(x[i], angle, MPFR_RNDN);
			mpfr_set_q(angle, e.a, MPFR_RNDN);
			mpfr_exp(angle, angle, MPFR_RNDN);
			mpfr_mul(x[i], x[i], angle, MPFR_RNDN);
			break;
		default: mpfr_set_zero(x[i], 1);
		}
	}
	mpq_clears(e.a, e.w, NULL);
	mpfr_clear(angle);
}

int reference_segment(const struct reference *r, const mpq_t t)
{
	int i = 0;
	while (i + 1 < r->segments && mpq_cmp(t, r->change[i]) >= 0)
		i++;
	return i;
}

void reference_matrix(const struct reference *r, int segment, const mpq_t tau, mpfr_t *E)
{
	if (evaluator_midpoints((size_t)r->size, (const mpq_t *)r->A[segment], tau, REFERENCE_BITS, E) != 0)
		abort();
}

void reference_apply(const struct reference *r, mpfr_t *E, mpfr_t *x)
{
	mpfr_t *y = new_floats(r->size), p;
	mpfr_init2(p, REFERENCE_PRECISION);
	for (int i = 0; i < r->size; i++)
		for (int j = 0; j < r->size; j++) {
			mpfr_mul(p, E[i * r->size + j], x[j], MPFR_RNDN);
			mpfr_add(y[i], y[i], p, MPFR_RNDN);
		}
	for (int i = 0; i < r->size; i++)
		mpfr_set(x[i], y[i], MPFR_RNDN);
	free_floats(y, r->size);
	mpfr_clear(p);
}

void reference_advance(const struct reference *r, const mpq_t from, const mpq_t to, mpfr_t *x)
{
	mpfr_t *E = new_floats(r->size * r->size);
	mpq_t *t = new_rationals(2);
	mpq_set(t[0], from);
	while (mpq_cmp(t[0], to) < 0) {
		const int segment = reference_segment(r, t[0]);
		const bool last = segment + 1 == r->segments || mpq_cmp(r->change[segment], to) > 0;
		mpq_sub(t[1], last ? to : r->change[segment], t[0]);
		reference_matrix(r, segment, t[1], E);
		reference_apply(r, E, x);
		mpq_add(t[0], t[0], t[1]);
	}
	free_rationals(t, 2);
	free_floats(E, r->size * r->size);
}

void reference_row(const struct reference *r, int segment, int row, mpfr_t *x, mpfr_t result)
{
	mpfr_t p;
	mpfr_init2(p, REFERENCE_PRECISION);
	mpfr_set_zero(result, 1);
	for (int j = 0; j < r->size; j++) {
		mpfr_mul_q(p, x[j], r->A[segment][row * r->size + j], MPFR_RNDN);
		mpfr_add(result, result, p, MPFR_RNDN);
	}
	mpfr_clear(p);
}
