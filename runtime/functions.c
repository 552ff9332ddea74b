/* SPDX-License-Identifier: MIT-0 */
/* sin, cos, exp, log and their kin with the same bits on every target: --math own.  Angles and exponents become
 * integers of phases.c and envelope.c; logarithms, powers and arcs are double-double sums.  The bits are the same
 * wherever products are rounded before they are added: on targets with fused multiply-adds that takes -ffp-
 * contract=off. */
#include "two.h"
#include "words.h"

#define NOT_A_NUMBER(x) (((x) - (x)) / ((x) - (x)))

static real_parts parts_of(double x)
{
	real_parts p;
	p.value = x;
	return p;
}

static int is_negative(double x)
{
	return (int)(parts_of(x).bits >> 63);
}

/* |x| with the sign of `sign` */
static double signed_as(double x, double sign)
{
	real_parts p = parts_of(x);
	p.bits = (p.bits & ~((uint64_t)1 << 63)) | (parts_of(sign).bits & (uint64_t)1 << 63);
	return p.value;
}

static double size_of(double x)
{
	return signed_as(x, 1.0);
}

/* 2^k, a normal number */
static double power_of_2(int k)
{
	real_parts p;
	p.bits = (uint64_t)(k + 1023) << 52;
	return p.value;
}

/* x > 0 as m 2^k, 1 <= m < 2 */
static double split(double x, int *k)
{
	const int subnormal = x < 0x1p-1022;
	real_parts p = parts_of(subnormal ? x * 0x1p54 : x);
	*k = (int)(p.bits >> 52) - 1023 - (subnormal ? 54 : 0);
	p.bits = (p.bits & REAL_FRACTION) | (uint64_t)1023 << 52;
	return p.value;
}

/* ---- double-double ---- */

static pl_two quotient(pl_two a, pl_two b)
{
	const double q = a.hi / b.hi;
	const pl_two p = two_product(q, b.hi);
	const double rest = ((a.hi - p.hi) - p.lo) + (a.lo - q * b.lo);
	return two_sum(q, rest / b.hi);
}

static pl_two negative(pl_two a)
{
	return two(-a.hi, -a.lo);
}

/* ---- angles ---- */

/* x as a fraction of a turn: of 1/(2 pi) those 192 bits that tell; bits above them give whole turns. */
static pl_phase turn_of(double x)
{
	static const uint64_t turns[] = { /* 1/(2 pi) 2^1280 */
		0x28BE60DB9391054Au, 0x7F09D5F47D4D3770u, 0x36D8A5664F10E410u, 0x7F9458EAF7AEF158u, 0x6DC91B8E909374B8u,
		0x01924BBA82746487u, 0x3F877AC72C4A69CFu, 0xBA208D7D4BAED121u, 0x3A671C09AD17DF90u, 0x4E64758E60D4CE7Du,
		0x272117E2EF7E4A0Eu, 0xC7FE25FFF7816603u, 0xFBCBC462D6829B47u, 0xDB4D9FB3C9F2C26Du, 0xD3D18FD9A797FA8Bu,
		0x5D49EEB1FAF97C5Eu, 0xCF41CE7DE294A4BAu, 0x9AFED7EC47E35742u, 0x1580CC11BF1EDAEAu, 0xFC33EF0826BD0D87u
	};
	pl_rate rate;
	int k, i, bit;
	(void)split(size_of(x), &k);
	k = k > 52 ? k - 52 : 0;
	bit = k % 64;
	for (i = 0; i < 3; i++) {
		const uint64_t *w = &turns[k / 64 + i];
		rate.word[i] = bit ? w[0] << bit | w[1] >> (64 - bit) : w[0];
	}
	rate.exponent = 192;
	return pl_phase_at(&rate, x * power_of_2(-k));
}

/* z[0] = cos x, z[1] = sin x */
static void cossin(double x, double z[2])
{
	if (!is_finite(x)) {
		z[0] = z[1] = NOT_A_NUMBER(x);
	} else if (size_of(x) < 0x1p-27) {
		z[0] = 1.0;
		z[1] = x;
	} else {
		pl_cossin(turn_of(x), z);
	}
}

double pl_sin(double x)
{
	double z[2];
	cossin(x, z);
	return z[1];
}

double pl_cos(double x)
{
	double z[2];
	cossin(x, z);
	return z[0];
}

double pl_tan(double x)
{
	double z[2];
	cossin(x, z);
	return z[1] / z[0];
}

/* ---- exponentials ---- */

