/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What was derived: for a person, and as JSON for a program. */
#include "report/report.h"

#include <math.h>
#include <string.h>

/* ---- for a person ---- */

static void person_matrix(FILE *to, const char *name, int n, const mpq_t *A)
{
	int width = 1;
	for (int i = 0; i < n * n; i++) {
		int length = (int)strlen(readable_text(A[i]));
		width = length > width ? length : width;
	}
	for (int i = 0; i < n; i++) {
		fprintf(to, "    %s [", i == 0 ? format("%s =", name) : "   ");
		for (int j = 0; j < n; j++)
			fprintf(to, " %*s", width, readable_text(A[i * n + j]));
		fputs(" ]\n", to);
	}
}

static void person_force(FILE *to, const char *what, int n, const mpq_t *force)
{
	bool any = false;
	for (int i = 0; i < n; i++)
		any = any || mpq_sgn(force[i]) != 0;
	if (!any)
		return;
	fprintf(to, "    %s on the equations: [", what);
	for (int i = 0; i < n; i++)
		fprintf(to, " %s", readable_text(force[i]));
	fputs(" ]\n", to);
}

static void person_loads(FILE *to, const struct linear *system)
{
	for (int l = 0; l < system->loads; l++)
		for (int k = 0; k < system->load[l].columns; k++)
			person_force(to, format("load %s", column_text(&system->load[l], k)), system->n,
				     (const mpq_t *)system->load[l].force[k]);
	for (int i = 0; i < system->inputs; i++)
		for (int k = 0; k < 2; k++)
			person_force(to, format("input %s%s", system->input[i].name, k ? "'" : ""), system->n,
				     (const mpq_t *)system->input[i].force[k]);
}

static void person_poles(FILE *to, const struct model *model, const struct resolvent *resolvent)
{
	int length = resolvent_determinant(resolvent)->length;
	mpq_t *B = rationals((size_t)length);
	characteristic_polynomial(resolvent, B);
	fprintf(to, "\n    B(s) = %s\n\n", polynomial_text(length, (const mpq_t *)B));
	struct pole_report *pole;
	int count = poles_of(model, resolvent, &pole);
	fprintf(to, "    %-36s %-16s damping ratio\n", "pole [1/s]", "frequency [Hz]");
	for (int i = 0; i < count; i++)
		fprintf(to, "    %s\n", pole_row(&pole[i], 36));
}

static void person_held(FILE *to, const struct step *step)
{
	const struct linear *system = &step->branch->system;
	int n = system->n;
	fputs("Scheme pl holds these accelerations at their value at the start of each step:\n", to);
	for (int i = 0; i < n; i++)
		for (int k = 0; k < 2; k++)
			for (int j = 0; j < n; j++) {
				mpq_t factor;
				mpq_init(factor);
				mpq_neg(factor, (k ? system->heldC : system->heldK)[i * n + j]);
				if (mpq_sgn(factor) != 0)
					fprintf(to, "    in %s'': %s * %s%s\n", step->model->coord_name[i],
						readable_text(factor), step->model->coord_name[j], k ? "'" : "");
				mpq_clear(factor);
			}
	fprintf(to,
		"It is of first order in h. Its modified equation y' = L y - (h/2) R L y (R: the held terms) has "
		"growth rate\n"
		"%.6g 1/s, the largest real part of its poles, at h = %s s.\n",
		growth_rate(step), readable_text(step->model->h));
}

/* Of a large step: which of its independent blocks they touch */
static void person_blocks(FILE *to, const struct tuned_blocks *p)
{
	int touched = 0;
	for (int b = 0; b < p->blocks; b++)
		touched += p->block[b].group->tuned;
	fprintf(to, "They touch %d of %d independent blocks; %s.\n", touched, p->blocks,
		p->whole ? "another h does, too" : "the others have tables, of this h");
}

static void person_tuning(FILE *to, const struct step *step)
{
	const struct model *model = step->model;
	const struct tuning *t = tunables_of(model);
	fputs("Tunable on the target:", to);
	for (int k = 0; k < t->params; k++)
		fprintf(to, "%s %s = %s", k ? "," : "", t->param[k].symbol->name, readable_text(t->nominal[k]));
	if (model->retuned)
		fprintf(to, "; rows of regions that change with them have %d terms there%s.\n",
			model->retuned->tuning->terms,
			model->retuned->blocks ? format(", and %d sets of them are solved", model->retuned->blocks)
					       : "");
	else if (model->held && model->switching)
		fputs("; they act like held inputs.\n", to);
	else if (model->held)
		fputs("; expressions read them there. Operators, orders and choices are those of these values.\n", to);
	else
		fprintf(to, "; the equations there have %d term%s%s.\n", t->terms, t->terms == 1 ? "" : "s",
			t->solves ? ", and are solved for the highest derivatives" : "");
	if (step->blocks)
		person_blocks(to, step->blocks);
}

/* What the step keeps in the place of positions and velocities as written */
static void person_relative(FILE *to, const struct model *model)
{
	const struct relative *r = model->relative;
	const char *list = "";
	for (int j = 0; j < r->written->n; j++)
		if (r->link[j].kind != LINK_NONE)
			list = format("%s%s%s", list, *list ? ", " : "", r->name[j]);
	fprintf(to, "What may move as a whole is kept apart from what moves in it: the step keeps %s.\n", list);
}

