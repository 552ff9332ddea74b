/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a header has: the struct of the state, the functions. */
#include "declarations.h"
#include "steps.h"
#include "emit/tunable/tunable.h"
#include "model/contacts/contacts.h"
#include "step/cost.h"

/* One declaration, its comment at a common column. */
void announce(const struct emitter *e, const char *text, const char *comment)
{
	if (*comment)
		say(e, "%-76s  /* %s */\n", text, comment);
	else
		say(e, "%s\n", text);
}

static void emit_state_struct(const struct emitter *e)
{
	const char *first = e->model->names.coord[0];
	const char *momenta = e->step->linear.kicks.momenta ? format("; velocities times mass / mass of %s", first)
							    : "";
	say(e, "typedef struct $n $n;  /* copy it to save, assign it to restore */\n"
	       "struct $n {\n"
	       "    double y[$N_STATES];  /* %s%s%s */\n",
	    e->step->modal ? "modes" : keeps_modes(e) ? "at the last set" : state_list(e->model), momenta,
	       e->step->forced ? "; less their forced part" : "");
	if (e->step->modal)
		say(e, "    double set[$N_STATES];  /* at the last set: %s */\n", state_list(e->model));
	if (e->step->program->compensated)
		say(e, "    double low[$N_STATES];  /* low parts of y: accumulated rounding errors */\n");
	if (e->step->carried.count)
		say(e, "    double carry[%d];      /* low part of %s: accumulated rounding errors */\n",
		    e->step->carried.count, carried_text(e));
	if (e->step->forced && !e->step->program->compensated && !e->model->relative)
		say(e, "    double low[$N_STATES];  /* low parts of y at the last set */\n");
	if (e->model->relative)
		say(e, "    double set[$N_STATES], from[$N_STATES];  "
		       "/* at the last set: the states as written, and as they are kept */\n");
	if (e->step->forced && e->model->relative)
		say(e, "    double start[$N_STATES];  /* what loads sustained of the states as written then */\n");
	if (e->step->is.tuned)
		say(e, "    $n_coeffs coeffs;    /* coefficients of this instance */\n");
	emit_held_member(e);
	if (given_inputs(e))
		say(e, "    double u[$N_INPUTS];  /* the %s */\n",
		    most_samples_before(e) ? "sample now" : "last sample");
	if (most_samples_before(e))
		say(e, "    double past[$N_INPUTS][%d];  /* samples before the next: those at and around now */\n",
		    most_samples_before(e));
	if (e->ramps)
		say(e, "    double slope[$N_INPUTS];  /* of the inputs over the last step [1/s] */\n");
	emit_load_members(e);
	emit_refresh_members(e);
	if (loads_change(e->system))
		say(e, "    int segment;          /* of time: how many changes of the loads are past */\n");
	say(e, "    double t0;            /* [s]; time is t0 + k h */\n"
	       "    uint64_t k;           /* steps since then */\n");
	emit_if_any(e->prints->members, e);
	emit_peak_members(e);
	emit_mass_members(e);
	if (keeps_status(e))
		say(e, "    int status;           /* 0 or PL_... bits of plrt.h, which stay until init or set */\n");
	say(e, "};\n\n");
}

void declare_reading(const struct emitter *e, const char *status_note)
{
	announce(e, spell(e, "void   $n_get(const $n *s, double y[$N_STATES]);"), "");
	announce(e, spell(e, "double $n_time(const $n *s);"), "[s]");
	announce(e, spell(e, "int    $n_status(const $n *s);"), status_note);
}

