/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A scheme with a remainder that goes from crossing to crossing: between two of them the formulas are those of given
 * intervals. Each step is looked at from both ends, where values and slopes of what is compared are known; one that
 * crosses a breakpoint is made again in parts, whose tables the target makes. */
#include "model/contacts/contacts.h"
#include "step/contacts/series_contacts.h"
#include "step/cost.h"
#include "step/series/switching.h"
#include "step/series/expansion.h"

#include <math.h>

/* Two derivatives at the start decide where a state on a breakpoint is heading, four what sticks, rests and slips; the
 * cubic of a whole step is believed where no pole turns by more than TURN in it. */
enum { LOOKED = 2, AT_EVENTS = 4, TURN = 2 };

static double *slopes_in(const struct step *step, const struct layout *layout, int segment)
{
	size_t cells = (size_t)layout->size * (size_t)layout->size;
	RATIONALS *exact = augmented_matrix(layout, &step->branch->system, segment);
	double *A = ARRAY(double, cells);
	for (size_t i = 0; i < cells; i++) {
		A[i] = round_rational(exact[i]);
		if (!isfinite(A[i]))
			report_range(step);
	}
	return A;
}

/* Above the size of every pole of |A|, which has no entry below 0: max (|A| v)_i / v_i for any v above 0; a few
 * products bring v near to that which makes it least. */
static double fastest_of(int size, const double *A)
{
	enum { PRODUCTS = 60 };
	const double least = 0x1p-80;
	double *v = ARRAY(double, size), *next = ARRAY(double, size), largest_entry = 0, most = 0;
	for (int i = 0; i < size * size; i++)
		largest_entry = fmax(largest_entry, fabs(A[i]));
	const double shift = largest_entry * 0x1p-20;   /* or it would not settle */
	for (int i = 0; i < size; i++)
		v[i] = 1;
	for (int k = 0; k < PRODUCTS; k++) {
		double largest = 0;
		most = 0;
		for (int i = 0; i < size; i++) {
			next[i] = shift * v[i];
			for (int j = 0; j < size; j++)
				next[i] += fabs(A[i * size + j]) * v[j];
			largest = fmax(largest, next[i]);
			most = fmax(most, next[i] / v[i]);
		}
		for (int i = 0; i < size; i++)
			v[i] = fmax(largest > 0 ? next[i] / largest : 1, least);
	}
	return most * (1 + 0x1p-20);
}

static bool *acting_loads(const struct linear *system)
{
	bool *acting = ARRAY(bool, system->loads);
	for (int l = 0; l < system->loads; l++)
		acting[l] = load_acts(system, &system->load[l]);
	return acting;
}

/* Expressions and, beside contacts, what is watched there */
static int *watched_sequences(const struct expansion *x, int *count)
{
	const int watches = x->contacts ? x->contacts->watches : 0;
	*count = x->functions + watches;
	int *sequence = ARRAY(int, *count);
	for (int i = 0; i < *count; i++)
		sequence[i] = i < x->functions ? x->function[i].sequence
						 : x->contacts->watch[i - x->functions].sequence;
	return sequence;
}

static void count_checks(const struct step *step, struct event_split *event_split)
{
	const struct linear *system = &step->branch->system;
	struct program program = { .uses = ARRAY(bool, step->branch->full->columns) };
	struct step view = *step;
	view.taylor.expansion = event_split->ends;
	count_expansion(&view, &program);
	int looks = system->inputs > 0 || loads_change(system) ? 2 : 1; /* else the one at the end is kept */
	event_split->multiplications = looks * program.multiplications;
	event_split->additions = looks * program.additions;
	event_split->calls = looks * program.calls;
}

/* The step of a scheme that holds coupling, and does not in a part */
static struct step *coupled(const struct step *step)
{
	struct step *made = NEW(struct step);
	*made = *step;
	made->branch = NEW(struct branch);
	*made->branch = *step->branch;
	made->branch->system = operator_system(step->model, 0);
	return made;
}

void plan_event_split(struct step *held)
{
	struct step *step = scheme_row(held->model->scheme)->holds_coupling ? coupled(held) : held;
	const struct linear *system = &step->branch->system;
	struct event_split *event_split = NEW(struct event_split);
	int watched;
	event_split->event_check = expansion_with_forces(step, has_contacts(step->model) ? AT_EVENTS : LOOKED);
	int *sequence = watched_sequences(event_split->event_check, &watched);
	event_split->ends = part_of_expansion(step, event_split->event_check, 1, watched, sequence);
	event_split->forces = part_of_expansion(step, event_split->event_check, 0, system->force_columns,
						event_split->event_check->held);
	event_split->layout = layout_with(system, SPLIT_POWERS, acting_loads(system));
	event_split->slopes = ARRAY(double *, system->segments);
	for (int s = 0; s < system->segments; s++) {
		event_split->slopes[s] = slopes_in(step, &event_split->layout, s);
		event_split->fastest =
			fmax(event_split->fastest, fastest_of(event_split->layout.size, event_split->slopes[s]));
	}
	double turn = event_split->fastest * mpq_get_d(step->model->h);
	event_split->certain = turn > TURN ? 1 / turn : 1;
	if (step->model->request.single)
		event_split->fastest = (double)(float)event_split->fastest;
	count_checks(step, event_split);
	event_split->kilobytes =
		1 + PL_EVENT_SPLIT_ROOM(event_split->layout.size) * 2 * (step->model->request.single ? 4 : 8) / 1024;
	held->event_split = event_split;
	held->taylor.switching = event_split->event_check;
	held->series.emitted = true;
}
