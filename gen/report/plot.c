/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures of a model as scripts for gnuplot: panels below each other, or beside. All numbers are in the script, those
 * of frf as --response prints them, those of response as --solution does. No dates, no paths. A page has each picture
 * twice, on a wide sheet and on a narrow one for telephones: the same numbers, laid out once for each. Legends stand
 * above their panels, never on curves, and curves of one panel differ in dashes and marks too. */
#include "model/regions/regions.h"
#include "host/picture.h"
#include "report/report.h"
#include "step/linear/images.h"

#include <math.h>
#include <string.h>

enum { NARROW = 400, SHEETS = 2, CURVES = PICTURE_CURVES, DRIVES = 6, OUTPUTS = 12, SHAPES = 12,
       POINTS = 600 };

struct panel {
	int sheet, left, top, width, height;   /* in points of a screen */
	const char *text;               /* commands */
};
struct picture {
	const struct step *step;
	const char *amplitude;          /* of an excitation that sweeps; NULL: frequency responses are linear */
	const struct picture_look *look;
	FILE *data;                     /* $name << END ... */
	int sheets, width[SHEETS], height[SHEETS];
	int panels;
	struct panel *panel;
};

/* ---- panels ---- */

/* On a paper lower, since letters are smaller there */
static int height_of(const struct picture *p, int height)
{
	return p->look->paper ? height * 7 / 10 : height;
}

static void add_panel(struct picture *p, int sheet, int left, int width, int height, const char *text)
{
	*MORE(p->panel, p->panels) =
		(struct panel){ sheet, left, p->height[sheet], width, height_of(p, height), text };
}

/* Over the whole width, the next below it */
static void add_row(struct picture *p, int sheet, int height, const char *text)
{
	add_panel(p, sheet, 0, p->width[sheet], height, text);
	p->height[sheet] += height_of(p, height);
}

static const char above[] = "set key outside top left horizontal Left reverse samplen 3\n";

/* Curve k of a panel of `points` points; dash: NULL, or another than its own */
static const char *curve(int k, const char *dash, int points)
{
	const struct picture_curve *c = &picture_curve[k % CURVES];
	return format("with linespoints lw 1.4 dt %s pt %d ps 0.5 pi %d lc rgb '%s'", dash ? dash : c->dash, c->mark,
		      points / (9 + k) + 1, c->colour);
}

/* Names are identifiers with primes and indices, and what loads are in time: nothing in them means more in quotes. */
static const char *quoted(const char *text)
{
	return format("\"%s\"", text);
}

static void note_first(int shown, int all, const char *what)
{
	if (shown < all)
		fprintf(stderr, "plgen: note: the first %d of %d %s are drawn\n", shown, all, what);
}

static void plot_poles(struct picture *p)
{
	need_linear(p->step, "poles");
	const char *text = draw_poles(p->data, p->step, p->look->paper ? 16 : 27);
	for (int sheet = 0; sheet < p->sheets; sheet++)
		add_row(p, sheet, 480, p->width[sheet] <= NARROW ? format("set xtics rotate by -45\n%s", text) : text);
}

/* ---- mode shapes ---- */

/* As many as there is room for */
static const char *coordinate_tics(const struct model *model, int most)
{
	const char *text = "set xtics (";
	int every = (model->n + most - 1) / most;
	for (int i = 0; i < model->n; i += every)
		text = format("%s%s%s %d", text, i ? ", " : "", quoted(model->names.coord[i]), i + 1);
	return format("%s)\n", text);
}

static bool is_complex(const struct mode_shape *shape, int n)
{
	for (int i = 0; i < n; i++)
		if (fabs(shape->im[i]) > 1e-6)
			return true;
	return false;
}

static void print_shape(FILE *to, const struct model *model, const struct mode_shape *shape, int k)
{
	fprintf(to, "$shape%d << END\n", k + 1);
	for (int i = 0; i < model->n; i++)
		fprintf(to, "%d %.17g %.17g\n", i + 1, shape->re[i], shape->im[i]);
	fputs("END\n", to);
}

