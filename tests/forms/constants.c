/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Every constant in the code of a linear step, in each form, for double and for float, plain and in two words, bit for
 * bit:
 *
 *     constants [-n RANDOM] [-u UNDAMPED] [-s SEED] [-v] MODEL.spec ...
 *
 * The numbers are read from the C that is emitted: those of the step's own sums in the order in which they stand there,
 * and the tables Phi, Gamma, increment, load_factor and rotated.  What they ought to be says the judge (judge.h).  Each
 * variant runs in a process of its own.
 */
#include "judge.h"
#include "cases.h"
#include "constants.h"
#include "random_spec.h"
#include "emit/printed.h"
#include "model/linear/inner.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { LONGEST_CASE = 200, MISMATCHES_SHOWN = 10 };     /* seconds; lines */

static struct {
	const char *variant;
	int compared, failed;
	bool verbose;
} trial = { .variant = "" };

void complain(const char *what)
{
	if (trial.failed++ < MISMATCHES_SHOWN)
		printf("# %s: %s\n", trial.variant, what);
}

/* Warnings may stand before it */
static const char *first_error(void)
{
	const char *text = diagnostics(), *error = strstr(text, ": error: ");
	while (error && error > text && error[-1] != '\n')
		error--;
	return first_line(error ? error : text);
}

/* ---- a variant ---- */

struct variant {
	enum step_form form;
	bool compensated, single;
};

static const char *variant_name(const struct variant *v)
{
	return format("%s, form %s%s", v->single ? "float" : "double", step_form_name(v->form),
				  v->compensated ? ", compensated" : "");
}

/* What may move as a whole is judged twice: over the coordinates as written, and over those that plgen keeps. */
static const struct relative *kept;

static struct model *model_of(const char *text, const struct variant *v)
{
	struct request *request = NEW(struct request);
	*request =
		(struct request){ .form = v->form, .compensated = v->compensated, .single = v->single,
						  .fast = true, .phasors = true, .again.relative = kept };
	return model_build(spec_of("spec", text), request);
}

/* ---- what should stand there ---- */

struct wanting {
	const struct judge *judge;
	const struct step *step;
	const struct model *model;
	const struct variant *variant;
	struct list *list, low;         /* second words wait for the end of their sum */
	double least;                   /* what is smaller is not written */
};

static void want(struct wanting *w, const struct judged_number *number, bool alone, bool second, const char *what)
{
	double value, low;
	if (number->zero)
		return;
	if (!judge_words(number, w->variant->single, &value, &low))
		complain(format("%s: the judge cannot decide it", what));
	if (fabs(value) < w->least)
		return;
	if (alone || fabs(value) != 1)
		append(w->list, value, what);   /* a factor 1 is not written */
	if (second && low != 0 && (alone || fabs(low) != 1))
		append(&w->low, low, format("second word of %s", what));
}

/* After a sum */
static void want_second_words(struct wanting *w)
{
	for (int i = 0; i < w->low.count; i++)
		append(w->list, w->low.value[i], w->low.what[i]);
	w->low.count = 0;
}

static const char *state_name(const struct wanting *w, int state)
{
	return w->model->names.state[state];
}

static void want_places(struct wanting *w, const struct judged_number *row, const char *what, const char *target)
{
	for (int k = 0; k < w->judge->system->n; k++)
		want(w, &row[k], false, w->variant->compensated, format("%s of %s in "
			"%s", what, state_name(w, k), target));
}

static void want_loads_and_inputs(struct wanting *w, int i)
{
	const struct judge *j = w->judge;
	const struct linear *system = j->system;
	const bool changes = system->segments > 1;
	for (int l = 0, column = 0; l < system->loads; l++)
		for (int k = 0; k < system->load[l].columns; k++, column++) {
			const struct forcing *forcing = system->load[l].forcing;
			const bool constant = k == 0 && !mpq_sgn(forcing->a) && !mpq_sgn(forcing->w);
			const struct judged_number *number = &j->step[i * j->columns + j->states + column];
			if (!changes && !is_refreshed(w->step, l) && !is_forced(w->step, column))
				want(w, number, constant, w->variant->compensated,
					 format("load column %d in %s", column, state_name(w, i)));
		}
	for (int k = 0; k < j->inputs; k++)
		want(w, &j->step[i * j->columns + j->states + j->loads + k], false, w->variant->compensated,
			 format("input column %d in %s", k, state_name(w, i)));
	want_second_words(w);
}

