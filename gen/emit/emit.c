/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A step program and its tables as C. Everything printed here is meant to be read. */
#include "emit/linear/blocks.h"
#include "declarations.h"
#include "emit.h"
#include "emit/series/series.h"
#include "steps.h"
#include "emit/tunable/tunable.h"
#include "model/contacts/contacts.h"
#include "model/reads.h"
#include "step/certify/certify.h"
#include "step/series/switching.h"
#include "step/series/expansion.h"

#include <ctype.h>

static const char *upper_case(const char *name)
{
	char *upper = format("%s", name);
	for (char *c = upper; *c; c++)
		*c = (char)toupper((unsigned char)*c);
	return upper;
}

/* ---- which loads the step or an output reads: others leave no trace ---- */

struct forcing_search {
	const struct forcing *forcing;
	bool found;
};

static void look_for_forcing(void *context, const struct form *form)
{
	struct forcing_search *search = context;
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		search->found = search->found || (basis->kind == BASIS_FORCING && basis->forcing == search->forcing);
	}
}

static bool remainders_read(const struct model *model, const struct forcing *forcing)
{
	struct forcing_search search = { forcing, false };
	visit_remainders(model, look_for_forcing, &search);
	return search.found;
}

/* Elsewhere than in the system, remainders, outputs */
static bool step_reads_load(const struct emitter *e, int load)
{
	const struct step *step = e->step;
	const struct splitting *split = e->model->remainder.split;
	bool read = step->is.tuned || derivatives_read_load(step, load);  /* for other params any may be */
	if (e->model->switching)
		read = step->regions.parts ? step->layout.load[load] >= 0 : loads_of_regions(step)[load];
	for (int k = 0; step->normal && k < split->forcings; k++)
		read = read || split->forcing[k].forcing == e->system->load[load].forcing;
	return read || (step->event_split && step->event_split->event_check->load[load]) ||
	       (step->taylor.expansion && step->taylor.expansion->load[load]) ||
	       (step->collocation && motion_reads_load(e, load));
}

static bool load_is_needed(const struct emitter *e, int load)
{
	return step_reads_load(e, load) || load_acts(e->system, &e->system->load[load]) ||
	       remainders_read(e->model, e->system->load[load].forcing) || outputs_read(e, load);
}

static void number_loads(struct emitter *e)
{
	e->phase = ARRAY(int, (size_t)e->system->loads);
	e->envelope = ARRAY(int, (size_t)e->system->loads);
	e->refresh.phasor = ARRAY(int, (size_t)e->system->loads);
	for (int l = 0; l < e->system->loads; l++) {
		const struct forcing *forcing = e->system->load[l].forcing;
		bool needed = load_is_needed(e, l);
		e->phase[l] = needed && oscillates(forcing) ? e->phases++ : -1;
		e->envelope[l] = needed && mpq_sgn(forcing->a) != 0 ? e->envelopes++ : -1;
		e->refresh.phasor[l] = is_refreshed(e->step, l) ? e->refresh.states : -1;
		e->refresh.states += is_refreshed(e->step, l) ? e->system->load[l].columns : 0;
	}
}

static struct emitter emitter_new(FILE *to, const struct step *step, const char *options)
{
	struct emitter e = {
		.to = to, .step = step, .prints = printers_of(step), .model = step->model,
		.system = system_of_outputs(step), .options = options, .name = step->model->name,
		.upper = upper_case(step->model->name), .spelled.own = step->model->name, .spelled.place = "",
		.spelled.degree = step->model->name
	};
	const int columns = step->taylor.expansion ? step->taylor.expansion->columns : 0;
	e.spelled.columns = format(columns ? "%s_STATES + %d" : "%s_STATES", e.upper, columns);
	number_loads(&e);
	for (int i = 0; i < e.system->inputs; i++)
		e.ramps = e.ramps || e.system->input[i].hold;
	e.local = ARRAY(const char *, (size_t)e.system->states);
	e.c = identifiers_of(step->model, e.upper, e.local);
	const int blocks = step->derivatives ? step->derivatives->blocks : 0;
	e.beside = ARRAY(struct emitter, (size_t)blocks + 1);
	for (int b = 0; b < blocks; b++) {
		e.beside[b] = emitter_new(to, step->derivatives->block[b].step, options);
		e.beside[b].is_beside = step->derivatives->apart;
	}
	return e;
}

