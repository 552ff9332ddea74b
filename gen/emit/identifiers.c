/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What symbols of a spec are called in C: a coordinate x is the local x, its velocity x_dot. */
#include "text.h"
#include "model/linear/relative.h"

#include <string.h>

enum { BUCKETS = 1 << 12 };

struct taken {
	const char *name;
	struct taken *next;
};
struct identifier {                 /* of a symbol; [1]: of its first derivative */
	const char *name[2];
	const char **component[2];  /* of a vector coordinate */
};
struct identifiers {
	struct taken *taken[BUCKETS]; /* by name: those given away so far */
	const char *model, *upper;  /* what begins with one of these and _ is generated */
	int symbols;
	struct identifier *symbol;  /* by the symbols' numbers */
};

/* What the generated functions use themselves. */
static const char *const own_names[] = {
	"s", "y", "t", "u", "out", "dydt", "residual", "envelope", "factor", "left", "remainder", "node", "which",
	"start", "slope", "interval", "excess", "now", "first", "turn", "rotated", "samples", "cell", "clear",
	"real", "tau", "when", "segment", "span", "terms", "c", "e", "mass", "miss", "conserved",
	"fabs", "fmin", "fmax", "pow"   /* of <math.h>, which no function of a spec is named after */
};

static bool begins_with(const char *name, const char *prefix)
{
	size_t length = strlen(prefix);
	return strncmp(name, prefix, length) == 0 && name[length] == '_';
}

/* load2, part3, ...: the locals of generated functions */
static bool is_load_local(const char *name)
{
	static const char *const stem[] =
		{ "forcing", "load", "part", "left", "remainder", "flow", "stage", "driven", "accel", "end",
					    "from", "to", "off", "before", "lead", "kicked", "drifted" };
	for (size_t i = 0; i < sizeof stem / sizeof *stem; i++) {
		size_t length = strlen(stem[i]);
		const char *number = strncmp(name, stem[i], length) == 0 ? name + length : "";
		if (*number && strspn(number, "0123456789") == strlen(number))
			return true;
	}
	return false;
}

/* x_3, x_by_y: coefficients and products of series */
static bool is_series_local(const char *name)
{
	const char *last = strrchr(name, '_');
	return strstr(name, "_by_") || (last && last[1] && strspn(last + 1, "0123456789") == strlen(last + 1));
}

static bool is_taken(const struct identifiers *c, const char *name)
{
	if (place_among(sizeof own_names / sizeof *own_names, own_names, name, strlen(name)) >= 0 ||
	    is_load_local(name))
		return true;
	for (const struct taken *t = c->taken[name_hash(name) % BUCKETS]; t; t = t->next)
		if (strcmp(name, t->name) == 0)
			return true;
	return false;
}

static bool is_generated(const struct identifiers *c, const char *name)
{
	return begins_with(name, c->model) || begins_with(name, c->upper);
}

static const char *claim(struct identifiers *c, const char *wish)
{
	char *own = format("%s", wish);         /* front.body, momentum(x): front_body, momentum_x_ */
	for (char *sign = own; (sign = strpbrk(sign, ".()[]"));)
		*sign = '_';
	const char *name = may_be_macro(own) ? format("v%s", own) : own;
	while (is_generated(c, name) || is_taken(c, name) || may_be_macro(name))
		name = is_generated(c, name) ? format("v%s", name) : format("%s_", name);
	struct taken **first = &c->taken[name_hash(name) % BUCKETS], *taken = NEW(struct taken);
	*taken = (struct taken){ name, *first };
	*first = taken;
	return name;
}

const char *c_name(const struct identifiers *c, const struct symbol *s, int order)
{
	return c->symbol[s->number].name[order];
}

const char *written_local(const struct identifiers *c, const struct model *written, int state)
{
	int coord = written->system.coord[state], order = state >= written->n;
	const struct symbol *s = written->frame.coord[coord];
	return s->length ? c->symbol[s->number].component[order][coord - s->index] : c_name(c, s, order);
}

/* s'' as s_dot_dot, q[1] as q1, (a - b)' as a_from_b_dot; a factor in front goes */
static const char *identifier(const char *name)
{
	const char *text = "";
	for (; *name; name++) {
		const char *times = strchr(name, '*');
		if (times && strspn(name, "0123456789./-e") == (size_t)(times - name))
			name = times + 1;
		if (strncmp(name, " - ", 3) == 0) {
			text = format("%s_from_", text);
			name += 2;
		} else if (*name == '\'') {
			text = format("%s_dot", text);
		} else if (!strchr("[]()", *name)) {
			text = format("%s%c", text, *name);
		}
	}
	return text;
}

/* An input is a local beside series; a coordinate is one of them. */
static const char *claim_of(struct identifiers *c, const struct symbol *s, const char *wish)
{
	return claim(c, s->kind == SYMBOL_INPUT && is_series_local(wish) ? format("%s_in", wish) : wish);
}

static void name_symbols(struct identifiers *c, const struct spec *spec)
{
	for (const struct symbol *s = spec->first; s; s = s->next)
		if (s->kind != SYMBOL_OUTPUT && s->kind < SYMBOL_PART_OUTPUT)
			c->symbol[s->number].name[0] = claim_of(c, s, s->name);
	for (const struct symbol *s = spec->first; s; s = s->next) {
		struct identifier *own = &c->symbol[s->number];
		if (s->kind == SYMBOL_COORD || s->kind == SYMBOL_INPUT)
			own->name[1] = claim_of(c, s, format("%s_dot", s->name));
		for (int order = 0; order < 2; order++)
			own->component[order] = ARRAY(const char *, (size_t)s->length);
		for (int i = 0; i < s->length; i++) {
			own->component[0][i] = claim_of(c, s, format("%s%d", s->name, i + 1));
			own->component[1][i] = claim_of(c, s, format("%s%d_dot", s->name, i + 1));
		}
	}
}

/* The state that is a written one; -1: none is */
static int place_of_written(const struct model *model, int state)
{
	if (model->reduction.place)
		return model->reduction.place[state];
	return model->relative ? relative_place(model, state) : state;
}

struct identifiers *identifiers_of(const struct model *model, const char *upper, const char **local)
{
	struct identifiers *c = NEW(struct identifiers);
	*c = (struct identifiers){ .model = model->name, .upper = upper, .symbols = model->spec->count.symbols };
	c->symbol = ARRAY(struct identifier, (size_t)c->symbols + 1);
	name_symbols(c, model->spec);
	for (int i = 0; i < model->written->system.states; i++) {
		int place = place_of_written(model, i);
		if (place >= 0)
			local[place] = written_local(c, model->written, i);
	}
	for (int i = 0; i < model->system.states; i++)
		if (!local[i])
			local[i] = claim(c, identifier(model->names.state[i]));
	return c;
}
