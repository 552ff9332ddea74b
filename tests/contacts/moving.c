/* SPDX-License-Identifier: GPL-3.0-or-later */
/* x = q, v, 1, cos w t, sin w t, t, and where forces are left q^3, q^2 v, sin q. In each segment of time and mode of
 * the contacts x' = A x for all but these, whose series follow from those of q and v; A and forces of contact as rows
 * over x. */
#include "moving.h"

void row_start(mpfr_t *r, int count)
{
	for (int i = 0; i < count; i++) {
		mpfr_init2(r[i], BITS);
		mpfr_set_zero(r[i], 1);
	}
}

void row_stop(mpfr_t *r, int count)
{
	for (int i = 0; i < count; i++)
		mpfr_clear(r[i]);
}

static void zero(mpfr_t *r, int count)
{
	for (int i = 0; i < count; i++)
		mpfr_set_zero(r[i], 1);
}

void thousandths(mpfr_ptr to, long value)
{
	mpfr_set_si(to, value, MPFR_RNDN);
	mpfr_div_ui(to, to, 1000, MPFR_RNDN);
}

void dot(int n, mpfr_t *a, mpfr_t *b, mpfr_ptr sum)
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

void doubt_view(struct truth *found, const char *why)
{
	if (!found->doubtful)
		found->doubt = why;
	found->doubtful = true;
}

void doubt(struct moving *m, const char *why)
{
	for (int k = 0; k < m->views; k++)
		doubt_view(m->view[k].found, why);
}

bool decides(const struct moving *m)
{
	bool any = false;
	for (int k = 0; k < m->views; k++)
		any = any || !m->view[k].found->doubtful;
	return any;
}

/* ---- laws ---- */

/* +1 at `on`, -1 at `against`, times the side */
int share(const struct contact *c, int mass)
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

void fill_equations(struct moving *m)
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
void measure(const struct moving *m, int index, int derivative, mpfr_t *r)
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

void measure_now(struct moving *m, int index, int derivative, mpfr_ptr value)
{
	row r;
	row_start(r, MOST);
	measure(m, index, derivative, r);
	dot(m->size, r, m->x, value);
	row_stop(r, MOST);
}

/* The sign of what rises when the contact's mode ends: row number `which`; false: there is none of this number */
bool guard(const struct moving *m, int index, int which, mpfr_t *r)
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

void expand(struct moving *m, int degree)
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
int first_sign(struct moving *m, mpfr_t *r, int from)
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
void check_limits(struct moving *m)
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
