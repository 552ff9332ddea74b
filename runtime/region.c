/* SPDX-License-Identifier: MIT-0 */
/* Tables of a region of a piecewise-linear model from other params: e^{A d} of a piece of its step, and how fast rows
 * over x may change within one. */
#include "two.h"

/* ---- pieces ---- */

/* Above the size of every pole of A h: of a matrix B of sizes, max (B v)_i / v_i for any v above 0 is such a bound, and
 * a few products bring v near to that which makes it least.  v, next: work, n each */
static real largest_turn(int n, const pl_two *A, real h, real *v, real *next)
{
	enum { PRODUCTS = 40 };
	const real shift = 1 / (real)16, least = REAL_EPSILON * REAL_EPSILON;
	real most = 0;
	int i, j, k;
	for (i = 0; i < n; i++) {
		v[i] = 1;
	}
	for (k = 0; k < PRODUCTS; k++) {
		real largest = 0;
		most = 0;
		for (i = 0; i < n; i++) {
			real sum = shift * v[i];
			for (j = 0; j < n; j++) {
				sum += pl_magnitude(A[i * n + j].hi * h) * v[j];
			}
			next[i] = sum;
			if (!is_finite(sum)) {
				return sum - sum;
			}
			if (sum > largest) {
				largest = sum;
			}
			if (sum / v[i] > most) {
				most = sum / v[i];
			}
		}
		for (i = 0; i < n; i++) {
			v[i] = next[i] > least * largest ? next[i] / largest : least;
		}
	}
	return most - shift;
}

/* Phi = I + D, rounded once */
static void from_increment(int n, const pl_two *D, real *Phi)
{
	int i;
	for (i = 0; i < n * n; i++) {
		Phi[i] = i % (n + 1) == 0 ? (1 + D[i].hi) + D[i].lo : D[i].hi;
	}
}

/* A rung: D itself in the rows of what keeps more than half of itself, and behind them which these are */
static void rung_of_increment(int n, const pl_two *D, real *rows)
{
	int i;
	from_increment(n, D, rows);
	for (i = 0; i < n; i++) {
		const int stays = D[i * (n + 1)].hi > -1 / (real)2;
		rows[n * n + i] = (real)stays;
		if (stays) {
			rows[i * (n + 1)] = D[i * (n + 1)].hi;
		}
	}
}

/* So many halvings of h that no pole turns by more than 1, and between the rungs of a ladder that has room for some */
int pl_region_halvings(int size, const pl_two *A, real h, int most, int rungs, int *halvings, int *spacing, real *v,
					   real *next)
{
	real turn = largest_turn(size, A, h, v, next);
	if (!is_finite(turn)) {
		return PL_NOT_FINITE;
	}
	for (*halvings = 0; turn > 1 && *halvings <= most; turn /= 2) {
		++*halvings;
	}
	*spacing = *halvings > rungs ? (*halvings + rungs - 1) / rungs : 1;
	return *halvings > most ? PL_OUT_OF_RANGE : 0;
}

int pl_region_of(int size, const pl_two *A, real h, int most, int rungs, int *halvings, int *spacing, real *slopes,
				 real *Phi, real *ladder, pl_two *work)
{
	const int cells = size * size;
	pl_two *const D = work + PL_INCREMENT_WORK(size);
	int i, down, status = pl_region_halvings(size, A, h, most, rungs, halvings, spacing, slopes, Phi);
	if (status == 0) {
		status = pl_increment(size, size, A, h, 1, D, work);
	}
	if (status != 0) {
		return status;
	}
	from_increment(size, D, Phi);
	for (i = 0; i < cells; i++) {
		slopes[i] = A[i].hi;
	}
	for (down = *halvings; down > 0 && status == 0; down -= *spacing, ladder += cells + size) {
		status = pl_increment(size, size, A, h / (real)((uint32_t)1 << down), 1, D, work);
		rung_of_increment(size, D, ladder);
	}
	return status;
}

real pl_region_large(int size, int halvings, const real *Phi, real most)
{
	real largest = 1;
	int i;
	for (i = 0; i < size * size; i++) {
		largest = pl_magnitude(Phi[i]) > largest ? pl_magnitude(Phi[i]) : largest;
	}
	return halvings > 1 ? 0 : most / largest;
}

