/* SPDX-License-Identifier: MIT-0 */
/* pllanes.h: several numbers side by side, as many as the machine adds in one instruction; for NAME_batch, in which
 * each lane is an instance.  With gcc and clang `+ - *` act on all lanes, and a single number on each of them;
 * elsewhere, and where the machine has no vectors, there is one lane, a plain number, and the same text computes with
 * that.  Which instructions there are says the compiler's command line (-march=native). */
#ifndef PLLANES_H
#define PLLANES_H

#include <stddef.h>
#include <string.h>

#if defined(__GNUC__) && defined(__AVX512F__)
#define PL_LANES_BYTES 64
#elif defined(__GNUC__) && defined(__AVX__)
#define PL_LANES_BYTES 32
#elif defined(__GNUC__) && (defined(__SSE2__) || (defined(__ARM_NEON) && defined(__aarch64__)))
#define PL_LANES_BYTES 16
#endif

#if defined(PL_LANES_BYTES) && defined(__AVX__)
#include <immintrin.h>
#elif defined(PL_LANES_BYTES) && defined(__SSE2__)
#include <emmintrin.h>
#endif

#ifdef PL_LANES_BYTES
#define PL_LANES_INLINE static inline __attribute__((always_inline, unused))
typedef double pl_lanes __attribute__((vector_size(PL_LANES_BYTES)));
typedef float pl_lanesf __attribute__((vector_size(PL_LANES_BYTES)));
typedef int64_t pl_lanes_bits __attribute__((vector_size(PL_LANES_BYTES)));
typedef int32_t pl_lanesf_bits __attribute__((vector_size(PL_LANES_BYTES)));
#ifdef __clang__
#define PL_LANES_UNROLL _Pragma("clang loop unroll(full)")
#elif __GNUC__ >= 8
#define PL_LANES_UNROLL _Pragma("GCC unroll 16")
#endif
#else
#define PL_LANES_INLINE static inline
typedef double pl_lanes;
typedef float pl_lanesf;
#endif

/* The loop that follows is of constant length; written out its lanes stay in registers. */
#ifndef PL_LANES_UNROLL
#define PL_LANES_UNROLL
#endif

/* The first `count` numbers, as many as there are lanes at most; 0 in the other lanes */
PL_LANES_INLINE pl_lanes pl_lanes_load(const double *from, size_t count)
{
    double part[sizeof(pl_lanes) / sizeof(double)] = {0.0};
    pl_lanes all;
    if (count < sizeof(pl_lanes) / sizeof(double)) {
        memcpy(part, from, count * sizeof(double));
        from = part;
    }
    memcpy(&all, from, sizeof all);
    return all;
}
PL_LANES_INLINE pl_lanesf pl_lanesf_load(const float *from, size_t count)
{
    float part[sizeof(pl_lanesf) / sizeof(float)] = {0.0f};
    pl_lanesf all;
    if (count < sizeof(pl_lanesf) / sizeof(float)) {
        memcpy(part, from, count * sizeof(float));
        from = part;
    }
    memcpy(&all, from, sizeof all);
    return all;
}

/* The first `count` lanes; without any nothing is written */
PL_LANES_INLINE void pl_lanes_store(double *to, pl_lanes all, size_t count)
{
    if (count >= sizeof(pl_lanes) / sizeof(double)) {
        memcpy(to, &all, sizeof all);
    } else {
        memcpy(to, &all, count * sizeof(double));
    }
}
PL_LANES_INLINE void pl_lanesf_store(float *to, pl_lanesf all, size_t count)
{
    if (count >= sizeof(pl_lanesf) / sizeof(float)) {
        memcpy(to, &all, sizeof all);
    } else {
        memcpy(to, &all, count * sizeof(float));
    }
}

/* The same number in every lane */
PL_LANES_INLINE pl_lanes pl_lanes_all(double value)
{
    const pl_lanes zero = pl_lanes_load(&value, 0);
    return zero + value;
}
PL_LANES_INLINE pl_lanesf pl_lanesf_all(float value)
{
    const pl_lanesf zero = pl_lanesf_load(&value, 0);
    return zero + value;
}

