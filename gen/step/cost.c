/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a step costs: evaluations of what is left over, load states. */
#include "step/step.h"

static bool is_unit(mpq_srcptr factor)
{
	return mpz_cmpabs_ui(mpq_numref(factor), 1) == 0 && mpz_cmp_ui(mpq_denref(factor), 1) == 0;
}

struct counting {
	struct cost cost;
	bool *seen;                 /* per atom */
	int forms;                  /* sums counted so far */
	const struct form **form;
};

static void cost_form(struct counting *c, const struct form *form);

static void cost_operand(struct counting *c, const struct form *form)
{
	for (int i = 0; i < c->forms; i++)
		if (c->form[i] == form)
			return;
	ENLARGE(c->form, (size_t)c->forms + 1);
	c->form[c->forms++] = form;
	cost_form(c, form);
}

static void cost_atom(struct counting *c, const struct atom *a)
{
	if (c->seen[a->index])
		return;
	c->seen[a->index] = true;
	int factors = 0;
	for (int k = 0; k < a->operands; k++) {
		factors += a->exponent ? (int)a->exponent[k] : 0;
		cost_operand(c, a->operand[k]);
	}
	c->cost.multiplications += a->kind == ATOM_PRODUCT ? factors - 1 : a->kind == ATOM_RECIPROCAL;
	c->cost.calls += calls_libm(a);
}

static void cost_form(struct counting *c, const struct form *form)
{
	c->cost.additions += form->terms > 1 ? form->terms - 1 : 0;
	for (int i = 0; i < form->terms; i++) {
		c->cost.multiplications += form->term[i].basis.kind > BASIS_PI && !is_unit(form->term[i].factor);
		if (form->term[i].basis.atom)
			cost_atom(c, form->term[i].basis.atom);
	}
}

struct cost leftover_cost(const struct step *step)
{
	const struct model *model = step->model;
	struct counting c = { .seen = ARRAY(bool, (size_t)atoms_count(model->atoms)) };
	for (int e = 0; e < model->channels; e++)
		cost_form(&c, model->operator[0].left[e]);
	return c.cost;
}

/* What the load states of the columns in use cost */
void count_loads(struct program *program, const struct linear *system, bool single)
{
	for (int l = 0, column = 0; l < system->loads; column += system->load[l++].columns) {
		const struct load *load = &system->load[l];
		bool used = false;
		for (int k = 0; k < load->columns; k++)
			used = used || program->uses[column + k];
		bool grows = used && mpq_sgn(load->wave->a) != 0, turns = used && oscillates(load->wave);
		program->oscillators += turns;
		program->growths += grows;
		program->multiplications += !used              ? 0
					    : turns            ? 2 * (load->powers - 1) + 2 * grows
					    : load->powers > 1 ? load->powers - 2 + grows
							       : 0;
	}
	program->wave_multiplications = program->oscillators * (single ? PL_COSSINF_MUL : PL_COSSIN_MUL) +
					program->growths * (single ? PL_GROWTHF_MUL : PL_GROWTH_MUL);
	program->wave_additions = program->oscillators * (single ? PL_COSSINF_ADD : PL_COSSIN_ADD) +
				  program->growths * (single ? PL_GROWTHF_ADD : PL_GROWTH_ADD);
	program->multiplications += program->wave_multiplications;
	program->additions += program->wave_additions;
}
