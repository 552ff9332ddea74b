/* SPDX-License-Identifier: MIT-0 */
/* The largest size of an output within a step: a bound that most steps stay below, else its Taylor polynomial. */
#include "real.h"

enum { MOST_TERMS = 48, LOOKS_A_TERM = 24, MOST_HALVINGS = 20, BEND_PARTS = 4, MOST_ENTRIES = 96, MOST_TRIES = 60 };

/* Of a step: a top is found once it is known so closely, where it is flat to rounding */
#define NEAREST (REAL_DIGITS > 30 ? (real)1e-8 : (real)2e-4)

/* Not a number stays none. */
static real larger(real a, real b)
{
    return a > b ? a : b;
}

static real smaller(real a, real b)
{
    return a < b ? a : b;
}

static real product(int n, const real *a, const real *b)
{
    real sum = 0;
    int i;
    for (i = 0; i < n; i++) {
        sum += a[i] * b[i];
    }
    return sum;
}

/* ---- a polynomial in s = 0 .. 1 ---- */

typedef struct taylor {
    int degree;
    real c[MOST_TERMS + 1];
    real end, end_slope;        /* p, p' at 1 */
    real second, third, fourth; /* bounds of the derivatives */
} taylor;

static void bound_derivatives(taylor *p)
{
    int k;
    p->end = p->c[0] + p->c[1];
    p->end_slope = p->c[1];
    p->second = p->third = p->fourth = 0;
    for (k = 2; k <= p->degree; k++) {
        const real size = (real)(k * (k - 1)) * pl_magnitude(p->c[k]);
        p->end += p->c[k];
        p->end_slope += (real)k * p->c[k];
        p->second += size;
        p->third += size * (real)(k - 2);
        p->fourth += size * (real)((k - 2) * (k - 3));
    }
}

/* No |p| is larger: the cubic with p's values and slopes at 0 and 1 stays within its control points, here those of its
 * halves, and is off p by at most s^2 (1 - s)^2/24 max|p''''|. */
static real bound_of(const taylor *p)
{
    const real a = p->c[0], d = p->end, b = a + p->c[1] / 3, c = d - p->end_slope / 3;
    const real ab = (a + b) / 2, bc = (b + c) / 2, cd = (c + d) / 2, left = (ab + bc) / 2, right = (bc + cd) / 2;
    const real halves = larger(pl_magnitude(left), pl_magnitude(right));
    const real inner = larger(halves, larger(pl_magnitude(ab), pl_magnitude(cd)));
    return larger(larger(pl_magnitude(a), pl_magnitude(d)), inner) + p->fourth / 384;
}

/* value[0], [1], [2]: p, p', p'' at s */
static void values_at(const taylor *p, real s, real *value)
{
    int k;
    value[0] = value[1] = value[2] = 0;
    for (k = p->degree; k >= 0; k--) {
        value[2] = value[2] * s + 2 * value[1];
        value[1] = value[1] * s + value[0];
        value[0] = value[0] * s + p->c[k];
    }
}

static real third_at(const taylor *p, real s)
{
    real value = 0;
    int k;
    for (k = p->degree; k >= 3; k--) {
        value = value * s + (real)(k * (k - 1) * (k - 2)) * p->c[k];
    }
    return value;
}

/* |p| at the root of p' in a .. b, where p'' has one sign: Newton's method from where the chord of p' is 0.  Off by
 * `off` p is off by off^2/2 p''. */
static real extreme(const taylor *p, real a, real b, real slope_a, real slope_b, real *at)
{
    real s = a + (b - a) * (slope_a / (slope_a - slope_b)), value[3];
    int k;
    for (k = 0; k < 12; k++) {
        real next, off;
        values_at(p, s, value);
        next = s - value[1] / value[2];
        next = next > a ? (next < b ? next : b) : a;
        off = pl_magnitude(next - s);
        *at = next;
        if (off * off * pl_magnitude(value[2]) <= REAL_EPSILON / 4 * pl_magnitude(value[0])) {
            break;
        }
        s = next;
    }
    return pl_magnitude(value[0]);
}

