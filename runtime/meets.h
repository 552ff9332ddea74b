/* SPDX-License-Identifier: MIT-0 */
/* meets.h: a step of a model with friction or impacts that meets one guard, or none that the chord of a guard has
 * hidden: part of unmet.h where PL_MEETS.  Its state there and behind are Taylor polynomials, of as many terms as add
 * to them.  What happens at the event is decided as in contacts.h: here where what else there is certainly has no part
 * in it, else by pl_guards_meet. */

/* Such steps are of up to MOST_SIZE entries and terms of MOST_TERMS - 1 orders, also where the runtime takes them.
 * Arrays that are added up have an even number of entries, as two go together. */
#ifndef PL_DOT
#define PL_ENTRIES PL_UNROLL
#define PL_PAIRED (PL_SIZE + PL_SIZE % 2)
#define PL_MOST_SIZE PL_PAIRED
#define PL_MOST_TERMS (PL_DEGREE + 1)
#define PL_DOT(row, x) PL(dot)(row, x)
#define PL_ACTS(i, j) PL(acts)(i, j)

/* Whether entry i, j of A is not 0 in any region; both are numbers where loops are unrolled */
static PL_INLINE int PL(acts)(int i, int j)
{
	int k, any = 0;
	PL_UNROLL
	for (k = 0; k < (int)(sizeof(PL(slopes)) / sizeof(PL(slopes)[0])); k++) {
		any |= PL(slopes)[k][i][j] < 0.0 || PL(slopes)[k][i][j] > 0.0;
	}
	return any;
}
#endif

/* What rounding may do to a sum, in parts of its terms, as the search has it */
#define PL_ROUNDED 1.7763568394002505e-15

/* sum |row_j x_j| by |x| */
static double PL(sizes_of)(const pl_guards *m, const double *row, const double *size)
{
	double s[4] = {-0.0, -0.0, -0.0, -0.0};
	int j;
	PL_ENTRIES
	for (j = 0; j < PL_SIZE; j++) {
		s[j % 4] += pl_magnitude(row[j]) * size[j];
	}
	(void)m; /* whose size may be a number */
	return (s[0] + s[2]) + (s[1] + s[3]);
}

/* A guard less its limit over a step: at both ends, how far it leaves its chord, what rounding may do to it */
typedef struct PL(course) {
	double from, to, off, noise;
} PL(course);

/* What rounding may do to row . x less b, as the search has it */
static double PL(noise_at)(const pl_guards *m, const double *row, const double *tangent, double b, double amplitude,
						   const double *size)
{
	return PL_ROUNDED *
		   (PL(sizes_of)(m, row, size) + 3.0 * PL(sizes_of)(m, tangent, size) + pl_magnitude(b) + amplitude);
}

/* Whether guard k keeps below its limit from x to end, h on or less, as unmet.h has it.  size: |x|.  g has what
 * follow_guard goes on from */
static int PL(keeps_off)(const pl_guards *m, int k, const double *x, const double *size, const double *end,
						 PL(course) *g)
{
	const int row = m->guard[k].row;
	g->from = PL_DOT(m->guards.row + row * PL_SIZE, x);
	g->to = PL_DOT(m->guards.row + row * PL_SIZE, end);
	g->off = PL_DOT(m->guards.chord_error + row * PL_SIZE, size);
	return (g->from > g->to ? g->from : g->to) + g->off
		   < m->limit[k] - 2e-15 * (pl_magnitude(m->limit[k]) + m->guards.amplitude[row]);
}

/* Of a guard that may not, L h on */
static PL_APART void PL(follow_guard)(const pl_guards *m, int k, const double *size, double L, PL(course) *g)
{
	const int row = m->guard[k].row;
	const double limit = m->limit[k];
	g->from -= limit;
	g->to -= limit;
	g->off *= L * L;
	g->noise = PL(noise_at)(m, m->guards.row + row * PL_SIZE, m->guards.tangent + row * PL_SIZE, limit,
							m->guards.amplitude[row], size);
}