static void person_operations(FILE *to, const struct step *step)
{
	const struct model *model = step->shown->model;
	const struct program *program = step->program;
	fprintf(to, "Step: form %s, h = %s s; %d multiplications, %d additions", step_form_text(step),
		readable_text(model->h), program->multiplications, program->additions);
	if (step->anchors)
		fprintf(to, "; every %d steps, for the functions of the loads, %d and %d more", step->anchors->steps,
			program->wave_multiplications, program->wave_additions);
	else if (program->wave_multiplications)
		fprintf(to, " (%d and %d of them for the functions of the loads%s%s)", program->wave_multiplications,
			program->wave_additions, step->no_anchors ? "; no anchors with " : "",
			step->no_anchors ? step->no_anchors : "");
	if (program->calls)
		fprintf(to, ", %d calls of the model's own functions", program->calls);
	if (peak_outputs(step->model) > 0)
		fprintf(to, ".\nThe look for peaks takes %d and %d more, the outputs counted, where a bound shows that "
			"none passes its peak",
			program->peak_multiplications, program->peak_additions);
	if (step->model->relative) {
		fputs(".\n", to);
		person_relative(to, step->model);
	}
	struct drift drift = drift_of(step);
	if (drift.known)
		fprintf(to, ".\n%s", drift_text(&drift));
	if (step->rounding.known)
		fprintf(to, ".\n%s", rounding_text(step));
}

void person_cost(FILE *to, const struct step *step)
{
	person_operations(to, step);
	fputs(".\n", to);
	if (step->choice)
		person_needs(to, step);
}

static void person_step(FILE *to, const struct step *step)
{
	const struct model *model = step->shown->model;
	person_operations(to, step);
	if (step->shown->no_phi)
		fprintf(to, ".\nThere is no Phi: %s.\n", step->shown->no_phi);
	else
		fprintf(to, ".\nPhi%s, each entry correctly rounded:\n",
			!has_leftover(step)  ? ""
			: step->branches > 1 ? " = e^{A h} of the first operator"
					     : " = e^{A h}");
	for (int i = 0; i < model->system.states && !step->shown->no_phi; i++) {
		fprintf(to, "    %-8s", model->state_name[i]);
		for (int j = 0; j < model->system.states; j++)
			fprintf(to, " %24s",
				shortest(step->shown->branch->whole->Phi[i * model->system.states + j].value));
		fputc('\n', to);
	}
	if (tunables_of(model))
		person_tuning(to, step);
	if (model->switching)
		fprintf(to, "%s_at: like a step, with every crossing on the way.\n", model->name);
	else if (model->tuning && !step->series.emitted)
		fprintf(to, "No %s_at: an independent block has more than %d states, load states and inputs.\n",
			model->name, LIMIT_TUNED_BLOCK);
	else if (model->tuning)
		fprintf(to, "%s_at: e^{A tau} of the instance's own params, as %s_retune computes it.\n", model->name,
			model->name);
	else if (step->collocation)
		fprintf(to, "%s_at: the polynomial of the internal step, or of the next.\n", model->name);
	else if (step->expansion)
		fprintf(to, "%s_at: the series of the step, at a part of it.\n", model->name);
	else if (step->normal && step->series.emitted)
		fprintf(to, "%s_at: the step's modes under the polynomial of its forces, by series of %d terms.\n",
			model->name, step->normal->within.terms);
	else if (step->normal)
		fprintf(to, "%s_at is not emitted: in a step a mode turns or decays by more than %d.\n", model->name,
			LIMIT_WITHIN);
	else if (step->series.emitted)
		fprintf(to, "%s_at: Taylor series of degree %d on %d part%s of the time.\n", model->name,
			step->series.degree, 1 << step->series.halvings, step->series.halvings ? "s" : "");
	else
		fprintf(to, "%s_at is not emitted: %s.\n", model->name,
			has_leftover(step) && !step->layout.powers
				? "between its steps the scheme has no values of its order"
				: "the largest |pole| times h is above 8");
}

/* Of the tables of a swift step: bounds for each matrix; for each region and expression, where it is and which are
 * beside it */
static long swift_bytes(const struct step *step)
{
	const struct switching *s = step->model->switching;
	long size = step->layout.size, halves = 0;
	for (int k = 0; k < step->branches; k++)
		halves = halves || step->branch[k].halvings > 0;
	long off = halves || is_cleared_by_tables(step) ? size + 1 : 0;
	return 8 * s->systems *
		       (s->expressions * (2 * size + off) + halves * size * (size + 2 * s->expressions)) +
	       28 * (long)s->regions * s->expressions + 8 * (step->swift_degree + 1);
}

/* Of cos, sin and e^{at} in the steps after an anchor */
static long anchor_bytes(const struct step *step)
{
	long numbers = 0;
	for (int l = 0; l < step->branch->system.loads && step->anchors; l++)
		if (is_anchored(step, l))
			numbers += step->anchors->steps * (1 + oscillates(step->branch->system.load[l].wave));
	return 8 * numbers;
}

/* What a swift step does before it leaves it to the search, at most: in each part of the step bounds, and polynomials
 * of x, corrected */
static long swift_multiplications(const struct step *step)
{
	long size = step->layout.size, bounds = step->model->switching->expressions * (12 * size + 60);
	long moves = 6 * step->swift_degree * (size * size + size) + 12 * size * size;
	return step->swift ? size * size + MOST_LOOKS * (bounds + moves) : 0;
}

/* Of what regions with friction have beside these, less two of them that they do not */
static long guard_bytes(const struct step *step)
{
	const struct switching *s = step->model->switching;
	struct pieces pieces = pieces_of(step);
	struct guards g = guards_of(step, &pieces);
	long size = step->layout.size, grips = 8 * size * s->regions * s->felts;
	return 8 * (g.rows * (4 * size + 1) + g.guards + g.assignments * size + s->expressions -
		    2 * s->systems * s->expressions * size + (s->segments - 1) * s->expressions) +
	       4 * (6 * g.guards + 2 * s->regions + 1 + g.assignments + g.sets + 1) + grips;
}

