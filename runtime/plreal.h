/* SPDX-License-Identifier: MIT-0 */
/* plreal.h: what plrt.h has of double and, by other names (floats.h), of float: it includes this for each PL_REAL.  In
 * floats DBL_EPSILON is FLT_EPSILON. */

/* ---- series.c: between two steps ------------------------------------------------------------------------- */

/* x' = A x, to be advanced by a Taylor polynomial of e^{A tau} on 2^halvings equal parts of tau.  The generator chooses
 * degree and halvings for 0 <= tau <= h.  With |pole| h / 2^halvings <= 1 for every pole, those of loads included, and
 * degree 15 + d, in floats 8 + d, d the longest way from one entry to another along nonzero entries of A, the error of
 * x_i stays below 8 DBL_EPSILON sum_j most_ij |x_j|, most_ij the largest |Phi_ij| of e^{A tau} on 0 .. h (measured for
 * |pole| h up to 8: 7.4 in 200 damped and undamped chains, half of them below 1.7; in floats 6.7 in eleven). */
typedef struct pl_series {
    int size;        /* entries of x */
    int states;      /* of which the first are the model's own states; the others carry loads and inputs */
    int degree;      /* of the Taylor polynomial, >= 1 */
    int halvings;    /* 0 .. 30 */
    const PL_REAL *A; /* size x size, row-major, [1/s] */
} pl_series;

/* x <- e^{A tau} x, tau in seconds; all `size` entries.  work: 2 size numbers, contents of no meaning. */
void pl_series_advance(const pl_series *p, PL_REAL tau, PL_REAL *x, PL_REAL *work);

/* ---- power.c: many steps at once ------------------------------------------------------------------------- */

/* A number in two words, hi + lo, |lo| <= half a unit in the last place of hi (106 bits, in floats 48). */
typedef struct pl_two {
    PL_REAL hi, lo;
} pl_two;

/* x <- P^k x by binary powering in two-word arithmetic; P is n x n, row-major.  The relative error is about k 2^-104,
 * in floats k 2^-46, where a term below 2^-102 loses bits of its low word to underflow.
 * P is destroyed; x: n entries, which k = 0 leaves as they are; W, w: work, n x n and n entries.  A result beyond the
 * range of double is an infinity with lo = 0; no NaN comes out of finite arguments.  Once an entry of a power of P has
 * itself overflowed, what it reaches is infinite, and its sign means nothing. */
void pl_power_apply(int n, pl_two *P, pl_two *W, pl_two *x, pl_two *w, uint64_t k);

/* ---- sums whose rounding is kept: the forms of --accuracy compensated ------------------------------------------ */

/* sum + term + (small + *rest), rounded; *rest becomes what that rounding took.  The first sum's error is exact
 * (Knuth's TwoSum: no condition on sizes); `small` and *rest, of the size of roundings, are added to it and not to
 * `term`, where they would be lost. */
static inline PL_REAL pl_accumulate(PL_REAL sum, PL_REAL term, PL_REAL small, PL_REAL *rest)
{
    const PL_REAL whole = sum + term, part = whole - sum;
    const PL_REAL error = ((sum - (whole - part)) + (term - part)) + (small + *rest), result = whole + error;
    *rest = error - (result - whole);
    return result;
}

/* ---- root.c: lengths of steps --------------------------------------------------------------------------- */

/* The n-th root of a, a normal number above 0, n >= 1, within 6 %: without pow, and the same bits on every target. */
PL_REAL pl_root(PL_REAL a, int n);

/* ---- dense.c: linear equations -------------------------------------------------------------------------- */

/* A, n x n, row-major, by Gauss' elimination with partial pivoting, in place: 1, or 0 where it is singular or not a
 * number comes out.  Complex: real and imaginary part side by side. */
int pl_factor(int n, PL_REAL *A, int *pivot);
int pl_factor_complex(int n, PL_REAL *A, int *pivot);

/* x <- A^-1 x, A and pivot as the other has left them. */
void pl_solve(int n, const PL_REAL *A, const int *pivot, PL_REAL *x);
void pl_solve_complex(int n, const PL_REAL *A, const int *pivot, PL_REAL *x);

/* ---- until.c: when a load changes ------------------------------------------------------------------------- */

/* change - (t0 + k h) [s], off by less than 2^-100 of the largest of change, t0 and k h, and rounded; in floats by less
 * than 2^-45 of it (2^-46.5 measured over 9 10^5).  k counts in full up to 2^63. */
PL_REAL pl_until(PL_REAL t0, uint64_t k, pl_two h, pl_two change);

/* ---- peak.c: the largest size of an output --------------------------------------------------------------- */

#define PL_PEAK_WORK(size) (PL_PEAK_SPACE * (size)) /* reals that these work in */

