/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A piecewise-linear model through its crossings, enclosed: from event to event by the closed form of each region. The
 * state is kept at rational times, as the region that it is in would have it there; what an event's time is not known
 * by becomes a width of the state. Between events it goes by powers of e^{A d} from where the grid of pieces d was met
 * first, so that rounding does not add up by steps. */
#include "inner.h"
#include "model/regions/regions.h"
#include "model/tunable/tuning.h"
#include "event_state.h"

/* ---- a piece ---- */

/* The length of the piece that begins at base, up to `target` at most; whole: it is one of the grid */
static void piece_at(struct trajectory *t, mpq_srcptr target, mpq_ptr tau, bool *full)
{
	mpq_srcptr d = t->at->flow->piece;
	RATIONAL pieces = ZERO, end = ZERO;
	INTEGER next = INTEGER_ZERO;
	mpq_div(pieces, t->base, d);
	*full = mpz_cmp_ui(mpq_denref(pieces), 1) == 0;
	mpz_fdiv_q(next, mpq_numref(pieces), mpq_denref(pieces));
	mpz_add_ui(next, next, 1);
	mpq_set_z(pieces, next);
	mpq_mul(end, pieces, d);
	if (mpq_cmp(end, target) > 0) {
		mpq_set(end, target);
		*full = false;
	}
	mpq_sub(tau, end, t->base);
}

static void keep(const struct trajectory *t, const mpfi_t *from, mpfi_t *to)
{
	for (int i = 0; i < t->n; i++)
		mpfi_set(to[i], from[i]);
}

/* A piece of the grid on: from where the grid was met, by as few products as the number of pieces has ones */
static void step_on_grid(struct trajectory *t, mpfi_t *y)
{
	if (!t->grid.met) {
		t->grid.met = true;
		t->grid.pieces = 0;
		keep(t, t->deviation->core, t->grid.slot[TRAJECTORY_SLOTS]);
	}
	unsigned long next = t->grid.pieces + 1;
	unsigned long from = next & (next - 1);
	int power = __builtin_ctzl(next);
	const mpfi_t *x = t->grid.slot[from ? __builtin_ctzl(from) : TRAJECTORY_SLOTS];
	stream_pieces(t->at->flow, power, x, y);
	keep(t, y, t->grid.slot[power]);
}

static void arrive(struct trajectory *t, mpq_srcptr tau, bool full)
{
	deviation_take(t);
	mpq_add(t->base, t->base, tau);
	t->piece.at_once = 0;
	t->grid.pieces++;
	for (int e = 0; e < t->s->functions; e++)
		t->fresh.order[e] = 0;
	t->grid.met = t->grid.met && full;
	if (full)
		return;
	trajectory_loads(t);
	deviation_loads(t);
}

static bool move(struct trajectory *t, mpq_srcptr target)
{
	bool full;
	const struct guard *guard = NULL;
	RATIONAL tau = ZERO;
	/* of its shortest piece, which no double may hold: a series would not end */
	if (!(t->at->flow->rate * mpq_get_d(t->at->flow->piece) <= 1))
		return trajectory_unknown(t, "where it goes: rates or loads are too large");
	piece_at(t, target, tau, &full);
	if (full) {
		step_on_grid(t, t->deviation->next_core);
		deviation_over_piece(t);
		if (trajectory_event_free(t, t->deviation->next_x, mpq_get_d(tau))) {
			arrive(t, tau, true);
			return true;
		}
	}
	INTERVAL at = OVER_BITS(t->precision);
	int degree = deviation_expand(t, tau);
	int found = trajectory_first(t, degree, tau, &guard, at);
	if (found == 0 && !full)
		deviation_over_part(t, degree, tau, t->piece.one);
	if (found == 0)
		arrive(t, tau, full);
	return found == 0 || (found > 0 && trajectory_pass(t, guard, degree, tau, at));
}

/* ---- changes of formula in time ---- */

static bool next_segment(struct trajectory *t)
{
	REAL none = WITH_BITS(64);
	bool known = true;
	mpfr_set_zero(none, 1);
	t->when.segment++;
	trajectory_loads(t);
	t->grid.met = false;
	if (t->s->segments > 1) {
		trajectory_enter(t, t->region + regions_at_once(t->s));
		t->noted.speed = 0;
		known = trajectory_take_up(t, none);
	}
	deviation_renew(t);
	return known;
}

static bool changes_here(const struct trajectory *t)
{
	return t->when.segment + 1 < t->when.segments && mpq_cmp(t->when.change[t->when.segment], t->base) <= 0;
}

bool trajectory_reach(struct trajectory *t, mpq_srcptr time)
{
	bool known = !t->undecided;
	while (known && changes_here(t))
		known = next_segment(t);
	while (known && mpq_cmp(t->base, time) < 0) {
		bool changes = t->when.segment + 1 < t->when.segments &&
			       mpq_cmp(t->when.change[t->when.segment], time) < 0;
		known = move(t, changes ? t->when.change[t->when.segment] : time);
		while (known && changes_here(t))
			known = next_segment(t);
	}
	return known;
}

/* ---- the beginning and the end ---- */

