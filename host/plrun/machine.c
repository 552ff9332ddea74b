/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A loaded model. Its numbers go in and out as doubles: those of a model in float are floats, which a double holds. */
#define _GNU_SOURCE
#include "plrun.h"

#include <dlfcn.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What any descriptor begins with */
struct head {
	int version, real_size;
};

static char *check_head(const struct head *head, const char *path)
{
	if (head->version != PL_MODEL_VERSION)
		return format("%s: its descriptor has version %d, and this plrun reads version %d", path, head->version,
			      PL_MODEL_VERSION);
	if (head->real_size != (int)sizeof(double) && head->real_size != (int)sizeof(float))
		return format("%s: its numbers have %d bytes, which are neither float nor double", path,
			      head->real_size);
	return NULL;
}

static double *widened(const float *value, int count)
{
	double *wide = need(malloc(sizeof *wide * (size_t)(count + 1)));
	for (int i = 0; i < count; i++)
		wide[i] = (double)value[i];
	return wide;
}

#define FILL(m, d) do { \
	(m)->name = (d)->name; \
	(m)->size = (d)->size; \
	(m)->states = (d)->states; \
	(m)->inputs = (d)->inputs; \
	(m)->outputs = (m)->plain_outputs = (m)->own_outputs = (d)->outputs; \
	(m)->params = (d)->params; \
	(m)->h = (double)(d)->h; \
	(m)->input_names = (d)->input_names; \
	(m)->output_names = (d)->output_names; \
	(m)->state_names = (d)->state_names; \
	(m)->param_names = (d)->param_names; \
	(m)->ahead = (d)->start_samples; \
	(m)->has_status = (d)->status != NULL; \
} while (0)

static void fill(struct machine *m)
{
	if (m->single)
		FILL(m, m->modelf);
	else
		FILL(m, m->model);
	m->param_values = m->single ? widened(m->modelf->param_values, m->params)
				    : need(malloc(sizeof(double) * (size_t)(m->params + 1)));
	if (!m->single && m->params)
		memcpy(m->param_values, m->model->param_values, sizeof(double) * (size_t)m->params);
	for (int i = 0; i < m->inputs; i++)
		if (m->ahead[i] > m->most_ahead)
			m->most_ahead = m->ahead[i];
}

static void *find(const struct machine *m, const char *name, const char *what)
{
	char *symbol = format("%s_%s", name, what);
	void *found = dlsym(m->object, symbol);
	free(symbol);
	return found;
}

/* Behind the outputs the derivatives of each: dx/dk, dx/dc, dv/dk, dv/dc */
static void name_derivatives(struct machine *m)
{
	const int columns = m->single ? m->derivativesf->columns : m->derivatives->columns, plain = m->plain_outputs;
	const char *const *by = m->single ? m->derivativesf->names : m->derivatives->names;
	const char **name = need(calloc((size_t)(plain * (1 + columns)) + 1, sizeof *name));
	for (int i = 0; i < plain; i++)
		name[i] = m->output_names[i];
	for (int i = 0; i < plain * columns; i++)
		name[plain + i] = format("d%s/d%s", m->output_names[i / columns], by[i % columns]);
	m->output_names = name;
	m->outputs = m->own_outputs = plain * (1 + columns);
}

/* Whether an instance takes another step; what reads tunable params alone has one step, and refuses */
static bool takes_steps(const struct machine *m)
{
	if (m->single ? m->modelf->retune == NULL : m->model->retune == NULL)
		return false;
	struct instance *i = instance_new(m);
	const bool takes = instance_retune(i, m->param_values, 0.5 * m->h) == NULL;
	instance_free(i);
	return takes;
}

/* NULL: *error */
static struct machine *machine_open(const char *path, const char *name, char **error)
{
	struct machine *m = need(calloc(1, sizeof *m));
	char *symbol = format("%s_model", name);
	*error = NULL;
	m->object = dlopen(path, RTLD_NOW | RTLD_LOCAL);
	const void *descriptor = m->object ? dlsym(m->object, symbol) : NULL;
	free(symbol);
	if (!descriptor)
		*error = format("cannot load what was compiled: %s", dlerror());
	else
		*error = check_head(descriptor, path);
	if (*error) {
		machine_close(m);
		return NULL;
	}
	void *allowed = find(m, name, "allowed");
	memcpy(&m->allowed, &allowed, sizeof allowed);
	memcpy(&m->allowedf, &allowed, sizeof allowed);
	m->many = find(m, name, "many");
	m->manyf = (const void *)m->many;
	void *crossed = find(m, name, "crossed");
	memcpy(&m->crossed, &crossed, sizeof crossed);
	m->units = find(m, name, "units");
	m->derivatives = find(m, name, "derivatives");
	m->derivativesf = (const void *)m->derivatives;
	m->single = ((const struct head *)descriptor)->real_size == (int)sizeof(float);
	m->model = descriptor;
	m->modelf = descriptor;
	fill(m);
	if (m->derivatives)
		name_derivatives(m);
	m->can_retune = takes_steps(m);
	return m;
}

