/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tables of a step: which responses, or entries of e^{A tau}, each of their numbers is a sum of. */
#include "inner.h"
#include "model/reads.h"

#include <math.h>

struct exponential {                /* e^{A tau} of one system by Taylor series */
	mpq_srcptr tau;
	struct taylor **segment;    /* of time: loads may change; NULL: not made yet */
};
struct filling {
	const struct model *model;
	const struct linear *system;
	struct resolvent *resolvent;
	const char **state_name;
	struct layout layout;
	int exponentials;           /* 0: residues */
	struct exponential *exponential;
	const struct wanted *wanted; /* the table being filled */
	int segment, row;
	mpq_t tau;                  /* its time */
	int entries;                /* room for one combination */
	struct entry *entry;
	int responses;
	struct started *response;
	mpq_t **impulse;            /* per force column, once asked for */
	mpq_srcptr scale, less;     /* of the number being rounded; NULL: 1 and 0 */
	const int *coord;           /* of a block, per coordinate: of the whole; NULL: it is the whole */
};

static const mpq_t *impulse_of(struct filling *f, int force_column)
{
	if (!f->impulse)
		f->impulse = ARRAY(mpq_t *, f->system->force_columns);
	if (!f->impulse[force_column])
		f->impulse[force_column] = impulse_of_force_column(f->system, force_column);
	return f->impulse[force_column];
}

static struct exponential *exponential_at(const struct filling *f, mpq_srcptr tau)
{
	for (int i = 0; i < f->exponentials; i++)
		if (mpq_equal(f->exponential[i].tau, tau))
			return &f->exponential[i];
	return NULL;
}

/* The square of e^{A tau/2}, where half the time is requested too */
static struct taylor *taylor_at(const struct filling *f, mpq_srcptr tau)
{
	struct exponential *here = exponential_at(f, tau);
	int segment = f->layout.segments > 1 ? 0 : f->segment;
	if (here->segment[segment])
		return here->segment[segment];
	RATIONAL half = ZERO;
	mpq_div_2exp(half, tau, 1);
	if (mpq_sgn(half) > 0 && exponential_at(f, half)) {
		here->segment[segment] = taylor_doubled(taylor_at(f, half));
	} else {
		RATIONALS *A = augmented_matrix(&f->layout, f->system, segment);
		here->segment[segment] = taylor_of(f->layout.size, A, tau);
	}
	return here->segment[segment];
}

static void add_entry(struct filling *f, mpq_srcptr tau, int column, mpq_srcptr weight)
{
	struct entry *entry = &f->entry[f->entries++];
	entry->taylor = taylor_at(f, tau);
	entry->column = column;
	mpq_set(entry->weight, weight);
}

static void add_response(struct filling *f, struct response *response, mpq_srcptr start)
{
	f->response[f->responses].response = response;
	mpq_set(f->response[f->responses++].start, start);
}

/* Two who say what a number is made of: entries of e^{A tau} as a whole, or sums of residues. */
enum sought { SOUGHT_STATE, SOUGHT_INPUT, SOUGHT_LOAD, SOUGHT_PHI_WEIGHT, SOUGHT };
typedef void evaluator(struct filling *f, int a, int b);

static evaluator state_by_taylor, input_by_taylor, load_by_taylor, phi_weight_by_taylor;
static evaluator state_by_residues, input_by_residues, load_by_residues, phi_weight_by_residues;
static evaluator *const by_taylor[SOUGHT] = { state_by_taylor, input_by_taylor, load_by_taylor, phi_weight_by_taylor };
static evaluator *const by_residues[SOUGHT] = { state_by_residues, input_by_residues, load_by_residues,
					     phi_weight_by_residues };

static struct number ask(struct filling *f, evaluator *const *evaluators, enum sought what, int a, int b)
{
	f->entries = f->responses = 0;
	evaluators[what](f, a, b);
	struct number number = { .row = f->row, .t = f->tau, .scale = f->scale, .less = f->less };
	if (evaluators == by_taylor) {
		number.count = f->entries;
		number.entry = f->entry;
	} else {
		number.count = f->responses;
		number.list = f->response;
	}
	return number;
}