/* The larger of `peak` and |row . x(tau)|, 0 <= tau <= h, where x' = A x from x on, of `size` entries, and row . x(h)
 * is known to be `end`.  bend . |x| bounds how far row . x(tau) is off its chord, so most steps are clear at once; else
 * every extreme of its Taylor polynomial is found.  Not a number once the output is none. */
PL_REAL pl_peak(int size, const PL_REAL *A, const PL_REAL *row, const PL_REAL *bend, PL_REAL h, const PL_REAL *x,
                PL_REAL end, PL_REAL peak, PL_REAL *work);

/* That bound: h^2/8 times what |row A^2 e^{A tau}| is at most, entry by entry */
void pl_peak_bend(int size, const PL_REAL *A, const PL_REAL *row, PL_REAL h, PL_REAL *bend, PL_REAL *work);

/* The same of an output of which values inside a step are all that is known: its caller is asked for them.  They are
 * taken at halves, quarters, ... of the step, down to PL_PEAK_TIMES, until second differences say that nothing passes
 * the peak or that a parabola stands for what is between three of them; then each top that may pass it is searched by
 * Brent's method, which kinks and jumps only make slower. */
#define PL_PEAK_TIMES 64
typedef struct pl_peak_values {
    PL_REAL peak;                      /* so far */
    PL_REAL value[PL_PEAK_TIMES + 1];
    PL_REAL at;                        /* where a value was asked for */
    PL_REAL a, b, s[3], size[3];       /* a top is between a and b; the best three times there, their sizes */
    PL_REAL moved, before;
    int apart, time, top, tries;
} pl_peak_values;

/* begin, end: the values at both ends.  Where in the step, 0 to 1, the next is asked for; below 0: l->peak is found */
PL_REAL pl_peak_begin(pl_peak_values *l, PL_REAL begin, PL_REAL end, PL_REAL peak);
PL_REAL pl_peak_next(pl_peak_values *l, PL_REAL value);

/* ---- apply.c: matrices times vectors ----------------------------------------------------------------------- */

/* y = table x; table is rows x columns, row-major; x has `columns` entries, y `rows`.  y overlaps neither x nor table.
 * Without columns y is 0.  Each row is summed in one order, whatever the sizes and the row's place: four sums, of the
 * columns m, m + 4, m + 8, ... upwards from 0 for m = 0 .. 3, then (s_0 + s_2) + (s_1 + s_3).  Off by less than
 * (columns/4 + 4) DBL_EPSILON/2 sum_j |a_j x_j| where nothing overflows or underflows. */
void pl_multiply(int rows, int columns, const PL_REAL *table, const PL_REAL *x, PL_REAL *y);

/* y += table x: that sum of each row first, then y and it. */
void pl_multiply_add(int rows, int columns, const PL_REAL *table, const PL_REAL *x, PL_REAL *y);

/* PL_NOT_FINITE if an entry of y is infinite or not a number, else 0; n entries.  By their bits: no compiler that takes
 * all numbers for finite can leave it out, and it raises no exception. */
int pl_not_finite(const PL_REAL *y, int n);

/* ---- crossings.c: piecewise-linear models ------------------------------------------------------------------- */

/* x' = A x with another constant A in each region.  x holds the model's own states, then what carries its loads (1, t,
 * cos w t, ...) and inputs, so that between two crossings nothing is approximated.  Switching expressions
 * e_i = row_i . x, each with breakpoints b_i0 < b_i1 < ..., are in interval 0 below b_i0, in 1 between b_i0 and b_i1,
 * ...; a region is one of each: interval_0 + (breaks_0 + 1) (interval_1 + (breaks_1 + 1) (interval_2 + ...)).
 *
 * A rounding error of e against a breakpoint b is taken to be 8 DBL_EPSILON (sum_j |row_j x_j| + |b| + how far e moves
 * in the time looked at).  What passes b by less is no crossing; what passes by more is found, whatever the step. */
/* Of each matrix whose poles turn far in h: the lengths that pieces of a step have, rung by rung.  Rung 0 is as short
 * as h / 2^halvings, the next ones are 2^spacing times as long each, and beyond the last of them, which is shorter than
 * h, comes h itself.  A step goes by the longest that are seen to stay clear, so that few pieces round what is slow. */
typedef struct pl_ladder {
    const int *first;   /* the number of its rung 0 among those of all */
    const int *spacing; /* 1 .. 30 */
    /* Of each rung size + 1 rows of `size`: x_i goes on to row_i . x, and where the last row has 1 at i, not 0, x_i is
     * added: there row_i is of e^{A d} - I, each entry rounded relative to itself. */
    const PL_REAL *pieces;
    /* In a piece of the rung after this one an expression, or a row of guards, is off the chord through its ends by at
     * most reach . |x''(0)|: of each matrix its rungs for the first expression, for the second; ... */
    const PL_REAL *reach;
    const int *guard_rows; /* of each row of guards: the number of the first of its rows of reach; else not read */
} pl_ladder;

