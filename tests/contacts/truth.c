/* SPDX-License-Identifier: GPL-3.0-or-later */
/* x = q, v, 1, cos w t, sin w t, t, and where forces are left q^3, q^2 v, sin q. In each segment of time and mode of
 * the contacts x' = A x for all but these, whose series follow from those of q and v; A and forces of contact as rows
 * over x. */
#include "truth.h"

#include "polynomial.h"

#include <math.h>
#include <stdlib.h>

enum { MOST = 5 * MOST_MASSES + 4 };
typedef mpfr_t row[MOST];

struct moving {
	const struct scene *s;
	int size, one, left, segment;   /* entries of x; where 1 is, and what is left */
	int degree;                     /* of its series; those of what is left take products of all */
	enum mode mode[MOST_CONTACTS];
	mpfr_t A[MOST][MOST];
	row force[MOST_CONTACTS];       /* what holds a contact that sticks or rests, along its direction */
	row x;
	mpfr_t series[DEGREE + 1][MOST];
	mpfr_t square[MOST_MASSES][DEGREE + 1], cosine[MOST_MASSES][DEGREE + 1];        /* of q */
	mpfr_t rate[MOST_MASSES][DEGREE + 1];   /* the k-th of q, times k */
	mpfr_t time, tiny;
	int views;
	struct view {
		double brief;
		bool hidden[MOST_CONTACTS];     /* its bounces are listed no more */
		struct truth *found;
	} view[MOST_VIEWS];
};

static void row_start(mpfr_t *r, int count)
{
	for (int i = 0; i < count; i++) {
		mpfr_init2(r[i], BITS);
		mpfr_set_zero(r[i], 1);
	}
}

static void row_stop(mpfr_t *r, int count)
{
	for (int i = 0; i < count; i++)
		mpfr_clear(r[i]);
}

static void zero(mpfr_t *r, int count)
{
	for (int i = 0; i < count; i++)
		mpfr_set_zero(r[i], 1);
}

static void thousandths(mpfr_ptr to, long value)
{
	mpfr_set_si(to, value, MPFR_RNDN);
	mpfr_div_ui(to, to, 1000, MPFR_RNDN);
}

static void dot(int n, mpfr_t *a, mpfr_t *b, mpfr_ptr sum)
{
	static mpfr_t total, part;              /* kept: to make them takes as long as a product */
	static bool made;
	if (!made)
		mpfr_inits2(BITS, total, part, (mpfr_ptr)0);
	made = true;
	mpfr_set_zero(total, 1);
	for (int i = 0; i < n; i++)
		if (!mpfr_zero_p(a[i]) && !mpfr_zero_p(b[i])) {         /* most are */
			mpfr_mul(part, a[i], b[i], MPFR_RNDN);
			mpfr_add(total, total, part, MPFR_RNDN);
		}
	mpfr_set(sum, total, MPFR_RNDN);
}

static void doubt_view(struct truth *found, const char *why)
{
	if (!found->doubtful)
		found->doubt = why;
	found->doubtful = true;
}

static void doubt(struct moving *m, const char *why)
{
	for (int k = 0; k < m->views; k++)
		doubt_view(m->view[k].found, why);
}

static bool decides(const struct moving *m)
{
	bool any = false;
	for (int k = 0; k < m->views; k++)
		any = any || !m->view[k].found->doubtful;
	return any;
}

/* ---- laws ---- */

/* +1 at `on`, -1 at `against`, times the side */
static int share(const struct contact *c, int mass)
{
	int side = c->kind == FRICTION ? 1 : (int)c->side;
	return mass == c->on ? side : mass == c->against ? -side : 0;
}

static bool is_bound(enum mode mode) { return mode == STICKING || mode == RESTING; }

/* a += factor (thousandths) times row e_column */
static void add(mpfr_t *a, int column, long factor)
{
	mpfr_t f;
	mpfr_init2(f, BITS);
	thousandths(f, factor);
	mpfr_add(a[column], a[column], f, MPFR_RNDN);
	mpfr_clear(f);
}

/* a += factor (thousandths) times a law */
static void add_law(const struct moving *m, mpfr_t *a, const struct law *law, long factor)
{
	mpfr_t f, part;
	mpfr_inits2(BITS, f, part, (mpfr_ptr)0);
	thousandths(f, factor);
	thousandths(part, law->at[m->segment]);
	mpfr_fma(a[m->one], f, part, a[m->one], MPFR_RNDN);
	thousandths(part, law->slope[m->segment]);
	mpfr_fma(a[m->one + 3], f, part, a[m->one + 3], MPFR_RNDN);
	mpfr_clears(f, part, (mpfr_ptr)0);
}

