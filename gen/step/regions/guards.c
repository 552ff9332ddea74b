/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Of regions with dry friction: what ends each of them, and what holds states there. A guard is a row over x: of a
 * switching function that comes to an end of its interval, or of a force that comes to what friction can hold. */
#include "inner.h"
#include "model/contacts/friction.h"
#include "guards.h"

#include <math.h>
#include <string.h>

static bool same_guard(const struct guard_key *a, const struct guard_key *b)
{
	return a->function == b->function && a->region == b->region && a->release == b->release &&
	       a->upward == b->upward && a->segment == b->segment;
}

/* The index of a row of a branch; equal ones are one, of tunable params those that are the same */
static int add_row(struct guards *g, int size, int branch, const double *row, struct guard_key guard_row)
{
	size_t bytes = (size_t)size * sizeof *row;
	for (int i = 0; i < g->rows; i++)
		if (g->branch[i] == branch && memcmp(g->row + i * size, row, bytes) == 0 &&
		    (!g->apart || same_guard(&g->guard_row[i], &guard_row)))
			return i;
	ENLARGE(g->branch, (size_t)g->rows + 1);
	ENLARGE(g->guard_row, (size_t)g->rows + 1);
	g->guard_row[g->rows] = guard_row;
	ENLARGE(g->row, (size_t)(g->rows + 1) * (size_t)size);
	memcpy(g->row + g->rows * size, row, bytes);
	g->branch[g->rows] = branch;
	return g->rows++;
}

static void add_guard(struct guards *g, int size, int branch, const double *row, struct guard_key guard_row,
		      struct guard guard)
{
	guard.row = add_row(g, size, branch, row, guard_row);
	*MORE(g->guard, g->guards) = guard;
}

static double *reversed(int size, const double *row, bool upward)
{
	double *result = ARRAY(double, size);
	for (int j = 0; j < size; j++)
		result[j] = upward || row[j] == 0 ? row[j] : -row[j];
	return result;
}

/* The ends of an interval of a switching function */
static void guard_interval(const struct step *step, const struct pieces *pieces, struct guards *g, int region,
			   int function, int first)
{
	const struct switching *s = step->model->switching;
	const struct switching_function *e = &s->function[function];
	int size = step->layout.size, interval = interval_of(s, region, function);
	int segment = segment_of_region(s, region);
	for (int upward = 0; upward < 2; upward++) {
		int breakpoint = interval - !upward;
		if (breakpoint < 0 || breakpoint == e->breaks || is_released(&s->region[region], function, upward))
			continue;
		double at = pieces->breakpoint[first + breakpoint];
		struct guard guard = { .function = function,
				       .breakpoint = breakpoint,
				       .upward = upward,
				       .leads = upward ? e->stride : -e->stride,
				       .release = -1,
				       .limit = upward || at == 0 ? at : -at,
				       .impact = impact_at(s, segment, function, e->at[breakpoint], upward) };
		if (guard.impact < 0 && impact_resting(s, segment, function, interval + (upward ? 1 : -1)) >= 0)
			guard.leads *= 2;       /* past the interval of rest, which impacts alone lead to */
		add_guard(g, size, s->region[region].system,
			  reversed(size, pieces->rows[segment] + function * size, upward),
			  (struct guard_key){ .function = function, .upward = upward, .segment = segment }, guard);
	}
}

/* What releases a switching function that is held */
static void guard_releases(const struct step *step, struct guards *g, int region, int function)
{
	const struct switching *s = step->model->switching;
	int stride = s->function[function].stride, interval = interval_of(s, region, function);
	for (int k = 0; k < s->region[region].releases; k++) {
		const struct release *release = &s->region[region].release[k];
		double *row = ARRAY(double, step->layout.size);
		if (release->function != function)
			continue;
		row_over_x(step, release->row, 0, row);
		add_guard(g, step->layout.size, s->region[region].system, row,
			  (struct guard_key){ .function = -1, .region = region, .release = k },
			  (struct guard){ .function = function,
					  .breakpoint = interval - !release->upward,
					  .upward = release->upward,
					  .leads = release->upward ? stride : -stride,
					  .impact = -1,
					  .release = k });
	}
}

static void add_assignment(const struct step *step, struct guards *g, int state, const struct output *row,
			   enum retuned_kind kind, int of)
{
	struct held_state new = { state, ARRAY(double, 2 * (size_t)step->layout.size), kind, of,
				  g->assignments - g->set[g->sets] };
	row_in_words(step, row, 0, new.value);
	*MORE(g->assignment, g->assignments) = new;
}

static int end_set(struct guards *g)
{
	ENLARGE(g->set, (size_t)g->sets + 2);
	g->set[++g->sets] = g->assignments;
	return g->sets - 1;
}