/* Between two points p is off its chord by at most (b - a)^2/8 max|p''|, all in all and, closer, between them.  Where
 * that may pass `peak` by more than rounding, and p' may change its sign: one sign of p'' in between leaves one extreme
 * at most; else half the interval.  Beyond LOOKS_A_TERM intervals for each term their ends count. */
static real largest(const taylor *p, real peak, real *at)
{
    const real least = REAL_DIGITS > 30 ? (real)1 / (1 << 26) : (real)1 / (1 << 12);
    real a = 0, width = 1, at_a[3], at_b[3], middle[3];
    int looks = 0;
    values_at(p, a, at_a);
    while (a < 1) {
        const real b = a + width, over = width * width / 8;
        real ends;
        values_at(p, b, at_b);
        ends = larger(pl_magnitude(at_a[0]), pl_magnitude(at_b[0]));
        if (width > least && looks < LOOKS_A_TERM * p->degree && !(ends + over * p->second <= peak)) {
            real turn, bend;
            looks++;
            values_at(p, a + width / 2, middle);
            turn = smaller(p->third, pl_magnitude(third_at(p, a + width / 2)) + p->fourth * width / 2) * width / 2;
            bend = pl_magnitude(middle[2]) + turn;
            if (!(pl_magnitude(middle[1]) > bend * width / 2) &&
                !(ends + over * bend <= peak + 4 * REAL_EPSILON * peak)) {
                if (pl_magnitude(middle[2]) < turn) {
                    width /= 2;
                    continue;
                }
                if ((at_a[1] < 0) != (at_b[1] < 0)) {
                    real top_at;
                    const real top = extreme(p, a, b, at_a[1], at_b[1], &top_at);
                    *at = top > peak ? top_at : *at;
                    peak = larger(peak, top);
                }
            }
        }
        a = b;
        width = 2 * width < 1 - a ? 2 * width : 1 - a;
        at_a[0] = at_b[0];
        at_a[1] = at_b[1];
    }
    return peak;
}

/* ---- the output as a polynomial ---- */

/* A where it is not 0, row by row, mostly chains of derivatives, and so the output's row; more entries: all of it */
typedef struct slopes {
    int size, entries, places;  /* below 0: all */
    int chain;                  /* rows from here on are sums of entries behind their own: of these, derivatives end */
    const real *A, *output;
    int row[MOST_ENTRIES + 1], column[MOST_ENTRIES], place[MOST_ENTRIES];
    real value[MOST_ENTRIES];
} slopes;

static int list_places(int size, const real *output, int *place)
{
    int i, places = 0;
    for (i = 0; i < size; i++) {
        if (output[i] < 0 || output[i] > 0) {
            if (places == MOST_ENTRIES) {
                return -1;
            }
            place[places++] = i;
        }
    }
    return places;
}

static void list_entries(int size, const real *A, slopes *s)
{
    int i, j;
    s->size = size;
    s->A = A;
    s->entries = s->chain = 0;
    for (i = 0; i < size; i++) {
        for (j = 0; j < size; j++) {
            if (A[i * size + j] < 0 || A[i * size + j] > 0) {
                if (s->entries == MOST_ENTRIES) {
                    s->entries = -1;
                    s->chain = size;
                    return;
                }
                s->row[s->entries] = i;
                s->column[s->entries] = j;
                s->value[s->entries++] = A[i * size + j];
                s->chain = j <= i ? i + 1 : s->chain;
            }
        }
    }
    s->row[s->entries] = size;
}

static real output_of(const slopes *s, const real *x)
{
    real sum = 0;
    int i;
    if (s->places < 0) {
        return product(s->size, s->output, x);
    }
    for (i = 0; i < s->places; i++) {
        sum += s->output[s->place[i]] * x[s->place[i]];
    }
    return sum;
}

/* Row i of A times x; *from: the first of its entries, then of those behind */
static real slope_of(const slopes *s, const real *x, int i, int *from)
{
    real sum = 0;
    int k;
    if (s->entries < 0) {
        return product(s->size, s->A + i * s->size, x);
    }
    for (k = *from; s->row[k] == i; k++) {
        sum += s->value[k] * x[s->column[k]];
    }
    *from = k;
    return sum;
}