typedef struct pl_switching {
    int size;           /* entries of x */
    PL_REAL h;          /* step [s] */
    int switches;       /* expressions */
    const PL_REAL *row; /* switches x size: e = row . x */
    const int *breaks;  /* of each switch: how many breakpoints, >= 1 */
    const PL_REAL *at;  /* the breakpoints: those of switch 0, rising; those of switch 1; ... */
    const int *matrix;  /* of each region: the number of its A; -1: cannot occur, and passed through in no time */
    /* Of each matrix: crossings are looked for in pieces d = h / 2^halvings or shorter.  Tables for switches are
     * switches x size. */
    const int *halvings; /* 0 .. 30: |pole| d is about 1 or below */
    const PL_REAL *A;    /* size x size, row-major [1/s] */
    const PL_REAL *Phi;  /* e^{A h}: the step where nothing is crossed */
    pl_ladder ladder;    /* shorter pieces; not read where halvings are 0 */
    const PL_REAL *tangent; /* d/3 row . A, so that tangent . x = d/3 e' */
    /* On 0 .. d, e is off the chord through its ends by at most chord_error . |x(0)|: d^2/8 max|e''|, and off the cubic
     * through its ends with its slopes there by at most cubic_error . |x(0)|: d^4/384 max|e''''| */
    const PL_REAL *chord_error, *cubic_error;
    /* of Taylor polynomials of e^{A tau} on 0 .. d, >= 3: as for pl_series, less where |pole| d is small */
    int degree;
    int max_events, max_splits; /* per step: crossings, and halvings of an interval in search of them */
} pl_switching;

typedef struct pl_crossing {
    PL_REAL time;                      /* after the start of the step [s] */
    int expression, breakpoint, upward; /* upward: e rises through it */
} pl_crossing;

/* How many doubles, or floats, of work the functions below need; contents of no meaning. */
#define PL_SWITCHING_WORK(size, switches, degree) (((degree) + 1) * ((size) + 2) + 5 * (size) + 5 * (switches))

/* The region of x, no crossings, status 0.  Exactly on a breakpoint the sign of e' decides, then of e'', then of e''';
 * what rests there counts as below. */
void pl_switching_start(const pl_switching *m, const PL_REAL *x, pl_contact *c, PL_REAL *work);

/* x, `size` entries, over h, with every crossing on the way, max_events of them at most, in order.  A step that is seen
 * to have none is Phi x, to the last bit.  Loads may be set anew before each step, and inputs may jump: an expression
 * that has left its interval by that passes its breakpoints at time 0.  work: PL_SWITCHING_WORK(size, switches, degree)
 *
 * Beyond max_events or max_splits: PL_TOO_MANY_EVENTS.  Then a last crossing is passed but not listed; pieces that are
 * seen to stay clear go on as ever; the first other one goes by e^{A d} of the region where x is, d at most
 * h / 2^halvings, in which no mode of another region grows by more than about e, and behind it x is held to the end of
 * the step.  The next step starts in the region of x.  An x that is not finite sets no bit here: ask pl_not_finite. */
void pl_switching_step(const pl_switching *m, PL_REAL *x, pl_contact *c, pl_crossing *crossing, PL_REAL *work);

/* The same over tau, 0 <= tau <= h. */
void pl_switching_advance(const pl_switching *m, PL_REAL tau, PL_REAL *x, pl_contact *c, pl_crossing *crossing,
                          PL_REAL *work);

/* The same with what rounding takes from x kept: x is `size` entries and then their rests, so that x + rest is what is
 * meant.  m->A, m->Phi and the rungs, which are e^{A d} - I, have two words: of each size x size first ones and then as
 * many second ones.  Crossings are those of x. */
#define PL_SWITCHING_COMPENSATED_WORK(size, switches, degree) (PL_SWITCHING_WORK(size, switches, degree) + 2 * (size))
void pl_switching_compensated_start(const pl_switching *m, const PL_REAL *x, pl_contact *c, PL_REAL *work);
void pl_switching_compensated_step(const pl_switching *m, PL_REAL *x, pl_contact *c, pl_crossing *crossing,
                                   PL_REAL *work);
void pl_switching_compensated_advance(const pl_switching *m, PL_REAL tau, PL_REAL *x, pl_contact *c,
                                      pl_crossing *crossing,
                               PL_REAL *work);

/* x on by dt, 0 <= dt <= h, with one of its matrices by a Taylor polynomial of this degree, whatever it passes. */
void pl_switching_compensated_move(const pl_switching *m, int matrix, int degree, PL_REAL dt, PL_REAL *x,
                                   PL_REAL *work);

/* Formulas that the state chooses beside a Taylor series: expressions e_i, each with breakpoints as above, whose series
 * stand in columns of its coefficients c, (degree + 1) x columns, in powers of time.  Between two crossings the
 * formulas are those of the intervals; c is made with them.  terms: of each expression the sizes of what its value at
 * the start is summed from, which bound what rounding may have done to it; as above what passes b by less is no
 * crossing. */
