/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which scheme the equations allow: exact, exact in regions, or one with a remainder. */
#include "building.h"
#include "capability.h"
#include "state_mass.h"
#include "checks.h"
#include "model/contacts/contacts.h"
#include "model/contacts/friction.h"

struct change {                     /* of formula in time */
	struct building *b;
	const struct segment_equations *segment_equations; /* after it */
	int index;
};

static bool same_cells(const struct value *a, const struct value *b)
{
	if (a->rows != b->rows || a->columns != b->columns)
		return false;
	for (int i = 0; i < a->rows * a->columns; i++)
		if (!same_in_states(a->cell[i], b->cell[i]))
			return false;
	return true;
}

static struct value *collect_in(struct building *b, struct node *node, int segment)
{
	b->collector.interval = segment;
	forget_lets(b->spec);
	return collect(&b->collector, node);
}

/* The first term of sums whose coordinates or inputs are not those of the first segment. */
static const struct node *changing_term(struct building *b, struct node *node, int segment)
{
	const struct node *found = NULL;
	if (node->kind != NODE_SUM)
		return same_cells(collect_in(b, node, 0), collect_in(b, node, segment)) ? NULL : node;
	for (int i = 0; i < node->children && !found; i++)
		found = changing_term(b, node->child[i], segment);
	return found;
}

/* Of network elements and energies: the equations have their derivatives. NULL: it stays what it is */
static const struct node *changing_element(struct building *b, int i, int segment)
{
	struct node *value = b->spec->element[i].value;
	const struct node *term = NULL;
	if (same_in_states(b->segment_equations[0].element[i], b->segment_equations[segment].element[i]))
		return NULL;
	if (b->spec->element[i].kind != ELEMENT_ENERGY)
		term = changing_term(b, value, segment);
	return term ? term : value;
}

static const struct node *first_changing_term(struct building *b, int segment)
{
	const struct spec *spec = b->spec;
	const struct node *term = NULL;
	for (int i = 0; i < spec->equations && !term; i++) {
		term = changing_term(b, spec->equation[i].left, segment);
		term = term ? term : changing_term(b, spec->equation[i].right, segment);
	}
	for (int i = 0; i < spec->elements && !term; i++)
		term = changing_element(b, i, segment);
	return term;
}

static void report_change(void *context)
{
	struct change *work = context;
	struct building *b = work->b;
	const struct spec *spec = b->spec;
	for (int i = 0; i < spec->elements; i++)
		if (spec->element[i].kind < ELEMENT_FORCE &&
		    !same_in_states(b->segment_equations[0].element[i], work->segment_equations->element[i]))
			error(spec->element[i].value->start, "what moves belongs in an equation, or in a force",
			      "a mass, spring or damper needs a constant");
	const struct node *term = first_changing_term(b, work->index);
	b->collector.term = term;
	not_linear(&b->collector, term,
		   format("has a factor that changes at t = %s",
			  readable_text(b->model->system.change[work->index - 1])));
}

static bool same_equations(const struct building *b, const struct segment_equations *s)
{
	for (int i = 0; i < b->model->n; i++)
		if (!same_in_states(b->segment_equations->residual[i].form, s->residual[i].form))
			return false;
	return true;
}

/* Before equations belong to coordinates: what they take */
struct demands { bool linear, piecewise; }; /* linear equations do; switching between such */

static struct demands demands_of(const struct building *b)
{
	const struct segment_equations *first = b->segment_equations;
	const int segments = b->model->system.segments;
	bool atoms = false, same = true, piecewise = true;
	for (int s = 0; s < segments; s++) {
		same = same && first[s].residuals == first->residuals;
		for (int i = 0; i < first[s].residuals + b->spec->elements; i++) {
			const int e = i - first[s].residuals;
			const struct form *form = e < 0 ? first[s].residual[i].form : first[s].element[e];
			same = same && same_in_states(form, e < 0 ? first->residual[i].form : first->element[e]);
			atoms = atoms || holds_atom(form);
			piecewise = piecewise && is_piecewise_form(form) && !atom_of_highest(form);
		}
	}
	return (struct demands){ same && !atoms, piecewise && (same || atoms) };
}

