/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "random_spec.h"
#include "drawn.h"
#include "base/base.h"


#include <string.h>

enum { LARGEST = 4 };

/* 1 to 17 digits, first not 0, times 10^(low..high); a third are as short as a person would write them */
static char *number(int low, int high)
{
	const int digits = chance(35) ? 1 : 1 + (int)below(17), power = low + (int)below((unsigned)(high - low) + 1);
	char text[32] = { 0 };
	for (int i = 0; i < digits; i++)
		text[i] = (char)('0' + (i == 0 ? 1 + below(9) : below(10)));
	return format("%c.%se%d", text[0], text + 1, power);
}

static char *signed_number(int low, int high)
{
	return format("%s%s", chance(50) ? "-" : "", number(low, high));
}

struct equations {
	int n;
	bool first_order[LARGEST];
	char *left[LARGEST];
};

static void add(struct equations *e, int row, const char *factor, int coord, const char *primes)
{
	e->left[row] = format("%s + %s*x%d%s", e->left[row], factor, coord + 1, primes);
}

/* factor (x_i - x_j) in both equations; j = n: the ground */
static void connect(struct equations *e, int i, int j, const char *factor, const char *primes)
{
	add(e, i, factor, i, primes);
	if (j == e->n)
		return;
	add(e, j, factor, j, primes);
	add(e, i, format("(-%s)", factor), j, primes);
	add(e, j, format("(-%s)", factor), i, primes);
}

static void add_chain(struct equations *e, int low, int high, const char *primes, unsigned ground)
{
	for (int i = 0; i < e->n; i++) {
		if (i + 1 < e->n)
			connect(e, i, i + 1, number(low, high), primes);
		if (chance(ground))
			connect(e, i, e->n, number(low, high), primes);
	}
}

/* Whole matrices with some zeros; what they do to the energy is not asked, so they stay small: e^{1e3 growth} has a
 * limit. */
static void add_dense(struct equations *e, const char *primes)
{
	for (int i = 0; i < e->n; i++)
		for (int j = 0; j < e->n; j++)
			if (chance(70))
				add(e, i, format("(%s)", signed_number(-5, 0)), j, primes);
}

static void add_masses(struct equations *e)
{
	const bool equal = chance(40), coupled = chance(15);
	for (int i = 0; i < e->n; i++)
		e->left[i] = format("%s*x%d%s", equal ? "1" : number(-1, 2), i + 1, e->first_order[i] ? "'" : "''");
	for (int i = 0; coupled && i + 1 < e->n; i++)
		if (!e->first_order[i] && !e->first_order[i + 1])
			connect(e, i, i + 1, number(-3, -1), "''");
}

static char *wave(void)
{
	char *phase = chance(50)   ? ""
				  : chance(30) ? format(" + pi/%u", 2 + below(7))
							   : format(" + %s", signed_number(-3, 2));
	return format("%s(%s*t%s)", chance(50) ? "cos" : "sin", chance(30) ? "10" : signed_number(-4, 3), phase);
}

static char *load(void)
{
	if (chance(20))
		return signed_number(-3, 3);
	if (chance(60))
		return format("%s*%s", signed_number(-3, 3), wave());
	char *text = signed_number(-3, 3);
	if (chance(60))
		text = format("%s*t^%u", text, 1 + below(3));
	if (chance(50))
		text = format("%s*exp(%s%s*t)", text, chance(85) ? "-" : "", number(-3, chance(85) ? 0 : -2));
	if (chance(30))
		text = format("%s*%s", text, wave());
	return text;
}

/* Changes its formula in time */
static char *changing_load(void)
{
	switch (below(5)) {
	case 0:
		return format("(t < %s ? %s : %s)", number(-3, 0), load(), chance(50) ? "0" : load());
	case 1:
		return format("%s*abs(t - %s)", signed_number(-2, 2), number(-3, 0));
	case 2:
		return format("%s*max(t - %s, 0)", signed_number(-2, 2), number(-3, 0));
	case 3:
		return format("table(t; 0, %s; 0.1, %s; 0.37, %s)", signed_number(-2, 2), signed_number(-2, 2),
					  signed_number(-2, 2));
	default:
		return format("min(%s*t, %s)", number(-1, 2), number(-2, 0));
	}
}