/* Rounded: from entries of e^{A tau} if the filling has them and they decide it; what vanishes at this very step only
 * residues decide. */
static struct coefficient number_of(struct filling *f, bool two_words, enum sought sought, int a, int b, const char *of)
{
	enum { TAYLOR_PRECISION = 2048 };
	const char *what = format("the factor of %s in the step of %s", of, f->state_name[f->row]);
	struct coefficient c;
	bool isolated;
	if (f->exponentials > 0) {
		struct number number = ask(f, by_taylor, sought, a, b);
		if (round_number(&number, two_words, TAYLOR_PRECISION, &c, &isolated) && isfinite(c.value))
			return c;
	}
	struct number number = ask(f, by_residues, sought, a, b);
	if (!round_number(&number, two_words, LIMIT_PRECISION, &c, &isolated))
		undecided(f->model->request.at.step, what, isolated);
	check_range(f->model, &c, f->responses, f->response, what);
	return c;
}

static void by_residues_from(struct filling *f, struct response *response)
{
	RATIONAL start = ZERO;
	add_response(f, response, start);
}

static void state_by_residues(struct filling *f, int state, int unused)
{
	(void)unused;
	by_residues_from(f, response_of_state(f->resolvent, f->system, f->row, state));
}

/* The state itself, and what a scheme holds of it: -heldK q or -heldC v in the held terms */
static void state_by_taylor(struct filling *f, int state, int unused)
{
	(void)unused;
	const struct linear *system = f->system;
	const mpq_t *held = state < system->n ? system->heldK : system->heldC;
	RATIONAL weight = RATIO(1, 1);
	add_entry(f, f->tau, state, weight);
	for (int i = 0; i < system->n && held; i++) {
		mpq_neg(weight, held[i * system->n + system->coord[state]]);
		if (mpq_sgn(weight) != 0)
			add_entry(f, f->tau, f->layout.held + i, weight);
	}
}

/* ---- forms other than direct ---- */

/* Phi - I, rounded as it is and not as Phi */
static struct coefficient increment_entry(struct filling *f, int j, bool two_words)
{
	RATIONAL one = RATIO(1, 1);
	f->less = f->row == j ? one : NULL;
	struct coefficient c = number_of(f, two_words, SOUGHT_STATE, j, 0, f->state_name[j]);
	f->less = NULL;
	return c;
}

static mpq_srcptr mass_of(const struct filling *f, int coord)
{
	return f->wanted->mass[f->coord ? f->coord[coord] : coord];
}

/* S = Phi_12 M^-1 */
static struct coefficient drift_entry(struct filling *f, int j, bool two_words)
{
	RATIONAL inverse = ZERO;
	mpq_inv(inverse, mass_of(f, j));
	f->scale = inverse;
	struct coefficient c = number_of(f, two_words, SOUGHT_STATE, f->system->velocity[j], 0,
					 f->state_name[f->system->velocity[j]]);
	f->scale = NULL;
	return c;
}

static bool enclose_state(struct filling *f, int i, int j, int precision, mpfi_ptr value)
{
	f->row = i;
	struct number number = ask(f, f->exponentials ? by_taylor : by_residues, SOUGHT_STATE, j, 0);
	return enclose_number(&number, precision, value);
}

/* X <- S^-1 R, all n x n, in intervals, by elimination; S is symmetric and positive definite, S and R are destroyed. */
static bool solve_enclosed(int n, mpfi_t *S, mpfi_t *R, int precision)
{
	bool regular = true;
	INTERVAL factor = OVER_BITS(precision), product = OVER_BITS(precision);
	for (int k = 0; k < n && regular; k++) {
		regular = !mpfi_has_zero(S[k * n + k]);
		for (int i = 0; i < n && regular; i++) {
			if (i == k)
				continue;
			mpfi_div(factor, S[i * n + k], S[k * n + k]);
			for (int j = 0; j < n; j++) {
				mpfi_mul(product, factor, S[k * n + j]);
				mpfi_sub(S[i * n + j], S[i * n + j], product);
				mpfi_mul(product, factor, R[k * n + j]);
				mpfi_sub(R[i * n + j], R[i * n + j], product);
			}
		}
	}
	for (int i = 0; i < n && regular; i++)
		for (int j = 0; j < n; j++)
			mpfi_div(R[i * n + j], R[i * n + j], S[i * n + i]);
	return regular;
}