/* ---- bounds ---- */

/* E <- e^{A tau} - I, or e^{|A| tau} - I, whose poles times tau are below 1/4.  work: 2 n n */
static void exponential(int n, const real *A, real tau, int sizes, real *E, real *work)
{
	enum { TERMS = 14 };
	real *term = work, *next = work + n * n, *swap;
	int i, j, k, m;
	for (i = 0; i < n * n; i++) {
		term[i] = (real)(i % (n + 1) == 0);
		E[i] = 0;
	}
	for (k = 1; k < TERMS + n; k++) {
		for (i = 0; i < n * n; i++) {
			next[i] = 0;
		}
		for (m = 0; m < n; m++) {
			for (j = 0; j < n; j++) {
				const real a = sizes ? pl_magnitude(A[m * n + j]) : A[m * n + j];
				for (i = 0; i < n && (a < 0 || a > 0); i++) { /* few are not 0 */
					next[i * n + j] += term[i * n + m] * a;
				}
			}
		}
		for (i = 0; i < n * n; i++) {
			next[i] = next[i] * tau / (real)k;
		}
		swap = term;
		term = next;
		next = swap;
		for (i = 0; i < n * n; i++) {
			E[i] += term[i];
		}
	}
}

static void add_one(int n, real *E)
{
	int i;
	for (i = 0; i < n; i++) {
		E[i * (n + 1)] += 1;
	}
}

/* row <- row B, B A or its sizes.  work: n */
static void times(int n, real *row, const real *A, int sizes, real *work)
{
	int i, j;
	for (j = 0; j < n; j++) {
		work[j] = 0;
		for (i = 0; i < n; i++) {
			work[j] += row[i] * (sizes ? pl_magnitude(A[i * n + j]) : A[i * n + j]);
		}
	}
	for (j = 0; j < n; j++) {
		row[j] = work[j];
	}
}

/* A piece is looked at in so many parts: within one a derivative grows by e^{|A| d / PARTS} at most. */
enum { PARTS = 8 };

/* bound . |x(0)| is above factor |row e^{A tau} x(0)| for all tau of a piece.  lost: what rounding did to row, at most;
 * both are used up.  E, most: over a part.  work: n */
static void bound_row(int n, const real *E, const real *most, real *row, real *lost, real factor, real *bound,
					  real *work)
{
	int i, j, part;
	for (j = 0; j < n; j++) {
		bound[j] = 0;
	}
	for (part = 0; part < PARTS; part++) {
		for (j = 0; j < n; j++) {
			real sum = 0;
			for (i = 0; i < n; i++) {
				sum += (pl_magnitude(row[i]) + lost[i]) * most[i * n + j];
			}
			sum *= factor * (1 + 64 * (real)n * REAL_EPSILON);
			if (!(sum <= bound[j])) {
				bound[j] = sum;
			}
		}
		times(n, row, E, 0, work);
		times(n, lost, most, 0, work);
	}
}

void pl_region_bounds(int size, real d, const real *A, int rows, const real *row, real *slope, real *second,
					  real *fourth, real *work)
{
	const int n = size;
	real *E = work, *most = E + n * n, *gone = most + n * n, *sizes = gone + n, *at = sizes + n, *lost = at + n;
	real *more = lost + n;
	int i, j, order;
	exponential(n, A, d / (real)PARTS, 0, E, gone);
	exponential(n, A, d / (real)PARTS, 1, most, gone);
	add_one(n, E);
	add_one(n, most);
	for (i = 0; i < rows; i++, row += n, slope += n) {
		for (j = 0; j < n; j++) {
			gone[j] = row[j];
			sizes[j] = pl_magnitude(row[j]);
		}
		for (order = 1; order <= 4; order++) {
			times(n, gone, A, 0, more);
			times(n, sizes, A, 1, more);
			for (j = 0; j < n && order == 1; j++) {
				slope[j] = d / 3 * gone[j];
			}
			if (order % 2) {
				continue;
			}
			for (j = 0; j < n; j++) {
				at[j] = gone[j];
				lost[j] = 8 * (real)(n + order) * REAL_EPSILON * sizes[j];
			}
			if (order == 2) {
				bound_row(n, E, most, at, lost, d * d / 8, second + i * n, more);
			} else {
				bound_row(n, E, most, at, lost, d * d * d * d / 384, fourth + i * n, more);
			}
		}
	}
}