static char *initial_values(const struct equations *e)
{
	char *text = "";
	for (int i = 0; i < e->n; i++)
		for (int k = 0; k < (e->first_order[i] ? 1 : 2); k++)
			if (chance(40))
				text =
					format("%s%sx%d%s = %s", text, *text ? ", " : "init ", i + 1, k ? "'" : "",
							signed_number(-4, 1));
	return format("%s\n", text);
}

static char *declarations(const struct equations *e, bool held, bool ramp)
{
	char *text = "model made\ncoord x1";
	for (int i = 1; i < e->n; i++)
		text = format("%s, x%d", text, i + 1);
	return format("%s\n%s%s%s", text, initial_values(e), held ? "input u\n" : "", ramp
			? "input v hold first\n" : "");
}

static char *sketch(const struct equations *e)
{
	char *text = "";
	const unsigned i = below((unsigned)e->n);
	if (chance(50) && !e->first_order[i])
		text = format("mass %s at x%u\n", number(-1, 1), i + 1);
	if (chance(50))
		text = format("%sspring %s between x%u, %s\n", text, number(-2, 2), i + 1, i == 0 ? "ground" : "x1");
	if (chance(50))
		text = format("%sdamper %s between x%u, %s\n", text, number(-3, 0), i + 1, i == 0 ? "ground" : "x1");
	return chance(50) ? format("%sforce %s on x%u\n", text, load(), i + 1) : text;
}

static char *finish(const struct equations *e, char *text, bool held, bool ramp, bool changes)
{
	for (int i = 0; i < e->n; i++) {
		text = format("%s%s = 0", text, e->left[i]);
		while (chance(30))
			text = format("%s + %s", text, load());
		if (held && chance(60))
			text = format("%s + %s*u", text, signed_number(-2, 2));
		if (ramp && chance(60))
			text = format("%s + %s*v", text, signed_number(-2, 2));
		if (ramp && chance(30))
			text = format("%s + %s*v'", text, signed_number(-2, 2));
		if (changes && (i == 0 || chance(20)))
			text = format("%s + %s", text, changing_load());
		text = format("%s\n", text);
	}
	return text;
}

char *random_spec(uint64_t seed)
{
	struct equations e = { .n = 1 };
	random_state = seed * UINT64_C(0x9e3779b97f4a7c15) + 1;
	below(2);
	e.n += (int)below(LARGEST);
	const bool mixed = chance(30), held = chance(15), ramp = chance(15), changes = chance(12);
	for (int i = 0; i < e.n; i++)
		e.first_order[i] = mixed && chance(50);
	char *text = declarations(&e, held, ramp);
	add_masses(&e);
	if (chance(70)) {
		const int center = (int)below(7) - 2;
		add_chain(&e, center - 2, center + 2, "", chance(50) ? 100 : 40);
	} else {
		add_dense(&e, "");
	}
	if (chance(45))
		add_chain(&e, -4, 1, "'", 50);
	else if (chance(20) && !mixed)
		add_dense(&e, "'");
	text = finish(&e, text, held, ramp, changes);
	if (chance(20))
		text = format("%s%s", text, sketch(&e));
	if (chance(30))
		text = format("%soutput a = x1%s + 0.25*x%d', b = x1 - 3*x%d + 2*cos(10*t), c = t - x1%s\n", text,
					  e.first_order[0] ? "'" : "''", e.n, e.n,
					  held   ? " + 2*u"
					  : ramp ? " + 2*v - v'"
							 : "");
	return format("%sstep %s\n", text, number(-12, 2));
}

/* ---- states that the outputs cannot see ---- */