/* Of the tables of a step, or of a part that is stepped alone */
static long bytes_of_regions(const struct step *step)
{
	const struct switching *s = step->model->switching;
	long size = step->layout.size, matrices = s->systems;
	long rows = s->segments * s->expressions * size;
	long bytes = 8 * (rows + matrices * (2 * size * size + 3 * s->expressions * size)) +
		     4 * (s->regions + s->expressions + matrices);
	return bytes + (step->swift ? swift_bytes(step) : 0) + (has_events(s) ? guard_bytes(step) : 0);
}

/* The most multiplications of a step: every piece of it by a Taylor polynomial, all events and splits used */
static long most_of_regions(const struct step *step)
{
	const struct switching *s = step->model->switching;
	long size = step->layout.size, degree = step->series.degree, pieces = 1;
	for (int k = 0; k < step->branches; k++)
		pieces = 1l << step->branch[k].halvings > pieces ? 1l << step->branch[k].halvings : pieces;
	pieces += max_events(step->model) + 1;
	return pieces * (degree * (size * size + 2 * size) + (degree + 1) * s->expressions * (size + 6)) +
	       4 * (degree + 1) *
		       (2 * max_splits(step->model) + 4 * s->expressions * pieces + 64 * max_events(step->model)) +
	       swift_multiplications(step);
}

static void person_expressions(FILE *to, const struct step *step)
{
	const struct switching *s = step->shown->model->switching;
	for (int i = 0; i < s->expressions; i++) {
		fprintf(to, "    expression %d: %s%s breakpoints", i, spoken_expression(step->shown->model, i),
			s->expression[i].segments > 1 ? ";" : ",");
		for (int k = 0; k < s->expression[i].breaks; k++)
			fprintf(to, "%s %s", k ? "," : "", readable_text(s->expression[i].at[k]));
		fputc('\n', to);
	}
}

/* What chooses formulas by the state, of a series */
static void person_divided(FILE *to, const struct step *step)
{
	const struct expansion *x = step->divided;
	fprintf(to, "The state chooses formulas; %s ends where an expression passes a breakpoint, at most %d "
		    "times in a step:\n", !step->collocation ? "a series" : "an internal step",
		max_events(step->model));
	for (int i = 0; i < x->expressions; i++) {
		const struct divided *d = &x->expression[i];
		mpq_t *rising = rising_breakpoints(d);
		fprintf(to, "    expression %d: %s, breakpoints", i, divided_text(step, i));
		for (int k = 0; k < d->breaks; k++)
			fprintf(to, "%s %s", k ? "," : "", readable_text(rising[k]));
		fputc('\n', to);
	}
	person_contacts(to, step);
}

/* What rubs, and where it sticks: its expression, and the interval of that */
static void person_frictions(FILE *to, const struct switching *s)
{
	for (int i = 0, shown = 0; i < s->frictions; i++) {
		const struct node *node = s->friction[i].atom->node;
		if (is_repeated(s, i))
			continue;
		fprintf(to, "    friction %d: %s; sticks in interval %d of expression %d\n", shown++,
			text_between(node->start, node->end), stick_of(s, &s->friction[i]), s->friction[i].expression);
	}
	for (int i = 0; i < s->sliders; i++)
		if (!is_repeated_slider(s, i))
			fprintf(to, "    slider: %s\n", slider_text(s, i));
}

static void person_intervals(FILE *to, const struct switching *s, int region)
{
	fputs(" (intervals", to);
	for (int i = 0; i < s->expressions; i++)
		fprintf(to, " %d", interval_of(s, region, i));
	fprintf(to, "%s): matrix %d\n",
		s->segments > 1 ? format("; segment %d of time", segment_of_region(s, region) + 1) : "",
		s->region[region].system);
}

static void person_way(FILE *to, const struct step *step, const char *of)
{
	if (step->swift)
		fprintf(to,
			"%s that a bound shows clear is one product; up to %d crossings go by Taylor polynomials of "
			"degree %d, all else by the search.\n",
			of, MOST_SWIFT, step->swift_degree);
	else
		fprintf(to, "%s goes by the search: %s.\n", *of == 'A' ? "Every step" : of, step->searches);
}

static void person_impacts(FILE *to, const struct model *model)
{
	for (int i = 0; i < model->impacts; i++) {
		const struct impact *impact = &model->impact[i];
		fprintf(to, "    impact %d: %s", i, text_between(impact->when->at, impact->when->end));
		if (impact->bounces)
			fprintf(to, "; a bounce of restitution %s, which rests in interval %d of expression %d",
				restitution_text(model, impact), rest_of(model->switching, 0, impact),
				impact->in->expression);
		fputs("\n", to);
	}
}

static void person_regions(FILE *to, const struct step *step)
{
	const struct switching *s = step->shown->model->switching;
	fprintf(to,
		"Piecewise linear: %d regions%s, %d of them different; in each nothing is approximated, every constant "
		"is correctly rounded.\n",
		possible_regions(s), s->segments > 1 ? format(" in %d segments of time", s->segments) : "", s->systems);
	person_expressions(to, step);
	person_frictions(to, s);
	person_impacts(to, step->shown->model);
	if (s->sharing)
		fprintf(to, "Coordinates move as a whole: %d independent parts have their regions together.\n",
			s->sharing);
	for (int r = 0; r < s->regions; r++)
		if (s->region[r].possible) {
			fprintf(to, "    region %d", r % regions_at_once(s));
			person_intervals(to, s, r);
		}
	person_way(to, step, "A step");
	fprintf(to, "Tables: %ld bytes. Per step at most %d crossings and %d splits; at most %ld multiplications.\n",
		bytes_of_regions(step) + anchor_bytes(step), max_events(step->model), max_splits(step->model),
		most_of_regions(step));
}

/* ---- independent parts ---- */