static void take_start(struct trajectory *t, const mpq_t *initial)
{
	bool rational = true;
	mpq_t *exact = rationals(t->n);
	for (int l = 0; l < t->system->loads; l++) {
		const struct load *load = &t->system->load[l];
		rational = rational && mpq_sgn(load->forcing->p) == 0;
		if (t->layout.load[l] >= 0)     /* t^0 e^0 cos 0 */
			mpq_set_ui(exact[t->layout.load[l]], 1, 1);
	}
	for (int i = 0; i < t->layout.states; i++)
		mpq_set(exact[i], initial[t->part ? t->part->state[i] : i]);
	for (int i = 0; i < t->system->inputs; i++) {
		int param = (t->part ? t->part->input[i] : i) - t->full->spec->count.inputs;
		mpq_set_ui(exact[t->layout.input[i]], 1, 1);
		if (param >= 0 && t->full->params.held)
			mpq_set(exact[t->layout.input[i]], t->full->params.held->nominal[param]);
		if (t->system->input[i].hold) {
			mpq_inv(exact[t->layout.input[i] + 1], t->model->h);
			mpq_neg(exact[t->layout.input[i] + 1], exact[t->layout.input[i] + 1]);
		}
	}
	for (int i = 0; i < t->n; i++)
		mpfi_set_q(t->x[i], exact[i]);
	trajectory_loads(t);
	t->exact = rational ? exact : NULL;
}

static void make_room(struct trajectory *t)
{
	const struct switching *s = t->s;
	t->area = ARRAY(struct area, s->regions);
	t->A = ARRAY(mpq_t *, s->systems);
	t->flow = ARRAY(struct stream *, s->systems);
	t->growth = ARRAY(double *, s->systems);
	t->resting = ARRAY(bool, s->functions);
	t->fresh.order = ARRAY(int, s->functions);
	t->fresh.back = ARRAY(bool, s->functions);
	t->x = enclosures(t->n, t->precision);
	t->y = enclosures(t->n, t->precision);
	for (int k = 0; k <= TRAJECTORY_SLOTS; k++)
		t->grid.slot[k] = enclosures(t->n, t->precision);
	for (int k = 0; k < 2; k++)
		t->piece.near[k] = (struct near){ ARRAY(double, t->n), ARRAY(double, t->n) };
	t->piece.most = ARRAY(double, t->n);
	mpq_init(t->base);
	deviation_make(t);
	t->event_state = NEW(struct event_state);
	mpfi_init2(t->event_state->flight, t->precision);
	mpfr_init2(t->fresh.off, 64);
	mpfr_init2(t->fresh.most_off, 64);
	mpfr_init2(t->piece.one, 2);
	mpfr_set_ui(t->piece.one, 1, MPFR_RNDN);
}

struct trajectory *trajectory_start(const struct model *full, const struct region_part *part, const mpq_t *initial,
			      int precision)
{
	struct trajectory *t = NEW(struct trajectory);
	t->full = full;
	t->part = part;
	t->model = part ? part->model : full;
	t->s = t->model->switching;
	t->system = &t->s->system[0];
	t->precision = precision;
	t->layout = layout_of_columns(t->system);
	t->n = t->layout.size;
	t->when.segments = full->system.segments;
	t->when.change = full->system.change;
	make_room(t);
	take_start(t, initial);
	while (t->when.segment + 1 < t->when.segments && mpq_sgn(t->when.change[t->when.segment]) <= 0)
		t->when.segment++;
	trajectory_place(t);
	deviation_renew(t);
	return t;
}

const char *trajectory_undecided(const struct trajectory *t)
{
	return t->undecided;
}

void trajectory_widen(struct trajectory *t, int state, mpfr_srcptr off)
{
	mpfi_increase(t->x[state], off);
	deviation_renew(t);
}

void trajectory_limit(struct trajectory *t, int most)
{
	t->noted.most = most;
}

int trajectory_passed(const struct trajectory *t, const struct passed **list)
{
	*list = t->noted.list;
	return t->noted.count;
}

static void free_room(int n, mpfi_t *x)
{
	for (int i = 0; i < n; i++)
		mpfi_clear(x[i]);
	discard(x);
}

void trajectory_free(struct trajectory *t)
{
	for (int k = 0; k < t->s->systems; k++)
		if (t->flow[k])
			stream_free(t->flow[k]);
	for (int k = 0; k < t->piece.terms; k++) {
		mpfi_clear(t->piece.value[k]);
		mpfi_clear(t->piece.slope[k]);
	}
	for (int k = 0; k <= TRAJECTORY_SLOTS; k++)
		free_room(t->n, t->grid.slot[k]);
	for (int k = 0; k < t->noted.count; k++)
		mpfi_clear(t->noted.list[k].at);
	deviation_free(t);
	free_room(t->n, t->x);
	free_room(t->n, t->y);
	series_room_free(&t->piece.room);
	mpfi_clear(t->event_state->flight);
	mpfr_clears(t->piece.one, t->fresh.off, t->fresh.most_off, NULL);
	mpq_clear(t->base);
	discard(t);
}
