/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The Taylor series of the solution as C: a line for each coefficient, oldest terms first, since what is newest decides
 * how long the next one waits; the sum of the series; steps as long as its last terms allow. */
#include "emit/emit.h"

#include <math.h>
#include <string.h>

enum { WHOLE_STEPS = 32 };          /* most that one expansion serves */

static const struct expansion *expansion(const struct emitter *e)
{
	return e->step->expansion;
}

static const struct truncation *truncation(const struct emitter *e)
{
	return &e->model->truncation;
}

static bool changes(const struct emitter *e)
{
	return e->system->segments > 1;
}

/* An expansion may start inside a step. */
static bool has_offset(const struct emitter *e)
{
	return truncation(e)->adaptive || changes(e);
}

static bool has_choices(const struct emitter *e)
{
	for (int i = 0; i < expansion(e)->count; i++)
		if (expansion(e)->sequence[i].kind == SEQUENCE_CHOICE && expansion(e)->sequence[i].top >= 0)
			return true;
	return false;
}

static bool looks_at_tolerance(const struct emitter *e)
{
	return mpq_sgn(truncation(e)->tolerance) != 0;
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
static void say_wrapped(const struct emitter *e, const char *text)
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
static void add_product(const struct emitter *e, struct list *sum, struct list *last, int a, int b, int k, double factor)
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

static const char *time_form(const struct emitter *e, const struct form *form)
{
	struct list sum = { 0 };
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		const char *operand = basis->kind == BASIS_PI				? "3.141592653589793"
				      : basis->kind == BASIS_WAVE && basis->power > 0 ? "when"
										      : NULL;
		add(&sum, scaled(finite_number(e, form->term[i].factor), operand));
	}
	return chain(&sum);
}

