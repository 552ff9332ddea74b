/* SPDX-License-Identifier: MIT-0 */
/* digits.h: numbers to the fewest digits that read back, and back from digits, without printf and strtod.  For hosts:
 * plmain.c and the generator share it; no part of the runtime.
 *
 * Which decimal: of all that read back as the number those with the fewest digits, of these the nearest to it (of two
 * as near the even one).  How it is found: R. Giulietti, "The Schubfach way to render doubles" (2021).  Between the two
 * halfway points to the numbers beside it there are at most two multiples of 10^(k+1) to look at, and where none of
 * them reads back, of 10^k; one product with 128 bits of 10^-k decides about each, as no double comes closer to a
 * decision than these bits can tell without being equal to it. */
#ifndef PLRT_DIGITS_H
#define PLRT_DIGITS_H

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* ---- 10^k in 128 bits ---- */

typedef struct digits_pair {
	uint64_t hi, lo;
} digits_pair;

enum { DIGITS_LEAST_POWER = -292, DIGITS_MOST_POWER = 324 }; /* what a double may ask for */

/* Of 10^k the first 128 bits, rounded down, plus 1: 10^k is in [(hi lo) - 1, (hi lo)) 2^(digits_log2 - 127). */
static digits_pair digits_power[DIGITS_MOST_POWER - DIGITS_LEAST_POWER + 1];

/* floor(log2 10^k), |k| <= 1233 */
static inline int digits_log2(int k)
{
	return (int)(((int64_t)k * 1741647 + ((int64_t)4096 << 19)) >> 19) - 4096;
}

/* floor(log10 2^q), or of 3/4 2^q; |q| <= 1500 */
static inline int digits_log10(int q, int of_three_quarters)
{
	return (int)(((int64_t)q * 1262611 - (of_three_quarters ? 524031 : 0) + ((int64_t)1024 << 22)) >> 22) - 1024;
}

/* The first 128 bits of a number of `words` words of 32 bits, least significant first, plus 1 */
static inline digits_pair digits_first(const uint32_t *number, int words)
{
	uint64_t bits[3] = {0, 0, 0};
	digits_pair first;
	int top = words - 1, shift = 0, i;
	while (number[top] == 0)
		top--;
	while (!(number[top] << shift & 0x80000000u))
		shift++;
	for (i = 0; i < 5 && i <= top; i++)
		bits[i / 2] |= (uint64_t)number[top - i] << (i % 2 ? 0 : 32);
	first.hi = shift ? bits[0] << shift | bits[1] >> (64 - shift) : bits[0];
	first.lo = shift ? bits[1] << shift | bits[2] >> (64 - shift) : bits[1];
	first.lo++;
	first.hi += first.lo == 0;
	return first;
}

/* The powers, each from the one before: 5^k exactly, and 2^831/5^k rounded down, which is that of the one before by 5.
 * Some 20,000 operations, once. */
static void digits_open(void)
{
	enum { WORDS = 26 };
	uint32_t up[WORDS] = {1}, down[WORDS] = {0};
	int k, i;
	down[WORDS - 1] = 0x80000000u;
	for (k = 0; k <= DIGITS_MOST_POWER; k++) {
		uint64_t carry = 0;
		digits_power[k - DIGITS_LEAST_POWER] = digits_first(up, WORDS);
		for (i = 0; i < WORDS; i++) {
			carry += (uint64_t)up[i] * 5;
			up[i] = (uint32_t)carry;
			carry >>= 32;
		}
	}
	for (k = -1; k >= DIGITS_LEAST_POWER; k--) {
		uint64_t rest = 0;
		for (i = WORDS - 1; i >= 0; i--) {
			rest = rest << 32 | down[i];
			down[i] = (uint32_t)(rest / 5);
			rest %= 5;
		}
		digits_power[k - DIGITS_LEAST_POWER] = digits_first(down, WORDS);
	}
}

static inline digits_pair digits_power_of_ten(int k)
{
	if (digits_power[0].hi == 0)
		digits_open();
	return digits_power[k - DIGITS_LEAST_POWER];
}

/* a b in full, by halves */
static inline digits_pair digits_by_halves(uint64_t a, uint64_t b)
{
	const uint64_t half = 0xFFFFFFFFu;
	const uint64_t low = (a & half) * (b & half);
	const uint64_t middle = (a >> 32) * (b & half) + (low >> 32);
	const uint64_t cross = (a & half) * (b >> 32) + (middle & half);
	digits_pair p;
	p.lo = cross << 32 | (low & half);
	p.hi = (a >> 32) * (b >> 32) + (middle >> 32) + (cross >> 32);
	return p;
}

