/* SPDX-License-Identifier: MIT-0 */
/* retune.h: coefficients of a linear step from other params: NAME_retune, NAME_use, and NAME_at.  Independent block by
 * independent block of the model, each as large as it is, in groups of one shape whose factors an instance has in one
 * table.  Included by the model's file, which defines before it
 *
 *     PL(name), PL_TYPE          the model's prefix before a name; its type, with member coeffs
 *     PL_SINGLE                  1: in float
 *     PL_STATES, PL_PARAMS, PL_SEGMENTS   sizes; segments of time of the loads
 *     PL_WRAPPED                 1: PL(retune) is the model's own, and calls PL(retune_all)
 *     PL_ANY_STEP                1: params touch every block, so that any h will do
 *     PL_DIRECT                  1: a step has factors of e^{A h}, 0: of e^{A h} - I
 *     PL_SAMPLES                 most derivatives of an input that goes from sample to sample; 0: none does
 *     PL_WHOLE, PL_LISTED        1: some group has a block, whose factors are a table; some has several, by lists
 *     PL_KEEPS                   1: a block that reads the spec's params alone keeps its factors
 *     PL_ROWS, PL(others)        rows of outputs that params change, then of frequencies in column 0; by PL_FORMULAS of
 *     PL_OPERATIONS              so many operations
 *     PL_SOLVED                  1: these are those of the only block, too
 *     PL_OUT, PL_OUT_COLUMNS     outputs that params change; columns of the rows
 *     PL_PHASES, PL_RATES, PL_ENVELOPES           of loads; 1: some have frequencies that params change
 *     PL_PEAKS                   outputs that are peaks, of peaks.h
 *     PL_WORK, PL_PASS_WORK, PL_SIZE            numbers of two words that a retune works in, a state between; of x
 *     PL_BLOCKS                  for the state at any time; 0: it is not asked for
 *     PL_JUMPS                   1: PL(jump), by that; PL(pass_steps)(s, n) moves the rest of it n steps on
 *
 *     PL(nominal), PL(until)     the spec's coefficients; time to a change of the loads
 *     PL(retune_groups)(c, params, h, made, work)   each group by PL(retune_group), if there is one
 *     PL(block)[PL_BLOCKS], PL(vector_now)(s, u, x)    x of the whole now
 *     PL(rate_entry)[PL_PHASES]  entries for the frequencies, -1: no param changes it; PL(decays)[PL_ENVELOPES]
 *     PL(phase_rate), PL(envelope_rate)  of loads */
#include "numbers.h"

#if PL_WHOLE || PL_LISTED || PL_BLOCKS > 0

/* ---- a block ---- */

static inline int PL(block_size)(const pl_block *b)
{
	return b->states + b->loads + b->inputs;
}

/* A of x' = A x in a segment of time; made: by its formulas */
static int PL(slopes)(const pl_block *b, const real *params, const pl_two *made, int segment, pl_two *A)
{
	return pl_entries_in(&b->entries, &b->formulas, params, made, b->states, b->loads, PL_SEGMENTS, segment, A);
}

#endif

#if PL_WHOLE || PL_LISTED

#if PL_SAMPLES > 0
static int PL(ramp_cancels)(const pl_group *g, const pl_block *b, const pl_two *D, real h)
{
	int i;
	for (i = 0; i < g->samples; i++) {
		const unsigned short *const sample = g->sample + 2 * i;
		if (sample[1] == 1 && pl_ramp_cancels(PL(block_size)(b), b->states, D, sample[0], h)) {
			return 1;
		}
	}
	return 0;
}
#endif

/* D <- e^{A h} - I, its rows of states, in each segment of time: once more, in two words, where a ramp's value before
 * the step would else be lost */
static int PL(increments)(const pl_group *g, const pl_block *b, const real *params, const pl_two *made, real h,
						  pl_two *D, pl_two *A)
{
	const int size = PL(block_size)(b);
	pl_two *const further = A + size * size;
	int segment, status = 0;

	for (segment = 0; segment < b->segments && status == 0; segment++) {
		pl_two *const to = D + segment * b->states * size;
		status = PL(slopes)(b, params, made, segment, A);
		if (status == 0) {
			status = pl_increment(size, b->states, A, h, 1, to, further);
		}
#if PL_SAMPLES > 0
		if (status == 0 && PL(ramp_cancels)(g, b, to, h)) {
			status = pl_increment(size, b->states, A, h, 2, to, further);
		}
#endif
	}
	(void)g;
	return status;
}

/* ---- a step ---- */

#if PL_SAMPLES > 1
/* In the place of an input's derivatives, what they make of its samples: sample_weight[k] has the parts of h^m times
 * derivative m in sample k.  They are summed in pairs. */
