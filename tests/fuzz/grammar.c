/* SPDX-License-Identifier: GPL-3.0-or-later */
/* grammar SEED SPEC [C]: a valid spec of a small model, and what it says once more as C, both written from one tree of
 * random choices; the same for the same seed.  Lines of comment at its head are for grammar.sh:
 *     # options: of plgen, besides --rhs and --prefix
 *     # class: linear, piecewise (linear in each region), smooth or kinked (a remainder; kinked: a slope of it jumps)
 *     # changes: times at which a load changes its formula [s]
 *     # retune: NAME=VALUE ... step=VALUE, for models with tunable params
 * Outputs named inner... read what is between coordinates that move as a whole: they are judged by their own size.
 * Rates stay below some 10 rad/s and steps are short, so that each scheme is close to the solution.
 *
 * The C, for NAME given by -DNAME=...:
 *     NAME_residual(t, y, u, top, r)     left sides minus right sides; top: the highest derivative of each coordinate
 *     NAME_wanted(t, y, u, top, out)     the outputs; NULL `out` of a model without
 *     NAME_coords                        how many coordinates, then of each its order */
#include "random.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_COORDS = 48, MOST_NAMES = 12, ROOM = 1 << 16 };

static int below(int n)
{
	return (int)(next() % (uint64_t)n);
}

static bool chance(int percent)
{
	return below(100) < percent;
}

/* ---- text in both languages ---- */

struct both {
	char *spec, *c;
};

static char *copy(const char *text)
{
	char *own = malloc(strlen(text) + 1);
	if (!own)
		exit(3);
	return strcpy(own, text);
}

static char *text(const char *form, ...)
{
	char line[ROOM];
	va_list arguments;
	va_start(arguments, form);
	const int length = vsnprintf(line, sizeof line, form, arguments);
	va_end(arguments);
	if (length < 0 || length >= ROOM)
		exit(3);
	return copy(line);
}

static struct both same(const char *words)
{
	return (struct both){ copy(words), copy(words) };
}

/* Each @ of the forms is the next of the operands. */
static struct both join2(const char *spec, const char *c, int count, const struct both *operand)
{
	char line[2][ROOM];
	const char *const form[2] = { spec, c };
	for (int k = 0; k < 2; k++) {
		int used = 0;
		size_t n = 0;
		for (const char *p = form[k]; *p; p++) {
                    const char one[2] = { *p, 0 }, *piece = *p != '@' ? one : k ? operand[used].c : operand[used].spec;
                    used += *p == '@';
                    if (used > count || n + strlen(piece) >= ROOM)
                        exit(3);
                    strcpy(line[k] + n, piece);
                    n += strlen(piece);
		}
		line[k][n] = 0;
	}
	return (struct both){ copy(line[0]), copy(line[1]) };
}

#define JOIN2(spec, c, ...)                                                                                            \
    join2(spec, c, (int)(sizeof(struct both[]){ __VA_ARGS__ } / sizeof(struct both)), (struct both[]){ __VA_ARGS__ })
#define JOIN(form, ...) JOIN2(form, form, __VA_ARGS__)

/* ---- what is declared ---- */

struct coord {
	char *name;
	int size, order;        /* size 0: a scalar */
	int first, velocity;    /* entry of y of its first component, and of its velocity */
	int top;                /* entry of `top` of its first component */
};

static struct coord coord[MOST_COORDS];
static int coords, tops, states;
static struct { char *name; bool ramp; } input[MOST_NAMES];
static int inputs;
static struct { char *name, *value; bool tunable; } param[MOST_NAMES];
static int params;
static char changes[400];
static enum { LINEAR, PIECEWISE, SMOOTH, KINKED } class;
static bool tunable;
/* may it move as a whole; and has it done so: positions of 1e4, velocities of 100 */
static enum { GROUNDED, TURNS, TURNS_FAR } drive;
static char *ratio[MOST_COORDS];                /* how far each coordinate moves then */
static char *spec_lets = "", *c_lets = "";
static char *spec_equations = "", *c_rows = "";
static int rows, lets;

static void add(char **to, const char *more)
{
	*to = text("%s%s", *to, more);
}

static double motion(int which)
{
	return ratio[which] ? strtod(ratio[which], NULL) : 0;
}

/* A component of a coordinate, -1 of a scalar, differentiated. */
static struct both derivative(int which, int component, int primes)
{
	const struct coord *x = &coord[which];
	const int i = component < 0 ? 0 : component;
	char *const spec = component < 0 ? text("%s%.*s", x->name, primes, "''") : text("%s[%d]%.*s", x->name,
		component + 1, primes, "''");
	return (struct both){ spec, primes == x->order ? text("top[%d]", x->top + i)
		: text("y[%d]", (primes ? x->velocity : x->first) + i) };
}

static int any_component(int which)
{
	return coord[which].size ? below(coord[which].size) : -1;
}

static struct both position(void)
{
	const int which = below(coords);
	return derivative(which, any_component(which), 0);
}

/* A position or a velocity that is a state. */
static struct both any_state(void)
{
	const int which = below(coords);
	return derivative(which, any_component(which), coord[which].order == 2 ? below(2) : 0);
}

/* ---- numbers ---- */

