/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What all emitters write with: text laid out as the C it becomes, sums, factors, rows of numbers. */
#include "text.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

static const char *name_of_letter(const struct emitter *e, char letter)
{
	switch (letter) {
	case 'n': return e->name;
	case 'N': return e->upper;
	case 'o': return e->spelled.own;
	case 'p': return e->spelled.place;
	case 'd': return e->spelled.degree;
	case 'c': return e->spelled.columns;
	default: return "$";
	}
}

/* `layout` with the names in it: names are C identifiers, without a % */
static char *with_names(const struct emitter *e, const char *layout)
{
	size_t length = 1;
	for (const char *c = layout; *c; c++)
		length += *c == '$' ? strlen(name_of_letter(e, c[1])) : 1;
	char *text = ARRAY(char, length), *end = text;
	for (const char *c = layout; *c; c++) {
		if (*c != '$') {
			*end++ = *c;
			continue;
		}
		end = stpcpy(end, name_of_letter(e, *++c));
	}
	return text;
}

void say(const struct emitter *e, const char *layout, ...)
{
	char *named = strchr(layout, '$') ? with_names(e, layout) : NULL;
	va_list arguments;
	va_start(arguments, layout);
	vfprintf(e->to, named ? named : layout, arguments);
	va_end(arguments);
	discard(named);
}

static const char *spelled(const struct emitter *e, const char *layout, va_list arguments)
{
	char *named = strchr(layout, '$') ? with_names(e, layout) : NULL;
	va_list again;
	va_copy(again, arguments);
	size_t size = (size_t)vsnprintf(NULL, 0, named ? named : layout, arguments) + 1;
	char *text = ARRAY(char, size);
	vsnprintf(text, size, named ? named : layout, again);
	va_end(again);
	discard(named);
	const char *result = format("%s", text);
	discard(text);
	return result;
}

const char *spell(const struct emitter *e, const char *layout, ...)
{
	va_list arguments;
	va_start(arguments, layout);
	const char *text = spelled(e, layout, arguments);
	va_end(arguments);
	return text;
}

void open_function(const struct emitter *e, const char *note, const char *layout, ...)
{
	va_list arguments;
	va_start(arguments, layout);
	say(e, "\n%s%s\n{\n", note ? format("/* %s */\n", note) : "", spelled(e, layout, arguments));
	va_end(arguments);
}

void close_function(const struct emitter *e, const char *unread)
{
	const char *before = "    ";
	for (size_t length; *(unread += strspn(unread, ", ")); unread += length, before = " ") {
		length = strcspn(unread, ", ");
		say(e, "%s(void)%.*s;", before, (int)length, unread);
	}
	say(e, "%s}\n", *before && !before[1] ? "\n" : "");
}

void emit_if_any(void (*printer)(const struct emitter *e), const struct emitter *e)
{
	if (printer)
		printer(e);
}

void put(FILE *to, const char *text, size_t length)
{
	fwrite(text, 1, length, to);
}

/* (a + b) + (c + d): the shortest chain of dependent additions; lines break at the middle of what is too long for
 * one. */
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

void add_summand(struct summands *s, const char *text)
{
	*MORE(s->term, s->terms) = text;
}

const char *sum_of(const struct summands *s, int indent)
{
	return s->terms ? tree(s->terms, s->term, indent) : "0.0";
}

const char *scaled(double factor, const char *operand)
{
	if (!operand)
		return shortest(factor);
	if (factor == 1)
		return operand;
	return factor == -1 ? format("-%s", operand) : format("%s * %s", shortest(factor), operand);
}

double finite_number(const struct emitter *e, mpq_srcptr q)
{
	return equation_number(e->model, q).value;
}

/* Of an initialiser, without its braces; `row` says of what a number may be too large, NULL: it is not known */
static void say_row(const struct emitter *e, int count, const double *value, const char *row)
{
	size_t width = 0;
	for (int i = 0; i < count; i++) {
		if (!isfinite(value[i]))
			error(e->model->request.at.step, NULL, "a number%s is beyond the range of %s",
			      row ? format(" in the row of %s", row) : "", target_name());
		const char *text = format("%s%s", shortest(value[i]), i + 1 < count ? ", " : "");
		width += strlen(text);
		say(e, "%s%s", text, width > 90 && i + 1 < count ? "\n     " : "");
		width = width > 90 ? 0 : width;
	}
}

