/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a spec says of single states: in which range they stay, what a step may add to them. */
#include "building.h"
#include "checks.h"

typedef void take_bound(struct building *b, const struct state_bound *bound, int state);
struct bound_work {
	struct building *b;
	const struct state_bound *bound;
	take_bound *take;
};

/* Of all components where none is named */
static void evaluate_bound(void *context)
{
	struct bound_work *work = context;
	const struct state_bound *bound = work->bound;
	const struct symbol *coord = bound->coord;
	int first = coord->index + (bound->component ? bound->component - 1 : 0),
	    count = bound->component || !coord->length ? 1 : coord->length;
	if (bound->primes == 1 && coord->highest == 1)
		error(bound->at, format("it is of first order: %s alone is a state", coord->name),
		      "%s' is no state", coord->name);
	for (int i = first; i < first + count; i++)
		work->take(work->b, bound, bound->primes ? work->b->model->system.velocity[i] : i);
}

static void evaluate_bounds(struct building *b, int count, const struct state_bound *bound, take_bound *take)
{
	for (int i = 0; i < count; i++)
		statement_guard(evaluate_bound, &(struct bound_work){ b, &bound[i], take });
}

static void evaluate_interval(struct building *b, struct node *from, struct node *to, mpq_ptr low, mpq_ptr high)
{
	collect_constant(&b->collector, from, low);
	collect_constant(&b->collector, to, high);
	if (mpq_cmp(low, high) >= 0)
		error(to->start, NULL, "a range ends above where it begins, found %s and %s", readable_text(low),
		      readable_text(high));
	if (beyond_range(low) || beyond_range(high))
		error(from->start, NULL, "the range is beyond that of %s", target_name());
}

static struct state_range *range_of(struct model *model, int state)
{
	for (int i = 0; i < model->ranges; i++)
		if (model->range[i].state == state)
			return &model->range[i];
	struct state_range *range = MORE(model->range, model->ranges);
	range->state = state;
	mpq_inits(range->low, range->high, NULL);
	return range;
}

static void take_range(struct building *b, const struct state_bound *bound, int state)
{
	struct model *model = b->model;
	struct state_range *range = range_of(model, state);
	range->at = bound->at;
	evaluate_interval(b, bound->low, bound->high, range->low, range->high);
	if (mpq_cmp(model->initial[state], range->low) < 0 || mpq_cmp(model->initial[state], range->high) > 0)
		error(bound->at, "its initial value has to be there", "%s starts at %s, outside of its range",
		      model->names.state[state], readable_text(model->initial[state]));
}

static void evaluate_absolute(struct building *b, struct node *node, mpq_ptr value)
{
	collect_constant(&b->collector, node, value);
	if (mpq_sgn(value) <= 0)
		error(node->start, "it has the unit of the state", "an absolute tolerance is above 0, found %s",
		      readable_text(value));
	if (beyond_range(value) || round_rational(value) == 0)
		error(node->start, NULL, "the tolerance is beyond the range of %s", target_name());
}

static void take_absolute(struct building *b, const struct state_bound *bound, int state)
{
	evaluate_absolute(b, bound->low, b->model->truncation.absolute[state]);
}

static void evaluate_all_absolute(void *context)
{
	struct building *b = context;
	mpq_t *absolute = b->model->truncation.absolute;
	evaluate_absolute(b, b->spec->request.absolute, absolute[0]);
	for (int i = 1; i < b->model->system.states; i++)
		mpq_set(absolute[i], absolute[0]);
}

/* Of what is kept in the place of written coordinates: as of the coordinate there; of a further one as of the first */
static void relative_absolutes(struct model *model)
{
	const struct model *written = model->written;
	const mpq_t *given = written->truncation.absolute;
	for (int i = 0; i < model->system.states && given; i++) {
		int coord = model->system.coord[i], like = coord < written->n ? coord : 0;
		int velocity = written->system.velocity[like];
		mpq_set(model->truncation.absolute[i], given[i >= model->n && velocity >= 0 ? velocity : like]);
	}
}

void evaluate_absolutes(struct building *b)
{
	struct model *model = b->model;
	if (!b->spec->request.absolute && b->spec->request.absolutes == 0)
		return;
	model->truncation.absolute = rationals(model->system.states);
	if (model->relative) {
		relative_absolutes(model);
		return;
	}
	if (b->spec->request.absolute)
		statement_guard(evaluate_all_absolute, b);
	evaluate_bounds(b, b->spec->request.absolutes, b->spec->request.absolute_of, take_absolute);
}

void evaluate_ranges(struct building *b)
{
	evaluate_bounds(b, b->spec->states.ranges, b->spec->states.range, take_range);
}

struct param_work {
	struct building *b;
	const struct tunable *param;
	const struct param_range **range;
};

static void evaluate_param_range(void *context)
{
	const struct param_work *work = context;
	const struct tunable *param = work->param;
	struct param_range *range = NEW(struct param_range);
	RATIONAL value = ZERO;
	mpq_inits(range->low, range->high, NULL);
	evaluate_interval(work->b, param->low, param->high, range->low, range->high);
	*work->range = range;
	if (work->b->request->again.tunable)    /* built with other values, to learn what follows from them */
		return;
	if (param->symbol->made.progress != COLLECTED)  /* it was said what is wrong with the value */
		return;
	param_value(param->symbol, value);
	if (mpq_cmp(value, range->low) < 0 || mpq_cmp(value, range->high) > 0)
		error(param->at,
		      param->symbol->unit_written ? "a bound without a unit is in SI units, as this value is"
						  : "the spec's own value has to be there",
		      "param '%s' is %s, outside of its range", param->symbol->name, readable_text(value));
}

void evaluate_param_ranges(struct building *b)
{
	const int given = b->spec->tuned.count - b->spec->tuned.derived;
	b->model->params.range = ARRAY(const struct param_range *, (size_t)given + 1);
	for (int k = 0; k < given; k++)
		if (b->spec->tuned.tunable[k].low)
			statement_guard(evaluate_param_range, &(struct param_work){
					b, &b->spec->tuned.tunable[k], &b->model->params.range[k] });
}
