/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * How the equations follow from tunable params, as find_tuning says it, against models built at other values, exactly:
 *
 *     equations [-n RANDOM] [-s SEED] [-v] MODEL.spec ...
 *
 * At random rational values the record gives A in x' = A x, x the states, load states and inputs; its rows of highest
 * derivatives put into the equations M q'' + C q' + K q = loads + inputs of the model that -D makes with these values,
 * they have to fulfil them, and rows of outputs have to be equal. Nothing is rounded.  Random specs write their factors
 * with nested params, matrices, lets and sketches; none may be refused.
 */
#include "algebra.h"
#include "cases.h"
#include "drawn.h"
#include "model/tunable/tuning.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { POINTS = 3 };

static bool verbose;
static int complaints;

static void complain(const char *what)
{
	if (complaints++ < 10)
		printf("# %s\n", what);
}

/* ---- random specs ---- */

static int pick(int n)
{
	return (int)below((unsigned)n);
}

static const char *name_of(int tunables)
{
	return format("p%d", pick(tunables));
}

/* A factor: few products, few powers */
static const char *factor(int tunables)
{
	switch (pick(10)) {
	case 0: return format("%d", 1 + pick(9));
	case 1: return format("%s*%s", name_of(tunables), name_of(tunables));
	case 2: return format("(%s + %d.5)", name_of(tunables), pick(4));
	case 3: return format("%d/%s", 1 + pick(5), name_of(tunables));
	case 4: return format("%s/%s", name_of(tunables), name_of(tunables));
	case 5: return format("(%s - 0.25*%s)", name_of(tunables), name_of(tunables));
	case 6: return format("%s^2", name_of(tunables));
	case 7: return format("d%d", pick(2));
	case 8: return format("%s*d1", name_of(tunables));
	default: return name_of(tunables);
	}
}

static const char *mass(int tunables)
{
	return pick(3)   ? format("%d", 1 + pick(4))
		   : pick(2) ? name_of(tunables)
					 : format("(%s + %s)", name_of(tunables), name_of(tunables));
}

static const char *random_text(uint64_t seed)
{
	random_state = seed * UINT64_C(0x9e3779b97f4a7c15) + 7;
	pick(2);
	const int n = 1 + pick(3), tunables = 1 + pick(4);
	const char *text = "model any\nparam p0 = 2", *coords = "coord x1", *list = "tunable p0";
	for (int k = 1; k < tunables; k++) {
		text = format("%s, p%d = %d.%d", text, k, 1 + pick(20), pick(10));
		list = format("%s, p%d", list, k);
	}
	for (int i = 1; i < n; i++)
		coords = format("%s, x%d", coords, i + 1);
	coords = format("%s, z[2]", coords);
	text = format("%s\nparam d0 = 3*%s, d1 = d0 + %s/2\nmatrix A = [%s, 1; 0, %s]\nmatrix B = A*A + [d0, 0; 1, "
				  "2]\n%s\ninput u\ninput v hold first\n",
				  text, name_of(tunables), name_of(tunables), name_of(tunables), name_of(tunables),
						coords);
	text = format("%slet e = %s*x1 - %s*x%d'\n%s\n", text, name_of(tunables), name_of(tunables), n, list);
	text = format("%soutput o1 = %s*x1 + %s*x%d'\noutput o2 = x1'' - %s*t\noutput o3 = e + %s*u - %s*v'\n", text,
				  factor(tunables), factor(tunables), n, factor(tunables), name_of(tunables),
						name_of(tunables));
	for (int i = 1; i <= n; i++) {
		text = format("%s%s*x%d''", text, mass(tunables), i);
		if (n > 1 && pick(3) == 0)
			text = format("%s + 0.3*%s*x%d''", text, mass(tunables), i % n + 1);
		for (int j = 1; j <= n; j++) {
			if (pick(2))
				text = format("%s + %s*x%d", text, factor(tunables), j);
			if (pick(3) == 0)
				text = format("%s - %s*x%d'", text, factor(tunables), j);
		}
		text = format("%s = %s", text, pick(3) ? "0" : "e");
		switch (pick(5)) {
		case 0: text = format("%s + %s*cos(%d*t)\n", text, factor(tunables), 1 + pick(3)); break;
		case 1: text = format("%s + %s*u - v*%s\n", text, factor(tunables), factor(tunables)); break;
		case 2: text = format("%s + (t < 1 ? %s*t : 3)\n", text, factor(tunables)); break;
		case 3: text = format("%s + %s*v'\n", text, name_of(tunables)); break;
		default: text = format("%s + exp(-t)*%s\n", text, factor(tunables));
		}
	}
	if (pick(2))
		text = format("%s%sz'' + %s*A*z' + B*z = [%s; 1]*sin(2*t)\n", text, pick(2) ? "A*" : "",
				factor(tunables),
					  factor(tunables));
	else
		text = format("%sz'' + B*z = 0\n", text);
	if (pick(3) == 0)
		text = format("%sspring %s between x1, ground\ndamper %s between x1, %s\n", text, factor(tunables),
					  name_of(tunables), n == 1 ? "ground" : "x2");
	return format("%sstep 0.01\n", text);
}

