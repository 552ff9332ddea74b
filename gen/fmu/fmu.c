/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The files of an FMU and their order. */
#include "fmu/fmu.h"
#include "model/tunable/tuning.h"
#include "step/cost.h"
#include "step/step.h"

#include <string.h>

const char *fmu_header_name(const struct model *model)
{
	return format("%s_pl.h", outer_name(model));
}

/* An input that is read further ahead than to the end of a step: the importer has no such samples. */
static bool can_have_inputs(const struct model *model)
{
	bool can = true;
	for (const struct symbol *s = model->spec->first; s; s = s->next)
		if (s->kind == SYMBOL_INPUT && s->hold > 1) {
			say_error(s->at, "'hold first' would do: an importer knows the sample at the end of a step",
				  "an FMU cannot have input '%s', which is held over samples further ahead", s->name);
			can = false;
		}
	return can;
}

/* FNV-1a of 64 bits */
static uint64_t hash_of(uint64_t hash, const char *text)
{
	for (; *text; text++)
		hash = (hash ^ (unsigned char)*text) * 0x100000001b3;
	return hash;
}

/* The numbers of fmu_constant, each with a comma behind it */
static const char *constants_text(const struct fmu_variables *v)
{
	const char *text = "";
	for (int i = v->count - v->constants; i < v->count; i++)
		text = format("%s%s, ", text, shortest(v->variable[i].start));
	return text;
}

/* What the importer must have read to make an instance: a number of all that is compiled, so a description of another
 * version of the model does not fit. */
static uint64_t mark_of(const struct fmu *f, const char *code, const char *header)
{
	uint64_t hash = hash_of(0xcbf29ce484222325, f->version == 3 ? "3" : "2");
	const char *text[] = { code, header, runtime_text("plfmu.h"), constants_text(&f->variables) };
	for (size_t i = 0; i < sizeof text / sizeof *text; i++)
		hash = hash_of(hash, text[i]);
	return hash;
}

static int column_by(const struct derivatives *d, const struct symbol *symbol)
{
	for (int i = 0; i < d->columns; i++)
		if (d->column[i].symbol == symbol)
			return i;
	return -1;
}

/* Of each input, or tunable param: its column; *all: no other than -1 is missing */
static const char *columns_text(const struct step *step, bool params, bool *all)
{
	const struct model *model = step->model;
	const struct tuning *tuning = tunables_of(model);
	const char *text = "";
	for (const struct symbol *s = model->spec->first; s && !params; s = s->next)
		if (s->kind == SYMBOL_INPUT && !s->delayed) {
			const int column = column_by(step->derivatives, s);
			text = format("%s%d, ", text, column);
			*all = *all && column >= 0;
		}
	for (int k = 0; params && tuning && k < tuning->given; k++) {
		const int column = column_by(step->derivatives, tuning->param[k].symbol);
		text = format("%s%d, ", text, column);
		*all = *all && column >= 0;
	}
	return text;
}

static const char *derivatives_text(const struct fmu *f, const struct step *step)
{
	bool all = true;
	const struct derivatives *d = step->derivatives;
	if (!d)
		return "";
	return format("#define FMU_DERIVATIVES %s_derivatives\n"
		      "#define FMU_SEEDED %d\n"
		      "#define FMU_ZERO(ds) %s_set_d(ds, NULL)\n"
		      "typedef %s_d fmu_derived;\n"
		      "enum { FMU_COLUMNS = %d };\n"
		      "static const int fmu_column_of_input[] = {%s-1};\n"
		      "static const int fmu_column_of_param[] = {%s-1};\n", f->name, d->seeded, f->name, f->name,
		      d->columns, columns_text(step, false, &all), columns_text(step, true, &all));
}

static bool derives_by_all(const struct step *step)
{
	bool all = step->derivatives != NULL;
	if (!all)
		return false;
	columns_text(step, false, &all);
	columns_text(step, true, &all);
	return all;
}

