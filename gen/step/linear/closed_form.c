/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Outputs of a linear model in closed form, at one time after the other: rows over x(t) = e^{A t} x(0), x the states,
 * loads and inputs. Every value is enclosed, by powers of e^{A d} at multiples of one distance d, and rounded once;
 * what is not decided by so many bits is asked for again with twice as many. */
#include "inner.h"
#include "model/reads.h"
#include "model/tunable/elsewhere.h"

#include <math.h>

enum { POWERS = 63, ENOUGH = 2048 };

struct closed_form {
	const struct linear *system;
	struct place at;            /* for messages */
	struct layout layout;
	mpq_t *initial, distance;
	int precision;              /* 0: not begun */
	bool known;                 /* nothing is beyond the limits */
	int segment;                /* of time, */
	mpq_t start;                /* its start [s], and x there */
	mpfi_t *x;
	mpq_t offset;               /* of the multiples of the distance, from there */
	bool met;                   /* x at the offset is known */
	mpfi_t *power[POWERS];      /* e^{A d 2^k}; NULL: not made */
	struct taylor *taylor[POWERS];
	/* x after so many distances: at the last that was asked for of each lowest one */
	unsigned long count[POWERS + 1];
	mpfi_t *slot[POWERS + 1];
};

struct closed_form *closed_form_new(struct place at, const struct linear *system, const mpq_t *initial,
				    mpq_srcptr distance, bool driven)
{
	struct closed_form *c = NEW(struct closed_form);
	bool *all = ARRAY(bool, system->loads);
	for (int l = 0; l < system->loads; l++)
		all[l] = true;
	*c = (struct closed_form){ .system = system, .at = at, .layout = layout_with(system, 0, all) };
	c->initial = rationals(c->layout.size);
	for (int i = 0; i < system->states; i++)
		mpq_set(c->initial[i], initial[i]);
	for (int i = 0; i < system->inputs && driven; i++) {
		mpq_set_ui(c->initial[c->layout.input[i]], 1, 1);
		if (!system->input[i].hold)
			continue;
		mpq_inv(c->initial[c->layout.input[i] + 1], distance);
		mpq_neg(c->initial[c->layout.input[i] + 1], c->initial[c->layout.input[i] + 1]);
	}
	mpq_inits(c->distance, c->start, c->offset, NULL);
	mpq_set(c->distance, distance);
	return c;
}

static mpfi_t *vector(const struct closed_form *c)
{
	return enclosures((size_t)c->layout.size, c->precision);
}

/* ---- e^{A tau} x ---- */

static mpfi_t *entries_of(struct closed_form *c, struct taylor *taylor)
{
	const int n = c->layout.size;
	mpfi_t *E = enclosures((size_t)(n * n), c->precision);
	INTERVAL entry = OVER_BITS(c->precision);
	c->known = c->known && taylor_enclose(taylor, c->precision);
	for (int i = 0; i < n * n && c->known; i++) {
		taylor_entry(taylor, i / n, i % n, entry);
		mpfi_set(E[i], entry);
	}
	return E;
}

static void apply(const struct closed_form *c, const mpfi_t *E, const mpfi_t *x, mpfi_t *y)
{
	const int n = c->layout.size;
	INTERVAL part = OVER_BITS(c->precision);
	for (int i = 0; i < n; i++) {
		mpfi_set_ui(y[i], 0);
		for (int j = 0; j < n; j++) {
			if (mpfi_is_zero(E[i * n + j]))
				continue;
			mpfi_mul(part, E[i * n + j], x[j]);
			mpfi_add(y[i], y[i], part);
		}
	}
}

static struct taylor *taylor_over(const struct closed_form *c, mpq_srcptr tau)
{
	return taylor_of(c->layout.size, augmented_matrix(&c->layout, c->system, c->segment), tau);
}

static void move(struct closed_form *c, mpq_srcptr tau, const mpfi_t *x, mpfi_t *y)
{
	apply(c, entries_of(c, taylor_over(c, tau)), x, y);
}

static const mpfi_t *power(struct closed_form *c, int k)
{
	if (!c->taylor[k])
		c->taylor[k] = k ? taylor_doubled((power(c, k - 1), c->taylor[k - 1])) : taylor_over(c, c->distance);
	if (!c->power[k])
		c->power[k] = entries_of(c, c->taylor[k]);
	return c->power[k];
}

/* ---- along the way ---- */

/* What was found with fewer bits is forgotten; with the equations, what they were */
static void forget(struct closed_form *c, bool equations)
{
	c->met = false;
	for (int k = 0; k < POWERS; k++) {
		clear_intervals(&c->power[k]);
		c->power[k] = NULL;
		c->taylor[k] = equations ? NULL : c->taylor[k];
	}
}

static void begin(struct closed_form *c, int precision)
{
	const bool moved = c->segment > 0;
	c->precision = precision;
	c->known = true;
	c->segment = 0;
	forget(c, moved);
	mpq_set_ui(c->start, 0, 1);
	c->x = vector(c);
	for (int i = 0; i < c->layout.size; i++)
		mpfi_set_q(c->x[i], c->initial[i]);
	for (int l = 0; l < c->system->loads; l++)
		for (int k = 0; k < c->system->load[l].columns; k++)
			load_enclosed(&c->system->load[l], k, c->start, c->x[c->layout.load[l] + k]);
}

