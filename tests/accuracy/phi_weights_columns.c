/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The judge's numbers of kernels: the plant, e^{A tau} at the times that are asked for, and sums of them. */
#include "kernels.h"

/* ---- the plant: one operator in one segment of time, as x' = A x ---- */

static void fill_row(const struct model *model, const struct plant *p, size_t i, const mpq_t *right)
{
	const struct linear *system = &model->system;
	const size_t target = system->velocity[i] >= 0 ? (size_t)system->velocity[i] : i;
	mpq_t *row = p->A + target * p->size;
	if (target != i)
		mpq_set_ui(p->A[i * p->size + target], 1, 1);
	for (size_t j = 0; j < p->states; j++)
		mpq_neg(row[(p->held && (size_t)system->coord[j] != i ? p->states : 0) + j], right[j]);
	for (size_t j = 0; j < p->loads; j++)
		mpq_set(row[p->load_at + j], right[p->states + j]);
	right += p->states + p->loads;
	for (size_t u = 0, at = p->input_at; u < (size_t)system->inputs; u++)
		for (int k = 0; k <= system->input[u].hold; k++)
			mpq_set(row[at++], right[2 * u + (size_t)k]);
	right += 2 * (size_t)system->inputs;
	for (size_t e = 0; e < p->force_columns; e++) {
		mpq_set(row[p->force_column_at + 3 * e], right[e]);
		mpq_set(p->B[e * p->size + target], right[e]);
	}
}

bool make_plant(struct plant *p, const struct model *model, int which, int segment, bool split)
{
	const struct linear *system = &model->system;
	size_t width;
	*p = (struct plant){ .states = (size_t)system->states,
						 .held = split ? (size_t)system->states : 0,
						 .loads = (size_t)load_columns(system),
						 .force_columns = (size_t)model->remainder.force_columns };
	for (int u = 0; u < system->inputs; u++)
		p->inputs += system->input[u].hold ? 2 : 1;
	p->load_at = p->states + p->held;
	p->input_at = p->load_at + p->loads;
	p->force_column_at = p->input_at + p->inputs;
	p->size = p->force_column_at + 3 * p->force_columns;
	p->A = rationals(p->size * p->size);
	p->B = rationals(p->force_columns * p->size);
	const struct operator *operator = &model->schedule.operator[which];
	const mpq_t *R = (const mpq_t *)highest_rows(system, operator->K, operator->C, segment,
							 model->remainder.force_columns, model->remainder.row, &width);
	if (!R) {
		complain("", "the matrix of highest derivatives is singular");
		return false;
	}
	for (size_t i = 0; i < (size_t)system->n; i++)
		fill_row(model, p, i, R + i * width);
	for (size_t at = p->load_at, l = 0; l < (size_t)system->loads; at += (size_t)system->load[l++].columns)
		fill_load_states(&system->load[l], p->size, p->A + at * p->size + at);
	for (size_t u = 0, at = p->input_at; u < (size_t)system->inputs; at += system->input[u++].hold ? 2 : 1)
		if (system->input[u].hold)
			mpq_set_ui(p->A[at * p->size + at + 1], 1, 1);
	for (size_t e = 0; e < p->force_columns; e++)
		for (size_t k = 0; k < 2; k++)
			mpq_set_ui(p->A[(p->force_column_at + 3 * e + k) * p->size + p->force_column_at + 3 * e + k
					+ 1], 1, 1);
	return true;
}

/* ---- e^{A tau} at the times that are asked for ---- */

static const unsigned long LEVEL_BITS[LEVELS] = { 200, 450, 950, 1950, 3950, 7900, 15800 };

struct moment *moment_at(struct judge *judge, mpq_srcptr fraction)
{
	for (int i = 0; i < judge->moments; i++)
		if (mpq_equal(judge->moment[i].fraction, fraction))
			return &judge->moment[i];
	if (judge->moments == MOMENTS)
		abort();
	struct moment *m = &judge->moment[judge->moments++];
	mpq_inits(m->fraction, m->tau, NULL);
	mpq_set(m->fraction, fraction);
	mpq_mul(m->tau, fraction, judge->h);
	return m;
}