/* Whether it certainly keeps below its limit, if it begins there: by its chord, or by its cubic, off by cubic_error */
static int PL(keeps_below)(const pl_guards *m, int k, const double *x, const double *size, const double *end, double L,
						   const PL(course) *g)
{
	const int at = m->guard[k].row * PL_SIZE;
	const double ends = g->from > g->to ? g->from : g->to;
	double leaving, arriving, most;
	if (!(ends < -g->noise) || ends + g->off < -g->noise) {
		return ends < -g->noise;
	}
	leaving = g->from + L * PL_DOT(m->guards.tangent + at, x);
	arriving = g->to - L * PL_DOT(m->guards.tangent + at, end);
	most = leaving > arriving ? leaving : arriving;
	most = most > ends ? most : ends;
	return most + L * L * L * L * PL_DOT(m->guards.cubic_error + at, size) < -g->noise;
}

/* Whether nothing is to be decided at x: what is held is in its place, and all else, but for one switching function, is
 * inside its interval by more than rounding, so that nothing touches either */
static int PL(is_settled)(const pl_guards *m, int region, int but, const double *x, const double *size)
{
	const double *b = m->at;
	const int set = m->hold[region];
	int i, k, stride = 1;
	for (k = set < 0 ? 0 : m->set[set]; set >= 0 && k < m->set[set + 1]; k++) {
		if (!(PL_DOT(m->value + k * PL_SIZE, x) - x[m->state[k]] == 0.0)) {
			return 0;
		}
	}
	for (i = 0; i < m->switches; i++) {
		const int intervals = m->breaks[i] + 1, interval = region / stride % intervals;
		const double low = interval > 0 ? b[interval - 1] : -1e300;
		const double high = interval < intervals - 1 ? b[interval] : 1e300;
		const double *const row = m->row + i * PL_SIZE;
		if (i != but && low < high) {
			const double *const tangent = m->tangent + (m->matrix[region] * m->switches + i) * PL_SIZE;
			const double e = PL_DOT(row, x), noise = PL(noise_at)(m, row, tangent, 0.0, m->amplitude[i],
					size);
			if (!(e - low > noise + PL_ROUNDED * pl_magnitude(low))
					|| !(high - e > noise + PL_ROUNDED * pl_magnitude(high))) {
				return 0;
			}
		}
		stride *= intervals;
		b += intervals - 1;
	}
	return 1;
}

/* ---- along the step ---- */

/* The slopes of a region, for an argument: compilers reach all entries of that from one address. */
static PL_INLINE const double *PL(slopes_in)(const pl_guards *m, int which)
{
	return m->A + which * PL_SIZE * PL_SIZE;
}

/* d_k = (L h A)^k x/k!, the coefficients of x in parts of L h, to the first even order that adds less than sums of the
 * terms before it are rounded by; so do those behind it, which are products of it.  Returns that order. */