static void add_shape(struct picture *p, int sheet, const struct model *model, const struct mode_shape *shape, int k,
		      int shapes)
{
	enum { TALL = 210 };
	bool twofold = is_complex(shape, model->n);
	int most = p->width[sheet] < 300 ? 1 : p->width[sheet] / 300;
	int columns = shapes < most ? shapes : most, wide = p->width[sheet] / columns;
	double hertz = mpfr_get_d(shape->pole->hertz, MPFR_RNDN);
	double ratio = mpfr_get_d(shape->pole->damping_ratio, MPFR_RNDN);
	add_panel(p, sheet, k % columns * wide, wide, TALL, format(
		"set title '%.5g Hz, damping ratio %.3g'\nset lmargin 7\nset rmargin 2\nset xzeroaxis lt 1 lc rgb "
		"frame\nset ytics 0.5\n%s%splot [0.5:%d.5] [-1.15:1.15] $shape%d using 1:2 %s title 're'%s\n",
		hertz, ratio, twofold ? above : "unset key\n", coordinate_tics(model, wide / 60), model->n, k + 1,
		curve(0, NULL, 0), twofold ? format(", '' using 1:3 %s title 'im'", curve(1, NULL, 0)) : ""));
	if (k % columns == columns - 1 || k == shapes - 1)
		p->height[sheet] += height_of(p, TALL);
}

static void plot_modes(struct picture *p)
{
	const struct model *of;
	struct mode_shape *shape;
	need_linear(p->step, "mode shapes");
	int count = shapes_of_step(p->step, &shape, &of);
	int shown = count < SHAPES ? count : SHAPES;
	if (of->system.n > LIMIT_SHAPES)
		error(of->request.at.step, NULL, "the model has %d coordinates: mode shapes are limited to %d",
		      of->system.n, LIMIT_SHAPES);
	note_first(shown, count, "mode shapes");
	for (int k = 0; k < shown; k++) {
		print_shape(p->data, of, &shape[k], k);
		for (int sheet = 0; sheet < p->sheets; sheet++)
			add_shape(p, sheet, of, &shape[k], k, shown);
	}
}

/* ---- frequency responses ---- */

/* The curves of one drive: those that are not 0; column 2, 4, ... of the data are sizes, after each an angle */
static const char *curves(const struct model *model, const struct responses *r, const char *data, int first, int last,
			  int angle, int *count)
{
	const char *text = "";
	*count = 0;
	for (int k = first; k < last; k++) {
		if (r->transfer[k].N.length == 0 && !r->transfer[k].earlier)
			continue;
		if (*count < CURVES)
			text = format("%s%s using 1:%d %s title %s", text, *text ? ", ''" : format("plot %s", data),
				      2 * k + 2 + angle, curve(*count, NULL, r->band.count),
				      quoted(labelled(model, r->transfer[k].output)));
		++*count;
	}
	return text;
}

static const char *frame_of(const struct band *band)
{
	return format("set logscale x\nset xrange [%.10g:%.10g]\nset lmargin 10\nset rmargin 3\n%sset format y "
		      "'%%.5g'\n", band->from, band->to, above);
}

static void add_size_and_angle(struct picture *p, const char *frame, const char *title, const char *size,
			       const char *angle)
{
	for (int sheet = 0; sheet < p->sheets; sheet++) {
		add_row(p, sheet, 300, format("%sset title %s\nset logscale y\nset format x ''\n"
					      "set ylabel 'magnitude'\nset bmargin 0.6\n%s\n", frame,
					      quoted(title), size));
		add_row(p, sheet, 190, format("%sset key off\nset tmargin 0.6\nset ylabel 'phase [deg]'\nset ytics 90\n"
					      "set xlabel 'f [Hz]'\n%s\n", frame, angle));
	}
}

static void add_bode(struct picture *p, const struct responses *r, int first, int last)
{
	int count, angles;
	const char *size = curves(p->step->shown->model, r, "$frf", first, last, 0, &count);
	const char *angle = curves(p->step->shown->model, r, "$frf", first, last, 1, &angles);
	const char *frame = frame_of(&r->band);
	note_first(count < CURVES ? count : CURVES, count, "outputs");
	if (count == 0)
		return;
	add_size_and_angle(p, frame, format("outputs over %s", labelled(p->step->shown->model,
									 r->transfer[first].drive)), size, angle);
}

/* ---- sweeps, up and down ---- */

/* The poles of every region, those of independent parts one after the other */
static int add_poles(const struct model *model, int count, struct pole_report **list)
{
	const struct switching *s = model->switching;
	for (int k = 0; k < s->systems; k++) {
		struct pole_report *pole;
		int more = poles_of(model, resolvent_of(&s->system[k]), &pole);
		ENLARGE(*list, (size_t)(count + more) + 1);
		for (int i = 0; i < more; i++)
			(*list)[count++] = pole[i];
	}
	return count;
}

static struct band band_of_regions(const struct model *model, int rows)
{
	const struct switching *s = model->switching;
	struct pole_report *pole = NULL;
	int count = s->parts ? 0 : add_poles(model, 0, &pole);
	for (int p = 0; p < s->parts; p++)
		count = add_poles(s->part[p].model, count, &pole);
	return band_of_poles(count, pole, rows);
}