/* From about low to high, as a person might write it. */
static struct both literal(double low, double high)
{
	const double x = low + (high - low) * (double)below(1001) / 1000;
	switch (below(8)) {
	case 0: return same(text("%.1f", x >= 0 && x < 0.1 ? 0.1 : x));
	case 1: return JOIN("(@)", same(text("%d.0/%d.0", (int)(x * 7) + 1, 7)));
	case 2: return same(text("%.3e", x + 0.001));
	case 3: return same(text("%.6f", x + 0.01 / 3));
	default: return same(text("%.2f", x + 0.01));
	}
}

/* A positive factor: a number or a param. */
static struct both factor(double low, double high)
{
	if (params == MOST_NAMES || !chance(25))
		return literal(low, high);
	if (params > 0 && chance(40)) {
		const int which = below(params);
		return JOIN2("@", "@", same(param[which].name));
	}
	param[params].name = text("%s%d", (const char *const[]){ "k", "c_", "mu", "Stiff" }[below(4)], params);
	param[params].value = literal(low, high).spec;
	param[params].tunable = tunable && chance(60);
	return same(param[params++].name);
}

/* A number that no tunable param touches. */
static struct both fixed(double low, double high)
{
	return literal(low, high);
}

/* ---- loads ---- */

static struct both change_at(double low, double high)
{
	char *const when = text("%.3f", low + (high - low) * (double)below(1000) / 1000);
	if (strlen(changes) + strlen(when) + 2 < sizeof changes) {
		strcat(changes, " ");
		strcat(changes, when);
	}
	return same(when);
}

static struct both load(int depth)
{
	switch (below(depth > 1 ? 8 : depth > 0 ? 16 : 6)) {
	case 0: return factor(0.1, 2);
	case 1: return JOIN("@*t", fixed(0.5, 2));
	case 2: return JOIN2("@*t^@", "@*pow(t, @)", fixed(0.5, 2), same(text("%d", 2 + below(3))));
	case 3: return JOIN("exp(-@*t)", fixed(0.2, 3));
	case 4: return JOIN("@*cos(@*t + @)", factor(0.5, 3), fixed(0.5, 8), fixed(0, 3));
	case 5: return JOIN("sin(@*t)", fixed(0.5, 8));
	case 6: return JOIN("(@)*(@)", load(depth - 1), load(depth - 2));
	case 7: return JOIN("(@ - @)", load(depth - 1), load(depth - 1));
	case 8: return JOIN("(t < @ ? @ : @)", change_at(0.02, 0.4), load(depth - 1), load(depth - 1));
	case 9: return JOIN("(t >= @ ? @ : @)", change_at(0.02, 0.4), load(depth - 1), fixed(0, 1));
	case 10: {
		const struct both a = change_at(0.05, 0.1), b = change_at(0.15, 0.2), c = change_at(0.25, 0.4);
		const struct both y0 = fixed(0, 2), y1 = fixed(0, 2), y2 = fixed(0, 2);
		return JOIN2("table(t; @, @; @, @; @, @)", "table3(t, @, @, @, @, @, @)", a, y0, b, y1, c, y2);
	}
	case 11: return JOIN2("abs(t - @)", "fabs(t - @)", change_at(0.02, 0.4));
	case 12: return JOIN2("max(t, @)", "fmax(t, @)", change_at(0.02, 0.4));
	case 13: return JOIN2("clip(t, @, @)", "clip(t, @, @)", change_at(0.02, 0.1), change_at(0.2, 0.4));
	case 14: {
		const struct both name = same(text("load%d", lets++)), value = load(depth - 1);
		add(&spec_lets, text("let %s = %s\n", name.spec, value.spec));
		add(&c_lets, text("\tconst double %s = %s;\n\t(void)%s;\n", name.c, value.c, name.c));
		return name;
	}
	default: return JOIN("exp(-@*t)*cos(@*t)", fixed(0.1, 2), fixed(1, 6));
	}
}

/* ---- forces ---- */

static struct both sampled(void)
{
	const int i = below(inputs);
	if (input[i].ramp && chance(25))
		return (struct both){ text("%s'", input[i].name), text("u[%d]", inputs + i) };
	return (struct both){ copy(input[i].name), text("u[%d]", i) };
}

/* Linear in the states, perhaps with what moves a stop. */
static struct both linear_form(void)
{
	switch (below(6)) {
	case 0: return JOIN("(@ - @)", position(), position());
	case 1: return JOIN("(@ + @*@)", position(), fixed(0.1, 0.5), any_state());
	case 2: return inputs && chance(50) ? JOIN("(@ - @)", position(), JOIN("0.1*@", sampled())) : position();
	default: return position();
	}
}

/* A velocity that may be 0: of a scalar of second order. */
static bool velocity(struct both *v)
{
	const int which = below(coords);
	if (coord[which].order != 2)
		return false;
	*v = derivative(which, any_component(which), 1);
	return true;
}

/* Arguments of extremes that are extremes themselves */
static struct both extreme_in_extreme(struct both e)
{
	const struct both x = position(), a = fixed(0.02, 0.2), b = fixed(0.25, 0.4);
	switch (below(5)) {
	case 0: return JOIN2("max(@, min(@, @))", "fmax(@, fmin(@, @))", e, x, a);
	case 1: return JOIN2("clip(max(@, @), -@, @)", "clip(fmax(@, @), -@, @)", e, x, a, b);
	case 2: return JOIN2("min(max(@, -@), clip(@, -@, @))", "fmin(fmax(@, -@), clip(@, -@, @))", e, a, x, a, b);
	case 3: return JOIN2("max(@, @, min(@, @))", "fmax(fmax(@, @), fmin(@, @))", e, a, x, b);
	default: return JOIN2("abs(@ - max(@, 0))", "fabs(@ - fmax(@, 0))", e, x);
	}
}

