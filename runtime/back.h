/* SPDX-License-Identifier: MIT-0 */
/* back.h: NAME_back and NAME_gradient, a cost's derivatives by the state at the start, by the columns of derivatives
 * and by every sample of the inputs, from those by the outputs at the ends of steps: step by step backwards, so that
 * each is what the step computed forwards.  The state before a step is that of a snapshot, or steps from one.  Included
 * by derivatives.h, which has the macros, and of these
 *
 *     PL_BY_PHI                  1: PL(Phi) is the derivative of every step by the state, and PL(move_d) a step of
 *                                derivatives alone
 *     PL_BY_ROWS                 1: that of outputs is the same all along.  PL_DECLARED  0: outputs are the states
 *     PL_STRIDE                  1, or at least so many steps are taken backwards at once, from where PL_ENDED(s)
 *     PL(d_input)[]              of each column the input that it is along, or -1; where PL_SEEDED
 *
 * Where PL_BY_PHI is 0 the derivatives of a step by its state are taken as columns of PL(step_d), as many at a time as
 * there are.  A seed is as large as what the column has without it, so that their difference loses nothing. */

typedef struct PL(back_work) {
	PL_TYPE after, seeded;
	PL(d) alone, ds; /* of the step without seeds; with them */
	real J[PL_OUTPUTS][PL_DERIVATIVES], seed[PL_OUTPUTS][PL_DERIVATIVES], lam[PL_STATES];
#if PL_STRIDE > 1
	real worth[PL_DERIVATIVES], seeded_worth[PL_DERIVATIVES]; /* of the columns of alone, of ds */
#endif
#if PL_BY_ROWS
	real row[PL_OUTPUTS][PL_STATES];
#endif
#if PL_PEAKS > 0
	real peak[PL_PEAKS]; /* what peaks are worth, until the step in which each has risen to what it is */
#endif
} PL(back_work);

#if PL_DECLARED || !PL_BY_PHI
static real PL(d_size)(const real *value, int count, int apart)
{
	real most = 1;
	int i;
	for (i = 0; i < count; i++) {
		const real size = pl_magnitude(value[i * apart]);
		most = size > most ? size : most;
	}
	return most;
}

/* S: a seed for each state from `first` on, in a column of its own; scale: of each */
static void PL(seed)(PL(d) *ds, int first, const real *scale)
{
	int p;
	PL(set_d)(ds, NULL);
	for (p = 0; p < PL_DERIVATIVES && first + p < PL_STATES; p++) {
		ds->s[p][first + p] = scale[p];
	}
}
#endif

/* What ds has need not fulfil what the model's states do: it has no time, for beside.h. */
static void PL(as_seeds)(PL(d) *ds)
{
#if PL_BESIDE
	ds->time = (real)-0x1p120;
#endif
	(void)ds;
}

/* 0 of peaks, which follow no state */
static real PL(worth)(const real *w, int o)
{
	real worth = w[o];
#if PL_PEAKS > 0
	int p;
	for (p = 0; p < PL_PEAKS; p++) {
		worth = PL(peak_output)[p] == o ? 0 : worth;
	}
#endif
	return worth;
}

#if PL_DECLARED
/* What outputs have without a derivative of a state */
static void PL(outputs_alone)(PL(back_work) *b)
{
	b->ds = b->alone;
	PL(set_d)(&b->ds, NULL);
	PL(out_d)(&b->after, &b->ds, b->J);
}

/* row += w^T (derivative of outputs by the state), of output `only`, or of all */
static void PL(rows_back)(PL(back_work) *b, const real *w, int only, real row[PL_STATES])
{
	const int from = only < 0 ? 0 : only, to = only < 0 ? PL_OUTPUTS : only + 1;
	real scale[PL_DERIVATIVES];
	int first, i, p;
	for (p = 0; p < PL_DERIVATIVES; p++) {
		scale[p] = PL(d_size)(&b->J[0][p], PL_OUTPUTS, PL_DERIVATIVES);
	}
	for (first = 0; first < PL_STATES; first += PL_DERIVATIVES) {
		PL(seed)(&b->ds, first, scale);
		PL(out_d)(&b->after, &b->ds, b->seed);
		for (p = 0; p < PL_DERIVATIVES && first + p < PL_STATES; p++) {
			for (i = from; i < to; i++) {
				row[first + p] += (w ? PL(worth)(w, i) : 1) * ((b->seed[i][p] - b->J[i][p]) / scale[p]);
			}
		}
	}
}
#endif

