/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The coefficients of a series as C: a line for each, oldest terms first, since what is newest decides how long the
 * next one waits. */
#include "emit/emit.h"

#include <string.h>

static const struct expansion *expansion(const struct emitter *e)
{
	return e->step->expansion;
}

static bool changes(const struct emitter *e)
{
	return e->system->segments > 1;
}

bool has_offset(const struct emitter *e)
{
	return e->model->truncation.adaptive || changes(e);
}

static bool has_choices(const struct emitter *e)
{
	for (int i = 0; i < expansion(e)->count; i++)
		if (expansion(e)->sequence[i].kind == SEQUENCE_CHOICE && expansion(e)->sequence[i].top >= 0)
			return true;
	return false;
}

/* ---- names ---- */

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

/* Its k-th coefficient; NULL: that is 0 */
static const char *coefficient(const struct emitter *e, int sequence, int k)
{
	const struct sequence *s = &expansion(e)->sequence[sequence];
	if (k > s->degree)
		return NULL;
	if (s->state != NONE)
		return format("%s_%d", e->local[s->state], k);
	return format("%s%d_%d", prefix(e), sequence - e->system->states + 1, k);
}

static const char *own_name(const struct emitter *e, int sequence, const char *what)
{
	return format("%s%d_%s", prefix(e), sequence - e->system->states + 1, what);
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

static void define(const struct emitter *e, const char *name, const char *text)
{
	say(e, "    const double ");
	say_wrapped(e, format("%s = %s;\n", name, text));
}

static const char *times(const char *a, const char *b)
{
	return a && b ? format("%s * %s", a, b) : NULL;
}

/* a_k times b_0 with its factor */
static const char *newest(const char *latest, double factor, const char *first)
{
	if (!latest || !first)
		return NULL;
	return factor == 1 ? format("%s * %s", latest, first)
			   : format("%s * (%s)", latest, scaled(factor, first));
}

/* factor (a_1 b_{k-1} + ... + a_{k-1} b_1) */
static const char *old_part(const struct emitter *e, int a, int b, int k, double factor)
{
	struct list old = { 0 };
	bool square = a == b;
	for (int gap = k % 2 ? 1 : 0; gap <= k - 2; gap += 2) {        /* those in the middle are the oldest */
		int i = (k - gap) / 2, j = k - i;
		add(&old, times(coefficient(e, a, i), coefficient(e, b, j)));
		if (i != j && !square)
			add(&old, times(coefficient(e, a, j), coefficient(e, b, i)));
	}
	if (old.terms == 0)
		return NULL;
	if (!square)
		return scaled(factor, old.terms == 1 ? old.term[0] : format("(%s)", chain(&old)));
	const char *middle = k % 2 == 0 ? times(coefficient(e, a, k / 2), coefficient(e, a, k / 2)) : NULL;
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
		const char *product = times(coefficient(e, a, 0), coefficient(e, b, 0));
		add(sum, product ? scaled(factor, product) : NULL);
		return;
	}
	add(sum, old_part(e, a, b, k, factor));
	if (a == b) {
		add(last, newest(coefficient(e, a, k), 2 * factor, coefficient(e, a, 0)));
		return;
	}
	add(last, newest(coefficient(e, a, k), factor, coefficient(e, b, 0)));
	add(last, newest(coefficient(e, b, k), factor, coefficient(e, a, 0)));
}

static const char *power_of_time(int power)
{
	const char *text = "t";
	for (int i = 1; i < power; i++)
		text = format("%s * t", text);
	return power ? text : NULL;
}

