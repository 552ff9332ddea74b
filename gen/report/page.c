/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One page of HTML with everything in it: equations, matrices, modes, pictures, what was chosen, what it costs, how
 * far it may be off. It reads well at 400 points of width too: pictures have a sheet of that width, text breaks, and
 * matrices alone move in frames of their own. */
#include "host/picture.h"
#include "report/report.h"
#include "step/linear/forms.h"
#include "step/linear/images.h"

#include <math.h>
#include <string.h>

struct section {
	const char *title;
	void (*print)(FILE *to, const struct step *step); /* NULL: nothing before its picture */
	bool (*applies)(const struct step *step); /* NULL: always */
	const char *picture;            /* the kind that follows; NULL: none */
};

static const char style[] =
	"body{font:16px/1.5 system-ui,sans-serif;color:#222;background:#fff;max-width:60rem;margin:0 auto;"
	"padding:1rem}\n"
	"h1{font-size:1.6rem;margin:.2em 0}h2{font-size:1.2rem;margin:1.6em 0 .4em;border-bottom:1px solid #ccc}\n"
	"nav a{margin-right:.9em;white-space:nowrap}a{color:#1f5fa8}p{margin:.5em 0}\n"
	".wide{overflow-x:auto;margin:.5em 0}\n"
	"pre{font:.85rem/1.45 ui-monospace,monospace;background:#f5f5f5;padding:.6em .8em;margin:.5em 0;"
	"white-space:pre-wrap;overflow-wrap:anywhere}\n"
	"table{border-collapse:collapse;font-size:.9rem}td,th{padding:.2em .7em;text-align:right;"
	"border-bottom:1px solid #e4e4e4;white-space:nowrap}th{font-weight:600}\n"
	"td.name,th.name{text-align:left}.matrix,.shapes{display:inline-table;vertical-align:top;"
	"margin:.3em 1.4em .3em 0}table.matrix{border-left:2px solid #444;"
	"border-right:2px solid #444}table.matrix td{border:0}\n"
	"figure{margin:.6em 0}figure svg{display:block;width:100%;height:auto}.narrow{display:none}\n"
	"@media(max-width:40rem){.broad{display:none}.narrow{display:block}body{padding:.6rem}"
	"table{font-size:.75rem}td,th{padding:.2em .35em}td,th{white-space:normal}"
	"td.name{overflow-wrap:anywhere}td.name:last-child{min-width:8em}table.matrix td{white-space:nowrap}"
	"pre{font-size:.75rem}}\n";

static const char dark[] =
	"body{color:#dde1e6;background:#14171c}pre{background:#20252c}a{color:#7fb2f0}"
	"h2,td,th{border-color:#363c45}table.matrix{border-color:#8b929c}\n";

/* ---- text as HTML ---- */

const char *html_text(const char *text)
{
	const char *html = "";
	for (; *text; text++) {
		const char *as = *text == '<' ? "&lt;" : *text == '>' ? "&gt;" : *text == '&' ? "&amp;"
				 : *text == '"' ? "&quot;" : NULL;
		html = as ? format("%s%s", html, as) : format("%s%c", html, *text);
	}
	return html;
}

static void copy_escaped(FILE *from, FILE *to)
{
	rewind(from);
	for (int c; (c = getc(from)) != EOF;)
		if (c == '<' || c == '>' || c == '&')
			fputs(c == '<' ? "&lt;" : c == '>' ? "&gt;" : "&amp;", to);
		else
			putc(c, to);
}

/* The text for a person, as it is */
static void print_words(FILE *to, const struct step *step, void (*print)(FILE *to, const struct step *step))
{
	FILE *words = new_script();
	print(words, step);
	fputs("<pre>", to);
	copy_escaped(words, to);
	fputs("</pre>\n", to);
	fclose(words);
}

/* ---- sections ---- */

static const struct model *reported_model(const struct step *step)
{
	const struct model *model = step->shown->model;
	return model->reduction.truncated ? model : model->written;
}