/* lam += (derivative of outputs by the state)^T w */
static void PL(outputs_back)(PL(back_work) *b, const real *w, real lam[PL_STATES])
{
#if PL_BY_ROWS
	int i, j;
	for (i = 0; i < PL_OUTPUTS; i++) {
		for (j = 0; j < PL_STATES; j++) {
			lam[j] += w[i] * b->row[i][j];
		}
	}
#elif PL_DECLARED
	PL(rows_back)(b, w, -1, lam);
#else
	int i;
	for (i = 0; i < PL_STATES; i++) {
		lam[i] += w[i];
	}
	(void)b;
#endif
}

/* lam: by the state after the step, made that by the state before it */
static void PL(state_back)(const PL_TYPE *s, PL(back_work) *b PL_GIVES, real lam[PL_STATES])
{
	int i, j;
#if PL_BY_PHI
	(void)s;
#if PL_INPUTS > 0
	(void)u;
#endif
	for (j = 0; j < PL_STATES; j++) {
		b->lam[j] = 0;
	}
	for (i = 0; i < PL_STATES; i++) {
		for (j = 0; j < PL_STATES; j++) {
			b->lam[j] += PL(Phi)[i][j] * lam[i];
		}
	}
#else
	real scale[PL_DERIVATIVES];
	int first, p;
#if PL_SEEDED
	const real *const du = NULL;
#endif
	for (p = 0; p < PL_DERIVATIVES; p++) {
#if PL_SEEDED
		for (i = 0; i < PL_STATES && PL(d_input)[p] >= 0; i++) {
			b->alone.s[p][i] = 0;
		}
#if PL_PEAKS > 0
		for (i = 0; i < PL_PEAKS && PL(d_input)[p] >= 0; i++) {
			b->alone.peak[i][p] = 0;
		}
#endif
#endif
		scale[p] = PL(d_size)(b->alone.s[p], PL_STATES, 1);
	}
	b->ds = b->alone;
#if PL_SEEDED
	for (i = 0; i < PL_INPUTS; i++) {
		b->ds.du[i] = 0;
	}
#endif
	for (first = 0; first < PL_STATES; first += PL_DERIVATIVES) {
		b->seeded = *s;
		PL(seed)(&b->ds, first, scale);
		PL(as_seeds)(&b->ds);
		PL(step_d)(&b->seeded, &b->ds PL_TAKES PL_ALONG);
		for (p = 0; p < PL_DERIVATIVES && first + p < PL_STATES; p++) {
			j = first + p;
			b->lam[j] = 0;
			for (i = 0; i < PL_STATES; i++) {
				b->lam[j] += lam[i] * ((b->ds.s[p][i] - b->alone.s[p][i]) / scale[p]);
			}
#if PL_PEAKS > 0
			for (i = 0; i < PL_PEAKS; i++) {
				b->lam[j] += b->peak[i] * ((b->ds.peak[i][p] - b->alone.peak[i][p]) / scale[p]);
			}
#endif
		}
	}
#endif
	for (j = 0; j < PL_STATES; j++) {
		lam[j] = b->lam[j];
	}
}

static real PL(column_back)(const PL(back_work) *b, int p, const real *w, const real *lam)
{
	real sum = 0;
	int i;
	for (i = 0; i < PL_STATES; i++) {
		sum += lam[i] * b->alone.s[p][i];
	}
	for (i = 0; i < PL_OUTPUTS && PL_DECLARED && w != NULL; i++) {
		sum += PL(worth)(w, i) * b->J[i][p];
	}
#if PL_PEAKS > 0
	for (i = 0; i < PL_PEAKS; i++) {
		sum += b->peak[i] * b->alone.peak[i][p];
	}
#endif
	return sum;
}

