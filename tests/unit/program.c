/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Programs of steps broken by hand, each in one way, and recipes that ask for more than there is room for: each is
 * told, by the message that is meant; as they were built nothing is said of them. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>
#include <stdlib.h>
#include <string.h>
#include "step/exponential/inner.h"

static const char linear_spec[] = "model m\ncoord x, y\ninput u\ninit x = 1\n"
						  "x'' + 0.1*x' + 2*x - y = u\ny'' + 2*y - x = cos(3*t)\nstep 0.1\n";
static const char left_spec[] = "model m\ncoord x\ninit x = 1\nx'' + x + x^3 = cos(2*t)\nstep 0.1\n";
static const char regions_spec[] = "model m\ncoord x\ninit x = 1\nx'' + x + max(x, 0) = 0\nstep 0.1\n";
static const char large_spec[] = "model m\ncoord x[9]\ninit x[1] = 1\n"
				 "x[1]'' + 2*x[1] - x[2] = 0\nx[2]'' + 2*x[2] - x[3] = 0\nx[3]'' + 2*x[3] - x[4] = 0\n"
				 "x[4]'' + 2*x[4] - x[5] = 0\nx[5]'' + 2*x[5] - x[6] = 0\nx[6]'' + 2*x[6] - x[7] = 0\n"
				 "x[7]'' + 2*x[7] - x[8] = 0\nx[8]'' + 2*x[8] - x[9] = 0\nx[9]'' + 2*x[9] - x[1] = 0\n"
								 "step 0.1\n";

static struct step *step_of(const char *text, const char *scheme)
{
	const struct request request = { .scheme = scheme, .form = FORM_AUTO };
	struct source *source = NEW(struct source);
	*source = (struct source){ .name = "m.spec", .base = "m.spec", .text = text, .length = strlen(text) };
	struct model *model = model_build(parse_spec(source), &request);
	struct step *step = model ? step_build(model) : NULL;
	if (!step)
		diagnostics_print(stderr);
	assert_non_null(step);
	return step;
}

/* What is said when this is done; "": it runs to its end */
static const char *said_of(void (*work)(void *), void *context)
{
	char *text = NULL;
	size_t length;
	bool done = statement_guard(work, context);
	FILE *to = open_memstream(&text, &length);
	assert_non_null(to);
	diagnostics_print(to);
	fclose(to);
	const char *kept = format("%s", done ? "" : text);
	free(text);
	return kept;
}

static void check(void *context)
{
	program_check(context);
}

static void expect(const char *said, const char *what)
{
	if (!strstr(said, "internal error: the program of scheme") || !strstr(said, what))
		fail_msg("expected an internal error with '%s', found '%s'", what, said);
}

static void expect_nothing(const char *said)
{
	if (*said)
		fail_msg("expected nothing, found '%s'", said);
}

/* ---- programs ---- */

static struct action *action_of(struct step *step, int kind, int which)
{
	for (int i = 0; i < step->program->actions; i++)
		if ((int)step->program->action[i].kind == kind && which-- == 0)
			return &step->program->action[i];
	fail_msg("no action of kind %d", kind);
	return NULL;
}

