/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Equilibria: where they are, along which directions nothing holds them, and the poles of the linear equations there.
 * These are another model for each, which the caller makes. */
#include "report/report.h"
#include "step/linear/images.h"

#include <math.h>
#include <string.h>

struct found {                      /* one of them */
	const struct model *model;
	const struct equilibrium *at;
	int poles;
	struct pole_report *pole;
	const char *why;            /* no poles; else NULL */
};

/* x, or q[1] + 0.5*q[2] */
static const char *direction_text(const struct model *model, const double *part)
{
	const char *text = "";
	for (int i = 0; i < model->n; i++) {
		const double size = fabs(part[i]);
		if (size < 1e-9)
			continue;
		text = format("%s%s%s%s", text, part[i] < 0 ? *text ? " - " : "-" : *text ? " + " : "",
			      fabs(size - 1) < 1e-9 ? "" : format("%.6g*", size), model->names.coord[i]);
	}
	return text;
}

static void text_one(FILE *to, const struct found *f, int number)
{
	fprintf(to, "\n%d: ", number);
	for (int i = 0; i < f->model->n; i++)
		fprintf(to, "%s%s = %.10g", i ? ", " : "", f->model->names.coord[i], mpq_get_d(f->at->state[i]));
	fprintf(to, "; %s", f->why ? format("it has no poles: %s", f->why) : stability_by_poles(f->poles, f->pole));
	for (int k = 0; k < f->at->directions; k++)
		fprintf(to, "%s%s", k ? ", " : "; no stiffness along ",
			direction_text(f->model, f->at->free + k * f->model->n));
	fprintf(to, "\n");
	if (!f->why)
		fprintf(to, "    %-36s %-16s damping ratio\n", "pole [1/s]", "frequency [Hz]");
	for (int i = 0; i < f->poles; i++)
		fprintf(to, "    %s\n", pole_row(&f->pole[i]));
}

static void json_one(FILE *to, const struct found *f, int number)
{
	fprintf(to, "%s{\n  \"at\": {", number > 1 ? ", " : "");
	for (int i = 0; i < f->model->n; i++)
		fprintf(to, "%s\"%s\": %s", i ? ", " : "", f->model->names.coord[i],
			json_number(mpq_get_d(f->at->state[i])));
	fprintf(to, "},\n  \"stability\": \"%s\",\n  \"free\": [",
		f->why ? "unknown" : stability_by_poles(f->poles, f->pole));
	for (int k = 0; k < f->at->directions; k++)
		fprintf(to, "%s\"%s\"", k ? ", " : "", direction_text(f->model, f->at->free + k * f->model->n));
	fputs("],\n", to);
	json_pole_list(to, f->poles, f->pole);
	fputs("}", to);
}

/* x; q[1] + q[2]: coordinates that no equation depends on, or combinations of several */
static const char *free_text(const struct model *model, bool cyclic)
{
	const struct equations *e = &model->equations;
	const char *text = "";
	for (int k = 0; k < e->directions; k++) {
		const char *direction = direction_text(model, e->free + k * model->n);
		if (!strchr(direction, ' ') == cyclic)
			text = format("%s%s%s", text, *text ? ", " : "", direction);
	}
	return text;
}

void text_symmetries(FILE *to, const struct model *model)
{
	const char *cyclic = free_text(model, true), *rigid = free_text(model, false);
	if (*cyclic)
		fprintf(to, "\nCyclic, as no equation depends on them: %s. Forces alone change their momentum.\n",
			cyclic);
	if (*rigid)
		fprintf(to, "\nRigid directions, along which no equation changes: %s.\n", rigid);
}

void json_symmetries(FILE *to, const struct model *model)
{
	fputs("  \"free\": [", to);
	for (int k = 0; k < model->equations.directions; k++)
		fprintf(to, "%s\"%s\"", k ? ", " : "",
			direction_text(model, model->equations.free + k * model->n));
	fputs("],\n", to);
}

void print_equilibria(FILE *to, const struct model *model, bool json,
		      const struct model *(*linear)(void *context, const char *place, const char **why), void *context)
{
	const struct equations *e = &model->equations;
	if (e->equilibria == 0)
		error(model->spec->name_at,
		      "other initial values: the search starts there, and up to half a turn beside",
		      "no equilibrium is found from %d points", e->starts);
	fprintf(to, json ? "{\"model\": \"%s\", \"starts\": %d, \"equilibria\": ["
			 : "Equilibria of %s: Newton's method from the initial values and %d points around them\n",
		model->name, json ? e->starts : e->starts - 1);
	for (int k = 0; k < e->equilibria; k++) {
		struct found f = { .model = model, .at = &e->equilibrium[k] };
		const struct model *there = linear(context, f.at->place, &f.why);
		f.poles = f.why ? 0 : poles_of(there, resolvent_of(&there->system), &f.pole);
		(json ? json_one : text_one)(to, &f, k + 1);
	}
	fputs(json ? "]}\n" : "", to);
}
