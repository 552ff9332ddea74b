/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A piecewise-linear model through its crossings, enclosed: from event to event by the closed form of each region. The
 * state is kept at rational times, as the region that it is in would have it there; what an event's time is not known
 * by becomes a width of the state. Between events it goes by powers of e^{A d} from where the grid of pieces d was met
 * first, so that widths grow by events and not by steps. */
#include "step/through.h"

#include <math.h>
#include <string.h>

enum { AT_ONCE = 64 };              /* events at one instant, before they count as without end */

/* ---- rows ---- */

static void fill_row(const struct through *t, const struct output *output, mpq_t *row)
{
	const struct linear *system = t->system;
	for (int i = 0; i < t->layout.states; i++)
		mpq_set(row[i], output->state[i]);
	for (int l = 0; l < system->loads; l++)
		for (int k = 0; k < system->load[l].columns && t->layout.load[l] >= 0; k++)
			mpq_set(row[t->layout.load[l] + k], output->load[l][k * t->segments + t->segment]);
	for (int i = 0; i < system->inputs; i++) {
		mpq_set(row[t->layout.input[i]], output->input[0][i]);
		if (system->input[i].hold)
			mpq_set(row[t->layout.input[i] + 1], output->input[1][i]);
	}
}

static void dot(const struct through *t, const mpq_t *row, const mpfi_t *x, mpfi_ptr sum)
{
	mpfi_t part;
	mpfi_init2(part, t->precision);
	mpfi_set_ui(sum, 0);
	for (int i = 0; i < t->n; i++) {
		if (mpq_sgn(row[i]) == 0)
			continue;
		mpfi_mul_q(part, x[i], row[i]);
		mpfi_add(sum, sum, part);
	}
	mpfi_clear(part);
}

void through_value(const struct through *t, const struct output *output, mpfi_ptr value)
{
	mpq_t *row = rationals((size_t)t->n);
	mpfi_set_prec(value, t->precision);
	fill_row(t, output, row);
	dot(t, (const mpq_t *)row, (const mpfi_t *)t->x, value);
	rationals_free(row, (size_t)t->n);
}

void through_state(const struct through *t, int state, mpfi_ptr value)
{
	mpfi_set_prec(value, t->precision);
	mpfi_set(value, t->x[state]);
}

/* ---- gates: what ends a region ---- */

static double *doubles(int n, const mpq_t *row)
{
	double *value = ARRAY(double, (size_t)n);
	for (int i = 0; i < n; i++)
		value[i] = mpq_get_d(row[i]);
	return value;
}

static mpq_t *times_matrix(const struct through *t, const mpq_t *row, const mpq_t *A)
{
	mpq_t *product = rationals((size_t)t->n), part;
	mpq_init(part);
	for (int i = 0; i < t->n; i++)
		for (int j = 0; j < t->n && mpq_sgn(row[i]) != 0; j++) {
			if (mpq_sgn(A[i * t->n + j]) == 0)
				continue;
			mpq_mul(part, row[i], A[i * t->n + j]);
			mpq_add(product[j], product[j], part);
		}
	mpq_clear(part);
	return product;
}

/* |row A^4|, and something for what doubles round */
static double *fourth_of(const struct through *t, const double *row, const mpq_t *A)
{
	int n = t->n;
	double *now = ARRAY(double, (size_t)n), *size = ARRAY(double, (size_t)n), *a = doubles(n * n, A);
	for (int i = 0; i < n; i++)
		size[i] = fabs(now[i] = row[i]);
	for (int k = 0; k < 4; k++) {
		double *next = ARRAY(double, (size_t)n), *bound = ARRAY(double, (size_t)n);
		for (int i = 0; i < n; i++)
			for (int j = 0; j < n; j++) {
				next[j] += now[i] * a[i * n + j];
				bound[j] += size[i] * fabs(a[i * n + j]);
			}
		now = next;
		size = bound;
	}
	for (int j = 0; j < n; j++)
		now[j] = fabs(now[j]) + 1e-12 * size[j];
	discard(a);
	return now;
}

