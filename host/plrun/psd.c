/* SPDX-License-Identifier: GPL-3.0-or-later */
/* --psd: power spectral densities by Welch's method (IEEE Trans. Audio Electroacoust. 15, 1967). A run is cut into
 * segments of 2^n steps that overlap; each less its mean, times a window, is transformed, and squares are averaged. A
 * density is one-sided: its sum over frequencies times their distance is the mean square about the mean. Segments are
 * treated as the run goes on, so that a run of any length takes the memory of one. */
#define _GNU_SOURCE
#include "plrun.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LEAST = 16, LONGEST_SEGMENT = 1 << 20, AVERAGES = 8 };
#define TWO_PI 6.283185307179586476925

/* a[0] - a[1] cos(x) + a[2] cos(2 x) ..., x = 2 pi j/L: Harris, Proc. IEEE 66, 1978; the flat top: D'Antona and
 * Ferrero, Digital Signal Processing for Measurement Systems, 2006 */
static const struct cosines {
	const char *name, *text;
	double a[5];
} windows[] = {
	{ "hann", "Hann", { 0.5, 0.5 } },
	{ "hamming", "Hamming", { 0.54, 0.46 } },
	{ "blackman", "Blackman", { 0.42, 0.5, 0.08 } },
	{ "flattop", "flat top", { 0.21557895, 0.41663158, 0.277263158, 0.083578947, 0.006947368 } },
	{ "boxcar", "rectangular", { 1 } }
};
enum { WINDOWS = sizeof windows / sizeof *windows };

struct psd {
	const struct machine *machine;
	const struct cosines *kind;
	double h;
	size_t length, shift, rows, segments;   /* shift: from one segment to the next; rows: those that were seen */
	double *window, squares;                /* sum of w^2 */
	double *turn;                           /* cos, sin of 2 pi j/L, j < L/2 */
	double *kept;                           /* the last `length` rows, as a ring */
	double *work;                           /* re, im */
	double *power;                          /* columns x (length/2 + 1): sums of |X|^2 */
	double *first, *last;                   /* per column: mean squares of the first and the last segment */
};

/* ---- the option ---- */

static _Noreturn void wrong_window(const char *text, const char *why)
{
	const char *names = "";
	for (int i = 0; i < WINDOWS; i++)
		names = format("%s%s%s", names, i ? ", " : "", windows[i].name);
	wrong_usage(format("--psd takes WINDOW[:STEPS[:PERCENT]], found '%s': %s", text, *why ? why
			   : format("windows are %s", names)));
}

bool is_window(const char *text)
{
	for (int i = 0; text && i < WINDOWS; i++)
		if (strlen(windows[i].name) == strcspn(text, ":") &&
		    strncmp(windows[i].name, text, strcspn(text, ":")) == 0)
			return true;
	return false;
}

void read_window(struct options *o, const char *text)
{
	const char *steps = text ? strchr(text, ':') : NULL, *percent = steps ? strchr(steps + 1, ':') : NULL;
	double value = 0;
	o->window = windows;
	o->overlap = 0.5;
	if (text && !is_window(text))
		wrong_window(text, "");
	for (int i = 0; text && i < WINDOWS; i++)
		if (strncmp(windows[i].name, text, strcspn(text, ":")) == 0 &&
		    strlen(windows[i].name) == strcspn(text, ":"))
			o->window = &windows[i];
	if (steps && !read_number(percent ? strndup(steps + 1, (size_t)(percent - steps - 1)) : steps + 1, &value))
		wrong_window(text, "STEPS is a number");
	if (steps && (value < LEAST || value > LONGEST_SEGMENT || exp2(floor(log2(value))) != value))
		wrong_window(text, format("a segment is a power of two of steps, from %d to %d", LEAST,
					  LONGEST_SEGMENT));
	o->segment = (unsigned long)value;
	if (percent && (!read_number(percent + 1, &o->overlap) || o->overlap < 0 || o->overlap > 95))
		wrong_window(text, "segments overlap by 0 to 95 percent");
	o->overlap = percent ? o->overlap / 100 : o->overlap;
}

/* ---- a segment ---- */

static void fill_tables(struct psd *p)
{
	const double part = TWO_PI / (double)p->length;
	for (size_t j = 0; j < p->length; j++) {
		const double *a = p->kind->a, x = part * (double)j;
		p->window[j] = a[0] - a[1] * cos(x) + a[2] * cos(2 * x) - a[3] * cos(3 * x) + a[4] * cos(4 * x);
		p->squares += p->window[j] * p->window[j];
	}
	for (size_t j = 0; j < p->length / 2; j++) {
		p->turn[2 * j] = cos(part * (double)j);
		p->turn[2 * j + 1] = sin(part * (double)j);
	}
}

