/* SPDX-License-Identifier: GPL-3.0-or-later */
/* plgen: the pipeline as one column of calls. Text is written to memory and published only when all went well. */
#include "command.h"
#include "emit/emit.h"
#include "model/checks.h"
#include "model/tunable/elsewhere.h"
#include "model/linear/modal_truncation.h"
#include "model/tunable/tuning.h"
#include "report/campbell.h"
#include "report/report.h"
#include "run/run.h"
#include "step/cost.h"
#include "step/linear/images.h"

#include <stdlib.h>
#include <string.h>

struct work {
	struct options options;
	struct spec *spec;
	const struct spec *given;       /* of which `spec` has the linear equations; NULL: it is the one given */
	struct model *model;
	struct model *stepped;          /* the one that is stepped: it, or over other coordinates */
	struct step *step;              /* NULL: the closed form is printed, and nothing is stepped */
	struct file *text, *header;     /* what is printed; the header beside C, NULL: none */
};

/* ---- from a text to a step; false: it was said why ---- */

static bool make_model(struct work *w)
{
	struct request *request = &w->options.request;
	request->find_factors = find_factors;
	w->model = model_build(w->spec, request);
	if (w->model)
		w->model = model_reduce(w->model);
	if (w->model && !request->solution)
		w->model = find_tuning(w->model, request);
	if (!w->model)
		return false;
	w->spec = w->model->spec;
	w->model = model_truncate(w->model);
	return w->model;
}

static bool make_step(struct work *w)
{
	if (w->options.request.solution)
		return true;
	w->stepped = stepped_model(w->model, w->spec, &w->options.request);
	w->step = w->stepped ? step_build(w->stepped) : NULL;
	if (w->step)
		w->options.request.form = w->step->model->request.form;
	return w->step;
}

static void try_all(void *context)
{
	struct work *w = context;
	if (!make_model(w) || !make_step(w))
		abandon();
}

/* With a need a step may be chosen; until then any will do. */
static void leave_step_open(struct work *w)
{
	struct request *request = &w->options.request;
	if (w->spec->required.needs == 0 || w->spec->request.step || request->step || !w->spec->required.need[0].until)
		return;
	const struct node *until = w->spec->required.need[0].until;
	request->step = format("(%s)/1000", text_between(until->start, until->end));
	request->step_open = true;
}

/* The spec; of linear equations what they were made of has the units. */
static struct spec *parsed(const struct work *w, const struct source *source)
{
	struct spec *spec = parse_spec(source);
	if (w->given)
		adopt_units(spec, w->given);
	add_drawn_outputs(&w->options, spec);
	return spec;
}

/* Other values of params are found by reading the spec again, and its list of --tunable with it. */
static const struct source *with_tunables(const struct work *w, const struct source *source)
{
	struct source *more = NEW(struct source);
	*more = *source;
	more->tunables = w->options.tunable ? source_argument(w->options.tunable) : NULL;
	return more;
}

/* Where no scheme is asked for the best one may not have a step of this model: then another is taken, and a note says
 * why. What stands in the way of any is said by the last. */
static bool make_of(struct work *w, const struct source *source)
{
	struct request *request = &w->options.request;
	w->spec = parsed(w, source);
	if (w->options.tunable && !diagnostics_errors())
		refuse_what_stays(w->spec);
	leave_step_open(w);
	if (!diagnostics_errors() && !request->scheme && !w->spec->request.scheme && !request->solution) {
		request->passed_over = refusal_of(try_all, w);
		if (!request->passed_over)
			return true;
		w->spec = parsed(w, source);
	}
	return make_model(w) && make_step(w);
}

/* What a linear model has; of a nonlinear one its linear equations at a point are asked, by default at rest. */
static const char *place_of_views(const struct options *o)
{
	const bool views = o->print == PRINT_RESPONSE || (o->print == PRINT_PLOT && !strstr(o->value, "response"));
	return o->at ? o->at : views && !o->amplitude ? "rest" : NULL;
}

/* Values of params from the file and the command line; false: it was said why not */
static bool define(struct work *w)
{
	struct definitions *all = &w->options.request.definitions;
	const bool read = !w->options.params || definitions_read(w->options.params, all);
	for (int i = 0; read && i < w->options.definitions; i++)
		definitions_add(w->options.definition[i], all);
	return read;
}