static void print_equations(FILE *to, const struct step *step)
{
	print_words(to, step, text_equations);
}

/* ---- tables of many columns ---- */

/* Printed as tables of a few columns each, which stand next to each other as far as there is room, so that a narrow
 * window moves up and down alone. */
struct wide_table {
	const char *class;
	int rows, columns;
	const char *corner, **row, **column;    /* heads */
	const char **entry;             /* [row][column] */
};

static struct wide_table wide_table_new(const char *class, int rows, int columns)
{
	return (struct wide_table){ class, rows, columns, "", ARRAY(const char *, rows + 1),
			       ARRAY(const char *, columns + 1), ARRAY(const char *, rows * columns + 1) };
}

static size_t longest(int count, const char *const *text, int stride)
{
	size_t most = 0;
	for (int i = 0; i < count; i++) {
		const size_t length = strlen(text[i * stride]);
		most = length > most ? length : most;
	}
	return most;
}

/* The column behind those that have room beside the heads of rows in a window of 400 points */
static int last_column(const struct wide_table *t, int first)
{
	enum { LETTERS = 44, BETWEEN = 2 };
	size_t letters = longest(t->rows, t->row, 1);
	for (int j = first; j < t->columns; j++) {
		const size_t head = strlen(t->column[j]), entries = longest(t->rows, t->entry + j, t->columns);
		letters += (head > entries ? head : entries) + BETWEEN;
		if (letters > LETTERS && j > first)
			return j;
	}
	return t->columns;
}

static void print_columns(FILE *to, const struct wide_table *t, int first, int last)
{
	fprintf(to, "<table class=\"%s\">\n<tr><th class=\"name\">%s</th>", t->class, t->corner);
	for (int j = first; j < last; j++)
		fprintf(to, "<th>%s</th>", html_text(t->column[j]));
	fputs("</tr>\n", to);
	for (int i = 0; i < t->rows; i++) {
		fprintf(to, "<tr><th class=\"name\">%s</th>", html_text(t->row[i]));
		for (int j = first; j < last; j++)
			fprintf(to, "<td>%s</td>", t->entry[i * t->columns + j]);
		fputs("</tr>\n", to);
	}
	fputs("</table>\n", to);
}

static void print_wide_table(FILE *to, const struct wide_table *t)
{
	fputs("<div class=\"wide\">\n", to);
	for (int first = 0, last; first < t->columns; first = last) {
		last = last_column(t, first);
		print_columns(to, t, first, last);
	}
	fputs("</div>\n", to);
}

static void print_matrix(FILE *to, const char *name, const struct model *model, const mpq_t *A)
{
	const int n = model->n;
	struct wide_table t = wide_table_new("matrix", n, n);
	t.corner = name;
	for (int i = 0; i < n; i++) {
		t.row[i] = format("%d", i + 1);
		t.column[i] = model->names.coord[i];
		for (int j = 0; j < n; j++)
			t.entry[i * n + j] = readable_text(A[i * n + j]);
	}
	print_wide_table(to, &t);
}

static void print_determinant(FILE *to, const struct step *step)
{
	mpq_t *B;
	const int length = characteristic_of(step->model, step->written, &B);
	fprintf(to, "<p>Characteristic polynomial, det P(s):</p>\n<pre>    B(s) = %s</pre>\n",
		polynomial_text(length, B));
}

static void print_matrices(FILE *to, const struct step *step)
{
	const struct model *model = reported_model(step);
	fprintf(to, "<p>%sP(s) = M s<sup>2</sup> + C s + K, over %s; a row for each equation, as written.</p>\n",
		is_nonlinear(step) ? "Of the terms that are linear with constant coefficients: " : "",
		html_text(name_list(model->n, model->names.coord)));
	print_matrix(to, "M", model, model->system.M);
	print_matrix(to, "C", model, model->system.C);
	print_matrix(to, "K", model, model->system.K);
	if (!is_nonlinear(step))
		print_determinant(to, step);
}

