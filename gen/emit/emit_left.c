/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A scheme that leaves something over, as C: the leftover as a function, and the step as actions on vectors. */
#include "emit/emit.h"

#include <math.h>
#include <string.h>

/* ---- what the leftover reads, and how it is called ---- */

static const struct form *const *leftovers(const struct emitter *e, int operator)
{
	return (const struct form *const *)e->model->operator[operator].left;
}

static bool many_operators(const struct emitter *e)
{
	return e->model->operators > 1;
}

static bool any(const bool *flag, int count)
{
	for (int i = 0; i < count; i++)
		if (flag[i])
			return true;
	return false;
}

static bool reads_slope(const struct emitter *e, const struct reads *r)
{
	return any(r->input + e->system->inputs, e->system->inputs);
}

/* The value of a ramp, which differs from one time in a step to another */
static bool reads_ramp(const struct emitter *e, const struct reads *r)
{
	for (int i = 0; i < e->system->inputs; i++)
		if (e->system->input[i].first_order && r->input[i])
			return true;
	return false;
}

static bool takes_slope(const struct emitter *e, const struct reads *r)
{
	return reads_slope(e, r) || (reads_ramp(e, r) && e->step->program->nodes > 1);
}

static struct reads reads_of_leftover(const struct emitter *e)
{
	int channels = e->model->channels, all = channels * e->model->operators;
	const struct form **form = ARRAY(const struct form *, (size_t)all + 1);
	for (int k = 0; k < e->model->operators; k++)
		for (int c = 0; c < channels; c++)
			form[k * channels + c] = leftovers(e, k)[c];
	return reads_of(e->model, all, form);
}

/* Whether a leftover depends on when it is evaluated, and there is more than one time */
static bool needs_node(const struct emitter *e, const struct reads *r)
{
	return e->step->program->nodes > 1 && (r->time || any(r->load, e->system->loads) || reads_ramp(e, r));
}

/* What every function of a step is handed on: the operator, the time, the inputs */
static const char *parameters(const struct emitter *e, const struct reads *r, bool with_node)
{
	const char *text = format("const %s *s", e->name);
	if (many_operators(e))
		text = format("%s, int which", text);
	if (with_node)
		text = format("%s, int node", text);
	if (any(r->input, e->system->inputs))
		text = format("%s, const double u[]", text);
	if (takes_slope(e, r))
		text = format("%s, const double slope[]", text);
	return text;
}

/* Where a call stands: in a step, whose own inputs are set up there; inside a function that got them; in the outputs */
enum from { FROM_STEP, FROM_INSIDE, FROM_OUTPUTS };

static const char *arguments(const struct emitter *e, const struct reads *r, const char *node, enum from from)
{
	static const char *const u[] = { "u", "u", "s->u" }, *const slope[] = { "slope", "slope", "s->slope" };
	const char *text = "s";
	if (many_operators(e))
		text = format("%s, %s", text, from == FROM_OUTPUTS ? "0" : "which");
	if (node)
		text = format("%s, %s", text, node);
	if (any(r->input, e->system->inputs))
		text = format("%s, %s", text, from == FROM_STEP && e->ramps ? "start" : u[from]);
	if (takes_slope(e, r))
		text = format("%s, %s", text, slope[from]);
	return text;
}

static const char *leftover_call(const struct emitter *e, const char *node, const char *state, const char *left, enum from from)
{
	struct reads r = reads_of_leftover(e);
	return format("%s_leftover(%s, %s, %s);", e->name, arguments(e, &r, needs_node(e, &r) ? node : NULL, from), state, left);
}

const char *leftover_of_step(const struct emitter *e)
{
	return leftover_call(e, "0", "s->y", "left", FROM_STEP);
}

const char *leftover_of_outputs(const struct emitter *e)
{
	return leftover_call(e, "0", "s->y", "left", FROM_OUTPUTS);
}

/* ---- the leftover ---- */

static int load_of_wave(const struct emitter *e, const struct wave *wave)
{
	int l = 0;
	while (e->system->load[l].wave != wave)
		l++;
	return l;
}

static const char *coordinate_now(const struct emitter *e, const struct basis *basis)
{
	const struct model *written = speaker(e->model);
	if (basis->order > 0 && basis->order >= written->frame.coord[basis->index]->highest)
		return format("accel%d", basis->index + 1);
	int state = basis->order ? written->system.velocity[basis->index] : basis->index;
	return e->local[e->model->reduction.place ? e->model->reduction.place[state] : state];
}

const char *basis_now(const struct emitter *e, const struct basis *basis)
{
	const char *text = "t";
	int l;
	switch (basis->kind) {
	case BASIS_ONE:   return NULL;
	case BASIS_PI:    return "3.141592653589793";
	case BASIS_COORD: return coordinate_now(e, basis);
	case BASIS_INPUT: return input_name(e, basis->index, basis->order);
	default: break;
	}
	if (is_polynomial(basis->wave)) {
		for (int k = 1; k < basis->power; k++)
			text = format("%s * t", text);
		return text;
	}
	l = load_of_wave(e, basis->wave);
	return format("load%d[%d]", l + 1, oscillates(basis->wave) ? 2 * basis->power + basis->sine : basis->power);
}

