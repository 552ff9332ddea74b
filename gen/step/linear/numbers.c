/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Each number of a step is decided exactly to be rational, or enclosed ever more tightly until both ends of the
 * enclosure round to the same double (Ziv); so each is rounded once, correctly. */
#include "inner.h"

#include <math.h>

enum { GUARD_BITS = 32 };

/* log2 |p| of the largest pole is at least the largest log2 |c_i/c_d| / (d-i), less log2 d (Cauchy's bound, reversed).
 * An angle |p| h of more bits than an enclosure may have could never be reduced to a turn. */
void check_pole_size(const struct model *model, const struct resolvent *resolvent)
{
	struct poly B = *resolvent_determinant(resolvent);
	long lead = (long)mpz_sizeinbase(B.c[B.length - 1], 2), largest = 0;
	for (int i = 0; i < B.length - 1; i++) {
		long bits = (long)mpz_sizeinbase(B.c[i], 2) - lead - B.length;
		if (mpz_sgn(B.c[i]) != 0 && bits / (B.length - 1 - i) > largest)
			largest = bits / (B.length - 1 - i);
	}
	long step = rational_bits(model->h);
	if (largest + step > LIMIT_PRECISION)
		error(model->request.at.step, NULL,
		      "the largest pole, about 2^%ld 1/s, times the step is beyond the limit of 2^%d", largest,
		      LIMIT_PRECISION);
}

struct culprit {                    /* what an overflow comes from */
	double re, im, size;
	bool grows;                 /* by more than e in a step */
};

/* The pole that grows fastest; if none grows in a step, the largest one, since then its units are to blame. */
static struct culprit find_culprit(const struct response *response, double h)
{
	const struct spectrum *spectrum = response->spectrum;
	struct culprit fastest = { spectrum->zero ? 0 : -INFINITY, 0, 0, false }, largest = { 0 };
	for (int f = 0; f < spectrum->factors; f++)
		for (int i = 0; i < spectrum->poles[f]; i++) {
			double re = mpfi_get_d(spectrum->pole[f][i].at.re), im = mpfi_get_d(spectrum->pole[f][i].at.im);
			struct culprit pole = { re, im, hypot(re, im), re * h > 1 };
			fastest = pole.re > fastest.re ? pole : fastest;
			largest = pole.size > largest.size ? pole : largest;
		}
	return fastest.grows ? fastest : largest;
}

static const char *pole_of(const struct culprit *pole)
{
	return pole->im == 0 ? format("%.6g 1/s", pole->re) : format("%.6g +- %.6g i 1/s", pole->re, pole->im);
}

_Noreturn void undecided(struct place at, const char *what, bool isolated)
{
	const char *note = isolated ? NULL
				    : "two poles cannot be told apart; do two parameters differ by less than their "
				      "rounding?";
	error(at, note, "%s is not decided with %d bits", what, LIMIT_PRECISION);
}

/* ---- enclosed, or exact ---- */

/* What a load has done while it acted cancels from its end on, all but what it has left moving: of sums of both, all
 * digits would in time. */
static struct response *response_at(const struct started *s, mpq_srcptr t)
{
	return s->transient && mpq_cmp(t, s->end) > 0 ? s->transient : s->response;
}

/* One term; false: it is beyond the method's limits. *absent: it has not started. */
static bool enclose_term(const struct number *n, int i, int precision, mpfi_ptr value, bool *absent)
{
	*absent = false;
	if (n->entry) {
		const struct entry *entry = &n->entry[i];
		if (!taylor_enclose(entry->taylor, precision))
			return false;
		taylor_entry(entry->taylor, n->row, entry->column, value);
		mpfi_mul_q(value, value, entry->weight);
		return true;
	}
	RATIONAL tau = ZERO;
	mpq_sub(tau, n->t, n->list[i].start);
	*absent = mpq_sgn(tau) < 0;
	return *absent || response_enclose(response_at(&n->list[i], n->t), tau, precision, value);
}

bool enclose_number(const struct number *n, int precision, mpfi_ptr sum)
{
	bool good = true, absent;
	INTERVAL value = OVER_BITS(precision);
	mpfi_set_prec(sum, precision + GUARD_BITS);
	mpfi_set_ui(sum, 0);
	for (int i = 0; i < n->count && good; i++) {
		good = enclose_term(n, i, precision, value, &absent);
		if (good && !absent)
			mpfi_add(sum, sum, value);
	}
	if (n->scale)
		mpfi_mul_q(sum, sum, n->scale);
	if (n->less)
		mpfi_sub_q(sum, sum, n->less);
	return good;
}

