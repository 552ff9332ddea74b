/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Derivatives beside a step of regions: the columns of what acts on the states, and those of outputs. */
#include "inner.h"
#include "emit/steps.h"
#include "model/tunable/elsewhere.h"

/* ---- what acts on the states ---- */

/* z = t^k e^{a t} (cos, sin)(w t + p): z_w = t J z, z_p = J z, z_a = t z */
static void emit_varied_load(const struct emitter *e, int column, int load, int from)
{
	struct varied_load by;
	const bool varies = vary_load(e, column, load, &by);
	const double a = by.a, w = by.w, p = by.p;
	for (int k = 0; k < e->system->load[load].columns && varies; k++) {
		struct summands sum = { 0 };
		const bool turns = mpq_sgn(e->system->load[load].forcing->w) != 0;
		const double sign = k % 2 ? 1 : -1;
		const char *other = format("x[%d]", from + k + (k % 2 ? -1 : 1));
		if (a != 0)
			add_summand(&sum, scaled(a, format("t * x[%d]", from + k)));
		if (turns && w != 0)
			add_summand(&sum, scaled(sign * w, format("t * %s", other)));
		if (turns && p != 0)
			add_summand(&sum, scaled(sign * p, other));
		say(e, "    S[%d][%d] = %s;\n", column, from + k, sum_of(&sum, 16));
	}
}

/* Params that act as inputs do, and vary as NAME_vary_params says */
static void declare_varied_params(const struct emitter *e)
{
	if (varies_params(e))
		say(e, "    double by[$N_D][%d];\n", tunables_of(e->model)->params);
}

static void emit_params_now(const struct emitter *e)
{
	if (varies_params(e))
		say(e, "    $n_vary_params(s->coeffs.params, by);\n");
}

static void emit_varied_tunables(const struct emitter *e, int column, const struct layout *x)
{
	const int by = tunable_of_column(e->step, column);
	for (int i = 0; i < e->system->inputs && by >= 0; i++) {
		const int param = param_of_input(e->model->spec, place_of_input(e, i));
		if (param >= 0 && varies_params(e))
			say(e, "    S[%d][%d] = by[%d][%d];\n", column, x->input[i], column, param);
		else if (param == by)
			say(e, "    S[%d][%d] = 1.0;\n", column, x->input[i]);
	}
}

static void emit_varied_input(const struct emitter *e, int column)
{
	const struct sensitivity *by = &e->step->shown->derivatives->column[column];
	emit_varied_tunables(e, column, &e->step->layout);
	for (int i = 0; i < e->system->inputs && by->symbol->kind == SYMBOL_INPUT; i++) {
		const int of = place_of_input(e, i), at = e->step->layout.input[i];
		const char *now = format("(du == NULL ? 0.0 : du[%d])", of);
		if (of != by->symbol->index)
			continue;
		say(e, "    S[%d][%d] = %s;\n", column, at, e->system->input[i].hold ? format("ds->du[%d]", of) : now);
		if (e->system->input[i].hold)
			say(e, "    S[%d][%d] = %s;\n", column, at + 1,
			    slope_of_samples(e, now, format("ds->du[%d]", of)));
	}
}

/* Of S what is of loads and inputs */
static void emit_acting_beside(const struct emitter *e)
{
	const struct layout *layout = &e->step->layout;
	emit_params_now(e);
	for (int p = 0; p < e->step->shown->derivatives->columns; p++) {
		for (int l = 0; l < e->system->loads; l++)
			if (layout->load[l] >= 0)
				emit_varied_load(e, p, l, layout->load[l]);
		emit_varied_input(e, p);
	}
}

static void open_doubts(const struct emitter *e)
{
	say(e, "    const unsigned known = ds->status;\n"
	       "    int i;\n");
}

static void close_doubts(const struct emitter *e)
{
	say(e, "    for (i = 0; i < 4; i++) {  /* times are after the start of the step */\n"
	       "        if ((ds->status & ~known) >> i & 1u) { ds->doubt.time[i] += $n_time(s); }\n"
	       "    }\n");
}

/* ds over a step from x, in which s may be already: what acts on the states, then `call` */
static void emit_from_start(const struct emitter *e, bool doubts, const char *call)
{
	if (doubts)
		open_doubts(e);
	say(e, "    const double t = $n_time(s);\n"
	       "    double S[$N_D + 1][%d] = {{0.0}};\n", e->step->layout.size);
	declare_varied_params(e);
	emit_acting_beside(e);
	say(e, "    $o_%s;\n", spell(e, call));
	if (doubts)
		close_doubts(e);
	close_function(e, given_inputs(e) ? e->step->shown->derivatives->seeded ? "t u du" : "t u" : "t");
}

