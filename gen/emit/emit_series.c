/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The coefficients of a series as C, a line for each. What is newest decides how long the next one waits, so it is
 * added last, and enters by its gains (step/newest.c). Lines are made from the last to the first: what none of those
 * after it reads is left out. */
#include "emit/emit.h"

#include <math.h>
#include <string.h>

static const struct expansion *expansion(const struct emitter *e)
{
	return e->step->expansion;
}

static const struct sequence *sequence_of(const struct emitter *e, int sequence)
{
	return &expansion(e)->sequence[sequence];
}

/* ---- names, and which are read ---- */

struct mark {
	bool full, early;           /* read: it, its early part */
	enum { UNKNOWN, NOTHING, SOMETHING } part; /* early part */
};
struct lines {
	struct mark *mark;          /* [sequence][k] */
	bool *helper;               /* per sequence: its inverse, half or choice */
	bool **gain;                /* [sequence][gain] */
	bool trial;                 /* nothing is marked */
	int lines;
	const char **line;          /* from the last to the first */
};

static struct mark *mark_of(const struct emitter *e, int sequence, int k)
{
	return &e->series->mark[sequence * (expansion(e)->order + 1) + k];
}

/* Of the sequences that are no states: a letter that no state's local starts with */
static const char *prefix(const struct emitter *e)
{
	static const char *const letters[] = { "a", "b", "p", "q", "w", "z", "part", "sequence" };
	for (size_t i = 0; i < sizeof letters / sizeof *letters; i++) {
		bool free = true;
		for (int k = 0; k < e->system->states; k++)
			free = free && strncmp(e->local[k], letters[i], strlen(letters[i])) != 0;
		if (free)
			return letters[i];
	}
	return "coefficient_of_sequence_";
}

static const char *base_name(const struct emitter *e, int sequence)
{
	int state = sequence_of(e, sequence)->state;
	return state != NONE ? e->local[state] : format("%s%d", prefix(e), sequence - e->system->states + 1);
}

static const char *name_of(const struct emitter *e, int sequence, int k)
{
	return format("%s_%d", base_name(e, sequence), k);
}

const char *coefficient(const struct emitter *e, int sequence, int k)
{
	if (k > sequence_of(e, sequence)->degree)
		return NULL;
	if (e->series && !e->series->trial)
		mark_of(e, sequence, k)->full = true;
	return name_of(e, sequence, k);
}

static const char *helper_name(const struct emitter *e, int sequence, const char *what)
{
	return format("%s_%s", base_name(e, sequence), what);
}

static const char *helper(const struct emitter *e, int sequence, const char *what)
{
	if (!e->series->trial)
		e->series->helper[sequence] = true;
	return helper_name(e, sequence, what);
}

/* ---- sums ---- */

struct list {
	int terms;
	const char **term;
};

static void add(struct list *list, const char *term)
{
	if (!term)
		return;
	ENLARGE(list->term, (size_t)list->terms + 1);
	list->term[list->terms++] = term;
}

/* Oldest first, the newest added last, in two chains where it is long */
static const char *chain(const struct list *list)
{
	const char *text[2] = { "", "" };
	if (list->terms == 0)
		return "0.0";
	int chains = list->terms > 4 ? 2 : 1;
	for (int i = 0; i < list->terms; i++) {
		const char **sum = &text[i % chains];
		*sum = **sum ? format("%s + %s", *sum, list->term[i]) : list->term[i];
	}
	return chains == 1 ? text[0] : format("(%s) + (%s)", text[0], text[1]);
}

/* Broken between summands that would pass column 110 */
void say_wrapped(const struct emitter *e, const char *text)
{
	enum { WIDTH = 96, INDENT = 10 };
	size_t start = 0, last = 0, length = strlen(text);
	int width = WIDTH;
	for (size_t i = 0; i < length; i++) {
		if (strncmp(text + i, " + ", 3) == 0 || strncmp(text + i, " - ", 3) == 0)
			last = i;
		if (i - start > (size_t)width && last > start) {
			say(e, "%.*s\n%*s", (int)(last - start), text + start, INDENT - 1, "");
			start = last;
			width = WIDTH;
		}
	}
	say(e, "%s", text + start);
}

