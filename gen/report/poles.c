/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The picture of poles: the plane with rays of equal damping ratio, and every pole's frequency beside it, or none. */
#include "host/picture.h"
#include "report/report.h"
#include "step/linear/images.h"

#include <math.h>
#include <stdlib.h>

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
		if (turn > 8 || turn < 0.12 || before < 2 * turn)
			continue;
		before = turn;
		for (int side = 1; side >= -1; side -= 2)
			text = format("%sset arrow from 0,0 to %.10g,%.10g nohead lc rgb faint lw 0.6\n", text, x,
				      side * y);
		text = format("%sset label '%g' at %.10g,%.10g %s tc rgb frame\n", text, ratio[i], x, y,
			      turn > 1 ? "center offset 0,0.5" : "left offset 1.6,0.7");
	}
	return text;
}

/* ---- a pole's frequency ---- */

struct pole_label {
	double re, im, at;              /* at: where its text stands, in im */
	const char *text;
};

static int by_height(const void *a, const void *b)
{
	const struct pole_label *one = a, *other = b;
	return one->im != other->im ? (one->im < other->im ? 1 : -1) : (one->re < other->re) - (one->re > other->re);
}

static struct pole_label *labels_of(int count, const struct pole_report *pole)
{
	struct pole_label *label = ARRAY(struct pole_label, count + 1);
	for (int i = 0; i < count; i++) {
		const char *fold = pole[i].multiplicity > 1 ? format(", %d-fold", pole[i].multiplicity) : "";
		label[i].re = mpfr_get_d(pole[i].re, MPFR_RNDN);
		label[i].im = label[i].at = mpfr_get_d(pole[i].im, MPFR_RNDN);
		label[i].text = format("%.4g Hz%s", mpfr_get_d(pole[i].hertz, MPFR_RNDN), fold);
	}
	qsort(label, (size_t)count, sizeof *label, by_height);
	return label;
}

/* Texts stand in a column beside the plane, each as high as its pole but for the distance that letters take: down from
 * the first, then up from the lowest that would stand below the plane */
static void spread(int count, struct pole_label *label, double high, double apart)
{
	for (int i = 1; i < count; i++)
		label[i].at = fmin(label[i].at, label[i - 1].at - apart);
	if (count > 0)
		label[count - 1].at = fmax(label[count - 1].at, -high + apart / 2);
	for (int i = count - 1; i > 0; i--)
		label[i - 1].at = fmax(label[i - 1].at, label[i].at + apart);
}

/* With a line to each pole; all of them, or none where the column is too short: *none */
static const char *label_poles(int count, struct pole_label *label, double high, int lines, bool *none)
{
	const char *text = "";
	*none = count > lines;
	spread(count, label, high, 2 * high / lines);
	for (int i = 0; i < count && !*none; i++)
		text = format("%sset arrow from %.10g,%.10g to graph 1.02,first %.10g nohead lc rgb faint lw 0.6\n"
			      "set label \"%s\" at graph 1.025,first %.10g left tc rgb ink font small\n", text,
			      label[i].re, label[i].im, label[i].at, label[i].text, label[i].at);
	return text;
}

static void print_poles(FILE *to, int count, const struct pole_report *pole)
{
	fputs("$poles << END\n", to);
	for (int i = count - 1; i >= 0; i--) {
		double re = mpfr_get_d(pole[i].re, MPFR_RNDN), im = mpfr_get_d(pole[i].im, MPFR_RNDN);
		fprintf(to, "%.17g %.17g\n", re, im);
		if (pole[i].pair)
			fprintf(to, "%.17g %.17g\n", re, -im);
	}
	fputs("END\n", to);
}

const char *draw_poles(FILE *data, const struct step *step, int lines)
{
	struct pole_report *pole;
	double left, right, high;
	bool none;
	int count = poles_of(step->model, step->written, &pole);
	window_of_poles(count, pole, &left, &right, &high);
	print_poles(data, count, pole);
	const char *labels = label_poles(count, labels_of(count, pole), high, lines, &none);
	return format(
		"set title 'poles, and rays of equal damping ratio%s'\nunset key\nset lmargin 9\nset rmargin %d\n"
		"set tmargin 3.4\nset xlabel 're [1/s]'\nset ylabel 'im [rad/s]'\nset xzeroaxis lt 1 lc rgb frame\n"
		"set yzeroaxis lt 1 lc rgb frame\n%s%s"
		"plot [%.10g:%.10g] [%.10g:%.10g] $poles using 1:2 with points pt 2 ps 1.2 lw 2 lc rgb '%s'\n",
		none ? format("; %d, listed by --explain", count) : "", none ? 4 : 16, rays_of(left, high), labels,
		left, right, -high, high, picture_curve[0].colour);
}
