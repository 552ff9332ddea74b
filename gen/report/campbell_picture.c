/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Modes over a param as CSV, as JSON, as a picture: frequencies with the lines of orders and what crosses them, and
 * damping ratios. */
#include "host/picture.h"
#include "report/campbell.h"

#include <math.h>

static const char *const whirl_name[] = { [WHIRL_NONE] = "none", [WHIRL_PLANAR] = "planar",
					  [WHIRL_FORWARD] = "forward", [WHIRL_BACKWARD] = "backward",
					  [WHIRL_MIXED] = "mixed" };

/* x, y (names); a, b (gyroscopic terms) */
static const char *pairs_text(const struct campbell *c)
{
	const char *text = "";
	for (int i = 0; i < c->pairs; i++)
		text = format("%s%s%s, %s (%s)", text, i ? "; " : "", c->coord[c->pair[i].first],
			      c->coord[c->pair[i].second], c->pair[i].by);
	return text;
}

static const char *crossing_text(const struct campbell *c, const struct whirl_crossing *x)
{
	return format("%sx crosses mode %d at %s = %.9g: %.9g Hz, damping ratio %.4g, %s", format("%g", x->order),
		      x->branch + 1, c->param, x->value, x->mode.hertz, x->mode.ratio, whirl_name[x->mode.whirl]);
}

/* ---- tables ---- */

static void print_csv(FILE *to, const struct campbell *c)
{
	fprintf(to, "%s,mode,frequency_hz,damping_ratio,re,im,whirl,circularity\n", c->param);
	for (int k = 0; k < c->values; k++)
		for (int b = 0; b < c->branches; b++) {
			const struct whirl_mode *m = mode_of_branch(&c->at[k], b);
			if (m)
				fprintf(to, "%.17g,%d,%.17g,%.17g,%.17g,%.17g,%s,%.6g\n", c->at[k].value, b + 1,
					m->hertz, m->ratio, m->re, m->im, whirl_name[m->whirl], m->measure);
		}
	for (int i = 0; i < c->pairs; i++)
		fprintf(to, "# forward is from %s to %s: pair by %s\n", c->coord[c->pair[i].first],
			c->coord[c->pair[i].second], c->pair[i].by);
	for (int i = 0; i < c->crossings; i++)
		fprintf(to, "# %s\n", crossing_text(c, &c->crossing[i]));
}

static void json_mode(FILE *to, const struct whirl_mode *m, int branch)
{
	fprintf(to, "{\"mode\": %d, \"frequency_hz\": %.17g, \"damping_ratio\": %.17g, \"re\": %.17g, \"im\": %.17g, "
		    "\"whirl\": \"%s\", \"circularity\": %.6g}", branch + 1, m->hertz, m->ratio, m->re, m->im,
		whirl_name[m->whirl], m->measure);
}

static void json_values(FILE *to, const struct campbell *c)
{
	fputs("  \"values\": [", to);
	for (int k = 0; k < c->values; k++) {
		const char *between = "";
		fprintf(to, "%s\n    {\"value\": %.17g, \"modes\": [", k ? "," : "", c->at[k].value);
		for (int b = 0; b < c->branches; b++) {
			const struct whirl_mode *m = mode_of_branch(&c->at[k], b);
			if (!m)
				continue;
			fprintf(to, "%s\n      ", between);
			json_mode(to, m, b);
			between = ",";
		}
		fputs("]}", to);
	}
	fputs("],\n", to);
}

static void print_json(FILE *to, const struct campbell *c)
{
	fprintf(to, "{\n  \"model\": \"%s\",\n  \"param\": \"%s\",\n  \"unit\": \"%s\",\n  \"orders\": ", c->name,
		c->param, c->unit);
	json_numbers(to, c->orders, c->order);
	fputs(",\n  \"pairs\": [", to);
	for (int i = 0; i < c->pairs; i++)
		fprintf(to, "%s{\"forward\": [\"%s\", \"%s\"], \"by\": \"%s\"}", i ? ", " : "",
			c->coord[c->pair[i].first], c->coord[c->pair[i].second], c->pair[i].by);
	fputs("],\n", to);
	json_values(to, c);
	fputs("  \"crossings\": [", to);
	for (int i = 0; i < c->crossings; i++) {
		const struct whirl_crossing *x = &c->crossing[i];
		fprintf(to, "%s\n    {\"order\": %.17g, \"value\": %.17g, \"at\": ", i ? "," : "", x->order, x->value);
		json_mode(to, &x->mode, x->branch);
		fputs("}", to);
	}
	fputs("]\n}\n", to);
}

