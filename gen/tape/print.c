/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A tape as C, in straight lines and, where these are many, in loops. */
#include "tape/print.h"

#include <string.h>

static bool *find_wide(const struct tape *t, const struct tape_target *to)
{
	bool *wide = ARRAY(bool, tape_length(t) + 1);
	for (int i = 0; i < tape_length(t); i++) {
		const struct tape_node *n = tape_node(t, i);
		bool operand = tape_is_operand(t, i) && n->op != TAPE_CONSTANT;
		wide[i] = operand ? to->lanes->varies(to->context, n) : n->op == TAPE_ACCUMULATE;
		const tape_ref ref[3] = { n->a, n->b, n->c };
		for (int k = 0; k < 3; k++)
			wide[i] = wide[i] || (ref[k] != TAPE_NONE && wide[ref[k]]);
	}
	return wide;
}

/* A line that opens or closes a block */
static void print_line(struct printing *p, const char *line)
{
	const size_t length = strlen(line);
	p->indent -= *line == '}' ? 4 : 0;
	if (length > 0)
		fprintf(p->out, "%*s%s\n", p->indent, "", line);
	p->indent += length > 0 && line[length - 1] == '{' ? 4 : 0;
}

void tape_print(const struct tape *t, const struct tape_target *to, FILE *out)
{
	struct printing p = { .t = t, .to = to, .out = out, .uses = tape_uses(t), .indent = to->indent };
	int outs = tape_outs(t);
	p.local = ARRAY(const char *, tape_length(t) + 1);
	p.wide = to->lanes ? find_wide(t, to) : NULL;
	const char **text = ARRAY(const char *, outs + 1);
	p.roll = to->rolls ? roll_new(&p) : NULL;
	for (int i = 0; i < outs; i++) {
		const int end = roll_run(&p, i);
		if (end != TAPE_NONE) {
			i = end - 1;
			continue;
		}
		tape_ref ref = tape_out(t, i)->ref;
		if (!tape_out(t, i)->target) {
			print_line(&p, tape_out(t, i)->note);
			continue;
		}
		text[i] = tape_widened(&p, ref, tape_text(&p, ref, CHOICE, tape_out(t, i)->indent));
		if (!to->locals_first)
			tape_set_text(&p, tape_out(t, i), text[i]);
	}
	for (int i = 0; i < outs && to->locals_first; i++)
		if (text[i])
			tape_set_text(&p, tape_out(t, i), text[i]);
}
