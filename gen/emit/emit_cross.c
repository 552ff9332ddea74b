/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Regions: a crossing that is the only one of a step, by the Taylor polynomials of the entries of x. All else is left
 * to the runtime's search. */
#include "emit/emit.h"

static void emit_expression(const struct emitter *e, const struct pieces *p)
{
	int size = e->step->layout.size, n = expressions_of(e);
	say(e, "\n"
	       "static double $n_expression(int i, const double x[%d])\n"
	       "{\n", size);
	if (n == 1) {
		say(e, "    (void)i;\n"
		       "    return %s;\n", expression_text(e, p, 0, places(e, "x[%d]"), 11));
	} else {
		struct region_tables rows = { spell(e, "$n_row"), n, size, 0, 0, NULL };
		const char **term = ARRAY(const char *, (size_t)size);
		int terms = 0;
		for (int j = 0; j < size; j++) {
			bool any = false;
			for (int i = 0; i < n; i++)
				any = any || p->row[i * size + j] != 0;
			if (any)
				term[terms++] = format("%s[i][%d] * x[%d]", rows.text, j, j);
		}
		say(e, "    return %s;\n", terms ? tree(terms, term, 11) : "0.0");
	}
	say(e, "}\n");
}

static double *turns_of(const struct region_piece *piece)
{
	return piece->turns;
}

/* Entries of h A that differ from matrix to matrix: locals, and their text */
static void emit_turns(const struct emitter *e, const struct region_tables *t)
{
	for (int i = 0; i < t->rows; i++)
		for (int j = 0; j < t->columns; j++)
			if (acts_at(t, i, j) && !agree_at(t, i, j))
				say(e, "    const double h%d_%d = $N_H * $n_slopes[which][%d][%d];\n", i, j, i, j);
}

static const char *turn_times(const struct region_tables *t, int i, int j)
{
	const char *a = format("a%d", j);
	return agree_at(t, i, j) ? scaled(t->value[0][i * t->columns + j], a) : format("h%d_%d * %s", i, j, a);
}

/* Velocities are added last: positions and loads are there before them, so that a chain has one product and one sum an
 * order. */
static const char *turned_row(const struct emitter *e, const struct region_tables *t, int row)
{
	const char **early = ARRAY(const char *, (size_t)t->columns), **late = ARRAY(const char *, (size_t)t->columns);
	int earlies = 0, lates = 0;
	for (int j = 0; j < t->columns; j++) {
		if (!acts_at(t, row, j))
			continue;
		bool velocity = j >= e->system->n && j < e->system->states;
		if (velocity)
			late[lates++] = turn_times(t, row, j);
		else
			early[earlies++] = turn_times(t, row, j);
	}
	if (earlies && lates)
		return format("(%s)\n%26s+ (%s)", tree(earlies, early, 26), "", tree(lates, late, 28));
	return earlies ? tree(earlies, early, 25) : lates ? tree(lates, late, 25) : "0.0";
}

static void emit_weights(const struct emitter *e, const struct pieces *p)
{
	int terms = p->degree + 1;
	say(e, "\n"
	       "static const double $n_weight[%d] = {  /* 1/k! */\n"
	       "    1.0", terms);
	for (int k = 1; k < terms; k++)
		say(e, "%s%s", k % 4 ? ", " : ",\n    ", shortest(p->weight[k]));
	say(e, "\n"
	       "};\n"
	       "static const double $n_orders[%d] = {", terms);
	for (int k = 0; k < terms; k++)
		say(e, "%s%d.0", k ? ", " : "", k);
	say(e, "};\n");
}