/* ---- longer pieces ---- */

/* On their way over pieces that double: e^{A d} - I and a bound of |e^{A tau}| for 0 <= tau <= d */
typedef struct stride {
	int n;
	real *D, *most, *room;
} stride;

/* sum_k |(I + D)_ik| most_kj, or the factors the other way */
static real grown(const stride *s, int swapped, int i, int j)
{
	real sum = 0;
	int k;
	for (k = 0; k < s->n; k++) {
		const int left = i * s->n + k, right = k * s->n + j, at = swapped ? right : left;
		sum += pl_magnitude(s->D[at] + (real)(at % (s->n + 1) == 0)) * s->most[swapped ? left : right];
	}
	return sum;
}

/* Twice as long: I + D by its square, which loses nothing of what is small, and its bound over both halves */
static void double_stride(stride *s)
{
	const int n = s->n;
	int i, j, k;
	real *swap;
	for (i = 0; i < n; i++) {
		for (j = 0; j < n; j++) {
			const real one = grown(s, 0, i, j), other = grown(s, 1, i, j), least = one < other
					? one : other;
			s->room[i * n + j] = least > s->most[i * n + j] ? least : s->most[i * n + j];
		}
	}
	swap = s->most;
	s->most = s->room;
	s->room = swap;
	for (i = 0; i < n; i++) {
		for (j = 0; j < n; j++) {
			real sum = 2 * s->D[i * n + j];
			for (k = 0; k < n; k++) {
				sum += s->D[i * n + k] * s->D[k * n + j];
			}
			s->room[i * n + j] = sum;
		}
	}
	swap = s->D;
	s->D = s->room;
	s->room = swap;
}

/* Of a row e^{A tau}: where it is, its largest sizes so far, and the integrals of tau times them */
typedef struct reached {
	real *row, *most, *moment;
} reached;

/* PARTS strides on from tau = from.  work: n */
static void reach_on(const stride *s, real from, real d, const reached *r, real *work)
{
	const int n = s->n;
	int i, j, part;
	for (part = 1; part <= PARTS; part++) {
		for (j = 0; j < n; j++) {
			real sum = 0, change = 0;
			for (i = 0; i < n; i++) {
				sum += pl_magnitude(r->row[i]) * s->most[i * n + j];
				change += r->row[i] * s->D[i * n + j];
			}
			if (!(sum <= r->most[j])) {
				r->most[j] = sum;
			}
			r->moment[j] += d * (from + (real)part * d) * sum;
			work[j] = r->row[j] + change;
		}
		for (j = 0; j < n; j++) {
			r->row[j] = work[j];
		}
	}
}

/* The chord over 0 .. length is off by the integral of G(tau) |e''(tau)|, where G <= tau (1 - tau / length) <= tau, and
 * by length^2/8 max|e''|. */
static void write_reach(int n, real length, const reached *r, real *reach)
{
	int j;
	for (j = 0; j < n; j++) {
		const real even = length * length / 8 * r->most[j];
		reach[j] = (even < r->moment[j] ? even : r->moment[j]) * (1 + 1 / (real)1024);
	}
}

