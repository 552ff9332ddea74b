/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A step program and its tables as C. Everything printed here is meant to be read. */
#include "plgen.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

static const char *upper_case(const char *name)
{
	char *upper = format("%s", name);
	for (char *c = upper; *c; c++)
		*c = (char)toupper((unsigned char)*c);
	return upper;
}

static struct emitter emitter_new(FILE *to, const struct step *step, const char *options)
{
	struct emitter e = { .to = to, .step = step, .model = step->model, .system = &step->system, .options = options };
	size_t loads = (size_t)e.system->loads;
	e.name = step->model->name;
	e.upper = upper_case(e.name);
	e.phase = ARRAY(int, loads);
	e.growth = ARRAY(int, loads);
	for (size_t l = 0; l < loads; l++) {
		const struct wave *wave = e.system->load[l].wave;
		e.phase[l] = oscillates(wave) ? e.phases++ : -1;
		e.growth[l] = mpq_sgn(wave->a) != 0 ? e.growths++ : -1;
	}
	for (int i = 0; i < e.system->inputs; i++)
		e.ramps = e.ramps || e.system->input[i].first_order;
	e.local = ARRAY(const char *, (size_t)e.system->states);
	name_for_c(step->model, e.upper, e.local);
	return e;
}

bool has_jump(const struct emitter *e)
{
	return e->system->inputs == 0;
}

/* ---- banner ---- */

static const char *printable(const char *text)
{
	char *clean = format("%s", text);
	for (char *c = clean; *c; c++)
		if ((unsigned char)*c < ' ' || *c == 127 || (c > clean && ((c[-1] == '*' && *c == '/') || (c[-1] == '/' && *c == '*'))))
			*c = '?';               /* a comment in an option neither ends nor opens ours */
	return clean;
}

static void banner_equations(const struct emitter *e)
{
	const struct spec *spec = e->model->spec;
	for (int i = 0; i < spec->equations; i++)
		fprintf(e->to, " *     %s\n", text_between(spec->equation[i].at, spec->equation[i].end));
	for (int i = 0; i < spec->elements; i++)
		fprintf(e->to, " *     %s\n", text_between(spec->element[i].at, spec->element[i].end));
}

static void banner_poles(const struct emitter *e)
{
	int length = resolvent_determinant(e->step->written)->length;
	mpq_t *B = rationals((size_t)length);
	characteristic_polynomial(e->step->written, B);
	fprintf(e->to, " *\n *     B(s) = %s\n", polynomial_text(length, (const mpq_t *)B));
	struct pole_report *pole;
	int count = poles_of(e->step->written, &pole);
	fprintf(e->to, " *     %-34s %-16s damping ratio\n", "pole [1/s]", "frequency [Hz]");
	for (int i = 0; i < count; i++)
		fprintf(e->to, " *     %-34s %-16.8g %.8g\n", pole_text(&pole[i]), mpfr_get_d(pole[i].hertz, MPFR_RNDN),
			mpfr_get_d(pole[i].damping_ratio, MPFR_RNDN));
}

static void banner_scheme(const struct emitter *e)
{
	FILE *to = e->to;
	if (e->model->scheme == SCHEME_EXACT) {
		fputs(" * Scheme exact: nothing is approximated; each constant is its closed form, correctly rounded.\n", to);
		return;
	}
	fputs(" * Scheme pl, of first order in h: the coupling terms (the other coordinates and their velocities, after\n"
	      " * division by the mass matrix) are held at their value at the start of the step; a coordinate's own terms and\n"
	      " * the loads are exact. Each constant is its closed form, correctly rounded.\n", to);
	fprintf(to, " * Its modified equation grows at %.3g 1/s (largest real part of its poles; the poles above are exact).\n",
		mpfr_get_d(e->step->growth, MPFR_RNDN));
}

static void banner_irrationals(const struct emitter *e)
{
	const char *which = irrationals_text(&e->model->irrationals);
	if (*which)
		fprintf(e->to, " * Irrational constants (%s) were taken as rationals of %d bits.\n", which, IRRATIONAL_BITS);
}

static const char *state_list(const struct model *model)
{
	const char *list = "";
	for (int i = 0; i < model->system.states; i++)
		list = format("%s%s%s", list, i ? ", " : "", model->state_name[i]);
	return list;
}

static void banner_cost(const struct emitter *e)
{
	const struct program *program = e->step->program;
	fprintf(e->to, " * One step of h = %s s, form direct: %d multiplications, %d additions", readable_text(e->model->h),
		program->multiplications, program->additions);
	int multiplications = program->oscillators * PL_COSSIN_MUL + program->growths * PL_GROWTH_MUL;
	if (multiplications)
		fprintf(e->to, ", %d of them and %d for the functions of the loads", multiplications,
			program->oscillators * PL_COSSIN_ADD + program->growths * PL_GROWTH_ADD);
	fprintf(e->to, ".\n * State y = %s.\n", state_list(e->model));
	for (int i = 0; i < e->system->inputs; i++)
		fprintf(e->to, " * Input %s: %s.\n", e->system->input[i].name, e->system->input[i].first_order
			? "a ramp from sample to sample; u is its value at the end of the step" : "held over the step");
	if (e->system->segments > 1)
		fprintf(e->to, " * The loads change their formula %d time%s; a step across a change is exact too, by a series that stops there.\n",
			e->system->segments - 1, e->system->segments > 2 ? "s" : "");
	if (e->model->dropped)
		fprintf(e->to, " * Reduced to what the outputs can see: %d of %d states.\n", e->system->states, e->model->written->system.states);
	if (has_jump(e) && e->system->states > 12)
		fprintf(e->to, " * %s_jump needs some %d KB of stack.\n", e->name, 1 + 32 * e->system->states * e->system->states / 1024);
	if (!has_jump(e))
		fprintf(e->to, " * There is no %s_jump: the samples to come are not known.\n", e->name);
	if (!e->step->series.emitted)
		fprintf(e->to, " * There is no %s_at: the largest |pole| times h is above 8.\n", e->name);
}