static void emit_expand(const struct emitter *e, const struct pieces *p)
{
	int size = e->step->layout.size, terms = p->degree + 1;
	struct region_tables turns = tables_of_regions(e, p, "", size, turns_of);
	emit_weights(e, p);
	say(e, "\n"
	       "/* The coefficients of x(s) = e^{A h s} x: its derivatives, times 1/k! */\n"
	       "static void $n_expand(int which, const double x[%d], double c[%d][%d])\n"
	       "{\n", size, terms, size);
	emit_turns(e, &turns);
	for (int j = 0; j < size; j++)
		say(e, "%sa%d = x[%d]%s", j ? ", " : "    double ", j, j, j == size - 1 ? ";\n" : "");
	say(e, "    int k;\n");
	for (int j = 0; j < size; j++)
		say(e, "    c[0][%d] = a%d;\n", j, j);
	say(e, "    for (k = 1; k < %d; k++) {\n"
	       "        const double weight = $n_weight[k];\n", terms);
	for (int i = 0; i < size; i++)
		say(e, "        const double b%d = %s;\n", i, turned_row(e, &turns, i));
	for (int i = 0; i < size; i++)
		say(e, "        a%d = b%d;\n"
		       "        c[k][%d] = weight * b%d;\n", i, i, i, i);
	say(e, "    }\n"
	       "    (void)which;\n"
	       "}\n");
}

/* x(s): of `count` of its entries */
static void emit_polynomial(const struct emitter *e, const struct pieces *p, const char *name, int count)
{
	int size = e->step->layout.size, terms = p->degree + 1;
	say(e, "\n"
	       "/* x(s)%s */\n"
	       "static void $n_%s(double c[%d][%d], double s, double x[%d])\n"
	       "{\n"
	       "    const double ss = s * s;\n", count < size ? ", the states" : "", name, terms, size, size);
	for (int i = 0; i < count; i++)
		say(e, "    double even%d = c[%d][%d], odd%d = c[%d][%d];\n", i, terms - 2, i, i, terms - 1, i);
	say(e, "    int k;\n"
	       "    for (k = %d; k >= 0; k -= 2) {\n", terms - 4);
	for (int i = 0; i < count; i++)
		say(e, "        even%d = even%d * ss + c[k][%d];\n"
		       "        odd%d = odd%d * ss + c[k + 1][%d];\n", i, i, i, i, i, i);
	say(e, "    }\n");
	for (int i = 0; i < count; i++)
		say(e, "    x[%d] = even%d + s * odd%d;\n", i, i, i);
	say(e, "}\n");
}

/* sum of |g[k + 2]| r^k, of k + 2 times that for `slopes`; lines of a function */
static void emit_sizes(const struct emitter *e, int terms, const char *sum, const char *r, bool slopes)
{
	const char *factor = slopes ? spell(e, "$n_orders[k + 2] * ") : "",
		   *next = slopes ? spell(e, "$n_orders[k + 3] * ") : "";
	say(e, "    for (k = %d; k >= 0; k -= 2) {\n"
	       "        even = even * (%s * %s) + %spl_magnitude(g[k + 2]);\n"
	       "        odd = odd * (%s * %s) + %spl_magnitude(g[k + 3]);\n"
	       "    }\n"
	       "    %s = even + %s * odd;\n",
	    terms - 4, r, r, factor, r, r, next, sum, r);
}

