/* SPDX-License-Identifier: GPL-3.0-or-later */
/* scenes SEED SPEC: a valid spec of what grammar.c lacks, since it has no second writing as C: dry friction, sliders
 * without mass, impacts, parts, delays, smooth holds, needs without a step; the same for the same seed. What is held
 * against it is another spec or another scheme, as lines of comment at its head say beside those of grammar.c:
 *     # instead: for sed: what a second spec has, of which CVODE solves the equations: steep dampers for friction,
 *                what is delayed as an input of its own
 *     # plain: options of that
 *     # beside: options with which the same spec is stepped too, where it has no equations that CVODE could solve */
#include "random.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

uint64_t state;

enum { ROOM = 1 << 14 };

static char body[ROOM], lets[ROOM], head[ROOM], declared[ROOM], outputs[ROOM], options[ROOM], equation[4][ROOM],
	retune[ROOM];

__attribute__((format(printf, 2, 3))) static void put(char *to, const char *form, ...)
{
	const size_t used = strlen(to);
	va_list arguments;
	va_start(arguments, form);
	const int length = vsnprintf(to + used, ROOM - used, form, arguments);
	va_end(arguments);
	if (length < 0 || (size_t)length >= ROOM - used)
		exit(3);
}

static double between(double low, double high)
{
	return low + (high - low) * below(101) / 100;
}

#define ONE_OF(...)                                                                                                   \
	((const char *const[]){ __VA_ARGS__ }[below(sizeof(const char *[]){ __VA_ARGS__ } / sizeof(char *))])

/* ---- what it has ---- */

enum curve { LINEAR, PIECES, SMOOTH };

static struct {
	enum curve curve;
	bool friction, holding, sliders, impacts, parts, delayed, oddly, smooth_hold, needs, tunable;
} has;

static int coords, bears, sliders, params, tuned;
static const char *const name[] = { "x", "y", "z" };

/* A number, or a param of that value, which may be tunable */
static const char *number(double low, double high)
{
	static char text[8][24];
	static int turn;
	char *const to = text[turn = (turn + 1) % 8];
	const double value = between(low, high) + 0.001;
	if (params > 8 || !chance(30)) {
		snprintf(to, sizeof *text, "%.3f", value);
		return to;
	}
	snprintf(to, sizeof *text, "k%d", params);
	put(declared, "param k%d = %.3f\n", params, value);
	if (has.tunable && chance(60)) {
		put(declared, "tunable k%d\n", params);
		put(retune, " k%d=%.3f", params, value * between(0.8, 1.2));
		tuned++;
	}
	params++;
	return to;
}

static const char *load(void)
{
	static char text[3][120];
	static int turn;
	char *const to = text[turn = (turn + 1) % 3];
	switch (below(6)) {
	case 0: return "0";
	case 1: snprintf(to, sizeof *text, "%.2f*t", between(0.5, 3)); break;
	case 2: snprintf(to, sizeof *text, "%.2f*exp(-%.2f*t)", between(0.5, 3), between(0.2, 2)); break;
	case 3:
		snprintf(to, sizeof *text, "(t < 0.083 ? %.2f : %.2f*t)", between(0.5, 3), between(0.5, 3));
		if (!strstr(head, "# changes: 0.083"))
			put(head, "# changes: 0.083\n");
		break;
	default: snprintf(to, sizeof *text, "%.2f*cos(%.2f*t + 1)", between(0.5, 5), between(1, 9));
	}
	return to;
}

/* ---- friction ---- */

static const char steep[] =
	"s/friction(\\(vel[0-9]\\), \\(bear[0-9]\\))"
	"/max(-max(\\2, 0), min(max(\\2, 0), 40000*(\\1)))/g; "
	"s/brake.spec/brake_steep.spec/; s/^output rub.*$//; s/^# class: sticking/# class: kinked/; ";
static const char creeping[] =
	"s/^friction(\\(s[0-9]\\)', \\(bear[0-9]\\)) = \\(born[0-9]\\)$"
	"/\\1' = 10000*(max(\\3 - max(\\2, 0), 0) + min(\\3 + max(\\2, 0), 0))/; "
	"s/^friction(\\(s[0-9]\\)', \\(bear[0-9]\\)) + \\([0-9.]*\\)[*]s[0-9]' = "
	"\\(born[0-9]\\)$/\\1' = (max(\\4 - max(\\2, 0), 0) + min(\\4 + max(\\2, 0), 0))\\/\\3/; ";

