/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a step costs: evaluations of the remainder, load states, sums. */
#include "model/checks.h"
#include "model/contacts/contacts.h"
#include "model/reads.h"
#include "step/collocation/collocation.h"
#include "cost.h"
#include "step/series/expansion.h"
#include "step/linear/forms.h"
#include "step/exponential/normal.h"
#include "step/linear/rows.h"
#include "tapes.h"

#include <math.h>

struct cost { int multiplications, additions, calls; };

static void add_cost(struct cost *to, int times, struct cost of)
{
	to->multiplications += times * of.multiplications;
	to->additions += times * of.additions;
	to->calls += times * of.calls;
}

static struct cost cost_of_tape(const struct tape *t)
{
	struct tape_cost cost = tape_cost(t);
	return (struct cost){ cost.multiplications + cost.divisions, cost.additions, cost.calls };
}

static tape_ref leaf(struct tape *t, const void *context, const struct basis *basis)
{
	return tape_of_basis(t, &((const struct step *)context)->branch->system, basis);
}

static tape_ref friction(struct tape *t, const void *context, const struct atom *atom)
{
	(void)context;
	return tape_operand(t, TAPE_FRICTION, atom->index, 0);
}

static void set_cost(struct program *program, struct cost cost)
{
	program->multiplications = cost.multiplications;
	program->additions = cost.additions;
	program->calls = cost.calls;
}

/* Of one evaluation of all */
static struct cost cost_of_forms(const struct step *step, int count, const struct form *const *form)
{
	struct tape *t = tape_new();
	const struct tape_reader reader = { leaf, NULL, friction, step, false, false };
	struct tape_forms *f = tape_forms_new(t, reader, count, form, 0, NULL);
	for (int i = 0; i < count; i++)
		tape_set(t, "", tape_form(f, form[i]), 0, NULL);
	return cost_of_tape(t);
}

/* Functions of a load: cos and sin together, e^{a t} */
static struct cost functions_of_load(const struct load *load, bool single)
{
	bool turns = oscillates(load->forcing), grows = mpq_sgn(load->forcing->a) != 0;
	return (struct cost){ turns * (single ? PL_COSSINF_MUL : PL_COSSIN_MUL) +
				      grows * (single ? PL_ENVELOPEF_MUL : PL_ENVELOPE_MUL),
			      turns * (single ? PL_COSSINF_ADD : PL_COSSIN_ADD) +
				      grows * (single ? PL_ENVELOPEF_ADD : PL_ENVELOPE_ADD), 0 };
}

static bool is_used(const struct program *program, const struct load *load, int column)
{
	bool used = false;
	for (int k = 0; k < load->columns; k++)
		used = used || program->uses[column + k];
	return used;
}

/* Powers of t times functions, and growths times cos and sin */
static int products_of_load(const struct load *load)
{
	bool grows = mpq_sgn(load->forcing->a) != 0;
	return oscillates(load->forcing) ? 2 * (load->powers - 1) + 2 * grows
	       : load->powers > 1     ? load->powers - 2 + grows
				      : 0;
}

/* ... and what turns the load states of a refresh into those of now */
static struct cost turning_of_load(const struct load *load)
{
	bool turns = oscillates(load->forcing);
	return (struct cost){ (turns ? 4 : 1) + (turns ? 2 : 1) * (load->powers - 1), 2 * turns, 0 };
}

void count_loads(struct program *program, const struct step *step)
{
	const struct linear *system = &step->branch->system;
	int refreshed = 0;
	for (int l = 0, column = 0; l < system->loads; column += system->load[l++].columns) {
		const struct load *load = &system->load[l];
		if (!is_used(program, load, column) && !is_refreshed(step, l))
			continue;
		*(is_refreshed(step, l) ? &refreshed : &program->multiplications) += products_of_load(load);
		struct cost functions = functions_of_load(load, step->model->request.single);
		program->forcing_multiplications += functions.multiplications;
		program->forcing_additions += functions.additions;
	}
	program->forcing_multiplications += refreshed;
	if (step->refresh)
		return;
	program->multiplications += program->forcing_multiplications;
	program->additions += program->forcing_additions;
}