static void stage_unwritten(struct step *s) { action_of(s, ACTION_REMAINDER, 1)->from = s->program->stages; }
static void stage_range(struct step *s) { action_of(s, ACTION_REMAINDER, 1)->from = s->program->stages + 1; }
static void stage_negative(struct step *s) { action_of(s, ACTION_REMAINDER, 1)->from = -1; }
static void plain_unwritten(struct step *s) { action_of(s, ACTION_SUM, 2)->plain = s->program->stages; }
static void left_unwritten(struct step *s) { action_of(s, ACTION_SUM, 1)->phi_weight[0].left = s->program->lefts - 1; }
static void left_range(struct step *s) { action_of(s, ACTION_SUM, 1)->phi_weight[0].left = s->program->lefts; }
static void plus_unwritten(struct step *s) { action_of(s, ACTION_COMBINE, 0)->plus = s->program->lefts - 1; }
static void minus_unwritten(struct step *s) { action_of(s, ACTION_COMBINE, 0)->minus = s->program->lefts - 1; }
static void left_twice(struct step *s) { action_of(s, ACTION_COMBINE, 0)->target = 0; }
static void left_target(struct step *s) { action_of(s, ACTION_REMAINDER, 0)->target = s->program->lefts; }
static void stage_target(struct step *s) { action_of(s, ACTION_SUM, 0)->target = s->program->stages + 1; }
static void stage_twice(struct step *s) { action_of(s, ACTION_SUM, 2)->target = action_of(s, ACTION_SUM, 1)->target; }
static void state_early(struct step *s) { action_of(s, ACTION_SUM, 0)->target = STAGE_STATE; }
static void state_never(struct step *s) { s->program->actions--; }
static void node_range(struct step *s) { action_of(s, ACTION_REMAINDER, 1)->node = s->program->nodes; }
static void table_range(struct step *s) { action_of(s, ACTION_SUM, 0)->flow = s->tables; }
static void no_Phi(struct step *s) { s->branch->table[1]->Phi = NULL; }
static void phi_weight_table(struct step *s) { action_of(s, ACTION_SUM, 1)->phi_weight[0].table = s->tables; }
static void phi_weight_range(struct step *s) { action_of(s, ACTION_SUM, 1)->phi_weight[0].phi_weight = 4; }
static void phi_weight_count(struct step *s) { action_of(s, ACTION_SUM, 1)->phi_weights = SUM_PHI_WEIGHTS + 1; }
static void phi_weight_gone(struct step *s) { s->branch->table[0]->phi_weight[0] = NULL; }
static void load_gone(struct step *s) { s->branch->table[0]->load = NULL; }
static void table_gone(struct step *s) { s->branch->table[1] = NULL; }
static void first_node(struct step *s) { mpq_set_ui(s->program->node[0], 1, 2); }
static void late_node(struct step *s) { mpq_set_ui(s->program->node[1], 3, 2); }
static void node_table(struct step *s) { s->program->node_table[1] = s->tables; }
static void nothing_summed(struct step *s) { action_of(s, ACTION_SUM, 0)->flow = NONE; }
static void kind_unknown(struct step *s) { s->program->action[0].kind = 17; }
static void no_reads(struct step *s) { s->program->reads = NULL; }
static void not_predicting(struct step *s) { s->program->predicts = false; }
static void half_range(struct step *s) { action_of(s, ACTION_PREDICT, 0)->half = s->program->nodes; }
static void input_gone(struct step *s) { s->branch->full->input = NULL; }
static void factor_gone(struct step *s) { s->program->assignment[1].term[0].factor = NULL; }
static void target_range(struct step *s) { s->program->assignment[1].target = 4; }
static void target_twice(struct step *s) { s->program->assignment[1].target = s->program->assignment[0].target; }
static void operand_range(struct step *s) { s->program->assignment[1].term[0].operand.index = 4; }
static void many_terms(struct step *s) { s->program->assignment[1].terms = 99; }
static void state_unmarked(struct step *s)
{
	s->program->reads[s->program->assignment[0].term[0].operand.index] = false;
}
static void loads_unmarked(struct step *s) { memset(s->program->uses, 0, (size_t)s->branch->full->columns); }
static void carried(struct step *s) { s->program->assignment[0].carried = true; }
static void tuned(struct step *s) { s->program->tuned = true; }
static void loops(struct step *s) { s->program->loops = true; }
static void group_twice(struct step *s) { s->program->group[0].state[1] = s->program->group[0].state[0]; }
static void group_short(struct step *s) { s->program->groups--; }
static void group_state(struct step *s) { s->program->group[0].state[0] = s->branch->full->states; }
static void group_load(struct step *s)
{
	struct group *g = &s->program->group[0];
	g->load = ARRAY(int, 1);
	g->loads = 1;
	g->load[0] = s->branch->full->columns;
}
static void loop_in_order(struct step *s) { s->program->in_order = true; }
static void region_gone(struct step *s) { s->branches--; }
static void region_table(struct step *s) { s->branch[1].table = NULL; }
static void pieces(struct step *s) { s->branch[1].halvings = -1; }
static void no_series(struct step *s) { s->series.emitted = false; }