/* A step from s without derivatives of its state, of the columns along inputs with these at its start and end; then
 * what outputs have of them behind it, where these are worth something */
static void PL(alone)(const PL_TYPE *s, PL(back_work) *b PL_GIVES, real before, real now, const real *w)
{
#if PL_SEEDED
	real du[PL_INPUTS];
	int i;
	for (i = 0; i < PL_INPUTS; i++) {
		b->alone.du[i] = before;
		du[i] = now;
	}
#else
	(void)before;
	(void)now;
#endif
	PL(set_d)(&b->alone, NULL);
	PL(as_seeds)(&b->alone);
#if PL_BY_PHI
	if (w == NULL || !PL_DECLARED) {
		PL(move_d)(s, &b->alone PL_TAKES PL_ALONG);
		return;
	}
#endif
	b->after = *s;
	PL(step_d)(&b->after, &b->alone PL_TAKES PL_ALONG);
#if PL_DECLARED
	if (w != NULL) {
		PL(outputs_alone)(b);
	}
#else
	(void)w;
#endif
}

static void PL(row_back)(const PL_TYPE *s, PL(back_work) *b PL_GIVES, const real *w, real lam[PL_STATES],
						 real pb[PL_DERIVATIVES]
#if PL_SEEDED
						 , real *ub, real *ub_before
#endif
						 )
{
	real sum;
	int p, some = 0;
	for (p = 0; p < PL_OUTPUTS && w != NULL; p++) {
		some |= w[p] < 0 || !(w[p] <= 0);
	}
	w = some ? w : NULL;
	PL(alone)(s, b PL_TAKES, 0, 1, w);
	if (w != NULL) {
		PL(outputs_back)(b, w, lam);
#if PL_PEAKS > 0
		for (p = 0; p < PL_PEAKS; p++) {
			b->peak[p] += w[PL(peak_output)[p]];
		}
#endif
	}
	for (p = 0; p < PL_DERIVATIVES; p++) {
		sum = PL(column_back)(b, p, w, lam);
		pb[p] += sum;
#if PL_SEEDED
		if (ub != NULL && PL(d_input)[p] >= 0) {
			ub[PL(d_input)[p]] += sum;
		}
#endif
	}
#if PL_SLOPED
	PL(alone)(s, b PL_TAKES, 1, 0, w);
	for (p = 0; p < PL_DERIVATIVES; p++) {
		sum = PL(d_input)[p] >= 0 ? PL(column_back)(b, p, w, lam) : 0;
		pb[p] += sum;
		if (ub_before != NULL && PL(d_input)[p] >= 0) {
			ub_before[PL(d_input)[p]] += sum;
		}
	}
#elif PL_SEEDED
	(void)ub_before;
#endif
	PL(state_back)(s, b PL_TAKES, lam);
#if PL_PEAKS > 0
	for (p = 0; p < PL_PEAKS; p++) {
		b->peak[p] = PL_PEAK_OF(&b->after)[p] > PL_PEAK_OF(s)[p] ? 0 : b->peak[p];
	}
#endif
}

static void PL(begin_back)(PL(back_work) *b)
{
#if PL_PEAKS > 0 || PL_BY_ROWS
	int i;
#endif
	PL(init_d)(&b->after, &b->alone);
	b->ds = b->alone;
#if PL_PEAKS > 0
	for (i = 0; i < PL_PEAKS; i++) {
		b->peak[i] = 0;
	}
#endif
#if PL_BY_ROWS
	PL(outputs_alone)(b);
	for (i = 0; i < PL_OUTPUTS; i++) {
		int j;
		for (j = 0; j < PL_STATES; j++) {
			b->row[i][j] = 0;
		}
		PL(rows_back)(b, NULL, i, b->row[i]);
	}
#endif
}

void PL(back)(const PL_TYPE *s PL_GIVES, const real *w, real lam[PL_STATES], real pb[PL_DERIVATIVES]
#if PL_SEEDED
			  , real *ub, real *ub_before
#endif
			  )
{
	PL(back_work) b;
	PL(begin_back)(&b);
	PL(row_back)(s, &b PL_TAKES, w, lam, pb
#if PL_SEEDED
				 , ub, ub_before
#endif
				 );
}

