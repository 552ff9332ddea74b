/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps by collocation, as long as a tolerance lets them be, with outputs from their polynomials; beside them, where
 * the scheme switches, steps by the Taylor series. */
#include "emit/emit.h"

#include <float.h>
#include <math.h>

enum {
	MOST_LENGTH = 65536,        /* of an internal step, in h */
	ITERATIONS = 9              /* of Newton's method */
};

static int stages(const struct emitter *e)
{
	return e->step->collocation->stages;
}

static bool changes(const struct emitter *e)
{
	return e->system->segments > 1;
}

static bool switches(const struct emitter *e)
{
	return e->step->expansion != NULL;
}

static double tolerance(const struct emitter *e)
{
	return round_rational(e->model->truncation.tolerance);
}

/* Rows of the polynomial; row 0 would be the state where the internal step starts */
static int rows(const struct emitter *e)
{
	return (switches(e) && e->model->truncation.order > stages(e) ? e->model->truncation.order : stages(e)) + 1;
}

static const char *nodes_argument(const struct emitter *e)
{
	int known = known_values(e);
	return known ? format("(const double (*)[%d])node, ", known) : "";
}

/* Where it is taken where the step starts, and not at each node */
static const char *jacobian_parameter(const struct emitter *e)
{
	int entries = e->step->motion->entries;
	return splits(e) ? format("const double slope_of[%d], ", entries ? entries : 1) : "";
}

static const char *samples_of_step(const struct emitter *e)
{
	return e->system->inputs ? ", u, slope" : "";
}

/* ---- members ---- */

void emit_collocation_members(const struct emitter *e)
{
	say(e, "    double start[$N_STATES], poly[%d][$c];  /* of an internal step; its polynomial, from "
	       "time^1 on in "
	       "row 1 */\n"
	       "    double gain[$N_STATES];  /* over all of it */\n"
	       "    double at, at_low;  /* where it starts, in h since the step k - back */\n"
	       "    double size, per;     /* its length in h; 1 over the unit of the polynomial */\n"
	       "    double want;          /* the length that the next may have */\n"
	       "    double scale[$c], unit[$c];  /* the largest size of each state so far; 1 over it */\n"
	       "    int back;             /* steps of h since then */\n"
	       "    int stop, ready;      /* it ends at 1: a step of h, 2: a change of the loads%s; it may be "
	       "extrapolated */\n",
	    rows(e), is_divided(e) ? ", 3: a crossing" : "");
	if (changes(e))
		say(e, "    int leg;              /* the segment of time that it is in */\n");
	if (switches(e))
		say(e, "    int series, stiff;    /* the polynomial is a series; the next one is of the collocation "
		       "*/\n"
		       "    double product;       /* of the length that the last series had and how fast the motion "
		       "may be there */\n"
		       "    int bounds, patience, run;  /* series in a row that stability bounds; how many may be; "
		       "steps of the "
		       "collocation */\n");
	if (is_divided(e))
		emit_divided_members(e);
}

bool collocation_places(const struct emitter *e)
{
	(void)e;
	return true;
}

static void emit_anew(const struct emitter *e)
{
	say(e, "\n/* An internal step starts at the state now. */\n"
	       "static void $n_anew($n *s)\n"
	       "{\n"
	       "    int i;\n"
	       "    for (i = 0; i < $N_STATES; i++)\n"
	       "        s->start[i] = s->y[i];\n"
	       "    s->at = s->at_low = s->size = 0.0;\n"
	       "    s->per = 1.0;\n"
	       "    s->back = s->stop = s->ready = 0;\n"
	       "%s}\n", changes(e) ? "    s->leg = s->segment;\n" : "");
}