struct machine *machine_of(const struct toolchain *t, const struct code *c, char **error)
{
	struct machine *m = NULL;
	for (int attempt = 0; !m && attempt < 2; attempt++) {   /* what a crash has left is made anew */
		char *object = compile(t, c, attempt > 0, error);
		m = object ? machine_open(object, c->name, error) : NULL;
		free(object);
	}
	return m;
}

void machine_close(struct machine *m)
{
	if (m->object)
		dlclose(m->object);
	kernel_free(m->kernel);
	free(m->param_values);
	free(m);
}

void machine_show(struct machine *m, const struct view *v, const struct options *o)
{
	m->view = v;
	m->shown = o->show ? v->source : NULL;
	m->outputs = v->columns;
	m->output_names = o->units ? v->label : v->name;
}

/* 25 mm are 25/1000 m, rounded once. */
double param_value(const struct machine *m, int param, double value)
{
	double factor;
	if (!m->units || !m->units->param_factor || !read_number(m->units->param_factor[param], &factor))
		return value;
	const double per = factor < 1 ? round(1 / factor) : 0;
	return per > 1 && per * factor == 1 ? value / per : value * factor;
}

/* ---- an instance ---- */

static void begin_derivatives(struct instance *i)
{
	const struct machine *m = i->machine;
	i->derivatives = need(calloc(1, m->single ? m->derivativesf->size : m->derivatives->size));
	i->seed = need(calloc((size_t)m->inputs + 1, sizeof *i->seed));
	for (int k = 0; k < m->inputs; k++)
		if (m->single)
			((float *)i->seed)[k] = 1;
		else
			i->seed[k] = 1;
	if (m->single)
		m->derivativesf->init(i->state, i->derivatives);
	else
		m->derivatives->init(i->state, i->derivatives);
	if (m->single && m->derivativesf->hold)
		m->derivativesf->hold(i->derivatives, (const float *)i->seed);
	if (!m->single && m->derivatives->hold)
		m->derivatives->hold(i->derivatives, i->seed);
}

struct instance *instance_new(const struct machine *m)
{
	struct instance *i = need(calloc(1, sizeof *i));
	int most = m->inputs > m->own_outputs ? m->inputs : m->own_outputs;
	most = m->states > most ? m->states : most;
	i->machine = m;
	i->state = need(calloc(1, m->size));
	i->all = need(calloc((size_t)(m->own_outputs + m->states) + 1, sizeof *i->all));
	most = most > m->params ? most : m->params;
	if (m->single)
		i->narrow = need(calloc((size_t)most + STEPS_AT_ONCE * (size_t)(m->inputs + m->own_outputs) + 1,
					sizeof(float)));
	if (m->derivatives)
		begin_derivatives(i);
	else if (m->single)
		m->modelf->init(i->state);
	else
		m->model->init(i->state);
	return i;
}

void instance_free(struct instance *i)
{
	free(i->state);
	free(i->derivatives);
	free(i->seed);
	free(i->narrow);
	free(i->all);
	free(i);
}

static const float *narrowed(struct instance *i, const double *value, int count)
{
	for (int k = 0; k < count; k++)
		i->narrow[k] = (float)value[k];
	return i->narrow;
}

const char *instance_retune(struct instance *i, const double *params, double h)
{
	const struct machine *m = i->machine;
	int status = m->single ? m->modelf->retune(i->state, narrowed(i, params, m->params), (float)h)
			       : m->model->retune(i->state, params, h);
	return status == 0 ? NULL
	     : status == PL_NO_STEP ? "the step is not above 0"
	     : status == PL_NO_RATE ? "with these values a load's frequency is below 0"
	     : status == PL_OUT_OF_RANGE && !m->crossed ? "outside of the range that the spec gives"
	     : status == PL_OUT_OF_RANGE
	     ? "these values are outside of the ranges that the spec gives, or make other regions: a restitution not "
	       "within 0 and 1, a gap or a force of friction below 0, breakpoints in another order"
	     : status == PL_SINGULAR ? "with these values the mass matrix has no inverse"
	     : "with these values the numbers of the step are not finite";
}