/* Linear in each region. */
static struct both regional(int depth)
{
	const struct both e = linear_form(), k = fixed(0.5, 20), a = fixed(0.02, 0.3);
	struct both v;
	switch (below(15)) {
	case 0: return JOIN("@*deadzone(@, -@, @)", k, e, a, fixed(0.05, 0.3));
	case 1: return JOIN("@*clip(@, -@, @)", k, e, a, fixed(0.05, 0.3));
	case 2: return JOIN2("@*max(@ - @, 0)", "@*fmax(@ - @, 0)", k, e, a);
	case 3: return JOIN2("@*min(@, @)", "@*fmin(@, @)", k, e, a);
	case 4: return JOIN2("@*abs(@)", "@*fabs(@)", k, e);
	case 5: return JOIN("(@ > @ ? @*(@ - @) : 0)", e, a, k, e, a);
	case 6: return velocity(&v) ? JOIN("(@ > 0 ? @*@ : @*@)", v, fixed(0.1, 2), v, fixed(0.1, 2), v)
		: JOIN2("@*abs(@)", "@*fabs(@)", k, e);
	case 7: return JOIN2("table(@; -1, @; -0.1, 0; 0.2, @)", "table3(@, -1, @, -0.1, 0, 0.2, @)", e, fixed(-3, -1),
		fixed(1, 3));
	/* nothing rests there */
	case 8: return JOIN2("@*sgn(@ - @)", "@*sgn(@ - @)", fixed(0.05, 0.5), position(), fixed(0.001, 0.002));
        case 9:
            return depth > 0 ? JOIN("(@ - @)", regional(depth - 1), regional(0)) : JOIN("deadzone(@, -@, @)", e, a, a);
        case 10: return JOIN2("deadzone(max(@, 0), @, @)", "deadzone(fmax(@, 0), @, @)", e, fixed(0.01, 0.1),
		fixed(0.16, 0.3));      /* the lower one may be 1/7 */
	case 11: case 12: return JOIN("@*@", k, extreme_in_extreme(e));
	default: return JOIN2("@*max(@, @)", "@*fmax(@, @)", k, e, position());
	}
}

static struct both smooth_remainder(void)
{
	const struct both k = factor(0.2, 3), x = position(), w = any_state();
	switch (below(18)) {
	case 0: return JOIN2("@*@^3", "@*pow(@, 3)", k, x);
	case 1: return JOIN("@*sin(@)", k, x);
	case 2: return JOIN("@*@*@", k, x, w);
	case 3: return JOIN2("@*@^2*@", "@*pow(@, 2)*@", k, x, w);
	case 4: return JOIN("@*cos(@*t)*@", k, fixed(1, 6), x);
	case 5: return inputs ? JOIN("0.5*@*@", sampled(), x) : JOIN("@*@*t", k, x);
	case 6: return JOIN2("exp(-@^2)", "exp(-pow(@, 2))", x);
	case 7: return JOIN("@*tanh(@)", k, w);
	case 8: return JOIN("@*atan(@)", k, x);
	case 9: return JOIN2("sqrt(1 + @^2)", "sqrt(1 + pow(@, 2))", x);
	case 10: return JOIN2("@/(1 + @^2)", "@/(1 + pow(@, 2))", w, x);
	case 11: return JOIN2("log(2 + @^2 + t)", "log(2 + pow(@, 2) + t)", x);
	case 12: return JOIN("@*(@)", x, load(1));
	case 13: return JOIN("sqrt(t + @)*@", fixed(0.5, 2), k);
	case 14: return JOIN2("atan2(@, 2 + @^2)", "atan2(@, 2 + pow(@, 2))", x, w);
	case 15: return JOIN("cosh(0.3*@) - @*sinh(@*@)", x, k, fixed(0.2, 0.6), w);
	case 16: return JOIN2("(2 + sin(t))^1.5*@", "pow(2 + sin(t), 1.5)*@", x);
	default: {
		const struct both name = same(text("part%d", lets++));
		add(&spec_lets, text("let %s = %s + 0.3*%s*t\n", name.spec, x.spec, w.spec));
		add(&c_lets, text("\tconst double %s = %s + 0.3*%s*t;\n\t(void)%s;\n", name.c, x.c, w.c, name.c));
		return JOIN2("@*@^2", "@*pow(@, 2)", k, name);
	}
	}
}

static struct both kinked(void)
{
	const struct both x = position(), w = any_state();
	switch (below(9)) {
	case 0: return JOIN2("abs(@)*@", "fabs(@)*@", x, w);
	case 1: return JOIN2("@*max(@, 0)^2", "@*pow(fmax(@, 0), 2)", fixed(1, 5), x);
	case 2: return JOIN2("(@ > @ ? (@ - @)^2 : 0)", "(@ > @ ? pow(@ - @, 2) : 0)", x, same("0.1"), x, same("0.1"));
	case 3: return JOIN2("sqrt(abs(@))*0.2", "sqrt(fabs(@))*0.2", w);
	case 4: return JOIN2("min(@^2, 0.04)", "fmin(pow(@, 2), 0.04)", x);
        case 5:
            return JOIN2("(t < @ ? @ : 0.5)*@^2", "(t < @ ? @ : 0.5)*pow(@, 2)", change_at(0.02, 0.2), fixed(0, 2), x);
	case 6: case 7: return JOIN("@*@", fixed(0.5, 5), extreme_in_extreme(x));
        default: return JOIN("@ + @", regional(1), smooth_remainder());
	}
}

