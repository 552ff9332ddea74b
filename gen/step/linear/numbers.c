/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Each number of a step is decided exactly to be rational, or enclosed ever more tightly until both ends of the
 * enclosure round to the same double (Ziv); so each is rounded once, correctly. */
#include "inner.h"
#include "model/reads.h"

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
		error(model->request.step_at, NULL,
		      "the largest pole, about 2^%ld 1/s, times the step is beyond the limit of 2^%d", largest,
		      LIMIT_PRECISION);
}

struct culprit {                    /* what an overflow comes from */
	double re, im, size;
	bool grows;                 /* by more than e in a step */
};

/* The pole that grows fastest; if none grows in a step, the largest one, since then its units are to blame. */
static struct culprit find_culprit(const struct model *model, struct spectrum *spectrum)
{
	struct culprit fastest = { spectrum->zero ? 0 : -INFINITY, 0, 0, false }, largest = { 0 };
	const double h = nearest_double(model->h);
	(void)spectrum_refine(spectrum, FIRST_PRECISION);
	for (int l = 0; l < model->system.loads; l++) {
		const struct forcing *f = model->system.load[l].forcing;
		const double a = nearest_double(f->a);
		if (a * h > 1 && a > fastest.re)
			fastest = (struct culprit){ a, nearest_double(f->w), 0, true };
	}
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

_Noreturn void undecided(struct place at, const char *what)
{
	error(at, NULL, "%s is not decided with %d bits", what, LIMIT_PRECISION);
}

/* ---- enclosed, or exact ---- */

bool enclose_number(const struct number *n, int precision, mpfi_ptr sum)
{
	INTERVAL value = OVER_BITS(precision);
	mpfi_set_prec(sum, precision + GUARD_BITS);
	mpfi_set_ui(sum, 0);
	for (int i = 0; i < n->count; i++) {
		const struct entry *entry = &n->entry[i];
		if (!taylor_enclose(entry->taylor, precision))
			return false;
		taylor_entry(entry->taylor, entry->place.row, entry->place.column, value);
		mpfi_mul_q(value, value, entry->place.weight);
		mpfi_add(sum, sum, value);
	}
	if (n->scale)
		mpfi_mul_q(sum, sum, n->scale);
	if (n->less)
		mpfi_sub_q(sum, sum, n->less);
	return true;
}

static void finish_exact(const struct number *n, mpq_ptr sum)
{
	if (n->scale)
		mpq_mul(sum, sum, n->scale);
	if (n->less)
		mpq_sub(sum, sum, n->less);
}

/* Entry by entry: for every time */
static bool exact_number(const struct number *n, mpq_ptr sum)
{
	bool exact = true;
	RATIONAL value = ZERO;
	mpq_set_ui(sum, 0, 1);
	for (int i = 0; i < n->count && exact; i++) {
		const struct taylor_place *place = &n->entry[i].place;
		exact = taylor_exact(n->entry[i].taylor, place->row, place->column, value);
		rational_addmul(sum, value, place->weight);
	}
	finish_exact(n, sum);
	return exact;
}

/* At this very time, of what stands at each */
static bool rational_number(const struct number *n, mpq_ptr sum)
{
	struct taylor_place *place = ARRAY(struct taylor_place, n->count);
	bool rational = true;
	RATIONAL value = ZERO;
	mpq_set_ui(sum, 0, 1);
	for (int i = 0; i < n->count && rational; i++) {
		int count = 0;
		bool done = false;
		for (int k = 0; k < n->count; k++) {
			if (n->entry[k].taylor != n->entry[i].taylor)
				continue;
			done = done || k < i;
			place[count++] = n->entry[k].place;
		}
		if (done)
			continue;
		rational = taylor_rational(n->entry[i].taylor, count, place, value);
		mpq_add(sum, sum, value);
	}
	finish_exact(n, sum);
	return rational;
}

/* ---- rounded ---- */

/* In both words, as far as wanted, with more and more bits; *precision: so many first */
static bool round_in_bits(const struct number *n, bool two_words, int *precision, int most, struct coefficient *c)
{
	INTERVAL value = OVER_BITS(FIRST_PRECISION);
	for (; *precision <= most; *precision *= 2) {
		if (!enclose_number(n, *precision, value))
			return false;
		if (!round_enclosure(value, &c->value) || (mpfi_has_zero(value) && 2 * *precision <= LIMIT_PRECISION))
			continue;               /* what is too small for the range may be 0 */
		if (!two_words || !isfinite(c->value))
			return true;
		mpfi_sub_d(value, value, c->value);
		if (round_enclosure(value, &c->low))
			return true;
	}
	return false;
}

bool round_number(const struct number *n, bool two_words, struct coefficient *c)
{
	enum { FAR = 2048 };            /* bits that hardly any transcendental number takes */
	RATIONAL exact = ZERO, low = ZERO;
	int precision = FIRST_PRECISION;
	*c = (struct coefficient){ 0 };
	if (!exact_number(n, exact)) {
		if (round_in_bits(n, two_words, &precision, FAR, c))
			return true;
		if (!rational_number(n, exact))
			return round_in_bits(n, two_words, &precision, LIMIT_PRECISION, c);
	}
	*c = (struct coefficient){ .value = round_rational(exact), .zero = mpq_sgn(exact) == 0 };
	if (two_words && isfinite(c->value)) {
		mpq_set_d(low, c->value);
		mpq_sub(low, exact, low);
		c->low = round_rational(low);
	}
	return true;
}

void check_range(const struct model *model, const struct coefficient *c, const struct resolvent *resolvent,
		 const char *what)
{
	if (isfinite(c->value))
		return;
	struct culprit pole = find_culprit(model, resolvent_spectrum(resolvent));
	error(model->request.step_at, pole.grows ? "a smaller step would do" : NULL,
	      "%s is beyond the range of %s: pole %s, h = %s s", what, target_name(), pole_of(&pole),
	      readable_text(model->h));
}

/* ---- among the states of a load ---- */

struct coefficient *growth_of_load(const struct step *step, const struct load *load, mpq_srcptr tau, bool two_words)
{
	const int n = load->columns;
	struct coefficient *cell = ARRAY(struct coefficient, (size_t)n * (size_t)n);
	struct entry entry = { .taylor = taylor_of(n, load_matrix(load), tau) };
	const struct number number = { .count = 1, .entry = &entry };
	mpq_init(entry.place.weight);
	mpq_set_ui(entry.place.weight, 1, 1);
	for (int i = 0; i < n * n; i++) {
		entry.place.row = i / n;
		entry.place.column = i % n;
		if (!round_number(&number, two_words, &cell[i]))
			undecided(step->model->request.step_at, column_text(load, i / n));
	}
	return cell;
}
