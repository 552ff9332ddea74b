/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loads by refreshes. The functions of a load, cos, sin and e^{at}, are evaluated every so many steps only, from its
 * phase and growth in fixed point. In the steps between, what the load adds to a state is
 *
 *   L z(t_a + l h) = (L E_l) z(t_a)
 *
 * with L the load's columns of the step, z its states and E_l how they go on in l steps. So L E_l, for each l, is a
 * table of constants, each enclosed and rounded once (Ziv); nothing is added up from step to step, and nothing
 * accumulates. A step of regions has many L and asks for z itself: there E_l alone is the table. */
#include "inner.h"

#include <math.h>

enum {
	REFRESH_STEPS = 32,         /* from refresh to refresh, where the table is small */
	FEWEST_STEPS = 8,           /* below, functions in every step are about as good */
	TABLE_NUMBERS = 2048,       /* of a table that the cache shares with other data: 16 KB */
	MOST_GROWTH = 16,           /* |a| l h: near the ends of the range a refresh leaves it before its load does */
	TAYLOR_PRECISION = 2048     /* beyond, residues */
};

/* ---- which loads, and how many steps ---- */

static bool moves(const struct step *step, int state, int first, int columns)
{
	const struct table *table = step->branch->full;
	bool any = false;
	for (int k = first; k < first + columns; k++)
		any = any || !table->load[state * table->columns + k].zero;
	return any;
}

/* Of the states that a load moves in a step, every column of it */
static void add_terms(struct refresh *refresh, int state, int first, int columns)
{
	ENLARGE(refresh->term, (size_t)(refresh->terms + columns));
	for (int k = 0; k < columns; k++)
		refresh->term[refresh->terms++] = (struct refreshed_term){ state, first + k };
}

static void list_terms(struct refresh *refresh, const struct step *step, bool forced_too)
{
	const struct linear *system = &step->branch->system;
	refresh->terms = 0;
	for (int i = 0; i < system->states && !refresh->rotated; i++)
		for (int l = 0, first = 0; l < system->loads; first += system->load[l++].columns)
			if (refresh->load[l] && (forced_too || !is_forced(step, first)) &&
			    moves(step, i, first, system->load[l].columns))
				add_terms(refresh, i, first, system->load[l].columns);
}

/* The fastest growth or decay of a load in a step */
static double growth_in_step(const struct step *step, const struct refresh *refresh)
{
	const struct linear *system = &step->branch->system;
	double most = 0;
	for (int l = 0; l < system->loads; l++)
		if (refresh->load[l])
			most = fmax(most, fabs(mpq_get_d(system->load[l].forcing->a)));
	return most * mpq_get_d(step->model->h);
}

static bool is_steady(const struct step *step, const struct refresh *refresh, int steps)
{
	return (steps - 1) * growth_in_step(step, refresh) <= MOST_GROWTH;
}

static bool fits(const struct step *step, const struct refresh *refresh, int steps)
{
	return steps * refresh->terms * (step->is.two_words ? 2 : 1) <= TABLE_NUMBERS;
}

/* Where more than 1 was asked for */
static void note_aside(const struct step *step, const char *why)
{
	const char *steps = format("%d", step->model->request.refresh);
	if (step->model->request.refresh > 1 && !step->model->request.again.trial)
		stand_aside((struct place){ source_argument(steps), 0 }, format("--refresh %s", steps), why);
}

/* As many as were asked for, or as are good; 1: what stands against more is said */
static int chosen_steps(struct step *step, const struct refresh *refresh)
{
	int requested = step->model->request.refresh;
	if (requested && !is_steady(step, refresh, requested)) {
		note_aside(step, format("a load changes by more than e^%d between refreshes", MOST_GROWTH));
		requested = 0;
	}
	int steps = requested ? requested : REFRESH_STEPS;
	while (!requested && steps >= FEWEST_STEPS && !(fits(step, refresh, steps) && is_steady(step, refresh, steps)))
		steps /= 2;
	if (steps >= FEWEST_STEPS || requested)
		return steps;
	step->no.refresh = fits(step, refresh, FEWEST_STEPS) ? "a load changes too much from step to step"
							     : "tables would be large";
	return 1;
}

