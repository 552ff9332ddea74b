/* SPDX-License-Identifier: GPL-3.0-or-later */
/* NAME_batch: the step of a linear model over lanes, each an instance. What instances share of a step (load states,
 * samples) is computed once, for some steps ahead; then each group of instances goes through these, its states in
 * locals. The sums are those of NAME_step, in its order, so that an instance gets the bits of one that steps alone. */
#include "emit/emit.h"

#include <string.h>

enum { STEPS_AHEAD = 64, STEPS_OF_PEAKS = 256 };

/* ---- the header ---- */

/* Rows of an instance's memory, as in its struct: what a step changes, then what only get and set read */
struct member { const char *name; int rows; };

static int members_of(const struct emitter *e, struct member member[5])
{
	int states = e->system->states, count = 0;
	bool compensated = e->step->program->compensated;
	member[count++] = (struct member){ "y", states };
	if (compensated)
		member[count++] = (struct member){ "rest", states };
	if (e->step->carries)
		member[count++] = (struct member){ "carry", e->step->carries };
	if (e->step->forced && !compensated)
		member[count++] = (struct member){ "rest", states };
	if (e->model->relative) {
		member[count++] = (struct member){ "set", states };
		member[count++] = (struct member){ "from", states };
	}
	return count;
}

static int rows_of(const struct emitter *e)
{
	struct member member[5];
	int count = members_of(e, member), rows = 0;
	for (int i = 0; i < count; i++)
		rows += member[i].rows;
	return rows;
}

static const char *row_list(const struct emitter *e)
{
	struct member member[5];
	int count = members_of(e, member);
	const char *list = "";
	for (int i = 0; i < count; i++)
		list = format("%s%s%s", list, i ? ", " : "", member[i].name);
	return list;
}

static void declare_instances(const struct emitter *e, const struct batch *b)
{
	say(e, "\n"
	       "/* Many instances in one call, all at one time%s. In each array the instance is the fastest: entry i\n"
	       " * of instance j stands at [i * count + j]. Set count and the arrays, then call $n_batch_init. */\n",
	    e->system->inputs ? " and under the same inputs" : "");
	say(e, "enum { $N_BATCH_ROWS = %d%s };\n", rows_of(e),
	    b->factors ? format(", %s_BATCH_FACTORS = %d", e->upper, b->factors) : "");
	say(e, "typedef struct $n_instances {\n"
	       "    size_t count;\n"
	       "    double *y;        /* [$N_BATCH_ROWS][count]: of each %s, as in struct $n */\n", row_list(e));
	if (b->factors)
		say(e, "    double *factors;  /* [$N_BATCH_FACTORS][count]: its own, by $n_batch_use; NULL: all have "
		       "those of shared */\n");
	say(e, "    double *peak;     /* [$N_OUTPUTS][count]: the largest |output| at ends of steps; "
	       "NULL: not kept */\n"
	       "    $n shared;        /* what all share: time%s%s; its states are not used */\n"
	       "} $n_instances;\n", e->system->inputs ? ", the last sample" : "",
	    e->phases || e->growths ? ", phases of loads" : "");
}

void emit_batch_declarations(const struct emitter *e)
{
	struct batch b = plan_batch(e);
	bool inputs = e->system->inputs > 0;
	declare_instances(e, &b);
	say(e, "void   $n_batch_init($n_instances *b);%31s/* t = 0; of each the spec's initial values%s */\n", "",
	    b.factors ? " and coefficients" : "");
	say(e, "void   $n_batch_set($n_instances *b, size_t j, const double y[$N_STATES]);  /* of instance j, now */\n"
	       "void   $n_batch_get(const $n_instances *b, size_t j, double y[$N_STATES]);\n"
	       "int    $n_batch_status(const $n_instances *b, size_t j);%24s/* of instance j, as $n_status */\n", "");
	if (b.factors)
		say(e, "/* Instance j goes on with c; PL_NO_STEP: its h is not that of shared, or b has no factors */\n"
		       "int    $n_batch_use($n_instances *b, size_t j, const $n_coeffs *c);\n");
	say(e, "/* n steps%s; out: [n][$N_OUTPUTS][count], or NULL */\n"
	       "void   $n_batch($n_instances *b, size_t n, %sdouble *out);\n\n",
	    inputs ? ", n rows of u for all" : "", inputs ? "const double *u, " : "");
}

