/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How a scene moves from one event to the next, and which modes hold behind each. */
#include "moving.h"

/* ---- which modes hold behind an event ---- */

static void log_event(const struct moving *m, struct truth *found, double time, int contact, enum mode from,
	enum mode to)
{
	const struct contact *c = &m->s->contact[contact];
	if (c->kind == FRICTION && c->force.at[m->segment] == 0 && c->force.slope[m->segment] == 0 && c->more == 0)
		return;                         /* it is not there */
	if (found->events == MOST_FOUND) {
		doubt_view(found, "too many events");
		return;
	}
	found->event[found->events++] = (struct event){ time, contact, from, to };
}

/* v -> v - (1 + e) M^-1 G^T (G v)/(G M^-1 G^T), e in thousandths */
static void strike(struct moving *m, int index, long e)
{
	const struct scene *s = m->s;
	mpfr_t speed, weight, mass, part;
	mpfr_inits2(BITS, speed, weight, mass, part, (mpfr_ptr)0);
	measure_now(m, index, 1, speed);
	mpfr_set_zero(weight, 1);
	for (int i = 0; i < s->n; i++) {
		if (share(&s->contact[index], i) == 0)
			continue;
		thousandths(mass, s->mass[i]);
		mpfr_ui_div(mass, 1, mass, MPFR_RNDN);
		mpfr_add(weight, weight, mass, MPFR_RNDN);
	}
	mpfr_div(speed, speed, weight, MPFR_RNDN);
	mpfr_mul_si(speed, speed, 1000 + e, MPFR_RNDN);
	mpfr_div_ui(speed, speed, 1000, MPFR_RNDN);
	for (int i = 0; i < s->n; i++) {
		thousandths(mass, s->mass[i]);
		mpfr_mul_si(part, speed, share(&s->contact[index], i), MPFR_RNDN);
		mpfr_div(part, part, mass, MPFR_RNDN);
		mpfr_sub(m->x[s->n + i], m->x[s->n + i], part, MPFR_RNDN);
	}
	mpfr_clears(speed, weight, mass, part, (mpfr_ptr)0);
}

/* In the order of contacts, each from the velocities that the one before has left, until none comes closer */
static void strike_all(struct moving *m, bool *struck)
{
	mpfr_t off, speed;
	mpfr_inits2(BITS, off, speed, (mpfr_ptr)0);
	int rounds = 0;
	for (int i = 0; i < m->s->contacts; i++) {
		if (m->s->contact[i].kind != IMPACT)
			continue;
		measure_now(m, i, 0, off);
		measure_now(m, i, 1, speed);
		if (mpfr_cmpabs(off, m->tiny) > 0 || mpfr_cmp(speed, m->tiny) <= 0)
			continue;
		if (++rounds > 200) {
			doubt(m, "impacts without an end at one instant");
			break;
		}
		strike(m, i, m->s->contact[i].restitution);
		struck[i] = true;
		m->mode[i] = OPEN;
		i = -1;
	}
	mpfr_clears(off, speed, (mpfr_ptr)0);
}

/* Whether this combination keeps to the laws of the contacts in `open` from here on */
static bool lawful(struct moving *m, const bool *open)
{
	row r;
	bool good = true;
	row_start(r, MOST);
	fill_equations(m);
	for (int i = 0; i < m->s->contacts && good; i++) {
		if (!open[i])
			continue;
		if (m->mode[i] == FORWARD || m->mode[i] == BACKWARD) {
			measure(m, i, 1, r);
			good = first_sign(m, r, 1) == (m->mode[i] == FORWARD ? 1 : -1);
		} else if (m->mode[i] == OPEN) {
			measure(m, i, 0, r);
			good = first_sign(m, r, 2) < 0;
		} else {
			for (int which = 0; good && guard(m, i, which, r); which++)
				good = first_sign(m, r, 0) < 0 + (m->mode[i] == RESTING);
		}
	}
	row_stop(r, MOST);
	return good;
}

static void try_all(struct moving *m, const bool *open, int index, enum mode *best, int *count)
{
	if (index == m->s->contacts) {
		if (lawful(m, open))
			for (int i = ((*count)++, 0); i < m->s->contacts; i++)
				best[i] = m->mode[i];
		return;
	}
	enum mode before = m->mode[index];
	enum mode first = m->s->contact[index].kind == FRICTION ? BACKWARD : OPEN;
	enum mode last = m->s->contact[index].kind == FRICTION ? FORWARD : RESTING;
	if (!open[index])
		try_all(m, open, index + 1, best, count);
	else
		for (enum mode mode = first; mode <= last; mode++) {
			if (mode == CLOSED)
				continue;
			m->mode[index] = mode;
			try_all(m, open, index + 1, best, count);
		}
	m->mode[index] = before;
}