void emit_collocation_place(const struct emitter *e)
{
	emit_state_table(e);
	emit_floors(e);
	emit_anew(e);
	emit_measure(e, "start");
	say(e, "\n/* What follows from a state that was set */\n"
	       "static void $n_place($n *s)\n"
	       "{\n"
	       "    int i;\n"
	       "    $n_anew(s);\n"
	       "    for (i = 0; i < $c; i++)\n"
	       "        s->scale[i] = s->unit[i] = 0.0;\n"
	       "    $n_measure(s);\n"
	       "    s->want = 0.0;\n");
	if (switches(e))
		say(e, "    s->product = 0.0;\n"
		       "    s->series = s->stiff = s->bounds = s->run = 0;\n"
		       "    s->patience = 2;\n");
	if (is_divided(e))
		emit_divided_place(e);
	say(e, "}\n");
}

/* ---- the polynomial ---- */

static void emit_within(const struct emitter *e)
{
	say(e, "\n/* What the polynomial of a collocation gains from its start, theta of the step later */\n");
	emit_polynomial(e, "within", stages(e) + 1, stages(e));
}

static void emit_inside(const struct emitter *e)
{
	say(e, "\n/* The state `ahead` h after the start of the internal step, which reaches so far */\n"
	       "static void $n_inside(const $n *s, double ahead, double y[$N_STATES])\n"
	       "{\n"
	       "    double gain[$N_STATES];\n"
	       "    int i;\n"
	       "    if (ahead == s->size) {\n"
	       "        for (i = 0; i < $N_STATES; i++)\n"
	       "            y[i] = s->start[i] + (s->gain[i] + s->rest[i]);\n"
	       "        return;\n"
	       "    }\n");
	if (switches(e))
		say(e, "    if (s->series)\n"
		       "        $n_ahead(s->poly, ahead, gain);\n"
		       "    else\n"
		       "    ");
	say(e, "    $n_within(s->poly, ahead * s->per, gain);\n"
	       "    for (i = 0; i < $N_STATES; i++)\n"
	       "        y[i] = s->start[i] + (gain[i] + s->rest[i]);\n"
	       "}\n");
}

/* ---- a step of the collocation ---- */

/* The derivative of the last polynomial, beyond its end: the velocity's, or of first order the coordinate's own */
static void emit_prediction(const struct emitter *e)
{
	int s = stages(e), n = e->system->n;
	say(e, "\n/* The highest derivatives of a polynomial, of which the unit of time is 1/per, at the nodes of a "
	       "step that is\n * so long and begins there */\n"
	       "static void $n_continue(const double poly[%d][$c], double from, double size, double per, double "
	       "k[%d])\n"
	       "{\n"
	       "    int i, j, m;\n"
	       "    for (i = 0; i < %d; i++) {\n"
	       "        const double theta = from + $n_node[i] * size;\n"
	       "        for (j = 0; j < %d; j++) {\n"
	       "            double sum = %s * poly[%d][%s];\n"
	       "            for (m = %d; m > 0; m--)\n"
	       "                sum = sum * theta + (double)m * poly[m][%s];\n"
	       "            k[i * %d + j] = sum * per;\n"
	       "        }\n"
	       "    }\n"
	       "}\n", s + 1, unknowns_of_stages(e), s, n, shortest(s), s, highest_text(e, "j"), s - 1,
	    highest_text(e, "j"), n);
}

/* Where nothing is known of a state's size yet, that at the nodes counts, or after h if it went on so. */
static void emit_sizes(const struct emitter *e)
{
	int n = e->system->n;
	say(e, "\n/* 1 over the size of each state; where that was 0 so far, of what the step makes of it */\n"
	       "static void $n_sizes(const $n *s, double dt, const double k[%d], double unit[$N_STATES])\n"
	       "{\n"
	       "    int i, j;\n"
	       "    dt = dt > $N_H ? dt : $N_H;\n"
	       "    for (i = 0; i < $N_STATES; i++) {\n"
	       "        double most = 0.0;\n"
	       "        unit[i] = s->unit[i];\n"
	       "        if (unit[i] != 0.0)\n"
	       "            continue;\n"
	       "        for (j = 0; j < %d; j++)\n"
	       "            if (pl_magnitude(k[j * %d + %s]) > most)\n"
	       "                most = pl_magnitude(k[j * %d + %s]);\n"
	       "        most *= %s;\n"
	       "        unit[i] = %s;\n"
	       "    }\n"
	       "}\n", unknowns_of_stages(e), stages(e), n, coord_text(e, "i"), n, coord_text(e, "i"),
	    moved_text(e, "i"), one_over(e, "most", "1.0"));
}