/* Its force, as a let: of a constant, time, an input or the state */
static int bear(const char *velocity)
{
	const char *const x = name[below(coords)];
	const double F = between(0.05, 1.5);
	put(lets, "let bear%d = ", bears);
	switch (below(has.curve == SMOOTH ? 6 : 9)) {
	case 0: put(lets, "%.3f + %.3f*cos(%.2f*t)", F, 0.8 * F, between(1, 9)); break;
	case 1: put(lets, "%.3f + 0.2*max(%s, 0)", F, x); break;
	case 2: put(lets, "%.3f*max(%.2f - 3*%s, 0)", F, between(0.1, 1), x); break;
	case 3: put(lets, "%.3f + clip(%s, -0.03, 0.04)", F, x); break;
	case 6: put(lets, "%s", strstr(declared, "input u_in") ? "max(0.1, u_in)" : "0.5 + 0.3*t"); break;
	case 7:
		if (*velocity)
			put(lets, "table(abs(%s); 0, %.3f; 0.3, %.3f; 2, %.3f)", velocity, F, F / 2, 0.6 * F);
		else
			put(lets, "max(%.3f, min(%s, 2))", F, x);
		break;
	default: put(lets, "%s", number(0.05, 1.5));
	}
	put(lets, "\n");
	return bears++;
}

static void rub(void)
{
	const int i = below(coords), j = coords > 1 ? (i + 1) % coords : i;
	const bool pair = j != i && chance(40);
	char v[80] = "";
	if (pair)
		put(v, "%s' - %s'", name[i], name[j]);
	else
		put(v, "%s'%s", name[i],
			chance(50) ? "" : ONE_OF(" - 0.2", " + 0.1", " - 0.3*cos(2*t)", " - 0.4*exp(-t)"));
	const int k = bear(v);
	put(lets, "let vel%d = %s\n", k, v);
	const char *const more = has.holding ? ONE_OF(", 2", ", 1.6") : "";
	put(equation[i], " + friction(vel%d, bear%d%s)", k, k, more);
	if (pair)
		put(equation[j], " - friction(vel%d, bear%d%s)", k, k, more);
	if (has.curve != SMOOTH && chance(30))
		put(outputs, "output rub%d = friction(vel%d, bear%d%s)\n", k, k, k, more);
}

static void slide(void)
{
	const int i = below(coords), k = bear("");
	const double spring = between(5, 25);
	put(declared, "coord s%d\n", sliders);
	put(lets, "let born%d = %.2f*(%s - s%d)\n", sliders, spring, name[i], sliders);
	put(equation[i], " + born%d", sliders);
	if (chance(40))
		put(body, "friction(s%d', bear%d) + %.2f*s%d' = born%d\n", sliders, k, between(0.1, 1), sliders,
			sliders);
	else
		put(body, "friction(s%d', bear%d) = born%d\n", sliders, k, sliders);
	if (chance(40))
		put(outputs, "output rub_s%d = friction(s%d', bear%d)\n", sliders, sliders, k);
	sliders++;
}

static void strike(void)
{
	const int i = below(coords), j = (i + 1) % coords;
	const double e = chance(20) ? 0 : between(0.1, 0.95);
	switch (below(coords > 1 ? 4 : 3)) {
	case 0:
		put(body, "when %s >= %.3f: %s' = -%.2f*%s'\n", name[i], between(0.01, 0.3), name[i], e, name[i]);
		break;
	case 1: put(body, "stop between %s, ground at %.3f restitution %.2f\n", name[i], between(0.01, 0.3), e); break;
	case 2: put(body, "stop between ground, %s at %.3f restitution %.2f\n", name[i], between(0.01, 0.3), e); break;
	default: put(body, "stop between %s, %s at %.3f restitution %.2f\n", name[i], name[j], between(0.01, 0.3), e);
	}
}

/* ---- equations ---- */

static const char *piece(int i)
{
	static char text[200];
	const char *const x = name[i], *const y = name[below(coords)];
	const double k = between(0.5, 9), a = between(0.02, 0.2);
	switch (below(7)) {
	case 0: snprintf(text, sizeof text, "%.2f*max(%s, min(%s, %.2f))", k, x, y, a); break;
	case 1: snprintf(text, sizeof text, "%.2f*clip(%s, -%.2f, %.2f)", k, x, a, a); break;
	case 2:
		snprintf(
			text, sizeof text, "%.2f*deadzone(%s - %s, -%.2f, %.2f)", k, x, i ? name[i - 1] : "0.1", a, a);
		break;
	case 3: snprintf(text, sizeof text, "%s*max(%s - %.2f, 0)", number(1, 20), x, a); break;
	case 4: snprintf(text, sizeof text, "(%s' > 0 ? 0.2*%s' : 0.7*%s')", x, x, x); break;
	case 5: snprintf(text, sizeof text, "table(%s; -1, -2; -0.05, 0; %.2f, 0.5)", x, a); break;
	default: snprintf(text, sizeof text, "%.2f*min(clip(%s, -0.3, 0.3), max(%s, -%.2f))", k, x, y, a);
	}
	return text;
}