static void emit_banner(const struct emitter *e)
{
	fprintf(e->to, "/* %s: made by plgen " PLGEN_VERSION " from %s%s%s; do not edit.\n", e->name, printable(e->model->spec->source->base),
		*e->options ? " with " : "", printable(e->options));
	fputs(" * SPDX-License-Identifier: MIT-0\n *\n", e->to);
	banner_equations(e);
	banner_poles(e);
	fputs(" *\n", e->to);
	banner_scheme(e);
	banner_irrationals(e);
	banner_cost(e);
	fputs(" */\n", e->to);
}

/* ---- declarations ---- */

/* One declaration, its comment at a common column. */
static void declare(const struct emitter *e, const char *text, const char *comment)
{
	fprintf(e->to, *comment ? "%-76s  /* %s */\n" : "%s\n", text, comment);
}

static void emit_state_struct(const struct emitter *e)
{
	FILE *to = e->to;
	fprintf(to, "typedef struct %s %s;  /* copy it to save, assign it to restore */\n", e->name, e->name);
	fprintf(to, "struct %s {\n    double y[%s_STATES];  /* %s */\n", e->name, e->upper, state_list(e->model));
	if (e->system->inputs)
		fprintf(to, "    double u[%s_INPUTS];  /* the last sample */\n", e->upper);
	if (e->ramps)
		fprintf(to, "    double slope[%s_INPUTS];  /* of the inputs over the last step [1/s] */\n", e->upper);
	emit_load_members(e);
	if (e->system->segments > 1)
		fputs("    int segment;          /* of time: how many changes of the loads are past */\n", to);
	fputs("    double t0;            /* [s]; time is t0 + k h */\n    uint64_t k;           /* steps since then */\n};\n\n", to);
}

static void emit_functions(const struct emitter *e, bool rhs)
{
	const char *n = e->name, *N = e->upper;
	const char *u = e->system->inputs ? format(", const double u[%s_INPUTS]", N) : "";
	bool inputs = e->system->inputs > 0;
	declare(e, format("void   %s_init(%s *s);", n, n), "t = 0, the spec's initial values");
	declare(e, format("void   %s_set(%s *s, double t, const double y[%s_STATES]);", n, n, N), "any state at any time [s]");
	declare(e, format("void   %s_get(const %s *s, double y[%s_STATES]);", n, n, N), "");
	declare(e, format("double %s_time(const %s *s);", n, n), "[s]");
	if (e->ramps)
		declare(e, format("void   %s_hold(%s *s, const double u[%s_INPUTS]);", n, n, N), "the previous sample");
	declare(e, format("void   %s_step(%s *s%s);", n, n, u), !inputs ? "one step of h" : e->ramps ? "one step of h; a ramp ends at u" : "one step of h with u held");
	declare(e, format("void   %s_out(const %s *s, double out[%s_OUTPUTS]);", n, n, N), "outputs now");
	declare(e, format("void   %s_run(%s *s, size_t n, %sdouble *out);", n, n, inputs ? "const double *u, " : ""),
		inputs ? "n steps, n rows of u; out: n rows, or NULL" : "n steps; out: n rows of outputs, or NULL");
	if (e->step->series.emitted)
		declare(e, format("void   %s_at(const %s *s%s, double tau, double y[%s_STATES]);", n, n, u, N), "tau after now, 0 <= tau <= h");
	if (has_jump(e))
		declare(e, format("void   %s_jump(%s *s, uint64_t n);", n, n), "as n steps would, in log n time");
	if (rhs)
		declare(e, format("void   %s_rhs(double t, const double y[], %sdouble dydt[]);", n, inputs ? "const double u[], " : ""),
			e->model->written != e->model ? format("as written; y: all %d written states", e->model->written->system.states)
			: e->ramps ? "as written; u: inputs, then their slopes" : "the equations as written");
	declare(e, format("extern const double %s_Phi[%s_STATES][%s_STATES];", n, N, N), "y(t+h) = Phi y(t) + ...");
	if (inputs)
		declare(e, format("extern const double %s_Gamma[%s_STATES][%d];", n, N, input_columns(e->system)),
			e->ramps ? "... + Gamma u; of a ramp: before, after" : "... + Gamma u");
	declare(e, format("extern const pl_model %s_model;", n), "");
}