static PL_APART int PL(powers)(const pl_guards *m, const double *A, double L, const double *x,
							   double d[PL_MOST_TERMS][PL_MOST_SIZE])
{
	static const double inverse[17] = { /* 1/k */
		1.0, 1.0, 0.5, 0.3333333333333333, 0.25, 0.2, 0.16666666666666666, 0.14285714285714285, 0.125,
		0.1111111111111111, 0.1, 0.09090909090909091, 0.08333333333333333, 0.07692307692307693,
		0.07142857142857142, 0.06666666666666667, 0.0625};
	const double length = L * m->h;
	double power[PL_MOST_SIZE], next[PL_MOST_SIZE];
	int i, j, k;
	PL_ENTRIES
	for (i = 0; i < PL_PAIRED; i++) {
		d[0][i] = power[i] = i < PL_SIZE ? x[i] : 0.0;
	}
	for (k = 1; k <= m->degree; k++) {
		const double part = length * inverse[k];
		PL_ENTRIES
		for (i = 0; i < PL_PAIRED; i++) {
			double sum = -0.0;
			PL_ENTRIES
			for (j = 0; j < PL_SIZE; j++) {
				if (i < PL_SIZE && PL_ACTS(i, j)) {
					sum += A[i * PL_SIZE + j] * power[j];
				}
			}
			next[i] = sum;
		}
		PL_ENTRIES
		for (i = 0; i < PL_PAIRED; i++) {
			power[i] = part * next[i];
			d[k][i] = power[i];
		}
		if (k < 6 || k % 2) {
			continue;
		}
		PL_ENTRIES
		for (i = 0; i < PL_SIZE; i++) {
			const double size = pl_magnitude(d[0][i]) + pl_magnitude(d[1][i]) + pl_magnitude(d[2][i]);
			if (!(pl_magnitude(d[k][i]) <= 0x1p-56 * size)) {
				break;
			}
		}
		if (i == PL_SIZE) {
			return k;
		}
	}
	return m->degree;
}

/* y: their sum at s, what is gained before x, so that little of it is lost */
static void PL(go_to)(const pl_guards *m, int order, double d[PL_MOST_TERMS][PL_MOST_SIZE], double s, double *y)
{
	double sum[PL_MOST_SIZE];
	int i, k;
	(void)m;
	PL_ENTRIES
	for (i = 0; i < PL_PAIRED; i++) {
		sum[i] = d[order][i];
	}
	for (k = order - 1; k >= 0; k--) {
		PL_ENTRIES
		for (i = 0; i < PL_PAIRED; i++) {
			sum[i] = sum[i] * s + d[k][i];
		}
	}
	PL_ENTRIES
	for (i = 0; i < PL_SIZE; i++) {
		y[i] = sum[i];
	}
}

/* About where guard k comes to its limit, from x to end, by the inverse of its cubic; above 1: it is not known */
static double PL(guess)(const pl_guards *m, int k, const double *x, const double *end, const PL(course) *g)
{
	const double *const tangent = m->guards.tangent + m->guard[k].row * PL_SIZE;
	const double rise = (g->to - g->from) / 3.0, s = -g->from / (g->to - g->from), u = 1.0 - s;
	const double leaving = PL_DOT(tangent, x), arriving = PL_DOT(tangent, end);
	if (!(leaving > 0.25 * rise && arriving > 0.25 * rise)) {
		return 2.0;
	}
	return s * (s * (3.0 - 2.0 * s) + u * (u * (rise / leaving) - s * (rise / arriving)));
}

/* Where a guard comes to its limit, from below to above, at its only root from 0 to 1: it rises all the way, or bends
 * one way all the way.  about: where that may be.  2: that is not certain */
static double PL(root_of)(const pl_guards *m, int k, int order, double d[PL_MOST_TERMS][PL_MOST_SIZE],
						  const PL(course) *g, double about)
{
	const double *const row = m->guards.row + m->guard[k].row * PL_SIZE;
	double c[PL_MOST_TERMS], slopes = 0.0, bends = 0.0, to = 0.0, s = about, step;
	int i, look;
	for (i = order; i > 0; i--) {
		c[i] = PL_DOT(row, d[i]);
		to += c[i];
		if (i > 2) {
			slopes += i * pl_magnitude(c[i]);
			bends += i * (i - 1) * pl_magnitude(c[i]);
		}
	}
	c[0] = g->from;
	if (!(c[0] + to > g->noise) || (!(c[1] > 2.0 * pl_magnitude(c[2]) + slopes)
			&& !(2.0 * pl_magnitude(c[2]) > bends))) {
		return 2.0;
	}
	for (look = 0; look < 6 && s >= 0.0 && s <= 1.0; look++) {
		double e = 0.0, slope = 0.0, second = 0.0, third = 0.0, w;
		for (i = order; i >= 0; i--) {
			third = third * s + second;
			second = second * s + slope;
			slope = slope * s + e;
			e = e * s + c[i];
		}
		w = 1.0 / slope;
		second *= w;
		e *= w;
		step = e * (1.0 + e * (second + e * (2.0 * second * second - third * w)));
		s -= step;
		if (pl_magnitude(step) < 1e-4) {
			return s;
		}
	}
	return 2.0;
}