static bool exact_term(const struct number *n, int i, mpq_ptr value)
{
	if (n->entry) {
		bool exact = taylor_exact(n->entry[i].taylor, n->row, n->entry[i].column, value);
		mpq_mul(value, value, n->entry[i].weight);
		return exact;
	}
	RATIONAL tau = ZERO;
	mpq_sub(tau, n->t, n->list[i].start);
	mpq_set_ui(value, 0, 1);
	bool exact = mpq_sgn(tau) < 0 || response_exact(response_at(&n->list[i], n->t), tau, value);
	return exact;
}

static bool exact_number(const struct number *n, mpq_ptr sum)
{
	bool exact = true;
	RATIONAL value = ZERO;
	mpq_set_ui(sum, 0, 1);
	for (int i = 0; i < n->count && exact; i++) {
		exact = exact_term(n, i, value);
		mpq_add(sum, sum, value);
	}
	if (n->scale)
		mpq_mul(sum, sum, n->scale);
	if (n->less)
		mpq_sub(sum, sum, n->less);
	return exact;
}

/* ---- rounded ---- */

struct enclosed {                   /* a number, to this precision; 0: not yet */
	int precision;
	mpfi_t at;
};

/* number - subtract, rounded, from what is known of the number on; false: not decided, *isolated says whether the
 * poles were */
static bool round_difference(const struct number *n, struct enclosed *known, double subtract, int limit, double *value,
			     bool *isolated)
{
	INTERVAL difference = OVER_BITS(FIRST_PRECISION);
	bool decided = false;
	*isolated = true;
	int precision = known->precision > 0 ? known->precision : FIRST_PRECISION;
	for (; precision <= limit && !decided; precision *= 2) {
		if (precision > known->precision)
			*isolated = enclose_number(n, precision, known->at);
		known->precision = precision;
		if (!*isolated)
			break;
		mpfi_set_prec(difference, mpfi_get_prec(known->at));
		mpfi_sub_d(difference, known->at, subtract);
		decided = round_enclosure(difference, value);
	}
	return decided;
}

bool round_number(const struct number *n, bool two_words, int limit, struct coefficient *c, bool *isolated)
{
	bool decided = true;
	RATIONAL exact = ZERO, low = ZERO;
	*isolated = true;
	*c = (struct coefficient){ 0 };
	if (exact_number(n, exact)) {
		c->zero = mpq_sgn(exact) == 0;
		c->value = round_rational(exact);
		if (two_words && isfinite(c->value)) {
			mpq_set_d(low, c->value);
			mpq_sub(low, exact, low);
			c->low = round_rational(low);
		}
	} else {
		struct enclosed known = { .precision = 0 };
		mpfi_init2(known.at, FIRST_PRECISION);
		decided = round_difference(n, &known, 0, limit, &c->value, isolated);
		if (decided && two_words && isfinite(c->value))
			decided = round_difference(n, &known, c->value, limit, &c->low, isolated);
		mpfi_clear(known.at);
	}
	return decided;
}

struct coefficient started_value(int count, const struct started *list, mpq_srcptr t, bool two_words, struct place at,
				 const char *what)
{
	struct number number = { .count = count, .list = list, .t = t };
	struct coefficient c;
	bool isolated;
	if (!round_number(&number, two_words, LIMIT_PRECISION, &c, &isolated))
		undecided(at, what, isolated);
	return c;
}

struct coefficient response_value(struct response *response, mpq_srcptr tau, bool two_words, struct place at,
				  const char *what)
{
	struct started alone = { .response = response };
	mpq_init(alone.start);
	return started_value(1, &alone, tau, two_words, at, what);
}

void check_range(const struct model *model, const struct coefficient *c, int count, const struct started *list,
			const char *what)
{
	if (isfinite(c->value) || count == 0)
		return;
	struct culprit pole = find_culprit(list[0].response, nearest_double(model->h));
	error(model->request.at.step, pole.grows ? "a smaller step would do" : NULL,
	      "%s is beyond the range of %s: pole %s, h = %s s", what, target_name(), pole_of(&pole),
	      readable_text(model->h));
}
