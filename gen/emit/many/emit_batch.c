/* SPDX-License-Identifier: GPL-3.0-or-later */
/* NAME_batch: what the header has of it, and what batch.h is given. */
#include "inner.h"
#include "emit/declarations.h"
#include "emit/regions/regions.h"
#include "emit/series/series.h"
#include "model/contacts/contacts.h"
#include "model/tunable/tuning.h"
#include "step/linear/forms.h"
#include "step/linear/rows.h"
#include "step/series/expansion.h"

#include <string.h>

/* ---- the header ---- */

/* Rows of an instance's memory, those that its struct begins with: what a step changes, then what only get and set
 * read */
struct member { const char *name; int rows; };

static int members_of(const struct emitter *e, struct member member[6])
{
	int states = e->system->states, count = 0;
	bool compensated = e->step->program->compensated;
	member[count++] = (struct member){ "y", states };
	if (e->step->modal)
		member[count++] = (struct member){ "set", states };
	if (compensated)
		member[count++] = (struct member){ "low", states };
	if (e->step->carried.count)
		member[count++] = (struct member){ "carry", e->step->carried.count };
	if (e->step->forced && !compensated && !e->model->relative)
		member[count++] = (struct member){ "low", states };
	if (e->model->relative) {
		member[count++] = (struct member){ "set", states };
		member[count++] = (struct member){ "from", states };
		if (e->step->forced)
			member[count++] = (struct member){ "start", states };
	}
	return count;
}

static int rows_of(const struct emitter *e)
{
	struct member member[6];
	int count = members_of(e, member), rows = 0;
	for (int i = 0; i < count; i++)
		rows += member[i].rows;
	return rows;
}

/* Behind the states of a model of regions: the region, and contact and status as bytes */
const char *row_count(const struct emitter *e)
{
	if (e->step->no.lanes)
		return spell(e, "(int)((sizeof(struct $n) + sizeof(double) - 1) / sizeof(double))");
	if (has_series(e))
		return format("%d", batch_stepped_rows(e) + 1);
	if (has_regions(e))
		return spell(e, "$N_STATES + 1 +\n"
				"       (int)((sizeof(pl_contact) + sizeof(int) + sizeof(double) - 1) / "
				"sizeof(double))");
	return format("%d", rows_of(e));
}

static const char *row_list(const struct emitter *e)
{
	struct member member[6];
	int count = members_of(e, member);
	const char *list = "";
	for (int i = 0; i < count; i++)
		list = format("%s%s%s", list, i ? ", " : "", member[i].name);
	if (has_series(e))
		return format("states, low parts,%s and the bytes of its status",
			      spans_steps(e) ? " how far its series is served, where that ends, the series," : "");
	if (has_regions(e))
		return format("%s, its region, and the bytes of contact and status", list);
	return list;
}

/* Of a model with delayed inputs those that are given */
int inputs_of(const struct emitter *e)
{
	return e->model->delays ? e->model->delays->inputs : given_inputs(e);
}

/* As lanes, or each by itself */
static void declare_instances(const struct emitter *e, const struct batch *b)
{
	const char *alone = e->step->no.lanes;
	say(e, "\n"
	       "/* Many instances in one call, all at one time%s. In each array the instance is the fastest: entry i\n"
	       " * of instance j stands at [i * count + j]. Set count and the arrays, then call $n_batch_init.%s */\n",
	    inputs_of(e) ? " and under the same inputs" : "",
	    alone ? format("\n * Each takes its steps by itself: %s.", alone) : "");
	say(e, "enum { $N_BATCH_ROWS = %s%s };\n", row_count(e),
	    b->factors ? format(", %s_BATCH_FACTORS = %d", e->upper, b->factors) : "");
	say(e, "typedef struct $n_instances {\n"
	       "    size_t count;\n"
	       "    double *y;        /* [$N_BATCH_ROWS][count]: each instance's %s */\n",
	    alone ? "bytes of its struct" : spell(e, "%s, as in struct $n", row_list(e)));
	if (b->factors)
		say(e, "    double *factors;  /* [$N_BATCH_FACTORS][count]: coefficients of each instance, set by "
		       "$n_batch_use; NULL: all have those of shared */\n");
	say(e, "    double *peak;     /* [$N_OUTPUTS][count]: the largest |output|, start and ends of steps; "
	       "NULL: not kept */\n"
	       "    struct $n shared;       /* %s */\n"
	       "} $n_instances;\n",
	    alone ? "a copy of the first"
		  : format("what all share: time%s%s; its states are not used",
			   e->system->inputs ? ", the last sample" : "",
			   e->phases || e->envelopes ? ", phases of loads" : ""));
}

/* Bytes at the head of an instance's struct that hold all that instances share, for work items that take whole steps */
const char *shared_head_text(const struct emitter *e)
{
	if (e->step->no.lanes)
		return "0";
	return spell(e, has_regions(e) ? "offsetof(struct $n, crossing)" : "sizeof(struct $n)");
}