/* ---- the two texts ---- */

static bool forms_need_math(const struct emitter *e)
{
	const struct model *model = e->model;
	bool math = (model->schedule.selector && reads_of(model, 1, &model->schedule.selector).math) ||
		    reads_of(model, model->spec->tuned.derived, model->params.derived).math;
	for (int i = 0; i < model->outputs; i++) {
		const struct form *left = model->output[i].left;
		math = math || (left && reads_of(written_model(model), 1, &left).math);
	}
	for (int k = 0; k < model->schedule.operators; k++) {
		const struct form *const *left = (const struct form *const *)model->schedule.operator[k].left;
		math = math || reads_of(model, model->remainder.force_columns, left).math;
	}
	for (int i = 0; i < model->contacts.drags; i++) {
		const struct form *const force[] = { model->contacts.drag[i].force, model->contacts.drag[i].rest };
		math = math || reads_of(model, 2, force).math;
	}
	for (int i = 0; i < model->contacts.impacts; i++) {
		const struct form *guard = model->contacts.impact[i].in->guard;
		math = math || (guard && reads_of(model, 1, &guard).math);
	}
	return math;
}

/* A certificate that counts on each product and each sum being rounded: it was found by running this C. */
static void emit_as_written(const struct emitter *e)
{
	const struct choice *choice = e->step->choice;
	if (!choice || !choice->alternative[choice->taken].as_written)
		return;
	say(e, "\n"
	       "/* What is certified counts on sums and products that are each rounded, to the bits of their type. */\n"
	       "#if PL_EXCESS_PRECISION%s\n"
	       "#error \"what is certified needs sums that have the bits of their type: "
	       "on x86 compile it with -msse2 -mfpmath=sse\"\n"
	       "#endif\n"
	       "#if !defined PL_NOT_CONTRACTED && (defined __FP_FAST_FMA || defined __FP_FAST_FMAF || \\\n"
	       "    defined __FMA__ || defined __FMA4__ || defined __ARM_FEATURE_FMA || defined __aarch64__ || \\\n"
	       "    defined _M_ARM64 || defined _M_FP_CONTRACT)\n"
	       "#error \"what is certified needs products that are rounded before they are added: "
	       "compile it and the runtime with -ffp-contract=off, and with -DPL_NOT_CONTRACTED\"\n"
	       "#endif\n", e->model->request.single ? "F" : "");
}

static void emit_includes(const struct emitter *e, bool rhs)
{
	if (!e->model->request.own_math &&
	    (forms_need_math(e) || (rhs && rhs_needs_math(e)) || constraints_need_math(e)))
		say(e, "\n#include <math.h>\n");
	if (e->step->program->compensated || e->step->carried.count)
		say(e, "\n#if PL_EXCESS_PRECISION%s\n"
		       "#error \"two-word arithmetic needs sums that have the bits of their type: "
		       "on x86 compile it with -msse2 -mfpmath=sse\"\n"
		       "#endif\n", e->model->request.single ? "F" : "");
	emit_as_written(e);
}

static void emit_all_tables(const struct emitter *e)
{
	if (e->model->relative)
		emit_conversions(e);
	emit_kept_phi(e);
	emit_mass_matrix(e);
	emit_energies(e);
	emit_load_tables(e);
	emit_refresh_tables(e);
	if (!e->model->params.retuned)
		emit_nominal(e);                /* else with the tables of regions */
	if (loads_change(e->system))
		emit_changes(e);
	emit_if_any(e->prints->tables, e);
	emit_peak_tables(e);
}

