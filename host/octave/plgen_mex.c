/* SPDX-License-Identifier: MIT-0 */
/* Calls into compiled models for plgen_model.m.
 *
 *     mkoctfile --mex -Iruntime host/octave/plgen_mex.c
 *
 * plgen_mex("open", FILE, NAME) loads a shared object and tells what its descriptor says; its `id` goes first in all
 * other calls.  An instance is a vector of bytes, the model's state, which comes in and goes out: copies are copies of
 * it.  Numbers are doubles; those of a model in float are floats inside. */
#include "plrt.h"
#include <mex.h>
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_MODELS = 4096 };

static struct loaded {
	const pl_model *model; /* where `single`, a pl_modelf */
	int single;
	const pl_units *units;  /* NULL: there are none */
} table[MOST_MODELS];
static int models;

/* What both descriptors have, whatever their type */
#define OF(m, entry) ((m)->single ? ((const pl_modelf *)(const void *)(m)->model)->entry : (m)->model->entry)
#define FLOATS(m) ((const pl_modelf *)(const void *)(m)->model)

static void refuse(const char *what)
{
	mexErrMsgIdAndTxt("plgen:error", "%s", what);
}

static char *text_of(const mxArray *a)
{
	char *text = mxArrayToString(a);
	if (text == NULL)
		refuse("plgen_mex: expected a text");
	return text;
}

static mxArray *names_of(const char *const *name, int count)
{
	mxArray *cell = mxCreateCellMatrix(1, (mwSize)count);
	int i;
	for (i = 0; i < count; i++)
		mxSetCell(cell, (mwIndex)i, mxCreateString(name[i]));
	return cell;
}

static void field(mxArray *to, const char *name, mxArray *value)
{
	mxAddField(to, name);
	mxSetField(to, 0, name, value);
}

/* Whether an instance takes another step: what reads tunable params alone has one step, and refuses. */
static int takes_steps(const struct loaded *m)
{
	void *s;
	int status;
	if (m->single ? FLOATS(m)->retune == NULL : m->model->retune == NULL)
		return 0;
	s = mxCalloc(1, OF(m, size));
	if (m->single) {
		FLOATS(m)->init(s);
		status = FLOATS(m)->retune(s, FLOATS(m)->param_values, 0.5f * FLOATS(m)->h);
	} else {
		m->model->init(s);
		status = m->model->retune(s, m->model->param_values, 0.5 * m->model->h);
	}
	mxFree(s);
	return status == 0;
}

/* One of the own unit of a tunable param in SI units */
static double factor_of(const struct loaded *m, int param)
{
	return m->units != NULL && m->units->param_factor != NULL ? strtod(m->units->param_factor[param], NULL) : 1.0;
}

static mxArray *description(const struct loaded *m, int id)
{
	mxArray *reported = mxCreateStructMatrix(1, 1, 0, NULL), *list;
	const int inputs = OF(m, inputs), params = OF(m, params);
	int i;
	field(reported, "id", mxCreateDoubleScalar(id));
	field(reported, "single", mxCreateDoubleScalar(m->single));
	field(reported, "h", mxCreateDoubleScalar(m->single ? (double)FLOATS(m)->h : m->model->h));
	field(reported, "states", names_of(OF(m, state_names), OF(m, states)));
	field(reported, "inputs", names_of(OF(m, input_names), inputs));
	field(reported, "outputs", names_of(OF(m, output_names), OF(m, outputs)));
	field(reported, "tunable", names_of(OF(m, param_names), params));
	list = mxCreateDoubleMatrix(1, (mwSize)params, mxREAL);
	for (i = 0; i < params; i++)
		mxGetPr(list)[i] = (m->single ? (double)FLOATS(m)->param_values[i] : m->model->param_values[i]) /
						   factor_of(m, i);
	field(reported, "values", list);
	list = mxCreateDoubleMatrix(1, (mwSize)inputs, mxREAL);
	for (i = 0; i < inputs; i++)
		mxGetPr(list)[i] = OF(m, start_samples)[i];
	field(reported, "ahead", list);
	field(reported, "can_retune", mxCreateDoubleScalar(takes_steps(m)));
	return reported;
}

/* NAME_units beside NAME_model; NULL: there are none */
static const pl_units *units_of(void *object, const mxArray *symbol)
{
	char *name = text_of(symbol), *last = strrchr(name, '_');
	return last == NULL ? NULL : (const pl_units *)dlsym(object, strcpy(last, "_units") - (last - name));
}