/* Of constant coefficients, without inputs, and the same at all times */
static bool is_plain_constraint(const struct building *b, int index)
{
	const struct segment_equations *first = b->segment_equations;
	bool plain = true;
	for (int s = 0; s < b->model->system.segments; s++)
		for (int k = 0; k < 3; k++) {
			const struct form *by = first[s].constraint[index].by[k];
			for (int i = 0; by && i < by->terms; i++)
				plain = plain && by->term[i].basis.kind != BASIS_INPUT;
			plain = plain && (!by || (!holds_atom(by) && same_form(by, first->constraint[index].by[k])));
		}
	return plain;
}

/* Where loads change their formula, a multiplier that an output has by itself has rows; what else is made of it may
 * not be linear. */
static bool reads_plain_multipliers(const struct building *b)
{
	bool plain = true;
	for (const struct symbol *s = b->spec->first; s && b->model->system.segments > 1; s = s->next)
		plain = plain && (s->kind != SYMBOL_OUTPUT || !multiplier_in(s->value) ||
				  (s->value->kind == NODE_NAME && s->value->symbol->kind == SYMBOL_MULTIPLIER));
	return plain;
}

/* Whether constraints leave equations that are linear, in which nothing is tuned or derived by, and scheme exact takes
 * them: as they are collected, before elements are added */
static bool may_eliminate(const struct building *b)
{
	const struct request *request = b->request;
	const struct spec *spec = b->spec;
	bool may = spec->count.multipliers > 0 && b->model->scheme == SCHEME_EXACT && demands_of(b).linear &&
		   b->model->contacts.impacts == 0 && spec->whens == 0 && spec->tuned.count == 0 &&
		   spec->sensitivities == 0 && !request->sensitivity && !request->external &&
		   !request->passed_over && !request->loads_left && !request->linear.where &&
		   !spec->operators.given && !spec->modes.at.source && !request->modes && !request->reduce &&
		   reads_plain_multipliers(b);
	for (int i = 0; i < spec->count.multipliers && may; i++)
		may = is_plain_constraint(b, i);
	return may;
}

/* Outputs that read multipliers, now that these are solved for */
static void read_multipliers(struct building *b)
{
	for (int s = 0; s < b->model->system.segments; s++) {
		b->collector.interval = s;
		forget_lets(b->spec);
		collect_outputs(b, &b->segment_equations[s]);
	}
	b->collector.interval = 0;
}

/* Of loads only where nothing goes from event to event */
bool leaves_over(const struct building *b)
{
	const struct scheme_row *row = scheme_row(b->model->scheme);
	const struct demands demands = demands_of(b);
	const bool loads = b->request->loads_left && b->spec->whens == 0;
	if (b->request->solution)
		return false;
	if (!b->model->request.at.scheme.source || b->spec->count.multipliers > 0)
		return !demands.piecewise || b->spec->count.multipliers > 0;
	return b->model->scheme != SCHEME_EXACT && !row->holds_coupling &&
	       (!demands.linear || row->expands || row->modes || loads || b->spec->operators.given);
}

bool needs_regions(const struct building *b)
{
	const struct demands demands = demands_of(b);
	return b->model->scheme == SCHEME_EXACT && demands.piecewise && (!demands.linear || b->spec->whens > 0);
}

/* Tunable params change matrices of regions; a scheme without a remainder has none for its parts between impacts. */
void go_by_regions_where_tuned(struct building *b)
{
	struct model *model = b->model;
	if (b->spec->whens == 0 || !model->request.at.scheme.source || model->scheme == SCHEME_EXACT || leaves_over(b))
		return;
	stand_aside(model->request.at.scheme, format("scheme %s", scheme_name(model->scheme)),
		    "without a remainder, impacts and tunable params go by the regions of scheme exact");
	model->scheme = SCHEME_EXACT;
}

/* Only loads may change their formula in time. */
static bool check_changes(struct building *b)
{
	for (int s = 1; s < b->model->system.segments; s++)
		if (!same_equations(b, &b->segment_equations[s]))
			return statement_guard(report_change, &(struct change){ b, &b->segment_equations[s], s });
	return true;
}

