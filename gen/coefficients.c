/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The numbers of a step. Each is decided exactly to be rational, or enclosed ever more tightly until both ends of the
 * enclosure round to the same double (Ziv); so each is rounded once, correctly. */
#include "plgen.h"

#include <math.h>

enum { FIRST_PRECISION = 128, GUARD_BITS = 32 };

/* log2 |p| of the largest pole is at least the largest log2 |c_i/c_d| / (d-i), less log2 d (Cauchy's bound, reversed).
 * An angle |p| h of more bits than an enclosure may have could never be reduced to a turn. */
void check_pole_size(const struct model *model, const struct resolvent *resolvent)
{
	struct poly B = *resolvent_determinant(resolvent);
	long lead = (long)mpz_sizeinbase(B.c[B.length - 1], 2), largest = 0;
	for (int i = 0; i < B.length - 1; i++) {
		long bits = (long)mpz_sizeinbase(B.c[i], 2) - lead - B.length;
		if (mpz_sgn(B.c[i]) != 0 && bits / (B.length - 1 - i) > largest)
			largest = bits / (B.length - 1 - i);
	}
	long step = (long)mpz_sizeinbase(mpq_numref(model->h), 2) - (long)mpz_sizeinbase(mpq_denref(model->h), 2);
	if (largest + step > LIMIT_PRECISION)
		error(model->step_at, NULL, "the largest pole, about 2^%ld 1/s, times the step is beyond the limit of 2^%d", largest, LIMIT_PRECISION);
}

struct culprit {                    /* what an overflow comes from */
	double re, im, size;
	bool grows;                 /* by more than e in a step */
};

/* The pole that grows fastest; if none grows in a step, the largest one, since then its units are to blame. */
static struct culprit find_culprit(const struct response *response, double h)
{
	const struct spectrum *spectrum = response->spectrum;
	struct culprit fastest = { spectrum->zero ? 0 : -INFINITY, 0, 0, false }, largest = { 0 };
	for (int f = 0; f < spectrum->factors; f++)
		for (int i = 0; i < spectrum->poles[f]; i++) {
			double re = mpfi_get_d(spectrum->pole[f][i].at.re), im = mpfi_get_d(spectrum->pole[f][i].at.im);
			struct culprit pole = { re, im, hypot(re, im), re * h > 1 };
			fastest = pole.re > fastest.re ? pole : fastest;
			largest = pole.size > largest.size ? pole : largest;
		}
	return fastest.grows ? fastest : largest;
}

static const char *pole_of(const struct culprit *pole)
{
	return pole->im == 0 ? format("%.6g 1/s", pole->re) : format("%.6g +- %.6g i 1/s", pole->re, pole->im);
}

static _Noreturn void undecided(struct place at, const char *what, bool isolated)
{
	const char *note = isolated ? NULL : "two poles cannot be told apart; do two parameters differ by less than their rounding?";
	error(at, note, "%s is not decided with %d bits", what, LIMIT_PRECISION);
}

/* ---- numbers: sums of responses at a time, or combinations of entries of e^{A tau} ---- */

struct number {
	int count;
	const struct started *list; /* responses, each from its own start to t */
	mpq_srcptr t;
	struct taylor *taylor;      /* or, if not NULL: sum of weight e^{A tau}[row][column] */
	int row;
	const int *column;
	const mpq_t *weight;
};

/* One term; false: it is beyond the method's limits. *absent: it has not started. */
static bool enclose_term(const struct number *n, int i, int precision, mpfi_ptr value, bool *absent)
{
	*absent = false;
	if (n->taylor) {
		taylor_entry(n->taylor, n->row, n->column[i], value);
		mpfi_mul_q(value, value, n->weight[i]);
		return true;
	}
	mpq_t tau;
	mpq_init(tau);
	mpq_sub(tau, n->t, n->list[i].start);
	*absent = mpq_sgn(tau) < 0;
	bool good = *absent || response_enclose(n->list[i].response, tau, precision, value);
	mpq_clear(tau);
	return good;
}

