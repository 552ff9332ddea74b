/* SPDX-License-Identifier: MIT-0 */
/* P^k x by binary powering in two-word arithmetic. */
#include "plrt.h"

#ifdef __FAST_MATH__
#error "power.c needs rounding errors as they are: compile it without -ffast-math"
#endif

static int is_finite(double a)
{
    return a - a == 0.0;
}

/* a as a double that was rounded and stored.  Without this a compiler that contracts could put an exact product where the
 * error term below needs the rounded one, and a wide register could keep more of a sum than its double. */
static double rounded(double a)
{
    volatile double stored = a;
    return stored;
}

static pl_two two(double hi, double lo)
{
    pl_two t;
    t.hi = hi;
    t.lo = lo;
    return t;
}

/* a + b, exactly (Knuth's TwoSum: no condition on sizes).  Infinities come without a low word. */
static pl_two two_sum(double a, double b)
{
    const double s = rounded(a + b), b_part = s - a, a_part = s - b_part;
    return two(s, is_finite(s) ? (a - a_part) + (b - b_part) : 0.0);
}

/* a rounded to 26 bits, so that it and what remains both have products without rounding error.  By its bits: this does not
 * overflow below the last binade, and no compiler can rewrite it. */
static double top_half(double a)
{
    union {
        double value;
        uint64_t bits;
    } u;
    u.value = a;
    u.bits = (u.bits + ((uint64_t)1 << 26)) & ~(((uint64_t)1 << 27) - 1);
    return u.value;
}

/* a b, exactly while it is above 2^-969.  Every product in the error term is exact, so contraction changes nothing. */
static pl_two two_product(double a, double b)
{
    const double p = rounded(a * b);
    const double ah = top_half(a), al = a - ah, bh = top_half(b), bl = b - bh;
    const double lost = ((ah * bh - p) + ah * bl + al * bh) + al * bl;
    return two(p, is_finite(lost) ? lost : 0.0);
}

/* a + b within 2^-104 of |a| + |b|.  An infinity stays, and the first one wins: no NaN from infinities that meet. */
static pl_two add(pl_two a, pl_two b)
{
    pl_two s, t;
    if (!is_finite(a.hi))
        return a;
    s = two_sum(a.hi, b.hi);
    if (!is_finite(s.hi))
        return s;
    t = two_sum(a.lo, b.lo);
    s = two_sum(s.hi, s.lo + t.hi);
    return two_sum(s.hi, s.lo + t.lo);
}

/* a b within 2^-104 of itself.  0 times infinity is 0: what is decoupled stays so when its neighbour overflows. */
static pl_two multiply(pl_two a, pl_two b)
{
    pl_two p;
    if (a.hi == 0.0 || b.hi == 0.0)
        return two(0.0, 0.0);
    p = two_product(a.hi, b.hi);
    if (!is_finite(p.hi))
        return two(p.hi, 0.0);
    return two_sum(p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi));
}

static pl_two scaled(pl_two a, double power_of_2)
{
    const double hi = a.hi * power_of_2;
    return two(hi, is_finite(hi) ? a.lo * power_of_2 : 0.0);
}

/* sum of a_j b_j scale^2; a is a row, b a column whose entries lie `stride` apart. */
static pl_two dot(int n, const pl_two *a, const pl_two *b, int stride, double scale)
{
    pl_two sum = two(0.0, 0.0);
    int j;
    for (j = 0; j < n; j++)
        sum = add(sum, multiply(scaled(a[j], scale), scaled(b[j * stride], scale)));
    return sum;
}

/* The same, with overflow only where the sum overflows, and with its sign: large terms of both signs may have met. */
static pl_two dot_any(int n, const pl_two *a, const pl_two *b, int stride)
{
    pl_two sum = dot(n, a, b, stride, 1.0);
    if (!is_finite(sum.hi))
        sum = scaled(scaled(dot(n, a, b, stride, 0x1p-520), 0x1p520), 0x1p520);
    return sum;
}

void pl_power_apply(int n, pl_two *P, pl_two *W, pl_two *x, pl_two *w, uint64_t k)
{
    int i, j;
    while (k != 0) { /* powers of one matrix commute: from the lowest bit on is as good */
        if (k & 1) {
            for (i = 0; i < n; i++)
                w[i] = dot_any(n, P + i * n, x, 1);
            for (i = 0; i < n; i++)
                x[i] = w[i];
        }
        k >>= 1;
        if (k != 0) {
            pl_two *const square = W;
            for (i = 0; i < n; i++)
                for (j = 0; j < n; j++)
                    square[i * n + j] = dot_any(n, P + i * n, P + j, n);
            W = P;
            P = square;
        }
    }
}