const struct node *changing_factor(struct building *b, int segment)
{
	if (same_equations(b, &b->segment_equations[segment]))
		return NULL;
	const struct node *term = first_changing_term(b, segment);
	b->collector.interval = 0;
	forget_lets(b->spec);
	return term;
}

/* An equation is as many scalar ones at all times. */
static bool check_sizes(const struct building *b)
{
	const struct segment_equations *first = b->segment_equations;
	for (int s = 1; s < b->model->system.segments; s++)
		for (int i = 0; i < first->written || i < first[s].written; i++)
			if (i >= first->written || i >= first[s].written ||
			    first->residual[i].at.offset != first[s].residual[i].at.offset) {
				say_error((i < first->written ? first : first + s)->residual[i].at, NULL,
					  "the size of the equation changes at t = %s",
					  readable_text(b->model->system.change[s - 1]));
				return false;
			}
	return true;
}

bool is_linear(const struct building *b)
{
	for (int s = 0; s < b->model->system.segments; s++)
		for (int i = 0; i < b->model->n; i++)
			if (holds_atom(b->segment_equations[s].residual[i].form) ||
			    !same_equations(b, &b->segment_equations[s]))
				return false;
	return true;
}

/* In one interval, loads with the spec's values of params; what is more by other values is in the remainder. */
static void part_nominal_loads(struct building *b, int row, const struct form *full)
{
	const struct form *here = form_at(point_new(&b->collector, 0, NULL), full), *known = nominal_form(b, here);
	b->load[row] = form_sum(known, time_part(known, true), true);
	b->time_left[row] = form_sum(here, b->load[row], true);
}

/* What depends on time alone, in each interval of time: t < 1 ? ... has one formula there. What is then still no load,
 * such as sqrt(t), is in the remainder if it is the same in all intervals; if it is not, all that is no plain load for
 * all time is. */
static void part_loads(void *context)
{
	struct building *b = context;
	struct collector *c = &b->collector;
	int n = b->model->n, segments = b->model->system.segments;
	b->load = ARRAY(struct form *, (size_t)(segments * n));
	b->time_left = ARRAY(struct form *, n);
	struct point *point = point_new(c, 0, NULL);
	for (int i = 0; i < n; i++) {
		const struct form *full = time_part(b->full->residual[i].form, false);
		bool same = true;
		if (parts_params(b)) {
			part_nominal_loads(b, i, full);
			continue;
		}
		for (c->interval = 0; c->interval < segments; c->interval++) {
			struct form *here = form_at(point, full), *left = time_part(here, true);
			b->load[c->interval * n + i] = form_sum(here, left, true);
			b->time_left[i] = c->interval == 0 ? left : b->time_left[i];
			same = same && same_form(left, b->time_left[i]);
		}
		if (!same)
			b->time_left[i] = time_part(full, true);
		for (int s = 0; s < segments && !same; s++)
			b->load[s * n + i] = form_sum(full, b->time_left[i], true);
	}
	c->interval = 0;
}

static const struct form *load_form(const struct building *b, int segment, int row)
{
	return b->full ? b->load[segment * b->model->n + row] : b->segment_equations[segment].residual[row].form;
}

/* The first in the text of those that are not piecewise linear; or of all */
static const struct atom *first_atom(const struct building *b, bool all)
{
	const struct atom *first = NULL;
	const struct segment_equations *segment_equations = b->nominal ? b->nominal : b->segment_equations;
	for (int s = 0; s < (b->nominal ? b->nominals : b->model->system.segments); s++)
		for (int i = 0; i < segment_equations[s].residuals; i++)
			for (int k = 0; k < segment_equations[s].residual[i].form->terms; k++) {
				const struct basis *basis = &segment_equations[s].residual[i].form->term[k].basis;
				const struct atom *a = basis->atom;
				if (a && (!first || a->node->start.offset < first->node->start.offset) &&
				    (all || !is_piecewise_form(form_unit(*basis))))
					first = a;
			}
	return first;
}