static void person_part(FILE *to, const struct step *whole, int index)
{
	const struct switching *all = whole->model->switching;
	const struct region_part *part = &all->part[index];
	const struct switching *s = part->model->switching;
	fprintf(to, "    part %d:", index);
	for (int i = 0; i < part->model->n; i++)
		fprintf(to, "%s %s", i ? "," : "", part->model->coord_name[i]);
	if (s->expressions == 0) {
		fputs("; linear\n", to);
		return;
	}
	fputs("; expressions", to);
	for (int i = 0; i < s->expressions; i++)
		fprintf(to, "%s %d", i ? "," : "", part->expression[i]);
	fprintf(to, "; %d regions, %d of them different\n", possible_regions(s), s->systems);
	for (int r = 0; r < s->regions; r++)
		if (s->region[r].possible) {
			fprintf(to, "        %d of the region's number", share_of_region(part, all, r));
			person_intervals(to, s, r);
		}
	person_way(to, whole->part[index], "        A step of it");
}

static void person_parts(FILE *to, const struct step *step)
{
	long bytes = anchor_bytes(step), most = 0;
	fprintf(to,
		"Piecewise linear, in %d independent parts, each stepped by itself; in each region nothing is "
		"approximated, every constant is correctly rounded.\n",
		step->parts);
	person_expressions(to, step);
	for (int p = 0; p < step->parts; p++) {
		person_part(to, step, p);
		bytes += bytes_of_regions(step->part[p]);
		most += most_of_regions(step->part[p]);
	}
	fprintf(to,
		"Tables: %ld bytes. Per step of each part at most %d crossings and %d splits; of all at most %ld "
		"multiplications.\n",
		bytes, MAX_EVENTS, MAX_SPLITS, most);
}

/* Stages, order and nodes; how Newton's method solves them; what an iteration costs */
static void person_collocation(FILE *to, const struct step *step)
{
	const struct collocation *x = step->collocation;
	int coords = step->motion->coords;
	fprintf(to, ".\nThe collocation has %d stages, of order %d at the ends of its steps and %d inside, at the "
		"nodes\n   ",
		x->stages, 2 * x->stages - 1, x->stages + 1);
	for (int i = 0; i < x->stages; i++)
		fprintf(to, "%s %.6g", i ? "," : "", x->node[i]);
	if (step->motion->apart)
		fprintf(to, ".\nNewton's method takes the Jacobian where a step starts, and solves one real and %d "
			"complex systems of %d unknowns", x->modes - 1, coords);
	else
		fprintf(to, ".\nNewton's method takes the Jacobian at each node, and solves %d unknowns together",
			x->stages * coords);
	fprintf(to, ":\n%d multiplications, %d additions, %d calls an iteration, of which a step takes two to four; "
		"where the step is longer than h, several h share them", step->iteration.multiplications,
		step->iteration.additions, step->iteration.calls);
}

/* What went where: the operators, then the leftover of the first; those of the others differ in linear terms only. */
static void person_split(FILE *to, const struct step *step)
{
	const struct model *model = step->shown->model;
	fprintf(to, "Split: y' = A y + loads%s + r(t, y). A, the loads%s are exact, each constant correctly rounded.\n",
		step->branch->system.inputs ? " + inputs" : "",
		model->loads_left             ? " excepted"
		: step->branch->system.inputs ? " and the inputs"
					      : "");
	for (int k = 0; k < model->operators && !step->normal; k++) {
		const struct operator *operator = &model->operator[k];
		if (!*operator->text) {
			fputs(scheme_row(model->scheme)->holds_coupling
				      ? "A: each coordinate's own terms.\n"
				      : "A: the linear terms with constant coefficients, as above.\n",
			      to);
			continue;
		}
		fprintf(to,
			"A: the Jacobian of the equations at %s (of an entry that still moves there, the constant "
			"part):\n",
			operator->text);
		person_matrix(to, "C", model->n, (const mpq_t *)operator->C);
		person_matrix(to, "K", model->n, (const mpq_t *)operator->K);
		if (!scheme_row(model->scheme)->holds_coupling)
			person_poles(to, model, step->shown->branch[k].resolvent);
	}
	if (step->normal)
		person_normal(to, step);
	if (model->operators > 1)
		fputs("A step uses the first operator whose value is not below the current one, else the last.\n", to);
	fprintf(to, "Scheme %s is of order %d in h", scheme_name(model->scheme), order_of_step(step));
	if (model->truncation.adaptive)
		fprintf(to, ", its steps as long as a tolerance of %s lets them be",
			readable_text(model->truncation.tolerance));
	if (model->truncation.over > 1)
		fprintf(to, ", with the error of steps of %d h: one expansion is over them", model->truncation.over);
	if (step->collocation)
		person_collocation(to, step);
	if (loses_order(model))
		fprintf(to, " where all is smooth; here of order %s at most: %s", order_text(model),
			smoothness_text(model));
	fputs(".\n", to);
	if (step->divided)
		person_divided(to, step);
	if (step->expansion)
		person_reach(to, step);
	fprintf(to, "r, left to scheme %s, is a force on each of these equations%s:\n", scheme_name(model->scheme),
		model->operators > 1 ? " (with the first operator; with the others its linear terms differ)" : "");
	for (int c = 0; c < model->channels; c++)
		fprintf(to, "    %s: %s\n", model->coord_name[coordinate_of_row(model, model->channel_row[c])],
			form_text(model, model->operator[0].left[c]));
}

/* A row over the written states, a - 2*b */
static const char *combination_text(const struct model *written, const mpq_t *row)
{
	const char *text = "";
	mpq_t size;
	mpq_init(size);
	for (int j = 0; j < written->system.states; j++) {
		int sign = mpq_sgn(row[j]);
		if (sign == 0)
			continue;
		mpq_abs(size, row[j]);
		text = format("%s%s%s%s", text, *text ? sign < 0 ? " - " : " + " : sign < 0 ? "-" : "",
			      mpq_cmp_ui(size, 1, 1) == 0 ? "" : format("%s*", readable_text(size)),
			      written->state_name[j]);
	}
	mpq_clear(size);
	return text;
}

