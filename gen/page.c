/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One page of HTML that runs a model: its C as WebAssembly, what describes it as JSON, and a script and a style that
 * are files of share/page. Nothing of the model is markup or script: JSON has its names, units and text, which the page
 * shows as text. The policy in its head lets the script and the style with these sums run, and nothing be loaded. */
#include "command.h"
#include "model/tunable/tuning.h"
#include "report/report.h"

#include <string.h>

/* ---- numbers that drawings read, as outputs behind those of the spec ---- */

static void add_drawn_output(struct spec *spec, struct node *value)
{
	struct symbol *output = NEW(struct symbol);
	*output = (struct symbol){ .kind = SYMBOL_OUTPUT, .name = format("pl_drawn%d", ++spec->page.outputs),
				   .at = value->start, .index = spec->count.outputs++, .value = value };
	add_symbol(spec, output);
}

static bool is_stop(const struct when *w)
{
	return w->restitution && (w->from || w->to);
}

/* Drawings first, then the gaps of stops */
void add_drawn_outputs(const struct options *options, struct spec *spec)
{
	struct node *node[MOST_DRAWN];
	for (int i = 0; i < spec->page.drawings && options->page; i++) {
		const int nodes = nodes_of_drawing(&spec->page.drawing[i], node);
		for (int k = 0; k < nodes; k++)
			add_drawn_output(spec, node[k]);
	}
	for (int i = 0; i < spec->whens && options->page; i++)
		if (is_stop(&spec->when[i]))
			add_drawn_output(spec, spec->when[i].gap);
}

/* ---- JSON ---- */

/* A < is written so that no text ends the element that the JSON stands in. */
static void put_string(FILE *to, const char *text)
{
	fputc('"', to);
	for (; *text; text++)
		if ((unsigned char)*text < ' ' || *text == '<' || *text == '>' || *text == '&' || *text == 127)
			fprintf(to, "\\u%04x", (unsigned)*text);
		else
			fprintf(to, "%s%c", *text == '"' || *text == '\\' ? "\\" : "", *text);
	fputc('"', to);
}

static void put_member(FILE *to, const char *name, const char *text)
{
	fprintf(to, "\"%s\":", name);
	put_string(to, text ? text : "");
}

/* Values are in SI units times `factor` of what is shown; of states the name without "state." */
static void put_variable(FILE *to, const struct fmu_variable *v, bool first)
{
	const struct unit *unit = v->shown ? v->shown : v->unit;
	const char *name = v->kind == FMU_STATE ? strchr(v->name, '.') + 1 : v->name;
	fputs(first ? "\n{" : ",\n{", to);
	put_member(to, "name", name);
	fputs(",", to);
	put_member(to, "unit", unit ? unit->text : "");
	fputs(",", to);
	put_member(to, "about", v->description);
	if (v->kind != FMU_OUTPUT)
		fprintf(to, ",\"value\":%s", shortest(v->start));
	if (v->shown)
		fprintf(to, ",\"factor\":%s", shortest(unit_factor(v->shown)));
	if (v->range)
		fprintf(to, ",\"low\":%s,\"high\":%s", shortest(round_rational(v->range->low)),
			shortest(round_rational(v->range->high)));
	fputs("}", to);
}

/* The first `most` of a kind */
static void put_variables(FILE *to, const char *list, const struct fmu_variables *v, enum fmu_kind kind, int most)
{
	int count = 0;
	fprintf(to, ",\n\"%s\":[", list);
	for (int i = 0; i < v->count && count < most; i++)
		if (v->variable[i].kind == kind)
			put_variable(to, &v->variable[i], count++ == 0);
	fputs("]", to);
}

/* ---- bodies and links ---- */

/* A body or a link: its kind, and one or two coordinates by their numbers; -1 is the ground */
static void put_element(FILE *to, int *count, const char *kind, int from, int end)
{
	fprintf(to, "%s[\"%s\",%d,%d]", (*count)++ ? "," : "", kind, from, end);
}

static int coordinate_number(const struct node *coordinate)
{
	return !coordinate ? -1 : coordinate->symbol->index + (coordinate->component ? coordinate->component - 1 : 0);
}

static void put_network(FILE *to, const struct spec *spec, int *count)
{
	static const char *const kind[] = {
		[ELEMENT_MASS] = "mass", [ELEMENT_SPRING] = "spring", [ELEMENT_DAMPER] = "damper",
		[ELEMENT_FORCE] = "force", [ELEMENT_FRICTION] = "friction"
	};
	for (int i = 0; i < spec->elements; i++) {
		const struct element *e = &spec->element[i];
		if (e->kind != ELEMENT_ENERGY)
			put_element(to, count, kind[e->kind], coordinate_number(e->from), coordinate_number(e->to));
	}
}