/* Scheme exact was asked for, and what it would have to switch on it cannot */
static void report_atom(void *context)
{
	const struct building *b = context;
	const struct atom *atom = first_atom(b, false);
	const char *rewrite = rewrite_of(atom->node, b->spec->lagrange.energies == 0);
	error(atom->node->start, format("%s%s%s and %s are the schemes that could", rewrite, *rewrite ? "; " : "",
					leaving_schemes(", "), holding_schemes()),
	      "'%s' is not piecewise linear: scheme exact cannot treat it",
	      text_between(atom->node->start, atom->node->end));
}

/* No scheme was asked for, and exact is not possible: what stood in its way */
static void find_obstacle(void *context)
{
	struct building *b = context;
	struct model *model = b->model;
	for (int s = 0; b->nominal && s < b->nominals; s++)
		add_elements(b, &b->nominal[s]);
	const struct atom *atom = first_atom(b, false);
	const bool held = atom && is_constant_system(atom);
	const bool kink = atom && atom->kind == ATOM_SOLUTION && atom->node->kind == NODE_CALL &&
			  atom->node->function >= FN_ABS;
	const char *why = held ? "is a constraint"
			  : kink ? "has a kink in what equations are solved for"
				 : "is not piecewise linear", *rewrite;
	model->nonlinear.obstacle = atom ? atom->node : NULL;
	for (int s = 1; s < model->system.segments && !model->nonlinear.obstacle; s++) {
		model->nonlinear.obstacle = changing_factor(b, s);
		why = format("has a factor that changes at t = %s", readable_text(model->system.change[s - 1]));
	}
	if (!model->nonlinear.obstacle && curved_guard(b)) {
		model->nonlinear.obstacle = curved_guard(b)->guard->child[0];
		model->nonlinear.why = "is the guard of a stop, and not linear";
		return;
	}
	if (b->crowded) {
		atom = first_atom(b, true);
		model->nonlinear.obstacle = atom ? atom->node : b->spec->when->guard->child[0];
		model->nonlinear.why = "and others have more regions than it takes";
	}
	if (!model->nonlinear.obstacle || b->crowded)
		return;
	rewrite = rewrite_of(model->nonlinear.obstacle, b->spec->lagrange.energies == 0);
	model->nonlinear.why = format("%s%s%s", why, *rewrite ? "; " : "", rewrite);
}

/* The first scheme to try where exact is not possible and none was asked for. What is smooth has its Taylor series; an
 * operator, and loads in the remainder, have been written for schemes that take the equations apart: of many states
 * in normal modes. */
static enum scheme scheme_of_choice(const struct building *b)
{
	bool many = b->model->system.states > LIMIT_UNROLLED_STATES;
	if (b->model->contacts.impacts > 0 || holds_friction(b) || b->spec->count.multipliers > 0)
		return SCHEME_TAYLOR;           /* no other goes from event to event, or projects */
	if (b->request->passed_over || b->request->loads_left)
		return default_scheme();
	return !b->spec->operators.given ? SCHEME_TAYLOR : many ? SCHEME_ETDAM4 : default_scheme();
}

/* By a Taylor series or a collocation, from event to event: where it was asked for, or scheme exact cannot */
static bool goes_by_series(const struct building *b)
{
	const struct model *model = b->model;
	bool chosen = !model->request.at.scheme.source && !is_piecewise_linear(b);
	return (stops_at_events(model->scheme) || chosen) && !impacts_change(b) && !b->request->solution &&
	       !b->request->loads_left;
}

/* Clearances, friction and impacts that no scheme was asked for, and that have more regions than exact can take */
static bool is_crowded(struct building *b, bool linear)
{
	return !b->model->request.at.scheme.source && is_piecewise_linear(b) && !impacts_change(b) &&
	       (!linear || b->model->contacts.impacts > 0 || holds_friction(b)) && !b->request->solution &&
	       b->spec->tuned.count == 0 && !b->spec->request.cached && has_too_many_regions(b);
}

static bool goes_by_regions(const struct building *b)
{
	return b->model->scheme == SCHEME_EXACT && is_piecewise_linear(b);
}