void pl_region_reach(int size, real h, int halvings, int spacing, const real *A, int rows, const real *row,
					 real *reach, real *work)
{
	const int n = size, cells = n * n, rungs = halvings > 0 ? (halvings - 1) / spacing + 1 : 0;
	real *const state = work + 3 * cells, *const room = state + 3 * n * rows;
	real d = h / (real)((uint32_t)1 << halvings) / (real)PARTS;
	stride s;
	int i, j, k;
	s.n = n;
	s.D = work;
	s.most = work + cells;
	s.room = work + 2 * cells;
	exponential(n, A, d, 0, s.D, room);
	exponential(n, A, d, 1, s.most, room);
	add_one(n, s.most);
	for (k = 0; k <= halvings; k++) {
		for (i = 0; i < rows; i++) {
			reached r;
			r.row = state + 3 * n * i;
			r.most = r.row + n;
			r.moment = r.most + n;
			for (j = 0; j < n && k == 0; j++) {
				r.row[j] = row[i * n + j];
				r.most[j] = r.moment[j] = 0;
			}
			reach_on(&s, k > 0 ? d * (real)PARTS : 0, d, &r, room);
			if (k > 0 && (k % spacing == 0 || k == halvings)) {
				write_reach(n, 2 * PARTS * d, &r, reach + (i * rungs + (k - 1) / spacing) * n);
			}
		}
		if (k > 0) {
			double_stride(&s);
			d *= 2;
		}
	}
}

/* ---- regions that are made when they are met ---- */

static void add_entries(const pl_cached *m, const pl_entries *e, pl_two *A)
{
	int i;
	for (i = 0; i < e->places; i++) {
		const pl_place *const p = e->place + i;
		pl_two *const to = A + p->row * m->size + p->column, more = m->constant[p->number];
		*to = p->negative ? add(*to, two(-more.hi, -more.lo)) : add(*to, more);
	}
}

/* A of a region: in the order of switching functions, so that it is the same whichever was before */
static void sum_region(const pl_cached *m, int region, pl_two *A)
{
	const int cells = m->size * m->size;
	const pl_entries *sum = m->sum;
	int segment = region / m->regions, rest = region % m->regions, intervals = 1, i;
	for (i = 0; i < cells; i++) {
		A[i] = two(0, 0);
	}
	for (i = 0; i < m->switches; i++) {
		intervals += m->breaks[i];
	}
	sum += (ptrdiff_t)segment * intervals;
	add_entries(m, sum++, A);
	for (i = 0; i < m->switches; sum += m->breaks[i++]) {
		const int interval = rest % (m->breaks[i] + 1);
		rest /= m->breaks[i] + 1;
		if (interval > 0) {
			add_entries(m, sum + interval - 1, A);
		}
	}
}

/* ---- their guards, and what they hold ---- */

/* Of a switching function in an interval: the guards of a region beside the lowest that are its */
static int take_guards(const pl_cached *m, int from, int function, int first, int count)
{
	const pl_cached_guards *const g = m->guards;
	const int n = m->size;
	int i, j;
	for (i = g->first[from]; i < g->first[from + 1]; i++) {
		const int to = first + count, row = g->guard[i].row;
		if (g->guard[i].expression != function) {
			continue;
		}
		g->own_guard[to] = g->guard[i];
		g->own_guard[to].row = to;
		g->own_limit[to] = g->limit[i];
		g->own_amplitude[to] = g->amplitude[row];
		for (j = 0; j < n; j++) {
			g->own_row[(ptrdiff_t)to * n + j] = g->row[(ptrdiff_t)row * n + j];
		}
		count++;
	}
	return count;
}

/* Likewise its assignments; how many there are then */
static int take_holds(const pl_cached *m, int from, int function, int first, int count)
{
	const pl_cached_guards *const g = m->guards;
	const int n = m->size, set = g->hold[from];
	int i, j;
	for (i = set < 0 ? 0 : g->set[set]; set >= 0 && i < g->set[set + 1]; i++) {
		if (g->owner[i] != function) {
			continue;
		}
		g->own_state[first + count] = g->state[i];
		for (j = 0; j < n; j++) {
			g->own_value[(ptrdiff_t)(first + count) * n + j] = g->value[(ptrdiff_t)i * n + j];
		}
		count++;
	}
	return count;
}