/* What friction can be at most: row over x, its factor */
static void add_limit(const struct moving *m, const struct contact *c, bool sticks, long factor, mpfr_t *r)
{
	add_law(m, r, &c->force, 1000 * factor);
	add(r, m->one, sticks ? factor * c->more : 0);
	add(r, m->one + 1, factor * c->swing);
	add(r, c->pad_at, factor * c->pad);
}

/* Forces on masses, without those that hold: row over x for each mass */
static void fill_forces(const struct moving *m, mpfr_t (*f)[MOST])
{
	const struct scene *s = m->s;
	for (int i = 0; i < s->n; i++) {
		zero(f[i], MOST);
		add_law(m, f[i], &s->constant[i], 1000);
		add(f[i], m->one + 1, s->cosine[i].at[m->segment]);
		add(f[i], m->one + 2, s->sine[i].at[m->segment]);
	}
	for (int i = 0; i < s->n && s->left; i++) {
		add(f[i], m->left + i, -s->cubic[i]);
		add(f[i], s->n + i, s->excited[i]);
		add(f[i], m->left + s->n + i, -s->excited[i]);
		add(f[i], m->left + 2 * s->n + i, -s->swing[i]);
	}
	for (int k = 0; k < s->n; k++)          /* spring and damper from mass k to k - 1 */
		for (int end = k; end >= 0 && end >= k - 1; end--)
			for (int other = k; other >= 0 && other >= k - 1; other--) {
				long sign = end == other ? -1 : 1;
				add(f[end], other, sign * s->spring[k]);
				add(f[end], s->n + other, sign * s->damper[k]);
			}
	for (int k = 0; k < s->contacts; k++) {
		const struct contact *c = &s->contact[k];
		for (int i = 0; i < s->n; i++) {
			int here = share(c, i);
			if (here == 0)
				continue;
			if (c->kind == FRICTION && m->mode[k] != STICKING)
				add_limit(m, c, false, m->mode[k] == FORWARD ? -here : here, f[i]);
			if (m->mode[k] != CLOSED)
				continue;
			for (int j = 0; j < s->n; j++)
				add(f[i], j, -here * share(c, j) * c->stiffness);
			add_law(m, f[i], &c->gap, here * c->stiffness);
		}
	}
}

/* W r = b, W k x k, b k rows over x, by elimination with pivots; false: singular */
static bool solve(int k, mpfr_t (*W)[MOST_CONTACTS], mpfr_t (*b)[MOST])
{
	mpfr_t factor;
	mpfr_init2(factor, BITS);
	bool good = true;
	for (int p = 0; p < k && good; p++) {
		int best = p;
		for (int i = p + 1; i < k; i++)
			if (mpfr_cmpabs(W[i][p], W[best][p]) > 0)
				best = i;
		good = fabs(mpfr_get_d(W[best][p], MPFR_RNDN)) > 1e-30;
		for (int j = 0; j < k; j++)
			mpfr_swap(W[p][j], W[best][j]);
		for (int j = 0; j < MOST; j++)
			mpfr_swap(b[p][j], b[best][j]);
		for (int i = 0; i < k && good; i++) {
			if (i == p)
				continue;
			mpfr_div(factor, W[i][p], W[p][p], MPFR_RNDN);
			mpfr_neg(factor, factor, MPFR_RNDN);
			for (int j = 0; j < k; j++)
				mpfr_fma(W[i][j], factor, W[p][j], W[i][j], MPFR_RNDN);
			for (int j = 0; j < MOST; j++)
				mpfr_fma(b[i][j], factor, b[p][j], b[i][j], MPFR_RNDN);
		}
	}
	for (int p = 0; p < k && good; p++)
		for (int j = 0; j < MOST; j++)
			mpfr_div(b[p][j], b[p][j], W[p][p], MPFR_RNDN);
	mpfr_clear(factor);
	return good;
}

