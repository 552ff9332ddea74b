/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Poles of a model over one of its params, a speed: exact at each value, modes followed from value to value, forward
 * and backward whirl told apart, and where a mode has a multiple of the speed (Lalanne and Ferraris 1998, chapter 2;
 * Genta 2005, chapter 3). */
#include "report/campbell.h"
#include "step/linear/images.h"

#include <math.h>
#include <string.h>

enum { VALUES = 61, MOST_VALUES = 2000, MOST_ORDERS = 16, REFINEMENTS = 40 };
static const double two_pi = 6.283185307179586, planar = 0.01;

/* ---- what is asked for ---- */

static const char sweep_note[] = "--sweep takes NAME=FROM:TO[:N], TO with rad/s, rpm or Hz behind it where that is "
				 "the unit of a speed: w=0:500, n=0:6000rpm:121";

static const struct speed_unit { const char *name; double hertz; } units[] = {
	{ "rad/s", 1 / 6.283185307179586 }, { "rpm", 1.0 / 60 }, { "Hz", 1 }
};

/* The number of `text` up to a ':' or the unit behind it */
static const char *take_unit(struct campbell *c, const char *text, const char *end)
{
	for (size_t i = 0; i < sizeof units / sizeof *units; i++) {
		const size_t length = strlen(units[i].name);
		if ((size_t)(end - text) > length && strncmp(end - length, units[i].name, length) == 0) {
			c->unit = units[i].name;
			c->hertz = units[i].hertz;
			return end - length;
		}
	}
	return end;
}

/* Of a param that has one of its own, in which its values then are */
static void take_unit_of_param(struct campbell *c, const struct spec *spec)
{
	for (const struct symbol *s = spec->first; s && !c->unit; s = s->next) {
		if (s->kind != SYMBOL_PARAM || !s->unit_written || strcmp(s->name, c->param) != 0)
			continue;
		c->unit = s->unit->text;
		c->hertz = unit_factor(s->unit) / (strstr(c->unit, "Hz") ? 1 : two_pi);
	}
	if (!c->unit) {
		c->unit = units[0].name;
		c->hertz = units[0].hertz;
	}
}

static void take_sweep(struct campbell *c, const char *text)
{
	struct place at = { source_argument(text), 0 };
	const char *equals = strchr(text, '='), *colon = equals ? strchr(equals, ':') : NULL;
	const char *last = colon ? strchr(colon + 1, ':') : NULL, *end = colon ? colon + strlen(colon) : NULL;
	double values = VALUES;
	if (!colon || equals == text)
		error(at, sweep_note, "expected a param, '=' and two values");
	c->param = format("%.*s", (int)(equals - text), text);
	const char *stop = take_unit(c, colon + 1, last ? last : end);
	if (!read_number(equals + 1, colon, &c->from) || !read_number(colon + 1, stop, &c->to) || c->from < 0 ||
	    !(c->to > c->from && isfinite(c->to)))
		error(at, sweep_note, "expected two values that rise, from 0 on");
	if (last && (!read_number(last + 1, end, &values) || values != floor(values) || values < 2 ||
		     values > MOST_VALUES))
		error(at, sweep_note, "expected a number of values from 2 to %d", MOST_VALUES);
	c->values = (int)values;
}

static void take_orders(struct campbell *c, const char *text)
{
	struct place at = { source_argument(text), 0 };
	c->order = ARRAY(double, MOST_ORDERS);
	for (const char *end; *text; text = end + (*end == ',')) {
		end = text + strcspn(text, ",");
		const char *stop = end > text && end[-1] == 'x' ? end - 1 : end;
		if (c->orders == MOST_ORDERS || !read_number(text, stop, &c->order[c->orders]) ||
		    !(c->order[c->orders] > 0))
			error(at, NULL, "--orders takes up to %d numbers above 0: 1,2,0.5", MOST_ORDERS);
		c->orders++;
	}
}

/* ---- pairs of coordinates ---- */

static void add_pair(struct campbell *c, int first, int second, const char *by)
{
	const struct whirl_pair pair = { first, second, by };
	*MORE(c->pair, c->pairs) = pair;
}

static bool is_paired(const struct campbell *c, int coord)
{
	for (int i = 0; i < c->pairs; i++)
		if (c->pair[i].first == coord || c->pair[i].second == coord)
			return true;
	return false;
}

/* X:Y,A:B of --whirl: forward is from the first to the second */
static void take_pairs(struct campbell *c, const struct model *model, const char *text)
{
	struct place at = { source_argument(text), 0 };
	const char *const *name = model->names.coord;
	for (const char *end; *text; text = end + (*end == ',')) {
		end = text + strcspn(text, ",");
		const char *colon = memchr(text, ':', (size_t)(end - text));
		const int first = colon ? place_among(model->n, name, text, (size_t)(colon - text)) : -1;
		const int second = colon ? place_among(model->n, name, colon + 1, (size_t)(end - colon - 1)) : -1;
		if (first < 0 || second < 0 || first == second)
			error(at, NULL, "--whirl takes pairs of coordinates, x:y,a:b: '%.*s' is none",
			      (int)(end - text), text);
		add_pair(c, first, second, "given");
	}
}

