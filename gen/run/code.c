/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Generated C that runs: a text, its functions, an instance of its model. */
#include "run/run.h"

#include <stdlib.h>
#include <string.h>

static void read_text(struct code *c, const char *text)
{
	c->lexemes = lexemes_of(c->at, text);
	c->here = 0;
	read_outside(c);
	c->outside = c->newest;
}

/* The text has to be one that the emitters wrote. */
static struct code *code_of_text(struct place at, const char *text)
{
	struct code *c = NEW(struct code);
	*c = (struct code){ .at = at, .constant = read_constant, .body = read_body };
	read_text(c, library_types);
	read_text(c, text);
	return c;
}

struct printed { const struct step *step; char *text; size_t length; };

/* Another text made of one, which is freed */
static char *rewritten(char *text, void (*print)(FILE *to, const char *text))
{
	char *other = NULL;
	size_t length = 0;
	FILE *to = open_memstream(&other, &length);
	need_memory(to);
	print(to, need_memory(text));
	fclose(to);
	free(text);
	return need_memory(other);
}

static char *text_of_step(const struct step *step, bool rhs)
{
	char *text = NULL;
	size_t length = 0;
	FILE *to = open_memstream(&text, &length);
	need_memory(to);
	emit_code(to, step, "", NULL, rhs);
	fclose(to);
	text = rewritten(text, print_included);
	return step->model->asked.single ? rewritten(text, print_single) : text;
}

struct code *code_of_step(struct place at, const struct step *step, bool rhs)
{
	char *text = text_of_step(step, rhs);
	struct code *c = code_of_text(at, text);
	free(text);
	return c;
}

/* ---- an instance ---- */

enum part { INIT, SET, STEP, GET, TIME, OUT, STATUS, RHS, HOLD, PARTS };
struct running {
	struct code *code;
	const struct step *step;
	int states, inputs, outputs;
	bool single;
	void *instance;
	struct entity *part[PARTS];
	void *y, *u, *out, *slope;  /* of the target's type */
};

static struct entity *compiled(struct running *r, const char *name)
{
	struct entity *e = entity_find(r->code, format("%s_%s", r->step->model->name, name));
	if (!e || e->kind != ENTITY_FUNCTION || !e->body)
		return NULL;
	if (!e->act)
		e->act = r->code->body(r->code, e);
	return e;
}

struct running *running_new(struct code *code, const struct step *step)
{
	static const char *const names[PARTS] = { "init", "set", "step", "get", "time", "out", "status", "rhs",
						  "hold" };
	const struct model *model = step->model;
	struct running *r = NEW(struct running);
	const struct entity *type = entity_find(code, model->name);
	*r = (struct running){ .code = code, .step = step, .states = model->written->system.states,
			       .inputs = model->system.inputs, .outputs = model->outputs,
			       .single = model->asked.single };
	if (!type || type->kind != ENTITY_TYPE)
		not_run(code, "no type of the model");
	r->instance = allocate(1, type->type->size);
	for (int i = 0; i < PARTS; i++)
		r->part[i] = compiled(r, names[i]);
	discard(code->lexemes.list);
	code->lexemes = (struct lexemes){ 0 };
	r->y = ARRAY(double, (size_t)r->states + 1);
	r->u = ARRAY(double, 2 * (size_t)r->inputs + 1);
	r->out = ARRAY(double, (size_t)r->outputs + 1);
	r->slope = ARRAY(double, (size_t)r->states + 1);
	return r;
}

const struct step *running_step_of(const struct running *r)
{
	return r->step;
}

static void to_target(const struct running *r, const double *from, void *to, int count)
{
	for (int i = 0; i < count; i++) {
		if (r->single)
			((float *)to)[i] = (float)from[i];
		else
			((double *)to)[i] = from[i];
	}
}

static void from_target(const struct running *r, const void *from, double *to, int count)
{
	for (int i = 0; i < count; i++)
		to[i] = r->single ? (double)((const float *)from)[i] : ((const double *)from)[i];
}

/* Calls it: arguments by the types of its parameters */
static struct entity *call_part(struct running *r, enum part part, int arguments, void *const *argument, double time)
{
	struct entity *e = r->part[part];
	if (!e || e->parameters != arguments)
		not_run(r->code, format("%s_... number %d", r->step->model->name, part));
	for (int i = 0; i < arguments; i++) {
		const struct ctype *type = e->parameter[i]->type;
		void *to = e->parameter[i]->at;
		if (type->kind == CTYPE_POINTER)
			*(void **)to = argument[i];
		else if (type->size == sizeof(float))
			*(float *)to = (float)time;
		else
			*(double *)to = time;
	}
	e->act->go.act(e->act);
	return e;
}

void running_start(struct running *r, double t, const double *y)
{
	if (!y) {
		call_part(r, INIT, 1, (void *[]){ r->instance }, 0);
		return;
	}
	to_target(r, y, r->y, r->states);
	call_part(r, SET, 3, (void *[]){ r->instance, NULL, r->y }, t);
}

void running_step(struct running *r, const double *u)
{
	if (r->inputs > 0)
		to_target(r, u, r->u, r->inputs);
	call_part(r, STEP, r->inputs > 0 ? 2 : 1, (void *[]){ r->instance, r->u }, 0);
}

/* The samples of the step before k, and the last one */
void running_drive(struct running *r, const struct sampled *d, long k)
{
	double *u = ARRAY(double, 2 * (size_t)r->inputs + 1);
	drive_at(d, k > 0 ? k - 1 : 0, d->h * (double)(k > 0 ? k - 1 : 0), u);
	to_target(r, u, r->u, r->inputs);
	if (r->part[HOLD])
		call_part(r, HOLD, 2, (void *[]){ r->instance, r->u }, 0);
	if (k > 0) {
		drive_step(d, k - 1, u);
		running_step(r, u);
	}
	discard(u);
}

void running_state(struct running *r, double *y)
{
	call_part(r, GET, 2, (void *[]){ r->instance, r->y }, 0);
	from_target(r, r->y, y, r->states);
}

void running_outputs(struct running *r, double *out)
{
	call_part(r, OUT, 2, (void *[]){ r->instance, r->out }, 0);
	from_target(r, r->out, out, r->outputs);
}

static double number_at(const struct entity *e)
{
	return e->type->kind == CTYPE_WHOLE	    ? (double)*(const int *)e->result
	       : e->type->size == sizeof(float) ? (double)*(const float *)e->result
						: *(const double *)e->result;
}

double running_time(struct running *r)
{
	return number_at(call_part(r, TIME, 1, (void *[]){ r->instance }, 0));
}

int running_status(struct running *r)
{
	return (int)number_at(call_part(r, STATUS, 1, (void *[]){ r->instance }, 0));
}

void running_rhs(struct running *r, double t, const double *y, const double *u, double *slope)
{
	to_target(r, y, r->y, r->states);
	if (r->inputs > 0) {
		to_target(r, u, r->u, 2 * r->inputs);
		call_part(r, RHS, 4, (void *[]){ NULL, r->y, r->u, r->slope }, t);
	} else {
		call_part(r, RHS, 3, (void *[]){ NULL, r->y, r->slope }, t);
	}
	from_target(r, r->slope, slope, r->states);
}