/* As many segments as a mean of eight takes, unless it is said how long they are */
static size_t segment_of(const struct options *o, uint64_t rows)
{
	size_t length = LEAST;
	if (o->segment)
		length = o->segment;
	while (!o->segment && length < LONGEST_SEGMENT &&
	       (double)rows >= 2 * (double)length * (1 + (AVERAGES - 1) * (1 - o->overlap)))
		length *= 2;
	if (rows < length)
		fail(WRONG_DATA, format("--psd: a segment of %zu steps is longer than the run, which has %llu rows",
					length, (unsigned long long)rows));
	return length;
}

struct psd *psd_new(const struct machine *m, const struct options *o, double h, uint64_t steps)
{
	struct psd *p = need(calloc(1, sizeof *p));
	const size_t length = segment_of(o, steps + 1), columns = (size_t)m->outputs;
	const size_t overlap = (size_t)((double)length * o->overlap);
	*p = (struct psd){ .machine = m, .kind = o->window, .h = h, .length = length, .shift = length - overlap };
	p->window = need(calloc(length * (4 + columns), sizeof *p->window));
	p->turn = p->window + length;
	p->work = p->turn + length;
	p->kept = need(calloc(length * columns + 1, sizeof *p->kept));
	p->power = need(calloc((length / 2 + 1) * columns + 2 * columns + 1, sizeof *p->power));
	p->first = p->power + (length / 2 + 1) * columns;
	p->last = p->first + columns;
	fill_tables(p);
	return p;
}

/* x, `length` complex numbers, becomes its transform: radix 2, the order of bits reversed first */
static void transform(const struct psd *p, double *x)
{
	const size_t n = p->length;
	for (size_t i = 1, j = 0; i < n; i++) {
		for (size_t bit = n >> 1; (j ^= bit) < bit;)
			bit >>= 1;
		for (int part = 0; i < j && part < 2; part++) {
			const double kept = x[2 * i + (size_t)part];
			x[2 * i + (size_t)part] = x[2 * j + (size_t)part];
			x[2 * j + (size_t)part] = kept;
		}
	}
	for (size_t half = 1; half < n; half *= 2)
		for (size_t i = 0; i < n; i += 2 * half)
			for (size_t k = 0; k < half; k++) {
				double *low = x + 2 * (i + k), *high = low + 2 * half;
				const double c = p->turn[2 * (k * (n / 2 / half))];
				const double s = -p->turn[2 * (k * (n / 2 / half)) + 1];
				const double re = c * high[0] - s * high[1], im = c * high[1] + s * high[0];
				high[0] = low[0] - re;
				high[1] = low[1] - im;
				low[0] += re;
				low[1] += im;
			}
}

/* Column `i` of the ring, whose oldest row is `oldest` */
static void add_segment(struct psd *p, size_t i, size_t oldest)
{
	const size_t columns = (size_t)p->machine->outputs, n = p->length;
	double mean = 0, square = 0, *power = p->power + i * (n / 2 + 1);
	for (size_t j = 0; j < n; j++)
		mean += p->kept[j * columns + i] / (double)n;
	for (size_t j = 0; j < n; j++) {
		const double value = p->kept[(oldest + j) % n * columns + i] - mean;
		square += value * value / (double)n;
		p->work[2 * j] = value * p->window[j];
		p->work[2 * j + 1] = 0;
	}
	transform(p, p->work);
	for (size_t k = 0; k <= n / 2; k++)
		power[k] += p->work[2 * k] * p->work[2 * k] + p->work[2 * k + 1] * p->work[2 * k + 1];
	if (p->segments == 0)
		p->first[i] = square;
	p->last[i] = square;
}

void psd_add(void *who, uint64_t k, const double *out)
{
	struct psd *p = who;
	const size_t columns = (size_t)p->machine->outputs;
	memcpy(p->kept + (size_t)(k % p->length) * columns, out, columns * sizeof *out);
	p->rows++;
	if (p->rows < p->length || (p->rows - p->length) % p->shift)
		return;
	for (size_t i = 0; i < columns; i++)
		add_segment(p, i, p->rows % p->length);
	p->segments++;
}

/* ---- what is said of them ---- */

static double frequency_of(const struct psd *p, size_t k)
{
	return (double)k / ((double)p->length * p->h);
}

static double density_of(const struct psd *p, size_t column, size_t k)
{
	const double sides = k == 0 || k == p->length / 2 ? 1 : 2;
	return sides * p->power[column * (p->length / 2 + 1) + k] * p->h / (p->squares * (double)p->segments);
}