static void print_left_out(FILE *to, const struct step *step)
{
	print_words(to, step, text_nonlinear);
}

static bool is_linear_model(const struct step *step)
{
	return !is_nonlinear(step);
}

static void print_modes(FILE *to, const struct step *step)
{
	struct pole_report *pole;
	int count = poles_of(step->model, step->written, &pole);
	fputs("<div class=\"wide\"><table>\n<tr><th class=\"name\">pole [1/s]</th><th>frequency [Hz]</th><th>damping "
	      "ratio</th></tr>\n", to);
	for (int i = 0; i < count; i++)
		fprintf(to, "<tr><td class=\"name\">%s</td><td>%.8g</td><td>%.8g</td></tr>\n", pole_text(&pole[i]),
			mpfr_get_d(pole[i].hertz, MPFR_RNDN), mpfr_get_d(pole[i].damping_ratio, MPFR_RNDN));
	fputs("</table></div>\n", to);
}

static const char *entry_text(const struct mode_shape *shape, int i)
{
	const char *re = format("%.4g", shape->re[i]);
	if (shape->im[i] == 0)
		return re;
	return format("%s %c %.4g i", re, shape->im[i] < 0 ? '-' : '+', fabs(shape->im[i]));
}

static bool has_shapes(const struct step *step)
{
	return !is_nonlinear(step) && reported_model(step)->n <= LIMIT_SHAPES;
}

static void print_shapes(FILE *to, const struct step *step)
{
	const struct model *model;
	struct mode_shape *shape;
	int count = shapes_of_step(step, &shape, &model);
	struct wide_table t = wide_table_new("shapes", count, model->n);
	fputs("<p>The largest entry of each is 1.</p>\n", to);
	t.corner = "[Hz]";
	for (int i = 0; i < model->n; i++)
		t.column[i] = model->names.coord[i];
	for (int k = 0; k < count; k++) {
		t.row[k] = format("%.6g", mpfr_get_d(shape[k].pole->hertz, MPFR_RNDN));
		for (int i = 0; i < model->n; i++)
			t.entry[k * model->n + i] = entry_text(&shape[k], i);
	}
	print_wide_table(to, &t);
}

static bool has_transfers(const struct step *step)
{
	const struct model *model = step->shown->model;
	struct drive *drive;
	struct transfer *t;
	if (is_nonlinear(step) || model->system.states > LIMIT_TRANSFERS || drives_of(model, &drive) == 0)
		return false;
	int count = transfers_of(resolvent_of(&model->system), model, &t);
	while (count > 0 && t[count - 1].N.length == 0)
		count--;
	return count > 0;
}

static bool has_response(const struct step *step)
{
	const struct model *model = step->shown->model;
	return !model->switching && !has_remainder(step) && model->system.inputs == 0;
}

static void print_gains(FILE *to, const struct step *step)
{
	const struct model *model = step->shown->model;
	struct transfer *t;
	int count = transfers_of(resolvent_of(&model->system), model, &t);
	fputs("<div class=\"wide\"><table>\n<tr><th class=\"name\">output</th><th class=\"name\">over</th><th>static "
	      "gain</th><th class=\"name\">zeros [1/s]</th></tr>\n", to);
	for (int k = 0; k < count; k++)
		fprintf(to, "<tr><td class=\"name\">%s</td><td class=\"name\">%s</td><td>%s</td><td "
			    "class=\"name\">%s</td></tr>\n", html_text(labelled(model, t[k].output)),
			html_text(labelled(model, t[k].drive)), static_gain_text(&t[k]), zeros_text(model, &t[k]));
	fputs("</table></div>\n", to);
}

