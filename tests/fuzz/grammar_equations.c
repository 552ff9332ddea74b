/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Equations of grammar's specs: of scalars and vectors, sketches, and drives, which may move as a whole. */
#include "grammar.h"

#include <string.h>

char *spec_equations = "", *c_rows = "", *spec_inner = "", *c_inner = "";
int inners;
static int rows;

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

/* ---- drives: what may move as a whole ---- */

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

void declare_drive(void)
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

void equations(void)
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
