/* SPDX-License-Identifier: MIT-0 */
/* few.h: the few crossings of a step of a piecewise-linear model, one after the other, each by the Taylor polynomials
 * of the entries of x and with bounds which say that it is there and that nothing comes before it.  All else is left to
 * the search of the runtime.
 *
 * Times are in parts of h, and so are derivatives.  A switching function e that is off a breakpoint b by g = sign (e -
 * b), less than 0 at the start, meets it at z first where g(z) = 0 and g(z - s)/s stays below 0.  That quotient is
 * -g'(z) at s = 0 and g(0)/z at s = z, and off the chord between them by at most z^2/24 max|g'''|, since its second
 * derivative is at most a third of that.  Behind the crossing (e - b)/s keeps its sign likewise.  Where e comes back to
 * b, the same holds of (e - b)/s in the place of e - b, whose third derivative is at most a quarter of the fourth of e.
 *
 * Included by search.h, which says what the model's file defines for both; and beside that
 *
 *     PL_FEW, PL_EVENT_CHECKS, PL_LARGE crossings and looks at most; how large the sum of |x| may be
 *     PL_OPEN_END                beyond all breakpoints
 *     PL_MOVES                   the degree of polynomials over h, of x in two words
 *     PL_TANGENT, PL_CUBIC_ERROR   of whole steps: a third of h e'; h^4/384 e'''' at most; each [which][i][PL_SIZE]
 *
 *     PL(within), PL(beyond)     [region][i][up]: the ends of its interval, and the region behind; -1: none can be
 *     PL(span)                   [region][i]: its interval, from the lowest one
 *     PL(matrix)                 [region]: `which` of the systems
 *     PL(slack), PL(jerk)        [which][i]: what rounding may do to e and h e'; h^3/24 e''' at most, times |x|
 *
 *     PL(switching_function)(i, x)       switching function i
 *     PL(along)(row, x), PL(sizes)(row, x), PL(most)(row, x)     row x; with |x|; of a bound, where what is never above
 *                                1 stands once
 *     PL(bounds)(which, x, off)  how far each switching function is off its chord over h or less, at most
 *     PL(advance)(which, x, end) e^{A h} x
 *     PL(turn_once)(which, x, d), PL(move)(which, x, s, gain)    h A x; e^{A h s} x - x, by its Taylor polynomial
 *     PL(size_of)(x)             the sum of |x| */

/* Of a step, in one region */
typedef struct PL(subinterval) {
	double done, left, length; /* before it, to the end of the step; looked at */
	int region, which;
	int passed, behind;        /* switching function that comes from an end of its interval; which end */
} PL(subinterval);

static void PL(next_subinterval)(PL(subinterval) *p, double gone, int region, int which, int passed, int behind)
{
	p->done += gone;
	p->length = 1.0 - p->done;
	p->left = p->length;
	p->region = region;
	p->which = which;
	p->passed = passed;
	p->behind = behind;
}

/* Whether what goes from `from` to `to`, by at most `off` aside, is between low and high */
static int PL(between)(double low, double high, double from, double to, double off)
{
	return (from < to ? from : to) - off > low && (from < to ? to : from) + off < high;
}

/* Whether what comes to b at z, to `noise`, certainly was not there before, nor at the other end, far, of its interval;
 * and is beyond b by more than noise before `left`.  leaving, slope: its derivatives at 0 and z, up or down as it goes
 * there; more: what its slope may be off those of the chord; off: at most off its own chord over h; behind: it comes
 * from an end, back: from b */
static int PL(passes)(double sign, double from, double b, double far, double leaving, double slope, double noise,
					  double more, double z, double left, double off, int behind, int back)
{
	if (!(z > 0.0 && z < left)) {
		return 0;
	}
	if (!((left - z) * slope > 2.0 * noise && slope * slope > 16.0 * off * noise)) {
		return 0;
	}
	if (back != 0) {
		return slope > noise + more && -leaving > noise + more && sign * (b - far) - z * z * off > 0.0;
	}
	if (!(slope > noise + more && sign * (b - from) > noise + z * more)) {
		return 0;
	}
	if (behind != 0) {
		return leaving > noise + more && sign * (b - far) > noise + z * more;
	}
	return sign * (from - far) - z * z * off > 0.0;
}