/* Impacts go from event to event. */
static void resolve_impacts(void *context)
{
	struct building *b = context;
	bool exact = goes_by_regions(b);
	if (!exact && !goes_by_series(b))
		report_no_events(b, b->spec->when->at);
	build_impacts(b);
	if (diagnostics_errors())
		abandon();
}

static void report_friction_stands(void *context)
{
	report_no_friction(context);
}

static void choose_beside_contacts(void *context)
{
	find_contacts(context);
}

/* Loads are not in the remainder, where that is asked for in vain. */
static void keep_loads(struct building *b, const char *why)
{
	if (!b->request->loads_left)
		return;
	stand_aside(b->model->request.at.scheme.source ? b->model->request.at.scheme : b->spec->name_at,
		    "--loads remainder", why);
	struct request *request = NEW(struct request);
	*request = *b->request;
	request->loads_left = b->model->request.loads_left = false;
	b->request = request;
}

/* Before contacts ask for events: a scheme that was asked for may project nothing. */
static void refuse_constraints(void *context)
{
	const struct building *b = context;
	refuse(CAN_CONSTRAINTS, b->model, b->segment_equations->constraint[0].statement->at);
}

/* Exact where there is no remainder and no scheme was asked for; the equations for all time where something is. */
static bool choose_scheme(struct building *b)
{
	struct model *model = b->model;
	bool linear = is_linear(b) && model->contacts.impacts == 0;
	const bool constrained = b->spec->count.multipliers > 0 && !b->eliminates;
	if (model->contacts.impacts > 0 || holds_friction(b))
		keep_loads(b, "what goes from event to event has no quadrature");
	if (constrained && (model->request.at.scheme.source || b->request->solution) &&
	    !statement_guard(refuse_constraints, b))
		return false;
	if (model->contacts.impacts > 0 && !statement_guard(resolve_impacts, b))
		return false;
	if (!linear && holds_friction(b) && !goes_by_regions(b) && !goes_by_series(b))
		return statement_guard(report_friction_stands, b);
	b->crowded = is_crowded(b, linear);
	const bool exact = !constrained && is_piecewise_linear(b);
	if ((!linear || constrained) && !model->request.at.scheme.source && !b->request->solution && !exact) {
		model->scheme = scheme_of_choice(b);
		choose_order(model, b->request->single);
		silent_guard(find_obstacle, b);
	}
	b->collector.scheme = scheme_name(model->scheme);
	if (model->scheme == SCHEME_EXACT)
		keep_loads(b, format("scheme exact has no quadrature; %s have", leaving_schemes(" and ")));
	if (model->scheme == SCHEME_EXACT && (!linear || b->request->again.by_regions) && is_piecewise_linear(b)) {
		if (!model->switching)
			find_regions(b);
		collect_full(b);                /* for outputs and NAME_rhs */
		if (!diagnostics_errors())
			statement_guard(part_loads, b);
		return !diagnostics_errors();
	}
	if (model->scheme == SCHEME_EXACT && first_atom(b, true) && !constrained)
		return statement_guard(report_atom, b);
	if (model->scheme == SCHEME_EXACT)
		return check_changes(b);
	if (!linear || b->request->loads_left || b->spec->operators.given)
		collect_full(b);
	/* in normal modes known loads are forces like others */
	model->remainder.loads = b->full && (b->request->loads_left || scheme_row(model->scheme)->modes);
	if (b->full && !diagnostics_errors())
		statement_guard(part_loads, b);
	if (b->full && !diagnostics_errors() && (model->contacts.impacts > 0 || holds_friction(b)) &&
	    !statement_guard(choose_beside_contacts, b))
		return false;
	return !diagnostics_errors();
}

/* Whether at the start some part decays so fast that stability, not accuracy, would bound the steps of a series: then
 * the series goes beside a method that bears it. */
static bool is_stiff(struct building *b)
{
	struct model *model = b->model;
	struct jacobian j = { .b = b, .damped = true, .state = model->initial };
	mpq_init(j.t);
	const bool equation = b->collector.equation;
	bool moves = b->full->masses > 0 && !b->spec->count.multipliers;
	moves = moves || model->equations.implicit;
	b->collector.equation = moves;
	bool known = moves ? silent_guard(jacobian_of_motion, &j)
			   : silent_guard(jacobian_forms, &j) && silent_guard(jacobian_evaluate, &j);
	b->collector.equation = equation;
	mpq_clear(j.t);
	return known && fastest_decay(&j.at) * nearest_double(model->h) > 0.8 + 0.1 * model->truncation.order;
}

