/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Formulas that the state chooses: regions, intervals, what they cost; for a person, and as JSON. */
#include "model/contacts/friction.h"
#include "report/report.h"
#include "step/series/switching.h"
#include "step/series/expansion.h"
#include "step/linear/forms.h"
#include "step/regions/guards.h"
#include "step/regions/regions.h"

/* ---- bytes and work ---- */

/* Of an entry of A, of e^{A d} and of what jumps make of a state */
static long words_of(const struct step *step)
{
	return step->is.two_words ? 2 : 1;
}

/* Of the tables of a fast path: bounds for each matrix; for each region and expression, where it is and which are
 * beside it */
static long fast_path_bytes(const struct step *step)
{
	const struct switching *s = step->model->switching;
	long size = step->layout.size, halves = 0;
	for (int k = 0; k < step->branches; k++)
		halves = halves || step->branch[k].halvings > 0;
	long off = halves || is_checked_by_tables(step) ? size + 1 : 0;
	return 8 * s->systems *
		       (s->functions * (2 * size + off) +
			halves * size * 2 * s->functions) +
	       28 * (long)s->regions * s->functions + 8 * (step->regions.event_check.degree + 1);
}

/* Of pieces that are shorter than h, but for what bounds guards */
static long ladder_bytes(const struct step *step)
{
	const struct switching *s = step->model->switching;
	long size = step->layout.size, rungs = 0;
	for (int k = 0; k < step->branches; k++)
		rungs += step->model->params.retuned ? room_for_rungs(step) : step->branch[k].rungs;
	long rows = words_of(step) > 1 ? 2 * size : size + 1, bounds = has_events(s) ? 0 : s->functions;
	return !has_ladder(step) ? 0 : 8 * rungs * (rows + bounds) * size + 8 * (long)step->branches;
}

/* Of cos, sin and e^{at} in the steps after a refresh */
static long refresh_bytes(const struct step *step)
{
	long numbers = 0;
	for (int l = 0; l < step->branch->system.loads && step->refresh; l++)
		if (is_refreshed(step, l))
			numbers += step->refresh->steps * (1 + oscillates(step->branch->system.load[l].forcing));
	return 8 * numbers;
}

/* What the fast path does before it leaves the step to the search, at most: in each part of the step bounds, and
 * polynomials of x, corrected */
static long fast_path_multiplications(const struct step *step)
{
	long size = step->layout.size, bounds = step->model->switching->functions * (12 * size + 60);
	long moves = 6 * step->regions.event_check.degree * (size * size + size) + 12 * size * size;
	return !step->regions.event_check.is_made                         ? 0
	       : step->regions.event_check.fast_path
		       ? size * size + MOST_EVENT_CHECKS * (bounds + moves)
	       : has_events(step->model->switching) ? products_of_unmet(step)
						    : size * size;
}

/* Of what regions with friction have beside these, less two of them that they do not */
static long guard_bytes(const struct step *step)
{
	const struct switching *s = step->model->switching;
	struct pieces pieces = pieces_of(step);
	struct guards g = guards_of(step, &pieces);
	long size = step->layout.size, friction_forces = 8 * size * s->regions * s->transmitted_forces;
	return 8 * (g.reaches * size + g.rows * (4 * size + 1) + g.guards + g.assignments * words_of(step) * size +
		    s->functions -
		    2 * s->systems * s->functions * size + (s->segments - 1) * s->functions) +
	       4 * (6 * g.guards + 2 * s->regions + 1 + g.assignments + g.sets + 1) + friction_forces;
}

/* Of the tables of a step, or of a part that is stepped alone */
static long bytes_of_regions(const struct step *step)
{
	const struct switching *s = step->model->switching;
	long size = step->layout.size, matrices = s->systems;
	long rows = s->segments * s->functions * size;
	long bytes = 8 * (rows + matrices * (2 * words_of(step) * size * size + 3 * s->functions * size)) +
		     4 * (s->regions + s->functions + matrices);
	if (step->regions.event_check.is_made && step->model->params.retuned)
		bytes += 8 * (matrices * (s->functions * (size + 1) + step->layout.states + 1) +
			      edges_of_regions(s));
	return bytes + ladder_bytes(step) + (step->regions.event_check.fast_path ? fast_path_bytes(step) : 0) +
	       (has_events(s) ? guard_bytes(step) : 0);
}