static void print_chosen(FILE *to, const struct step *step)
{
	const struct model *model = step->shown->model;
	fprintf(to, "<p>Scheme %s%s, form %s, h = %s s, numbers of type %s.</p>\n", scheme_name(model->scheme),
		model->request.at.scheme.source ? " (asked for)" : " (best that the model allows)",
		step_form_text(step),
		readable_text(model->h), target_name());
	if (model->nonlinear.obstacle && model->nonlinear.why)
		fprintf(to, "<p>Not exact as a whole: %s.</p>\n", html_text(model->nonlinear.why));
	print_words(to, step, text_course);
}

static void print_cost(FILE *to, const struct step *step)
{
	print_words(to, step, text_cost);
}

static const struct section sections[] = {
	{ "Equations", print_equations, NULL, NULL },
	{ "Matrices", print_matrices, NULL, NULL },
	{ "What is not reported, and why", print_left_out, is_nonlinear, NULL },
	{ "Poles and modes", print_modes, is_linear_model, NULL },
	{ "Poles in the plane", NULL, is_linear_model, "poles" },
	{ "Mode shapes", print_shapes, has_shapes, "modes" },
	{ "Static gains and zeros", print_gains, has_transfers, NULL },
	{ "Frequency responses", NULL, has_transfers, "frf" },
	{ "Response from the start", NULL, has_response, "response" },
	{ "What was chosen, and why", print_chosen, NULL, NULL },
	{ "Cost and error of a step", print_cost, NULL, NULL }
};
enum { SECTIONS = sizeof sections / sizeof *sections };

static bool is_there(const struct section *section, const struct step *step)
{
	return !section->applies || section->applies(step);
}

/* In a frame that has an origin of its own, under its own policy */
static void print_frame(FILE *to, const char *live)
{
	fputs("<h2 id=\"live\">The model runs</h2>\n<iframe title=\"The model runs\" sandbox=\"allow-scripts "
	      "allow-downloads\" style=\"width:100%;height:50rem;border:1px solid #ccc\" srcdoc=\"", to);
	for (; *live; live++)
		if (*live == '&' || *live == '"')
			fputs(*live == '&' ? "&amp;" : "&quot;", to);
		else
			fputc(*live, to);
	fputs("\"></iframe>\n", to);
}

void print_page(FILE *to, const struct step *step, const char *options, const struct picture_look *look,
		const char *live)
{
	const struct model *model = step->shown->model;
	const char *name = model->delays ? model->delays->name : model->name;
	const char *title = html_text(look->title ? look->title : name);
	const int inputs = model->delays ? model->delays->inputs : model->system.inputs;
	fprintf(to, "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n<meta name=\"viewport\" "
		    "content=\"width=device-width,initial-scale=1\"/>\n<title>%s</title>\n<style>\n%s%s</style>\n"
		    "</head>\n<body>\n<h1>%s</h1>\n", title, style, look->dark ? dark : "", title);
	fprintf(to, "<p>%d coordinate%s, %d states, %d input%s, %d output%s; plgen " PLGEN_VERSION "%s%s.</p>\n<nav>",
		model->written->n, model->written->n == 1 ? "" : "s", model->written->system.states, inputs,
		inputs == 1 ? "" : "s", model->outputs,
		model->outputs == 1 ? "" : "s", *options ? " " : "", html_text(options));
	if (live)
		fputs("<a href=\"#live\">The model runs</a>\n", to);
	for (int i = 0; i < SECTIONS; i++)
		if (is_there(&sections[i], step))
			fprintf(to, "<a href=\"#s%d\">%s</a>\n", i, sections[i].title);
	fputs("</nav>\n", to);
	if (live)
		print_frame(to, live);
	for (int i = 0; i < SECTIONS; i++) {
		if (!is_there(&sections[i], step))
			continue;
		fprintf(to, "<h2 id=\"s%d\">%s</h2>\n", i, sections[i].title);
		if (sections[i].print)
			sections[i].print(to, step);
		if (sections[i].picture)
			picture_in_page(to, step, sections[i].picture, look->dark);
	}
	fputs("</body>\n</html>\n", to);
}