/* A factor of fewer bits than others counts for nothing beside one that is so much larger. */
static double least_of_row(const struct wanting *w, const struct judged_number *row)
{
	double largest = 0, value, low;
	for (int k = 0; k < w->judge->states; k++)
		if (!row[k].zero && judge_words(&row[k], w->variant->single, &value, &low))
			largest = fmax(largest, fabs(value));
	return w->variant->single ? fmin(FLT_MIN, 0x1p-50 * largest) : fmin(DBL_MIN, 0x1p-100 * largest);
}

static void want_rows(struct wanting *w)
{
	const struct judge *j = w->judge;
	const struct linear *system = j->system;
	for (int i = 0; i < j->states; i++) {
		const struct judged_number *row = w->variant->form == FORM_DIRECT ? &j->step[i * j->columns]
										  : &j->increment[i * j->states];
		w->least = least_of_row(w, row);
		if (w->variant->form == FORM_DIRECT) {
			for (int k = 0; k < system->n; k++)
				want(w, &row[k], false, false, format("factor of %s in "
					"%s", state_name(w, k), state_name(w, i)));
		} else {
			want_places(w, row, "increment", state_name(w, i));
		}
		for (int k = system->n; k < j->states; k++)
			want(w, &row[k], false, w->variant->compensated,
				 format("factor of %s in %s", state_name(w, k), state_name(w, i)));
		w->least = 0;
		want_loads_and_inputs(w, i);
	}
}

static void want_kick(struct wanting *w, int i)
{
	const struct linear *system = w->judge->system;
	want_places(w, &w->judge->kick[i * system->n], "kick", state_name(w, system->velocity[i]));
	want_second_words(w);
}

/* A sum stands before the first one that reads it: a position's drift behind the first kicks of all of its block. */
static void want_kicks_of_block(struct wanting *w, int i, bool *kicked)
{
	for (int k = 0; k < w->judge->system->n; k++)
		if (!kicked[k] && w->judge->block[k] == w->judge->block[i]) {
			want_kick(w, k);
			kicked[k] = true;
		}
}

static void want_drift(struct wanting *w, int i)
{
	const struct linear *system = w->judge->system;
	for (int k = 0; k < system->n; k++)
		want(w, &w->judge->drift[i * system->n + k], false, w->variant->compensated,
			 format("drift of %s in %s", state_name(w, system->velocity[k]), state_name(w, i)));
	want_second_words(w);
	want_loads_and_inputs(w, i);
}

static void want_kick_drift_kick(struct wanting *w)
{
	const struct linear *system = w->judge->system;
	bool *kicked = ARRAY(bool, (size_t)system->n);
	for (int i = 0; i < system->n; i++) {
		want_kicks_of_block(w, i, kicked);
		want_drift(w, i);
	}
	for (int i = 0; i < system->n; i++) {
		want_kick(w, i);
		want_loads_and_inputs(w, system->velocity[i]);
	}
}

/* ---- both ---- */

static void compare_lists(const char *where, const struct list *found, const struct list *expected)
{
	if (found->count != expected->count)
		complain(format("%s: found %d numbers, expected %d", where, found->count, expected->count));
	for (int i = 0; i < found->count && i < expected->count; i++) {
		trial.compared++;
		if (memcmp(&found->value[i], &expected->value[i], sizeof(double)) == 0)
			continue;
		complain(format("%s, number %d, %s: found %a = %.17g, expected %a = %.17g, tolerance 0", where, i,
						expected->what[i], found->value[i], found->value[i],
								expected->value[i], expected->value[i]));
		if (found->count != expected->count)
			return;                     /* all that follows is shifted */
	}
}

/* A factor 0 adds nothing, be it written (e^{-1e9}, a second word that is none) or not. */
static void drop_zeros(struct list *list)
{
	int left = 0;
	for (int i = 0; i < list->count; i++)
		if (list->value[i] != 0) {
			list->value[left] = list->value[i];
			list->what[left++] = list->what[i];
		}
	list->count = left;
}

static void want_table_entry(struct wanting *w, const struct judged_number *number, const char *what)
{
	double value, low;
	if (!judge_words(number, w->variant->single, &value, &low))
		complain(format("%s: the judge cannot decide it", what));
	append(w->list, value, what);
}

static void compare_table(const char *code, struct wanting *w, const char *table, int segment, int from, int to,
						  const struct judged_number *numbers, int width)
{
	struct list found = { 0 }, expected = { 0 };
	w->list = &expected;
	const int segments = segment < 0 ? w->judge->system->segments : 1;
	for (int s = 0; s < segments; s++)
		for (int i = 0; i < w->judge->states; i++)
			for (int k = from; k < to; k++)
				want_table_entry(w, &numbers[(s * w->judge->states + i) * width + k],
								 format("entry %d, %d of segment %d", i, k - from, s));
	numbers_of_table(code, w->model->name, table, w->variant->single, &found);
	compare_lists(table, &found, &expected);
}