/* What went: states that no output sees, and with them the poles that cancel in every N/B. */
static void person_reduction(FILE *to, const struct step *step)
{
	const struct model *model = step->model;
	fprintf(to, "Reduced to what the outputs can see: %d of %d states.\n", model->system.states,
		model->written->system.states);
	for (int i = 0; i < model->system.states; i++) {
		const mpq_t *row = (const mpq_t *)model->reduction.row;
		const char *text = row ? combination_text(model->written, row + i * model->written->system.states)
				       : model->state_name[i];
		bool same = strcmp(text, model->state_name[i]) == 0;
		fprintf(to, "    state %s%s%s\n", model->state_name[i], same ? "" : " = ", same ? "" : text);
	}
	fputs("Gone:", to);
	for (int i = 0; i < model->reduction.dropped; i++)
		fprintf(to, "%s %s", i ? "," : "", model->reduction.dropped_name[i]);
	fputs(model->reduction.dropped ? " (no output sees them, nor a combination of the states that are left).\n"
				       : " nothing.\n",
	      to);
	struct pole_report *pole;
	int count = poles_of(step->model, step->branch->resolvent, &pole);
	fputs("Poles that are left:\n", to);
	for (int i = 0; i < count; i++)
		fprintf(to, "    %s\n", pole_text(&pole[i]));
}

static void person_scene(FILE *to, const struct spec *spec)
{
	if (spec->parts)
		fputs("\nParts:\n", to);
	for (int i = 0; i < spec->parts; i++)
		if (parts_text(spec, i))
			fprintf(to, "    %s\n", parts_text(spec, i));
}

void person_equations(FILE *to, const struct step *step)
{
	const struct model *model = step->shown->model;
	const struct spec *spec = model->spec;
	for (int i = 0; i < spec->equations; i++)
		fprintf(to, "    %s\n",
			written_text(spec->equation[i].part, spec->equation[i].at, spec->equation[i].end));
	for (int i = 0; i < spec->elements; i++)
		fprintf(to, "    %s\n",
			written_text(spec->element[i].part, spec->element[i].at, spec->element[i].end));
	person_scene(to, spec);
	if (spec->elements) {
		fputs("\nEquations of the sketch:\n\n", to);
		for (int i = 0; i < model->written->n; i++)
			fprintf(to, "    %s\n", equation_text(model->written, model->residual[i].form));
	}
}

void person_course(FILE *to, const struct step *step)
{
	const struct model *model = step->shown->model;
	if (scheme_row(model->scheme)->holds_coupling)
		person_held(to, step);
	if (model->switching)
		(step->parts ? person_parts : person_regions)(to, step);
	else if (has_leftover(step))
		person_split(to, step);
	else if (!scheme_row(model->scheme)->holds_coupling)
		fprintf(to, "%s: every constant is its closed form, correctly rounded.\n",
			model->shortened ? "Modes are dropped, nothing else is approximated"
					 : "Nothing is approximated");
	if (model->shortened)
		person_shortening(to, model);
	else if (model->written != model)
		person_reduction(to, step);
	if (model->reduction.irreducible)
		fputs("Nothing to reduce: every state is seen by an output.\n", to);
}

void explain_person(FILE *to, const struct step *step)
{
	const struct model *model = step->shown->model;
	fprintf(to, "Model %s: %d coordinate%s, %d states, scheme %s\n\n", model->name, model->written->n,
		model->written->n == 1 ? "" : "s", model->written->system.states, scheme_name(model->scheme));
	person_equations(to, step);
	fputs("\nP(s) = M s^2 + C s + K with\n", to);
	person_matrix(to, "M", model->written->n, (const mpq_t *)model->written->system.M);
	person_matrix(to, "C", model->written->n, (const mpq_t *)model->written->system.C);
	person_matrix(to, "K", model->written->n, (const mpq_t *)model->written->system.K);
	person_loads(to, &model->written->system);
	if (model->shortened)
		fputs("\nOf the modes that are kept:\n", to);
	person_poles(to, step->model, step->written);
	const char *irrational = irrationals_text(&model->irrationals);
	if (*irrational)
		fprintf(to, "\nIrrational constants (%s) were taken as rationals of %d bits.\n", irrational,
			IRRATIONAL_BITS);
	fputc('\n', to);
	person_course(to, step);
	person_step(to, step);
	if (step->choice)
		person_needs(to, step);
	person_linear(to, step);
}

/* ---- JSON ---- */

static void json_name(FILE *to, const char *name)
{
	fprintf(to, "\"%s\"", name);       /* names are identifiers with primes: nothing to escape */
}

static void json_names(FILE *to, const char *key, int count, const char *const *name)
{
	fprintf(to, "  \"%s\": [", key);
	for (int i = 0; i < count; i++) {
		fputs(i ? ", " : "", to);
		json_name(to, name[i]);
	}
	fputs("],\n", to);
}

/* JSON has no infinity: what is beyond the range of double is null. */
static const char *json_number(double value)
{
	return isfinite(value) ? format("%.17g", value) : "null";
}

static void json_matrix(FILE *to, const char *key, int rows, int columns, const double *value)
{
	fprintf(to, "  \"%s\": [", key);
	for (int i = 0; i < rows; i++) {
		fputs(i ? ",\n    [" : "\n    [", to);
		for (int j = 0; j < columns; j++)
			fprintf(to, "%s%s", j ? ", " : "", json_number(value[i * columns + j]));
		fputc(']', to);
	}
	fputs("],\n", to);
}

static void json_rational_matrix(FILE *to, const char *key, int n, const mpq_t *A)
{
	double *value = ARRAY(double, (size_t)(n * n));
	for (int i = 0; i < n * n; i++)
		value[i] = nearest_double(A[i]);
	json_matrix(to, key, n, n, value);
}

