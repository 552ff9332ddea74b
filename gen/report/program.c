/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The program of a step as text: what emitters print as C, before they do. */
#include "model/reads.h"
#include "model/regions/regions.h"
#include "report/report.h"
#include "step/collocation/collocation.h"
#include "step/series/switching.h"
#include "step/series/expansion.h"
#include "step/linear/forms.h"
#include "step/tapes.h"
#include "step/tunable/tuned.h"

#include <string.h>

/* ---- tables and phi-function weights ---- */

/* p/q h, or h */
static const char *time_text(mpq_srcptr fraction)
{
	return mpq_sgn(fraction) == 0		 ? "0"
	       : mpq_cmp_ui(fraction, 1, 1) == 0 ? "h"
						 : format("%s h", exact_text(fraction));
}

/* 1 - 3 (s/h) + 2 (s/h)^2 */
static const char *powers_text(const struct phi_weight_part *part)
{
	static const char *const power[PART_POWERS] = { "", " s/h", " (s/h)^2" };
	const char *text = "";
	RATIONAL size = ZERO;
	for (int m = 0; m < part->powers; m++) {
		int sign = mpq_sgn(part->power[m]);
		mpq_abs(size, part->power[m]);
		if (sign != 0)
			text = format("%s%s%s%s", text,
				      sign < 0 ? (*text ? " - " : "-")
				      : *text  ? " + "
					       : "",
				      exact_text(size), power[m]);
	}
	return text;
}

/* What a unit remainder adds: e^{A tau} B times a number, the response to a force over a part of the step */
static const char *phi_weight_text(const struct phi_weight *phi_weight)
{
	const char *text = "";
	for (int i = 0; i < phi_weight->parts; i++) {
		const struct phi_weight_part *part = &phi_weight->part[i];
		const char *time = time_text(part->fraction), *plus = *text ? ", plus " : "";
		const char *at = mpq_sgn(part->fraction) == 0 ? "" : format("e^{A tau}, tau = %s, times ", time);
		if (mpq_sgn(part->impulse) != 0)
			text = format("%s%s%s%s s B", text, plus, at, exact_text(part->impulse));
		else
			text = format("%s%sresponse to B (%s) from s = 0 to %s", text, plus, powers_text(part), time);
	}
	return text;
}

static void print_table(FILE *to, const struct table *table)
{
	const struct wanted *wanted = table->wanted;
	fprintf(to, "    %s: tau = %s;", wanted->name, time_text(wanted->fraction));
	if (table->Phi)
		fprintf(to, " Phi %d x %d,", table->states, table->states);
	if (table->increment)
		fprintf(to, " Phi - I,");
	if (table->kick)
		fprintf(to, " kicks and drifts,");
	fprintf(to, " %d load column%s, %d input column%s\n", table->columns, table->columns == 1 ? "" : "s",
		table->inputs, table->inputs == 1 ? "" : "s");
	for (int k = 0; k < wanted->phi_weights; k++)
		fprintf(to, "        %s (%d x %d): %s\n", wanted->phi_weight[k].name, table->states,
			table->force_columns,
			phi_weight_text(&wanted->phi_weight[k]));
}

static void print_tables(FILE *to, const struct step *step)
{
	fprintf(to, "Tables%s:\n", step->branches > 1 ? format(", of each of %d operators", step->branches) : "");
	for (int t = 0; t < step->tables; t++)
		print_table(to, step->branch->table[t]);
}

/* ---- a list of actions ---- */

static const char *stage_text(int stage)
{
	return stage == STAGE_STATE ? "y" : format("stage%d", stage);
}

/* t, t + h/2 */
static const char *node_text(const struct program *program, int node)
{
	return mpq_sgn(program->node[node]) == 0 ? "t" : format("t + %s", time_text(program->node[node]));
}

static const char *sum_text(const struct step *step, const struct action *a)
{
	struct table *const *table = step->branch->table;
	const char *text = a->plain == NONE ? "" : stage_text(a->plain);
	if (a->flow != NONE) {
		const struct table *flow = table[a->flow];
		text = format("%s%s%s.Phi y%s%s", text, *text ? " + " : "", flow->wanted->name,
			      flow->columns ? " + loads" : "", flow->inputs ? " + inputs" : "");
	}
	for (int k = 0; k < a->phi_weights; k++) {
		const struct wanted *wanted = table[a->phi_weight[k].table]->wanted;
		text = format("%s%s%s.%s r%d", text, *text ? " + " : "", wanted->name,
			      wanted->phi_weight[a->phi_weight[k].phi_weight].name, a->phi_weight[k].left);
	}
	return text;
}