static void emit_solve(const struct emitter *e)
{
	int s = stages(e), known = known_values(e);
	const double bound = fmax(0.05 * tolerance(e), 4 * (e->model->asked.single ? FLT_EPSILON : DBL_EPSILON));
	say(e, "\n/* The highest derivatives k at the nodes of a step of `size` h, from those that are given: 1, or 0 "
	       "where\n * Newton's method does not find them */\n"
	       "static int $n_solve(const $n *s%s, %sdouble size, double unit[$N_STATES], double k[%d])\n"
	       "{\n"
	       "    const double dt = size * $N_H;\n"
	       "    double previous = 0.0;\n", samples_parameter(e), jacobian_parameter(e), unknowns_of_stages(e));
	if (splits(e))
		say(e, "    $n_factors factors;\n");
	if (known)
		say(e, "    double node[%d][%d];\n", s, known);
	say(e, "%s"
	       "    int i;\n"
	       "%s", current_intervals(e), unread_samples(e));
	if (known) {
		struct emitter here = *e;
		here.ramps = false;             /* samples are called u here */
		say(e, "    for (i = 0; i < %d; i++)\n"
		       "        %s\n", s,
		    known_call(&here, spell(e, "((s->at - (double)s->back) + $n_node[i] * size) * $N_H"),
			       spell(e, "((s->at - (double)s->back) + 0.5 * size) * $N_H"), "node[i]"));
	}
	if (splits(e))
		say(e, "    if (!$n_factorize(slope_of, dt, &factors))\n"
		       "        return 0;\n");
	say(e, "    for (i = 0; i < %d; i++) {\n"
	       "        double change;\n"
	       "        $n_sizes(s, dt, k, unit);\n"
	       "        change = $n_iterate(s->start, %s%sdt, unit, %sk);\n"
	       "        if (!(change < 1e10)%s)\n"
	       "            return 0;\n"
	       "        if (i > 0 && (change <= %s || (change < previous && change * change <= %s * (previous - "
	       "change))))\n"
	       "            return 1;\n"
	       "        if (change <= %s)\n"
	       "            return 1;\n"
	       "        previous = change;\n"
	       "    }\n"
	       "    return 0;\n"
	       "}\n", ITERATIONS, nodes_argument(e), interval_argument(e), splits(e) ? "&factors, " : "",
	    splits(e) ? " || (i > 0 && change >= previous)" : "", shortest(bound), shortest(bound),
	    shortest(e->model->asked.single ? 1e-12 : 1e-17));
}

/* The polynomial, and the size of its last term where that is largest, over 2^(2s-1): what a polynomial of one degree
 * less leaves out on 0 .. 1 (Chebyshev) */
static void emit_finish(const struct emitter *e)
{
	int s = stages(e), n = e->system->n;
	say(e, "\n/* The polynomial through the nodes; returns its last term as an error, relative to the sizes */\n"
	       "static double $n_finish(const double y[$N_STATES], double dt, const double unit[$N_STATES],\n"
	       "    const double k[%d], double poly[%d][$c], double gain[$N_STATES])\n"
	       "{\n"
	       "    double most = 0.0;\n"
	       "    int i, j, m;\n", unknowns_of_stages(e), s + 1);
	say(e, "    for (j = 0; j < %d; j++) {\n"
	       "        double v[%d], once = 0.0, twice = 0.0;\n"
	       "        const int state = %s, twofold = state != j;\n"
	       "        for (i = 0; i < %d; i++) {\n"
	       "            double sum = 0.0;\n"
	       "            for (m = 0; m < %d; m++)\n"
	       "                sum += $n_once[i][m] * k[m * %d + j];\n"
	       "            v[i] = y[state] + dt * sum;\n"
	       "            once = sum;\n"
	       "            twice += $n_twice[%d][i] * k[i * %d + j];\n"
	       "        }\n", n, s, highest_text(e, "j"), s, s, n, s - 1, n);
	say(e, "        gain[state] = dt * once;\n"
	       "        if (twofold)\n"
	       "            gain[j] = dt * (y[state] + dt * twice);\n"
	       "        for (i = 0; i < %d; i++) {\n"
	       "            double rate = 0.0, speed = 0.0;\n"
	       "            for (m = 0; m < %d; m++) {\n"
	       "                rate += $n_monomial[i][m] * k[m * %d + j];\n"
	       "                speed += $n_monomial[i][m] * v[m];\n"
	       "            }\n"
	       "            poly[i + 1][state] = rate * (dt / (double)(i + 1));\n"
	       "            if (twofold)\n"
	       "                poly[i + 1][j] = speed * (dt / (double)(i + 1));\n"
	       "        }\n"
	       "    }\n", s, s, n);
	say(e, "    for (i = 0; i < $N_STATES; i++) {\n"
	       "        const double last = pl_magnitude(poly[%d][i]) * unit[i];\n"
	       "        most = last > most || last != last ? last : most;\n"
	       "    }\n"
	       "    return $n_ends(y, gain) ? most * %s : 1e35;\n"
	       "}\n", s, shortest(ldexp(1, 1 - 2 * s)));
}