static void emit_shared_steps(const struct emitter *e)
{
	const char *seeds = sample_parameters(e);
	const int size = size_of_vector(e);
	const bool linear = functions_of(e) == 0;
	if (e->step->regions.event_check.is_made) {
		open_function(e, NULL, "static PL_INLINE void $o_vary_clear(const $n *s, $n_d *ds%s, "
			      "const double x[%d])", seeds, size);
		emit_from_start(e, false, "vary_free(s, x, S, ds)");
	}
	open_function(e, NULL, "static void $o_vary_met($n *s, $n_d *ds%s, double x[%d])", seeds, size);
	if (linear)
		say(e, "    const pl_contact from = %s;\n", start_of_search(e));
	emit_from_start(e, true, linear ? "vary(s, $N_H, x, from, -1, S, ds)" : "vary_searched(s, x, S, ds)");
	if (e->step->regions.event_check.fast_path) {
		open_function(e, NULL, "static void $o_vary_crossed(const $n *s, $n_d *ds%s, double x[%d], "
			      "pl_contact from)", seeds, size);
		emit_from_start(e, true, "vary(s, $N_H, x, from, s->contact$p.crossings, S, ds)");
	}
}

/* Its loads now */
static void emit_loads_of_step(const struct emitter *e)
{
	const struct layout *layout = &e->step->layout;
	bool *needed = ARRAY(bool, (size_t)e->system->loads);
	struct standing at = { .since = e->step->shown->refresh != NULL };      /* a part has none of its own */
	struct emitter loads = *e;
	loads.at = at.since ? &at : e->at;
	for (int l = 0; l < e->system->loads; l++)
		needed[l] = layout->load[l] >= 0;
	emit_load_states(&loads, needed, true);
}

/* ds over tau, from s */
static void emit_varied_step(const struct emitter *e)
{
	const struct layout *layout = &e->step->layout;
	open_function(e, NULL, "static void $o_vary_by(const $n *s, $n_d *ds%s, double tau)", sample_parameters(e));
	say(e, "    pl_contact contact = %s;\n"
	       "    const double t = $n_time(s);\n"
	       "    double S[$N_D + 1][%d] = {{0.0}};\n", start_of_search(e), layout->size);
	declare_varied_params(e);
	declare_region_vector(e);
	emit_loads_of_step(e);
	emit_region_vector(e, true);
	if (e->step->shown->derivatives->regions)
		say(e, "    $n_get(s, x);\n");
	emit_acting_beside(e);
	say(e, "    $o_vary(s, tau, x, contact, -1, S, ds);\n");
	close_function(e, given_inputs(e) ? e->step->shown->derivatives->seeded ? "t u du" : "t u" : "t");
}

static void emit_vary_call(const struct emitter *part)
{
	say(part, "    $o_vary_by(s, ds%s, tau);\n", sample_arguments(part));
}

/* A linear model whose loads change: its own step is another, of the same states, loads and inputs. */
static struct emitter emitter_of_changes(const struct emitter *e)
{
	struct emitter changes = *e;
	changes.step = e->step->derivatives->regions;
	changes.model = changes.step->model;
	changes.system = &changes.step->branch->system;
	changes.spelled.own = format("%s_d", e->name);
	return changes;
}

static void each_part(const struct emitter *e, void (*emit)(const struct emitter *part))
{
	if (e->step->regions.parts)
		for_parts(e, e->step->regions.parts, emit);
	else
		emit(e);
}

void emit_all_varied(const struct emitter *e)
{
	if (e->step->derivatives->regions) {
		const struct emitter changes = emitter_of_changes(e);
		emit_linear_tables(&changes);
		emit_varied_step(&changes);
	} else {
		each_part(e, emit_varied_step);
	}
	if (shares_step(e))
		each_part(e, emit_shared_steps);
	open_function(e, NULL, "static void $n_vary_all(const $n *s, $n_d *ds%s, double tau)", sample_parameters(e));
	open_doubts(e);
	if (e->step->derivatives->regions)
		say(e, "    $n_d_vary_by(s, ds%s, tau);\n", sample_arguments(e));
	else
		each_part(e, emit_vary_call);
	close_doubts(e);
	close_function(e, "");
}

/* ---- outputs ---- */