static void emit_declarations(const struct emitter *e, bool rhs)
{
	FILE *to = e->to;
	const char *N = e->upper;
	fprintf(to, "#ifndef %s_DECLARED\n#define %s_DECLARED\n\n#include \"plrt.h\"\n\n#ifdef __cplusplus\nextern \"C\" {\n#endif\n\n", N, N);
	fprintf(to, "enum { %s_STATES = %d, %s_INPUTS = %d, %s_OUTPUTS = %d };\n", N, e->system->states, N, e->system->inputs, N, e->model->outputs);
	fprintf(to, "#define %s_H %s  /* step [s] */\n\n", N, shortest(round_rational(e->model->h)));
	emit_state_struct(e);
	emit_functions(e, rhs);
	fputs("\n#ifdef __cplusplus\n}\n#endif\n\n#endif\n", to);
}

/* ---- sums ---- */

/* (a + b) + (c + d): the shortest chain of dependent additions; lines break at the middle of what is too long for one. */
const char *tree(int terms, const char *const *term, int indent)
{
	enum { WIDTH = 100 };
	if (terms == 1)
		return term[0];
	int half = (terms + 1) / 2;
	half += terms > 3 && half % 2;          /* pairs stay together */
	const char *left = tree(half, term, indent + 1), *right = tree(terms - half, term + half, indent + 1);
	left = half > 1 ? format("(%s)", left) : left;
	right = terms - half > 1 ? format("(%s)", right) : right;
	bool subtract = terms - half == 1 && right[0] == '-';
	const char *sign = subtract ? "-" : "+";
	right += subtract;
	bool wide = (int)(strlen(left) + strlen(right)) + indent > WIDTH;
	return wide ? format("%s\n%*s%s %s", left, indent, "", sign, right) : format("%s %s %s", left, sign, right);
}

double finite_number(const struct emitter *e, mpq_srcptr q)
{
	if (beyond_double(q))
		error(e->model->step_at, NULL, "a number of the equations is beyond the range of double");
	return round_rational(q);
}

const char *scaled(double factor, const char *operand)
{
	if (!operand)
		return shortest(factor);
	if (factor == 1)
		return operand;
	return factor == -1 ? format("-%s", operand) : format("%s * %s", shortest(factor), operand);
}

static void emit_locals(const struct emitter *e, const bool *reads)
{
	const char *list = "";
	for (int i = 0; i < e->system->states; i++)
		if (reads[i])
			list = format("%s%s%s = s->y[%d]", list, *list ? ", " : "    const double ", e->local[i], i);
	for (int width = 0; *list; list++) {            /* a line break instead of the blank that would pass column 110 */
		putc(*list == ' ' && width > 100 && list[-1] == ',' ? '\n' : *list, e->to);
		if (*list == ' ' && width > 100 && list[-1] == ',') {
			fputs("                 ", e->to);
			width = 17;
		}
		width++;
		if (!list[1])
			fputs(";\n", e->to);
	}
}

/* ---- the step ---- */

/* Held: the sample that the step is given. A ramp: the previous sample, then the one given. */
static const char *input_operand(const struct emitter *e, int column)
{
	for (int i = 0; i < e->system->inputs; i++) {
		int columns = e->system->input[i].first_order ? 2 : 1;
		if (column < columns)
			return format(columns == 2 && column == 0 ? "s->u[%d]" : "u[%d]", i);
		column -= columns;
	}
	return NULL;
}

static const char *operand_text(const struct emitter *e, const struct operand *operand)
{
	switch (operand->kind) {
	case OPERAND_STATE: return e->local[operand->index];
	case OPERAND_LOAD:  return column_operand(e, operand->index);
	default:            return input_operand(e, operand->index);
	}
}

/* A load that changes has its factors in a table, one row for each segment of time. */
static const char *term_text(const struct emitter *e, const struct assignment *a, const struct product *p)
{
	const char *operand = operand_text(e, &p->operand);
	if (p->operand.kind != OPERAND_LOAD || e->system->segments == 1)
		return scaled(p->factor->value, operand);
	const char *factor = format("factor[%d][%d]", a->target, p->operand.index);
	return operand ? format("%s * %s", factor, operand) : factor;
}

static void emit_assignment(const struct emitter *e, const struct assignment *a)
{
	const char **term = ARRAY(const char *, (size_t)a->terms + 1);
	for (int k = 0; k < a->terms; k++)
		term[k] = term_text(e, a, &a->term[k]);
	const char *sum = a->terms ? tree(a->terms, term, 14) : "0.0";
	fprintf(e->to, "    s->y[%d] = %s;  /* %s */\n", a->target, sum, e->model->state_name[a->target]);
}

static bool *loads_of_step(const struct emitter *e)
{
	bool *wanted = ARRAY(bool, (size_t)e->system->loads);
	for (int l = 0, column = 0; l < e->system->loads; l++)
		for (int k = 0; k < e->system->load[l].columns; k++, column++)
			wanted[l] = wanted[l] || e->step->program->uses[column];
	return wanted;
}