static void PL(to_samples)(pl_two *d, int derivatives, const real *sample_weight, real h)
{
	real term[PL_SAMPLES + 1];
	int k, m, apart, terms;
	for (k = 0; k <= derivatives; k++) {
		real power = 1;
		for (m = terms = 0; m <= derivatives; m++) {
			if (sample_weight[k * (derivatives + 1) + m] != 0) {
				term[terms++] = sample_weight[k * (derivatives + 1) + m] * d[m].hi / power;
			}
			power *= h;
		}
		for (apart = 1; apart < terms; apart *= 2) {
			for (m = 0; m + apart < terms; m += 2 * apart) {
				term[m] += term[m + apart];
			}
		}
		d[k].lo = term[0];
	}
	for (k = 0; k <= derivatives; k++) {
		d[k].hi = d[k].lo;
	}
}
#endif

#if PL_SAMPLES > 0 || PL_DIRECT
/* Row i of e^{A h} - I, over what a step reads */
static void PL(finish_row)(const pl_group *g, pl_two *d, int i, real h)
{
#if PL_SAMPLES > 1
	const real *sample_weight = g->sample_weight;
#endif
#if PL_SAMPLES > 0
	int k;
#endif
#if PL_DIRECT
	d[i].hi = (1 + d[i].hi) + d[i].lo;
#endif
#if PL_SAMPLES > 0
	for (k = 0; k < g->samples; k++) {
		pl_two *const at = d + g->sample[2 * k];
#if PL_SAMPLES > 1
		const int derivatives = g->sample[2 * k + 1];
		if (derivatives > 1) {
			PL(to_samples)(at, derivatives, sample_weight, h);
			sample_weight += (derivatives + 1) * (derivatives + 1);
			continue;
		}
#endif
		at[0].hi = pl_ramp_before(at[0], at[1], h);
		at[1].hi /= h;
	}
#endif
	(void)g;
	(void)i;
	(void)h;
}
#endif

#if PL_WHOLE
/* All factors of one block.  What of them loads have in each segment of time stands in its place, or apart. */
static void PL(take_whole)(const pl_group *g, const pl_two *D, real *to, real *apart)
{
	const pl_block *const b = g->block;
	const int size = PL(block_size)(b), all = apart != NULL ? 0 : b->segments * b->loads;
	int i, j;
	for (i = 0; i < b->states; i++) {
		const pl_two *const d = D + i * size;
		real *const row = to + i * g->down, *const acting = row + b->states * g->across;
		for (j = 0; j < b->states; j++) {
			row[j * g->across] = d[j].hi;
		}
		for (j = 0; j < b->segments * b->loads; j++) {
			const int segment = j / b->loads, k = j % b->loads;
			const real factor = d[segment * b->states * size + b->states + k].hi;
			if (apart != NULL) {
				apart[(segment * g->changing + k) * g->across + i] = factor;
			} else {
				acting[j * g->across] = factor;
			}
		}
		for (j = 0; j < b->inputs; j++) {
			acting[(all + j) * g->across] = d[b->states + b->loads + j].hi;
		}
	}
}
#endif

#if PL_LISTED
/* Of one of several blocks the factors in a list of rows and columns */
static void PL(take_listed)(const pl_group *g, int size, const pl_two *D, int count, const unsigned char *entry,
							real *to)
{
	int i;
	for (i = 0; i < count; i++) {
		to[i * g->blocks] = D[entry[2 * i] * size + entry[2 * i + 1]].hi;
	}
}
#endif

static void PL(take)(const pl_group *g, int k, const pl_two *D, real *to, real *apart)
{
#if PL_LISTED
	const pl_block *const b = g->block + k;
	const int size = PL(block_size)(b);
	int segment;
#if PL_WHOLE
	if (g->across != 0) {
		PL(take_whole)(g, D, to, apart);
		return;
	}
#endif
	PL(take_listed)(g, size, D, g->entries, g->entry, to + k);
	for (segment = 0; segment < b->segments && g->changing > 0; segment++) {
		PL(take_listed)(g, size, D + segment * b->states * size, g->changing, g->load,
						apart + segment * g->changing * g->blocks + k);
	}
#else
	(void)k;
	PL(take_whole)(g, D, to, apart);
#endif
}

#if PL_KEEPS
static int PL(keeps)(unsigned reads, const real *params, real h)
{
	int i;
	if (h != PL(nominal).h) {
		return 0;
	}
	for (i = 0; i < PL_PARAMS; i++) {
		if ((reads >> i & 1u) != 0 && params[i] != PL(nominal).params[i]) {
			return 0;
		}
	}
	return 1;
}
#endif

