/* SPDX-License-Identifier: GPL-3.0-or-later */
/* init, set, get, time, status, hold: what access.h is given of the model. */
#include "declarations.h"
#include "steps.h"
#include "emit/tunable/tunable.h"
#include "step/linear/forms.h"
#include "step/exponential/normal.h"
#include "step/linear/rows.h"

static void emit_initial(const struct emitter *e, const char *name, const struct model *model)
{
	double *value = ARRAY(double, (size_t)e->system->states);
	for (int i = 0; i < e->system->states; i++)
		value[i] = round_rational(model->initial[i]);
	emit_array(e, format("Initial state: %s", state_list(model)), name, 1, &e->system->states, value, NULL);
}

static void emit_masses(const struct emitter *e)
{
	double *value = ARRAY(double, (size_t)e->system->states);
	for (int i = 0; i < e->system->states; i++)
		value[i] = i < e->model->n ? 1 : finite_number(e, e->step->linear.kicks.mass[e->system->coord[i]]);
	emit_array(e, "Velocities are kept times these", "mass", 1, &e->system->states, value, NULL);
}

static void emit_ranges(const struct emitter *e)
{
	const struct model *written = e->model->written;
	const int count = written->ranges;
	int *state = ARRAY(int, (size_t)count);
	double *value = ARRAY(double, 2 * (size_t)count);
	for (int i = 0; i < count; i++) {
		state[i] = written->range[i].state;
		value[2 * i] = round_rational(written->range[i].low);
		value[2 * i + 1] = round_rational(written->range[i].high);
	}
	emit_array(e, "Ranges of states", "range", 2, (const int[]){ count, 2 }, value, NULL);
	emit_int_list(e, "range_state", count, state);
}

/* Growths that are negative, and how many samples around now each input is kept of */
static void emit_flags(const struct emitter *e)
{
	int *list = ARRAY(int, (size_t)(e->envelopes + e->system->inputs));
	for (int l = 0; l < e->system->loads; l++)
		if (e->envelope[l] >= 0)
			list[e->envelope[l]] = mpq_sgn(e->system->load[l].forcing->a) < 0;
	if (e->envelopes)
		emit_integers(e, "unsigned char", "falls", e->envelopes, list);
	for (int i = 0; i < e->system->inputs; i++)
		list[i] = e->system->input[i].hold;
	if (most_samples_before(e))
		emit_integers(e, "unsigned char", "past_samples", e->system->inputs, list);
}

/* k h: of the spec's step p/q, with p and q exact, it is one rounding away from the exact time while k p < 2^53. */
static const char *elapsed_text(const struct emitter *e)
{
	mpz_srcptr p = mpq_numref(e->model->h), q = mpq_denref(e->model->h);
	size_t bits = mpz_sizeinbase(p, 2), divisor_bits = mpz_sizeinbase(q, 2);
	bool single = e->model->request.single;
	bool short_fraction = bits <= (single ? 12 : 40) && divisor_bits <= (single ? 24 : 53);
	if (e->step->is.tuned || !short_fraction)
		return format("(double)s->k * %s", step_length(e));
	const char *factor = mpz_cmp_ui(p, 1) == 0 ? "" : format(" * %s", shortest(mpz_get_d(p)));
	const char *divisor = mpz_cmp_ui(q, 1) == 0 ? "" : format(" / %s", shortest(mpz_get_d(q)));
	return format("(double)s->k%s%s", factor, divisor);
}

static void emit_tables(const struct emitter *e)
{
	emit_initial(e, "initial", e->model);
	if (e->model->relative)
		emit_initial(e, "initial_set", e->model->written);
	if (e->step->linear.kicks.momenta)
		emit_masses(e);
	if (has_ranges(e))
		emit_ranges(e);
	emit_flags(e);
	if (e->step->forced)
		emit_forced(e);
}

void emit_access(const struct emitter *e)
{
	const struct step *step = e->step;
	emit_tables(e);
	emit_sizes(e, "access.h", { "STATES", e->system->states }, { "INPUTS", given_inputs(e) },
		   { "MODAL", step->modal != NULL },
		   { "NORMAL", keeps_modes(e) ? step->normal->modes : 0 }, { "MOMENTA", step->linear.kicks.momenta },
		   { "FORCED", step->forced != NULL },
		   { "WHOLE", step->forced && e->model->relative && !rows_sustained(step) },
		   { "COMPENSATED", step->program->compensated },
		   { "CARRIES", step->carried.count }, { "RELATIVE", e->model->relative != NULL },
		   { "PHASES", e->phases },
		   { "ENVELOPES", e->envelopes }, { "LEADS", held_leads(e) }, { "PEAKS", peak_outputs(e->model) },
		   { "BY_VALUES", peaks_by_values(e->step) },
		   { "REFRESHED", step->refresh != NULL }, { "SEGMENTS", e->system->segments },
		   { "STATUS", keeps_status(e) }, { "RANGES", e->model->written->ranges }, { "PLACES", has_place(e) },
		   { "MASSES", moving_masses(e) }, { "INDEFINITE", may_be_singular(e) },
		   { "SAMPLED", may_be_singular(e) && !tells_tolerance(e) },
		   { "FAILS", steps_may_fail(e) }, { "CONSERVES", holds_energy(e) },
		   { "OWN", e->model->params.held || e->step->is.tuned }, { "RAMPS", e->ramps },
		   { "PAST_SAMPLES", most_samples_before(e) });
	say_macro(e, "ELAPSED", elapsed_text(e));
	if (step->forced && step->forced->written) {
		say_macro(e, "COLUMNS", integer_text(step->branch->full->columns));
		say_macro(e, "SUSTAINED", spell(e, loads_change(e->system) ? "$n_forced_part[s->segment]"
									   : "$n_forced_part[0]"));
	}
	if (e->phases)
		say_macro(e, "PHASE_RATE", phase_rate_text(e));
	say_include(e, "access.h");
}
