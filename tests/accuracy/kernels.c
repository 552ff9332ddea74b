/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * Every number of the schemes that leave something over, against the judge, bit for bit: the transfer matrices e^{A h}
 * and e^{A h/2}, the load columns of every segment of time and the input columns at every fraction of the step, and
 * what multiplies the remainder, each combination rounded once.  A number carries the mark of zero if and only if it is
 * zero.
 *
 *     kernels [-n RANDOM] [-l LARGE] [-e EVERY] [-s SEED] [-w] [-v] MODEL.spec ...
 *
 * EVERY: of the specs that stand here, each so many-th.
 * Shared with the generator: its parser, the matrices M, C, K, loads and inputs that it reads from a spec, the C and K
 * of each operator, and which equations have a remainder.  From there on the judge has its own algebra and its own list
 * of what each scheme needs, after Cox and Matthews 2002 and Liu, Wang, Li and Yi 2022.  Each case runs in a process of
 * its own.
 */
#include "kernels.h"

#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

enum { LONGEST_CASE = 300, MISMATCHES_SHOWN = 10, LARGE_STATES = 20, LARGE_STRIDE = 7 };

static const rlim_t LARGEST_CASE = (rlim_t)4 << 30;     /* bytes */

static bool verbose, whole;             /* whole: large models too are compared whole */

/* ---- one case: what is compared now, and what went wrong so far ---- */

struct tried trial = { .scheme = "none", .table = "none", .name = "none" };

void complain(const char *what, const char *message)
{
	if (trial.failed++ < MISMATCHES_SHOWN)
		printf("# %s%s, operator %d, segment %d, table %s, %s%s: %s\n", trial.scheme,
			   trial.loads_left ? ", loads left" : "", trial.operator, trial.segment, trial.table,
				trial.name, what,
			   message);
}

/* ---- what each scheme needs, written from the papers ---- */

struct fraction { long p; unsigned long q; };
struct phi_weight_term { /* tau = f h: tau phi1(A tau), and where f = 1 also h phi2(A h), h phi3(A h), times these */
	struct fraction f;
	long phi[3];
};
struct scheme_table {
	enum scheme scheme;
	struct fraction table;              /* at which time it stands */
	const char *name;
	int terms;
	struct phi_weight_term term[2];
};

static const struct scheme_table definitions[] = {
	{ SCHEME_PL, { 1, 1 }, "p1", 1, { { { 1, 1 }, { 1, 0, 0 } } } },
	{ SCHEME_ETD1, { 1, 1 }, "p1", 1, { { { 1, 1 }, { 1, 0, 0 } } } },
	{ SCHEME_ETDRK2, { 1, 1 }, "p1", 1, { { { 1, 1 }, { 1, 0, 0 } } } },
	{ SCHEME_ETDRK2, { 1, 1 }, "p2", 1, { { { 1, 1 }, { 0, 1, 0 } } } },
	{ SCHEME_ETDRK4, { 1, 2 }, "q1", 1, { { { 1, 2 }, { 1, 0, 0 } } } },
	{ SCHEME_ETDRK4, { 1, 1 }, "c0", 2, { { { 1, 1 }, { 1, 0, 0 } }, { { 1, 2 }, { -2, 0, 0 } } } },
	{ SCHEME_ETDRK4, { 1, 1 }, "b1", 1, { { { 1, 1 }, { 1, -3, 4 } } } },
	{ SCHEME_ETDRK4, { 1, 1 }, "b2", 1, { { { 1, 1 }, { 0, 2, -4 } } } },
	{ SCHEME_ETDRK4, { 1, 1 }, "b3", 1, { { { 1, 1 }, { 0, -1, 4 } } } },
};
enum { SCHEME_TABLES = sizeof definitions / sizeof *definitions };