/* ---- the picture ---- */

/* Of one kind of whirl, a block for each mode: the mode's other points are left out, with a gap in their place */
static void print_curves(FILE *to, const struct campbell *c, enum whirl whirl)
{
	fprintf(to, "$%s << END\n", whirl_name[whirl]);
	for (int b = 0; b < c->branches; b++) {
		for (int k = 0; k < c->values; k++) {
			const struct whirl_mode *m = mode_of_branch(&c->at[k], b);
			const struct whirl_mode *next = k + 1 < c->values ? mode_of_branch(&c->at[k + 1], b) : NULL;
			if (m && (m->whirl == whirl || (next && next->whirl == whirl)))
				fprintf(to, "%.10g %.10g %.10g\n", c->at[k].value, m->hertz, m->ratio);
			else
				fputs("\n", to);
		}
		fputs("\n", to);
	}
	fputs("END\n", to);
}

static bool has_whirl(const struct campbell *c, enum whirl whirl)
{
	for (int k = 0; k < c->values; k++)
		for (int i = 0; i < c->at[k].modes; i++)
			if (c->at[k].mode[i].whirl == whirl)
				return true;
	return false;
}

static double highest(const struct campbell *c, bool ratio)
{
	double most = 0;
	for (int k = 0; k < c->values; k++)
		for (int i = 0; i < c->at[k].modes; i++)
			most = fmax(most, ratio ? c->at[k].mode[i].ratio : c->at[k].mode[i].hertz);
	return most;
}

static double lowest_ratio(const struct campbell *c)
{
	double least = 0;
	for (int k = 0; k < c->values; k++)
		for (int i = 0; i < c->at[k].modes; i++)
			least = fmin(least, c->at[k].mode[i].ratio);
	return least;
}

/* Lines differ in colour and in dashes. */
static const char *curves_text(const struct campbell *c, int column)
{
	static const int style[] = { [WHIRL_NONE] = 0, [WHIRL_FORWARD] = 0, [WHIRL_BACKWARD] = 1, [WHIRL_PLANAR] = 2,
				     [WHIRL_MIXED] = 3 };
	const char *text = "";
	for (enum whirl w = WHIRL_NONE; w <= WHIRL_MIXED; w++) {
		const struct picture_curve *curve = &picture_curve[style[w]];
		if (has_whirl(c, w))
			text = format("%s%s$%s using 1:%d with lines lw 2 dt %s lc rgb '%s' title '%s'", text,
				      *text ? ", " : "plot ", whirl_name[w], column, curve->dash, curve->colour,
				      w == WHIRL_NONE ? "modes" : whirl_name[w]);
	}
	return *text ? text : "plot NaN notitle";
}

/* Order lines as far as the frame goes, each with its order behind its end */
static const char *orders_text(const struct campbell *c, double high)
{
	const char *text = "";
	for (int i = 0; i < c->orders; i++) {
		const double slope = c->order[i] * c->hertz, to = fmin(c->to, high / slope);
		text = format("%sset arrow from %.10g,%.10g to %.10g,%.10g nohead lc rgb faint\n", text, c->from,
			      fmin(high, slope * c->from), to, slope * to);
		text = format("%sset label '%gx' at %.10g,%.10g %s tc rgb ink font small\n", text, c->order[i],
			      to, slope * to, to < c->to ? "center offset 0,0.5" : "left offset 0.5,0");
	}
	return text;
}

/* Each with its value, above the line of a forward mode and below that of others */
static const char *crossings_text(const struct campbell *c)
{
	const char *text = "";
	for (int i = 0; i < c->crossings; i++) {
		const struct whirl_crossing *x = &c->crossing[i];
		text = format("%sset label '%.4g' at %.10g,%.10g %s tc rgb ink font small front\n", text, x->value,
			      x->value, x->mode.hertz, x->mode.whirl == WHIRL_FORWARD ? "right offset -0.5,0.8"
									    : "left offset 0.5,-0.8");
	}
	return text;
}

