/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The highest derivatives of the coordinates as forms, the mass matrix folded in, and their Jacobian: what an implicit
 * scheme solves. */
#include "model/contacts/contacts.h"
#include "collocation.h"
#include "step/series/expansion.h"

static struct basis basis_of_state(const struct linear *system, int state)
{
	return (struct basis){ .kind = BASIS_COORD, .index = system->coord[state], .order = state >= system->n };
}

/* Row of A and the remainders; what depends on time alone is apart */
static const struct form *force_of(const struct step *step, const struct layout *layout, const mpq_t *row)
{
	const struct linear *system = &step->branch->system;
	struct form *force = NEW(struct form);
	for (int j = 0; j < system->states; j++)
		if (mpq_sgn(row[j]) != 0)
			form_add_basis(force, basis_of_state(system, j), row[j]);
	for (int e = 0; e < system->force_columns; e++)
		if (mpq_sgn(row[layout->force_column + e]) != 0)
			form_add_to(force, step->model->schedule.operator[0].left[e], row[layout->force_column + e]);
	return force;
}

/* Of it with respect to a state */
static const struct form *slope_of(const struct step *step, const struct layout *layout, const mpq_t *row, int state)
{
	const struct linear *system = &step->branch->system;
	struct form *slope = NEW(struct form);
	if (mpq_sgn(row[state]) != 0)
		form_add_basis(slope, (struct basis){ .kind = BASIS_ONE }, row[state]);
	for (int e = 0; e < system->force_columns; e++)
		if (mpq_sgn(row[layout->force_column + e]) != 0)
			form_add_to(slope, step->model->remainder.slope[e * system->states + state],
				    row[layout->force_column + e]);
	return slope;
}

static void add_entries(struct motion *m, const struct step *step, const struct layout *layout, const mpq_t *row,
			int coord)
{
	const struct linear *system = &step->branch->system;
	for (int state = 0; state < system->states; state++) {
		const struct form *slope = slope_of(step, layout, row, state);
		if (slope->terms == 0 || system->coord[state] >= m->solved)
			continue;
		*MORE(m->entry, m->entries) = (struct motion_entry){
			.coord = coord, .of = system->coord[state],
			.twice = state < system->n && system->velocity[state] >= 0, .slope = slope
		};
	}
}

/* Those whose Jacobian is wanted: of a model of derivatives its own, since that of each column is the same */
static int solved_coords(const struct step *step)
{
	const int n = step->branch->system.n, own = step->model->spec->joined.own;
	const bool alike = step->model->spec->joined.held && n == own * (step->model->spec->joined.columns + 1);
	return alike ? own : n;
}

/* What loads and inputs give each coordinate's highest derivative */
static void find_drive(struct motion *m, const struct step *step, const struct layout *layout, mpq_t *const *slopes)
{
	const struct linear *system = &step->branch->system;
	int n = system->n, columns = load_columns(system);
	m->columns = columns;
	m->load = ARRAY(double, (size_t)(system->segments * n * columns) + 1);
	m->input = ARRAY(double, 2 * (size_t)(n * system->inputs) + 1);
	for (int i = 0; i < n; i++) {
		const int at = highest_state(system, i) * layout->size;
		for (int k = 0; k < system->segments; k++)
			for (int l = 0, column = 0; l < system->loads; column += system->load[l++].columns)
				for (int j = 0; j < system->load[l].columns && layout->load[l] >= 0; j++) {
					mpq_srcptr factor = slopes[k][at + layout->load[l] + j];
					m->load[(k * n + i) * columns + column + j] =
						equation_number(step->model, factor).value;
					m->driven[i] = m->driven[i] || mpq_sgn(factor) != 0;
				}
		for (int u = 0; u < system->inputs; u++)
			for (int slope = 0; slope <= (system->input[u].hold > 0); slope++) {
				mpq_srcptr factor = slopes[0][at + layout->input[u] + slope];
				m->input[2 * (i * system->inputs + u) + slope] =
					equation_number(step->model, factor).value;
				m->driven[i] = m->driven[i] || mpq_sgn(factor) != 0;
			}
	}
}

/* ---- beside contacts: as the series has them, with what holds ---- */

static const char *any_name(const void *context, int sequence)
{
	(void)context;
	return format("q%d", sequence);
}

struct recurrences *motion_recurrences(const struct step *step)
{
	return recurrences_new(step, step->taylor.switching, (struct series_names){ .name = any_name });
}

/* The highest derivative of a coordinate, of which the series has h times */
static tape_ref highest_node(const struct step *step, struct recurrences *r, int coord)
{
	RATIONAL per = ZERO;
	mpq_inv(per, step->model->h);
	tape_ref ref = recurrence_number(r, highest_state(&step->branch->system, coord), 1);
	return tape_scaled(tape_of_recurrences(r), round_rational(per), ref);
}

