/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Models of a sweep: the values of params that are not tunable, and a `step` where nothing is, make a variant, compiled
 * when the first of its rows is reached and dropped with the last. Where these are many, params that plgen can make
 * tunable are, so that one model is compiled. */
#define _GNU_SOURCE
#include "plrun.h"

#include <stdlib.h>
#include <string.h>

const char *sweep_value(const struct sweep *s, size_t row, size_t param)
{
	return s->text[row * s->params + param];
}

static bool same_variant(const struct sweep *s, size_t a, size_t b)
{
	for (size_t i = 0; i < s->params; i++)
		if (!s->param[i].tuned && strcmp(sweep_value(s, a, i), sweep_value(s, b, i)) != 0)
			return false;
	return true;
}

static const struct sweep *sorted;              /* whose rows are put in order; before any thread begins */

static int by_variant(const void *a, const void *b)
{
	size_t one = *(const size_t *)a, other = *(const size_t *)b;
	for (size_t i = 0; i < sorted->params; i++) {
		int order = sorted->param[i].tuned ? 0
			  : strcmp(sweep_value(sorted, one, i), sweep_value(sorted, other, i));
		if (order)
			return order;
	}
	return one < other ? -1 : 1;
}

/* `left` counts rows of all processes: of one of several a variant may stay loaded to the end. */
void find_variants(struct sweep *s)
{
	size_t *order = need(calloc(s->rows, sizeof *order));
	s->variant_of = need(calloc(s->rows, sizeof *s->variant_of));
	s->variant = need(calloc(s->rows, sizeof *s->variant));
	s->variants = 0;
	for (size_t i = 0; i < s->rows; i++)
		order[i] = i;
	sorted = s;
	qsort(order, s->rows, sizeof *order, by_variant);
	for (size_t i = 0; i < s->rows; i++) {
		if (i == 0 || !same_variant(s, order[i - 1], order[i])) {
			s->variant[s->variants].row = order[i];
			pthread_mutex_init(&s->variant[s->variants++].busy, NULL);
		}
		s->variant_of[order[i]] = s->variants - 1;
		s->variant[s->variants - 1].left += s->options->histories ? 2 : 1;
	}
	free(order);
}

/* The first line of what plgen or the compiler said */
static char *first_line(const char *text)
{
	const char *error = strstr(text, "error: ");
	text = error ? error + strlen("error: ") : text;
	return need(strndup(text, strcspn(text, "\n")));
}

bool is_name_of(const struct machine *m, const char *name)
{
	for (int k = 0; k < m->params; k++)
		if (strcmp(m->param_names[k], name) == 0)
			return true;
	return false;
}

/* With one more option for plgen, and room for another; NULL: none */
static struct options with_passed(const struct options *o, const char *more)
{
	struct options with = *o;
	with.passed = need(calloc(o->passed_count + 3, sizeof *with.passed));
	memcpy(with.passed, o->passed, o->passed_count * sizeof *o->passed);
	if (more)
		with.passed[with.passed_count++] = more;
	return with;
}

/* Those of the command line that are no values of tunable params */
static size_t definitions_of(const struct sweep *s, const char **definition)
{
	const struct options *o = s->options;
	size_t count = 0;
	double number;
	for (size_t i = 0; i < o->definitions; i++)
		if (!is_name_of(s->machine, o->definition[i].name) || !read_number(o->definition[i].value, &number))
			definition[count++] = format("%s=%s", o->definition[i].name, o->definition[i].value);
	return count;
}

/* Where runs are wanted on a device */
static void add_kernel(const struct sweep *s, struct variant *v, const struct options *with,
		       const char *const *definition, size_t count)
{
	struct machine *m = v->machine;
	if (m->single)
		v->no_kernel = format("sums of squares of a model in float are in double");
	else if (!machine_has_lanes(m))
		v->no_kernel = format("no param of the model is tunable, or states are shown");
	else
		m->kernel = generate_kernel(s->tools, with, definition, count, m->name, &v->no_kernel);
	if (v->no_kernel)
		v->no_kernel = first_line(v->no_kernel);
}