void count_rotated_loads(struct program *program, const struct step *step)
{
	const struct linear *system = &step->branch->system;
	for (int l = 0, column = 0; l < system->loads; column += system->load[l++].columns) {
		const struct load *load = &system->load[l];
		if (!is_used(program, load, column))
			continue;
		program->multiplications += is_refreshed(step, l) ? turning_of_load(load).multiplications
								 : products_of_load(load);
		program->additions += is_refreshed(step, l) ? turning_of_load(load).additions : 0;
	}
}

/* ---- the look for peaks ---- */

static bool is_row(const struct output *output)
{
	return !output->left && !output->peak;
}

static bool is_any(const struct output *output)
{
	return output != NULL;
}

/* Outputs now; `reads`, per load, marks those whose load states they read. */
static struct cost cost_of_outputs(const struct step *step, bool (*counts)(const struct output *output), bool *reads)
{
	struct tape *t = tape_new();
	for (int i = 0; i < step->model->outputs; i++)
		if (counts(&step->model->output[i]))
			tape_set(t, "", tape_of_row(t, step, &step->model->output[i]), 0, NULL);
	for (int l = 0; l < step->branch->system.loads; l++)
		reads[l] = tape_reads(t, TAPE_LOAD, l, -1);
	return cost_of_tape(t);
}

/* Load states: anew, or from the refresh's */
static void cost_load(struct cost *cost, const struct step *step, int l, bool rotated)
{
	const struct load *load = &step->branch->system.load[l];
	add_cost(cost, 1, rotated ? turning_of_load(load) : functions_of_load(load, step->model->request.single));
	cost->multiplications += rotated ? 0 : products_of_load(load);
}

/* Of the loads whose functions a step evaluates, in the mean over the steps to a refresh */
static int forcings_of(const struct step *step)
{
	const struct linear *system = &step->branch->system;
	int forcings = 0;
	for (int l = 0, column = 0; l < system->loads; column += system->load[l++].columns)
		forcings += oscillates(system->load[l].forcing) && is_used(step->program, &system->load[l], column);
	return forcings;
}

double cost_of_step(const struct step *step, const struct target *target)
{
	const struct model *model = step->model;
	const struct program *program = step->program;
	const bool single = model->request.single;
	const int refresh = step->refresh ? step->refresh->steps : 1;
	struct cost cost = { program->multiplications, program->additions, 0 };
	bool *reads = ARRAY(bool, (size_t)step->branch->system.loads);
	if (step->forced)
		add_cost(&cost, 1, (struct cost){ step->forced->multiplications, step->forced->additions, 0 });
	if (step->modal)
		add_cost(&cost, model->outputs * step->modal->states, (struct cost){ 1, 1, 0 });
	else if (model->declared_outputs)
		add_cost(&cost, 1, cost_of_outputs(step, is_row, reads));
	double multiplications = cost.multiplications, additions = cost.additions;
	if (step->refresh) {
		multiplications += (double)program->forcing_multiplications / refresh;
		additions += (double)program->forcing_additions / refresh;
	}
	if (!target)
		return (multiplications + additions) * (single ? 1 : 2);
	return target->cost[single].multiplication * multiplications + target->cost[single].addition * additions +
	       target->cost[single].forcing * forcings_of(step) / refresh + target->cost[single].step;
}

/* Instructions: of an operation, cos and sin of a load, a function of <math.h>, the time to a change of loads, a piece
 * of a step that is searched, an event in it, a term of that one's polynomials, a step */
struct takes { double multiplication, addition, forcing, call, wait, piece, event, term, step; };

/* Fitted as those of needs.c, to the steps of tests/firmware/costs.sh. In double the search with friction and impacts
 * adds many zeros, which soft float is done with early; in float searches go by loops over arrays. */