static void add_gate(const struct through *t, struct area *area, struct gate gate, mpq_t *row, mpq_srcptr limit)
{
	mpq_init(gate.limit);
	mpq_set(gate.limit, limit);
	gate.row = row;
	gate.slope = times_matrix(t, (const mpq_t *)row, (const mpq_t *)area->A);
	gate.near_limit = mpq_get_d(limit);
	gate.near_row = doubles(t->n, (const mpq_t *)row);
	gate.near_slope = doubles(t->n, (const mpq_t *)gate.slope);
	gate.fourth = fourth_of(t, gate.near_row, (const mpq_t *)area->A);
	ENLARGE(area->gate, (size_t)area->gates + 1);
	area->gate[area->gates++] = gate;
}

/* The ends of an interval of an expression */
static void add_ends(const struct through *t, struct area *area, int region, int expression)
{
	const struct expression *e = &t->s->expression[expression];
	int interval = interval_of(t->s, region, expression);
	mpq_t limit;
	mpq_init(limit);
	for (int upward = 0; upward < 2; upward++) {
		int breakpoint = interval - !upward;
		if (breakpoint < 0 || breakpoint == e->breaks)
			continue;
		mpq_t *row = rationals((size_t)t->n);
		fill_row(t, e->row, row);
		mpq_set(limit, e->at[breakpoint]);
		if (!upward)
			mpq_neg(limit, limit);
		for (int i = 0; i < t->n && !upward; i++)
			mpq_neg(row[i], row[i]);
		add_gate(t, area,
			 (struct gate){ .expression = expression, .breakpoint = breakpoint, .upward = upward,
					.leads = upward ? e->stride : -e->stride },
			 row, limit);
	}
	mpq_clear(limit);
}

/* e^{|A| piece}, rounded up: entry by entry it bounds how far states grow in a piece */
static double *growth_of(const struct stream *f)
{
	int n = f->n;
	double *E = ARRAY(double, (size_t)(n * n)), *term = ARRAY(double, (size_t)(n * n)), d = mpq_get_d(f->piece);
	for (int i = 0; i < n * n; i++)
		E[i] = term[i] = i % n == i / n;
	for (int k = 1; k < 60; k++) {
		double *next = ARRAY(double, (size_t)(n * n));
		for (int i = 0; i < n; i++)
			for (int m = 0; m < n; m++)
				for (int j = 0; j < n && term[i * n + m] != 0; j++)
					next[i * n + j] += term[i * n + m] * f->size[m * n + j] * d / k;
		for (int i = 0; i < n * n; i++)
			E[i] += next[i];
		discard(term);
		term = next;
	}
	for (int i = 0; i < n * n; i++)
		E[i] *= 1 + 1e-9;
	discard(term);
	return E;
}

static struct stream *stream_of_system(struct through *t, int system, mpq_t **A)
{
	if (!t->A[system]) {
		t->A[system] = augmented_matrix(&t->layout, &t->s->system[system], 0);
		t->flow[system] = stream_of(t->n, (const mpq_t *)t->A[system], t->model->h, t->precision);
		t->growth[system] = growth_of(t->flow[system]);
	}
	*A = t->A[system];
	return t->flow[system];
}

/* Regions that cannot be are passed through where two expressions cross at once; then the equations stay those before */
static void enter(struct through *t, int region)
{
	struct area *area = &t->area[region];
	const struct region *r = &t->s->region[region];
	t->region = region;
	t->gridded = false;
	for (int e = 0; e < t->s->expressions; e++)
		t->resting[e] = false;
	if (area->flow && r->possible) {
		t->at = area;
		return;
	}
	int system = r->possible ? r->system : t->at ? t->at->system : 0;
	*area = (struct area){ .system = system };
	area->flow = stream_of_system(t, system, &area->A);
	area->growth = t->growth[system];
	for (int e = 0; e < t->s->expressions; e++)
		add_ends(t, area, region, e);
	t->at = area;
}