/* The window, the averaging and the resolution: the width of a line, of equal power (Harris 1978) */
static char *method_of(const struct psd *p)
{
	double sum = 0;
	for (size_t j = 0; j < p->length; j++)
		sum += p->window[j];
	return format("one-sided PSD (Welch): %s, %zu segment%s of %zu steps, overlap %.3g %%, means removed, line "
		      "width %.3g Hz", p->kind->text, p->segments, p->segments == 1 ? "" : "s", p->length,
		      100 * (double)(p->length - p->shift) / (double)p->length,
		      (double)p->length * p->squares / (sum * sum) * frequency_of(p, 1));
}

/* Where a spectrum says less than it seems to */
static void say_limits(const struct psd *p)
{
	const size_t used = p->length + (p->segments - 1) * p->shift;
	if (p->rows > used)
		say_note(format("the last %zu of %zu rows are in no segment", p->rows - used, p->rows));
	if (p->kind->a[1] == 0)
		say_note("a rectangular window leaks: a line that is no whole number of periods in a segment spreads "
			 "over all frequencies; hann does not");
	for (int i = 0; i < p->machine->outputs; i++) {
		const char *name = p->machine->output_names[i];
		size_t most = 0;
		for (size_t k = 0; k <= p->length / 2; k++)
			if (density_of(p, (size_t)i, k) > density_of(p, (size_t)i, most))
				most = k;
		if (p->last[i] < p->first[i] / 4 || p->last[i] > 4 * p->first[i])
			say_note(format("the motion of '%s' is not a steady one: its mean square is %.2g in the first "
					"segment and %.2g in the last", name, p->first[i], p->last[i]));
		if (most < 3 && density_of(p, (size_t)i, most) > 0)
			say_note(format("the spectrum of '%s' is largest below %.2g Hz: segments of %.3g s are too "
					"short for the lowest frequencies", name, frequency_of(p, 3),
					(double)p->length * p->h));
	}
}

void psd_print(FILE *to, const struct psd *p, const struct options *o)
{
	const struct view *v = p->machine->view;
	char text[LONGEST];
	if (p->segments == 0)           /* the run ended early, and says why */
		return;
	say_note(method_of(p));
	say_limits(p);
	fputs("f", to);
	for (int i = 0; i < p->machine->outputs; i++)
		fprintf(to, ",psd %s", o->units ? psd_label(v, &(struct panel){ -1, 1, { i } }) : v->name[i]);
	for (size_t k = 0; k <= p->length / 2; k++) {
		*put_shortest(text, frequency_of(p, k), false) = 0;
		fprintf(to, "\n%s", text);
		for (int i = 0; i < p->machine->outputs; i++) {
			*put_shortest(text, density_of(p, (size_t)i, k), false) = 0;
			fprintf(to, ",%s", text);
		}
	}
	putc('\n', to);
}

/* Without frequency 0, which the means are taken from; both axes are logarithmic unless --log says which */
void psd_draw(const struct psd *p, const struct options *o)
{
	const struct view *v = p->machine->view;
	if (p->segments == 0)
		return;
	struct script *s = script_new(&o->look, o->plot_file, p->machine->name, method_of(p));
	FILE *data = script_data(s);
	const bool log_x = o->look.log_x || !o->look.log, log_y = o->look.log_y || !o->look.log;
	fputs("$data << END\n", data);
	for (size_t k = 1; k <= p->length / 2; k++) {
		fprintf(data, "%.10g", frequency_of(p, k));
		for (int i = 0; i < p->machine->outputs; i++)
			fprintf(data, " %.10g", density_of(p, (size_t)i, k));
		putc('\n', data);
	}
	fputs("END\n", data);
	for (int i = 0; i < v->panels; i++) {
		const struct panel *panel = &v->panel[i];
		const bool last = i == v->panels - 1;
		FILE *to = script_panel(s, panel_height(v, panel, last));
		fprintf(to, "set xrange [%.10g:%.10g]\nset format y '%%.0e'\n%s", log_x ? frequency_of(p, 1) : 0,
			frequency_of(p, p->length / 2), log_y ? "set logscale y\n" : "");
		if (log_x)
			script_log_tics(to, 'x', frequency_of(p, 1), frequency_of(p, p->length / 2));
		script_label(to, "xlabel", last ? "f [Hz]" : "");
		script_label(to, "ylabel", psd_label(v, panel));
		for (int k = 0; k < panel->curves; k++)
			script_curve(to, k, format("$data using 1:%d", panel->y[k] + 2),
				     panel->curves > 1 ? p->machine->output_names[panel->y[k]] : NULL, p->length / 2);
		putc('\n', to);
	}
	script_draw(s);
}