/* Up in full lines, down in broken ones; columns 2 to 5 are of the first: up, its angle, down, its angle */
static const char *sweep_curves(const struct sweeps *s, int first, int last, int angle)
{
	const char *text = "plot ";
	for (int k = first; k < last && k - first < CURVES; k++)
		for (int down = 0; down < 2; down++)
			text = format("%s%s using 1:%d %s title %s", text, k > first || down ? ", ''" : "$frf",
				      4 * k + 2 * down + 2 + angle,
				      curve(k - first, down ? "(12,6)" : "1", s->band.count),
				      quoted(format("%s%s", s->of[k].output, down ? ", down" : "")));
	return text;
}

static void plot_sweeps(struct picture *p)
{
	struct sweeps s = sweeps_of(p->step, p->step->shown->model->switching
			? band_of_regions(p->step->shown->model, POINTS / 3 + 1) : (struct band){ 0 },
			amplitude_of(p->amplitude));
	int drives = 0;
	fputs("$frf << END\n", p->data);
	print_rows(p->data, &s.band, s.count, 2, s.size, s.angle, ' ');
	fputs("END\n", p->data);
	for (int first = 0, last; first < s.count; first = last, drives++) {
		for (last = first; last < s.count && s.of[last].drive_index == s.of[first].drive_index; last++)
			;
		note_first(last - first < CURVES ? last - first : CURVES, last - first, "outputs");
		if (drives < DRIVES)
			add_size_and_angle(p, frame_of(&s.band), format("outputs over %s, swept with amplitude %s",
						labelled(p->step->shown->model, s.of[first].drive), p->amplitude),
					   sweep_curves(&s, first, last, 0), sweep_curves(&s, first, last, 1));
	}
	note_first(drives < DRIVES ? drives : DRIVES, drives, "inputs and loads");
}

static void plot_frf(struct picture *p)
{
	if (p->amplitude) {
		plot_sweeps(p);
		return;
	}
	need_linear(p->step, "frequency responses");
	struct pole_report *pole;
	int count = poles_of(p->step->model, p->step->written, &pole), drives = 0;
	struct responses r = responses_of(p->step, band_of_poles(count, pole, 2 * POINTS / 3 + 1));
	fputs("$frf << END\n", p->data);
	print_rows(p->data, &r.band, r.count, 1, &r.size, &r.angle, ' ');
	fputs("END\n", p->data);
	for (int first = 0, last; first < r.count; first = last, drives++) {
		last = first;
		while (last < r.count && r.transfer[last].drive == r.transfer[first].drive)
			last++;
		if (drives < DRIVES)
			add_bode(p, &r, first, last);
	}
	note_first(drives < DRIVES ? drives : DRIVES, drives, "inputs and loads");
}

/* ---- responses in time ---- */

/* Ten periods of the slowest that oscillates, or five time constants of the slowest that decays, whichever is longer,
 * of poles and loads; without any 100 steps; to two digits */
static double span_of(const struct step *step)
{
	const struct linear *system = &step->shown->model->system;
	struct pole_report *pole;
	int count = poles_of(step->model, step->written, &pole);
	double span = 0, two_pi = 6.283185307179586;
	for (int i = 0; i < count; i++) {
		double re = fabs(mpfr_get_d(pole[i].re, MPFR_RNDN)), im = fabs(mpfr_get_d(pole[i].im, MPFR_RNDN));
		span = fmax(span, im > 0 ? 10 * two_pi / im : re > 0 ? 5 / re : 0);
	}
	for (int l = 0; l < system->loads; l++) {
		double w = fabs(mpq_get_d(system->load[l].forcing->w));
		if (w > 0)
			span = fmax(span, fmin(5 * two_pi / w, span > 0 ? 10 * span : HUGE_VAL));
	}
	span = span > 0 ? span : 100 * mpq_get_d(step->shown->model->h);
	double unit = pow(10, floor(log10(span)) - 1);
	return ceil(span / unit) * unit;
}

/* Samples are at so many steps, or so many to a step: those of --solution are among them, or they among those */
static unsigned long interval_of_samples(const struct model *model, double span, mpq_ptr interval)
{
	double h = mpq_get_d(model->h), steps = span / h;
	RATIONAL factor = ZERO;
	if (steps >= POINTS)
		mpq_set_d(factor, fmin(ceil(steps / POINTS), 1e15));
	else
		mpq_set_ui(factor, 1, (unsigned long)fmin(ceil(POINTS / steps), 1e9));
	mpq_mul(interval, model->h, factor);
	return (unsigned long)fmin(ceil(span / mpq_get_d(interval)), 4 * POINTS);
}

