/* SPDX-License-Identifier: MIT-0 */
/* many.h: of NAME_batch what is the same by lanes and each by itself, and NAME_many, by which programs step instances
 * of any model.  Included by batch.h and each.h, with
 *
 *     PL_DRIVES                      whether there is NAME_many
 *     PL_FACTORS                     above 0: member factors has so many numbers of an instance
 *     PL(batch_steps)(b, n, u, out, sum)     PL(batch) with sums as NAME_many has them, or NULL
 *     PL_NOW                         numbers of a step that PL(batch_share) writes
 *     PL(many_hold)(b, u)            PL_RAMPS: PL(hold) of all
 *     PL(many_use)(b, j, c, out)     what params decide of instance j, and then its outputs; 0, or why not */

void PL(batch_get)(const PL_INSTANCES *b, size_t j, real y[PL_STATES])
{
	PL_TYPE one;
	PL(batch_take)(b, j, &one);
	PL(get)(&one, y);
}

int PL(batch_status)(const PL_INSTANCES *b, size_t j)
{
	PL_TYPE one;
	PL(batch_take)(b, j, &one);
	return PL(status)(&one);
}

void PL(batch)(PL_INSTANCES *b, size_t n PL_TAKEN_ROWS, real *out)
{
	PL(batch_steps)(b, n PL_GIVEN, out, NULL);
}

#if PL_DRIVES
static void PL(many_init)(void *to, size_t count, real *y, real *factors, real *peak)
{
	PL_INSTANCES *const b = (PL_INSTANCES *)to;
	b->count = count;
	b->y = y;
#if PL_FACTORS > 0
	b->factors = factors;
#else
	(void)factors;
#endif
	b->peak = peak;
	PL(batch_init)(b);
}

static int PL(many_retune)(void *b, size_t j, const real *params, real *out)
{
	PL(coeffs) c = PL(nominal);
#if PL_TUNED
	const int status = PL(retune)(&c, params, c.h);
#else
	const int status = PL(retune)(&c, params, PL_H);
#endif
	return status == 0 ? PL(many_use)((PL_INSTANCES *)b, j, &c, out) : status;
}

static void PL(many_run)(void *b, size_t n, const real *u, real *out, real *sum)
{
	(void)u;
	PL(batch_steps)((PL_INSTANCES *)b, n PL_GIVEN, out, sum);
}

static int PL(many_status)(const void *b, size_t j)
{
	return PL(batch_status)((const PL_INSTANCES *)b, j);
}

static void PL(many_share)(void *b, size_t n, const real *u, real *now)
{
	(void)u;
	PL(batch_share)((PL_INSTANCES *)b, n PL_GIVEN, now);
}

const pl_many PL(many) = {
	sizeof(PL_INSTANCES), PL_ROWS,
#if PL_FACTORS > 0
	PL_FACTORS,
#else
	0,
#endif
	PL(many_init),
#if PL_RAMPS
	PL(many_hold),
#else
	NULL,
#endif
	PL(many_retune), PL(many_run), PL(many_status), PL_NOW, PL(many_share)
};
#endif
