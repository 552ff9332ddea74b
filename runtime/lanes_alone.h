/* SPDX-License-Identifier: MIT-0 */
/* lanes_alone.h: instances of a batch by themselves, to and from their numbers in the arrays.  Part of batch.h.  Of
 * models with events an instance has its states, the region, and the bytes of its contact and status; where a step may
 * have an event the lane is left as it was, and NAME_step takes it, from what all instances share before that step. */

PL_LANES_INLINE real PL(lane)(const pl_lanes *all, size_t l)
{
	real one;
	memcpy(&one, (const char *)all + l * sizeof one, sizeof one);
	return one;
}

PL_LANES_INLINE void PL(set_lane)(pl_lanes *all, size_t l, real one)
{
	memcpy((char *)all + l * sizeof one, &one, sizeof one);
}

/* The larger of each */
PL_LANES_INLINE void PL(lanes_widen)(pl_lanes *most, const pl_lanes *value, const int count)
{
	int i;
	PL_LANES_UNROLL
	for (i = 0; i < count; i++) {
		most[i] = pl_lanes_peak(most[i], value[i]);
	}
}

/* Outputs of the instances from j on */
PL_LANES_INLINE void PL(lanes_report)(const PL_INSTANCES *b, size_t j, const pl_lanes *value, real *out)
{
	size_t i;
	if (out && j < b->count) {
		PL_LANES_UNROLL
		for (i = 0; i < PL_OUTPUTS; i++) {
			pl_lanes_store(out + i * b->count + j, value[i], b->count - j);
		}
	}
}

#if PL_OVER > 0
/* What stands in an instance's rows, and in which: series_lanes.h */
static void PL(own_take)(const real *row, PL_TYPE *one)
{
	memcpy(one->y, row, sizeof one->y);
	memcpy(one->low, row + PL_STATES, sizeof one->low);
#if PL_OVER > 1
	one->served = (int)row[2 * PL_STATES];
	memcpy(one->next, row + 2 * PL_STATES + 1, sizeof one->next);
	memcpy(one->left, row + 3 * PL_STATES + 1, sizeof one->left);
	memcpy(one->series, row + 4 * PL_STATES + 1, sizeof one->series);
#endif
}

static void PL(own_give)(const PL_TYPE *one, real *row)
{
	memcpy(row, one->y, sizeof one->y);
	memcpy(row + PL_STATES, one->low, sizeof one->low);
#if PL_OVER > 1
	row[2 * PL_STATES] = (real)one->served;
	memcpy(row + 2 * PL_STATES + 1, one->next, sizeof one->next);
	memcpy(row + 3 * PL_STATES + 1, one->left, sizeof one->left);
	memcpy(row + 4 * PL_STATES + 1, one->series, sizeof one->series);
#endif
}

/* Behind these its status */
static void PL(marks_read)(const PL_INSTANCES *b, size_t j, PL_TYPE *one)
{
	memcpy(&one->status, &b->y[PL_STEPPED * b->count + j], sizeof one->status);
}

static void PL(marks_write)(PL_INSTANCES *b, size_t j, const PL_TYPE *one)
{
	memcpy(&b->y[PL_STEPPED * b->count + j], &one->status, sizeof one->status);
}

#elif PL_EVENTS
static void PL(own_take)(const real *row, PL_TYPE *one)
{
	memcpy(one->y, row, sizeof one->y);
}

static void PL(own_give)(const PL_TYPE *one, real *row)
{
	memcpy(row, one->y, sizeof one->y);
	row[PL_STATES] = (real)one->contact.region;
}

/* Of an instance the numbers in which its contact and status stand */
#define PL_CONTACT_ROWS ((sizeof(pl_contact) + sizeof(int) + sizeof(real) - 1) / sizeof(real))

static void PL(marks_read)(const PL_INSTANCES *b, size_t j, PL_TYPE *one)
{
	real row[PL_CONTACT_ROWS];
	size_t i;
	for (i = 0; i < PL_CONTACT_ROWS; i++) {
		row[i] = b->y[(PL_STEPPED + i) * b->count + j];
	}
	memcpy(&one->contact, row, sizeof one->contact);
	memcpy(&one->status, (const char *)row + sizeof one->contact, sizeof one->status);
}