static void emit_root(const struct emitter *e, const struct pieces *p)
{
	int terms = p->degree + 1;
	say(e, "\n"
	       "/* Where g rises through 0 for 0 < s < 1 first; 2: that is not certain.  Up to `most` its slope "
	       "is above `least`\n"
	       " * by the sizes of its other coefficients, and |g''| below `bend`: there is one root.  Two steps "
	       "of Newton's\n"
	       " * method from the series of the inverse.  slack: what g' may be off by; g > 0 at 1 is known. */\n"
	       "static double $n_root(const double g[%d], double slack)\n"
	       "{\n"
	       "    const double q = g[2] / g[1], w = -g[0] / g[1];\n"
	       "    const double guess = w * (1.0 - q * w * (1.0 - 2.0 * q * w)), most = guess < 0.99 ? guess + "
	       "0.01 : 1.0;\n"
	       "    double z = guess, last = guess, miss = 0.0, even = 0.0, odd = 0.0, least, bend = 0.0;\n"
	       "    int i, k;\n", terms);
	emit_sizes(e, terms, "least", "most", true);
	say(e, "    least = g[1] - slack - most * least;\n"
	       "    for (k = 2; k < %d; k++)\n"
	       "        bend += $n_orders[k] * $n_orders[k - 1] * pl_magnitude(g[k]);\n"
	       "    for (i = 0; i < 2; i++) {\n"
	       "        const double zz = z * z;\n"
	       "        double even_slope = %d.0 * g[%d], odd_slope = 0.0;\n"
	       "        even = g[%d];\n"
	       "        odd = g[%d];\n"
	       "        for (k = %d; k >= 0; k -= 2) {\n"
	       "            even = even * zz + g[k];\n"
	       "            odd = odd * zz + g[k + 1];\n"
	       "            even_slope = even_slope * zz + $n_orders[k + 1] * g[k + 1];\n"
	       "            odd_slope = odd_slope * zz + $n_orders[k + 2] * g[k + 2];\n"
	       "        }\n"
	       "        miss = even + z * odd;\n"
	       "        last = z;\n"
	       "        z -= miss / (even_slope + z * odd_slope);\n"
	       "    }\n",
	    terms, terms - 1, terms - 1, terms - 2, terms - 1, terms - 4);
	say(e, "    if (!(least > 0.0 && last > 0.0 && last <= most && z > 0.0 && z < 1.0))\n"
	       "        return 2.0;\n"
	       "    if (most < 1.0 && !(least * (most - last) > -miss))\n"
	       "        return 2.0;\n"
	       "    /* the root is within |miss|/least of the last but one, and z within bend/(2 least) times "
	       "that squared */\n"
	       "    return bend * (miss * miss) < least * least * least * 2.220446049250313e-16 ? z : 2.0;\n"
	       "}\n");
}

/* off[i], from x */
static void emit_bounds(const struct emitter *e, const struct pieces *p)
{
	int n = expressions_of(e);
	const char **size = entries(e, "pl_magnitude(x[%d])");
	say(e, "\n"
	       "/* How far each expression is off its chord over h or less, at most */\n"
	       "static void $n_bounds(int which, const double x[%d], double off[%d])\n"
	       "{\n", e->step->layout.size, n);
	for (int i = 0; i < n; i++)
		say(e, "    off[%d] = %s;\n", i, off_text(e, p, -1, i, size, 13));
	say(e, "    (void)which;\n"
	       "    (void)x;\n"
	       "}\n"
	       "\n"
	       "static int $n_stays(int region, int i, double from, double to, double off)\n"
	       "{\n"
	       "    return (from < to ? from : to) - off > $n_within[region][i][0] &&\n"
	       "           (from > to ? from : to) + off < $n_within[region][i][1];\n"
	       "}\n");
}

/* Into end[]: Phi x over h */
static void emit_whole(const struct emitter *e, const struct pieces *p)
{
	int size = e->step->layout.size;
	struct region_tables whole = tables_of_regions(e, p, "factor", size, whole_of);
	const char **x = entries(e, "x[%d]");
	say(e, "\n"
	       "/* e^{A h} x */\n"
	       "static void $n_advance(int which, const double x[%d], double end[%d])\n"
	       "{\n"
	       "    const double (*const factor)[%d] = $n_%s[which];\n",
	    size, size, size, any_pieces(e) ? "whole" : "pieces");
	for (int i = 0; i < size; i++)
		say(e, "    end[%d] = %s;\n", i, row_text(&whole, i, x, NULL, 13));
	say(e, "    (void)factor;\n"
	       "}\n");
}