/* ---- what loads and inputs are at a time ---- */

static void wave_at(const struct through *t, const struct load *load, int column, mpq_srcptr time, mpfi_ptr z)
{
	const struct wave *wave = load->wave;
	bool turns = oscillates(wave);
	mpq_t argument;
	mpfi_t factor;
	mpq_init(argument);
	mpfi_init2(factor, t->precision);
	mpq_mul(argument, wave->a, time);
	mpfi_set_q(factor, argument);
	mpfi_exp(z, factor);
	for (int k = 0; k < (turns ? column / 2 : column); k++)
		mpfi_mul_q(z, z, time);
	if (turns) {
		mpq_mul(argument, wave->w, time);
		mpq_add(argument, argument, wave->p);
		mpfi_set_q(factor, argument);
		if (mpq_sgn(argument) == 0)
			mpfi_set_ui(factor, column % 2 == 0);
		else
			(column % 2 ? mpfi_sin : mpfi_cos)(factor, factor);
		mpfi_mul(z, z, factor);
	}
	mpq_clear(argument);
	mpfi_clear(factor);
}

static void take_loads(struct through *t)
{
	for (int l = 0; l < t->system->loads; l++)
		for (int k = 0; k < t->system->load[l].columns && t->layout.load[l] >= 0; k++)
			wave_at(t, &t->system->load[l], k, t->base, t->x[t->layout.load[l] + k]);
}

/* ---- what cannot be told ---- */

static const char *time_text(mpq_srcptr time)
{
	return format("%.12g", mpq_get_d(time));
}

static bool undecided(struct through *t, const struct gate *gate, const char *what)
{
	t->undecided = format("at t = %s s it is not known whether %s passes %s: %s", time_text(t->base),
			      spoken_expression(t->model, gate->expression),
			      readable_text(t->s->expression[gate->expression].at[gate->breakpoint]), what);
	return false;
}

/* ---- a piece that stays clear ---- */

static void near_of(const struct through *t, const mpfi_t *x, struct near *room)
{
	for (int i = 0; i < t->n; i++) {
		double low = mpfr_get_d(&x[i]->left, MPFR_RNDD), high = mpfr_get_d(&x[i]->right, MPFR_RNDU);
		room->x[i] = low / 2 + high / 2;
		room->off[i] = (high - low) * (1 + 1e-9) + 1e-13 * fabs(room->x[i]);
	}
}

/* row . x, and by how much it is not known */
static double value_near(int n, const double *row, const struct near *x, double *off)
{
	double sum = 0;
	for (int i = 0; i < n; i++) {
		sum += row[i] * x->x[i];
		*off += fabs(row[i]) * x->off[i];
	}
	return sum;
}

/* A cubic lies within its Bezier points, and the gate is off it by its fourth derivative. */
static bool is_clear(const struct through *t, const struct gate *g, const struct near *x, const struct near *y,
		     const double *most, double tau)
{
	int n = t->n;
	double off = 1e-13 * fabs(g->near_limit), bend = 0, slope = 0;
	double from = value_near(n, g->near_row, x, &off), to = value_near(n, g->near_row, y, &off);
	double leaves = value_near(n, g->near_slope, x, &slope) * tau / 3;
	double arrives = value_near(n, g->near_slope, y, &slope) * tau / 3;
	for (int i = 0; i < n; i++)
		bend += g->fourth[i] * most[i];
	off += slope * tau + bend * tau * tau * tau * tau / 384 * (1 + 1e-9);
	return from + off < g->near_limit && to + off < g->near_limit && from + leaves + off < g->near_limit &&
	       to - arrives + off < g->near_limit;
}

