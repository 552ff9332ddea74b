/* SPDX-License-Identifier: MIT-0 */
/* regions.h: regions as intervals of switching functions between breakpoints, and a state in one of them, for the
 * runtime's own use: part of crossings.c and guards.c, which say first what `searched` is, their tables, and
 * AMPLITUDE(m, i), the size of what is never above 1 in switching function i.  With derivatives beside x, VARIED has
 * what is done to them: it is empty without.  It has no guard, for it is a part of
 * these. */
#include "compensated.h"

#ifdef WITH_DERIVATIVES
#define VARIED(hook) hook
#define AND_VARIATION , pl_variation *variation
#define SET_VARIATION(at) (at).v = variation
#else
#define VARIED(hook)
#define AND_VARIATION
#define SET_VARIATION(at) ((void)0)
#endif

typedef struct instant {
	real *x;
	pl_contact *c;
	pl_crossing *crossing; /* NULL: nothing is listed */
	real *work;            /* size, or as much as assignments of one set */
	/* Of contacts: */
	real time;             /* after the start of the step [s] */
	int before;            /* the region before what happens now */
	int only;              /* the one switching function that is looked at; -1: all */
	pl_chain chain;
	VARIED(pl_variation *v;) /* NULL: no derivatives are asked for */
} instant;

static const real *matrix_of(const real *all, const searched *m, int matrix)
{
	return all + WORDS * (ptrdiff_t)matrix * m->size * m->size;
}

static const real *matrix_now(const searched *m, const instant *at)
{
	return matrix_of(m->A, m, at->c->matrix);
}

#ifdef WITH_DERIVATIVES

/* Columns S = x_p beside x, in crossings_d.c and guards_d.c.
 * In a region S' = A S + A_p x, by the same Taylor polynomials as x.  At an event (saltation.h) the jump is linear,
 * x_i = value . x: S_i becomes value . S + value_p . x, and of one more column, which is f- before, R_x f-.  An event
 * ends with the first piece behind it, or with the step: only then is the field f+ known.  crossings.c and impacts.h
 * have beside it
 *
 *     vary_held(m, at)           S of what is held in a region
 *     projects(m, at)            what friction that comes to stick makes of S; 0: it does not */
static void vary_held(const searched *m, instant *at);
static int projects(const searched *m, instant *at);

/* A_p x and the like: blocks of entries, of each column those of A of each matrix, and behind them these */
enum { OF_FUNCTIONS, OF_BREAKS, OF_GUARDS, OF_ASSIGNMENTS, OF_CHANGES, OF_ALL };

static real *column_of_time(const searched *m, const pl_variation *v)
{
	return v->S + (ptrdiff_t)v->columns * m->size;
}

/* row_p . x of a row of a block; column `size` is what is compared with that, and taken from it */
static real varied_row(const pl_variation *v, int column, int block, int row, int n, const real *x)
{
	const int *first = v->first + column * (v->matrices + OF_ALL) + block;
	real sum = 0;
	int k;
	for (k = first[0]; k < first[1]; k++) {
		if (v->entry[k].row == row) {
			sum += v->entry[k].value * (v->entry[k].column < n ? x[v->entry[k].column] : -1);
		}
	}
	return sum;
}

/* The same of a switching function less one of its breakpoints */
static real off_breakpoint(const searched *m, const pl_variation *v, int column, int function, int breakpoint,
						   const real *x)
{
	int i, place = breakpoint;
	for (i = 0; i < function; i++) {
		place += m->breaks[i];
	}
	return varied_row(v, column, v->matrices + OF_FUNCTIONS, v->segment * m->switches + function, m->size, x) +
		   varied_row(v, column, v->matrices + OF_BREAKS, place, m->size, x);
}

/* ---- events ---- */

