/* SPDX-License-Identifier: MIT-0 */
/* e^{a t} as a power of 2 whose exponent a t / ln 2 is a fixed-point number, added up without rounding.  The power is
 * made of integers of 32 bits and rounded once, into the subnormal range too. */
#define REAL_IS_FLOAT
#include "words.h"

/* +-magnitude 2^-48, saturated */
static pl_envelopef envelope(uint64_t magnitude, int negative)
{
    if (magnitude >> 63) { /* 2^15 or more; -2^15 itself is what saturation gives */
        return negative ? INT64_MIN : INT64_MAX;
    }
    return negative ? -(int64_t)magnitude : (int64_t)magnitude;
}

pl_envelopef pl_envelopef_times(pl_envelopef a, uint64_t n)
{
    const int negative = a < 0;
    const words_pair m = words_product(negative ? 0u - (uint64_t)a : (uint64_t)a, n);
    return envelope(m.hi != 0 ? UINT64_MAX : m.lo, negative);
}

pl_envelopef pl_envelopef_at(const pl_ratef *rate, int negative, float t)
{
    const float last = 0x1.fffffep127f;
    int point;
    const words_wide powers = words_rate_times(rate, t > last ? last : t < -last ? -last : t, &point);
    const words_pair m = words_rounded(&powers, point - 48);
    int i, beyond = m.hi != 0;
    for (i = 0; i < 4; i++) { /* bits worth 2^15 and more */
        const int above = point + 15 - 64 * i; /* where they begin in word i */
        beyond |= above < 64 && powers.word[i] >> (above > 0 ? above : 0) != 0;
    }
    return envelope(beyond ? UINT64_MAX : m.lo, (negative != 0) != (t < 0));
}

/* 2^f - 1, both in units of 2^-32.  Minimax for the error relative to 2^f by Remez exchange in 50 digits, the
 * coefficients rounded to 2^-32 in turn from the lowest on and the others fitted again each time: within 2^-33.6 of
 * 2^f, before the products are rounded down. */
static uint32_t power_of_2(uint32_t f)
{
    uint32_t sum = words_times32(f, 0x00016785);
    sum = words_times32(f, 0x00096C33 + sum);
    sum = words_times32(f, 0x0057F13A + sum);
    sum = words_times32(f, 0x02761501 + sum);
    sum = words_times32(f, 0x0E3593BA + sum);
    sum = words_times32(f, 0x3D7F7A4B + sum);
    return words_times32(f, 0xB1721808 + sum);
}

/* significand 2^(power - 31), rounded once; its top bit is set, and -150 <= power <= 128 */
static float assembled(uint32_t significand, int power)
{
    const int biased = power + 127;
    const int drop = biased > 0 ? 8 : 9 - biased; /* 24 bits stay, fewer of a subnormal: 8 .. 32 of 32 go */
    /* less 1: a half goes down, for 2^-150 is 0 in IEEE arithmetic */
    const uint32_t above = (significand - 1) >> (drop - 1);
    real_parts u;
    u.bits = (above >> 1) + (above & 1);
    if (biased > 1) {
        u.bits += (uint32_t)(biased - 1) << 23; /* a carry goes on into the exponent, as it should, to infinity even */
    }
    return u.value;
}

float pl_envelopef_value(pl_envelopef a)
{
    const int64_t one = (int64_t)1 << 48;
    const int k = (int)(((uint64_t)a ^ (uint64_t)1 << 63) >> 48) - 32768; /* rounded down */
    uint32_t rest;

    if (a < -150 * one) {
        return 0;
    }
    if (a >= 128 * one) {
        return assembled((uint32_t)1 << 31, 128);
    }
    rest = power_of_2((uint32_t)((uint64_t)a >> 16));
    return assembled((uint32_t)1 << 31 | rest >> 1 | (rest & 1), k);
}
