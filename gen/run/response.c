/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What inputs within their bounds do to the outputs of a linear step at worst. A linear step adds up what it is given,
 * so what one sample does to an output at each later step tells all: the sum of sizes is reached by samples at their
 * bounds with the signs of those in reverse (Bulgakov's problem). */
#include "run/run.h"

#include <math.h>

static void subtract(struct course *a, const struct course *b)
{
	for (long k = 0; k < (a->samples + 1) * a->needs; k++)
		a->value[k] -= b->value[k];
}

struct input_response input_response_of(struct running *r, const mpq_t *most)
{
	const struct model *model = running_step_of(r)->model;
	struct input_response found = { .still = run_of(r, NULL, NULL, NULL), .inputs = sampled_inputs(model),
				  .by = ARRAY(struct course *, sampled_inputs(model)),
				  .size = ARRAY(double, sampled_inputs(model)) };
	struct sampled one = inputs_at_rest(model, sample_time(model), found.still->samples);
	for (int i = 0; i < found.inputs; i++) {
		double *first = &one.sample[one.ramps[i] * one.inputs + i];
		*first = found.size[i] = mpq_get_d(most[i]);
		found.by[i] = run_of(r, &one, NULL, NULL);
		subtract(found.by[i], found.still);
		*first = 0;
	}
	discard(one.sample);
	return found;
}

void input_response_less(struct input_response *a, const struct input_response *b)
{
	subtract(a->still, b->still);
	for (int i = 0; i < a->inputs; i++)
		subtract(a->by[i], b->by[i]);
}

double worst_of(const struct input_response *r, int need, const mpq_t *most)
{
	double worst = largest_of(r->still, need);
	for (int i = 0; i < r->inputs; i++) {
		const double scale = r->size[i] > 0 ? mpq_get_d(most[i]) / r->size[i] : 0;
		for (long k = 1; k <= r->still->end[need]; k++)
			worst += scale * fabs(r->by[i]->value[k * r->still->needs + need]);
	}
	return worst;
}

double reached_by(const struct input_response *r, int need, const mpq_t *most)
{
	const struct course *still = r->still;
	const double size = largest_of(still, need), last = fabs(still->value[still->end[need] * still->needs + need]);
	return fmax(size, worst_of(r, need, most) - size + last);
}

struct sampled worst_inputs(const struct input_response *r, int need, const struct model *model, const mpq_t *most)
{
	const struct course *still = r->still;
	const long end = still->end[need];
	struct sampled d = inputs_at_rest(model, sample_time(model), still->samples);
	for (long k = 0; k < end; k++)
		for (int i = 0; i < r->inputs; i++) {
			const bool down = (r->by[i]->value[(end - k) * still->needs + need] < 0) !=
					  (still->value[end * still->needs + need] < 0);
			d.sample[(k + d.ramps[i]) * d.inputs + i] = (down ? -1 : 1) * mpq_get_d(most[i]);
		}
	return d;
}

void input_response_free(struct input_response *r)
{
	course_free(r->still);
	for (int i = 0; i < r->inputs; i++)
		course_free(r->by[i]);
	discard(r->by);
	discard(r->size);
}