/* ---- a bank: linear terms of the leftover that differ from operator to operator ---- */

struct excess {
	int channel, coord, order;
};

static mpq_srcptr linear_factor(const struct form *form, int coord, int order)
{
	for (int i = 0; i < form->terms; i++)
		if (form->term[i].basis.kind == BASIS_COORD && form->term[i].basis.index == coord && form->term[i].basis.order == order)
			return form->term[i].factor;
	return NULL;
}

static bool differs(const struct emitter *e, int channel, int coord, int order)
{
	mpq_srcptr first = linear_factor(leftovers(e, 0)[channel], coord, order);
	for (int k = 1; k < e->model->operators; k++) {
		mpq_srcptr other = linear_factor(leftovers(e, k)[channel], coord, order);
		if (!first != !other || (first && !mpq_equal(first, other)))
			return true;
	}
	return false;
}

static int find_excess(const struct emitter *e, struct excess **list)
{
	int count = 0, states = e->system->states, n = e->system->n;
	*list = ARRAY(struct excess, (size_t)(states * e->model->channels) + 1);
	for (int c = 0; c < e->model->channels; c++)
		for (int i = 0; i < states; i++)
			if (differs(e, c, e->system->coord[i], i >= n))
				(*list)[count++] = (struct excess){ c, e->system->coord[i], i >= n };
	return count;
}

static void emit_excess(const struct emitter *e, int count, const struct excess *list)
{
	fprintf(e->to, "\n/* What the linear terms of the equations exceed those of each operator by */\nstatic const double %s_excess[%d][%d] = {\n", e->name,
		e->model->operators, count);
	for (int k = 0; k < e->model->operators; k++) {
		const char *row = "";
		for (int i = 0; i < count; i++) {
			mpq_srcptr factor = linear_factor(leftovers(e, k)[list[i].channel], list[i].coord, list[i].order);
			row = format("%s%s%s", row, i ? i % 6 ? ", " : ",\n     " : "", factor ? shortest(finite_number(e, factor)) : "0.0");
		}
		fprintf(e->to, "    {%s},  /* %s */\n", row, e->model->operator[k].text);
	}
	fputs("};\n", e->to);
}

/* The form without the terms that differ */
static const struct form *common_part(const struct emitter *e, int channel)
{
	const struct form *form = leftovers(e, 0)[channel];
	struct form *common = NEW(struct form);
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		if (basis->kind != BASIS_COORD || !differs(e, channel, basis->index, basis->order))
			common = form_sum(common, form_single(*basis, form->term[i].factor), false);
	}
	return common;
}

static const char *with_excess(const struct emitter *e, int channel, const char *text, int count, const struct excess *list)
{
	const char **term = ARRAY(const char *, (size_t)count + 1);
	int terms = 0;
	for (int i = 0; i < count; i++)
		if (list[i].channel == channel) {
			struct basis basis = { .kind = BASIS_COORD, .index = list[i].coord, .order = list[i].order };
			term[terms++] = format("excess[%d] * %s", i, basis_now(e, &basis));
		}
	if (terms == 0)
		return text;
	const char *sum = tree(terms, term, 15);
	return strcmp(text, "0.0") == 0 ? sum : format("(%s)\n           + (%s)", text, sum);
}

/* ---- the function ---- */

static void emit_nodes(const struct emitter *e, const struct reads *r)
{
	const struct program *program = e->step->program;
	mpq_t x;
	mpq_init(x);
	if (r->time || reads_ramp(e, r)) {
		fprintf(e->to, "\nstatic const double %s_node[%d] = {", e->name, program->nodes);
		for (int i = 0; i < program->nodes; i++) {
			mpq_mul(x, program->node[i], e->model->h);
			fprintf(e->to, "%s%s", i ? ", " : "", shortest(round_rational(x)));
		}
		fputs("};  /* times after the start of the step [s] */\n", e->to);
	}
	if (any(r->load, e->system->loads))
		emit_node_phases(e, r->load);
	mpq_clear(x);
}

static void emit_leftover_locals(const struct emitter *e, const struct reads *r, bool node)
{
	FILE *to = e->to;
	emit_locals_of(e, r->state, "y");
	if (r->time)
		fprintf(to, "    const double t = %s_time(s)%s;\n", e->name, node ? format(" + %s_node[node]", e->name) : "");
	for (int i = 0; i < e->system->inputs; i++) {
		const char *ramp = node ? format("u[%d] + %s_node[node] * slope[%d]", i, e->name, i) : format("u[%d]", i);
		if (r->input[i])
			fprintf(to, "    const double %s = %s;\n", input_name(e, i, 0), e->system->input[i].first_order ? ramp : format("u[%d]", i));
		if (r->input[e->system->inputs + i])
			fprintf(to, "    const double %s = slope[%d];\n", input_name(e, i, 1), i);
	}
	struct emitter here = *e;
	here.at_node = node;
	emit_load_states(&here, r->load, true);
}

