/* SPDX-License-Identifier: MIT-0 */
/* e^{a t} as a power of 2 whose exponent a t / ln 2 is a fixed-point number: it is added up without rounding, so a load
 * that grows or decays for 10^9 steps is as accurate as in its first.  The power is made of integers and rounded once,
 * into the subnormal range too. */
#include "words.h"

/* +-magnitude 2^-112, saturated. */
static pl_envelope envelope(words_pair magnitude, int negative)
{
    const words_pair m = negative ? words_negative(magnitude) : magnitude;
    pl_envelope a;
    if (magnitude.hi >> 63) { /* 2^15 or more; -2^15 itself is what saturation gives */
        a.hi = negative ? INT64_MIN : INT64_MAX;
        a.lo = negative ? 0 : UINT64_MAX;
    } else {
        a.hi = pl_envelope_signed(m.hi);
        a.lo = m.lo;
    }
    return a;
}

pl_envelope pl_envelope_times(pl_envelope a, uint64_t n)
{
    const int negative = a.hi < 0;
    words_pair m, low, high;

    m.hi = (uint64_t)a.hi;
    m.lo = a.lo;
    if (negative) {
        m = words_negative(m);
    }
    low = words_product(m.lo, n);
    high = words_product(m.hi, n);
    low.hi += high.lo;
    high.hi += low.hi < high.lo;
    if (high.hi != 0) {
        low.hi = UINT64_MAX;
    }
    return envelope(low, negative);
}

pl_envelope pl_envelope_at(const pl_rate *rate, int negative, double t)
{
    const double last = 0x1.fffffffffffffp1023;
    int point, i;
    words_wide w;
    words_pair m;

    w = words_rate_times(rate, t > last ? last : t < -last ? -last : t, &point);
    m = words_rounded(&w, point - 112);
    for (i = 0; i < 4; i++) { /* bits worth 2^15 and more */
        const int above = point + 15 - 64 * i; /* where they begin in word i */
        if (above < 64 && w.word[i] >> (above > 0 ? above : 0) != 0) {
            m.hi = UINT64_MAX;
        }
    }
    return envelope(m, (negative != 0) != (t < 0.0));
}

/* (e^r - 1 - r - r^2/2)/r^3 for |r| <= ln(2)/2.  Minimax for the error relative to e^r by Remez exchange in 60 digits,
 * the coefficients rounded in turn from the lowest on and the others fitted again each time.  As used, it is within
 * 2^-61.7 of e^r. */
static double exponential_rest(double r)
{
    return 0x1.555555555555ap-3
        + r * (0x1.555555555549cp-5
        + r * (0x1.111111110f0b2p-7
        + r * (0x1.6c16c16c4bee6p-10
        + r * (0x1.a01a01b2b1627p-13
        + r * (0x1.a01a01137c47dp-16
        + r * (0x1.71ddf044ebb8bp-19
        + r * (0x1.27e53c2b48631p-22
        + r * (0x1.af6e3f437189dp-26
        + r * 0x1.1ff0ae6e94e03p-29))))))));
}

/* significand 2^(power - 63), rounded once; its top bit is set, and -1075 <= power <= 1024. */
static double assembled(uint64_t significand, int power)
{
    union {
        uint64_t bits;
        double value;
    } u;
    const int biased = power + 1023;
    const int drop = biased > 0 ? 11 : 12 - biased; /* 53 bits stay, fewer of a subnormal: 11 .. 64 of 64 go */
    /* less 1: a half goes down, for 2^-1075 is 0 in IEEE arithmetic */
    const uint64_t above = (significand - 1) >> (drop - 1);
    u.bits = (above >> 1) + (above & 1);
    if (biased > 1) {
        u.bits += (uint64_t)(biased - 1) << 52; /* a carry goes on into the exponent, as it should, to infinity even */
    }
    return u.value;
}

/* 2^k e^r with k the nearest integer: 1 + r + r^2/2 in integers of 64 bits; the small rest in doubles, where no
 * rounding of it can be seen. */
double pl_envelope_value(pl_envelope a)
{
    const uint64_t ln_2 = 0xB17217F7D1CF79AC; /* ln 2 2^64 */
    const int64_t one = (int64_t)1 << 48;     /* of a.hi */
    /* positive, and halves go up */
    const uint64_t shifted = (uint64_t)a.hi + ((uint64_t)2048 << 48) + ((uint64_t)1 << 47);
    const int k = (int)(shifted >> 48) - 2048;
    uint64_t fraction = (uint64_t)a.hi << 16 | a.lo >> 48, r, rr, sum;
    const int below = (int)(fraction >> 63); /* of k */
    double x;

    if (a.hi < -1075 * one) {
        return 0.0;
    }
    if (a.hi >= 1024 * one) {
        return assembled((uint64_t)1 << 63, 1024);
    }
    if (below) {
        fraction = 0u - fraction;
    }
    r = words_times(fraction, ln_2); /* |r| in units of 2^-64 */
    rr = words_times(r, r);
    x = (double)(int64_t)r * (below ? -0x1p-64 : 0x1p-64);
    sum = ((uint64_t)1 << 63) + (rr >> 2);
    sum = below ? sum - (r >> 1) : sum + (r >> 1);
    sum += (uint64_t)(int64_t)(x * x * x * 0x1p63 * exponential_rest(x)); /* negative perhaps: mod 2^64 */
    return sum >> 63 ? assembled(sum, k) : assembled(sum << 1, k - 1);
}