const evaluator_enclosure *enclosure(const struct judge *judge, struct moment *m, int level)
{
	if (!m->level[level]) {
		m->level[level] = NEW(evaluator_enclosure);
		evaluator_enclosure_init(m->level[level], judge->plant.size);
		m->given_up[level] =
			evaluator_enclose((const mpq_t *)judge->plant.A, m->tau, LEVEL_BITS[level],
					m->level[level]) != 0;
	}
	return m->given_up[level] ? NULL : m->level[level];
}

/* ---- one number per state: a sum over times of e^{A tau} w ---- */

struct part *add_part(struct judge *judge, struct column *column, mpq_srcptr fraction)
{
	struct part *part = &column->part[column->parts++];
	*part = (struct part){ .moment = moment_at(judge, fraction), .w = rationals(judge->plant.size) };
	return part;
}

/* By Cayley and Hamilton (e^{A tau} w)_i is zero at every tau if (A^k w)_i = 0 for k < n, a polynomial in tau if for n
 * <= k < 2n. */
static void screen(const struct judge *judge, struct part *part)
{
	const size_t n = judge->plant.size, states = judge->plant.states;
	uint64_t *v = ARRAY(uint64_t, n), *next = ARRAY(uint64_t, n);
	part->zero = ARRAY(bool, states);
	part->polynomial = ARRAY(bool, states);
	for (size_t i = 0; i < n; i++)
		v[i] = residue(part->w[i]);
	for (size_t i = 0; i < states; i++)
		part->zero[i] = part->polynomial[i] = true;
	for (size_t k = 0; k < 2 * n; k++) {
		for (size_t i = 0; i < states; i++)
			if (v[i])
				(k < n ? part->zero : part->polynomial)[i] = false;
		for (size_t i = 0; i < n; i++) {
			next[i] = 0;
			for (size_t l = 0; l < n; l++)
				if (v[l] && judge->residue[i * n + l])
					next[i] = (next[i] + times(judge->residue[i * n + l], v[l])) % PRIME;
		}
		uint64_t *swap = v;
		v = next;
		next = swap;
	}
	for (size_t i = 0; i < states; i++)
		part->polynomial[i] = part->polynomial[i] || mpq_sgn(part->moment->fraction) == 0;
}

/* Which entries take part in those that are polynomial and not zero */
static bool *needed_rows(const struct judge *judge, const struct part *part)
{
	const size_t n = judge->plant.size;
	bool *needed = ARRAY(bool, n);
	for (size_t i = 0; i < judge->plant.states; i++)
		needed[i] = part->polynomial[i] && !part->zero[i];
	for (bool grown = true; grown;) {
		grown = false;
		for (size_t i = 0; i < n; i++)
			for (size_t l = 0; needed[i] && l < n; l++)
				if (!needed[l] && mpq_sgn(judge->plant.A[i * n + l])) {
					needed[l] = true;
					grown = true;
				}
	}
	return needed;
}

/* sum over k < n of A^k w tau^k / k! */
static void find_polynomials(const struct judge *judge, struct part *part)
{
	const size_t n = judge->plant.size, states = judge->plant.states;
	const bool *needed = needed_rows(judge, part);
	mpq_t *v = rationals(n), *next = rationals(n), weight;
	mpq_init(weight);
	mpq_set_ui(weight, 1, 1);
	part->value = rationals(states);
	for (size_t i = 0; i < n; i++)
		mpq_set(v[i], part->w[i]);
	for (unsigned long k = 0; k < n && mpq_sgn(weight); k++) {
		for (size_t i = 0; i < states; i++)
			if (part->polynomial[i] && !part->zero[i])
				add_product(part->value[i], v[i], weight, false);
		for (size_t i = 0; i < n; i++) {
			mpq_set_ui(next[i], 0, 1);
			for (size_t l = 0; needed[i] && l < n; l++)
				if (mpq_sgn(judge->plant.A[i * n + l]) && mpq_sgn(v[l]))
					add_product(next[i], judge->plant.A[i * n + l], v[l], false);
		}
		for (size_t i = 0; i < n; i++)
			mpq_swap(v[i], next[i]);
		mpq_mul(weight, weight, part->moment->tau);
		mpq_set_ui(next[0], 1, k + 1);
		mpq_mul(weight, weight, next[0]);
	}
	mpq_clear(weight);
}