/* What rows of K or C couple: neighbours always, others where they are few; the ground where a row's sum is not 0 */
static void put_couplings(FILE *to, const char *kind, const struct model *model, const mpq_t *A, int *count)
{
	enum { FEW = 8 };
	RATIONAL sum = ZERO;
	for (int i = 0; i < model->n; i++) {
		mpq_set_ui(sum, 0, 1);
		for (int j = 0; j < model->n; j++) {
			mpq_srcptr there = A[i * model->n + j], back = A[j * model->n + i];
			const bool coupled = mpq_sgn(there) != 0 || mpq_sgn(back) != 0;
			mpq_add(sum, sum, there);
			if (j > i && coupled && (j == i + 1 || model->n <= FEW))
				put_element(to, count, kind, i, j);
		}
		if (mpq_sgn(sum) != 0 && (model->n <= FEW || i == 0))
			put_element(to, count, kind, i, -1);
	}
}

/* Elements as written; of equations alone a mass for each coordinate, and what K and C couple */
static void put_bodies(FILE *to, const struct step *step, struct spec *spec)
{
	const struct model *model = step->shown->model;
	int count = 0;
	fputs(",\n\"elements\":[", to);
	if (!model->reduction.truncated && model->written == model) {
		put_network(to, spec, &count);
		const bool plain = count == 0;
		for (int i = 0; i < model->n && plain; i++)
			put_element(to, &count, "mass", i, i);
		if (plain) {
			put_couplings(to, "spring", model, model->system.K, &count);
			put_couplings(to, "damper", model, model->system.C, &count);
		}
		for (int i = 0; i < spec->whens; i++)
			if (is_stop(&spec->when[i]))
				put_element(to, &count, "stop", coordinate_number(spec->when[i].from),
					    coordinate_number(spec->when[i].to));
	}
	fputs("]", to);
}

/* The number of the output that a drawing reads; -1: it is 0 */
static int drawn(const struct node *node, int *next)
{
	return node ? (*next)++ : -1;
}

static void put_drawings(FILE *to, const struct spec *spec, int next)
{
	fputs(",\n\"draw\":[", to);
	for (int i = 0; i < spec->page.drawings; i++) {
		const struct drawing *d = &spec->page.drawing[i];
		fprintf(to, "%s{\"what\":\"%s\",\"at\":[", i ? "," : "", d->what);
		for (int k = 0; k < d->points; k++) {
			const int x = drawn(d->point[k][0], &next);
			fprintf(to, "%s%d,%d", k ? "," : "", x, drawn(d->point[k][1], &next));
		}
		const int radius = drawn(d->radius, &next);
		fprintf(to, "],\"radius\":%d,\"turn\":%d}", radius, drawn(d->turn, &next));
	}
	fputs("]", to);
}

/* ---- text of 64 letters ---- */