static struct refresh *refresh_of(const struct step *step)
{
	const struct linear *system = &step->branch->system;
	struct refresh *refresh = NEW(struct refresh);
	refresh->rotated = step->model->switching != NULL;
	refresh->load = refresh->rotated ? loads_of_regions(step) : ARRAY(bool, system->loads);
	for (int l = 0; l < system->loads; l++)
		refresh->load[l] = !is_polynomial(system->load[l].forcing) &&
				   (refresh->rotated ? refresh->load[l] : load_acts(system, &system->load[l]));
	return refresh;
}

static bool any_load(const struct step *step, const struct refresh *refresh)
{
	bool any = false;
	for (int l = 0; l < step->branch->system.loads; l++)
		any = any || refresh->load[l];
	return any;
}

/* NULL: more than 1 was asked for, or serves best. What a need is met with is the cheapest that there is. */
static const char *not_requested(const struct model *model)
{
	const struct request *requested = &model->request;
	if (requested->refresh)
		return requested->refresh == 1 ? "--refresh 1" : NULL;
	return requested->phasors || model->spec->required.needs > 0 ? NULL : "--fast adds them";
}

void check_refresh(struct step *step)
{
	const char *against = step_objection(step, CAN_REFRESH), *unwanted = not_requested(step->model);
	if (against)
		note_aside(step, against);
	if (any_load(step, refresh_of(step)))
		step->no.refresh = unwanted && !against ? unwanted : against;
}

void leave_out_refresh(struct step *step, const char *why)
{
	note_aside(step, why);
	step->no.refresh = why;
	step->refresh = NULL;
}

void plan_refresh(struct step *step)
{
	struct refresh *refresh = refresh_of(step);
	if (step->no.refresh || not_requested(step->model) || step_objection(step, CAN_REFRESH) ||
	    !any_load(step, refresh))
		return;
	list_terms(refresh, step, true);
	refresh->steps = chosen_steps(step, refresh);
	step->refresh = refresh->steps > 1 ? refresh : NULL;
}

int refreshed_term(const struct step *step, int state, int column)
{
	for (int k = 0; step->refresh && k < step->refresh->terms; k++)
		if (step->refresh->term[k].state == state && step->refresh->term[k].column == column)
			return k;
	return -1;
}

/* ---- E_l: how a load's states go on ---- */

struct turn {                       /* e^{a tau} cos(w tau) and sin */
	mpq_t tau;
	int precision;              /* 0: not asked for */
	mpfi_t z[2];
};

/* e^{a tau} cos(w tau) and sin; kept, since all states that the load moves ask for it */
static void enclose_turn(const struct forcing *forcing, struct turn *turn, int precision)
{
	if (turn->precision == precision)
		return;
	turn->precision = precision;
	mpfi_set_prec(turn->z[0], precision);
	mpfi_set_prec(turn->z[1], precision);
	RATIONAL product = ZERO;
	INTERVAL x = OVER_BITS(precision);
	mpq_mul(product, forcing->w, turn->tau);
	mpfi_set_q(x, product);
	mpfi_cos(turn->z[0], x);
	mpfi_sin(turn->z[1], x);
	mpq_mul(product, forcing->a, turn->tau);
	mpfi_set_q(x, product);
	mpfi_exp(x, x);
	mpfi_mul(turn->z[0], turn->z[0], x);
	mpfi_mul(turn->z[1], turn->z[1], x);
}

/* Over 0, 1, ... steps */
static struct turn *turns_of(const struct step *step)
{
	int steps = step->refresh->steps;
	struct turn *turn = ARRAY(struct turn, steps);
	for (int l = 0; l < steps; l++) {
		mpq_init(turn[l].tau);
		mpq_set_si(turn[l].tau, l, 1);
		mpq_mul(turn[l].tau, turn[l].tau, step->model->h);
		mpfi_init(turn[l].z[0]);
		mpfi_init(turn[l].z[1]);
	}
	return turn;
}