/* ---- what instances share in some steps ahead ---- */

static bool *loads_of_outputs(const struct batch *b)
{
	const struct linear *system = b->e->system;
	bool *wanted = ARRAY(bool, (size_t)system->loads);
	for (int l = 0; l < system->loads; l++)
		wanted[l] = tape_reads(b->out, TAPE_LOAD, l, -1);
	return wanted;
}

static int steps_ahead(const struct emitter *e)
{
	return has_peaks(e) ? STEPS_OF_PEAKS : STEPS_AHEAD;
}

static void emit_ahead(const struct batch *b)
{
	const struct emitter *e = b->e;
	say(e, "\n/* What instances share in some steps ahead: [0] before the first, [k] in step k and behind it */\n"
	       "struct $n_ahead {\n"
	       "    size_t steps;\n"
	       "    double now[%d][%d];\n", steps_ahead(e) + 1, batch_shared_rows(b));
	if (b->acting)
		say(e, "    double acting[%d][%d];  /* on the states, then how far it bends outputs */\n"
		       "    double reach[%d];       /* that at most */\n", steps_ahead(e) + 1, b->acting,
		    peak_outputs(e->model));
	if (b->sampled)
		say(e, "    int known;             /* is `acting` filled in? From these, the samples of the steps: */\n"
		       "    $n from;\n"
		       "    const double *u;\n");
	say(e, "};\n");
}

static void emit_shared(const struct batch *b)
{
	const struct emitter *e = b->e;
	say(e, "\n/* What instances share in a step, which is taken: before it, */\n"
	       "static void $n_share_step(%s, double *now)\n"
	       "{\n", step_parameters(e));
	emit_load_states(e, loads_of_step(e), false);
	for (int i = 0; i < b->after; i++)
		say(e, "    now[%d] = %s;\n", i, b->shared_text[i]);
	emit_step_end(e);
	say(e, "    (void)now;\n"
	       "}\n"
	       "\n/* and in the outputs behind it */\n"
	       "static void $n_share_out(const $n *s, double *now)\n"
	       "{\n");
	emit_load_states(e, loads_of_outputs(b), false);
	for (int i = b->after; i < (b->forced >= 0 ? b->forced : b->shared); i++)
		say(e, "    now[%d] = %s;\n", i, b->shared_text[i]);
	if (b->forced >= 0)
		say(e, "    $n_forced(s, now + %d);\n", b->forced);
	say(e, "    (void)s;\n"
	       "    (void)now;\n"
	       "}\n");
}

/* ---- groups of lanes over some steps ---- */

static const char *from_group(int group)
{
	return group > 1 ? format("first + %d * lanes", group) : group ? "first + lanes" : "first";
}

/* A line for each group: # its number, @ its first instance, ! its factors where there are some */
static void say_groups(const struct batch *b, int groups, const char *layout)
{
	const struct emitter *e = b->e;
	for (int g = 0; g < groups; g++) {
		say(e, "    ");
		for (const char *text = layout; *text; text++)
			if (*text == '#')
				say(e, "%d", g);
			else if (*text == '@')
				say(e, "%s", from_group(g));
			else if (*text == '!')
				say(e, b->factors ? "factor[%d], " : "", g);
			else if (*text == '\t')
				say(e, "    ");
			else
				say(e, "%c", *text);
		say(e, "\n");
	}
}

static void say_locals(const struct batch *b, int groups)
{
	const struct emitter *e = b->e;
	say(e, "%s"
	       "    pl_lanes y[%d][%d], peak[%d][$N_OUTPUTS];\n",
	    groups > 1 ? "    const size_t lanes = sizeof(pl_lanes) / sizeof(double);\n" : "", groups,
	    batch_stepped_rows(e), groups);
	if (b->factors)
		say(e, "    pl_lanes factor[%d][%d];\n", groups, b->lanes);
}

