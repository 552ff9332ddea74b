/* SPDX-License-Identifier: MIT-0 */
/* unmet.h: a step of a model with friction or impacts that meets none of the guards of its region or, with PL_MEETS,
 * one, by the tables of its search: part of search.h, for small processors of guards.c, and over lanes of NAME_batch of
 * unmet_lanes.h.  Where none is met the search would take the same step, to the last bit: sums have its order, and what
 * is accepted here leaves nothing to take up, nothing that touches, and each guard below its limit by the bound of the
 * search.  A guard that has just been left, and what is less certain, go by the search.  PL_SUM(row, x) is of PL_SIZE
 * products; bit i of PL_CAPPED is set where x_i is never above 1.  PL_VALUE is a number, or lanes of numbers, and what
 * is true then so in some lanes.  With PL_SEEKS, behind these: a step of s. */
#ifndef PL_SEEKS
#ifndef PL_VALUE
#define PL_VALUE double
#define PL_TRUTH int
#define PL_UNMET(name) PL(name)
#define PL_ALL_OF(value) (value)
#define PL_MAGNITUDE(value) pl_magnitude(value)
#define PL_LARGER(a, b) ((a) > (b) ? (a) : (b))
#define PL_BELOW(a, b) ((a) < (b))
#define PL_IS_ZERO(size) ((size) <= 0.0)
#define PL_AND(a, b) ((a) & (b))
#define PL_FAILS(truth) (!(truth))
#define PL_STRANGE(x) (PL_SOFT && pl_not_finite(x, PL_SIZE))
#endif

#if PL_FEW_REGIONS
/* row . x in the order of the runtime's sums: of each fourth term, then these */
static PL_INLINE PL_VALUE PL_UNMET(product)(int j, const double *row, const PL_VALUE *x)
{
	return j < PL_SIZE && (row[j] < 0.0 || row[j] > 0.0) ? row[j] * x[j] : PL_ALL_OF(-0.0);
}

static PL_INLINE PL_VALUE PL_UNMET(fourth)(int j, const double *row, const PL_VALUE *x)
{
	return ((PL_UNMET(product)(j, row, x) + PL_UNMET(product)(j + 4, row, x)) + PL_UNMET(product)(j + 8, row, x)) +
		   PL_UNMET(product)(j + 12, row, x);
}

static PL_INLINE PL_VALUE PL_UNMET(sum)(const double *row, const PL_VALUE *x)
{
	return (PL_UNMET(fourth)(0, row, x) + PL_UNMET(fourth)(2, row, x)) +
		   (PL_UNMET(fourth)(1, row, x) + PL_UNMET(fourth)(3, row, x));
}
#define PL_SUM(row, x) PL_UNMET(sum)(row, x)
#define PL_EACH PL_UNROLL
#endif

/* Whether what a set holds is where it is held; at the end it is put there, all from the same x.  place: size */
static PL_INLINE PL_TRUTH PL_UNMET(holds)(const pl_guards *m, int set, const PL_VALUE *x, PL_VALUE *end,
										  PL_VALUE *place)
{
	const int first = m->set[set], last = m->set[set + 1];
	PL_TRUTH held = PL_BELOW(PL_ALL_OF(0.0), PL_ALL_OF(1.0));
	int k;
	PL_EACH
	for (k = first; k < last; k++) {
		const double *const value = m->value + k * PL_SIZE;
		held = PL_AND(held, PL_IS_ZERO(PL_MAGNITUDE(PL_SUM(value, x) - x[m->state[k]])));
		if (PL_FAILS(held)) {
			return held;
		}
		place[k - first] = 0.0 + PL_SUM(value, end);
	}
	PL_EACH
	for (k = first; k < last; k++) {
		end[m->state[k]] = place[k - first];
	}
	return held;
}

/* Whether guard k keeps below its limit from x to end: by its chord, h^2/8 of its second derivative, and what rounding
 * may hide at the start, 9 units in the last place of all terms; those of x are in the table */
static PL_INLINE PL_TRUTH PL_UNMET(keeps)(const pl_guards *m, int k, const PL_VALUE *x, const PL_VALUE *end,
										  const PL_VALUE *size)
{
	const int row = m->guard[k].row;
	const PL_VALUE from = PL_SUM(m->guards.row + row * PL_SIZE, x), to = PL_SUM(m->guards.row + row * PL_SIZE, end);
	const PL_VALUE off = PL_SUM(m->guards.chord_error + row * PL_SIZE, size);
	return PL_BELOW(PL_LARGER(from, to) + off,
					PL_ALL_OF(m->limit[k] - 2e-15 * (pl_magnitude(m->limit[k])
							+ m->guards.amplitude[row])));
}