/* What a model of this class has in its equations beside springs, dampers and masses. */
static struct both force(void)
{
	const int kind = below(100);
	if (class == PIECEWISE && kind < 55)
		return regional(2);
	if (class == SMOOTH && kind < 55)
		return smooth_remainder();
	if (class == KINKED && kind < 60)
		return kind < 40 ? kinked() : smooth_remainder();
	if (inputs && kind < 80)
		return JOIN("@*@", factor(0.5, 4), sampled());
	return load(class == PIECEWISE && chance(85) ? 0 : 2);
}

/* ---- equations ---- */

static void add_row(const char *c)
{
	add(&c_rows, text("\tr[%d] = %s;\n", rows++, c));
}

/* left and right side, each moved about */
static void equation(struct both left, struct both right)
{
	if (chance(15))
		right = JOIN("-(@) + @", left, right), left = same("0");
	else if (chance(15))
		left = JOIN("@ - (@)", left, right), right = same("0");
	else if (chance(10))
		left = JOIN("2*(@)/2.0", left);
	add(&spec_equations, text("%s = %s\n", left.spec, right.spec));
	add_row(text("(%s) - (%s)", left.c, right.c));
}

static void scalar_equation(int i)
{
	const struct coord *x = &coord[i];
	const bool loose = chance(15);
	struct both sum;
	if (x->order == 2) {
		sum = JOIN("@*@", factor(0.5, 3), derivative(i, -1, 2));
		if (chance(60))
			sum = JOIN("@ + @*@", sum, factor(0.05, 1), derivative(i, -1, 1));
		if (chance(5) && i > 0)         /* masses that are coupled */
			sum = JOIN("@ + 0.1*@", sum, derivative(0, coord[0].size ? 0 : -1, coord[0].order));
	} else {
		sum = JOIN("@*@", factor(0.5, 2), derivative(i, -1, 1));
	}
	if (!loose)
		sum = JOIN("@ + @*@", sum, factor(0.5, x->order == 2 ? 40 : 4), derivative(i, -1, 0));
	if (i > 0 && chance(70)) {
		const int j = below(i), component = any_component(j);
		sum = JOIN("@ + @*(@ - @)", sum, factor(0.5, 9), derivative(i, -1, 0), derivative(j, component, 0));
		if (x->order == 2 && coord[j].order == 2 && chance(30))
                    sum =
                        JOIN("@ - @*(@ - @)", sum, fixed(0.01, 0.2), derivative(j, component, 1), derivative(i, -1, 1));
        }
	if (i + 1 < coords && chance(40))
		sum = JOIN("@ - @*@", sum, factor(0.2, 4), derivative(i + 1, any_component(i + 1), 0));
	equation(sum, chance(75) ? force() : same("0"));
}

static void any_output(int n);
static char *spec_outputs = "", *c_outputs = "";
static int outputs;

/* ---- drives: what may move as a whole ---- */

static char *spec_inner = "", *c_inner = "";
static int inners;

/* What is between two coordinates, `order` times differentiated */
static struct both between(int i, int p, int order)
{
	char *const times = text("%.10g*", motion(i) / motion(p));
	const struct both xi = derivative(i, -1, order), xp = derivative(p, -1, order);
	return JOIN("(@ - @@)", xi, same(motion(i) == motion(p) ? "" : times), xp);
}

/* A force of it, such as the class has them; SECOND: its first derivative is at hand too */
static struct both shaft(int i, int p, bool second)
{
	const struct both d = between(i, p, 0), k = factor(1, class == LINEAR ? 40 : 12), a = fixed(0.02, 0.2);
	struct both force = JOIN("@*@", k, d);
	const int kind = below(10);
	if (class == PIECEWISE && kind < 6)
            force = kind < 2   ? JOIN("@*deadzone(@, -@, @)", k, d, a, fixed(0.05, 0.3))
                    : kind < 3 ? JOIN2("@*max(@ - @, 0)", "@*fmax(@ - @, 0)", k, d, a)
                    : kind < 4
                        ? JOIN2("table(@; -1, -@; -0.1, 0; 0.2, @)", "table3(@, -1, -@, -0.1, 0, 0.2, @)", d, k, a)
                    : kind < 5 ? JOIN2("@*(@ + abs(@))", "@*(@ + fabs(@))", k, d, d)
                               : JOIN("@*@ + @*clip(@, -@, @)", k, d, k, d, a, a);
        if (class >= SMOOTH && kind < 5)
            force = kind < 2   ? JOIN2("@*@ + @*@^3", "@*@ + @*pow(@, 3)", k, d, fixed(1, 5), d)
                    : kind < 3 ? JOIN("@*sin(@)", k, d)
                    : kind < 4 ? JOIN("(@ + @*cos(@*t))*@", k, a, fixed(1, 6), d)
                               : JOIN("@*tanh(@)", k, d);
        if (class == KINKED && kind >= 5 && kind < 8)
            force = kind < 7 ? JOIN2("@*@*abs(@)", "@*@*fabs(@)", k, d, d)
                             : JOIN2("@*max(@, 0)^2", "@*pow(fmax(@, 0), 2)", k, d);
        if (second && chance(60))
		force = JOIN("@ + @*@", force, factor(0.05, 1), between(i, p, 1));
	else if (chance(8))             /* an inerter, or what the other's rate drags along */
		force = JOIN("@ + @*@", force, fixed(0.05, 0.2),
			between(i, p, coord[i].order < coord[p].order ? coord[i].order : coord[p].order));
	return force;
}