#if PL_STRIDE > 1
/* What the derivatives that ds has at s are worth to the rows of the next n steps, and to lam behind them */
static void PL(worth_of)(const PL_TYPE *s, PL(back_work) *b, PL(d) *ds, size_t n, const real *w, const real *lam,
						 real worth[PL_DERIVATIVES])
{
	int i, p;
	b->after = *s;
	for (p = 0; p < PL_DERIVATIVES; p++) {
		worth[p] = 0;
	}
	for (; n > 0; n--) {
		PL(step_d)(&b->after, ds);
		if (w != NULL) {
			PL(out_d)(&b->after, ds, b->J);
			for (p = 0; p < PL_DERIVATIVES; p++) {
				for (i = 0; i < PL_OUTPUTS; i++) {
					worth[p] += w[i] * b->J[i][p];
				}
			}
			w += PL_OUTPUTS;
		}
	}
	for (p = 0; p < PL_DERIVATIVES; p++) {
		for (i = 0; i < PL_STATES; i++) {
			worth[p] += lam[i] * ds->s[p][i];
		}
	}
}

/* Steps on to where the first series ends from the row `far` on, or the last one up to `most`: so many steps */
static size_t PL(go_far)(PL_TYPE *s, size_t *row, size_t far, size_t most)
{
	const size_t begun = *row;
	PL_TYPE next = *s;
	size_t at = begun;
	while (*row < far && at < most) {
		PL(step)(&next);
		at++;
		if (PL_ENDED(&next)) {
			*s = next;
			*row = at;
		}
	}
	return at - begun;
}

/* n steps backwards at once */
static void PL(stride_back)(const PL_TYPE *s, PL(back_work) *b, size_t n, const real *w, real lam[PL_STATES],
							real pb[PL_DERIVATIVES])
{
	real scale[PL_DERIVATIVES];
	int first, p;
	size_t k, some = 0;
	for (k = 0; w != NULL && k < n * PL_OUTPUTS; k++) {
		some |= w[k] < 0 || !(w[k] <= 0);
	}
	w = some ? w : NULL;
	PL(set_d)(&b->alone, NULL);
	PL(as_seeds)(&b->alone);
	PL(worth_of)(s, b, &b->alone, n, w, lam, b->worth);
	for (p = 0; p < PL_DERIVATIVES; p++) {
		pb[p] += b->worth[p];
		scale[p] = PL(d_size)(b->alone.s[p], PL_STATES, 1);
	}
	for (first = 0; first < PL_STATES; first += PL_DERIVATIVES) {
		PL(seed)(&b->ds, first, scale);
		PL(as_seeds)(&b->ds);
		PL(worth_of)(s, b, &b->ds, n, w, lam, b->seeded_worth);
		for (p = 0; p < PL_DERIVATIVES && first + p < PL_STATES; p++) {
			b->lam[first + p] = (b->seeded_worth[p] - b->worth[p]) / scale[p];
		}
	}
	for (p = 0; p < PL_STATES; p++) {
		lam[p] = b->lam[p];
	}
}
#endif

/* ---- snapshots: binomial checkpointing (Griewank and Walther 2000) ---- */

/* How many steps r replays of each reach with c snapshots: (c + r)! / (c! r!), or more than `enough` */
static size_t PL(reached)(size_t c, size_t r, size_t enough)
{
	size_t value = 1, i;
	for (i = 1; i <= r && value <= enough; i++) {
		value = value * (c + i) / i;
	}
	return value;
}

/* Of n steps from the newest of c snapshots: how far on the next one stands */
static size_t PL(apart)(size_t n, size_t c)
{
	size_t r = 1, far, less;
	if (c < 2) {
		return n - 1;
	}
	while (PL(reached)(c, r, n) < n) {
		r++;
	}
	far = r > 1 ? PL(reached)(c, r - 2, n) : 1;
	less = PL(reached)(c - 1, r, n);
	return n > less + far ? n - less : far;
}