/* x / ln 2 */
static pl_envelope exponent_of(double x)
{
	static const pl_rate per_e = {{0xB8AA3B295C17F0BBu, 0xBE87FED0691D3E88u, 0xEB577AA8DD695A59u}, 191};
	return pl_envelope_at(&per_e, 0, x);
}

double pl_exp(double x)
{
	return x != x ? x : pl_envelope_value(exponent_of(x));
}

/* e^|x| / 2 */
static double half_exponential(double x)
{
	const pl_envelope less = {-((int64_t)1 << 48), 0};
	return pl_envelope_value(pl_envelope_add(exponent_of(size_of(x)), less));
}

double pl_sinh(double x)
{
	double sum = 0.0, half;
	int j;
	if (!(size_of(x) >= 0.5)) {
		for (j = 9; j > 0; j--) {
			sum = (1.0 + sum) * (x * x) / (2 * j * (2 * j + 1));
		}
		return x + x * sum;
	}
	half = half_exponential(x);
	return signed_as(half - 0.25 / half, x);
}

double pl_cosh(double x)
{
	const double half = half_exponential(x);
	return x != x ? x : half + 0.25 / half;
}

double pl_tanh(double x)
{
	if (!(size_of(x) >= 0.5)) {
		return pl_sinh(x) / pl_cosh(x);
	}
	return signed_as(1.0 - 2.0 / (pl_exp(2.0 * size_of(x)) + 1.0), x);
}

/* ---- logarithms and powers ---- */

static pl_two reciprocal(int n)
{
	return quotient(two(1.0, 0.0), two(n, 0.0));
}

/* ln x for x > 0, finite: k ln 2 + 2 artanh((m - 1)/(m + 1)), sqrt(1/2) < m < sqrt(2) */
static pl_two logarithm(double x)
{
	int k, j;
	double m = split(x, &k);
	pl_two s, ss, sum;
	if (m > 0x1.6a09e667f3bcdp0) {
		m *= 0.5;
		k++;
	}
	s = quotient(two(m - 1.0, 0.0), two_sum(m, 1.0));
	ss = multiply(s, s);
	sum = reciprocal(45);
	for (j = 43; j > 0; j -= 2) {
		sum = add(multiply(sum, ss), reciprocal(j));
	}
	sum = multiply(s, sum);
	return add(multiply(two(k, 0.0), two(0x1.62e42fefa39efp-1, 0x1.abc9e3b39803fp-56)),
			   two(2.0 * sum.hi, 2.0 * sum.lo));
}

double pl_log(double x)
{
	if (x == 0.0) {
		return -1.0 / (x * x);
	}
	if (!(x > 0.0)) {
		return NOT_A_NUMBER(x);
	}
	return is_finite(x) ? logarithm(x).hi : x;
}

/* 0: y is no integer; 1: an odd one; 2: an even one */
static int parity(double y)
{
	const double size = size_of(y);
	if (size >= 0x1p53) {
		return 2;
	}
	return size != (double)(uint64_t)size ? 0 : (uint64_t)size & 1 ? 1 : 2;
}

/* |x|^y, x neither 0 nor infinite */
static double power_of_size(double x, double y)
{
	const pl_two t = multiply(two(y, 0.0), logarithm(size_of(x)));
	const double low = size_of(t.hi) < 0x1p10 ? t.lo : 0.0; /* beyond that the power is 0 or infinite */
	return pl_envelope_value(pl_envelope_add(exponent_of(t.hi), exponent_of(low)));
}

double pl_pow(double x, double y)
{
	const int whole = parity(y);
	double size;
	if (x == 1.0 || y == 0.0) {
		return 1.0;
	}
	if (x != x || y != y) {
		return x + y;
	}
	if (!is_finite(y) && size_of(x) == 1.0) {
		return 1.0;
	}
	if (x == 0.0 || !is_finite(x)) {
		size = (x == 0.0) == (y > 0.0) ? 0.0 : 1.0 / 0.0;
	} else if (x < 0.0 && whole == 0) {
		return NOT_A_NUMBER(x);
	} else {
		size = power_of_size(x, y);
	}
	return whole == 1 && is_negative(x) ? -size : size;
}

/* The root in 54 bits, one by one, the last for rounding: no root is half way between two numbers. */
double pl_sqrt(double x)
{
#ifdef __wasm__
	return __builtin_sqrt(x);
#else
	uint64_t bits, rest = 0, root = 0;
	int k, i;
	if (x == 0.0 || !(x > 0.0) || !is_finite(x)) {
		return x == 0.0 || x > 0.0 ? x : NOT_A_NUMBER(x);
	}
	bits = (uint64_t)(split(x, &k) * 0x1p52);
	bits <<= k & 1;
	for (i = 26; i >= -27; i--) {
		const uint64_t next = i >= 0 ? bits >> 2 * i & 3 : 0, trial = root << 2 | 1;
		rest = rest << 2 | next;
		root <<= 1;
		if (rest >= trial) {
			rest -= trial;
			root |= 1;
		}
	}
	return (double)((root + 1) >> 1) * power_of_2((k - (k & 1)) / 2 - 52);
#endif
}