typedef struct pl_divided {
    int expressions, columns, degree;
    const int *column;  /* of each expression */
    const int *breaks;  /* of each how many breakpoints, >= 1 */
    const PL_REAL *at;  /* those of expression 0, rising; of expression 1; ... */
} pl_divided;

#define PL_DIVIDED_WORK(degree) (2 * ((degree) < 3 ? 4 : (degree) + 1)) /* numbers that pl_divided_next works in */

/* The interval of each expression at the start, exactly on a breakpoint by the first derivative that is not 0; what
 * rests there counts as below.  1: some are others than before, and c may be another one. */
int pl_divided_place(const pl_divided *m, const PL_REAL *c, const PL_REAL *terms, int *interval);

/* What starts on the breakpoint above its interval and soon is beyond it by more than rounding, along c of which the
 * unit of time is the step, goes there: 1, some does */
int pl_divided_rises(const pl_divided *m, const PL_REAL *c, const PL_REAL *terms, int *interval);

/* Whether an expression is outside of its interval by more than rounding: crossing receives which, and where; before
 * that the last crossing, expression -1: none, which need not be left behind yet. */
int pl_divided_left(const pl_divided *m, const PL_REAL *c, const PL_REAL *terms, const int *interval,
                    pl_crossing *crossing);

/* When, until `end`, in the unit of time of c, an expression first leaves its interval; -1: none does.  Searched as
 * above: no root of a polynomial is stepped over; *splits < 0 afterwards: it took too many halvings. */
PL_REAL pl_divided_next(const pl_divided *m, const PL_REAL *c, const PL_REAL *terms, const int *interval, PL_REAL end,
                        int *splits, pl_crossing *crossing, PL_REAL *work);

/* ---- events.c: impacts, contacts at rest and dry friction beside a Taylor series ------------------------------- */

/* As pl_divided; an expression may have the same breakpoint twice, and in the interval between it is held: by friction
 * that sticks, by a contact at rest.  Beside the expressions stand watches, columns of c too, of which each has its
 * entry of terms behind those of the expressions: velocities, what would let go, what a state is after a jump.
 *
 * An impact, where an expression passes a breakpoint.  One with a hold is a bounce: it turns the speed of its guard, s
 * to -restitution s. */
typedef struct pl_event_impact {
    int expression, breakpoint, upward;
    int hold;               /* in which its contact rests; -1: it is no bounce */
    int place, speed;       /* watches: how far the guard is beyond 0, its rate */
    int jump, still, jumps; /* assignments, so many from there on: its own; those with restitution 0 */
    PL_REAL restitution;
    PL_REAL per; /* of the expression for a guard of 1 */
} pl_event_impact;

typedef struct pl_events {
    const pl_divided *divided;
    int states;
    const int *watch; /* the column of each */
    int holds;        /* at most 32 */
    const pl_hold *hold;
    const PL_REAL *back; /* holds x states: what is taken from a state for a velocity of 1 */
    int impacts;        /* at most 32, in the order in which they act at one instant */
    const pl_event_impact *impact;
    const PL_REAL *place_back; /* impacts x states: likewise for a guard of 1 */
    const int *state, *value; /* assignments: a state is set to a watch */
    int conflicts;
    const pl_conflict *conflict;
    PL_REAL h;                /* step [s], the unit of time of c */
    int max_events;
} pl_events;

/* Impacts that follow each other in a step.  last: when the last one was; most: the fastest of those that follow each
 * other in no time to speak of, close: so many they are; least: a speed that is but rounding of forces over a step;
 * impacts: at this instant, acting: those that acted of late, as bits, ended: how often they were ended; all: events of
 * the step; full: there is no more room */
typedef struct pl_chain {
    PL_REAL last, most, least;
    uint32_t acting;
    int close, impacts, ended, all, full;
} pl_chain;

/* Where a series begins, and how it is made anew. */
typedef struct pl_instant {
    void (*expand)(const void *from, const int *interval, const PL_REAL *y, PL_REAL *c, PL_REAL *terms);
    const void *from;
    PL_REAL *y, *rest;  /* the states, what rounding took from them; one that is set has no rest */
    PL_REAL *c, *terms;
    PL_REAL *work;      /* PL_DIVIDED_WORK */
    PL_REAL unit;       /* of time of c, in h */
    int *interval;      /* of each expression */
    uint64_t *total;    /* crossings */
    int *crossings;     /* in this step */
    int *rested;        /* contacts that came to rest by infinitely many bounces */
    pl_crossing *crossing, *last;
    PL_REAL time;       /* after the start of the step [s] */
    pl_crossing next;   /* the event that pl_events_next has found, */
    int starting, freed; /* the impact that begins there, the hold that lets go; -1: none */
    int crossed, was;   /* the expression that passed a breakpoint there, or -1; its interval before */
    int unlisted;       /* 1: what happens is not listed */
    int status;         /* 0, PL_UNDECIDED, PL_TOO_MANY_EVENTS, PL_PENETRATED */
    pl_chain chain;     /* none yet: last is -h, else 0 */
} pl_instant;