/* A matrix among others: one row stands on one line. */
void emit_inner_matrix(const struct emitter *e, int rows, int columns, const double *value, const char *const *row_note)
{
	say(e, rows == 1 ? "    {{" : "  {\n");
	if (rows == 1)
		say_row(e, columns, value, *row_note);
	else
		emit_number_rows(e, rows, columns, value, row_note);
	say(e, rows == 1 ? "}},  /* %s */\n" : "  },\n", *row_note);
}

void emit_number_rows(const struct emitter *e, int rows, int columns, const double *value, const char *const *row_note)
{
	for (int i = 0; i < rows; i++) {
		say(e, "    {");
		say_row(e, columns, value + i * columns, row_note[i]);
		say(e, "},  /* %s */\n", row_note[i]);
	}
}

/* Rows of the innermost dimension, in braces of those further out; `row`: of it, or of its rows, what they are */
static void say_array(const struct emitter *e, int dimensions, const int *size, int depth, const double *value,
		      const char *const *row)
{
	int each = 1;
	for (int k = 1; k < dimensions; k++)
		each *= size[k];
	say(e, "%*s{%s", 2 * depth, "", dimensions == 1 ? "" : "\n");
	if (dimensions == 1)
		say_row(e, *size, value, row ? *row : NULL);
	for (int i = 0; dimensions > 1 && i < *size; i++)
		say_array(e, dimensions - 1, size + 1, depth + 1, value + i * each,
			  row && dimensions == 2 ? row + i : row);
	say(e, "%*s}%s%s\n", dimensions == 1 ? 0 : 2 * depth, "", depth ? "," : ";",
	    row && dimensions == 1 ? format("  /* %s */", *row) : "");
}

const char *state_vector(const struct emitter *e)
{
	return e->wide ? "y" : "s->y";
}

const char *table_words(const struct emitter *e)
{
	return e->device ? e->device : "static const";
}

void emit_array(const struct emitter *e, const char *note, const char *name, int dimensions, const int *size,
		const double *value, const char *const *row)
{
	say(e, "%s%s double $n_%s", note ? format("\n/* %s */\n", note) : "", table_words(e), name);
	for (int k = 0; k < dimensions; k++)
		say(e, "[%d]", size[k]);
	say(e, " = ");
	say_array(e, dimensions, size, 0, value, row);
}

void emit_name_list(const struct emitter *e, const char *array, int count, const char *const *name)
{
	say(e, "static const char *const $n_%s[] = {", array);
	for (int i = 0; i < count; i++)
		say(e, "%s\"%s\"", i == 0 ? "" : i % 10 ? ", " : ",\n    ", name[i]);
	say(e, "};\n");
}

const char *low_text(mpq_srcptr q)
{
	return shortest(rounding_rest(q));
}

const char *two_text(mpq_srcptr q)
{
	return format("{%s, %s}", shortest(round_rational(q)), low_text(q));
}

/* Broken between summands, or declarations, that would pass column 110 */
void say_wrapped(const struct emitter *e, const char *text)
{
	enum { WIDTH = 96, INDENT = 10 };
	size_t start = 0, last = 0, length = strlen(text);
	int width = WIDTH;
	say(e, length ? "    " : "");
	for (size_t i = 0; i < length; i++) {
		if (strncmp(text + i, " + ", 3) == 0 || strncmp(text + i, " - ", 3) == 0 || (i && text[i - 1] == ','))
			last = i;
		if (i - start > (size_t)width && last > start) {
			say(e, "%.*s\n%*s", (int)(last - start), text + start, INDENT - 1, "");
			start = last;
			width = WIDTH;
		}
	}
	say(e, "%s", text + start);
}

void say_vector(const struct emitter *e, const char *name, int count, const char *const *text)
{
	enum { WIDTH = 100 };
	int width = (int)strlen(name) + 24;
	say(e, "    const double %s[%d] = {", name, count);
	for (int k = 0; k < count; k++) {
		const char *own = text[k] ? text[k] : "1.0";
		int length = (int)strlen(own) + 2;
		bool breaks = width + length > WIDTH;
		say(e, "%s%s%s", k ? "," : "", breaks ? "\n        " : k ? " " : "", own);
		width = (breaks ? 8 : width) + length;
	}
	say(e, "};\n");
}

const char *integer_text(int number)
{
	return format("%d", number);
}

/* What numbers.h defines itself where the file does not */
static bool is_default(const char *name, const char *text)
{
	return strstr(runtime_text("numbers.h"), format("\n#define PL_%s %s\n", name, text)) != NULL;
}

void say_macro(const struct emitter *e, const char *name, const char *text)
{
	if (is_default(name, text))
		return;
	say(e, "#define PL_%s%s%s\n", name, *text ? " " : "", text);
}