static struct layout layout_of_outputs(const struct emitter *e)
{
	bool *needed = ARRAY(bool, (size_t)e->system->loads);
	for (int l = 0; l < e->system->loads; l++)
		needed[l] = outputs_read(e, l);
	return layout_with(e->system, 0, needed);
}

static void emit_output_rows(const struct emitter *e, const struct layout *x)
{
	const struct model *model = e->model;
	const int segments = model->system.segments, size[] = { segments, model->outputs, x->size };
	double *value = ARRAY(double, (size_t)(segments * model->outputs * x->size)), *to = value;
	const char **name = ARRAY(const char *, (size_t)model->outputs);
	for (int k = 0; k < segments; k++)
		for (int o = 0; o < model->outputs; o++, to += x->size) {
			RATIONALS *row = rationals((size_t)x->size);
			row_of_output(x, &model->system, &model->output[o], segments, k, row);
			name[o] = model->output[o].name;
			for (int j = 0; j < x->size; j++)
				to[j] = model->output[o].slopes ? 0 : finite_number(e, row[j]);
		}
	emit_array(e, "Outputs as rows over states, loads and inputs, in each segment of time", "out_row", 3, size,
		   value, name);
}

/* Of S what is of loads and inputs now; x: where each stands */
static void emit_acting_now(const struct emitter *e, const struct layout *x)
{
	const struct derivatives *d = e->step->shown->derivatives;
	emit_params_now(e);
	for (int p = 0; p < d->columns; p++) {
		emit_varied_tunables(e, p, x);
		for (int l = 0; l < e->system->loads; l++)
			if (x->load[l] >= 0)
				emit_varied_load(e, p, l, x->load[l]);
		for (int i = 0; i < e->system->inputs && d->column[p].symbol->kind == SYMBOL_INPUT; i++)
			for (int k = 0; k <= e->system->input[i].hold; k++)
				if (place_of_input(e, i) == d->column[p].symbol->index)
					say(e, "    S[%d][%d] = ds->%s[%d];\n", p, x->input[i] + k, k ? "slope" : "du",
					    d->column[p].symbol->index);
	}
}

/* x and what it varies by, now */
static void emit_columns_now(const struct emitter *e, const struct layout *x)
{
	bool *needed = ARRAY(bool, (size_t)e->system->loads);
	open_function(e, NULL, "static void $n_columns(const $n *s, const $n_d *ds, double x[%d], double S[$N_D][%d])",
		      x->size, x->size);
	say(e, "    const double t = $n_time(s);\n");
	declare_varied_params(e);
	for (int l = 0; l < e->system->loads; l++)
		needed[l] = x->load[l] >= 0;
	emit_load_states(e, needed, true);
	say(e, "    $n_%s(s, x);\n", !e->model->relative ? "get" : e->step->forced ? "kept" : "stored_state");
	for (int l = 0; l < e->system->loads; l++)
		for (int k = 0; k < e->system->load[l].columns && needed[l]; k++) {
			const char *operand = load_operand(e, l, k);
			say(e, "    x[%d] = %s;\n", x->load[l] + k, operand ? operand : "1.0");
		}
	for (int i = 0; i < e->system->inputs; i++)
		for (int k = 0; k <= e->system->input[i].hold; k++)
			say(e, "    x[%d] = %s;\n", x->input[i] + k,
			    k ? format("s->slope[%d]", place_of_input(e, i)) : sample_kept(e, i));
	emit_acting_now(e, x);
	close_function(e, "t ds S");
}

/* Is how highest derivatives vary in derivatives of outputs? */
static bool reads_rates(const struct model *model)
{
	bool any = false;
	for (int o = 0; o < model->outputs; o++)
		for (int k = 0; k < model->output[o].slopes; k++)
			any = any || is_highest(&model->frame, &model->output[o].slope[k].along);
	return any;
}

/* How the states of a part go on varying, now */
static void emit_rates(const struct emitter *e)
{
	const struct layout *layout = &e->step->layout;
	const char *own = e->model->params.retuned ? "s->coeffs." : spell(e, "$o_");
	const char *states = own_states(e), *place = place_in_loop(e);
	open_function(e, NULL, "static void $o_rates_now(const $n *s, const $n_d *ds, double rate[$N_D][$N_STATES])");
	say(e, "    const pl_contact contact = %s;\n"
	       "    const double t = $n_time(s);\n"
	       "    double S[$N_D][%d] = {{0.0}}, now[$N_STATES];\n"
	       "    int p;\n", start_of_search(e), layout->size);
	declare_varied_params(e);
	declare_region_vector(e);
	emit_loads_of_step(e);
	emit_region_vector(e, false);
	emit_acting_now(e, layout);
	say(e, "    for (p = 0; p < $N_D; p++) {\n"
	       "        $o_keep_d(ds->s[p], S[p]);\n"
	       "        pl_variation_rate(%d, %s, %sslopes[contact.matrix][0],\n"
	       "                          $o_varied_first + p * %d + contact.matrix, %svaried, x, S[p], now);\n"
	       "        for (i = 0; i < %s; i++) { rate[p][%s] = now[i]; }\n"
	       "    }\n", layout->size, states, own, e->step->branches + 5, own, states, place);
	close_function(e, "t");
}

