/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Coordinates that are differences along a tree, and a centre: what they are called, the written ones as forms of them,
 * and values of either from those of the other. */
#include "inner.h"
#include "model/building.h"
#include "model/tunable/tuning.h"

/* ---- what is kept ---- */

static const char *times(mpq_srcptr ratio, const char *name)
{
	return mpq_cmp_ui(ratio, 1, 1) == 0 ? name : format("%s*%s", readable_text(ratio), name);
}

static void name_kept(struct relative *r)
{
	const struct model *model = r->written;
	int centres = 0;
	for (int j = 0; j < model->n; j++)
		centres += r->link[j].kind == LINK_CENTRE;
	for (int j = 0, centre = 0; j < model->n; j++) {
		const struct link *link = &r->link[j];
		const char *own = model->names.coord[j],
			   *from = link->kind == LINK_PARENT ? times(link->ratio, model->names.coord[link->from]) : "";
		r->name[j] = link->kind == LINK_NONE     ? own
			     : link->kind == LINK_CENTRE ? (centres > 1 ? format("centre%d", ++centre) : "centre")
			     : link->reversed              ? format("%s - %s", from, own)
							 : format("%s - %s", own, from);
	}
}

/* x' of a first-order coordinate over constants and coordinates of first order that stay as written; NULL: it is not
 * so simple */
static struct form *rate_in(const struct relative *r, const struct model *model, int coord)
{
	const struct form *form = model->equations.residual[model->equations.owner[coord]].form;
	struct form *rate = NEW(struct form);
	mpq_srcptr lead = NULL;
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		bool own = basis->kind == BASIS_COORD && basis->index == coord && basis->order == 1;
		bool plain = basis->kind == BASIS_COORD && basis->order == 0 &&
			     r->link[basis->index].kind == LINK_NONE && model->system.velocity[basis->index] < 0;
		if (own)
			lead = form->term[i].factor;
		else if (plain || basis->kind == BASIS_ONE)
			rate = form_sum(rate, form_single(*basis, form->term[i].factor), true);
		else
			return NULL;
	}
	if (!lead || loads_change(&model->system))
		return NULL;
	RATIONAL factor = ZERO;
	mpq_inv(factor, lead);
	rate = form_scale(rate, factor);
	return rate;
}

/* The same where tunable params leave it as it is: a set finds it by the spec's values */
static struct form *rate_of(const struct relative *r, int coord)
{
	const struct model *other = model_elsewhere(r->written);
	struct form *rate = rate_in(r, r->written, coord);
	struct form *elsewhere = rate && other ? rate_in(r, other, coord) : rate;
	return elsewhere && form_difference(rate, elsewhere)->terms == 0 ? rate : NULL;
}

static struct form *unit(int coord, int order)
{
	return form_unit((struct basis){ .kind = BASIS_COORD, .index = coord, .order = order });
}

/* Of constants and first-order coordinates */
static struct form *derivative(const struct form *form)
{
	struct form *sum = NEW(struct form);
	for (int i = 0; i < form->terms; i++)
		if (form->term[i].basis.kind == BASIS_COORD)
			sum = form_sum(sum, form_scale(unit(form->term[i].basis.index, 1), form->term[i].factor),
				       false);
	return sum;
}

/* The written coordinate, or a derivative, over what is kept */
static struct form *written_form(const struct relative *r, int coord, int order)
{
	const struct link *link = &r->link[coord];
	if (link->velocity >= 0 && order > 0)
		return unit(link->velocity, order - 1);
	if (link->rate && order > 0)
		return form_sum(form_scale(order == 1 ? link->rate : derivative(link->rate), link->ratio),
				unit(coord, order), link->reversed);
	if (link->kind == LINK_PARENT)
		return form_sum(form_scale(r->form[order][link->from], link->ratio), unit(coord, order),
				link->reversed);
	struct form *form = unit(coord, order);
	for (int k = 0; k < r->written->n && link->kind == LINK_CENTRE; k++)
		if (mpq_sgn(link->shift[k]) != 0)
			form = form_sum(form, form_scale(unit(k, order), link->shift[k]), false);
	return form;
}

/* r' = x' - (n_k/n_p) x_p', where the velocity x' stands alone */
static struct form *rate_equation(const struct relative *r, int coord)
{
	const struct link *link = &r->link[coord];
	struct form *rate = form_sum(r->form[1][coord], form_scale(r->form[1][link->from], link->ratio), true);
	return form_sum(unit(coord, 1), rate, !link->reversed);
}

static void write_forms(struct relative *r)
{
	int n = r->written->n;
	for (int order = 0; order < 3; order++) {
		r->form[order] = ARRAY(struct form *, n);
		for (int j = 0; j < n; j++)
			if (r->link[j].kind != LINK_PARENT)
				r->form[order][j] = written_form(r, j, order);
		for (int i = 0; i < r->links; i++)
			r->form[order][r->sequence[i]] = written_form(r, r->sequence[i], order);
	}
	r->extra = ARRAY(struct form *, (size_t)(r->n - n));
	for (int j = 0; j < n; j++)
		if (r->link[j].velocity >= 0)
			r->extra[r->link[j].velocity - n] = rate_equation(r, j);
}

