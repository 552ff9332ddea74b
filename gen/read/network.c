/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sketches: masses, springs, dampers and what else is drawn between coordinates. */
#include "read/parser.h"

#include <string.h>

/* The velocity of a coordinate that has been read */
static struct node *velocity_of(const struct node *coordinate)
{
	struct node *velocity = node_new(NODE_NAME, coordinate->at);
	*velocity = *coordinate;
	velocity->primes = 1;
	return velocity;
}

/* friction F between x, y: friction(x' - y', F) */
static struct node *friction_between(const struct element *element)
{
	struct node *call = node_new(NODE_CALL, element->value->at), *slide = velocity_of(element->from);
	call->function = FN_FRICTION;
	call->start = element->at;
	call->end = element->end;
	if (element->to) {
		struct node *sum = node_new(NODE_SUM, element->from->at);
		sum->start = element->from->start;
		sum->end = element->to->end;
		add_child(sum, slide, false, element->from->at);
		add_child(sum, velocity_of(element->to), true, element->to->at);
		slide = sum;
	}
	add_child(call, slide, false, element->value->at);
	add_child(call, element->value, false, element->value->at);
	return call;
}

/* mass: mass expression at coordinate;  spring, damper, friction: ... expression between coordinate , coordinate;
 * force: force expression on coordinate */
static void read_element(struct parser *p, int kind)
{
	struct spec *spec = p->spec;
	struct element element = { .kind = kind, .part = p->part };
	element.at = (struct place){ p->lexer.source, p->statement };
	element.value = read_quantity(p);
	const bool at = p->token.kind == TOKEN_NAME && strcmp(p->token.name, "at") == 0;
	if (kind == ELEMENT_FORCE && (at || is_op(p, ","))) {
		read_point_force(p, element.value);
		return;
	}
	expect_word(p, kind == ELEMENT_MASS ? "at" : kind == ELEMENT_FORCE ? "on" : "between");
	bool two = kind == ELEMENT_SPRING || kind == ELEMENT_DAMPER || kind == ELEMENT_FRICTION;
	struct token first = p->token;
	element.from = read_coordinate(p, two);
	if (two) {
		expect_op(p, ",", "','");
		element.to = read_coordinate(p, true);
	}
	if (two && !element.from) {
		element.from = element.to;
		element.to = NULL;
	}
	if (!element.from || (element.to && element.from->symbol == element.to->symbol &&
			      element.from->component == element.to->component))
		error(first.at, NULL, "it acts between a coordinate and itself");
	expect_end(p);
	element.end = p->end;
	if (kind == ELEMENT_FRICTION)
		element.value = friction_between(&element);
	*MORE(spec->element, spec->elements) = element;
}

void read_mass(struct parser *p) { read_element(p, ELEMENT_MASS); }
void read_spring(struct parser *p) { read_element(p, ELEMENT_SPRING); }
void read_damper(struct parser *p) { read_element(p, ELEMENT_DAMPER); }
void read_force(struct parser *p) { read_element(p, ELEMENT_FORCE); }
void read_friction(struct parser *p) { read_element(p, ELEMENT_FRICTION); }

/* ---- drawings: what a page shows; they change nothing that is computed ---- */

/* point: ( expression , expression ) | expression [ , expression ] */
static void read_point(struct parser *p, struct node **point)
{
	const bool bracket = is_op(p, "(") && has_two_arguments(p);
	if (bracket)
		take(p);
	point[0] = read_quantity(p);
	if (bracket)
		expect_op(p, ",", "','");
	if (bracket || take_op(p, ","))
		point[1] = read_quantity(p);
	if (bracket)
		expect_op(p, ")", "')' or an operator");
}

/* draw: draw ( mass | wheel | joint | ground ) at point [ radius expression ] [ turned expression ]
 * | draw ( rod | spring | damper ) from point to point */
void read_draw(struct parser *p)
{
	static const char *const known[] = { "mass", "wheel", "joint", "ground", "rod", "spring", "damper" };
	enum { AT = 4, KNOWN = 7 };
	struct drawing drawing = { .part = p->part, .at = { p->lexer.source, p->statement } };
	int kind = 0;
	while (kind < KNOWN && !take_word(p, known[kind]))
		kind++;
	if (kind == KNOWN)
		unexpected(p, "mass, wheel, joint or ground, or rod, spring or damper");
	drawing.what = known[kind];
	drawing.points = kind < AT ? 1 : 2;
	expect_word(p, kind < AT ? "at" : "from");
	read_point(p, drawing.point[0]);
	if (kind >= AT) {
		expect_word(p, "to");
		read_point(p, drawing.point[1]);
	}
	if (kind < AT && take_word(p, "radius"))
		drawing.radius = read_quantity(p);
	if (kind < AT && take_word(p, "turned"))
		drawing.turn = read_quantity(p);
	expect_end(p);
	drawing.end = p->end;
	*MORE(p->spec->page.drawing, p->spec->page.drawings) = drawing;
}

int nodes_of_drawing(const struct drawing *d, struct node **node)
{
	struct node *const all[] = { d->point[0][0], d->point[0][1], d->point[1][0], d->point[1][1], d->radius,
				     d->turn };
	int count = 0;
	for (int i = 0; i < MOST_DRAWN; i++)
		if (all[i])
			node[count++] = all[i];
	return count;
}