/* The output of e^{A s d} x, and x at the end, s = 1; 0: it takes too many terms.  work: 3 size reals */
static int expand(const slopes *A, real d, real *x, taylor *p, real *work)
{
    real *term = work, *next = work + A->size, *most = work + 2 * A->size;
    int i, k, small = 0, size = A->size;
    for (i = 0; i < size; i++) {
        term[i] = x[i];
        most[i] = pl_magnitude(x[i]);
    }
    p->c[0] = output_of(A, x);
    for (k = 1; k <= MOST_TERMS && small < 2; k++) {
        const real part = d / (real)k;
        real *const done = term;
        int from = 0, all = 1;
        for (i = 0; i < size; i++) {
            const real now = slope_of(A, term, i, &from) * part;
            next[i] = now;
            x[i] += now;
            most[i] = larger(most[i], pl_magnitude(now));
            all &= pl_magnitude(now) <= REAL_EPSILON / 8 * most[i];
        }
        term = next;
        next = done;
        p->c[k] = output_of(A, term);
        p->degree = k;
        small = all ? small + 1 : 0;
        while (size > A->chain && !(term[size - 1] < 0) && !(term[size - 1] > 0)) {
            next[--size] = 0;           /* from now on, in both */
        }
    }
    return small == 2;
}

/* Part by part, of which there are 2^halvings; below 0: these are too long */
static real search(const slopes *A, real h, int halvings, const real *start, real peak, real *when, real *work)
{
    const int size = A->size;
    const int32_t parts = (int32_t)1 << halvings;
    real *x = work + 3 * size;
    int32_t part;
    int i;
    taylor p;
    for (i = 0; i < size; i++) {
        x[i] = start[i];
    }
    for (part = 0; part < parts; part++) {
        if (!expand(A, h / (real)parts, x, &p, work)) {
            return -1;
        }
        bound_derivatives(&p);
        if (part + 1 < parts && pl_magnitude(p.end) > peak) {
            peak = pl_magnitude(p.end);
            *when = (real)(part + 1) / (real)parts;
        }
        if (pl_magnitude(p.c[1]) < p.second && !(bound_of(&p) <= peak)) {      /* else it only rises, or stays below */
            real at = -1;
            peak = largest(&p, peak, &at);
            *when = at >= 0 ? ((real)part + at) / (real)parts : *when;
        }
    }
    return peak;
}

real pl_peak(int size, const real *A, const real *row, const real *bend, real h, const real *x, real end, real peak,
             real *when, real *work)
{
    const real begin = pl_magnitude(product(size, row, x)), most = larger(begin, pl_magnitude(end));
    real off = 0, found = -1;
    slopes listed;
    int i;
    for (i = 0; i < size; i++) {
        off += bend[i] * pl_magnitude(x[i]);
    }
    if (most + off <= peak) {
        return peak;
    }
    if (!(most - most <= 0) || !(peak - peak <= 0)) {     /* not finite */
        return peak - peak <= 0 ? most : peak;
    }
    if (most > peak) {
        peak = most;
        *when = begin >= most ? 0 : 1;
    }
    list_entries(size, A, &listed);
    listed.output = row;
    listed.places = list_places(size, row, listed.place);
    for (i = 0; i <= MOST_HALVINGS && found < 0; i++) {
        found = search(&listed, h, i, x, peak, when, work);
    }
    return found < 0 ? peak : found;
}

/* ---- the bound ---- */

/* row A, and |row| |A| */
static void row_times(const slopes *s, const real *row, real *product, const real *most, real *bound)
{
    const int all = s->entries < 0, entries = all ? s->size * s->size : s->entries;
    int k;
    for (k = 0; k < s->size; k++) {
        product[k] = bound[k] = 0;
    }
    for (k = 0; k < entries; k++) {
        const int i = all ? k / s->size : s->row[k], j = all ? k % s->size : s->column[k];
        const real value = all ? s->A[k] : s->value[k];
        product[j] += row[i] * value;
        bound[j] += most[i] * pl_magnitude(value);
    }
}