static bool stays_clear(struct through *t, const mpfi_t *y, double tau)
{
	const struct near *from = &t->near[0], *to = &t->near[1];
	near_of(t, (const mpfi_t *)t->x, &t->near[0]);
	near_of(t, y, &t->near[1]);
	for (int i = 0; i < t->n; i++) {
		t->most[i] = 0;
		for (int j = 0; j < t->n; j++)
			t->most[i] += t->at->growth[i * t->n + j] * (fabs(from->x[j]) + from->off[j]);
	}
	for (int k = 0; k < t->at->gates; k++)
		if (!t->resting[t->at->gate[k].expression] && !is_clear(t, &t->at->gate[k], from, to, t->most, tau))
			return false;
	return true;
}

/* ---- the first event of a piece ---- */

static void add_room(struct through *t, int degree)
{
	if (degree < t->terms)
		return;
	ENLARGE(t->value, (size_t)degree + 1);
	ENLARGE(t->slope, (size_t)degree + 1);
	for (; t->terms <= degree; t->terms++) {
		mpfi_init2(t->value[t->terms], t->precision);
		mpfi_init2(t->slope[t->terms], t->precision);
	}
}

/* The gate's polynomial in s, less its limit, and that of its slope */
static void expand_gate(struct through *t, const struct gate *gate, int degree, mpq_srcptr tau)
{
	add_room(t, degree);
	for (int m = 0; m <= degree; m++) {
		dot(t, (const mpq_t *)gate->row, (const mpfi_t *)t->room.term[m], t->value[m]);
		dot(t, (const mpq_t *)gate->slope, (const mpfi_t *)t->room.term[m], t->slope[m]);
		mpfi_mul_q(t->slope[m], t->slope[m], tau);
	}
	mpfi_sub_q(t->value[0], t->value[0], gate->limit);
}

/* 1: found; -1: not known; 0: none */
static int first_gate(struct through *t, int degree, mpq_srcptr tau, const struct gate **found, mpfi_ptr at)
{
	mpfr_t end;
	mpfi_t root;
	int result = 0;
	mpfr_init2(end, t->precision);
	mpfi_init2(root, t->precision);
	mpfr_set_d(end, 1.0 + 77 * 0x1p-20, MPFR_RNDN);
	for (int k = 0; k < t->at->gates && result >= 0; k++) {
		const struct gate *gate = &t->at->gate[k];
		if (t->resting[gate->expression])
			continue;
		expand_gate(t, gate, degree, tau);
		enum rise rise = first_rise(degree, (const mpfi_t *)t->value, (const mpfi_t *)t->slope, end, root);
		if (rise == RISE_UNKNOWN) {
			undecided(t, gate, "it comes closer than is known");
			result = -1;
		} else if (rise == RISE_AT && mpfr_cmp_ui(&root->left, 1) <= 0) {
			*found = gate;
			mpfi_set(at, root);
			result = 1;
			mpfr_min(end, end, &root->right, MPFR_RNDU);
		}
	}
	mpfr_clear(end);
	mpfi_clear(root);
	return result;
}

/* ---- an event ---- */

static void note(struct through *t, const struct gate *gate, mpfr_srcptr off)
{
	mpfi_t slope;
	ENLARGE(t->list, (size_t)t->passed + 1);
	struct passed *p = &t->list[t->passed++];
	*p = (struct passed){ .expression = gate->expression, .breakpoint = gate->breakpoint, .upward = gate->upward };
	mpfi_init2(slope, t->precision);
	mpfi_init2(p->at, t->precision);
	mpfi_set_q(p->at, t->base);
	mpfi_t width;
	mpfi_init2(width, t->precision);
	mpfi_set_fr(width, off);
	mpfi_neg(slope, width);
	mpfi_union(width, width, slope);
	mpfi_add(p->at, p->at, width);
	dot(t, (const mpq_t *)gate->slope, (const mpfi_t *)t->x, slope);
	p->speed = fabs(mpfi_get_d(slope));
	for (int i = 0; i < t->n && gate->near_row; i++)
		p->size += fabs(gate->near_row[i] * mpfi_get_d(t->x[i]));
	mpfi_clear(slope);
	mpfi_clear(width);
}