/* About where in 0 .. 1 the cubic with these values and slopes at its ends is 0, no more than a guess.  back: it is 0
 * at the start, and comes back */
static double PL(cubic_zero)(double from, double to, double leaving, double arriving, int back)
{
	const double rise = to - from;
	double c0 = from, c1 = leaving, c2 = 3.0 * rise - 2.0 * leaving - arriving;
	double c3 = leaving + arriving - 2.0 * rise, low = 0.0, high = 1.0, t = -from / rise;
	int k;
	if (!back && leaving > 0.25 * rise && arriving > 0.25 * rise) { /* that of the inverse */
		const double u = 1.0 - t;
		return t * (t * (3.0 - 2.0 * t) + u * (u * (rise / leaving) - t * (rise / arriving)));
	}
	if (back != 0) {
		c0 = c1;
		c1 = c2;
		c2 = c3;
		c3 = 0.0;
		t = 0.5;
	}
	for (k = 0; k < 12; k++) {
		const double at = c0 + t * (c1 + t * (c2 + t * c3)), last = t;
		if (at > 0.0) {
			high = t;
		} else {
			low = t;
		}
		t -= at / (c1 + t * (2.0 * c2 + t * (3.0 * c3)));
		if (!(t > low && t < high)) {
			t = 0.5 * (low + high);
		}
		if (pl_magnitude(t - last) < 1e-5) {
			break;
		}
	}
	return t;
}

/* How far on it is to where a switching function has gained so much, by the inverse series of the polynomial of these
 * derivatives */
static double PL(inverse)(double gain, double slope, double bend, double turn)
{
	const double w = 1.0 / slope, second = 0.5 * w * bend, third = 0.16666666666666666 * w * turn;
	const double z = w * gain;
	return z * (1.0 - z * (second - z * (2.0 * second * second - third)));
}

/* What rounding may do to switching function i beside b; 8 units in the last place of 1, as in the search */
static double PL(noise)(int which, int i, double b, const double x[PL_SIZE])
{
	return PL(most)(PL(slack)[which][i], x) + 1.7763568394002505e-15 * pl_magnitude(b);
}

/* h e' of switching function i */
static double PL(slope)(int which, int i, const double x[PL_SIZE])
{
	return 3.0 * PL(along)(PL_TANGENT[which][i], x);
}

/* Whether switching function i certainly keeps off the ends of its interval over h times `left`, from x to end: by its
 * chord, then by its cubic, which is within its Bezier points.  behind: the end it comes from, or -1; it keeps off that
 * one, b, where (e - b)/s does not come to 0 */
static int PL(keeps)(int region, int which, int i, int behind, const double x[PL_SIZE], const double end[PL_SIZE],
					 double left, double off)
{
	const double from = PL(switching_function)(i, x), to = PL(switching_function)(i, end), two = left * left;
	double low = PL(within)[region][i][0], high = PL(within)[region][i][1], cubic_error;
	if (behind >= 0) {
		const double sign = behind ? -1.0 : 1.0, b = behind ? high : low;
		const double noise = PL(noise)(which, i, b, x), jerk = two * PL(most)(PL(jerk)[which][i], x);
		if (!(sign * PL(slope)(which, i, x) > noise + jerk && sign * (to - b) > noise + left * jerk)) {
			return 0;
		}
		if (behind != 0) {
			high = PL_OPEN_END;
		} else {
			low = -PL_OPEN_END;
		}
	}
	if (PL(between)(low, high, from, to, two * off)) {
		return 1;
	}
	cubic_error = two * two * PL(sizes)(PL_CUBIC_ERROR[which][i], x);
	return PL(between)(low, high, from, to, cubic_error) &&
		   PL(between)(low, high, from + left * PL(along)(PL_TANGENT[which][i], x),
					   to - left * PL(along)(PL_TANGENT[which][i], end), cubic_error);
}

/* Whether it surely meets the lower or the upper end at y, after h times z, and none before; and passes it by more than
 * rounding before h times `left` */