static bool round_words(mpfi_ptr x, struct coefficient *c)
{
	if (!round_enclosure(x, &c->value))
		return false;
	mpfi_sub_d(x, x, c->value);
	return round_enclosure(x, &c->low);
}

/* X = S^-1 (Phi_11 - I) with so many bits; false: they do not decide every entry */
static bool round_kicks(struct filling *f, struct table *table, int precision)
{
	const struct linear *system = f->system;
	int n = system->n;
	INTERVALS *S = enclosures((size_t)(n * n), precision), *R = enclosures((size_t)(n * n), precision);
	bool decided = true;
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++) {
			decided = decided && enclose_state(f, i, system->velocity[j], precision, S[i * n + j]);
			decided = decided && enclose_state(f, i, j, precision, R[i * n + j]);
			mpfi_div_q(S[i * n + j], S[i * n + j], mass_of(f, j));
			mpfi_sub_ui(R[i * n + j], R[i * n + j], i == j);
		}
	decided = decided && solve_enclosed(n, S, R, precision);
	for (int i = 0; i < n; i++)
		for (int j = i; j < n && decided; j++) {
			decided = round_words(R[i * n + j], &table->kick[i * n + j]);
			table->kick[j * n + i] = table->kick[i * n + j];
		}
	return decided;
}

static void fill_kicks(struct filling *f, struct table *table)
{
	const struct linear *system = f->system;
	int precision = FIRST_PRECISION;
	f->segment = 0;
	if (system->n == 1 && mpq_sgn(system->K[0]) == 0) {
		table->kick[0].zero = true;
		return;
	}
	while (!round_kicks(f, table, precision)) {
		precision *= 2;
		if (precision > LIMIT_PRECISION)
			undecided(f->model->request.at.step, "a kick of the form kick-drift-kick", true);
	}
	for (int i = 0; i < system->n * system->n; i++)
		if (!isfinite(table->kick[i].value) || !isfinite(table->drift[i].value))
			error(f->model->request.at.step, "--form delta or --form direct may do",
			      "a factor of the form kick-drift-kick is beyond the range of %s", target_name());
}

static void input_by_residues(struct filling *f, int input, int column)
{
	by_residues_from(f, response_of_input(f->resolvent, f->system, f->row, input, column, f->model->h));
}

/* One sample's share of u and its derivatives at the start */
static void input_by_taylor(struct filling *f, int input, int column)
{
	int at = f->layout.input[input], hold = f->system->input[input].hold;
	RATIONAL weight = ZERO;
	for (int m = 0; m <= hold; m++) {
		sample_derivative(hold, m, column, f->model->h, weight);
		if (mpq_sgn(weight) != 0)
			add_entry(f, f->tau, at + m, weight);
	}
}

static void load_by_residues(struct filling *f, int load, int column)
{
	by_residues_from(f, response_of_load(f->resolvent, f->system, f->segment, f->row, load, column));
}

static void load_by_taylor(struct filling *f, int load, int column)
{
	RATIONAL one = RATIO(1, 1);
	if (f->layout.load[load] >= 0)
		add_entry(f, f->tau,
			  f->layout.load[load] + column + (f->layout.segments > 1 ? f->segment * f->layout.loads : 0),
			  one);
}

/* (s/h)^m from u_m of a chain u_0' = u_1, u_1' = u_2 ..., u_0 the force: s^m/m! */
static void add_powers(struct filling *f, const struct phi_weight_part *part, mpq_srcptr tau, int force_column)
{
	RATIONAL weight = ZERO, scale = RATIO(1, 1);
	for (int m = 0; m < part->powers; m++) {
		if (m > 0) {
			mpq_set_ui(weight, (unsigned long)m, 1);
			mpq_mul(scale, scale, weight);
			mpq_div(scale, scale, f->model->h);
		}
		mpq_mul(weight, part->power[m], scale);
		if (mpq_sgn(weight) != 0)
			add_entry(f, tau, f->layout.force_column + force_column * f->layout.powers + m, weight);
	}
}