/* pl_region_reach has the rows of one guard behind those of another; each gets the room that it has. */
static void reach_guards(const pl_cached *m, int slot, int first, int count)
{
	const pl_cached_guards *const g = m->guards;
	const int n = m->size, rungs = (m->halvings[slot] - 1) / m->spacing[slot] + 1;
	real *const reach = g->reach + (ptrdiff_t)first * m->rungs * n;
	int i, j;
	pl_region_reach(n, m->h, m->halvings[slot], m->spacing[slot], m->A + (ptrdiff_t)slot * n * n, count,
					g->own_row + (ptrdiff_t)first * n, reach, (real *)(void *)m->work);
	for (i = count - 1; i > 0; i--) {
		for (j = rungs * n - 1; j >= 0; j--) {
			reach[(ptrdiff_t)i * m->rungs * n + j] = reach[(ptrdiff_t)i * rungs * n + j];
		}
	}
}

static void make_guards(const pl_cached *m, int region, int slot)
{
	const pl_cached_guards *const g = m->guards;
	const int n = m->size, first = slot * g->most, held = slot * g->holds;
	const ptrdiff_t rows = (ptrdiff_t)first * n;
	int rest = region % m->regions, segment = region / m->regions, beside = 1, lowest, count = 0, holds = 0, i;
	for (i = 0; i < m->switches; i++) {
		beside += m->breaks[i];
	}
	lowest = segment * beside;
	for (i = 0, beside = lowest; i < m->switches; beside += m->breaks[i++]) {
		const int interval = rest % (m->breaks[i] + 1), from = interval > 0 ? beside + interval : lowest;
		rest /= m->breaks[i] + 1;
		count = take_guards(m, from, i, first, count);
		holds = take_holds(m, from, i, held, holds);
	}
	g->count[slot] = count;
	g->own_set[2 * slot] = held;
	g->own_set[2 * slot + 1] = held + holds;
	pl_region_bounds(n, m->h / (real)((uint32_t)1 << m->halvings[slot]), m->A + (ptrdiff_t)slot * n * n, count,
					 g->own_row + rows, g->tangent + rows, g->chord_error + rows, g->cubic_error
							+ rows,
					 (real *)(void *)m->work);
	if (m->halvings[slot] > 0) {
		reach_guards(m, slot, first, count);
	}
}

static void make_region(const pl_cached *m, int region, int slot)
{
	const int n = m->size;
	const ptrdiff_t cells = (ptrdiff_t)slot * n * n, rows = (ptrdiff_t)slot * m->switches * n;
	real *const A = m->A + cells, *const work = (real *)(void *)m->work;
	const real *const row = m->row + (ptrdiff_t)(region / m->regions) * m->switches * n;
	real none = 0;
	int i, status;
	sum_region(m, region, m->work);
	status = pl_region_of(n, m->work, m->h, m->most, m->rungs, &m->halvings[slot], &m->spacing[slot], A, m->Phi
			+ cells,
					  m->pieces + (ptrdiff_t)slot * m->rungs * (n + 1) * n, m->work + n * n);
	if (status != 0) {
		m->halvings[slot] = 0;
		for (i = 0; i < n * n; i++) {
			A[i] = m->Phi[cells + i] = none / none;
		}
	}
	if (m->guards != NULL) { /* of switching functions slopes alone are read */
		real *const spare = work + PL_BOUNDS_WORK(n), d = m->h / (real)((uint32_t)1 << m->halvings[slot]);
		pl_region_bounds(n, d, A, m->switches, row, m->tangent + rows, spare, spare + m->switches * n, work);
		make_guards(m, region, slot);
		return;
	}
	pl_region_bounds(n, m->h / (real)((uint32_t)1 << m->halvings[slot]), A, m->switches, row, m->tangent + rows,
					 m->chord_error + rows, m->cubic_error + rows, work);
	pl_region_reach(n, m->h, m->halvings[slot], m->spacing[slot], A, m->switches, row,
					m->reach + rows * m->rungs, work);
}

int pl_cached_matrix(pl_cached *m, int region)
{
	int i, oldest = m->pinned == 0;
	region += m->first;
	for (i = 0; i < m->slots && m->slot[i].region != region; i++) {
		oldest = m->slot[i].used < m->slot[oldest].used && i != m->pinned ? i : oldest;
	}
	if (i == m->slots) {
		i = oldest;
		make_region(m, region, i);
		m->slot[i].region = region;
	}
	m->slot[i].used = ++*m->clock;
	return i;
}