/* Step by step, with outputs of each */
static void emit_block(const struct batch *b, const char *name, int groups)
{
	const struct emitter *e = b->e;
	bool peaks = has_peaks(e);
	say(e, "\n/* Instances from `first` on, %s, over the steps ahead */\n"
	       "static void $n_batch_%s($n_instances *b, size_t first, %sstruct $n_ahead *ahead, double *out)\n"
	       "{\n", groups > 1 ? format("%d a lane", groups) : "one a lane", name, b->sampled ? "" : "const ");
	say_locals(b, groups);
	if (peaks)
		say(e, "    pl_lanes start[%d][$N_STATES], before[%d][$N_OUTPUTS];\n", groups, groups);
	say(e, "    size_t k;\n");
	say_groups(b, groups, spell(e, "$n_lanes_take(b, @, y[#], !peak[#]);"));
	if (peaks)
		say_groups(b, groups, spell(e, "$n_lanes_out(y[#], !ahead->now[0], before[#]);"));
	if (b->sampled)
		say(e, "    $n_ahead_acting(ahead);\n");
	say(e, "    for (k = 1; k <= ahead->steps; k++) {\n");
	for (int i = 0; i < e->system->states && peaks; i++)
		say_groups(b, groups, format("\tstart[#][%d] = y[#][%d];", i, i));
	say_groups(b, groups, spell(e, "\t$n_lanes_step(y[#], !ahead->now[k]);"));
	say(e, "        if (b->peak || out) {\n");
	say_groups(b, groups, spell(e, "\t\t$n_lanes_tell(b, @, %sy[#], !ahead->now[k], %s%speak[#], out);",
				    peaks ? "start[#], " : "", b->acting ? "ahead->acting[k], " : "",
				    peaks ? "before[#], " : ""));
	say(e, "            out = out ? out + $N_OUTPUTS * b->count : NULL;\n"
	       "        }\n"
	       "    }\n");
	say_groups(b, groups, spell(e, "$n_lanes_give(b, @, y[#], peak[#]);"));
	say(e, "}\n");
}

static void emit_swift_block(const struct batch *b, const char *name, int groups)
{
	const struct emitter *e = b->e;
	say(e, "\n/* Instances from `first` on, %s, over the steps ahead */\n"
	       "static void $n_batch_%s($n_instances *b, size_t first, %sstruct $n_ahead *ahead)\n"
	       "{\n", groups > 1 ? format("%d a lane", groups) : "one a lane", name, b->sampled ? "" : "const ");
	say_locals(b, groups);
	say(e, "    pl_lanes state[%d][$N_STATES], top[%d][$N_OUTPUTS];\n"
	       "    size_t k;\n", groups, groups);
	say_groups(b, groups, spell(e, "$n_lanes_take(b, @, y[#], !peak[#]);"));
	say_groups(b, groups, spell(e, "$n_lanes_first(y[#], !ahead->now[0], state[#], top[#]);"));
	say(e, "    for (k = 1; k <= ahead->steps; k++) {\n");
	say_groups(b, groups, spell(e, "\t$n_lanes_step(y[#], !ahead->now[k]);"));
	say_groups(b, groups, spell(e, "\t$n_lanes_widen(y[#], !ahead->now[k], state[#], top[#]);"));
	say(e, "    }\n");
	say_groups(b, groups, spell(e, "$n_lanes_end(b, @, ahead, y[#], !state[#], top[#], peak[#]);"));
	say(e, "}\n");
}

/* ---- NAME_batch ---- */

static void emit_blocks(struct batch *b)
{
	const struct emitter *e = b->e;
	int groups = batch_groups(e);
	if (!has_peaks(e)) {
		emit_block(b, "block", groups);
		if (groups > 1)
			emit_block(b, "group", 1);
		return;
	}
	emit_block(b, "one_by_one", 1);
	emit_lanes_widen(b);
	emit_lanes_end(b);
	emit_swift_block(b, "block", groups);
	if (groups > 1)
		emit_swift_block(b, "group", 1);
}