static const char *combination_text(const struct action *a)
{
	if (a->minus == NONE)
		return format("2 r%d", a->plus);
	return format("r%d %c r%d", a->plus, a->added ? '+' : '-', a->minus);
}

static void print_action(FILE *to, const struct step *step, const struct action *a)
{
	const struct program *program = step->program;
	switch (a->kind) {
	case ACTION_REMAINDER:
		fprintf(to, "    r%d = r(%s, %s)\n", a->target, node_text(program, a->node), stage_text(a->from));
		break;
	case ACTION_COMBINE:
		fprintf(to, "    r%d = %s\n", a->target, combination_text(a));
		break;
	case ACTION_SUM:
		fprintf(to, "    # %s\n    %s = %s\n", a->note, stage_text(a->target), sum_text(step, a));
		break;
	case ACTION_PREDICT:
		fprintf(to, "    %s = RK4 from y to %s, by way of %s\n", stage_text(a->target),
			node_text(program, a->node), node_text(program, a->half));
		break;
	}
}

static void print_nodes(FILE *to, const struct step *step)
{
	const struct program *program = step->program;
	fputs("Nodes:", to);
	for (int i = 0; i < program->nodes; i++) {
		int table = program->node_table[i];
		const char *loads =
			table == NONE ? "" : format(" (loads: %s)", step->branch->table[table]->wanted->name);
		fprintf(to, "%s %s%s", i ? "," : "", node_text(program, i), loads);
	}
	fprintf(to, "\nStages: %d; remainders: %d, each of %d number%s\n", program->stages, program->lefts,
		step->branch->system.force_columns, step->branch->system.force_columns == 1 ? "" : "s");
}

static void print_actions(FILE *to, const struct step *step)
{
	const struct program *program = step->program;
	print_tables(to, step);
	print_nodes(to, step);
	fprintf(to, "Actions%s:\n", program->loops ? ", in loops over the tables" : "");
	for (int i = 0; i < program->actions; i++)
		print_action(to, step, &program->action[i]);
}

/* ---- a list of assignments ---- */

/* A state that is a difference stands in brackets */
static const char *state_text(const struct step *step, int state)
{
	const char *name = step->model->names.state[state];
	return strchr(name, ' ') && name[0] != '(' ? format("(%s)", name) : name;
}

/* u as it is held; of first order, at the start of the step or at its end */
static const char *input_column_text(const struct step *step, int column)
{
	const struct linear *system = &step->branch->system;
	for (int i = 0; i < system->inputs; column -= system->input[i++].hold + 1)
		if (column < system->input[i].hold + 1)
			return format("%s%s", system->input[i].name,
				      system->input[i].hold > 1 ? format("(sample %d)", column)
				      : !system->input[i].hold ? "" : column ? "(end)" : "(start)");
	return "";
}

static const char *operand_text(const struct step *step, const struct operand *operand)
{
	switch (operand->kind) {
	case OPERAND_STATE: return state_text(step, operand->index);
	case OPERAND_LOAD:  return text_of_column(&step->branch->system, operand->index);
	default:            return input_column_text(step, operand->index);
	}
}

static void print_assignment(FILE *to, const struct step *step, const struct assignment *a)
{
	fprintf(to, "    %s %s", state_text(step, a->target), a->added ? "+=" : "=");
	for (int k = 0; k < a->terms; k++) {
		const struct product *p = &a->term[k];
		const char *factor = shortest(p->factor->value);
		if (step->program->compensated && has_second_word(p, step))
			factor = format("(%s + %s)", factor, shortest(p->factor->low));
		fprintf(to, "%s %s*%s", k ? " +" : "", factor, operand_text(step, &p->operand));
	}
	fprintf(to, "%s%s\n", a->terms ? "" : " 0", a->carried ? "        # what rounding takes is kept" : "");
}

static const char *states_of_group(const struct step *step, const struct group *g, int block)
{
	enum { SHOWN = 4 };
	const char *text = "";
	for (int i = 0; i < g->states && i < SHOWN; i++)
		text = format("%s%s%s", text, i ? ", " : "", state_text(step, g->state[i * g->blocks + block]));
	return g->states > SHOWN ? format("%s, ...", text) : text;
}

