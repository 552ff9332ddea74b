/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inputs as they were some time ago, u(t - d). Each is an input of the model, to which a ring of past samples gives
 * what it is. Where a delay is no multiple of the step, the model is stepped by parts of it of which all delays are
 * multiples: in such a part a delayed input is held, or a ramp, like any other, and nothing is approximated. */
#include "building.h"
#include "capability.h"

static const struct symbol *next_delayed(const struct symbol *s)
{
	while (s && !s->delayed)
		s = s->next;
	return s;
}

/* Those that the text declares come first, as the caller gives them. */
static void number_inputs(struct spec *spec)
{
	int index = 0;
	for (int delayed = 0; delayed < 2; delayed++)
		for (struct symbol *s = spec->first; s; s = s->next)
			if (s->kind == SYMBOL_INPUT && (s->delayed != NULL) == delayed)
				s->index = index++;
}

/* d of t - d, by the spec's values of params */
static void evaluate_delay(struct building *b, const struct symbol *s, mpq_ptr d)
{
	struct collector own = b->collector;
	own.params = PARAMS_VALUES;
	struct value *value = collect(&own, s->when);
	mpq_srcptr zero = rationals(1)[0];
	const struct basis time =
		{ .kind = BASIS_FORCING, .forcing = forcing_of(&b->collector, zero, zero, zero), .power = 1 };
	const struct form *rest = NULL;
	if (value->rows == 1 && value->columns == 1)
		rest = form_difference(form_unit(time), value->cell[0]);
	if (!rest || !is_constant(rest))
		error(s->when->start, format("%s(t - 0.25), with a constant", s->delayed->name),
		      "an input is delayed by a constant time");
	constant_value(&b->collector, rest, d);
	if (mpq_sgn(d) < 0)
		error(s->when->start, NULL, "the delay is below 0: what %s will be is not known", s->delayed->name);
	if (s->hold > 1)
		error(s->at, "held, or hold first",
		      "the delay of an input that is a polynomial of degree %d is not built", s->hold);
}

struct delaying {
	struct building *b;
	const struct symbol *symbol;
	mpq_ptr d;
};

static void evaluate_one(void *context)
{
	struct delaying *work = context;
	evaluate_delay(work->b, work->symbol, work->d);
}

/* Parts of the step of which all delays are multiples */
static void find_parts(struct delays *delays, const mpq_t *d)
{
	RATIONAL ratio = ZERO;
	INTEGER parts = INTEGER_ZERO;
	mpz_set_ui(parts, 1);
	for (int i = 0; i < delays->count; i++) {
		mpq_div(ratio, d[i], delays->h);
		mpz_lcm(parts, parts, mpq_denref(ratio));
		if (mpz_cmp_ui(parts, LIMIT_DELAY_PARTS) > 0)
			error(delays->delay[i].symbol->when->start, "another step, or another delay, would do",
			      "delays and step have no common part that is at least 1/%d of the step",
			      LIMIT_DELAY_PARTS);
	}
	delays->parts = (int)mpz_get_ui(parts);
	for (int i = 0; i < delays->count; i++) {
		mpq_div(ratio, d[i], delays->h);
		if (mpq_cmp_ui(ratio, LIMIT_DELAY, 1) > 0)
			error(delays->delay[i].symbol->when->start, "past samples are kept, one for each step",
			      "the delay is longer than the limit of %d steps", LIMIT_DELAY);
		mpz_set_ui(parts, (unsigned long)delays->parts);
		mpz_mul(parts, parts, mpq_numref(ratio));
		mpz_divexact(parts, parts, mpq_denref(ratio));
		delays->delay[i].back = (int)mpz_get_si(parts);
		delays->most = delays->delay[i].back > delays->most ? delays->delay[i].back : delays->most;
	}
}

static void check_request(const struct building *b, const struct symbol *s)
{
	const struct facts facts = { .delays = true };
	const bool requested[CAPABILITIES] = { [CAN_SOLUTION] = b->request->solution,
					   [CAN_NEED] = b->spec->required.needs > 0 };
	for (int k = 0; k < CAPABILITIES; k++)
		if (requested[k])
			error(s->at, NULL, "%s%s", words_before(k), objection_to(k, &facts, b->model).why);
	if (mpq_sgn(b->model->h) == 0)
		error(s->at, NULL, "a delayed input needs a step that is given");
}

static void build_delays(void *context)
{
	struct building *b = context;
	struct spec *spec = b->spec;
	struct delays *delays = NEW(struct delays);
	const struct symbol *s = next_delayed(spec->first);
	check_request(b, s);
	number_inputs(spec);
	delays->name = b->model->name;
	delays->delay = ARRAY(struct delay, spec->count.inputs);
	mpq_init(delays->h);
	mpq_set(delays->h, b->model->h);
	mpq_t *d = rationals(spec->count.inputs);
	bool good = true;
	for (; s; s = next_delayed(s->next)) {
		struct delaying work = { b, s, d[delays->count] };
		good = statement_guard(evaluate_one, &work) && good;
		delays->delay[delays->count++] = (struct delay){ .symbol = s };
	}
	if (!good)
		abandon();
	find_parts(delays, d);
	delays->inputs = spec->count.inputs - delays->count;
	b->model->delays = delays;
	b->model->name = format("%s_core", delays->name);
	RATIONAL parts = ZERO;
	mpq_set_si(parts, delays->parts, 1);
	mpq_div(b->model->h, b->model->h, parts);
}

/* With other values of params, which move no delay */
static void keep_delays(struct building *b)
{
	number_inputs(b->spec);
	b->model->delays = NEW(struct delays);
}

void find_delays(struct building *b)
{
	if (next_delayed(b->spec->first) && b->request->again.tunable)
		keep_delays(b);
	else if (next_delayed(b->spec->first) && !diagnostics_errors())
		statement_guard(build_delays, b);
}

const char *outer_name(const struct model *model)
{
	return model->delays ? model->delays->name : model->name;
}

int outer_inputs(const struct model *model)
{
	return model->delays ? model->delays->inputs : model->spec->count.inputs;
}

mpq_srcptr outer_step(const struct model *model)
{
	return model->delays ? model->delays->h : model->h;
}