void build_variant(const struct sweep *s, struct variant *v)
{
	const struct options *o = s->options;
	const char **definition = need(calloc(s->params + o->definitions, sizeof *definition));
	struct options with = with_passed(o, NULL);
	size_t count = definitions_of(s, definition);
	int status;
	for (size_t i = 0; i < s->params; i++) {
		if (s->param[i].step && !s->param[i].tuned)
			with.passed[with.passed_count++] = format("--step=%s", sweep_value(s, v->row, i));
		else if (!s->param[i].tuned)
			definition[count++] = format("%s=%s", s->param[i].name, sweep_value(s, v->row, i));
	}
	struct code *c = generate(s->tools, &with, definition, count, true, &v->error, &status);
	if (c) {
		v->machine = machine_of(s->tools, c, &v->error);
		if (v->machine)
			machine_show(v->machine, s->machine->view, o);
		if (v->machine && o->device && v->left > 1)
			add_kernel(s, v, &with, definition, count);
		free(c->text);
		free(c->said);
		free(c);
	}
	if (v->error)
		v->error = first_line(v->error);
	free(definition);
	free(with.passed);
}

const struct machine *take_variant(struct sweep *s, struct variant *v)
{
	pthread_mutex_lock(&v->busy);
	if (!v->tried)
		build_variant(s, v);
	v->tried = true;
	pthread_mutex_unlock(&v->busy);
	return v->machine;
}

void leave_variant(struct variant *v)
{
	pthread_mutex_lock(&v->busy);
	if (--v->left == 0 && v->machine) {
		machine_close(v->machine);
		v->machine = NULL;
	}
	pthread_mutex_unlock(&v->busy);
}

/* ---- params that are not tunable, made so ---- */

static bool has_numbers(const struct sweep *s, size_t param)
{
	double number;
	bool all = true;
	for (size_t row = 0; row < s->rows && all; row++)
		all = read_number(sweep_value(s, row, param), &number);
	return all;
}

/* Of all that could be; NULL: there is none, or too few rows are compiled for it to pay */
static char *list_of_params(const struct sweep *s)
{
	char *list = NULL;
	for (size_t i = 0; i < s->params && s->variants > COMPILED_AT_MOST; i++)
		if (!s->param[i].tuned && !s->param[i].step && has_numbers(s, i))
			list = list ? format("%s,%s", list, s->param[i].name) : format("%s", s->param[i].name);
	return list;
}

/* The model with these params tunable, if plgen has one */
static struct code *generate_tunable(const struct sweep *s, const struct options *with, struct machine **machine)
{
	const char **definition = need(calloc(s->options->definitions + 1, sizeof *definition));
	char *error;
	int status;
	struct code *c = generate(s->tools, with, definition, definitions_of(s, definition), true, &error, &status);
	*machine = c ? machine_of(s->tools, c, &error) : NULL;
	free(definition);
	return *machine ? c : NULL;
}

const struct code *make_tunable(struct sweep *s, const struct code *c)
{
	const char *list = list_of_params(s);
	struct machine *machine = NULL;
	struct options *with = need(malloc(sizeof *with));
	*with = with_passed(s->options, list ? format("--tunable=%s", list) : NULL);
	struct code *tunable = list ? generate_tunable(s, with, &machine) : NULL;
	if (!tunable)
		return c;
	struct sweep *compiled = need(malloc(sizeof *compiled));
	*compiled = *s;
	s->compiled = compiled;
	s->options = with;
	machine_show(machine, s->machine->view, with);
	s->machine = machine;
	s->param = need(calloc(s->params, sizeof *s->param));
	memcpy(s->param, compiled->param, s->params * sizeof *s->param);
	for (size_t i = 0; i < s->params; i++)
		s->param[i].tuned = is_tunable(tunable, s->param[i].name) ||
				    (s->param[i].step && machine->can_retune);
	find_variants(s);
	return tunable;
}