/* The intervals of a state that was set.  What is on a breakpoint that stands twice is held where that can be, else
 * goes where it is heading. */
void pl_events_place(const pl_events *m, pl_instant *at);

/* The series from here.  1: an expression or what is held has left its interval, and that has been passed; -1: there
 * were too many; 0: neither.  What is held and has moved by rounding is put back. */
int pl_events_begin(const pl_events *m, pl_instant *at);

/* When, until `end`, the first event comes, as pl_divided_next; size, in and out: how far the series goes without one,
 * shorter behind a bounce that comes back soon. */
PL_REAL pl_events_next(const pl_events *m, pl_instant *at, PL_REAL *size, int *splits);

/* That event: at->y is the state there.  0: there were too many.  Several at one instant as pl_guards_advance says. */
int pl_events_pass(const pl_events *m, pl_instant *at);

/* Whether an expression or what is held has left its interval where c begins, which is made, as pl_events_begin says */
int pl_events_left(const pl_events *m, pl_instant *at);

/* at->next is this event, met by a search like that of pl_events_next; of what is held it lets go. */
void pl_events_meet(const pl_events *m, pl_instant *at, const pl_crossing *event);

/* How far the series at->c, which is made, serves without an event, at most until `end`; 0: not even from here */
PL_REAL pl_events_end(const pl_events *m, pl_instant *at, PL_REAL end, int *splits);

/* PL_PENETRATED where the series is beyond the guard of a bounce by more than rounding and `least`, s on; else 0 */
int pl_events_places(const pl_events *m, const pl_instant *at, PL_REAL s, PL_REAL least);

/* ---- guards.c: piecewise-linear models whose velocity is held at times, and that jump -------------------------- */

/* As pl_switching, with events of their own in each region.  x' = A x; a guard is a row that must not become greater
 * than its limit: where it does, x jumps, and goes on in another region.  An expression may have the same breakpoint
 * twice: in the interval between it is held there, as by friction that sticks, and states that follow from others are
 * set from them, exactly: x_i = row . x.
 *
 * The state jumps where the guard comes true.  One that turns the speed of its guard, s to -restitution s, is a bounce;
 * its contact may rest, in the interval between two equal breakpoints. */
typedef struct pl_impact {
    int expression, breakpoint, upward; /* as a crossing of it is listed */
    int rest;                           /* that interval; -1: it is no bounce */
    int jump, still;                    /* sets of assignments: its jump; of a bounce that with restitution 0 */
    PL_REAL restitution;
    PL_REAL amplitude;                  /* the sizes of the factors of cos and sin in its speed */
} pl_impact;

typedef struct pl_guards {
    int size;          /* entries of x */
    PL_REAL h;         /* step [s] */
    int switches;      /* expressions */
    const PL_REAL *row; /* switches x size: e = row . x */
    const int *breaks; /* of each expression: how many breakpoints */
    const PL_REAL *at; /* the breakpoints: those of the first, not falling; those of the second; ... */
    const int *matrix; /* of each region: the number of its A; -1: it cannot be */
    /* Of each matrix, as for pl_switching: */
    const int *halvings;
    const PL_REAL *A, *Phi;
    pl_ladder ladder;
    const PL_REAL *tangent; /* switches x size */
    /* Of each region: its guards are guard[first[region]] to guard[first[region + 1] - 1]; hold is the set of
     * assignments that holds its states, or -1 */
    const int *first;
    const pl_guard *guard;
    const PL_REAL *limit; /* of each guard */
    const int *hold;
    /* Rows of guards, of each: d/3 times its slope; bounds as for pl_switching.  All rows x size */
    const PL_REAL *guard_row, *guard_tangent, *chord_error, *cubic_error;
    /* Of each expression and each row of guards: the sizes of its factors of cos and sin, to tell rounding from what
     * is more where these are evaluated anew */
    const PL_REAL *amplitude, *guard_amplitude;
    /* Assignments: x[state] = value . x, those of a set from the same x: set[k] to set[k + 1] - 1 */
    const int *set, *state;
    const PL_REAL *value;
    int impacts; /* at most 30, in the order in which they act at one instant */
    const pl_impact *impact;
    /* impacts x size, of those that bounce: the speed of the guard; what times e - b is taken from x to be on it */
    const PL_REAL *speed, *back;
    int degree;
    int max_events, max_splits;
} pl_guards;

#define PL_GUARDS_WORK(size, degree) (((degree) + 1) * ((size) + 2) + 11 * (size))