/* ---- a large step: the columns of its blocks ---- */

/* The columns from..to of x = [states of the block, its loads, its inputs], padded as vectors want them */
static void want_columns(struct wanting *w, const struct group *g, int from, int to, int segment)
{
	const struct judge *j = w->judge;
	const int rows = (g->states + 7) / 8 * 8, columns = (to - from + 3) / 4 * 4;
	for (int k = from; k < from + columns; k++)
		for (int i = 0; i < rows; i++) {
			if (k >= to || i >= g->states) {
				append(w->list, 0, "padding");
				continue;
			}
			const struct judged_number *step = &j->step[(segment * j->states + g->state[i]) * j->columns];
			const struct judged_number *number =
				k >= g->states + g->loads ? &step[j->states + j->loads
						+ g->input[k - g->states - g->loads]]
				: k >= g->states          ? &step[j->states + g->load[k - g->states]]
				: w->variant->form == FORM_DELTA
					? &j->increment[g->state[i] * j->states + g->state[k]]
					: &step[g->state[k]];
			want_table_entry(w, number, format("column %d, row %d of segment %d", k, i, segment));
		}
}

static void compare_columns(const char *code, const struct wanting *of, const struct group *g, int index)
{
	struct list found = { 0 }, expected = { 0 };
	struct wanting wanting = *of, *w = &wanting;
	const int segments = w->judge->system->segments, loads = g->states + g->loads, all = loads + g->inputs;
	const bool apart = segments > 1 && g->loads > 0;
	w->list = &expected;
	if (apart && g->inputs)
		return;                             /* not among these models: inputs behind loads that stand apart */
	want_columns(w, g, 0, apart ? g->states : all, 0);
	numbers_of_table(code, w->model->name, format("columns%d", index), w->variant->single, &found);
	compare_lists("columns", &found, &expected);
	found.count = expected.count = 0;
	if (!apart)
		return;
	for (int s = 0; s < segments; s++)
		want_columns(w, g, g->states, loads, s);
	numbers_of_table(code, w->model->name, format("loads%d", index), w->variant->single, &found);
	compare_lists("columns of loads", &found, &expected);
}

/* Does a load move a state in a step? */
static bool load_moves(const struct judge *j, int i, int first, int columns)
{
	bool any = false;
	for (int k = 0; k < columns; k++)
		any = any || !j->step[i * j->columns + j->states + first + k].zero;
	return any;
}

/* In each step after a refresh: every column of every load in the states that it moves; then their second words */
static void want_rotated(struct wanting *w, int l)
{
	const struct judge *j = w->judge;
	const struct linear *system = j->system;
	struct list low = { 0 };
	for (int i = 0; i < j->states; i++)
		for (int m = 0, column = 0; m < system->loads; column += system->load[m++].columns)
			for (int k = 0; k < system->load[m].columns; k++) {
				const struct judged_number *number = &j->turned[(l * j->states + i) * j->loads + column
						+ k];
				const char *what = format("load column %d in %s, %d steps "
					"after", column + k, state_name(w, i), l);
				double value, second;
				if (!is_refreshed(w->step, m) || is_forced(w->step, column) ||
					!load_moves(j, i, column, system->load[m].columns))
					continue;
				if (!judge_words(number, w->variant->single, &value, &second))
					complain(format("%s: the judge cannot decide it", what));
				append(w->list, value, what);
				append(&low, second, format("second word of %s", what));
			}
	for (int k = 0; k < low.count && w->variant->compensated; k++)
		append(w->list, low.value[k], low.what[k]);
}

static void compare_rotated(const char *code, struct wanting *w)
{
	struct list found = { 0 }, expected = { 0 };
	const int steps = w->step->refresh->steps;
	if (steps > JUDGED_TURNS) {
		complain(format("%d steps between anchors, the judge knows %d", steps, JUDGED_TURNS));
		return;
	}
	w->list = &expected;
	for (int l = 0; l < steps; l++)
		want_rotated(w, l);
	numbers_of_table(code, w->model->name, "rotated", w->variant->single, &found);
	compare_lists("rotated", &found, &expected);
}