static struct both drive_load(void)
{
	if (drive == TURNS && chance(12))
		return force();
	return inputs && chance(50) ? JOIN("@*@", factor(0.5, 4), sampled()) : load(2);
}

/* Coordinates that are held by each other; forces come in pairs, mostly. */
static void drive_equations(void)
{
	struct both sum[MOST_COORDS];
	bool integrates[MOST_COORDS] = { false };
	for (int i = 0; i < coords; i++) {
		sum[i] = JOIN("@*@", coord[i].order == 1 && class != LINEAR ? factor(3, 6) : factor(0.5, 3),
			derivative(i, -1, coord[i].order));
                if (coord[i].order == 1 && i > 0 && coord[i - 1].order == 2 && motion(i) == motion(i - 1) &&
                    chance(25)) {
                    sum[i] = JOIN("@ - @", derivative(i, -1, 1), derivative(i - 1, -1, 1));
                    integrates[i] = true;
                }
        }
	for (int i = 1; i < coords; i++) {
		const int p = chance(80) ? i - 1 : below(i);
		if (chance(6) || integrates[i])
			continue;
		struct both f = shaft(i, p, coord[i].order == 2 && coord[p].order == 2), d = between(i, p, 0);
		if (chance(40)) {
			const struct both name = same(text("shaft%d", lets++));
			if (!strstr(f.c, "top[")) {
				add(&spec_lets, text("let %s = %s\n", name.spec, f.spec));
				add(&c_lets, text("\tconst double %s = %s;\n\t(void)%s;\n", name.c, f.c, name.c));
				f = name;
			}
		}
		sum[i] = JOIN("@ + @", sum[i], f);
		const bool both_ways = !integrates[p] && chance(92);
		if (both_ways)
			sum[p] = motion(i) == motion(p) ? JOIN("@ - (@)", sum[p], f) : JOIN("@ - @*(@)", sum[p],
				same(text("%.10g", motion(i) / motion(p))), f);
		/* where nothing acts back, positions are kept as written: what is between has their rounding */
		if (both_ways && inners < 4 && !strstr(f.c, "top[")) {
			const struct both seen = chance(50) ? d : f;
			add(&spec_inner, text("output inner%d = %s\n", inners, seen.spec));
			add(&c_inner, text("\tout[%d] = %s;\n", inners++, seen.c));
		}
	}
	if (chance(12) && coord[0].order == 2)
		sum[0] = JOIN("@ + @*@", sum[0], fixed(0.01, 0.1), derivative(0, -1, 1));
	for (int i = 0; i < coords; i++)
		equation(sum[i], chance(60) ? drive_load() : coord[i].order == 1 &&
			drive == TURNS_FAR ? same(text("%g", 100 * motion(i))) : same("0"));
}

static void declare_drive(void)
{
	static const char *const ratios[] = { "1", "2", "-1", "3", "0.5", "0.3", "1" };
	const bool first = chance(10), gears = chance(40);
	coords = chance(12) && !tunable && class != PIECEWISE ? 9 + below(3) : 2 + below(3);
	for (int i = 0; i < coords; i++) {
		coord[i].name = text("%s%d", (const char *const[]){ "x", "th_", "w" }[below(3)], i);
		coord[i].order = first || chance(i ? 8 : 20) ? 1 : 2;
                ratio[i] = copy(gears ? ratios[below(class == LINEAR ? 7 : 3)]
                                      : "1") /* a gear stiffens by its ratio squared */;
        }
}

static void write_inner(void)
{
	spec_outputs = spec_inner;
	c_outputs = c_inner;
	outputs = inners;
	for (int n = chance(50) ? below(3) : 0; n > 0; n--)
		any_output(n);
}

static char *matrix_text(int n, double on, double beside)
{
	char *all = "[";
	for (int r = 0; r < n; r++) {
		for (int c = 0; c < n; c++)
                    add(&all, text("%s%g", c ? ", " : "",
                                   c == r                     ? on + r * 0.5
                                   : c == r + 1 || r == c + 1 ? beside
                                                              : 0));
                add(&all, r + 1 < n ? "; " : "]");
	}
	return all;
}

/* Row r of a matrix as matrix_text gives it, times components. */
static char *row_times(int which, int r, int primes, double on, double beside)
{
	char *sum = "0.0";
	for (int c = r ? r - 1 : 0; c <= r + 1 && c < coord[which].size; c++)
		add(&sum, text(" + (%g)*%s", c == r ? on + r * 0.5 : beside, derivative(which, c, primes).c));
	return sum;
}