static void emit_keep_inputs(const struct emitter *e)
{
	for (int i = 0; i < e->system->inputs; i++) {
		if (e->system->input[i].first_order)
			fprintf(e->to, "    s->slope[%d] = (u[%d] - s->u[%d]) / %s_H;\n", i, i, i, e->upper);
		fprintf(e->to, "    s->u[%d] = u[%d];\n", i, i);
	}
}

static bool any_load_term(const struct program *program)
{
	for (int i = 0; i < program->assignments; i++)
		for (int k = 0; k < program->assignment[i].terms; k++)
			if (program->assignment[i].term[k].operand.kind == OPERAND_LOAD)
				return true;
	return false;
}

static void emit_load_factors(const struct emitter *e)
{
	const struct table *table = e->step->table;
	double *value = ARRAY(double, (size_t)(table->states * table->columns));
	fprintf(e->to, "\n/* Factors of the load states in each segment of time */\nstatic const double %s_load_factor[%d][%s_STATES][%d] = {\n",
		e->name, e->system->segments, e->upper, table->columns);
	for (int s = 0; s < e->system->segments; s++) {
		for (int i = 0; i < table->states * table->columns; i++)
			value[i] = table->load[s * table->states * table->columns + i].value;
		fputs("  {\n", e->to);
		emit_number_rows(e, table->states, table->columns, value, e->model->state_name);
		fputs("  },\n", e->to);
	}
	fputs("};\n", e->to);
}

/* vector[...] = the operands of the columns of a table; then y[i] += table[i][...] vector[...] */
static void emit_columns(const struct emitter *e, const char *table, const char *vector, enum operand_kind kind, int columns)
{
	if (columns == 0)
		return;
	fprintf(e->to, "    const double %s[%d] = {", vector, columns);
	for (int k = 0; k < columns; k++) {
		const char *operand = operand_text(e, &(struct operand){ kind, k });
		fprintf(e->to, "%s%s", k ? ", " : "", operand ? operand : "1.0");
	}
	fprintf(e->to, "};\n    for (i = 0; i < %s_STATES; i++)\n        for (j = 0; j < %d; j++)\n            y[i] += %s[i][j] * %s[j];\n", e->upper, columns,
		table, vector);
}

/* A large model steps by loops over its tables: text that nobody would read is of no use. */
static void emit_looped_step(const struct emitter *e)
{
	FILE *to = e->to;
	const char *n = e->name, *N = e->upper;
	const struct table *table = e->step->table;
	bool *loads = ARRAY(bool, (size_t)e->system->loads);
	for (int l = 0; l < e->system->loads; l++)
		loads[l] = true;
	fprintf(to, "    double y[%s_STATES];\n    int i, j;\n", N);
	emit_load_states(e, loads, false);
	fprintf(to, "    for (i = 0; i < %s_STATES; i++) {\n        y[i] = 0.0;\n        for (j = 0; j < %s_STATES; j++)\n", N, N);
	fprintf(to, "            y[i] += %s_Phi[i][j] * s->y[j];\n    }\n", n);
	emit_columns(e, format("%s_load_factor[%s]", n, e->system->segments > 1 ? "s->segment" : "0"), "load", OPERAND_LOAD, table->columns);
	emit_columns(e, format("%s_Gamma", n), "input", OPERAND_INPUT, table->inputs);
	fprintf(to, "    for (i = 0; i < %s_STATES; i++)\n        s->y[i] = y[i];\n", N);
}

/* A step that no change of the loads interrupts */
static void emit_plain_step(const struct emitter *e)
{
	const struct program *program = e->step->program;
	if (program->loops) {
		emit_looped_step(e);
		return;
	}
	emit_locals(e, program->reads);
	emit_load_states(e, loads_of_step(e), false);
	if (e->system->segments > 1 && any_load_term(program))
		fprintf(e->to, "    const double (*const factor)[%d] = %s_load_factor[s->segment];\n", e->step->table->columns, e->name);
	for (int i = 0; i < program->assignments; i++)
		emit_assignment(e, &program->assignment[i]);
}

static void emit_step_end(const struct emitter *e)
{
	emit_keep_inputs(e);
	emit_load_advance(e, NULL);
	fputs("    s->k++;\n", e->to);
}

static const char *step_parameters(const struct emitter *e)
{
	return format("%s *s%s", e->name, e->system->inputs ? format(", const double u[%s_INPUTS]", e->upper) : "");
}

static void emit_changing_step(const struct emitter *e)
{
	const char *n = e->name, *u = e->system->inputs ? "u, " : "";
	int changes = e->system->segments - 1;
	if (any_load_term(e->step->program) && !e->step->program->loops)
		emit_load_factors(e);
	fprintf(e->to, "\nstatic void %s_plain_step(%s)\n{\n", e->name, step_parameters(e));
	emit_plain_step(e);
	if (e->system->inputs)
		fputs("    (void)u;\n", e->to);
	fprintf(e->to, "}\n\nvoid %s_step(%s)\n{\n", n, step_parameters(e));
	fprintf(e->to, "    if (s->segment < %d && %s_until(s, s->segment) < %s_H) {\n", changes, n, e->upper);
	fprintf(e->to, "        double y[%s_STATES];\n        int i;\n        %s_pass(s, %s%s_H, y);\n", e->upper, n, u, e->upper);
	fprintf(e->to, "        for (i = 0; i < %s_STATES; i++)\n            s->y[i] = y[i];\n    } else {\n        %s_plain_step(s%s);\n    }\n", e->upper, n,
		*u ? ", u" : "");
	emit_step_end(e);
	fprintf(e->to, "    while (s->segment < %d && %s_until(s, s->segment) <= 1e-18 * %s_H)\n        s->segment++;\n}\n", changes, n, e->upper);
}