/* Row i of a product, with 0 in the place of -0 as the search has it.  Where what multiplies x_i is above 0 there is no
 * -0 unless x_i was one; the addition that is spared there is one of the few that the next step waits for. */
static PL_INLINE PL_VALUE PL_UNMET(row_of)(const pl_guards *m, const double *matrix, int i, const PL_VALUE *x)
{
	const PL_VALUE sum = PL_SUM(matrix + i * PL_SIZE, x);
	(void)m; /* which a sum that is written out does not read */
	return matrix[i * PL_SIZE + i] > 0.0 ? sum : 0.0 + sum;
}

/* x over h in a region to end, and whether it is sure that nothing is met.  size, place: for sizes of x, and work */
static PL_INLINE PL_TRUTH PL_UNMET(keeps_all)(const pl_guards *m, int region, const PL_VALUE *x, PL_VALUE *end,
										  PL_VALUE *size, PL_VALUE *place)
{
	const int which = m->matrix[region], set = m->hold[region];
	PL_VALUE all = PL_ALL_OF(-0.0); /* which adds nothing: a compiler need not add it */
	PL_TRUTH kept;
	int i;
	if (which < 0 || PL_STRANGE(x)) {
		return PL_BELOW(PL_ALL_OF(0.0), PL_ALL_OF(-1.0));
	}
	PL_EACH
	for (i = 0; i < PL_SIZE; i++) {
		const int capped = i < 31 && (PL_CAPPED >> i) % 2 == 1;
		end[i] = PL_UNMET(row_of)(m, m->Phi + which * PL_SIZE * PL_SIZE, i, x);
		size[i] = capped ? PL_ALL_OF(1.0) : PL_MAGNITUDE(x[i]);
		all = all + (PL_SOFT || capped ? PL_ALL_OF(-0.0) : size[i]);
	}
	kept = PL_BELOW(all, PL_ALL_OF(1e300));
	if (!PL_FAILS(kept) && set >= 0) {
		kept = PL_AND(kept, PL_UNMET(holds)(m, set, x, end, place));
	}
	if (PL_FAILS(kept)) {
		return kept;
	}
	PL_EACH
	for (i = m->first[region]; i < m->first[region + 1]; i++) {
		kept = PL_AND(kept, PL_UNMET(keeps)(m, i, x, end, size));
		if (PL_FAILS(kept)) {
			return kept;
		}
	}
	return kept;
}

#if PL_MEETS
/* ---- a step that meets one guard ---- */

/* Such steps are of up to MOST_SIZE entries and terms of MOST_TERMS - 1 orders, also where the runtime takes them. */
#ifndef PL_DOT
#define PL_ENTRIES PL_UNROLL
#define PL_MOST_SIZE PL_SIZE
#define PL_MOST_TERMS PL_DEGREE + 1
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

/* sum |row_j x_j| by |x| */
static PL_INLINE double PL(sizes_of)(const pl_guards *m, const double *row, const double *size)
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

/* A guard less its limit over a step: at both ends, its slopes there, how far it leaves its chord, what rounding may do
 * to it.  Times are in parts of h, and so are derivatives. */
typedef struct PL(course) {
	double from, to, leaving, arriving, off, noise;
} PL(course);

/* What rounding may do to row . x less b, as the search has it */
static double PL(noise_at)(const pl_guards *m, const double *row, const double *tangent, double b, double amplitude,
						   const double *size)
{
	return 1.7763568394002505e-15 *
		   (PL(sizes_of)(m, row, size) + 3.0 * PL(sizes_of)(m, tangent, size) + pl_magnitude(b) + amplitude);
}

/* Of guard k from x to end, L h on.  size: |x| */
static PL_APART void PL(follow_guard)(const pl_guards *m, int k, const double *x, const double *size,
									  const double *end, double L, PL(course) *g)
{
	const int at = m->guard[k].row * PL_SIZE;
	const double *const row = m->guards.row + at, *const tangent = m->guards.tangent + at;
	const double limit = m->limit[k];
	g->from = PL_DOT(row, x) - limit;
	g->to = PL_DOT(row, end) - limit;
	g->off = L * L * PL(sizes_of)(m, m->guards.chord_error + at, size);
	g->noise = PL(noise_at)(m, row, tangent, limit, m->guards.amplitude[m->guard[k].row], size);
	g->leaving = 3.0 * L * PL_DOT(tangent, x);
	g->arriving = 3.0 * L * PL_DOT(tangent, end);
}