static void print_crossings(FILE *to, const struct campbell *c)
{
	fputs("$crossings << END\n", to);
	for (int i = 0; i < c->crossings; i++)
		fprintf(to, "%.10g %.10g\n", c->crossing[i].value, c->crossing[i].mode.hertz);
	fputs("END\n", to);
}

struct campbell_sheet {
	const struct campbell *c;
	const struct picture_look *look;
	double width, height, panels;   /* panels: the part of the height below the title */
};

static struct campbell_sheet sheet_of(const struct campbell *c, const struct picture_look *look)
{
	struct campbell_sheet s = { c, look, look->paper ? PICTURE_COLUMN : PICTURE_WIDE, look->paper ? 300 : 640, 1 };
	if (look->width > 0) {
		s.width = picture_points(look, look->width);
		s.height = picture_points(look, look->height);
	}
	if (look->title)
		s.panels = 1 - (8 + PICTURE_LINE * picture_heading_lines(look->title, s.width)) / s.height;
	return s;
}

/* From so far up, so high, both parts of the sheet below the title */
static void begin_panel(FILE *to, const struct campbell_sheet *s, double from, double high)
{
	fputs("reset\n", to);
	picture_colours(to, s->look);
	fprintf(to, "set lmargin %d\nset rmargin 16\nset key outside right top noautotitle\nset xrange [%.10g:%.10g]\n"
		    "set origin 0,%g\nset size 1,%g\n", s->width < 500 ? 9 : 12, s->c->from, s->c->to,
		from * s->panels, high * s->panels);
}

static void print_frequencies(FILE *to, const struct campbell_sheet *s)
{
	const struct campbell *c = s->c;
	const double most = highest(c, false), high = most > 0 ? 1.08 * most : 1;
	begin_panel(to, s, 0.34, 0.66);
	if (s->look->title)
		picture_heading(to, s->look, s->look->title, 0, s->width, s->height);
	else
		fprintf(to, "set title '%s: modes over %s%s'\n", c->name, c->param,
			c->pairs ? format(", whirl by %s", pairs_text(c)) : "");
	fprintf(to, "set bmargin 0.8\nset format x ''\nset ylabel 'f [Hz]'\nset yrange [0:%.10g]\n%s%s%s%s\n", high,
		orders_text(c, high), crossings_text(c), curves_text(c, 2),
		c->crossings ? ", $crossings using 1:2 with points pt 6 ps 1.1 lw 1.6 lc rgb ink title 'crossing'"
			     : "");
}

static void print_ratios(FILE *to, const struct campbell_sheet *s)
{
	const struct campbell *c = s->c;
	const double damped = highest(c, true), least = lowest_ratio(c);
	begin_panel(to, s, 0, 0.34);
	fprintf(to, "set key off\nset tmargin 0.8\nset xlabel '%s [%s]'\nset ylabel 'damping ratio'\n"
		    "set format y '%%.3g'\nset yrange [%.10g:%.10g]\n%s\n", c->param, c->unit, 1.1 * least,
		damped > 0 ? 1.1 * damped : least < 0 ? 0 : 1, curves_text(c, 3));
}

static void print_picture_of(FILE *to, const struct campbell *c, const struct picture_look *look,
			     enum picture_format as)
{
	const struct campbell_sheet s = sheet_of(c, look);
	FILE *script = new_script();
	begin_picture(script, look, as, (int)s.width, (int)s.height, "campbell");
	for (enum whirl w = WHIRL_NONE; w <= WHIRL_MIXED; w++)
		if (has_whirl(c, w))
			print_curves(script, c, w);
	print_crossings(script, c);
	fputs("set multiplot\n", script);
	print_frequencies(script, &s);
	print_ratios(script, &s);
	fputs("unset multiplot\n", script);
	draw(to, script);
	fclose(script);
}

void print_campbell(FILE *to, const struct campbell *c, const struct picture_look *look, enum picture_format as)
{
	if (as == PICTURE_CSV)
		print_csv(to, c);
	else if (as == PICTURE_JSON)
		print_json(to, c);
	else
		print_picture_of(to, c, look, as);
	for (int i = 0; i < c->crossings && as != PICTURE_CSV && as != PICTURE_JSON; i++)
		fprintf(stderr, "plgen: note: %s\n", crossing_text(c, &c->crossing[i]));
}