static void make_motion(void *context)
{
	struct work *w = context;
	if (!make_of(w, w->spec->source))
		abandon();
}

/* t=END and the states that the model's own step comes to then; NULL: it was said why it does not */
static const char *place_on_motion(struct work *w, const struct model *model, const char **by)
{
	struct work moving = *w;
	const char *end = exact_text(model->equations.motion_end), *place = format("t=%s", end);
	const int states = model->system.states;
	SCRATCH double *y = ARRAY(double, states + 1);
	moving.options.request = request_of_motion(&w->options.request);
	const long steps = divide_motion(&moving.options.request, model->h,
					 model->equations.motion_end);
	target_double();
	const char *why = unheard_refusal_of(make_motion, &moving);
	why = why ? why : motion_to(w->spec->name_at, moving.step, steps, y);
	if (w->options.request.single)
		target_float();
	if (why) {
		say_error(w->spec->name_at, "--at x=0.1 linearises at given values", "the motion to t = %s: %s", end,
			  why);
		return NULL;
	}
	for (int i = 0; i < states; i++)
		place = format("%s,%s=%s", place, model->names.state[i], shortest(y[i]));
	*by = format("scheme %s", scheme_name(moving.step->model->scheme));
	return place;
}

/* With its linear equations, where it has others and a place is asked for */
static struct model *model_at_place(struct work *w, const struct source *source, const struct request *equations)
{
	w->spec = parse_spec(source);
	leave_step_open(w);
	struct request request = *equations;
	request.step = w->options.request.step;
	return diagnostics_errors() ? NULL : model_build(w->spec, &request);
}

/* The spec, or that of its linear equations; NULL: it was said why not */
static const struct source *source_of(struct work *w)
{
	struct request *request = &w->options.request;
	const struct source *source = source_read(w->options.spec, (struct place){ 0 });
	if (!source || !define(w))
		return NULL;
	source = with_tunables(w, source);
	request->linear.where = place_of_views(&w->options);
	if (!request->linear.where)
		return source;
	struct request equations = *request;    /* no scheme, closed form or modes of the nonlinear ones */
	request->linear.where = equations.scheme = equations.tolerance = equations.modes = NULL;
	equations.solution = false;
	struct model *model = model_at_place(w, source, &equations);
	if (model && model->equations.motion_end) {
		equations.linear.where = place_on_motion(w, model, &equations.linear.moved_by);
		model = equations.linear.where ? model_at_place(w, source, &equations) : NULL;
	}
	if (!model)
		return diagnostics_errors() ? NULL : source;
	if (!model->equations.linearised && w->options.at)
		stand_aside(w->spec->name_at, "--at", "the model is linear");
	if (!model->equations.linearised)
		return source;
	request->definitions.count = 0;
	if (w->options.print > PRINT_HEADER)
		request->sensitivity = NULL;    /* by params that are none of the linear equations' */
	request->linear.found = model->equations.point;
	w->given = w->spec;
	return source_text(format("%s, linearised", source->name), model->equations.linearised);
}

static bool make(struct work *w)
{
	const struct source *source = source_of(w);
	bool made = source && make_of(w, source);
	if (made && w->given)                   /* what the linear equations were made of was read all the same */
		w->spec->data = w->given->data;
	return made;
}

/* ---- where the spec says how exact it has to be ---- */

/* Of inputs a step is the time between samples. */
static bool lacks_step(const struct work *w)
{
	if (w->stepped->system.inputs == 0)
		return false;
	say_error(w->spec->end, "the step is the time between samples of inputs", "missing step");
	return true;
}

/* The same model with another step */
static bool make_again(struct work *w, const char *step)
{
	w->options.request.step = step;
	w->spec = parse_spec(w->spec->source);
	const char *refused = unheard_refusal_of(try_all, w);
	if (refused)
		say_error(w->spec->end, "another step can be written: step 0.01", "with a step of %s s: %s", step,
			  refused);
	return !refused;
}