static const struct takes *takes_of(const struct step *step)
{
	static const struct takes plain[2] = {
		{ 58, 78, 1970, 1180, 2950, 0, 0, 0, 0 }, { 1.5, 1.5, 110, 67, 310, 0, 0, 0, 12 }
	};
	static const struct takes switching[2] = {
		{ 58, 78, 1970, 1180, 2950, 0, 0, 0, 0 }, { 6.8, 6.8, 110, 67, 310, 480, 7000, 24, 0 }
	};
	static const struct takes contacts[2] = {
		{ 58, 30, 1970, 1180, 2950, 0, 0, 0, 0 }, { 14.6, 14.6, 110, 67, 310, 290, 7000, 24, 0 }
	};
	const struct model *model = step->model;
	const struct takes *takes = !model->switching ? plain : facts_of_model(model).contacts ? contacts : switching;
	return &takes[model->request.single];
}

double instructions_of(const struct step *step, struct operations of)
{
	const bool single = step->model->request.single;
	const struct takes *each = takes_of(step);
	const double m = of.multiplications - of.forcings * (single ? PL_COSSINF_MUL : PL_COSSIN_MUL);
	const double a = of.additions - of.forcings * (single ? PL_COSSINF_ADD : PL_COSSIN_ADD);
	return each->multiplication * m + each->addition * a + each->forcing * of.forcings + each->call * of.calls +
	       each->wait * of.waits + each->piece * of.pieces + each->event * of.events + each->term * of.terms +
	       each->step;
}

double instructions_of_program(const struct step *step)
{
	const struct program *program = step->program;
	return instructions_of(step, (struct operations){
		.multiplications = program->multiplications, .additions = program->additions, .calls = program->calls,
		.forcings = forcings_of(step), .waits = 2 * loads_change(&step->branch->system),
		.pieces = step->model->switching != NULL });
}

void count_peaks(struct step *step)
{
	const struct model *model = step->model;
	const struct linear *system = &step->branch->system;
	int count = peak_outputs(model), size = step->layout.size;
	if (count == 0 || peaks_by_values(step))
		return;
	bool *reads = ARRAY(bool, (size_t)system->loads);
	/* of each the sums row . x and bend . |x|; their sum */
	struct cost cost = cost_of_outputs(step, is_any, reads);
	cost.multiplications += 2 * size * count;
	cost.additions += (2 * size + 1) * count;
	for (int l = 0; l < system->loads; l++) {
		if (step->layout.load[l] >= 0)
			cost_load(&cost, step, l, false);
		if (reads[l])
			cost_load(&cost, step, l, is_refreshed(step, l));
	}
	step->program->peak_multiplications = cost.multiplications;
	step->program->peak_additions = cost.additions;
}

/* ---- regions ---- */

void count_regions(struct step *step, int multiplications, int additions)
{
	const struct linear *system = &step->branch->system;
	struct program *program = step->program;
	struct cost functions = { 0, 0, 0 };
	if (step->refresh) {
		program->multiplications = multiplications;
		program->additions = additions;
		count_rotated_loads(program, step);
		return;
	}
	for (int l = 0; l < system->loads; l++) {
		if (step->layout.load[l] < 0)
			continue;
		add_cost(&functions, 1, functions_of_load(&system->load[l], step->model->request.single));
		multiplications += products_of_load(&system->load[l]);
	}
	program->forcing_multiplications = functions.multiplications;
	program->forcing_additions = functions.additions;
	program->multiplications = multiplications + functions.multiplications;
	program->additions = additions + functions.additions;
}

/* ---- the count of a program of actions ---- */

struct tally {
	const struct step *step;
	struct program *program;
	int *terms;                 /* per row of the sum being counted */
};

static void tally_matrix(struct tally *t, const struct coefficient *c, int columns)
{
	for (int i = 0; i < t->step->branch->system.states; i++)
		for (int j = 0; j < columns; j++) {
			double value = c[i * columns + j].value;
			if (c[i * columns + j].zero && !t->program->loops)
				continue;
			t->terms[i]++;
			t->program->multiplications += t->program->loops || (value != 1 && value != -1);
		}
}