/* Contacts whose law is open: friction without velocity, impacts that touch and neither come nor go */
static void find_open(struct moving *m, bool *open)
{
	mpfr_t off, speed;
	row r;
	mpfr_inits2(BITS, off, speed, (mpfr_ptr)0);
	row_start(r, MOST);
	for (int i = 0; i < m->s->contacts; i++) {
		measure_now(m, i, 0, off);
		measure_now(m, i, 1, speed);
		const bool touches = mpfr_cmpabs(off, m->tiny) <= 0, still = mpfr_cmpabs(speed, m->tiny) <= 0;
		open[i] = false;
		switch (m->s->contact[i].kind) {
		case STOP:
			if (touches && still)
				doubt(m, "a stop touched without velocity");
			m->mode[i] = touches ? (mpfr_sgn(speed) > 0 ? CLOSED : OPEN)
					     : (mpfr_sgn(off) > 0 ? CLOSED : OPEN);
			break;
		case FRICTION:
			open[i] = still;
			if (!still)
				m->mode[i] = mpfr_sgn(speed) > 0 ? FORWARD : BACKWARD;
			break;
		case IMPACT:
			open[i] = touches && still;
			if (!open[i])
				m->mode[i] = OPEN;
			break;
		}
	}
	row_stop(r, MOST);
	mpfr_clears(off, speed, (mpfr_ptr)0);
}

/* How long bounces of contact i will still go on, from the velocity that it leaves with; -1: for good */
static double bounces_left(struct moving *m, int i)
{
	const long e = m->s->contact[i].restitution;
	row r, slope;
	mpfr_t speed, push;
	double left = -1;
	row_start(r, MOST);
	row_start(slope, MOST);
	mpfr_inits2(BITS, speed, push, (mpfr_ptr)0);
	measure(m, i, 1, r);
	expand(m, 0);
	dot(m->size, r, m->x, speed);
	for (int k = 0; k < m->left; k++)
		dot(m->size, (mpfr_t *)m->A[k], m->x, slope[k]);
	dot(m->size, r, slope, push);
	if (e < 1000 && mpfr_sgn(push) > 0) {
		mpfr_div(speed, speed, push, MPFR_RNDN);
		left = -2 * mpfr_get_d(speed, MPFR_RNDN) * 1000 / (double)(1000 - e);
	}
	row_stop(r, MOST);
	row_stop(slope, MOST);
	mpfr_clears(speed, push, (mpfr_ptr)0);
	return left;
}

static bool others_near(struct moving *m, int index)
{
	bool near = false;
	mpfr_t off;
	mpfr_init2(off, BITS);
	for (int i = 0; i < m->s->contacts; i++) {
		if (i == index || m->s->contact[i].kind != IMPACT)
			continue;
		measure_now(m, i, 0, off);
		near = near || fabs(mpfr_get_d(off, MPFR_RNDN)) < 1e-18;
	}
	mpfr_clear(off);
	return near;
}

static void note_speeds(struct moving *m)
{
	mpfr_t off, speed;
	mpfr_inits2(BITS, off, speed, (mpfr_ptr)0);
	for (int i = 0; i < m->s->contacts; i++) {
		measure_now(m, i, 0, off);
		measure_now(m, i, 1, speed);
		const double size = fabs(mpfr_get_d(speed, MPFR_RNDN));
		if (m->s->contact[i].kind == FRICTION || mpfr_cmpabs(off, m->tiny) > 0 || size <= 1e-6)
			continue;
		for (int k = 0; k < m->views; k++)
			if (!m->view[k].hidden[i])
				m->view[k].found->slowest = fmin(size, m->view[k].found->slowest);
	}
	mpfr_clears(off, speed, (mpfr_ptr)0);
}

/* left: how long its bounces go on, or -1 */
static void log_bounce(struct moving *m, double time, int contact, double left)
{
	for (int k = 0; k < m->views; k++) {
		struct view *view = &m->view[k];
		if (view->hidden[contact])
			continue;
		log_event(m, view->found, time, contact, OPEN, OPEN);
		if (left >= 0 && left < view->brief) {
			view->hidden[contact] = true;
			log_event(m, view->found, time + left, contact, OPEN, RESTING);
		}
	}
}

