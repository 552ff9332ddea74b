/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sums of sequences: what is added up exactly, and its factors as numbers, each rounded once. */
#include "inner.h"

void sum_add(struct sum *sum, enum term_kind kind, int a, int b, mpq_srcptr factor)
{
	for (int i = 0; i < sum->keys; i++) {
		struct key *key = &sum->key[i];
		if (key->kind == kind && key->a == a && key->b == b) {
			mpq_add(key->factor, key->factor, factor);
			return;
		}
	}
	struct key *key = MORE(sum->key, sum->keys);
	*key = (struct key){ .kind = kind, .a = a, .b = b };
	mpq_init(key->factor);
	mpq_set(key->factor, factor);
}

/* ---- numbers of sums ---- */

static double rounded(const struct sequencing *w, mpq_srcptr q)
{
	return equation_number(w->step->model, q).value;
}

/* One more, with factors from the k-th to the last */
static void add_numbers(struct sequencing *w, struct sequence *s, struct sequence_term term, int k, int last,
			mpq_srcptr factor, const mpq_t *scale)
{
	RATIONAL number = ZERO;
	term.slot = -1;
	term.factor = ARRAY(double, w->x->order + 1);
	for (int i = k; i <= last && i <= w->x->order; i++) {
		mpq_mul(number, factor, scale[i]);
		term.factor[i] = i > k && mpq_equal(scale[i], scale[i - 1]) ? term.factor[i - 1] : rounded(w, number);
	}
	*MORE(s->term, s->terms) = term;
}

/* binomial(m, k) D^k t^{m-k}, k = 0 .. m */
static void add_powers(struct sequencing *w, struct sequence *s, int m, mpq_srcptr factor, const mpq_t *scale)
{
	RATIONAL part = ZERO, binomial = ZERO;
	mpq_set(part, factor);
	for (int k = 0; k <= m && k <= w->x->order; k++) {
		add_numbers(w, s, (struct sequence_term){ .kind = TERM_TIME, .a = m - k }, k, k, part, scale);
		mpq_set_ui(binomial, (unsigned long)(m - k), (unsigned long)k + 1);
		mpq_canonicalize(binomial);
		mpq_mul(part, part, binomial);
		mpq_mul(part, part, w->unit);
	}
}

/* row (D S)^k / k!, S the load's own slopes: exact, times what the sum scales its k-th with */
static void next_row(const struct sequencing *w, int load, int k, mpq_t *row)
{
	const struct load *l = &w->system->load[load];
	int n = l->columns, at = w->layout.load[load], size = w->layout.size;
	RATIONALS *next = rationals(n);
	RATIONAL part = ZERO;
	for (int j = 0; j < n; j++)
		for (int i = 0; i < n; i++) {
			mpq_mul(part, row[i], w->slopes[0][(at + i) * size + at + j]);
			mpq_add(next[j], next[j], part);
		}
	mpq_set_ui(part, 1, (unsigned long)k + 1);
	mpq_mul(part, part, w->unit);
	for (int j = 0; j < n; j++)
		mpq_mul(row[j], next[j], part);
}

/* value[column][k] */
static double *load_numbers(const struct sequencing *w, int load, mpq_t *row, const mpq_t *scale)
{
	int n = w->system->load[load].columns, order = w->x->order;
	double *value = ARRAY(double, (size_t)((order + 1) * n));
	RATIONAL scaled = ZERO;
	for (int k = 0; k <= order; k++) {
		for (int j = 0; j < n; j++) {
			mpq_mul(scaled, row[j], scale[k]);
			value[j * (order + 1) + k] = rounded(w, scaled);
		}
		next_row(w, load, k, row);
	}
	return value;
}

/* All loads of a sum, whose columns change into each other */
static void add_loads(struct sequencing *w, struct sequence *s, const struct sum *sum, const mpq_t *scale)
{
	const int stride = w->x->order + 1;
	for (int l = 0; l < w->system->loads; l++) {
		int first = column_of_load(w->system, l), n = w->system->load[l].columns;
		RATIONALS *row = rationals(n);
		for (int i = 0; i < sum->keys; i++) {
			const struct key *key = &sum->key[i];
			if (key->kind == TERM_LOAD && key->a >= first && key->a < first + n)
				mpq_set(row[key->a - first], key->factor);
		}
		if (rationals_zero((size_t)n, row))
			continue;
		double *value = load_numbers(w, l, row, scale);
		for (int j = 0; j < n; j++)
			*MORE(s->term, s->terms) = (struct sequence_term){
				.kind = TERM_LOAD, .a = first + j, .slot = -1, .factor = value + j * stride
			};
	}
}