void instance_hold(struct instance *i, const double *u)
{
	const struct machine *m = i->machine;
	if (m->single)
		m->modelf->hold(i->state, narrowed(i, u, m->inputs));
	else
		m->model->hold(i->state, u);
}

void instance_step(struct instance *i, const double *u)
{
	const struct machine *m = i->machine;
	const float *narrow = m->single && m->inputs ? narrowed(i, u, m->inputs) : NULL;
	if (m->derivatives && m->single)
		m->derivativesf->step(i->state, i->derivatives, narrow, (const float *)i->seed);
	else if (m->derivatives)
		m->derivatives->step(i->state, i->derivatives, m->inputs ? u : NULL, i->seed);
	else if (m->single)
		m->modelf->step(i->state, narrow);
	else
		m->model->step(i->state, m->inputs ? u : NULL);
}

void instance_run(struct instance *i, size_t n, const double *u, double *out)
{
	const struct machine *m = i->machine;
	if (!m->single) {
		m->model->run(i->state, n, m->inputs ? u : NULL, out);
		return;
	}
	const size_t inputs = n * (size_t)m->inputs, outputs = n * (size_t)m->outputs;
	m->modelf->run(i->state, n, m->inputs ? narrowed(i, u, (int)inputs) : NULL, i->narrow + inputs);
	for (size_t k = 0; k < outputs; k++)
		out[k] = (double)i->narrow[inputs + k];
}

void instance_jump(struct instance *i, uint64_t n)
{
	const struct machine *m = i->machine;
	if (m->single)
		m->modelf->jump(i->state, n);
	else
		m->model->jump(i->state, n);
}

static void own_out(struct instance *i, double *out)
{
	const struct machine *m = i->machine;
	if (!m->single) {
		m->model->out(i->state, out);
		if (m->derivatives)
			m->derivatives->out(i->state, i->derivatives, out + m->plain_outputs);
		return;
	}
	m->modelf->out(i->state, i->narrow);
	if (m->derivatives)
		m->derivativesf->out(i->state, i->derivatives, i->narrow + m->plain_outputs);
	for (int k = 0; k < m->own_outputs; k++)
		out[k] = (double)i->narrow[k];
}

void instance_out(struct instance *i, double *out)
{
	const struct machine *m = i->machine;
	own_out(i, m->shown ? i->all : out);
	if (!m->shown)
		return;
	instance_get(i, i->all + m->own_outputs);
	for (int k = 0; k < m->outputs; k++)
		out[k] = i->all[m->shown[k]];
}

void instance_get(struct instance *i, double *y)
{
	const struct machine *m = i->machine;
	if (!m->single) {
		m->model->get(i->state, y);
		return;
	}
	m->modelf->get(i->state, i->narrow);
	for (int k = 0; k < m->states; k++)
		y[k] = (double)i->narrow[k];
}

void instance_allowed(struct instance *i, double *y)
{
	const struct machine *m = i->machine;
	if (!m->single) {
		m->allowed(i->state, y);
		return;
	}
	m->allowedf(i->state, i->narrow);
	for (int k = 0; k < m->states; k++)
		y[k] = (double)i->narrow[k];
}

int instance_status(const struct instance *i)
{
	const struct machine *m = i->machine;
	return !m->has_status ? 0 : m->single ? m->modelf->status(i->state) : m->model->status(i->state);
}

unsigned instance_doubt(const struct instance *i)
{
	const struct machine *m = i->machine;
	return !m->derivatives ? 0 : m->single ? m->derivativesf->status(i->derivatives)
					       : m->derivatives->status(i->derivatives);
}

int instance_first_doubt(const struct instance *i, int bit, double *time)
{
	const struct machine *m = i->machine;
	if (m->single) {
		*time = (double)m->derivativesf->doubt(i->derivatives)->time[bit];
		return m->derivativesf->doubt(i->derivatives)->function[bit];
	}
	*time = m->derivatives->doubt(i->derivatives)->time[bit];
	return m->derivatives->doubt(i->derivatives)->function[bit];
}

double instance_time(const struct instance *i)
{
	const struct machine *m = i->machine;
	return m->single ? (double)m->modelf->time(i->state) : m->model->time(i->state);
}

void instance_move(struct instance *i, const double *offset)
{
	const struct machine *m = i->machine;
	double *y = need(calloc((size_t)m->states + 1, sizeof *y));
	instance_get(i, y);
	for (int k = 0; k < m->states; k++)
		y[k] += offset[k];
	if (m->single)
		m->modelf->set(i->state, 0, narrowed(i, y, m->states));
	else
		m->model->set(i->state, 0, y);
	free(y);
}
