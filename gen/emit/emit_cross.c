/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Regions: the few crossings of a step, one after the other, each by the Taylor polynomials of the entries of x and
 * with bounds which say that it is there and that nothing comes before it. All else is left to the runtime's search.
 *
 * Times are in parts of h, and so are derivatives. An expression e that is off a breakpoint b by g = sign (e - b), less
 * than 0 at the start, meets it at z first where g(z) = 0 and g(z - s)/s stays below 0. That quotient is -g'(z) at s =
 * 0 and g(0)/z at s = z, and off the chord between them by at most z^2/24 max|g'''|, since its second derivative is at
 * most a third of that. Behind the crossing (e - b)/s keeps its sign likewise. Where e comes back to b, the same holds
 * of (e - b)/s in the place of e - b, whose third derivative is at most a quarter of the fourth of e. */
#include "emit/emit.h"

#include <string.h>

static double *turn_of(const struct region_piece *piece)  { return piece->turn; }
static double *turns_of(const struct region_piece *piece) { return piece->turns; }

/* ---- what depends on no table: one for all parts ---- */

static void emit_remarks(const struct emitter *e)
{
	say(e, "\n"
	       "/* What is passed in a step, where that is certain, and little.  Times are in parts of h.\n"
	       " *   sizes, most      sums with |x|; most: of a bound, where what is never above 1 stands once\n"
	       " *   bounds           how far each expression is off its chord over h or less, at most\n"
	       " *   noise            what rounding may do to expression i beside b; 8 DBL_EPSILON as in the search\n"
	       " *   slope            h e' of expression i\n"
	       " *   advance          e^{A h} x\n"
	       " *   turn_once, move  h A x; gain = e^{A h s} x - x, by its Taylor polynomial\n"
	       " *   keeps            whether expression i certainly keeps off the ends of its interval over h times\n"
	       " *                    `rest`, from x to end: by its chord, then by its cubic, which is within its\n"
	       " *                    Bezier points.  behind: the end it comes from, or -1; it keeps off that one, b,\n"
	       " *                    where (e - b)/s does not come to 0\n");
	say(e, " *   meets            whether it surely meets the lower or the upper end at y, after h times z, and\n"
	       " *                    none before; and passes it by more than rounding before h times `rest`\n"
	       " *   guess            about where it is b, from x to end over h times `rest`; back: it comes from b\n"
	       " *   reach            moves x on to y, where it is b, near h times z; returns z.  From what is gained\n"
	       " *                    since x: of e - b itself more is lost\n"
	       " *   next             the first crossing: 1, and moves on to it; 0: there is none in this length; -1:\n"
	       " *                    that is not certain, and may be so of less; -2: nor of less\n"
	       " *   cross            s over h: 1.  Else 0, and nothing has changed. */\n");
}

static void emit_stretch(const struct emitter *e)
{
	say(e, "typedef struct $n_stretch {  /* of a step, in one region */\n"
	       "    double done, rest, length;   /* before it, to the end of the step; looked at */\n"
	       "    int region, which;\n"
	       "    int passed, behind;          /* expression that comes from an end of its interval; which end */\n"
	       "} $n_stretch;\n"
	       "\n"
	       "static void $n_next_stretch($n_stretch *p, double gone, int region, int which, int passed,\n"
	       "                            int behind)\n"
	       "{\n"
	       "    p->done += gone;\n"
	       "    p->length = 1.0 - p->done;\n"
	       "    p->rest = p->length;\n"
	       "    p->region = region;\n"
	       "    p->which = which;\n"
	       "    p->passed = passed;\n"
	       "    p->behind = behind;\n"
	       "}\n");
	say(e, "\n"
	       "static void $n_accept(pl_contact *contact, pl_crossing *into, const $n_stretch *last,\n"
	       "                      const pl_crossing *crossing, int count)\n"
	       "{\n"
	       "    int i;\n"
	       "    for (i = 0; i < count; i++)\n"
	       "        into[i] = crossing[i];\n"
	       "    contact->crossings = count;\n"
	       "    contact->total += (uint64_t)count;\n"
	       "    contact->region = last->region;\n"
	       "    contact->matrix = last->which;\n"
	       "}\n"
	       "\n"
	       "/* Whether what goes from `from` to `to`, by at most `off` aside, is between low and high */\n"
	       "static int $n_between(double low, double high, double from, double to, double off)\n"
	       "{\n"
	       "    return (from < to ? from : to) - off > low && (from < to ? to : from) + off < high;\n"
	       "}\n");
}

static void emit_passes(const struct emitter *e)
{
	say(e, "\n"
	       "/* Whether what comes to b at z, to `noise`, certainly was not there before, nor at the other end,\n"
	       " * far, of its interval; and is beyond b by more than noise before `rest`.  leaving, slope: its\n"
	       " * derivatives at 0 and z, up or down as it goes there; more: what its slope may be off those of the\n"
	       " * chord; off: at most off its own chord over h; behind: it comes from an end, back: from b */\n"
	       "static int $n_passes(double sign, double from, double b, double far, double leaving, double slope,\n"
	       "                     double noise, double more, double z, double rest, double off, int behind,\n"
	       "                     int back)\n"
	       "{\n"
	       "    if (!(z > 0.0 && z < rest))\n"
	       "        return 0;\n"
	       "    if (!((rest - z) * slope > 2.0 * noise && slope * slope > 16.0 * off * noise))\n"
	       "        return 0;\n");
	say(e, "    if (back != 0)\n"
	       "        return slope > noise + more && -leaving > noise + more &&\n"
	       "               sign * (b - far) - z * z * off > 0.0;\n"
	       "    if (!(slope > noise + more && sign * (b - from) > noise + z * more))\n"
	       "        return 0;\n"
	       "    if (behind != 0)\n"
	       "        return leaving > noise + more && sign * (b - far) > noise + z * more;\n"
	       "    return sign * (from - far) - z * z * off > 0.0;\n"
	       "}\n");
}

static void emit_zeros(const struct emitter *e)
{
	say(e, "\n"
	       "/* About where in 0 .. 1 the cubic with these values and slopes at its ends is 0, no more than a\n"
	       " * guess.  back: it is 0 at the start, and comes back */\n"
	       "static double $n_cubic_zero(double from, double to, double leaving, double arriving, int back)\n"
	       "{\n"
	       "    const double rise = to - from;\n"
	       "    double c0 = from, c1 = leaving, c2 = 3.0 * rise - 2.0 * leaving - arriving;\n"
	       "    double c3 = leaving + arriving - 2.0 * rise, low = 0.0, high = 1.0, t = -from / rise;\n"
	       "    int k;\n"
	       "    if (!back && leaving > 0.25 * rise && arriving > 0.25 * rise) {  /* that of the inverse */\n"
	       "        const double u = 1.0 - t;\n"
	       "        return t * (t * (3.0 - 2.0 * t) + u * (u * (rise / leaving) - t * (rise / arriving)));\n"
	       "    }\n"
	       "    if (back != 0) {\n"
	       "        c0 = c1;\n"
	       "        c1 = c2;\n"
	       "        c2 = c3;\n"
	       "        c3 = 0.0;\n"
	       "        t = 0.5;\n"
	       "    }\n");
	say(e, "    for (k = 0; k < 12; k++) {\n"
	       "        const double at = c0 + t * (c1 + t * (c2 + t * c3)), last = t;\n"
	       "        if (at > 0.0)\n"
	       "            high = t;\n"
	       "        else\n"
	       "            low = t;\n"
	       "        t -= at / (c1 + t * (2.0 * c2 + t * (3.0 * c3)));\n"
	       "        if (!(t > low && t < high))\n"
	       "            t = 0.5 * (low + high);\n"
	       "        if (pl_magnitude(t - last) < 1e-5)\n"
	       "            break;\n"
	       "    }\n"
	       "    return t;\n"
	       "}\n"
	       "\n"
	       "/* How far on it is to where an expression has gained so much, by the inverse series of the\n"
	       " * polynomial of these derivatives */\n"
	       "static double $n_inverse(double gain, double slope, double bend, double turn)\n"
	       "{\n"
	       "    const double w = 1.0 / slope, second = 0.5 * w * bend, third = 0.16666666666666666 * w * turn;\n"
	       "    const double z = w * gain;\n"
	       "    return z * (1.0 - z * (second - z * (2.0 * second * second - third)));\n"
	       "}\n");
}

void emit_crossing_scalars(const struct emitter *e)
{
	emit_remarks(e);
	emit_stretch(e);
	emit_passes(e);
	emit_zeros(e);
}

/* ---- expressions, bounds ---- */

static void emit_expression(const struct emitter *e, const struct pieces *p)
{
	int size = e->step->layout.size, n = expressions_of(e);
	say(e, "\n"
	       "static double $o_expression(int i, const double x[%d])\n"
	       "{\n", size);
	if (n == 1) {
		say(e, "    (void)i;\n"
		       "    return %s;\n", expression_text(e, p, 0, places(e, "x[%d]"), 11));
	} else {
		struct region_tables rows = { spell(e, "$o_row"), n, size, 0, 0, NULL, NULL };
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

/* `what` of the entries of x that `row` reads, summed */
static void emit_product(const struct emitter *e, const char *name, const char *const *what, const bool *reads)
{
	int size = e->step->layout.size, terms = 0;
	const char **term = ARRAY(const char *, (size_t)size);
	bool any = false;
	for (int j = 0; j < size; j++)
		if (reads[j]) {
			term[terms++] = *what[j] ? format("row[%d] * %s", j, what[j]) : format("row[%d]", j);
			any = any || *what[j];
		}
	say(e, "static double $o_%s(const double row[%d], const double x[%d])\n"
	       "{\n"
	       "%s%s"
	       "    return %s;\n"
	       "}\n", name, size, size, terms ? "" : "    (void)row;\n", any ? "" : "    (void)x;\n",
	    terms ? tree(terms, term, 11) : "0.0");
}

/* Of tables of slopes; of bounds, in which what is never above 1 stands at the first of that; of other bounds */
static void emit_products(const struct emitter *e, const struct pieces *p)
{
	int size = e->step->layout.size;
	struct region_tables slopes = tables_of_regions(e, p, "", expressions_of(e), turn_of);
	bool *reads = ARRAY(bool, (size_t)size), *all = ARRAY(bool, (size_t)size), bounded = false;
	const char **most = places(e, "pl_magnitude(x[%d])");
	for (int j = 0; j < size; j++) {
		all[j] = true;
		for (int i = 0; i < slopes.rows; i++)
			reads[j] = reads[j] || acts_at(&slopes, i, j);
	}
	say(e, "\n");
	emit_product(e, "along", places(e, "x[%d]"), reads);
	say(e, "\n");
	emit_product(e, "sizes", most, all);
	for (int j = 0; j < size; j++) {
		all[j] = !p->bounded[j] || !bounded;
		bounded = bounded || p->bounded[j];
		if (p->bounded[j])
			most[j] = "";
	}
	say(e, "\n");
	emit_product(e, "most", most, all);
}

/* off[i], from x */
static void emit_bounds(const struct emitter *e, const struct pieces *p)
{
	int n = expressions_of(e), size = e->step->layout.size;
	const char **magnitude = entries(e, "pl_magnitude(x[%d])");
	say(e, "\n"
	       "static void $o_bounds(int which, const double x[%d], double off[%d])\n"
	       "{\n", size, n);
	for (int i = 0; i < n; i++)
		say(e, "    off[%d] = %s;\n", i,
		    any_pieces(e) ? off_text(e, p, -1, i, magnitude, 13)
				  : spell(e, "$o_sizes($o_sag[which][%d], x)", i));
	say(e, "%s"
	       "}\n"
	       "\n"
	       "static double $o_noise(int which, int i, double b, const double x[%d])\n"
	       "{\n"
	       "    return $o_most($o_slack[which][i], x) + 1.7763568394002505e-15 * pl_magnitude(b);\n"
	       "}\n"
	       "\n"
	       "static double $o_slope(int which, int i, const double x[%d])\n"
	       "{\n"
	       "    return 3.0 * $o_along($o_%slean[which][i], x);\n"
	       "}\n", any_pieces(e) ? "    (void)which;\n    (void)x;\n" : "", size, size,
	    any_pieces(e) ? "whole_" : "");
}

/* ---- x(s) ---- */

/* Into end[]: Phi x over h */
static void emit_whole(const struct emitter *e, const struct pieces *p)
{
	int size = e->step->layout.size;
	struct region_tables whole = steps_of_regions(e, p, "factor");
	const char **x = entries(e, "x[%d]");
	say(e, "\n"
	       "static void $o_advance(int which, const double x[%d], double end[%d])\n"
	       "{\n"
	       "    const double (*const factor)[%d] = $o_pieces[which];\n",
	    size, size, size);
	for (int i = 0; i < size; i++)
		if (keeps_rest(e))
			say(e, "    end[%d] = x[%d] + (%s);\n", i, i, row_text(&whole, i, x, NULL, 21));
		else
			say(e, "    end[%d] = %s;\n", i, row_text(&whole, i, x, NULL, 13));
	say(e, is_table(&whole) && !keeps_rest(e) ? "}\n" : "    (void)factor;\n}\n");
}

static bool moves(const struct region_tables *t, int row)
{
	bool any = false;
	for (int j = 0; j < t->columns; j++)
		any = any || acts_at(t, row, j);
	return any;
}

/* Entries of h A that differ from matrix to matrix: locals, and their text */
static void emit_turns(const struct emitter *e, const struct region_tables *t)
{
	bool any = false;
	for (int i = 0; i < t->rows; i++)
		for (int j = 0; j < t->columns; j++)
			if (acts_at(t, i, j) && !agree_at(t, i, j)) {
				say(e, "    const double h%d_%d = $N_H * $o_slopes[which][%d][%d];\n", i, j, i, j);
				any = true;
			}
	if (!any)
		say(e, "    (void)which;\n");
}

static const char *turn_times(const struct region_tables *t, int i, int j, const char *operand)
{
	return agree_at(t, i, j) ? scaled(t->value[0][i * t->columns + j], operand)
				 : format("h%d_%d * %s", i, j, operand);
}

/* Velocities are added last: positions and loads are there before them, so that a chain has one product and one sum an
 * order.  From the second derivative on what is constant is 0. */
static const char *turned_row(const struct emitter *e, const struct region_tables *t, int row, const char *layout,
			      bool first)
{
	const char **early = ARRAY(const char *, (size_t)t->columns), **late = ARRAY(const char *, (size_t)t->columns);
	int earlies = 0, lates = 0;
	for (int j = 0; j < t->columns; j++) {
		if (!acts_at(t, row, j) || !(first || moves(t, j)))
			continue;
		const char *text = turn_times(t, row, j, format(layout, j));
		if (j >= e->system->n && j < e->system->states)
			late[lates++] = text;
		else
			early[earlies++] = text;
	}
	if (earlies && lates)
		return format("(%s)\n%26s+ (%s)", tree(earlies, early, 26), "", tree(lates, late, 28));
	return earlies ? tree(earlies, early, 25) : lates ? tree(lates, late, 25) : "0.0";
}

static void emit_turn(const struct emitter *e, const struct region_tables *t)
{
	int size = e->step->layout.size;
	say(e, "\n"
	       "static void $o_turn_once(int which, const double x[%d], double d[%d])\n"
	       "{\n", size, size);
	emit_turns(e, t);
	for (int i = 0; i < size; i++)
		say(e, "    d[%d] = %s;\n", i, turned_row(e, t, i, "x[%d]", true));
	say(e, "}\n");
}

static void emit_weights(const struct emitter *e, const struct pieces *p)
{
	say(e, "\n"
	       "static const double $d_weight[%d] = {  /* 1/k! */\n"
	       "    1.0", p->degree + 1);
	for (int k = 1; k <= p->degree; k++)
		say(e, "%s%s", k % 4 ? ", " : ",\n    ", shortest(p->weight[k]));
	say(e, "\n"
	       "};\n");
}

/* What is added to x, so that little of it is lost beside x */
static void emit_move(const struct emitter *e, const struct pieces *p, const struct region_tables *t)
{
	int size = e->step->layout.size;
	say(e, "\n"
	       "static void $o_move(int which, const double x[%d], double s, double gain[%d])\n"
	       "{\n"
	       "    double power = s;\n"
	       "    int k;\n", size, size);
	emit_turns(e, t);
	for (int i = 0; i < size; i++)
		if (moves(t, i))
			say(e, "    double a%d = %s, sum%d = s * a%d;\n", i, turned_row(e, t, i, "x[%d]", true), i, i);
	say(e, "    for (k = 2; k <= %d; k++) {\n", p->degree);
	for (int i = 0; i < size; i++)
		if (moves(t, i))
			say(e, "        const double b%d = %s;\n", i, turned_row(e, t, i, "a%d", false));
	say(e, "        double weight;\n"
	       "        power *= s;\n"
	       "        weight = power * $d_weight[k];\n");
	for (int i = 0; i < size; i++)
		if (moves(t, i))
			say(e, "        a%d = b%d;\n"
			       "        sum%d += weight * b%d;\n", i, i, i, i);
	say(e, "    }\n");
	for (int i = 0; i < size; i++)
		say(e, moves(t, i) ? "    gain[%d] = sum%d;\n" : "    gain[%d] = 0.0;\n", i, i);
	say(e, "}\n");
}

/* ---- what is certain ---- */

static void emit_keeps(const struct emitter *e)
{
	int size = e->step->layout.size;
	const char *whole = any_pieces(e) ? "whole_" : "";
	say(e, "\n"
	       "static int $o_keeps(int region, int which, int i, int behind, const double x[%d],\n"
	       "                    const double end[%d], double rest, double off)\n"
	       "{\n"
	       "    const double from = $o_expression(i, x), to = $o_expression(i, end), two = rest * rest;\n"
	       "    double low = $o_within[region][i][0], high = $o_within[region][i][1], sway;\n",
	    size, size);
	say(e, "    if (behind >= 0) {\n"
	       "        const double sign = behind ? -1.0 : 1.0, b = behind ? high : low;\n"
	       "        const double noise = $o_noise(which, i, b, x), jerk = two * $o_most($o_jerk[which][i], x);\n"
	       "        if (!(sign * $o_slope(which, i, x) > noise + jerk && sign * (to - b) > noise + rest * jerk))\n"
	       "            return 0;\n"
	       "        if (behind != 0)\n"
	       "            high = %s;\n"
	       "        else\n"
	       "            low = -%s;\n"
	       "    }\n", shortest(OPEN_END), shortest(OPEN_END));
	say(e, "    if ($n_between(low, high, from, to, two * off))\n"
	       "        return 1;\n"
	       "    sway = two * two * $o_sizes($o_%ssway[which][i], x);\n"
	       "    return $n_between(low, high, from, to, sway) &&\n"
	       "           $n_between(low, high, from + rest * $o_along($o_%slean[which][i], x),\n"
	       "                      to - rest * $o_along($o_%slean[which][i], end), sway);\n"
	       "}\n", whole, whole, whole);
}

static void emit_first(const struct emitter *e)
{
	int size = e->step->layout.size;
	say(e, "\n"
	       "static int $o_meets(int region, int which, int i, int up, int behind, const double x[%d],\n"
	       "                    const double y[%d], double z, double rest, double off)\n"
	       "{\n"
	       "    const double sign = up ? 1.0 : -1.0, b = $o_within[region][i][up];\n"
	       "    const double noise = $o_noise(which, i, b, x), zz = z * z;\n"
	       "    const double more = behind == up ? 4.0 * z * zz * $o_sizes($o_%ssway[which][i], x)\n"
	       "                                     : zz * $o_most($o_jerk[which][i], x);\n"
	       "    return pl_magnitude($o_expression(i, y) - b) <= noise &&\n"
	       "           $n_passes(sign, $o_expression(i, x), b, $o_within[region][i][!up],\n"
	       "                     sign * $o_slope(which, i, x), sign * $o_slope(which, i, y), noise, more, z,\n"
	       "                     rest, off, behind >= 0, behind == up);\n"
	       "}\n", size, size, any_pieces(e) ? "whole_" : "");
}

/* ---- where it is ---- */

static void emit_guess(const struct emitter *e)
{
	int size = e->step->layout.size;
	say(e, "\n"
	       "static double $o_guess(int which, int i, double sign, double b, int back, const double x[%d],\n"
	       "                       const double end[%d], double rest)\n"
	       "{\n"
	       "    return rest * $n_cubic_zero(sign * ($o_expression(i, x) - b), sign * ($o_expression(i, end) - b),\n"
	       "                                sign * rest * $o_slope(which, i, x),\n"
	       "                                sign * rest * $o_slope(which, i, end), back);\n"
	       "}\n", size, size);
}

static void emit_reach(const struct emitter *e)
{
	int size = e->step->layout.size;
	say(e, "\n"
	       "static double $o_reach(int which, int i, double b, const double x[%d], double z, double y[%d])\n"
	       "{\n"
	       "    double d[3][%d], gain[%d];\n"
	       "    const double far = b - $o_expression(i, x);\n"
	       "    int j, k;\n"
	       "    $o_move(which, x, z, gain);\n"
	       "    for (k = 0; k < 4; k++) {\n"
	       "        double step;\n"
	       "        for (j = 0; j < %d; j++)\n"
	       "            y[j] = x[j] + gain[j];\n"
	       "        $o_turn_once(which, y, d[0]);\n"
	       "        $o_turn_once(which, d[0], d[1]);\n"
	       "        $o_turn_once(which, d[1], d[2]);\n"
	       "        step = $n_inverse(far - $o_expression(i, gain), $o_expression(i, d[0]),\n"
	       "                          $o_expression(i, d[1]), $o_expression(i, d[2]));\n"
	       "        z += step;\n", size, size, size, size, size);
	say(e, "        if (pl_magnitude(step) < 1e-4) {\n"
	       "            for (j = 0; j < %d; j++)\n"
	       "                y[j] = x[j] + (gain[j] + step * (d[0][j] + step * (0.5 * d[1][j] + step *\n"
	       "                               (0.16666666666666666 * d[2][j]))));\n"
	       "            return z;\n"
	       "        }\n"
	       "        if (!(pl_magnitude(step) < 1.0))\n"
	       "            break;\n"
	       "        $o_move(which, y, step, d[0]);\n"
	       "        for (j = 0; j < %d; j++)\n"
	       "            gain[j] += d[0][j];\n"
	       "    }\n"
	       "    return 2.0;\n"
	       "}\n", size, size);
}

/* ---- crossing after crossing ---- */

/* x on over a part of the step, of h 1: to `end`, or by the same polynomial in two words */
static void emit_moved(const struct emitter *e, const char *indent, const char *which, const char *part,
		       const char *end)
{
	if (keeps_rest(e))
		say(e, "%spl_switching_kept_move(&$o_switching, %s, %d, %s * $N_H, x, work);\n", indent, which,
		    e->step->swift_degree, part);
	else
		say(e, "%sfor (i = 0; i < %d; i++)\n"
		       "%s    x[i] = %s[i];\n", indent, e->step->layout.size, indent, end);
}

/* Room for that */
static const char *room_to_move(const struct emitter *e)
{
	return !keeps_rest(e) ? "" : format("    double work[PL_SWITCHING_KEPT_WORK(%d, %d, %d)];\n",
					    e->step->layout.size, expressions_of(e), e->step->swift_degree);
}

/* Which expressions may be passed: near, unclear[] */
static void emit_candidates(const struct emitter *e)
{
	int n = expressions_of(e);
	say(e, "    for (i = 0; i < %d; i++) {\n"
	       "        const double *const within = $o_within[p->region][i];\n"
	       "        const double from = $o_expression(i, x), to = $o_expression(i, end);\n"
	       "        const int above = to > within[1];\n"
	       "        double about;\n"
	       "        behind = i == p->passed ? p->behind : -1;\n"
	       "        if (behind < 0 && !(from > within[0] && from < within[1]))\n"
	       "            return -2;\n"
	       "        if (!above && !(to < within[0])) {\n"
	       "            if (!$o_keeps(p->region, p->which, i, behind, x, end, p->length, off[i]))\n"
	       "                return -1;\n"
	       "            continue;\n"
	       "        }\n"
	       "        about = $o_guess(p->which, i, above ? 1.0 : -1.0, within[above], behind == above, x,\n"
	       "                         end, p->length);\n", n);
	say(e, n > 1 ? "        unclear[near++] = i;\n" : "        near++;\n");
	say(e, "        if (about < z) {\n"
	       "            z = about;\n"
	       "            first = i;\n"
	       "            up = above;\n"
	       "        }\n"
	       "    }\n"
	       "    if (near == 0)\n"
	       "        return 0;\n");
}

static void emit_next(const struct emitter *e)
{
	int size = e->step->layout.size, n = expressions_of(e);
	say(e, "\n"
	       "static int $o_first($n_stretch *p, double x[%d], const double end[%d], pl_crossing *crossing)\n"
	       "{\n"
	       "    double off[%d], y[%d], z = 2.0;\n"
	       "%s"
	       "    int i, %snear = 0, first = 0, up = 0, behind, next;\n"
	       "    $o_bounds(p->which, x, off);\n", size_of_vector(e), size, n, size, room_to_move(e),
	    n > 1 ? format("unclear[%d], ", n) : "");
	emit_candidates(e);
	say(e, "    next = $o_beyond[p->region][first][up];\n"
	       "    behind = first == p->passed ? p->behind : -1;\n"
	       "    if (next < 0)\n"
	       "        return -2;\n"
	       "    z = $o_reach(p->which, first, $o_within[p->region][first][up], x, z, y);\n"
	       "    if (!$o_meets(p->region, p->which, first, up, behind, x, y, z, p->length, off[first]))\n"
	       "        return -1;\n");
	if (n > 1)
		say(e, "    for (i = 0; i < near; i++) {  /* others that are passed, but later */\n"
		       "        const int other = unclear[i];\n"
		       "        behind = other == p->passed ? p->behind : -1;\n"
		       "        if (other != first && !$o_keeps(p->region, p->which, other, behind, x, y, z, "
		       "off[other]))\n"
		       "            return -1;\n"
		       "    }\n");
	emit_moved(e, "    ", "p->which", "z", "y");
	say(e, "    $n_next_stretch(p, z, next, $o_matrix[next], first, !up);\n"
	       "    crossing->time = p->done * $N_H;\n"
	       "    crossing->expression = first;\n"
	       "    crossing->breakpoint = $o_span[next][first] - up;\n"
	       "    crossing->upward = up;\n"
	       "    return 1;\n"
	       "}\n");
}

/* The state behind what has been found, and that */
static void emit_crossed(const struct emitter *e)
{
	if (keeps_rest(e)) {
		emit_moved(e, "    ", "part.which", "part.length", "end");
		emit_state_of_x(e);
	} else {
		say(e, "    $n_accept(&s->contact$p, s->crossing$p, &part, crossing, count);\n"
		       "    for (i = 0; i < %s; i++)\n"
		       "        s->y[%s] = end[i];\n"
		       "    return 1;\n"
		       "}\n", own_states(e), place_in_loop(e));
		return;
	}
	say(e, "    $n_accept(&s->contact$p, s->crossing$p, &part, crossing, count);\n"
	       "    return 1;\n"
	       "}\n");
}

/* Part by part; a part that is not certain is halved. */
static void emit_cross(const struct emitter *e, const struct pieces *p)
{
	int size = e->step->layout.size, all = size_of_vector(e);
	say(e, "\n"
	       "static PL_APART int $o_cross($n *s, const double now[%d])\n"
	       "{\n"
	       "    pl_crossing crossing[%d];\n"
	       "    $n_stretch part = {0.0, 1.0, 1.0, 0, 0, -1, -1};\n"
	       "    double x[%d], end[%d];\n"
	       "%s"
	       "    int i, look, count = 0;\n"
	       "    for (i = 0; i < %d; i++)\n"
	       "        x[i] = now[i];\n"
	       "    part.region = s->contact$p.region;\n"
	       "    part.which = s->contact$p.matrix;\n"
	       "    if (!(%s < %s))\n"
	       "        return 0;\n"
	       "    $o_advance(part.which, x, end);\n"
	       "    for (look = 0; look < %d; look++) {\n", all, MOST_SWIFT, all, size, room_to_move(e), all,
	    size_of_x(e, p, places(e, "pl_magnitude(x[%d])"), 10), shortest(p->large), MOST_LOOKS);
	say(e, "        int found = -2;\n"
	       "        if (%s < %s &&\n"
	       "            count < %d)\n"
	       "            found = $o_first(&part, x, end, &crossing[count]);\n"
	       "        if (found == -2)\n"
	       "            return 0;\n"
	       "        if (found == 0 && part.length == part.rest)\n"
	       "            break;\n",
	    size_of_x(e, p, places(e, "pl_magnitude(end[%d])"), 12), shortest(p->large), MOST_SWIFT);
	say(e, "        if (found == -1)\n"
	       "            part.length *= 0.5;\n"
	       "        else if (found == 1)\n"
	       "            count++;\n"
	       "        else {\n");
	emit_moved(e, "            ", "part.which", "part.length", "end");
	say(e, "            $n_next_stretch(&part, part.length, part.region, part.which, -1, -1);\n"
	       "        }\n"
	       "        $o_move(part.which, x, part.length, end);\n"
	       "        for (i = 0; i < %d; i++)\n"
	       "            end[i] += x[i];\n"
	       "    }\n"
	       "    if (look == %d)\n"
	       "        return 0;\n", size, MOST_LOOKS);
	emit_crossed(e);
}

void emit_crossing(const struct emitter *e)
{
	struct pieces pieces = pieces_of(e->step);
	struct region_tables turns = tables_of_regions(e, &pieces, "", e->step->layout.size, turns_of);
	emit_expression(e, &pieces);
	emit_products(e, &pieces);
	emit_bounds(e, &pieces);
	emit_whole(e, &pieces);
	emit_turn(e, &turns);
	if (strcmp(e->degree, e->own) == 0)     /* else they are there already */
		emit_weights(e, &pieces);
	emit_move(e, &pieces, &turns);
	emit_keeps(e);
	emit_first(e);
	emit_guess(e);
	emit_reach(e);
	emit_next(e);
	emit_cross(e, &pieces);
}