/* Nodes and weights; those of weight 0 are not computed. */
static const struct { int nodes; struct fraction c[4], weight[4]; } quadratures[SCHEMES] = {
	[SCHEME_NC2] = { 3, { { 0, 1 }, { 1, 2 }, { 1, 1 } }, { { 1, 6 }, { 2, 3 }, { 1, 6 } } },
	[SCHEME_NC3] = { 4, { { 0, 1 }, { 1, 3 }, { 2, 3 }, { 1, 1 } }, { { 1, 8 }, { 3, 8 }, { 3, 8 }, { 1, 8 } } },
	[SCHEME_DQ4] = { 4, { { 1, 4 }, { 1, 2 }, { 3, 4 }, { 1, 1 } }, { { 2, 3 }, { -1, 3 }, { 2, 3 }, { 0, 1 } } },
	[SCHEME_BM3] = { 4, { { 0, 1 }, { 1, 4 }, { 3, 4 }, { 1, 1 } }, { { 1, 18 }, { 4, 9 }, { 4, 9 }, { 1, 18 } } },
};

static void set_fraction(mpq_ptr q, struct fraction f)
{
	mpq_set_si(q, f.p, f.q);
	mpq_canonicalize(q);
}

/* Unit chains: tau^{k+1} phi_{k+1}(A tau) B from u_k; at tau = h that is h^k times h phi_{k+1}. */
static struct column defined_column(struct judge *judge, const struct scheme_table *d, size_t force_column)
{
	struct column column = { 0 };
	mpq_t q, power;
	mpq_inits(q, power, NULL);
	for (int t = 0; t < d->terms; t++) {
		set_fraction(q, d->term[t].f);
		struct part *part = add_part(judge, &column, q);
		mpq_set_ui(power, 1, 1);
		for (size_t k = 0; k < 3; k++) {
			mpq_set_si(q, d->term[t].phi[k], 1);
			mpq_div(part->w[judge->plant.force_column_at + 3 * force_column + k], q, power);
			mpq_mul(power, power, judge->h);
		}
	}
	mpq_clears(q, power, NULL);
	return column;
}

/* h weight e^{A (1 - c) h} B */
static struct column weighted_column(struct judge *judge, struct fraction c, struct fraction weight,
				     size_t force_column)
{
	const struct plant *p = &judge->plant;
	struct column column = { 0 };
	mpq_t q;
	mpq_init(q);
	set_fraction(q, (struct fraction){ (long)c.q - c.p, c.q });
	struct part *part = add_part(judge, &column, q);
	set_fraction(q, weight);
	mpq_mul(q, q, judge->h);
	for (size_t i = 0; i < p->states; i++)
		mpq_mul(part->w[i], p->B[force_column * p->size + i], q);
	mpq_clear(q);
	return column;
}

/* ---- tables ---- */

/* Of a large model every seventh column */
static bool is_sampled(const struct judge *judge, size_t column)
{
	return whole || judge->plant.states <= LARGE_STATES || column % LARGE_STRIDE == 0;
}

static void compare_Phi(const struct model *model, struct judge *judge, const struct table *table)
{
	const size_t states = judge->plant.states;
	for (size_t j = 0; j < states; j++) {
		struct column column = { 0 };
		if (!is_sampled(judge, j))
			continue;
		struct part *part = add_part(judge, &column, table->wanted->fraction);
		mpq_set_ui(part->w[j], 1, 1);
		if (judge->plant.held)
			mpq_set_ui(part->w[states + j], 1, 1);
		trial.name = format("factor of %s", model->names.state[j]);
		compare_column(model, judge, &column, table->Phi + j, states);
	}
}

static void compare_loads(const struct model *model, struct judge *judge, const struct table *table)
{
	const size_t loads = judge->plant.loads;
	for (size_t j = 0; j < loads; j++) {
		struct column column = { 0 };
		mpq_set_ui(add_part(judge, &column, table->wanted->fraction)->w[judge->plant.load_at + j], 1, 1);
		trial.name = format("factor of load column %zu", j);
		compare_column(model, judge, &column,
			table->load + (size_t)trial.segment * judge->plant.states * loads + j,
					   loads);
	}
}