/* Which expressions are not seen to be clear */
static void emit_near(const struct emitter *e, const struct pieces *p)
{
	int size = e->step->layout.size, n = expressions_of(e);
	const char *whole = any_pieces(e) ? "whole_" : "";
	say(e, "\n"
	       "/* How many expressions are not seen to be clear over h, from x to end; the last of them.  By "
	       "chords, then by\n"
	       " * cubics, which lie within their Bezier points */\n"
	       "static int $n_near(int region, int which, const double x[%d], const double end[%d], int *last)\n"
	       "{\n"
	       "    double off[%d];\n"
	       "    int i, j, near = 0;\n"
	       "    $n_bounds(which, x, off);\n"
	       "    for (i = 0; i < %d; i++) {\n"
	       "        const double from = $n_expression(i, x), to = $n_expression(i, end);\n"
	       "        double leaving = from, arriving = to, sway = 0.0;\n"
	       "        if ($n_stays(region, i, from, to, off[i]))\n"
	       "            continue;\n",
	    size, size, n, n);
	say(e, "        for (j = 0; j < %d; j++) {\n"
	       "            leaving += $n_%slean[which][i][j] * x[j];\n"
	       "            arriving -= $n_%slean[which][i][j] * end[j];\n"
	       "            sway += $n_%ssway[which][i][j] * pl_magnitude(x[j]);\n"
	       "        }\n"
	       "        if ($n_stays(region, i, from, to, sway) && $n_stays(region, i, leaving, arriving, sway))\n"
	       "            continue;\n"
	       "        *last = i;\n"
	       "        near++;\n"
	       "    }\n"
	       "    return near;\n"
	       "}\n",
	    size, whole, whole, whole);
	(void)p;
}

/* Where one expression leaves its interval */
static void emit_leaves(const struct emitter *e, const struct pieces *p)
{
	int size = e->step->layout.size, terms = p->degree + 1;
	say(e, "\n"
	       "/* Where expression i, which is `to` after h, first passes the upper or the lower end of its "
	       "interval; 2: that is\n"
	       " * not certain.  c: the coefficients of x(s) */\n"
	       "static double $n_leaves(int region, int which, int i, int up, const double x[%d], double "
	       "c[%d][%d], double to)\n"
	       "{\n"
	       "    const double sign = up ? 1.0 : -1.0, b = $n_within[region][i][up], from = $n_expression(i, x);\n"
	       "    double g[%d], noise = pl_magnitude(b), slack = 0.0;\n"
	       "    int k;\n"
	       "    if ($n_beyond[region][i][up] < 0 ||\n"
	       "        !(up ? from > $n_within[region][i][0] : from < $n_within[region][i][1]))\n"
	       "        return 2.0;\n"
	       "    g[0] = sign * (from - b);\n"
	       "    for (k = 1; k < %d; k++) {\n"
	       "        g[k] = sign * $n_expression(i, c[k]);\n"
	       "        noise += pl_magnitude(g[k]);\n"
	       "    }\n",
	    size, terms, size, terms, terms);
	say(e, "    for (k = 0; k < %d; k++) {\n"
	       "        slack += $n_slack[which][i][k] * pl_magnitude(x[k]);\n"
	       "        noise += pl_magnitude($n_row[i][k] * x[k]);\n"
	       "    }\n"
	       "    noise *= 1.7763568394002505e-15;  /* 8 DBL_EPSILON, as in the search */\n"
	       "    return g[0] < -noise && sign * (to - b) > noise && g[1] > 0.0 ? $n_root(g, slack) : 2.0;\n"
	       "}\n", size);
}

/* Behind a crossing */
static void emit_moves_on(const struct emitter *e, const struct pieces *p)
{
	int size = e->step->layout.size, terms = p->degree + 1, n = expressions_of(e);
	say(e, "\n"
	       "/* Whether it is certain that nothing is passed from x on over h times `rest`: not what was "
	       "passed just now, since\n"
	       " * (e - b)/s stays beside 0, and nothing else.  c: the coefficients of x(s) */\n"
	       "static int $n_moves_on(int region, int which, int passed, int up, const double x[%d], double "
	       "c[%d][%d],\n"
	       "                       double rest, const double end[%d])\n"
	       "{\n"
	       "    double g[%d], off[%d], slack = 0.0, even = 0.0, odd = 0.0, more;\n"
	       "    int i, k;\n"
	       "    for (k = 1; k < %d; k++)\n"
	       "        g[k] = $n_expression(passed, c[k]);\n"
	       "    for (k = 0; k < %d; k++)\n"
	       "        slack += $n_slack[which][passed][k] * pl_magnitude(x[k]);\n",
	    size, terms, size, size, terms, n, terms, size);
	emit_sizes(e, terms, "more", "rest", false);
	say(e, "    if (!((up ? g[1] : -g[1]) > rest * more + slack))\n"
	       "        return 0;\n"
	       "    $n_bounds(which, x, off);\n"
	       "    for (i = 0; i < %d; i++) {\n"
	       "        const double from = $n_expression(i, x), to = $n_expression(i, end), sag = off[i] * "
	       "(rest * rest);\n"
	       "        if (i == passed ? !(up ? (from > to ? from : to) + sag < $n_within[region][i][1]\n"
	       "                               : (from < to ? from : to) - sag > $n_within[region][i][0])\n"
	       "                        : !$n_stays(region, i, from, to, sag))\n"
	       "            return 0;\n"
	       "    }\n"
	       "    return %s < %s;\n"
	       "}\n",
	    n, size_of_x(e, p, places(e, "pl_magnitude(end[%d])"), 12), shortest(p->large));
}

