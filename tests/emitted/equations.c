/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "equations.h"

#include "../accuracy/rationals.h"

#include <mpfr.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BITS = 400 };

static const char *const two_masses[] = {"x1", "x2", "x1'", "x2'"};
static const char *const car[] = {"body", "wheel", "body'", "wheel'"};
static const char *const car_outputs[] = {"body", "wheel", "travel_mm", "comfort", "tyre_force"};
static const char *const floor_and_absorber[] = {"floor", "absorber", "floor'", "absorber'"};
static const char *const floor_outputs[] = {"floor_mm", "stroke_mm", "acceleration"};

/* Accelerations as rows, over x1 x2 x1' x2' and the loads.  The rows of tuned_floor are irrational: see there. */
static const struct table {
	const char *name, *h, *w, *initial;
	enum load load;
	const char *rows;
	int outputs;
	const char *const *state_names, *const *output_names;
} tables[] = {
	{"scs", "1/100", "0", "1/100 0 0 0", NO_LOAD,
	 "-200  100    0    0 "
	 " 100 -200    0    0 ", 4, two_masses, two_masses},
	{"sdcs", "1/100", "0", "1/100 0 0 0", NO_LOAD,
	 "-200  100   -1  1/2 "
	 " 100 -200  1/2   -1 ", 4, two_masses, two_masses},
	{"sdcsf", "1/100", "5", "1/100 0 0 0", WAVE,
	 "-200  100   -1  1/2   1  0 "
	 " 100 -200  1/2   -1   0  0 ", 4, two_masses, two_masses},
	{"scs_weak", "1/100", "0", "1/100 0 0 0", NO_LOAD,
	 "-4040    40   0  0 "
	 "   40 -2040   0  0 ", 4, two_masses, two_masses},
	{"linear2dof", "1/5", "0", "0 0 0 0", CONSTANT,
	 "-3  1  0  0   0 "
	 " 2 -4  0  0  10 ", 4, two_masses, two_masses},
	{"quarter_car", "1/1000", "0", "0 0 0 0", CONSTANT,
	 "-60    60  -4   4    0 "      /* 18000/300, 1200/300 */
	 "450 -4950  30 -30  225 ",     /* 18000/40, 198000/40, 1200/40, 180000 0.05/40 */
	 5, car, car_outputs},
	{"tuned_floor", "1/100", NULL, "0 0 0 0", WAVE, NULL, 3, floor_and_absorber, floor_outputs}
};

mpq_t *new_rationals(int count)
{
	mpq_t *q = malloc((size_t)count * sizeof *q);
	if (!q)
		abort();
	for (int i = 0; i < count; i++)
		mpq_init(q[i]);
	return q;
}

void free_rationals(mpq_t *q, int count)
{
	for (int i = 0; i < count; i++)
		mpq_clear(q[i]);
	free(q);
}

static void read_rationals(const char *text, int count, mpq_t *q)
{
	for (int i = 0; i < count; i++) {
		char word[40];
		int length = 0;
		if (sscanf(text, "%39s%n", word, &length) != 1 || rational_parse(q[i], word) != 0)
			abort();
		text += length;
	}
}

static void set_exactly(mpq_t to, mpfr_t x, int sign)
{
	mpfr_get_q(to, x);
	if (sign < 0)
		mpq_neg(to, to);
}

/* Per unit mass of its own: floor'' + 2 zeta w0 floor' + w0^2 floor + mu (wd^2 r + 2 zd wd r') = F/m sin(w0 t),
 * absorber'' = wd^2 r + 2 zd wd r', r = floor - absorber, zeta = 1/100, mu = 1/50, w0 = 4 pi, wd = w0/(1+mu), zd =
 * sqrt(3 mu/(8 (1+mu)^3)), F/m = 400/20000. */