static void tally_flow(struct tally *t, const struct table *table)
{
	if (table->Phi)
		tally_matrix(t, table->Phi, table->states);
	tally_matrix(t, table->load, table->columns);
	tally_matrix(t, table->input, table->inputs);
}

static void tally_sum(struct tally *t, const struct action *a)
{
	struct table *const *table = t->step->branch[0].table;
	int rows = t->step->branch->system.states;
	t->terms = ARRAY(int, (size_t)rows);
	if (a->flow != NONE)
		tally_flow(t, table[a->flow]);
	for (int k = 0; k < a->phi_weights; k++)
		tally_matrix(t, table[a->phi_weight[k].table]->phi_weight[a->phi_weight[k].phi_weight],
			     t->step->branch->system.force_columns);
	for (int i = 0; i < rows; i++)
		t->program->additions += t->terms[i] + (a->plain != NONE) - (t->terms[i] > 0 || a->plain != NONE);
}

/* Three slopes beside the first, which all predictions of a step share, and the sums of Runge and Kutta */
static void tally_prediction(struct tally *t, bool first)
{
	int rows = t->step->branch->system.states, slopes = first ? 4 : 3, n = t->step->branch->system.n;
	int terms = n * (rows + t->step->branch->system.force_columns);
	t->program->multiplications += slopes * terms + 4 * rows;
	t->program->additions += slopes * terms + 6 * rows;
}

static int remainders_evaluated(const struct program *program)
{
	int count = 0;
	for (int i = 0; i < program->actions; i++)
		count += program->action[i].kind == ACTION_REMAINDER  ? 1
			 : program->action[i].kind == ACTION_PREDICT ? 3
								     : 0;
	return count;
}

void count_program(const struct step *step, struct program *program)
{
	struct tally t = { step, program, NULL };
	bool first = true;
	struct cost left = cost_of_forms(step, step->model->remainder.force_columns,
					 (const struct form *const *)step->model->schedule.operator[0].left);
	for (int i = 0; i < program->actions; i++) {
		const struct action *a = &program->action[i];
		if (a->kind == ACTION_SUM)
			tally_sum(&t, a);
		if (a->kind == ACTION_COMBINE)
			program->additions += step->branch->system.force_columns;
		if (a->kind == ACTION_PREDICT) {
			tally_prediction(&t, first);
			first = false;
		}
	}
	int count = remainders_evaluated(program);
	program->multiplications += count * left.multiplications;
	program->additions += count * left.additions;
	program->calls = count * left.calls;
}

/* ---- the series of an expanded step ---- */

static void count_sum(const struct expansion *x, const struct sequence *s, int k, struct program *p)
{
	for (int i = 0; i < s->terms; i++) {
		const struct sequence_term *t = &s->term[i];
		if (t->factor && t->factor[k] == 0)
			continue;
		int pairs = t->kind == TERM_PRODUCT && k > 0 ? (t->a == t->b ? k / 2 + 1 : k + 1) : 1;
		if ((t->kind == TERM_SEQUENCE && k > x->sequence[t->a].top))
			continue;
		p->multiplications += pairs + 1;
		p->additions += pairs;
	}
}

/* Early part, and gains times the highest coefficients; the gains themselves once, at k = 1 */
static void count_joined(const struct expansion *x, const struct sequence *s, int k, struct program *p)
{
	bool sum = s->kind == SEQUENCE_INTEGRAL || s->kind == SEQUENCE_SUM;
	int own = sum ? 0 : s->kind == SEQUENCE_ROOT ? k / 2 : k - 1;
	int made = s->gains * (k == 1 ? 2 : 1);
	p->multiplications += made + (s->kind == SEQUENCE_INTEGRAL ? s->gains : 0);
	p->additions += made;
	p->multiplications += s->kind == SEQUENCE_POWER ? 2 * own + 1 : own;
	p->additions += own;
	for (int i = 0; i < s->terms; i++) {
		const struct sequence_term *t = &s->term[i];
		bool pair = t->kind == TERM_PRODUCT, made_of = pair || t->kind == TERM_SEQUENCE;
		if (t->factor && t->factor[k] == 0)
			continue;
		int old = !pair ? !made_of : t->a == t->b ? k / 2 : k - 1;
		const struct sequence *a = made_of ? &x->sequence[t->a] : NULL, *b = pair ? &x->sequence[t->b] : NULL;
		int early = (a && (a->split || a->known)) + (b && a != b && (b->split || b->known));
		p->multiplications += old + (old > 0) + early * (pair ? 2 : 1);
		p->additions += old + early;
	}
}

