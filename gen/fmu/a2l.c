/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Names for calibration tools, ASAP2 1.61: states and outputs to be measured, tunable params to be set, as elements of
 * arrays of the user's, NAME_states, NAME_outputs and NAME_params, which NAME_get and NAME_out fill and NAME_retune
 * reads. Addresses are 0 with a link to the symbol, from which a tool and the linker's map make them. */
#include "fmu/fmu.h"
#include "model/tunable/tuning.h"
#include "step/step.h"

#include <ctype.h>
#include <string.h>

struct a2l {
	FILE *to;
	const char *name;
	bool single;
	struct fmu_variables variables;
	const char **written;       /* identifiers so far */
	int count;
};

static const char *type_of(const struct a2l *a)
{
	return a->single ? "FLOAT32_IEEE" : "FLOAT64_IEEE";
}

static const char *largest_of(const struct a2l *a)
{
	return a->single ? "3.4028234E+38" : "1.7976931348623157E+308";
}

static bool is_written(const struct a2l *a, const char *name)
{
	for (int i = 0; i < a->count; i++)
		if (strcmp(a->written[i], name) == 0)
			return true;
	return false;
}

/* rotor.outputs.q_dot[2], of q[2]': letters, digits, _ and an index at the end, which no other has */
static const char *identifier(struct a2l *a, const char *group, const char *name)
{
	const char *text = "";
	int primes = 0;
	for (; *name; name++) {
		primes += *name == '\'';
		if (*name != '\'')
			text = format("%s%c", text,
				      isalnum((unsigned char)*name) || strchr("_.[]", *name) ? *name : '_');
	}
	const char *index = strchr(text, '[') ? strchr(text, '[') : text + strlen(text);
	text = format("%s.%s.%.*s%s%s", a->name, group, (int)(index - text), text,
		      primes == 0 ? "" : primes == 1 ? "_dot" : "_ddot", index);
	while (is_written(a, text))
		text = format("%s_", text);
	*MORE(a->written, a->count) = text;
	return text;
}

/* Quotes and backslashes with a backslash before them */
static const char *quoted(const char *text)
{
	const char *out = "\"";
	for (; text && *text; text++)
		out = format("%s%s%c", out, strchr("\"\\", *text) ? "\\" : "",
			     (unsigned char)*text < ' ' ? ' ' : *text);
	return format("%s\"", out);
}

static void link_of(const struct a2l *a, const char *array, int index)
{
	fprintf(a->to, "      SYMBOL_LINK \"%s_%s\" %d\n", a->name, array, index * (a->single ? 4 : 8));
}

static const char *shown_of(const struct fmu_variable *v)
{
	const char *dot = strchr(v->name, '.');
	return v->kind == FMU_STATE && dot ? dot + 1 : v->name;
}

/* Units are those of the arrays: of states and params SI, of outputs their own. */
static void print_unit(const struct a2l *a, const struct unit *unit, bool own)
{
	if (unit)
		fprintf(a->to, "      PHYS_UNIT %s\n", quoted(own ? unit->text : si_unit_text(unit->base)));
}

static void print_measurement(struct a2l *a, const struct fmu_variable *v, const char *array, int index,
			      const struct unit *unit)
{
	fprintf(a->to, "    /begin MEASUREMENT %s %s\n      %s NO_COMPU_METHOD 0 0 -%s %s\n      ECU_ADDRESS 0x0\n",
		identifier(a, array, shown_of(v)), quoted(v->description), type_of(a), largest_of(a), largest_of(a));
	print_unit(a, unit, v->kind == FMU_OUTPUT);
	link_of(a, array, index);
	fputs("    /end MEASUREMENT\n", a->to);
}

static void print_characteristic(struct a2l *a, const struct fmu_variable *v, int index, const struct unit *unit)
{
	const struct param_range *range = v->range;
	const char *low = range ? shortest(nearest_double(range->low)) : format("-%s", largest_of(a));
	const char *high = range ? shortest(nearest_double(range->high)) : largest_of(a);
	fprintf(a->to, "    /begin CHARACTERISTIC %s %s\n      VALUE 0x0 PL_VALUE 0 NO_COMPU_METHOD %s %s\n",
		identifier(a, "params", v->name), quoted(v->description), low, high);
	print_unit(a, unit, false);
	link_of(a, "params", index);
	fputs("    /end CHARACTERISTIC\n", a->to);
}

static const struct unit *unit_of_variable(const struct step *step, const struct fmu_variable *v, int index)
{
	return v->kind == FMU_OUTPUT  ? step->model->output[index].unit
	       : v->kind == FMU_STATE ? unit_of_state(step->shown->model, index)
				      : tunables_of(step->model)->param[index].symbol->unit;
}

static void print_variables(struct a2l *a, const struct step *step)
{
	int index[FMU_CONSTANT + 1] = { 0 };
	for (int i = 0; i < a->variables.count; i++) {
		const struct fmu_variable *v = &a->variables.variable[i];
		const int at = index[v->kind]++;
		if (v->kind == FMU_PARAM)
			print_characteristic(a, v, at, unit_of_variable(step, v, at));
		else if (v->kind == FMU_OUTPUT || v->kind == FMU_STATE)
			print_measurement(a, v, v->kind == FMU_OUTPUT ? "outputs" : "states", at,
					  unit_of_variable(step, v, at));
	}
}

/* One for each array */
static void print_groups(const struct a2l *a)
{
	static const char *const group[] = { "states", "outputs", "params" };
	for (int g = 0; g < 3; g++) {
		const char *start = format("%s.%s.", a->name, group[g]), *list = "";
		const char *kind = g < 2 ? "MEASUREMENT" : "CHARACTERISTIC";
		for (int i = 0; i < a->count; i++)
			if (strncmp(a->written[i], start, strlen(start)) == 0)
				list = format("%s\n        %s", list, a->written[i]);
		if (*list)
			fprintf(a->to, "    /begin GROUP %s_%s \"\" ROOT\n      /begin REF_%s%s\n      /end REF_%s\n"
				       "    /end GROUP\n", a->name, group[g], kind, list, kind);
	}
}

void print_a2l(FILE *to, const struct step *step)
{
	struct a2l a = { to, step->model->name, step->model->request.single, variables_of(step), NULL, 0 };
	fprintf(to,
		"ASAP2_VERSION 1 61\n/* %s: made by plgen " PLGEN_VERSION ". The arrays are the program's own:\n"
		" * NAME_get(&s, %s_states), NAME_out(&s, %s_outputs), NAME_retune(&c, %s_params, h). */\n"
		"/begin PROJECT %s \"\"\n  /begin MODULE %s_model \"\"\n"
		"    /begin MOD_COMMON \"\"\n      BYTE_ORDER MSB_LAST\n      ALIGNMENT_FLOAT%d_IEEE %d\n"
		"    /end MOD_COMMON\n"
		"    /begin RECORD_LAYOUT PL_VALUE\n      FNC_VALUES 1 %s COLUMN_DIR DIRECT\n    /end RECORD_LAYOUT\n",
		a.name, a.name, a.name, a.name, a.name, a.name, a.single ? 32 : 64, a.single ? 4 : 8, type_of(&a));
	print_variables(&a, step);
	print_groups(&a);
	fputs("  /end MODULE\n/end PROJECT\n", to);
}