static void PL(marks_write)(PL_INSTANCES *b, size_t j, const PL_TYPE *one)
{
	pl_contact contact = one->contact;
	real row[PL_CONTACT_ROWS] = {0};
	size_t i;
	contact.crossings = 0;
	memcpy(row, &contact, sizeof contact);
	memcpy((char *)row + sizeof contact, &one->status, sizeof one->status);
	for (i = 0; i < PL_CONTACT_ROWS; i++) {
		b->y[(PL_STEPPED + i) * b->count + j] = row[i];
	}
}

#endif

#if PL_FACTORS > 0
static void PL(batch_factors)(const PL_INSTANCES *b, size_t j, PL_TYPE *one)
{
	size_t i;
	for (i = 0; i < PL_FACTORS && b->factors; i++) {
		memcpy((char *)one + PL(factor_at)[i], &b->factors[i * b->count + j], sizeof(real));
	}
}
#endif

#if PL_EVENTS
/* What is of instance j alone, over what all share; row: what lanes have of it */
static void PL(own_read)(const PL_INSTANCES *b, size_t j, const real *row, PL_TYPE *one)
{
	PL(own_take)(row, one);
	PL(marks_read)(b, j, one);
#if PL_FACTORS > 0
	PL(batch_factors)(b, j, one);
#endif
}

static void PL(row_read)(const PL_INSTANCES *b, size_t j, real row[PL_STEPPED])
{
	size_t i;
	for (i = 0; i < PL_STEPPED; i++) {
		row[i] = b->y[i * b->count + j];
	}
}

void PL(batch_take)(const PL_INSTANCES *b, size_t j, PL_TYPE *s)
{
	real row[PL_STEPPED];
	PL(row_read)(b, j, row);
	*s = b->shared;
	PL(own_read)(b, j, row, s);
}

void PL(batch_give)(PL_INSTANCES *b, size_t j, const PL_TYPE *s)
{
	real row[PL_STEPPED];
	size_t i;
	PL(own_give)(s, row);
	for (i = 0; i < PL_STEPPED; i++) {
		b->y[i * b->count + j] = row[i];
	}
	PL(marks_write)(b, j, s);
}

#else
/* Its coefficients are those of all: nothing that is asked of it behind this reads them. */
static void PL(batch_take)(const PL_INSTANCES *b, size_t j, PL_TYPE *s)
{
	real row[PL_ROWS];
	size_t i;
	for (i = 0; i < PL_ROWS; i++) {
		row[i] = b->y[i * b->count + j];
	}
	*s = b->shared;
	memcpy(s, row, sizeof row);
}

static void PL(batch_give)(PL_INSTANCES *b, size_t j, const PL_TYPE *s)
{
	real row[PL_ROWS];
	size_t i;
	memcpy(row, s, sizeof row);
	for (i = 0; i < PL_ROWS; i++) {
		b->y[i * b->count + j] = row[i];
	}
}
#endif

/* As instance j; its peaks are what its outputs are now. */
static void PL(batch_begin)(PL_INSTANCES *b, size_t j, const PL_TYPE *s)
{
	PL_TYPE one = *s;
	real out[PL_OUTPUTS];
	size_t i;
	PL(batch_give)(b, j, s);
#if PL_FACTORS > 0
	PL(batch_factors)(b, j, &one);
#endif
	PL(out)(&one, out);
	for (i = 0; i < PL_OUTPUTS && b->peak; i++) {
		b->peak[i * b->count + j] = pl_magnitude(out[i]);
	}
}

#if PL_FACTORS > 0
static void PL(batch_keep)(PL_INSTANCES *b, size_t j, const PL_TYPE *s)
{
	size_t i;
	for (i = 0; i < PL_FACTORS && b->factors; i++) {
		memcpy(&b->factors[i * b->count + j], (const char *)s + PL(factor_at)[i], sizeof(real));
	}
}

int PL(batch_use)(PL_INSTANCES *b, size_t j, const PL(coeffs) *c)
{
	PL_TYPE one = b->shared;
#if PL_TUNED
	if (!(c->h == b->shared.coeffs.h)) {
		return PL_NO_STEP;
	}
#endif
	if (!b->factors) {
		return PL_NO_STEP;
	}
#if PL_EVENTS /* another region may have its state */
	PL(batch_take)(b, j, &one);
	PL(use)(&one, c);
	PL(batch_give)(b, j, &one);
#else
	one.coeffs = *c;
#endif
	PL(batch_keep)(b, j, &one);
	return 0;
}
#endif