static void emit_step(const struct emitter *e)
{
	if (e->step->program->loops && e->step->table->columns)
		emit_load_factors(e);
	if (e->system->segments > 1) {
		emit_changing_step(e);
		return;
	}
	fprintf(e->to, "\nvoid %s_step(%s)\n{\n", e->name, step_parameters(e));
	emit_plain_step(e);
	emit_step_end(e);
	fputs("}\n", e->to);
}

/* ---- init, set, get, time ---- */

static void emit_init(const struct emitter *e)
{
	fprintf(e->to, "\nvoid %s_init(%s *s)\n{\n    static const double start[%s_STATES] = {", e->name, e->name, e->upper);
	for (int i = 0; i < e->system->states; i++)
		fprintf(e->to, "%s%s", i ? ", " : "", shortest(round_rational(e->model->initial[i])));
	fputs("};\n", e->to);
	for (int i = 0; i < e->system->inputs; i++) {
		fprintf(e->to, "    s->u[%d] = 0.0;\n", i);
		if (e->ramps)
			fprintf(e->to, "    s->slope[%d] = 0.0;\n", i);
	}
	fprintf(e->to, "    %s_set(s, 0.0, start);\n}\n", e->name);
}

/* t0 + k p/q with p and q exact is one rounding away from the exact time while k p < 2^53. */
static void emit_time(const struct emitter *e)
{
	mpz_srcptr p = mpq_numref(e->model->h), q = mpq_denref(e->model->h);
	bool short_fraction = mpz_sizeinbase(p, 2) <= 40 && mpz_sizeinbase(q, 2) <= 53;
	const char *factor = mpz_cmp_ui(p, 1) == 0 ? "" : format(" * %s", shortest(mpz_get_d(p)));
	const char *divisor = mpz_cmp_ui(q, 1) == 0 ? "" : format(" / %s", shortest(mpz_get_d(q)));
	fprintf(e->to, "\ndouble %s_time(const %s *s)\n{\n    return s->t0 + (double)s->k%s%s;\n}\n", e->name, e->name,
		short_fraction ? factor : format(" * %s_H", e->upper), short_fraction ? divisor : "");
}

static void emit_access(const struct emitter *e)
{
	FILE *to = e->to;
	const char *n = e->name, *N = e->upper;
	emit_init(e);
	fprintf(to, "\nvoid %s_set(%s *s, double t, const double y[%s_STATES])\n{\n    int i;\n", n, n, N);
	fprintf(to, "    for (i = 0; i < %s_STATES; i++)\n        s->y[i] = y[i];\n    s->t0 = t;\n    s->k = 0;\n", N);
	emit_load_set(e);
	if (e->system->segments > 1)
		fprintf(to, "    for (s->segment = 0; s->segment < %d && %s_until(s, s->segment) <= 1e-18 * %s_H;)\n        s->segment++;\n",
			e->system->segments - 1, n, N);
	fprintf(to, "}\n\nvoid %s_get(const %s *s, double y[%s_STATES])\n{\n    int i;\n", n, n, N);
	fprintf(to, "    for (i = 0; i < %s_STATES; i++)\n        y[i] = s->y[i];\n}\n", N);
	emit_time(e);
	if (e->ramps)
		fprintf(to, "\nvoid %s_hold(%s *s, const double u[%s_INPUTS])\n{\n    int i;\n    for (i = 0; i < %s_INPUTS; i++)\n        s->u[i] = u[i];\n}\n",
			n, n, N, N);
}

/* ---- out, run ---- */

void emit_used_constants(const struct emitter *e, bool lets)
{
	for (const struct symbol *s = e->model->spec->first; s; s = s->next) {
		if (!s->used || (s->kind != SYMBOL_PARAM && s->kind != SYMBOL_LET))
			continue;
		if (s->kind == SYMBOL_PARAM) {
			struct collector collector = { .scheme = "exact" };
			mpq_t value;
			mpq_init(value);
			constant_value(&collector, s->collected->cell[0], value);
			fprintf(e->to, "    const double %s = %s;\n", s->c_name, finite_text(s->at, value));
			mpq_clear(value);
		} else if (lets) {
			fprintf(e->to, "    const double %s = %s;\n", s->c_name, c_expression(s->value));
		}
	}
}

void clear_used(const struct spec *spec)
{
	for (struct symbol *s = spec->first; s; s = s->next)
		s->used = s->slope_used = false;
}

bool uses_time(const struct node *node)
{
	bool found = node->kind == NODE_TIME || (node->kind == NODE_NAME && node->symbol->kind == SYMBOL_LET && uses_time(node->symbol->value));
	for (int i = 0; i < node->children && !found; i++)
		found = uses_time(node->child[i]);
	return found;
}