/* Everything that moves states, in the order in which it is called */
static void emit_motion_of(const struct emitter *e, bool rhs)
{
	emit_includes(e, rhs);
	emit_flush(e);
	emit_all_tables(e);
	emit_modes(e);
	emit_access(e);
	emit_held_retune(e);
	emit_if_any(e->prints->pass, e);
	if ((e->step->is.flow == FLOW_RECIPE && !e->step->event_split) || reads_force_columns(e->model))
		emit_remainder(e);
	emit_if_any(e->prints->step, e);
	emit_out(e);
	emit_peak_step(e);
	emit_run(e);
}

/* Parts that only some models have: states between steps, many steps at once, the ways to check it */
static void emit_further_functions(const struct emitter *e, bool rhs)
{
	emit_block_list(e);
	if (e->step->series.emitted)
		emit_if_any(e->prints->at, e);
	if (has_jump(e))
		emit_jump(e);
	if (e->model->request.many.batch && !e->model->delays)
		emit_batch(e);
	if (e->model->request.selftest && !e->model->delays)
		emit_selftest(e, has_jump(e));
	if (rhs)
		emit_rhs(e);
}

/* A block of derivatives that goes the way of its own step */
static void emit_model_beside(const struct emitter *e)
{
	emit_motion_of(e, false);
	emit_declared_tables(e);
	if (e->step->series.emitted)
		emit_if_any(e->prints->at, e);
	if (has_jump(e))
		emit_jump(e);
}

static void declare_beside(const struct emitter *e)
{
	if (e->step->derivatives)
		emit_derivative_declarations(e);
	if (e->model->delays)
		emit_delay_declarations(e);
}

void emit_header(FILE *to, const struct step *step, const char *options, bool rhs)
{
	struct emitter e = emitter_new(to, step, options);
	if (rhs)
		check_rhs(&e);
	emit_banner(&e);
	emit_declarations(&e, rhs);
	declare_beside(&e);
}

void emit_device(FILE *to, const struct step *step, const char *options, const char *target)
{
	struct emitter e = emitter_new(to, step, options);
	emit_banner(&e);
	if (!is_whole_on_device(&e)) {
		emit_kernel(&e, target);
		return;
	}
	if (step->model->request.single && (forms_need_math(&e) || constraints_need_math(&e)))
		error(step->model->spec->name_at, "those of double are the runtime's, as with --math own",
		      "--target %s: functions in float have other bits on a device", target);
	emit_if_any(e.prints->events, &e);
	emit_declarations(&e, false);
	if (e.model->delays)
		emit_delay_declarations(&e);
	emit_declared_tables(&e);
	emit_motion_of(&e, false);
	if (e.model->delays && step->series.emitted)
		emit_if_any(e.prints->at, &e);
	if (has_jump(&e))
		emit_jump(&e);
	(e.model->delays ? emit_delays_on_device : emit_whole_kernel)(&e, target);
}

void emit_code(FILE *to, const struct step *step, const char *options, const char *header_name, bool rhs)
{
	struct emitter made = emitter_new(to, step, options), *e = &made;
	if (rhs)
		check_rhs(e);
	emit_banner(e);
	emit_if_any(e->prints->events, e);
	if (header_name)
		say(e, "#include \"%s\"\n", header_name);
	else
		emit_declarations(e, rhs);
	if (!header_name)
		declare_beside(e);
	emit_motion_of(e, rhs);
	emit_declared_tables(e);
	emit_further_functions(e, rhs);
	for (int b = 0; e->step->derivatives && e->step->derivatives->apart && b < e->step->derivatives->blocks; b++)
		emit_model_beside(&e->beside[b]);
	if (e->step->derivatives)
		emit_step_derivatives(e);
	(e->model->delays ? emit_delays : emit_descriptor)(e);
}