static bool enclose_number(const struct number *n, int precision, mpfi_ptr sum)
{
	mpfi_t value;
	bool good = !n->taylor || taylor_enclose(n->taylor, precision), absent;
	mpfi_init2(value, precision);
	mpfi_set_prec(sum, precision + GUARD_BITS);
	mpfi_set_ui(sum, 0);
	for (int i = 0; i < n->count && good; i++) {
		good = enclose_term(n, i, precision, value, &absent);
		if (good && !absent)
			mpfi_add(sum, sum, value);
	}
	mpfi_clear(value);
	return good;
}

static bool exact_term(const struct number *n, int i, mpq_ptr value)
{
	if (n->taylor) {
		bool exact = taylor_exact(n->taylor, n->row, n->column[i], value);
		mpq_mul(value, value, n->weight[i]);
		return exact;
	}
	mpq_t tau;
	mpq_init(tau);
	mpq_sub(tau, n->t, n->list[i].start);
	mpq_set_ui(value, 0, 1);
	bool exact = mpq_sgn(tau) < 0 || response_exact(n->list[i].response, tau, value);
	mpq_clear(tau);
	return exact;
}

static bool exact_number(const struct number *n, mpq_ptr sum)
{
	mpq_t value;
	bool exact = true;
	mpq_init(value);
	mpq_set_ui(sum, 0, 1);
	for (int i = 0; i < n->count && exact; i++) {
		exact = exact_term(n, i, value);
		mpq_add(sum, sum, value);
	}
	mpq_clear(value);
	return exact;
}

/* number - subtract, rounded; false: not decided, *isolated says whether the poles were */
static bool round_difference(const struct number *n, double subtract, int limit, double *value, bool *isolated)
{
	mpfi_t enclosure;
	mpfi_init2(enclosure, FIRST_PRECISION);
	bool decided = false;
	*isolated = true;
	for (int precision = FIRST_PRECISION; precision <= limit && !decided && *isolated; precision *= 2) {
		*isolated = enclose_number(n, precision, enclosure);
		if (!*isolated)
			break;
		mpfi_sub_d(enclosure, enclosure, subtract);
		decided = round_enclosure(enclosure, value);
	}
	mpfi_clear(enclosure);
	return decided;
}

static bool round_number(const struct number *n, bool two_words, int limit, struct coefficient *c, bool *isolated)
{
	mpq_t exact, low;
	bool decided = true;
	mpq_inits(exact, low, NULL);
	*isolated = true;
	*c = (struct coefficient){ 0 };
	if (exact_number(n, exact)) {
		c->zero = mpq_sgn(exact) == 0;
		c->value = round_rational(exact);
		if (two_words && isfinite(c->value)) {
			mpq_set_d(low, c->value);
			mpq_sub(low, exact, low);
			c->low = round_rational(low);
		}
	} else {
		decided = round_difference(n, 0, limit, &c->value, isolated);
		if (decided && two_words && isfinite(c->value))
			decided = round_difference(n, c->value, limit, &c->low, isolated);
	}
	mpq_clears(exact, low, NULL);
	return decided;
}

struct coefficient started_value(int count, const struct started *list, mpq_srcptr t, struct place at, const char *what)
{
	struct number number = { .count = count, .list = list, .t = t };
	struct coefficient c;
	bool isolated;
	if (!round_number(&number, false, LIMIT_PRECISION, &c, &isolated))
		undecided(at, what, isolated);
	return c;
}

struct coefficient response_value(struct response *response, mpq_srcptr tau, bool two_words, struct place at, const char *what)
{
	struct started alone = { .response = response };
	mpq_init(alone.start);
	struct number number = { .count = 1, .list = &alone, .t = tau };
	struct coefficient c;
	bool isolated;
	if (!round_number(&number, two_words, LIMIT_PRECISION, &c, &isolated))
		undecided(at, what, isolated);
	mpq_clear(alone.start);
	return c;
}