static int state_of_node(const struct model *written, const struct node *node)
{
	int coord = node->symbol->index + (node->component ? node->component - 1 : 0);
	return node->primes ? written->system.velocity[coord] : coord;
}

/* Flags the written states that an expression reads. */
void mark_states(const struct model *written, const struct node *node, bool *reads)
{
	if (vanishes(node))
		return;
	if (node->kind == NODE_NAME && node->symbol->kind == SYMBOL_COORD && node->primes < node->symbol->highest)
		reads[state_of_node(written, node)] = true;
	if (node->kind == NODE_NAME && node->symbol->kind == SYMBOL_LET)
		mark_states(written, node->symbol->value, reads);
	for (int i = 0; i < node->children; i++)
		mark_states(written, node->child[i], reads);
}

static bool changes(const mpq_t *factor, int segments)
{
	for (int s = 1; s < segments; s++)
		if (!mpq_equal(factor[0], factor[s]))
			return true;
	return false;
}

static bool any_factor(const struct emitter *e, const struct output *output, int load, int column)
{
	for (int s = 0; s < e->system->segments; s++)
		if (mpq_sgn(output->load[load][column * e->system->segments + s]) != 0)
			return true;
	return false;
}

/* A load in an output: its factor, or where that changes its place in the table direct[segment][output] */
static const char *direct_term(const struct emitter *e, const struct output *output, int load, int k, int column)
{
	const mpq_t *factor = (const mpq_t *)output->load[load] + k * e->system->segments;
	const char *operand = load_operand(e, load, k);
	if (!changes(factor, e->system->segments))
		return scaled(round_rational(factor[0]), operand);
	const char *text = format("%s_direct[s->segment][%d][%d]", e->name, (int)(output - e->model->output), column);
	return operand ? format("%s * %s", text, operand) : text;
}

/* Factors of the load states in the outputs, where one changes its formula */
static void emit_direct_factors(const struct emitter *e)
{
	const struct linear *system = e->system;
	int columns = load_columns(system);
	bool any = false;
	for (int o = 0; o < e->model->outputs; o++)
		for (int l = 0; l < system->loads; l++)
			for (int k = 0; k < system->load[l].columns; k++)
				any = any || changes((const mpq_t *)e->model->output[o].load[l] + k * system->segments, system->segments);
	if (!any)
		return;
	fprintf(e->to, "\nstatic const double %s_direct[%d][%s_OUTPUTS][%d] = {  /* factors of the load states in each segment of time */\n",
		e->name, system->segments, e->upper, columns);
	for (int s = 0; s < system->segments; s++) {
		fputs("  {\n", e->to);
		for (int o = 0; o < e->model->outputs; o++) {
			const char *row = "";
			for (int l = 0; l < system->loads; l++)
				for (int k = 0; k < system->load[l].columns; k++)
					row = format("%s%s%s", row, *row ? ", " : "", shortest(round_rational(e->model->output[o].load[l][k * system->segments + s])));
			fprintf(e->to, "    {%s},  /* %s */\n", row, e->model->output[o].name);
		}
		fputs("  },\n", e->to);
	}
	fputs("};\n", e->to);
}

static double output_factor(const struct output *output, mpq_srcptr factor)
{
	if (beyond_double(factor))
		error(output->value->start, NULL, "a factor of output '%s' is beyond the range of double", output->name);
	return round_rational(factor);
}

static const char *linear_output(const struct emitter *e, const struct output *output)
{
	const struct linear *system = e->system;
	const char **term = ARRAY(const char *, (size_t)(system->states + load_columns(system) + 2 * system->inputs + 1));
	int terms = 0;
	for (int i = 0; i < system->states; i++)
		if (mpq_sgn(output->state[i]) != 0)
			term[terms++] = scaled(output_factor(output, output->state[i]), e->local[i]);
	for (int l = 0, column = 0; l < system->loads; l++)
		for (int k = 0; k < system->load[l].columns; k++, column++)
			if (any_factor(e, output, l, k))
				term[terms++] = direct_term(e, output, l, k, column);
	for (int k = 0; k < 2; k++)
		for (int i = 0; i < system->inputs; i++)
			if (mpq_sgn(output->input[k][i]) != 0)
				term[terms++] = scaled(output_factor(output, output->input[k][i]), format(k ? "s->slope[%d]" : "s->u[%d]", i));
	return terms ? tree(terms, term, 13) : "0.0";
}

struct output_needs {
	bool *reads, *loads, *inputs, time, state;
};

static void mark_inputs(const struct node *node, bool *inputs, int count)
{
	if (node->kind == NODE_NAME && node->symbol->kind == SYMBOL_INPUT)
		inputs[node->symbol->index + node->primes * count] = true;
	if (node->kind == NODE_NAME && node->symbol->kind == SYMBOL_LET)
		mark_inputs(node->symbol->value, inputs, count);
	for (int i = 0; i < node->children; i++)
		mark_inputs(node->child[i], inputs, count);
}

static void mark_output_states(const struct emitter *e, const struct node *value, bool *reads)
{
	const struct model *written = e->model->written;
	bool *seen = ARRAY(bool, (size_t)written->system.states);
	mark_states(written, value, seen);
	for (int i = 0; i < written->system.states; i++)
		if (seen[i])
			reads[e->model->place ? e->model->place[i] : i] = true;
}

