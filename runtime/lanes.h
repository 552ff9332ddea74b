/* SPDX-License-Identifier: MIT-0 */
/* lanes.h: several numbers side by side, as many as the machine adds in one instruction; for NAME_batch, in which each
 * lane is an instance.  With gcc and clang `+ - *` act on all lanes, and a single number on each of them; elsewhere,
 * and where the machine has no vectors, there is one lane, a plain number, and the same text computes with that.  Which
 * instructions there are says the compiler's command line (-march=native).  Included by the file of the model, once it
 * has defined PL(name) and PL_SINGLE, 1: in float; before its functions over lanes and batch.h. */
#include "numbers.h"

#include <string.h>

/* PL_LANES_UNROLL: the loop that follows is of constant length; written out its lanes stay in registers. */
#if defined(__GNUC__) && (defined(__SSE2__) || (defined(__ARM_NEON) && defined(__aarch64__)))
#define PL_LANES_INLINE static inline __attribute__((always_inline, unused))
#if defined(__clang__)
#define PL_LANES_UNROLL _Pragma("clang loop unroll(full)")
#elif __GNUC__ >= 8
#define PL_LANES_UNROLL _Pragma("GCC unroll 16")
#else
#define PL_LANES_UNROLL
#endif
#if defined(__AVX512F__)
#include <immintrin.h>
#define PL_LANES_BYTES 64
#elif defined(__AVX__)
#include <immintrin.h>
#define PL_LANES_BYTES 32
#else
#if defined(__SSE2__)
#include <emmintrin.h>
#endif
#define PL_LANES_BYTES 16
#endif
#else
#define PL_LANES_INLINE static inline
#define PL_LANES_UNROLL
#endif

/* Once of each type, however many models a file has */
#if (PL_SINGLE && !defined(PL_LANES_OF_FLOATS)) || (!PL_SINGLE && !defined(PL_LANES_OF_DOUBLES))
#if PL_SINGLE
#define PL_LANES_OF_FLOATS
#define PL_LANES_BITS int32_t
#define PL_LANES_MAGNITUDE INT32_MAX
#define PL_LANES_CALL(front, back) front##ps##back
#else
#define PL_LANES_OF_DOUBLES
#define PL_LANES_BITS int64_t
#define PL_LANES_MAGNITUDE INT64_MAX
#define PL_LANES_CALL(front, back) front##pd##back
#endif

/* |value| */
#if defined(__GNUC__) && (defined(__SSE2__) || (defined(__ARM_NEON) && defined(__aarch64__)))
typedef real pl_lanes __attribute__((vector_size(PL_LANES_BYTES)));
typedef PL_LANES_BITS pl_lanes_bits __attribute__((vector_size(PL_LANES_BYTES)));
PL_LANES_INLINE pl_lanes pl_lanes_size(pl_lanes value)
{
    const pl_lanes_bits none = {0}, magnitude = none + PL_LANES_MAGNITUDE;
    return (pl_lanes)((pl_lanes_bits)value & magnitude);
}
#else
typedef real pl_lanes;
PL_LANES_INLINE pl_lanes pl_lanes_size(pl_lanes value)
{
    return value < 0 ? -value : value;
}
#endif

/* The larger of `peak` and |value|, lane by lane; not a number where value is none */
PL_LANES_INLINE pl_lanes pl_lanes_peak(pl_lanes peak, pl_lanes value)
{
    const pl_lanes size = pl_lanes_size(value);
#if defined(__GNUC__) && defined(__AVX512F__)
    return PL_LANES_CALL(_mm512_max_, )(peak, size);
#elif defined(__GNUC__) && defined(__AVX__)
    return PL_LANES_CALL(_mm256_max_, )(peak, size);
#elif defined(__GNUC__) && defined(__SSE2__)
    return PL_LANES_CALL(_mm_max_, )(peak, size);
#elif defined(__GNUC__) && defined(__ARM_NEON) && defined(__aarch64__)
    const pl_lanes_bits above = (pl_lanes_bits)(peak > size);
    return (pl_lanes)(((pl_lanes_bits)peak & above) | ((pl_lanes_bits)size & ~above));
#else
    return peak > size ? peak : size;
#endif
}

