/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What of a model is shown: --show z,acc draws two panels, z+zf two curves in one, x:x' the second over the first.
 * Names are those of outputs, or of states where no output is called so; what is shown are the columns of the rows too,
 * each once, in the order in which they are named. Without --show each output has a panel. */
#define _GNU_SOURCE
#include "plrun.h"

#include <stdlib.h>
#include <string.h>

/* How many letters have to be put in, left out or exchanged; ends of equal letters cost nothing */
static size_t distance(const char *a, const char *b)
{
	const size_t m = strlen(a), n = strlen(b);
	size_t row[65], diagonal, above;
	if (m > 64 || n > 64)
		return 64;
	for (size_t j = 0; j <= n; j++)
		row[j] = j;
	for (size_t i = 1; i <= m; i++) {
		diagonal = row[0];
		row[0] = i;
		for (size_t j = 1; j <= n; j++, diagonal = above) {
			above = row[j];
			row[j] = diagonal + (a[i - 1] != b[j - 1]);
			row[j] = row[j] > above + 1 ? above + 1 : row[j];
			row[j] = row[j] > row[j - 1] + 1 ? row[j - 1] + 1 : row[j];
		}
	}
	return row[n];
}

static const char *name_of(const struct machine *m, int source)
{
	return source < m->own_outputs ? m->output_names[source] : m->state_names[source - m->own_outputs];
}

static int source_of(const struct machine *m, const char *name)
{
	for (int i = 0; i < m->own_outputs + m->states; i++)
		if (strcmp(name_of(m, i), name) == 0)
			return i;
	return -1;
}

/* Suggests a name at most a third of whose letters are others, or lists what there is. */
static const char *suggestion(const struct machine *m, const char *name)
{
	size_t best = strlen(name) / 3 + 1;
	const char *near = NULL, *list = "";
	for (int i = 0; i < m->own_outputs + m->states; i++) {
		const size_t away = distance(name, name_of(m, i));
		if (away < best || (away == best && !near)) {
			best = away;
			near = name_of(m, i);
		}
		if (i < 20 && i == source_of(m, name_of(m, i)))
			list = format("%s%s%s", list, *list ? ", " : "", name_of(m, i));
	}
	return near ? format("did you mean '%s'?", near)
		    : format("there are %s%s", list, m->own_outputs + m->states > 20 ? ", ..." : "");
}

/* ---- the list ---- */

struct list {
	const char *text, *next;
	const struct machine *machine;
	struct view *view;
};

static _Noreturn void wrong_at(const struct list *l, const char *at, const char *message, const char *note)
{
	const size_t column = (size_t)(at - l->text);
	say_at((struct place){ "<command line>", 1, l->text, strlen(l->text), column }, message);
	fprintf(stderr, "note: %s\n", note);
	exit(WRONG_USAGE);
}

static const char *unit_of(const struct machine *m, int source)
{
	const bool output = source < m->plain_outputs, state = source >= m->own_outputs;
	const char *const *list = !m->units ? NULL : output ? m->units->output : state ? m->units->state : NULL;
	return list ? list[output ? source : source - m->own_outputs] : "";
}

static const char *labelled(const char *name, const char *unit)
{
	return *unit ? format("%s [%s]", name, unit) : name;
}

static int column_of(struct view *v, const struct machine *m, int source)
{
	const size_t count = (size_t)v->columns + 1;
	for (int i = 0; i < v->columns; i++)
		if (v->source[i] == source)
			return i;
	v->source = need(reallocarray(v->source, count, sizeof *v->source));
	v->name = need(reallocarray(v->name, count, sizeof *v->name));
	v->unit = need(reallocarray(v->unit, count, sizeof *v->unit));
	v->label = need(reallocarray(v->label, count, sizeof *v->label));
	v->source[v->columns] = source;
	v->name[v->columns] = name_of(m, source);
	v->unit[v->columns] = unit_of(m, source);
	v->label[v->columns] = labelled(name_of(m, source), unit_of(m, source));
	return v->columns++;
}

static int take_name(struct list *l)
{
	const char *begin = l->next + strspn(l->next, " ");
	size_t length = strcspn(begin, ",+: ");
	char *name = need(strndup(begin, length));
	const int source = source_of(l->machine, name);
	if (length == 0)
		wrong_at(l, begin, "expected the name of an output or a state",
			 "z,acc are two panels, z+zf two curves in one, x:x' is x' over x");
	if (source < 0)
		wrong_at(l, begin, format("no output or state is named '%s'", name), suggestion(l->machine, name));
	free(name);
	l->next = begin + length + strspn(begin + length, " ");
	return column_of(l->view, l->machine, source);
}

static struct panel *new_panel(struct view *v)
{
	v->panel = need(reallocarray(v->panel, (size_t)v->panels + 1, sizeof *v->panel));
	v->panel[v->panels] = (struct panel){ .x = -1 };
	return &v->panel[v->panels++];
}

static void take_panel(struct list *l)
{
	struct panel *p = new_panel(l->view);
	int column = take_name(l);
	if (*l->next == ':') {
		p->x = column;
		l->next++;
		column = take_name(l);
	}
	p->y[p->curves++] = column;
	while (*l->next == '+') {
		if (p->curves == PICTURE_CURVES)
			wrong_at(l, l->next, format("a panel has at most %d curves", PICTURE_CURVES),
				 "a comma begins another panel");
		l->next++;
		p->y[p->curves++] = take_name(l);
	}
	if (*l->next && *l->next != ',')
		wrong_at(l, l->next, format("expected ',' or '+', found '%c'", *l->next),
			 "z,acc are two panels, z+zf two curves in one, x:x' is x' over x");
}

struct view view_of(const struct machine *m, const char *text)
{
	struct view v = { 0 };
	struct list l = { text, text, m, &v };
	for (int i = 0; !text && i < m->own_outputs; i++) {
		struct panel *p = new_panel(&v);
		p->y[p->curves++] = column_of(&v, m, i);
	}
	while (text) {
		take_panel(&l);
		if (!*l.next)
			break;
		l.next++;
	}
	return v;
}

double panel_height(const struct view *v, const struct panel *p, bool labelled)
{
	return (v->panels == 1 || p->x >= 0 ? 2 : 1) + 0.15 * (p->curves > 1) + 0.1 * labelled;
}

/* ---- text at an axis ---- */

const char *panel_label(const struct view *v, const struct panel *p)
{
	const char *unit = v->unit[p->y[0]];
	for (int k = 1; k < p->curves; k++)
		if (strcmp(v->unit[p->y[k]], unit) != 0)
			return "";
	return p->curves == 1 ? v->label[p->y[0]] : labelled("", unit);
}

const char *psd_label(const struct view *v, const struct panel *p)
{
	const char *name = p->curves == 1 ? v->name[p->y[0]] : "", *unit = v->unit[p->y[0]];
	if (!*unit || !*panel_label(v, p))
		unit = "unit";
	return format(strpbrk(unit, " /*^") ? "%s [(%s)²/Hz]" : "%s [%s²/Hz]", name, unit);
}

const char *param_label(const struct machine *m, const char *name)
{
	for (int k = 0; m->units && m->units->param && k < m->params; k++)
		if (strcmp(m->param_names[k], name) == 0)
			return labelled(name, m->units->param[k]);
	return strcmp(name, "step") == 0 ? "step [s]" : name;
}