static void compare_code(const char *code, const struct step *step, const struct judge *j, const struct variant *v)
{
	struct list found = { 0 }, expected = { 0 };
	struct wanting w = { .judge = j, .step = step, .model = step->model, .variant = v, .list = &expected };
	if (j->states > LIMIT_UNROLLED_STATES) {
		for (int k = 0; k < step->program->groups; k++)
			if (step->program->group[k].kind == GROUP_COLUMNS)
				compare_columns(code, &w, &step->program->group[k], k);
	} else {
		if (v->form == FORM_KICK_DRIFT_KICK)
			want_kick_drift_kick(&w);
		else
			want_rows(&w);
		numbers_of_step(code, step->model->name, v->single, &found);
		drop_zeros(&found);
		drop_zeros(&expected);
		compare_lists("step", &found, &expected);
	}
	if (step->refresh && step->refresh->terms)
		compare_rotated(code, &w);
	if (kept)
		return;                             /* Phi and Gamma are of the states as written */
	compare_table(code, &w, "Phi", 0, 0, j->states, j->step, j->columns);
	if (j->inputs)
		compare_table(code, &w, "Gamma", 0, j->states + j->loads, j->columns, j->step, j->columns);
	if (j->loads && j->system->segments > 1 && j->states <= LIMIT_UNROLLED_STATES)
		compare_table(code, &w, "load_factor", -1, j->states, j->states + j->loads, j->step, j->columns);
}

/* Numbers that stand twice are the same twice, whoever is right about their value. */
static void compare_symmetry(const struct step *step)
{
	const int n = step->branch->system.n;
	for (int i = 0; i < n; i++)
		for (int k = 0; k < i; k++) {
			const struct coefficient *pair[2][2] = {
				{ &step->branch->full->kick[i * n + k], &step->branch->full->kick[k * n + i] },
				{ &step->branch->full->drift[i * n + k], &step->branch->full->drift[k * n + i] }
			};
			for (int p = 0; p < 2; p++) {
				trial.compared++;
				if (pair[p][0]->value != pair[p][1]->value || pair[p][0]->low != pair[p][1]->low)
					complain(format("%s %d, %d: %a + %a, its mirror image %a + "
						"%a", p ? "drift" : "kick", i, k,
					pair[p][0]->value, pair[p][0]->low, pair[p][1]->value, pair[p][1]->low));
			}
		}
}

/* Is some factor beyond the type's range? */
static bool overflows(const struct judge *j, bool single)
{
	for (int i = 0; i < j->system->segments * j->states * j->columns; i++) {
		double value, low;
		if (judge_words(&j->step[i], single, &value, &low) && isinf(value))
			return true;
	}
	return false;
}

/* Equal masses, or nothing but the state acts */
static bool may_kick(const struct judge *j)
{
	bool equal = true;
	for (int i = 0; i < j->system->n && j->undamped; i++)
		equal = equal && mpq_equal(j->system->M[i * (j->system->n + 1)], j->system->M[0]);
	return j->undamped && j->states <= LIMIT_UNROLLED_STATES && (equal || j->loads + j->inputs == 0);
}

struct emitting {
	FILE *to;
	const struct step *step;
};

static void emit(void *context)
{
	const struct emitting *e = context;
	emit_code(e->to, e->step, "", NULL, false);
}

static void try_variant(const char *text, const struct judge *j, const struct variant *v)
{
	trial.variant = variant_name(v);
	const struct model *model = model_of(text, v);
	if (!model) {
		if (!v->single)
			complain(format("not accepted: %s", first_error()));
		return;                         /* beyond the range of float, say */
	}
	if (v->compensated && j->states > LIMIT_UNROLLED_STATES)
		return;
	const bool may = v->form != FORM_KICK_DRIFT_KICK || may_kick(j);
	const struct step *step = step_build(model);
	if (!step) {
		const char *said = first_error();
		const bool beyond = strstr(said, "beyond the range of") && overflows(j, v->single);
		trial.compared += beyond;
		if (may && !strstr(said, "times h is above 2.5") && !beyond)
			complain(format("refused: %s", said));
		return;
	}
	if (v->form == FORM_KICK_DRIFT_KICK && step->form != v->form) {
		const char *aside = strstr(diagnostics(), "stands aside");
		trial.compared++;
		if (!aside)
			complain("another form, of which nothing is said");
		else if (may && !strstr(aside, "times h is above 2.5") && !strstr(aside, "beyond the range of"))
			complain(format("another form: it %s", first_line(aside)));
		return;
	}
	if (!may) {
		complain("accepted, though it cannot be");
		return;
	}
	char *code = NULL;
	size_t length = 0;
	struct emitting e = { open_memstream(&code, &length), step };
	const bool emitted = statement_guard(emit, &e);
	fclose(e.to);
	if (!emitted) {
		const char *said = first_error();
		if (!v->single || !strstr(said, "beyond the range of float"))
			complain(format("not emitted: %s", said));
		return;
	}
	if (v->single) {
		char *draft = code;
		e.to = open_memstream(&code, &length);
		print_single(e.to, draft, NULL);
		fclose(e.to);
		free(draft);
	}
	compare_code(code, step, j, v);
	if (v->form == FORM_KICK_DRIFT_KICK)
		compare_symmetry(step);
}

