/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The straight pieces of a table() as numbers. */
#include "collect/collect.h"

/* v: x0, y0, x1, y1, ... */
static int pieces_between(int points, mpq_t *v, struct straight **list)
{
	struct straight *piece = ARRAY(struct straight, points);
	for (int i = 0; i + 1 < points; i++) {
		mpq_srcptr p[4] = { v[2 * i], v[2 * i + 1], v[2 * i + 2], v[2 * i + 3] };
		piece[i] = (struct straight){ .x = p[0], .y = p[1], .end = i + 2 < points ? p[2] : NULL };
		mpq_init(piece[i].slope);
		slope_between(p, piece[i].slope);
	}
	*list = piece;
	return points - 1;
}

int pieces_of_atom(const struct atom *a, struct straight **list)
{
	struct collector collector = { .scheme = "exact" };
	int points = (a->operands - 1) / 2;
	mpq_t *v = rationals(2 * (size_t)points);
	for (int i = 0; i < 2 * points; i++)
		constant_value(&collector, a->operand[i + 1], v[i]);
	return pieces_between(points, v, list);
}

int pieces_of_call(const struct node *node, struct straight **list)
{
	struct collector collector = { .scheme = "exact" };
	int points = (node->children - 1) / 2;
	mpq_t *v = rationals(2 * (size_t)points);
	for (int i = 0; i < 2 * points; i++)
		collect_constant(&collector, node->child[i + 1], v[i]);
	return pieces_between(points, v, list);
}