/* f- stands in the column of time. */
static void leave_field(const searched *m, instant *at)
{
	pl_variation *v = at->v;
	const real *A = matrix_now(m, at);
	int i;
	pl_multiply(m->size, m->size, A, at->x, column_of_time(m, v));
	for (i = 0; i < m->size; i++) {
		v->noise[i] = sizes(m->size, A + (ptrdiff_t)i * m->size, at->x);
	}
	v->pending = 1;
}

/* row . x comes to its limit: dg has the derivatives of what is left to it. */
static void meet(const searched *m, instant *at, const real *row, int function)
{
	pl_variation *v = at->v;
	const int n = m->size;
	int p, i;
	v->rate = dot(n, row, column_of_time(m, v));
	v->time = at->time;
	v->function = function;
	v->before = at->c->region;
	v->size = 0;
	for (i = 0; i < n; i++) {
		v->size += magnitude(row[i]) * v->scale[i];
	}
	pl_multiply(n, n, matrix_now(m, at), column_of_time(m, v), v->work);
	v->bend = dot(n, row, v->work);
	for (p = 0; p < v->columns; p++) {
		v->dg[p] += dot(n, row, v->S + (ptrdiff_t)p * n);
		v->when[p] = v->rate > 0 || v->rate < 0 ? pl_saltation_time(v->dg[p], v->rate) : 0;
	}
}

/* q = R_x f- + R_t - f+; what rounding may have made of it is 0.  Whether there is any */
static int field_jumps(const searched *m, const instant *at)
{
	const pl_variation *v = at->v;
	const real *A = matrix_now(m, at);
	real *q = column_of_time(m, v);
	int i, any = 0;
	for (i = 0; i < m->size; i++) {
		const real *row = A + (ptrdiff_t)i * m->size, behind = dot(m->size, row, at->x);
		const real noise = noise_of(v->noise[i] + sizes(m->size, row, at->x));
		q[i] -= behind;
		if (magnitude(q[i]) <= noise) {
			q[i] = 0;
		}
		any = any || magnitude(q[i]) > 0;
	}
	return any;
}

/* Events at one instant, or where a step, a segment of time or a sample ends: the derivative is that of one side. */
static void look_at_order(const searched *m, pl_variation *v, int jumps)
{
	const real none = 64 * REAL_EPSILON * m->h;
	const int together = v->last >= 0 && v->last != v->function && v->time - v->last_time <= none;
	if (v->function >= 0 && jumps && (v->time <= none || v->time >= m->h - none)) {
		pl_doubt_add(&v->doubt, PL_D_ONE_SIDED, v->function, v->time);
	}
	if (together && v->function >= 0 && (jumps || v->jumped)) {
		pl_doubt_add(&v->doubt, PL_D_ONE_SIDED, v->function, v->time);
	}
	v->last = v->function;
	v->last_time = v->time;
	v->jumped = jumps;
}

/* Behind an event, in the region where x goes on: S from that at the event's time to that at fixed time */
static void end_event(const searched *m, instant *at)
{
	pl_variation *v = at->v;
	int p, done, jumps = 0;
	if (v == NULL || !v->pending) {
		return;
	}
	done = v->sticks && projects(m, at);
	if (!done && field_jumps(m, at)) {
		jumps = 1;
		for (p = 0; p < v->columns; p++) {
			pl_saltation_pass(m->size, column_of_time(m, v), v->when[p], v->S + (ptrdiff_t)p * m->size);
		}
		if (v->function >= 0 && (!(v->rate > 0 || v->rate < 0)
				|| pl_saltation_grazes(v->size, v->rate, v->bend))) {
			pl_doubt_add(&v->doubt, PL_D_GRAZING, v->function, v->time);
		}
	}
	look_at_order(m, v, done || jumps);
	v->pending = v->sticks = 0;
	v->function = -1;
	vary_held(m, at);
}

/* ---- between events ---- */

/* x where the last piece has ended, of vary_piece */
static real *end_of_piece(const searched *m, const pl_variation *v)
{
	return v->work + (v->degree + 3) * m->size;
}