/* made: by the formulas of the only block; else NULL */
static int PL(retune_group)(const pl_group *g, const real *params, real h, const pl_two *made, real *to, real *apart,
							pl_two *work)
{
	int k, status = 0;
	for (k = 0; k < g->blocks && status == 0; k++) {
		const pl_block *const b = g->block + k;
		pl_two *const further = work + b->segments * b->states * PL(block_size)(b);
#if PL_SOLVED
		status = PL(increments)(g, b, params, made, h, work, further);
#else
#if PL_KEEPS
		if (PL(keeps)(g->reads[k], params, h)) {
			continue;
		}
#endif
		status = pl_formulas_at(&b->formulas, params, further);
		if (status == 0) {
			status = PL(increments)(g, b, params, further, h, work, further + b->formulas.operations);
		}
#endif
		if (status == 0) {
#if PL_SAMPLES > 0 || PL_DIRECT
			int i;
			for (i = 0; i < b->states; i++) {
				PL(finish_row)(g, work + i * PL(block_size)(b), i, h);
			}
#endif
			PL(take)(g, k, work, to, apart);
		}
	}
	(void)made;
	return status;
}

static int PL(retune_groups)(PL(coeffs) *c, const real *params, real h, const pl_two *made, pl_two *work);

#endif

/* ---- beside it: outputs, loads, peaks ---- */

#if PL_RATES
static int PL(rates_are_wrong)(const pl_two *value)
{
	int i, wrong = 0;
	for (i = 0; i < PL_PHASES; i++) {
		wrong |= PL(rate_entry)[i] >= 0 && value[PL(rate_entry)[i]].hi < 0;
	}
	return wrong;
}
#endif

#if PL_PHASES > 0 && (PL_RATES || PL_ANY_STEP)
static void PL(retune_phases)(PL(coeffs) *c, const pl_two *value, real h)
{
	int i;
	for (i = 0; i < PL_PHASES; i++) {
#if PL_RATES
		const pl_rate *const rate = &c->phase_rate[i];
		if (PL(rate_entry)[i] >= 0) {
			c->phase_rate[i] = pl_rate_of(value[PL(rate_entry)[i]]);
		} else {
			c->phase_rate[i] = PL(nominal).phase_rate[i];
		}
		const int tuned = PL(rate_entry)[i] >= 0;
#else
		const pl_rate *const rate = &PL(phase_rate)[i];
		const int tuned = 0;
#endif
		/* the spec's step is no number of the type, and what was made of it is more exact than by h */
		c->phase_step[i] = tuned || h != PL(nominal).h ? pl_phase_at(rate, h) : PL(nominal).phase_step[i];
	}
	(void)value;
}
#endif

static void PL(retune_others)(PL(coeffs) *c, const pl_two *value, const pl_two *made, real h, pl_two *work)
{
#if PL_OUT > 0 || (PL_ANY_STEP && PL_ENVELOPES > 0)
	int i;
#endif
#if PL_OUT > 0
	for (i = 0; i < PL_OUT * PL_OUT_COLUMNS; i++) {
		const int row = i / PL_OUT_COLUMNS, column = i % PL_OUT_COLUMNS;
		c->out[row][column] = value[i].hi;
	}
#endif
#if PL_PHASES > 0 && (PL_RATES || PL_ANY_STEP)
	PL(retune_phases)(c, value, h);
#endif
#if PL_ANY_STEP && PL_ENVELOPES > 0
	for (i = 0; i < PL_ENVELOPES; i++) {
		c->envelope_step[i] = h != PL(nominal).h ? pl_envelope_at(&PL(envelope_rate)[i], PL(decays)[i], h)
											 : PL(nominal).envelope_step[i];
	}
#endif
#if PL_PEAKS > 0
	(void)PL(slopes)(PL(block), c->params, made, 0, work);
	PL(retune_peaks)(c, work, h);
#endif
	(void)c;
	(void)value;
	(void)made;
	(void)h;
	(void)work;
}

/* ---- all ---- */