/* Every piece of it by a Taylor polynomial, after one of each other length was tried, all events and splits used */
static long most_of_regions(const struct step *step)
{
	const struct switching *s = step->model->switching;
	long size = step->layout.size, degree = step->series.degree, pieces = 1;
	for (int k = 0; k < step->branches; k++)
		pieces = 1l << step->branch[k].halvings > pieces ? 1l << step->branch[k].halvings : pieces;
	pieces += max_events(step->model) + 1;
	long two_words = (words_of(step) - 1) * (12 * size * size + 3 * size);
	return pieces * (products_of_piece(step) + degree * (size * size + 2 * size) +
			 (degree + 1) * s->functions * (size + 6) + two_words) +
	       4 * (degree + 1) *
		       (2 * max_splits(step->model) + 4 * s->functions * pieces + 64 * max_events(step->model)) +
	       fast_path_multiplications(step);
}

/* ---- for a person ---- */

static void text_switching_functions(FILE *to, const struct step *step)
{
	const struct switching *s = step->shown->model->switching;
	for (int i = 0; i < s->functions; i++)
		fprintf(to, "    switching function %d: %s%s breakpoints %s\n", i,
			text_of_function(step->shown->model, i),
			s->function[i].segments > 1 ? ";" : ",",
			breakpoints_text(s->function[i].breaks, (const mpq_t *)s->function[i].at));
}

/* What chooses formulas by the state, of a series */
void text_series_switching(FILE *to, const struct step *step)
{
	const struct expansion *x = step->taylor.switching;
	const char *ends = step->event_split
		? "a step goes on with others where a switching function passes a breakpoint"
				     : format("%s ends where a switching function passes a breakpoint",
					      step->collocation ? "an internal step" : "a series");
	fprintf(to, "The state chooses formulas; %s, at most %d times%s:\n", ends, max_events(step->model),
		step->event_split ? "" : " in a step");
	for (int i = 0; i < x->functions; i++)
		fprintf(to, "    switching function %d: %s, breakpoints %s\n", i, series_switching_text(step, i),
			rising_text(&x->function[i]));
	text_contacts(to, step);
}

const char *frictions_text(const struct switching *s, const char *indent)
{
	const char *text = "";
	for (int i = 0, shown = 0; i < s->frictions; i++) {
		const struct node *node = s->friction[i].atom->node;
		if (!is_repeated(s, i))
			text = format("%s%sfriction %d: %s; sticks in interval %d of switching function %d\n", text,
				      indent,
				      shown++, text_between(node->start, node->end), stick_of(s, &s->friction[i]),
				      s->friction[i].function);
	}
	for (int i = 0; i < s->sliders; i++)
		if (!is_repeated_slider(s, i))
			text = format("%s%sslider: %s\n", text, indent, slider_text(s, i));
	return text;
}

static void text_intervals(FILE *to, const struct switching *s, int region)
{
	fputs(" (intervals", to);
	for (int i = 0; i < s->functions; i++)
		fprintf(to, " %d", interval_of(s, region, i));
	fprintf(to, "%s): matrix %d\n",
		s->segments > 1 ? format("; segment %d of time", segment_of_region(s, region) + 1) : "",
		s->region[region].system);
}

static void text_way(FILE *to, const struct step *step, const char *of)
{
	if (step->regions.event_check.fast_path)
		fprintf(to,
			"%s that a bound shows clear is one product; up to %d crossings go by Taylor polynomials of "
			"degree %d, all else by the search.\n",
			of, MOST_FAST_PATH, step->regions.event_check.degree);
	else if (step->regions.event_check.is_made)
		fprintf(to, "%s that a bound shows clear is one product, all else goes by the search.\n", of);
	else
		fprintf(to, "%s goes by the search: %s.\n", *of == 'A' ? "Every step" : of,
			step->regions.event_check.searches);
}

