/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "random_spec.h"

#include "plgen.h"

#include <string.h>

enum { LARGEST = 4 };

static uint64_t state;

static unsigned below(unsigned n)
{
    state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (unsigned)(state >> 33) % n;
}

static bool chance(unsigned percent)
{
    return below(100) < percent;
}

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

/* Whole matrices with some zeros; what they do to the energy is not asked, so they stay small: e^{1e3 growth} has a limit. */
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
        e->left[i] = format("%s*x%d''", equal ? "1" : number(-2, 2), i + 1);
    for (int i = 0; coupled && i + 1 < e->n; i++)
        connect(e, i, i + 1, number(-3, -1), "''");
}

static char *load(void)
{
    char *phase = chance(50) ? "" : chance(30) ? format(" + pi/%u", 2 + below(7)) : format(" + %s", signed_number(-3, 2));
    if (chance(25))
        return signed_number(-3, 3);
    return format("%s*%s(%s*t%s)", signed_number(-3, 3), chance(50) ? "cos" : "sin", chance(30) ? "10" : signed_number(-4, 3), phase);
}

static char *initial_values(int n)
{
    char *text = "";
    for (int i = 0; i < n; i++)
        for (int k = 0; k < 2; k++)
            if (chance(40))
                text = format("%s%sx%d%s = %s", text, *text ? ", " : "init ", i + 1, k ? "'" : "", signed_number(-4, 1));
    return format("%s\n", text);
}

char *random_spec(uint64_t seed)
{
    struct equations e = { .n = 1 };
    state = seed * UINT64_C(0x9e3779b97f4a7c15) + 1;
    below(2);
    e.n += (int)below(LARGEST);
    char *text = "model made\ncoord x1";
    for (int i = 1; i < e.n; i++)
        text = format("%s, x%d", text, i + 1);
    text = format("%s\n%s", text, initial_values(e.n));
    add_masses(&e);
    if (chance(70)) {
        const int center = (int)below(7) - 2;
        add_chain(&e, center - 2, center + 2, "", chance(50) ? 100 : 40);
    } else {
        add_dense(&e, "");
    }
    if (chance(45))
        add_chain(&e, -4, 1, "'", 50);
    else if (chance(20))
        add_dense(&e, "'");
    for (int i = 0; i < e.n; i++) {
        text = format("%s%s = 0", text, e.left[i]);
        while (chance(30))
            text = format("%s + %s", text, load());
        text = format("%s\n", text);
    }
    if (chance(30))
        text = format("%soutput a = x1'' + 0.25*x%d', b = x1 - 3*x%d + 2*cos(10*t), c = t - x1\n", text, e.n, e.n);
    return format("%sstep %s\n", text, number(-12, 2));
}