static void json_pole(FILE *to, const struct pole_report *pole, bool conjugate, bool first)
{
	double im = mpfr_get_d(pole->im, MPFR_RNDN);
	fprintf(to, "%s\n    {\"re\": %s, \"im\": %s, \"multiplicity\": %d}", first ? "" : ",",
		json_number(mpfr_get_d(pole->re, MPFR_RNDN)), json_number(conjugate ? -im : im), pole->multiplicity);
}

/* One mode for each pair of poles, for each real pole, and for each two poles at 0 (a rigid body). */
static void json_modes(FILE *to, int count, const struct pole_report *pole)
{
	fputs("  \"modes\": [", to);
	bool first = true;
	for (int i = 0; i < count; i++) {
		int modes = mpfr_zero_p(pole[i].hertz) ? (pole[i].multiplicity + 1) / 2 : pole[i].multiplicity;
		for (int k = 0; k < modes; k++, first = false)
			fprintf(to, "%s\n    {\"frequency_hz\": %s, \"damping_ratio\": %s}", first ? "" : ",",
				json_number(mpfr_get_d(pole[i].hertz, MPFR_RNDN)),
				json_number(mpfr_get_d(pole[i].damping_ratio, MPFR_RNDN)));
	}
	fputs("],\n", to);
}

static void json_pole_list(FILE *to, int count, const struct pole_report *pole)
{
	fputs("  \"poles\": [", to);
	for (int i = 0; i < count; i++) {
		json_pole(to, &pole[i], false, i == 0);
		if (pole[i].pair)
			json_pole(to, &pole[i], true, false);
	}
	fputs("]", to);
}

static void json_poles(FILE *to, const struct step *step)
{
	int length = resolvent_determinant(step->written)->length;
	mpq_t *B = rationals((size_t)length);
	characteristic_polynomial(step->written, B);
	fputs("  \"B\": [", to);
	for (int k = 0; k < length; k++)
		fprintf(to, "%s\"%s\"", k ? ", " : "", exact_text(B[k]));
	fputs("],\n", to);
	struct pole_report *pole;
	int count = poles_of(step->model, step->written, &pole);
	json_pole_list(to, count, pole);
	fputs(",\n", to);
	json_modes(to, count, pole);
}

static void json_column(FILE *to, int rows, int columns, int column, const struct coefficient *value)
{
	fputc('[', to);
	for (int i = 0; i < rows; i++)
		fprintf(to, "%s%.17g", i ? ", " : "", value[i * columns + column].value);
	fputc(']', to);
}

/* Columns as the step applies them: to the load states at the start of the step, t^k times cos before sin. */
static void json_loads(FILE *to, const struct step *step)
{
	const struct table *table = step->shown->branch->whole;
	fputs("  \"loads\": [", to);
	for (int l = 0, column = 0; l < step->branch->system.loads; l++) {
		const struct load *load = &step->branch->system.load[l];
		int trig = oscillates(load->wave) ? 2 : 1;
		for (int k = 0; k < load->columns; k += trig) {
			fprintf(to, "%s\n    {\"term\": \"%s\", \"columns\": [", column ? "," : "",
				column_text(load, k));
			for (int i = 0; i < trig; i++, column++) {
				fputs(i ? ", " : "", to);
				json_column(to, table->states, table->columns, column, table->load);
			}
			fputs("]}", to);
		}
	}
	fputs("],\n  \"Gamma\": [", to);
	for (int i = 0, column = 0; i < step->branch->system.inputs; i++) {
		fprintf(to, "%s\n    {\"input\": \"%s\", \"columns\": [", i ? "," : "",
			step->branch->system.input[i].name);
		for (int k = 0; k <= step->branch->system.input[i].hold; k++, column++) {
			fputs(k ? ", " : "", to);
			json_column(to, table->states, table->inputs, column, table->input);
		}
		fputs("]}", to);
	}
	fputs("],\n", to);
}

/* Operators as what multiplies q' and q, and their poles; the leftover of the first, as text */
static void json_split(FILE *to, const struct step *step)
{
	const struct model *model = step->shown->model;
	if (step->normal)
		json_normal(to, step);
	fputs("  \"operators\": [", to);
	for (int k = 0; k < model->operators && !step->normal; k++) {
		struct pole_report *pole;
		int count = poles_of(model, step->shown->branch[k].resolvent, &pole);
		fprintf(to, "%s{\n  \"at\": \"%s\",\n", k ? ", " : "", model->operator[k].text);
		json_rational_matrix(to, "C", model->n, (const mpq_t *)model->operator[k].C);
		json_rational_matrix(to, "K", model->n, (const mpq_t *)model->operator[k].K);
		json_pole_list(to, count, pole);
		fputs("}", to);
	}
	fputs("],\n  \"leftover\": [", to);
	for (int c = 0; c < model->channels; c++)
		fprintf(to, "%s\n    {\"equation\": \"%s\", \"force\": \"%s\"}", c ? "," : "",
			model->coord_name[coordinate_of_row(model, model->channel_row[c])],
			form_text(model, model->operator[0].left[c]));
	fputs("],\n", to);
}

static void json_expressions(FILE *to, const struct step *step)
{
	const struct switching *s = step->shown->model->switching;
	fputs("  \"expressions\": [", to);
	for (int i = 0; i < s->expressions; i++) {
		fprintf(to, "%s\n    {\"expression\": \"%s\", \"breakpoints\": [", i ? "," : "",
			spoken_expression(step->shown->model, i));
		for (int k = 0; k < s->expression[i].breaks; k++)
			fprintf(to, "%s%.17g", k ? ", " : "", nearest_double(s->expression[i].at[k]));
		fputs("]}", to);
	}
	fputs("],\n", to);
}