static mxArray *open_model(const mxArray *file, const mxArray *symbol)
{
	void *object = dlopen(text_of(file), RTLD_NOW | RTLD_LOCAL);
	const void *descriptor = object != NULL ? dlsym(object, text_of(symbol)) : NULL;
	const int *head = (const int *)descriptor; /* version, real_size */
	int id;
	if (descriptor == NULL)
		mexErrMsgIdAndTxt("plgen:load", "cannot load what was compiled: %s", dlerror());
	if (head[0] != PL_MODEL_VERSION)
		mexErrMsgIdAndTxt("plgen:error",
			"the model's descriptor has version %d, and plgen_mex reads version %d",
						  head[0], PL_MODEL_VERSION);
	for (id = 0; id < models && table[id].model != descriptor; id++)
		;
	if (id == MOST_MODELS)
		refuse("too many models: `clear plgen_mex` forgets them");
	table[id].model = (const pl_model *)descriptor;
	table[id].single = head[1] == (int)sizeof(float);
	table[id].units = units_of(object, symbol);
	if (id == models)
		models++;
	return description(&table[id], id);
}

static const struct loaded *model_of(const mxArray *id)
{
	const double value = mxGetScalar(id);
	if (!(value >= 0 && value < models))
		refuse("plgen_mex: the model is not open");
	return &table[(int)value];
}

/* ---- numbers as the model has them ---- */

/* NULL where there are none */
static void *numbers(const struct loaded *m, const mxArray *a, size_t count)
{
	const double *from;
	float *narrow;
	size_t i;
	if (a == NULL || mxGetNumberOfElements(a) != count || (count != 0 && (!mxIsDouble(a) || mxIsComplex(a))))
		refuse("plgen_mex: another number of values was expected");
	if (count == 0)
		return NULL;
	from = mxGetPr(a);
	narrow = (float *)mxMalloc(count * sizeof(double));
	if (!m->single)
		return memcpy(narrow, from, count * sizeof *from);
	for (i = 0; i < count; i++)
		narrow[i] = (float)from[i];
	return narrow;
}

static void *room(size_t count)
{
	return mxMalloc((count + 1) * sizeof(double));
}

/* rows x columns, as memory of the model has them one after the other: a matrix of columns x rows */
static mxArray *matrix_of(const struct loaded *m, const void *values, size_t columns, size_t rows)
{
	mxArray *a = mxCreateDoubleMatrix((mwSize)columns, (mwSize)rows, mxREAL);
	double *to = mxGetPr(a);
	size_t i;
	for (i = 0; i < rows * columns; i++)
		to[i] = m->single ? (double)((const float *)values)[i] : ((const double *)values)[i];
	return a;
}

static void *entry(const struct loaded *m, void *values, size_t i)
{
	return values == NULL ? NULL : (char *)values + i * (m->single ? sizeof(float) : sizeof(double));
}

/* ---- calls ---- */

static void call_out(const struct loaded *m, const void *s, void *out)
{
	if (m->single)
		FLOATS(m)->out(s, (float *)out);
	else
		m->model->out(s, (double *)out);
}

static void call_step(const struct loaded *m, void *s, const void *u)
{
	if (m->single)
		FLOATS(m)->step(s, (const float *)u);
	else
		m->model->step(s, (const double *)u);
}

static double call_time(const struct loaded *m, const void *s)
{
	return m->single ? (double)FLOATS(m)->time(s) : m->model->time(s);
}

static int call_status(const struct loaded *m, const void *s)
{
	return OF(m, status) != NULL ? OF(m, status)(s) : 0;
}

/* n steps: rows and times after each; the number of those that went well */
static void run(const struct loaded *m, void *s, const mxArray *const *in, mxArray **out)
{
	const double count = mxGetScalar(in[0]);
	const size_t n = (size_t)count, inputs = (size_t)OF(m, inputs), outputs = (size_t)OF(m, outputs);
	void *u = numbers(m, in[1], n * inputs), *rows = room(n * outputs);
	mxArray *t = mxCreateDoubleMatrix(1, (mwSize)n, mxREAL);
	size_t k;
	for (k = 0; k < n; k++) {
		call_step(m, s, entry(m, u, k * inputs));
		if (call_status(m, s) != 0)
			break;
		call_out(m, s, entry(m, rows, k * outputs));
		mxGetPr(t)[k] = call_time(m, s);
	}
	out[0] = matrix_of(m, rows, outputs, k);
	out[1] = t;
	out[2] = mxCreateDoubleScalar((double)k);
}

static mxArray *states(const struct loaded *m, const void *s)
{
	void *y = room((size_t)OF(m, states));
	if (m->single)
		FLOATS(m)->get(s, (float *)y);
	else
		m->model->get(s, (double *)y);
	return matrix_of(m, y, (size_t)OF(m, states), 1);
}

static void set(const struct loaded *m, void *s, double t, const mxArray *y)
{
	const void *values = numbers(m, y, (size_t)OF(m, states));
	if (m->single)
		FLOATS(m)->set(s, (float)t, (const float *)values);
	else
		m->model->set(s, t, (const double *)values);
}