static void put_base64(FILE *to, const unsigned char *bytes, size_t length)
{
	static const char letter[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
	for (size_t i = 0; i < length; i += 3) {
		const size_t left = length - i;
		const unsigned long three = (unsigned long)bytes[i] << 16 |
					    (left > 1 ? (unsigned long)bytes[i + 1] << 8 : 0) |
					    (left > 2 ? bytes[i + 2] : 0);
		fputc(letter[three >> 18], to);
		fputc(letter[three >> 12 & 63], to);
		fputc(left > 1 ? letter[three >> 6 & 63] : '=', to);
		fputc(left > 2 ? letter[three & 63] : '=', to);
	}
}

/* ---- the page ---- */

/* The model's C, and behind it what the page calls */
static const char *code_of_page(const struct step *step, const char *code, bool ramps)
{
	const struct model *model = step->model;
	const char *name = model->delays ? model->delays->name : model->name;
	const struct tuning *tuning = tunables_of(model);
	char *upper = format("%s", name);
	for (char *c = upper; *c; c++)
		*c = (char)(*c >= 'a' && *c <= 'z' ? *c - 'a' + 'A' : *c);
	return format("%s\n#define PAGE(name) %s_##name\n#define PAGE_TYPE %s\n#define PAGE_H %s_H\n"
		      "#define PAGE_STATES %d\n#define PAGE_INPUTS %d\n#define PAGE_OUTPUTS %d\n"
		      "#define PAGE_PARAMS %d\n#define PAGE_RAMPS %d\n#define PAGE_CROSSES %d\n\n%s",
		      code, name, name, upper, step->branch->system.states, outer_inputs(model), model->outputs,
		      tuning ? tuning->given : 0, ramps, strstr(code, format("\nuint64_t %s_crossed(", name)) != NULL,
		      runtime_text("plpage.h"));
}

/* Of each input the samples before the first step; whether one has some */
static bool put_ahead(FILE *to, const struct step *step)
{
	bool some = false;
	fputs(",\n\"ahead\":[", to);
	for (int i = 0; i < outer_inputs(step->model); i++) {
		const int ahead = samples_ahead(step->branch->system.input[i].hold);
		fprintf(to, "%s%d", i ? "," : "", ahead);
		some = some || ahead > 0;
	}
	fputs("]", to);
	return some;
}

/* Whether an input is a ramp */
static bool put_json(FILE *to, const struct step *step, const char *title)
{
	const struct fmu_variables v = variables_of(step);
	struct spec *spec = step->model->spec;
	const struct delays *delays = step->model->delays;
	const int shown = step->model->outputs - spec->page.outputs;
	fputs("{", to);
	put_member(to, "name", delays ? delays->name : step->model->name);
	fputs(",", to);
	put_member(to, "title", title);
	fputs(",", to);
	put_member(to, "plgen", PLGEN_VERSION);
	fputs(",", to);
	put_member(to, "spec", spec->source->text);
	fprintf(to, ",\"h\":%s,\"coords\":%d,\"hidden\":%d,\"constrained\":%s,\"linear\":%s,\"whole\":%s",
		shortest(round_rational(delays ? delays->h : step->model->h)), step->shown->model->n,
		spec->page.outputs, spec->count.multipliers > 0 ? "true" : "false",
		is_nonlinear(step) ? "false" : "true",
		delays ? "false" : "true");
	put_variables(to, "states", &v, FMU_STATE, v.count);
	put_variables(to, "outputs", &v, FMU_OUTPUT, shown);
	put_variables(to, "inputs", &v, FMU_INPUT, v.count);
	put_variables(to, "params", &v, FMU_PARAM, v.count);
	put_bodies(to, step, spec);
	put_drawings(to, spec, shown);
	const bool ramps = put_ahead(to, step);
	fputs("}\n", to);
	return ramps;
}

static void put_policy(FILE *to)
{
	fputs("<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src ", to);
	fprintf(to, "'sha256-%s' 'sha256-%s' 'wasm-unsafe-eval'; style-src 'sha256-%s'; base-uri 'none'; form-action "
		    "'none'\"/>\n", runtime_text("load.sum"), runtime_text("script.sum"), runtime_text("style.sum"));
}

static bool has_outputs(const struct spec *spec)
{
	for (const struct symbol *s = spec->first; s; s = s->next)
		if (s->kind == SYMBOL_OUTPUT && s->number > 0)
			return true;
	return false;
}

static bool print_live_page(FILE *to, const struct step *step, const char *code, const char *title)
{
	size_t length;
	title = title ? title : step->model->delays ? step->model->delays->name : step->model->name;
	if (!has_outputs(step->model->spec))
		say_note(step->model->spec->name_at, "the model has no outputs: the page shows its states");
	fputs("<!DOCTYPE html>\n<!-- SPDX-License-Identifier: MIT-0, made by plgen " PLGEN_VERSION " -->\n"
	      "<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n", to);
	put_policy(to);
	fprintf(to, "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\"/>\n<title>%s</title>\n"
		    "<style>%s</style>\n</head>\n<body>\n<noscript>This page runs a model by a script, and scripts are "
		    "turned off.</noscript>\n<script type=\"application/json\" id=\"model\">\n", html_text(title),
		runtime_text("page.css"));
	const bool ramps = put_json(to, step, title);
	char *wasm = wasm_of(code_of_page(step, code, ramps), &length);
	if (!wasm)
		return false;
	fputs("</script>\n<script type=\"text/plain\" id=\"wasm\">", to);
	put_base64(to, (unsigned char *)wasm, length);
	fprintf(to, "</script>\n<script type=\"text/plain\" id=\"script\">%s</script>\n<script>%s</script>\n</body>\n"
		    "</html>\n", runtime_text("script.gz"), runtime_text("load.js"));
	return true;
}

enum { LARGE_PAGE = 110000 };   /* bytes: what nearly all models stay below */

bool write_page(const struct options *options, const struct step *step, struct file *code)
{
	if (!options->page)
		return true;
	struct file *f = options->page_in_report ? file_inside() : file_new(options->page);
	const bool made = print_live_page(f->to, step, code->text, options->look.title);
	file_close(f);
	if (made && f->length > LARGE_PAGE)
		say_note(step->model->spec->name_at, "the page has %zu kB, since the step has large tables",
			 f->length / 1000);
	file_drop(code);
	if (!options->page_in_report)
		return made;
	struct file *report = file_new(options->page);
	if (made)
		print_page(report->to, step, options->banner, &options->look, f->text);
	file_close(report);
	file_drop(f);
	return made;
}