/* A chain that is its own mirror image, seen through the sum or the difference of two that mirror each other */
static char *mirrored(struct equations *e)
{
	e->n = 2 + (int)below(LARGEST - 1);
	char *mass = number(-1, 1), *end = number(-1, 2), *damping = chance(50) ? number(-3, 0) : NULL;
	for (int i = 0; i < e->n; i++)
		e->left[i] = format("%s*x%d''", mass, i + 1);
	char *spring = number(-1, 2);
	for (int i = 0; i + 1 < e->n; i++) {
		connect(e, i, i + 1, spring, "");
		if (damping)
			connect(e, i, i + 1, damping, "'");
	}
	connect(e, 0, e->n, end, "");
	connect(e, e->n - 1, e->n, end, "");
	return format("output a = x1 %s x%d\n", chance(50) ? "+" : "-", e->n);
}

/* Two equal blocks, coupled or not */
static char *doubled(struct equations *e)
{
	const char *mass[2] = { number(-1, 1), number(-1, 1) }, *inside = number(-1, 2), *across = number(-2, 1),
			   *ground = number(-1, 2);
	const bool coupled = chance(50), damped = chance(50), coil = chance(40);
	const char *damping = number(-2, 0);
	e->n = 4;
	for (int i = 0; i < 4; i++) {
		e->first_order[i] = coil && i % 2;
		e->left[i] = format("%s*x%d%s", mass[i % 2], i + 1, e->first_order[i] ? "'" : "''");
	}
	for (int i = 0; i < 4; i += 2) {
		connect(e, i, i + 1, inside, "");
		connect(e, i, e->n, ground, "");
		if (damped)
			connect(e, i, e->n, damping, "'");
	}
	if (coupled)
		connect(e, 0, 2, across, "");
	const char *sign = chance(50) ? "+" : "-";
	return format("output a = 3*x1 %s 3*x3, b = x2 %s x4\n", sign, sign);
}

/* Each coupled to the sum of all */
static char *summed(struct equations *e)
{
	e->n = 3 + (int)below(LARGEST - 2);
	const char *own = number(-1, 2), *damping = number(-3, 0), *shared = number(-1, 1);
	const bool first = chance(30);
	char *sum = "x1", *speeds = "x1'";
	for (int i = 1; i < e->n; i++) {
		sum = format("%s + x%d", sum, i + 1);
		speeds = format("%s + x%d'", speeds, i + 1);
	}
	for (int i = 0; i < e->n; i++) {
		e->first_order[i] = first;
		e->left[i] = first
						 ? format("x%d' + %s*x%d + %s*(%s)", i + 1, own, i + 1, shared, sum)
						 : format("x%d'' + %s*x%d' + %s*x%d + %s*(%s)", i + 1, damping, i + 1,
								own, i + 1, shared, sum);
	}
	return format("output a = %s, b = %s\n", sum, speeds);
}

/* The first ones drive the others, and only the first are seen. */
static char *driven(struct equations *e)
{
	e->n = 2 + (int)below(LARGEST - 1);
	const int seen = 1 + (int)below((unsigned)e->n - 1);
	for (int i = 0; i < e->n; i++)
		e->first_order[i] = chance(25);
	for (int i = 0; i < e->n; i++) {
		e->left[i] = format("%s*x%d%s", number(-1, 1), i + 1, e->first_order[i] ? "'" : "''");
		for (int j = 0; j < e->n; j++)
			if ((i >= seen || j < seen) && (i == j || chance(60)))
				add(e, i, i == j ? number(-1, 2) : format("(%s)", signed_number(-2, 0)), j, "");
	}
	return format("output a = x1, b = x1' + x%d\n", seen);
}

char *random_symmetric_spec(uint64_t seed)
{
	static char *(*const kinds[])(struct equations *) = { mirrored, doubled, summed, driven };
	struct equations e = { .n = 1 };
	random_state = seed * UINT64_C(0xd1342543de82ef95) + 7;
	below(2);
	char *outputs = kinds[below(4)](&e);
	const bool held = chance(20), ramp = chance(20), changes = chance(15);
	char *text = declarations(&e, held, ramp);
	text = finish(&e, text, held, ramp, changes);
	return format("%s%sstep %s\n", text, outputs, number(-3, -1));
}