static const struct fault {
	const char *spec, *scheme;
	void (*inflict)(struct step *);
	const char *said;
} faults[] = {
	{ left_spec, "etdrk4", stage_unwritten, "reads a stage that is not written" },
	{ left_spec, "etdrk4", stage_range, "reads a stage that is out of range" },
	{ left_spec, "etdrk4", stage_negative, "reads a stage that is out of range" },
	{ left_spec, "etdrk4", plain_unwritten, "reads a stage that is not written" },
	{ left_spec, "etdrk4", left_unwritten, "reads a remainder that is not written" },
	{ left_spec, "etdrk4", left_range, "reads a remainder that is out of range" },
	{ left_spec, "etdrk4", plus_unwritten, "reads a remainder that is not written" },
	{ left_spec, "etdrk4", minus_unwritten, "reads a remainder that is not written" },
	{ left_spec, "etdrk4", left_twice, "its target is written before" },
	{ left_spec, "etdrk4", left_target, "its target is no remainder" },
	{ left_spec, "etdrk4", stage_target, "its target is no stage" },
	{ left_spec, "etdrk4", stage_twice, "its target is written before" },
	{ left_spec, "etdrk4", state_early, "it comes after the state is written" },
	{ left_spec, "etdrk4", state_never, "the state is never written" },
	{ left_spec, "etdrk4", node_range, "its node is out of range" },
	{ left_spec, "etdrk4", table_range, "its table is out of range" },
	{ left_spec, "etdrk4", no_Phi, "a table without its Phi" },
	{ left_spec, "etdrk4", phi_weight_table, "the table of a phi-function weight is out of range" },
	{ left_spec, "etdrk4", phi_weight_range, "a phi-function weight is out of range" },
	{ left_spec, "etdrk4", phi_weight_count, "more phi-function weights than the limit" },
	{ left_spec, "etdrk4", phi_weight_gone, "a table without one of its phi-function weights" },
	{ left_spec, "etdrk4", load_gone, "a table without the columns of its loads" },
	{ left_spec, "etdrk4", table_gone, "a table is not there" },
	{ left_spec, "etdrk4", first_node, "nodes: the first is not 0" },
	{ left_spec, "etdrk4", late_node, "nodes: one is outside the step" },
	{ left_spec, "bm3", node_table, "nodes: the table of one is out of range" },
	{ left_spec, "etdrk4", nothing_summed, "a sum of nothing" },
	{ left_spec, "etdrk4", kind_unknown, "an action of no known kind" },
	{ left_spec, "etdrk4", no_reads, "it does not say what it reads" },
	{ left_spec, "bm3", not_predicting, "not marked for them" },
	{ left_spec, "bm3", half_range, "its node is out of range" },
	{ linear_spec, NULL, input_gone, "a table without the columns of its inputs" },
	{ linear_spec, NULL, factor_gone, "assignment 1: a term without its factor" },
	{ linear_spec, NULL, target_range, "assignment 1: its target is out of range" },
	{ linear_spec, NULL, target_twice, "assignment 1: its target is written before" },
	{ linear_spec, NULL, operand_range, "assignment 1: a term whose operand is out of range" },
	{ linear_spec, NULL, many_terms, "assignment 1: its number of terms is out of range" },
	{ linear_spec, NULL, state_unmarked, "not marked as read" },
	{ linear_spec, NULL, loads_unmarked, "a load is read that is not marked as used" },
	{ linear_spec, NULL, carried, "no place for that" },
	{ linear_spec, NULL, tuned, "there are none" },
	{ linear_spec, NULL, loops, "loops over groups, or it has none" },
	{ large_spec, NULL, group_twice, "a state is stepped twice" },
	{ large_spec, NULL, group_short, "loops over groups, or it has none" },
	{ large_spec, NULL, group_state, "a state that is out of range" },
	{ large_spec, NULL, group_load, "a load that is out of range" },
	{ large_spec, NULL, loop_in_order, "a form that is not built with loops" },
	{ regions_spec, NULL, region_gone, "regions: one without its tables" },
	{ regions_spec, NULL, region_table, "a branch without tables" },
	{ regions_spec, NULL, pieces, "pieces of a step that are out of range" },
	{ regions_spec, NULL, no_series, "no series to find crossings by" }
};

enum { FAULTS = sizeof faults / sizeof *faults };

/* Once something was said no model is built any more: all that is broken is built before. */
static struct step *broken[FAULTS], *plain;

static int build_all(void **state)
{
	(void)state;
	for (int i = 0; i < FAULTS; i++)
		broken[i] = step_of(faults[i].spec, faults[i].scheme);
	plain = step_of(left_spec, "etdrk4");
	return 0;
}

static void each_violation_is_told(void **state)
{
	(void)state;
	for (int i = 0; i < FAULTS; i++) {
		expect_nothing(said_of(check, broken[i]));
		faults[i].inflict(broken[i]);
		expect(said_of(check, broken[i]), faults[i].said);
	}
}

static void whole_programs_are_passed(void **state)
{
	(void)state;
	for (int scheme = 0; scheme < SCHEMES; scheme++) {
		expect_nothing(said_of(check, step_of(linear_spec, scheme_name(scheme))));
		if (scheme != SCHEME_EXACT)
			expect_nothing(said_of(check, step_of(left_spec, scheme_name(scheme))));
	}
	expect_nothing(said_of(check, step_of(regions_spec, NULL)));
	expect_nothing(said_of(check, step_of(large_spec, NULL)));
}