static void tuned_floor(struct equations *e)
{
	mpfr_t w0, wd2, d, x;
	mpfr_inits2(BITS, w0, wd2, d, x, (mpfr_ptr)0);
	mpfr_const_pi(w0, MPFR_RNDN);
	mpfr_mul_ui(w0, w0, 4, MPFR_RNDN);
	mpfr_mul_ui(wd2, w0, 50, MPFR_RNDN);
	mpfr_div_ui(wd2, wd2, 51, MPFR_RNDN);
	mpfr_set_ui(d, 3 * 50 * 50, MPFR_RNDN);         /* zd^2 = (3/50)/(8 (51/50)^3) = 7500/1061208 */
	mpfr_div_ui(d, d, 8 * 51 * 51 * 51, MPFR_RNDN);
	mpfr_sqrt(d, d, MPFR_RNDN);
	mpfr_mul(d, d, wd2, MPFR_RNDN);
	mpfr_mul_ui(d, d, 2, MPFR_RNDN);                /* 2 zd wd */
	mpfr_sqr(wd2, wd2, MPFR_RNDN);
	mpq_t *floor = e->A + 2 * e->size, *absorber = e->A + 3 * e->size;
	set_exactly(absorber[0], wd2, 1);
	set_exactly(absorber[1], wd2, -1);
	set_exactly(absorber[2], d, 1);
	set_exactly(absorber[3], d, -1);
	mpfr_div_ui(wd2, wd2, 50, MPFR_RNDN);
	mpfr_div_ui(d, d, 50, MPFR_RNDN);
	set_exactly(floor[1], wd2, 1);
	set_exactly(floor[3], d, 1);
	mpfr_sqr(x, w0, MPFR_RNDN);
	mpfr_add(x, x, wd2, MPFR_RNDN);
	set_exactly(floor[0], x, -1);
	mpfr_div_ui(x, w0, 50, MPFR_RNDN);
	mpfr_add(x, x, d, MPFR_RNDN);
	set_exactly(floor[2], x, -1);
	mpq_set_ui(floor[5], 1, 50);
	mpfr_get_q(e->w, w0);
	mpfr_clears(w0, wd2, d, x, (mpfr_ptr)0);
}

static struct equations *built(const struct table *table)
{
	struct equations *e = calloc(1, sizeof *e);
	if (!e)
		abort();
	e->name = table->name;
	e->states = 4;
	e->load = table->load;
	e->size = 4 + (int)table->load;
	e->A = new_rationals(e->size * e->size);
	e->initial = new_rationals(4);
	e->outputs = table->outputs;
	e->state_names = table->state_names;
	e->output_names = table->output_names;
	mpq_inits(e->h, e->w, NULL);
	read_rationals(table->h, 1, &e->h);
	read_rationals(table->initial, 4, e->initial);
	mpq_set_ui(e->A[0 * e->size + 2], 1, 1);
	mpq_set_ui(e->A[1 * e->size + 3], 1, 1);
	if (table->rows) {
		read_rationals(table->w, 1, &e->w);
		read_rationals(table->rows, 2 * e->size, e->A + 2 * e->size);
	} else {
		tuned_floor(e);
	}
	if (e->load == WAVE) {                          /* cos' = -w sin, sin' = w cos */
		mpq_neg(e->A[4 * e->size + 5], e->w);
		mpq_set(e->A[5 * e->size + 4], e->w);
	}
	return e;
}

struct equations *equations_of(const char *name)
{
	for (size_t i = 0; i < sizeof tables / sizeof *tables; i++)
		if (strcmp(tables[i].name, name) == 0)
			return built(&tables[i]);
	return NULL;
}

void equations_free(struct equations *e)
{
	free_rationals(e->A, e->size * e->size);
	free_rationals(e->initial, e->states);
	mpq_clears(e->h, e->w, NULL);
	free(e);
}

void equations_vector(const struct equations *e, const double *y, const mpq_t t, mpq_t *x)
{
	for (int i = 0; i < e->states; i++)
		mpq_set_d(x[i], y[i]);
	if (e->load == CONSTANT)
		mpq_set_ui(x[4], 1, 1);
	if (e->load != WAVE)
		return;
	mpfr_t angle, cosine, sine;
	mpfr_inits2(BITS, angle, cosine, sine, (mpfr_ptr)0);
	mpq_mul(x[4], e->w, t);
	mpfr_set_q(angle, x[4], MPFR_RNDN);
	mpfr_sin_cos(sine, cosine, angle, MPFR_RNDN);
	mpfr_get_q(x[4], cosine);
	mpfr_get_q(x[5], sine);
	mpfr_clears(angle, cosine, sine, (mpfr_ptr)0);
}

void equations_time(const struct equations *e, unsigned long k, mpq_t t)
{
	mpq_set_ui(t, k, 1);
	mpq_mul(t, t, e->h);
}

double nearest_double(const mpq_t q)
{
	mpfr_t x;
	mpfr_init2(x, 53);
	mpfr_set_q(x, q, MPFR_RNDN);
	const double d = mpfr_get_d(x, MPFR_RNDN);
	mpfr_clear(x);
	return d;
}