/* Of time, where there are several */
static const char *json_segment(const struct switching *s, int region)
{
	return s->segments > 1 ? format(", \"segment\": %d", segment_of_region(s, region)) : "";
}

static void json_frictions(FILE *to, const struct switching *s)
{
	fputs("  \"frictions\": [", to);
	for (int i = 0; i < s->frictions; i++)
		if (!is_repeated(s, i))
			fprintf(to, "%s{\"expression\": %d, \"sticks\": %d}", i ? ", " : "",
				s->friction[i].expression, stick_of(s, &s->friction[i]));
	fputs("],\n", to);
}

static void json_sliders(FILE *to, const struct switching *s)
{
	fputs("  \"sliders\": [", to);
	for (int i = 0; i < s->sliders; i++)
		fprintf(to, "%s{\"expressions\": [%d, %d], \"upward\": [%s, %s]}", i ? ", " : "",
			s->slider[i].expression[0], s->slider[i].expression[1],
			s->slider[i].upward[0] ? "true" : "false", s->slider[i].upward[1] ? "true" : "false");
	fputs("],\n", to);
}

static void json_impacts(FILE *to, const struct model *model)
{
	fputs("  \"impacts\": [", to);
	for (int i = 0; i < model->impacts; i++) {
		const struct impact *impact = &model->impact[i];
		fprintf(to, "%s{\"expression\": %d, \"upward\": %s, \"restitution\": ", i ? ", " : "",
			impact->in->expression, impact->in->upward ? "true" : "false");
		if (impact->bounces)
			fprintf(to, "%.17g, \"rests\": %d}", nearest_double(impact->in->restitution),
				rest_of(model->switching, 0, impact));
		else
			fputs("null}", to);
	}
	fputs("],\n", to);
}

static void json_region_list(FILE *to, const struct switching *s)
{
	bool first = true;
	fputs("  \"regions\": [", to);
	for (int r = 0; r < s->regions; r++) {
		if (!s->region[r].possible)
			continue;
		fprintf(to, "%s\n    {\"number\": %d%s, \"matrix\": %d}", first ? "" : ",", r % regions_at_once(s),
			json_segment(s, r), s->region[r].system);
		first = false;
	}
	fputs("],\n", to);
}

/* number: what a region of the part adds to that of the model */
static void json_part(FILE *to, const struct switching *all, int index)
{
	const struct region_part *part = &all->part[index];
	const struct switching *s = part->model->switching;
	bool first = true;
	fprintf(to, "%s\n    {\"coordinates\": [", index ? "," : "");
	for (int i = 0; i < part->model->n; i++)
		fprintf(to, "%s\"%s\"", i ? ", " : "", part->model->coord_name[i]);
	fputs("], \"expressions\": [", to);
	for (int i = 0; i < s->expressions; i++)
		fprintf(to, "%s%d", i ? ", " : "", part->expression[i]);
	fputs("],\n     \"regions\": [", to);
	for (int r = 0; r < s->regions && s->expressions > 0; r++) {
		if (!s->region[r].possible)
			continue;
		fprintf(to, "%s{\"number\": %d%s, \"matrix\": %d}", first ? "" : ", ",
			share_of_region(part, all, r), json_segment(s, r), s->region[r].system);
		first = false;
	}
	fputs("]}", to);
}

static void json_regions(FILE *to, const struct step *step)
{
	const struct switching *s = step->shown->model->switching;
	json_expressions(to, step);
	if (s->frictions > 0)
		json_frictions(to, s);
	if (s->sliders > 0)
		json_sliders(to, s);
	if (s->impacts > 0)
		json_impacts(to, step->shown->model);
	if (!s->parts) {
		json_region_list(to, s);
		return;
	}
	fputs("  \"parts\": [", to);
	for (int p = 0; p < s->parts; p++)
		json_part(to, s, p);
	fputs("],\n", to);
}

static void json_tuning(FILE *to, const struct tuning *t)
{
	fputs("  \"tunable\": [", to);
	for (int k = 0; k < t->params; k++)
		fprintf(to, "%s{\"name\": \"%s\", \"value\": %.17g}", k ? ", " : "", t->param[k].symbol->name,
			nearest_double(t->nominal[k]));
	fputs("],\n", to);
}

/* A step; beside it what anchors, peaks, blocks of rows and forced parts take */
static void json_cost(FILE *to, const struct step *step)
{
	const struct program *program = step->program;
	fprintf(to, "  \"cost\": {\"multiplications\": %d, \"additions\": %d", program->multiplications,
		program->additions);
	if (program->calls)
		fprintf(to, ", \"calls\": %d", program->calls);
	if (program->wave_multiplications)
		fprintf(to, ",\n    \"loads\": {\"every\": %d, \"multiplications\": %d, \"additions\": %d, "
			"\"numbers\": %d}",
			step->anchors ? step->anchors->steps : 1, program->wave_multiplications,
			program->wave_additions, anchor_numbers(step));
	if (peak_outputs(step->model) > 0)
		fprintf(to, ",\n    \"peaks\": {\"multiplications\": %d, \"additions\": %d}",
			program->peak_multiplications, program->peak_additions);
	if (step->forced)
		fprintf(to, ",\n    \"shown\": {\"multiplications\": %d, \"additions\": %d}",
			step->forced->multiplications, step->forced->additions);
	if (step->rows)
		fprintf(to, ",\n    \"rows\": {\"count\": %d, \"numbers\": %d}", step->rows->count,
			row_numbers(step));
	fputs("}\n", to);
}

/* States of parts that are not modelled, then what reduction left out */
static void json_dropped(FILE *to, const struct model *model)
{
	const struct spec *spec = model->spec;
	const char **name = ARRAY(const char *, (size_t)(spec->unseen + model->reduction.dropped));
	for (int i = 0; i < spec->unseen; i++)
		name[i] = spec->unseen_name[i];
	for (int i = 0; i < model->reduction.dropped; i++)
		name[spec->unseen + i] = model->reduction.dropped_name[i];
	json_names(to, "dropped", spec->unseen + model->reduction.dropped, name);
}