static const char *curve(int i)
{
	static char text[200];
	const char *const x = name[i], *const y = name[below(coords)];
	switch (below(6)) {
	case 0: snprintf(text, sizeof text, "%s*%s^3", number(1, 5), x); break;
	case 1: snprintf(text, sizeof text, "%.2f*sin(%s)", between(1, 5), x); break;
	case 2: snprintf(text, sizeof text, "%.2f*abs(%s')*%s'", between(0.1, 1), x, x); break;
	case 3: snprintf(text, sizeof text, "%.2f*%s*%s", between(0.1, 1), x, y); break;
	case 4: snprintf(text, sizeof text, "%.2f*tanh(2*%s')", between(0.1, 1), x); break;
	default: snprintf(text, sizeof text, "%.2f*max(%s, 0)^2", between(1, 5), x);
	}
	return text;
}

static const char *driving(double step)
{
	static char text[120];
	if (!strstr(declared, "input u_in"))
		return load();
	if (has.delayed)
		snprintf(text, sizeof text, "2*u_in(t - %.4f)", has.oddly ? between(0.2, 3) * step : 2 * step);
	else
		snprintf(text, sizeof text, "2*u_in");
	return text;
}

static void equations(double step)
{
	for (int i = 0; i < coords; i++) {
		put(equation[i], "%s*%s''", number(0.5, 2), name[i]);
		if (chance(60))
			put(equation[i], " + %s*%s'", number(0.05, 0.6), name[i]);
		if (chance(85))
			put(equation[i], " + %s*%s", number(2, 40), name[i]);
		if (i > 0)
			put(equation[i], " + 3*(%s - %s)", name[i], name[i - 1]);
		if (i + 1 < coords)
			put(equation[i], " + 3*(%s - %s)", name[i], name[i + 1]);
		if (has.curve >= PIECES && chance(60))
			put(equation[i], " + %s", has.curve == PIECES || chance(20) ? piece(i) : curve(i));
	}
	if (has.curve == SMOOTH)
		put(equation[0], " + 2*%s^3", name[0]);
	for (int n = has.friction ? 1 + below(2) : 0; n > 0; n--)
		rub();
	for (int n = has.sliders ? 1 + below(2) : 0; n > 0; n--)
		slide();
	for (int n = has.impacts ? 1 + below(2) : 0; n > 0; n--)
		strike();
	for (int i = 0; i < coords; i++)
		put(body, "%s = %s\n", equation[i], i == 0 ? driving(step) : load());
}

static void parts(void)
{
	if (!has.parts)
		return;
	const char *const of = has.curve == LINEAR && !has.friction
				       ? "cell"
				       : ONE_OF("cell", "stop", has.friction || has.sliders ? "brake" : "stop");
	put(declared, "use \"parts/%s.spec\" as p%s with x' = %.2f%s\n", of, chance(30) ? ", idle" : "",
		between(0.1, 1), strcmp(of, "cell") ? "" : ", pull = cos(4*t), base = 0.1");
	if (chance(80))
		put(body, "spring %.2f between p.x, x\n", between(1, 9));
	put(outputs, "output p.x, x\n");
}

static void statements(double step)
{
	for (int i = 0; i < coords; i++)
		if (chance(60))
			put(outputs, "output out%d = %s%s\n", i, name[i],
				ONE_OF("", "'", chance(50) ? "''" : "", " + 0.5*x'"));
	if (has.needs || !*outputs || strcmp(outputs, "output p.x, x\n") == 0)
		put(outputs, "output seen = x + 0.5*%s'\n", name[coords - 1]);
	if (has.needs)
		put(outputs, "need seen within %s until 0.5%s\n", has.curve == LINEAR ? "1e-7" : "1e-5",
			strstr(declared, "input u_in") ? " for |u_in| <= 2" : "");
	if (!has.needs || strstr(declared, "input u_in") || chance(30))
		put(outputs, "step %g\n", step);
}

/* ---- what it is held against ---- */