static void define_as(const struct emitter *e, const char *type, const char *name, const char *text)
{
	struct lines *series = e->series;
	ENLARGE(series->line, (size_t)series->lines + 1);
	series->line[series->lines++] = format("%s %s = %s;\n", type, name, text);
}

static void define(const struct emitter *e, const char *name, const char *text)
{
	define_as(e, "const double", name, text);
}

/* a_i b_j; where one is 0 the other is not read */
static const char *pair(const struct emitter *e, int a, int i, int b, int j)
{
	if (i > sequence_of(e, a)->degree || j > sequence_of(e, b)->degree)
		return NULL;
	return format("%s * %s", coefficient(e, a, i), coefficient(e, b, j));
}

static const char *latest_times(const char *latest, double factor, const char *first)
{
	return factor == 1 ? format("%s * %s", latest, first)
			   : format("%s * (%s)", latest, scaled(factor, first));
}

/* What is new of one sequence, times the first of another with its factor */
static const char *newest(const char *latest, double factor, const struct emitter *e, int other)
{
	return latest ? latest_times(latest, factor, coefficient(e, other, 0)) : NULL;
}

/* factor (a_1 b_{k-1} + ... + a_{k-1} b_1) */
static const char *old_part(const struct emitter *e, int a, int b, int k, double factor)
{
	struct list old = { 0 };
	bool square = a == b;
	for (int gap = k % 2 ? 1 : 0; gap <= k - 2; gap += 2) {        /* those in the middle are the oldest */
		int i = (k - gap) / 2, j = k - i;
		add(&old, pair(e, a, i, b, j));
		if (i != j && !square)
			add(&old, pair(e, a, j, b, i));
	}
	if (old.terms == 0)
		return NULL;
	if (!square)
		return scaled(factor, old.terms == 1 ? old.term[0] : format("(%s)", chain(&old)));
	const char *middle = k % 2 == 0 ? pair(e, a, k / 2, a, k / 2) : NULL;
	struct list twice = { middle ? old.terms - 1 : old.terms, middle ? old.term + 1 : old.term };
	const char *rest = twice.terms == 0	? NULL
			   : twice.terms == 1 ? scaled(2, twice.term[0])
					      : scaled(2, format("(%s)", chain(&twice)));
	if (!middle || !rest)
		return scaled(factor, middle ? middle : rest);
	return factor == 1 ? format("%s + %s", middle, rest) : scaled(factor, format("(%s + %s)", middle, rest));
}

/* factor times the k-th of a b, its newest terms into `last` */
static void add_product(const struct emitter *e, struct list *sum, struct list *last, int a, int b, int k,
			double factor)
{
	if (k == 0) {
		const char *product = pair(e, a, 0, b, 0);
		add(sum, product ? scaled(factor, product) : NULL);
		return;
	}
	add(sum, old_part(e, a, b, k, factor));
	add(last, newest(coefficient(e, a, k), a == b ? 2 * factor : factor, e, b));
	if (a != b)
		add(last, newest(coefficient(e, b, k), factor, e, a));
}

static const char *power_of_time(int power)
{
	const char *text = "t";
	for (int i = 1; i < power; i++)
		text = format("%s * t", text);
	return power ? text : NULL;
}