/* A ramp over the whole step, u0 at its start and u1 at its end: u = u0, u' = (u1 - u0)/h */
static void compare_inputs(const struct model *model, struct judge *judge, const struct table *table)
{
	const size_t inputs = judge->plant.inputs;
	for (size_t u = 0, at = 0; u < (size_t)model->system.inputs; u++)
		for (int end = 0; end <= model->system.input[u].hold; end++, at++) {
			struct column column = { 0 };
			mpq_t *w = add_part(judge, &column, table->wanted->fraction)->w +
				judge->plant.input_at + at - (size_t)end;
			if (!end)
				mpq_set_ui(w[0], 1, 1);
			if (model->system.input[u].hold)
				mpq_inv(w[1], judge->h);
			if (model->system.input[u].hold && !end)
				mpq_neg(w[1], w[1]);
			trial.name = format("factor of input %s%s", model->system.input[u].name,
				end ? ", its end" : "");
			compare_column(model, judge, &column, table->input + at, inputs);
		}
}

static void compare_phi_weight(const struct model *model, const struct judge *judge, struct column *column,
						   const struct table *table, int phi_weight, size_t force_column)
{
	trial.name = format("%s of channel %zu", table->wanted->phi_weight[phi_weight].name, force_column + 1);
	compare_column(model, judge, column, table->phi_weight[phi_weight] + force_column, judge->plant.force_columns);
}

static const struct scheme_table *definition_of(enum scheme scheme, const struct wanted *wanted, const char *name)
{
	for (int i = 0; i < SCHEME_TABLES; i++)
		if (definitions[i].scheme == scheme && strcmp(definitions[i].name, name) == 0 &&
			mpq_cmp_si(wanted->fraction, definitions[i].table.p, definitions[i].table.q) == 0)
			return &definitions[i];
	return NULL;
}

/* Kernels with a name of their own */
static void compare_defined(const struct model *model, struct judge *judge, const struct table *table)
{
	for (int k = 0; k < table->wanted->phi_weights; k++) {
		const struct scheme_table *d = definition_of(model->scheme, table->wanted,
			table->wanted->phi_weight[k].name);
		if (!d)
			complain(table->wanted->phi_weight[k].name, "no such factor in this scheme");
		for (size_t e = 0; d && e < judge->plant.force_columns; e++) {
			if (!is_sampled(judge, e))
				continue;
			struct column column = defined_column(judge, d, e);
			compare_phi_weight(model, judge, &column, table, k, e);
		}
	}
}

/* ---- the remainder of each node meets the kernel of its node ---- */

static mpq_srcptr node_of_left(const struct program *program, int left)
{
	for (int i = 0; i < program->actions; i++)
		if (program->action[i].kind == ACTION_REMAINDER && program->action[i].target == left)
			return program->node[program->action[i].node];
	return NULL;
}

static const struct action *last_sum(const struct program *program)
{
	const struct action *sum = NULL;
	for (int i = 0; i < program->actions; i++)
		if (program->action[i].kind == ACTION_SUM && program->action[i].target == STAGE_STATE)
			sum = &program->action[i];
	return sum;
}

