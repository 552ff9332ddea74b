/* SPDX-License-Identifier: GPL-3.0-or-later */
/* NAME_X_..., NAME_IN_..., NAME_OUT_... and NAME_P_... against the descriptor's names, which the generator keeps in
 * tables of its own. */
#include "index_names.h"
#include "tap.h"

#include <stddef.h>
#include <string.h>

struct place {
	int index;
	const char *name;
};
static const struct place states[] = {
	{CLASH_X_k, "k"}, {CLASH_X_K, "K"}, {CLASH_X_x_dot_2, "x_dot"}, {CLASH_X_X, "x"}, {CLASH_X_Q_1, "q[1]"},
	{CLASH_X_Q_2, "q[2]"}, {CLASH_X_k_dot, "k'"}, {CLASH_X_K_dot, "K'"}, {CLASH_X_X_DOT_DOT, "x_dot'"},
	{CLASH_X_x_dot_9, "x'"}, {CLASH_X_Q_1_DOT, "q[1]'"}, {CLASH_X_Q_2_DOT, "q[2]'"}
};
static const struct place inputs[] = {{CLASH_IN_push, "push"}, {CLASH_IN_Push, "Push"}};
static const struct place outputs[] = {
	{CLASH_OUT_SHAFT, "shaft"}, {CLASH_OUT_X_DOT, "x'"}, {CLASH_OUT_Q_1, "q[1]"}, {CLASH_OUT_Q_2, "q[2]"},
	{CLASH_OUT_X_DDOT, "x''"}
};
static const struct place params[] = {{CLASH_P_STIFF, "stiff"}, {CLASH_P_c, "c"}, {CLASH_P_C, "C"}};

static void check(const char *what, const struct place *place, size_t count, const char *const *name, int names)
{
	bool good = (size_t)names == count;
	for (size_t i = 0; i < count && good; i++) {
		good = place[i].index == (int)i && strcmp(name[i], place[i].name) == 0;
		if (!good)
			note("%s %d is \"%s\", in the descriptor \"%s\"", what, place[i].index, place[i].name, name[i]);
	}
	ok(good, "%s: %d names of places, the descriptor has %d", what, (int)count, names);
}

#define COUNT(array) (sizeof array / sizeof *array)

int main(void)
{
	check("states", states, COUNT(states), clash_model.state_names, clash_model.states);
	check("inputs", inputs, COUNT(inputs), clash_model.input_names, clash_model.inputs);
	check("outputs", outputs, COUNT(outputs), clash_model.output_names, clash_model.outputs);
	check("params", params, COUNT(params), clash_model.param_names, clash_model.params);
	return tap_end();
}