/* A set of assignments, all from the same x */
static void PL(put)(const pl_guards *m, int set, double *x)
{
	double place[PL_MOST_SIZE];
	int k;
	for (k = set < 0 ? 0 : m->set[set]; set >= 0 && k < m->set[set + 1]; k++) {
		place[k - m->set[set]] = 0.0 + PL_DOT(m->value + k * PL_SIZE, x);
	}
	for (k = set < 0 ? 0 : m->set[set]; set >= 0 && k < m->set[set + 1]; k++) {
		x[m->state[k]] = place[k - m->set[set]];
	}
}

/* The guard that is met first in a step: its number, and y is x there, after h times *when; -1: none is; -2: that is
 * not certain.  Terms are those of the part of the step up to where it may be. */
static int PL(first_met)(const pl_guards *m, int region, const double *x, const double *size, const double *end,
						 double *y, double *when)
{
	const int last = m->first[region + 1];
	double d[PL_MOST_TERMS][PL_MOST_SIZE], about = 2.0, scale = 1.0, root;
	int k, order, met = -1, others = 0;
	PL(course) g, one;
	for (k = m->first[region]; k < last; k++) {
		if (PL(keeps_off)(m, k, x, size, end, &g)) {
			continue;
		}
		PL(follow_guard)(m, k, size, 1.0, &g);
		if (!(g.from < -g.noise)) {
			return -2;
		}
		if (PL(keeps_below)(m, k, x, size, end, 1.0, &g)) {
			continue;
		}
		if (!(g.to > 2.0 * g.noise)) {
			return -2;
		}
		others += met >= 0;
		if (-g.from < about * (g.to - g.from)) {
			about = -g.from / (g.to - g.from);
			met = k;
			one = g;
		}
	}
	if (met < 0) {
		return met;
	}
	root = PL(guess)(m, met, x, end, &one);
	if (root < 0.9) {
		about = root;
		scale = 1.0625 * root + 0.015625;
	}
	order = PL(powers)(m, PL(slopes_in)(m, m->matrix[region]), scale, x, d);
	root = PL(root_of)(m, met, order, d, &one, about / scale);
	if (!(root <= 1.0) && scale < 1.0) {
		scale = 1.0;
		order = PL(powers)(m, PL(slopes_in)(m, m->matrix[region]), scale, x, d);
		root = PL(root_of)(m, met, order, d, &one, about);
	}
	*when = root * scale;
	if (!(*when > 0.0 && *when < 1.0)) {
		return -2;
	}
	PL(go_to)(m, order, d, root, y);
	if (!(pl_magnitude(PL_DOT(m->guards.row + m->guard[met].row * PL_SIZE, y) - m->limit[met]) <= one.noise)) {
		return -2;
	}
	for (k = m->first[region]; others > 0 && k < last; k++) {
		if (k == met || PL(keeps_off)(m, k, x, size, y, &g)) {
			continue;
		}
		PL(follow_guard)(m, k, size, *when, &g);
		if (!PL(keeps_below)(m, k, x, size, y, *when, &g)) {
			return -2;
		}
	}
	return met;
}

/* ---- behind the event ---- */

/* Whether a guard that begins at its limit certainly leaves it over h L, or does not rise above it by more than
 * rounding: by a parabola above it, as what is let go may begin with no acceleration */