static int PL(meets)(int region, int which, int i, int up, int behind, const double x[PL_SIZE],
					 const double y[PL_SIZE], double z, double left, double off)
{
	const double sign = up ? 1.0 : -1.0, b = PL(within)[region][i][up];
	const double noise = PL(noise)(which, i, b, x), zz = z * z;
	const double more = behind == up ? 4.0 * z * zz * PL(sizes)(PL_CUBIC_ERROR[which][i], x)
									 : zz * PL(most)(PL(jerk)[which][i], x);
	return pl_magnitude(PL(switching_function)(i, y) - b) <= noise &&
		   PL(passes)(sign, PL(switching_function)(i, x), b, PL(within)[region][i][!up],
				sign * PL(slope)(which, i, x),
					  sign * PL(slope)(which, i, y), noise, more, z, left, off, behind >= 0,
							behind == up);
}

/* About where it is b, from x to end over h times `left`; back: it comes from b */
static double PL(guess)(int which, int i, double sign, double b, int back, const double x[PL_SIZE],
						const double end[PL_SIZE], double left)
{
	return left * PL(cubic_zero)(sign * (PL(switching_function)(i, x) - b),
			sign * (PL(switching_function)(i, end) - b),
				 sign * left * PL(slope)(which, i, x), sign * left * PL(slope)(which, i, end), back);
}

/* Moves x on to y, where it is b, near h times z; returns z.  From what is gained since x: of e - b itself more is
 * lost */
static double PL(reach)(int which, int i, double b, const double x[PL_SIZE], double z, double y[PL_SIZE])
{
	double d[3][PL_SIZE], gain[PL_SIZE];
	const double far = b - PL(switching_function)(i, x);
	int j, k;
	PL(move)(which, x, z, gain);
	for (k = 0; k < 4; k++) {
		double step;
		for (j = 0; j < PL_SIZE; j++) {
			y[j] = x[j] + gain[j];
		}
		PL(turn_once)(which, y, d[0]);
		PL(turn_once)(which, d[0], d[1]);
		PL(turn_once)(which, d[1], d[2]);
		step = PL(inverse)(far - PL(switching_function)(i, gain), PL(switching_function)(i, d[0]),
						   PL(switching_function)(i, d[1]),
						   PL(switching_function)(i, d[2]));
		z += step;
		if (pl_magnitude(step) < 1e-4) {
			for (j = 0; j < PL_SIZE; j++) {
				y[j] = x[j] + (gain[j] + step * (d[0][j] + step * (0.5 * d[1][j] + step *
							   (0.16666666666666666 * d[2][j]))));
			}
			return z;
		}
		if (!(pl_magnitude(step) < 1.0)) {
			break;
		}
		PL(move)(which, y, step, d[0]);
		for (j = 0; j < PL_SIZE; j++) {
			gain[j] += d[0][j];
		}
	}
	return 2.0;
}

/* x on over a part of the step, of h 1: to `end`, or by the same polynomial in two words */
static void PL(go)(int which, double part, double x[PL_VECTOR], const double end[PL_SIZE])
{
#if PL_COMPENSATED
	double work[PL_SWITCHING_COMPENSATED_WORK(PL_SIZE, PL_SWITCHING_FUNCTIONS, PL_MOVES)];
	pl_switching_compensated_move(&PL(switching), which, PL_MOVES, part * PL_H, x, work);
	(void)end;
#else
	int i;
	for (i = 0; i < PL_SIZE; i++) {
		x[i] = end[i];
	}
	(void)which;
	(void)part;
#endif
}

/* The first crossing: 1, and moves on to it; 0: there is none in this length; -1: that is not certain, and may be so of
 * less; -2: nor of less */