/* impulse e^{A tau} B: B are the highest derivatives that the force gives */
static void add_impulse(struct filling *f, const struct phi_weight_part *part, mpq_srcptr tau, int force_column)
{
	const struct linear *system = f->system;
	const mpq_t *B = impulse_of(f, force_column);
	RATIONAL weight = ZERO;
	for (int i = 0; i < system->states; i++) {
		mpq_mul(weight, B[i], part->impulse);
		if (mpq_sgn(weight) != 0)
			add_entry(f, tau, i, weight);
	}
}

static void phi_weight_by_residues(struct filling *f, int index, int force_column)
{
	const struct phi_weight *phi_weight = &f->wanted->phi_weight[index];
	RATIONAL start = ZERO;
	for (int k = 0; k < phi_weight->parts; k++) {
		const struct phi_weight_part *part = &phi_weight->part[k];
		mpq_mul(start, part->fraction, f->model->h);
		mpq_sub(start, f->tau, start);
		add_response(f, response_of_phi_weight(f->resolvent, f->system, f->row, force_column, part,
						       f->model->h), start);
	}
}

static void phi_weight_by_taylor(struct filling *f, int index, int force_column)
{
	const struct phi_weight *phi_weight = &f->wanted->phi_weight[index];
	RATIONAL tau = ZERO;
	for (int k = 0; k < phi_weight->parts; k++) {
		const struct phi_weight_part *part = &phi_weight->part[k];
		mpq_mul(tau, part->fraction, f->model->h);
		add_powers(f, part, tau, force_column);
		if (mpq_sgn(part->impulse) != 0)
			add_impulse(f, part, tau, force_column);
	}
}

/* At tau = 0 an impulse is what it is. */
static bool is_immediate(const struct phi_weight *phi_weight)
{
	return phi_weight->parts == 1 && mpq_sgn(phi_weight->part[0].fraction) == 0;
}

static struct coefficient immediate(struct filling *f, const struct phi_weight *phi_weight, int force_column)
{
	RATIONAL value = ZERO;
	mpq_mul(value, impulse_of(f, force_column)[f->row], phi_weight->part[0].impulse);
	struct coefficient c = { .value = round_rational(value), .zero = mpq_sgn(value) == 0 };
	check_range(f->model, &c, 0, NULL, "a factor of the remainder");
	return c;
}

/* Whether a load acts alike in two segments of time: then its factors are the same */
static bool same_forces(const struct linear *system, int load, int a, int b)
{
	bool same = true;
	for (int k = 0; k < system->load[load].columns; k++)
		for (int i = 0; i < system->n && same; i++)
			same = mpq_equal(system->load[load].force[k][a * system->n + i],
					 system->load[load].force[k][b * system->n + i]);
	return same;
}

static void fill_row(struct filling *f, struct table *table)
{
	const struct linear *system = f->system;
	const struct wanted *wanted = f->wanted;
	int n = table->states, columns = table->columns, i = f->row;
	f->segment = 0;
	for (int j = 0; j < n && wanted->Phi; j++)
		table->Phi[i * n + j] = number_of(f, wanted->two_words, SOUGHT_STATE, j, 0, f->state_name[j]);
	for (int j = 0; j < n && wanted->increments; j++)
		table->increment[i * n + j] = i == j ? increment_entry(f, j, wanted->two_words) : table->Phi[i * n + j];
	for (int j = 0; j < system->n && wanted->mass && i < system->n; j++)
		table->drift[i * system->n + j] = drift_entry(f, j, wanted->two_words);
	for (int j = 0, column = 0; j < system->inputs; j++)
		for (int k = 0; k <= system->input[j].hold; k++, column++)
			table->input[i * table->inputs + column] =
				number_of(f, wanted->two_words, SOUGHT_INPUT, j, k, system->input[j].name);
	for (int j = 0; j < wanted->phi_weights; j++)
		for (int e = 0; e < system->force_columns; e++)
			table->phi_weight[j][i * system->force_columns + e] =
				is_immediate(&wanted->phi_weight[j])
					? immediate(f, &wanted->phi_weight[j], e)
					: number_of(f, wanted->two_words, SOUGHT_PHI_WEIGHT, j, e,
						    format("remainder %d", e + 1));
	for (f->segment = 0; f->segment < system->segments; f->segment++)
		for (int l = 0, column = 0; l < system->loads; l++) {
			bool known = f->segment > 0 && same_forces(system, l, f->segment - 1, f->segment);
			for (int k = 0; k < system->load[l].columns; k++, column++) {
				struct coefficient *here = &table->load[(f->segment * n + i) * columns + column];
				*here = known ? here[-n * columns]
					      : number_of(f, wanted->two_words, SOUGHT_LOAD, l, k,
							  column_text(&system->load[l], k));
			}
		}
}