/* How far from base + s tau the event may be [s], rounded up */
static void width_of(mpfi_srcptr at, mpfr_srcptr s, mpq_srcptr tau, mpfr_ptr off)
{
	mpfr_t other;
	mpfr_init2(other, 64);
	mpfr_sub(off, &at->right, s, MPFR_RNDU);
	mpfr_sub(other, s, &at->left, MPFR_RNDU);
	mpfr_max(off, off, other, MPFR_RNDU);
	mpfr_mul_q(off, off, tau, MPFR_RNDU);
	mpfr_clear(other);
}

static bool pass(struct through *t, const struct gate *gate, int degree, mpq_srcptr tau, mpfi_srcptr at)
{
	mpfr_t s, off;
	mpq_t part;
	const struct stream *before = t->at->flow;
	mpfr_init2(s, t->precision);
	mpfr_init2(off, 64);
	mpq_init(part);
	mpfi_mid(s, at);
	if (mpfi_cmp_ui(at, 1) == 0)
		mpfr_set_ui(s, 1, MPFR_RNDN);
	if (mpfr_cmp_ui(&at->left, 0) <= 0)
		mpfr_set_zero(s, 1);
	width_of(at, s, tau, off);
	stream_sum(before, &t->room, degree, s, t->x);
	mpfr_get_q(part, s);
	mpq_mul(part, part, tau);
	mpq_add(t->base, t->base, part);
	t->at_once = mpq_sgn(part) == 0 ? t->at_once + 1 : 0;
	note(t, gate, off);
	enter(t, t->region + gate->leads);
	bool known = stream_change(before, t->at->flow, off, t->x);
	take_loads(t);
	mpq_clear(part);
	mpfr_clears(s, off, NULL);
	if (!known)
		return undecided(t, gate, "when is not known well enough");
	return t->at_once < AT_ONCE || undecided(t, gate, "breakpoints are passed without end");
}

/* ---- a piece ---- */

/* The length of the piece that begins at base, up to `target` at most; whole: it is one of the grid */
static void piece_at(struct through *t, mpq_srcptr target, mpq_ptr tau, bool *whole)
{
	mpq_srcptr d = t->at->flow->piece;
	mpq_t pieces, end;
	mpz_t next;
	mpq_inits(pieces, end, NULL);
	mpz_init(next);
	mpq_div(pieces, t->base, d);
	*whole = mpz_cmp_ui(mpq_denref(pieces), 1) == 0;
	mpz_fdiv_q(next, mpq_numref(pieces), mpq_denref(pieces));
	mpz_add_ui(next, next, 1);
	mpq_set_z(pieces, next);
	mpq_mul(end, pieces, d);
	if (mpq_cmp(end, target) > 0) {
		mpq_set(end, target);
		*whole = false;
	}
	mpq_sub(tau, end, t->base);
	mpq_clears(pieces, end, NULL);
	mpz_clear(next);
}

static void keep(const struct through *t, const mpfi_t *from, mpfi_t *to)
{
	for (int i = 0; i < t->n; i++)
		mpfi_set(to[i], from[i]);
}

/* A piece of the grid on: from where the grid was met, by as few products as the number of pieces has ones */
static void step_on_grid(struct through *t, mpfi_t *y)
{
	if (!t->gridded) {
		t->gridded = true;
		t->pieces = 0;
		keep(t, (const mpfi_t *)t->x, t->slot[THROUGH_SLOTS]);
	}
	unsigned long next = t->pieces + 1;
	unsigned long from = next & (next - 1);
	int power = __builtin_ctzl(next);
	const mpfi_t *x = (const mpfi_t *)t->slot[from ? __builtin_ctzl(from) : THROUGH_SLOTS];
	stream_pieces(t->at->flow, power, x, y);
	keep(t, (const mpfi_t *)y, t->slot[power]);
}

static void arrive(struct through *t, mpq_srcptr tau, bool whole, const mpfi_t *y)
{
	keep(t, y, t->x);
	mpq_add(t->base, t->base, tau);
	t->at_once = 0;
	t->pieces++;
	t->gridded = t->gridded && whole;
	if (!whole)
		take_loads(t);
}