/* What at k follows from time, loads and inputs; true: it is that */
static bool add_known(const struct emitter *e, struct list *sum, const struct sequence_term *t, int k)
{
	double factor = t->factor ? t->factor[k] : 1;
	if (t->kind == TERM_SEQUENCE || t->kind == TERM_PRODUCT)
		return factor == 0;
	if (t->slot >= 0) {
		const char *operand = column_operand(e, t->a), *place = format("force[%d][%d]", k, t->slot);
		add(sum, operand ? format("%s * %s", place, operand) : place);
	} else if (factor != 0) {
		bool input = t->kind == TERM_INPUT || t->kind == TERM_SLOPE;
		add(sum, scaled(factor, t->kind == TERM_TIME    ? power_of_time(t->a)
					: t->kind == TERM_PARAM ? param_text(t->a)
					: input                 ? input_name(e, t->a, t->kind == TERM_SLOPE)
								: column_operand(e, t->a)));
	}
	return true;
}

static void add_term(const struct emitter *e, struct list *sum, struct list *last, const struct sequence_term *t, int k)
{
	double factor = t->factor ? t->factor[k] : 1;
	if (add_known(e, sum, t, k))
		return;
	if (t->kind == TERM_PRODUCT)
		add_product(e, sum, last, t->a, t->b, k, factor);
	else
		add(last, coefficient(e, t->a, k) ? scaled(factor, coefficient(e, t->a, k)) : NULL);
}

static const char *early_and_last(const struct list *sum, const struct list *last)
{
	const char *early = chain(sum);
	if (last->terms == 0)
		return early;
	if (sum->terms > 1)
		early = format("(%s)", early);
	for (int i = 0; i < last->terms; i++)
		early = i == 0 && sum->terms == 0 ? last->term[0] : format("%s + %s", early, last->term[i]);
	return early;
}

/* What stands in a sum at k, from the coefficients themselves */
static const char *sum_at(const struct emitter *e, const struct sequence *s, int k)
{
	struct list sum = { 0 }, last = { 0 };
	for (int i = 0; i < s->terms; i++)
		add_term(e, &sum, &last, &s->term[i], k);
	return early_and_last(&sum, &last);
}

const char *size_of_terms(const struct emitter *e, int sequence)
{
	const struct sequence *s = sequence_of(e, sequence);
	struct list sum = { 0 }, last = { 0 };
	const char *text = "";
	for (int i = 0; i < s->terms && s->kind == SEQUENCE_SUM; i++)
		add_term(e, &sum, &last, &s->term[i], 0);
	if (sum.terms + last.terms == 0)
		return format("pl_magnitude(%s)", coefficient(e, sequence, 0));
	for (int i = 0; i < sum.terms + last.terms; i++)
		text = format("%s%spl_magnitude(%s)", text, i ? " + " : "",
			      i < sum.terms ? sum.term[i] : last.term[i - sum.terms]);
	return text;
}

static bool has_parts(const struct emitter *e, int sequence)
{
	const struct sequence *s = sequence_of(e, sequence);
	return s->state == NONE && (s->kind == SEQUENCE_CHOICE || (s->kind == SEQUENCE_SUM && s->terms > 0));
}

/* What a sum of sums is summed from, each part of it once, as a local; `made`: per sequence, whether it is there */
const char *emit_whole_size(const struct emitter *e, bool *made, int sequence)
{
	const struct sequence *s = sequence_of(e, sequence);
	const char *name = format("%s_size", base_name(e, sequence)), *text = "";
	if (!has_parts(e, sequence))
		return format("pl_magnitude(%s)", coefficient(e, sequence, 0));
	if (made[sequence])
		return name;
	made[sequence] = true;
	struct list sum = { 0 }, last = { 0 };
	for (int i = 0; i < s->terms; i++) {
		const struct sequence_term *t = &s->term[i];
		if (t->kind == TERM_SEQUENCE && has_parts(e, t->a))
			text = format("%s%s%s * %s", text, *text ? " + " : "", shortest(fabs(t->factor[0])),
				      emit_whole_size(e, made, t->a));
		else
			add_term(e, &sum, &last, t, 0);
	}
	for (int i = 0; i < sum.terms + last.terms; i++)
		text = format("%s%spl_magnitude(%s)", text, *text ? " + " : "",
			      i < sum.terms ? sum.term[i] : last.term[i - sum.terms]);
	if (s->kind == SEQUENCE_CHOICE) {
		const char *a = emit_whole_size(e, made, s->a), *b = emit_whole_size(e, made, s->b);
		text = format("%s ? %s : %s", helper_name(e, sequence, "holds"), a, b);
	}
	say(e, "    ");
	say_wrapped(e, format("const double %s = %s;\n", name, *text ? text : "0.0"));
	return name;
}