static void emit_ends(const struct emitter *e)
{
	say(e, "\n/* Whether an internal step ends at numbers */\n"
	       "static int $n_ends(const double y[$N_STATES], const double gain[$N_STATES])\n"
	       "{\n"
	       "    double end[$N_STATES];\n"
	       "    int i;\n"
	       "    for (i = 0; i < $N_STATES; i++)\n"
	       "        end[i] = y[i] + gain[i];\n"
	       "    return !pl_not_finite(end, $N_STATES);\n"
	       "}\n");
}

/* ---- the next internal step ---- */

/* The end of the last is where the next starts. */
static void emit_commit(const struct emitter *e)
{
	say(e, "\n/* The next internal step starts where the last ends. */\n"
	       "static void $n_commit($n *s)\n"
	       "{\n"
	       "    int i;\n"
	       "    if (s->size == 0.0)\n"
	       "        return;\n"
	       "    for (i = 0; i < $N_STATES; i++)\n"
	       "        s->start[i] = pl_accumulate(s->start[i], s->gain[i], 0.0, &s->rest[i]);\n"
	       "    if (s->stop == 1) {\n"
	       "        s->at = s->at_low = 0.0;\n"
	       "        s->back = 0;\n"
	       "    } else {\n"
	       "        const int whole = (int)(s->at = pl_accumulate(s->at, s->size, 0.0, &s->at_low));\n"
	       "        s->at -= (double)whole;\n"
	       "        s->back -= whole;\n"
	       "    }\n");
	if (changes(e))
		say(e, "    s->leg += s->stop == 2;\n");
	say(e, "    s->size = 0.0;\n"
	       "    $n_measure(s);\n"
	       "}\n");
}

static void emit_limit(const struct emitter *e)
{
	say(e, "\n/* How long the next internal step may be at most, in h; s->stop says what ends it there */\n"
	       "static double $n_limit($n *s)\n"
	       "{\n"
	       "    double limit = %d.0;\n"
	       "    s->stop = 0;\n", MOST_LENGTH);
	if (e->system->inputs)
		say(e, "    limit = ((double)(s->back + 1) - s->at) - s->at_low;  /* the samples to come are not "
		       "known */\n"
		       "    s->stop = 1;\n");
	if (changes(e))
		say(e, "    for (; s->leg < %d; s->leg++) {\n"
		       "        const double change = $n_until(s, s->leg) / $N_H - (s->at - (double)s->back);\n"
		       "        if (change > 1e-12) {\n"
		       "            if (change < limit) {\n"
		       "                limit = change;\n"
		       "                s->stop = 2;\n"
		       "            }\n"
		       "            break;\n"
		       "        }\n"
		       "    }\n", e->system->segments - 1);
	say(e, "    return limit;\n"
	       "}\n");
}