static const char *row_name(const struct emitter *e, int channel)
{
	return e->model->coord_name[coordinate_of_row(e->model, e->model->channel_row[channel])];
}

static void emit_leftover(const struct emitter *e)
{
	FILE *to = e->to;
	struct reads r = reads_of_leftover(e);
	struct excess *list = NULL;
	int count = many_operators(e) ? find_excess(e, &list) : 0, channels = e->model->channels;
	bool node = needs_node(e, &r);
	if (node)
		emit_nodes(e, &r);
	if (count)
		emit_excess(e, count, list);
	fprintf(to, "\n/* What is left over at state y: a force on each equation that has some */\nstatic void %s_leftover(%s, const double y[%s_STATES], double left[%d])\n{\n",
		e->name, parameters(e, &r, node), e->upper, channels);
	emit_leftover_locals(e, &r, node);
	if (count)
		fprintf(to, "    const double *const excess = %s_excess[which];\n", e->name);
	const struct form **form = ARRAY(const struct form *, (size_t)channels);
	for (int c = 0; c < channels; c++)
		form[c] = common_part(e, c);
	struct writer *writer = writer_new(e, basis_now, channels, form);
	for (int c = 0; c < channels; c++) {
		const char *text = write_form(writer, form[c], 15);
		fprintf(to, "    left[%d] = %s;  /* %s */\n", c, with_excess(e, c, text, count, list), row_name(e, c));
	}
	if (!r.time && !any(r.load, e->system->loads))
		fputs("    (void)s;\n", to);
	if (many_operators(e) && !count)
		fputs("    (void)which;\n", to);
	if (!any(r.state, e->system->states))
		fputs("    (void)y;\n", to);
	fputs("}\n", to);
}

/* ---- which operator of a bank serves now ---- */

static void emit_selection(const struct emitter *e)
{
	const struct form *selector = e->model->selector;
	struct reads r = reads_of(e->model, 1, &selector);
	fprintf(e->to, "\n/* The first operator whose value is not below the current one */\nstatic int %s_operator(const %s *s%s%s)\n{\n", e->name, e->name,
		any(r.input, e->system->inputs) ? ", const double u[]" : "", reads_slope(e, &r) ? ", const double slope[]" : "");
	emit_locals_of(e, r.state, "s->y");
	if (r.time)
		fprintf(e->to, "    const double t = %s_time(s);\n", e->name);
	for (int i = 0; i < e->system->inputs; i++) {
		if (r.input[i])
			fprintf(e->to, "    const double %s = u[%d];\n", input_name(e, i, 0), i);
		if (r.input[e->system->inputs + i])
			fprintf(e->to, "    const double %s = slope[%d];\n", input_name(e, i, 1), i);
	}
	emit_load_states(e, r.load, true);
	const char *text = write_form(writer_new(e, basis_now, 1, &selector), selector, 8);
	fprintf(e->to, "    const double now = %s;\n    (void)s;\n    return ", text);
	for (int k = 0; k + 1 < e->model->operators; k++)
		fprintf(e->to, "now <= %s ? %d : ", shortest(finite_number(e, e->model->operator[k].at)), k);
	fprintf(e->to, "%d;\n}\n", e->model->operators - 1);
}

/* ---- tables of a step that loops ---- */

/* Columns of the loads that act, in the order of a table */
static int acting_columns(const struct emitter *e, int **column)
{
	int count = 0, all = 0;
	*column = ARRAY(int, (size_t)load_columns(e->system) + 1);
	for (int l = 0; l < e->system->loads; l++)
		for (int k = 0; k < e->system->load[l].columns; k++, all++)
			if (load_acts(e->system, &e->system->load[l]))
				(*column)[count++] = all;
	return count;
}

struct picked {                     /* a matrix of a table: Phi, the loads' columns in one segment of time, the inputs', or a kernel */
	enum { PICK_PHI, PICK_LOAD, PICK_INPUT, PICK_KERNEL, PICK_SLOPE, PICK_FORCE } kind;
	int table, index;           /* of a kernel: which */
	int columns;
	const int *column;          /* of the loads: those that act */
};

static double picked_entry(const struct picked *p, const struct emitter *e, int operator, int segment, int i, int j)
{
	const struct table *table = e->step->branch[operator].table[p->table];
	switch (p->kind) {
	case PICK_PHI:   return table->Phi[i * table->states + j].value;
	case PICK_LOAD:  return table->load[(segment * table->states + i) * table->columns + p->column[j]].value;
	case PICK_INPUT: return table->input[i * table->inputs + j].value;
	default:         return table->kernel[p->index][i * table->channels + j].value;
	}
}