static void compare_quadrature(const struct model *model, struct judge *judge, const struct step *step,
							   struct table *const *tables)
{
	const struct action *sum = last_sum(step->program);
	int used = 0;
	for (int i = 0; i < quadratures[model->scheme].nodes; i++) {
		const struct fraction c = quadratures[model->scheme].c[i],
			weight = quadratures[model->scheme].weight[i];
		int found = 0;
		for (int k = 0; sum && k < sum->phi_weights; k++) {
			mpq_srcptr node = node_of_left(step->program, sum->phi_weight[k].left);
			if (!node || mpq_cmp_si(node, c.p, c.q) != 0)
				continue;
			found++;
			for (size_t e = 0; e < judge->plant.force_columns; e++) {
				if (!is_sampled(judge, e))
					continue;
				struct column column = weighted_column(judge, c, weight, e);
				trial.table = tables[sum->phi_weight[k].table]->wanted->name;
				compare_phi_weight(model, judge, &column, tables[sum->phi_weight[k].table],
				   sum->phi_weight[k].phi_weight, e);
			}
		}
		used += found;
		if (found != (weight.p != 0))
			complain("", format("node %ld/%lu is used %d times", c.p, c.q, found));
	}
	if (!sum || used != sum->phi_weights)
		complain("", "a node that the scheme has not");
}

/* ---- which tables there are ---- */

static bool has_drive(const struct linear *system)
{
	for (int l = 0; l < system->loads; l++)
		for (int k = 0; k < system->load[l].columns; k++)
			for (int i = 0; i < system->segments * system->n; i++)
				if (mpq_sgn(system->load[l].force[k][i]))
					return true;
	return system->inputs > 0;
}

struct expected_tables {
	int count;
	struct fraction at[8];
};

static void expect_table(struct expected_tables *e, struct fraction f)
{
	for (int i = 0; i < e->count; i++)
		if ((unsigned long)e->at[i].p * f.q == (unsigned long)f.p * e->at[i].q)
			return;
	e->at[e->count++] = f;
}

/* The whole step; its half where stages stand there; where a predictor passes, if there are loads to be carried along.
 */
static struct expected_tables expected_tables(const struct model *model)
{
	struct expected_tables e = { 1, { { 1, 1 } } };
	if (model->scheme == SCHEME_ETDRK4)
		expect_table(&e, (struct fraction){ 1, 2 });
	for (int i = 0; i < quadratures[model->scheme].nodes && has_drive(&model->system); i++) {
		const struct fraction c = quadratures[model->scheme].c[i];
		if (c.p == 0 || quadratures[model->scheme].weight[i].p == 0)
			continue;
		expect_table(&e, (struct fraction){ c.p, 2 * c.q });
		expect_table(&e, c);
	}
	return e;
}

static void check_tables(const struct model *model, const struct step *step, struct table *const *tables)
{
	const struct expected_tables e = expected_tables(model);
	int phi_weights = 0, defined = 0;
	for (int i = 0; i < e.count; i++) {
		int found = 0;
		for (int t = 0; t < step->tables; t++)
			found += mpq_cmp_si(tables[t]->wanted->fraction, e.at[i].p, e.at[i].q) == 0;
		if (found != 1)
			complain("", format("%d tables at %ld/%lu h", found, e.at[i].p, e.at[i].q));
	}
	if (step->tables != e.count)
		complain("", format("%d tables, expected %d", step->tables, e.count));
	for (int t = 0; t < step->tables; t++)
		phi_weights += tables[t]->wanted->phi_weights;
	for (int i = 0; i < SCHEME_TABLES; i++)
		defined += definitions[i].scheme == model->scheme;
	for (int i = 0; i < quadratures[model->scheme].nodes; i++)
		defined += quadratures[model->scheme].weight[i].p != 0;
	if (phi_weights != defined)
		complain("", format("%d factors of remainders, expected %d", phi_weights, defined));
	for (int i = 0; i < step->program->nodes; i++)
		if (step->program->node_table[i] != NONE &&
			!mpq_equal(step->program->node[i], tables[step->program->node_table[i]]->wanted->fraction))
			complain("", format("loads of node %d are those of another time", i));
}

/* ---- one step ---- */

enum { OPERATORS = 8, SEGMENTS = 8 };
static struct judge *judges[2][2][OPERATORS][SEGMENTS]; /* of this case; all schemes but pl have the same */

