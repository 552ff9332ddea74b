/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Terms of grammar's specs: numbers, loads, forces, each in both languages. */
#include "grammar.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- text in both languages ---- */

char *copy(const char *text)
{
	char *own = malloc(strlen(text) + 1);
	if (!own)
		exit(3);
	return strcpy(own, text);
}

char *text(const char *form, ...)
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

struct both same(const char *words)
{
	return (struct both){ copy(words), copy(words) };
}

struct both join2(const char *spec, const char *c, int count, const struct both *operand)
{
	char line[2][ROOM];
	const char *const form[2] = { spec, c };
	for (int k = 0; k < 2; k++) {
		int used = 0;
		size_t n = 0;
		for (const char *p = form[k]; *p; p++) {
					const char one[2] = { *p, 0 }, *piece = *p != '@' ? one : k ? operand[used].c
							: operand[used].spec;
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

/* ---- what is declared ---- */

struct coord coord[MOST_COORDS];
char *ratio[MOST_COORDS];
int coords;
struct input input[MOST_NAMES];
int inputs;
struct param param[MOST_NAMES];
int params;
char changes[400];
enum class class;
bool tunable;
enum drive drive;
char *spec_lets = "", *c_lets = "";
int lets;

void add(char **to, const char *more)
{
	*to = text("%s%s", *to, more);
}

double motion(int which)
{
	return ratio[which] ? strtod(ratio[which], NULL) : 0;
}

struct both derivative(int which, int component, int primes)
{
	const struct coord *x = &coord[which];
	const int i = component < 0 ? 0 : component;
	char *const spec = component < 0 ? text("%s%.*s", x->name, primes, "''") : text("%s[%d]%.*s", x->name,
		component + 1, primes, "''");
	return (struct both){ spec, primes == x->order ? text("top[%d]", x->top + i)
		: text("y[%d]", (primes ? x->velocity : x->first) + i) };
}

int any_component(int which)
{
	return coord[which].size ? below(coord[which].size) : -1;
}

static struct both position(void)
{
	const int which = below(coords);
	return derivative(which, any_component(which), 0);
}

struct both any_state(void)
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

struct both factor(double low, double high)
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

struct both fixed(double low, double high)
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

struct both load(int depth)
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

struct both sampled(void)
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
			return depth > 0 ? JOIN("(@ - @)", regional(depth - 1), regional(0))
					: JOIN("deadzone(@, -@, @)", e, a, a);
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
			return JOIN2("(t < @ ? @ : 0.5)*@^2", "(t < @ ? @ : 0.5)*pow(@, 2)", change_at(0.02, 0.2),
					fixed(0, 2), x);
	case 6: case 7: return JOIN("@*@", fixed(0.5, 5), extreme_in_extreme(x));
		default: return JOIN("@ + @", regional(1), smooth_remainder());
	}
}

struct both force(void)
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