/* `value`, and 0 where |of| < least < 1, lane by lane */
PL_LANES_INLINE pl_lanes pl_lanes_kept(pl_lanes of, pl_lanes value, pl_lanes least)
{
    const pl_lanes size = pl_lanes_size(of);
#if defined(__GNUC__) && (defined(__SSE2__) || (defined(__ARM_NEON) && defined(__aarch64__)))
    return (pl_lanes)((pl_lanes_bits)value & ~((pl_lanes_bits)(size < least) & (pl_lanes_bits)(least < 1)));
#else
    return size < least && least < 1 ? 0 : value;
#endif
}

/* Is a above b in some lane, or one of them not a number? */
PL_LANES_INLINE int pl_lanes_above(pl_lanes a, pl_lanes b)
{
#if defined(__GNUC__) && defined(__AVX512F__)
    return PL_LANES_CALL(_mm512_cmp_, _mask)(a, b, _CMP_NLE_UQ) != 0;
#elif defined(__GNUC__) && defined(__AVX__)
    return PL_LANES_CALL(_mm256_movemask_, )(PL_LANES_CALL(_mm256_cmp_, )(a, b, _CMP_NLE_UQ)) != 0;
#elif defined(__GNUC__) && defined(__SSE2__)
    return PL_LANES_CALL(_mm_movemask_, )(PL_LANES_CALL(_mm_cmpnle_, )(a, b)) != 0;
#else
    real x[sizeof(pl_lanes) / sizeof(real)], y[sizeof(pl_lanes) / sizeof(real)];
    size_t i;
    int above = 0;
    memcpy(x, &a, sizeof a);
    memcpy(y, &b, sizeof b);
    for (i = 0; i < sizeof(pl_lanes) / sizeof(real); i++) {
        above |= !(x[i] <= y[i]);
    }
    return above;
#endif
}

/* The first `count` numbers, as many as there are lanes at most; 0 in the other lanes */
PL_LANES_INLINE pl_lanes pl_lanes_load(const real *from, size_t count)
{
    real part[sizeof(pl_lanes) / sizeof(real)] = {0};
    pl_lanes all;
    if (count < sizeof(pl_lanes) / sizeof(real)) {
        memcpy(part, from, count * sizeof(real));
        from = part;
    }
    memcpy(&all, from, sizeof all);
    return all;
}

/* The first `count` lanes; without any nothing is written */
PL_LANES_INLINE void pl_lanes_store(real *to, pl_lanes all, size_t count)
{
    if (count >= sizeof(pl_lanes) / sizeof(real)) {
        memcpy(to, &all, sizeof all);
    } else {
        memcpy(to, &all, count * sizeof(real));
    }
}

/* The same number in every lane */
PL_LANES_INLINE pl_lanes pl_lanes_all(real value)
{
    const pl_lanes zero = pl_lanes_load(&value, 0);
    return zero + value;
}

/* The larger of `most` and |value|; not a number where value is none */
PL_LANES_INLINE real pl_larger_size(real most, real value)
{
    const real size = value < 0 ? -value : value;
    return most > size ? most : size;
}

/* As pl_accumulate, in every lane */
PL_LANES_INLINE pl_lanes pl_lanes_accumulate(pl_lanes sum, pl_lanes term, pl_lanes small, pl_lanes *low)
{
    const pl_lanes whole = sum + term, part = whole - sum;
    const pl_lanes error = ((sum - (whole - part)) + (term - part)) + (small + *low), result = whole + error;
    *low = error - (result - whole);
    return result;
}
#undef PL_LANES_BITS
#undef PL_LANES_CALL
#undef PL_LANES_MAGNITUDE
#endif

#include "undef.h"