/* What holds: G M^-1 (f + G^T r) = the slope of its belt, r as rows over x; f becomes f + G^T r */
static void hold(struct moving *m, mpfr_t (*f)[MOST])
{
	const struct scene *s = m->s;
	int bound[MOST_CONTACTS], k = 0;
	mpfr_t W[MOST_CONTACTS][MOST_CONTACTS], b[MOST_CONTACTS][MOST], mass, part;
	mpfr_inits2(BITS, mass, part, (mpfr_ptr)0);
	for (int c = 0; c < s->contacts; c++)
		if (is_bound(m->mode[c]))
			bound[k++] = c;
	for (int i = 0; i < k; i++) {
		row_start(W[i], MOST_CONTACTS);
		row_start(b[i], MOST);
		if (s->contact[bound[i]].kind == FRICTION)
			add(b[i], m->one, s->contact[bound[i]].belt.slope[m->segment]);
		for (int q = 0; q < s->n; q++) {
			const int here = share(&s->contact[bound[i]], q);
			thousandths(mass, s->mass[q]);
			for (int j = 0; j < k; j++) {
				mpfr_set_si(part, here * share(&s->contact[bound[j]], q), MPFR_RNDN);
				mpfr_div(part, part, mass, MPFR_RNDN);
				mpfr_add(W[i][j], W[i][j], part, MPFR_RNDN);
			}
			for (int j = 0; j < MOST; j++) {
				mpfr_mul_si(part, f[q][j], -here, MPFR_RNDN);
				mpfr_div(part, part, mass, MPFR_RNDN);
				mpfr_add(b[i][j], b[i][j], part, MPFR_RNDN);
			}
		}
	}
	if (!solve(k, W, b))
		doubt(m, "constraints that are not independent");
	for (int i = 0; i < k; i++) {
		for (int j = 0; j < MOST; j++) {
			mpfr_set(m->force[bound[i]][j], b[i][j], MPFR_RNDN);
			for (int q = 0; q < s->n; q++) {
				mpfr_mul_si(part, b[i][j], share(&s->contact[bound[i]], q), MPFR_RNDN);
				mpfr_add(f[q][j], f[q][j], part, MPFR_RNDN);
			}
		}
		row_stop(W[i], MOST_CONTACTS);
		row_stop(b[i], MOST);
	}
	mpfr_clears(mass, part, (mpfr_ptr)0);
}

static void fill_equations(struct moving *m)
{
	const struct scene *s = m->s;
	mpfr_t f[MOST_MASSES][MOST], mass;
	mpfr_init2(mass, BITS);
	for (int i = 0; i < s->n; i++)
		row_start(f[i], MOST);
	fill_forces(m, f);
	hold(m, f);
	for (int i = 0; i < MOST; i++)
		zero(m->A[i], MOST);
	for (int i = 0; i < s->n; i++) {
		mpfr_set_ui(m->A[i][s->n + i], 1, MPFR_RNDN);
		thousandths(mass, s->mass[i]);
		for (int j = 0; j < MOST; j++)
			mpfr_div(m->A[s->n + i][j], f[i][j], mass, MPFR_RNDN);
		row_stop(f[i], MOST);
	}
	add(m->A[m->one + 1], m->one + 2, -s->frequency);
	add(m->A[m->one + 2], m->one + 1, s->frequency);
	mpfr_set_ui(m->A[m->one + 3][m->one], 1, MPFR_RNDN);
	mpfr_clear(mass);
}

/* ---- quantities of contacts, as rows over x ---- */

/* p - gap, or its derivative; of friction v - belt with derivative 1 */
static void measure(const struct moving *m, int index, int derivative, mpfr_t *r)
{
	const struct contact *c = &m->s->contact[index];
	zero(r, MOST);
	for (int i = 0; i < m->s->n; i++)
		mpfr_set_si(r[i + derivative * m->s->n], share(c, i), MPFR_RNDN);
	if (c->kind == FRICTION)
		add_law(m, r, &c->belt, -1000);
	else if (derivative == 0)
		add_law(m, r, &c->gap, -1000);
	else
		add(r, m->one, -c->gap.slope[m->segment]);
}

static void measure_now(struct moving *m, int index, int derivative, mpfr_ptr value)
{
	row r;
	row_start(r, MOST);
	measure(m, index, derivative, r);
	dot(m->size, r, m->x, value);
	row_stop(r, MOST);
}

/* The sign of what rises when the contact's mode ends: row number `which`; false: there is none of this number */
static bool guard(const struct moving *m, int index, int which, mpfr_t *r)
{
	const struct contact *c = &m->s->contact[index];
	enum mode mode = m->mode[index];
	if (which > (mode == STICKING))
		return false;
	if (mode == OPEN || mode == CLOSED)
		measure(m, index, 0, r);
	else if (mode == FORWARD || mode == BACKWARD)
		measure(m, index, 1, r);
	else
		for (int j = 0; j < MOST; j++)
			mpfr_set(r[j], m->force[index][j], MPFR_RNDN);
	bool turned = mode == CLOSED || mode == FORWARD || which == 1;
	for (int j = 0; j < MOST && turned; j++)
		mpfr_neg(r[j], r[j], MPFR_RNDN);
	if (mode == STICKING)
		add_limit(m, c, true, -1, r);
	return true;
}

/* ---- series ---- */

/* sum over from <= j <= to of a_j b_{k-j}; of columns of the series, or other numbers: `stride` apart */
static void convolve(mpfr_ptr sum, int k, int from, int to, mpfr_t *a, int a_stride, mpfr_t *b, int b_stride)
{
	static mpfr_t part;                     /* kept, as in dot() */
	static bool made;
	if (!made)
		mpfr_init2(part, BITS);
	made = true;
	mpfr_set_zero(sum, 1);
	for (int j = from; j <= to; j++) {
		mpfr_mul(part, a[j * a_stride], b[(k - j) * b_stride], MPFR_RNDN);
		mpfr_add(sum, sum, part, MPFR_RNDN);
	}
}