static void text_impacts(FILE *to, const struct model *model)
{
	for (int i = 0; i < model->contacts.impacts; i++) {
		const struct impact *impact = &model->contacts.impact[i];
		fprintf(to, "    impact %d: %s", i, text_between(impact->when->at, impact->when->end));
		if (impact->bounces)
			fprintf(to, "; a bounce of restitution %s, which rests in interval %d of switching function %d",
				restitution_text(model, impact), rest_of(model->switching, 0, impact),
				impact->in->function);
		fputs("\n", to);
	}
}

static void text_of_one_part(FILE *to, const struct step *step)
{
	const struct switching *s = step->shown->model->switching;
	fprintf(to,
		"Piecewise linear: %d regions%s, %d of them different; in each nothing is approximated, every constant "
		"is correctly rounded.\n",
		possible_regions(s), s->segments > 1 ? format(" in %d segments of time", s->segments) : "", s->systems);
	text_switching_functions(to, step);
	fputs(frictions_text(s, "    "), to);
	text_impacts(to, step->shown->model);
	if (s->sharing)
		fprintf(to, "Rigid-body modes: %d independent parts have their regions together.\n",
			s->sharing);
	for (int r = 0; r < s->regions; r++)
		if (s->region[r].possible) {
			fprintf(to, "    region %d", r % regions_at_once(s));
			text_intervals(to, s, r);
		}
	text_way(to, step, "A step");
	fprintf(to, "Tables: %ld bytes. Per step at most %d crossings and %d splits; at most %ld multiplications.\n",
		bytes_of_regions(step) + refresh_bytes(step), max_events(step->model), max_splits(step->model),
		most_of_regions(step));
}

static void text_part(FILE *to, const struct step *full, int index)
{
	const struct switching *all = full->model->switching;
	const struct region_part *part = &all->part[index];
	const struct switching *s = part->model->switching;
	fprintf(to, "    part %d: %s", index, name_list(part->model->n, part->model->names.coord));
	if (s->functions == 0) {
		fputs("; linear\n", to);
		return;
	}
	fputs("; switching functions", to);
	for (int i = 0; i < s->functions; i++)
		fprintf(to, "%s %d", i ? "," : "", part->function[i]);
	fprintf(to, "; %d regions, %d of them different\n", possible_regions(s), s->systems);
	for (int r = 0; r < s->regions; r++)
		if (s->region[r].possible) {
			fprintf(to, "        %d of the region's number", share_of_region(part, all, r));
			text_intervals(to, s, r);
		}
	text_way(to, full->regions.part[index], "        A step of it");
}

static void text_parts(FILE *to, const struct step *step)
{
	long bytes = refresh_bytes(step), most = 0;
	fprintf(to,
		"Piecewise linear, in %d independent parts, each stepped by itself; in each region nothing is "
		"approximated, every constant is correctly rounded.\n",
		step->regions.parts);
	text_switching_functions(to, step);
	for (int p = 0; p < step->regions.parts; p++) {
		text_part(to, step, p);
		bytes += bytes_of_regions(step->regions.part[p]);
		most += most_of_regions(step->regions.part[p]);
	}
	fprintf(to,
		"Tables: %ld bytes. Per step of each part at most %d crossings and %d splits; of all at most %ld "
		"multiplications.\n",
		bytes, MAX_EVENTS, MAX_SPLITS, most);
}

void text_regions(FILE *to, const struct step *step)
{
	(step->regions.parts ? text_parts : text_of_one_part)(to, step);
}

/* ---- JSON ---- */

static void json_function(FILE *to, int i, const char *text, int breaks, mpq_t *at)
{
	SCRATCH double *rounded = ARRAY(double, breaks);
	for (int k = 0; k < breaks; k++)
		rounded[k] = nearest_double(at[k]);
	fprintf(to, "%s\n    {\"expression\": \"%s\", \"breakpoints\": ", i ? "," : "", text);
	json_numbers(to, breaks, rounded);
	fputs("}", to);
}

static void json_switching_functions(FILE *to, const struct step *step)
{
	const struct switching *s = step->shown->model->switching;
	fputs("  \"expressions\": [", to);
	for (int i = 0; i < s->functions; i++)
		json_function(to, i, text_of_function(step->shown->model, i), s->function[i].breaks,
				s->function[i].at);
	fputs("],\n", to);
}