static bool move(struct through *t, mpq_srcptr target)
{
	bool whole;
	mpq_t tau;
	mpfi_t at;
	const struct gate *gate = NULL;
	mpq_init(tau);
	piece_at(t, target, tau, &whole);
	if (whole) {
		step_on_grid(t, t->y);
		if (stays_clear(t, (const mpfi_t *)t->y, mpq_get_d(tau))) {
			arrive(t, tau, true, (const mpfi_t *)t->y);
			mpq_clear(tau);
			return true;
		}
	}
	mpfi_init2(at, t->precision);
	int degree = stream_expand(t->at->flow, (const mpfi_t *)t->x, tau, &t->room);
	int found = first_gate(t, degree, tau, &gate, at);
	if (found == 0 && !whole)
		stream_sum(t->at->flow, &t->room, degree, t->one, t->y);
	if (found == 0)
		arrive(t, tau, whole, (const mpfi_t *)t->y);
	bool known = found == 0 || (found > 0 && pass(t, gate, degree, tau, at));
	mpfi_clear(at);
	mpq_clear(tau);
	return known;
}

/* ---- where expressions stand ---- */

/* e - at, 1 above, -1 below; 0: not told apart */
static int side_of(const struct through *t, int expression, mpq_srcptr at)
{
	mpq_t *row = rationals((size_t)t->n);
	mpfi_t value;
	mpfi_init2(value, t->precision);
	fill_row(t, t->s->expression[expression].row, row);
	dot(t, (const mpq_t *)row, (const mpfi_t *)t->x, value);
	mpfi_sub_q(value, value, at);
	int side = mpfr_sgn(&value->left) > 0 ? 1 : mpfr_sgn(&value->right) < 0 ? -1 : 0;
	mpfi_clear(value);
	rationals_free(row, (size_t)t->n);
	return side;
}

/* ---- the start ---- */

/* Of a row over x at the start: its sign, exactly where the start is rational */
static int sign_at_start(struct through *t, const mpq_t *row, mpq_srcptr less, bool *known)
{
	mpq_t sum, part;
	int sign;
	mpq_inits(sum, part, NULL);
	*known = true;
	if (t->exact) {
		for (int i = 0; i < t->n; i++) {
			mpq_mul(part, row[i], t->exact[i]);
			mpq_add(sum, sum, part);
		}
		sign = mpq_cmp(sum, less);
	} else {
		mpfi_t value;
		mpfi_init2(value, t->precision);
		dot(t, row, (const mpfi_t *)t->x, value);
		mpfi_sub_q(value, value, less);
		sign = mpfr_sgn(&value->left) > 0 ? 1 : mpfr_sgn(&value->right) < 0 ? -1 : 0;
		*known = sign != 0 || (mpfr_zero_p(&value->left) && mpfr_zero_p(&value->right));
		mpfi_clear(value);
	}
	mpq_clears(sum, part, NULL);
	return sign;
}

/* Where an expression that stands on a breakpoint is heading: the sign of its first derivative that is not 0 */
static int heading(struct through *t, int expression, bool *known)
{
	mpq_t *row = rationals((size_t)t->n), zero;
	int sign = 0;
	mpq_init(zero);
	*known = true;
	fill_row(t, t->s->expression[expression].row, row);
	for (int k = 0; k < t->n && sign == 0 && *known; k++) {
		row = times_matrix(t, (const mpq_t *)row, (const mpq_t *)t->at->A);
		sign = sign_at_start(t, (const mpq_t *)row, zero, known);
	}
	mpq_clear(zero);
	return sign;
}

/* The interval of an expression, below where it stands on a breakpoint; then *on */
static int interval_at_start(struct through *t, int expression, bool *on, bool *known)
{
	const struct expression *e = &t->s->expression[expression];
	mpq_t *row = rationals((size_t)t->n);
	int interval = 0, sign = 1;
	*on = false;
	*known = true;
	fill_row(t, e->row, row);
	while (interval < e->breaks && *known) {
		sign = sign_at_start(t, (const mpq_t *)row, e->at[interval], known);
		*on = sign == 0;
		if (sign <= 0)
			break;
		interval++;
	}
	return interval;
}