static struct judge *judge_of(const struct model *model, int which, int segment)
{
	const bool split = model->scheme == SCHEME_PL;
	struct judge **judge = &judges[trial.loads_left][split][which][segment];
	if (*judge)
		return *judge;
	struct judge *made = NEW(struct judge);
	if (!make_plant(&made->plant, model, which, segment, split))
		return NULL;
	const size_t cells = made->plant.size * made->plant.size;
	made->residue = ARRAY(uint64_t, cells);
	for (size_t i = 0; i < cells; i++)
		made->residue[i] = residue(made->plant.A[i]);
	mpq_init(made->h);
	mpq_set(made->h, model->h);
	return *judge = made;
}

static bool has_size(const struct table *table, const struct plant *p)
{
	return (size_t)table->states == p->states && (size_t)table->columns == p->loads &&
		   (size_t)table->inputs == p->inputs && (size_t)table->force_columns == p->force_columns;
}

static void compare_segment(const struct model *model, const struct step *step, int which, int segment)
{
	struct judge *judge = judge_of(model, which, segment);
	trial.operator = which;
	trial.segment = segment;
	for (int t = 0; judge && t < step->tables; t++) {
		const struct table *table = step->branch[which].table[t];
		trial.table = table->wanted->name;
		trial.name = "";
		if (!has_size(table, &judge->plant)) {
			complain("", "wrong size");
			continue;
		}
		compare_loads(model, judge, table);
		if (segment > 0)
			continue;                   /* the rest is the same in every segment */
		if (table->Phi)
			compare_Phi(model, judge, table);
		compare_inputs(model, judge, table);
		if (!quadratures[model->scheme].nodes)
			compare_defined(model, judge, table);
	}
	if (judge && segment == 0 && quadratures[model->scheme].nodes)
		compare_quadrature(model, judge, step, step->branch[which].table);
}

/* The first error that was said; warnings come before it. */
/* What was the first error */
static const char *first_error(void)
{
	const char *error = strstr(diagnostics(), ": error: ");
	return error ? first_line(error + 2) : "no reason was given";
}

/* A step is refused rightly if e^{A h}, or what a load or an input gives, is beyond the range. */
static void check_refusal(const struct model *model)
{
	const char *said = first_error();
	bool overflow = false;
	mpq_t one;
	mpfi_t x;
	mpq_init(one);
	mpq_set_ui(one, 1, 1);
	mpfi_init2(x, 256);
	for (int k = 0; k < model->schedule.operators; k++)
		for (int s = 0; s < model->system.segments; s++) {
			struct judge *judge = judge_of(model, k, s);
			const evaluator_enclosure *E = judge ? enclosure(judge, moment_at(judge, one), 0) : NULL;
			for (size_t i = 0; E && i < judge->plant.states * judge->plant.size; i++) {
				mpfi_set_ui(x, 0);
				add_entry(x, E, i, one);
				overflow =
					overflow || isinf(mpfr_get_d(&x->left, MPFR_RNDN)) ||
						isinf(mpfr_get_d(&x->right, MPFR_RNDN));
			}
		}
	if (!overflow || !strstr(said, "is beyond the range of double"))
		complain("", said);
	trial.compared++;
	trial.refused++;
	mpq_clear(one);
	mpfi_clear(x);
}

static struct model *model_of(const char *scheme)
{
	const struct request request = { .scheme = scheme, .loads_left = trial.loads_left };
	struct model *model = model_build(spec_of(trial.path, trial.spec), &request);
	if (!model)
		complain("not accepted: ", first_error());
	else if (model->remainder.force_columns == 0)
		complain("", "there is no remainder");
	return model && model->remainder.force_columns ? model : NULL;
}

