/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Numbers below the range of full precision take many times as long as others, and tell nothing: factors that are so
 * small leave the step, and states that have decayed that far become 0 (runtime/flush.h). */
#include "forms.h"
#include "inner.h"
#include "model/regions/regions.h"

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
static bool decays(const struct resolvent *resolvent)
{
	enum { BITS = 128 };
	INTEGER content = INTEGER_ZERO;
	struct spectrum *spectrum =
		spectrum_of(poly_primitive(*resolvent_determinant(resolvent), content));
	bool negative = spectrum->zero == 0 && spectrum_refine(spectrum, BITS);
	for (int f = 0; f < spectrum->factors && negative; f++)
		for (int i = 0; i < spectrum->poles[f]; i++)
			negative = negative && mpfi_is_strictly_neg(spectrum->pole[f][i].at.re);
	return negative;
}

/* A piecewise-linear model decays where it does in each of its regions, and nothing gives or takes speed. */
static bool decays_in_all(const struct switching *s)
{
	enum { MOST_SYSTEMS = 16 };
	bool all = !s->cached && s->systems <= MOST_SYSTEMS && s->frictions + s->impacts == 0;
	for (int k = 0; k < s->systems && all; k++)
		all = decays(resolvent_of(&s->system[k]));
	return all;
}

/* The states of one part, and the next number */
static void flush_part(struct denormal_flush *flush, const struct block *block)
{
	for (int i = 0; i < block->system.states; i++)
		flush->part[block->state[i]] = flush->parts;
	flush->parts++;
}

/* Modes are apart whatever their blocks. */
static void part_modes(struct denormal_flush *flush, const struct modal *modal)
{
	for (int i = 0; i < modal->states; i++)
		flush->part[i] = i < modal->pairs ? i : i - modal->pairs;
	flush->decaying = flush->decaying == flush->parts ? modal->pairs + modal->reals : 0;
	flush->parts = modal->pairs + modal->reals;
}

static void part_blocks(struct denormal_flush *flush, const struct branch *branch)
{
	struct block *block;
	const int blocks = blocks_of(&branch->system, &block);
	bool *decaying = ARRAY(bool, blocks);
	for (int b = 0; b < blocks; b++) {
		decaying[b] = decays(blocks > 1 ? resolvent_of(&block[b].system) : branch->resolvent);
		if (decaying[b])
			flush_part(flush, &block[b]);
	}
	flush->decaying = flush->parts;
	for (int b = 0; b < blocks; b++)
		if (!decaying[b])
			flush_part(flush, &block[b]);
}

/* In a small model a wave soon arrives everywhere, and its step stays as short as it can. */
void plan_flush(struct step *step)
{
	const struct switching *switching = step->model->switching;
	struct denormal_flush *flush = NEW(struct denormal_flush);
	flush->part = ARRAY(int, step->branch->system.states);
	if (step->is.flow == FLOW_LINEAR && !switching && !step->branch->system.heldK) {
		part_blocks(flush, step->branch);
	} else {
		flush->parts = 1;
		flush->decaying = switching && !switching->parts && decays_in_all(switching);
	}
	if (step->modal)
		part_modes(flush, step->modal);
	flush->beside = step->branch->system.states > LIMIT_UNROLLED_STATES;
	const bool flushes = step->is.flow == FLOW_LINEAR || step->is.flow == FLOW_RECIPE;
	step->linear.flush = flushes && (flush->beside || flush->decaying > 0) ? flush : NULL;
}