/* ---- comparing ---- */

static struct model *model_of(const char *text, const struct spec *tunables, const mpq_t *values)
{
	struct request *request = NEW(struct request);
	for (int k = 0; tunables && k < tunables->tuned.count - tunables->tuned.derived; k++)
		definitions_add(format("%s=%s", tunables->tuned.tunable[k].symbol->name,
				mpq_get_str(NULL, 10, values[k])),
						&request->definitions);
	struct spec *spec = spec_of("spec", text);
	struct model *model = spec ? model_build(spec, request) : NULL;
	return model && !tunables ? find_tuning(model, request) : model;
}

static void part_at(const struct traced_part *part, mpq_t *value, mpq_ptr result)
{
	mpq_set(result, part->number < 0 ? part->constant : value[part->number]);
	if (part->negative)
		mpq_neg(result, result);
}

/* A at these values, then the rows of outputs. NULL: a divisor is 0 */
static mpq_t *rows_at(const struct tuning *t, const mpq_t *values)
{
	const int size = t->x.size;
	mpq_t *number = rationals((size_t)t->numbers + 1), *value = rationals((size_t)((size + t->all.rows) * size)),
			a, b;
	mpq_inits(a, b, NULL);
	bool *divided = ARRAY(bool, (size_t)t->numbers + 1);    /* by 0, or made of what is */
	for (int i = 0; i < t->numbers; i++) {
		const struct traced *n = &t->number[i];
		if (n->op == TRACED_GIVEN) {
			(n->a.negative ? mpq_neg : mpq_set)(number[i], values[n->a.number]);
			continue;
		}
		part_at(&n->a, number, a);
		part_at(&n->b, number, b);
		divided[i] = (n->a.number >= 0 && divided[n->a.number]) || (n->b.number >= 0 && divided[n->b.number]) ||
					 (n->op == TRACED_QUOTIENT && mpq_sgn(b) == 0);
		if (!divided[i])
			(n->op == TRACED_SUM ? mpq_add : n->op == TRACED_PRODUCT ? mpq_mul : mpq_div)(number[i], a, b);
	}
	const struct tuned_equations *of[] = { t->system, &t->all };
	for (int k = 0; k < 2; k++)
		for (const struct tuned_entry *entry = of[k]->entry; entry < of[k]->entry + of[k]->entries; entry++) {
			if (entry->value.number >= 0 && divided[entry->value.number])
				return NULL;
			part_at(&entry->value, number, value[(k * size + entry->row) * size + entry->column]);
		}
	return value;
}

/* Left side of equation i in a column, highest derivatives from `value`; and its right side */
static void sides(const struct linear *system, const struct tuning *t, const mpq_t *value, int i, int column,
				  mpq_ptr left)
{
	const int n = system->n;
	mpq_set_ui(left, 0, 1);
	for (int j = 0; j < n; j++)
		add_product(left, (system->velocity[j] >= 0 ? system->M : system->C)[i * n + j],
					value[highest_state(system, j) * t->x.size + column], false);
	if (column < system->states)
		mpq_add(left, left, (column < n ? system->K : system->C)[i * n + system->coord[column]]);
}

static void compare(mpq_srcptr found, mpq_srcptr expected, const char *what, int row, int column)
{
	if (!mpq_equal(found, expected))
		complain(format("%s %d, column %d: found %s, expected %s", what, row, column,
				mpq_get_str(NULL, 10, found),
						mpq_get_str(NULL, 10, expected)));
}

/* The force on equation i in a column behind the states, and the factor of an output there */
static mpq_srcptr force_at(const struct linear *system, int column, int i, const struct output *output)
{
	column -= system->states;
	for (int s = 0; s < system->segments; s++)
		for (int l = 0; l < system->loads; l++)
			for (int k = 0; k < system->load[l].columns; k++)
				if (column-- == 0)
					return output ? output->load[l][k * system->segments + s]
								  : system->load[l].force[k][s * system->n + i];
	for (int u = 0; u < system->inputs; u++)
		for (int k = 0; k < (system->input[u].hold ? 2 : 1); k++)
			if (column-- == 0)
				return output ? output->input[k][u] : system->input[u].force[k][i];
	return NULL;
}