static double *picked_matrix(const struct picked *p, const struct emitter *e, int operator, int segment)
{
	int rows = e->system->states;
	double *value = ARRAY(double, (size_t)(rows * p->columns));
	const struct linear *system = &e->step->branch[operator].system;
	mpq_t *A = p->kind == PICK_SLOPE ? state_matrix(system, false) : NULL;
	for (int j = 0; j < p->columns; j++) {
		mpq_t *B = p->kind == PICK_FORCE ? impulse_of_channel(system, j) : NULL;
		for (int i = 0; i < rows; i++)
			value[i * p->columns + j] = A ? finite_number(e, A[i * rows + j]) : B ? finite_number(e, B[i])
						      : picked_entry(p, e, operator, segment, i, j);
	}
	return value;
}

/* NAME_name[of segments of time, then of operators][row][column] */
static void emit_table(const struct emitter *e, const char *name, const char *note, int first, struct picked picked)
{
	int segments = picked.kind == PICK_LOAD ? e->system->segments : 1, rows = e->system->states;
	fprintf(e->to, "\nstatic const double %s_%s[%d][%d][%d] = {  /* %s */\n", e->name, name, segments * (e->model->operators - first), rows, picked.columns,
		note);
	for (int s = 0; s < segments; s++)
		for (int k = first; k < e->model->operators; k++) {
			fputs("  {\n", e->to);
			emit_number_rows(e, rows, picked.columns, picked_matrix(&picked, e, k, s), e->model->state_name);
			fputs("  },\n", e->to);
		}
	fputs("};\n", e->to);
}

static void emit_one_table(const struct emitter *e, int t)
{
	const struct wanted *wanted = &e->step->branch->whole->wanted[t];
	int states = e->system->states, *column, columns = acting_columns(e, &column);
	if (wanted->Phi && t > 0)
		emit_table(e, wanted->name, format("e^{A tau}, tau = %s h", exact_text(wanted->fraction)), 0, (struct picked){ PICK_PHI, t, 0, states, NULL });
	else if (wanted->Phi && many_operators(e))
		emit_table(e, wanted->name, "e^{A h} of the operators after the first", 1, (struct picked){ PICK_PHI, t, 0, states, NULL });
	if (columns)
		emit_table(e, format("%s_load", wanted->name), "what the load states add", 0, (struct picked){ PICK_LOAD, t, 0, columns, column });
	if (e->step->branch->whole->inputs)
		emit_table(e, format("%s_input", wanted->name), "what the inputs add", 0, (struct picked){ PICK_INPUT, t, 0, e->step->branch->whole->inputs, NULL });
	for (int k = 0; k < wanted->kernels; k++)
		emit_table(e, wanted->kernel[k].name, "what leftovers add", 0, (struct picked){ PICK_KERNEL, t, k, e->model->channels, NULL });
}

static void emit_tables(const struct emitter *e)
{
	for (int t = 0; t < e->step->tables; t++)
		emit_one_table(e, t);
	if (!e->step->program->predicts)
		return;
	emit_table(e, "A", "y' = A y + B r", 0, (struct picked){ PICK_SLOPE, 0, 0, e->system->states, NULL });
	emit_table(e, "B", "the force of each leftover", 0, (struct picked){ PICK_FORCE, 0, 0, e->model->channels, NULL });
}

static const char *operator_index(const struct emitter *e)
{
	return many_operators(e) ? "which" : "0";
}

/* The first entry of a matrix of the operator that serves now */
static const char *matrix_text(const struct emitter *e, const char *name)
{
	return format("%s_%s[%s][0]", e->name, name, operator_index(e));
}

static const char *phi_text(const struct emitter *e, int t)
{
	if (t > 0)
		return matrix_text(e, e->step->branch->whole->wanted[t].name);
	const char *first = format("%s[0]", stepped_table(e, "Phi"));
	return many_operators(e) ? format("which ? %s_full[which - 1][0] : %s", e->name, first) : first;
}

static const char *load_text(const struct emitter *e, int t)
{
	const char *name = format("%s_%s_load", e->name, e->step->branch->whole->wanted[t].name);
	if (e->system->segments == 1)
		return format("%s[%s][0]", name, operator_index(e));
	return many_operators(e) ? format("%s[%d * s->segment + which][0]", name, e->model->operators) : format("%s[s->segment][0]", name);
}

/* ---- predictors ---- */

static bool is_driven(const struct emitter *e)
{
	const struct program *program = e->step->program;
	for (int i = 0; i < program->nodes; i++)
		if (program->node_table[i] != NONE)
			return true;
	return false;
}

static bool any_nonzero(const mpq_t *row, int count)
{
	for (int i = 0; i < count; i++)
		if (mpq_sgn(row[i]) != 0)
			return true;
	return false;
}

