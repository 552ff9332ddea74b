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
#define PL_LANES_MASK __mmask16
#define PL_LANES_CALL(front, back) front##ps##back
#else
#define PL_LANES_OF_DOUBLES
#define PL_LANES_BITS int64_t
#define PL_LANES_MAGNITUDE INT64_MAX
#define PL_LANES_MASK __mmask8
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

/* What is so in some lanes: of each lane a bit, all its bits, or of a single one whether it is not 0 */
#if defined(__GNUC__) && defined(__AVX512F__)
typedef unsigned pl_lanes_truth;
#elif defined(__GNUC__) && defined(__SSE2__)
typedef pl_lanes pl_lanes_truth;
#elif defined(__GNUC__) && defined(__ARM_NEON) && defined(__aarch64__)
typedef pl_lanes_bits pl_lanes_truth;
#else
typedef int pl_lanes_truth;
#endif
PL_LANES_INLINE pl_lanes_truth pl_lanes_below(pl_lanes a, pl_lanes b)
{
#if defined(__GNUC__) && defined(__AVX512F__)
	return (pl_lanes_truth)PL_LANES_CALL(_mm512_cmp_, _mask)(a, b, _CMP_LT_OQ);
#elif defined(__GNUC__) && defined(__AVX__)
	return PL_LANES_CALL(_mm256_cmp_, )(a, b, _CMP_LT_OQ);
#elif defined(__GNUC__) && defined(__SSE2__)
	return PL_LANES_CALL(_mm_cmplt_, )(a, b);
#elif defined(__GNUC__) && defined(__ARM_NEON) && defined(__aarch64__)
	return (pl_lanes_bits)(a < b);
#else
	return a < b;
#endif
}
PL_LANES_INLINE pl_lanes_truth pl_lanes_equal(pl_lanes a, pl_lanes b)
{
#if defined(__GNUC__) && defined(__AVX512F__)
	return (pl_lanes_truth)PL_LANES_CALL(_mm512_cmp_, _mask)(a, b, _CMP_EQ_OQ);
#elif defined(__GNUC__) && defined(__AVX__)
	return PL_LANES_CALL(_mm256_cmp_, )(a, b, _CMP_EQ_OQ);
#elif defined(__GNUC__) && defined(__SSE2__)
	return PL_LANES_CALL(_mm_cmpeq_, )(a, b);
#elif defined(__GNUC__) && defined(__ARM_NEON) && defined(__aarch64__)
	return (pl_lanes_bits)(a == b);
#else
	return a <= b && a >= b;
#endif
}
/* Both of two, either; a where it is so, b elsewhere */
PL_LANES_INLINE pl_lanes_truth pl_lanes_both(pl_lanes_truth a, pl_lanes_truth b)
{
#if defined(__GNUC__) && defined(__AVX512F__)
	return a & b;
#elif defined(__GNUC__) && defined(__AVX__)
	return PL_LANES_CALL(_mm256_and_, )(a, b);
#elif defined(__GNUC__) && defined(__SSE2__)
	return PL_LANES_CALL(_mm_and_, )(a, b);
#elif defined(__GNUC__) && defined(__ARM_NEON) && defined(__aarch64__)
	return a & b;
#else
	return a & b;
#endif
}
PL_LANES_INLINE pl_lanes_truth pl_lanes_either(pl_lanes_truth a, pl_lanes_truth b)
{
#if defined(__GNUC__) && defined(__AVX512F__)
	return a | b;
#elif defined(__GNUC__) && defined(__AVX__)
	return PL_LANES_CALL(_mm256_or_, )(a, b);
#elif defined(__GNUC__) && defined(__SSE2__)
	return PL_LANES_CALL(_mm_or_, )(a, b);
#elif defined(__GNUC__) && defined(__ARM_NEON) && defined(__aarch64__)
	return a | b;
#else
	return a | b;
#endif
}
PL_LANES_INLINE pl_lanes pl_lanes_choose(pl_lanes_truth which, pl_lanes a, pl_lanes b)
{
#if defined(__GNUC__) && defined(__AVX512F__)
	return PL_LANES_CALL(_mm512_mask_blend_, )((PL_LANES_MASK)which, b, a);
#elif defined(__GNUC__) && defined(__AVX__)
	return PL_LANES_CALL(_mm256_blendv_, )(b, a, which);
#elif defined(__GNUC__) && defined(__SSE2__)
	return PL_LANES_CALL(_mm_or_, )(PL_LANES_CALL(_mm_and_, )(which, a), PL_LANES_CALL(_mm_andnot_, )(which, b));
#elif defined(__GNUC__) && defined(__ARM_NEON) && defined(__aarch64__)
	return (pl_lanes)(((pl_lanes_bits)a & which) | ((pl_lanes_bits)b & ~which));
#else
	return which ? a : b;
#endif
}
/* Of each lane a bit, the first in the lowest */
PL_LANES_INLINE unsigned pl_lanes_flags(pl_lanes_truth a)
{
#if defined(__GNUC__) && defined(__AVX512F__)
	return a;
#elif defined(__GNUC__) && defined(__AVX__)
	return (unsigned)PL_LANES_CALL(_mm256_movemask_, )(a);
#elif defined(__GNUC__) && defined(__SSE2__)
	return (unsigned)PL_LANES_CALL(_mm_movemask_, )(a);
#else
	PL_LANES_BITS bit[sizeof(pl_lanes) / sizeof(real)] = {0};
	unsigned flags = 0;
	size_t i;
	memcpy(bit, &a, sizeof a);
	for (i = 0; i < sizeof(pl_lanes) / sizeof(real); i++) {
		flags |= (bit[i] != 0 ? 1u : 0u) << i;
	}
	return flags;
#endif
}