static void mark_output(const struct emitter *e, const struct output *output, struct output_needs *needs)
{
	bool math = false;
	if (!output->form && output->value) {
		mark_used(output->value, &math);
		mark_output_states(e, output->value, needs->reads);
		mark_inputs(output->value, needs->inputs, e->system->inputs);
		needs->time = needs->time || uses_time(output->value);
		return;
	}
	for (int i = 0; i < e->system->states; i++)
		needs->reads[i] = needs->reads[i] || mpq_sgn(output->state[i]) != 0;
	for (int l = 0; l < e->system->loads; l++)
		for (int k = 0; k < e->system->load[l].columns; k++)
			needs->loads[l] = needs->loads[l] || any_factor(e, output, l, k);
	for (int i = 0; i < 2 * e->system->inputs; i++)
		needs->state = needs->state || mpq_sgn(output->input[i / e->system->inputs][i % e->system->inputs]) != 0;
}

static void emit_input_locals(const struct emitter *e, const bool *wanted)
{
	for (const struct symbol *s = e->model->spec->first; s; s = s->next)
		for (int k = 0; k < 2 && s->kind == SYMBOL_INPUT; k++)
			if (wanted[s->index + k * e->system->inputs])
				fprintf(e->to, "    const double %s = s->%s[%d];\n", k ? s->c_dot : s->c_name, k ? "slope" : "u", s->index);
}

static void emit_out(const struct emitter *e)
{
	FILE *to = e->to;
	const struct model *model = e->model;
	if (model->declared_outputs)
		emit_direct_factors(e);
	fprintf(to, "\nvoid %s_out(const %s *s, double out[%s_OUTPUTS])\n{\n", e->name, e->name, e->upper);
	if (!model->declared_outputs) {
		fprintf(to, "    %s_get(s, out);\n}\n", e->name);
		return;
	}
	struct output_needs needs = { ARRAY(bool, (size_t)e->system->states), ARRAY(bool, (size_t)e->system->loads),
				      ARRAY(bool, 2 * (size_t)e->system->inputs), false, false };
	clear_used(model->spec);
	for (int i = 0; i < model->outputs; i++)
		mark_output(e, &model->output[i], &needs);
	emit_locals(e, needs.reads);
	emit_input_locals(e, needs.inputs);
	if (needs.time)
		fprintf(to, "    const double t = %s_time(s);\n", e->name);
	emit_used_constants(e, true);
	emit_load_states(e, needs.loads, needs.time);
	for (int i = 0; i < model->outputs; i++) {
		const struct output *output = &model->output[i];
		bool linear = output->form || !output->value;
		fprintf(to, "    out[%d] = %s;  /* %s */\n", i, linear ? linear_output(e, output) : c_expression(output->value), output->name);
	}
	fputs("    (void)s;\n}\n", to);
}

static void emit_run(const struct emitter *e)
{
	bool inputs = e->system->inputs > 0;
	fprintf(e->to, "\nvoid %s_run(%s *s, size_t n, %sdouble *out)\n{\n    for (; n > 0; n--) {\n", e->name, e->name, inputs ? "const double *u, " : "");
	if (inputs)
		fprintf(e->to, "        %s_step(s, u);\n        u += %s_INPUTS;\n", e->name, e->upper);
	else
		fprintf(e->to, "        %s_step(s);\n", e->name);
	fprintf(e->to, "        if (out) {\n            %s_out(s, out);\n            out += %s_OUTPUTS;\n        }\n    }\n}\n", e->name, e->upper);
}

/* ---- tables and descriptor ---- */

void emit_number_rows(const struct emitter *e, int rows, int columns, const double *value, const char *const *row_note)
{
	for (int i = 0; i < rows; i++) {
		fputs("    {", e->to);
		for (int j = 0; j < columns; j++) {
			if (!isfinite(value[i * columns + j]))
				error(e->model->step_at, NULL, "a number in the row of %s is beyond the range of double", row_note[i]);
			fprintf(e->to, "%s%s", j ? ", " : "", shortest(value[i * columns + j]));
		}
		fprintf(e->to, "},  /* %s */\n", row_note[i]);
	}
}

static void emit_phi(const struct emitter *e)
{
	int n = e->system->states;
	double *value = ARRAY(double, (size_t)(n * n));
	for (int i = 0; i < n * n; i++)
		value[i] = e->step->table->Phi[i].value;
	fprintf(e->to, "\nconst double %s_Phi[%s_STATES][%s_STATES] = {  /* columns: %s */\n", e->name, e->upper, e->upper, state_list(e->model));
	emit_number_rows(e, n, n, value, e->model->state_name);
	fputs("};\n", e->to);
}

static void emit_gamma(const struct emitter *e)
{
	const struct table *table = e->step->table;
	double *value = ARRAY(double, (size_t)(table->states * table->inputs));
	for (int i = 0; i < table->states * table->inputs; i++)
		value[i] = table->input[i].value;
	fprintf(e->to, "\nconst double %s_Gamma[%s_STATES][%d] = {\n", e->name, e->upper, table->inputs);
	emit_number_rows(e, table->states, table->inputs, value, e->model->state_name);
	fputs("};\n", e->to);
}

