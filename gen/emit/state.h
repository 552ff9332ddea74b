/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The state in emitted code. */
#ifndef PLGEN_EMIT_STATE_H
#define PLGEN_EMIT_STATE_H

#include "text.h"
#include "step/step.h"

struct reads;

/* ---- flows.c: what the C of a step has by its flow and events, in the order of the C ---- */

struct printers {                       /* NULL: none of its own */
	const char *step_note;      /* before what a step costs; NULL: ": " */
	/* Behind that, in the C alone: how an event is found */
	void (*events)(const struct emitter *e);
	/* The header: constants; types before that of the state; at its end; functions */
	void (*constants)(const struct emitter *e);
	void (*types)(const struct emitter *e);
	void (*members)(const struct emitter *e);
	const char *status_note;
	void (*declare_state)(const struct emitter *e); /* of what else the state has */
	bool (*places)(const struct emitter *e);        /* NAME_place(s) finds what follows from a state that was set */
	/* Tables and functions */
	void (*tables)(const struct emitter *e);
	void (*pass)(const struct emitter *e);          /* over what changes at a time */
	void (*step)(const struct emitter *e);
	void (*held)(const struct emitter *e);          /* in at: what is held over the step */
	void (*at)(const struct emitter *e);
};
const struct printers *printers_of(const struct step *step);

/* ---- state.c: the state in emitted code ---- */

const struct expansion *own_expansion(const struct emitter *e);   /* of the step */
const struct truncation *truncation_of(const struct emitter *e);  /* of the model */
bool has_jump(const struct emitter *e);
bool has_peak_rows(const struct emitter *e);                      /* which are found from x */
bool has_ranges(const struct emitter *e);       /* the spec says in which some states stay */
bool keeps_status(const struct emitter *e);
bool tells_tolerance(const struct emitter *e);  /* of its states, as written */
bool has_floors(const struct emitter *e);       /* some states have an absolute tolerance */
bool has_peaks(const struct emitter *e);                          /* some output is the largest size so far */
const char *state_list(const struct model *model);                /* x, x' */
const char *carried_text(const struct emitter *e);                /* the states that only add up */
const struct model *written_model(const struct model *model);      /* over whose coordinates its forms are */
const char *input_name(const struct emitter *e, int input, int order); /* the C name of an input, of its slope */
const char *stepped_table(const struct emitter *e); /* Phi of the states as they are kept */
/* of a velocity that is kept as a momentum; NULL: it is not */
const char *factor_of_momentum(const struct emitter *e, int state);
void emit_locals(const struct emitter *e, const bool *reads);     /* the states wanted, under their names */
/* as kept: of kick-drift-kick, momenta; reads NULL: all */
void emit_raw_locals(const struct emitter *e, const bool *reads);
void emit_locals_of(const struct emitter *e, const bool *reads, const char *vector);
/* of a part, in the model: a state of it, an input; how many states it has; state i in a loop, as text */
int place_of_state(const struct emitter *e, int state);
/* a tunable param, or a lead, in an instance s; */
const char *param_text(const struct emitter *e, int param);
const char *param_local(const struct emitter *e, int param);      /* its C name */
int given_inputs(const struct emitter *e);                        /* samples of a step: without params that act so */
const char *sample_now(const struct emitter *e, int input);       /* of the whole: what a step is given, or a param */
const char *sample_kept(const struct emitter *e, int input);      /* the same between steps */
int place_of_input(const struct emitter *e, int input);
const char *sample_text(const struct emitter *e, int input, int sample); /* a sample that the step has, oldest first */
const char *input_operand(const struct emitter *e, int column);   /* the same, by the columns of all inputs */
const char *own_states(const struct emitter *e);
const char *place_in_loop(const struct emitter *e);
const char *step_length(const struct emitter *e);                 /* NAME_H; of tunable models that of the instance s */
const char *slope_of_samples(const struct emitter *e, const char *to, const char *from); /* samples a step apart */
const char *ramp_slope(const struct emitter *e, int input);       /* of an input that ramps to u over the step */
bool keeps_modes(const struct emitter *e);                         /* normal modes are the state; y is what was set */
bool has_place(const struct emitter *e);                           /* NAME_place */
/* a table of what a step adds: the instance's own, or the model's */
const char *of_step(const struct emitter *e, const char *table);

struct size { const char *name; int value; };
/* Before an algorithm of the runtime is included: its name and what it is for, PL(name), PL_TYPE, PL_H, PL_SINGLE, and
 * PL_... of each size, up to one without a name; emit_sizes: of those listed */
void open_algorithm(const struct emitter *e, const char *algorithm, const struct size *size);
#define emit_sizes(e, algorithm, ...) open_algorithm(e, algorithm, (const struct size[]){ __VA_ARGS__, { NULL, 0 } })

bool has_param_ranges(const struct emitter *e);
bool wraps_retune(const struct emitter *e);      /* NAME_retune is the model's own, and calls NAME_retune_all */
const char *param_list(const struct emitter *e);                  /* names, commas between */
void emit_nominal_params(const struct emitter *e);                /* a member */
void emit_param_locals(const struct emitter *e, const bool *reads); /* of those that forms read: struct reads */
void emit_nominal_params_read(const struct emitter *e, const struct reads *reads); /* the spec's values */

#endif