/* ---- early parts, k >= 1 ---- */

static const char *early_text(const struct emitter *e, int sequence, int k);

/* The part of the k-th that the newest of other sequences are not in; NULL: there is none */
static const char *early(const struct emitter *e, int sequence, int k)
{
	const struct sequence *s = sequence_of(e, sequence);
	bool trial = e->series->trial;
	if (k > s->degree)
		return NULL;
	if (s->known)
		return coefficient(e, sequence, k);
	if (!s->split)
		return NULL;
	struct mark *mark = mark_of(e, sequence, k);
	e->series->trial = true;
	if (mark->part == UNKNOWN)
		mark->part = early_text(e, sequence, k) ? SOMETHING : NOTHING;
	e->series->trial = trial;
	if (mark->part == NOTHING)
		return NULL;
	mark->early = mark->early || !trial;
	return format("%s_early_%d", base_name(e, sequence), k);
}

/* Of a sum: old terms of its products, and early parts of what is in it */
static void add_early_terms(const struct emitter *e, struct list *sum, const struct sequence *s, int k)
{
	for (int i = 0; i < s->terms; i++) {
		const struct sequence_term *t = &s->term[i];
		double factor = t->factor ? t->factor[k] : 1;
		if (add_known(e, sum, t, k))
			continue;
		const char *a = early(e, t->a, k);
		if (t->kind == TERM_SEQUENCE) {
			add(sum, a ? scaled(factor, a) : NULL);
			continue;
		}
		add(sum, old_part(e, t->a, t->b, k, factor));
		const char *b = t->a == t->b ? NULL : early(e, t->b, k);
		if (a)
			add(sum, newest(a, t->a == t->b ? 2 * factor : factor, e, t->b));
		if (b)
			add(sum, newest(b, factor, e, t->a));
	}
}

/* (early a_k - sum over 0 < j < k of c_j b_{k-j} - c_0 early b_k) / b_0 */
static const char *early_quotient(const struct emitter *e, int sequence, const struct sequence *s, int k)
{
	const char *above = s->a == NONE ? NULL : early(e, s->a, k), *below = early(e, s->b, k);
	struct list sum = { 0 };
	if (below)
		add(&sum, format("%s * %s", coefficient(e, sequence, 0), below));
	for (int j = 1; j < k; j++)
		add(&sum, pair(e, sequence, j, s->b, k - j));
	if (!above && sum.terms == 0)
		return NULL;
	const char *inverse = helper(e, sequence, "inverse");
	if (sum.terms == 0)
		return format("%s * %s", above, inverse);
	return above ? format("(%s - (%s)) * %s", above, chain(&sum), inverse)
		     : format("-(%s) * %s", chain(&sum), inverse);
}

/* (early a_k - sum over 0 < j < k of c_j c_{k-j}) / (2 c_0) */
static const char *early_root(const struct emitter *e, int sequence, const struct sequence *s, int k)
{
	const char *above = early(e, s->a, k), *old = old_part(e, sequence, sequence, k, 1);
	if (!above && !old)
		return NULL;
	return format("%s * %s", !old ? above : above ? format("(%s - (%s))", above, old) : format("-(%s)", old),
		      helper(e, sequence, "half"));
}

/* In the target's type */
static double rounded_double(double value)
{
	mpq_t exact;
	mpq_init(exact);
	mpq_set_d(exact, value);
	value = round_rational(exact);
	mpq_clear(exact);
	return value;
}