static void emit_unrolled_slope(const struct emitter *e)
{
	bool reads = false;
	int states = e->system->states, channels = e->model->channels;
	mpq_t *A = state_matrix(e->system, false), **B = ARRAY(mpq_t *, (size_t)channels);
	for (int c = 0; c < channels; c++)
		B[c] = impulse_of_channel(e->system, c);
	for (int i = 0; i < states; i++) {
		const char **term = ARRAY(const char *, (size_t)(states + channels) + 1);
		int terms = 0;
		for (int j = 0; j < states; j++)
			if (mpq_sgn(A[i * states + j]) != 0)
				term[terms++] = scaled(finite_number(e, A[i * states + j]), format("z[%d]", j));
		for (int c = 0; c < channels; c++)
			if (mpq_sgn(B[c][i]) != 0)
				term[terms++] = scaled(finite_number(e, B[c][i]), format("left[%d]", c));
		reads = reads || any_nonzero((const mpq_t *)A + i * states, states);
		fprintf(e->to, "    dz[%d] = %s;  /* %s' */\n", i, terms ? tree(terms, term, 12) : "0.0", e->model->state_name[i]);
	}
	if (!reads)
		fputs("    (void)z;\n", e->to);
}

static void emit_slope(const struct emitter *e)
{
	const char *n = e->name, *N = e->upper;
	int channels = e->model->channels;
	fprintf(e->to, "\n/* dz = A z + B r, r what is left over */\nstatic void %s_slope_of(%sconst double z[%s_STATES], const double left[%d], double dz[%s_STATES])\n{\n",
		n, many_operators(e) ? "int which, " : "", N, channels, N);
	if (e->step->program->loops) {
		fprintf(e->to, "    pl_multiply(%s_STATES, %s_STATES, %s, z, dz);\n", N, N, matrix_text(e, "A"));
		fprintf(e->to, "    pl_multiply_add(%s_STATES, %d, %s, left, dz);\n", N, channels, matrix_text(e, "B"));
	} else {
		emit_unrolled_slope(e);
	}
	fputs("}\n", e->to);
}

static const char *predicting_parameters(const struct emitter *e, const struct reads *r, bool node)
{
	const char *text = parameters(e, r, false);
	const char *driven = is_driven(e) ? format(", const double middle[%s_STATES], const double last[%s_STATES]", e->upper, e->upper) : "";
	return format("%s%s, double tau, const double first[%s_STATES]%s, double y[%s_STATES]", text, node ? ", int half, int end" : "", e->upper, driven, e->upper);
}

/* RK4 in z' = A z + r(t, z + what the loads have added so far) */
static void emit_predictor(const struct emitter *e)
{
	FILE *to = e->to;
	const char *N = e->upper;
	struct reads r = reads_of_leftover(e);
	bool node = needs_node(e, &r), driven = is_driven(e);
	emit_slope(e);
	fprintf(to, "\n/* One step of Runge and Kutta of length tau on all but the loads, whose exact part is added%s */\n", driven ? "" : " (there are none)");
	fprintf(to, "static void %s_predict(%s)\n{\n", e->name, predicting_parameters(e, &r, node));
	fputs("    static const double ahead[3] = {0.5, 0.5, 1.0}, weight[3] = {2.0, 2.0, 1.0};\n", to);
	fprintf(to, "    double z[%s_STATES], dz[%s_STATES], sum[%s_STATES], left[%d];\n    int i, k;\n", N, N, N, e->model->channels);
	fprintf(to, "    for (i = 0; i < %s_STATES; i++)\n        sum[i] = dz[i] = first[i];\n    for (k = 0; k < 3; k++) {\n", N);
	fprintf(to, "        for (i = 0; i < %s_STATES; i++) {\n            z[i] = s->y[i] + ahead[k] * tau * dz[i];\n", N);
	fprintf(to, "            y[i] = z[i]%s;\n        }\n", driven ? " + (k < 2 ? middle[i] : last[i])" : "");
	fprintf(to, "        %s\n", leftover_call(e, "k < 2 ? half : end", "y", "left", FROM_INSIDE));
	fprintf(to, "        %s_slope_of(%sz, left, dz);\n", e->name, many_operators(e) ? "which, " : "");
	fprintf(to, "        for (i = 0; i < %s_STATES; i++)\n            sum[i] += weight[k] * dz[i];\n    }\n", N);
	fprintf(to, "    for (i = 0; i < %s_STATES; i++)\n        y[i] = s->y[i] + tau / 6.0 * sum[i]%s;\n}\n", N, driven ? " + last[i]" : "");
}

/* ---- the step ---- */

static const char *vector_name(int stage)
{
	return stage == STAGE_STATE ? "next" : format("stage%d", stage);
}

/* Flows are computed apart where a change of the loads may interrupt them. */
static bool flows_apart(const struct emitter *e)
{
	return e->system->segments > 1;
}

static void emit_combination(const struct emitter *e, const struct action *a)
{
	for (int c = 0; c < e->model->channels; c++) {
		if (a->minus == NONE)
			fprintf(e->to, "    left%d[%d] = 2.0 * left%d[%d];\n", a->target, c, a->plus, c);
		else
			fprintf(e->to, "    left%d[%d] = left%d[%d] %c left%d[%d];\n", a->target, c, a->plus, c, a->added ? '+' : '-', a->minus, c);
	}
}