#if PL_WRAPPED
static int PL(retune_all)(PL(coeffs) *c, const real params[PL_PARAMS], real h)
#else
int PL(retune)(PL(coeffs) *c, const real params[PL_PARAMS], real h)
#endif
{
#if PL_SOLVED
	PL(coeffs) *const to = c; /* which nothing fills before all is known to be finite */
#else
	PL(coeffs) fresh = PL(nominal), *const to = &fresh;
#endif
#if PL_ROWS > 0
	pl_two value[PL_ROWS * PL_OUT_COLUMNS];
#else
	const pl_two *const value = NULL;
#endif
#if PL_OPERATIONS > 0
	pl_two made[PL_OPERATIONS];
#else
	pl_two *const made = NULL;
#endif
	pl_two work[PL_WORK];
	int i, status = 0;
	if (PL_ANY_STEP ? !(h > 0) : h != PL(nominal).h) {
		return PL_NO_STEP;
	}
	status = pl_formulas_at(&PL_FORMULAS, params, made);
#if PL_ROWS > 0
	if (status == 0) {
		status = pl_entries_at(&PL(others), &PL_FORMULAS, params, made, value);
	}
#endif
#if PL_RATES
	if (status == 0 && PL(rates_are_wrong)(value)) {
		status = PL_NO_RATE;
	}
#endif
#if PL_WHOLE || PL_LISTED
	if (status == 0) {
		status = PL(retune_groups)(to, params, h, made, work);
	}
#endif
	if (status != 0) {
		return status;
	}
	for (i = 0; i < PL_PARAMS; i++) {
		to->params[i] = params[i];
	}
#if PL_ANY_STEP
#if PL_SEGMENTS > 1
	to->h_low = h != PL(nominal).h ? 0 : PL(nominal).h_low;
#endif
	to->h = h;
#endif
	PL(retune_others)(to, value, made, h, work);
#if !PL_SOLVED
	*c = fresh;
#endif
	return 0;
}

void PL(use)(PL_TYPE *s, const PL(coeffs) *c)
{
	if (c->h != s->coeffs.h) {
		s->t0 = PL(time)(s);
		s->k = 0;
	}
	s->coeffs = *c;
}

/* ---- any time ---- */

#if PL_BLOCKS > 0
/* x <- e^{A tau} x, its first `rows`; not numbers where that is not finite */
static void PL(advance)(const PL_TYPE *s, const pl_block *b, const pl_two *made, int segment, int rows, real tau,
						real *x, pl_two *A)
{
	const int size = PL(block_size)(b);
	pl_two *const D = A + size * size, *const further = D + size * size;
	int i, j, found;
	found = PL(slopes)(b, s->coeffs.params, made, segment, A) == 0 &&
			pl_increment(size, rows, A, tau, 1, D, further) == 0;
	for (i = 0; i < rows; i++) {
		real more = 0;
		for (j = 0; j < size && found; j++) {
			more += D[i * size + j].hi * x[j];
		}
		further[i].hi = found ? more : more / more;
	}
	for (i = 0; i < rows; i++) {
		x[i] += further[i].hi;
	}
}

/* One block; where the loads change on the way, all of its x, since more follows */
static void PL(pass_block)(const PL_TYPE *s, const pl_block *b, real tau, real *x, pl_two *work)
{
	pl_two *const further = work + b->formulas.operations;
	real done = 0;
	int segment = 0, rows = b->states;
	(void)pl_formulas_at(&b->formulas, s->coeffs.params, work);
#if PL_SEGMENTS > 1
	rows = PL(block_size)(b);
	for (segment = s->segment; segment < PL_SEGMENTS - 1 && PL(until)(s, segment) < tau; segment++) {
		const real ahead = PL(until)(s, segment);
		if (ahead > done) {
			PL(advance)(s, b, work, segment, rows, ahead - done, x, further);
			done = ahead;
		}
	}
#endif
	PL(advance)(s, b, work, segment, rows, tau - done, x, further);
}

/* The state tau after now */
static void PL(pass)(const PL_TYPE *s, const real u[], real tau, real y[PL_STATES])
{
	pl_two work[PL_PASS_WORK];
	real x[PL_SIZE];
	int i;
#if PL_SOLVED
	PL(vector_now)(s, u, x);
	PL(pass_block)(s, PL(block), tau, x, work);
	for (i = 0; i < PL_STATES; i++) {
		y[i] = x[i];
	}
#else
	real part[PL_SIZE];
	int k;
	PL(vector_now)(s, u, x);
	for (k = 0; k < PL_BLOCKS; k++) {
		const pl_block *const b = PL(block) + k;
		for (i = 0; i < PL(block_size)(b); i++) {
			part[i] = x[b->place[i]];
		}
		PL(pass_block)(s, b, tau, part, work);
		for (i = 0; i < b->states; i++) {
			y[b->place[i]] = part[i];
		}
	}
#endif
}

#if PL_JUMPS
static void PL(pass_steps)(PL_TYPE *s, uint64_t n);
#if PL_SEGMENTS > 1
static inline void PL(pass_segments)(PL_TYPE *s);
#endif

/* n steps at once: by e^{A n h} of the instance's own params */
void PL(jump)(PL_TYPE *s, uint64_t n)
{
	real y[PL_STATES];
	int i;
	PL(pass)(s, NULL, (real)n * s->coeffs.h, y);
	for (i = 0; i < PL_STATES && n > 0u; i++) {
		s->y[i] = y[i];
	}
	PL(pass_steps)(s, n);
#if PL_SEGMENTS > 1
	PL(pass_segments)(s);
#endif
}
#endif
#endif
#include "undef.h"