/* From `before` to the modes that hold now */
static void log_modes(struct moving *m, double time, const enum mode *before)
{
	for (int k = 0; k < m->views; k++)
		for (int i = 0; i < m->s->contacts; i++) {
			bool *hidden = &m->view[k].hidden[i];
			if (m->mode[i] != before[i] && !*hidden)
				log_event(m, m->view[k].found, time, i, before[i], m->mode[i]);
			if (m->mode[i] == RESTING)
				*hidden = false;
		}
}

static void settle(struct moving *m)
{
	static const double nothing = 1e-21;    /* [s] */
	const int n = m->s->contacts;
	bool open[MOST_CONTACTS] = { false }, struck[MOST_CONTACTS] = { false };
	enum mode before[MOST_CONTACTS], best[MOST_CONTACTS];
	const double time = mpfr_get_d(m->time, MPFR_RNDN);
	for (int i = 0; i < n; i++)
		best[i] = before[i] = m->mode[i];
	note_speeds(m);
	strike_all(m, struck);
	for (int again = 1; again; ) {
		int count = 0;
		again = 0;
		find_open(m, open);
		for (int i = 0; i < n; i++)
			best[i] = m->mode[i];
		try_all(m, open, 0, best, &count);
		if (count != 1)
			doubt(m, count ? "more than one combination" : "no combination");
		for (int i = 0; i < n; i++)
			m->mode[i] = best[i];
		fill_equations(m);
		for (int i = 0; i < n && !again; i++) {
			if (!struck[i] || m->mode[i] != OPEN)
				continue;
			const double left = bounces_left(m, i);
			log_bounce(m, time, i, left);
			struck[i] = false;
			if (left >= 0 && left < nothing && others_near(m, i))
				doubt(m, "several come to rest together");
			if (left >= 0 && left < nothing) {
				strike(m, i, 0);
				again = 1;
			}
		}
	}
	log_modes(m, time, before);
}

/* ---- in time ---- */

static void go(struct moving *m, mpfr_srcptr by)
{
	for (int i = 0; i < m->size; i++) {
		mpfr_set(m->x[i], m->series[m->degree][i], MPFR_RNDN);
		for (int k = m->degree - 1; k >= 0; k--) {
			mpfr_mul(m->x[i], m->x[i], by, MPFR_RNDN);
			mpfr_add(m->x[i], m->x[i], m->series[k][i], MPFR_RNDN);
		}
	}
	mpfr_add(m->time, m->time, by, MPFR_RNDN);
}

/* A length over which 58 terms of the series are enough: |A| of it is below 4 (4^59/59! < 1e-44); or 30, where it is
 * below 1/2 (0.5^31/31! < 1e-43): forces that are left turn no faster than their linear parts, of a size of q and v of
 * about 1 */
static double piece_of(const struct moving *m)
{
	double most = 1;
	for (int i = 0; i < MOST; i++) {
		double sum = 0;
		for (int j = 0; j < MOST; j++)
			sum += fabs(mpfr_get_d(m->A[i][j], MPFR_RNDN));
		most = sum > most ? sum : most;
	}
	return ldexp(1, (m->s->left ? -2 : 1) - ilogb(most));
}

/* The first event within `width`: true, and where */
static bool next_event(struct moving *m, mpfr_ptr width)
{
	mpfr_t p[DEGREE + 1], at;
	row r;
	bool any = false;
	row_start(p, DEGREE + 1);
	row_start(r, MOST);
	mpfr_init2(at, BITS);
	for (int i = 0; i < m->s->contacts; i++)
		for (int which = 0; guard(m, i, which, r); which++) {
			for (int k = 0; k <= m->degree; k++)
				dot(m->size, r, m->series[k], p[k]);
			if (first_rise(p, width, m->tiny, at)) {
				mpfr_set(width, at, MPFR_RNDN);
				any = true;
			}
		}
	row_stop(p, DEGREE + 1);
	row_stop(r, MOST);
	mpfr_clear(at);
	return any;
}

