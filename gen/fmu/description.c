/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What describes an FMU (FMI 2.0.5, section 2.2; FMI 3.0.2, sections 2.4 and 2.5), valid against the standard's
 * schemas. */
#include "fmu/fmu.h"
#include "model/request.h"

#include <stdlib.h>
#include <string.h>

/* As the value of an XML attribute */
static const char *attribute_text(const char *text)
{
	const char *made = "";
	for (; *text; text++)
		switch (*text) {
		case '&':  made = format("%s&amp;", made); break;
		case '<':  made = format("%s&lt;", made); break;
		case '>':  made = format("%s&gt;", made); break;
		case '"':  made = format("%s&quot;", made); break;
		case '\'': made = format("%s&apos;", made); break;
		default:   made = format("%s%c", made, *text);
		}
	return made;
}

/* ---- text that grows in memory ---- */

struct text {
	FILE *to;
	char *bytes;
	size_t length;
};

static void open_text(struct text *t)
{
	t->to = need_memory(open_memstream(&t->bytes, &t->length));
	fputs("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n", t->to);
}

static const char *close_text(struct text *t)
{
	bool whole = !ferror(t->to);
	const char *kept = fclose(t->to) == 0 && whole ? format("%s", t->bytes) : NULL;
	free(t->bytes);
	return need_memory((char *)kept);
}

/* ---- what both versions say of a variable ---- */

struct wording {
	const char *causality, *variability, *initial;
};

static struct wording wording_of(const struct fmu_variable *v)
{
	static const struct wording wording[] = {
		[FMU_TIME] = { "independent", "continuous", NULL },
		[FMU_INPUT] = { "input", "continuous", NULL },
		[FMU_OUTPUT] = { "output", "continuous", NULL },
		[FMU_PARAM] = { "parameter", "tunable", "exact" },
		[FMU_STATE] = { "local", "continuous", "exact" },
		[FMU_CONSTANT] = { "local", "constant", "exact" }
	};
	return wording[v->kind];
}

static void print_variable(FILE *to, const struct fmu *f, int reference)
{
	const struct fmu_variable *v = &f->variables.variable[reference];
	const struct wording w = wording_of(v);
	const bool starts = v->kind != FMU_TIME && v->kind != FMU_OUTPUT;
	const char *initial = w.initial ? format(" initial=\"%s\"", w.initial) : "";
	const char *start = starts ? format(" start=\"%s\"", shortest(v->start)) : "";
	const char *range = v->range ? format(" min=\"%s\" max=\"%s\"", shortest(round_rational(v->range->low)),
					      shortest(round_rational(v->range->high))) : "";
	const char *unit = v->unit ? format(" unit=\"%s\"", attribute_text(v->unit->text)) : "";
	if (v->shown)
		unit = format("%s displayUnit=\"%s\"", unit, attribute_text(v->shown->text));
	const char *description = v->description ? format(" description=\"%s\"", attribute_text(v->description)) : "";
	const char *common = format("name=\"%s\" valueReference=\"%d\" causality=\"%s\" variability=\"%s\"%s%s",
				    attribute_text(v->name), reference, w.causality, w.variability, initial,
				    description);
	if (f->version == 3)
		fprintf(to, "    <Float64 %s%s%s%s/>\n", common, unit, range, start);
	else
		fprintf(to, "    <ScalarVariable %s>\n      <Real%s%s%s/>\n    </ScalarVariable>\n", common, unit,
			range, start);
}

static void print_variables(FILE *to, const struct fmu *f)
{
	fputs("  <ModelVariables>\n", to);
	for (int i = 0; i < f->variables.count; i++)
		print_variable(to, f, i);
	fputs("  </ModelVariables>\n", to);
}

/* A line for each output: of FMI 3.0 by its value reference, of FMI 2.0 by its place, from 1 */
static void print_outputs(FILE *to, const struct fmu *f, const char *element)
{
	for (int i = 0; i < f->variables.count; i++)
		if (f->variables.variable[i].kind == FMU_OUTPUT)
			fprintf(to, "      <%s=\"%d\"/>\n", element, f->version == 3 ? i : i + 1);
}