static void define_choice(const struct emitter *e, int sequence, const struct sequence *s, int k)
{
	static const char *const sign[] = { "<", "<=", ">", ">=", "==", "!=" };
	const char *a = coefficient(e, s->a, k), *b = coefficient(e, s->b, k), *choice = own_name(e, sequence, "holds");
	if (k == 0)
		say(e, "    const int %s = %s %s %s;\n", choice, time_form(e, s->left), sign[s->comparison],
		    time_form(e, s->right));
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

static const char *driven_parameter(const struct emitter *e)
{
	return e->system->inputs ? format("const double u[%s_INPUTS], ", e->upper) : "";
}

static void emit_input_samples(const struct emitter *e)
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

static void emit_force_table(const struct emitter *e)
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

static void emit_expand(const struct emitter *e)
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

static const char *expand_call(const struct emitter *e, const char *tau, const char *when, const char *segment,
			       const char *y, const char *c)
{
	return format("%s_expand(s, %s%s%s%s%s, %s);", e->name, has_offset(e) ? format("%s, ", tau) : "",
		      has_choices(e) ? format("%s, ", when) : "", changes(e) ? format("%s, ", segment) : "",
		      input_parameters(e, false), y, c);
}

/* ---- its sum ---- */

static void emit_ahead(const struct emitter *e)
{
	int order = expansion(e)->order, states = e->system->states;
	enum { WRITTEN_OUT = 400 };
	say(e, "\n/* What the series gains from its start, theta h later */\n"
	       "static void $n_ahead(const double c[%d][$N_STATES], double theta, double gain[$N_STATES])\n"
	       "{\n", order + 1);
	if (states * order > WRITTEN_OUT) {
		say(e, "    int i, k;\n"
		       "    for (i = 0; i < $N_STATES; i++)\n"
		       "        gain[i] = c[%d][i];\n"
		       "    for (k = %d; k > 0; k--)\n"
		       "        for (i = 0; i < $N_STATES; i++)\n"
		       "            gain[i] = gain[i] * theta + c[k][i];\n"
		       "    for (i = 0; i < $N_STATES; i++)\n"
		       "        gain[i] *= theta;\n"
		       "}\n", order, order - 1);
		return;
	}
	for (int i = 0; i < states; i++)
		say(e, "    double g%d = c[%d][%d];\n", i, order, i);
	for (int k = order - 1; k > 0; k--)
		for (int i = 0; i < states; i++)
			say(e, "%sg%d = g%d * theta + c[%d][%d];%s", i % 4 ? " " : "    ", i, i, k, i,
			    i % 4 == 3 || i == states - 1 ? "\n" : "");
	for (int i = 0; i < states; i++)
		say(e, "    gain[%d] = g%d * theta;\n", i, i);
	say(e, "}\n");
}

/* ---- how far it holds ---- */

static void emit_reach_tables(const struct emitter *e)
{
	int order = expansion(e)->order;
	const char *last = "", *before = "";
	mpq_t bound, steps;
	mpq_inits(bound, steps, NULL);
	for (int m = 1; m <= WHOLE_STEPS; m++) {
		mpq_set(bound, truncation(e)->tolerance);
		mpq_set_ui(steps, (unsigned long)m, 1);
		for (int k = 1; k < order; k++)
			mpq_div(bound, bound, steps);
		const char *gap = m == 1 ? "" : (m - 1) % 4 ? ", " : ",\n    ";
		before = format("%s%s%s", before, gap, shortest(round_rational(bound)));
		mpq_div(bound, bound, steps);
		last = format("%s%s%s", last, gap, shortest(round_rational(bound)));
	}
	mpq_clears(bound, steps, NULL);
	say(e, "\n/* The tolerance over m^%d and m^%d: what the last two coefficients may be for m steps */\n"
	       "static const double $n_last[%d] = {\n    %s\n};\n"
	       "static const double $n_before_last[%d] = {\n    %s\n};\n", order, order - 1, WHOLE_STEPS, last,
	    WHOLE_STEPS, before);
}

/* The last two coefficients, relative to the largest size of each state so far */
static void emit_remainder(const struct emitter *e)
{
	int order = expansion(e)->order;
	say(e, "\n/* The last two coefficients over the largest value of each state so far, or where that is 0 its gain */\n"
	       "static void $n_remainder(const $n *s, const double c[%d][$N_STATES], double *last, double *before)\n"
	       "{\n"
	       "    int i;\n"
	       "    *last = *before = 0.0;\n"
	       "    for (i = 0; i < $N_STATES; i++) {\n"
	       "        double unit = s->unit[i], p = c[%d][i], q = c[%d][i];\n"
	       "        if (unit == 0.0) {\n"
	       "            const double one = pl_magnitude(c[1][i]), two = pl_magnitude(c[2][i]);\n"
	       "            unit = one > two ? 1.0 / one : two > 0.0 ? 1.0 / two : 1.0;\n"
	       "        }\n"
	       "        p = pl_magnitude(p) * unit;\n"
	       "        q = pl_magnitude(q) * unit;\n"
	       "        *last = p <= *last ? *last : p;  /* what is not a number stays */\n"
	       "        *before = q <= *before ? *before : q;\n"
	       "    }\n"
	       "}\n", order + 1, order, order - 1);
}

static void emit_reach(const struct emitter *e)
{
	int order = expansion(e)->order;
	say(e, "\n/* Steps that the series serves, at most %d; 0: not even one */\n"
	       "static int $n_reach(const $n *s)\n"
	       "{\n"
	       "    double last, before;\n"
	       "    int m = s->valid;\n"
	       "    $n_remainder(s, s->series, &last, &before);\n"
	       "    while (m < %d && last <= $n_last[m] && before <= $n_before_last[m])\n"
	       "        m++;\n"
	       "    while (m > 0 && !(last <= $n_last[m - 1] && before <= $n_before_last[m - 1]))\n"
	       "        m--;\n"
	       "    return m;\n"
	       "}\n", WHOLE_STEPS, WHOLE_STEPS);
	say(e, "\n/* The part of a step that the series serves, a power of 2 up to 1; 0: none */\n"
	       "static double $n_part(const $n *s, const double c[%d][$N_STATES])\n"
	       "{\n"
	       "    double last, before, part = 1.0;\n"
	       "    int halvings = 0;\n"
	       "    $n_remainder(s, c, &last, &before);\n"
	       "    for (; halvings < 60 && !(last <= %s && before <= %s); halvings++) {\n"
	       "        part *= 0.5;\n"
	       "        last *= %s;\n"
	       "        before *= %s;\n"
	       "    }\n"
	       "    return halvings < 60 ? part : 0.0;\n"
	       "}\n", order + 1, shortest(round_rational(truncation(e)->tolerance)),
	    shortest(round_rational(truncation(e)->tolerance)), shortest(ldexp(1, -order)), shortest(ldexp(1, 1 - order)));
}

/* ---- inside a step ---- */

/* From now over a part of the step: substeps, and changes of the loads on the way */
static void emit_between(const struct emitter *e)
{
	int order = expansion(e)->order, last = e->system->segments - 1;
	bool adaptive = truncation(e)->adaptive;
	say(e, "\n/* y and what rounding took from it, end h later: 0, or what went wrong, and then as far as it went */\n"
	       "static int $n_between(const $n *s, %sdouble end, double y[$N_STATES], double rest[$N_STATES])\n"
	       "{\n"
	       "    double c[%d][$N_STATES], gain[$N_STATES], done = 0.0;\n"
	       "    int i%s%s;\n", driven_parameter(e), order + 1,
	    adaptive ? ", steps = 0" : "", changes(e) ? ", segment = s->segment" : "");
	emit_input_samples(e);
	say(e, "    while (done < end) {\n"
	       "        double limit = end, size;\n");
	if (changes(e))
		say(e, "        for (; segment < %d; segment++) {\n"
		       "            const double change = $n_until(s, segment) / $N_H;\n"
		       "            limit = change < end ? change : end;\n"
		       "            if (limit > done)\n"
		       "                break;\n"
		       "            limit = end;\n"
		       "        }\n", last);
	if (adaptive)
		say(e, "        if (steps++ == %d)\n"
		       "            return PL_TOO_MANY_STEPS;\n", truncation(e)->substeps);
	say(e, "        %s\n", expand_call(e, spell(e, "done * $N_H"),
		spell(e, "$n_time(s) + 0.5 * (done + limit) * $N_H"), "segment", "y", "c"));
	if (adaptive)
		say(e, "        size = $n_part(s, (const double (*)[$N_STATES])c);\n"
		       "        if (size == 0.0)\n"
		       "            return PL_NOT_FINITE;\n"
		       "        size = size < limit - done ? size : limit - done;\n");
	else
		say(e, "        size = limit - done;\n");
	say(e, "        $n_ahead((const double (*)[$N_STATES])c, size, gain);\n"
	       "        for (i = 0; i < $N_STATES; i++)\n"
	       "            y[i] = pl_accumulate(y[i], gain[i], 0.0, &rest[i]);\n"
	       "        done = size < limit - done ? done + size : limit;\n"
	       "    }\n"
	       "    return 0;\n"
	       "}\n");
}

/* ---- the step ---- */

static void emit_scales(const struct emitter *e, const char *indent)
{
	say(e, "%sif (pl_magnitude(s->y[i]) > s->scale[i]) {\n"
	       "%s    s->scale[i] = pl_magnitude(s->y[i]);\n"
	       "%s    s->unit[i] = 1.0 / s->scale[i];\n"
	       "%s}\n", indent, indent, indent, indent);
}

bool expansion_places(const struct emitter *e)
{
	return looks_at_tolerance(e);
}

void emit_expansion_place(const struct emitter *e)
{
	if (!looks_at_tolerance(e))
		return;
	say(e, "\n/* What follows from a state that was set */\n"
	       "static void $n_place($n *s)\n"
	       "{\n"
	       "    int i;\n");
	if (truncation(e)->adaptive)
		say(e, "    s->served = s->valid = 0;\n");
	say(e, "    for (i = 0; i < $N_STATES; i++) {\n"
	       "        s->scale[i] = s->unit[i] = 0.0;\n");
	emit_scales(e, "        ");
	say(e, "    }\n"
	       "}\n");
}

static const char *u_argument(const struct emitter *e)
{
	return e->system->inputs ? "u, " : "";
}

static void emit_expansion_end(const struct emitter *e)
{
	emit_step_end(e);
	if (!truncation(e)->adaptive)           /* else a series that is not finite serves no step */
		say(e, "    s->status |= pl_not_finite(s->y, $N_STATES);\n");
	if (changes(e))
		say(e, "    while (s->segment < %d && $n_until(s, s->segment) <= 1e-18 * $N_H)\n"
		       "        s->segment++;\n", e->system->segments - 1);
	say(e, "}\n");
}

/* Of fixed order: one way through, whatever the numbers are */
static void emit_fixed_step(const struct emitter *e)
{
	int order = expansion(e)->order, states = e->system->states;
	say(e, "\nvoid $n_step(%s)\n"
	       "{\n", step_parameters(e));
	if (changes(e)) {
		say(e, "%s    s->status |= $n_between(s, %s1.0, s->y, s->rest);\n",
		    looks_at_tolerance(e) ? "    int i;\n" : "", u_argument(e));
	} else {
		say(e, "    double c[%d][$N_STATES];\n", order + 1);
		emit_input_samples(e);
		if (looks_at_tolerance(e))
			say(e, "    double last, before;\n"
			       "    int i;\n");
		say(e, "    %s\n", expand_call(e, "", "", "", "s->y", "c"));
		for (int i = 0; i < states; i++) {
			const char *text = format("c[%d][%d]", order, i);
			for (int k = order - 1; k > 0; k--)
				text = format("(%s + c[%d][%d])", text, k, i);
			say(e, "    ");
			say_wrapped(e, format("s->y[%d] = pl_accumulate(s->y[%d], %s, 0.0, &s->rest[%d]);\n", i, i, text, i));
		}
		if (looks_at_tolerance(e))
			say(e, "    $n_remainder(s, (const double (*)[$N_STATES])c, &last, &before);\n"
			       "    if (!(last <= %s && before <= %s))\n"
			       "        s->status |= PL_INACCURATE;\n",
			    shortest(round_rational(truncation(e)->tolerance)),
			    shortest(round_rational(truncation(e)->tolerance)));
	}
	if (looks_at_tolerance(e)) {
		say(e, "    for (i = 0; i < $N_STATES; i++)\n");
		emit_scales(e, "        ");
	}
	emit_expansion_end(e);
}

static void emit_adaptive_step(const struct emitter *e)
{
	bool inputs = e->system->inputs > 0;
	say(e, "\n/* A new series from here, and how many steps it serves */\n"
	       "static void $n_renew(%s)\n"
	       "{\n"
	       "    int i;\n", step_parameters(e));
	emit_input_samples(e);
	say(e, "    for (i = 0; i < $N_STATES; i++)\n");
	emit_scales(e, "        ");
	say(e, "    %s\n", expand_call(e, "0.0", spell(e, "$n_time(s) + 1e-9 * $N_H"), "s->segment", "s->y", "s->series"));
	say(e, "    s->valid = $n_reach(s);\n");
	if (inputs)
		say(e, "    s->valid = s->valid > 1 ? 1 : s->valid;  /* the samples to come are not known */\n");
	if (changes(e))
		say(e, "    if (s->segment < %d && $n_until(s, s->segment) < s->valid * $N_H)\n"
		       "        s->valid = (int)($n_until(s, s->segment) / $N_H);\n", e->system->segments - 1);
	say(e, "    s->served = 0;\n"
	       "    for (i = 0; i < $N_STATES; i++)\n"
	       "        s->base[i] = s->rest[i];\n");
	if (inputs)
		say(e, "    (void)u;\n");
	say(e, "}\n"
	       "\nvoid $n_step(%s)\n"
	       "{\n"
	       "    int i;\n"
	       "    if (s->served == s->valid)\n"
	       "        $n_renew(s%s);\n"
	       "    if (s->valid) {\n"
	       "        double gain[$N_STATES];\n"
	       "        s->served++;\n"
	       "        $n_ahead((const double (*)[$N_STATES])s->series, (double)s->served, gain);\n"
	       "        if (s->served < s->valid) {\n"
	       "            for (i = 0; i < $N_STATES; i++)\n"
	       "                s->y[i] = s->series[0][i] + (gain[i] + s->base[i]);\n"
	       "        } else {\n"
	       "            for (i = 0; i < $N_STATES; i++)\n"
	       "                s->y[i] = pl_accumulate(s->series[0][i], gain[i], 0.0, &s->rest[i]);\n"
	       "        }\n"
	       "    } else {\n"
	       "        s->status |= $n_between(s, %s1.0, s->y, s->rest);\n"
	       "    }\n", step_parameters(e), inputs ? ", u" : "", u_argument(e));
	emit_expansion_end(e);
}

void emit_expansion_members(const struct emitter *e)
{
	if (truncation(e)->adaptive)
		say(e, "    double series[%d][$N_STATES];  /* the last expansion, in powers of time over h */\n"
		       "    double base[$N_STATES];  /* what rounding had taken there */\n"
		       "    int served, valid;    /* steps since then; steps that it serves */\n", expansion(e)->order + 1);
	if (looks_at_tolerance(e))
		say(e, "    double scale[$N_STATES], unit[$N_STATES];  /* the largest size of each state so far; 1 over it */\n");
}

void emit_expansion_step(const struct emitter *e)
{
	if (reads_channels(e->model))
		emit_leftover_functions(e);
	emit_force_table(e);
	emit_expand(e);
	emit_ahead(e);
	if (looks_at_tolerance(e) && (truncation(e)->adaptive || !changes(e)))
		emit_remainder(e);
	if (truncation(e)->adaptive) {
		emit_reach_tables(e);
		emit_reach(e);
	}
	if (has_offset(e))
		emit_between(e);
	(truncation(e)->adaptive ? emit_adaptive_step : emit_fixed_step)(e);
}

/* ---- between steps ---- */

void emit_expansion_at(const struct emitter *e)
{
	bool relative = e->model->relative != NULL, adaptive = truncation(e)->adaptive, offset = has_offset(e);
	const char *y = relative ? "x" : "y";
	say(e, "\nvoid $n_at(const $n *s, %sdouble tau, double y[$N_STATES])\n"
	       "{\n"
	       "    double %s%s[$N_STATES];\n"
	       "    int i;\n", driven_parameter(e), relative ? format("x[%s_STATES], ", e->upper) : "",
	    offset ? "rest" : "gain");
	if (!offset) {
		say(e, "    double c[%d][$N_STATES];\n", expansion(e)->order + 1);
		emit_input_samples(e);
		say(e, "    %s\n", expand_call(e, "", "", "", "s->y", "c"));
		say(e, "    $n_ahead((const double (*)[$N_STATES])c, tau / $N_H, gain);\n"
		       "    for (i = 0; i < $N_STATES; i++)\n"
		       "        %s[i] = s->y[i] + (gain[i] + s->rest[i]);\n", y);
	}
	if (adaptive)
		say(e, "    if (s->served < s->valid) {\n"
		       "        double gain[$N_STATES];\n"
		       "        $n_ahead((const double (*)[$N_STATES])s->series, (double)s->served + tau / $N_H, gain);\n"
		       "        for (i = 0; i < $N_STATES; i++)\n"
		       "            %s[i] = s->series[0][i] + (gain[i] + s->base[i]);\n"
		       "    } else {\n", y);
	if (offset)
		say(e, "%s    for (i = 0; i < $N_STATES; i++) {\n"
		       "%s        %s[i] = s->y[i];\n"
		       "%s        rest[i] = s->rest[i];\n"
		       "%s    }\n"
		       "%s    $n_between(s, %stau / $N_H, %s, rest);\n", adaptive ? "    " : "", adaptive ? "    " : "", y,
		    adaptive ? "    " : "", adaptive ? "    " : "", adaptive ? "    " : "", u_argument(e), y);
	if (adaptive)
		say(e, "    }\n");
	if (relative)
		say(e, "    $n_written(s, x, y);\n");
	say(e, "}\n");
}