static void hold_region(const struct step *step, struct guards *g, int region)
{
	const struct region *r = &step->model->switching->region[region];
	g->hold[region] = -1;
	if (!r->possible || r->holds == 0)
		return;
	g->hold[region] = g->sets;
	for (int k = 0; k < r->holds; k++)
		add_assignment(step, g, r->hold[k].state, r->hold[k].row, RETUNED_HOLD, region);
	end_set(g);
}

static int set_of_jumps(const struct step *step, struct guards *g, int jumps, const struct jump *jump,
			enum retuned_kind kind, int impact)
{
	for (int k = 0; k < jumps; k++)
		add_assignment(step, g, jump[k].state, jump[k].row, kind, impact);
	return end_set(g);
}

static struct impact_row impact_in(const struct step *step, struct guards *g, int number, int segment)
{
	const struct switching *s = step->model->switching;
	const struct impact *impact = &s->impact[number];
	const struct impact_law *impact_law = &impact->in[segment];
	const struct switching_function *e = &s->function[impact_law->function];
	struct impact_row new = { .function = impact_law->function, .upward = impact_law->upward,
			      .rest = rest_of(s, segment, impact),
			      .still = -1, .restitution = round_rational(impact_law->restitution) };
	while (!mpq_equal(e->at[new.breakpoint], impact_law->at))
		new.breakpoint++;
	if (impact->bounces && !impact_law->upward)
		new.breakpoint++;               /* the upper of two */
	new.jump =
		set_of_jumps(step, g, impact_law->jumps, impact_law->jump, RETUNED_JUMP, segment * s->impacts + number);
	new.speed = ARRAY(double, step->layout.size);
	new.back = ARRAY(double, step->layout.size);
	RATIONAL part = ZERO;
	if (impact->bounces) {
		new.still = set_of_jumps(step, g, impact_law->jumps, impact_law->still, RETUNED_STILL,
					 segment * s->impacts + number);
		row_over_x(step, impact_law->speed_row, 0, new.speed);
		for (int j = 0; j < step->model->n; j++) {
			mpq_mul(part, impact_law->direction[j], impact_law->factor);
			new.back[j] = round_rational(part);
		}
	}
	new.amplitude = size_of_bounded(step, new.speed);
	return new;
}

/* In an instance each has as much room as any. */
static void add_reach(const struct step *step, const struct pieces *pieces, struct guards *g, int row)
{
	int branch = g->branch[row], size = step->layout.size, rungs = step->branch[branch].rungs;
	int room = step->model->params.retuned ? room_for_rungs(step) : rungs;
	SCRATCH double *reach = reach_of_rows(step, branch, pieces->piece[branch].slopes, 1, g->row + row * size);
	ENLARGE(g->reach, (size_t)((g->reaches + room) * size));
	for (int i = 0; i < room * size; i++)
		g->reach[g->reaches * size + i] = i < rungs * size ? reach[i] : 0;
	g->reach_at[row] = g->reaches;
	g->reaches += room;
}

static void bound_rows_of_guards(const struct step *step, const struct pieces *pieces, struct guards *g)
{
	size_t size = (size_t)step->layout.size, cells = (size_t)g->rows * size;
	g->slope = ARRAY(double, cells);
	g->second = ARRAY(double, cells);
	g->fourth = ARRAY(double, cells);
	g->reach_at = ARRAY(int, g->rows);
	for (int from = 0, to; from < g->rows; from = to) {
		for (to = from; to < g->rows && g->branch[to] == g->branch[from]; to++)
			;
		size_t at = (size_t)from * size;
		bounds_of_rows(step, pieces, g->branch[from], to - from, g->row + at, g->slope + at, g->second + at,
			       g->fourth + at);
		for (int i = from; i < to; i++)
			add_reach(step, pieces, g, i);
	}
}

/* What rounding may hide is 8 units in the last place of all terms, as in the search. */
static void add_rounding(const struct step *step, struct guards *g)
{
	const double rounding = 8 * ldexp(1, -52) * (1 + 1e-9);
	for (int i = 0; i < g->rows * step->layout.size; i++)
		g->second[i] += rounding * (fabs(g->row[i]) + 3 * fabs(g->slope[i]));
}

double *friction_forces_of(const struct step *step)
{
	const struct switching *s = step->model->switching;
	size_t size = (size_t)step->layout.size, count = (size_t)s->transmitted_forces;
	double *friction_force = ARRAY(double, (size_t)s->regions * count * size);
	for (int r = 0; r < s->regions; r++)
		for (int i = 0; i < s->transmitted_forces; i++)
			if (s->region[r].friction_force[i])
				row_over_x(step, s->region[r].friction_force[i], 0,
					   friction_force + ((size_t)r * count + (size_t)i) * size);
	return friction_force;
}

