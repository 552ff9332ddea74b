/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whether two models differ in how large their loads are, and in nothing else: so a param is known as an amplitude. */
#include "model/checks.h"
#include "model/regions/switching_functions.h"
#include "model/reads.h"
#include "model/regions/regions.h"

#include <string.h>

/* Of all but what loads act with: *loads is set where that differs */
static bool same_but_loads(const struct linear *p, const struct linear *q, bool *loads)
{
	const size_t cells = (size_t)p->n * (size_t)p->n;
	if (p->states != q->states || p->loads != q->loads || p->segments != q->segments ||
	    !rationals_equal(cells, p->M, q->M) || !rationals_equal(cells, p->C, q->C) ||
	    !rationals_equal(cells, p->K, q->K))
		return false;
	for (int l = 0; l < p->loads; l++) {
		const struct forcing *u = p->load[l].forcing, *v = q->load[l].forcing;
		if (!mpq_equal(u->a, v->a) || !mpq_equal(u->w, v->w) || !mpq_equal(u->p, v->p) ||
		    p->load[l].columns != q->load[l].columns)
			return false;
		for (int c = 0; c < p->load[l].columns; c++)
			*loads = *loads || !rationals_equal((size_t)(p->segments * p->n), p->load[l].force[c],
							    q->load[l].force[c]);
	}
	return true;
}

/* ---- what is not linear ---- */

/* Texts of remainders that are cut short say nothing. */
static bool same_remainders(const struct model *a, const struct model *b)
{
	if (a->schedule.operators != b->schedule.operators || a->remainder.force_columns != b->remainder.force_columns)
		return false;
	for (int k = 0; k < a->schedule.operators * a->remainder.force_columns; k++) {
		const char *left = form_text(
			a, a->schedule.operator[k / a->remainder.force_columns].left[k % a->remainder.force_columns]);
		const char *other = form_text(
			b, b->schedule.operator[k / a->remainder.force_columns].left[k % a->remainder.force_columns]);
		if (strstr(left, "...") || strcmp(left, other) != 0)
			return false;
	}
	return true;
}

/* ---- regions ---- */

/* What is compared with breakpoints may read loads. */
static bool same_breakpoints(const struct switching *a, const struct switching *b, int states)
{
	bool same = a->functions == b->functions && a->regions == b->regions && a->systems == b->systems &&
		    a->parts == b->parts;
	for (int i = 0; i < a->functions && same; i++) {
		const struct switching_function *e = &a->function[i], *f = &b->function[i];
		same = e->breaks == f->breaks && rationals_equal(e->breaks, e->at, f->at) &&
		       rationals_equal(states, e->row->state, f->row->state);
	}
	return same;
}

/* A constant that is a load changes alike in all regions; one of the law of a spring or a friction does not. */
static bool change_alike(const struct switching *a, const struct switching *b)
{
	bool alike = true;
	RATIONAL first = ZERO, other = ZERO;
	for (int l = 0; a->systems > 0 && l < a->system->loads; l++) {
		const struct forcing *forcing = a->system->load[l].forcing;
		const bool constant = mpq_sgn(forcing->a) == 0 && !oscillates(forcing);
		const int numbers = a->system->segments * a->system->n;
		for (int k = 1; k < a->systems && constant; k++)
			for (int i = 0; i < numbers && alike; i++) {
				mpq_sub(first, b->system->load[l].force[0][i], a->system->load[l].force[0][i]);
				mpq_sub(other, b->system[k].load[l].force[0][i], a->system[k].load[l].force[0][i]);
				alike = mpq_equal(first, other);
			}
	}
	return alike;
}

static bool same_regions(const struct model *a, const struct model *b, bool *loads)
{
	const struct switching *p = a->switching, *q = b->switching;
	if (!p != !q || (p && !same_breakpoints(p, q, a->system.states)))
		return false;
	if (!p)
		return true;
	bool same = true;
	for (int k = 0; k < p->parts && same; k++)
		same = same_but_loads(&p->part[k].model->system, &q->part[k].model->system, loads) &&
		       same_regions(p->part[k].model, q->part[k].model, loads);
	for (int k = 0; k < p->systems && same && p->parts == 0; k++)
		same = same_but_loads(&p->system[k], &q->system[k], loads);
	return same && (p->parts > 0 || change_alike(p, q));
}

bool differ_in_loads(const struct model *a, const struct model *b)
{
	bool loads = false;
	return mpq_equal(a->h, b->h) && same_but_loads(&a->system, &b->system, &loads) &&
	       rationals_equal(a->system.states, a->initial, b->initial) && same_remainders(a, b) &&
	       same_regions(a, b, &loads) && loads;
}