/* Two coordinates whose velocities act on each other with opposite signs, the gyroscopic moments of a disc: forward is
 * the direction in which they raise the frequency, from i to j where j' has a positive factor in the equation of i. */
static void find_gyroscopic_pairs(struct campbell *c, const struct model *model)
{
	const mpq_t *C = model->system.C;
	const int n = model->n;
	for (int i = 0; i < n; i++)
		for (int j = i + 1; j < n; j++) {
			const int up = mpq_sgn(C[i * n + j]), down = mpq_sgn(C[j * n + i]);
			if (up * down >= 0 || is_paired(c, i) || is_paired(c, j))
				continue;
			add_pair(c, up > 0 ? i : j, up > 0 ? j : i, "gyroscopic terms");
		}
}

/* x1 and y1: names that differ in one letter, which is the next one */
static bool are_neighbours(const char *a, const char *b, char letter)
{
	int differences = 0;
	if (strlen(a) != strlen(b))
		return false;
	for (; *a; a++, b++)
		if (*a != *b) {
			const char low = (char)(*a | 0x20);
			differences += low == letter && *b == *a + 1 ? 1 : 2;
		}
	return differences == 1;
}

static void find_named_pairs(struct campbell *c, const struct model *model)
{
	for (const char *letter = "xyuv"; *letter; letter++)
		for (int i = 0; i < model->n; i++)
			for (int j = 0; j < model->n; j++)
				if (!is_paired(c, i) && !is_paired(c, j) &&
				    are_neighbours(model->names.coord[i], model->names.coord[j], *letter))
					add_pair(c, i, j, "names");
}

/* ---- the modes at one value ---- */

static double part_of(const struct whirl_pair *pair, const struct mode_shape *v, double *size)
{
	const double xr = v->re[pair->first], xi = v->im[pair->first];
	const double yr = v->re[pair->second], yi = v->im[pair->second];
	*size = 0.5 * (xr * xr + xi * xi + yr * yr + yi * yi);
	return xi * yr - xr * yi;       /* |x| |y| sin(angle of x less that of y) */
}

/* 1: in circles forward, -1: backward, 0: in a plane; of the sum over all pairs */
static enum whirl whirl_of(const struct campbell *c, const struct mode_shape *v, double *measure)
{
	double turning = 0, all = 0, forward = 0, backward = 0, size;
	for (int i = 0; i < c->pairs; i++) {
		const double part = part_of(&c->pair[i], v, &size);
		turning += part;
		all += size;
		forward = fmax(forward, part);
		backward = fmax(backward, -part);
	}
	*measure = all > 0 ? turning / all : 0;
	if (all <= 0 || fmax(forward, backward) <= planar * all)
		return c->pairs ? WHIRL_PLANAR : WHIRL_NONE;
	if (forward > planar * all && backward > planar * all)
		return WHIRL_MIXED;
	return forward > backward ? WHIRL_FORWARD : WHIRL_BACKWARD;
}

static const struct model *model_at(struct campbell *c, double value)
{
	return c->build(c->context, format("%s=%s", c->param, shortest(value)));
}

static struct modes_at modes_at(struct campbell *c, double value)
{
	const struct model *model = model_at(c, value);
	struct modes_at at = { .value = value };
	struct pole_report *pole;
	struct mode_shape *shape;
	if (model->n > LIMIT_SHAPES)
		error(model->spec->name_at, NULL, "the model has %d coordinates: mode shapes are limited to %d",
		      model->n, LIMIT_SHAPES);
	const int count = poles_of(model, resolvent_of(&model->system), &pole);
	const int shapes = shapes_of(&model->system, count, pole, &shape);
	for (int k = 0; k < shapes; k++) {
		if (!shape[k].pole->pair)
			continue;
		struct whirl_mode m = { .shape = shape[k], .re = mpfr_get_d(shape[k].pole->re, MPFR_RNDN),
				  .im = fabs(mpfr_get_d(shape[k].pole->im, MPFR_RNDN)) };
		m.hertz = m.im / two_pi;
		m.ratio = mpfr_get_d(shape[k].pole->damping_ratio, MPFR_RNDN);
		m.whirl = whirl_of(c, &shape[k], &m.measure);
		*MORE(at.mode, at.modes) = m;
	}
	return at;
}

/* ---- modes from value to value ---- */

/* |v^H w|^2 / (|v|^2 |w|^2), the modal assurance criterion */
static double assurance(const struct campbell *c, const struct mode_shape *v, const struct mode_shape *w)
{
	double re = 0, im = 0, one = 0, other = 0;
	for (int i = 0; i < c->n; i++) {
		re += v->re[i] * w->re[i] + v->im[i] * w->im[i];
		im += v->re[i] * w->im[i] - v->im[i] * w->re[i];
		one += v->re[i] * v->re[i] + v->im[i] * v->im[i];
		other += w->re[i] * w->re[i] + w->im[i] * w->im[i];
	}
	return (re * re + im * im) / (one * other);
}