/* Its share of the factors, of the solution, and of its residual's part that the solution of this order is not in */
static void count_solution(const struct sequence *s, int k, struct program *p)
{
	int n = s->equations->n, products = n + (k == 0 ? n * (n + 1) / 6 + 1 : 0);
	p->multiplications += products;
	p->additions += products;
}

static void count_sequence(const struct expansion *x, const struct sequence *s, int k, struct program *p)
{
	int from = s->kind == SEQUENCE_INTEGRAL ? k - 1 : k;
	if (s->gains && from > 0) {
		count_joined(x, s, from, p);
		return;
	}
	switch (s->kind) {
	case SEQUENCE_SUM:
		count_sum(x, s, k, p);
		break;
	case SEQUENCE_INTEGRAL:
		if (k > 0)
			count_sum(x, s, k - 1, p);
		else
			p->calls += s->state == NONE;
		break;
	case SEQUENCE_ROOT:
		p->multiplications += k / 2 + 2;
		p->additions += k / 2 + 1;
		p->calls += k == 0;
		break;
	case SEQUENCE_QUOTIENT:
	case SEQUENCE_POWER:
		p->multiplications += (s->kind == SEQUENCE_POWER ? 2 : 1) * k + 1;
		p->additions += k;
		p->calls += s->kind == SEQUENCE_POWER && k == 0;
		break;
	case SEQUENCE_RATE:
		p->multiplications++;
		break;
	case SEQUENCE_SOLUTION:
		count_solution(s, k, p);
		break;
	case SEQUENCE_CHOICE:
		break;
	}
}

static void count_sequences(const struct expansion *x, struct program *program)
{
	for (int i = 0; i < x->count; i++)
		for (int k = 0; k <= x->sequence[i].top; k++)
			count_sequence(x, &x->sequence[i], k, program);
}

int multiplications_of_series(const struct expansion *x)
{
	struct program counted = { .multiplications = 0 };
	count_sequences(x, &counted);
	return counted.multiplications;
}

void count_expansion(const struct step *step, struct program *program)
{
	enum { TWO_SUM = 8 };           /* of pl_accumulate, with what it is given 0 */
	const struct expansion *x = step->taylor.expansion;
	const struct linear *system = &step->branch->system;
	count_sequences(x, program);
	program->additions += system->states * (x->order + TWO_SUM);
	for (int l = 0, column = 0; l < system->loads; l++)
		for (int k = 0; k < system->load[l].columns; k++, column++)
			program->uses[column] = x->load[l];
	count_loads(program, step);
}

/* ---- Newton's method in a collocated step ---- */

/* Elimination of n unknowns, and one right side; of complex numbers four times that */
static int elimination(int n)
{
	return n * (n * n - 1) / 3 + n * n;
}

static struct cost cost_of_motion(const struct step *step)
{
	const struct motion *m = step->collocation->motion;
	const int n = m->coords;
	const struct form **form = ARRAY(const struct form *, (size_t)(n + m->entries) + 1);
	for (int i = 0; i < n; i++)
		form[i] = m->force[i];
	for (int k = 0; k < m->entries; k++)
		form[n + k] = m->entry[k].slope;
	return cost_of_forms(step, m->apart ? n : n + m->entries, form);
}

static struct cost cost_beside_contacts(const struct step *step)
{
	struct recurrences *r = motion_recurrences(step);
	set_motion(step, r, !step->collocation->motion->apart);
	return cost_of_tape(tape_of_recurrences(r));
}