void PL(batch_init)(PL_INSTANCES *b)
{
	size_t j;
	PL(init)(&b->shared);
	for (j = 0; j < b->count; j++) {
#if PL_FACTORS > 0
		PL(batch_keep)(b, j, &b->shared);
#endif
		PL(batch_begin)(b, j, &b->shared);
	}
}

void PL(batch_set)(PL_INSTANCES *b, size_t j, const real y[PL_STATES])
{
	PL_TYPE one = b->shared;
#if PL_FACTORS > 0
	PL(batch_factors)(b, j, &one);
#endif
	PL(set)(&one, PL(time)(&b->shared), y);
	PL(batch_begin)(b, j, &one);
}

#if PL_EVENTS
/* ---- steps by themselves ---- */

/* Instance j, lane l of y, after k steps of those ahead */
static void PL(lane_alone)(const PL_INSTANCES *b, size_t j, const PL(steps_ahead) *ahead, size_t k, const pl_lanes *y,
						   size_t l, PL_TYPE *one)
{
	real row[PL_STEPPED];
	int i;
	for (i = 0; i < PL_STEPPED; i++) {
		row[i] = PL(lane)(&y[i], l);
	}
	memcpy(one, ahead->head[k], sizeof ahead->head[k]);
	PL(own_read)(b, j, row, one);
}

/* Step k of the lanes from instance j on that `kept` has no bit of */
static void PL(step_alone)(PL_INSTANCES *b, size_t j, const PL(steps_ahead) *ahead, size_t k, pl_lanes *y,
						   unsigned kept)
{
	size_t l;
	int i;
	for (l = 0; l < PL_AT_ONCE && j + l < b->count; l++) {
#if PL_INPUTS > 0
		const real *const u = ahead->u + (k - 1) * PL_INPUTS;
#endif
		real row[PL_STEPPED];
		PL_TYPE one;
		if (kept >> l & 1) {
			continue;
		}
		PL(lane_alone)(b, j + l, ahead, k - 1, y, l, &one);
		PL(step)(&one PL_GIVEN);
		PL(own_give)(&one, row);
		for (i = 0; i < PL_STEPPED; i++) {
			PL(set_lane)(&y[i], l, row[i]);
		}
		PL(marks_write)(b, j + l, &one);
	}
}

/* A step: those in lanes that are sure to have no event, then the others.  Only for these lanes are in memory. */
PL_LANES_INLINE void PL(lanes_step_all)(PL_INSTANCES *b, size_t j, const PL(steps_ahead) *ahead, size_t k, pl_lanes *y,
										const pl_lanes *factor, int seen)
{
#if PL_OVER > 1
	const unsigned kept = pl_lanes_flags(PL(lanes_pass)(y, factor, ahead->now[k], seen || k == ahead->steps));
#else
	const unsigned kept = pl_lanes_flags(PL(lanes_step)(y, factor, ahead->now[k]));
	(void)seen;
#endif
	if (kept != ((unsigned)1 << (PL_AT_ONCE - 1)) * 2 - 1) {
		pl_lanes now[PL_STEPPED];
		memcpy(now, y, sizeof now);
		PL(step_alone)(b, j, ahead, k, now, kept);
		memcpy(y, now, sizeof now);
	}
}

#if PL_OUT_ALONE
/* Outputs after step k that no sum over lanes gives */
static void PL(out_alone)(const PL_INSTANCES *b, size_t j, const PL(steps_ahead) *ahead, size_t k, const pl_lanes *y,
						  pl_lanes *value)
{
	size_t l;
	int i;
	for (i = 0; i < PL_OUTPUTS; i++) {
		value[i] = pl_lanes_all(0);
	}
	for (l = 0; l < PL_AT_ONCE && j + l < b->count; l++) {
		real out[PL_OUTPUTS];
		PL_TYPE one;
		PL(lane_alone)(b, j + l, ahead, k, y, l, &one);
		PL(out)(&one, out);
		for (i = 0; i < PL_OUTPUTS; i++) {
			PL(set_lane)(&value[i], l, out[i]);
		}
	}
}
#endif