static bool stands_where(struct through *t, int expression)
{
	t->undecided = format("at t = %s s it is not known on which side of a breakpoint %s is", time_text(t->base),
			      spoken_expression(t->model, expression));
	return false;
}

static bool place(struct through *t)
{
	int count = t->s->expressions, region = t->segment * (t->s->segments > 1 ? regions_at_once(t->s) : 0);
	bool *on = ARRAY(bool, (size_t)count), *above = ARRAY(bool, (size_t)count), known;
	for (int e = 0; e < count; e++) {
		region += interval_at_start(t, e, &on[e], &known) * t->s->expression[e].stride;
		if (!known)
			return stands_where(t, e);
	}
	enter(t, region);
	for (int round = 0; round < count; round++)     /* where one goes may change where another one is heading */
		for (int e = 0; e < count; e++) {
			bool up = on[e] && heading(t, e, &known) > 0;
			if (on[e] && !known)
				return stands_where(t, e);
			if (up != above[e])
				enter(t, t->region + (up ? 1 : -1) * t->s->expression[e].stride);
			above[e] = up;
		}
	for (int e = 0; e < count; e++)
		t->resting[e] = on[e] && t->exact && heading(t, e, &known) == 0;
	return true;
}

/* ---- changes of formula in time ---- */

/* What a load that jumps takes out of its interval passes the breakpoint there. */
static bool follow(struct through *t)
{
	mpfr_t none;
	mpfr_init2(none, 64);
	mpfr_set_zero(none, 1);
	for (int e = 0; e < t->s->expressions; e++) {
		const struct expression *x = &t->s->expression[e];
		for (int way = 1; way;) {
			int interval = interval_of(t->s, t->region, e);
			way = interval < x->breaks && side_of(t, e, x->at[interval]) > 0	? 1
			      : interval > 0 && side_of(t, e, x->at[interval - 1]) < 0 ? -1 : 0;
			if (!way)
				break;
			struct gate gate = { .expression = e, .breakpoint = interval - (way < 0), .upward = way > 0,
					     .slope = rationals((size_t)t->n) };
			note(t, &gate, none);
			t->list[t->passed - 1].jumped = true;
			enter(t, t->region + way * x->stride);
		}
	}
	mpfr_clear(none);
	return true;
}

static bool next_segment(struct through *t)
{
	t->segment++;
	take_loads(t);
	t->gridded = false;
	if (t->s->segments == 1)
		return true;
	enter(t, t->region + regions_at_once(t->s));
	return follow(t);
}

static bool changes_here(const struct through *t)
{
	return t->segment + 1 < t->segments && mpq_cmp(t->change[t->segment], t->base) <= 0;
}

bool through_reach(struct through *t, mpq_srcptr time)
{
	bool known = !t->undecided;
	while (known && changes_here(t))
		known = next_segment(t);
	while (known && mpq_cmp(t->base, time) < 0) {
		bool changes = t->segment + 1 < t->segments && mpq_cmp(t->change[t->segment], time) < 0;
		known = move(t, changes ? t->change[t->segment] : time);
		while (known && changes_here(t))
			known = next_segment(t);
	}
	return known;
}

/* ---- the beginning and the end ---- */

static bool is_rational_wave(const struct wave *wave)
{
	return mpq_sgn(wave->p) == 0;           /* at t = 0 */
}