static void add_power_terms(const struct emitter *e, struct list *sum, int sequence, const struct sequence *s,
			    int first, int k)
{
	for (int j = first; j < k; j++) {
		double factor = rounded_double((s->exponent * (k - j) - j) / k);
		const char *product = factor == 0 ? NULL : pair(e, s->a, k - j, sequence, j);
		if (product)
			add(sum, scaled(factor, product));
	}
}

static const char *early_power(const struct emitter *e, int sequence, const struct sequence *s, int k)
{
	const char *base = early(e, s->a, k);
	struct list sum = { 0 };
	if (base)
		add(&sum, scaled(rounded_double(s->exponent), format("%s * %s", base, coefficient(e, sequence, 0))));
	add_power_terms(e, &sum, sequence, s, 1, k);
	return sum.terms ? format("(%s) * %s", chain(&sum), helper(e, sequence, "inverse")) : NULL;
}

static const char *early_text(const struct emitter *e, int sequence, int k)
{
	const struct sequence *s = sequence_of(e, sequence);
	struct list sum = { 0 };
	if (s->kind == SEQUENCE_QUOTIENT)
		return early_quotient(e, sequence, s, k);
	if (s->kind == SEQUENCE_ROOT)
		return early_root(e, sequence, s, k);
	if (s->kind == SEQUENCE_POWER)
		return early_power(e, sequence, s, k);
	add_early_terms(e, &sum, s, k);
	return sum.terms ? chain(&sum) : NULL;
}

/* ---- gains: derivatives of the k-th by the k-th of another, k >= 1, as text: a number, or what follows from the first
 * coefficients. Of an integral, times k + 1 ---- */

static int place_of_gain(const struct sequence *s, int other)
{
	int place = 0;
	while (place < s->gains && s->gain[place] != other)
		place++;
	return place < s->gains ? place : NONE;
}

static const char *gain_name(const struct emitter *e, int sequence, int other)
{
	return format("%s_by_%s", base_name(e, sequence), base_name(e, other));
}

/* In what reads it: "1", a name, or NULL: it is 0 */
static const char *gain(const struct emitter *e, int sequence, int other)
{
	const struct sequence *s = sequence_of(e, sequence);
	if (!s->split)
		return sequence == other ? "1" : NULL;
	int place = place_of_gain(s, other);
	if (place == NONE)
		return NULL;
	e->series->gain[sequence][place] = true;
	return gain_name(e, sequence, other);
}

/* times the first of a sequence */
static const char *gain_times(const struct emitter *e, const char *gain, double factor, int sequence)
{
	if (!gain)
		return NULL;
	const char *first = coefficient(e, sequence, 0);
	return strcmp(gain, "1") == 0 ? scaled(factor, first) : scaled(factor, format("%s * %s", first, gain));
}

/* Of a sum */
static const char *gain_of_sum(const struct emitter *e, const struct sequence *s, int other)
{
	struct list sum = { 0 };
	for (int i = 0; i < s->terms; i++) {
		const struct sequence_term *t = &s->term[i];
		if (t->kind != TERM_SEQUENCE && t->kind != TERM_PRODUCT)
			continue;
		const char *a = gain(e, t->a, other), *b = t->kind == TERM_PRODUCT ? gain(e, t->b, other) : NULL;
		double factor = t->factor[0];
		if (t->kind == TERM_SEQUENCE) {
			add(&sum, !a ? NULL : strcmp(a, "1") == 0 ? scaled(factor, NULL) : scaled(factor, a));
		} else if (t->a == t->b) {
			add(&sum, gain_times(e, a, 2 * factor, t->a));
		} else {
			add(&sum, gain_times(e, a, factor, t->b));
			add(&sum, gain_times(e, b, factor, t->a));
		}
	}
	return chain(&sum);
}

static const char *plain_gain(const char *gain)
{
	return strcmp(gain, "1") == 0 ? "1.0" : gain;
}

