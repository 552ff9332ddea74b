/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "unresolved_system.h"

#include <math.h>

static unsigned state;

static double drawn(double low, double high)
{
	state = state * 1103515245u + 12345u;
	return low + (high - low) * ((double)(state >> 8) / 16777216);
}

/* To three digits, so that the spec has the same number */
static double short_number(double value)
{
	char text[32];
	double same = 0;
	snprintf(text, sizeof text, "%.3g", value);
	sscanf(text, "%lf", &same);
	return same;
}

static double number(double low, double high)
{
	return short_number(drawn(low, high));
}

/* Evenly by its logarithm */
static double by_logarithm(double low, double high)
{
	return short_number(exp(drawn(log(low), log(high))));
}

enum kind { FRICTION, BELT, CONTACT, NARROW, PULSE, LOGISTIC, WELL, ROOT, WINDOW, ARC, LORENTZ, SECANT, WALL, SWITCH,
			POWER, STRIBECK, FLAT, RIDGE, COSH, BURSTS, TEETH, GROWTH };

static int is_in_time(int kind)
{
	return kind == PULSE || kind == WINDOW || kind == LORENTZ || kind == SECANT || kind == SWITCH ||
		   kind == BURSTS || kind == GROWTH;
}

/* From a seed on that no random one has */
static const struct unresolved given[UNRESOLVED_GIVEN] = {
	{ .kind = FRICTION, .masses = 1, .tolerance = 1e-9, .step = 0.1, .stiffness = 1, .force = 1.5, .frequency = 0.7,
	  .size = 1, .steep = 20, .start = { 0.5 } },
	{ .kind = FRICTION, .masses = 1, .tolerance = 1e-13, .step = 0.1, .stiffness = 1, .force = 1.5,
			.frequency = 0.7,
	  .size = 1, .steep = 50, .start = { 0.5 } },
	{ .kind = PULSE, .masses = 1, .tolerance = 1e-9, .step = 0.1, .stiffness = 1, .damping = 0.1, .cubic = 1,
	  .frequency = 1, .size = -50, .steep = 10, .at = 5 },
	{ .kind = PULSE, .masses = 1, .tolerance = 1e-6, .step = 0.5, .stiffness = 1, .damping = 0.1, .cubic = 1,
	  .frequency = 1, .size = -50, .steep = 100, .at = 5 },
	{ .kind = GROWTH, .masses = 1, .tolerance = 1e-9, .step = 0.25, .stiffness = 1.38, .damping = 0.257,
	  .cubic = 0.696, .frequency = 1, .size = 0.432, .steep = 170 },
};

struct unresolved unresolved_of(unsigned seed)
{
	if (seed >= UNRESOLVED_FIRST_GIVEN)
		return given[(seed - UNRESOLVED_FIRST_GIVEN) % UNRESOLVED_GIVEN];
	static const double tolerance[] = { 1e-4, 1e-6, 1e-9, 1e-11 }, step[] = { 0.05, 0.1, 0.25, 0.5 };
	struct unresolved u = { .kind = (int)(seed % UNRESOLVED_KINDS) };
	state = seed * 2654435761u + 1;
	for (int i = 0; i < 5; i++)
		drawn(0, 1);
	u.masses = drawn(0, 1) < 0.7 ? 1 : 2;
	u.tolerance = tolerance[(int)drawn(0, 4)];
	u.step = step[(int)drawn(0, 4)];
	u.stiffness = number(0.3, 4);
	u.damping = number(0.02, 0.3);
	u.cubic = drawn(0, 1) < 0.5 ? number(0.1, 1) : 0;
	u.force = number(0.5, 2);
	u.frequency = number(0.4, 1.5);
	u.size = by_logarithm(0.3, 5);
	u.steep = by_logarithm(8, 200);
	u.at = number(-0.7, 0.7);
	u.start[0] = number(-1, 1);
	u.start[u.masses] = number(-1, 1);
	if (u.kind == CONTACT || u.kind == WALL)
		u.size = by_logarithm(5, 50);
	if (u.kind == WALL) {                   /* from outside */
		u.steep = fmin(u.steep, 40);
		u.start[0] = fmin(u.start[0], u.at);
	}
	if (u.kind == WELL || u.kind == SECANT || u.kind == SWITCH
			|| u.kind == COSH)     /* within the largest number */
		u.steep = fmin(u.steep, 60);
	u.power = 2 * (int)drawn(4, 16) + 1;
	if (!is_in_time(u.kind))
		return u;
	u.at = number(1, 9);
	u.until = short_number(u.at + drawn(0.05, 2));
	if (drawn(0, 1) < 0.6)                  /* from rest */
		u.force = u.start[0] = u.start[u.masses] = 0;
	return u;
}