/* Of a linear model without a step the longest is tried first; it may show what is kept too seldom */
static bool choose_sampling(struct work *w)
{
	struct request *request = &w->options.request;
	const struct request given = *request;
	if (!find_requirements(w->stepped))
		return false;
	for (const char *step = first_step(w->stepped); step; step = shorter_step(w->step)) {
		*request = given;
		if (!make_again(w, step))
			return false;
		w->step = choose_step(w->model, w->stepped, request);
		if (!w->step)
			return false;
	}
	return true;
}

static bool choose_of_needs(struct work *w)
{
	const struct budget *budget = &w->spec->required.budget;
	if (!w->step || (w->spec->required.needs == 0 && (!budget->instructions || budget->worst)))
		return true;
	if (w->options.request.step_open && lacks_step(w))
		return false;
	if (w->options.request.step_open && !is_measured(w->stepped))
		return choose_sampling(w);
	w->step = choose_step(w->model, w->stepped, &w->options.request);
	return w->step;
}

static void check_budget(void *step)
{
	check_worst(step);
}

static bool choose(struct work *w)
{
	return choose_of_needs(w) && (!w->step || statement_guard(check_budget, w->step));
}

/* Of what is printed the C and its header have derivatives. */
static bool derive(struct work *w)
{
	if (w->options.page && w->spec->sensitivities > 0)
		say_note(w->spec->sensitivity[0].at, "a page has the model without its derivatives");
	return w->options.print > PRINT_HEADER || w->options.page || find_derivatives(w->step);
}

/* ---- from a step to texts ---- */

static void print_closed_form(FILE *to, const struct work *w)
{
	RATIONAL end = ZERO;
	argument_value(w->model, w->options.solution, end);
	print_solution(to, w->model, resolvent_of(&w->model->system), end);
}

static const char *header_name(const struct work *w)
{
	return w->options.fmu.path ? fmu_header_name(w->model) : base_name(w->options.header);
}

/* What explains a model says what a step takes on a board. */
static void measure_board(struct work *w)
{
	const enum print print = w->options.print;
	if (print != PRINT_EXPLAIN && print != PRINT_JSON && print != PRINT_REPORT && !w->options.page_in_report)
		return;
	struct board_cost *cost = NEW(struct board_cost);
	*cost = board_cost_of(w->spec->name_at, w->step);
	w->step->board = cost;
}

static void print_main_text(void *context)
{
	const struct work *w = context;
	const struct options *options = &w->options;
	FILE *to = w->text->to;
	switch (options->print) {
	case PRINT_C:        emit_code(to, w->step, options->banner, header_name(w), options->rhs); break;
	case PRINT_HEADER:   emit_header(to, w->step, options->banner, options->rhs); break;
	case PRINT_KERNEL:   emit_device(to, w->step, options->banner, options->target); break;
	case PRINT_EXPLAIN:  explain_text(to, w->step); break;
	case PRINT_JSON:     explain_json(to, w->step); break;
	case PRINT_PROGRAM:  explain_program(to, w->step); break;
	case PRINT_SOLUTION: print_closed_form(to, w); break;
	case PRINT_RESPONSE: print_response(to, w->step, options->value, options->amplitude); break;
	case PRINT_PLOT:
		print_picture(to, w->step, options->value, options->amplitude, &options->look,
			      picture_of_file(options->output));
		break;
	case PRINT_REPORT:   print_page(to, w->step, options->banner, &options->look, NULL); break;
	}
}

/* The rows of a closed form are where the C would step, also where a need chooses how far that is. */
static void choose_for_rows(void *context)
{
	struct work *w = context;
	if (!make(w) || !choose(w))
		abandon();
}

static bool find_rows(struct work *w)
{
	struct work code = *w;
	struct request *request = &w->options.request;
	if (!request->solution || !request->step_open)
		return true;
	code.options.request.solution = request->step_open = false;
	code.options.request.step = NULL;
	if (request->single)
		target_float();
	const char *refused = unheard_refusal_of(choose_for_rows, &code);
	target_double();
	if (refused) {
		say_error(w->spec->end, "a step can be written: step 0.01", "the needs choose no step: %s", refused);
		return false;
	}
	request->step = exact_text(code.step->model->h);
	return make(w);
}