/* Entries of A that are not 0, row by row, and one behind them */
static void list_acting(const searched *m, const instant *at)
{
	const real *A = matrix_now(m, at);
	pl_varied *to = at->v->acting;
	int i, j;
	for (i = 0; i < m->size; i++) {
		for (j = 0; j < m->size; j++, A++) {
			if (*A < 0 || *A > 0) {
				to->row = (unsigned short)i;
				to->column = (unsigned short)j;
				to->value = *A;
				to++;
			}
		}
	}
	to->row = (unsigned short)m->size;
}

/* The next term of a Taylor polynomial, part (A term + next), which is added to `sum`.  Whether it is but rounding, as
 * then are those that follow: each is at most what rounding of all entries would become. */
static inline int add_term(int n, const pl_varied *acting, real part, const real *term, real *next, real *sum)
{
	int i;
	for (i = 0; i < n; i++) {
		real turned = next[i];
		for (; acting->row == i; acting++) {
			turned += acting->value * term[acting->column];
		}
		turned *= part;
		next[i] = turned;
		sum[i] += turned;
	}
	for (i = 0; i < n && magnitude(next[i]) <= REAL_EPSILON / 8 * magnitude(sum[i]); i++) {
	}
	return i == n;
}

/* z, where x begins, and S by tau, by their Taylor polynomials */
static void vary_part(const searched *m, const instant *at, real tau, real *z)
{
	const pl_variation *v = at->v;
	const int n = m->size, *first = v->first + at->c->matrix;
	real *const series = v->work + 2 * n;
	int p, k, i, orders = 0, is_small = 0;
	for (i = 0; i < n; i++) {
		series[i] = z[i];
	}
	for (; orders < v->degree && !is_small; orders++) {
		real *const next = series + (orders + 1) * n;
		for (i = 0; i < n; i++) {
			next[i] = 0;
		}
		is_small = add_term(n, v->acting, tau / (real)(orders + 1), next - n, next, z);
	}
	for (p = 0; p < v->columns; p++, first += v->matrices + OF_ALL) {
		real *const S = v->S + (ptrdiff_t)p * n, *term = v->work, *next = term + n;
		const int varies = first[0] < first[1] ? orders : 0;
		for (i = 0; i < n; i++) {
			term[i] = S[i];
		}
		is_small = 0;
		for (k = 0; k < v->degree && !(is_small && k > varies); k++) {
			real *const last = term;
			for (i = 0; i < n; i++) {
				next[i] = 0;
			}
			for (i = first[0]; i < first[1] && k <= orders; i++) {
				next[v->entry[i].row] += v->entry[i].value * series[k * n + v->entry[i].column];
			}
			is_small = add_term(n, v->acting, tau / (real)(k + 1), term, next, S);
			term = next;
			next = last;
		}
	}
}

/* S over an event-free step, x beginning at at->x.  0: its tables are not there */
static int vary_step(const searched *m, const instant *at)
{
	const pl_variation *v = at->v;
	const int n = m->size;
	const real *Phi = matrix_of(m->Phi, m, at->c->matrix), *over = v->over;
	int p, i;
	for (p = 0; p < v->columns && over != NULL; p++) {
		real *S = v->S + (ptrdiff_t)p * n;
		pl_multiply(n, n, Phi, S, v->work);
		if (WORDS > 1) { /* of e^{A h} - I; second words are not small in columns of loads */
			pl_multiply_add(n, n, Phi + (ptrdiff_t)n * n, S, v->work);
		}
		pl_multiply_add(n, n, over + ((ptrdiff_t)p * v->matrices + at->c->matrix) * n * n, at->x, v->work);
		for (i = 0; i < n; i++) {
			S[i] = WORDS > 1 ? S[i] + v->work[i] : v->work[i];
		}
	}
	return over != NULL;
}