static bool has_outputs(const struct fmu *f)
{
	for (int i = 0; i < f->variables.count; i++)
		if (f->variables.variable[i].kind == FMU_OUTPUT)
			return true;
	return false;
}

/* The inputs by which outputs have derivatives */
static const char *inputs_of_outputs(const struct fmu *f)
{
	const char *list = "";
	for (int i = 0; i < f->variables.count && f->derives; i++)
		if (f->variables.variable[i].kind == FMU_INPUT)
			list = format("%s%s%d", list, *list ? " " : "", f->version == 3 ? i : i + 1);
	return list;
}

/* What is set acts in the steps that follow, so between steps outputs depend on no input, but for derivatives by those
 * that acted last; at the start on anything. */
static void print_structure(FILE *to, const struct fmu *f)
{
	const char *inputs = inputs_of_outputs(f);
	fputs("  <ModelStructure>\n", to);
	if (f->version == 3) {
		print_outputs(to, f, format("Output dependencies=\"%s\" valueReference", inputs));
		print_outputs(to, f, "InitialUnknown valueReference");
	} else if (has_outputs(f)) {
		fputs("    <Outputs>\n", to);
		print_outputs(to, f, format("Unknown dependencies=\"%s\" index", inputs));
		fputs("    </Outputs>\n    <InitialUnknowns>\n", to);
		print_outputs(to, f, "Unknown index");
		fputs("    </InitialUnknowns>\n", to);
	}
	fputs("  </ModelStructure>\n", to);
}

/* ---- units: by the base units of SI, and others in which a value may be shown ---- */

/* Exponents that are no whole numbers have no place in a description: then the name alone stands there. */
static void print_base_unit(FILE *to, const struct unit *unit)
{
	static const char *const name[] = { "m", "kg", "s", "A", "K", "mol", "cd" };
	const char *text = "";
	for (int i = 0; i < UNIT_BASES; i++) {
		if (mpz_cmp_ui(mpq_denref(unit->base[i]), 1) != 0)
			return;
		if (mpq_sgn(unit->base[i]) != 0)
			text = format("%s %s=\"%s\"", text, name[i], exact_text(unit->base[i]));
	}
	if (unit->angle)
		text = format("%s rad=\"%d\"", text, unit->angle);
	if (!is_coherent(unit))
		text = format("%s factor=\"%s\"", text, shortest(unit_factor(unit)));
	fprintf(to, "      <BaseUnit%s/>\n", text);
}

static bool is_first_shown(const struct fmu *f, int index)
{
	const struct fmu_variable *v = f->variables.variable;
	for (int i = 0; i < index; i++)
		if (v[i].shown && strcmp(v[i].shown->text, v[index].shown->text) == 0 &&
		    strcmp(v[i].unit->text, v[index].unit->text) == 0)
			return false;
	return true;
}

static void print_unit(FILE *to, const struct fmu *f, int index)
{
	const struct fmu_variable *v = f->variables.variable;
	for (int i = 0; i < index; i++)
		if (v[i].unit && strcmp(v[i].unit->text, v[index].unit->text) == 0)
			return;
	fprintf(to, "    <Unit name=\"%s\">\n", attribute_text(v[index].unit->text));
	print_base_unit(to, v[index].unit);
	for (int i = index; i < f->variables.count; i++)
		if (v[i].shown && strcmp(v[i].unit->text, v[index].unit->text) == 0 && is_first_shown(f, i))
			fprintf(to, "      <DisplayUnit name=\"%s\" factor=\"%s\"/>\n",
				attribute_text(v[i].shown->text), shortest(1 / unit_factor(v[i].shown)));
	fputs("    </Unit>\n", to);
}

static void print_units(FILE *to, const struct fmu *f)
{
	bool any = false;
	for (int i = 0; i < f->variables.count; i++)
		if (f->variables.variable[i].unit) {
			fputs(any ? "" : "  <UnitDefinitions>\n", to);
			any = true;
			print_unit(to, f, i);
		}
	fputs(any ? "  </UnitDefinitions>\n" : "", to);
}