static void check_range(const struct model *model, const struct coefficient *c, const struct response *response, const char *what)
{
	if (isfinite(c->value))
		return;
	struct culprit pole = find_culprit(response, round_rational(model->h));
	error(model->step_at, pole.grows ? "a smaller step would do" : NULL, "%s is beyond the range of double: pole %s, h = %s s", what,
	      pole_of(&pole), readable_text(model->h));
}

/* ---- a table ---- */

struct filling {
	const struct model *model;
	const struct linear *system;
	struct resolvent *resolvent;
	const char **state_name;
	struct series series;
	struct taylor **taylor;     /* per segment of time; NULL: residues */
	bool two_words;
	int *column;                /* room for one combination */
	mpq_t *weight;
};

/* By Taylor series if the filling has them and they decide it; what vanishes at this very step only residues decide. */
static struct coefficient entry(const struct filling *f, int segment, int terms, struct response *(*respond)(const struct filling *, int, int, int, int),
				int row, int a, int b, const char *of)
{
	enum { TAYLOR_PRECISION = 2048 };
	const char *what = format("the factor of %s in the step of %s", of, f->state_name[row]);
	struct coefficient c;
	bool isolated;
	if (f->taylor) {
		struct number number = { .count = terms, .taylor = f->taylor[segment], .row = row, .column = f->column, .weight = (const mpq_t *)f->weight };
		if (round_number(&number, f->two_words, TAYLOR_PRECISION, &c, &isolated) && isfinite(c.value))
			return c;
	}
	struct response *response = respond(f, segment, row, a, b);
	c = response_value(response, f->model->h, f->two_words, f->model->step_at, what);
	check_range(f->model, &c, response, what);
	return c;
}

static struct response *respond_state(const struct filling *f, int segment, int row, int state, int unused)
{
	(void)segment;
	(void)unused;
	return response_of_state(f->resolvent, f->system, row, state);
}

static struct response *respond_load(const struct filling *f, int segment, int row, int load, int column)
{
	return response_of_load(f->resolvent, f->system, segment, row, load, column);
}

static struct response *respond_input(const struct filling *f, int segment, int row, int input, int column)
{
	(void)segment;
	return response_of_input(f->resolvent, f->system, row, input, column, f->model->h);
}

static int add_column(const struct filling *f, int terms, int column, mpq_srcptr weight)
{
	f->column[terms] = column;
	mpq_set(f->weight[terms], weight);
	return terms + 1;
}

/* The state itself, and what a scheme holds of it: -heldK q or -heldC v in the held terms */
static int combine_state(const struct filling *f, int state)
{
	const struct linear *system = f->system;
	const mpq_t *held = state < system->n ? system->heldK : system->heldC;
	mpq_t weight;
	mpq_init(weight);
	mpq_set_ui(weight, 1, 1);
	int terms = add_column(f, 0, state, weight);
	for (int i = 0; i < system->n && held; i++) {
		mpq_neg(weight, held[i * system->n + system->coord[state]]);
		if (mpq_sgn(weight) != 0)
			terms = add_column(f, terms, f->series.held + i, weight);
	}
	mpq_clear(weight);
	return terms;
}

/* A ramp from u0 to u1: u0 (u - u'/h) + u1 u'/h */
static int combine_input(const struct filling *f, int input, int column)
{
	mpq_t weight;
	mpq_init(weight);
	mpq_set_ui(weight, 1, 1);
	int at = f->series.input[input], terms = column == 0 ? add_column(f, 0, at, weight) : 0;
	if (f->system->input[input].first_order) {
		mpq_inv(weight, f->model->h);
		if (column == 0)
			mpq_neg(weight, weight);
		terms = add_column(f, terms, at + 1, weight);
	}
	mpq_clear(weight);
	return terms;
}

static int combine_load(const struct filling *f, int load, int column)
{
	mpq_t one;
	mpq_init(one);
	mpq_set_ui(one, 1, 1);
	int at = f->series.load[load], terms = at < 0 ? 0 : add_column(f, 0, at + column, one);
	mpq_clear(one);
	return terms;
}

