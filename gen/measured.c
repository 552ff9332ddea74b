/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Needs of models that no bound is known for: what is not linear, or piecewise linear. Schemes, steps and tolerances
 * that the spec leaves open are tried: the C of each runs beside a reference of the equations as written, from the
 * spec's start and from its neighbours, and the cheapest that meets all needs is taken. It is measured, not
 * certified. */
#include "measuring.h"
#include "model/checks.h"
#include "report/report.h"
#include "step/certify/certify.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* No step is tried that is likely to cost so many times what the cheapest costs that met all needs. */
static const double expensive = 2;

/* ---- steps and tolerances of a scheme ---- */

static struct alternative tried_step(struct measuring *m, struct alternative a, double h)
{
	a.step = round_step(h);
	try_alternative(m, &a);
	return a;
}

/* The longest step that meets the needs: from the error of one the next is guessed by the scheme's order. */
static void try_steps(struct measuring *m, struct alternative a)
{
	enum scheme scheme = SCHEME_EXACT;
	scheme_of(a.scheme ? a.scheme : scheme_name(m->model->scheme), &scheme);
	const int order = scheme_row(scheme)->order > 0 ? scheme_row(scheme)->order : 4;
	double h = m->longest, missing = HUGE_VAL, meeting = 0;
	int refused = 0;
	for (int tried = 0; tried < MOST_TRIED; tried++) {
		const double now = strtod(round_step(h), NULL);
		const struct alternative one = tried_step(m, a, h);
		const double error_ratio = one.error_ratio;
		if (one.refused && ++refused == 2)              /* a step that is too long for it may be one reason */
			return;
		if (is_enough(m, &one))
			meeting = fmax(meeting, now);
		else
			missing = fmin(missing, now);
		const double by = isfinite(error_ratio) ? pow(0.9 / error_ratio, 1.0 / order) : 0.2;
		if (meeting == 0)
			h = now * fmax(fmin(by, 0.6), 0.02);
		else if (missing == HUGE_VAL)
			return;
		else
			h = meeting * 2.6;
		const double next = strtod(round_step(h), NULL);
		if (one.cost * now / next > expensive * m->cheapest)
			return;
		if (next >= missing || next == meeting || m->until / next > MOST_SAMPLES)
			return;
	}
}

static void try_scheme_in(struct measuring *m, const char *scheme, bool single)
{
	static const char *const tolerances[] = { "1e-3", "1e-4", "1e-5", "1e-6", "1e-7", "1e-8", "1e-9", "1e-10",
						  "1e-11", "1e-12", "1e-13" };
	const struct spec *spec = m->model->spec;
	enum scheme row = m->model->scheme;
	if (scheme)
		scheme_of(scheme, &row);
	const bool step_open = m->request->step_open;
	struct alternative a = { .scheme = scheme, .single = single, .form = FORM_DIRECT };
	if (!scheme_row(row)->expands || m->request->tolerance || spec->request.tolerance) {
		if (step_open)
			try_steps(m, a);
		else
			try_alternative(m, &a);
		return;
	}
	for (size_t i = 0; i < sizeof tolerances / sizeof *tolerances; i++) {
		struct alternative one = a;
		one.tolerance = tolerances[i];
		if (step_open)
			one = tried_step(m, one, m->longest);
		else
			try_alternative(m, &one);
		if (one.refused || is_enough(m, &one) || one.cost > expensive * m->cheapest)
			return;
	}
}

/* In float and in double, unless one is asked for. What is tried stays in memory: with a fifth of it used, one that
 * meets all needs is enough. */
static void try_scheme(struct measuring *m, const char *scheme)
{
	for (int single = 1; single >= 0 && (memory_used() < 0.2 || !isfinite(m->cheapest)); single--)
		if (!m->request->real_given || m->request->single == single)
			try_scheme_in(m, scheme, single);
}

/* ---- the choice ---- */