/* Velocities of coordinates that are measured from one without: relative to its rate where that is simple, else they
 * stand alone */
static void split_velocities(struct relative *r)
{
	const struct model *model = r->written;
	for (int i = 0; i < r->links; i++) {
		int j = r->sequence[i];
		struct link *link = &r->link[j];
		if (model->system.velocity[j] < 0 || model->system.velocity[link->from] >= 0)
			continue;
		link->rate = rate_of(r, link->from);
		if (link->rate)
			continue;
		link->velocity = r->n++;
		r->name[link->velocity] = model->names.state[model->system.velocity[j]];
		r->order[j] = r->order[link->velocity] = 1;
	}
}

struct relative *relative_new(const struct model *model)
{
	struct relative *r = NEW(struct relative);
	size_t n = (size_t)model->n;
	*r = (struct relative){ .written = model,
				.n = model->n,
				.name = ARRAY(const char *, 2 * n),
				.order = ARRAY(int, 2 * n),
				.link = ARRAY(struct link, n),
				.sequence = ARRAY(int, n) };
	for (int j = 0; j < model->n; j++) {
		r->order[j] = model->system.velocity[j] >= 0 ? 2 : 1;
		r->link[j].velocity = -1;
		mpq_init(r->link[j].ratio);
	}
	return r;
}

void complete_relative(struct relative *r)
{
	name_kept(r);
	split_velocities(r);
	write_forms(r);
}

/* ---- values ---- */

void relative_value(const struct relative *r, int coord, mpq_t *const *value, mpq_ptr kept)
{
	const struct link *link = &r->link[coord];
	RATIONAL product = ZERO;
	if (link->kind == LINK_NONE) {
		mpq_set(kept, *value[coord]);
	} else if (link->kind == LINK_PARENT) {
		mpq_mul(product, link->ratio, *value[link->from]);
		if (link->reversed)
			mpq_sub(kept, product, *value[coord]);
		else
			mpq_sub(kept, *value[coord], product);
	} else {
		mpq_set_ui(kept, 0, 1);
		for (int j = 0; j < r->written->n; j++) {
			if (mpq_sgn(link->weight[j]) == 0)
				continue;
			mpq_mul(product, link->weight[j], *value[j]);
			mpq_add(kept, kept, product);
		}
	}
}

/* The rate that a link is measured from, at written values */
static mpq_t *rate_value(const struct link *link, mpq_t *written)
{
	mpq_t *sum = rationals(1);
	RATIONAL product = ZERO;
	for (int i = 0; i < link->rate->terms; i++) {
		const struct form_term *term = &link->rate->term[i];
		mpq_set(product, term->factor);
		if (term->basis.kind == BASIS_COORD)
			mpq_mul(product, product, written[term->basis.index]);
		mpq_add(*sum, *sum, product);
	}
	return sum;
}

void relative_values(const struct model *model, mpq_t *written, mpq_t *kept)
{
	const struct relative *r = model->relative;
	const struct linear *from = &r->written->system;
	mpq_t **place = ARRAY(mpq_t *, from->n), **rate = ARRAY(mpq_t *, from->n);
	for (int j = 0; j < from->n; j++) {
		place[j] = &written[j];
		rate[j] = from->velocity[j] >= 0 ? &written[from->velocity[j]] : &written[j];
	}
	for (int j = 0; j < from->n; j++)
		if (r->link[j].rate)
			rate[r->link[j].from] = rate_value(&r->link[j], written);
	for (int j = 0; j < from->n; j++) {
		relative_value(r, j, place, kept[j]);
		if (model->system.velocity[j] >= 0)
			relative_value(r, j, rate, kept[model->system.velocity[j]]);
		else if (r->link[j].velocity >= 0)
			mpq_set(kept[r->link[j].velocity], *rate[j]);
	}
}

mpq_t *relative_rows(const struct model *model)
{
	const struct relative *r = model->relative;
	const struct linear *from = &r->written->system, *to = &model->system;
	const int width = to->states + 1;
	mpq_t *rows = rationals((size_t)(from->states * width));
	for (int i = 0; i < from->states; i++) {
		const struct form *form = r->form[i >= from->n][from->coord[i]];
		for (int k = 0; k < form->terms; k++) {
			const struct basis *basis = &form->term[k].basis;
			const int at = basis->kind == BASIS_ONE ? to->states
							: basis->order ? to->velocity[basis->index] : basis->index;
			mpq_set(rows[i * width + at], form->term[k].factor);
		}
	}
	return rows;
}

int relative_place(const struct model *model, int written)
{
	const struct linear *from = &model->relative->written->system;
	int coord = from->coord[written];
	const struct link *link = &model->relative->link[coord];
	bool velocity = written >= from->n;
	if (velocity && link->velocity >= 0)
		return link->velocity;
	return link->kind != LINK_NONE ? -1 : velocity ? model->system.velocity[coord] : coord;
}