/* ---- recipes ---- */

static void five_phi_weights(void *context)
{
	int table = add_table(context, "full", 1, 1, true);
	for (int k = 0; k < 5; k++)
		add_phi(context, table, "p", 1, 1, 1, (long[]){ 1 });
}

static void three_parts(void *context)
{
	int table = add_table(context, "full", 1, 1, true),
		phi_weight = add_phi(context, table, "p", 1, 1, 1, (long[]){ 1 });
	for (int k = 0; k < 2; k++)
		add_phi_part(context, table, phi_weight, 1, 2, 1, (long[]){ 1 });
}

static void four_powers(void *context)
{
	add_phi(context, add_table(context, "full", 1, 1, true), "p", 1, 1, 4, (long[]){ 1, 1, 1, 1 });
}

static void nine_tables(void *context)
{
	for (int k = 0; k < 9; k++)
		add_table(context, "t", 1, 1, true);
}

static void five_terms(void *context)
{
	int table = add_table(context, "full", 1, 1, true), p = add_phi(context, table, "p", 1, 1, 1, (long[]){ 1 });
	int r0 = add_remainder(context, add_node(context, 0, 1), STAGE_STATE);
	struct action *sum = add_sum(context, STAGE_STATE, table, NONE, "");
	for (int k = 0; k < 5; k++)
		times_left(context, sum, table, p, r0);
}

/* As many as there is room for */
static void all_that_fits(void *context)
{
	static const char *const names[] = { "a", "b", "c", "d" };
	struct recipe *r = context;
	for (int t = 0; t < RECIPE_TABLES; t++)
		add_table(r, "t", 1, 1, true);
	for (int k = 0; k < TABLE_PHI_WEIGHTS; k++)
		add_phi_part(r, 0, add_phi(r, 0, names[k], 1, 1, 3, (long[]){ 1, 2, 3 }), 1, 2, 3, (long[]){ 1, 2, 3 });
	int r0 = add_remainder(r, add_node(r, 0, 1), STAGE_STATE);
	struct action *sum = add_sum(r, STAGE_STATE, 0, NONE, "");
	for (int k = 0; k < SUM_PHI_WEIGHTS; k++)
		times_left(r, sum, 0, k % TABLE_PHI_WEIGHTS, r0);
}

static const char *said_of_recipe(void (*write)(void *))
{
	struct recipe *recipe = NEW(struct recipe);
	recipe->step = plain;
	recipe->program = NEW(struct program);
	return said_of(write, recipe);
}

static void recipes_have_limits(void **state)
{
	(void)state;
	expect(said_of_recipe(five_phi_weights), "more phi-function weights of a table than the limit of 4");
	expect(said_of_recipe(three_parts), "more parts of a phi-function weight than the limit of 2");
	expect(said_of_recipe(four_powers), "more powers in a part of a phi-function weight than the limit of 3");
	expect(said_of_recipe(nine_tables), "more tables than the limit of 8");
	expect(said_of_recipe(five_terms), "more phi-function weights in a sum than the limit of 4");
	expect_nothing(said_of_recipe(all_that_fits));
}

/* ---- rows ---- */

static void rows_are_whole(void **state)
{
	(void)state;
	int defaults = 0;
	for (int i = 0; i < SCHEMES; i++) {
		const struct scheme_row *row = scheme_row((enum scheme)i);
		enum scheme found;
		assert_non_null(row->name);
		assert_true(scheme_of(row->name, &found) && (int)found == i);
		/* that of one that expands, or has stages, is asked for, or found */
		assert_int_equal(row->order > 0, i != SCHEME_EXACT && !row->expands && !row->stages);
		assert_int_equal(row->modes, row->points > 0 || row->stages > 0);
		assert_true(!row->expands || (row->leaves && !row->predicts && !row->holds_remainder));
		assert_int_equal(row->leaves || row->holds_coupling, i != SCHEME_EXACT);
		if (i != SCHEME_EXACT) {
			assert_non_null(row->method);
			assert_non_null(row->citation);
		}
		assert_true(!row->predicts || row->leaves);
		defaults += row->by_default;
	}
	assert_int_equal(defaults, 1);
	assert_true(scheme_row(default_scheme())->leaves);
}

int main(void)
{
	static const struct CMUnitTest tests[] = {
		cmocka_unit_test(whole_programs_are_passed), cmocka_unit_test(each_violation_is_told),
		cmocka_unit_test(recipes_have_limits), cmocka_unit_test(rows_are_whole)
	};
	memory_open();
	const int status = cmocka_run_group_tests(tests, build_all, NULL);
	memory_close();
	return status;
}