static void fill_row(const struct filling *f, struct table *table, int i)
{
	const struct linear *system = f->system;
	int n = table->states, columns = table->columns;
	for (int j = 0; j < n; j++)
		table->Phi[i * n + j] = entry(f, 0, combine_state(f, j), respond_state, i, j, 0, f->state_name[j]);
	for (int s = 0; s < system->segments; s++)
		for (int l = 0, column = 0; l < system->loads; l++)
			for (int k = 0; k < system->load[l].columns; k++, column++)
				table->load[(s * n + i) * columns + column] =
					entry(f, s, combine_load(f, l, k), respond_load, i, l, k, column_text(&system->load[l], k));
	for (int j = 0, column = 0; j < system->inputs; j++)
		for (int k = 0; k <= system->input[j].first_order; k++, column++)
			table->input[i * table->inputs + column] = entry(f, 0, combine_input(f, j, k), respond_input, i, j, k, system->input[j].name);
}

static struct table *table_new(const struct linear *system)
{
	struct table *table = NEW(struct table);
	size_t n = (size_t)system->states;
	table->states = system->states;
	table->columns = load_columns(system);
	table->inputs = input_columns(system);
	table->Phi = ARRAY(struct coefficient, n * n);
	table->load = ARRAY(struct coefficient, (size_t)system->segments * n * (size_t)table->columns);
	table->input = ARRAY(struct coefficient, n * (size_t)table->inputs);
	return table;
}

static struct table *table_of_block(struct filling *f)
{
	const struct linear *system = f->system;
	struct table *table = table_new(system);
	f->column = ARRAY(int, (size_t)system->n + 2);
	f->weight = rationals((size_t)system->n + 2);
	series_place(&f->series, system);
	if (system->states > LIMIT_RESIDUE_STATES) {
		f->taylor = ARRAY(struct taylor *, (size_t)system->segments);
		for (int s = 0; s < system->segments; s++)
			f->taylor[s] = taylor_of(f->series.size, (const mpq_t *)series_matrix(&f->series, system, s), f->model->h);
	}
	for (int i = 0; i < table->states; i++) {
		progress("factors of the step, state", i, table->states);
		fill_row(f, table, i);
	}
	progress_end();
	return table;
}

static void mark_zero(struct coefficient *c, size_t count)
{
	for (size_t i = 0; i < count; i++)
		c[i].zero = true;
}

/* The block's rows and columns to their places in the whole; between blocks everything stays exactly 0. */
static void scatter(const struct block *block, const struct table *part, int segments, struct table *table)
{
	for (int i = 0; i < part->states; i++) {
		int row = block->state[i];
		for (int j = 0; j < part->states; j++)
			table->Phi[row * table->states + block->state[j]] = part->Phi[i * part->states + j];
		for (int s = 0; s < segments; s++)
			for (int k = 0; k < table->columns; k++)
				table->load[(s * table->states + row) * table->columns + k] = part->load[(s * part->states + i) * part->columns + k];
		for (int k = 0; k < table->inputs; k++)
			table->input[row * table->inputs + k] = part->input[i * part->inputs + k];
	}
}

struct table *table_of(const struct model *model, struct resolvent *resolvent, const struct linear *system, bool two_words)
{
	struct block *block;
	int count = blocks_of(system, &block);
	struct filling whole = { .model = model, .system = system, .resolvent = resolvent, .state_name = model->state_name, .two_words = two_words };
	if (count == 1)
		return table_of_block(&whole);
	struct table *table = table_new(system);
	mark_zero(table->Phi, (size_t)table->states * (size_t)table->states);
	for (int b = 0; b < count; b++) {
		struct filling part = { .model = model, .system = &block[b].system, .resolvent = resolvent_of(&block[b].system), .two_words = two_words };
		part.state_name = ARRAY(const char *, (size_t)block[b].system.states);
		for (int i = 0; i < block[b].system.states; i++)
			part.state_name[i] = model->state_name[block[b].state[i]];
		scatter(&block[b], table_of_block(&part), system->segments, table);
	}
	return table;
}