static void add_term(const struct emitter *e, struct list *sum, struct list *last, const struct sequence_term *t, int k)
{
	double factor = t->factor ? t->factor[k] : 1;
	if (factor == 0)
		return;
	if (t->slot >= 0) {
		const char *operand = column_operand(e, t->a), *place = format("force[%d][%d]", k, t->slot);
		add(sum, operand ? format("%s * %s", place, operand) : place);
		return;
	}
	switch (t->kind) {
	case TERM_TIME:
		add(sum, scaled(factor, power_of_time(t->a)));
		break;
	case TERM_LOAD:
		add(sum, scaled(factor, column_operand(e, t->a)));
		break;
	case TERM_INPUT:
	case TERM_SLOPE:
		add(sum, scaled(factor, input_name(e, t->a, t->kind == TERM_SLOPE)));
		break;
	case TERM_SEQUENCE:
		add(last, coefficient(e, t->a, k) ? scaled(factor, coefficient(e, t->a, k)) : NULL);
		break;
	case TERM_PRODUCT:
		add_product(e, sum, last, t->a, t->b, k, factor);
		break;
	}
}

/* What stands in a sum at k */
static const char *sum_at(const struct emitter *e, const struct sequence *s, int k)
{
	struct list sum = { 0 }, last = { 0 };
	for (int i = 0; i < s->terms; i++)
		add_term(e, &sum, &last, &s->term[i], k);
	const char *early = chain(&sum);
	if (last.terms == 0)
		return early;
	if (sum.terms > 1)
		early = format("(%s)", early);
	for (int i = 0; i < last.terms; i++)
		early = i == 0 && sum.terms == 0 ? last.term[0] : format("%s + %s", early, last.term[i]);
	return early;
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
	const char *inverse = own_name(e, sequence, "inverse"), *above = s->a == NONE ? NULL : coefficient(e, s->a, k);
	struct list sum = { 0 };
	if (k == 0) {
		if (s->top > 0)
			define(e, inverse, format("1.0 / %s", coefficient(e, s->b, 0)));
		define(e, coefficient(e, sequence, 0),
		       format("%s / %s", above ? above : "1.0", coefficient(e, s->b, 0)));
		return;
	}
	for (int j = 0; j < k; j++)
		add(&sum, times(coefficient(e, sequence, j), coefficient(e, s->b, k - j)));
	const char *minus = sum.terms ? format("(%s)", chain(&sum)) : "0.0";
	define(e, coefficient(e, sequence, k),
	       above ? format("(%s - %s) * %s", above, minus, inverse) : format("-%s * %s", minus, inverse));
}