/* ---- arcs ---- */

/* arctan(k/8), exact to 106 bits */
static pl_two eighth(int k)
{
	static const double arc[9][2] = {
		{0.0, 0.0}, {0x1.fd5ba9aac2f6ep-4, -0x1.cd37686760c17p-59},
				{0x1.f5b75f92c80ddp-3, 0x1.8ab6e3cf7afbdp-57},
		{0x1.6f61941e4def1p-2, -0x1.c63aae6f6e918p-56}, {0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56},
		{0x1.1e00babdefeb4p-1, -0x1.928df287a668fp-58}, {0x1.4978fa3269ee1p-1, 0x1.2419a87f2a458p-56},
		{0x1.700a7c5784634p-1, -0x1.8c34d25aadef6p-56}, {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55}
	};
	return two(arc[k][0], arc[k][1]);
}

/* arctan(y/x) for 0 <= y <= x, 1 <= x < 2: that of k/8 next to it, and a series for what is left */
static pl_two small_arc(pl_two y, pl_two x)
{
	const double ratio = y.hi / x.hi;
	const int k = (int)(8.0 * ratio + 0.5);
	const pl_two c = two(0.125 * k, 0.0);
	double tt, rest = 0.0;
	pl_two t;
	int j;
	if (ratio < 0x1p-30) {
		return two(ratio, 0.0);
	}
	t = quotient(add(y, negative(multiply(c, x))), add(x, multiply(c, y)));
	tt = t.hi * t.hi;
	for (j = 10; j > 0; j--) {
		rest = 1.0 / (2 * j + 1) - tt * rest;
	}
	return add(eighth(k), add(t, two(-t.hi * tt * rest, 0.0)));
}

/* The angle of the point (x, y), not both 0, from -pi to pi; its double-double words are scaled so that no product
 * leaves the range. */
static double angle(pl_two y, pl_two x)
{
	const pl_two quarter = two(0x1.921fb54442d18p0, 0x1.1a62633145c07p-54);
	pl_two a = y.hi < 0.0 ? negative(y) : y, b = x.hi < 0.0 ? negative(x) : x, arc;
	const int steep = a.hi > b.hi;
	double unit, half;
	int k;
	(void)split(steep ? a.hi : b.hi, &k);
	half = power_of_2(-(k / 2));
	unit = power_of_2(k / 2 - k);
	a = two(a.hi * half * unit, a.lo * half * unit);
	b = two(b.hi * half * unit, b.lo * half * unit);
	arc = steep ? add(quarter, negative(small_arc(b, a))) : small_arc(a, b);
	if (is_negative(x.hi)) {
		arc = add(add(quarter, quarter), negative(arc));
	}
	return signed_as(arc.hi, y.hi);
}

double pl_atan2(double y, double x)
{
	if (x != x || y != y) {
		return x + y;
	}
	if (!is_finite(x) || !is_finite(y)) {
		const double to = is_finite(x) ? 0.0 : 1.0, up = is_finite(y) ? 0.0 : 1.0;
		return angle(two(signed_as(up, y), 0.0), two(signed_as(to, x), 0.0));
	}
	if (y == 0.0 && x == 0.0) {
		return angle(two(y, 0.0), two(signed_as(1.0, x), 0.0));
	}
	return angle(two(y, 0.0), two(x, 0.0));
}

double pl_atan(double x)
{
	return pl_atan2(x, 1.0);
}

/* sqrt(1 - x^2) for |x| <= 1 */
static pl_two other_leg(double x)
{
	const pl_two square = multiply(two_sum(1.0, -x), two_sum(1.0, x));
	const double root = pl_sqrt(square.hi);
	const pl_two back = two_product(root, root);
	return root == 0.0 ? two(0.0, 0.0)
					   : two_sum(root, (((square.hi - back.hi) - back.lo)
							+ square.lo) / (2.0 * root));
}

double pl_asin(double x)
{
	return size_of(x) <= 1.0 ? angle(two(x, 0.0), other_leg(x)) : NOT_A_NUMBER(x);
}

double pl_acos(double x)
{
	return size_of(x) <= 1.0 ? angle(other_leg(x), two(x, 0.0)) : NOT_A_NUMBER(x);
}