static struct table *table_new(const struct linear *system, const struct wanted *wanted)
{
	struct table *table = NEW(struct table);
	size_t n = (size_t)system->states;
	table->states = system->states;
	table->columns = load_columns(system);
	table->inputs = input_columns(system);
	table->force_columns = system->force_columns;
	table->wanted = wanted;
	size_t coordinates = (size_t)system->n;
	table->Phi = wanted->Phi ? ARRAY(struct coefficient, n * n) : NULL;
	table->increment = wanted->increments ? ARRAY(struct coefficient, n * n) : NULL;
	table->drift = wanted->mass ? ARRAY(struct coefficient, coordinates * coordinates) : NULL;
	table->kick = wanted->mass ? ARRAY(struct coefficient, coordinates * coordinates) : NULL;
	table->load = ARRAY(struct coefficient, (size_t)system->segments * n * (size_t)table->columns);
	table->input = ARRAY(struct coefficient, n * (size_t)table->inputs);
	table->phi_weight = ARRAY(struct coefficient *, wanted->phi_weights);
	for (int k = 0; k < wanted->phi_weights; k++)
		table->phi_weight[k] = ARRAY(struct coefficient, n * (size_t)system->force_columns);
	return table;
}

static void add_exponential(struct filling *f, mpq_srcptr fraction)
{
	mpq_ptr tau = rationals(1)[0];
	mpq_mul(tau, fraction, f->model->h);
	for (int i = 0; i < f->exponentials; i++)
		if (mpq_equal(f->exponential[i].tau, tau))
			return;
	*MORE(f->exponential, f->exponentials) =
		(struct exponential){ tau, ARRAY(struct taylor *, f->system->segments) };
}

static void plan_exponentials(struct filling *f, int count, const struct wanted *wanted)
{
	for (int t = 0; t < count; t++) {
		add_exponential(f, wanted[t].fraction);
		for (int k = 0; k < wanted[t].phi_weights; k++)
			for (int j = 0; j < wanted[t].phi_weight[k].parts; j++)
				add_exponential(f, wanted[t].phi_weight[k].part[j].fraction);
	}
}

/* A series of a forcing term that oscillates so often in a step has no end; residues are slow beyond a few states. */
static void check_forcings(const struct filling *f)
{
	for (int l = 0; l < f->system->loads; l++) {
		const long bits = rational_bits(f->system->load[l].forcing->w) + rational_bits(f->model->h);
		if (bits > LIMIT_TURNS && load_acts(f->system, &f->system->load[l]))
			error(f->model->request.at.step, NULL,
			      "the frequency of %s times the step is beyond the limit of 2^%d for models of more than "
			      "%d states",
			      column_text(&f->system->load[l], 0), LIMIT_TURNS, LIMIT_RESIDUE_STATES);
	}
}

static int longest_chain(int count, const struct wanted *wanted)
{
	int powers = 0;
	for (int t = 0; t < count; t++)
		for (int k = 0; k < wanted[t].phi_weights; k++)
			for (int j = 0; j < wanted[t].phi_weight[k].parts; j++)
				powers = wanted[t].phi_weight[k].part[j].powers > powers
						 ? wanted[t].phi_weight[k].part[j].powers
						 : powers;
	return powers;
}