static bool print_text(struct work *w)
{
	measure_board(w);
	if (w->options.print == PRINT_C && !find_replayed(w->step))
		return false;
	w->text = w->options.fmu.path || w->options.page ? file_inside() : file_new(w->options.output);
	bool printed = statement_guard(print_main_text, w);
	file_close(w->text);
	if (!printed)
		free(w->text->text);
	return printed;
}

static void print_header(struct work *w)
{
	if (!w->options.header && !w->options.fmu.path)
		return;
	w->header = w->options.fmu.path ? file_inside() : file_new(w->options.header);
	emit_header(w->header->to, w->step, w->options.banner, w->options.rhs);
	file_close(w->header);
}

/* A kernel that takes whole steps has the model's header */
static bool has_whole_step(const struct work *w)
{
	return w->options.target && strstr(w->text->text, "_DECLARED\n");
}

/* The runtime's algorithms are in the file where all of the runtime is, or where they use the model's name. */
static void rewrite(struct work *w, struct file *f)
{
	const char *name = w->model->delays ? w->model->delays->name : w->model->name;
	if (w->options.bundle || w->options.fmu.path || w->options.target || algorithms_use(f->text, name))
		file_rewrite(f, name, print_included);
	if (w->options.request.own_math || (has_whole_step(w) && !w->options.request.single))
		file_rewrite(f, name, print_own_functions);
	if (w->options.request.single)
		file_rewrite(f, name, print_single);
	file_rewrite(f, name, print_apart);
}

static void rewrite_code(struct work *w)
{
	if (w->options.print > PRINT_KERNEL)
		return;
	const struct derivatives *d = w->step->derivatives;
	const bool varied = d && d->varied, two_words = w->options.request.compensated && !(varied && d->regions);
	rewrite(w, w->text);
	if (w->header)
		rewrite(w, w->header);
	if (w->options.bundle || w->options.fmu.path || has_whole_step(w))
		bundle(w->text, w->header, w->options.fmu.path ? runtime_text("plfmu.h") : NULL,
		       w->options.request.single,
		       varied ? two_words ? "_compensated_d" : "_d" : two_words ? "_compensated" : NULL);
	if (has_whole_step(w))
		file_rewrite(w->text, w->model->delays ? w->model->delays->name : w->model->name,
			     *w->options.target == 'o' && w->options.target[4] == 'c' ? print_opencl
			     : *w->options.target == 'o' ? print_openmp : print_cuda);
	if (w->options.print == PRINT_HEADER)
		mark_pair(NULL, w->text);
	else if (w->header)
		mark_pair(w->text, w->header);
}

/* ---- both and what they need in one file ---- */

static bool print_fmu(const struct work *w)
{
	const struct options *options = &w->options;
	if (!options->fmu.path)
		return true;
	struct fmu *fmu = fmu_new(w->step, options->fmu.version ? options->fmu.version : 3, w->text->text,
				  w->header->text);
	bool made = fmu && (!options->fmu.binary || add_binary(fmu, options->fmu.headers));
	if (made) {
		struct file *f = file_new(options->fmu.path);
		archive_write(f->to, &fmu->archive);
		file_close(f);
	}
	file_drop(w->text);
	file_drop(w->header);
	return made;
}

static void print_names(const struct work *w)
{
	if (!w->options.a2l)
		return;
	struct file *f = file_new(w->options.a2l);
	print_a2l(f->to, w->step);
	file_close(f);
}

static bool publish_all(const struct work *w)
{
	print_depfile(&w->options, w->spec, w->model);
	if (!spares(w->spec->data.files, w->spec->data.file))
		return false;
	publish();
	return true;
}

/* ---- over a param ---- */

struct many { const struct work *first; struct work now; double used, took; }; /* of memory, by the last one */

/* All are of the same text; of later ones what it warns of was said of the first. */
static void make_one(void *context)
{
	struct many *m = context;
	const struct source *source = source_of(&m->now);
	m->now.spec = source ? parsed(&m->now, source) : NULL;
	if (!source || diagnostics_errors() || !make_model(&m->now))
		abandon();
	if (m->now.model->nonlinear.terms > 0)
		error(m->now.spec->name_at, NULL, "the equations are not linear");
}