/* M q'' + C q' + K q = f load, or of first order. */
static void vector_equation(int i)
{
	const struct coord *q = &coord[i];
	const double k = 4 + below(8), c = 0.25 * below(4);
	const bool cubic = (class == SMOOTH || class == KINKED) && chance(50), mass = chance(50) && q->order == 2,
		loaded = chance(70);
	const bool gap = class == PIECEWISE && chance(40) && q->size <= 4;
	const struct both f = loaded ? force() : same("0");
	add(&spec_lets, text("matrix K%d = %s\n", i, matrix_text(q->size, k, -1)));
	if (mass)
		add(&spec_lets, text("matrix M%d = %s\n", i, matrix_text(q->size, 1, 0)));
	char *shape = "[";
	for (int r = 0; r < q->size; r++)
		add(&shape, text("%s%d", r ? "; " : "", r % 3));
	add(&spec_lets, text("matrix f%d = %s]\n", i, shape));
        char *const extra = cubic ? text(" + 0.3*sin(%s)", q->name)
                            : gap ? text(" + 3*deadzone(%s, -0.1, 0.2)", q->name)
                                  : "";
        if (q->order == 2)
            add(&spec_equations, text("%s%s'' + %g*%s' + K%d*%s%s = f%d*(%s)\n", mass ? text("M%d*", i) : "", q->name,
                                      c, q->name, i, q->name, extra, i, f.spec));
        else
            add(&spec_equations, text("%s' = -K%d*%s%s + f%d*(%s)\n", q->name, i, q->name,
                                      cubic ? text(" - 0.3*sin(%s)", q->name)
                                      : gap ? text(" - 3*deadzone(%s, -0.1, 0.2)", q->name)
                                            : "",
                                      i, f.spec));
        for (int r = 0; r < q->size; r++) {
		const char *const x = derivative(i, r, 0).c;
                const char *const own = cubic ? text(" + 0.3*sin(%s)", x)
                                        : gap ? text(" + 3*deadzone(%s, -0.1, 0.2)", x)
                                              : "";
                const char *const head = derivative(i, r, q->order).c;
		add_row(text("%g*%s + %s + %s%s - %d*(%s)", mass ? 1 + r * 0.5 : 1, head,
			q->order == 2 ? text("%g*%s", c, derivative(i, r, 1).c) : "0.0",
			row_times(i, r, 0, k, -1), own, r % 3, f.c));
	}
}

/* Two masses from a sketch. */
static void sketch(int i)
{
	const struct both m1 = factor(0.5, 3), m2 = factor(0.5, 3), k1 = factor(1, 40), k2 = factor(1, 10),
		c = factor(0.05, 1), f = force();
	const char *const a = coord[i].name, *const b = coord[i + 1].name;
        add(&spec_equations,
            text("mass %s at %s\nmass %s at %s\nspring %s between %s, ground\n", m1.spec, a, m2.spec, b, k1.spec, a));
        add(&spec_equations, text("spring %s between %s, %s\ndamper %s between %s, %s\nforce %s on %s\n", k2.spec, a, b,
		c.spec, a, b, f.spec, b));
	const struct both xa = derivative(i, -1, 0), va = derivative(i, -1, 1), xb = derivative(i + 1, -1, 0),
		vb = derivative(i + 1, -1, 1);
        add_row(text("%s*%s + %s*%s + %s*(%s - %s) + %s*(%s - %s)", m1.c, derivative(i, -1, 2).c, k1.c, xa.c, k2.c,
                     xa.c, xb.c, c.c, va.c, vb.c));
        add_row(text("%s*%s + %s*(%s - %s) + %s*(%s - %s) - (%s)", m2.c, derivative(i + 1, -1, 2).c, k2.c, xb.c, xa.c,
                     c.c, vb.c, va.c, f.c));
}

/* ---- outputs ---- */

static void output(const char *spec, const char *c)
{
	add(&spec_outputs, text("output %s\n", spec));
	add(&c_outputs, text("\tout[%d] = %s;\n", outputs++, c));
}

static void any_output(int n)
{
	const int i = below(coords), component = any_component(i);
        const struct both x = derivative(i, component, 0), a = derivative(i, component, coord[i].order),
                          w = any_state();
        struct both e;
	switch (below(9)) {
	case 0: case 1: e = JOIN("@ + @*@", x, fixed(0.5, 2), w); break;
	case 2: e = a; break;
	case 3: e = JOIN("2*@ - @ + t", a, w); break;
	case 4: e = inputs ? JOIN("@ + 0.5*@", sampled(), w) : JOIN("@ - 3.0*@", x, w); break;
	case 5: e = load(1); break;
	case 6: e = JOIN2("@^2 + sin(@)", "pow(@, 2) + sin(@)", x, w); break;
	case 7: e = JOIN2("max(@, @)", "fmax(@, @)", x, w); break;
	default: e = JOIN("@*@ + @", x, a, JOIN("exp(-@*t)", fixed(0.1, 1)));
	}
	if (tunable && strstr(e.c, "pow"))
		e = x;
	output(text("out%d = %s", n, e.spec), e.c);
}

static void write_outputs(void)
{
	if (chance(35))
		return;
	if (chance(30))
		for (int i = 0; i < coords; i++) {
			if (!coord[i].size || !chance(50)) {
                            const struct both x = derivative(i, any_component(i), coord[i].order == 2 ? below(2) : 0);
                            output(x.spec, x.c);
                            continue;
			}
			for (int r = 0; r < coord[i].size; r++)
				add(&c_outputs, text("\tout[%d] = %s;\n", outputs++, derivative(i, r, 0).c));
			add(&spec_outputs, text("output %s\n", coord[i].name));
		}
	for (int n = 1 + below(3); n > 0; n--)
		any_output(n);
}

/* ---- options and statements ---- */

static const char *of_all(void)
{
	static const char *const scheme[] = { "etd1", "etdrk2", "etdrk4", "nc2", "nc3", "dq4", "bm3", "taylor",
					      "radau", "auto", "etdam4", "etdam5", "etdam6", "etdcol" };
	return scheme[below(sizeof scheme / sizeof *scheme)];
}

