/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which model is stepped: that of the equations, or one over rigid-body and relative coordinates. */
#include "inner.h"
#include "model/regions/regions.h"
#include "model/tunable/tuning.h"

/* The coordinate from which all of its group are measured */
static int root_of(const struct relative *r, int coord)
{
	while (r->link[coord].kind == LINK_PARENT)
		coord = r->link[coord].from;
	return coord;
}

/* The coordinates kept from `first` on that share its rigid-body mode; NULL: there are no others */
static const char *kept_with(const struct model *model, const struct relative *r, int first)
{
	const char *names = model->written->names.coord[first];
	int count = 1;
	for (int j = first + 1; j < model->written->n; j++)
		if (model->reduction.place[first] >= 0 && model->reduction.place[j] >= 0 &&
		    root_of(r, first) == root_of(r, j)) {
			names = format("%s, %s", names, model->written->names.coord[j]);
			count++;
		}
	return count > 1 ? names : NULL;
}

/* Positions that a reduced model keeps as they are written, though they have rigid-body modes */
static void warn_of_kept(const struct model *model)
{
	const struct relative *r = relative_of(model->written);
	const char *names = NULL;
	for (int i = 0; r && i < model->written->n && !names; i++)
		names = kept_with(model, r, i);
	if (names)
		say_warning(model->spec->name_at, "without --reduce differences are states of their own",
			    "the reduced model keeps %s, which have rigid-body modes: where they grow, their "
			    "differences lose digits",
			    names);
}

/* The model again, its regions those of all coordinates together: over differences independent parts are not told
 * apart. NULL: it was said why not */
static struct model *undivided(struct model *model, struct spec *spec, struct request *again)
{
	if (!model->switching || !model->switching->parts)
		return model;
	again->again.undivided = true;
	struct model *full = model_build(spec, again);
	if (full)
		full->switching->sharing = model->switching->parts;
	return full;
}

static struct model *model_over_differences(struct model *model, struct spec *spec, struct request *again)
{
	model = undivided(model, spec, again);
	again->again.relative = model ? relative_of(model) : NULL;
	struct model *relative = again->again.relative ? model_build(spec, again) : NULL;
	relative = relative ? find_tuning(relative, again) : NULL;
	if (!relative)
		return NULL;
	relative->reduction.irreducible = model->reduction.irreducible;
	if (relative->switching)
		relative->switching->sharing = model->switching->sharing;
	return relative;
}

/* The model over coordinates that part rigid-body modes from relative motion; itself, where there are none */
struct model *stepped_model(struct model *model, struct spec *spec, const struct request *request)
{
	struct request again = *request;
	if (model->written != model) {
		warn_of_kept(model);
		return model;
	}
	if (!relative_of(model))
		return model;
	const struct scheme_row *row = scheme_row(model->scheme);
	if (row->holds_coupling || row->modes) {
		say_warning(model->request.at.scheme.source ? model->request.at.scheme : spec->name_at,
			    row->modes ? "exact and etdrk4 step differences as states of their own"
				       : "any other scheme steps differences as states of their own",
			    "%s keeps coordinates as they are written, and there are rigid-body modes: where they "
			    "grow, their differences lose digits", scheme_name(model->scheme));
		return model;
	}
	again.reduce = again.reduce && !model->reduction.irreducible;
	return model_over_differences(model, spec, &again);
}