/* The larger of `peak` and |value|, lane by lane; not a number where value is none */
#ifdef PL_LANES_BYTES
PL_LANES_INLINE pl_lanes pl_lanes_peak(pl_lanes peak, pl_lanes value)
{
    const pl_lanes_bits none = {0}, magnitude = none + INT64_MAX;
    const pl_lanes size = (pl_lanes)((pl_lanes_bits)value & magnitude);
#if defined(__AVX512F__)
    return (pl_lanes)_mm512_max_pd((__m512d)peak, (__m512d)size);
#elif defined(__AVX__)
    return (pl_lanes)_mm256_max_pd((__m256d)peak, (__m256d)size);
#elif defined(__SSE2__)
    return (pl_lanes)_mm_max_pd((__m128d)peak, (__m128d)size);
#else
    const pl_lanes_bits above = (pl_lanes_bits)(peak > size);
    return (pl_lanes)(((pl_lanes_bits)peak & above) | ((pl_lanes_bits)size & ~above));
#endif
}
PL_LANES_INLINE pl_lanesf pl_lanesf_peak(pl_lanesf peak, pl_lanesf value)
{
    const pl_lanesf_bits none = {0}, magnitude = none + INT32_MAX;
    const pl_lanesf size = (pl_lanesf)((pl_lanesf_bits)value & magnitude);
#if defined(__AVX512F__)
    return (pl_lanesf)_mm512_max_ps((__m512)peak, (__m512)size);
#elif defined(__AVX__)
    return (pl_lanesf)_mm256_max_ps((__m256)peak, (__m256)size);
#elif defined(__SSE2__)
    return (pl_lanesf)_mm_max_ps((__m128)peak, (__m128)size);
#else
    const pl_lanesf_bits above = (pl_lanesf_bits)(peak > size);
    return (pl_lanesf)(((pl_lanesf_bits)peak & above) | ((pl_lanesf_bits)size & ~above));
#endif
}
#else
PL_LANES_INLINE pl_lanes pl_lanes_peak(pl_lanes peak, pl_lanes value)
{
    const pl_lanes size = value < 0.0 ? -value : value;
    return peak > size ? peak : size;
}
PL_LANES_INLINE pl_lanesf pl_lanesf_peak(pl_lanesf peak, pl_lanesf value)
{
    const pl_lanesf size = value < 0.0f ? -value : value;
    return peak > size ? peak : size;
}
#endif

/* The larger of `most` and |value|; not a number where value is none */
PL_LANES_INLINE double pl_larger_size(double most, double value)
{
    const double size = value < 0.0 ? -value : value;
    return most > size ? most : size;
}
PL_LANES_INLINE float pl_larger_sizef(float most, float value)
{
    const float size = value < 0.0f ? -value : value;
    return most > size ? most : size;
}

/* Is a above b in some lane, or one of them not a number? */
#if defined(PL_LANES_BYTES) && defined(__AVX512F__)
PL_LANES_INLINE int pl_lanes_above(pl_lanes a, pl_lanes b)
{
    return _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_NLE_UQ) != 0;
}
PL_LANES_INLINE int pl_lanesf_above(pl_lanesf a, pl_lanesf b)
{
    return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_NLE_UQ) != 0;
}
#elif defined(PL_LANES_BYTES) && defined(__AVX__)
PL_LANES_INLINE int pl_lanes_above(pl_lanes a, pl_lanes b)
{
    return _mm256_movemask_pd(_mm256_cmp_pd((__m256d)a, (__m256d)b, _CMP_NLE_UQ)) != 0;
}
PL_LANES_INLINE int pl_lanesf_above(pl_lanesf a, pl_lanesf b)
{
    return _mm256_movemask_ps(_mm256_cmp_ps((__m256)a, (__m256)b, _CMP_NLE_UQ)) != 0;
}
#elif defined(PL_LANES_BYTES) && defined(__SSE2__)
PL_LANES_INLINE int pl_lanes_above(pl_lanes a, pl_lanes b)
{
    return _mm_movemask_pd(_mm_cmpnle_pd((__m128d)a, (__m128d)b)) != 0;
}
PL_LANES_INLINE int pl_lanesf_above(pl_lanesf a, pl_lanesf b)
{
    return _mm_movemask_ps(_mm_cmpnle_ps((__m128)a, (__m128)b)) != 0;
}
#else
PL_LANES_INLINE int pl_lanes_above(pl_lanes a, pl_lanes b)
{
    double x[sizeof(pl_lanes) / sizeof(double)], y[sizeof(pl_lanes) / sizeof(double)];
    size_t i;
    int above = 0;
    memcpy(x, &a, sizeof a);
    memcpy(y, &b, sizeof b);
    for (i = 0; i < sizeof(pl_lanes) / sizeof(double); i++) {
        above |= !(x[i] <= y[i]);
    }
    return above;
}
PL_LANES_INLINE int pl_lanesf_above(pl_lanesf a, pl_lanesf b)
{
    float x[sizeof(pl_lanesf) / sizeof(float)], y[sizeof(pl_lanesf) / sizeof(float)];
    size_t i;
    int above = 0;
    memcpy(x, &a, sizeof a);
    memcpy(y, &b, sizeof b);
    for (i = 0; i < sizeof(pl_lanesf) / sizeof(float); i++) {
        above |= !(x[i] <= y[i]);
    }
    return above;
}
#endif

/* As pl_accumulate, in every lane */
PL_LANES_INLINE pl_lanes pl_lanes_accumulate(pl_lanes sum, pl_lanes term, pl_lanes small, pl_lanes *rest)
{
    const pl_lanes whole = sum + term, part = whole - sum;
    const pl_lanes error = ((sum - (whole - part)) + (term - part)) + (small + *rest), result = whole + error;
    *rest = error - (result - whole);
    return result;
}
PL_LANES_INLINE pl_lanesf pl_lanesf_accumulate(pl_lanesf sum, pl_lanesf term, pl_lanesf small, pl_lanesf *rest)
{
    const pl_lanesf whole = sum + term, part = whole - sum;
    const pl_lanesf error = ((sum - (whole - part)) + (term - part)) + (small + *rest), result = whole + error;
    *rest = error - (result - whole);
    return result;
}

#endif