/* Numbers of a row of NAME_batch_share */
const char *shared_row_text(const struct batch *b)
{
	const struct emitter *e = b->e;
	if (!takes_whole_steps(b))
		return integer_text(b->shared);
	if (e->step->no.lanes)
		return integer_text(inputs_of(e));
	return format("(int)(%s / sizeof(double)) + %d", shared_head_text(e), inputs_of(e));
}

/* Are there tunable params? */
static bool drives_many(const struct batch *b)
{
	return b->factors > 0 || (b->e->step->no.lanes && tunables_of(b->e->model));
}

void emit_batch_declarations(const struct emitter *e)
{
	const struct batch b = e->step->no.lanes ? (struct batch){ .e = e } : plan_batch(e);
	bool inputs = inputs_of(e) > 0;
	declare_instances(e, &b);
	say(e, "void   $n_batch_init($n_instances *b);%31s/* t = 0; of each the spec's initial values%s */\n", "",
	    b.factors ? " and coefficients" : "");
	say(e, "void   $n_batch_set($n_instances *b, size_t j, const double y[$N_STATES]);  /* of instance j, now */\n"
	       "void   $n_batch_get(const $n_instances *b, size_t j, double y[$N_STATES]);\n"
	       "int    $n_batch_status(const $n_instances *b, size_t j);%24s/* of instance j, as $n_status */\n", "");
	if (b.factors)
		say(e, "/* Instance j goes on with c; PL_NO_STEP: its h is not that of shared, or b has no factors */\n"
		       "int    $n_batch_use($n_instances *b, size_t j, const $n_coeffs *c);\n");
	if (e->step->no.lanes || leaves_lanes(e))
		say(e, "void   $n_batch_take(const $n_instances *b, size_t j, $n *s);  /* instance j to s */\n"
		       "void   $n_batch_give($n_instances *b, size_t j, const $n *s);  /* it goes on as s */\n");
	say(e, "/* For $n_kernel on a device (plgen --target): now[n + 1][$N_BATCH_SHARED] receives what all\n"
	       " * share in n steps%s; time goes on. */\n"
	       "enum { $N_BATCH_SHARED = %s };\n"
	       "void   $n_batch_share($n_instances *b, size_t n, %sdouble *now);\n",
	    inputs ? ", n rows of u" : "", shared_row_text(&b), inputs ? "const double *u, " : "");
	say(e, "/* n steps%s; out: [n][$N_OUTPUTS][count], or NULL */\n"
	       "void   $n_batch($n_instances *b, size_t n, %sdouble *out);\n",
	    inputs ? ", n rows of u for all" : "", inputs ? "const double *u, " : "");
	say(e, drives_many(&b) ? "extern const pl_many $n_many;  /* for programs that drive any model */\n\n" : "\n");
}

/* ---- what instances share of a step ---- */

static bool *loads_of_outputs(const struct batch *b)
{
	const struct linear *system = b->e->system;
	bool *wanted = ARRAY(bool, (size_t)system->loads);
	for (int l = 0; l < system->loads; l++)
		wanted[l] = tape_reads(b->out, TAPE_LOAD, l, -1);
	return wanted;
}

static void emit_shared_of_linear(const struct batch *b)
{
	const struct emitter *e = b->e;
	open_function(e, "now receives what all instances share in this step; time then advances by h",
		      "static void $n_share_step($n *s, const double *u, double *now)");
	emit_load_states(e, loads_of_step(e), false);
	for (int i = 0; i < b->after; i++)
		say(e, "    now[%d] = %s;\n", i, b->shared_text[i]);
	emit_step_end(e);
	close_function(e, "u now");
}

static void emit_shared(const struct batch *b)
{
	const struct emitter *e = b->e;
	if (has_regions(e))
		emit_shared_of_regions(e);
	else if (has_series(e))
		emit_shared_of_series(b);
	else
		emit_shared_of_linear(b);
	open_function(e, "now receives what all instances share in the outputs after a step",
		      "static void $n_share_out(const $n *s, double *now)");
	(has_regions(e) ? emit_rotated_loads : emit_load_states)(e, loads_of_outputs(b), false);
	for (int i = b->after; i < (b->forced >= 0 ? b->forced : b->shared); i++)
		say(e, "    now[%d] = %s;\n", i, b->shared_text[i]);
	if (b->forced >= 0)
		say(e, "    $n_forced(s, now + %d);\n", b->forced);
	close_function(e, "s now");
}

/* ---- what batch.h asks ---- */

void emit_factor_places(const struct batch *b)
{
	const struct emitter *e = b->e;
	if (!b->factors)
		return;
	say(e, "\nstatic const size_t $n_factor_at[%d] = {\n", b->factors);
	for (int k = 0; k < b->factors; k++)
		say(e, "    offsetof(struct $n, %s),\n", strchr(b->factor_text[k], '>') + 1);
	say(e, "};\n");
}