/* The same in a loop */
static void emit_combination_loop(const struct emitter *e, const struct action *a)
{
	fprintf(e->to, "    for (i = 0; i < %d; i++)\n        left%d[i] = ", e->model->channels, a->target);
	if (a->minus == NONE)
		fprintf(e->to, "2.0 * left%d[i];\n", a->plus);
	else
		fprintf(e->to, "left%d[i] %c left%d[i];\n", a->plus, a->added ? '+' : '-', a->minus);
}

static int add_flow_terms(const struct emitter *e, const struct table *table, int row, const char **term)
{
	int terms = 0;
	for (int j = 0; j < table->states && table->Phi; j++)
		if (!table->Phi[row * table->states + j].zero)
			term[terms++] = scaled(table->Phi[row * table->states + j].value, e->local[j]);
	for (int k = 0; k < table->columns; k++)
		if (!table->load[row * table->columns + k].zero)
			term[terms++] = scaled(table->load[row * table->columns + k].value, column_operand(e, k));
	for (int k = 0; k < table->inputs; k++)
		if (!table->input[row * table->inputs + k].zero)
			term[terms++] = scaled(table->input[row * table->inputs + k].value, input_operand(e, k));
	return terms;
}

static size_t most_terms(const struct emitter *e)
{
	const struct table *table = e->step->branch->whole;
	return (size_t)(table->states + table->columns + table->inputs + 4 * table->channels + 2);
}

static void emit_sum(const struct emitter *e, const struct action *a)
{
	struct table *const *table = e->step->branch[0].table;
	for (int i = 0; i < e->system->states; i++) {
		const char **term = ARRAY(const char *, most_terms(e));
		int terms = a->flow != NONE ? add_flow_terms(e, table[a->flow], i, term) : 0;
		if (a->plain != NONE)
			term[terms++] = format("stage%d[%d]", a->plain, i);
		for (int k = 0; k < a->kernels; k++)
			for (int c = 0; c < e->model->channels; c++) {
				const struct coefficient *factor = &table[a->kernel[k].table]->kernel[a->kernel[k].kernel][i * e->model->channels + c];
				if (!factor->zero)
					term[terms++] = scaled(factor->value, format("left%d[%d]", a->kernel[k].left, c));
			}
		const char *target = a->target == STAGE_STATE ? "s->y" : vector_name(a->target);
		fprintf(e->to, "    %s[%d] = %s;\n", target, i, terms ? tree(terms, term, 14) : "0.0");
	}
}

/* target = Phi y + loads + inputs; without Phi: the loads and inputs alone */
static void emit_flow_loop(const struct emitter *e, int t, const char *target, const char *margin)
{
	const struct table *table = e->step->branch[0].table[t];
	int *column, columns = acting_columns(e, &column);
	const char *N = e->upper, *function = "pl_multiply";
	if (table->Phi) {
		fprintf(e->to, "%spl_multiply(%s_STATES, %s_STATES, %s, s->y, %s);\n", margin, N, N, phi_text(e, t), target);
		function = "pl_multiply_add";
	}
	if (columns) {
		fprintf(e->to, "%s%s(%s_STATES, %d, %s, load, %s);\n", margin, function, N, columns, load_text(e, t), target);
		function = "pl_multiply_add";
	}
	if (table->inputs)
		fprintf(e->to, "%s%s(%s_STATES, %d, %s, input, %s);\n", margin, function, N, table->inputs,
			matrix_text(e, format("%s_input", table->wanted->name)), target);
}

static void emit_sum_loop(const struct emitter *e, const struct action *a)
{
	struct table *const *table = e->step->branch[0].table;
	const char *target = vector_name(a->target);
	if (a->flow != NONE && !flows_apart(e))
		emit_flow_loop(e, a->flow, target, "    ");
	else
		fprintf(e->to, "    for (i = 0; i < %s_STATES; i++)\n        %s[i] = %s;\n", e->upper, target,
			a->flow != NONE ? format("flow%d[i]", a->flow) : format("stage%d[i]", a->plain));
	for (int k = 0; k < a->kernels; k++)
		fprintf(e->to, "    pl_multiply_add(%s_STATES, %d, %s, left%d, %s);\n", e->upper, e->model->channels,
			matrix_text(e, table[a->kernel[k].table]->wanted->kernel[a->kernel[k].kernel].name), a->kernel[k].left, target);
	if (a->target == STAGE_STATE)
		fprintf(e->to, "    for (i = 0; i < %s_STATES; i++)\n        s->y[i] = next[i];\n", e->upper);
}

static void emit_prediction(const struct emitter *e, const struct action *a)
{
	const struct program *program = e->step->program;
	struct reads r = reads_of_leftover(e);
	mpq_t tau;
	mpq_init(tau);
	mpq_mul(tau, program->node[a->node], e->model->h);
	const char *nodes = needs_node(e, &r) ? format(", %d, %d", a->half, a->node) : "";
	const char *parts = is_driven(e) ? format(", driven%d, driven%d", a->half, a->node) : "";
	fprintf(e->to, "    %s_predict(%s%s, %s, first%s, stage%d);\n", e->name, arguments(e, &r, NULL, FROM_STEP), nodes, shortest(round_rational(tau)), parts,
		a->target);
	mpq_clear(tau);
}