/* binomial(k, j) tau^(k-j) */
static void power_of_time(int k, int j, mpq_srcptr tau, mpq_ptr value)
{
	INTEGER binomial = INTEGER_ZERO;
	mpz_bin_uiui(binomial, (unsigned long)k, (unsigned long)j);
	mpq_set_z(value, binomial);
	for (int i = j; i < k; i++)
		mpq_mul(value, value, tau);
}

/* ---- L: a load's columns of the step, enclosed ---- */

struct block_source {               /* of a block */
	const struct linear *system;
	struct resolvent *resolvent;
	struct taylor *taylor;      /* NULL: residues */
	struct layout layout;
};
struct column {                     /* of L, in one row */
	int precision;              /* 0: not asked for */
	mpfi_t value;
	struct response *response;
};
struct row {                        /* what a load adds to a state */
	struct block_source *source;
	int state, load, columns;   /* of the block */
	struct column *column;
	mpq_srcptr h;
};

static struct block_source source_of_block(const struct step *step, const struct linear *system)
{
	bool full = system->states == step->branch->system.states;
	struct block_source source = { .system = system,
				       .resolvent = full ? step->branch->resolvent : resolvent_of(system),
				       .layout = layout_of(system, 0) };
	if (system->states > LIMIT_RESIDUE_STATES)
		source.taylor = taylor_of(source.layout.size,
					  augmented_matrix(&source.layout, system, 0), step->model->h);
	return source;
}

static bool enclose_by_residues(struct row *row, int k, int precision)
{
	struct column *column = &row->column[k];
	RATIONAL exact = ZERO;
	if (!column->response)
		column->response = response_of_load(row->source->resolvent, row->source->system, 0, row->state,
						    row->load, k);
	bool rational = response_exact(column->response, row->h, exact);
	if (rational)
		mpfi_set_q(column->value, exact);
	return rational || response_enclose(column->response, row->h, precision, column->value);
}

static bool enclose_column(struct row *row, int k, int precision)
{
	const struct block_source *source = row->source;
	struct column *column = &row->column[k];
	if (column->precision == precision)
		return true;
	column->precision = 0;
	mpfi_set_prec(column->value, precision);
	bool good;
	if (!source->taylor || precision > TAYLOR_PRECISION) {
		good = enclose_by_residues(row, k, precision);
	} else {
		good = taylor_enclose(source->taylor, precision);
		if (good)
			taylor_entry(source->taylor, row->state, source->layout.load[row->load] + k, column->value);
	}
	column->precision = good ? precision : 0;
	return good;
}

/* ---- L E_l, rounded ---- */

/* sum = column `from` of L E_l: t^k cos from t^j, j <= k; cos(x + w tau) = cos x cos(w tau) - sin x sin(w tau) */
static bool enclose_rotated(struct row *row, struct turn *turn, int from, int precision, mpfi_ptr sum)
{
	const struct forcing *forcing = row->source->system->load[row->load].forcing;
	int trig = oscillates(forcing) ? 2 : 1;
	bool good = true;
	INTERVAL value = OVER_BITS(precision);
	RATIONAL power = ZERO;
	enclose_turn(forcing, turn, precision);
	mpfi_set_prec(sum, precision);
	mpfi_set_ui(sum, 0);
	for (int to = from / trig * trig; to < row->columns && good; to++) {
		bool same = to % trig == from % trig;
		good = enclose_column(row, to, precision);
		mpfi_mul(value, row->column[to].value, turn->z[!same]);
		power_of_time(to / trig, from / trig, turn->tau, power);
		mpfi_mul_q(value, value, power);
		(same || to % trig ? mpfi_add : mpfi_sub)(sum, sum, value);
	}
	return good;
}