static const char *gain_text(const struct emitter *e, int sequence, int other)
{
	const struct sequence *s = sequence_of(e, sequence);
	if (s->kind == SEQUENCE_SUM || s->kind == SEQUENCE_INTEGRAL)
		return gain_of_sum(e, s, other);
	const char *a = s->a == NONE ? NULL : gain(e, s->a, other);
	if (s->kind == SEQUENCE_ROOT)
		return format("%s * %s", plain_gain(a), helper(e, sequence, "half"));
	const char *inverse = helper(e, sequence, "inverse");
	if (s->kind == SEQUENCE_POWER)
		return scaled(rounded_double(s->exponent), format("%s * %s * %s", plain_gain(a),
								  coefficient(e, sequence, 0), inverse));
	const char *b = gain(e, s->b, other);
	const char *below = gain_times(e, b, 1, sequence);
	return !below ? format("%s * %s", plain_gain(a), inverse)
	       : a    ? format("(%s - %s) * %s", plain_gain(a), below, inverse)
		      : format("-%s * %s", below, inverse);
}

/* Some of the newest of a term is that of another */
static bool reads(const struct emitter *e, const struct sequence_term *t, int other)
{
	bool product = t->kind == TERM_PRODUCT, found = false;
	for (int i = 0; i < (product ? 2 : t->kind == TERM_SEQUENCE); i++) {
		int operand = i ? t->b : t->a;
		const struct sequence *s = sequence_of(e, operand);
		found = found || (s->split ? place_of_gain(s, other) != NONE : operand == other);
	}
	return found;
}

/* The only term with this other is itself, with a number: its factor at each k */
static const struct sequence_term *plain_term(const struct emitter *e, const struct sequence *s, int other)
{
	const struct sequence_term *only = NULL;
	if (s->kind != SEQUENCE_SUM && s->kind != SEQUENCE_INTEGRAL)
		return NULL;
	for (int i = 0; i < s->terms; i++) {
		const struct sequence_term *t = &s->term[i];
		bool itself = t->kind == TERM_SEQUENCE && t->a == other && !sequence_of(e, other)->split;
		if (!reads(e, t, other))
			continue;
		if (!itself || only)
			return NULL;
		only = t;
	}
	return only;
}

/* early part + sum of gains times the k-th of the others, over k + 1 of an integral */
static const char *joined(const struct emitter *e, int sequence, int k)
{
	const struct sequence *s = sequence_of(e, sequence);
	struct list sum = { 0 }, last = { 0 };
	const char *part = s->split ? early(e, sequence, k) : NULL;
	if (part)
		add(&sum, part);
	if (!s->split)
		add_early_terms(e, &sum, s, k);
	for (int i = 0; i < s->gains; i++) {
		const struct sequence_term *plain = plain_term(e, s, s->gain[i]);
		const char *latest = coefficient(e, s->gain[i], k);
		if (!latest)
			continue;
		if (plain) {
			add(&last, scaled(plain->factor[k], latest));
			continue;
		}
		e->series->gain[sequence][i] = true;
		add(&last, latest_times(latest, s->kind == SEQUENCE_INTEGRAL ? rounded_double(1.0 / (k + 1)) : 1,
					gain_name(e, sequence, s->gain[i])));
	}
	return early_and_last(&sum, &last);
}

/* ---- coefficients ---- */

static const char *value_at_start(const struct emitter *e, const struct sequence *s)
{
	if (s->state != NONE)
		return format("y[%d]", s->state);
	if (s->function == FN_ATAN2)
		return format("atan2(%s, %s)", coefficient(e, s->a, 0), coefficient(e, s->b, 0));
	return format("%s(%s)", function_name(s->function), coefficient(e, s->a, 0));
}