/* A root of time alone that comes to 0, where it has no Taylor series: sqrt(t), max(t - 1, 0)^1.5 */
static bool is_root_at_zero(const struct atom *a)
{
	if ((a->kind != ATOM_POWER && !(a->kind == ATOM_CALL && a->function == FN_SQRT)) || a->state || a->velocity ||
	    a->input)
		return false;
	const mpq_srcptr exponent = a->kind == ATOM_POWER ? factor_of(a->operand[1], BASIS_ONE) : NULL;
	if (exponent && mpz_cmp_ui(mpq_denref(exponent), 1) == 0)
		return false;
	mpq_srcptr factor, constant;
	struct form phase;
	bool pieces = false;                    /* ends of them may be 0 at any time */
	if (linear_in_time(a->operand[0], &factor, &phase)) {
		constant = factor_of(&phase, BASIS_ONE);
		return !constant || mpq_sgn(constant) * mpq_sgn(factor) < 0;
	}
	for (int i = 0; i < a->operand[0]->terms; i++)
		pieces = pieces || a->operand[0]->term[i].basis.kind == BASIS_ATOM;
	return pieces && is_piecewise_form(a->operand[0]);
}

/* A collocation bears what has no Taylor series at a time, which its steps get shorter to */
static bool has_root_at_zero(const struct building *b)
{
	SCRATCH bool *seen = ARRAY(bool, (size_t)atoms_count(b->collector.atoms));
	bool any = false;
	for (int i = 0; i < b->full->residuals; i++)
		for (const struct form_term **term = terms_within(b->full->residual[i].form, seen); *term; term++)
			any = any || ((*term)->basis.kind == BASIS_ATOM && is_root_at_zero((*term)->basis.atom));
	return any;
}

static void prefer_stiff(struct building *b)
{
	struct model *model = b->model;
	if (!model->nonlinear.obstacle || model->scheme != SCHEME_TAYLOR || (!is_stiff(b) && !has_root_at_zero(b)))
		return;
	model->scheme = SCHEME_AUTO;
	model->truncation.order = 0;
	choose_order(model, b->request->single);
	b->collector.scheme = scheme_name(model->scheme);
}

void build_system(struct building *b)
{
	struct model *model = b->model;
	struct linear *system = &model->system;
	if (!check_sizes(b) || !assign_equations(b))
		return;
	b->eliminates = may_eliminate(b);
	for (int s = 0; s < system->segments; s++)
		add_elements(b, &b->segment_equations[s]);
	if (!b->eliminates)
		model->equations.misses = 0;
	if (b->eliminates && !diagnostics_errors())
		read_multipliers(b);
	if (diagnostics_errors() || !choose_scheme(b))
		return;
	const struct segment_equations *rows = b->full ? b->full : b->segment_equations;
	fill_states(b, rows);
	for (int s = 0; s < system->segments && !model->remainder.loads; s++)
		for (int i = 0; i < model->n; i++)
			place_loads(b, load_form(b, s, i));
	if (model->switching)
		place_region_loads(b);
	else if (has_contacts(model))
		place_contact_loads(b);
	for (int s = 0; s < system->segments && !model->remainder.loads; s++)
		for (int i = 0; i < model->n; i++)
			fill_loads(b, s, i, load_form(b, s, i));
	model->equations.owner = b->owner;
	model->equations.reversed = b->reversed;
	model->equations.residual = rows->residual;
	model->equations.segment_equations = b->segment_equations;
	model->equations.full = b->full;
	if (b->spec->count.multipliers > 0 && !diagnostics_errors())
		keep_constraints(b);
	if (b->full && !diagnostics_errors())
		check_mass_at_start(b);
	if (b->full && !diagnostics_errors())
		silent_guard(find_conserved, b);
	if (b->full && !diagnostics_errors())
		prefer_stiff(b);
}