/* fmu_model.h, which plfmu.h asks for */
static const char *model_header(const struct fmu *f, const struct step *step, uint64_t mark)
{
	const struct linear *system = &step->branch->system;
	const char *name = f->name;
	return format("/* SPDX-License-Identifier: MIT-0 */\n"
		      "/* The model that plfmu.h makes an FMU of, its sizes and constants: made by plgen " PLGEN_VERSION
		      "; do not edit. */\n"
		      "#ifndef FMU_MODEL_H\n"
		      "#define FMU_MODEL_H\n\n"
		      "#define FMI%d_FUNCTION_PREFIX %s_\n\n"
		      "#include \"%s\"\n\n"
		      "typedef struct %s fmu_state;\n"
		      "typedef %s fmu_real;\n"
		      "typedef pl_model%s fmu_model;\n"
		      "#define FMU_MODEL %s_model\n"
		      "#define FMU_H %s\n"
		      "#define FMU_TOKEN \"%s\"\n"
		      "#define FMU_MARK 0x%016llx\n"
		      "%s"
		      "enum { FMU_STATES = %d, FMU_INPUTS = %d, FMU_OUTPUTS = %d, FMU_PARAMS = %d,\n"
		      "       FMU_CONSTANTS = %d };\n"
		      "static const double fmu_constant[] = {%s0.0};\n%s\n"
		      "#endif\n",
		      f->version, name, fmu_header_name(step->model), name, f->single ? "float" : "double",
		      f->single ? "f" : "", name, shortest(f->h), f->token, (unsigned long long)mark,
		      f->crosses ? format("#define FMU_CROSSED(s) %s_crossed(s)\n", name) : "", system->states,
		      outer_inputs(step->model), step->model->outputs,
		      tunables_of(step->model) ? tunables_of(step->model)->given : 0, f->variables.constants,
		      constants_text(&f->variables), derivatives_text(f, step));
}

static void add_text(struct fmu *f, const char *name, const char *text)
{
	archive_add(&f->archive, name, text, strlen(text));
}

struct fmu *fmu_new(const struct step *step, int version, const char *code, const char *header)
{
	const struct model *model = step->model;
	struct fmu *f = NEW(struct fmu);
	if (!can_have_inputs(model))
		return NULL;
	f->version = version;
	f->single = model->request.single;
	f->name = outer_name(model);
	f->title = model->spec->name;
	f->worst = unbounded_text(step) ? NULL : worst_text(step);
	f->h = nearest_double(outer_step(model));
	f->math = strstr(code, "\n#include <math.h>\n") != NULL;
	f->crosses = strstr(header, format("\nuint64_t %s_crossed(", f->name)) != NULL;
	f->derives = derives_by_all(step);
	f->variables = variables_of(step);
	const uint64_t mark = mark_of(f, code, header);
	const uint64_t more = hash_of(mark, "token");
	f->token = format("{%08x-%04x-%04x-%04x-%04x%08x}", (unsigned)(mark >> 32), (unsigned)(mark >> 16 & 0xffff),
			  (unsigned)(mark & 0xffff), (unsigned)(more >> 48), (unsigned)(more >> 32 & 0xffff),
			  (unsigned)(more & 0xffffffff));
	const char *face = version == 3 ? "fmi3.h" : "fmi2.h";
	f->source[0] = version == 3 ? "fmi3.c" : "fmi2.c";
	f->source[1] = format("%s_pl.c", f->name);
	add_text(f, "modelDescription.xml", model_description(f));
	add_text(f, "documentation/licenses/license.txt", runtime_text("LICENSE"));
	if (version == 3)
		add_text(f, "sources/buildDescription.xml", build_description(f));
	add_text(f, "sources/fmu_model.h", model_header(f, step, mark));
	add_text(f, format("sources/%s", fmu_header_name(model)), header);
	add_text(f, format("sources/%s", f->source[1]), code);
	add_text(f, format("sources/%s", f->source[0]), runtime_text(f->source[0]));
	add_text(f, format("sources/%s", face), runtime_text(face));
	add_text(f, "sources/fmi.h", runtime_text("fmi.h"));
	add_text(f, "sources/plfmu.h", runtime_text("plfmu.h"));
	return f;
}