/* To the segment of time that `t` is in */
static void pass_changes(struct closed_form *c, mpq_srcptr t)
{
	const struct linear *system = c->system;
	RATIONAL tau = ZERO;
	while (c->segment + 1 < system->segments && mpq_cmp(system->change[c->segment], t) <= 0) {
		mpq_srcptr change = system->change[c->segment];
		if (mpq_cmp(change, c->start) > 0) {
			mpfi_t *x = vector(c);
			mpq_sub(tau, change, c->start);
			move(c, tau, c->x, x);
			c->x = x;
			mpq_set(c->start, change);
		}
		c->segment++;
		forget(c, true);
	}
}

static void meet(struct closed_form *c, mpq_srcptr offset)
{
	c->met = true;
	mpq_set(c->offset, offset);
	for (int k = 0; k <= POWERS; k++) {
		c->count[k] = 0;
		c->slot[k] = c->slot[k] && (int)mpfi_get_prec(c->slot[k][0]) == c->precision ? c->slot[k] : NULL;
	}
	c->slot[POWERS] = c->slot[POWERS] ? c->slot[POWERS] : vector(c);
	if (mpq_sgn(offset) == 0)
		for (int i = 0; i < c->layout.size; i++)
			mpfi_set(c->slot[POWERS][i], c->x[i]);
	else
		move(c, offset, c->x, c->slot[POWERS]);
}

/* x after so many distances, by as few products as that has ones */
static const mpfi_t *after(struct closed_form *c, unsigned long count)
{
	const int k = count ? __builtin_ctzl(count) : POWERS;
	if (c->count[k] == count)
		return c->slot[k];
	const mpfi_t *from = after(c, count & (count - 1));
	c->slot[k] = c->slot[k] ? c->slot[k] : vector(c);
	apply(c, power(c, k), from, c->slot[k]);
	c->count[k] = count;
	return c->slot[k];
}

static const mpfi_t *x_at(struct closed_form *c, mpq_srcptr t)
{
	RATIONAL tau = ZERO, whole = ZERO, offset = ZERO;
	INTEGER count = INTEGER_ZERO;
	pass_changes(c, t);
	mpq_sub(tau, t, c->start);
	mpq_div(offset, tau, c->distance);
	mpz_fdiv_q(count, mpq_numref(offset), mpq_denref(offset));
	mpq_set_z(whole, count);
	mpq_mul(whole, whole, c->distance);
	mpq_sub(offset, tau, whole);
	if (!c->met || !mpq_equal(offset, c->offset))
		meet(c, offset);
	return after(c, mpz_get_ui(count));
}

/* ---- values ---- */

static bool round_at(struct closed_form *c, const struct output *output, mpq_srcptr t, bool two_words,
		     struct coefficient *value)
{
	const mpfi_t *x = x_at(c, t);
	RATIONALS *row = rationals(c->layout.size);
	INTERVAL sum = OVER_BITS(c->precision), part = OVER_BITS(c->precision);
	row_of_output(&c->layout, c->system, output, c->system->segments, c->segment, row);
	mpfi_set_ui(sum, 0);
	for (int i = 0; i < c->layout.size; i++) {
		if (mpq_sgn(row[i]) == 0)
			continue;
		mpfi_mul_q(part, x[i], row[i]);
		mpfi_add(sum, sum, part);
	}
	if (!c->known || !round_enclosure(sum, &value->value))
		return false;
	mpfi_sub_d(sum, sum, isfinite(value->value) ? value->value : 0);
	return !two_words || !isfinite(value->value) || round_enclosure(sum, &value->low);
}

/* One that may be rational, in the first segment of time */
static bool round_exactly(struct closed_form *c, const struct output *output, mpq_srcptr t, bool two_words,
			  struct coefficient *value)
{
	const int n = c->layout.size;
	struct entry *entry = ARRAY(struct entry, (size_t)(n * n));
	struct number number = { .entry = entry };
	struct taylor *taylor = taylor_over(c, t);
	RATIONALS *row = rationals(n), *start = rationals_copied(n, c->initial);
	for (int l = 0; l < c->system->loads; l++)
		for (int k = 0; k < c->system->load[l].columns; k++)
			load_state(&c->system->load[l], k, c->start, start[c->layout.load[l] + k]);
	row_of_output(&c->layout, c->system, output, c->system->segments, c->segment, row);
	for (int i = 0; i < n * n; i++) {
		if (mpq_sgn(row[i / n]) == 0 || mpq_sgn(start[i % n]) == 0)
			continue;
		struct entry *e = &entry[number.count++];
		*e = (struct entry){ taylor, { .row = i / n, .column = i % n } };
		mpq_init(e->place.weight);
		mpq_mul(e->place.weight, row[i / n], start[i % n]);
	}
	return mpq_sgn(c->start) == 0 && round_number(&number, two_words, value);
}

struct coefficient closed_form_value(struct closed_form *c, const struct output *output, mpq_srcptr t, bool two_words,
				     const char *what)
{
	struct coefficient value = { 0 };
	if (c->precision == 0 || mpq_cmp(t, c->start) < 0)
		begin(c, c->precision ? c->precision : 2 * FIRST_PRECISION);
	while (!round_at(c, output, t, two_words, &value)) {
		if (c->precision >= ENOUGH && round_exactly(c, output, t, two_words, &value))
			break;
		if (2 * c->precision > LIMIT_PRECISION || !c->known)
			undecided(c->at, what);
		begin(c, 2 * c->precision);
	}
	return value;
}