/* Those with a number stand in the spec. */
static char *scheme_statement(void)
{
	static const char *const scheme[] = { "taylor 12", "taylor 16", "taylor 12 over 3", "taylor 14 over 2",
		"radau 3", "radau 5", "radau 7", "auto 5", "auto 7", "etdcol 4", "etdcol 8" };
	static const char *const tolerance[] = { "1e-7", "1e-9", "1e-11" };
	char *const all = text("scheme %s\n", scheme[below(sizeof scheme / sizeof *scheme)]);
	return chance(50) ? all : text("%stolerance %s\n", all, tolerance[below(3)]);
}

/* The operator of a scheme with a remainder, sometimes. */
static char *operator_statement(void)
{
	if (class < SMOOTH || !chance(30))
		return "";
	const struct both x = any_state();
        switch (drive == TURNS_FAR ? 1
                                   : below(3)) { /* where one of a drive's states is fixed, all are kept as written */
        case 0: return text("operator at %s = %s\n", x.spec, chance(50) ? "0" : "0.2");
	case 1: return text("operator at t = 0.1\n");
	default: return text("operator at %s = -0.3, 0, 0.3, 0.6\n", x.spec);
        }
}

static char *options(const char *stated)
{
	char *all = "";
	if (chance(20))
		add(&all, " --real float");
	if (*stated)
		;
	else if (class >= SMOOTH ? chance(70) : !drive && chance(12))
		add(&all, text(" --scheme %s", !drive && chance(6) ? "pl" : of_all()));
	else if (!drive && chance(8))
		add(&all, chance(70) ? " --scheme exact" : " --scheme pl");
	if (class == LINEAR ? chance(30) : chance(2))
            add(&all,
                text(" --form %s", (const char *const[]){ "direct", "delta", "kick-drift-kick", "auto" }[below(4)]));
        if (class == LINEAR && states <= 16 && !tunable ? chance(18) : chance(1))
		add(&all, " --accuracy compensated");
	if (class == LINEAR && !tunable ? chance(20) : chance(2))
		add(&all, " --reduce");
	if (class == LINEAR ? chance(25) : chance(1))
		add(&all, " --selftest");
	if (chance(class >= SMOOTH ? 20 : 5))
		add(&all, " --loads remainder");
	if (chance(10))
		add(&all, text(" --step %s", (const char *const[]){ "0.01", "1/128", "0.0075" }[below(3)]));
	if (params && !tunable && chance(15))
		add(&all, text(" -D %s=%s", param[0].name, "1.25"));
	return all;
}

/* Names that other libraries have taken too. */
static const char *const odd[] = { "I",        "complex",  "NULL",  "errno", "math_errhandling",
                                   "HUGE_VAL", "uint64_t", "x0",    "E",     "e1",
                                   "lo",       "work",     "s",     "y",     "u",
                                   "h",        "k",        "left",  "part1", "size",
                                   "fabs",     "M_PI",     "i",     "q1",    "load1",
                                   "phase",    "stdin",    "isnan", "NAN",   "signal",
                                   "double_t", "a_dot" };

static void declare(void)
{
	static const char *const plain[] = { "x", "z", "theta", "w", "body", "a" };
	const int count = drive ? 0 : 1 + below(class == LINEAR ? 4 : 3);
	int used = 0;
	if (drive)
		declare_drive();
	for (int i = 0; i < count; i++) {
		struct coord *x = &coord[coords++];
		const bool far = class != PIECEWISE && !tunable && chance(10);
		x->name = chance(4) ? copy(odd[below((int)(sizeof odd / sizeof *odd))]) : copy(plain[used]);
		for (int j = 0; j < i; j++)
			if (strcmp(coord[j].name, x->name) == 0)
				x->name = copy(plain[used]);
		used++;
		x->order = chance(20) ? 1 : 2;
		x->size = chance(18) ? (far ? 9 + below(3) : 2 + below(2)) : 0;
		if (tunable && x->size > 2)
			x->size = 2;
	}
	if (!drive && below(2)) {         /* a first order alone is rare in the field */
		coord[0].order = 2;
	}
	for (int i = 0; i < coords; i++) {
		coord[i].first = states;
		coord[i].top = tops;
		states += coord[i].size ? coord[i].size : 1;
		tops += coord[i].size ? coord[i].size : 1;
	}
	for (int i = 0; i < coords; i++)
		if (coord[i].order == 2) {
			coord[i].velocity = states;
			states += coord[i].size ? coord[i].size : 1;
		}
	if (chance(30))
		for (inputs = 0; inputs == 0 || (inputs < 2 && chance(40)); inputs++) {
			input[inputs].name = copy(inputs ? "v_in" : "u_in");
			input[inputs].ramp = chance(50);
		}
}

static char *initial(void)
{
	char *all = "";
	for (int i = 0; i < coords; i++)
		for (int primes = 0; primes < coord[i].order; primes++)
			for (int r = 0; r < (coord[i].size ? coord[i].size : 1); r++)
				if (drive == TURNS_FAR || (chance(70) && r < 3))
                                    add(&all, text("%s%s = %.3f", *all ? ", " : "init ",
                                                   derivative(i, coord[i].size ? r : -1, primes).spec,
                                                   (below(1201) - 600) * (primes                     ? 0.002
                                                                          : drive && class != LINEAR ? 0.0003
                                                                                                     : 0.001) +
                                                       (drive == TURNS_FAR ? motion(i) * (primes ? 100 : 1e4) : 0)));
        return *all ? text("%s\n", all) : all;
}