static int PL(leaves)(const pl_guards *m, int k, int order, double d[PL_MOST_TERMS][PL_MOST_SIZE],
					  const PL(course) *g)
{
	const double *const row = m->guards.row + m->guard[k].row * PL_SIZE;
	const double slope = PL_DOT(row, d[1]);
	double bend = PL_DOT(row, d[2]);
	int i;
	for (i = 3; i <= order; i++) {
		bend += pl_magnitude(PL_DOT(row, d[i]));
	}
	if (!(g->from <= g->noise)) {
		return 0;
	}
	return slope + bend < 0.0 ||
		   (bend < 0.0 && (slope <= 0.0 || slope * slope <= -4.0 * bend * (g->noise - g->from)));
}

/* x on over h L in a region, at whose start something has happened; 0: it is not certain that nothing more does.
 * Guards of a switching function may begin at their limit, or with -1 all */
static int PL(goes_on)(const pl_guards *m, int region, int of, double L, int order,
					   double d[PL_MOST_TERMS][PL_MOST_SIZE], const double *size, double *x)
{
	double end[PL_MOST_SIZE];
	int i, k;
	PL(go_to)(m, order, d, 1.0, end);
	for (k = m->first[region]; k < m->first[region + 1]; k++) {
		PL(course) g;
		if (PL(keeps_off)(m, k, x, size, end, &g)) {
			continue;
		}
		PL(follow_guard)(m, k, size, L, &g);
		if (!PL(keeps_below)(m, k, x, size, end, L, &g)
				&& !((of < 0 || m->guard[k].expression == of) && PL(leaves)(m, k, order, d, &g))) {
			return 0;
		}
	}
	PL(put)(m, m->hold[region], end);
	PL_ENTRIES
	for (i = 0; i < PL_SIZE; i++) {
		x[i] = end[i];
	}
	return 1;
}

/* Whether two breakpoints of a switching function are one, where it is held between them: this and the next */
static int PL(stands_twice)(const pl_guards *m, int expression, int breakpoint)
{
	const double *b = m->at;
	int i;
	for (i = 0; i < expression; i++) {
		b += m->breaks[i];
	}
	return breakpoint >= 0 && breakpoint + 1 < m->breaks[expression] && !(b[breakpoint] < b[breakpoint + 1]);
}

/* |A| size */
static void PL(turn_sizes)(const pl_guards *m, int which, const double *size, double *turned)
{
	const double *const A = m->A + which * PL_SIZE * PL_SIZE;
	int i, j;
	PL_ENTRIES
	for (i = 0; i < PL_SIZE; i++) {
		double sum = -0.0;
		PL_ENTRIES
		for (j = 0; j < PL_SIZE; j++) {
			if (PL_ACTS(i, j)) {
				sum += pl_magnitude(A[i * PL_SIZE + j]) * size[j];
			}
		}
		turned[i] = sum;
	}
}

/* Whether a switching function that was held certainly moves up, or down, as what is at rest is asked: by its slope, or
 * where that is but rounding by its second derivative */
static int PL(moves)(const pl_guards *m, int which, const pl_guard *g, double L, const double *size,
					 double d[PL_MOST_TERMS][PL_MOST_SIZE])
{
	const double *const row = m->row + g->expression * PL_SIZE, sign = g->upward ? 1.0 : -1.0;
	const double slope = sign * PL_DOT(row, d[1]), unit = 2.0 * PL_ROUNDED * L * m->h;
	double terms[PL_MOST_SIZE], further[PL_MOST_SIZE], noise;
	PL(turn_sizes)(m, which, size, terms);
	noise = unit * PL(sizes_of)(m, row, terms);
	if (slope > noise || !(pl_magnitude(slope) < 0.25 * noise)) {
		return slope > noise;
	}
	PL(turn_sizes)(m, which, terms, further);
	return 2.0 * sign * PL_DOT(row, d[2]) > unit * L * m->h * PL(sizes_of)(m, row, further);
}

/* Whether impact k, met at x, is certainly one of a speed that counts, and flies off at one; x is behind it, on its
 * guard.  size: |x| before */