static void emit_sample_reaches(const struct emitter *e)
{
	int inputs = e->system->inputs, columns = most_samples_before(e) + 1;
	int *degree = ARRAY(int, (size_t)inputs);
	double *reach = ARRAY(double, (size_t)(inputs * columns));
	for (int i = 0; i < inputs; i++) {
		degree[i] = e->system->input[i].hold;
		for (int m = 0; m <= degree[i]; m++)
			reach[i * columns + m] = sample_reach(degree[i], m);
	}
	emit_int_list(e, "sample_degree", inputs, degree);
	emit_int_list(e, "sample_column", inputs, e->step->layout.input);
	emit_array(e, "Of the largest sample in each derivative of the polynomial through samples, times h, h^2, ...",
		   "sample_reach", 2, (const int[]){ inputs, columns }, reach, names_of_inputs(e));
}

static bool any_momentum(const struct emitter *e)
{
	bool any = false;
	for (int i = 0; i < e->system->states; i++)
		any = any || factor_of_momentum(e, i);
	return any;
}

static void emit_velocities(const struct emitter *e)
{
	open_function(e, NULL, "static void $n_velocities(double *x)");
	for (int i = 0; i < e->system->states; i++)
		if (factor_of_momentum(e, i))
			say(e, "    x[%d] = x[%d] / %s;\n", i, i, factor_of_momentum(e, i));
	close_function(e, "");
}

static void emit_peaks_of_batch(struct batch *b)
{
	const struct emitter *e = b->e;
	emit_lanes_bend(b);
	if (b->sampled)
		emit_sample_reaches(e);
	if (any_momentum(e))
		emit_velocities(e);
}

static void emit_include(const struct batch *b)
{
	const struct emitter *e = b->e;
	const struct denormal_flush *flush = e->step->linear.flush;
	emit_sizes(e, "batch.h", { "STATES", e->system->states }, { "INPUTS", given_inputs(e) },
		   { "OUTPUTS", e->model->outputs },
		   { "EVENTS", leaves_lanes(e) },
		   { "ORDER", has_series(e) ? own_expansion(e)->order : 0 },
		   { "OVER", steps_of_series(e) },
		   { "TUNED", e->step->is.tuned },
		   { "OUT_ALONE", b->out_alone },
		   { "SHARES", takes_whole_steps(b) ? 2 : 1 },
		   { "LANES_PAY", !has_regions(e) ? 0 : has_events(e->model->switching) ? 3 : 2 },
		   { "STEPPED", batch_stepped_rows(e) }, { "GROUPS", batch_groups(e) },
		   { "SHARED", b->shared }, { "FACTORS", b->factors }, { "LANES", b->lanes },
		   { "PEAKS", peak_outputs(e->model) }, { "SIZE", e->step->layout.size },
		   { "MOMENTA", any_momentum(e) }, { "SAMPLED", b->sampled }, { "RAMPS", e->ramps },
		   { "FLUSHES", flush ? flush->parts : 0 },
		   { "FLUSHES_BESIDE", flush && flush->beside }, { "DECAYING", flush ? flush->decaying : 0 },
		   { "COMPENSATED", e->step->program->compensated });
	say(e, "#define PL_INSTANCES $n_instances\n");
	say_macro(e, "ROWS", spell(e, "$N_BATCH_ROWS"));
	say_macro(e, "NOW", spell(e, "$N_BATCH_SHARED"));
	say_macro(e, "HEAD", shared_head_text(e));
	if (has_peaks(e))
		say_macro(e, "NOMINAL", e->step->is.tuned ? spell(e, "$n_nominal.bend") : spell(e, "$n_peak_bend"));
	say(e, "#include \"batch.h\"\n");
}

static void emit_each(const struct emitter *e)
{
	emit_sizes(e, "each.h", { "STATES", e->system->states }, { "INPUTS", inputs_of(e) },
		   { "OUTPUTS", e->model->outputs }, { "RAMPS", e->ramps }, { "TUNED", e->step->is.tuned },
		   { "PARAMS", tunables_of(e->model) ? tunables_of(e->model)->given : 0 });
	say_macro(e, "ROWS", spell(e, "$N_BATCH_ROWS"));
	say_macro(e, "INSTANCES", spell(e, "$n_instances"));
	say_include(e, "each.h");
}

void emit_batch(const struct emitter *e)
{
	if (e->step->no.lanes) {
		emit_each(e);
		return;
	}
	struct batch b = plan_batch(e);
	open_algorithm(e, "lanes.h", &(struct size){ NULL, 0 });
	say(e, "#include \"lanes.h\"\n");
	emit_shared(&b);
	if (has_regions(e))
		emit_lanes_of_regions(e);
	else if (has_series(e))
		emit_lanes_of_series(&b);
	else
		emit_lanes_step(&b);
	if (!b.out_alone)
		emit_lanes_out(&b);
	emit_factor_places(&b);
	if (has_peaks(e))
		emit_peaks_of_batch(&b);
	emit_include(&b);
}