static mxArray *inside(const struct loaded *m, const void *s, double tau, const mxArray *sample)
{
	const void *u = numbers(m, sample, (size_t)OF(m, inputs));
	void *y = room((size_t)OF(m, states));
	if (m->single ? FLOATS(m)->at == NULL : m->model->at == NULL)
		refuse("the model has no states inside a step");
	if (m->single)
		FLOATS(m)->at(s, (const float *)u, (float)tau, (float *)y);
	else
		m->model->at(s, (const double *)u, tau, (double *)y);
	return matrix_of(m, y, (size_t)OF(m, states), 1);
}

static int retune(const struct loaded *m, void *s, const mxArray *params, double h)
{
	const int count = OF(m, params);
	void *values = numbers(m, params, (size_t)count);
	int i;
	for (i = 0; i < count; i++) {
		if (m->single)
			((float *)values)[i] = (float)((double)((float *)values)[i] * factor_of(m, i));
		else
			((double *)values)[i] *= factor_of(m, i);
	}
	return m->single ? FLOATS(m)->retune(s, (const float *)values, (float)h)
					 : m->model->retune(s, (const double *)values, h);
}

static void hold(const struct loaded *m, void *s, const mxArray *sample)
{
	const void *u = numbers(m, sample, (size_t)OF(m, inputs));
	if (m->single && FLOATS(m)->hold != NULL)
		FLOATS(m)->hold(s, (const float *)u);
	else if (!m->single && m->model->hold != NULL)
		m->model->hold(s, (const double *)u);
}

static void jump(const struct loaded *m, void *s, double n)
{
	if (OF(m, jump) == NULL)
		refuse("the model has no jump");
	OF(m, jump)(s, (uint64_t)n);
}

/* What looks at the state; NULL: it is none of these */
static mxArray *look(const char *what, const struct loaded *m, const void *s, const mxArray *const *in)
{
	void *out;
	if (strcmp(what, "get") == 0)
		return states(m, s);
	if (strcmp(what, "time") == 0)
		return mxCreateDoubleScalar(call_time(m, s));
	if (strcmp(what, "status") == 0)
		return mxCreateDoubleScalar(call_status(m, s));
	if (strcmp(what, "at") == 0)
		return inside(m, s, mxGetScalar(in[0]), in[1]);
	if (strcmp(what, "out") != 0)
		return NULL;
	out = room((size_t)OF(m, outputs));
	call_out(m, s, out);
	return matrix_of(m, out, (size_t)OF(m, outputs), 1);
}

/* What changes it */
static void change(const char *what, const struct loaded *m, void *s, const mxArray *const *in, mxArray **out)
{
	if (strcmp(what, "init") == 0)
		OF(m, init)(s);
	else if (strcmp(what, "set") == 0)
		set(m, s, mxGetScalar(in[0]), in[1]);
	else if (strcmp(what, "run") == 0)
		run(m, s, in, out);
	else if (strcmp(what, "hold") == 0)
		hold(m, s, in[0]);
	else if (strcmp(what, "jump") == 0)
		jump(m, s, mxGetScalar(in[0]));
	else if (strcmp(what, "retune") == 0)
		out[0] = mxCreateDoubleScalar(retune(m, s, in[0], mxGetScalar(in[1])));
	else
		refuse("plgen_mex: what is to be done?");
}

void mexFunction(int results, mxArray *result[], int count, const mxArray *argument[])
{
	const mxArray *in[4] = {NULL, NULL, NULL, NULL};
	mxArray *out[4] = {NULL, NULL, NULL, NULL};
	const struct loaded *m;
	const char *what;
	void *s;
	int i;
	if (count < 3 || count > 5)
		refuse("plgen_mex: what is to be done?  plgen_model knows how to ask");
	what = text_of(argument[0]);
	if (strcmp(what, "open") == 0) {
		result[0] = open_model(argument[1], argument[2]);
		return;
	}
	m = model_of(argument[1]);
	for (i = 3; i < count; i++)
		in[i - 3] = argument[i];
	s = mxCalloc(OF(m, size) / sizeof(double) + 2, sizeof(double)); /* the bytes of others are not aligned */
	if (mxGetNumberOfElements(argument[2]) == OF(m, size))
		memcpy(s, mxGetData(argument[2]), OF(m, size));
	else if (strcmp(what, "init") != 0)
		refuse("plgen_mex: this is no state of the model");
	result[0] = look(what, m, s, in);
	if (result[0] != NULL)
		return;
	change(what, m, s, in, out);
	result[0] = mxCreateNumericMatrix(1, (mwSize)OF(m, size), mxUINT8_CLASS, mxREAL);
	memcpy(mxGetData(result[0]), s, OF(m, size));
	for (i = 1; i < results && i < 5; i++)
		result[i] = out[i - 1] != NULL ? out[i - 1] : mxCreateDoubleMatrix(0, 0, mxREAL);
}