size_t PL(gradient)(const PL_TYPE *s, PL(d) *ds, size_t n
#if PL_INPUTS > 0
					, const real *u
#endif
					, const real *w, real lam[PL_STATES], real pb[PL_DERIVATIVES]
#if PL_SEEDED
					, real *ub
#endif
					, PL_TYPE *snapshot, size_t snapshots)
{
	size_t at[PL_SNAPSHOTS], top = 0, steps = 0, k, row;
	PL(back_work) b;
	int i, p;
#if PL_SLOPED
	real held[PL_INPUTS];
	for (i = 0; i < PL_INPUTS; i++) {
		held[i] = 0;
	}
#endif
	if (snapshots > PL_SNAPSHOTS) {
		snapshots = PL_SNAPSHOTS;
	}
	PL(begin_back)(&b);
	at[0] = 0;
	snapshot[0] = *s;
	for (k = n; k > 0; k = row) {
		struct PL_TYPE now = snapshot[top];
		row = at[top];
		while (row + PL_STRIDE < k) {
			const size_t left = (k - row + PL_STRIDE - 1) / PL_STRIDE;
			const size_t far = row + PL_STRIDE * PL(apart)(left, snapshots - top);
#if PL_STRIDE > 1
			steps += PL(go_far)(&now, &row, far, k - PL_STRIDE);
			if (row < far) {
				break;
			}
#else
			for (; row < far; row++, steps++) {
				PL(step)(&now
#if PL_INPUTS > 0
						 , u + row * PL_INPUTS
#endif
						 );
			}
#endif
			if (top + 1 < snapshots) {
				top++;
				snapshot[top] = now;
				at[top] = row;
			}
		}
#if PL_STRIDE > 1
		PL(stride_back)(&now, &b, k - row, w == NULL ? NULL : w + row * PL_OUTPUTS, lam, pb);
#else
		PL(row_back)(&now, &b
#if PL_INPUTS > 0
					 , u + row * PL_INPUTS
#endif
					 , w == NULL ? NULL : w + row * PL_OUTPUTS, lam, pb
#if PL_SEEDED
#if PL_SLOPED
					 , ub == NULL ? NULL : ub + (row + 1) * PL_INPUTS
					 , row == 0 ? held : ub == NULL ? NULL : ub + row * PL_INPUTS
#else
					 , ub == NULL ? NULL : ub + row * PL_INPUTS, NULL
#endif
#endif
					 );
#endif
		if (b.alone.doubt.status || b.ds.doubt.status) {
			pl_doubt_join(&ds->doubt, &b.alone.doubt, 0);
			pl_doubt_join(&ds->doubt, &b.ds.doubt, 0);
			ds->status = ds->doubt.status;
		}
		top -= at[top] == row && top > 0;
	}
#if PL_SLOPED
	for (i = 0; i < PL_INPUTS && ub != NULL; i++) {
		ub[i] += held[i];
	}
#endif
	for (p = 0; p < PL_DERIVATIVES; p++) {
#if PL_SLOPED
		if (PL(d_input)[p] >= 0) { /* the sample before the first step moves as ds says */
			pb[p] += held[PL(d_input)[p]] * (ds->du[PL(d_input)[p]] - 1);
		}
#endif
		for (i = 0; i < PL_STATES; i++) {
			pb[p] += lam[i] * ds->s[p][i];
		}
#if PL_PEAKS > 0
		for (i = 0; i < PL_PEAKS; i++) {
			pb[p] += b.peak[i] * ds->peak[i][p];
		}
#endif
	}
	return steps;
}

static size_t PL(any_gradient)(const void *s, void *ds, size_t n, const real *u, const real *w, real *lam, real *pb,
							   real *ub, void *snapshot, size_t snapshots)
{
	(void)u;
	(void)ub;
	return PL(gradient)((const struct PL_TYPE *)s, (PL(d) *)ds, n PL_TAKES, w, lam, pb
#if PL_SEEDED
						, ub
#endif
						, (struct PL_TYPE *)snapshot, snapshots);
}
