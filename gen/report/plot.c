/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures of a model as scripts for gnuplot: panels below each other, or beside. All numbers are in the script, those
 * of frf as --response prints them, those of response as --solution does. No dates, no paths. */
#include "model/regions/regions.h"
#include "report/report.h"
#include "step/linear/images.h"

#include <math.h>
#include <string.h>

enum { WIDTH = 900, CURVES = 8, DRIVES = 6, OUTPUTS = 12, SHAPES = 12, POINTS = 600 };

struct panel {
	int left, top, width, height;   /* in points of a screen */
	const char *text;               /* commands */
};
struct picture {
	const struct step *step;
	const char *amplitude;          /* of an excitation that sweeps; NULL: frequency responses are linear */
	FILE *data;                     /* $name << END ... */
	int panels, height;
	struct panel *panel;
};

/* ---- panels ---- */

static void add_panel(struct picture *p, int left, int width, int height, const char *text)
{
	*MORE(p->panel, p->panels) = (struct panel){ left, p->height, width, height, text };
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

/* ---- poles ---- */

/* 0, and their largest sizes */
static void window_of_poles(int count, const struct pole_report *pole, double *left, double *right, double *high)
{
	*left = *right = *high = 0;
	for (int i = 0; i < count; i++) {
		double re = mpfr_get_d(pole[i].re, MPFR_RNDN), im = fabs(mpfr_get_d(pole[i].im, MPFR_RNDN));
		*left = fmin(*left, re);
		*right = fmax(*right, re);
		*high = fmax(*high, im);
	}
	double wide = fmax(-*left, *right);
	*high = *high > 0 ? 1.25 * *high : wide > 0 ? wide : 1;
	wide = wide > 0 ? wide : 0.1 * *high;
	*left = *left < 0 ? 1.25 * *left : -wide;
	*right = *right > 0 ? 1.25 * *right : 0.2 * wide;
}

/* Poles of one damping ratio lie on a ray: im = re sqrt(1 - z^2)/z; to the edge of the window */
static const char *rays_of(double left, double high)
{
	static const double ratio[] = { 0.0001, 0.0002, 0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.3,
					0.4, 0.5, 0.6, 0.7, 0.8, 0.9 };
	const char *text = "";
	double before = HUGE_VAL;
	for (size_t i = 0; i < sizeof ratio / sizeof *ratio; i++) {
		double slope = sqrt(1 - ratio[i] * ratio[i]) / ratio[i], turn = -left * slope / high;
		double x = turn > 1 ? -high / slope : left, y = turn > 1 ? high : -left * slope;
		if (turn > 8 || turn < 0.12 || before < 1.7 * turn)
			continue;
		before = turn;
		for (int side = 1; side >= -1; side -= 2)
			text = format("%sset arrow from 0,0 to %.10g,%.10g nohead lc rgb '#c8c8c8' lw 0.8\n", text, x,
				      side * y);
		text = format("%sset label '%g' at %.10g,%.10g %s tc rgb '#808080'\n", text, ratio[i], x, y,
			      turn > 1 ? "center offset 0,0.5" : "left offset 0.5,0.7");
	}
	return text;
}

/* Each with its frequency, where that does not stand on another's */
static void print_poles(FILE *to, int count, const struct pole_report *pole, double high)
{
	double reported = HUGE_VAL;
	fputs("$poles << END\n", to);
	for (int i = count - 1; i >= 0; i--) {
		double re = mpfr_get_d(pole[i].re, MPFR_RNDN), im = mpfr_get_d(pole[i].im, MPFR_RNDN);
		const char *text = "";
		if (reported - im > 0.08 * high || i == count - 1) {
			text = format("%.4g Hz%s", mpfr_get_d(pole[i].hertz, MPFR_RNDN),
				      pole[i].multiplicity > 1 ? format(", %d-fold", pole[i].multiplicity) : "");
			reported = im;
		}
		fprintf(to, "%.17g %.17g \"%s\"\n", re, im, text);
		if (pole[i].pair)
			fprintf(to, "%.17g %.17g \"\"\n", re, -im);
	}
	fputs("END\n", to);
}

static void plot_poles(struct picture *p)
{
	struct pole_report *pole;
	double left, right, high;
	need_linear(p->step, "poles");
	int count = poles_of(p->step->model, p->step->written, &pole);
	window_of_poles(count, pole, &left, &right, &high);
	print_poles(p->data, count, pole, high);
	add_panel(p, 0, WIDTH, 480, format(
		"set title 'poles, and rays of equal damping ratio'\nunset key\nset lmargin 12\nset rmargin 5\n"
		"set tmargin 3.4\n"
		"set xlabel 're [1/s]'\nset ylabel 'im [rad/s]'\nset xzeroaxis lt 1 lc rgb '#606060'\n"
		"set yzeroaxis lt 1 lc rgb '#606060'\n%s"
		"plot [%.10g:%.10g] [%.10g:%.10g] $poles using 1:2 with points pt 2 ps 1.2 lw 2 lc rgb '#b03020', "
		"'' using 1:2:3 with labels left offset 0.8,0.4 font ',9'\n",
		rays_of(left, high), left, right, -high, high));
	p->height += 480;
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

static void add_shape(struct picture *p, const struct model *model, const struct mode_shape *shape, int k, int shapes)
{
	enum { TALL = 210 };
	bool twofold = is_complex(shape, model->n);
	int columns = shapes < 3 ? shapes : 3, wide = WIDTH / columns;
	double hertz = mpfr_get_d(shape->pole->hertz, MPFR_RNDN);
	double ratio = mpfr_get_d(shape->pole->damping_ratio, MPFR_RNDN);
	fprintf(p->data, "$shape%d << END\n", k + 1);
	for (int i = 0; i < model->n; i++)
		fprintf(p->data, "%d %.17g %.17g\n", i + 1, shape->re[i], shape->im[i]);
	fputs("END\n", p->data);
	add_panel(p, k % columns * wide, wide, TALL, format(
		"set title '%.5g Hz, damping ratio %.3g'\nset lmargin 7\nset rmargin 2\nset xzeroaxis lt 1 lc rgb "
		"'#606060'\nset ytics 0.5\n%s%splot [0.5:%d.5] [-1.15:1.15] $shape%d using 1:2 with linespoints pt 7 "
		"ps 0.6 lw 1.6 lc rgb '#1f5fa8' title 're'%s\n", hertz, ratio, twofold ? "" : "unset key\n",
		coordinate_tics(model, 15 / columns), model->n, k + 1,
		twofold ? ", '' using 1:3 with linespoints pt 6 ps 0.6 dt 2 lc rgb '#b03020' title 'im'" : ""));
	if (k % columns == columns - 1 || k == shapes - 1)
		p->height += TALL;
}

static void plot_modes(struct picture *p)
{
	const struct model *of;
	struct mode_shape *shape;
	need_linear(p->step, "mode shapes");
	int count = shapes_of_step(p->step, &shape, &of);
	int shown = count < SHAPES ? count : SHAPES;
	if (of->system.n > LIMIT_SHAPES)
		error(of->asked.step_at, NULL, "the model has %d coordinates: mode shapes are limited to %d",
		      of->system.n, LIMIT_SHAPES);
	note_first(shown, count, "mode shapes");
	for (int k = 0; k < shown; k++)
		add_shape(p, of, &shape[k], k, shown);
}

/* ---- frequency responses ---- */

static const char *const colour[CURVES] = { "#1f5fa8", "#b03020", "#2e8b57", "#c08000", "#7040a0", "#008b8b", "#a05050",
					    "#505050" };

/* The curves of one drive: those that are not 0; column 2, 4, ... of the data are sizes, after each an angle */
static const char *curves(const struct responses *r, const char *data, int first, int last, int angle, int *count)
{
	const char *text = "";
	*count = 0;
	for (int k = first; k < last; k++) {
		if (r->transfer[k].N.length == 0)
			continue;
		if (*count < CURVES)
			text = format("%s%s using 1:%d with lines lw 1.6 lc rgb '%s' title %s", text,
				      *text ? ", ''" : format("plot %s", data), 2 * k + 2 + angle, colour[*count],
				      quoted(r->transfer[k].output));
		++*count;
	}
	return text;
}

static const char *frame_of(const struct band *band)
{
	return format("set logscale x\nset xrange [%.10g:%.10g]\nset lmargin 12\nset rmargin 20\nset key "
		      "outside right top\nset format y '%%.3g'\n", band->from, band->to);
}

static void add_size_and_angle(struct picture *p, const char *frame, const char *title, const char *size,
			       const char *angle)
{
	add_panel(p, 0, WIDTH, 270, format("%sset title %s\nset logscale y\nset format x ''\nset ylabel 'magnitude'\n"
					   "set bmargin 0.6\n%s\n", frame, quoted(title), size));
	p->height += 270;
	add_panel(p, 0, WIDTH, 190, format("%sset key off\nset tmargin 0.6\nset ylabel 'phase [deg]'\nset ytics 90\n"
					   "set xlabel 'f [Hz]'\n%s\n", frame, angle));
	p->height += 190;
}

static void add_bode(struct picture *p, const struct responses *r, int first, int last)
{
	int count, angles;
	const char *size = curves(r, "$frf", first, last, 0, &count);
	const char *angle = curves(r, "$frf", first, last, 1, &angles);
	const char *frame = frame_of(&r->band);
	note_first(count < CURVES ? count : CURVES, count, "outputs");
	if (count == 0)
		return;
	add_size_and_angle(p, frame, format("outputs over %s", r->transfer[first].drive), size, angle);
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
			text = format("%s%s using 1:%d with lines lw 1.6 %slc rgb '%s' title %s", text,
				      k > first || down ? ", ''" : "$frf", 4 * k + 2 * down + 2 + angle,
				      down ? "dt 2 " : "", colour[k - first],
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
	for (int row = 0; row < s.band.count; row++) {
		fprintf(p->data, "%.17g", frequency_of(&s.band, row));
		for (int k = 0; k < s.count; k++)
			for (int down = 0; down < 2; down++)
				fprintf(p->data, " %.12g %.12g", s.size[down][row * s.count + k],
					s.angle[down][row * s.count + k]);
		fputc('\n', p->data);
	}
	fputs("END\n", p->data);
	for (int first = 0, last; first < s.count; first = last, drives++) {
		for (last = first; last < s.count && s.of[last].drive_index == s.of[first].drive_index; last++)
			;
		note_first(last - first < CURVES ? last - first : CURVES, last - first, "outputs");
		if (drives < DRIVES)
			add_size_and_angle(p, frame_of(&s.band), format("outputs over %s, swept with amplitude %s",
									s.of[first].drive, p->amplitude),
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
	for (int row = 0; row < r.band.count; row++) {
		fprintf(p->data, "%.17g", frequency_of(&r.band, row));
		for (int k = 0; k < r.count; k++)
			fprintf(p->data, " %.17g %.17g", r.size[row * r.count + k], r.angle[row * r.count + k]);
		fputc('\n', p->data);
	}
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
		double w = fabs(mpq_get_d(system->load[l].wave->w));
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
		error(model->asked.step_at, "plrun --plot draws a run of any model",
		      "the model is not linear: its response has no closed form that could be drawn");
	if (model->system.inputs)
		error(model->asked.step_at, "plrun --plot draws a run with a record",
		      "the model has inputs, whose samples are not known: its response cannot be drawn");
}

static void add_response(struct picture *p, int output, int column, bool last)
{
	int tall = last ? 190 : 150;
	add_panel(p, 0, WIDTH, tall, format(
		"set key off\nset lmargin 12\nset rmargin 4\nset ylabel %s\nset format y '%%.3g'\nset tmargin 1\n"
		"set autoscale xfix\n%splot $response using 1:%d with lines lw 1.4 lc rgb '#1f5fa8'\n",
		quoted(p->step->shown->model->output[output].name),
		last ? "set xlabel 't [s]'\n" : "set bmargin 1.6\n", column));
	p->height += tall;
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
			fprintf(p->data, " %.17g", started_value(forms[i], form[i], t, false, model->asked.step_at,
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
	for (int i = 0; i < count; i++)
		add_response(p, output[i], i + 2, i == count - 1);
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

void print_terminal(FILE *to, enum picture_format as, int height, const char *name)
{
	if (as == PICTURE_PDF)
		fprintf(to, "set term pdfcairo noenhanced size 9in,%.2fin font 'sans,10'\n", height / 100.0);
	else if (as == PICTURE_PNG)
		fprintf(to, "set term pngcairo noenhanced size %d,%d font 'sans,11' background '#ffffff'\n", WIDTH,
			height);
	else
		fprintf(to, "set term svg noenhanced size %d,%d font 'sans,12' background '#ffffff' name \"%s\"\n",
			WIDTH, height, name_of(name));
}

static void print_panels(FILE *to, const struct picture *p)
{
	fprintf(to, "set multiplot\n");
	for (int i = 0; i < p->panels; i++) {
		const struct panel *panel = &p->panel[i];
		fprintf(to, "reset\nset encoding utf8\nset grid lt 1 lc rgb '#e4e4e4'\nset border lc rgb '#606060'\n"
			    "set origin %.6f,%.6f\nset size %.6f,%.6f\n%s", (double)panel->left / WIDTH,
			1 - (double)(panel->top + panel->height) / p->height, (double)panel->width / WIDTH,
			(double)panel->height / p->height, panel->text);
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

void print_picture(FILE *to, const struct step *step, const char *list, const char *amplitude, enum picture_format as)
{
	struct picture p = { .step = step, .amplitude = amplitude, .data = new_script() };
	FILE *script = new_script();
	for (const char *name = list; *name; name += *name == ',') {
		size_t length = strcspn(name, ",");
		kind_of(name, length)->plot(&p);
		name += length;
	}
	if (p.height == 0)
		error(step->model->asked.step_at, NULL,
		      "there is nothing to draw: no output that is linear reacts to an input or a load");
	print_terminal(script, as, p.height, list);
	copy_file(p.data, script);
	print_panels(script, &p);
	draw(to, script);
	fclose(p.data);
	fclose(script);
}

/* Without what stands before it in a file of its own: <?xml ...?> and <!DOCTYPE ...> */
void picture_in_page(FILE *to, const struct step *step, const char *kind)
{
	FILE *picture = new_script();
	bool inside = false;
	print_picture(picture, step, kind, NULL, PICTURE_SVG);
	rewind(picture);
	fputs("<figure>\n", to);
	for (char line[4096]; fgets(line, sizeof line, picture);) {
		inside = inside || strncmp(line, "<svg", 4) == 0;
		if (inside)
			fputs(line, to);
	}
	fputs("</figure>\n", to);
	fclose(picture);
}