/* What hides between the nodes makes a step half as long. */
static const char *unshown(const struct emitter *e)
{
	return !traces(e) && !crowds(e) ? "" : spell(e, "            if (good && (%s)) {\n"
					      "                good = 0;\n"
					      "                factor = 0.5;\n"
					      "            }\n", shows_along(e));
}

static void emit_collocate(const struct emitter *e)
{
	int s = stages(e);
	const char *single = e->model->asked.single ? "1e-35" : "1e-290";
	say(e, "\n/* An internal step of the collocation, at most `limit` h long: 0, or what went wrong%s */\n"
	       "static int $n_collocate($n *s%s, double limit, %sint *steps)\n"
	       "{\n"
	       "    const int stop = s->stop;\n"
	       "    int rejected = 0, %si, j;\n"
	       "%s"
	       "    for (;;) {\n"
	       "        double k[%d], poly[%d][$c], unit[$N_STATES], error, factor = rejected < 3 ? 0.25 : "
	       "0.0625;\n"
	       "        const double size = s->want < limit ? s->want : limit;\n"
	       "        int good;\n"
	       "        if ((*steps)++ == %d)\n"
	       "            return PL_TOO_MANY_STEPS;\n"
	       "        if (!(size > %s))\n"
	       "            return PL_NOT_FINITE;\n",
	    switches(e) ? "; -1: a series should do it" : "", samples_parameter(e),
	    switches(e) ? "const double rates[2], "
			  "" : "", is_divided(e) ? "wrong, " : "", splits(e) ? start_jacobian(e) : "",
	    unknowns_of_stages(e), s + 1,
	    e->model->truncation.substeps, e->model->asked.single ? "1e-12" : "1e-18");
	say(e, "        for (i = 0; i < %d && !s->ready; i++)\n"
	       "            k[i] = 0.0;\n"
	       "        if (s->ready)\n"
	       "            $n_continue((const double (*)[$c])s->poly, 1.0, size * s->per, s->per / $N_H, k);\n",
	    unknowns_of_stages(e));
	say(e, "        good = $n_solve(s%s%s, size, unit, k);\n"
	       "        if (good) {\n"
	       "            error = $n_finish(s->start, size * $N_H, unit, k, poly, s->gain) + %s;\n"
	       "            good = error <= %s;\n"
	       "            if (error < 1e30)\n"
	       "                factor = 0.9 * pl_root(%s / error, %d);\n"
	       "            factor = factor > 5.0 ? 5.0 : factor > 0.15 ? factor : 0.15;\n"
	       "%s"
	       "        }\n"
	       "        if (!good) {\n"
	       "            s->want = size * (rejected++ < 3 || factor < 0.1 ? factor : 0.1);\n"
	       "%s"
	       "            continue;\n"
	       "        }\n", e->system->inputs ? ", u, slope" : "", splits(e) ? ", slope_of" : "", single,
	    shortest(2 * tolerance(e)), shortest(tolerance(e)), s + 1, unshown(e),
	    !switches(e) ? "" : spell(e, "            if ($n_product(rates, s->want) < 0.5)\n"
					 "                return -1;\n"));
	say(e, "        s->want = size < limit || s->want < size * factor ? size * factor : s->want;\n"
	       "        s->stop = size < limit ? 0 : stop;\n"
	       "        s->size = size;\n"
	       "        s->per = 1.0 / size;\n"
	       "        s->ready = 1;\n"
	       "%s", switches(e) ? "        s->series = 0;\n        s->run++;\n" : "");
	if (is_divided(e))
		say(e, "        wrong = $n_pass(s%s%s, limit, unit, poly);\n", samples_of_step(e),
		    splits(e) ? ", slope_of" : "");
	say(e, "        for (i = 1; i <= %d; i++)\n"
	       "            for (j = 0; j < $N_STATES; j++)\n"
	       "                s->poly[i][j] = poly[i][j];\n"
	       "        return %s;\n"
	       "    }\n"
	       "}\n", s, is_divided(e) ? "wrong" : "0");
}