static void start(struct moving *m, double nudge)
{
	const struct scene *s = m->s;
	m->one = 2 * s->n;
	m->left = 2 * s->n + 4;
	m->size = m->left + (s->left ? 3 * s->n : 0);
	m->degree = s->left ? 30 : DEGREE;
	for (int i = 0; i < MOST_MASSES; i++) {
		row_start(m->square[i], DEGREE + 1);
		row_start(m->cosine[i], DEGREE + 1);
		row_start(m->rate[i], DEGREE + 1);
	}
	for (int i = 0; i < MOST; i++)
		row_start(m->A[i], MOST);
	for (int i = 0; i < MOST_CONTACTS; i++)
		row_start(m->force[i], MOST);
	for (int k = 0; k <= DEGREE; k++)
		row_start(m->series[k], MOST);
	row_start(m->x, MOST);
	mpfr_inits2(BITS, m->time, m->tiny, (mpfr_ptr)0);
	mpfr_set_zero(m->time, 1);
	mpfr_set_d(m->tiny, 1e-40, MPFR_RNDN);
	for (int i = 0; i < s->n; i++) {
		thousandths(m->x[i], s->start[i]);
		thousandths(m->x[s->n + i], s->speed[i]);
		mpfr_add_d(m->x[i], m->x[i], nudge, MPFR_RNDN);
		if (s->speed[i] != 0)
			mpfr_add_d(m->x[s->n + i], m->x[s->n + i], nudge, MPFR_RNDN);
	}
	mpfr_set_ui(m->x[m->one], 1, MPFR_RNDN);
	mpfr_set_ui(m->x[m->one + 1], 1, MPFR_RNDN);
	for (int i = 0; i < s->contacts; i++)
		m->mode[i] = s->contact[i].kind == FRICTION ? STICKING : OPEN;
	settle(m);
	for (int k = 0; k < m->views; k++)
		m->view[k].found->events = 0;   /* where it starts is no event */
}

static void finish(struct moving *m)
{
	for (int k = 0; k < m->views; k++)
		for (int i = 0; i < m->s->n; i++) {
			m->view[k].found->q[i] = mpfr_get_d(m->x[i], MPFR_RNDN);
			m->view[k].found->v[i] = mpfr_get_d(m->x[m->s->n + i], MPFR_RNDN);
		}
	for (int i = 0; i < MOST; i++)
		row_stop(m->A[i], MOST);
	for (int i = 0; i < MOST_CONTACTS; i++)
		row_stop(m->force[i], MOST);
	for (int k = 0; k <= DEGREE; k++)
		row_stop(m->series[k], MOST);
	for (int i = 0; i < MOST_MASSES; i++) {
		row_stop(m->square[i], DEGREE + 1);
		row_stop(m->cosine[i], DEGREE + 1);
		row_stop(m->rate[i], DEGREE + 1);
	}
	row_stop(m->x, MOST);
	mpfr_clears(m->time, m->tiny, (mpfr_ptr)0);
}

/* At the end of a segment of time, if it is one: the laws behind it, and what they make of the contacts */
static void pass_change(struct moving *m, mpfr_srcptr change)
{
	mpfr_set(m->time, change, MPFR_RNDN);
	mpfr_set(m->x[m->one + 3], change, MPFR_RNDN);
	m->segment++;
	settle(m);
}

void truth_run(const struct scene *s, double until, int views, const double *brief, double nudge, struct truth *found)
{
	struct moving *m = calloc(1, sizeof *m);
	mpfr_t width, left, end, change;
	m->s = s;
	m->views = views;
	for (int k = 0; k < views; k++) {
		found[k] = (struct truth){ .slowest = 1 };
		m->view[k] = (struct view){ .brief = brief[k], .found = &found[k] };
	}
	start(m, nudge);
	bool any = false;
	for (int i = 0; i < s->contacts; i++)
		any = any || s->contact[i].kind != FRICTION || s->segments > 1 ||
				s->contact[i].force.at[0] + s->contact[i].more > 0;
	if (!any)
		doubt(m, "nothing touches");
	mpfr_inits2(BITS, width, left, end, change, (mpfr_ptr)0);
	mpfr_set_d(end, until * 1000, MPFR_RNDN);       /* a whole number of thousandths */
	mpfr_rint(end, end, MPFR_RNDN);
	mpfr_div_ui(end, end, 1000, MPFR_RNDN);
	while (decides(m)) {
		const bool last = m->segment + 1 == s->segments;
		thousandths(change, last ? 0 : s->change[m->segment]);
		mpfr_sub(left, end, m->time, MPFR_RNDN);
		if (mpfr_cmp(left, m->tiny) <= 0)
			break;
		if (!last && mpfr_cmp(change, end) < 0)
			mpfr_sub(left, change, m->time, MPFR_RNDN);
		if (mpfr_cmp(left, m->tiny) <= 0) {
			pass_change(m, change);
			continue;
		}
		mpfr_set_d(width, piece_of(m), MPFR_RNDN);
		if (mpfr_cmp(width, left) > 0)
			mpfr_set(width, left, MPFR_RNDN);
		expand(m, m->degree);
		check_limits(m);
		const bool event = next_event(m, width);
		go(m, width);
		if (event)
			settle(m);
	}
	mpfr_clears(width, left, end, change, (mpfr_ptr)0);
	finish(m);
	free(m);
}
