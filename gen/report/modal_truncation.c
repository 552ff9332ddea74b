/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Of a model of some modes of another: which are kept, and what is lost by the others. */
#include "model/linear/modal_truncation.h"
#include "report/report.h"

#include <math.h>

/* The numbers of the modes that are kept, or of the others: 1-4, 6 */
const char *mode_numbers(const struct modal_truncation *s, bool kept)
{
	const char *text = "";
	const struct modes *modes = s->modes;
	for (int i = 0; i < modes->count;) {
		int last = i;
		if (s->kept[i] != kept) {
			i++;
			continue;
		}
		while (last + 1 < modes->count && s->kept[last + 1] == kept)
			last++;
		const int from = modes->mode[i].number, to = modes->mode[last].number + modes->mode[last].weight - 1;
		text = format("%s%s%d", text, *text ? ", " : "", from);
		if (to > from)
			text = format("%s-%d", text, to);
		i = last + 1;
	}
	return text;
}

int modes_of_model(const struct modal_truncation *s)
{
	const struct mode *last = &s->modes->mode[s->modes->count - 1];
	return last->number + last->weight - 1;
}

/* Up to three digits */
static double rounded_up(double x)
{
	const double unit = x > 0 ? pow(10, floor(log10(x)) - 2) : 0;
	return x > 0 ? ceil(x / unit) * unit : 0;
}

/* tip 3.2e-05 */
const char *truncation_text(const struct model *model, int output)
{
	const struct modal_truncation *s = model->reduction.truncated;
	const double mode_error = truncation_of_modes(s->modes, s->kept, s->static_correction, output);
	const char *name = model->output[output].name;
	return isfinite(mode_error) ? format("%s %.3g", name, rounded_up(mode_error))
			      : format("%s without a bound (something dropped grows, or a load has its pole)", name);
}

/* What the others still do */
const char *static_correction_text(const struct model *model)
{
	const struct linear *system = &model->system;
	if (!model->reduction.truncated->static_correction)
		return "the others are left out";
	if (!system->loads && !system->inputs)
		return "nothing drives the others";
	return format("of the others the outputs keep%s%s%s", system->loads ? " what loads force" : "",
		      system->loads && system->inputs ? " and" : "",
		      system->inputs ? " the static gain of inputs" : "");
}

static double ratio_of(const struct mode *mode)
{
	const double size = hypot(mode->re, mode->im);
	return size == 0 ? 0 : -mode->re / size;
}

/* Where what misses eliminated constraints decays */
static bool is_of_misses(const struct model *model, const struct mode *mode)
{
	return model->equations.misses && mode->im == 0 &&
	       fabs(mode->re * mpq_get_d(model->h) + DECAY_OF_MISSES) < 1e-9;
}

/* Each mode, and what it gives */
void text_modal_truncation(FILE *to, const struct model *model)
{
	const struct modal_truncation *s = model->reduction.truncated;
	const struct modes *modes = s->modes;
	fprintf(to, "    %-9s %-16s %-14s %-10s largest share of an output\n", "mode", "frequency [Hz]",
		"damping ratio", "");
	for (int i = 0; i < modes->count; i++) {
		const struct mode *mode = &modes->mode[i];
		const int last = mode->number + mode->weight - 1;
		const char *number = last > mode->number ? format("%d-%d", mode->number, last)
							 : format("%d", mode->number);
		const char *share = is_of_misses(model, mode) ? "none: it is of the constraints"
				    : !mode->seen ? "not seen" : mode->rigid ? "rigid"
				    : isfinite(mode->share) ? format("%.3g", mode->share) : "no bound";
		fprintf(to, "    %-9s %-16.8g %-14.8g %-10s %s\n", number,
			hypot(mode->re, mode->im) / 6.283185307179586, ratio_of(mode), s->kept[i] ? "kept" : "dropped",
			share);
	}
	fputs("Of the largest sizes that modes can ever have in an output, by the start and the loads, or by a step of "
	      "an input.\n", to);
	fprintf(to, "States: %s\n", name_list(model->system.states, model->names.state));
}

/* Members of an object */
void json_modal_truncation(FILE *to, const struct model *model)
{
	const struct modal_truncation *s = model->reduction.truncated;
	fputs("  \"mode_shares\": [\n", to);
	for (int i = 0; i < s->modes->count; i++) {
		const struct mode *mode = &s->modes->mode[i];
		fprintf(to,
			"    {\"number\": %d, \"states\": %d, \"re\": %.9g, \"im\": %.9g, \"rigid\": %s, "
			"\"seen\": %s, \"kept\": %s, \"share\": %s}%s\n",
			mode->number, mode->states, mode->re, mode->im, mode->rigid ? "true" : "false",
			mode->seen ? "true" : "false", s->kept[i] ? "true" : "false", json_number(mode->share),
			i + 1 < s->modes->count ? "," : "");
	}
	fprintf(to, "  ],\n  \"static\": %s,\n  \"lost\": [", s->static_correction ? "true" : "false");
	for (int i = 0; i < model->outputs; i++)
		fprintf(to, "%s%s", i ? ", " : "",
			json_number(truncation_of_modes(s->modes, s->kept, s->static_correction, i)));
	fputs("],\n", to);
}