static void emit_samples_now(const struct emitter *e)
{
	int inputs = e->system->inputs;
	const char *start = "", *slope = "";
	for (int i = 0; i < inputs; i++) {
		bool ramp = e->system->input[i].hold;
		start = format("%s%s%s[%d]", start, i ? ", " : "", ramp ? "s->u" : "u", i);
		slope = format("%s%s%s", slope, i ? ", " : "", ramp ? ramp_slope(e, i) : "0.0");
	}
	if (inputs && e->ramps)
		say(e, "    const double start[$N_INPUTS] = {%s};\n", start);
	if (inputs)
		say(e, "    const double slope[$N_INPUTS] = {%s};\n", slope);
}

/* Of a first step: a hundredth of what a state is, at its speed */
static void emit_first_length(const struct emitter *e)
{
	say(e, "\n/* A first length, in h: the states move by a hundredth */\n"
	       "static double $n_first(const $n *s%s)\n"
	       "{\n"
	       "    double most = 1.0;\n"
	       "    int i;\n"
	       "%s"
	       "%s"
	       "    for (i = 0; i < $N_STATES; i++) {\n"
	       "        const double speed = pl_magnitude(%s) * s->unit[i] * (100.0 * $N_H);\n"
	       "        most = speed > most ? speed : most;\n"
	       "    }\n"
	       "    return most < %s ? 1.0 / most : %s;  /* far above the shortest that is tried */\n"
	       "}\n", samples_parameter(e), start_jacobian(e), unread_samples(e), speed_text(e, "i"),
	    e->model->asked.single ? "1e10" : "1e15", e->model->asked.single ? "1e-10" : "1e-15");
}

/* How the internal step goes that starts now */
static void emit_advance_text(const struct emitter *e, const char *indent)
{
	const char *watched = is_divided(e) && watch_reads_known(e) ? samples_argument(e) : "";
	say(e, "%slimit = $n_limit(s);\n", indent);
	if (is_divided(e))
		say(e, "%sif (!s->contact.placed)\n"
		       "%s    $n_locate(s%s);\n"
		       "%sif ($n_left(s%s)) {\n"
		       "%s    if (!$n_pass_here(s))\n"
		       "%s        return PL_TOO_MANY_EVENTS;\n"
		       "%s    continue;\n"
		       "%s}\n", indent, indent,
		    !switches(e) ? watched : e->system->inputs ? ", u, &s->contact" : ", &s->contact",
		    indent, watched, indent, indent, indent, indent);
	/* of a step that says where things go its inside is looked at, where what is left out has lower powers */
	const char *shorter = is_divided(e) && !switches(e) ? "0.0625 * " : "";
	say(e, "%sif (s->want == 0.0)\n"
	       "%s    s->want = %s$n_first(s%s);\n", indent, indent, shorter, samples_argument(e));
	if (switches(e))
		say(e, "%s$n_rates(s%s, rates);\n"
		       "%swrong = $n_choose(s%s, limit, rates, steps);\n", indent, samples_argument(e), indent,
		    samples_argument(e));
	else
		say(e, "%swrong = $n_collocate(s%s, limit, steps);\n", indent, samples_argument(e));
}

static void emit_advance(const struct emitter *e)
{
	if (switches(e))
		emit_choice(e);
	say(e, "\n/* The next internal step, from the end of the last: 0, or what went wrong; *steps of them were "
	       "tried */\n"
	       "static int $n_advance(%s, int *steps)\n"
	       "{\n", step_parameters(e));
	emit_samples_now(e);
	say(e, "    double limit%s;\n"
	       "    int wrong;\n", switches(e) ? ", rates[2]" : "");
	if (!is_divided(e)) {
		say(e, "    $n_commit(s);\n");
		emit_advance_text(e, "    ");
		say(e, "    return wrong;\n"
		       "}\n");
		return;
	}
	say(e, "    const int met = s->size > 0.0 && s->stop == 3;\n"
	       "    $n_commit(s);\n"
	       "    if (met && !$n_pass_here(s))\n"
	       "        return PL_TOO_MANY_EVENTS;\n"
	       "    for (;;) {\n");
	emit_advance_text(e, "        ");
	say(e, "        if (wrong != -2)\n"
	       "            return wrong;\n"
	       "        if (s->contact.last.expression >= 0 && !$n_pass_here(s))\n"
	       "            return PL_TOO_MANY_EVENTS;\n"
	       "    }\n"
	       "}\n");
}