static void print_logging(FILE *to)
{
	fputs("  <LogCategories>\n"
	      "    <Category name=\"logStatusWarning\"/>\n"
	      "    <Category name=\"logStatusError\"/>\n"
	      "  </LogCategories>\n", to);
}

/* ---- the two versions ---- */

/* Of the model, as an attribute */
static const char *bound_text(const struct fmu *f)
{
	return f->worst ? format(" description=\"Fitted bound on the instructions of a step: %s.\"", f->worst) : "";
}

static void print_head_2(FILE *to, const struct fmu *f)
{
	fprintf(to, "<fmiModelDescription fmiVersion=\"2.0\" modelName=\"%s\" guid=\"%s\" license=\"MIT-0\" "
		    "generationTool=\"plgen " PLGEN_VERSION "\" variableNamingConvention=\"flat\"%s>\n",
		attribute_text(f->title), f->token, bound_text(f));
	fprintf(to, "  <CoSimulation modelIdentifier=\"%s\" canHandleVariableCommunicationStepSize=\"false\" "
		    "canNotUseMemoryManagementFunctions=\"true\" canGetAndSetFMUstate=\"true\" "
		    "canSerializeFMUstate=\"true\"%s>\n"
		    "    <SourceFiles>\n", f->name, f->derives ? " providesDirectionalDerivative=\"true\"" : "");
	for (int i = 0; i < FMU_SOURCES; i++)
		fprintf(to, "      <File name=\"%s\"/>\n", f->source[i]);
	fputs("    </SourceFiles>\n"
	      "  </CoSimulation>\n", to);
}

static void print_head_3(FILE *to, const struct fmu *f)
{
	fprintf(to, "<fmiModelDescription fmiVersion=\"3.0\" modelName=\"%s\" instantiationToken=\"%s\" "
		    "license=\"MIT-0\" generationTool=\"plgen " PLGEN_VERSION "\" "
		    "variableNamingConvention=\"flat\"%s>\n", attribute_text(f->title), f->token, bound_text(f));
	fprintf(to, "  <CoSimulation modelIdentifier=\"%s\" canGetAndSetFMUState=\"true\" "
		    "canSerializeFMUState=\"true\" canHandleVariableCommunicationStepSize=\"false\" "
		    "fixedInternalStepSize=\"%s\"%s%s/>\n", f->name, shortest(f->h),
		f->derives ? " providesDirectionalDerivatives=\"true\" providesAdjointDerivatives=\"true\"" : "",
		f->crosses ? " mightReturnEarlyFromDoStep=\"true\"" : "");
}

const char *model_description(const struct fmu *f)
{
	struct text t = { 0 };
	open_text(&t);
	(f->version == 3 ? print_head_3 : print_head_2)(t.to, f);
	print_units(t.to, f);
	print_logging(t.to);
	fprintf(t.to, "  <DefaultExperiment startTime=\"0\" stepSize=\"%s\"/>\n", shortest(f->h));
	print_variables(t.to, f);
	print_structure(t.to, f);
	fputs("</fmiModelDescription>\n", t.to);
	return close_text(&t);
}

const char *build_description(const struct fmu *f)
{
	struct text t = { 0 };
	open_text(&t);
	fprintf(t.to, "<fmiBuildDescription fmiVersion=\"3.0\">\n"
		      "  <BuildConfiguration modelIdentifier=\"%s\">\n"
		      "    <SourceFileSet language=\"C99\">\n", f->name);
	for (int i = 0; i < FMU_SOURCES; i++)
		fprintf(t.to, "      <SourceFile name=\"%s\"/>\n", f->source[i]);
	fputs("    </SourceFileSet>\n", t.to);
	if (f->math)
		fputs("    <Library name=\"m\" external=\"true\" "
		      "description=\"the C library's mathematics, where it is a library of its own\"/>\n", t.to);
	fputs("  </BuildConfiguration>\n"
	      "</fmiBuildDescription>\n", t.to);
	return close_text(&t);
}