static void print_group(FILE *to, const struct step *step, const struct group *g)
{
	const int acting = g->loads + g->inputs;
	const char *added = step->program->products_added ? "y += (Phi - I) y" : "y = Phi y";
	if (g->kind == GROUP_COLUMNS)
		fprintf(to, "    %s of %d states by columns", added, g->states);
	else if (g->kind == GROUP_ALIKE)
		fprintf(to, "    %s of %d blocks alike of %d states, in a loop", added, g->blocks, g->states);
	fputs(g->tuned ? ", the instance's" : "", to);
	fprintf(to, acting ? ", %d column%s of loads and inputs: " : ": ", acting, acting == 1 ? "" : "s");
	fputs(states_of_group(step, g, 0), to);
	if (g->blocks > 1)
		fprintf(to, " to %s", states_of_group(step, g, g->blocks - 1));
	fputc('\n', to);
}

static bool is_of_group(const struct group *g, int state)
{
	for (int i = 0; i < g->states * g->blocks; i++)
		if (g->state[i] == state)
			return true;
	return false;
}

static void print_groups(FILE *to, const struct step *step)
{
	const struct program *program = step->program;
	if (step->modal)
		fprintf(to, "Modes: %d pairs of real and imaginary part, turned and damped; %d that are real\n",
			step->modal->pairs, step->modal->reals);
	else
		fprintf(to, "Independent blocks, all of which read the old state:\n");
	for (int k = 0; k < program->groups; k++) {
		const struct group *g = &program->group[k];
		if (g->kind != GROUP_ROWS)
			print_group(to, step, g);
		for (int i = 0; i < program->assignments && g->kind == GROUP_ROWS; i++)
			if (is_of_group(g, program->assignment[i].target))
				print_assignment(to, step, &program->assignment[i]);
	}
}

static void print_list(FILE *to, const struct step *step)
{
	const struct program *program = step->program;
	print_tables(to, step);
	if (program->tuned)
		fprintf(to, "Factors%s are read from the instance; these are of the spec's values.\n",
			!step->blocks->solved ? " of blocks that tunable params touch" : "");
	if (loads_change(&step->branch->system))
		fprintf(to, "Factors of loads change %d time%s; these are those before.\n",
			step->branch->system.segments - 1, step->branch->system.segments == 2 ? "" : "s");
	if (step->refresh && step->refresh->terms)
		fprintf(to,
			"Loads are evaluated every %d steps, at a refresh; these are their factors there, of %d, which "
			"change from step to step.\n",
			step->refresh->steps, step->refresh->terms);
	if (program->loops) {
		print_groups(to, step);
		return;
	}
	fprintf(to, "Assignments, %s%s:\n",
		program->in_order ? "in order: each reads what those before it have left"
				  : "all of which read the old state",
		step->linear.kicks.momenta ? "; velocities are kept as momenta" : "");
	for (int i = 0; i < program->assignments; i++)
		print_assignment(to, step, &program->assignment[i]);
}

/* ---- regions ---- */

static void print_matrices(FILE *to, const struct step *step)
{
	for (int k = 0; k < step->branches; k++) {
		const struct branch *b = &step->branch[k];
		fprintf(to, "Matrix %d, %s:\n", k,
			b->rungs ? format("pieces of %d lengths", b->rungs + 1) : "one piece");
		for (int r = 0; r <= b->rungs; r++)
			print_table(to, b->table[r]);
	}
}

static void print_regions(FILE *to, const struct step *step)
{
	const struct switching *s = step->model->switching;
	fprintf(to,
		"Actions, from piece to piece d of the step, the longest that is seen to be event-free:\n"
		"    y %s y + loads + piece.held u + piece.ramp u'\n"
		"    where %s passes a breakpoint: the Taylor series of y, of degree %d, to there; then the next "
		"region\n",
		step->program->compensated ? "+= (piece.Phi - I)" : "= piece.Phi",
		s->functions == 1 ? "the switching function" : format("one of %d switching functions", s->functions),
		step->series.degree);
	if (step->program->compensated)
		fprintf(to, "    factors in two words, and what rounding takes from y kept\n");
	if (s->segments > 1)
		fprintf(to,
			"    at a change of the loads: as far as there, then the region with the same intervals in the "
			"next of %d segments of time\n", s->segments);
	print_matrices(to, step);
}

