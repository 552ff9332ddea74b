/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Numbers that count: generated C is compiled as C++ with this for `double` (g++ -x c++ -include counted.h), and what
 * it computes then says how many operations it took and when its result could be there, were there no end of units to
 * compute with: the longest chain of operations that wait for each other.  Products that are added may be fused. */
#ifndef COUNTED_H
#define COUNTED_H

#include <stddef.h>                 /* before `double` becomes another word; no <math.h>: linear models */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef double plain;

struct counted {
	plain value;                /* first: its bits are read through a union */
	plain ready;                /* [ns] when it is there */
	plain factors;              /* of a product: when its factors are; of anything else below 0 */
	counted() = default;
	template <class T> constexpr counted(T number) : value(static_cast<plain>(number)), ready(0), factors(-1) {}
	template <class T> explicit operator T() const { return static_cast<T>(value); }
	explicit operator bool() const { return value != 0; }
};

/* Latencies [ns]; fused below 0: there is no such instruction */
struct counts {
	plain add, multiply, fused;
	long additions, multiplications, pairs, divisions;
	plain latest;               /* of all results */
};
extern counts tally;

inline counted counted_at(plain value, plain ready, plain factors)
{
	counted x(value);
	x.ready = ready;
	x.factors = factors;
	tally.latest = ready > tally.latest ? ready : tally.latest;
	return x;
}

inline plain later(plain a, plain b)
{
	return a > b ? a : b;
}

inline plain sooner(plain a, plain b)
{
	return a < b ? a : b;
}

inline counted counted_sum(counted a, counted b, plain value)
{
	plain ready = later(a.ready, b.ready) + tally.add;
	bool pair = tally.fused >= 0 && (a.factors >= 0 || b.factors >= 0);
	tally.additions++;
	tally.pairs += pair;
	if (pair && a.factors >= 0)
		ready = sooner(ready, later(a.factors, b.ready) + tally.fused);
	if (pair && b.factors >= 0)
		ready = sooner(ready, later(b.factors, a.ready) + tally.fused);
	return counted_at(value, ready, -1);
}

inline counted operator+(counted a, counted b) { return counted_sum(a, b, a.value + b.value); }
inline counted operator-(counted a, counted b) { return counted_sum(a, b, a.value - b.value); }

inline counted operator*(counted a, counted b)
{
	plain both = later(a.ready, b.ready);
	tally.multiplications++;
	return counted_at(a.value * b.value, both + tally.multiply, both);
}

inline counted operator/(counted a, counted b)
{
	tally.divisions++;
	return counted_at(a.value / b.value, later(a.ready, b.ready) + tally.multiply, -1); /* at the least */
}

/* A sign costs nothing where it is an operand of what follows */
inline counted operator-(counted a)
{
	a.value = -a.value;
	return a;
}
inline counted operator+(counted a) { return a; }
inline counted counted_magnitude(counted a) { return a.value < 0 ? -a : a; }
#define __builtin_fabs counted_magnitude  /* of the runtime */
inline counted &operator+=(counted &a, counted b) { return a = a + b; }
inline counted &operator-=(counted &a, counted b) { return a = a - b; }
inline counted &operator*=(counted &a, counted b) { return a = a * b; }
inline counted &operator/=(counted &a, counted b) { return a = a / b; }
inline bool operator<(counted a, counted b) { return a.value < b.value; }
inline bool operator>(counted a, counted b) { return a.value > b.value; }
inline bool operator<=(counted a, counted b) { return a.value <= b.value; }
inline bool operator>=(counted a, counted b) { return a.value >= b.value; }
inline bool operator==(counted a, counted b) { return a.value == b.value; }
inline bool operator!=(counted a, counted b) { return a.value != b.value; }

#define double counted
#define volatile            /* rounds what a wide register holds; here is none */

#endif