void emit_integers(const struct emitter *e, const char *type, const char *name, int count, const int *value)
{
	say(e, "%s %s $n_%s[%d] = {%s", table_words(e), type, name, count ? count : 1, count ? "" : "0");
	for (int i = 0; i < count; i++)
		say(e, "%s%d", !i ? "" : i % 20 ? ", " : ",\n    ", value[i]);
	say(e, "};\n");
}

void emit_integer_rows(const struct emitter *e, const char *type, const char *name, int rows, int columns,
		       const int *value)
{
	say(e, "static const %s $n_%s = {", type, name);
	for (int i = 0; i < rows; i++) {
		say(e, "%s{", !i ? "\n    " : i % 6 ? ", " : ",\n    ");
		for (int j = 0; j < columns; j++)
			say(e, "%s%d", j ? ", " : "", value[i * columns + j]);
		say(e, "}");
	}
	say(e, "\n};\n");
}

void emit_int_list(const struct emitter *e, const char *name, int count, const int *value)
{
	emit_integers(e, "int", name, count, value);
}

/* The first sentence behind "/\* NAME: ", on one line */
static const char *purpose_of(const char *algorithm)
{
	const char *text = strstr(runtime_text(algorithm), format("/* %s: ", algorithm)), *purpose = "";
	for (text += strlen("/* : ") + strlen(algorithm); *text && !(*text == '.' && strchr(" \n", text[1])) &&
	     strncmp(text, " */", 3) != 0; text += strncmp(text, "\n *", 3) == 0 ? 3 : 1)
		purpose = format("%s%.1s", purpose, *text == '\n' ? "" : text);
	return purpose;
}

void say_words(const struct emitter *e, const char *text)
{
	enum { WIDTH = 110 };
	size_t column = 2;
	say(e, " *");
	while (*text) {
		size_t word = strcspn(text, " ");
		if (column + 1 + word > WIDTH) {
			say(e, "\n *");
			column = 2;
		}
		say(e, " %.*s", (int)word, text);
		column += 1 + word;
		text += word + strspn(text + word, " ");
	}
	say(e, "\n");
}

void say_comment(const struct emitter *e, const char *indent, const char *text)
{
	enum { WIDTH = 112 };
	say(e, "%s/* ", indent);
	while (strlen(text) > WIDTH) {
		size_t length = WIDTH;
		while (length > 0 && text[length] != ' ')
			length--;
		if (length == 0)        /* a name longer than a line */
			length = strcspn(text, " ");
		if (!text[length])
			break;
		say(e, "%.*s\n%s * ", (int)length, text, indent);
		text += length + 1;
	}
	say(e, "%s */\n", text);
}

void say_purpose(const struct emitter *e, const char *algorithm)
{
	say(e, "\n");
	say_comment(e, "", format("From the runtime, %s: %s. The macros give it the model's sizes and limits.",
				  algorithm, purpose_of(algorithm)));
}

void say_include(const struct emitter *e, const char *algorithm)
{
	say(e, "#include \"%s\"\n", algorithm);
}

/* ---- NAME_coeffs: declared, or of the spec's values ---- */

void open_member(const struct emitter *e, const char *type, const char *name, const char *shape, const char *note)
{
	if (e->members && strlen(note) > 64) {
		say_comment(e->members, "    ", note);
		say(e->members, "    %s %s%s;\n", type, name, shape);
	} else if (e->members) {
		say(e->members, "    %-46s /* %s */\n", format("%s %s%s;", type, name, shape), note);
	} else {
		say(e, "    {  /* %s */\n", name);
	}
}

void close_member(const struct emitter *e)
{
	say(e, "    },\n");
}

void number_member(const struct emitter *e, const char *name, const char *value, const char *note)
{
	if (e->members)
		open_member(e, "double", name, "", note);
	else
		say(e, "    %s,\n", value);
}

void declare_members(const struct emitter *e, void (*print)(const struct emitter *e))
{
	struct emitter nowhere = *e;
	char *text = NULL;
	size_t length = 0;
	nowhere.members = e;
	nowhere.to = open_memstream(&text, &length);
	need_memory(nowhere.to);
	print(&nowhere);
	fclose(nowhere.to);
	free(text);
}

void emit_nominal_of(const struct emitter *e, void (*print)(const struct emitter *e))
{
	say(e, "\nconst $n_coeffs $n_nominal = {\n");
	print(e);
	say(e, "};\n");
}