/* (a_k - sum over j < k of c_j b_{k-j}) / b_0 */
static void define_quotient(const struct emitter *e, int sequence, const struct sequence *s, int k)
{
	const char *above = s->a == NONE ? NULL : coefficient(e, s->a, k);
	struct list sum = { 0 };
	if (k == 0) {
		define(e, name_of(e, sequence, 0), format("%s / %s", above ? above : "1.0", coefficient(e, s->b, 0)));
		return;
	}
	const char *inverse = helper(e, sequence, "inverse");
	for (int j = 0; j < k; j++)
		add(&sum, pair(e, sequence, j, s->b, k - j));
	const char *minus = sum.terms ? format("(%s)", chain(&sum)) : "0.0";
	define(e, name_of(e, sequence, k),
	       above ? format("(%s - %s) * %s", above, minus, inverse) : format("-%s * %s", minus, inverse));
}

/* (a_k - sum over 0 < j < k of c_j c_{k-j}) / (2 c_0) */
static void define_root(const struct emitter *e, int sequence, const struct sequence *s, int k)
{
	const char *above = coefficient(e, s->a, k);
	if (k == 0) {
		define(e, name_of(e, sequence, 0), format("sqrt(%s)", above));
		return;
	}
	const char *old = old_part(e, sequence, sequence, k, 1);
	const char *rest = !old ? (above ? above : "0.0") : above ? format("(%s - (%s))", above, old)
								  : format("-(%s)", old);
	define(e, name_of(e, sequence, k), format("%s * %s", rest, helper(e, sequence, "half")));
}

/* sum over j < k of (exponent (k-j) - j)/k a_{k-j} c_j / a_0 */
static void define_power(const struct emitter *e, int sequence, const struct sequence *s, int k)
{
	struct list sum = { 0 };
	if (k == 0) {
		define(e, name_of(e, sequence, 0),
		       format("pow(%s, %s)", coefficient(e, s->a, 0), shortest(s->exponent)));
		return;
	}
	add_power_terms(e, &sum, sequence, s, 0, k);
	define(e, name_of(e, sequence, k), format("(%s) * %s", chain(&sum), helper(e, sequence, "inverse")));
}

static int rank_of_choice(const struct emitter *e, const struct sequence *s)
{
	return s->choice == CHOICE_BY_HOLD ? breakpoint_rank(expansion(e), s->expression, s->breakpoint)
					   : upper_rank(expansion(e), s->expression, s->breakpoint);
}

static void define_choice(const struct emitter *e, int sequence, const struct sequence *s, int k)
{
	const char *a = coefficient(e, s->a, k), *b = coefficient(e, s->b, k);
	define(e, name_of(e, sequence, k), format("%s ? %s : %s", helper(e, sequence, "holds"), a ? a : "0.0",
						  b ? b : "0.0"));
}

/* What the later ones of a sequence read beside coefficients */
static void define_helper(const struct emitter *e, int sequence, const struct sequence *s)
{
	static const char *const sign[] = { "<", "<=", ">", ">=", "==", "!=" };
	if (s->kind == SEQUENCE_CHOICE)
		define_as(e, "const int", helper_name(e, sequence, "holds"),
			  s->choice == CHOICE_BY_STATE
				  ? format("interval[%d] > %d", s->expression, rank_of_choice(e, s))
			  : s->choice == CHOICE_BY_HOLD
				  ? format("interval[%d] == %d", s->expression, rank_of_choice(e, s) + 1)
			  : s->choice == CHOICE_BY_SEQUENCE
				  ? format("%s != 0.0", coefficient(e, s->test, 0))
				  : format("%s %s %s", time_text(e, s->left, "when"), sign[s->comparison],
					   time_text(e, s->right, "when")));
	else if (s->kind == SEQUENCE_ROOT)
		define(e, helper_name(e, sequence, "half"), format("0.5 / %s", coefficient(e, sequence, 0)));
	else
		define(e, helper_name(e, sequence, "inverse"),
		       format("1.0 / %s", coefficient(e, s->kind == SEQUENCE_POWER ? s->a : s->b, 0)));
}

