/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Regions whose matrices the target makes when it meets them, and keeps for a while: what A of a region is the sum of,
 * and the place for what is made of it. */
#include "inner.h"
#include "emit/text.h"
#include "model/contacts/contacts.h"
#include "step/regions/guards.h"

/* ---- what a region's A is the sum of ---- */

struct summed { int row, column, constant; bool negative; };
struct sums {
	int constants, places;
	mpq_t *constant;
	struct summed *place;
};

static int constant_of(struct sums *all, mpq_srcptr value)
{
	int k = 0;
	while (k < all->constants && !mpq_equal(all->constant[k], value))
		k++;
	if (k == all->constants) {
		mpq_t *new = MORE(all->constant, all->constants);
		mpq_init(*new);
		mpq_set(*new, value);
	}
	return k;
}

/* A, less A of the first region where it is another; how many places */
static int add_places(struct sums *all, const struct emitter *e, int region)
{
	const struct switching *s = e->model->switching;
	const int size = e->step->layout.size, before = all->places, first = region - region % regions_at_once(s);
	const mpq_t *A = augmented_matrix(&e->step->layout, &s->system[s->region[region].system], 0);
	const mpq_t *A0 = augmented_matrix(&e->step->layout, &s->system[s->region[first].system], 0);
	RATIONAL part = ZERO;
	for (int i = 0; i < size * size; i++) {
		mpq_set(part, A[i]);
		if (region > first)
			mpq_sub(part, A[i], A0[i]);
		const bool negative = mpq_sgn(part) < 0;
		mpq_abs(part, part);
		if (mpq_sgn(part) != 0)
			*MORE(all->place, all->places) =
				(struct summed){ i / size, i % size, constant_of(all, part), negative };
	}
	return all->places - before;
}

static void emit_constants(const struct emitter *e, const struct sums *all)
{
	open_table(e, "pl_two", "constant", format("[%d]", all->constants + 1),
		   "Sizes of the entries below, in two words");
	for (int i = 0; i < all->constants; i++) {
		const struct coefficient c = equation_number(e->model, all->constant[i]);
		say(e, "    {%s, %s},\n", shortest(c.value), shortest(c.low));
	}
	say(e, "    {0.0, 0.0}\n");
	close_table(e);
}

static void emit_places(const struct emitter *e, const struct sums *all)
{
	open_table(e, "pl_place", "summed", format("[%d]", all->places + 1),
		   "Entries of A, or added to it: row, column, number of the constant, 1: negative");
	for (int i = 0; i < all->places; i++)
		say(e, "%s{%d, %d, %d, %d},%s", i % 5 ? " " : "    ", all->place[i].row, all->place[i].column,
		    all->place[i].constant, all->place[i].negative, i % 5 == 4 ? "\n" : "");
	say(e, "%s{0, 0, 0, 0}\n", all->places % 5 ? " " : "    ");
	close_table(e);
}

static void emit_sums(const struct emitter *e)
{
	const struct switching *s = e->model->switching;
	const int size = e->step->layout.size;
	struct sums all = { 0 };
	SCRATCH int *count = ARRAY(int, s->regions);
	for (int r = 0; r < s->regions; r++)
		count[r] = add_places(&all, e, r);
	if (all.constants > LIMIT_FORMULAS)
		error(e->model->request.at.step, NULL, "matrices of regions are sums of %d numbers, of at most %d",
		      all.constants, LIMIT_FORMULAS);
	emit_constants(e, &all);
	emit_places(e, &all);
	open_table(e, "pl_entries", "sum", format("[%d]", s->regions),
		   format("A of x' = A x in the lowest interval of all switching functions, then what interval 1, 2, "
			  "... of each adds%s; x = states, load states, inputs",
			  s->segments > 1 ? ", in each segment of time" : ""));
	for (int r = 0, first = 0; r < s->regions; first += count[r++])
		say(e, "    {%d, %d, %d, $o_summed + %d}%s\n", size, size, count[r], first,
		    r + 1 < s->regions ? "," : "");
	close_table(e);
}