static void declare_state_functions(const struct emitter *e)
{
	announce(e, spell(e, "void   $n_init($n *s);"), e->step->is.tuned
		? "first: t = 0, the spec's initial values and coefficients" : "t = 0, the spec's initial values");
	announce(e, spell(e, "void   $n_set($n *s, double t, const double y[$N_STATES]);"),
		"any state at any time [s]");
	const char *note = e->model->switching && has_events(e->model->switching)
			? "0, or bits: PL_NOT_FINITE, PL_TOO_MANY_EVENTS, PL_UNDECIDED, PL_PENETRATED"
			: e->prints->status_note;
	declare_reading(e, has_ranges(e) ? "0, or PL_... bits (plrt.h): PL_LEFT_RANGE among them" : note);
	emit_if_any(e->prints->declare_state, e);
	if (e->ramps)
		announce(e, spell(e, "void   $n_hold($n *s, const double u[$N_INPUTS]);"),
			most_samples_before(e) ? "the next sample, no step" : "the sample before the first step");
}

void declare_driven_step(const struct emitter *e, const char *note)
{
	announce(e, spell(e, "void   $n_step($n *s, const double u[$N_INPUTS]);"), note);
	announce(e, spell(e, "void   $n_out(const $n *s, double out[$N_OUTPUTS]);"), "outputs now");
	announce(e, spell(e, "void   $n_run($n *s, size_t n, const double *u, double *out);"),
		"n steps, n rows of u; out: n rows, or NULL");
	if (e->step->series.emitted)
		announce(e, spell(e, "void   $n_at(const $n *s, const double u[$N_INPUTS], "
				    "double tau, double y[$N_STATES]);"), "tau after now, 0 <= tau <= h");
}

static void declare_free_step(const struct emitter *e)
{
	announce(e, spell(e, "void   $n_step($n *s);"), "one step of h");
	announce(e, spell(e, "void   $n_out(const $n *s, double out[$N_OUTPUTS]);"), "outputs now");
	announce(e, spell(e, "void   $n_run($n *s, size_t n, double *out);"),
		"n steps; out: n rows of outputs, or NULL");
	if (e->step->series.emitted)
		announce(e, spell(e, "void   $n_at(const $n *s, double tau, double y[$N_STATES]);"),
			"tau after now, 0 <= tau <= h");
}

static void declare_checks(const struct emitter *e, bool rhs)
{
	const char *note = e->ramps ? "as written; u: inputs, then their slopes" : "the equations as written";
	if (e->model->reduction.place)
		note = format("as written; y: all %d written states", e->model->written->system.states);
	if (rhs)
		announce(e, spell(e, "void   $n_rhs(double t, const double y[], %sdouble dydt[]);",
				 given_inputs(e) ? "const double u[], " : ""), note);
	if (!e->model->delays)
		declare_selftest(e);
}

void declare_selftest(const struct emitter *e)
{
	if (e->model->request.selftest)
		announce(e, spell(e, "double $n_selftest(void);"),
			 format("largest deviation from %s, in units in the last place", e->step->replayed
				? "the same steps where this was made" : "the closed form"));
}

void declare_model(const struct emitter *e)
{
	announce(e, spell(e, "extern const pl_model $n_model;"), "");
	if (e->model->spec->units.written)
		announce(e, spell(e, "extern const pl_units $n_units;"), "");
}

static void declare_tables(const struct emitter *e)
{
	if (!e->step->shown->no.phi)
		announce(e, spell(e, "extern const double $n_Phi[$N_STATES][$N_STATES];"), "y(t+h) = Phi y(t) + ...");
	if (given_inputs(e) && !e->step->shown->no.phi)
		announce(e, spell(e, "extern const double $n_Gamma[$N_STATES][%d];", input_columns(e->system)),
			most_samples_before(e) ? "... + Gamma u; of an input: its samples around the step" :
			e->ramps ? "... + Gamma u; of a ramp: before, after" : "... + Gamma u");
	if (e->model->reduction.truncated) {
		const int all = e->model->written->system.states;
		announce(e, spell(e, "extern const double $n_project[$N_STATES][%d];", all),
			"y = project x, x: a state of all modes");
		announce(e, spell(e, "extern const double $n_expand[%d][$N_STATES];", all),
			"x = expand y, without what is dropped");
		say(e, "#define $n_from_whole $n_project\n"      /* the names that both had before */
		       "#define $n_to_whole $n_expand\n");
	}
	if (!e->model->delays && !e->is_beside)
		declare_model(e);
	if (tells_tolerance(e) && !e->is_beside)
		announce(e, spell(e, "void   $n_allowed(const $n *s, double y[$N_STATES]);"),
			"error that a step may make in each state; 0: the absolute tolerance alone counts");
}