void count_collocation(struct step *step)
{
	enum { OF_COMPLEX = 4 };
	const struct motion *m = step->collocation->motion;
	int s = step->collocation->stages, n = m->coords, sums = 2 * s * s * n, solved;
	bool apart = m->apart;
	struct cost cost = has_contacts(step->model) ? cost_beside_contacts(step) : cost_of_motion(step);
	solved = apart ? n * n * (1 + OF_COMPLEX * (s - 1) / 2) + 2 * s * s * n
		       : elimination(s * n) + m->entries * s * s;
	struct cost all = { sums + solved, sums + solved, 0 };
	add_cost(&all, s, cost);
	step->collocation->iteration.multiplications = all.multiplications;
	step->collocation->iteration.additions = all.additions;
	step->collocation->iteration.calls = all.calls;
	if (!step->taylor.expansion)
		set_cost(step->program, all);
}

/* Loads whose functions the factors of forces read */
static void mark_loads_read(const struct step *step, struct program *program)
{
	const struct splitting *split = step->model->remainder.split;
	const struct linear *system = &step->branch->system;
	const struct form **form = ARRAY(const struct form *, (size_t)split->functions);
	for (int f = 1; f < split->functions; f++)
		form[f - 1] = split->function[f].form;
	struct reads r = reads_of(step->model, split->functions - 1, form);
	for (int l = 0, column = 0; l < system->loads; l++) {
		bool read = r.load[l];
		for (int k = 0; k < split->forcings; k++)
			read = read || split->forcing[k].forcing == system->load[l].forcing;
		for (int k = 0; k < system->load[l].columns; k++, column++)
			program->uses[column] = program->uses[column] || read;
	}
}

/* What forcing terms add to eta and eta' of each mode: cos and sin, or e^{a t} alone */
static int forcing_products(const struct step *step)
{
	const struct splitting *split = step->model->remainder.split;
	int values = 0;
	for (int k = 0; k < split->forcings; k++)
		values += oscillates(split->forcing[k].forcing) ? 2 : 1;
	return 2 * step->normal->modes * values;
}

static struct cost cost_of_matrix(const struct normal *normal, const struct normal_matrix *m)
{
	struct cost cost = { 0, 0, 0 };
	for (int i = 0; i < normal->modes * normal->modes; i++)
		cost.multiplications += m->value[i] != 0;
	cost.additions = cost.multiplications;
	cost.multiplications += m->terms * normal->modes;
	cost.additions += (m->terms - 1) * normal->modes;
	return cost;
}

/* Of one evaluation of the forces on the modes */
static struct cost cost_of_forces(const struct step *step)
{
	const struct normal *normal = step->normal;
	struct cost all = { 0, 0, 0 };
	for (int k = 0; k < normal->matrices; k++)
		add_cost(&all, 1, cost_of_matrix(normal, &normal->matrix[k]));
	for (int f = 0; f < step->model->remainder.split->functions; f++)
		add_cost(&all, normal->force[f] ? normal->modes : 0, (struct cost){ 1, 1, 0 });
	return all;
}

void count_normal(const struct step *step, struct program *program)
{
	const struct normal *normal = step->normal;
	const struct splitting *split = step->model->remainder.split;
	struct cost force = cost_of_forces(step);
	int n = normal->modes, points = normal->multistep.points, evaluations = normal->multistep.twice ? 2 : 1,
	    forms = 0;
	const struct form **form = ARRAY(const struct form *, (size_t)(split->functions + split->rests) + 1);
	for (int f = 1; f < split->functions; f++)
		form[forms++] = split->function[f].form;
	struct cost c = cost_of_forms(step, forms, form);
	for (int k = 0; k < split->rests; k++)
		form[forms + k] = split->rest[k].form;
	struct cost all = cost_of_forms(step, forms + split->rests, form);
	add_cost(&force, 1, all);
	add_cost(&force, -1, c);
	add_cost(&force, split->rests, (struct cost){ n + 1, n, 0 });
	add_cost(&c, evaluations, force);
	add_cost(&c, forcing_products(step) + n * (3 * points + 6), (struct cost){ 1, 1, 0 });
	set_cost(program, c);
	mark_loads_read(step, program);
	count_loads(program, step);
}