static const char *class_of(void)
{
	return has.friction || has.sliders					     ? "sticking"
	       : has.curve == SMOOTH						     ? "kinked"
	       : has.curve == PIECES || has.impacts || strstr(declared, "stop.spec") ? "piecewise"
										     : "linear";
}

static void against(void)
{
	const bool contacts = has.friction || has.sliders || has.impacts || has.curve >= PIECES;
	put(head, "# class: %s\n", class_of());
	if (has.impacts || has.holding || has.smooth_hold || has.oddly) {
		put(head, "# beside: %s\n",
			has.curve == SMOOTH ? "--scheme taylor --tolerance 1e-13"
			: contacts	    ? "--scheme taylor --tolerance 1e-12"
					    : "--form direct");
		return;
	}
	if (has.friction || has.sliders || has.delayed)
		put(head, "# instead: %s%ss/u_in(t - [0-9.]*)/late/; s/^# whole: //\n# plain: --scheme etdrk4\n",
			steep, creeping);
}

static void choose_options(void)
{
	const bool contacts = has.friction || has.sliders || has.impacts;
	if (chance(20))
		put(options, " --real float");
	if (has.curve < SMOOTH && chance(15))
		put(options, " --accuracy compensated");
	if (has.curve < SMOOTH && contacts && !has.sliders && !has.needs && chance(30))
		put(options, " --scheme taylor");
	if (has.curve == SMOOTH && !contacts && chance(70))
		put(options, " --scheme %s",
			ONE_OF("taylor", "radau", "auto", "etd1", "etdrk2", "etdrk4", "nc2", "bm3"));
	if (has.curve == LINEAR && !contacts && chance(30))
		put(options, " %s",
			ONE_OF("--batch", "--reduce", "--form delta", "--form direct", "--rows 8", "--selftest"));
	if (has.curve == PIECES && chance(10))
		put(options, " --selftest");
}

static void inputs(void)
{
	if (!has.delayed && !has.smooth_hold && !chance(25))
		return;
	const char *const hold = has.smooth_hold ? ONE_OF("third", "fifth", "seventh") : chance(50) ? "first" : NULL;
	put(declared, "input u_in%s%s\n%s", hold ? " hold " : "", hold ? hold : "",
		chance(15) ? "input unread\n" : "");
	if (has.delayed) /* drive.c has it behind all others */
		put(declared, "# whole: input late%s%s\n", hold ? " hold " : "", hold ? hold : "");
}

static void choose(void)
{
	const int kind = below(100);
	has.curve = (enum curve)below(3);
	has.friction = kind < 40;
	has.holding = has.friction && chance(25);
	has.sliders = has.curve != SMOOTH && (kind >= 35 && kind < 60);
	has.impacts = (kind >= 60 && kind < 80) || (has.friction && chance(10));
	has.parts = chance(15);
	has.delayed = chance(has.friction ? 6 : 20);
	has.oddly = has.delayed && chance(30);
	has.smooth_hold = !has.delayed && has.curve == LINEAR && kind >= 80 && chance(40);
	has.tunable = !has.delayed && !has.smooth_hold && chance(30);
	has.needs = !has.delayed && !has.tunable && !has.smooth_hold && !has.friction && !has.impacts &&
		    !has.sliders && chance(30);
	coords = 1 + below(3);
}

int main(int argc, char **argv)
{
	static const double step[] = { 0.01, 0.015625, 0.0125, 0.02 };
	if (argc < 3) {
		fputs("usage: scenes SEED SPEC\n", stderr);
		return 2;
	}
	state = strtoull(argv[1], NULL, 10) * UINT64_C(0x9e6c63d0876a9a63) + 11;
	choose();
	const double h = step[below(4)];
	inputs();
	parts();
	equations(h);
	statements(h);
	choose_options();
	against();
	FILE *const file = fopen(argv[2], "w");
	if (!file) {
		perror(argv[2]);
		return 1;
	}
	fprintf(file, "# options:%s\n%s", options, head);
	if (tuned)
		fprintf(file, "# retune:%s\n", retune);
	fprintf(file, "model f\ncoord x");
	for (int i = 1; i < coords; i++)
		fprintf(file, ", %s", name[i]);
	fprintf(file, "\n%s%s", declared, chance(8) ? "param spare = 2\n" : "");
	for (int i = 0; i < coords; i++)
		fprintf(file, "init %s = %.3f, %s' = %.3f\n", name[i],
			has.impacts ? between(-0.3, 0) : between(-0.3, 0.3), name[i], between(-0.8, 0.8));
	fprintf(file, "%s%s%s", lets, body, outputs);
	return fclose(file) != 0;
}