static void put_places(const struct emitter *e, const char *name, const char *note, int count, int apart)
{
	SCRATCH int *first = ARRAY(int, count);
	for (int k = 0; k < count; k++)
		first[k] = k * apart;
	put_wholes(e, false, name, note, count, first);
}

void emit_cached(const struct emitter *e, const struct guards *g)
{
	const int slots = slots_of(e->step), rungs = room_for_rungs(e->step);
	int guards = 1, holds;
	emit_sums(e);
	put_places(e, "first_rung", "Number of the first, shortest, piece of each slot in rungs", slots, rungs);
	if (g) {
		most_in_region(e->step, &guards, &holds);
		emit_guards_beside(e, g);
	}
	put_places(e, "bend_rung", "Number of the first row of bend for each guard function", g ? slots * guards : 1,
		   rungs);
}

/* ---- where they are kept ---- */

static void emit_guard_members(const struct emitter *e)
{
	const int size = e->step->layout.size, slots = slots_of(e->step), rungs = room_for_rungs(e->step);
	int guards, holds;
	most_in_region(e->step, &guards, &holds);
	const int rows = slots * guards, values = slots * (holds > 0 ? holds : 1);
	say(e, "        pl_guard guard[%d];\n"
	       "        int count[%d], sets[%d], held[%d];\n"
	       "        double limit[%d], guard_amplitude[%d], guard_row[%d][%d], guard_tangent[%d][%d];\n",
	    rows, slots, 2 * slots, values, rows, rows, rows, size, rows, size);
	say(e, "        double guard_chord_error[%d][%d], guard_cubic_error[%d][%d], bend[%d][%d], value[%d][%d];\n",
	    rows, size, rows, size, rows * rungs, size, values, size);
}

void emit_cached_member(const struct emitter *e)
{
	const struct switching *s = e->model->switching;
	const int size = e->step->layout.size, slots = slots_of(e->step), rungs = room_for_rungs(e->step);
	if (!s->cached)
		return;
	say(e, "    struct {              /* of the regions met last; of each A, e^{A h}, shorter pieces, bounds */\n"
	       "        pl_slot slot[%d];\n"
	       "        uint32_t clock;\n"
	       "        int halvings[%d], spacing[%d];\n"
	       "        double slopes[%d][%d][%d], pieces[%d][%d][%d], rungs[%d][%d][%d];\n",
	    slots, slots, slots, slots, size, size, slots, size, size, slots * rungs, size + 1, size);
	say(e, "        double tangent[%d][%d][%d];\n", slots, s->functions, size);
	int rows = s->functions, holds;
	if (has_events(s)) {
		emit_guard_members(e);
		most_in_region(e->step, &rows, &holds);
	} else
		say(e, "        double chord_error[%d][%d][%d], cubic_error[%d][%d][%d], bend[%d][%d];\n", slots,
		    s->functions, size, slots, s->functions, size, slots * rungs * s->functions, size);
	say(e, "        pl_two work[PL_CACHED_WORK(%d, %d)];\n"
	       "    } cached;\n", size, rows);
}

void emit_cached_start(const struct emitter *e)
{
	if (e->model->switching->cached)
		say(e, "    for (i = 0; i < %d; i++) { s->cached.slot[i].region = -1; s->cached.slot[i].used = 0; }\n"
		       "    s->cached.clock = 0;\n", slots_of(e->step));
}

void emit_cached_macros(const struct emitter *e)
{
	say_macro(e, "SLOTS", integer_text(slots_of(e->step)));
	say_macro(e, "RUNGS", integer_text(room_for_rungs(e->step)));
	say_macro(e, "HALVINGS", integer_text(LIMIT_PIECES));
	if (!has_events(e->model->switching))
		return;
	int guards, holds;
	most_in_region(e->step, &guards, &holds);
	say_macro(e, "MOST_GUARDS", integer_text(guards));
	say_macro(e, "MOST_HOLDS", integer_text(holds));
}