static void emit_name_list(const struct emitter *e, const char *array, int count, const char *const *name)
{
	fprintf(e->to, "static const char *const %s_%s[] = {", e->name, array);
	for (int i = 0; i < count; i++)
		fprintf(e->to, "%s\"%s\"", i == 0 ? "" : i % 10 ? ", " : ",\n    ", name[i]);
	fputs("};\n", e->to);
}

static void emit_wrapper(const struct emitter *e, const char *result, const char *function, const char *parameters, const char *arguments, bool is_const)
{
	const char *state = format(is_const ? "const struct %s" : "struct %s", e->name); /* the tag: a parameter may bear the name */
	fprintf(e->to, "static %s %s_any_%s(%svoid *s%s) { %s%s_%s((%s *)s%s); }\n", result, e->name, function, is_const ? "const " : "", parameters,
		*result == 'd' ? "return " : !e->system->inputs && strstr(parameters, "*u") ? "(void)u; " : "", e->name, function, state, arguments);
}

static void emit_descriptor(const struct emitter *e)
{
	FILE *to = e->to;
	const char *n = e->name, *N = e->upper;
	bool at = e->step->series.emitted, inputs = e->system->inputs > 0;
	const char **output = ARRAY(const char *, (size_t)e->model->outputs), **input = ARRAY(const char *, (size_t)e->system->inputs);
	for (int i = 0; i < e->model->outputs; i++)
		output[i] = e->model->output[i].name;
	for (int i = 0; i < e->system->inputs; i++)
		input[i] = e->system->input[i].name;
	fputs("\n/* The same functions for programs that drive any model. */\n\n", to);
	emit_name_list(e, "state_names", e->system->states, e->model->state_name);
	if (inputs)
		emit_name_list(e, "input_names", e->system->inputs, input);
	emit_name_list(e, "output_names", e->model->outputs, output);
	fputc('\n', to);
	emit_wrapper(e, "void", "init", "", "", false);
	emit_wrapper(e, "void", "set", ", double t, const double *y", ", t, y", false);
	emit_wrapper(e, "void", "get", ", double *y", ", y", true);
	emit_wrapper(e, "double", "time", "", "", true);
	emit_wrapper(e, "void", "step", ", const double *u", inputs ? ", u" : "", false);
	emit_wrapper(e, "void", "out", ", double *out", ", out", true);
	emit_wrapper(e, "void", "run", ", size_t n, const double *u, double *out", inputs ? ", n, u, out" : ", n, out", false);
	if (at)
		emit_wrapper(e, "void", "at", ", const double *u, double tau, double *y", inputs ? ", u, tau, y" : ", tau, y", true);
	if (has_jump(e))
		emit_wrapper(e, "void", "jump", ", uint64_t n", ", n", false);
	fprintf(to, "\nconst pl_model %s_model = {\n    \"%s\", sizeof(struct %s), %s_STATES, %s_INPUTS, %s_OUTPUTS, %s_H,\n", n, n, n, N, N, N, N);
	fprintf(to, "    %s_state_names, %s, %s_output_names,\n", n, inputs ? format("%s_input_names", n) : "NULL", n);
	fprintf(to, "    %s_any_init, %s_any_set, %s_any_get, %s_any_time, %s_any_step,\n    %s_any_out, %s_any_run, %s, %s\n};\n", n, n, n, n, n, n, n,
		at ? format("%s_any_at", n) : "NULL", has_jump(e) ? format("%s_any_jump", n) : "NULL");
}

/* ---- the two texts ---- */

void emit_header(FILE *to, const struct step *step, const char *options, bool rhs)
{
	struct emitter e = emitter_new(to, step, options);
	emit_banner(&e);
	emit_declarations(&e, rhs);
}

static bool needs_math(const struct emitter *e, bool rhs)
{
	bool math = false;
	clear_used(e->model->spec);
	for (int i = 0; i < e->model->outputs; i++)
		if (e->model->output[i].value && !e->model->output[i].form)
			mark_used(e->model->output[i].value, &math);
	return math || (rhs && rhs_needs_math(e->model));
}

void emit_code(FILE *to, const struct step *step, const char *options, const char *header_name, bool rhs)
{
	struct emitter e = emitter_new(to, step, options);
	emit_banner(&e);
	if (header_name)
		fprintf(to, "#include \"%s\"\n", header_name);
	else
		emit_declarations(&e, rhs);
	if (needs_math(&e, rhs))
		fputs("\n#include <math.h>\n", to);
	emit_phi(&e);
	if (e.system->inputs)
		emit_gamma(&e);
	emit_load_tables(&e);
	if (e.system->segments > 1)
		emit_changes(&e);
	emit_access(&e);
	if (e.system->segments > 1)
		emit_passing(&e);
	emit_step(&e);
	emit_out(&e);
	emit_run(&e);
	if (step->series.emitted)
		emit_at(&e);
	if (has_jump(&e))
		emit_jump(&e);
	if (rhs)
		emit_rhs(&e);
	emit_descriptor(&e);
}