static inline digits_pair digits_product(uint64_t a, uint64_t b)
{
#ifdef __SIZEOF_INT128__
	__extension__ typedef unsigned __int128 wide;
	digits_pair p;
	p.hi = (uint64_t)((wide)a * b >> 64);
	p.lo = a * b;
	return p;
#else
	return digits_by_halves(a, b);
#endif
}

/* ---- a number to decimal ---- */

typedef struct digits_decimal {
	uint64_t digits; /* the last one not 0, except of 0 */
	int exponent;    /* digits 10^exponent */
} digits_decimal;

/* A type's numbers: significands of `bits` bits times 2^q, q >= least */
typedef struct digits_type {
	int bits, least;
} digits_type;

static const digits_type digits_of_double = {53, -1074}, digits_of_float = {24, -149};

/* c power 2^-128 with a last bit that is 1 where something is cut off behind it (round to odd).  power is a little
 * above 10^k: below 2 2^-64 is what that may add to a whole number. */
static inline uint64_t digits_scaled(digits_pair power, uint64_t c)
{
	const digits_pair low = digits_product(power.lo, c), high = digits_product(power.hi, c);
	const uint64_t rest = high.lo + low.hi;
	return (high.hi + (rest < high.lo)) | (rest > 1);
}

static inline digits_decimal digits_stripped(uint64_t digits, int exponent)
{
	digits_decimal d;
	if (digits % 100000000 == 0) {
		digits /= 100000000;
		exponent += 8;
	}
	if (digits % 10000 == 0) {
		digits /= 10000;
		exponent += 4;
	}
	while (digits % 10 == 0) {
		digits /= 10;
		exponent++;
	}
	d.digits = digits;
	d.exponent = exponent;
	return d;
}

/* c 2^q > 0 of this type, all in quarters of 10^k: it, and the halfway points, which read back where c is even */
static digits_decimal digits_between(const digits_type *type, uint64_t c, int q)
{
	const int power_of_two = c == (uint64_t)1 << (type->bits - 1)
			&& q > type->least; /* numbers lie closer below it */
	const int k = digits_log10(q, power_of_two), shift = q + digits_log2(-k) + 1;
	const digits_pair power = digits_power_of_ten(-k);
	const uint64_t odd = c & 1, value = digits_scaled(power, 4 * c << shift);
	const uint64_t lower = digits_scaled(power, (4 * c - (power_of_two ? 1 : 2)) << shift) + odd;
	const uint64_t upper = digits_scaled(power, (4 * c + 2) << shift) - odd;
	const uint64_t below = value / 4;
	if (below >= 10) {
		const uint64_t ten = below / 10 * 10;
		const int ten_reads = lower <= 4 * ten, next_reads = 4 * ten + 40 <= upper;
		if (ten_reads != next_reads)
			return digits_stripped(ten + (next_reads ? 10 : 0), k);
	}
	{
		const int below_reads = lower <= 4 * below, above_reads = 4 * below + 4 <= upper;
		const uint64_t middle = 4 * below + 2;
		const int nearer = value > middle || (value == middle && (below & 1));
		return digits_stripped(below + (uint64_t)(below_reads != above_reads ? above_reads : nearer), k);
	}
}

/* Of |value|, which is finite; float: (double)value, of a float */
static inline digits_decimal digits_shortest(double value, int is_float)
{
	digits_decimal zero = {0, 0};
	uint64_t bits, c;
	uint32_t single;
	int exponent;
	if (is_float) {
		const float narrow = (float)value;
		memcpy(&single, &narrow, sizeof single);
		c = single & 0x7FFFFFu;
		exponent = (int)(single >> 23 & 0xFF);
		c |= exponent ? 0x800000u : 0;
	} else {
		memcpy(&bits, &value, sizeof bits);
		c = bits & 0xFFFFFFFFFFFFFu;
		exponent = (int)(bits >> 52 & 0x7FF);
		c |= exponent ? (uint64_t)1 << 52 : 0;
	}
	if (c == 0)
		return zero;
	exponent -= exponent != 0;
	return is_float ? digits_between(&digits_of_float, c, exponent + digits_of_float.least)
					: digits_between(&digits_of_double, c, exponent + digits_of_double.least);
}

/* ---- decimal to text ---- */

/* The last `count` digits, eight at a time and of these two, so that divisions are of 32 bits */
static inline void digits_put(char *to, uint64_t digits, int count)
{
	static const char pairs[] = "0001020304050607080910111213141516171819"
								"2021222324252627282930313233343536373839"
								"4041424344454647484950515253545556575859"
								"6061626364656667686970717273747576777879"
								"8081828384858687888990919293949596979899";
	while (count > 0) {
		uint32_t eight = (uint32_t)(digits % 100000000);
		const int first = count > 8 ? count - 8 : 0;
		digits /= 100000000;
		for (; count > first + 1; eight /= 100)
			memcpy(to + (count -= 2), pairs + 2 * (eight % 100), 2);
		if (count > first)
			to[count = first] = (char)('0' + eight % 10);
	}
}