/* The k-th of q^2: each product of two coefficients once */
static void expand_square(mpfr_t *square, int k, mpfr_t *q)
{
	mpfr_t middle;
	convolve(square[k], k, 0, (k + 1) / 2 - 1, q, MOST, q, MOST);
	mpfr_mul_2ui(square[k], square[k], 1, MPFR_RNDN);
	if (k % 2 != 0)
		return;
	mpfr_init2(middle, BITS);
	mpfr_sqr(middle, q[k / 2 * MOST], MPFR_RNDN);
	mpfr_add(square[k], square[k], middle, MPFR_RNDN);
	mpfr_clear(middle);
}

/* The k-th of what is left of mass i, where it is there, from those of q and v up to there */
static void expand_powers(struct moving *m, int i, int k)
{
	const struct scene *s = m->s;
	mpfr_t *q = &m->series[0][i], *v = q + s->n, *cube = &m->series[0][m->left + i], *square = m->square[i];
	if (s->cubic[i] != 0 || s->excited[i] != 0)
		expand_square(square, k, q);
	if (s->cubic[i] != 0)
		convolve(cube[k * MOST], k, 0, k, square, 1, q, MOST);
	if (s->excited[i] != 0)
		convolve(cube[s->n + k * MOST], k, 0, k, square, 1, v, MOST);
}

static void expand_sine(struct moving *m, int i, int k)
{
	mpfr_t *q = &m->series[0][i], *sine = &m->series[0][m->left + 2 * m->s->n + i];
	mpfr_t *cosine = m->cosine[i], *rate = m->rate[i];
	if (k == 0) {
		mpfr_sin_cos(sine[0], cosine[0], q[0], MPFR_RNDN);
		return;
	}
	mpfr_mul_si(rate[k], q[k * MOST], k, MPFR_RNDN);
	convolve(sine[k * MOST], k, 1, k, rate, 1, cosine, 1);
	mpfr_div_si(sine[k * MOST], sine[k * MOST], k, MPFR_RNDN);
	convolve(cosine[k], k, 1, k, rate, 1, sine, MOST);
	mpfr_div_si(cosine[k], cosine[k], -k, MPFR_RNDN);
}

static void expand_left(struct moving *m, int k)
{
	for (int i = 0; i < m->s->n && m->s->left; i++) {
		expand_powers(m, i, k);
		if (m->s->swing[i] != 0)
			expand_sine(m, i, k);
	}
}

static void expand(struct moving *m, int degree)
{
	for (int i = 0; i < m->size; i++)
		mpfr_set(m->series[0][i], m->x[i], MPFR_RNDN);
	expand_left(m, 0);
	for (int i = m->left; i < m->size; i++)
		mpfr_set(m->x[i], m->series[0][i], MPFR_RNDN);
	for (int k = 1; k <= degree; k++) {
		for (int i = 0; i < m->left; i++) {
			dot(m->size, (mpfr_t *)m->A[i], m->series[k - 1], m->series[k][i]);
			mpfr_div_ui(m->series[k][i], m->series[k][i], (unsigned long)k, MPFR_RNDN);
		}
		expand_left(m, k);
	}
}

/* The sign of the first coefficient of r x that is not 0, from number `from` on */
static int first_sign(struct moving *m, mpfr_t *r, int from)
{
	enum { FURTHEST = 5 };
	mpfr_t value;
	int sign = 0;
	mpfr_init2(value, BITS);
	expand(m, FURTHEST);
	for (int k = from; k <= FURTHEST && sign == 0; k++) {
		dot(m->size, r, m->series[k], value);
		if (mpfr_cmpabs(value, m->tiny) > 0)
			sign = mpfr_sgn(value);
	}
	mpfr_clear(value);
	return sign;
}

/* F below 0 counts as 0, which no scene here goes into. */
static void check_limits(struct moving *m)
{
	mpfr_t force;
	row r;
	mpfr_init2(force, BITS);
	row_start(r, MOST);
	for (int i = 0; i < m->s->contacts; i++) {
		const struct contact *c = &m->s->contact[i];
		if (c->kind != FRICTION || (c->force.at[m->segment] == 0 && c->force.slope[m->segment] == 0 &&
				c->swing == 0 && c->pad == 0))
			continue;
		zero(r, MOST);
		add_limit(m, c, false, 1, r);
		dot(MOST, r, m->x, force);
		if (mpfr_get_d(force, MPFR_RNDN) < 1e-4)
			doubt(m, "a force of friction below 0");
	}
	row_stop(r, MOST);
	mpfr_clear(force);
}

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