/* u = value + slope tau; its slope alone */
static void add_input(struct sequencing *w, struct sequence *s, const struct key *key, const mpq_t *scale)
{
	bool ramps = w->system->input[key->a].hold > 0;
	RATIONAL reversed = ZERO;
	if (key->kind == TERM_SLOPE && !ramps)
		return;
	add_numbers(w, s, (struct sequence_term){ .kind = key->kind, .a = key->a }, 0, 0, key->factor, scale);
	mpq_mul(reversed, key->factor, w->unit);
	if (key->kind == TERM_INPUT && ramps)
		add_numbers(w, s, (struct sequence_term){ .kind = TERM_SLOPE, .a = key->a }, 1, 1, reversed, scale);
}

/* Its keys as terms, scaled by scale[k] at k */
void sum_numbers(struct sequencing *w, struct sequence *s, const struct sum *sum, const mpq_t *scale)
{
	for (int i = 0; i < sum->keys; i++) {
		const struct key *key = &sum->key[i];
		struct sequence_term term = { .kind = key->kind, .a = key->a, .b = key->b };
		if (mpq_sgn(key->factor) == 0 || key->kind == TERM_LOAD)
			continue;
		if (key->kind == TERM_TIME)
			add_powers(w, s, key->a, key->factor, scale);
		else if (key->kind == TERM_INPUT || key->kind == TERM_SLOPE)
			add_input(w, s, key, scale);
		else
			add_numbers(w, s, term, 0, key->kind == TERM_PARAM ? 0 : w->x->order, key->factor, scale);
	}
	add_loads(w, s, sum, scale);
}

mpq_t *plain_scale(const struct sequencing *w)
{
	mpq_t *scale = rationals(w->x->order + 1);
	for (int k = 0; k <= w->x->order; k++)
		mpq_set_ui(scale[k], 1, 1);
	return scale;
}

/* D/(k+1): of a derivative with respect to time; or 1/(k+1), where D is in the factors already */
mpq_t *integral_scale(const struct sequencing *w, bool times_unit)
{
	mpq_t *scale = rationals(w->x->order + 1);
	for (int k = 0; k <= w->x->order; k++) {
		mpq_set_ui(scale[k], 1, (unsigned long)k + 1);
		if (times_unit)
			mpq_mul(scale[k], scale[k], w->unit);
	}
	return scale;
}

/* ---- as sequences ---- */

int new_sequence(struct sequencing *w, struct sequence sequence)
{
	struct expansion *x = w->x;
	*MORE(x->sequence, x->count) = sequence;
	return x->count - 1;
}

int sum_sequence(struct sequencing *w, const struct sum *sum)
{
	struct sequence s = { .kind = SEQUENCE_SUM, .state = NONE, .a = NONE, .b = NONE };
	RATIONALS *scale = plain_scale(w);
	sum_numbers(w, &s, sum, scale);
	return new_sequence(w, s);
}

/* A sum of one term */
int single_sequence(struct sequencing *w, enum term_kind kind, int a, int b, long sign)
{
	struct sum sum = { 0 };
	RATIONAL factor = ZERO;
	mpq_set_si(factor, sign, 1);
	sum_add(&sum, kind, a, b, factor);
	return sum_sequence(w, &sum);
}

int minus_sequence(struct sequencing *w, int a)
{
	return single_sequence(w, TERM_SEQUENCE, a, 0, -1);
}

int product_sequence(struct sequencing *w, int a, int b)
{
	return single_sequence(w, TERM_PRODUCT, a < b ? a : b, a < b ? b : a, 1);
}

/* ---- loads that change their formula ---- */

/* Loads whose force changes in time have their factors in a table. */
void add_changing_loads(struct sequencing *w, struct sequence *s, int state, const mpq_t *scale)
{
	struct expansion *x = w->x;
	int size = w->layout.size, segments = w->system->segments, stride = x->order + 1;
	for (int l = 0; l < w->system->loads; l++) {
		int at = w->layout.load[l], n = w->system->load[l].columns, first = column_of_load(w->system, l);
		bool any = false;
		for (int k = 0; k < segments && at >= 0; k++)
			any = any || !rationals_zero((size_t)n, w->slopes[k] + state * size + at);
		if (!any)
			continue;
		for (int j = 0; j < n; j++)
			*MORE(s->term, s->terms) = (struct sequence_term){
				.kind = TERM_LOAD, .a = first + j, .slot = x->slots + j
			};
		ENLARGE(x->changing, (size_t)((x->slots + n) * segments * stride));
		for (int k = 0; k < segments; k++) {
			mpq_t *row = rationals_copied(n, w->slopes[k] + state * size + at);
			const double *value = load_numbers(w, l, row, scale);
			for (int i = 0; i < n * stride; i++)
				x->changing[((x->slots + i / stride) * segments + k) * stride + i % stride] = value[i];
		}
		x->slots += n;
	}
}