/* In which order they are called, and what fails how */
static void explain_functions(const struct emitter *e)
{
	const bool jumps = has_jump(e), between = e->step->series.emitted;
	const char *text = "First $n_init, or $n_set after it for another state; then $n_step for each h, or $n_run "
			   "for many. $n_get, $n_out%s read the state and change nothing%s. No function allocates, "
			   "waits or ends the program; what goes wrong is in $n_status, which is 0 while all is "
			   "well%s.";
	say_comment(e, "", spell(e, text, between ? spell(e, ", $n_at") : "",
				 jumps ? spell(e, "; $n_jump is many steps at once, without outputs between") : "",
				 keeps_status(e) ? " and keeps its bits until the next init or set" : ""));
}

static void emit_functions(const struct emitter *e, bool rhs)
{
	if (!e->is_beside)
		explain_functions(e);
	declare_state_functions(e);
	if (given_inputs(e))
		declare_driven_step(e, most_samples_before(e) ? "one step of h; u: the next sample"
				       : e->ramps	   ? "one step of h; a ramp ends at u"
							   : "one step of h with u held");
	else
		declare_free_step(e);
	if (has_jump(e))
		announce(e, spell(e, "void   $n_jump($n *s, uint64_t n);"), "as n steps would, in log n time");
	emit_held_declarations(e);
	if (e->model->request.many.device)
		return;
	if (e->model->request.many.batch && !e->model->delays)
		emit_batch_declarations(e);
	declare_checks(e, rhs);
	declare_tables(e);
}

void open_declarations(const struct emitter *e, const char *guard, const char *included)
{
	say(e, "#ifndef %s_DECLARED\n"
	       "#define %s_DECLARED\n"
	       "\n%s"
	       "#ifdef __cplusplus\n"
	       "extern \"C\" {\n"
	       "#endif\n\n", guard, guard, included);
}

void close_declarations(const struct emitter *e)
{
	say(e, "\n#ifdef __cplusplus\n"
	       "}\n"
	       "#endif\n"
	       "\n#endif\n");
}

void emit_counts(const struct emitter *e, int inputs)
{
	say(e, "enum { $N_STATES = %d, $N_INPUTS = %d, $N_OUTPUTS = %d };\n", e->system->states, inputs,
	    e->model->outputs);
}

/* The bound of the target that the C is compiled for */
static void emit_worst(const struct emitter *e)
{
	static const char *const condition[] = { "elif defined __arm__", "elif defined __arm__ && defined __ARM_FP",
						 "if defined __arm__ && defined __ARM_FP && (__ARM_FP & 8)" };
	if (unbounded_text(e->step))
		return;
	say(e, "/* Bound on the instructions of a step by arm-none-eabi-gcc -O2, while no number is subnormal */\n");
	for (int t = 2; t >= 0; t--)
		say(e, "#%s\n"
		       "#define $N_STEP_MAX %.0f  /* %s */\n",
		    condition[t], worst_of_step(e->step, t, e->model->request.single), worst_target(t));
	say(e, "#endif\n\n");
}

void emit_declarations(const struct emitter *e, bool rhs)
{
	open_declarations(e, e->upper, e->model->request.single ? "#define PL_FLOAT_ONLY\n#include \"plrt.h\"\n\n"
						    : "#include \"plrt.h\"\n\n");
	emit_counts(e, given_inputs(e));
	emit_if_any(e->prints->constants, e);
	emit_index_names(e);
	say(e, "#define $N_H %s  /* step [s] */\n\n", shortest(round_rational(e->model->h)));
	emit_worst(e);
	emit_if_any(e->prints->types, e);
	emit_held_types(e);
	emit_state_struct(e);
	emit_functions(e, rhs);
	close_declarations(e);
}
