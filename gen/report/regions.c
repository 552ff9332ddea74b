/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Formulas that the state chooses: regions, intervals, what they cost; for a person, and as JSON. */
#include "model/contacts/friction.h"
#include "plrt.h"
#include "report/report.h"
#include "model/regions/regions.h"
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
		       ? size * size + event_checks(step->model) * (bounds + moves)
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
	if (s->cached)                          /* in an instance */
		return 16 * PL_CACHED_WORK(size, s->functions) + slots_of(step) * bytes_of_slot(step);
	long bytes = 8 * (rows + matrices * (2 * words_of(step) * size * size + 3 * s->functions * size)) +
		     4 * (s->regions + s->functions + matrices);
	if (step->regions.event_check.is_made && step->model->params.retuned)
		bytes += 8 * (matrices * (s->functions * (size + 1) + step->layout.states + 1) +
			      edges_of_regions(s));
	return bytes + ladder_bytes(step) + (step->regions.event_check.fast_path ? fast_path_bytes(step) : 0) +
	       (has_events(s) ? guard_bytes(step) : 0);
}

/* To make the tables of a region: an increment in two words for h and each rung, of so many products at most of 17
 * multiplications an entry; series of bounds; strides that double */
static long most_of_slot(const struct step *step)
{
	enum { PRODUCTS = 80, EACH = 17, SERIES = 14, DOUBLED = 8 };
	const long size = step->layout.size, functions = step->model->switching->functions;
	const long rungs = room_for_rungs(step), doubled = DOUBLED * (step->branch->halvings + 1);
	return size * size * (size * ((1 + rungs) * PRODUCTS * EACH + 4 * (SERIES + size) + 3 * doubled) +
			      4 * doubled * functions + 64 * functions);
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
	       fast_path_multiplications(step) +
	       (step->model->switching->cached ? (max_events(step->model) + 1) * most_of_slot(step) : 0);
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

static void text_region_number(FILE *to, int functions)
{
	fputs(functions == 1 ? "The number of a region is that of its interval of switching function 0.\n"
			     : "The number of a region is i0 + n0*(i1 + n1*(i2 + ...)), i0 being its interval of "
			       "switching function 0, n0 how many intervals that has.\n", to);
}

/* What chooses formulas by the state, of a series */
void text_series_switching(FILE *to, const struct step *step)
{
	const struct expansion *x = step->taylor.switching;
	if (step->event_split)
		fputs("The state chooses formulas: steps go from crossing to crossing, the first root of the cubic "
		      "through a switching function's values and slopes at both ends; there formulas change.\n", to);
	else
		fprintf(to, "The state chooses formulas: %s is of those between two crossings. Where a switching "
			    "function passes a breakpoint is the first root of its %s, found before it is stepped "
			    "over; costs below are without the search.\n",
			step->collocation ? "an internal step" : "a series",
			!step->collocation	 ? "own series"
			: step->taylor.expansion ? "own series, or of its polynomial through the nodes"
						 : "polynomial through the start and the nodes");
	for (int i = 0; i < x->functions; i++)
		fprintf(to, "    switching function %d: %s, breakpoints %s\n", i, series_switching_text(step, i),
			rising_text(&x->function[i]));
	text_contacts(to, step);
	if (regions_of_series(x))
		text_region_number(to, x->functions);
}

/* Each friction on a line: its expression, and the interval in which it sticks */
static void text_frictions(FILE *to, const struct switching *s)
{
	for (int i = 0, shown = 0; i < s->frictions; i++) {
		const struct node *node = s->friction[i].atom->node;
		if (!is_repeated(s, i))
			fprintf(to, "    friction %d: %s; sticks in interval %d of switching function %d\n", shown++,
				text_between(node->start, node->end), stick_of(s, &s->friction[i]),
				s->friction[i].function);
	}
	for (int i = 0; i < s->sliders; i++)
		if (!is_repeated_slider(s, i))
			fprintf(to, "    slider: %s\n", slider_text(s, i));
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

static void text_way(FILE *to, const struct step *step)
{
	const struct event_check *check = &step->regions.event_check;
	const char *clear = "A step that a bound shows to be free of events is one matrix product";
	if (check->fast_path)
		fprintf(to, "%s; up to %d crossings that are certain are computed by Taylor polynomials of degree %d; "
			    "the search does all other steps.\n", clear, fast_path_events(step->model), check->degree);
	else if (check->is_made)
		fprintf(to, "%s; the search does all other steps.\n", clear);
	else
		fprintf(to, "Every step goes by the search: %s.\n", check->searches);
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
	const struct model *model = step->shown->model;
	const struct switching *s = model->switching;
	const char *in_time = s->segments > 1 ? format(" in %d segments of time", s->segments) : "";
	const char *linear = format(" with %d different linear systems; each constant of these is its closed form, "
				    "correctly rounded", s->systems);
	if (s->cached)
		linear = format("; the target makes their matrices when it meets them, each entry within 16 units in "
				"the last place of the largest, and keeps those of the last %d", slots_of(step));
	fprintf(to, "Scheme exact: nothing is approximated. The equations are piecewise linear: %d regions%s%s; "
		    "crossings inside a step are found in order, to rounding.\n",
		s->cached ? region_numbers(s) : possible_regions(s), in_time, linear);
	text_switching_functions(to, step);
	text_frictions(to, s);
	text_impacts(to, model);
	text_impact_rules(to, model);
	if (s->sharing)
		fprintf(to, "Rigid-body modes: %d independent parts have their regions together.\n", s->sharing);
	text_way(to, step);
}

static void text_part(FILE *to, const struct step *full, int index)
{
	const struct region_part *part = &full->model->switching->part[index];
	const struct switching *s = part->model->switching;
	const struct event_check *check = &full->regions.part[index]->regions.event_check;
	fprintf(to, "    part %d: %s", index, name_list(part->model->n, part->model->names.coord));
	if (s->functions == 0) {
		fputs("; linear\n", to);
		return;
	}
	fprintf(to, "; switching function%s", s->functions > 1 ? "s" : "");
	for (int i = 0; i < s->functions; i++)
		fprintf(to, "%s %d", i ? "," : "", part->function[i]);
	fprintf(to, "; %d regions with %d different linear systems", possible_regions(s), s->systems);
	if (check->fast_path)
		fprintf(to, "; polynomials of degree %d\n", check->degree);
	else
		fprintf(to, "; %s\n", check->is_made ? "no polynomials: the search"
						     : format("every step goes by the search: %s", check->searches));
}

static void text_parts(FILE *to, const struct step *step)
{
	const struct step *fast = NULL;
	fprintf(to, "Scheme exact: nothing is approximated. The equations are piecewise linear, in %d independent "
		    "parts, each with regions and crossings of its own: in each region every constant is its closed "
		    "form, correctly rounded; crossings inside a step are found in order, to rounding.\n",
		step->regions.parts);
	text_switching_functions(to, step);
	for (int p = 0; p < step->regions.parts; p++) {
		text_part(to, step, p);
		if (step->regions.part[p]->regions.event_check.fast_path)
			fast = step->regions.part[p];
	}
	if (fast)
		fprintf(to, "A step of a part that a bound shows to be free of events is one matrix product; up to %d "
			    "crossings that are certain are computed by Taylor polynomials; the search does all other "
			    "steps.\n", fast_path_events(step->model));
}

void text_regions(FILE *to, const struct step *step)
{
	(step->regions.parts ? text_parts : text_of_one_part)(to, step);
	text_region_number(to, step->shown->model->switching->functions);
}

static void text_list_of_part(FILE *to, const struct switching *all, int index)
{
	const struct region_part *part = &all->part[index];
	const struct switching *s = part->model->switching;
	for (int r = 0; r < s->regions && s->functions > 0; r++)
		if (s->region[r].possible) {
			fprintf(to, "    part %d: %d of the region's number", index, share_of_region(part, all, r));
			text_intervals(to, s, r);
		}
}

static void text_list(FILE *to, const struct switching *s)
{
	for (int r = 0; r < s->regions && !s->cached; r++)
		if (s->region[r].possible) {
			fprintf(to, "    region %d", r % regions_at_once(s));
			text_intervals(to, s, r);
		}
}

void text_region_list(FILE *to, const struct step *step)
{
	const int parts = step->regions.parts;
	long bytes = refresh_bytes(step) + (parts ? 0 : bytes_of_regions(step));
	long most = parts ? 0 : most_of_regions(step);
	if (!parts)
		text_list(to, step->shown->model->switching);
	for (int p = 0; p < parts; p++) {
		text_list_of_part(to, step->model->switching, p);
		bytes += bytes_of_regions(step->regions.part[p]);
		most += most_of_regions(step->regions.part[p]);
	}
	fprintf(to,
		"Tables%s: %ld bytes. Per step%s at most %d crossings and %d splits; at most %ld multiplications%s.\n",
		caches_regions(step->model) ? ", most of them in an instance" : "", bytes,
		parts ? " of each part" : "", max_events(step->model),
		max_splits(step->model), most, parts ? " of all" : "");
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
		if (!s->region[r].possible || s->cached)
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
	if (s->cached)
		fprintf(to, "  \"regions_cached\": %d,\n", slots_of(step));
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