/* ... computed, or of samples bounded, for as many steps as there are, u at the first */
static void say_shared_steps(const struct batch *b)
{
	const struct emitter *e = b->e;
	bool inputs = e->system->inputs > 0;
	int peaks = peak_outputs(e->model);
	say(e, "        ahead.steps = n < %d ? n : %d;\n"
	       "        $n_share_out(&b->shared, ahead.now[0]);\n", steps_ahead(e), steps_ahead(e));
	if (b->sampled)
		say(e, "        ahead.known = 0;\n"
		       "        ahead.from = b->shared;\n"
		       "        ahead.u = u;\n"
		       "        $n_share_reach(&b->shared, u, ahead.steps, ahead.reach);\n");
	for (int p = 0; p < peaks && b->acting && !b->sampled; p++)
		say(e, "        ahead.reach[%d] = 0.0;\n", p);
	say(e, "        for (k = 1; k <= ahead.steps; k++) {\n");
	if (b->acting && !b->sampled)
		say(e, "            $n_share_acting(&b->shared, %sahead.acting[k]);\n", inputs ? "u, " : "");
	for (int p = 0; p < peaks && b->acting && !b->sampled; p++)
		say(e, "            ahead.reach[%d] = pl_larger_size(ahead.reach[%d], ahead.acting[k][%d]);\n", p, p,
		    b->acting - peaks + p);
	say(e, "            $n_share_step(&b->shared, %sahead.now[k]);\n"
	       "            $n_share_out(&b->shared, ahead.now[k]);\n", inputs ? "u, " : "");
	if (inputs)
		say(e, "            u += $N_INPUTS;\n");
	say(e, "        }\n");
}

/* As many whole blocks as there are, then single groups */
static void say_blocks(const struct batch *b)
{
	const struct emitter *e = b->e;
	bool single = batch_groups(e) > 1;
	const char *wanted = has_peaks(e) ? "!out && " : "", *last = has_peaks(e) ? "" : ", out";
	if (has_peaks(e))
		say(e, "        for (first = 0; out && first < b->count; first += lanes)\n"
		       "            $n_batch_one_by_one(b, first, &ahead, out);\n");
	say(e, "        for (first = 0; %sfirst < b->count%s; first += block)\n"
	       "            $n_batch_block(b, first, &ahead%s);\n", wanted,
	    single ? " && b->count - first > block - lanes" : "", last);
	if (single)
		say(e, "        for (; %sfirst < b->count; first += lanes)\n"
		       "            $n_batch_group(b, first, &ahead%s);\n", wanted, last);
}

static void emit_batch_function(const struct batch *b)
{
	const struct emitter *e = b->e;
	int groups = batch_groups(e);
	bool single = groups > 1, lanes = single || has_peaks(e);
	say(e, "\nvoid $n_batch($n_instances *b, size_t n, %sdouble *out)\n"
	       "{\n"
	       "    const size_t %sblock = %s%s;\n"
	       "    struct $n_ahead ahead;\n"
	       "    size_t first, k;\n", e->system->inputs ? "const double *u, " : "",
	    lanes ? "lanes = sizeof(pl_lanes) / sizeof(double), " : "", single ? format("%d * ", groups) : "",
	    lanes ? "lanes" : "sizeof(pl_lanes) / sizeof(double)");
	say(e, "    for (; n > 0; n -= ahead.steps) {\n");
	say_shared_steps(b);
	say_blocks(b);
	say(e, "        out = out ? out + ahead.steps * $N_OUTPUTS * b->count : NULL;\n"
	       "    }\n"
	       "}\n");
}

/* ---- init, set, get, use ---- */

/* Rows of instance j from those of one alone, or into it */
static void say_rows(const struct emitter *e, bool into)
{
	struct member member[5];
	int count = members_of(e, member), row = 0;
	for (int i = 0; i < count; i++) {
		const char *from = row ? format("(%d + i)", row) : "i";
		const char *there = format("b->y[%s * b->count + j]", from);
		const char *here = format("one.%s[i]", member[i].name);
		say(e, "    for (i = 0; i < %d; i++)\n"
		       "        %s = %s;\n", member[i].rows, into ? there : here, into ? here : there);
		row += member[i].rows;
	}
}