void print_unresolved(FILE *to, const struct unresolved *u)
{
	const double F = u->size, s = u->steep, a = u->at;
	const int two = u->masses == 2;
	fprintf(to, "model m\ncoord x%s\nstep %g\ntolerance %g\n", two ? ", y" : "", u->step, u->tolerance);
	fprintf(to, "init x = %g\ninit x' = %g\n", u->start[0], u->start[u->masses]);
	fprintf(to, "x'' + %g*x' + %g*x + %g*x^3%s + (", u->damping, u->stiffness, u->cubic, two
			? " + 0.5*(x - y)" : "");
	switch (u->kind) {
	case FRICTION: fprintf(to, "%g*tanh(%g*x')", F, s); break;
	case BELT:     fprintf(to, "%g*tanh(%g*(x' - (%g)))", F, s, a); break;
	case CONTACT:  fprintf(to, "%g/%g*log(1 + exp(%g*(x - (%g))))", F, s, s, a); break;
	case NARROW:   fprintf(to, "%g*exp(-(%g*(x - (%g)))^2)", F, s, a); break;
	case PULSE:    fprintf(to, "%g*exp(-(%g*(t - (%g)))^2)", F, s, a); break;
	case LOGISTIC: fprintf(to, "%g/(1 + exp(-%g*(x - (%g))))", F, s, a); break;
	case WELL:     fprintf(to, "%g/cosh(%g*(x - (%g)))^2", F, s, a); break;
	case ROOT:     fprintf(to, "%g*x'/sqrt(x'^2 + %g^(-2))", F, s); break;
	case WINDOW:   fprintf(to, "%g*(tanh(%g*(t - %g)) - tanh(%g*(t - %g)))", F, s, a, s, u->until); break;
	case ARC:      fprintf(to, "%g*atan(%g*x')", F, s); break;
	case LORENTZ:  fprintf(to, "%g/(1 + (%g*(t - %g))^2)", F, s, a); break;
	case SECANT:   fprintf(to, "%g/cosh(%g*(t - %g))", F, s, a); break;
	case WALL:     fprintf(to, "%g*exp(%g*(x - (%g)))", F, s, a); break;
	case POWER:    fprintf(to, "%g*(x/0.8)^%d", F, u->power); break;
	case STRIBECK: fprintf(to, "%g*tanh(%g*x')*(1 + exp(-(x'/0.1)^2))", F, s); break;
	case FLAT:     fprintf(to, "%g*exp(-(%g*(x - (%g)))^4)", F, s, a); break;
	case RIDGE:    fprintf(to, "%g/(1 + (%g*(x - (%g)))^8)", F, s, a); break;
	case COSH:     fprintf(to, "%g/%g*log(cosh(%g*x'))*x'", F, s, s); break;
	case BURSTS:   fprintf(to, "%g*sin(1.3*(t - %g))^%d", F, a, u->power - 1); break;
	case TEETH:    fprintf(to, "%g*sin(3*(x - (%g)))^%d", F, a, u->power - 1); break;
	case GROWTH:   fprintf(to, "%g*exp(%g*(t - 12))", F, s / 10); break;
	case SWITCH:   fprintf(to, "%g/(1 + exp(-%g*(t - %g)))", F, s, a); break;
	}
	fprintf(to, ") = %g*cos(%g*t)\n", u->force, u->frequency);
	if (two)
		fprintf(to, "y'' + 0.1*y' + 2*y + 0.5*(y - x) = 0\n");
}

static const struct unresolved *followed;

static real unresolved_force(const struct unresolved *u, real t, real x, real v)
{
	const real F = u->size, s = u->steep, a = u->at;
	switch (u->kind) {
	case FRICTION: return F * tanhl(s * v);
	case BELT:     return F * tanhl(s * (v - a));
	case CONTACT:  return F / s * (s * (x - a) > 60 ? s * (x - a) : log1pl(expl(s * (x - a))));
	case NARROW:   return F * expl(-(s * (x - a)) * (s * (x - a)));
	case PULSE:    return F * expl(-(s * (t - a)) * (s * (t - a)));
	case LOGISTIC: return F / (1 + expl(-s * (x - a)));
	case WELL:     return F / (coshl(s * (x - a)) * coshl(s * (x - a)));
	case ROOT:     return F * v / sqrtl(v * v + 1 / (s * s));
	case WINDOW:   return F * (tanhl(s * (t - a)) - tanhl(s * (t - u->until)));
	case ARC:      return F * atanl(s * v);
	case LORENTZ:  return F / (1 + s * (t - a) * s * (t - a));
	case SECANT:   return F / coshl(s * (t - a));
	case WALL:     return F * expl(s * (x - a));
	case POWER:    return F * powl(fabsl(x) / 0.8L, u->power) * (x < 0 ? -1 : 1);
	case STRIBECK: return F * tanhl(s * v) * (1 + expl(-100 * v * v));
	case FLAT:     return F * expl(-powl(s * (x - a), 4));
	case RIDGE:    return F / (1 + powl(s * (x - a), 8));
	case COSH:     return F / s * logl(coshl(s * v)) * v;
	case BURSTS:   return F * powl(sinl(1.3L * (t - a)), u->power - 1);
	case TEETH:    return F * powl(sinl(3 * (x - a)), u->power - 1);
	case GROWTH:   return F * expl(s / 10 * (t - 12));
	default:       return F / (1 + expl(-s * (t - a)));
	}
}

static void slopes(real t, const real *y, const real *unused, real *dydt)
{
	const struct unresolved *u = followed;
	const int n = u->masses;
	const real x = y[0], v = y[n];
	(void)unused;
	dydt[0] = v;
	dydt[n] = u->force * cosl(u->frequency * t) - u->damping * v - u->stiffness * x - u->cubic * x * x * x -
			  unresolved_force(u, t, x, v);
	if (n == 2) {
		dydt[1] = y[3];
		dydt[2] -= (x - y[1]) / 2;
		dydt[3] = -0.1L * y[3] - 2 * y[1] - (y[1] - x) / 2;
	}
}

/* What has powers inside bends more sharply than its slope tells: pieces a seventh as long follow it to all digits. */
void follow_unresolved(const struct unresolved *u, real from, real to, real *y)
{
	const int sharp = u->kind == STRIBECK || u->kind == FLAT || u->kind == RIDGE || u->kind == COSH;
	followed = u;
	gragg(slopes, 2 * u->masses, from, to, (sharp ? 0.1L : 0.7L) / (u->steep > 40 ? u->steep : 40), 0, NULL, y);
}
