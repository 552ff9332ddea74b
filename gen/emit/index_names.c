/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Names of places: in y, u, out and params.  A place that a statement more or less moves is asked for by name. */
#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include "declarations.h"
#include "model/tunable/tuning.h"

/* body.x' as BODY_X_DOT; as it is written, body_x_dot, where capitals name something else too. */
static const char *as_index(const char *name, bool capitals)
{
	char *text = format("%s", name), *to = text;
	int primes = 0;
	for (const char *c = name; *c; c++) {
		if (*c == '\'')
			primes++;
		else if (isalnum((unsigned char)*c))
			*to++ = (char)(capitals ? toupper((unsigned char)*c) : *c);
		else if (to > text && to[-1] != '_')
			*to++ = '_';
	}
	while (to > text + 1 && to[-1] == '_')
		to--;
	*to = '\0';
	const char *derivative[] = {"", "_DOT", "_DDOT"};
	const char *lower[] = {"", "_dot", "_ddot"};
	return format("%s%s", text, (capitals ? derivative : lower)[primes > 2 ? 2 : primes]);
}

static int in_order(const void *a, const void *b)
{
	return strcmp(*(const char *const *)a, *(const char *const *)b);
}

static int times_in(const char *const *sorted, int count, const char *text)
{
	int first = 0, end = count;
	while (first < end) {
		const int middle = (first + end) / 2;
		if (strcmp(sorted[middle], text) < 0)
			first = middle + 1;
		else
			end = middle;
	}
	for (end = first; end < count && strcmp(sorted[end], text) == 0; end++)
		;
	return end - first;
}

static const char **in_capitals(const char *const *name, int count, bool capitals)
{
	const char **text = ARRAY(const char *, (size_t)count);
	for (int i = 0; i < count; i++)
		text[i] = as_index(name[i], capitals);
	return text;
}

static const char **sorted_copy(const char *const *text, int count)
{
	const char **sorted = ARRAY(const char *, (size_t)count);
	memcpy(sorted, text, (size_t)count * sizeof *sorted);
	qsort(sorted, (size_t)count, sizeof *sorted, in_order);
	return sorted;
}

/* enum { NAME_<kind>_<name>, ... }: capitals; what differs in its letters' size only as it is written; what is alike
 * even so (a coordinate x_dot beside x') with its place. */
void emit_names_of(const struct emitter *e, const char *kind, const char *const *name, int count)
{
	enum { WIDTH = 110 };
	if (count == 0)
		return;
	const char **capitals = in_capitals(name, count, true), **written = in_capitals(name, count, false);
	const char **sorted_capitals = sorted_copy(capitals, count), **sorted_written = sorted_copy(written, count);
	const char *line = spell(e, "enum {");
	for (int i = 0; i < count; i++) {
		const char *own = times_in(sorted_capitals, count, capitals[i]) == 1 ? capitals[i] :
				  times_in(sorted_written, count, written[i]) == 1 ? written[i] :
				  format("%s_%d", written[i], i);
		const char *next = format("%s_%s_%s%s", e->upper, kind, own, i + 1 < count ? "," : " };");
		if (strlen(line) + strlen(next) >= WIDTH) {
			say(e, "%s\n", line);
			line = "      ";
		}
		line = format("%s %s", line, next);
	}
	say(e, "%s\n", line);
}

const char **names_of_outputs(const struct emitter *e)
{
	const char **name = ARRAY(const char *, (size_t)e->model->outputs);
	for (int i = 0; i < e->model->outputs; i++)
		name[i] = e->model->output[i].name;
	return name;
}

const char **names_of_params(const struct tuning *tuning)
{
	const char **name = ARRAY(const char *, (size_t)tuning->given);
	for (int k = 0; k < tuning->given; k++)
		name[k] = tuning->param[k].symbol->name;
	return name;
}

const char **names_of_inputs(const struct emitter *e)
{
	const char **name = ARRAY(const char *, (size_t)given_inputs(e));
	for (int i = 0; i < given_inputs(e); i++)
		name[i] = e->system->input[i].name;
	return name;
}

void emit_index_names(const struct emitter *e)
{
	const struct tuning *tuning = tunables_of(e->model);
	say(e, "/* indices into y, u and out%s */\n", tuning ? ", into params" : "");
	emit_names_of(e, "X", e->step->shown->model->names.state, e->system->states);
	emit_names_of(e, "IN", names_of_inputs(e), given_inputs(e));
	emit_names_of(e, "OUT", names_of_outputs(e), e->model->outputs);
	if (tuning)
		emit_names_of(e, "P", names_of_params(tuning), tuning->given);
}