static void emit_write(const struct batch *b)
{
	const struct emitter *e = b->e;
	say(e, "\n/* One instance alone as instance j; its peaks are what its outputs are now. */\n"
	       "static void $n_batch_write($n_instances *b, size_t j, const $n *s)\n"
	       "{\n"
	       "    %s$n one = *s;\n"
	       "    double out[$N_OUTPUTS];\n"
	       "    size_t i;\n", b->factors ? "" : "const ");
	say_rows(e, true);
	if (b->factors)
		say(e, "    if (b->factors) {\n");
	for (int k = 0; k < b->factors; k++)
		say(e, "        one.%s = b->factors[%d * b->count + j];\n", strchr(b->factor_text[k], '>') + 1, k);
	if (b->factors)
		say(e, "    }\n");
	say(e, "    $n_out(&one, out);\n"
	       "    for (i = 0; i < $N_OUTPUTS && b->peak; i++)\n"
	       "        b->peak[i * b->count + j] = out[i] < 0.0 ? -out[i] : out[i];\n"
	       "}\n");
}

static void emit_use(const struct batch *b)
{
	const struct emitter *e = b->e;
	if (!b->factors)
		return;
	say(e, "\nint $n_batch_use($n_instances *b, size_t j, const $n_coeffs *c)\n"
	       "{\n"
	       "    $n one = b->shared, *s = &one;\n"
	       "    if (!b->factors || !(c->h == b->shared.coeffs.h))\n"
	       "        return PL_NO_STEP;\n"
	       "    s->coeffs = *c;\n");
	for (int k = 0; k < b->factors; k++)
		say(e, "    b->factors[%d * b->count + j] = %s;\n", k, b->factor_text[k]);
	say(e, "    return 0;\n"
	       "}\n");
}

static void emit_batch_access(const struct batch *b)
{
	const struct emitter *e = b->e;
	emit_write(b);
	emit_use(b);
	say(e, "\nvoid $n_batch_init($n_instances *b)\n"
	       "{\n"
	       "    size_t j;\n"
	       "    $n_init(&b->shared);\n"
	       "    for (j = 0; j < b->count; j++) {\n"
	       "%s"
	       "        $n_batch_write(b, j, &b->shared);\n"
	       "    }\n"
	       "}\n", b->factors ? spell(e, "        (void)$n_batch_use(b, j, &b->shared.coeffs);\n") : "");
	say(e, "\nvoid $n_batch_set($n_instances *b, size_t j, const double y[$N_STATES])\n"
	       "{\n"
	       "    $n one = b->shared;\n"
	       "    $n_set(&one, $n_time(&b->shared), y);\n"
	       "    $n_batch_write(b, j, &one);\n"
	       "}\n"
	       "\nvoid $n_batch_get(const $n_instances *b, size_t j, double y[$N_STATES])\n"
	       "{\n"
	       "    $n one = b->shared;\n"
	       "    size_t i;\n");
	say_rows(e, false);
	say(e, "    $n_get(&one, y);\n"
	       "}\n"
	       "\nint $n_batch_status(const $n_instances *b, size_t j)\n"
	       "{\n"
	       "    $n one = b->shared;\n"
	       "    size_t i;\n");
	say_rows(e, false);
	say(e, "    return $n_status(&one);\n"
	       "}\n");
}

void emit_batch(const struct emitter *e)
{
	struct batch b = plan_batch(e);
	emit_ahead(&b);
	emit_batch_acting(&b);
	emit_shared(&b);
	emit_batch_reach(&b);
	emit_lanes_step(&b);
	emit_lanes_out(&b);
	emit_lanes_take(&b);
	if (has_peaks(e)) {
		emit_lanes_may_pass(&b);
		emit_lanes_look(&b);
	}
	emit_lanes_tell(&b);
	emit_blocks(&b);
	emit_batch_function(&b);
	emit_batch_access(&b);
}