static void try_schemes(struct measuring *m)
{
	const struct spec *spec = m->model->spec;
	if (m->request->scheme || spec->request.scheme) {
		try_scheme(m, NULL);
		return;
	}
	if (m->model->switching || m->model->remainder.force_columns == 0)
		try_scheme(m, scheme_name(SCHEME_EXACT));
	if (m->model->remainder.force_columns == 0 && !m->model->switching)
		return;
	/* What is likely to do comes first: what is dearer is not tried. */
	for (int likely = 1; likely >= 0; likely--)
		for (int i = 0; i < SCHEMES; i++) {
			const struct scheme_row *row = scheme_row((enum scheme)i);
			if (row->leaves && likely == (row->by_default || (row->expands && !row->collocates)))
				try_scheme(m, row->name);
		}
}

static void find_taken(struct measuring *m)
{
	struct choice *choice = m->choice;
	choice->taken = -1;
	for (int i = 0; i < choice->alternatives && choice->taken < 0; i++) {
		struct alternative *a = &choice->alternative[i];
		if (!meets(a))
			continue;
		try_neighbours(m, a);
		if (meets(a))
			choice->taken = i;
	}
}

/* Where all that meets the needs from the start misses them from a neighbour, all is tried with twice the room. */
static void choose(struct measuring *m)
{
	struct choice *choice = m->choice;
	for (m->within = WITHIN; m->within > WITHIN / 16; m->within /= 2) {
		bool near = false;
		choice->alternatives = 0;
		m->cheapest = HUGE_VAL;
		try_schemes(m);
		sort_by_cost(choice);
		find_taken(m);
		for (int i = 0; i < choice->alternatives; i++)
			near = near || choice->alternative[i].worst_neighbour > WITHIN;
		if (choice->taken >= 0 || !near)
			return;
	}
}

static void report_unmet(const struct measuring *m)
{
	const struct alternative *best = most_exact(m->choice, HUGE_VAL);
	const struct alternative *any = m->choice->alternatives > 0 ? m->choice->alternative : NULL;
	const struct place at = m->model->needs.requirement[0].need->at;
	if (!best)
		say_error(at, NULL, "the need cannot be measured: %s",
			  any ? (any->refused ? any->refused : any->why) : "there is no scheme for the model");
	else if (best->error_ratio <= WITHIN)
		say_error(at, NULL,
			  "the need cannot be met: %s meets it from the spec's start, and misses it by a factor of "
			  "%.3g where %s", alternative_text(best), best->worst_neighbour, best->worst_name);
	else
		say_error(at,
			  m->request->step_open || m->model->system.inputs > 0 ? NULL : "without 'step' one is chosen",
			  "the need cannot be met: the best that was measured, %s, misses it by a factor of %.3g",
			  alternative_text(best), best->error_ratio);
}

static bool is_over_budget(const struct measuring *m, const struct alternative *taken)
{
	if (!m->model->needs.target || taken->step_cost <= m->model->needs.budget)
		return false;
	say_error(m->model->spec->required.budget.at, "a shorter step of a scheme of lower order may take fewer each",
		  "over budget: the cheapest that meets the need takes some %.0f instructions a step (%s), %.0f more "
		  "than %.0f, or %.3g times as many",
		  taken->step_cost, alternative_text(taken), taken->step_cost - m->model->needs.budget,
		  m->model->needs.budget, taken->step_cost / m->model->needs.budget);
	return true;
}

struct step *choose_measured(struct model *stepped, struct request *request)
{
	struct measuring m = { .model = stepped, .request = request, .single = request->single,
			       .choice = NEW(struct choice) };
	const struct place at = stepped->spec->required.need[0].at;
	if (!find_requirements(stepped))
		return NULL;
	m.largest = ARRAY(double, stepped->needs.requirements);
	m.until = longest_need(stepped);
	if (!(m.until > 0)) {
		say_error(at, NULL, "a need that is measured ends after 0");
		return NULL;
	}
	if (!open_reference(&m)) {
		say_error(at, NULL, "the need cannot be measured: %s", m.why);
		return NULL;
	}
	choose(&m);
	if (m.choice->taken < 0) {
		report_unmet(&m);
		return NULL;
	}
	const struct alternative *taken = &m.choice->alternative[m.choice->taken];
	if (is_over_budget(&m, taken))
		return NULL;
	*request = request_of(&m, taken);
	m.single = request->single;
	struct step *step = built(&m, request, &m.why);
	if (step)
		step->choice = m.choice;
	return step;
}