static void compare_model(const struct model *there, const struct tuning *t, const mpq_t *value)
{
	const struct linear *system = &there->system;
	const int size = t->x.size;
	mpq_t left, zero;
	mpq_inits(left, zero, NULL);
	for (int i = 0; i < system->n; i++)
		for (int j = 0; j < t->x.size; j++) {
			sides(system, t, value, i, j, left);
			compare(left, j < system->states ? zero : force_at(system, j, i, NULL), "equation", i, j);
		}
	for (int l = 0; l < system->loads; l++)
		if (t->frequency[l])
			compare(value[(t->x.load[l] + 1) * size + t->x.load[l]], system->load[l].forcing->w,
					"frequency of load", l,
					0);
	for (int o = 0; o < there->outputs; o++)
		for (int j = 0; j < t->x.size && t->output[o] >= 0; j++)
			compare(value[(size + t->output[o]) * size + j],
					j < system->states ? there->output[o].state[j] : force_at(system, j, 0,
							&there->output[o]),
					there->output[o].name, o, j);
}

/* An output that is said to depend on no param */
static void compare_fixed(const struct model *a, const struct model *b, const struct tuning *t)
{
	for (int o = 0; o < a->outputs; o++)
		for (int j = 0; j < t->x.size && t->output[o] < 0; j++)
			compare(j < a->system.states ? a->output[o].state[j] : force_at(&a->system, j, 0,
					&a->output[o]),
					j < a->system.states
							? b->output[o].state[j] : force_at(&b->system, j, 0,
									&b->output[o]),
					"fixed output", o, j);
}

/* Some frequency is not above 0: the model there has turned its sine around, and the target refuses it. */
static bool turned(const struct model *model, const struct tuning *t, const mpq_t *value)
{
	for (int l = 0; l < model->system.loads; l++)
		if (t->frequency[l] && mpq_sgn(value[(t->x.load[l] + 1) * t->x.size + t->x.load[l]]) <= 0)
			return true;
	return false;
}

/* Elements stand where masses are positive: those that are below 0 there alone have another side. */
static bool same_sides(const struct equations *a, const struct equations *b, size_t n)
{
	return memcmp(a->owner, b->owner, n * sizeof *a->owner) == 0 &&
		   memcmp(a->reversed, b->reversed, n * sizeof *a->reversed) == 0;
}

static int try_text(const char *text)
{
	const struct model *model = model_of(text, NULL, NULL);
	if (!model) {
		printf("# %s\n", first_line(diagnostics()));
		return 1;
	}
	const struct tuning *t = model->params.tuning;
	for (int p = 0; p < POINTS; p++) {
		mpq_t *values = rationals((size_t)t->params);
		for (int k = 0; k < t->given; k++) {
			mpq_set_si(values[k], (1 + pick(2000)) * (pick(4) ? 1 : -1), (unsigned)(1 + pick(60)));
			mpq_canonicalize(values[k]);
		}
		const struct model *there = model_of(text, model->spec, (const mpq_t *)values);
		if (!there || !same_sides(&there->equations, &model->equations, (size_t)model->n))
			continue;                           /* singular there, or a load has gone */
		for (int k = t->given; k < t->params; k++)
			param_value(there->spec->tuned.tunable[k].symbol, values[k]);
		mpq_t *value = rows_at(t, (const mpq_t *)values);
		if (!value)
			complain("a divisor is 0, but the model there is none");
		else if (there->system.loads == model->system.loads && !turned(model, t, (const mpq_t *)value))
			compare_model(there, t, (const mpq_t *)value);
		compare_fixed(model, there, t);
	}
	return complaints > 0;
}

/* ---- the whole ---- */

static bool try_case(void *text)
{
	return try_text(text) == 0;
}

static void run(const char *name, const char *text)
{
	if (!run_case(name, 0, try_case, (void *)text) || verbose)
		show_spec(text);
}

int main(int argc, char **argv)
{
	unsigned long count = 100, seed = 1;
	memory_open();
	take_options(argc, argv, (struct command_option[]){
		{ 'n', .number = &count }, { 's', .number = &seed }, { 'v', .on = &verbose }, { 0 }
	});
	for (int i = optind; i < argc; i++)
		run(base_name(argv[i]), read_text(argv[i]));
	for (unsigned long i = 0; i < count; i++)
		run(format("random model %lu", seed + i), random_text(seed + i));
	printf("1..%d\n", cases_reported());
	memory_close();
	return cases_failed() > 0;
}