static void emit_cross(const struct emitter *e, const struct pieces *p)
{
	int size = e->step->layout.size, terms = p->degree + 1;
	say(e, "\n"
	       "/* s over h from x where it is certain that nothing is passed, or one breakpoint once: 1.  Else 0, and "
	       "nothing has\n"
	       " * changed. */\n"
	       "static PL_APART int $n_cross($n *s, const double x[%d])\n"
	       "{\n"
	       "    const int region = s->contact.region, which = s->contact.matrix;\n"
	       "    double c[%d][%d], y[%d], end[%d], z, to;\n"
	       "    int i, passed = 0, up, next, near;\n"
	       "    if (!(%s < %s))\n"
	       "        return 0;\n"
	       "    $n_advance(which, x, end);\n"
	       "    near = $n_near(region, which, x, end, &passed);\n"
	       "    if (near > 1)\n"
	       "        return 0;\n",
	    size, terms, size, size, size, size_of_x(e, p, places(e, "pl_magnitude(x[%d])"), 10),
	    shortest(p->large));
	say(e, "    if (near) {\n"
	       "        to = $n_expression(passed, end);\n"
	       "        up = to > $n_within[region][passed][1];\n"
	       "        $n_expand(which, x, c);\n"
	       "        z = $n_leaves(region, which, passed, up, x, c, to);\n"
	       "        if (z > 1.0)\n"
	       "            return 0;\n"
	       "        $n_sum_up(c, z, y);\n"
	       "        next = $n_beyond[region][passed][up];\n"
	       "        $n_expand($n_matrix[next], y, c);\n"
	       "        $n_sum_up(c, 1.0 - z, end);\n"
	       "        if (!$n_moves_on(next, $n_matrix[next], passed, up, y, c, 1.0 - z, end))\n"
	       "            return 0;\n");
	say(e, "        s->crossing[0].time = z * $N_H;\n"
	       "        s->crossing[0].expression = passed;\n"
	       "        s->crossing[0].breakpoint = next / $n_stride[passed] %% ($n_breaks[passed] + 1) - up;\n"
	       "        s->crossing[0].upward = up;\n"
	       "        s->contact.total++;\n"
	       "        s->contact.region = next;\n"
	       "        s->contact.matrix = $n_matrix[next];\n"
	       "    }\n"
	       "    s->contact.crossings = near;\n"
	       "    for (i = 0; i < $N_STATES; i++)\n"
	       "        s->y[i] = end[i];\n"
	       "    return 1;\n"
	       "}\n");
}

void emit_crossing(const struct emitter *e)
{
	struct pieces pieces = pieces_of(e->step);
	emit_expression(e, &pieces);
	emit_expand(e, &pieces);
	emit_polynomial(e, &pieces, "sum_up", e->step->layout.size);
	emit_root(e, &pieces);
	emit_bounds(e, &pieces);
	emit_whole(e, &pieces);
	emit_near(e, &pieces);
	emit_leaves(e, &pieces);
	emit_moves_on(e, &pieces);
	emit_cross(e, &pieces);
}