static double difference(const struct campbell *c, const struct whirl_mode *a, const struct whirl_mode *b)
{
	const double apart = hypot(a->re - b->re, a->im - b->im);
	return 4 * apart / (hypot(a->re, a->im) + hypot(b->re, b->im)) + 1 - assurance(c, &a->shape, &b->shape);
}

/* Each mode here has the number of the one before that it is most like, the most alike first; others have new ones. */
static void follow(struct campbell *c, const struct modes_at *before, struct modes_at *now)
{
	for (int k = 0; k < now->modes; k++)
		now->mode[k].branch = -1;
	bool *taken = ARRAY(bool, before->modes + 1);
	for (;;) {
		double least = HUGE_VAL;
		int from = -1, to = -1;
		for (int i = 0; i < before->modes; i++)
			for (int k = 0; k < now->modes; k++) {
				const double d = taken[i] || now->mode[k].branch >= 0
							 ? HUGE_VAL : difference(c, &before->mode[i], &now->mode[k]);
				if (d < least) {
					least = d;
					from = i;
					to = k;
				}
			}
		if (from < 0)
			break;
		taken[from] = true;
		now->mode[to].branch = before->mode[from].branch;
	}
	for (int k = 0; k < now->modes; k++)
		if (now->mode[k].branch < 0)
			now->mode[k].branch = c->branches++;
}

const struct whirl_mode *mode_of_branch(const struct modes_at *at, int branch)
{
	for (int k = 0; k < at->modes; k++)
		if (at->mode[k].branch == branch)
			return &at->mode[k];
	return NULL;
}

/* ---- crossings ---- */

static double gap(const struct campbell *c, const struct whirl_mode *m, double order, double value)
{
	return m->hertz - order * value * c->hertz;
}

static const struct whirl_mode *most_alike(const struct campbell *c, const struct modes_at *at,
					    const struct whirl_mode *m)
{
	const struct whirl_mode *best = NULL;
	for (int k = 0; k < at->modes; k++)
		if (!best || difference(c, &at->mode[k], m) < difference(c, best, m))
			best = &at->mode[k];
	return best;
}

/* Between two values by the rule of false position in Illinois' form, poles exact at each */
static void refine(struct campbell *c, double order, int branch, const struct modes_at *low,
		   const struct modes_at *high)
{
	const struct whirl_mode *m[2] = { mode_of_branch(low, branch), mode_of_branch(high, branch) }, *at = m[1];
	double x[2] = { low->value, high->value }, value = x[1];
	double g[2] = { gap(c, m[0], order, x[0]), gap(c, m[1], order, x[1]) };
	for (int k = 0; k < REFINEMENTS && g[1] != 0 && fabs(x[1] - x[0]) > 1e-13 * x[1]; k++) {
		value = x[1] - g[1] * (x[1] - x[0]) / (g[1] - g[0]);
		const struct modes_at there = modes_at(c, value);
		at = most_alike(c, &there, m[1]);
		if (!at)
			break;
		const double now = gap(c, at, order, value);
		if (fabs(now) <= 1e-14 * at->hertz)
			break;
		if ((now > 0) != (g[1] > 0)) {
			x[0] = x[1];
			g[0] = g[1];
		} else {
			g[0] /= 2;
		}
		x[1] = value;
		g[1] = now;
	}
	if (at)
		*MORE(c->crossing, c->crossings) = (struct whirl_crossing){ order, value, branch, *at };
}

static void find_crossings(struct campbell *c)
{
	for (int i = 0; i < c->orders; i++)
		for (int k = 0; k + 1 < c->values; k++)
			for (int b = 0; b < c->branches; b++) {
				const struct whirl_mode *here = mode_of_branch(&c->at[k], b);
				const struct whirl_mode *next = mode_of_branch(&c->at[k + 1], b);
				if (here && next && (gap(c, here, c->order[i], c->at[k].value) > 0) !=
							    (gap(c, next, c->order[i], c->at[k + 1].value) > 0))
					refine(c, c->order[i], b, &c->at[k], &c->at[k + 1]);
			}
}

/* ---- the whole ---- */

static double value_at_row(const struct campbell *c, int row)
{
	return row == c->values - 1 ? c->to : c->from + (c->to - c->from) * row / (c->values - 1);
}

void find_campbell(struct campbell *c, const char *sweep, const char *orders, const char *pairs)
{
	take_sweep(c, sweep);
	take_orders(c, orders ? orders : "1");
	const struct model *model = model_at(c, c->to);
	take_unit_of_param(c, model->spec);
	c->n = model->n;
	c->name = model->name;
	c->coord = model->names.coord;
	if (pairs)
		take_pairs(c, model, pairs);
	else
		find_gyroscopic_pairs(c, model);
	if (!pairs)
		find_named_pairs(c, model);
	c->at = ARRAY(struct modes_at, c->values);
	for (int k = 0; k < c->values; k++) {
		progress("value", k, c->values);
		c->at[k] = modes_at(c, value_at_row(c, k));
		follow(c, k ? &c->at[k - 1] : &(struct modes_at){ 0 }, &c->at[k]);
	}
	progress_end();
	find_crossings(c);
}