static void try_scheme(const char *scheme, bool loads_left)
{
	trial.scheme = scheme;
	trial.loads_left = loads_left;
	trial.table = "none";
	trial.name = "";
	const struct model *model = model_of(scheme);
	if (!model)
		return;
	if (model->schedule.operators > OPERATORS || model->system.segments > SEGMENTS)
		abort();
	const clock_t start = clock();
	const struct step *step = step_build(model);
	const clock_t built = clock();
	if (!step) {
		check_refusal(model);
		return;
	}
	for (int k = 0; k < model->schedule.operators; k++)
		check_tables(model, step, step->branch[k].table);
	for (int k = 0; k < model->schedule.operators; k++)
		for (int s = 0; s < model->system.segments; s++)
			compare_segment(model, step, k, s);
	if (verbose)
		printf("# %s%s: generator %.2f s, judge %.2f s\n", scheme, loads_left ? ", loads left" : "",
			   (double)(built - start) / CLOCKS_PER_SEC, (double)(clock() - built) / CLOCKS_PER_SEC);
}

static int states_of(void)
{
	const struct model *model = model_of("etd1");
	return model ? model->system.states : 0;
}

/* Loads left over or not: another A has other columns.  Of a large model two schemes will do.  A refusal stays an error
 * for what follows in this process, so it ends the case; pl, whose own terms may grow where the operator does not,
 * comes last. */
static void try_spec(const char *text)
{
	static const struct { const char *scheme; bool loads_left, large;
	} tries[] = {
		{ "etd1", false, false }, { "etdrk2", false, false }, { "etdrk4", false, true },
		{ "nc2", false, false },
		{ "nc3", false, false },  { "dq4", false, false },    { "bm3", false, true },   
		{ "etdrk4", true, false },
		{ "bm3", true, false },   { "pl", false, false },
	};
	trial.spec = text;
	const bool large = states_of() > LARGE_STATES && !whole;
	for (size_t i = 0; i < sizeof tries / sizeof *tries && !trial.refused; i++)
		if (tries[i].large || !large)
			try_scheme(tries[i].scheme, tries[i].loads_left);
}

/* ---- the whole ---- */

static bool try_case(void *text)
{
	setrlimit(RLIMIT_AS, &(struct rlimit){ LARGEST_CASE, LARGEST_CASE });
	try_spec(text);
	if (trial.failed)
		show_spec(trial.spec);
	if (trial.failed > MISMATCHES_SHOWN)
		printf("# %d failures in all\n", trial.failed);
	if (trial.compared == 0)
		puts("# nothing was compared");
	if (verbose)
		printf("# %d numbers compared in %.2f s; steps refused %d, too small to be told from 0: %d\n",
			trial.compared,
			   (double)clock() / CLOCKS_PER_SEC, trial.refused, trial.unsettled);
	return !trial.failed && trial.compared > 0;
}

static void run(const char *name, const char *path, const char *text)
{
	trial.path = path;
	run_case(name, LONGEST_CASE, try_case, (void *)text);
}

int main(int argc, char **argv)
{
	unsigned long random_count = 80, large_count = 5, every = 1, seed = 1;
	memory_open();
	take_options(argc, argv, (struct command_option[]){
		{ 'n', .number = &random_count }, { 'l', .number = &large_count }, { 'e', .number = &every },
		{ 's', .number = &seed }, { 'w', .on = &whole }, { 'v', .on = &verbose }, { 0 }
	});
	printf("1..%lu\n",
		(unsigned long)(argc - optind) + (spec_count + every - 1) / every + random_count + large_count);
	for (int i = optind; i < argc; i++)
		run(base_name(argv[i]), argv[i], read_text(argv[i]));
	for (unsigned long i = 0; i < spec_count; i += every)
		run(specs[i].name, "spec", specs[i].text);
	for (unsigned long i = 0; i < random_count; i++)
		run(format("random model %lu", seed + i), "spec", random_text(seed + i));
	for (unsigned long i = 0; i < large_count; i++)
		run(format("large random model %lu", seed + i), "spec", large_text(seed + i));
	memory_close();
	return cases_failed() > 0;
}
