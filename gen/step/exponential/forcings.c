/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What a known load e^{a t} cos(w t + p), or sin, does to a mode eta'' + 2 delta eta' + lambda eta = F over a part of a
 * step. Of its values C and S at the step's start, cos(w (t + s) + p) = C cos(w s) - S sin(w s), so the response is C
 * and S times those to cos and sin from rest, which Taylor series give. No quadrature has a part in it.
 */
#include "inner.h"

#include <math.h>

enum { FORCING_BITS = 512 };

struct waving {                     /* terms of series in theta, as at theta: under cos, under sin */
	mpfr_t eta[2], rate[2], forcing[2];
	mpfr_t a, w, lambda, twice;
};

/* The terms after these: by is theta h/(k + 1) */
static void next_terms(struct waving *z, mpfr_srcptr by, mpfr_t *part)
{
	for (int d = 0; d < 2; d++) {
		mpfr_mul(part[d], z->lambda, z->eta[d], MPFR_RNDN);
		mpfr_mul(part[2], z->twice, z->rate[d], MPFR_RNDN);
		mpfr_add(part[d], part[d], part[2], MPFR_RNDN);
		mpfr_sub(part[d], z->forcing[d], part[d], MPFR_RNDN);
		mpfr_mul(z->eta[d], by, z->rate[d], MPFR_RNDN);
		mpfr_mul(z->rate[d], by, part[d], MPFR_RNDN);
	}
	mpfr_mul(part[0], z->a, z->forcing[0], MPFR_RNDN);      /* (a + i w) (cos + i sin) */
	mpfr_mul(part[1], z->w, z->forcing[1], MPFR_RNDN);
	mpfr_sub(part[2], part[0], part[1], MPFR_RNDN);
	mpfr_mul(part[0], z->a, z->forcing[1], MPFR_RNDN);
	mpfr_mul(part[1], z->w, z->forcing[0], MPFR_RNDN);
	mpfr_add(part[1], part[0], part[1], MPFR_RNDN);
	mpfr_mul(z->forcing[0], by, part[2], MPFR_RNDN);
	mpfr_mul(z->forcing[1], by, part[1], MPFR_RNDN);
}

/* Terms of the series: more than e times the angle that the fastest turns through, and what is left of the bits */
static int terms_of_forcings(const struct waving *z, mpfr_srcptr time)
{
	double size = sqrt(fabs(mpfr_get_d(z->lambda, MPFR_RNDN))) + fabs(mpfr_get_d(z->twice, MPFR_RNDN)) +
		      fabs(mpfr_get_d(z->a, MPFR_RNDN)) + mpfr_get_d(z->w, MPFR_RNDN);
	return (int)(4 * size * mpfr_get_d(time, MPFR_RNDN)) + FORCING_BITS;
}

/* From rest, over theta h: eta and eta' under a force e^{a s} cos(w s), then under e^{a s} sin(w s) */
static void swing_of(const struct normal_mode *mode, const struct forcing *forcing, mpq_srcptr h, mpq_srcptr theta,
		     mpfr_t *response)
{
	struct waving z;
	REAL time = WITH_BITS(FORCING_BITS);
	mpfr_inits2(FORCING_BITS, z.a, z.w, z.lambda, z.twice, NULL);
	mpfr_set_q(z.a, forcing->a, MPFR_RNDN);
	mpfr_set_q(z.w, forcing->w, MPFR_RNDN);
	mpfr_set(z.lambda, mode->lambda, MPFR_RNDN);
	mpfr_mul_2ui(z.twice, mode->delta, 1, MPFR_RNDN);
	mpfr_set_q(time, h, MPFR_RNDN);
	mpfr_mul_q(time, time, theta, MPFR_RNDN);
	int terms = terms_of_forcings(&z, time), bits = FORCING_BITS + terms;
	REAL by = WITH_BITS(bits);
	REALS *part = reals(3, bits), *sum = reals(4, bits);
	for (int d = 0; d < 2; d++) {
		mpfr_inits2(bits, z.eta[d], z.rate[d], z.forcing[d], NULL);
		mpfr_set_zero(z.eta[d], 1);
		mpfr_set_zero(z.rate[d], 1);
		mpfr_set_ui(z.forcing[d], d == 0, MPFR_RNDN);
	}
	for (int k = 0; k < terms; k++) {
		mpfr_div_ui(by, time, (unsigned long)k + 1, MPFR_RNDN);
		next_terms(&z, by, part);
		for (int d = 0; d < 2; d++) {
			mpfr_add(sum[2 * d], sum[2 * d], z.eta[d], MPFR_RNDN);
			mpfr_add(sum[2 * d + 1], sum[2 * d + 1], z.rate[d], MPFR_RNDN);
		}
	}
	for (int d = 0; d < 4; d++)
		mpfr_set(response[d], sum[d], MPFR_RNDN);
	mpfr_clears(z.eta[0], z.eta[1], z.rate[0], z.rate[1], z.forcing[0], z.forcing[1], z.a, z.w, z.lambda, z.twice,
		    NULL);
}