static void take_start(struct through *t, const mpq_t *initial)
{
	bool rational = true;
	mpq_t *exact = rationals((size_t)t->n);
	for (int l = 0; l < t->system->loads; l++) {
		const struct load *load = &t->system->load[l];
		rational = rational && is_rational_wave(load->wave);
		if (t->layout.load[l] >= 0)     /* t^0 e^0 cos 0 */
			mpq_set_ui(exact[t->layout.load[l]], 1, 1);
	}
	for (int i = 0; i < t->layout.states; i++)
		mpq_set(exact[i], initial[t->part ? t->part->state[i] : i]);
	for (int i = 0; i < t->system->inputs; i++) {
		int param = (t->part ? t->part->input[i] : i) - t->whole->spec->inputs;
		mpq_set_ui(exact[t->layout.input[i]], 1, 1);
		if (param >= 0 && t->whole->held)
			mpq_set(exact[t->layout.input[i]], t->whole->held->nominal[param]);
		if (t->system->input[i].hold) {
			mpq_inv(exact[t->layout.input[i] + 1], t->model->h);
			mpq_neg(exact[t->layout.input[i] + 1], exact[t->layout.input[i] + 1]);
		}
	}
	for (int i = 0; i < t->n; i++)
		mpfi_set_q(t->x[i], exact[i]);
	take_loads(t);
	t->exact = rational ? exact : NULL;
}

static mpfi_t *room_of(const struct through *t)
{
	mpfi_t *x = ARRAY(mpfi_t, (size_t)t->n);
	for (int i = 0; i < t->n; i++) {
		mpfi_init2(x[i], t->precision);
		mpfi_set_ui(x[i], 0);
	}
	return x;
}

static void make_room(struct through *t)
{
	const struct switching *s = t->s;
	t->area = ARRAY(struct area, (size_t)s->regions);
	t->A = ARRAY(mpq_t *, (size_t)s->systems);
	t->flow = ARRAY(struct stream *, (size_t)s->systems);
	t->growth = ARRAY(double *, (size_t)s->systems);
	t->resting = ARRAY(bool, (size_t)s->expressions);
	t->x = room_of(t);
	t->y = room_of(t);
	for (int k = 0; k <= THROUGH_SLOTS; k++)
		t->slot[k] = room_of(t);
	for (int k = 0; k < 2; k++)
		t->near[k] = (struct near){ ARRAY(double, (size_t)t->n), ARRAY(double, (size_t)t->n) };
	t->most = ARRAY(double, (size_t)t->n);
	mpq_init(t->base);
	mpfr_init2(t->one, 2);
	mpfr_set_ui(t->one, 1, MPFR_RNDN);
}

struct through *through_start(const struct model *whole, const struct region_part *part, const mpq_t *initial,
			      int precision)
{
	struct through *t = NEW(struct through);
	t->whole = whole;
	t->part = part;
	t->model = part ? part->model : whole;
	t->s = t->model->switching;
	t->system = &t->s->system[0];
	t->precision = precision;
	t->layout = layout_of_columns(t->system);
	t->n = t->layout.size;
	t->segments = whole->system.segments;
	t->change = (const mpq_t *)whole->system.change;
	make_room(t);
	take_start(t, initial);
	while (t->segment + 1 < t->segments && mpq_sgn(t->change[t->segment]) <= 0)
		t->segment++;
	place(t);
	return t;
}

const char *through_undecided(const struct through *t)
{
	return t->undecided;
}

int through_passed(const struct through *t, const struct passed **list)
{
	*list = t->list;
	return t->passed;
}

static void free_room(int n, mpfi_t *x)
{
	for (int i = 0; i < n; i++)
		mpfi_clear(x[i]);
	discard(x);
}

void through_free(struct through *t)
{
	for (int k = 0; k < t->s->systems; k++)
		if (t->flow[k])
			stream_free(t->flow[k]);
	for (int k = 0; k < t->terms; k++) {
		mpfi_clear(t->value[k]);
		mpfi_clear(t->slope[k]);
	}
	for (int k = 0; k <= THROUGH_SLOTS; k++)
		free_room(t->n, t->slot[k]);
	for (int k = 0; k < t->passed; k++)
		mpfi_clear(t->list[k].at);
	free_room(t->n, t->x);
	free_room(t->n, t->y);
	series_room_free(t->n, &t->room);
	mpfr_clear(t->one);
	mpq_clear(t->base);
	discard(t);
}