static struct table **tables_of_block(struct filling *f, int count, const struct wanted *wanted)
{
	const struct linear *system = f->system;
	struct table **table = ARRAY(struct table *, count);
	size_t room = (size_t)system->states + (size_t)system->n + 8;
	f->entry = ARRAY(struct entry, room);
	f->response = ARRAY(struct started, 4);
	for (size_t i = 0; i < room; i++)
		mpq_init(f->entry[i].weight);
	for (size_t i = 0; i < 4; i++)
		mpq_init(f->response[i].start);
	mpq_init(f->tau);
	f->layout = layout_of_segments(system, longest_chain(count, wanted));
	if (system->states > LIMIT_RESIDUE_STATES) {
		check_forcings(f);
		plan_exponentials(f, count, wanted);
	}
	for (int t = 0; t < count; t++) {
		f->wanted = &wanted[t];
		table[t] = table_new(system, f->wanted);
		mpq_mul(f->tau, f->wanted->fraction, f->model->h);
		for (f->row = 0; f->row < system->states; f->row++) {
			progress("factors of the step, row", t * system->states + f->row, count * system->states);
			fill_row(f, table[t]);
		}
		if (f->wanted->mass)
			fill_kicks(f, table[t]);
	}
	progress_end();
	return table;
}

static void mark_zero(struct coefficient *c, size_t count)
{
	for (size_t i = 0; c && i < count; i++)
		c[i].zero = true;
}

static void scatter_square(const struct block *block, int n, const struct coefficient *part, struct coefficient *full)
{
	int m = block->system.n;
	for (int i = 0; part && i < m; i++)
		for (int j = 0; j < m; j++)
			full[block->coord[i] * n + block->coord[j]] = part[i * m + j];
}

/* Puts rows and columns of a block to their places in the full matrix; entries between blocks stay exactly 0. */
static void scatter(const struct block *block, const struct table *part, int segments, struct table *table)
{
	for (int i = 0; i < part->states; i++) {
		int row = block->state[i];
		for (int j = 0; part->Phi && j < part->states; j++)
			table->Phi[row * table->states + block->state[j]] = part->Phi[i * part->states + j];
		for (int j = 0; part->increment && j < part->states; j++)
			table->increment[row * table->states + block->state[j]] = part->increment[i * part->states + j];
		for (int s = 0; s < segments; s++)
			for (int k = 0; k < table->columns; k++)
				table->load[(s * table->states + row) * table->columns + k] =
					part->load[(s * part->states + i) * part->columns + k];
		for (int k = 0; k < table->inputs; k++)
			table->input[row * table->inputs + k] = part->input[i * part->inputs + k];
		for (int k = 0; k < table->wanted->phi_weights; k++)
			for (int e = 0; e < table->force_columns; e++)
				table->phi_weight[k][row * table->force_columns + e] =
					part->phi_weight[k][i * part->force_columns + e];
	}
}

struct table **tables_of(const struct model *model, struct resolvent *resolvent, const struct linear *system, int count,
			 const struct wanted *wanted)
{
	struct block *block;
	int blocks = blocks_of(system, &block);
	struct filling full = { .model = model,
				 .system = system,
				 .resolvent = resolvent,
				 .state_name = model->names.state };
	if (blocks == 1)
		return tables_of_block(&full, count, wanted);
	struct table **table = ARRAY(struct table *, count);
	for (int t = 0; t < count; t++) {
		table[t] = table_new(system, &wanted[t]);
		mark_zero(table[t]->Phi, (size_t)system->states * (size_t)system->states);
		mark_zero(table[t]->increment, (size_t)system->states * (size_t)system->states);
		mark_zero(table[t]->kick, (size_t)system->n * (size_t)system->n);
		mark_zero(table[t]->drift, (size_t)system->n * (size_t)system->n);
	}
	for (int b = 0; b < blocks; b++) {
		struct filling part = { .model = model,
					.system = &block[b].system,
					.resolvent = resolvent_of(&block[b].system) };
		part.state_name = ARRAY(const char *, block[b].system.states);
		part.coord = block[b].coord;
		for (int i = 0; i < block[b].system.states; i++)
			part.state_name[i] = model->names.state[block[b].state[i]];
		struct table **made = tables_of_block(&part, count, wanted);
		for (int t = 0; t < count; t++) {
			scatter(&block[b], made[t], system->segments, table[t]);
			scatter_square(&block[b], system->n, made[t]->kick, table[t]->kick);
			scatter_square(&block[b], system->n, made[t]->drift, table[t]->drift);
		}
	}
	return table;
}