/* ---- all of a stage ---- */

/* sum <- V^T F of mode j */
static void project(const struct normal_work *w, int schedule, const mpq_t *force, int j, mpfr_ptr sum)
{
	int n = w->normal->modes;
	REAL part = WITH_BITS(mpfr_get_prec(sum));
	mpfr_set_zero(sum, 1);
	for (int i = 0; i < n; i++) {
		mpfr_mul_q(part, w->pairs[schedule].vector[i * n + j], force[i], MPFR_RNDN);
		mpfr_add(sum, sum, part, MPFR_RNDN);
	}
}

void check_turns(const struct step *step)
{
	const struct splitting *split = step->model->remainder.split;
	double h = nearest_double(step->model->h);
	for (int k = 0; k < split->forcings; k++) {
		const struct forcing *forcing = split->forcing[k].forcing;
		double turn = (fabs(nearest_double(forcing->a)) + nearest_double(forcing->w)) * h;
		if (!(turn <= LIMIT_WITHIN))
			error(step->model->request.at.step,
			      "a shorter step can; with --loads remainder it is a polynomial",
			      "scheme %s follows loads that turn or grow by at most %d in a step, which that of "
			      "%s 1/s exceeds", scheme_name(step->model->scheme), LIMIT_WITHIN,
			      readable_text(mpq_sgn(forcing->w) ? forcing->w : forcing->a));
	}
}

void find_forcings(struct normal_work *w)
{
	struct normal *normal = w->normal;
	const struct splitting *split = w->model->remainder.split;
	int forcings = split->forcings, width = normal->width;
	REAL force = WITH_BITS(FORCING_BITS);
	normal->forcing = ARRAY(double, (size_t)(normal->operators * forcings * 2 * width));
	for (int i = 0; i < normal->operators * forcings * 2; i++)
		for (int j = 0; j < normal->modes; j++) {
			const mpq_t *own = split->forcing[i / 2 % forcings].force[i % 2];
			project(w, i / 2 / forcings, own, j, force);
			normal->forcing[i * width + normal->place[j]] = round_real(force);
		}
}

/* Of mode j, to theta h: of cos at the start gc Rc + gs Rs, of sin gs Rc - gc Rs; eta and eta' of each */
static void weigh_forcing(const struct normal_work *w, int schedule, int k, int j, mpq_srcptr theta, double *weight)
{
	const struct forcing_force *own = &w->model->remainder.split->forcing[k];
	REALS *R = reals(4, FORCING_BITS);
	REAL of_cos = WITH_BITS(FORCING_BITS), of_sin = WITH_BITS(FORCING_BITS), sum = WITH_BITS(FORCING_BITS),
	     part = WITH_BITS(FORCING_BITS);
	swing_of(&w->mode[schedule * w->normal->modes + j], own->forcing, w->model->h, theta, R);
	project(w, schedule, own->force[0], j, of_cos);
	project(w, schedule, own->force[1], j, of_sin);
	for (int d = 0; d < 2; d++) {
		mpfr_mul(sum, of_cos, R[d], MPFR_RNDN);
		mpfr_mul(part, of_sin, R[2 + d], MPFR_RNDN);
		mpfr_add(sum, sum, part, MPFR_RNDN);
		weight[d * w->normal->width] = round_real(sum);
		mpfr_mul(sum, of_sin, R[d], MPFR_RNDN);
		mpfr_mul(part, of_cos, R[2 + d], MPFR_RNDN);
		mpfr_sub(sum, sum, part, MPFR_RNDN);
		weight[(2 + d) * w->normal->width] = round_real(sum);
	}
}

double *forcings_of_stage(const struct normal_work *w, mpq_srcptr theta)
{
	const struct normal *normal = w->normal;
	int forcings = w->model->remainder.split->forcings;
	double *weight = ARRAY(double, (size_t)(normal->operators * forcings * 4 * normal->width));
	for (int i = 0; i < normal->operators * forcings; i++)
		for (int j = 0; j < normal->modes; j++)
			weigh_forcing(w, i / forcings, i % forcings, j, theta,
				   weight + i * 4 * normal->width + normal->place[j]);
	return weight;
}