/* The region of x, as pl_switching_start; what is on a breakpoint that stands twice sticks where that can be. */
void pl_guards_start(const pl_guards *m, const PL_REAL *x, pl_contact *c, PL_REAL *work);

/* x over tau, 0 <= tau <= h, as pl_switching_advance.  Where several stick or slip at one event, the combination is
 * taken in which all of them agree: none is held by more than its guard lets it, and each that slips moves away in its
 * direction; of several the one with the fewest changes, then with most that stick.
 *
 * Impacts at one instant act in their order, each from the state that the one before has left, and again from the
 * first, until none is on its guard and comes closer; what is slower than 2^-48 of the fastest (float: 2^-20) is over,
 * and rests; so does, with e < 1, what still acts after 1000 of them.  The first 12 are listed; once the list is half
 * full, of those within 2^-10 h (float: 2^-8).  Behind a bounce that leaves with the velocity v and is pressed back by
 * the acceleration a, all further ones take T = 2 v/(a (1 - e)): where T <= PL_BRIEF h, e < 1, it rests, listed T
 * later; where the list of crossings is full but for a few, where T <= 2^-10 h (float: 2^-8).  Several that touch
 * and strike each other rest together where that holds of each with the largest a, or their bounces are lower than
 * rounding, and all are pressed then.  Speeds of what comes to rest go by impacts with e = 0, so momentum stays.
 * What rests is held until it would have to be pulled.  Impacts with e < 1 go on beyond the list, to 65536 events in
 * a step.  What rounding has taken beyond a bounce is still before it; PL_PENETRATED: at the end of a step it is
 * there by more. */
void pl_guards_advance(const pl_guards *m, PL_REAL tau, PL_REAL *x, pl_contact *c, pl_crossing *crossing,
                       PL_REAL *work);

/* At this time [s] of a step: behind loads that have changed their formula, in the region of the same intervals, which
 * m is of now.  What has left its interval by a jump of a load passes its breakpoints, in the order of expressions, and
 * no impact begins there; then what touches and comes closer bounces, and what is at rest is decided anew. */
void pl_guards_change(const pl_guards *m, PL_REAL time, PL_REAL *x, pl_contact *c, pl_crossing *crossing,
                      PL_REAL *work);

/* The same with what rounding takes from x kept, as pl_switching_compensated_step: m->value is of each assignment
 * `size` first words and then as many second ones. */
#define PL_GUARDS_COMPENSATED_WORK(size, degree) (PL_GUARDS_WORK(size, degree) + 2 * (size))
void pl_guards_compensated_start(const pl_guards *m, const PL_REAL *x, pl_contact *c, PL_REAL *work);
void pl_guards_compensated_advance(const pl_guards *m, PL_REAL tau, PL_REAL *x, pl_contact *c, pl_crossing *crossing,
                            PL_REAL *work);
void pl_guards_compensated_change(const pl_guards *m, PL_REAL time, PL_REAL *x, pl_contact *c, pl_crossing *crossing,
                           PL_REAL *work);

/* ---- retune.c: coefficients from other params --------------------------------------------------------------- */

/* W a = R x: equations of highest derivatives a over the states and what acts on them, x.  Where every mass that
 * params change stands alone the generator has divided by it, and there is no W. */
typedef struct pl_equations {
    unsigned short rows;    /* entries of a */
    unsigned short columns; /* entries of x */
    unsigned short solves;  /* 1: there is a W, rows x rows, its columns behind those of R; 0: it is the unit matrix */
    unsigned short params, constants;
    int operations, places;
    const pl_two *constant;
    const pl_operation *operation;
    const pl_place *place; /* of what is not 0 */
} pl_equations;

/* value <- W^-1 R at these params, in two words: row i from value[i width] on, width = columns + (solves ? rows : 0);
 * what is behind `columns` has no meaning.
 *     value  rows x width; work: as many entries as there are operations, contents of no meaning
 * 0; PL_SINGULAR: W has no inverse, or nothing but rounding says that it has one, or a divisor is 0; PL_NOT_FINITE:
 * a param or a result is infinite, or not a number.  An operation is off by less than 2^-103 (in floats 2^-45) of
 * its result, sums and differences of the sizes of both numbers; what so much cancels that rounding alone could have
 * left it is 0.  Without W an entry that is a sum of products is off by less than 2^-101 (in floats 2^-43) of the
 * sizes of its terms, summed; with W that of row i, column j by less than 2^-101 of sum_k |W^-1|_ik times the
 * largest, over rows, of the sizes of all terms in W a - R x for column j. */
int pl_equations_at(const pl_equations *e, const PL_REAL *params, pl_two *value, pl_two *work);