/* A file's name as it is in quotes */
static const char *json_text(const char *name)
{
	const char *text = "";
	for (; *name; name++)
		text = (unsigned char)*name < ' ' ? format("%s\\u%04x", text, *name)
						  : format("%s%s%c", text, *name == '\\' ? "\\" : "", *name);
	return text;
}

static void json_scene(FILE *to, const struct spec *spec)
{
	fputs("  \"scene\": [", to);
	for (int i = 0; i < spec->parts; i++)
		fprintf(to, "%s{\"name\": \"%s\", \"file\": \"%s\", \"modelled\": %s}", i ? ", " : "",
			spec->part[i]->name, json_text(spec->part[i]->file), spec->part[i]->unseen ? "false" : "true");
	fputs("],\n", to);
}

static void json_divided(FILE *to, const struct step *step)
{
	const struct expansion *x = step->divided;
	fputs("  \"expressions\": [", to);
	for (int i = 0; i < x->expressions; i++) {
		mpq_t *rising = rising_breakpoints(&x->expression[i]);
		fprintf(to, "%s\n    {\"expression\": \"%s\", \"breakpoints\": [", i ? "," : "",
			json_text(divided_text(step, i)));
		for (int k = 0; k < x->expression[i].breaks; k++)
			fprintf(to, "%s%.17g", k ? ", " : "", nearest_double(rising[k]));
		fputs("]}", to);
	}
	fputs("],\n", to);
	json_contacts(to, step);
}

/* Its order here, and what it goes by */
static void json_scheme(FILE *to, const struct step *step)
{
	const struct model *model = step->shown->model;
	static const char *const smooth[] = { "smooth", "kink", "jump" };
	fprintf(to, "  \"order\": %d,\n  \"smooth\": \"%s\",\n",
		step->expansion && !loses_order(model) ? order_of_step(step) : order_that_holds(model),
		smooth[model->smooth.kind]);
	if (step->collocation)
		fprintf(to, "  \"stages\": %d,\n"
			    "  \"iteration\": {\"multiplications\": %d, \"additions\": %d, \"calls\": %d},\n",
			step->collocation->stages, step->iteration.multiplications, step->iteration.additions,
			step->iteration.calls);
	if ((step->expansion || step->collocation) && mpq_sgn(model->truncation.tolerance) != 0)
		fprintf(to, "  \"tolerance\": %s,\n", shortest(round_rational(model->truncation.tolerance)));
	if (model->truncation.adaptive && (step->expansion || step->collocation))
		fprintf(to, "  \"substeps\": %d,\n", model->truncation.substeps);
	if (step->expansion && model->truncation.over > 1)
		fprintf(to, "  \"over\": %d,\n", model->truncation.over);
	if (step->divided)
		json_divided(to, step);
	if (step->expansion)
		json_reach(to, step);
}

void explain_json(FILE *to, const struct step *step)
{
	const struct model *model = step->shown->model;
	const char **output = ARRAY(const char *, (size_t)model->outputs);
	double *Phi = ARRAY(double, (size_t)(model->system.states * model->system.states));
	const char **input = ARRAY(const char *, (size_t)model->system.inputs);
	for (int i = 0; i < model->system.inputs; i++)
		input[i] = model->system.input[i].name;
	for (int i = 0; i < model->outputs; i++)
		output[i] = model->output[i].name;
	for (int i = 0; i < model->system.states * model->system.states; i++)
		Phi[i] = step->shown->branch->whole->Phi[i].value;
	fprintf(to,
		"{\n  \"model\": \"%s\",\n  \"scheme\": \"%s\",\n  \"form\": \"%s\",\n  \"accuracy\": \"%s\",\n  "
		"\"real\": \"%s\",\n  \"step\": %.17g,\n",
		model->name, scheme_name(model->scheme), step_form_name(step->form),
		step->model->asked.compensated ? "compensated" : "plain", target_name(), nearest_double(model->h));
	json_names(to, "states", model->system.states, model->state_name);
	json_names(to, "outputs", model->outputs, output);
	json_names(to, "inputs", model->spec->inputs, input);
	json_dropped(to, model);
	if (model->shortened)
		json_shortening(to, model);
	if (model->spec->parts)
		json_scene(to, model->spec);
	if (tunables_of(model))
		json_tuning(to, tunables_of(model));
	json_rational_matrix(to, "M", model->written->n, (const mpq_t *)model->written->system.M);
	json_rational_matrix(to, "C", model->written->n, (const mpq_t *)model->written->system.C);
	json_rational_matrix(to, "K", model->written->n, (const mpq_t *)model->written->system.K);
	json_poles(to, step);
	json_linear(to, step);
	if (!step->shown->no_phi)
		json_matrix(to, "Phi", model->system.states, model->system.states, Phi);
	json_loads(to, step);
	if (scheme_row(model->scheme)->holds_coupling)
		fprintf(to, "  \"growth_rate\": %.17g,\n", growth_rate(step));
	json_scheme(to, step);
	if (step->model->switching)
		json_regions(to, step);
	if (has_leftover(step))
		json_split(to, step);
	struct drift drift = drift_of(step);
	if (drift.known)
		fprintf(to, "  \"drift_per_step\": {\"amplitude\": %.17g, \"phase\": %.17g},\n", drift.amplitude,
			drift.phase);
	if (step->rounding.known)
		fprintf(to, "  \"rounding\": {\"steps\": %d, \"relative\": %.17g, \"state\": \"%s\"},\n",
			step->rounding.steps, step->rounding.relative, model->state_name[step->rounding.state]);
	if (step->choice)
		json_needs(to, step);
	json_cost(to, step);
	fputs("}\n", to);
}