static int state_of_entry(const struct linear *system, const struct motion_entry *entry)
{
	return entry->twice ? entry->of : highest_state(system, entry->of);
}

void set_motion(const struct step *step, struct recurrences *r, bool slopes)
{
	const struct linear *system = &step->branch->system;
	const struct motion *m = step->collocation->motion;
	struct tape *t = tape_of_recurrences(r);
	tape_ref *by = ARRAY(tape_ref, system->states);
	for (int i = 0; i < m->coords; i++) {
		tape_ref left = highest_node(step, r, i);
		tape_set(t, format("left[%d]", i), left, 15, step->model->names.coord[i]);
		if (!slopes)
			continue;
		if (m->entries == 0)
			tape_set(t, "slope[0]", tape_number(t, 0), 15, NULL);
		tape_reverse(t, left, TAPE_STATE, system->states, by);
		for (int k = 0; k < m->entries; k++)
			if (m->entry[k].coord == i)
				tape_set(t, format("slope[%d]", k), by[state_of_entry(system, &m->entry[k])], 15, NULL);
	}
}

static void add_full_entries(struct motion *m, const struct linear *system)
{
	for (int i = 0; i < m->solved; i++)
		for (int state = 0; state < system->states; state++)
			if (system->coord[state] < m->solved)
				*MORE(m->entry, m->entries) = (struct motion_entry){
					.coord = i, .of = system->coord[state],
					.twice = state < system->n && system->velocity[state] >= 0
				};
}

static void find_entries(struct motion *m, const struct step *step)
{
	const struct linear *system = &step->branch->system;
	m->differences = step->model->equations.moving_mass && system->n > LISTED_EQUATIONS;
	if (m->differences) {
		add_full_entries(m, system);
		return;
	}
	struct recurrences *r = motion_recurrences(step);
	tape_ref *by = ARRAY(tape_ref, system->states), zero = tape_number(tape_of_recurrences(r), 0);
	for (int i = 0; i < m->coords; i++) {
		tape_reverse(tape_of_recurrences(r), highest_node(step, r, i), TAPE_STATE, system->states, by);
		for (int state = 0; state < system->states; state++)
			if (by[state] != zero)
				*MORE(m->entry, m->entries) = (struct motion_entry){
					.coord = i, .of = system->coord[state],
					.twice = state < system->n && system->velocity[state] >= 0
				};
	}
}

/* ---- the whole ---- */

/* Do more than that many equations give some of them? */
static bool any_solved(const struct step *step, const struct motion *m, int equations)
{
	bool any = false, *seen = ARRAY(bool, (size_t)atoms_count(step->model->equations.atoms));
	for (int i = 0; i < m->coords; i++)
		for (const struct form_term **term = terms_within(m->force[i], seen); *term; term++) {
			const struct atom *a = (*term)->basis.atom;
			any = any || (a && a->kind == ATOM_SOLUTION && system_of(a, a->operand).n > equations);
		}
	return any;
}

struct motion *motion_of(const struct step *step)
{
	const struct linear *system = &step->branch->system;
	struct motion *m = NEW(struct motion);
	struct layout layout = layout_of(system, 1);
	mpq_t **slopes = ARRAY(mpq_t *, system->segments);
	for (int k = 0; k < system->segments; k++)
		slopes[k] = augmented_matrix(&layout, system, k);
	m->coords = system->n;
	m->solved = solved_coords(step);
	m->apart = m->solved > MOST_TOGETHER;
	m->force = ARRAY(const struct form *, system->n);
	m->driven = ARRAY(bool, system->n);
	if (has_contacts(step->model)) {
		m->columns = load_columns(system);
		m->load = ARRAY(double, (size_t)(system->segments * system->n * m->columns) + 1);
		m->input = ARRAY(double, 2 * (size_t)(system->n * system->inputs) + 1);
		find_entries(m, step);
		return m;
	}
	m->differences = !step->model->remainder.slope && step->model->remainder.force_columns > 0;
	for (int i = 0; i < system->n; i++) {
		const mpq_t *row = slopes[0] + highest_state(system, i) * layout.size;
		m->force[i] = force_of(step, &layout, row);
		if (!m->differences && i < m->solved)
			add_entries(m, step, &layout, row, i);
	}
	if (m->differences)
		add_full_entries(m, system);
	find_drive(m, step, &layout, slopes);
	m->listed = any_solved(step, m, LISTED_EQUATIONS);
	m->apart = m->apart || (m->solved < m->coords && m->coords > MOST_TOGETHER && any_solved(step, m, 1));
	return m;
}
