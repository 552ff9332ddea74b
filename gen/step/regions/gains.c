/* SPDX-License-Identifier: GPL-3.0-or-later */
/* e^{A d} - I of a region in two words: what a piece of the step adds to a state that keeps what rounding takes. */
#include "inner.h"
#include "model/reads.h"
#include "step/linear/images.h"

#include <math.h>

/* a + b in two words; of the target's type the first, and nearly so the second */
static void set_words(const struct step *step, double a, double b, double low, double *first, double *second)
{
	double sum = a + b, part = sum - a, error = (a - (sum - part)) + (b - part);
	*first = step->model->request.single ? (float)sum : sum;
	*second = error + (sum - *first) + low;
}

static void set_coefficient(const struct coefficient *c, double *first, double *second)
{
	*first = c->value;
	*second = c->low;
}

/* What a load or an input adds may be the same in every step, and the rounding of its sum with the others then too, in
 * one direction: half of the bits go to the second word, so that the sum is exact where it is not much larger. */
static void set_acting(const struct step *step, double *first, double *second)
{
	const int kept = step->model->request.single ? 12 : 26;
	int exponent;
	(void)frexp(*first, &exponent);
	double value = *first, top = ldexp(rint(ldexp(value, kept - exponent)), exponent - kept);
	*first = top;
	*second += value - top;
}

void growth_of_loads(const struct step *step, mpq_srcptr d, double *Phi, double *low)
{
	const struct layout *layout = &step->layout;
	const struct linear *system = &step->branch->system;
	for (int l = 0; l < system->loads; l++) {
		const struct load *load = &system->load[l];
		int n = load->columns, at = layout->load[l];
		for (int i = 0; i < n * n && at >= 0; i++) {
			struct response *response = response_of_load_state(load, i / n, i % n, d);
			const struct coefficient c = response_value(response, d, low, step->model->request.at.step,
								    column_text(load, i / n));
			const int cell = (at + i / n) * layout->size + at + i % n;
			Phi[cell] = c.value;
			if (low)
				low[cell] = c.low;
		}
	}
}

static void fill_gain_of_loads(const struct step *step, mpq_srcptr d, double *first, double *second)
{
	const struct layout *layout = &step->layout;
	growth_of_loads(step, d, first, second);
	for (int k = layout->first_load; k < layout->first_load + layout->loads; k++) {
		int cell = k * layout->size + k;
		set_words(step, first[cell], -1, second[cell], first + cell, second + cell);
	}
}

static void fill_gain_of_inputs(const struct step *step, mpq_srcptr d, double *first, double *second)
{
	const struct layout *layout = &step->layout;
	for (int i = 0; i < step->branch->system.inputs; i++) {
		int at = layout->input[i] * layout->size + layout->input[i] + 1;
		if (!step->branch->system.input[i].hold)
			continue;
		first[at] = round_rational(d);
		second[at] = rounding_rest(d);
	}
}

/* u, and of a ramp u' */
static void fill_gain_by_inputs(const struct step *step, const struct table *table, int row, double *first,
				double *second)
{
	const struct layout *layout = &step->layout;
	for (int i = 0; i < step->branch->system.inputs; i++) {
		const struct coefficient *held = &table->phi_weight[0][row * table->force_columns];
		const struct coefficient *ramp = &table->phi_weight[1][row * table->force_columns];
		int cell = row * layout->size + layout->input[i], ramps = step->branch->system.input[i].hold > 0;
		set_coefficient(&held[2 * i], first + cell, second + cell);
		if (ramps)
			set_words(step, ramp[2 * i].value, held[2 * i + 1].value,
				  ramp[2 * i].low + held[2 * i + 1].low, first + cell + 1, second + cell + 1);
		for (int k = cell; k <= cell + ramps; k++)
			set_acting(step, first + k, second + k);
	}
}

static void fill_gain_of_states(const struct step *step, const struct table *table, double *first, double *second)
{
	const struct layout *layout = &step->layout;
	const struct linear *system = &step->branch->system;
	for (int i = 0; i < table->states; i++) {
		int row = i * layout->size;
		for (int j = 0; j < table->states; j++)
			set_coefficient(&table->increment[i * table->states + j], first + row + j, second + row + j);
		for (int l = 0, column = 0; l < system->loads; column += system->load[l++].columns)
			for (int k = 0; k < system->load[l].columns && layout->load[l] >= 0; k++) {
				int cell = row + layout->load[l] + k;
				set_coefficient(&table->load[i * table->columns + column + k], first + cell,
						second + cell);
				set_acting(step, first + cell, second + cell);
			}
		fill_gain_by_inputs(step, table, i, first, second);
	}
}

double *gain_of(const struct step *step, const struct table *table, int halvings)
{
	size_t cells = (size_t)step->layout.size * (size_t)step->layout.size;
	if (!step->is.two_words)
		return NULL;
	double *first = ARRAY(double, 2 * cells), *second = first + cells;
	RATIONAL d = ZERO;
	mpq_div_2exp(d, step->model->h, (mp_bitcnt_t)halvings);
	fill_gain_of_states(step, table, first, second);
	fill_gain_of_loads(step, d, first, second);
	fill_gain_of_inputs(step, d, first, second);
	return first;
}