static void emit_rates_call(const struct emitter *part)
{
	say(part, "    $o_rates_now(s, ds, rate);\n");
}

static void each_stepped(const struct emitter *e, void (*emit)(const struct emitter *part))
{
	const struct emitter changes = e->step->derivatives->regions ? emitter_of_changes(e) : *e;
	if (e->step->derivatives->regions)
		emit(&changes);
	else
		each_part(e, emit);
}

/* What a slope is times, of column p; NULL: it is of one column alone */
static const char *varied_along(const struct emitter *e, const struct basis *along)
{
	if (along->kind != BASIS_COORD)
		return NULL;
	const bool highest = is_highest(&e->model->frame, along);
	const int *velocity = e->system->velocity, own = along->index;
	if (highest)
		return format("rate[p][%d]", along->order > 1 ? velocity[own] : own);
	return format("%s[%d]", e->model->relative ? "kept" : "ds->s[p]", along->order ? velocity[own] : own);
}

static void emit_slope_in_column(const struct emitter *e, int output, int number, const struct basis *along)
{
	const struct derivatives *d = e->step->derivatives;
	if (along->kind == BASIS_ONE)
		say(e, "    J[%d][%d] += slope[%d];\n", output, along->index, number);
	for (int p = 0; p < d->columns && along->kind == BASIS_INPUT; p++)
		if (d->column[p].symbol->kind == SYMBOL_INPUT && d->column[p].symbol->index == along->index)
			say(e, "    J[%d][%d] += slope[%d] * ds->%s[%d];\n", output, p, number,
			    along->order ? "slope" : "du", along->index);
}

/* J of outputs that are no rows in all regions: their slopes times what each is along */
static void emit_outputs_by_slopes(const struct emitter *e)
{
	const struct model *model = e->model;
	const bool rated = reads_rates(model);
	if (rated)
		each_stepped(e, emit_rates);
	open_function(e, NULL, "static void $n_out_by_slopes(const $n *s, const $n_d *ds, "
		      "double J[$N_OUTPUTS][$N_D])");
	say(e, "    double slope[%d];\n"
	       "%s%s"
	       "    int p;\n"
	       "    {\n", slopes_of_outputs(model), rated ? spell(e, "    double rate[$N_D][$N_STATES];\n") : "",
	    e->model->relative ? spell(e, "    double kept[$N_STATES];\n") : "");
	emit_output_slopes(e);
	say(e, "    }\n");
	if (rated)
		each_stepped(e, emit_rates_call);
	say(e, "    for (p = 0; p < $N_D; p++) {\n"
	       "%s", e->model->relative ? spell(e, "        $n_keep_d(ds->s[p], kept);\n") : "");
	for (int o = 0, number = 0; o < model->outputs; o++)
		for (int k = 0; k < model->output[o].slopes; k++, number++) {
			const char *varied = varied_along(e, &model->output[o].slope[k].along);
			if (varied)
				say(e, "        J[%d][p] += slope[%d] * %s;\n", o, number, varied);
		}
	say(e, "    }\n");
	for (int o = 0, number = 0; o < model->outputs; o++)
		for (int k = 0; k < model->output[o].slopes; k++, number++)
			emit_slope_in_column(e, o, number, &model->output[o].slope[k].along);
	close_function(e, "s ds J");
}

int emit_varied_outputs(const struct emitter *e)
{
	const struct layout x = layout_of_outputs(e);
	const struct variation v = variation_of_outputs(e->step, &x);
	emit_output_rows(e, &x);
	put_wholes(e, false, "out_first", "Where the derivatives of rows begin, of each column in each segment of time",
		   v.blocks + 1, v.first);
	put_entries(e, false, "out_varied", &v);
	emit_columns_now(e, &x);
	if (slopes_of_outputs(e->model))
		emit_outputs_by_slopes(e);
	return x.size;
}