static int PL(first)(PL(subinterval) *p, double x[PL_VECTOR], const double end[PL_SIZE], pl_crossing *crossing)
{
	double off[PL_SWITCHING_FUNCTIONS], y[PL_SIZE], z = 2.0;
#if PL_SWITCHING_FUNCTIONS > 1
	int undecided[PL_SWITCHING_FUNCTIONS];
#endif
	int i, near = 0, first = 0, up = 0, behind, next;
	PL(bounds)(p->which, x, off);
	for (i = 0; i < PL_SWITCHING_FUNCTIONS; i++) {
		const double *const within = PL(within)[p->region][i];
		const double from = PL(switching_function)(i, x), to = PL(switching_function)(i, end);
		const int above = to > within[1];
		double about;
		behind = i == p->passed ? p->behind : -1;
		if (behind < 0 && !(from > within[0] && from < within[1])) {
			return -2;
		}
		if (!above && !(to < within[0])) {
			if (!PL(keeps)(p->region, p->which, i, behind, x, end, p->length, off[i])) {
				return -1;
			}
			continue;
		}
		about = PL(guess)(p->which, i, above ? 1.0 : -1.0, within[above], behind == above, x, end, p->length);
#if PL_SWITCHING_FUNCTIONS > 1
		undecided[near] = i;
#endif
		near++;
		if (about < z) {
			z = about;
			first = i;
			up = above;
		}
	}
	if (near == 0) {
		return 0;
	}
	next = PL(beyond)[p->region][first][up];
	behind = first == p->passed ? p->behind : -1;
	if (next < 0) {
		return -2;
	}
	z = PL(reach)(p->which, first, PL(within)[p->region][first][up], x, z, y);
	if (!PL(meets)(p->region, p->which, first, up, behind, x, y, z, p->length, off[first])) {
		return -1;
	}
#if PL_SWITCHING_FUNCTIONS > 1
	for (i = 0; i < near; i++) { /* others that are passed, but later */
		const int other = undecided[i];
		behind = other == p->passed ? p->behind : -1;
		if (other != first && !PL(keeps)(p->region, p->which, other, behind, x, y, z, off[other])) {
			return -1;
		}
	}
#endif
	PL(go)(p->which, z, x, y);
	PL(next_subinterval)(p, z, next, PL(matrix)[next], first, !up);
	crossing->time = p->done * PL_H;
	crossing->expression = first;
	crossing->breakpoint = PL(span)[next][first] - up;
	crossing->upward = up;
	return 1;
}

/* s over h: 1.  Else 0, and nothing has changed. Part by part; a part that is not certain is halved. */
static PL_APART int PL(cross)(PL_TYPE *s, const double now[PL_VECTOR])
{
	pl_crossing crossing[PL_FEW];
	PL(subinterval) part = {0.0, 1.0, 1.0, 0, 0, -1, -1};
	double x[PL_VECTOR], end[PL_SIZE];
	int i, look, count = 0;
	for (i = 0; i < PL_VECTOR; i++) {
		x[i] = now[i];
	}
	part.region = s->contact PL_PART.region;
	part.which = s->contact PL_PART.matrix;
	if (!(PL(size_of)(x) < PL_LARGE)) {
		return 0;
	}
	PL(advance)(part.which, x, end);
	for (look = 0; look < PL_EVENT_CHECKS; look++) {
		int found = -2;
		if (PL(size_of)(end) < PL_LARGE && count < PL_FEW) {
			found = PL(first)(&part, x, end, &crossing[count]);
		}
		if (found == -2) {
			return 0;
		}
		if (found == 0 && part.length == part.left) {
			break;
		}
		if (found == -1) {
			part.length *= 0.5;
		} else if (found == 1) {
			count++;
		} else {
			PL(go)(part.which, part.length, x, end);
			PL(next_subinterval)(&part, part.length, part.region, part.which, -1, -1);
		}
		PL(move)(part.which, x, part.length, end);
		for (i = 0; i < PL_SIZE; i++) {
			end[i] += x[i];
		}
	}
	if (look == PL_EVENT_CHECKS) {
		return 0;
	}
#if PL_COMPENSATED
	PL(go)(part.which, part.length, x, end);
	for (i = 0; i < PL_STATES; i++) {
		s->y[PL_PLACE(i)] = x[i];
		s->low[PL_PLACE(i)] = x[PL_SIZE + i];
	}
#else
	for (i = 0; i < PL_STATES; i++) {
		s->y[PL_PLACE(i)] = end[i];
	}
#endif
	for (i = 0; i < count; i++) {
		s->crossing PL_PART[i] = crossing[i];
	}
	s->contact PL_PART.crossings = count;
	s->contact PL_PART.total += (uint64_t)count;
	s->contact PL_PART.region = part.region;
	s->contact PL_PART.matrix = part.which;
	return 1;
}