static void need_responses(const struct step *step)
{
	const struct model *model = step->shown->model;
	if (model->switching || has_remainder(step))
		error(model->request.at.step, "plrun --plot draws a run of any model",
		      "the model is not linear: its response has no closed form that could be drawn");
	if (model->system.inputs)
		error(model->request.at.step, "plrun --plot draws a run with a record",
		      "the model has inputs, whose samples are not known: its response cannot be drawn");
}

static void add_response(struct picture *p, int sheet, int output, int column, bool last)
{
	add_row(p, sheet, last ? 190 : 150, format(
		"set key off\nset lmargin 12\nset rmargin 4\nset ylabel %s\nset format y '%%.5g'\nset tmargin 1\n"
		"set autoscale xfix\n%splot $response using 1:%d with lines lw 1.4 lc rgb '%s'\n",
		quoted(labelled(p->step->shown->model, p->step->shown->model->output[output].name)),
		last ? "set xlabel 't [s]'\n" : "set bmargin 1.6\n", column, picture_curve[0].colour));
}

static void print_samples(struct picture *p, int count, const int *output)
{
	const struct model *model = p->step->shown->model;
	struct resolvent *r = resolvent_of(&model->system);
	struct started **form = ARRAY(struct started *, count);
	int *forms = ARRAY(int, count);
	RATIONAL t = ZERO, interval = ZERO;
	unsigned long last = interval_of_samples(model, span_of(p->step), interval);
	for (int i = 0; i < count; i++)
		forms[i] = responses_of_output(r, &model->system, model->initial, &model->output[output[i]], &form[i]);
	fputs("$response << END\n", p->data);
	for (unsigned long k = 0; k <= last; k++) {
		progress("row", (int)k, (int)last);
		fprintf(p->data, "%.17g", nearest_double(t));
		for (int i = 0; i < count; i++)
			fprintf(p->data, " %.17g", started_value(forms[i], form[i], t, false, model->request.at.step,
								 model->output[output[i]].name).value);
		fputc('\n', p->data);
		mpq_add(t, t, interval);
	}
	progress_end();
	fputs("END\n", p->data);
}

static void plot_response(struct picture *p)
{
	const struct model *model = p->step->shown->model;
	int *output = ARRAY(int, model->outputs + 1), count = 0, reported = 0;
	need_responses(p->step);
	check_pole_size(model, p->step->written);
	for (int i = 0; i < model->outputs; i++)
		if (is_reported(&model->output[i]) && reported++ < OUTPUTS)
			output[count++] = i;
	note_first(count, model->outputs, "outputs");
	bool single = strcmp(target_name(), "float") == 0;
	target_double();                /* what --solution prints */
	print_samples(p, count, output);
	if (single)
		target_float();
	for (int i = 0; i < count * p->sheets; i++)
		add_response(p, i / count, output[i % count], i % count + 2, i % count == count - 1);
}

/* ---- a picture ---- */

static const struct kind {
	const char *name;
	void (*plot)(struct picture *p);
} kinds[] = { { "response", plot_response }, { "poles", plot_poles }, { "modes", plot_modes }, { "frf", plot_frf } };

static const struct kind *kind_of(const char *name, size_t length)
{
	for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
		if (strlen(kinds[i].name) == length && strncmp(kinds[i].name, name, length) == 0)
			return &kinds[i];
	return NULL;
}

const char *wrong_picture(const char *list)
{
	for (;; list++) {
		size_t length = strcspn(list, ",");
		if (!kind_of(list, length))
			return format("%.*s", (int)length, list);
		list += length;
		if (!*list)
			return NULL;
	}
}

enum picture_format picture_of_file(const char *path)
{
	static const char *const ending[] = { [PICTURE_SVG] = ".svg", [PICTURE_PNG] = ".png", [PICTURE_PDF] = ".pdf",
						[PICTURE_CSV] = ".csv", [PICTURE_JSON] = ".json" };
	size_t length = path ? strlen(path) : 0;
	if (!path)
		return PICTURE_SVG;
	for (int i = PICTURE_SVG; i <= PICTURE_JSON; i++)
		if (length > strlen(ending[i]) && strcmp(path + length - strlen(ending[i]), ending[i]) == 0)
			return (enum picture_format)i;
	return PICTURE_NONE;
}

/* What stands before the names inside of it, so that pictures of one page have names of their own */
static const char *name_of(const char *list)
{
	const char *name = "";
	for (; *list; list++)
		name = format("%s%c", name, *list == ',' ? '_' : *list);
	return name;
}