static void equations(void)
{
	if (drive) {
		drive_equations();
		return;
	}
	for (int i = 0; i < coords; i++)
		if (coord[i].size)
			vector_equation(i);
                else if (i + 1 < coords && !coord[i + 1].size && coord[i].order == 2 && coord[i + 1].order == 2 &&
                         chance(20))
                    sketch(i++);
		else
			scalar_equation(i);
}

/* What no expression reads */
static void write_unread(FILE *file)
{
	if (chance(6))
		fprintf(file, "param spare = 2, more = spare + 1\n");
	if (chance(4))
		fprintf(file, "param idle = 3\ntunable idle\n");
	if (chance(6))
		fprintf(file, "matrix still = [1, 2; 3, 4]\n");
}

static void write_spec(FILE *file, const char *of, const char *given, const char *operator, const char *stated)
{
	bool any = false;
	fprintf(file, "# options:%s\n# class: %s\n# changes:%s\n", given, of, changes);
	for (int i = 0; i < params; i++)
		any = any || param[i].tunable;
	if (any) {
		fprintf(file, "# retune:");
		for (int i = 0; i < params; i++)
			if (param[i].tunable)
				fprintf(file, " %s=%.4f", param[i].name, 0.6 + (double)below(3000) / 1000);
		if (class == LINEAR && !strstr(given, "--scheme"))      /* other schemes have the spec's step */
			fprintf(file, " step=%s", (const char *const[]){ "0.01", "0.03", "0.0625" }[below(3)]);
		fputc('\n', file);
	}
	fprintf(file, "model f\n");
	for (int i = 0; i < params; i++)
		fprintf(file, "param %s = %s\n", param[i].name, param[i].value);
	for (int i = 0; i < params; i++)
		if (param[i].tunable)
			fprintf(file, "tunable %s\n", param[i].name);
	for (int i = 0; i < coords; i++)
		fprintf(file, coord[i].size ? "coord %s[%d]\n" : "coord %s\n", coord[i].name, coord[i].size);
	for (int i = 0; i < inputs; i++)
		fprintf(file, "input %s%s\n", input[i].name, input[i].ramp ? " hold first" : "");
	write_unread(file);
	fprintf(file, "%s%s%s%s%s%s", initial(), spec_lets, operator, spec_equations, spec_outputs, stated);
	if (chance(6))
		fprintf(file, "let unread = %s + t\n", coord[0].size ? "2" : coord[0].name);
        fprintf(file, "step %s\n",
                (const char *const[]){ "0.01", "1/64", "0.0125", "0.02" }[below(class >= SMOOTH ? 3 : 4)]);
}

static void write_c(FILE *file, const char *given)
{
	char *names = "";
	for (int i = 0; i < params; i++) {
		const char *value = param[i].value;
		if (i == 0 && strstr(given, " -D "))
			value = "1.25";
		add(&names, text("\tconst double %s = %s;\n\t(void)%s;\n", param[i].name, value, param[i].name));
	}
	fprintf(file, "#include \"again.h\"\n\nconst int NAME(coords)[] = {%d", tops);
	for (int i = 0; i < coords; i++)
		for (int r = 0; r < (coord[i].size ? coord[i].size : 1); r++)
			fprintf(file, ", %d", coord[i].order);
	fprintf(file, "};\n\nvoid NAME(residual)(double t, const double *y, const double *u, const double *top, double "
	    "*r)\n{\n%s%s", names, c_lets);
	fprintf(file, "\t(void)t, (void)y, (void)u;\n%s}\n\n", c_rows);
        fprintf(file,
                "void NAME(wanted)(double t, const double *y, const double *u, const double *top, double *out)\n{\n"
                "%s%s",
                names, c_lets);
        fprintf(file, "\t(void)t, (void)y, (void)u, (void)top;\n");
	if (outputs)
		fprintf(file, "%s}\n", c_outputs);
	else
		fprintf(file, "\tfor (int i = 0; i < %d; i++)\n\t\tout[i] = y[i];\n}\n", states);
}

int main(int argc, char **argv)
{
	if (argc < 3) {
		fputs("usage: grammar SEED SPEC [C]\n", stderr);
		return 2;
	}
	state = strtoull(argv[1], NULL, 10) * UINT64_C(0x2545f4914f6cdd1d) + 7;
	const int kind = below(100);
	class = kind < 46 ? LINEAR : kind < 70 ? PIECEWISE : kind < 88 ? SMOOTH : KINKED;
	tunable = chance(class == LINEAR ? 25 : 15);
	drive = chance(50) ? GROUNDED : chance(50) ? TURNS : TURNS_FAR;
	declare();
	equations();
	if (drive && chance(80))
		write_inner();
	else
		write_outputs();
	const char *const operator = operator_statement(), *const stated = class >= SMOOTH && chance(20) ?
		scheme_statement() : "", *const given = options(stated);
	if (class != PIECEWISE && *changes && strstr(given, "--loads remainder"))
		class = KINKED;         /* the quadrature goes over the changes */
	FILE *const spec = fopen(argv[2], "w"), *const c = argc > 3 ? fopen(argv[3], "w") : NULL;
	if (!spec || (argc > 3 && !c)) {
		perror(argv[spec ? 3 : 2]);
		return 1;
	}
	write_spec(spec, (const char *const[]){ "linear", "piecewise", "smooth", "kinked" }[class], given, operator,
		stated);
	if (c)
		write_c(c, given);
	return fclose(spec) != 0 || (c && fclose(c) != 0);
}