static int PL(bounces)(const pl_guards *m, int which, int k, const double *size, double *x)
{
	const pl_impact *const of = m->impact + k;
	const double *const speed = m->speed + k * PL_SIZE, *const back = m->back + k * PL_SIZE, *b = m->at;
	double terms[PL_MOST_SIZE], off, least;
	int i;
	PL(turn_sizes)(m, which, size, terms);
	least = 2.0 * PL_ROUNDED *
			(PL(sizes_of)(m, speed, size) + of->amplitude + m->h * PL(sizes_of)(m, speed, terms));
	if (of->rest < 0 || !(PL_DOT(speed, x) > least)) {
		return 0;
	}
	PL(put)(m, of->jump, x);
	for (i = 0; i < of->expression; i++) {
		b += m->breaks[i];
	}
	off = PL_DOT(m->row + of->expression * PL_SIZE, x) - b[of->breakpoint];
	PL_ENTRIES
	for (i = 0; i < PL_SIZE; i++) {
		x[i] -= back[i] * off;
	}
	return PL_DOT(speed, x) < -least;
}

/* Whether it does so for longer than what comes to rest, and no other bounce is near its guard */
static int PL(flies)(const pl_guards *m, int which, int k, double L, const double *x, const double *size,
					 double d[PL_MOST_TERMS][PL_MOST_SIZE])
{
	const double *const row = m->speed + k * PL_SIZE;
	const double speed = PL_DOT(row, x), press = PL_DOT(row, d[1]), *b = m->at;
	int i, j;
	if (!(speed < -2.0 * PL_ROUNDED * (PL(sizes_of)(m, row, size) + m->impact[k].amplitude))
			|| !(-2.0 * L * speed > 0x1p-9 * (1.0 - m->impact[k].restitution) * press)) {
		return 0;
	}
	for (i = 0; i < m->switches; i++) {
		const double *const of = m->row + i * PL_SIZE;
		const double *const tangent = m->tangent + (which * m->switches + i) * PL_SIZE;
		for (j = 0; j < m->impacts; j++) {
			if (j != k && m->impact[j].expression == i && m->impact[j].rest >= 0) {
				const double at = b[m->impact[j].breakpoint], off = PL_DOT(of, x) - at;
				if (!((m->impact[j].upward ? -off : off) >
						2.0 * PL(noise_at)(m, of, tangent, at, m->amplitude[i], size)
						+ 0x1p-40 * m->h * pl_magnitude(press / L))) {
					return 0;
				}
			}
		}
		b += m->breaks[i];
	}
	return 1;
}

/* x, where guard k is met, on over h L, where it is certain that what happens concerns that guard alone: it begins or
 * ends to stick, or bounces.  Returns the region behind it; -1: it is not certain */
static int PL(goes_alone)(const pl_guards *m, int region, int k, double L, double *x)
{
	const pl_guard *const g = m->guard + k;
	const int behind = g->impact < 0 ? region + g->leads : region, which = m->matrix[behind];
	const int holds = g->impact < 0 && PL(stands_twice)(m, g->expression, g->breakpoint - !g->upward);
	double d[PL_MOST_TERMS][PL_MOST_SIZE], size[PL_MOST_SIZE];
	int i, order;
	if (which < 0 || m->halvings[which] > 0 || m->max_events < 1 || m->most < 1) {
		return -1;
	}
	PL_ENTRIES
	for (i = 0; i < PL_SIZE; i++) {
		size[i] = pl_magnitude(x[i]);
	}
	PL(put)(m, m->hold[behind], x);
	if (g->impact >= 0) {
		if (!PL(bounces)(m, which, g->impact, size, x)) {
			return -1;
		}
		PL(put)(m, m->hold[behind], x);
	}
	PL_ENTRIES
	for (i = 0; i < PL_SIZE; i++) {
		size[i] = pl_magnitude(x[i]);
	}
	if (!PL(is_settled)(m, behind, g->expression, x, size)) {
		return -1;
	}
	order = PL(powers)(m, PL(slopes_in)(m, which), L, x, d);
	if (g->impact >= 0 ? !PL(flies)(m, which, g->impact, L, x, size, d)
			: PL(stands_twice)(m, g->expression, g->breakpoint - g->upward)
			&& !PL(moves)(m, which, g, L, size, d)) {
		return -1;
	}
	/* a force that holds is below its limit, or it lets go at once */
	return PL(goes_on)(m, behind, holds ? m->switches : g->expression, L, order, d, size, x) ? behind : -1;
}