/* Of time, where there are several */
static const char *json_segment(const struct switching *s, int region)
{
	return s->segments > 1 ? format(", \"segment\": %d", segment_of_region(s, region)) : "";
}

static void json_frictions(FILE *to, const struct switching *s)
{
	fputs("  \"frictions\": [", to);
	for (int i = 0; i < s->frictions; i++)
		if (!is_repeated(s, i))
			fprintf(to, "%s{\"expression\": %d, \"sticks\": %d}", i ? ", " : "",
				s->friction[i].function, stick_of(s, &s->friction[i]));
	fputs("],\n", to);
}

static void json_sliders(FILE *to, const struct switching *s)
{
	fputs("  \"sliders\": [", to);
	const char *between = "";
	for (int i = 0; i < s->sliders; i++) {
		const struct slide **slide;
		int slides = slides_of(s, i, &slide);
		for (int k = 0; k < slides; k++, between = ", ")
			fprintf(to, "%s{\"expressions\": [%d, %d], \"upward\": [%s, %s]}", between,
				slide[k]->function[0], slide[k]->function[1],
				slide[k]->upward[0] ? "true" : "false", slide[k]->upward[1] ? "true" : "false");
	}
	fputs("],\n", to);
}

static void json_impacts(FILE *to, const struct model *model)
{
	fputs("  \"impacts\": [", to);
	for (int i = 0; i < model->contacts.impacts; i++) {
		const struct impact *impact = &model->contacts.impact[i];
		fprintf(to, "%s{\"expression\": %d, \"upward\": %s, \"restitution\": ", i ? ", " : "",
			impact->in->function, impact->in->upward ? "true" : "false");
		if (impact->bounces)
			fprintf(to, "%.17g, \"rests\": %d}", nearest_double(impact->in->restitution),
				rest_of(model->switching, 0, impact));
		else
			fputs("null}", to);
	}
	fputs("],\n", to);
}

/* Of the model, a line each; of a part, and what each adds to the number of the model's */
static void json_region_list(FILE *to, const struct switching *s, const struct region_part *part,
			     const struct switching *all)
{
	const char *next = part ? "" : "\n    ", *between = part ? ", " : ",\n    ";
	fputs("\"regions\": [", to);
	for (int r = 0; r < s->regions && (s->functions > 0 || !part); r++) {
		if (!s->region[r].possible)
			continue;
		fprintf(to, "%s{\"number\": %d%s, \"matrix\": %d}", next,
			part ? share_of_region(part, all, r) : r % regions_at_once(s), json_segment(s, r),
			s->region[r].system);
		next = between;
	}
}

static void json_part(FILE *to, const struct switching *all, int index)
{
	const struct region_part *part = &all->part[index];
	const struct switching *s = part->model->switching;
	fprintf(to, "%s\n    {", index ? "," : "");
	json_names(to, "coordinates", part->model->n, part->model->names.coord);
	fputs(", \"expressions\": [", to);
	for (int i = 0; i < s->functions; i++)
		fprintf(to, "%s%d", i ? ", " : "", part->function[i]);
	fputs("],\n     ", to);
	json_region_list(to, s, part, all);
	fputs("]}", to);
}

void json_regions(FILE *to, const struct step *step)
{
	const struct switching *s = step->shown->model->switching;
	json_switching_functions(to, step);
	if (s->frictions > 0)
		json_frictions(to, s);
	if (s->sliders > 0)
		json_sliders(to, s);
	if (s->impacts > 0)
		json_impacts(to, step->shown->model);
	if (!s->parts) {
		fputs("  ", to);
		json_region_list(to, s, NULL, NULL);
		fputs("],\n", to);
		return;
	}
	fputs("  \"parts\": [", to);
	for (int p = 0; p < s->parts; p++)
		json_part(to, s, p);
	fputs("],\n", to);
}
void json_series_switching(FILE *to, const struct step *step)
{
	const struct expansion *x = step->taylor.switching;
	fputs("  \"expressions\": [", to);
	for (int i = 0; i < x->functions; i++)
		json_function(to, i, json_text(series_switching_text(step, i)), x->function[i].breaks,
				rising_breakpoints(&x->function[i]));
	fputs("],\n", to);
	json_contacts(to, step);
}