/* What is refused stays refused for the rest of a process, and a target stays what it is: each variant has its own. */
static int try_in_process(const char *text, const struct judge *judge, const struct variant *v)
{
	int status;
	fflush(stdout);
	const pid_t child = fork();
	if (child == 0) {
		alarm(LONGEST_CASE);
		if (v->single)
			target_float();
		try_variant(text, judge, v);
		if (trial.failed > MISMATCHES_SHOWN)
			printf("# %s: %d failures in all\n", trial.variant, trial.failed);
		if (trial.verbose)
			printf("# %s: %d numbers compared\n", trial.variant, trial.compared);
		fflush(stdout);
		_exit(trial.failed ? 1 : trial.compared ? 0 : 2);
	}
	if (child < 0 || waitpid(child, &status, 0) != child) {
		puts("Bail out! cannot start a process");
		exit(1);
	}
	if (WIFSIGNALED(status))
		printf("# %s: ended by signal %d\n", variant_name(v), WTERMSIG(status));
	return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

static bool try_spec(const char *text)
{
	static const struct variant variants[] = {
		{ FORM_DIRECT, false, false }, { FORM_DELTA, false, false }, { FORM_DELTA, true, false },
		{ FORM_KICK_DRIFT_KICK, false, false }, { FORM_KICK_DRIFT_KICK, true, false },
		{ FORM_DIRECT, false, true }, { FORM_DELTA, false, true }, { FORM_DELTA, true, true },
		{ FORM_KICK_DRIFT_KICK, false, true }, { FORM_KICK_DRIFT_KICK, true, true }
	};
	bool good = true, compared = false;
	const struct model *model = model_of(text, &variants[0]);
	if (!model) {
		printf("# not accepted: %s\n", first_error());
		return false;
	}
	const struct judge *judge = judge_of(&model->system, model->h);
	for (size_t i = 0; i < sizeof variants / sizeof *variants; i++) {
		const int result = try_in_process(text, judge, &variants[i]);
		good = good && result != 1;
		compared = compared || result == 0;
	}
	kept = relative_of(model);
	model = kept ? model_of(text, &variants[0]) : NULL;
	for (size_t i = 0; model && i < sizeof variants / sizeof *variants; i++)
		if (variants[i].form != FORM_KICK_DRIFT_KICK)       /* the judge knows no masses of what is kept */
			good = good && try_in_process(text, judge_of(&model->system, model->h), &variants[i]) != 1;
	good = good && (model || !kept);
	kept = NULL;
	if (!compared)
		printf("# nothing was compared\n");
	return good && compared;
}

/* ---- the whole ---- */

static bool try_text(void *text)
{
	const bool good = try_spec(text);
	if (!good)
		show_spec(text);
	return good;
}

/* The generator gives nothing back before it ends: each in a process */
static void run(const char *name, char *text)
{
	run_case(name, 0, try_text, text);
}

int main(int argc, char **argv)
{
	unsigned long random_count = 60, undamped_count = 60, seed = 1;
	memory_open();
	take_options(argc, argv, (struct command_option[]){
		{ 'n', .number = &random_count }, { 'u', .number = &undamped_count }, { 's', .number = &seed },
		{ 'v', .on = &trial.verbose }, { 0 }
	});
	printf("1..%lu\n", (unsigned long)(argc - optind) + TWICE + random_count + undamped_count);
	for (int i = optind; i < argc; i++)
		run(base_name(argv[i]), read_text(argv[i]));
	for (int i = 0; i < TWICE; i++)
		run(format("rounded once: %s", twice[i].name), twice_spec(&twice[i]));
	for (unsigned long i = 0; i < undamped_count; i++)
		run(format("undamped model %lu", seed + i), undamped_spec(seed + i));
	for (unsigned long i = 0; i < random_count; i++)
		run(format("random model %lu", seed + i), random_spec(seed + i));
	memory_close();
	return cases_failed() > 0;
}