/* ---- the step ---- */

static const char *u_argument(const struct emitter *e)
{
	return e->system->inputs ? "u, " : "";
}

/* s->y `end` h after now */
static void emit_reach(const struct emitter *e)
{
	say(e, "\n/* y `end` h after now, from as many internal steps as it takes: 0; or what went wrong, and the "
	       "last good "
	       "state */\n"
	       "static int $n_reach($n *s, %sdouble end, double y[$N_STATES])\n"
	       "{\n"
	       "    int i, steps = 0, wrong = 0;\n"
	       "    double ahead;\n"
	       "    while ((ahead = (((double)s->back + end) - s->at) - s->at_low) > s->size && !wrong)\n"
	       "        wrong = $n_advance(s, %s&steps);\n"
	       "    if (!wrong) {\n"
	       "        $n_inside(s, ahead, y);\n"
	       "        return 0;\n"
	       "    }\n"
	       "    for (i = 0; i < $N_STATES; i++)\n"
	       "        y[i] = s->start[i];\n"
	       "    return wrong;\n"
	       "}\n", driven_parameter(e), u_argument(e));
}

static void emit_step_function(const struct emitter *e)
{
	say(e, "\nvoid $n_step(%s)\n"
	       "{\n"
	       "%s"
	       "    wrong = $n_reach(s, %s1.0, s->y);\n"
	       "    s->back++;\n", step_parameters(e),
	    is_divided(e) ? "    int wrong;\n    s->contact.crossings = 0;\n" : "    int wrong;\n", u_argument(e));
	emit_step_end(e);
	if (changes(e))
		say(e, "    while (s->segment < %d && $n_until(s, s->segment) <= 1e-18 * $N_H)\n"
		       "        s->segment++;\n", e->system->segments - 1);
	say(e, "    if (wrong) {\n"
	       "        s->status |= wrong;\n"
	       "        $n_anew(s);\n"
	       "    }\n"
	       "}\n");
}

void emit_collocation_step(const struct emitter *e)
{
	if (reads_channels(e->model))
		emit_leftover_functions(e);
	emit_stage_tables(e);
	emit_motion(e);
	emit_newton(e);
	if (is_divided(e)) {
		emit_divided_tables(e);
		emit_pass_breakpoint(e);
	}
	emit_ends(e);
	if (switches(e))
		emit_series_steps(e);
	emit_within(e);
	emit_inside(e);
	emit_sizes(e);
	emit_prediction(e);
	emit_solve(e);
	emit_finish(e);
	emit_shows_along(e);
	emit_commit(e);
	emit_limit(e);
	emit_passage(e);
	emit_first_length(e);
	emit_collocate(e);
	emit_advance(e);
	emit_reach(e);
	emit_step_function(e);
	if (is_divided(e))
		emit_divided_questions(e);
}

/* ---- between steps ---- */

/* Of a copy: what it takes beyond the internal step is not kept. */
void emit_collocation_at(const struct emitter *e)
{
	bool relative = e->model->relative != NULL;
	const char *y = relative ? "x" : "y";
	say(e, "\nvoid $n_at(const $n *s, %sdouble tau, double y[$N_STATES])\n"
	       "{\n"
	       "    const double ahead = (((double)s->back + tau / $N_H) - s->at) - s->at_low;\n"
	       "%s"
	       "    if (ahead <= s->size && s->size > 0.0) {\n"
	       "        $n_inside(s, ahead, %s);\n"
	       "    } else {\n"
	       "        $n copy = *s;\n"
	       "        $n_reach(&copy, %stau / $N_H, %s);\n"
	       "    }\n", driven_parameter(e), relative ? spell(e, "    double x[$N_STATES];\n") : "", y, u_argument(e),
	    y);
	if (relative)
		say(e, "    $n_written(s, x, y);\n");
	say(e, "}\n");
}