/* The larger, the smaller of two: b where they are equal or one is not a number */
PL_LANES_INLINE pl_lanes pl_lanes_larger(pl_lanes a, pl_lanes b)
{
#if defined(__GNUC__) && defined(__AVX512F__)
	return PL_LANES_CALL(_mm512_max_, )(a, b);
#elif defined(__GNUC__) && defined(__AVX__)
	return PL_LANES_CALL(_mm256_max_, )(a, b);
#elif defined(__GNUC__) && defined(__SSE2__)
	return PL_LANES_CALL(_mm_max_, )(a, b);
#else
	return pl_lanes_choose(pl_lanes_below(b, a), a, b);
#endif
}
PL_LANES_INLINE pl_lanes pl_lanes_smaller(pl_lanes a, pl_lanes b)
{
#if defined(__GNUC__) && defined(__AVX512F__)
	return PL_LANES_CALL(_mm512_min_, )(a, b);
#elif defined(__GNUC__) && defined(__AVX__)
	return PL_LANES_CALL(_mm256_min_, )(a, b);
#elif defined(__GNUC__) && defined(__SSE2__)
	return PL_LANES_CALL(_mm_min_, )(a, b);
#else
	return pl_lanes_choose(pl_lanes_below(a, b), a, b);
#endif
}

/* The larger of `peak` and |value|, lane by lane; not a number where value is none */
PL_LANES_INLINE pl_lanes pl_lanes_peak(pl_lanes peak, pl_lanes value)
{
	return pl_lanes_larger(peak, pl_lanes_size(value));
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

/* All lanes of numbers in a row; where the next ones begin of `count` numbers, which fill lanes at least once: the last
 * ones may be some of those before again. */
PL_LANES_INLINE pl_lanes pl_lanes_at(const real *from)
{
	return pl_lanes_load(from, sizeof(pl_lanes) / sizeof(real));
}
PL_LANES_INLINE void pl_lanes_put(real *to, pl_lanes all)
{
	memcpy(to, &all, sizeof all);
}
PL_LANES_INLINE size_t pl_lanes_next(size_t at, size_t count)
{
	const size_t lanes = sizeof(pl_lanes) / sizeof(real);
	return at + lanes == count ? count : at + 2 * lanes > count ? count - lanes : at + lanes;
}

/* The same number in every lane */
PL_LANES_INLINE pl_lanes pl_lanes_all(real value)
{
	const pl_lanes zero = pl_lanes_load(&value, 0);
	return zero + value;
}

/* `value`, and 0 where |of| < least, lane by lane */
PL_LANES_INLINE pl_lanes pl_lanes_kept(pl_lanes of, pl_lanes value, pl_lanes least)
{
	return pl_lanes_choose(pl_lanes_below(pl_lanes_size(of), least), pl_lanes_all(0), value);
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
#undef PL_LANES_MASK
#undef PL_LANES_MAGNITUDE
#endif

#include "undef.h"