/* Both words; false: it is not decided with so many bits. What is 0 is so, once it is too small for the range. */
static bool round_rotated(struct row *row, struct turn *turn, int from, int precision, struct coefficient *c)
{
	INTERVAL x = OVER_BITS(precision);
	bool decided = enclose_rotated(row, turn, from, precision, x) && round_enclosure(x, &c->value);
	if (decided && isfinite(c->value)) {
		mpfi_sub_d(x, x, c->value);
		decided = round_enclosure(x, &c->low);
	}
	return decided;
}

static void fill_term(const struct step *step, struct row *row, struct turn *turn, int from, struct coefficient *c)
{
	int precision = FIRST_PRECISION;
	while (precision <= LIMIT_PRECISION && !round_rotated(row, turn, from, precision, c))
		precision *= 2;
	bool decided = precision <= LIMIT_PRECISION;
	if (!decided || !isfinite(c->value))
		error(step->model->request.at.step, "--refresh 1 may do",
		      "what a load adds so many steps after a refresh is %s",
		      decided ? format("beyond the range of %s", target_name())
			      : format("not decided with %d bits", LIMIT_PRECISION));
}

/* The terms of one state and one load, which stand together, after any number of steps */
static void fill_row(const struct step *step, struct block_source *source, int state, int load, struct turn *turn,
		     int term)
{
	struct refresh *refresh = step->refresh;
	int columns = source->system->load[load].columns;
	struct row row = { source, state, load, columns, ARRAY(struct column, columns), step->model->h };
	for (int k = 0; k < columns; k++)
		mpfi_init(row.column[k].value);
	for (int l = 0; l < refresh->steps; l++)
		for (int k = 0; k < columns; k++)
			fill_term(step, &row, &turn[l], k, &refresh->factor[l * refresh->terms + term + k]);
	for (int k = 0; k < columns; k++)
		mpfi_clear(row.column[k].value);
}

static void fill_block(const struct step *step, const struct block *block, struct turn *const *turn)
{
	const struct linear *system = &step->branch->system;
	struct block_source source = source_of_block(step, &block->system);
	int first;
	for (int i = 0; i < block->system.states; i++)
		for (int k = 0; k < step->refresh->terms; k++) {
			const struct refreshed_term *term = &step->refresh->term[k];
			int load = load_of_column(system, term->column, &first);
			if (term->state == block->state[i] && term->column == first)
				fill_row(step, &source, i, load, turn[load], k);
		}
}

/* What turns the load states of a refresh into those of now */
static void fill_turn(const struct forcing *forcing, struct turn *turn, double value[2])
{
	bool decided = false;
	for (int precision = FIRST_PRECISION; precision <= LIMIT_PRECISION && !decided; precision *= 2) {
		enclose_turn(forcing, turn, precision);
		decided = round_enclosure(turn->z[0], &value[0]) && round_enclosure(turn->z[1], &value[1]);
	}
}

void fill_refresh(struct step *step)
{
	const struct linear *system = &step->branch->system;
	struct refresh *refresh = step->refresh;
	struct block *block;
	struct turn **turn = ARRAY(struct turn *, system->loads);
	if (!refresh)
		return;
	list_terms(refresh, step, false);
	refresh->factor = ARRAY(struct coefficient, (size_t)(refresh->steps * refresh->terms));
	refresh->turn = ARRAY(double, 2 * (size_t)(refresh->steps * system->loads));
	for (int l = 0; l < system->loads; l++) {
		turn[l] = is_refreshed(step, l) ? turns_of(step) : NULL;
		for (int k = 0; turn[l] && k < refresh->steps; k++)
			fill_turn(system->load[l].forcing, &turn[l][k], &refresh->turn[2 * (l * refresh->steps + k)]);
	}
	int blocks = blocks_of(system, &block);
	for (int b = 0; b < blocks; b++)
		fill_block(step, &block[b], turn);
}

int refresh_numbers(const struct step *step)
{
	const struct refresh *a = step->refresh;
	return a ? a->steps * a->terms * (step->program->compensated ? 2 : 1) : 0;
}