/* sum <- sum |A|^k d^k/k! of |row|, row <- row e^{A d}; 0: not in so many terms.  work: 4 size reals */
static int grow(const slopes *A, real d, real *row, real *sum, real *work)
{
    const int size = A->size;
    real *term = work, *most = work + size, *next = work + 2 * size, *bound = work + 3 * size;
    int j, k, small = 0;
    for (j = 0; j < size; j++) {
        term[j] = row[j];
        sum[j] = most[j] = pl_magnitude(row[j]);
    }
    for (k = 1; k <= MOST_TERMS && small < 2; k++) {
        const real part = d / (real)k;
        int all = 1;
        row_times(A, term, next, most, bound);
        for (j = 0; j < size; j++) {
            term[j] = next[j] * part;
            most[j] = bound[j] * part;
            row[j] += term[j];
            sum[j] += most[j];
            all &= most[j] <= REAL_EPSILON * sum[j];
        }
        small = all ? small + 1 : 0;
    }
    return small == 2;
}

void pl_peak_bend(int size, const real *A, const real *row, real h, real *bend, real *work)
{
    const real slack = 1 + 4096 * REAL_EPSILON;
    real *r = work, *sum = work + size, *first = work + 2 * size;
    slopes listed;
    int j, k;
    list_entries(size, A, &listed);
    row_times(&listed, row, first, row, sum);
    row_times(&listed, first, r, row, sum);
    for (j = 0; j < size; j++) {
        bend[j] = 0;
    }
    for (k = 0; k < BEND_PARTS; k++) {
        const int known = grow(&listed, h / (real)BEND_PARTS, r, sum, work + 2 * size);
        for (j = 0; j < size; j++) {
            bend[j] = known ? larger(bend[j], slack * (h * h / 8) * sum[j]) : REAL_LARGE;
        }
        if (!known) {
            return;
        }
    }
}

/* ---- by values ---- */

/* The largest second difference of values so far apart */
static real bend_of(const pl_peak_values *l, int apart)
{
    const real *const v = l->value;
    real most = 0;
    int i;
    for (i = apart; i + apart <= PL_PEAK_TIMES; i += apart) {
        most = larger(most, pl_magnitude((v[i + apart] - v[i]) - (v[i] - v[i - apart])));
    }
    return most;
}

static real top_of(const pl_peak_values *l)
{
    real most = 0;
    int i;
    for (i = 0; i <= PL_PEAK_TIMES; i += l->apart) {
        most = larger(most, pl_magnitude(l->value[i]));
    }
    return most;
}

/* Whether they stand so close that a parabola has about a quarter of the second differences of those twice as far
 * apart, or that nothing between them can pass the peak */
static int are_close(const pl_peak_values *l)
{
    const real bend = bend_of(l, l->apart), top = top_of(l);
    if (l->apart == 1 || top + 4 * bend <= l->peak) {
        return 1;
    }
    return l->apart <= PL_PEAK_TIMES / 8 && (bend <= (real)0.3 * bend_of(l, 2 * l->apart) || bend <= NEAREST * top);
}

/* Brent 1973, chapter 5: the top of the parabola through the best three, or where that is of no use a golden section;
 * below 0: it is found */
static real next_try(pl_peak_values *l)
{
    const real x = l->s[0], middle = (l->a + l->b) / 2, before = l->before;
    const real r = (x - l->s[1]) * (l->size[0] - l->size[2]), t = (x - l->s[2]) * (l->size[0] - l->size[1]);
    const real sign = t > r ? -1 : 1, q = 2 * pl_magnitude(t - r), p = sign * ((x - l->s[2]) * t - (x - l->s[1]) * r);
    if (pl_magnitude(x - middle) + (l->b - l->a) / 2 <= 2 * NEAREST || l->tries++ == MOST_TRIES) {
        return -1;
    }
    l->before = l->moved;
    if (pl_magnitude(p) < pl_magnitude(q * before / 2) && p > q * (l->a - x) && p < q * (l->b - x)) {
        l->moved = p / q;
    } else {
        l->before = x < middle ? l->b - x : l->a - x;
        l->moved = (real)0.3819660113 * l->before;
    }
    if (pl_magnitude(l->moved) < NEAREST) {
        return x + (l->moved > 0 ? NEAREST : -NEAREST);
    }
    return x + l->moved;
}