/* S over a piece of this length from x on, before x is moved */
static void vary_piece(const searched *m, instant *at, real length)
{
	pl_variation *v = at->v;
	const int n = m->size;
	real *z, shortest;
	int part, parts = 1, i;
	if (v == NULL) {
		return;
	}
	end_event(m, at);
	z = end_of_piece(m, v);
	shortest = m->h / (real)((uint32_t)1 << m->halvings[at->c->matrix]);
	while ((real)parts * shortest < length * (1 - REST)) {
		parts *= 2;
	}
	for (i = 0; i < n; i++) {
		z[i] = at->x[i];
		v->scale[i] = larger(v->scale[i], magnitude(z[i]));
	}
	if (length >= m->h && vary_step(m, at)) {
		return;
	}
	list_acting(m, at);
	for (part = 0; part < parts && length > 0; part++) {
		vary_part(m, at, length / (real)parts, z);
	}
}

#endif

/* One switch after the other, and where a region has it:
 *     for (w = first_switch(at); arrive(switches, breaks, region, &w); leave(&w)) */
typedef struct walk {
	int i, breaks, interval;
	int stride;     /* between the numbers of regions one interval of this switch apart */
	const real *at; /* its breakpoints */
} walk;

static walk first_switch(const real *at)
{
	walk w;
	w.i = w.breaks = w.interval = 0;
	w.stride = 1;
	w.at = at;
	return w;
}

static int arrive(int switches, const int *breaks, int region, walk *w)
{
	if (w->i == switches) {
		return 0;
	}
	w->breaks = breaks[w->i];
	w->interval = region / w->stride % (w->breaks + 1);
	return 1;
}

static void leave(walk *w)
{
	w->stride *= w->breaks + 1;
	w->at += w->breaks;
	w->i++;
}

/* The number of a region's matrix; -1: it cannot be */
static int matrix_in(const searched *m, int region)
{
	return m->cached != NULL ? m->cached->matrix(m->cached, region) : m->matrix[region];
}

/* Where it cannot be, the matrix before stays in use. */
static void enter(const searched *m, pl_contact *c, int region)
{
	const int matrix = matrix_in(m, region);
	c->region = region;
	if (matrix >= 0) {
		c->matrix = matrix;
	}
	if (m->cached != NULL) {
		m->cached->pinned = matrix;
	}
}

/* What was met since may have its slot. */
static void enter_again(const searched *m, pl_contact *c)
{
	if (m->cached != NULL) {
		enter(m, c, c->region);
	}
}

/* Lists a crossing, or says that there is no more room. */
static int list(int max_events, pl_contact *c, pl_crossing *crossing, real time, int expression, int breakpoint,
				int upward)
{
	if (c->crossings == max_events) {
		c->status |= PL_TOO_MANY_EVENTS;
		return 0;
	}
	crossing += c->crossings++;
	crossing->time = time;
	crossing->expression = expression;
	crossing->breakpoint = breakpoint;
	crossing->upward = upward;
	c->total++;
	return 1;
}

/* e - b of a switching function, and what rounding may have done to it.  A tangent is a third of a piece's e'. */
static real excess(const searched *m, const pl_contact *c, int expression, real b, const real *x, real *noise)
{
	const real *row = m->row + expression * m->size;
	const real *tangent = m->tangent + ((ptrdiff_t)c->matrix * m->switches + expression) * m->size;
	real e;
	e = dot(m->size, row, x);
	*noise =
		noise_of(sizes(m->size, row, x) + 3 * sizes(m->size, tangent, x) + magnitude(b)
				+ AMPLITUDE(m, expression));
	return e - b;
}

/* 1 or -1 where e is above or below its interval by more than rounding, else 0 */
static int outside(const searched *m, const pl_contact *c, const walk *w, const real *x)
{
	real noise;
	if (w->interval < w->breaks && excess(m, c, w->i, w->at[w->interval], x, &noise) > noise) {
		return 1;
	}
	if (w->interval > 0 && -excess(m, c, w->i, w->at[w->interval - 1], x, &noise) > noise) {
		return -1;
	}
	return 0;
}