/* Each instance by itself over the steps ahead: with few lanes that takes less. */
static void PL(each_alone)(PL_INSTANCES *b, size_t j, const PL(steps_ahead) *ahead, real *out, real *sum)
{
	const real *u = ahead->u;
	real row[PL_STEPPED];
	PL_TYPE one;
	size_t k, i;
	PL(row_read)(b, j, row);
	memcpy(&one, ahead->head[0], sizeof ahead->head[0]);
	PL(own_read)(b, j, row, &one);
	for (k = 0; k < ahead->steps; k++) {
		PL(step)(&one PL_GIVEN);
		u += PL_INPUTS;
		if (out || sum || b->peak) {
			real now[PL_OUTPUTS];
			PL(out)(&one, now);
			for (i = 0; i < PL_OUTPUTS; i++) {
				if (out) {
					out[(k * PL_OUTPUTS + i) * b->count + j] = now[i];
				}
				if (b->peak) {
					b->peak[i * b->count + j] = pl_larger_size(b->peak[i * b->count + j], now[i]);
				}
				if (sum) {
					pl_sum_squares(sum + i * b->count + j, PL_OUTPUTS * b->count, now[i]);
				}
			}
		}
	}
	(void)u;
	PL(batch_give)(b, j, &one);
}

static size_t PL(all_alone)(PL_INSTANCES *b, const PL(steps_ahead) *ahead, real *out, real *sum)
{
	size_t j = 0;
	for (; PL_AT_ONCE < PL_LANES_PAY && j < b->count; j++) {
		PL(each_alone)(b, j, ahead, out, sum);
	}
	return j;
}
#endif

#if PL_PEAKS > 0
/* ---- peaks in a step ---- */

/* Instance j by itself, from states x on: larger values inside the step that ends at outputs `end` */
static void PL(look_alone)(const PL_INSTANCES *b, size_t j, real *x, const real *acting, const real *end, real *peak)
{
	int i;
#if PL_FACTORS > 0
	PL_TYPE one = b->shared;
	const PL_TYPE *const s = &one;
	PL(batch_factors)(b, j, &one);
#else
	const PL_TYPE *const s = &b->shared;
	(void)j;
#endif
#if PL_MOMENTA
	PL(velocities)(x);
#endif
	for (i = PL_STATES; i < PL_SIZE; i++) {
		x[i] = acting[i - PL_STATES];
	}
	PL(look)(s, x, end, peak);
}

/* Where a lane may have passed a peak, each is looked at by itself. */
static void PL(lanes_look)(const PL_INSTANCES *b, size_t j, const pl_lanes *start, const real *acting,
						   const pl_lanes *most, const pl_lanes *value, pl_lanes *peak)
{
	size_t l;
	int i, p;
	for (l = 0; l < PL_AT_ONCE && j + l < b->count; l++) {
		real x[PL_SIZE], end[PL_OUTPUTS], largest[PL_PEAKS];
		int any = 0;
		for (p = 0; p < PL_PEAKS; p++) {
			largest[p] = PL(lane)(&peak[PL(peak_output)[p]], l);
			any |= !(PL(lane)(&most[p], l) <= largest[p]);
		}
		if (!any) {
			continue;
		}
		for (i = 0; i < PL_STATES; i++) {
			x[i] = PL(lane)(&start[i], l);
		}
		for (i = 0; i < PL_OUTPUTS; i++) {
			end[i] = PL(lane)(&value[i], l);
		}
		PL(look_alone)(b, j + l, x, acting, end, largest);
		for (p = 0; p < PL_PEAKS; p++) {
			memcpy((char *)&peak[PL(peak_output)[p]] + l * sizeof(real), &largest[p], sizeof(real));
		}
	}
}
#endif

/* ---- for kernels: what instances share ---- */

/* What instances share before a step, for work items that take whole ones */
static void PL(share_head)(const PL_TYPE *s, real *now)
{
#if PL_SHARES > 1
	memcpy(now, s, PL_HEAD);
#else
	PL(share_out)(s, now);
#endif
}

void PL(batch_share)(PL_INSTANCES *b, size_t n PL_TAKEN_ROWS, real *now)
{
	size_t k;
#if PL_SHARES > 1
	real unread[PL_HAS(PL_SHARED)];
#endif
	PL(share_head)(&b->shared, now);
	for (k = 0; k < n; k++) {
		now += PL_NOW;
#if PL_SHARES > 1
#if PL_INPUTS > 0
		memcpy(now + (PL_NOW - PL_INPUTS), u, PL_INPUTS * sizeof *u);
#endif
		PL(share_step)(&b->shared, PL_THE_INPUTS, unread);
#else
		PL(share_step)(&b->shared, PL_THE_INPUTS, now);
#endif
		PL(share_head)(&b->shared, now);
#if PL_INPUTS > 0
		u += PL_INPUTS;
#endif
	}
}