/* D <- e^{A tau} - I, its first `states` rows, tau in seconds.
 *     A      size x size, row-major [1/s]; 0 below the first `states` rows and left of column `states`: what acts on
 *            the states does not depend on them
 *     D      states x size; the low words are 0 where one word was enough; words 2: two in any case
 *     work   PL_INCREMENT_WORK(size) entries, contents of no meaning
 * 0, or PL_NOT_FINITE and D has no meaning; so it ends too where |A| tau is beyond 2^64, or 2^32 in floats.  |A| is a
 * norm that knows no units, as a rule at most twice the largest pole or frequency of a load.  In the first `states`
 * columns no entry is off by more than 16 units in the last place of the largest of all these, in each other column of
 * the largest in it, for |A| tau up to 2^20 and where that largest is above 2^-900; in floats up to 2^10, above 2^-100.
 */
int pl_increment(int size, int states, const pl_two *A, PL_REAL tau, int words, pl_two *D, pl_two *work);
#define PL_INCREMENT_WORK(size) (6 * (size) * (size))

/* A ramp that is u in column `column` of D and u' in the next acts by its value after the step with D_{u'} / h, and by
 * that before with D_u - D_{u'} / h.  1: so much of that cancels that one word is not enough.  D: states x size */
int pl_ramp_cancels(int size, int states, const pl_two *D, int column, PL_REAL h);

/* whole - slope / h, rounded: that difference */
PL_REAL pl_ramp_before(pl_two whole, pl_two slope, PL_REAL h);

/* ---- retune.h: coefficients of a step, independent block by independent block --------------------------------- */

/* An entry of A in x' = A x */
typedef struct pl_entry {
    unsigned short row, column;
    pl_two value;
} pl_entry;

/* A block that no state outside acts on: x is its states, the load states that act on it, the inputs that do. */
typedef struct pl_block {
    /* of its highest derivatives, and in further rows frequencies of its loads, in column 0; over its states, the load
     * states in each segment of time, the inputs */
    pl_equations equations;
    unsigned short states, loads, inputs; /* entries of x */
    unsigned short segments;      /* of time, in which loads have formulas of their own */
    unsigned short derivatives;   /* the first rows of the equations, */
    unsigned short entries;       /* of A that no param changes */
    unsigned short turns;         /* pairs of load states, cosine and sine, whose frequency params change */
    const unsigned short *row;    /* of A that the derivatives are */
    const pl_entry *entry;
    const unsigned short *turn;   /* a row of the equations, the place of the cosine in x */
    const unsigned short *place;  /* of each entry of x in that of the whole model */
} pl_block;

/* Blocks of one shape, whose factors of a step an instance has in one table */
typedef struct pl_group {
    int blocks;
    const pl_block *block;
    const unsigned short *reads;  /* of each block the params that it reads, a bit each */
    int samples;                  /* inputs that go from sample to sample: */
    const unsigned short *sample; /* the place of each in x, and how many of its derivatives follow there */
    const PL_REAL *tap;           /* of those with more than one: parts of h^m times derivative m in each sample */
    int down, across;             /* of one block, in the table: from row to row, from column to column; of several 0 */
    int entries, changing;        /* of several, of each; and beside them in each segment of time; of one, columns */
    const unsigned char *entry, *load; /* row and column of each entry */
} pl_group;

/* ---- region.c: a region of a piecewise-linear model from other params ------------------------------------------ */

/* Of x' = A x, A size x size in two words: *halvings, so that no pole times h 2^-halvings is above 1; slopes and
 * Phi = e^{A h} as pl_switching has them, each entry within 16 units in the last place of the largest of all; and the
 * pieces of a ladder that has room for `rungs` of them, *spacing halvings apart.  work: PL_REGION_WORK(size) entries.
 * 0; PL_NOT_FINITE; PL_OUT_OF_RANGE: more halvings than `most` */
int pl_region_of(int size, const pl_two *A, PL_REAL h, int most, int rungs, int *halvings, int *spacing,
                 PL_REAL *slopes, PL_REAL *Phi, PL_REAL *ladder, pl_two *work);
#define PL_REGION_WORK(size) (7 * (size) * (size))

/* `most` over the largest entry of Phi, or over 1; 0 where there is more than one halving: no step looks over h */
PL_REAL pl_region_large(int size, int halvings, const PL_REAL *Phi, PL_REAL most);

/* Of rows over x, rows x size, in such a region: slope, second and fourth as tangent, chord_error and cubic_error of
 * pl_switching, with room for what rounding did to them.  work: PL_BOUNDS_WORK(size) entries */
void pl_region_bounds(int size, PL_REAL d, const PL_REAL *A, int rows, const PL_REAL *row, PL_REAL *slope,
                      PL_REAL *second, PL_REAL *fourth, PL_REAL *work);
#define PL_BOUNDS_WORK(size) ((4 * (size) + 5) * (size))

/* Of the same rows: reach as a ladder has it, for each row that of all rungs but the first, and of h.  work:
 * PL_REACH_WORK(size, rows) entries */
void pl_region_reach(int size, PL_REAL h, int halvings, int spacing, const PL_REAL *A, int rows, const PL_REAL *row,
                     PL_REAL *reach, PL_REAL *work);