struct guards guards_of(const struct step *step, const struct pieces *pieces)
{
	const struct switching *s = step->model->switching;
	struct guards g = { .first = ARRAY(int, s->regions + 1), .hold = ARRAY(int, s->regions),
			    .set = ARRAY(int, 1), .apart = step->model->params.retuned };
	for (int r = 0; r < s->regions; r++) {
		g.first[r] = g.guards;
		hold_region(step, &g, r);
		for (int e = 0, first = 0; e < s->functions; first += s->function[e++].breaks)
			if (!s->region[r].possible ||
			    (s->cached && r % regions_at_once(s) > 0 && interval_of(s, r, e) == 0))
				continue;       /* those of the lowest interval stand in the lowest region */
			else {
				guard_releases(step, &g, r, e);
				if (!is_stick(&s->function[e], interval_of(s, r, e)))
					guard_interval(step, pieces, &g, r, e, first);
			}
	}
	g.first[s->regions] = g.guards;
	g.impacts = s->impacts;
	g.impact = ARRAY(struct impact_row, (size_t)(s->segments * s->impacts));
	for (int k = 0; k < s->segments; k++)
		for (int i = 0; i < s->impacts; i++)
			g.impact[k * s->impacts + i] = impact_in(step, &g, i, k);
	if (!s->cached)                         /* else the target does */
		bound_rows_of_guards(step, pieces, &g);
	g.amplitude = ARRAY(double, (size_t)(s->segments * s->functions));
	g.row_amplitude = ARRAY(double, g.rows);
	for (int k = 0; k < s->segments; k++)
		for (int e = 0; e < s->functions; e++)
			g.amplitude[k * s->functions + e] =
				size_of_bounded(step, pieces->rows[k] + e * step->layout.size);
	for (int i = 0; i < g.rows; i++)
		g.row_amplitude[i] = size_of_bounded(step, g.row + i * step->layout.size);
	if (step->regions.event_check.is_made)
		add_rounding(step, &g);
	return g;
}

/* From h down to 2^-23 h, where they rest, bounces become shorter by e each. Several contacts whose impacts act on each
 * other, take more. */
static int bounces_in_step(const struct model *model)
{
	enum { MOST = 480, SHORTER = 23 };
	double sum = 0;
	for (int i = 0; i < model->contacts.impacts; i++) {
		double most = 0;
		if (model->params.retuned && retuned_place(model->params.retuned, RETUNED_RESTITUTION, i, 0) >= 0)
			return MOST;            /* it may be anything */
		for (int s = 0; s < model->system.segments; s++) {
			double e = mpq_get_d(model->contacts.impact[i].in[s].restitution);
			if (model->contacts.impact[i].bounces && e > 0 && e < 1)
				most = fmax(most, ceil(SHORTER * log(2) / -log(e)));
		}
		sum += most;
	}
	return (int)fmin(model->contacts.impacts > 1 ? 2 * sum : sum, MOST);
}

void most_in_region(const struct step *step, int *guards, int *holds)
{
	const struct switching *s = step->model->switching;
	*guards = *holds = 0;
	for (int e = 0; e < s->functions; e++) {
		int most = 0, held = 0;
		for (int k = 0; k < s->segments * (s->function[e].breaks + 1); k++) {
			const struct region *r =
				&s->region[beside_lowest(s, k % s->segments, e, k / s->segments)];
			int own = 2, holding = 0;
			for (int i = 0; i < r->releases; i++)
				own += r->release[i].function == e;
			for (int i = 0; i < r->holds; i++)
				holding += owner_of_hold(s, r->hold[i].state) == e;
			most = own > most ? own : most;
			held = holding > held ? holding : held;
		}
		*guards += most;
		*holds += held;
	}
}

int max_events(const struct model *model)
{
	return model->most_events ? model->most_events : MAX_EVENTS + bounces_in_step(model);
}

int fast_path_events(const struct model *model)
{
	return max_events(model) < MOST_FAST_PATH ? max_events(model) : MOST_FAST_PATH;
}

int event_checks(const struct model *model)
{
	const int most = 2 * model->most_events + 2;
	return model->most_events && most < MOST_EVENT_CHECKS ? most : MOST_EVENT_CHECKS;
}

int most_in_step(const struct model *model)
{
	return model->most_events ? model->most_events : MOST_IN_STEP;
}

int max_splits(const struct model *model)
{
	enum { MANY = 8 };              /* so many switching functions, each of which is looked at after each event */
	const int functions = model->switching ? model->switching->functions : 0;
	return model->most_events ? LOOKS_OF_STEP + LOOKS_OF_EVENT * model->most_events
				  : MAX_SPLITS * (functions > MANY ? functions / 2 : 1) + 32 * bounces_in_step(model);
}