/* Each as if it were alone */
static void print_parts(FILE *to, const struct step *step)
{
	for (int p = 0; p < step->regions.parts; p++) {
		const struct step *part = step->regions.part[p];
		fprintf(to, "Part %d: %s", p, name_list(part->model->n, part->model->names.coord));
		if (part->model->switching->functions > 0) {
			fputs(". ", to);
			print_regions(to, part);
		} else {
			fputs(". Actions:\n    y = whole.Phi y + loads + whole.held u + whole.ramp u'\n", to);
			print_matrices(to, part);
		}
	}
}

/* ---- a series ---- */

static const char *sequence_text(const struct step *step, int sequence)
{
	const struct sequence *s = &step->taylor.expansion->sequence[sequence];
	return s->state != NONE ? state_text(step, s->state)
				: format("a%d", sequence - step->branch->system.states + 1);
}

static const char *term_text(const struct step *step, const struct sequence_term *t)
{
	const struct linear *system = &step->branch->system;
	switch (t->kind) {
	case TERM_TIME:     return t->a ? format("t^%d", t->a) : "1";
	case TERM_LOAD:     return text_of_column(system, t->a);
	case TERM_INPUT:    return system->input[t->a].name;
	case TERM_SLOPE:    return format("%s'", system->input[t->a].name);
	case TERM_PARAM:    return held_symbol(step->model, t->a)->name;
	case TERM_SEQUENCE: return sequence_text(step, t->a);
	default:            return format("%s %s", sequence_text(step, t->a), sequence_text(step, t->b));
	}
}

/* The sum at k = 0; of an integral that is what its derivative has */
static const char *sequence_sum(const struct step *step, const struct sequence *s)
{
	const char *text = "";
	for (int i = 0; i < s->terms; i++) {
		const struct sequence_term *t = &s->term[i];
		const char *factor = t->factor ? shortest(t->factor[0]) : format("force[%d]", t->slot);
		if (!t->factor || t->factor[0] != 0)
			text = format("%s%s%s %s", text, *text ? " + " : "", factor, term_text(step, t));
	}
	return *text ? text : "0";
}

/* By what it is chosen; by the state, while it is in or above the breakpoint */
static const char *chooser_text(const struct step *step, const struct sequence *s)
{
	if (s->choice == CHOICE_BY_TIME)
		return "t";
	if (s->choice == CHOICE_BY_SEQUENCE)
		return format("%s not 0", sequence_text(step, s->test));
	const struct series_switching *d = &step->taylor.switching->function[s->switching];
	return format("%s %s %s", sequence_text(step, d->sequence), s->choice == CHOICE_BY_HOLD ? "held at" : "above",
		      readable_text(d->at[s->breakpoint]));
}

static const char *sequence_definition(const struct step *step, const struct sequence *s)
{
	const char *a = s->a == NONE ? "1" : sequence_text(step, s->a);
	const char *b = s->b == NONE ? "" : sequence_text(step, s->b);
	switch (s->kind) {
	case SEQUENCE_SUM:	return sequence_sum(step, s);
	case SEQUENCE_QUOTIENT: return format("%s / %s", a, b);
	case SEQUENCE_ROOT:	return format("sqrt(%s)", a);
	case SEQUENCE_POWER:	return format("%s ^ %s", a, shortest(s->exponent));
	case SEQUENCE_SOLUTION: return format("component %d of %d linear equations", s->component + 1, s->equations->n);
	case SEQUENCE_RATE:	return format("the derivative of %s", a);
	case SEQUENCE_CHOICE:	return format("%s or %s, by %s", a, b, chooser_text(step, s));
	default:
		if (s->state != NONE)
			return format("integral of %s", sequence_sum(step, s));
		return format("%s(%s%s%s), by the integral of %s", function_name(s->function), a, *b ? ", " : "", b,
			      sequence_sum(step, s));
	}
}

static void print_series(FILE *to, const struct step *step)
{
	const struct expansion *x = step->taylor.expansion;
	const struct truncation *truncation = &step->model->truncation;
	fprintf(to,
		"Series of order %d in time over %s%s; of each sequence the coefficients that are read, factors of the "
		"first:\n", x->order, truncation->over > 1 ? format("%d h", truncation->over) : "h",
		truncation->adaptive ? ", as far as its last two terms allow" : "");
	for (int i = 0; i < x->count; i++)
		if (x->sequence[i].top >= 0)
			fprintf(to, "    %s (0 to %d) = %s\n", sequence_text(step, i),
				x->sequence[i].top, sequence_definition(step, &x->sequence[i]));
}

static void print_expansion(FILE *to, const struct step *step)
{
	print_tables(to, step);
	print_series(to, step);
}