#define PL_REACH_WORK(size, rows) ((5 * (size) + 3 * (rows) + 1) * (size))

/* ---- event_split.c: a part of a step of a scheme with a remainder
 * ------------------------------------------------------ */

/* e^{A tau} of x' = A x, of what is set up for one tau */
typedef struct pl_event_split {
    int size, terms; /* entries of x; of the series, 0: there are tables */
    PL_REAL tau;     /* [s] */
    const PL_REAL *A, *D;
    PL_REAL *room;
} pl_event_split;

/* By the series, or where fastest times tau is above 2 by tables that are made here.
 *     A        size x size [1/s], kept as long as m is
 *     fastest  the sizes |A| have no larger pole [1/s]
 *     work     PL_EVENT_SPLIT_WORK(size) entries, kept as long as m is; room: PL_EVENT_SPLIT_ROOM(size) entries
 * 0, or PL_NOT_FINITE and m has no meaning */
int pl_event_split_begin(pl_event_split *m, int size, const PL_REAL *A, PL_REAL fastest, PL_REAL tau, PL_REAL *work,
                         pl_two *room);

/* out = e^{A tau} x, or where half is not 0 e^{A tau / 2} x */
void pl_event_split_flow(const pl_event_split *m, int half, const PL_REAL *x, PL_REAL *out);
#define PL_EVENT_SPLIT_ROOM(size) (8 * (size) * (size))
#define PL_EVENT_SPLIT_WORK(size) ((2 * (size) + 2) * (size))

/* ---- rate.c: frequencies from other params -------------------------------------------------------------------- */

/* w / (2 pi), w >= 0 an angular frequency [rad/s]: off by less than 2^-115 of itself, beside what two words
 * leave of w; in floats 2^-86. */
pl_rate pl_rate_of(pl_two w);

/* What the phase of a sine has gained over w t where its frequency w was changed: it went on from where it was. */
typedef struct pl_lead {
    pl_turn turn;
    PL_REAL angle; /* the same [rad], from -pi to pi */
} pl_lead;

/* w was `before` and is `after` [rad/s] from t [s] on: the turn gains (before - after) t, which is off by less than
 * 2^-115 of it, or 2^-86, and 2^-129 turn, or 2^-65; so nothing adds up over many changes, however late. */
void pl_lead_change(pl_lead *lead, PL_REAL before, PL_REAL after, PL_REAL t);

/* ---- a model, seen from outside -------------------------------------------------------------------------- */

/* What a program needs to drive a model that it was not written for.  s points to the model's state, `size` bytes,
 * aligned as any double or uint64_t; copy the bytes to save it, copy them back to restore it.
 * u holds one sample of the `inputs` inputs and is NULL where there are none. */
typedef struct pl_model {
    int version;                  /* PL_MODEL_VERSION, of the plrt.h that the model was compiled with */
    int real_size;                /* sizeof(double); in its place a pl_modelf says sizeof(float) */
    const char *name;
    size_t size;                  /* sizeof the state */
    int states, inputs, outputs;
    PL_REAL h;                    /* step [s] */
    const char *const *state_names, *const *input_names, *const *output_names;
    void (*init)(void *s);        /* t = 0 and the spec's initial values */
    void (*set)(void *s, PL_REAL t, const PL_REAL *y); /* y: `states` entries */
    void (*get)(const void *s, PL_REAL *y);
    PL_REAL (*time)(const void *s);                  /* [s] */
    void (*step)(void *s, const PL_REAL *u);
    void (*out)(const void *s, PL_REAL *out);        /* out: `outputs` entries */
    void (*run)(void *s, size_t n, const PL_REAL *u, PL_REAL *out); /* n steps; n rows of u; n rows of out, or NULL */
    void (*at)(const void *s, const PL_REAL *u, PL_REAL tau, PL_REAL *y); /* 0 <= tau <= h; NULL where it has none */
    void (*jump)(void *s, uint64_t n);                                 /* n steps at once; NULL where it has none */
    int (*status)(const void *s); /* 0, or PL_... bits */
    int params;                   /* tunable ones */
    const char *const *param_names;
    const PL_REAL *param_values;  /* the spec's */
    int (*retune)(void *s, const PL_REAL *params, PL_REAL h); /* state and time stay; NULL: nothing is tunable */
    void (*hold)(void *s, const PL_REAL *u); /* the samples before the first step; NULL where no input is a ramp */
    /* Of each input: how many it has had when the first step comes.  0: held, so row k of a record acts from k h to
     * (k + 1) h; 1: a ramp, so row 0 is the sample at t = 0, which `hold` takes, and row k + 1 that at the end of step
     * k; m > 1: `hold` takes rows 0 to m - 1 one after the other, step k row k + m.  NULL where there are no inputs */
    const int *start_samples;
} pl_model;