/* Whether it certainly keeps below its limit, if it begins there: by its chord, or by its cubic, off by cubic_error */
static int PL(keeps_below)(const pl_guards *m, int k, const double *size, double L, const PL(course) *g)
{
	const double *const cubic_error = m->guards.cubic_error + m->guard[k].row * PL_SIZE;
	const double ends = g->from > g->to ? g->from : g->to;
	double leaving, arriving, most;
	if (ends + g->off < -g->noise) {
		return 1;
	}
	leaving = g->from + g->leaving / 3.0;
	arriving = g->to - g->arriving / 3.0;
	most = leaving > arriving ? leaving : arriving;
	most = most > ends ? most : ends;
	return most + L * L * L * L * PL(sizes_of)(m, cubic_error, size) < -g->noise;
}

/* Whether nothing is to be decided at x: what is held is in its place, and all else is inside its interval by more than
 * rounding, so that nothing touches either */
static int PL(is_settled)(const pl_guards *m, int region, const double *x, const double *size)
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
		if (low < high) {
			const double *const tangent = m->tangent + (m->matrix[region] * m->switches + i) * PL_SIZE;
			const double e = PL_DOT(row, x), noise = PL(noise_at)(m, row, tangent, 0.0, m->amplitude[i],
					size);
			const double far = 1.7763568394002505e-15;
			if (!(e - low > noise + far * pl_magnitude(low))
					|| !(high - e > noise + far * pl_magnitude(high))) {
				return 0;
			}
		}
		stride *= intervals;
		b += intervals - 1;
	}
	return 1;
}

/* d_k = (h A)^k x/k!, the coefficients of x in parts of h */
static PL_APART void PL(powers)(const pl_guards *m, int which, const double *x, double d[PL_MOST_TERMS][PL_MOST_SIZE])
{
	static const double weight[17] = { /* 1/k! */
		1.0, 1.0, 0.5, 0.16666666666666666, 0.041666666666666664, 0.008333333333333333, 0.001388888888888889,
		0.0001984126984126984, 2.48015873015873e-05, 2.7557319223985893e-06, 2.755731922398589e-07,
		2.505210838544172e-08, 2.08767569878681e-09, 1.6059043836821613e-10, 1.1470745597729725e-11,
		7.647163731819816e-13, 4.779477332387385e-14};
	const double *const A = m->A + which * PL_SIZE * PL_SIZE;
	double turn[PL_MOST_SIZE][PL_MOST_SIZE], power[PL_MOST_SIZE], next[PL_MOST_SIZE];
	int i, j, k;
	PL_ENTRIES
	for (i = 0; i < PL_SIZE; i++) {
		d[0][i] = power[i] = x[i];
		PL_ENTRIES
		for (j = 0; j < PL_SIZE; j++) {
			turn[i][j] = m->h * A[i * PL_SIZE + j];
		}
	}
	for (k = 1; k <= m->degree; k++) {
		PL_ENTRIES
		for (i = 0; i < PL_SIZE; i++) {
			double sum = -0.0;
			PL_ENTRIES
			for (j = 0; j < PL_SIZE; j++) {
				if (PL_ACTS(i, j)) {
					sum += turn[i][j] * power[j];
				}
			}
			next[i] = sum;
		}
		PL_ENTRIES
		for (i = 0; i < PL_SIZE; i++) {
			power[i] = next[i];
			d[k][i] = weight[k] * next[i];
		}
	}
}

/* y: x after s h, what is gained before x, so that little of it is lost.  size: |y| */
static void PL(go_to)(const pl_guards *m, double d[PL_MOST_TERMS][PL_MOST_SIZE], double s, double *y,
					  double *size)
{
	double even[PL_MOST_SIZE], odd[PL_MOST_SIZE]; /* of two chains neither waits for the other */
	const double ss = s * s;
	int i, k;
	PL_ENTRIES
	for (i = 0; i < PL_SIZE; i++) {
		even[i] = odd[i] = 0.0;
	}
	for (k = m->degree - m->degree % 2; k > 1; k -= 2) {
		PL_ENTRIES
		for (i = 0; i < PL_SIZE; i++) {
			even[i] = even[i] * ss + d[k][i];
			odd[i] = odd[i] * ss + (k < m->degree ? d[k + 1][i] : 0.0);
		}
	}
	PL_ENTRIES
	for (i = 0; i < PL_SIZE; i++) {
		y[i] = d[0][i] + (d[1][i] + (odd[i] * ss + even[i] * s)) * s;
		size[i] = pl_magnitude(y[i]);
	}
}

/* Where a guard comes to its limit, from below to above, at its only root: it rises all the way, or bends one way all
 * the way.  2: that is not certain */