static void emit_action(const struct emitter *e, const struct action *a)
{
	const struct program *program = e->step->program;
	bool loops = program->loops, first = a->kind == ACTION_LEFTOVER && a->target == 0;
	switch (a->kind) {
	case ACTION_LEFTOVER:
		fprintf(e->to, "    %s\n", leftover_call(e, format("%d", a->node), a->from == STAGE_STATE ? "s->y" : vector_name(a->from),
							 format("left%d", a->target), FROM_STEP));
		if (first && program->predicts)
			fprintf(e->to, "    %s_slope_of(%ss->y, left0, first);\n", e->name, many_operators(e) ? "which, " : "");
		break;
	case ACTION_COMBINE:
		(loops ? emit_combination_loop : emit_combination)(e, a);
		break;
	case ACTION_SUM:
		fprintf(e->to, "    /* %s */\n", a->note);
		(loops ? emit_sum_loop : emit_sum)(e, a);
		break;
	case ACTION_PREDICT:
		emit_prediction(e, a);
		break;
	}
}

static void declare_vectors(const struct emitter *e)
{
	const struct program *program = e->step->program;
	const char *list = "";
	for (int i = 1; i <= program->stages; i++)
		list = format("%s%sstage%d[%s_STATES]", list, *list ? ", " : "", i, e->upper);
	if (program->loops)
		list = format("%s%snext[%s_STATES]", list, *list ? ", " : "", e->upper);
	if (program->predicts)
		list = format("%s%sfirst[%s_STATES]", list, *list ? ", " : "", e->upper);
	for (int t = 0; t < e->step->tables && flows_apart(e); t++)
		if (e->step->branch[0].table[t]->Phi)
			list = format("%s, flow%d[%s_STATES]", list, t, e->upper);
	for (int i = 0; i < program->nodes; i++)
		if (program->node_table[i] != NONE)
			list = format("%s, driven%d[%s_STATES]", list, i, e->upper);
	if (*list)
		fprintf(e->to, "    double %s;\n", list);
	fputs("    double ", e->to);
	for (int i = 0; i < program->lefts; i++)
		fprintf(e->to, "%sleft%d[%d]", i ? ", " : "", i, e->model->channels);
	fputs(program->loops ? ";\n    int i;\n" : ";\n", e->to);
}

/* The samples at the start of the step, and the slopes of those that ramp */
void emit_samples(const struct emitter *e)
{
	struct reads r = reads_of_leftover(e), chosen = r;
	bool selected = many_operators(e);
	if (selected)
		chosen = reads_of(e->model, 1, &e->model->selector);
	int inputs = e->system->inputs;
	const char *start = "", *slope = "";
	for (int i = 0; i < inputs; i++) {
		bool ramp = e->system->input[i].first_order;
		start = format("%s%s%s[%d]", start, i ? ", " : "", ramp ? "s->u" : "u", i);
		slope = format("%s%s%s", slope, i ? ", " : "", ramp ? format("(u[%d] - s->u[%d]) / %s_H", i, i, e->upper) : "0.0");
	}
	if (e->ramps && (any(r.input, inputs) || (selected && any(chosen.input, inputs))))
		fprintf(e->to, "    const double start[%s_INPUTS] = {%s};\n", e->upper, start);
	if (takes_slope(e, &r) || (selected && takes_slope(e, &chosen)))
		fprintf(e->to, "    const double slope[%s_INPUTS] = {%s};\n", e->upper, slope);
}

static void emit_operands(const struct emitter *e)
{
	int *column, columns = acting_columns(e, &column);
	if (columns) {
		fprintf(e->to, "    const double load[%d] = {", columns);
		for (int k = 0; k < columns; k++) {
			const char *operand = column_operand(e, column[k]);
			fprintf(e->to, "%s%s", k ? ", " : "", operand ? operand : "1.0");
		}
		fputs("};\n", e->to);
	}
	if (e->step->branch->whole->inputs) {
		fprintf(e->to, "    const double input[%d] = {", e->step->branch->whole->inputs);
		for (int k = 0; k < e->step->branch->whole->inputs; k++)
			fprintf(e->to, "%s%s", k ? ", " : "", input_operand(e, k));
		fputs("};\n", e->to);
	}
}

/* What the loads and inputs add from rest up to each node of the predictors */
static void emit_driven(const struct emitter *e)
{
	const struct program *program = e->step->program;
	for (int i = 0; i < program->nodes; i++) {
		int t = program->node_table[i];
		if (t == NONE)
			continue;
		if (program->loops) {
			struct table without = *e->step->branch[0].table[t], *kept = e->step->branch[0].table[t];
			without.Phi = NULL;
			e->step->branch[0].table[t] = &without;
			emit_flow_loop(e, t, format("driven%d", i), flows_apart(e) ? "        " : "    ");
			e->step->branch[0].table[t] = kept;
			continue;
		}
		struct table without = *e->step->branch[0].table[t];
		without.Phi = NULL;
		for (int row = 0; row < e->system->states; row++) {
			const char **term = ARRAY(const char *, most_terms(e));
			int terms = add_flow_terms(e, &without, row, term);
			fprintf(e->to, "    driven%d[%d] = %s;\n", i, row, terms ? tree(terms, term, 16) : "0.0");
		}
	}
}

