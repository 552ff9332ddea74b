/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The order of a series and the stages of a collocation: as they are asked for, or from what a step may add. */
#include "model/building.h"
#include "model/checks.h"

#include <math.h>

enum { LEAST_LOBATTO = 2, MOST_LOBATTO = 12 };  /* stages of collocation in normal modes */

/* 8, 12, 16, 18 for 3, 6, 9, 12 digits: best within a third on smooth models, so much so that nobody needs to choose */
static int order_for(mpq_srcptr tolerance)
{
	double digits = -log10(mpq_get_d(tolerance));
	int order = (int)ceil(digits <= 9.001 ? 4 + 4 * (digits - 0.001) / 3 : 16 + 2 * (digits - 9.001) / 3);
	return order < LEAST_ORDER ? LEAST_ORDER : order;
}

/* 3, 5, 7, 9 for 3, 6, 9, 12 digits; beside them a series of about as many digits a step */
static void choose_stages(struct truncation *truncation, bool switches)
{
	static const int order_beside[MOST_STAGES + 1] = { [3] = 10, [5] = 16, [7] = 20, [9] = 24 };
	double digits = -log10(mpq_get_d(truncation->tolerance));
	if (!truncation->stages)
		truncation->stages = digits < 3.001 ? 3 : digits < 6.001 ? 5 : digits < 9.001 ? 7 : MOST_STAGES;
	truncation->order = switches ? order_beside[truncation->stages] : 2 * truncation->stages - 1;
}

void choose_order(struct model *model, bool single)
{
	struct truncation *truncation = &model->truncation;
	if (!scheme_row(model->scheme)->expands || truncation->order)
		return;
	truncation->adaptive = true;
	if (mpq_sgn(truncation->tolerance) == 0)
		mpq_set_ui(truncation->tolerance, 1, single ? 100000 : 1000000000);
	if (scheme_row(model->scheme)->collocates)
		choose_stages(truncation, scheme_row(model->scheme)->switches);
	else
		truncation->order = order_for(truncation->tolerance);
}

/* ---- what the command line and the spec ask for ---- */

struct node *requested_or_written(struct building *b, const char *requested, struct node *written, struct place *at)
{
	if (!requested)
		return written;
	struct source *source = source_argument(requested);
	struct node *node = parse_argument(b->spec, source, 0, source->length);
	*at = (struct place){ source, 0 };
	if (!node)
		abandon();
	return node;
}

int whole_number(struct building *b, struct node *node, int low, int high, const char *what)
{
	RATIONAL value = ZERO;
	collect_constant(&b->collector, node, value);
	if (mpz_cmp_ui(mpq_denref(value), 1) != 0 || mpq_cmp_si(value, low, 1) < 0 || mpq_cmp_si(value, high, 1) > 0)
		error(node->start, NULL, "%s is a whole number from %d to %d, found %s", what, low, high,
		      readable_text(value));
	int number = (int)mpz_get_si(mpq_numref(value));
	return number;
}

static void set_least_tolerance(const struct building *b, mpq_ptr least)
{
	mpq_set_ui(least, 1, b->request->single ? 1000000 : 1000000000000000);
}

static void evaluate_tolerance(struct building *b, struct node *node, struct place at)
{
	struct truncation *truncation = &b->model->truncation;
	const bool single = b->request->single;
	RATIONAL least = ZERO;
	set_least_tolerance(b, least);
	collect_constant(&b->collector, node, truncation->tolerance);
	if (mpq_sgn(truncation->tolerance) <= 0 || mpq_cmp_ui(truncation->tolerance, 1, 1) >= 0)
		error(at, "it is relative to the largest value of each state so far",
		      "a tolerance is above 0 and below 1, found %s", readable_text(truncation->tolerance));
	if (mpq_cmp(truncation->tolerance, least) < 0)
		error(at, NULL, "a tolerance below %s is below the rounding of %s", single ? "1e-6" : "1e-15",
		      target_name());
}

static int stages_of(struct building *b, struct node *node)
{
	int stages = LEAST_STAGES;
	RATIONAL requested = ZERO;
	collect_constant(&b->collector, node, requested);
	while (stages <= MOST_STAGES && mpq_cmp_ui(requested, (unsigned long)stages, 1) != 0)
		stages += 2;
	if (stages > MOST_STAGES)
		error(node->start, NULL, "the number of stages of scheme %s is 3, 5, 7 or 9, found %s",
		      scheme_name(b->model->scheme), readable_text(requested));
	return stages;
}

/* The steps that one expansion of fixed order is over */
static int steps_of_expansion(struct building *b)
{
	struct node *over = b->model->request.series.over;
	const struct scheme_row *row = scheme_row(b->model->scheme);
	if (!over)
		return 1;
	if (!row->expands || row->collocates)
		error(over->start, "scheme taylor N over K", "no expansion of scheme %s is over several steps",
		      row->name);
	return whole_number(b, over, 1, MOST_OVER, "the number of steps of one expansion");
}

void evaluate_events(void *context)
{
	struct building *b = context;
	b->model->most_events = whole_number(b, b->spec->request.events, 1, LIMIT_EVENTS, "the most events");
}

/* Where states alone say how long steps are: derivatives are less smooth */
static void tighten(struct building *b)
{
	enum { LESS = 16 };
	RATIONAL least = ZERO, tighter = ZERO;
	set_least_tolerance(b, least);
	mpq_set_ui(tighter, 1, LESS);
	mpq_mul(tighter, tighter, b->model->truncation.tolerance);
	if (mpq_cmp(tighter, least) > 0)
		mpq_set(b->model->truncation.tolerance, tighter);
}

/* The order of a series, given or from its tolerance; the most steps within one h */
void evaluate_truncation(void *context)
{
	enum { SUBSTEPS = 1000, MOST_SUBSTEPS = 1000000000 };
	struct building *b = context;
	struct model *model = b->model;
	struct truncation *truncation = &model->truncation;
	struct place at = b->spec->request.tolerance ? b->spec->request.tolerance->start : model->request.at.scheme;
	struct node *tolerance = requested_or_written(b, b->request->tolerance, b->spec->request.tolerance, &at);
	struct node *order = model->request.series.order, *substeps = b->spec->request.substeps;
	const struct scheme_row *row = scheme_row(model->scheme);
	mpq_init(truncation->tolerance);
	if (row->stages) {
		truncation->stages = !order ? row->stages :
			whole_number(b, order, LEAST_LOBATTO, MOST_LOBATTO, "a number of stages");
		truncation->order = truncation->stages + 1;
	}
	if (order && !row->expands && !row->stages)
		error(order->start,
		      format("that of scheme taylor is given: scheme taylor %s",
			     text_between(order->start, order->end)),
		      "the order of scheme %s is its own", row->name);
	if (tolerance)
		evaluate_tolerance(b, tolerance, at);
	truncation->substeps = substeps ? whole_number(b, substeps, 1, MOST_SUBSTEPS, "the most substeps") : SUBSTEPS;
	if (order && row->collocates)
		truncation->stages = stages_of(b, order);
	else if (order && row->expands)
		truncation->order = whole_number(b, order, LEAST_ORDER, MOST_ORDER, "an order");
	truncation->over = steps_of_expansion(b);
	choose_order(model, b->request->single);
	if (b->request->again.held)
		tighten(b);
}

void unit_of_expansion(const struct model *model, mpq_ptr unit)
{
	mpq_set_si(unit, model->truncation.over, 1);
	mpq_mul(unit, unit, model->h);
}