/* (a_k - sum over 0 < j < k of c_j c_{k-j}) / (2 c_0) */
static void define_root(const struct emitter *e, int sequence, const struct sequence *s, int k)
{
	const char *half = own_name(e, sequence, "half"), *above = coefficient(e, s->a, k);
	if (k == 0) {
		define(e, coefficient(e, sequence, 0), format("sqrt(%s)", coefficient(e, s->a, 0)));
		if (s->top > 0)
			define(e, half, format("0.5 / %s", coefficient(e, sequence, 0)));
		return;
	}
	const char *old = old_part(e, sequence, sequence, k, 1);
	const char *rest = !old ? (above ? above : "0.0") : above ? format("(%s - (%s))", above, old)
								  : format("-(%s)", old);
	define(e, coefficient(e, sequence, k), format("%s * %s", rest, half));
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

/* sum over j < k of (exponent (k-j) - j)/k a_{k-j} c_j / a_0 */
static void define_power(const struct emitter *e, int sequence, const struct sequence *s, int k)
{
	const char *inverse = own_name(e, sequence, "inverse");
	struct list sum = { 0 };
	if (k == 0) {
		define(e, coefficient(e, sequence, 0),
		       format("pow(%s, %s)", coefficient(e, s->a, 0), shortest(s->exponent)));
		if (s->top > 0)
			define(e, inverse, format("1.0 / %s", coefficient(e, s->a, 0)));
		return;
	}
	for (int j = 0; j < k; j++) {
		double factor = rounded_double((s->exponent * (k - j) - j) / k);
		const char *product = times(coefficient(e, s->a, k - j), coefficient(e, sequence, j));
		if (factor != 0 && product)
			add(&sum, scaled(factor, product));
	}
	define(e, coefficient(e, sequence, k), format("(%s) * %s", chain(&sum), inverse));
}

static void define_choice(const struct emitter *e, int sequence, const struct sequence *s, int k)
{
	static const char *const sign[] = { "<", "<=", ">", ">=", "==", "!=" };
	const char *a = coefficient(e, s->a, k), *b = coefficient(e, s->b, k), *choice = own_name(e, sequence, "holds");
	if (k == 0)
		say(e, "    const int %s = %s %s %s;\n", choice, time_text(e, s->left, "when"), sign[s->comparison],
		    time_text(e, s->right, "when"));
	define(e, coefficient(e, sequence, k), format("%s ? %s : %s", choice, a ? a : "0.0", b ? b : "0.0"));
}

/* The k-th of a sequence, or of one that comes late the one before */
static void define_coefficient(const struct emitter *e, int sequence, int k)
{
	const struct sequence *s = &expansion(e)->sequence[sequence];
	k -= s->late;
	if (k < 0 || k > s->top || k > s->degree)
		return;
	const char *name = coefficient(e, sequence, k);
	switch (s->kind) {
	case SEQUENCE_SUM:
		define(e, name, sum_at(e, s, k));
		break;
	case SEQUENCE_INTEGRAL:
		define(e, name, k ? sum_at(e, s, k - 1) : value_at_start(e, s));
		break;
	case SEQUENCE_QUOTIENT:
		define_quotient(e, sequence, s, k);
		break;
	case SEQUENCE_ROOT:
		define_root(e, sequence, s, k);
		break;
	case SEQUENCE_POWER:
		define_power(e, sequence, s, k);
		break;
	case SEQUENCE_RATE:
		define(e, name, coefficient(e, s->a, k + 1) ? scaled(k + 1, coefficient(e, s->a, k + 1)) : "0.0");
		break;
	case SEQUENCE_CHOICE:
		define_choice(e, sequence, s, k);
		break;
	}
}

/* ---- the expansion ---- */

static const char *input_parameters(const struct emitter *e, bool typed)
{
	const struct expansion *x = expansion(e);
	bool input = any_of(x->input, e->system->inputs), slope = any_of(x->slope, e->system->inputs);
	return format("%s%s", !input ? "" : typed ? "const double u[], " : e->ramps ? "start, " : "u, ",
		      !slope && !(input && e->ramps) ? "" : typed ? "const double slope[], " : "slope, ");
}

const char *driven_parameter(const struct emitter *e)
{
	return e->system->inputs ? format("const double u[%s_INPUTS], ", e->upper) : "";
}

void emit_input_samples(const struct emitter *e)
{
	const struct expansion *x = expansion(e);
	int inputs = e->system->inputs;
	const char *start = "", *slope = "";
	bool input = any_of(x->input, inputs), any = any_of(x->slope, inputs) || (input && e->ramps);
	for (int i = 0; i < inputs; i++) {
		bool ramp = e->system->input[i].hold;
		start = format("%s%s%s[%d]", start, i ? ", " : "", ramp ? "s->u" : "u", i);
		slope = format("%s%s%s", slope, i ? ", " : "", ramp ? ramp_slope(e, i) : "0.0");
	}
	if (input && e->ramps)
		say(e, "    const double start[$N_INPUTS] = {%s};\n", start);
	if (any)
		say(e, "    const double slope[$N_INPUTS] = {%s};\n", slope);
}

static void emit_expansion_locals(const struct emitter *e)
{
	const struct expansion *x = expansion(e);
	bool offset = has_offset(e);
	for (int i = 0; i < e->system->inputs; i++) {
		if (x->input[i])
			say(e, "    const double %s = u[%d]%s;\n", input_name(e, i, 0), i,
			    e->system->input[i].hold && offset ? format(" + tau * slope[%d]", i) : "");
		if (x->slope[i])
			say(e, "    const double %s = slope[%d];\n", input_name(e, i, 1), i);
	}
	bool time = x->time;
	for (int l = 0; l < e->system->loads; l++)
		time = time || (x->load[l] && e->system->load[l].powers > 1);
	if (time)
		say(e, "    const double t = $n_time(s)%s;\n", offset ? " + tau" : "");
	struct emitter here = *e;
	here.after = offset ? "tau" : NULL;
	emit_load_states(&here, x->load, true);
	if (x->slots)
		say(e, "    const double (*const force)[%d] = $n_force[segment];\n", x->slots);
}

void emit_force_table(const struct emitter *e)
{
	const struct expansion *x = expansion(e);
	int segments = e->system->segments, stride = x->order + 1;
	if (!x->slots)
		return;
	const char **note = ARRAY(const char *, (size_t)x->order);
	for (int k = 0; k < x->order; k++)
		note[k] = format("of coefficient %d", k + 1);
	say(e, "\n/* What the load states add to each coefficient, in each segment of time */\n"
	       "static const double $n_force[%d][%d][%d] = {\n", segments, x->order, x->slots);
	for (int s = 0; s < segments; s++) {
		double *value = ARRAY(double, (size_t)(x->order * x->slots));
		for (int k = 0; k < x->order; k++)
			for (int j = 0; j < x->slots; j++)
				value[k * x->slots + j] = x->changing[(j * segments + s) * stride + k];
		say(e, "  {\n");
		emit_number_rows(e, x->order, x->slots, value, note);
		say(e, "  },\n");
	}
	say(e, "};\n");
}

static bool reads_instance(const struct emitter *e)
{
	const struct expansion *x = expansion(e);
	bool instance = x->time;
	for (int l = 0; l < e->system->loads; l++)
		instance = instance || (x->load[l] && (e->phase[l] >= 0 || e->growth[l] >= 0 ||
						       e->system->load[l].powers > 1));
	return instance;
}

void emit_expand_function(const struct emitter *e)
{
	const struct expansion *x = expansion(e);
	bool tau = false;
	say(e, "\n/* The series of the solution from %s on: c[k] = h^k/k! times the k-th derivative of y */\n"
	       "static void $n_expand(const $n *s, %s%s%s%sconst double y[$N_STATES], double c[%d][$N_STATES])\n"
	       "{\n",
	    has_offset(e) ? "tau after now" : "now", has_offset(e) ? "double tau, " : "",
	    has_choices(e) ? "double when, " : "", changes(e) ? "int segment, " : "", input_parameters(e, true),
	    x->order + 1);
	emit_expansion_locals(e);
	for (int k = 0; k <= x->order; k++)
		for (int i = 0; i < x->count; i++)
			define_coefficient(e, i, k);
	for (int k = 0; k <= x->order; k++)
		for (int i = 0; i < e->system->states; i++) {
			const char *name = coefficient(e, i, k);
			say(e, "    c[%d][%d] = %s;\n", k, i, name ? name : "0.0");
		}
	for (int i = 0; i < e->system->inputs; i++)
		tau = tau || (x->input[i] && e->system->input[i].hold);
	if (!reads_instance(e))
		say(e, "    (void)s;\n");
	if (has_offset(e) && !reads_instance(e) && !tau)
		say(e, "    (void)tau;\n");
	if (changes(e) && !x->slots)
		say(e, "    (void)segment;\n");
	if (any_of(x->slope, e->system->inputs) || (any_of(x->input, e->system->inputs) && e->ramps))
		say(e, "    (void)slope;\n");
	say(e, "}\n");
}

const char *expand_call(const struct emitter *e, const char *tau, const char *when, const char *segment,
			       const char *y, const char *c)
{
	return format("%s_expand(s, %s%s%s%s%s, %s);", e->name, has_offset(e) ? format("%s, ", tau) : "",
		      has_choices(e) ? format("%s, ", when) : "", changes(e) ? format("%s, ", segment) : "",
		      input_parameters(e, false), y, c);
}