static void define_read(const struct emitter *e, int sequence, const struct sequence *s, int k)
{
	int from = s->kind == SEQUENCE_INTEGRAL ? k - 1 : k;
	if (s->gains && from > 0) {
		define(e, name_of(e, sequence, k), joined(e, sequence, from));
		return;
	}
	switch (s->kind) {
	case SEQUENCE_SUM:
	case SEQUENCE_INTEGRAL: define(e, name_of(e, sequence, k),
				       from < 0 ? value_at_start(e, s) : sum_at(e, s, from)); break;
	case SEQUENCE_QUOTIENT: define_quotient(e, sequence, s, k); break;
	case SEQUENCE_ROOT:     define_root(e, sequence, s, k); break;
	case SEQUENCE_POWER:    define_power(e, sequence, s, k); break;
	case SEQUENCE_RATE: {
		const char *next = coefficient(e, s->a, k + 1);
		define(e, name_of(e, sequence, k), next ? scaled(k + 1, next) : "0.0");
		break;
	}
	case SEQUENCE_CHOICE:   define_choice(e, sequence, s, k); break;
	}
}

/* The k-th of a sequence, or of one that comes late the one before */
static void define_coefficient(const struct emitter *e, int sequence, int k)
{
	const struct sequence *s = sequence_of(e, sequence);
	k -= s->late;
	if (k < 0 || k > s->degree)
		return;
	if (k == 0 && e->series->helper[sequence] && s->kind != SEQUENCE_CHOICE)
		define_helper(e, sequence, s);
	if (mark_of(e, sequence, k)->full)
		define_read(e, sequence, s, k);
	if (k == 0 && e->series->helper[sequence] && s->kind == SEQUENCE_CHOICE)
		define_helper(e, sequence, s);
	if (mark_of(e, sequence, k)->early)
		define(e, format("%s_early_%d", base_name(e, sequence), k), early_text(e, sequence, k));
}

static void define_gains(const struct emitter *e, int sequence)
{
	const struct sequence *s = sequence_of(e, sequence);
	for (int i = s->gains - 1; i >= 0; i--)
		if (e->series->gain[sequence][i])
			define(e, gain_name(e, sequence, s->gain[i]), gain_text(e, sequence, s->gain[i]));
}

/* Forwards: the first coefficients, the gains of what is split, those of the integrals, all other coefficients. */
void emit_series_lines(const struct emitter *e)
{
	const struct expansion *x = expansion(e);
	struct lines series = { .mark = ARRAY(struct mark, (size_t)(x->count * (x->order + 1))),
				 .helper = ARRAY(bool, (size_t)x->count), .gain = ARRAY(bool *, (size_t)x->count) };
	struct emitter writer = *e;
	writer.series = &series;
	for (int i = 0; i < x->count; i++)
		series.gain[i] = ARRAY(bool, (size_t)x->sequence[i].gains);
	for (int k = 0; k <= x->order; k++) {
		for (int i = 0; i < e->system->states && !x->alone; i++)
			coefficient(&writer, i, k);
		for (int i = 0; i < x->columns; i++)
			if (k <= x->column_top[i])
				coefficient(&writer, x->column[i], k);
	}
	for (int k = x->order; k > 0; k--)
		for (int i = x->count - 1; i >= 0; i--)
			define_coefficient(&writer, i, k);
	for (int integrals = 1; integrals >= 0; integrals--)
		for (int i = x->count - 1; i >= 0; i--)
			if ((x->sequence[i].kind == SEQUENCE_INTEGRAL) == integrals)
				define_gains(&writer, i);
	for (int i = x->count - 1; i >= 0; i--)
		define_coefficient(&writer, i, 0);
	for (int i = series.lines - 1; i >= 0; i--) {
		say(e, "    ");
		say_wrapped(e, series.line[i]);
	}
}
