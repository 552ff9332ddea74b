/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The order of a series whose steps are as long as the tolerance lets them be, where none was asked for. That of the
 * tolerance is best for what is cheap. A series of order P takes a number of multiplications that grows with P^2, for
 * a step that grows with tolerance^(1/(P-1)), its last but one term being at the tolerance; and where it is long it has
 * more instructions than a processor keeps decoded. Then a lower order is cheaper: by a third where the equations have
 * seven products, for the same error. A loop over the order has more instructions and takes less time, the same within
 * a tenth at all orders about that of the tolerance (a chain of five links at 1e-9, gcc -O2 on x86-64: 1.8
 * times the instructions of straight code, 0.7 of its time): there that of the tolerance stays. */
#include "model/checks.h"
#include "step/cost.h"
#include "expansion.h"

#include <math.h>

enum { SHORT = 1000, AROUND = 100 };    /* multiplications: up to where each costs the same; what else a step costs */

/* Of a unit of time, but for a factor that all orders have; `multiplications`: those of the series */
static double cost_of_order(struct step *step, int order, int *multiplications)
{
	struct program counted = *step->program;
	step->taylor.expansion = expansion_of(step, order);
	count_expansion(step, &counted);
	double count = counted.multiplications, beyond = count > SHORT ? 0.8 * (count - SHORT) : 0;
	*multiplications = counted.multiplications;
	return (AROUND + count + beyond) * pow(mpq_get_d(step->model->truncation.tolerance), -1.0 / (order - 1));
}

/* As many digits as it must give, and some */
static int least_order(const struct truncation *truncation)
{
	int least = (int)ceil(-log10(mpq_get_d(truncation->tolerance))) + 2;
	return least < LEAST_ORDER ? LEAST_ORDER : least;
}

int economical_order(struct step *step)
{
	const struct truncation *truncation = &step->model->truncation;
	int best = truncation->order, least = least_order(truncation), multiplications;
	if (step->model->request.again.order)
		return step->model->request.again.order;
	if (!truncation->adaptive || truncation->stages || loses_order(step->model))
		return best;
	double lowest = 0.95 * cost_of_order(step, best, &multiplications);
	if (multiplications <= SHORT || step->taylor.expansion->lines)
		return best;
	for (int order = best - 1; order >= least; order--) {
		double cost = cost_of_order(step, order, &multiplications);
		if (cost < lowest) {
			lowest = cost;
			best = order;
		}
	}
	return best;
}

int order_of_step(const struct step *step)
{
	return step->taylor.expansion && !step->collocation ? step->taylor.expansion->order
							    : order_of_scheme(step->model);
}