/* The same whatever happens, c being before it.  0: it is not certain */
static int PL(goes_through)(const pl_guards *m, int k, double when, double *x, pl_contact *c, pl_crossing *crossing,
							double *work)
{
	double d[PL_MOST_TERMS][PL_MOST_SIZE], size[PL_MOST_SIZE] = {0.0};
	int i, order;
	if (!pl_guards_meet(m, k, when * m->h, x, c, crossing, work) || m->matrix[c->region] < 0 ||
		m->halvings[c->matrix] > 0) {
		return 0;
	}
	for (i = 0; i < PL_SIZE; i++) {
		size[i] = pl_magnitude(x[i]);
	}
	order = PL(powers)(m, PL(slopes_in)(m, c->matrix), 1.0 - when, x, d);
	return PL(goes_on)(m, c->region, -1, 1.0 - when, order, d, size, x);
}

/* x over h with one event, or with none that the chord of a guard has hidden; 0: there may be more, and nothing has
 * changed */
static int PL(meets_one)(const pl_guards *m, double *x, pl_contact *c, pl_crossing *crossing,
						 double *work PL_AND_VARIATION)
{
	const pl_contact before = *c;
	double end[PL_MOST_SIZE], size[PL_MOST_SIZE], y[PL_MOST_SIZE], again[PL_MOST_SIZE], all = 0.0, when = 1.0;
	int i, met, behind;
	if (m->matrix[c->region] < 0 || m->halvings[c->matrix] > 0) {
		return 0;
	}
	PL_ENTRIES
	for (i = 0; i < PL_SIZE; i++) {
		end[i] = 0.0 + PL_DOT(m->Phi + (c->matrix * PL_SIZE + i) * PL_SIZE, x);
		size[i] = pl_magnitude(x[i]);
		all += size[i];
	}
	if (!(all < 1e300) || !PL(is_settled)(m, c->region, -1, x, size)) {
		return 0;
	}
	PL(put)(m, m->hold[c->region], end);
	met = PL(first_met)(m, c->region, x, size, end, y, &when);
	if (met == -2) {
		return 0;
	}
	for (i = 0; i < PL_SIZE; i++) {
		again[i] = met == -1 ? end[i] : y[i];
	}
	behind = met == -1 ? c->region : PL(goes_alone)(m, c->region, met, 1.0 - when, again);
	if (behind < 0) {
		for (i = 0; i < PL_SIZE; i++) {
			again[i] = y[i];
		}
		if (!PL(goes_through)(m, met, when, again, c, crossing, work)) {
			*c = before;
			return 0;
		}
	} else {
		c->crossings = 0;
		if (met >= 0) {
			crossing->time = when * m->h;
			crossing->expression = m->guard[met].expression;
			crossing->breakpoint = m->guard[met].breakpoint;
			crossing->upward = m->guard[met].upward;
			c->crossings = 1;
			c->total++;
			c->region = behind;
			c->matrix = m->matrix[behind];
		}
	}
#if PL_COLUMNS_D > 0
	if (v != NULL) {
		PL(take_along)(m, met, when, x, y, again, &before, c->region, work, v);
	}
#endif
	for (i = 0; i < PL_SIZE; i++) {
		x[i] = again[i];
	}
	return 1;
}