static const char *ending_of(enum picture_format as)
{
	return as == PICTURE_PDF ? "pdf" : as == PICTURE_PNG ? "png" : "svg";
}

void begin_picture(FILE *to, const struct picture_look *look, enum picture_format as, int width, int height,
		   const char *name)
{
	const struct picture_inks *inks = picture_inks_of(look);
	const double letters = picture_terminal(to, look, ending_of(as), width, height, name_of(name));
	fprintf(to, "ink = '%s'\nframe = '%s'\nfaint = '%s'\nsmall = ',%.1f'\n", inks->text, inks->frame, inks->faint,
		0.85 * letters);
}

static void print_panels(FILE *to, const struct picture *p, int sheet)
{
	const double wide = p->width[sheet], tall = p->height[sheet];
	int titled = 0;
	fprintf(to, "set multiplot\n");
	for (int i = 0; i < p->panels; i++) {
		const struct panel *panel = &p->panel[i];
		if (panel->sheet != sheet)
			continue;
		fputs("reset\n", to);
		picture_colours(to, p->look);
		if (!titled && p->look->title)
			titled = picture_heading(to, p->look, p->look->title, 0, wide, tall);
		fprintf(to, "set origin %.6f,%.6f\nset size %.6f,%.6f\n%s", panel->left / wide,
			1 - (panel->top + panel->height) / tall, panel->width / wide, panel->height / tall,
			panel->text);
	}
	fputs("unset multiplot\n", to);
}

bool has_frf(const char *list)
{
	for (; *list; list += *list == ',') {
		if (kind_of(list, strcspn(list, ","))->plot == plot_frf)
			return true;
		list += strcspn(list, ",");
	}
	return false;
}

static struct picture picture_of(const struct step *step, const char *list, const char *amplitude,
				 const struct picture_look *look, int sheets)
{
	const double width = look->width > 0 ? picture_points(look, look->width)
			   : look->paper ? PICTURE_COLUMN : PICTURE_WIDE;
	struct picture p = { .step = step, .amplitude = amplitude, .look = look, .data = new_script(),
			     .sheets = sheets, .width = { (int)width, NARROW } };
	if (look->title)
		p.height[0] = 10 + PICTURE_LINE * picture_heading_lines(look->title, width);
	const int begun = p.height[0];
	for (const char *name = list; *name; name += *name == ',') {
		size_t length = strcspn(name, ",");
		kind_of(name, length)->plot(&p);
		name += length;
	}
	if (p.height[0] == begun)
		error(step->model->request.at.step, NULL,
		      "there is nothing to draw: no output that is linear reacts to an input or a load");
	return p;
}

static void draw_sheet(FILE *to, const struct picture *p, int sheet, enum picture_format as, const char *name)
{
	FILE *script = new_script();
	const int tall = p->look->height > 0 ? (int)picture_points(p->look, p->look->height) : p->height[sheet];
	begin_picture(script, p->look, as, p->width[sheet], tall, name);
	copy_file(p->data, script);
	print_panels(script, p, sheet);
	draw(to, script);
	fclose(script);
}

void print_picture(FILE *to, const struct step *step, const char *list, const char *amplitude,
		   const struct picture_look *look, enum picture_format as)
{
	struct picture p = picture_of(step, list, amplitude, look, 1);
	draw_sheet(to, &p, 0, as, list);
	fclose(p.data);
}

/* Without what stands before it in a file of its own: <?xml ...?> and <!DOCTYPE ...> */
static void put_in_page(FILE *to, FILE *picture, const char *class)
{
	bool inside = false;
	rewind(picture);
	fprintf(to, "<figure class=\"%s\">\n", class);
	for (char line[4096]; fgets(line, sizeof line, picture);) {
		inside = inside || strncmp(line, "<svg", 4) == 0;
		if (inside)
			fputs(line, to);
	}
	fputs("</figure>\n", to);
	fclose(picture);
}

/* Whose title is that of the page */
void picture_in_page(FILE *to, const struct step *step, const char *kind, bool dark)
{
	const struct picture_look look = { .dark = dark };
	static const char *const class[SHEETS] = { "broad", "narrow" };
	struct picture p = picture_of(step, kind, NULL, &look, SHEETS);
	for (int sheet = 0; sheet < SHEETS; sheet++) {
		FILE *picture = new_script();
		draw_sheet(picture, &p, sheet, PICTURE_SVG, format("%s,%s", kind, class[sheet]));
		put_in_page(to, picture, class[sheet]);
	}
	fclose(p.data);
}
