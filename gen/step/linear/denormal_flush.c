/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Numbers below the range of full precision take many times as long as others, and tell nothing: factors that are so
 * small leave the step, and what has decayed that far comes to rest. */
#include "forms.h"
#include "images.h"

#include <float.h>
#include <math.h>

/* ---- factors ---- */

/* A factor of fewer bits, beside one of its row that is larger by more than what is rounded: it would count only for
 * a state as much larger than that one's. */
static bool is_lost(double factor, double largest, bool single)
{
	const double least = single ? FLT_MIN : DBL_MIN, beside = single ? 0x1p-50 : 0x1p-100;
	return factor != 0 && fabs(factor) < least && fabs(factor) < beside * largest;
}

/* They stay in the table: what is read there is Phi. */
static void leave_out(struct coefficient *factor, int n, bool single)
{
	for (int i = 0; i < n && factor; i++) {
		double largest = 0;
		for (int j = 0; j < n; j++)
			largest = fmax(largest, fabs(factor[i * n + j].value));
		for (int j = 0; j < n; j++)
			if (is_lost(factor[i * n + j].value, largest, single))
				factor[i * n + j].zero = true;
	}
}

void leave_out_lost(struct step *step)
{
	struct table *table = step->branch->full;
	if (step->model->params.tuning)
		return;
	leave_out(table->Phi, table->states, step->model->request.single);
	leave_out(table->increment, table->states, step->model->request.single);
}

/* ---- states ---- */

/* Is the real part of every pole negative? */
static bool decays(const struct linear *block)
{
	enum { BITS = 128 };
	INTEGER content = INTEGER_ZERO;
	struct spectrum *spectrum =
		spectrum_of(poly_primitive(*resolvent_determinant(resolvent_of(block)), content));
	bool negative = spectrum->zero == 0 && spectrum_refine(spectrum, BITS);
	for (int f = 0; f < spectrum->factors && negative; f++)
		for (int i = 0; i < spectrum->poles[f]; i++)
			negative = negative && mpfi_is_strictly_neg(spectrum->pole[f][i].at.re);
	return negative;
}

/* Modes are apart whatever their blocks. */
static void part_modes(const struct modal *modal, int *part)
{
	for (int i = 0; i < modal->states; i++)
		part[i] = i < modal->pairs ? i : i - modal->pairs;
}

/* Boards step small models, and their arithmetic takes no longer for such numbers: the step of a small model stays as
 * short as it is, and its run looks. */
void plan_rest(struct step *step)
{
	const struct linear *system = &step->branch->system;
	struct block *block;
	if (step->model->params.tuning || system->heldK || step->forced || step->carried.count ||
	    step->form == FORM_KICK_DRIFT_KICK)
		return;
	const int blocks = blocks_of(system, &block);
	struct denormal_flush *flush = NEW(struct denormal_flush);
	bool any = false, all = true;
	flush->part = ARRAY(int, system->states);
	flush->parts = blocks;
	flush->in_step = system->states > LIMIT_UNROLLED_STATES;
	for (int b = 0; b < blocks; b++) {
		const bool free = !any_load_acts(&block[b].system) && decays(&block[b].system);
		any = any || free;
		all = all && free;
		for (int i = 0; i < block[b].system.states; i++)
			flush->part[block[b].state[i]] = free ? b : -1;
	}
	if (step->modal && all) {
		part_modes(step->modal, flush->part);
		flush->parts = step->modal->pairs + step->modal->reals;
	}
	step->linear.flush = any && (all || !step->modal) ? flush : NULL;
}