/* What a step is looked at by, with the formulas that hold */
static void print_check(FILE *to, const struct step *step)
{
	struct step view = *step;
	view.taylor.expansion = step->event_split->event_check;
	fprintf(to, "Looked at from both ends, by values and slopes of its switching functions; a step that crosses a "
		    "breakpoint in parts, by e^{A tau} of %d numbers:\n", step->event_split->layout.size);
	print_series(to, &view);
}

/* ---- collocation ---- */

/* Of a force or a slope; beside contacts it has no formula of its own. */
static const char *text_beside_contacts(const struct model *model, const struct form *form)
{
	return form ? form_text(model, form) : "that of the series, by what holds and slips";
}

static void print_collocation(FILE *to, const struct step *step)
{
	const struct collocation *x = step->collocation;
	const struct motion *m = step->collocation->motion;
	const struct model *model = step->model;
	if (step->taylor.expansion)
		print_expansion(to, step);
	else
		print_tables(to, step);
	fprintf(to, "Collocation at %d nodes of an internal step:\n   ", x->stages);
	for (int i = 0; i < x->stages; i++)
		fprintf(to, "%s %s", i ? "," : "", shortest(x->node[i]));
	fprintf(to, "\nIts unknowns, the highest derivatives at each node%s:\n",
		m->columns ? ", what loads and inputs give them apart" : "");
	for (int i = 0; i < m->coords; i++)
		fprintf(to, "    %s%s = %s\n", model->names.coord[i],
			highest_state(&model->system, i) == i ? "'" : "''",
			text_beside_contacts(model, m->force ? m->force[i] : NULL));
	fprintf(to, "Their Jacobian, where it is not 0:\n");
	for (int k = 0; k < m->entries; k++)
		fprintf(to, "    of %s by %s%s = %s\n", model->names.coord[m->entry[k].coord],
			model->names.coord[m->entry[k].of],
			m->entry[k].twice || highest_state(&model->system, m->entry[k].of) == m->entry[k].of ? "" : "'",
			text_beside_contacts(model, m->entry[k].slope));
	fprintf(to, "An iteration of Newton's method: %d multiplications, %d additions, %d calls\n",
		step->collocation->iteration.multiplications, step->collocation->iteration.additions,
		step->collocation->iteration.calls);
}

/* ---- the whole ---- */

static void print_reads(FILE *to, const struct step *step)
{
	const struct program *program = step->program;
	const char *states = "", *loads = "";
	for (int i = 0; i < step->branch->full->states; i++)
		if (program->reads[i])
			states = format("%s%s %s", states, *states ? "," : "", state_text(step, i));
	for (int k = 0; k < step->branch->full->columns; k++)
		if (program->uses[k])
			loads = format("%s%s %s", loads, *loads ? "," : "", text_of_column(&step->branch->system, k));
	if (step->model->switching || has_remainder(step))
		states = " all states";
	fprintf(to, "Reads:%s%s%s\n", *states ? states : " no state", *loads ? "; loads" : "", loads);
}

static const char *kind_text(const struct step *step)
{
	return step->regions.parts ? "regions of independent parts"
	       : step->model->switching ? "regions" : has_remainder(step) ? "with a remainder"
	       : step->program->tuned ? "linear, tunable" : "linear";
}

void explain_program(FILE *to, const struct step *step)
{
	const struct program *program = step->program;
	fprintf(to, "Program of a step of %s: %s; scheme %s, form %s, h = %s s\n", step->model->name, kind_text(step),
		scheme_name(step->model->scheme), step_form_text(step), readable_text(step->model->h));
	if (step->model->switching)
		(step->regions.parts ? print_parts : print_regions)(to, step);
	else if (step->collocation)
		print_collocation(to, step);
	else if (step->taylor.expansion)
		print_expansion(to, step);
	else if (step->normal)
		program_normal(to, step);
	else if (has_remainder(step))
		print_actions(to, step);
	else
		print_list(to, step);
	if (step->event_split)
		print_check(to, step);
	print_reads(to, step);
	fprintf(to, "Cost: %d multiplications, %d additions, %d calls%s%s%s\n", program->multiplications,
		program->additions, program->calls,
		step->program->peak_multiplications ? format("; the look for peaks %d and %d more",
						       program->peak_multiplications, program->peak_additions)
					      : "",
		step->refresh ? format("; every %d steps %d and %d more", step->refresh->steps,
				       program->forcing_multiplications, program->forcing_additions)
			      : "",
		step->forced ? "; of the transient, without the particular solution of its loads" : "");
}