static const struct model *model_with(void *context, const char *definition)
{
	struct many *m = context;
	const bool again = m->now.model;
	m->now = *m->first;
	struct options *o = &m->now.options;
	const char **all = ARRAY(const char *, o->definitions + 1);
	for (int i = 0; i < o->definitions; i++)
		all[i] = o->definition[i];
	all[o->definitions++] = definition;
	o->definition = all;
	const char *refused = again ? unheard_refusal_of(make_one, m) : NULL;
	if (refused)
		error((struct place){ source_argument(definition), 0 }, NULL, "%s", refused);
	if (!again)
		make_one(m);
	return m->now.model;
}

static void find_and_print_campbell(void *context)
{
	struct work *w = context;
	const struct options *o = &w->options;
	struct many many = { .first = w };
	struct campbell c = { .build = model_with, .context = &many };
	find_campbell(&c, o->campbell.sweep, o->campbell.orders, o->campbell.whirl);
	w->spec = many.now.given ? (struct spec *)many.now.given : many.now.spec;
	w->model = many.now.model;
	print_campbell(w->text->to, &c, &o->look, picture_of_file(o->output));
}

static const struct model *model_at(void *context, const char *place, const char **why)
{
	struct many *m = context;
	const bool again = m->now.model;
	m->now = *m->first;
	m->now.options.at = place;
	const double used = memory_used();
	m->took = again && used - m->used > m->took ? used - m->used : m->took;
	m->used = used;
	*why = used + 1.25 * m->took > 1 ? "memory is near its limit; --at has them" : unheard_refusal_of(make_one, m);
	return m->now.model;
}

static void find_and_print_equilibria(void *context)
{
	struct work *w = context, searched = *w;
	struct request *request = &searched.options.request;
	struct many many = { .first = w };
	const struct source *source = source_read(w->options.spec, (struct place){ 0 });
	if (!source || !define(&searched))
		abandon();
	request->linear.where = EQUILIBRIA;
	request->scheme = request->tolerance = request->modes = NULL;
	w->model = model_at_place(&searched, source, request);
	if (!w->model)
		abandon();
	w->spec = searched.spec;
	print_equilibria(w->text->to, w->model, w->options.print == PRINT_JSON, model_at, &many);
}

/* What looks at many models */
static bool print_many(struct work *w, void (*print)(void *))
{
	w->text = file_new(w->options.output);
	const bool printed = statement_guard(print, w);
	file_close(w->text);
	if (!printed || (w->options.strict && diagnostics_harden()))
		return false;
	return publish_all(w);
}

/* ---- the whole ---- */

/* A describing function is of the model alone, without the samples that delays keep. */
static bool goes_with_delays(const struct work *w)
{
	const struct facts facts = facts_of_model(w->model);
	const char *against = objection_to(CAN_AMPLITUDE, &facts, w->model).why;
	if (!w->options.amplitude || !against || !w->model->delays)
		return true;
	say_error(w->model->delays->delay->symbol->at, NULL, "%s%s", words_before(CAN_AMPLITUDE), against);
	return false;
}

static bool compile(struct work *w)
{
	if (w->options.request.single && !w->options.request.solution)
		target_float();
	if (w->options.campbell.wanted || w->options.equilibrium)
		return print_many(w, w->options.campbell.wanted ? find_and_print_campbell : find_and_print_equilibria);
	if (!make(w) || !find_rows(w) || !goes_with_delays(w) || !choose(w) || !derive(w) ||
	    (w->options.strict && diagnostics_harden()) || !print_text(w))
		return false;
	print_header(w);
	rewrite_code(w);
	if (!print_fmu(w) || !write_page(&w->options, w->step, w->text))
		return false;
	print_names(w);
	return publish_all(w);
}

struct command { int argc; char **argv; int status; };

static void *run(void *context)
{
	struct command *command = context;
	struct work work = { 0 };
	memory_open();
	memory_on_limit(give_up);
	publish_open();
	read_options(command->argc, command->argv, &work.options);
	command->status = compile(&work) ? 0 : 1;
	diagnostics_print(stderr);
	return NULL;
}

int plgen(int argc, char **argv)
{
	struct command command = { argc, argv, 1 };
	if (!run_deep(run, &command))
		fputs("plgen: error: out of memory\n", stderr);
	return command.status;
}
