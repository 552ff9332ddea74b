/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A step program and its tables as C. Everything printed here is meant to be read. */
#include "plgen.h"

#include <ctype.h>
#include <string.h>

struct emitter {
	FILE *to;
	const struct step *step;
	const struct model *model;
	const struct linear *system;
	const char *name, *upper;   /* scs, SCS */
	const char *options;
	int waves;                  /* phases in the state */
	int *phase;                 /* per load: index of its phase, -1 for a constant */
};

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
	e.name = step->model->name;
	e.upper = upper_case(e.name);
	e.phase = ARRAY(int, (size_t)e.system->loads);
	for (int l = 0; l < e.system->loads; l++)
		e.phase[l] = e.system->load[l].wave ? e.waves++ : -1;
	name_for_c(step->model->spec, e.name, e.upper);
	return e;
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
	for (int i = 0; i < model->states; i++)
		list = format("%s%s%s", list, i ? ", " : "", model->state_name[i]);
	return list;
}

static void banner_cost(const struct emitter *e)
{
	const struct program *program = e->step->program;
	fprintf(e->to, " * One step of h = %s s, form direct: %d multiplications, %d additions", readable_text(e->model->h),
		program->multiplications, program->additions);
	if (program->oscillators)
		fprintf(e->to, ", %d of them and %d for cos and sin of the load%s", program->oscillators * PL_COSSIN_MUL,
			program->oscillators * PL_COSSIN_ADD, program->oscillators > 1 ? "s" : "");
	fprintf(e->to, ".\n * State y = %s.\n", state_list(e->model));
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

static void emit_declarations(const struct emitter *e, bool rhs)
{
	FILE *to = e->to;
	const char *n = e->name, *N = e->upper;
	fprintf(to, "#ifndef %s_DECLARED\n#define %s_DECLARED\n\n#include \"plrt.h\"\n\n#ifdef __cplusplus\nextern \"C\" {\n#endif\n\n", N, N);
	fprintf(to, "enum { %s_STATES = %d, %s_INPUTS = 0, %s_OUTPUTS = %d };\n", N, e->model->states, N, N, e->model->outputs);
	fprintf(to, "#define %s_H %s  /* step [s] */\n\n", N, shortest(round_rational(e->model->h)));
	fprintf(to, "typedef struct %s %s;  /* copy it to save, assign it to restore */\n", n, n);
	fprintf(to, "struct %s {\n    double y[%s_STATES];  /* %s */\n", n, N, state_list(e->model));
	if (e->waves)
		fprintf(to, "    pl_turn phase[%d];    /* of the loads */\n", e->waves);
	fprintf(to, "    double t0;            /* [s]; time is t0 + k h */\n    uint64_t k;           /* steps since then */\n};\n\n");
	fprintf(to, "void   %s_init(%s *s);                                          /* t = 0, the spec's initial values */\n", n, n);
	fprintf(to, "void   %s_set(%s *s, double t, const double y[%s_STATES]);\n", n, n, N);
	fprintf(to, "void   %s_get(const %s *s, double y[%s_STATES]);\n", n, n, N);
	fprintf(to, "double %s_time(const %s *s);                                    /* [s] */\n", n, n);
	fprintf(to, "void   %s_step(%s *s);                                          /* one step of h */\n", n, n);
	fprintf(to, "void   %s_out(const %s *s, double out[%s_OUTPUTS]);\n", n, n, N);
	fprintf(to, "void   %s_run(%s *s, size_t n, double *out);                    /* n steps; out: n rows of outputs, or NULL */\n", n, n);
	if (e->step->series.emitted)
		fprintf(to, "void   %s_at(const %s *s, double tau, double y[%s_STATES]);     /* the state tau after now, 0 <= tau <= h */\n", n, n, N);
	fprintf(to, "void   %s_jump(%s *s, uint64_t n);                              /* as n steps would, in log n time */\n", n, n);
	if (rhs)
		fprintf(to, "void   %s_rhs(double t, const double y[], double dydt[]);       /* the equations as written */\n", n);
	fprintf(to, "extern const double %s_Phi[%s_STATES][%s_STATES];               /* y(t+h) = Phi y(t) + loads */\n", n, N, N);
	fprintf(to, "extern const pl_model %s_model;\n\n#ifdef __cplusplus\n}\n#endif\n\n#endif\n", n);
}

/* ---- sums ---- */

/* (a + b) + (c + d): the shortest chain of dependent additions; lines break at the middle of what is too long for one. */
static const char *tree(int terms, const char *const *term, int indent)
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

static const char *scaled(double factor, const char *operand)
{
	if (!operand)
		return shortest(factor);
	if (factor == 1)
		return operand;
	return factor == -1 ? format("-%s", operand) : format("%s * %s", shortest(factor), operand);
}

/* What stands for the state's old value and for a column of the loads (NULL: the constant 1) in step and out. */
static const char *state_local(const struct emitter *e, int state)
{
	const struct symbol *coord = e->model->coord[state % e->model->n];
	return state < e->model->n ? coord->c_name : coord->c_dot;
}

static const char *load_local(const struct emitter *e, int column)
{
	int l = 0;
	for (; column >= e->system->load[l].columns; l++)
		column -= e->system->load[l].columns;
	return e->system->load[l].wave ? format("wave%d[%d]", e->phase[l] + 1, column) : NULL;
}

static void emit_locals(const struct emitter *e, const bool *reads)
{
	const char *list = "";
	for (int i = 0; i < e->model->states; i++)
		if (reads[i])
			list = format("%s%s%s = s->y[%d]", list, *list ? ", " : "    const double ", state_local(e, i), i);
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

static void emit_wave(const struct emitter *e, int load)
{
	int phase = e->phase[load];
	fprintf(e->to, "    double wave%d[2];  /* %s, %s */\n    pl_cossin(s->phase[%d], wave%d);\n", phase + 1,
		wave_text(e->system->load[load].wave, false), wave_text(e->system->load[load].wave, true), phase, phase + 1);
}

/* ---- the step ---- */

static void emit_assignment(const struct emitter *e, const struct assignment *a)
{
	const char **term = ARRAY(const char *, (size_t)a->terms + 1);
	for (int k = 0; k < a->terms; k++) {
		const struct product *p = &a->term[k];
		term[k] = scaled(p->factor->value, p->operand.kind == OPERAND_STATE ? state_local(e, p->operand.index) : load_local(e, p->operand.index));
	}
	const char *sum = a->terms ? tree(a->terms, term, 14) : "0.0";
	fprintf(e->to, "    s->y[%d] = %s;  /* %s */\n", a->target, sum, e->model->state_name[a->target]);
}

static bool wave_is_used(const struct emitter *e, int load)
{
	int column = 0;
	for (int l = 0; l < load; l++)
		column += e->system->load[l].columns;
	return e->system->load[load].wave && (e->step->program->uses[column] || e->step->program->uses[column + 1]);
}

static void emit_step(const struct emitter *e)
{
	const struct program *program = e->step->program;
	fprintf(e->to, "\nvoid %s_step(%s *s)\n{\n", e->name, e->name);
	emit_locals(e, program->reads);
	for (int l = 0; l < e->system->loads; l++)
		if (wave_is_used(e, l))
			emit_wave(e, l);
	for (int i = 0; i < program->assignments; i++)
		emit_assignment(e, &program->assignment[i]);
	for (int i = 0; i < e->waves; i++)
		fprintf(e->to, "    s->phase[%d] = pl_turn_add(s->phase[%d], %s_phase_step[%d]);\n", i, i, e->name, i);
	fputs("    s->k++;\n}\n", e->to);
}

/* ---- phases ---- */

/* x turns as 128 bits, wrapped; x a multiple of 1/2 pi of the rational q */
static void turns(mpq_srcptr q, uint64_t word[2])
{
	mpfr_t x, pi;
	mpz_t fraction, half;
	mpfr_inits2(2048, x, pi, NULL);
	mpz_inits(fraction, half, NULL);
	mpfr_const_pi(pi, MPFR_RNDN);
	mpfr_set_q(x, q, MPFR_RNDN);
	mpfr_div(x, x, pi, MPFR_RNDN);
	mpfr_mul_2si(x, x, 127, MPFR_RNDN);
	mpfr_get_z(fraction, x, MPFR_RNDN);
	mpz_fdiv_r_2exp(fraction, fraction, 128);
	mpz_fdiv_r_2exp(half, fraction, 64);
	word[1] = mpz_get_ui(half);
	mpz_fdiv_q_2exp(half, fraction, 64);
	word[0] = mpz_get_ui(half);
	mpz_clears(fraction, half, NULL);
	mpfr_clears(x, pi, NULL);
}

static void emit_turns(const struct emitter *e, const char *name, const char *what, bool per_step)
{
	fprintf(e->to, "\nstatic const pl_turn %s_%s[%d] = {  /* %s */\n", e->name, name, e->waves, what);
	mpq_t angle;
	mpq_init(angle);
	for (int l = 0; l < e->system->loads; l++) {
		const struct wave *wave = e->system->load[l].wave;
		if (!wave)
			continue;
		mpq_set(angle, wave->p);
		if (per_step)
			mpq_mul(angle, wave->w, e->model->h);
		uint64_t word[2];
		turns(angle, word);
		fprintf(e->to, "    {UINT64_C(0x%016llx), UINT64_C(0x%016llx)},  /* %s */\n", (unsigned long long)word[0],
			(unsigned long long)word[1], wave_text(wave, false));
	}
	mpq_clear(angle);
	fputs("};\n", e->to);
}

static void emit_rates(const struct emitter *e)
{
	fprintf(e->to, "\nstatic const pl_rate %s_phase_rate[%d] = {  /* turns per second */\n", e->name, e->waves);
	for (int l = 0; l < e->system->loads; l++) {
		const struct wave *wave = e->system->load[l].wave;
		if (!wave)
			continue;
		mpfr_t rate, pi;
		mpz_t word, digits;
		mpfr_init2(rate, 192);
		mpfr_init2(pi, 512);
		mpz_inits(word, digits, NULL);
		mpfr_const_pi(pi, MPFR_RNDN);
		mpfr_mul_ui(pi, pi, 2, MPFR_RNDN);
		mpfr_t wide;
		mpfr_init2(wide, 512);
		mpfr_set_q(wide, wave->w, MPFR_RNDN);
		mpfr_div(rate, wide, pi, MPFR_RNDN);
		long exponent = mpfr_get_z_2exp(digits, rate);
		fputs("    {{", e->to);
		for (int k = 2; k >= 0; k--) {
			mpz_fdiv_q_2exp(word, digits, (mp_bitcnt_t)k * 64);
			mpz_fdiv_r_2exp(word, word, 64);
			fprintf(e->to, "UINT64_C(0x%016llx)%s", (unsigned long long)mpz_get_ui(word), k ? ", " : "");
		}
		fprintf(e->to, "}, %ld},  /* %s */\n", -exponent, wave_text(wave, false));
		mpz_clears(word, digits, NULL);
		mpfr_clears(rate, pi, wide, NULL);
	}
	fputs("};\n", e->to);
}

/* ---- init, set, get, time ---- */

static void emit_access(const struct emitter *e)
{
	FILE *to = e->to;
	const char *n = e->name, *N = e->upper;
	fprintf(to, "\nvoid %s_init(%s *s)\n{\n    static const double start[%s_STATES] = {", n, n, N);
	for (int i = 0; i < e->model->states; i++)
		fprintf(to, "%s%s", i ? ", " : "", shortest(round_rational(e->model->initial[i])));
	fprintf(to, "};\n    %s_set(s, 0.0, start);\n}\n", n);
	fprintf(to, "\nvoid %s_set(%s *s, double t, const double y[%s_STATES])\n{\n    int i;\n", n, n, N);
	fprintf(to, "    for (i = 0; i < %s_STATES; i++)\n        s->y[i] = y[i];\n    s->t0 = t;\n    s->k = 0;\n", N);
	if (e->waves)
		fprintf(to, "    for (i = 0; i < %d; i++)\n        s->phase[i] = pl_turn_add(%s_phase_start[i], pl_turn_at(&%s_phase_rate[i], t));\n", e->waves, n, n);
	fprintf(to, "}\n\nvoid %s_get(const %s *s, double y[%s_STATES])\n{\n    int i;\n", n, n, N);
	fprintf(to, "    for (i = 0; i < %s_STATES; i++)\n        y[i] = s->y[i];\n}\n", N);
	mpz_srcptr p = mpq_numref(e->model->h), q = mpq_denref(e->model->h);
	bool short_fraction = mpz_sizeinbase(p, 2) <= 40 && mpz_sizeinbase(q, 2) <= 53;
	const char *factor = mpz_cmp_ui(p, 1) == 0 ? "" : format(" * %s", shortest(mpz_get_d(p)));
	const char *divisor = mpz_cmp_ui(q, 1) == 0 ? "" : format(" / %s", shortest(mpz_get_d(q)));
	fprintf(to, "\ndouble %s_time(const %s *s)\n{\n    return s->t0 + (double)s->k%s%s;\n}\n", n, n,
		short_fraction ? factor : format(" * %s_H", N), short_fraction ? divisor : "");
}

/* ---- out, run ---- */

struct output_needs {
	bool *reads, *waves, time;
};

static void mark_output(const struct emitter *e, const struct output *output, struct output_needs *needs)
{
	for (int i = 0; output->form && i < e->model->states; i++)
		needs->reads[i] = needs->reads[i] || mpq_sgn(output->state[i]) != 0;
	for (int l = 0; output->form && l < e->system->loads; l++)
		needs->waves[l] = needs->waves[l] || mpq_sgn(output->load[0][l]) != 0 || mpq_sgn(output->load[1][l]) != 0;
	needs->time = needs->time || (output->form && mpq_sgn(output->time) != 0);
}

static double output_factor(const struct output *output, mpq_srcptr factor)
{
	if (beyond_double(factor))
		error(output->value->start, NULL, "a factor of output '%s' is beyond the range of double", output->name);
	return round_rational(factor);
}

static const char *linear_output(const struct emitter *e, const struct output *output)
{
	const char **term = ARRAY(const char *, (size_t)(e->model->states + 2 * e->system->loads + 2));
	int terms = 0;
	for (int i = 0; i < e->model->states; i++)
		if (mpq_sgn(output->state[i]) != 0)
			term[terms++] = scaled(output_factor(output, output->state[i]), state_local(e, i));
	for (int l = 0; l < e->system->loads; l++)
		for (int k = 0; k < 2; k++)
			if (mpq_sgn(output->load[k][l]) != 0)
				term[terms++] = scaled(output_factor(output, output->load[k][l]), format("wave%d[%d]", e->phase[l] + 1, k));
	if (mpq_sgn(output->time) != 0)
		term[terms++] = scaled(output_factor(output, output->time), "t");
	if (mpq_sgn(output->constant) != 0)
		term[terms++] = scaled(output_factor(output, output->constant), NULL);
	return terms ? tree(terms, term, 13) : "0.0";
}

static void emit_used_constants(const struct emitter *e, bool lets)
{
	for (const struct symbol *s = e->model->spec->first; s; s = s->next) {
		if (!s->used || s->kind == SYMBOL_COORD || s->kind == SYMBOL_OUTPUT)
			continue;
		if (s->kind == SYMBOL_PARAM) {
			struct collector collector = { .scheme = "exact" };
			mpq_t value;
			mpq_init(value);
			constant_value(&collector, s->form, value);
			fprintf(e->to, "    const double %s = %s;\n", s->c_name, finite_text(s->at, value));
			mpq_clear(value);
		} else if (lets) {
			fprintf(e->to, "    const double %s = %s;\n", s->c_name, c_expression(s->value));
		}
	}
}

static void clear_used(const struct spec *spec)
{
	for (struct symbol *s = spec->first; s; s = s->next)
		s->used = false;
}

static bool uses_time(const struct node *node)
{
	bool found = node->kind == NODE_TIME || (node->kind == NODE_NAME && node->symbol->kind == SYMBOL_LET && uses_time(node->symbol->value));
	for (int i = 0; i < node->children && !found; i++)
		found = uses_time(node->child[i]);
	return found;
}

static void mark_states(const struct emitter *e, const struct node *node, bool *reads)
{
	if (vanishes(node))
		return;
	if (node->kind == NODE_NAME && node->symbol->kind == SYMBOL_COORD && node->primes < 2)
		reads[node->symbol->index + node->primes * e->model->n] = true;
	if (node->kind == NODE_NAME && node->symbol->kind == SYMBOL_LET)
		mark_states(e, node->symbol->value, reads);
	for (int i = 0; i < node->children; i++)
		mark_states(e, node->child[i], reads);
}

static void emit_out(const struct emitter *e)
{
	FILE *to = e->to;
	const struct model *model = e->model;
	fprintf(to, "\nvoid %s_out(const %s *s, double out[%s_OUTPUTS])\n{\n", e->name, e->name, e->upper);
	if (!model->declared_outputs) {
		fprintf(to, "    %s_get(s, out);\n}\n", e->name);
		return;
	}
	struct output_needs needs = { ARRAY(bool, (size_t)model->states), ARRAY(bool, (size_t)e->system->loads), false };
	bool math = false;
	clear_used(model->spec);
	for (int i = 0; i < model->outputs; i++) {
		mark_output(e, &model->output[i], &needs);
		if (!model->output[i].form) {
			mark_used(model->output[i].value, &math);
			mark_states(e, model->output[i].value, needs.reads);
			needs.time = needs.time || uses_time(model->output[i].value);
		}
	}
	emit_locals(e, needs.reads);
	if (needs.time)
		fprintf(to, "    const double t = %s_time(s);\n", e->name);
	emit_used_constants(e, true);
	for (int l = 0; l < e->system->loads; l++)
		if (needs.waves[l])
			emit_wave(e, l);
	bool unused = true;
	for (int i = 0; i < model->outputs; i++) {
		const struct output *output = &model->output[i];
		fprintf(to, "    out[%d] = %s;  /* %s */\n", i, output->form ? linear_output(e, output) : c_expression(output->value), output->name);
	}
	for (int i = 0; i < model->states; i++)
		unused = unused && !needs.reads[i];
	if (unused && !needs.time)
		fputs("    (void)s;\n", to);
	fputs("}\n", to);
}

static void emit_run(const struct emitter *e)
{
	fprintf(e->to, "\nvoid %s_run(%s *s, size_t n, double *out)\n{\n    for (; n > 0; n--) {\n        %s_step(s);\n", e->name, e->name, e->name);
	fprintf(e->to, "        if (out) {\n            %s_out(s, out);\n            out += %s_OUTPUTS;\n        }\n    }\n}\n", e->name, e->upper);
}

/* ---- at ---- */

static void emit_number_rows(const struct emitter *e, int rows, int columns, const double *value, const char *const *row_note)
{
	for (int i = 0; i < rows; i++) {
		fputs("    {", e->to);
		for (int j = 0; j < columns; j++)
			fprintf(e->to, "%s%s", j ? ", " : "", shortest(value[i * columns + j]));
		fprintf(e->to, "},  /* %s */\n", row_note[i]);
	}
}

/* Names of the entries of the series' vector. */
static const char **series_names(const struct emitter *e, bool slopes)
{
	const struct series *series = &e->step->series;
	const char **name = ARRAY(const char *, (size_t)series->size);
	for (int i = 0; i < e->model->states; i++)
		name[i] = slopes ? format("%s'", e->model->state_name[i]) : e->model->state_name[i];
	for (int i = 0; i < e->model->n && series->held >= 0; i++)
		name[series->held + i] = format("held in %s''", e->model->coord[i]->name);
	for (int l = 0; l < e->system->loads; l++) {
		if (series->load[l] < 0)
			continue;
		const struct wave *wave = e->system->load[l].wave;
		name[series->load[l]] = wave ? wave_text(wave, false) : "1";
		if (wave)
			name[series->load[l] + 1] = wave_text(wave, true);
	}
	return name;
}

static void emit_held(const struct emitter *e)
{
	const struct series *series = &e->step->series;
	int n = e->model->n;
	for (int i = 0; i < n && series->held >= 0; i++) {
		const char **term = ARRAY(const char *, 2 * (size_t)n);
		int terms = 0;
		for (int k = 0; k < 2; k++)
			for (int j = 0; j < n; j++) {
				const mpq_t *held = k ? e->system->heldC : e->system->heldK;
				if (mpq_sgn(held[i * n + j]) != 0)
					term[terms++] = scaled(-round_rational(held[i * n + j]), format("s->y[%d]", k * n + j));
			}
		fprintf(e->to, "    x[%d] = %s;  /* held in %s'' */\n", series->held + i, terms ? tree(terms, term, 12) : "0.0", e->model->coord[i]->name);
	}
}

static void emit_load_states(const struct emitter *e, const int *index, const char *array, const char *member)
{
	for (int l = 0; l < e->system->loads; l++) {
		if (index[l] < 0)
			continue;
		if (!e->system->load[l].wave) {
			fprintf(e->to, "    %s[%d]%s = 1.0;\n", array, index[l], member);
		} else {
			fprintf(e->to, "    pl_cossin(s->phase[%d], z);  /* %s */\n", e->phase[l], wave_text(e->system->load[l].wave, false));
			for (int k = 0; k < 2; k++)
				fprintf(e->to, "    %s[%d]%s = z[%d];\n", array, index[l] + k, member, k);
		}
	}
}

static bool any_wave(const struct emitter *e, const int *index)
{
	for (int l = 0; l < e->system->loads; l++)
		if (index[l] >= 0 && e->system->load[l].wave)
			return true;
	return false;
}

static void emit_at(const struct emitter *e)
{
	const struct series *series = &e->step->series;
	FILE *to = e->to;
	size_t cells = (size_t)series->size * (size_t)series->size;
	double *A = ARRAY(double, cells);
	for (size_t i = 0; i < cells; i++)
		A[i] = round_rational(series->A[i]);
	fprintf(to, "\n/* x' = A x; x = y%s */\nstatic const double %s_slope[%d][%d] = {\n", series->size > e->model->states ? ", then what acts on it" : "",
		e->name, series->size, series->size);
	emit_number_rows(e, series->size, series->size, A, series_names(e, true));
	fprintf(to, "};\n\nvoid %s_at(const %s *s, double tau, double y[%s_STATES])\n{\n", e->name, e->name, e->upper);
	fprintf(to, "    static const pl_series series = {%d, %s_STATES, %d, %d, %s_slope[0]};  /* size, states, degree, halvings */\n", series->size,
		e->upper, series->degree, series->halvings, e->name);
	fprintf(to, "    double x[%d], work[%d]%s;\n    int i;\n", series->size, 2 * series->size, any_wave(e, series->load) ? ", z[2]" : "");
	fprintf(to, "    for (i = 0; i < %s_STATES; i++)\n        x[i] = s->y[i];\n", e->upper);
	emit_held(e);
	emit_load_states(e, series->load, "x", "");
	fprintf(to, "    pl_series_advance(&series, tau, x, work);\n    for (i = 0; i < %s_STATES; i++)\n        y[i] = x[i];\n}\n", e->upper);
}

/* ---- jump ---- */

struct power {                      /* the one-step matrix of y, then 1 for a constant load, then cos and sin of each wave */
	int size;
	int *load;                  /* index of the first entry of each load; -1: no effect */
	struct coefficient *cell;
};

static struct power power_matrix(const struct emitter *e)
{
	const struct table *table = e->step->table;
	int n = table->states;
	struct power p = { n, ARRAY(int, (size_t)e->system->loads), NULL };
	for (int l = 0, column = 0; l < e->system->loads; column += e->system->load[l++].columns) {
		bool used = false;
		for (int k = 0; k < e->system->load[l].columns; k++)
			used = used || e->step->program->uses[column + k];
		p.load[l] = used ? p.size : -1;
		p.size += used ? e->system->load[l].columns : 0;
	}
	p.cell = ARRAY(struct coefficient, (size_t)p.size * (size_t)p.size);
	for (int i = 0; i < n; i++) {
		for (int j = 0; j < n; j++)
			p.cell[i * p.size + j] = table->Phi[i * n + j];
		for (int l = 0, column = 0; l < e->system->loads; column += e->system->load[l++].columns)
			for (int k = 0; k < e->system->load[l].columns && p.load[l] >= 0; k++)
				p.cell[i * p.size + p.load[l] + k] = table->load[i * table->columns + column + k];
	}
	for (int l = 0; l < e->system->loads; l++) {
		int at = p.load[l];
		if (at < 0)
			continue;
		struct coefficient *diagonal = &p.cell[at * p.size + at];
		if (!e->system->load[l].wave) {
			diagonal->value = 1;
			continue;
		}
		rotation_of(e->model, e->system->load[l].wave, diagonal, diagonal + p.size);
		diagonal[p.size + 1] = diagonal[0];
		diagonal[1] = (struct coefficient){ -diagonal[p.size].value, -diagonal[p.size].low, diagonal[p.size].zero };
	}
	return p;
}

static void emit_jump(const struct emitter *e)
{
	FILE *to = e->to;
	struct power p = power_matrix(e);
	int n = e->model->states, size = p.size;
	fprintf(to, "\n/* One step in two words, y%s; not named: 0 */\n", size > n ? ", then what acts on it" : "");
	fprintf(to, "static const struct { int row, column; pl_two value; } %s_power_entry[] = {\n", e->name);
	int entries = 0;
	for (int i = 0; i < size; i++)
		for (int j = 0; j < size; j++) {
			const struct coefficient *c = &p.cell[i * size + j];
			if (c->value == 0 && c->low == 0 && (entries > 0 || i < size - 1 || j < size - 1))
				continue;       /* but an array has at least one entry */
			fprintf(to, "    {%d, %d, {%s, %s}},\n", i, j, shortest(c->value), shortest(c->low));
			entries++;
		}
	fprintf(to, "};\n\nvoid %s_jump(%s *s, uint64_t n)\n{\n", e->name, e->name);
	fprintf(to, "    pl_two power[%d], work[%d], x[%d], w[%d];\n", size * size, size * size, size, size);
	if (any_wave(e, p.load))
		fputs("    double z[2];\n", to);
	fprintf(to, "    int i;\n    for (i = 0; i < %d; i++)\n        power[i].hi = power[i].lo = 0.0;\n", size * size);
	fprintf(to, "    for (i = 0; i < %d; i++)\n        power[%d * %s_power_entry[i].row + %s_power_entry[i].column] = %s_power_entry[i].value;\n", entries, size,
		e->name, e->name, e->name);
	fprintf(to, "    for (i = 0; i < %d; i++)\n        x[i].lo = 0.0;\n", size);
	fprintf(to, "    for (i = 0; i < %s_STATES; i++)\n        x[i].hi = s->y[i];\n", e->upper);
	emit_load_states(e, p.load, "x", ".hi");
	fprintf(to, "    pl_power_apply(%d, power, work, x, w, n);\n    for (i = 0; i < %s_STATES; i++)\n        s->y[i] = x[i].hi;\n", size, e->upper);
	if (e->waves)
		fprintf(to, "    for (i = 0; i < %d; i++)\n        s->phase[i] = pl_turn_add(s->phase[i], pl_turn_times(%s_phase_step[i], n));\n", e->waves, e->name);
	fputs("    s->k += n;\n}\n", to);
}

/* ---- rhs ---- */

static const char *residual_text(const struct equation *equation)
{
	const char *left = c_expression(equation->left), *right = c_expression(equation->right);
	if (vanishes(equation->left))
		return format("-(%s)", right);
	return vanishes(equation->right) || strcmp(right, "0.0") == 0 ? left : format("%s - (%s)", left, right);
}

/* y' = velocities; accelerations from the residuals of the equations as written, through the inverse mass matrix */
static void emit_rhs(const struct emitter *e)
{
	const struct model *model = e->model;
	const struct spec *spec = model->spec;
	FILE *to = e->to;
	int n = model->n, column;
	bool math = false, *reads = ARRAY(bool, (size_t)model->states), time = false;
	mpq_t *inverse = rationals((size_t)(n * n));
	rational_inverse(n, (const mpq_t *)model->system.M, inverse, &column);
	clear_used(spec);
	for (int i = 0; i < spec->equations; i++)
		for (int side = 0; side < 2; side++) {
			const struct node *node = side ? spec->equation[i].right : spec->equation[i].left;
			mark_used(node, &math);
			mark_states(e, node, reads);
			time = time || uses_time(node);
		}
	fprintf(to, "\n/* The equations as written, for checking against any ODE solver. */\n");
	fprintf(to, "void %s_rhs(double t, const double y[], double dydt[])\n{\n", e->name);
	emit_used_constants(e, false);
	for (int i = 0; i < model->states; i++)
		if (reads[i])
			fprintf(to, "    const double %s = y[%d];\n", state_local(e, i), i);
	for (const struct symbol *s = spec->first; s; s = s->next)
		if (s->used && s->kind == SYMBOL_LET)
			fprintf(to, "    const double %s = %s;\n", s->c_name, c_expression(s->value));
	fprintf(to, "    double residual[%d];  /* left side minus right side, without the accelerations */\n", spec->equations);
	for (int i = 0; i < spec->equations; i++)
		fprintf(to, "    residual[%d] = %s;\n", i, residual_text(&spec->equation[i]));
	for (int i = 0; i < n; i++)
		fprintf(to, "    dydt[%d] = y[%d];\n", i, n + i);
	for (int i = 0; i < n; i++) {
		const char **term = ARRAY(const char *, (size_t)n);
		int terms = 0;
		for (int j = 0; j < n; j++)
			if (mpq_sgn(inverse[i * n + j]) != 0)
				term[terms++] = scaled(-round_rational(inverse[i * n + j]), format("residual[%d]", j));
		fprintf(to, "    dydt[%d] = %s;  /* the inverse mass matrix times them */\n", n + i, tree(terms, term, 12));
	}
	if (!time)
		fputs("    (void)t;\n", to);
	fputs("}\n", to);
}

/* ---- tables and descriptor ---- */

static void emit_phi(const struct emitter *e)
{
	int n = e->model->states;
	double *value = ARRAY(double, (size_t)(n * n));
	for (int i = 0; i < n * n; i++)
		value[i] = e->step->table->Phi[i].value;
	fprintf(e->to, "\nconst double %s_Phi[%s_STATES][%s_STATES] = {  /* columns: %s */\n", e->name, e->upper, e->upper, state_list(e->model));
	emit_number_rows(e, n, n, value, e->model->state_name);
	fputs("};\n", e->to);
}

static void emit_name_list(const struct emitter *e, const char *array, int count, const char *const *name)
{
	fprintf(e->to, "static const char *const %s_%s[] = {", e->name, array);
	for (int i = 0; i < count; i++)
		fprintf(e->to, "%s\"%s\"", i == 0 ? "" : i % 10 ? ", " : ",\n    ", name[i]);
	fputs("};\n", e->to);
}

static void emit_descriptor(const struct emitter *e)
{
	FILE *to = e->to;
	const char *n = e->name, *N = e->upper;
	const char **output = ARRAY(const char *, (size_t)e->model->outputs);
	for (int i = 0; i < e->model->outputs; i++)
		output[i] = e->model->output[i].name;
	bool at = e->step->series.emitted;
	fputs("\n/* The same functions for programs that drive any model. */\n\n", to);
	emit_name_list(e, "state_names", e->model->states, e->model->state_name);
	emit_name_list(e, "output_names", e->model->outputs, output);
	static const char *const wrapper[][5] = {       /* result, name, parameters, body before the name, arguments */
		{ "void", "init", "void *s", "", "" }, { "void", "set", "void *s, double t, const double *y", "", ", t, y" },
		{ "void", "get", "const void *s, double *y", "", ", y" }, { "double", "time", "const void *s", "return ", "" },
		{ "void", "step", "void *s, const double *u", "(void)u; ", "" }, { "void", "out", "const void *s, double *out", "", ", out" },
		{ "void", "run", "void *s, size_t n, const double *u, double *out", "(void)u; ", ", n, out" },
		{ "void", "at", "const void *s, const double *u, double tau, double *y", "(void)u; ", ", tau, y" },
		{ "void", "jump", "void *s, uint64_t n", "", ", n" } };
	fputc('\n', to);
	for (size_t i = 0; i < sizeof wrapper / sizeof *wrapper; i++)   /* the tag: a parameter may bear the type's name */
		if (at || strcmp(wrapper[i][1], "at") != 0)
			fprintf(to, "static %s %s_any_%s(%s) { %s%s_%s((%sstruct %s *)s%s); }\n", wrapper[i][0], n, wrapper[i][1], wrapper[i][2],
				wrapper[i][3], n, wrapper[i][1], wrapper[i][2][0] == 'c' ? "const " : "", n, wrapper[i][4]);
	fprintf(to, "\nconst pl_model %s_model = {\n    \"%s\", sizeof(struct %s), %s_STATES, %s_INPUTS, %s_OUTPUTS, %s_H,\n", n, n, n, N, N, N, N);
	fprintf(to, "    %s_state_names, NULL, %s_output_names,\n    %s_any_init, %s_any_set, %s_any_get, %s_any_time, %s_any_step,\n", n, n, n, n, n, n, n);
	fprintf(to, "    %s_any_out, %s_any_run, %s, %s_any_jump\n};\n", n, n, at ? format("%s_any_at", n) : "NULL", n);
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
	for (int i = 0; i < e->model->spec->equations && rhs; i++) {
		mark_used(e->model->spec->equation[i].left, &math);
		mark_used(e->model->spec->equation[i].right, &math);
	}
	return math;
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
	if (e.waves) {
		emit_turns(&e, "phase_start", "at t = 0, in turns of 2^-128", false);
		emit_turns(&e, "phase_step", "in one step", true);
		emit_rates(&e);
	}
	emit_access(&e);
	emit_step(&e);
	emit_out(&e);
	emit_run(&e);
	if (step->series.emitted)
		emit_at(&e);
	emit_jump(&e);
	if (rhs)
		emit_rhs(&e);
	emit_descriptor(&e);
}