/* Of digits < 10^17 */
static inline int digits_count(uint64_t digits)
{
	uint64_t power = 10;
	int count = 1;
	if (digits >= 1000000000000000) /* as most have */
		return digits < 10000000000000000 ? 16 : 17;
	for (; digits >= power; power *= 10)
		count++;
	return count;
}

/* d.ddde-05 */
static inline char *digits_scientific(char *to, uint64_t digits, int count, int power)
{
	const int size = power < 0 ? -power : power, places = size < 100 ? 2 : 3;
	digits_put(to + 1, digits, count);
	to[0] = to[1];
	to[1] = '.';
	to += count > 1 ? count + 1 : 1;
	*to++ = 'e';
	*to++ = power < 0 ? '-' : '+';
	digits_put(to, (uint64_t)size, places);
	return to + places;
}

/* As printf("%.*g") with `places`, or with as many as there are digits where these are more: with an exponent below
 * 1e-4 and from 10^places on.  Returns the end; at most 24 characters, no NUL. */
static inline char *digits_text(char *to, digits_decimal d, int places)
{
	const int count = digits_count(d.digits), point = count + d.exponent; /* digits before the point */
	if (point < -3 || point > (count > places ? count : places))
		return digits_scientific(to, d.digits, count, point - 1);
	if (point <= 0) {
		memcpy(to, "0.000", 5);
		digits_put(to + 2 - point, d.digits, count);
		return to + 2 - point + count;
	}
	if (point >= count) {
		digits_put(to, d.digits, count);
		memset(to + count, '0', (size_t)(point - count));
		return to + point;
	}
	digits_put(to + 1, d.digits, count);
	memmove(to, to + 1, (size_t)point);
	to[point] = '.';
	return to + count + 1;
}

/* ---- text to number ---- */

/* digits 10^exponent to the nearest double, where 128 bits of the power decide it; 0: they do not.  digits > 0 */
static inline int digits_nearest(uint64_t digits, int exponent, double *value)
{
	digits_pair power, high, low;
	uint64_t rest, bits, cut;
	int shift = 0, q;
	if (exponent < DIGITS_LEAST_POWER || exponent > DIGITS_MOST_POWER)
		return 0;
	while (!(digits >> 63)) {
		digits <<= 1;
		shift++;
	}
	power = digits_power_of_ten(exponent);
	high = digits_product(power.hi, digits);
	low = digits_product(power.lo, digits);
	rest = high.lo + low.hi;
	high.hi += rest < high.lo; /* high.hi, rest: the product without its last 64 bits, too large by less than 1 */
	q = digits_log2(exponent) + 64 - shift; /* high.hi 2^(q-63): the number is below 2^(q+1) */
	if (!(high.hi >> 63)) {
		high.hi = high.hi << 1 | rest >> 63;
		rest <<= 1;
		q--;
	}
	/* all that it may be lies on one side of the halfway point, and is a normal number */
	cut = high.hi & 0x7FF;
	if ((cut == 0x400 && rest < 4) || (cut == 0x3FF && rest > (uint64_t)-5) || q < -1022 || q > 1022)
		return 0;
	bits = (high.hi >> 11) + (cut >> 10) + ((uint64_t)(q + 1022) << 52);
	memcpy(value, &bits, sizeof bits);
	return 1;
}

/* strtod, and the same number */
static inline double digits_read(const char *text, char **end)
{
	const char *p = text;
	const int negative = *p == '-';
	uint64_t digits = 0;
	int read = 0, exponent = 0, significant = 0, point = 0;
	double value = 0;
	for (p += *p == '-' || *p == '+'; (*p >= '0' && *p <= '9') || (*p == '.' && !point); p++) {
		if (*p == '.') {
			point = 1;
			continue;
		}
		digits = 10 * digits + (uint64_t)(*p - '0');
		significant += significant != 0 || *p != '0';
		exponent -= point;
		if (++read > 400 || significant > 19)
			return strtod(text, end);
	}
	if (read == 0 || *p == 'x' || *p == 'X')
		return strtod(text, end);
	if (*p == 'e' || *p == 'E') {
		const int down = p[1] == '-';
		int power = 0, places = 0;
		for (p += 1 + (p[1] == '-' || p[1] == '+'); *p >= '0' && *p <= '9' && places < 4; p++, places++)
			power = 10 * power + (*p - '0');
		if (places == 0 || places == 4)
			return strtod(text, end);
		exponent += down ? -power : power;
	}
	if (digits != 0 && !digits_nearest(digits, exponent, &value))
		return strtod(text, end);
	*end = (char *)(size_t)p; /* as strtod's, not const */
	return negative ? -value : value;
}

#endif