/* The number of row i; false: the judge has no enclosure so narrow */
static bool enclose(const struct judge *judge, const struct column *column, size_t i, int level, mpfi_ptr sum)
{
	mpfi_set_prec(sum, (mpfr_prec_t)(3 * LEVEL_BITS[level] + 256));
	mpfi_set_ui(sum, 0);
	for (int k = 0; k < column->parts; k++) {
		const struct part *part = &column->part[k];
		const evaluator_enclosure *E = enclosure(judge, part->moment, level);
		if (!E)
			return false;
		for (size_t l = 0; l < judge->plant.size; l++)
			if (mpq_sgn(part->w[l]))
				add_entry(sum, E, i * judge->plant.size + l, part->w[l]);
	}
	return true;
}

static double rounded(mpfr_srcptr x)
{
	const double d = mpfr_get_d(x, MPFR_RNDN);
	return d == 0 ? 0 : d;              /* no sign */
}

/* ---- found and expected ---- */

static void compare(const char *what, double found, double expected)
{
	trial.compared++;
	if (memcmp(&found, &expected, sizeof found) != 0)
		complain(what, format("found %a = %.17g, expected %a = %.17g", found, found, expected, expected));
}

/* A polynomial in tau: rational, so its zeros are known */
static void compare_rational(const char *what, const struct judge *judge, struct column *column, size_t i,
							 const struct coefficient *found)
{
	mpq_t sum;
	mpfr_t value;
	mpq_init(sum);
	mpfr_init2(value, 8192);
	for (int k = 0; k < column->parts; k++) {
		if (!column->part[k].zero[i] && !column->part[k].value)
			find_polynomials(judge, &column->part[k]);
		if (!column->part[k].zero[i])
			mpq_add(sum, sum, column->part[k].value[i]);
	}
	mpfr_set_q(value, sum, MPFR_RNDN);
	compare(what, found->value, rounded(value));
	if (found->zero != (mpq_sgn(sum) == 0))
		complain(what,
				 found->zero ? format("marked as zero, but it is %s", readable_text(sum)) : "zero, "
					"and not marked so");
	mpq_clear(sum);
	mpfr_clear(value);
}

/* Marked as zero: nothing is found there with 3950 bits.  Not marked, and rounded to zero: it can be told from zero. */
static void compare_mark(const char *what, const struct judge *judge, const struct column *column, size_t i,
						 const struct coefficient *found)
{
	mpfi_t sum;
	bool apart = false;
	mpfi_init(sum);
	for (int level = 0; level <= (found->zero ? ZERO_LEVEL : LEVELS - 1) && !apart; level++)
		apart = enclose(judge, column, i, level, sum) && !mpfi_has_zero(sum);
	if (found->zero && apart)
		complain(what, "marked as zero, but it is not");
	trial.unsettled += !found->zero && !apart;
	mpfi_clear(sum);
}

static void compare_enclosed(const char *what, const struct judge *judge, const struct column *column, size_t i,
							 const struct coefficient *found)
{
	mpfi_t sum;
	bool decided = false;
	double value = 0;
	mpfi_init(sum);
	for (int level = 0; level < LEVELS && !decided; level++)
		if (enclose(judge, column, i, level, sum)) {
			value = rounded(&sum->left);
			decided = value == rounded(&sum->right);
		}
	if (decided)
		compare(what, found->value, value);
	else
		complain(what, "the judge cannot decide");
	if (decided && (found->zero || value == 0))
		compare_mark(what, judge, column, i, found);
	mpfi_clear(sum);
}

/* `found` has one number per state, `stride` apart. */
void compare_column(const struct model *model, const struct judge *judge, struct column *column,
						   const struct coefficient *found, size_t stride)
{
	const size_t states = judge->plant.states;
	for (int k = 0; k < column->parts; k++)
		screen(judge, &column->part[k]);
	for (size_t i = 0; i < states; i++) {
		const char *what = format(" in %s", model->names.state[i]);
		bool polynomial = true;
		for (int k = 0; k < column->parts; k++)
			polynomial = polynomial && (column->part[k].polynomial[i] || column->part[k].zero[i]);
		if (polynomial)
			compare_rational(what, judge, column, i, &found[i * stride]);
		else
			compare_enclosed(what, judge, column, i, &found[i * stride]);
	}
}