/* Of these times, whose sizes are known, the best three.  One by one: of a loop compilers make a memmove. */
static void keep(pl_peak_values *l, int place, real s, real size)
{
    if (place < 2) {
        l->s[2] = l->s[1];
        l->size[2] = l->size[1];
    }
    if (place < 1) {
        l->s[1] = l->s[0];
        l->size[1] = l->size[0];
    }
    l->s[place] = s;
    l->size[place] = size;
}

static void take_try(pl_peak_values *l, real s, real size)
{
    const int best = size >= l->size[0], behind = best ? s >= l->s[0] : s < l->s[0];
    if (behind) {
        l->a = best ? l->s[0] : s;
    } else {
        l->b = best ? l->s[0] : s;
    }
    if (best || size >= l->size[1]) {
        keep(l, best ? 0 : 1, s, size);
    } else if (size >= l->size[2] || !(pl_magnitude(l->s[2] - l->s[1]) > 0)) {
        keep(l, 2, s, size);
    }
}

/* Around time i, which is higher than its neighbours */
static void begin_top(pl_peak_values *l, int i)
{
    const int left = i > 0 ? i - l->apart : 0, right = i < PL_PEAK_TIMES ? i + l->apart : i;
    const int other = left < i ? left : right, last = right > i ? right : left;
    l->a = (real)left / PL_PEAK_TIMES;
    l->b = (real)right / PL_PEAK_TIMES;
    keep(l, 0, (real)last / PL_PEAK_TIMES, pl_magnitude(l->value[last]));
    keep(l, 0, (real)other / PL_PEAK_TIMES, pl_magnitude(l->value[other]));
    keep(l, 0, (real)i / PL_PEAK_TIMES, pl_magnitude(l->value[i]));
    l->moved = l->before = l->b - l->a;
    l->tries = 0;
}

/* Where the next top is looked for: no neighbour is larger, and what is between them may pass the peak */
static real next_top(pl_peak_values *l)
{
    const real slack = 2 * bend_of(l, l->apart);
    for (; l->top <= PL_PEAK_TIMES; l->top += l->apart) {
        const int i = l->top, left = i > 0 ? i - l->apart : i, right = i < PL_PEAK_TIMES ? i + l->apart : i;
        const real size = pl_magnitude(l->value[i]);
        if (size >= pl_magnitude(l->value[left]) && size >= pl_magnitude(l->value[right]) &&
            !(size + slack <= l->peak)) {
            begin_top(l, i);
            l->top += l->apart;
            return l->at = next_try(l);
        }
    }
    return -1;
}

static real next_time(pl_peak_values *l)
{
    return l->at = (real)l->time / PL_PEAK_TIMES;
}

real pl_peak_begin(pl_peak_values *l, real begin, real end, real peak)
{
    const real most = larger(pl_magnitude(begin), pl_magnitude(end));
    l->peak = larger(peak, most);
    l->when = pl_magnitude(begin) >= most ? 0 : 1;
    l->value[0] = begin;
    l->value[PL_PEAK_TIMES] = end;
    l->apart = l->time = PL_PEAK_TIMES / 2;
    l->top = 0;
    if (!(begin - begin <= 0) || !(end - end <= 0) || !(peak - peak <= 0)) {       /* not finite */
        l->peak = peak - peak <= 0 ? pl_magnitude(begin) + pl_magnitude(end) : peak;
        return -1;
    }
    return next_time(l);
}

real pl_peak_next(pl_peak_values *l, real value)
{
    if (!(value - value <= 0)) {
        return -1;
    }
    l->when = pl_magnitude(value) > l->peak ? l->at : l->when;
    l->peak = larger(l->peak, pl_magnitude(value));
    if (l->time > PL_PEAK_TIMES) {
        take_try(l, l->at, pl_magnitude(value));
        l->at = next_try(l);
        return l->at >= 0 ? l->at : next_top(l);
    }
    l->value[l->time] = value;
    l->time += 2 * l->apart;
    if (l->time < PL_PEAK_TIMES) {
        return next_time(l);
    }
    if (are_close(l)) {
        return next_top(l);
    }
    l->apart /= 2;
    l->time = l->apart;
    return next_time(l);
}