static const char *time_of(const struct emitter *e, mpq_srcptr fraction)
{
	if (mpq_cmp_ui(fraction, 1, 1) == 0)
		return format("%s_H", e->upper);
	mpq_t tau;
	mpq_init(tau);
	mpq_mul(tau, fraction, e->model->h);
	const char *text = shortest(round_rational(tau));
	mpq_clear(tau);
	return text;
}

static void emit_flows_apart(const struct emitter *e)
{
	const struct program *program = e->step->program;
	const char *n = e->name, *which = many_operators(e) ? "which, " : "", *u = e->system->inputs ? "u, " : "";
	const char *held = e->step->series.powers ? "NULL, " : "";
	fprintf(e->to, "    if (s->segment < %d && %s_until(s, s->segment) < %s_H) {\n", e->system->segments - 1, n, e->upper);
	if (is_driven(e))
		fprintf(e->to, "        %s rest = *s;\n        for (i = 0; i < %s_STATES; i++)\n            rest.y[i] = 0.0;\n", n, e->upper);
	for (int t = 0; t < e->step->tables; t++)
		if (e->step->branch[0].table[t]->Phi)
			fprintf(e->to, "        %s_pass(s, %s%s%s%s, flow%d);\n", n, which, u, held, time_of(e, e->step->branch->whole->wanted[t].fraction), t);
	for (int i = 0; i < program->nodes; i++)
		if (program->node_table[i] != NONE)
			fprintf(e->to, "        %s_pass(&rest, %s%s%s%s, driven%d);\n", n, which, u, held, time_of(e, program->node[i]), i);
	fputs("    } else {\n", e->to);
	for (int t = 0; t < e->step->tables; t++)
		if (e->step->branch[0].table[t]->Phi)
			emit_flow_loop(e, t, format("flow%d", t), "        ");
	emit_driven(e);
	fputs("    }\n", e->to);
}

/* Loads whose states the step reads: loops read all of those that act, sums not the constant 1 */
static bool *acting_loads(const struct emitter *e)
{
	const struct linear *system = e->system;
	bool *acting = ARRAY(bool, (size_t)system->loads);
	for (int l = 0; l < system->loads; l++)
		for (int k = 0; k < system->load[l].columns; k++)
			for (int i = 0; i < system->segments * system->n && (e->step->program->loops || load_operand(e, l, k)); i++)
				acting[l] = acting[l] || mpq_sgn(system->load[l].force[k][i]) != 0;
	return acting;
}

static bool *all_states(const struct emitter *e)
{
	bool *all = ARRAY(bool, (size_t)e->system->states);
	for (int i = 0; i < e->system->states; i++)
		for (int j = 0; j < e->system->states; j++)
			for (int t = 0; t < e->step->tables; t++)
				all[j] = all[j] || (e->step->branch[0].table[t]->Phi && !e->step->branch[0].table[t]->Phi[i * e->system->states + j].zero);
	return all;
}

const char *selection_call(const struct emitter *e)
{
	struct reads r = reads_of(e->model, 1, &e->model->selector);
	const char *u = !any(r.input, e->system->inputs) ? "" : e->ramps ? ", start" : ", u";
	return format("%s_operator(s%s%s)", e->name, u, reads_slope(e, &r) ? ", slope" : "");
}

void emit_leftover_functions(const struct emitter *e)
{
	emit_leftover(e);
	if (many_operators(e))
		emit_selection(e);
}

void emit_leftover_step(const struct emitter *e)
{
	const struct program *program = e->step->program;
	if (program->loops)
		emit_tables(e);
	if (program->predicts)
		emit_predictor(e);
	fprintf(e->to, "\nvoid %s_step(%s)\n{\n", e->name, step_parameters(e));
	emit_set_aside(e);
	if (!program->loops)
		emit_locals(e, all_states(e));
	emit_load_states(e, acting_loads(e), false);
	emit_samples(e);
	if (many_operators(e))
		fprintf(e->to, "    const int which = %s;\n", selection_call(e));
	if (program->loops)
		emit_operands(e);
	declare_vectors(e);
	if (flows_apart(e))
		emit_flows_apart(e);
	else
		emit_driven(e);
	for (int i = 0; i < program->actions; i++)
		emit_action(e, &program->action[i]);
	emit_take_back(e);
	emit_step_end(e);
	fprintf(e->to, "    s->status |= pl_not_finite(s->y, %s_STATES);\n", e->upper);
	if (e->system->segments > 1)
		fprintf(e->to, "    while (s->segment < %d && %s_until(s, s->segment) <= 1e-18 * %s_H)\n        s->segment++;\n", e->system->segments - 1, e->name,
			e->upper);
	fputs("}\n", e->to);
}
