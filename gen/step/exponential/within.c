/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Of steps in normal modes: a state inside a step. The forces of the step are a polynomial through those that it was
 * made from, a_0 + a_1 sigma + ..., sigma = s/h; over a part of the step in which no mode turns or decays by more than
 * 1, eta and eta' are Taylor series:
 *     eta_(k+1) = tau/(k+1) rate_k,   rate_(k+1) = tau/(k+1) (a_k d^k - lambda eta_k - 2 delta rate_k)
 * each multiplied with tau^k, d = tau/h. Once nothing changes the force of each term is that on the term.
 */
#include "inner.h"

#include <math.h>

enum {
	DOUBLE_TERMS = 20, FLOAT_TERMS = 12,    /* 1/20! is below 2^-61, 1/12! below 2^-28 */
	FURTHER_TERMS = 10                      /* beyond the polynomial's last */
};

/* Rows: powers 1 and up; columns: nodes but that at 0, which is the first. Of what a force there exceeds that at 0 */
static double *powers_of(int nodes, const mpq_t *node)
{
	struct lagrange l = lagrange_of(nodes, node);
	int degree = nodes - 1;
	double *factor = ARRAY(double, (size_t)(degree * degree));
	for (int j = 1; j < nodes; j++)
		for (int i = 1; i < nodes; i++)
			factor[(j - 1) * degree + i - 1] = round_real(l.factor[i * nodes + j]);
	return factor;
}

/* Norms of the remainder at the end, on eta and on eta' */
static void last_norms(const struct normal *m, const struct splitting *split, double *norm)
{
	size_t cells = (size_t)m->modes * (size_t)m->modes;
	norm[0] = norm[1] = 0;
	for (int k = 0; k < m->matrices; k++) {
		double size = norm_of_rows(m->modes, m->matrix[k].value + (size_t)m->steady.schedule * cells);
		for (int t = 0; t < m->matrix[k].terms; t++)
			norm[m->matrix[k].term[t].velocity] +=
				fabs(m->matrix[k].term[t].factor[m->steady.schedule] *
				     nearest_double(split->function[m->matrix[k].term[t].function].last)) * size;
	}
}

/* By what a mode or a forcing term turns or decays in a step at most; once nothing changes, the remainder makes modes
 * faster. */
static double angle_of_step(const struct normal_work *w)
{
	const struct normal *m = w->normal;
	double angle = 0, fastest = 0, norm[2], h = nearest_double(w->model->h);
	for (int i = 0; i < m->operators * m->modes; i++) {
		double lambda = mpfr_get_d(w->mode[i].lambda, MPFR_RNDN);
		double turn = sqrt(fabs(lambda)) + 2 * fabs(mpfr_get_d(w->mode[i].delta, MPFR_RNDN));
		angle = turn > angle ? turn : angle;
		fastest = fabs(lambda) > fastest ? fabs(lambda) : fastest;
	}
	for (int k = 0; k < w->model->remainder.split->forcings; k++) {
		const struct forcing *forcing = w->model->remainder.split->forcing[k].forcing;
		double turn = fabs(nearest_double(forcing->a)) + nearest_double(forcing->w);
		angle = turn > angle ? turn : angle;
	}
	if (m->steady.flow) {
		last_norms(m, w->model->remainder.split, norm);
		angle += norm[1];
		fastest = fastest > norm[0] ? fastest : norm[0];
		angle += norm[0] > 0 ? norm[0] / sqrt(fastest) : 0;
	}
	return angle * h;
}

void find_within(struct normal_work *w)
{
	struct normal *m = w->normal;
	struct within *within = &m->within;
	int most = m->multistep.points ? m->multistep.points : m->collocation.stages,
	    terms = w->model->request.single ? FLOAT_TERMS : DOUBLE_TERMS;
	bool damped = false;
	within->angle = angle_of_step(w);
	within->terms = terms > most + FURTHER_TERMS ? terms : most + FURTHER_TERMS;
	within->stiffness = ARRAY(double, (size_t)(m->operators * m->width));
	within->damping = ARRAY(double, (size_t)(m->operators * m->width));
	for (int i = 0; i < m->operators * m->modes; i++) {
		int at = i / m->modes * m->width + m->place[i % m->modes];
		within->stiffness[at] = round_real(w->mode[i].lambda);
		within->damping[at] = 2 * round_real(w->mode[i].delta);
		damped = damped || within->damping[at] != 0;
	}
	within->damping = damped ? within->damping : NULL;
	within->nodes = powers_of(m->collocation.stages + 1, m->collocation.node);
	if (m->multistep.points) {
		mpq_t *node = past_nodes(m->multistep.points + 1);
		mpq_set_ui(node[m->multistep.points], 1, 1);
		within->past = powers_of(m->multistep.points + 1, node);
	}
}