static double PL(root_of)(const pl_guards *m, int k, double d[PL_MOST_TERMS][PL_MOST_SIZE], const PL(course) *g)
{
	const double *const row = m->guards.row + m->guard[k].row * PL_SIZE, rise = g->to - g->from;
	double c[PL_MOST_TERMS], slopes = 0.0, bends = 0.0, s = -g->from / rise, step;
	int i, look;
	c[0] = g->from;
	for (i = 1; i <= m->degree; i++) {
		c[i] = PL_DOT(row, d[i]);
	}
	for (i = m->degree; i > 2; i--) {
		slopes += i * pl_magnitude(c[i]);
		bends += i * (i - 1) * pl_magnitude(c[i]);
	}
	if (!(c[1] > 2.0 * pl_magnitude(c[2]) + slopes) && !(2.0 * pl_magnitude(c[2]) > bends)) {
		return 2.0;
	}
	if (g->leaving > 0.25 * rise && g->arriving > 0.25 * rise) { /* that of the inverse cubic */
		const double u = 1.0 - s;
		s *= s * (3.0 - 2.0 * s) + u * (u * (rise / g->leaving) - s * (rise / g->arriving));
	}
	for (look = 0; look < 6 && s >= 0.0 && s <= 1.0; look++) {
		double e = 0.0, slope = 0.0, second = 0.0, third = 0.0, w;
		for (i = m->degree; i >= 0; i--) {
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

/* What is held is put in its place, all from the same x */
static void PL(put_held)(const pl_guards *m, int region, double *x)
{
	const int set = m->hold[region];
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
 * not certain */
static int PL(first_met)(const pl_guards *m, int region, const double *x, const double *size, const double *end,
						 double *y, double *when)
{
	const int last = m->first[region + 1];
	double d[PL_MOST_TERMS][PL_MOST_SIZE], there[PL_MOST_SIZE], about = 2.0;
	int k, met = -1, others = 0;
	PL(course) g, one;
	for (k = m->first[region]; k < last; k++) {
		PL(follow_guard)(m, k, x, size, end, 1.0, &g);
		if (!(g.from < -g.noise)) {
			return -2;
		}
		if (PL(keeps_below)(m, k, size, 1.0, &g)) {
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
	PL(powers)(m, m->matrix[region], x, d);
	*when = PL(root_of)(m, met, d, &one);
	if (!(*when > 0.0 && *when < 1.0)) {
		return -2;
	}
	PL(go_to)(m, d, *when, y, there);
	PL(follow_guard)(m, met, x, size, y, *when, &g);
	if (!(pl_magnitude(g.to) <= g.noise)) {
		return -2;
	}
	for (k = m->first[region]; others > 0 && k < last; k++) {
		PL(follow_guard)(m, k, x, size, y, *when, &g);
		if (k != met && !PL(keeps_below)(m, k, size, *when, &g)) {
			return -2;
		}
	}
	return met;
}

/* Whether a guard that begins at its limit certainly leaves it over h times L, or does not rise above it by more than
 * rounding: by a parabola above it, as what is let go may begin with no acceleration */
static int PL(leaves)(const pl_guards *m, int k, double d[PL_MOST_TERMS][PL_MOST_SIZE], double L,
					  const PL(course) *g)
{
	const double *const row = m->guards.row + m->guard[k].row * PL_SIZE;
	const double slope = PL_DOT(row, d[1]);
	double bend = PL_DOT(row, d[2]);
	int i;
	for (i = 3; i <= m->degree; i++) {
		bend += pl_magnitude(PL_DOT(row, d[i]));
	}
	if (!(g->from <= g->noise)) {
		return 0;
	}
	return slope + bend * L < 0.0 ||
		   (bend < 0.0 && (slope <= 0.0 || slope * slope <= -4.0 * bend * (g->noise - g->from)));
}

/* x on over h times L in a region, at whose start something has happened; 0: it is not certain that nothing more
 * does */
static int PL(goes_on)(const pl_guards *m, int region, double L, double *x)
{
	double d[PL_MOST_TERMS][PL_MOST_SIZE], size[PL_MOST_SIZE], end[PL_MOST_SIZE], unused[PL_MOST_SIZE];
	int i, k;
	PL_ENTRIES
	for (i = 0; i < PL_SIZE; i++) {
		size[i] = pl_magnitude(x[i]);
	}
	PL(powers)(m, m->matrix[region], x, d);
	PL(go_to)(m, d, L, end, unused);
	for (k = m->first[region]; k < m->first[region + 1]; k++) {
		PL(course) g;
		PL(follow_guard)(m, k, x, size, end, L, &g);
		if (!PL(keeps_below)(m, k, size, L, &g) && !PL(leaves)(m, k, d, L, &g)) {
			return 0;
		}
	}
	PL(put_held)(m, region, end);
	PL_ENTRIES
	for (i = 0; i < PL_SIZE; i++) {
		x[i] = end[i];
	}
	return 1;
}

/* x over h with one event, or with none that the chord of a guard has hidden; 0: there may be more, and nothing has
 * changed.  What happens at the event is decided as in the search. */
static int PL(meets_one)(const pl_guards *m, double *x, pl_contact *c, pl_crossing *crossing, double *work)
{
	const pl_contact before = *c;
	double end[PL_MOST_SIZE], size[PL_MOST_SIZE], y[PL_MOST_SIZE], all = 0.0, when = 1.0;
	int i, met;
	if (m->matrix[c->region] < 0 || m->halvings[c->matrix] > 0) {
		return 0;
	}
	PL_ENTRIES
	for (i = 0; i < PL_SIZE; i++) {
		end[i] = 0.0 + PL_DOT(m->Phi + (c->matrix * PL_SIZE + i) * PL_SIZE, x);
		size[i] = pl_magnitude(x[i]);
		all += size[i];
	}
	if (!(all < 1e300) || !PL(is_settled)(m, c->region, x, size)) {
		return 0;
	}
	PL(put_held)(m, c->region, end);
	met = PL(first_met)(m, c->region, x, size, end, y, &when);
	if (met == -2) {
		return 0;
	}
	if (met == -1) {
		c->crossings = 0;
	} else if (!pl_guards_meet(m, met, when * m->h, y, c, crossing, work) || m->matrix[c->region] < 0 ||
			   m->halvings[c->matrix] > 0 || !PL(goes_on)(m, c->region, 1.0 - when, y)) {
		*c = before;
		return 0;
	}
	for (i = 0; i < PL_SIZE; i++) {
		x[i] = met == -1 ? end[i] : y[i];
	}
	return 1;
}
#endif

#else

/* s over h in a region, where it is sure that no guard is met.  Stored here, as what all regions store behind them goes
 * through memory; and one by one, as two in one store would have to be put together first. */
static PL_INLINE int PL(unmet)(PL_TYPE *s, int region, const double x[PL_SIZE])
{
	double end[PL_SIZE], size[PL_SIZE], place[PL_SIZE];
	volatile double *const y = s->y;
	int i;
	if (!PL(keeps_all)(&PL(switching), region, x, end, size, place)) {
		return 0;
	}
	PL_EACH
	for (i = 0; i < PL_STATES; i++) {
		y[PL_PLACE(i)] = end[i];
	}
	s->contact PL_PART.crossings = 0;
	return 1;
}

#if PL_FEW_REGIONS
#define PL_CASE(k) case k: return k < PL_REGIONS && PL(unmet)(s, k, x);
#define PL_CASES(k) PL_CASE(k) PL_CASE(k + 1) PL_CASE(k + 2)

/* The same in the region where s is */
static PL_INLINE int PL(unmet_here)(PL_TYPE *s, double x[PL_VECTOR])
{
	const volatile double *const y = s->y; /* one by one, as they are stored: two in one load would wait for that */
	int i;
	PL_UNROLL
	for (i = 0; i < PL_STATES; i++) {
		x[i] = y[PL_PLACE(i)];
	}
	switch (s->contact PL_PART.region) {
	PL_CASES(0)
#if PL_REGIONS > 3
	PL_CASES(3)
	PL_CASES(6)
#endif
#if PL_REGIONS > 9
	PL_CASES(9)
	PL_CASES(12)
	PL_CASE(15)
#endif
	default:
		return 0;
	}
}
#else
static PL_INLINE int PL(unmet_here)(PL_TYPE *s, double x[PL_VECTOR])
{
	return PL(unmet)(s, s->contact PL_PART.region, x);
}
#endif

/* By the search.  x has no place in memory there, which each step would have to fill. */
static PL_INLINE void PL(seek_again)(PL_TYPE *s, const real x[PL_VECTOR])
{
	real again[PL_VECTOR];
	volatile real *const from = again;
	int i;
	PL_EACH
	for (i = PL_SOFT ? 0 : PL_STATES; i < PL_VECTOR; i++) {
		from[i] = x[i];
	}
	PL(by_search)(s, again);
}

/* s over h by that, or by the search */
static PL_INLINE void PL(seek)(PL_TYPE *s, real x[PL_VECTOR])
{
	if (PL_SOFT) {
		PL(by_search)(s, x);
	} else if (!PL(unmet_here)(s, x)) {
		PL(seek_again)(s, x);
	}
}
#endif
