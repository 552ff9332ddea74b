/* SPDX-License-Identifier: GPL-3.0-or-later */
/* contacts NAME: times of a step of a model with friction or impacts, by what happens in it, beside a step of the same
 * model without, in short samples that take turns so that all meet the same machine: the least of each, and ratios. Of
 * each kind of step there are up to STEPS, from where a run meets them; those without an event some way apart. */
#include "contacts_pl.h"
#include "timing.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

extern const pl_model plain_model, contacts_model;

enum { SAMPLES = 501, STEPS = 20, LOOKED_AT = 1000000, APART = 101 };
enum kind { FREE, STICKS, TO_STICK, EVENT, CHANGE, KINDS };
static const char *const what[2][KINDS] = {
    {"clear", "", "", "one impact", "a change of the load"},
    {"slips", "sticks", "slip to stick", "stick to slip", "a change of the load"}};

#ifdef CHANGES /* the loads of the model change their formula */
static int segment_of(const contacts *s) { return s->segment; }
#else
static int segment_of(const contacts *s) { return s == NULL; }
#endif

struct kept { int count; contacts from[STEPS]; };

/* Of a friction law the interval between its two breakpoints, number 1, is where it sticks */
static enum kind kind_of(const contacts *before, const contacts *after, int rubs)
{
	const int sticks = rubs && contacts_region(after) == 1;
	if (segment_of(after) != segment_of(before))
		return CHANGE;
	if (contacts_crossed(after) == contacts_crossed(before))
		return sticks ? STICKS : FREE;
	return sticks ? TO_STICK : EVENT;
}

static void look(struct kept *kept, int rubs)
{
	contacts s;
	contacts_model.init(&s);
	for (int k = 0; k < LOOKED_AT; k++) {
		const contacts before = s;
		contacts_model.step(&s, NULL);
		if (contacts_crossed(&s) > contacts_crossed(&before) + 1)
			continue;
		struct kept *of = &kept[kind_of(&before, &s, rubs)];
		const int eventful = of != &kept[FREE] && of != &kept[STICKS];
		if (of->count < STEPS && (eventful || k % APART == 0))
			of->from[of->count++] = before;
	}
}

/* One step from each; without one: what putting the state there costs */
static double sample_each(const struct kept *kept, int step)
{
	contacts s;
	const double start = nanoseconds();
	for (int k = 0; k < STEPS; k++) {
		memcpy(&s, &kept->from[k % kept->count], sizeof s);
		__asm__ volatile("" : : "r"(&s) : "memory");
		if (step)
			contacts_model.step(&s, NULL);
		__asm__ volatile("" : : "r"(&s) : "memory");
	}
	return (nanoseconds() - start) / STEPS;
}

/* Steps that wait for each other, as they do in use */
static double sample_plain(void *state, const void *begun)
{
	memcpy(state, begun, plain_model.size);
	const double start = nanoseconds();
	for (int k = 0; k < STEPS; k++)
		plain_model.step(state, NULL);
	return (nanoseconds() - start) / STEPS;
}

int main(int argc, char **argv)
{
	static struct kept kept[KINDS];
	double least[KINDS][2], plain = INFINITY;
	char *state = calloc(2, plain_model.size);
	if (argc != 3 || !state)
		return 2;
	const int rubs = strcmp(argv[2], "friction") == 0;
	look(kept, rubs);
	plain_model.init(state + plain_model.size);
	plain_model.step(state + plain_model.size, NULL);
	for (int i = 0; i < KINDS; i++)
		least[i][0] = least[i][1] = INFINITY;
	for (int k = 0; k < SAMPLES; k++) {
		plain = fmin(plain, sample_plain(state, state + plain_model.size));
		for (int i = 0; i < KINDS; i++)
			for (int step = 0; step < 2 && kept[i].count > 0; step++)
				least[i][step] = fmin(least[i][step], sample_each(&kept[i], step));
	}
	printf("%s\n    %-20s %8.1f ns\n", argv[1], "without contacts", plain);
	for (int i = 0; i < KINDS; i++)
		if (kept[i].count > 0)
			printf("    %-20s %8.1f ns   %6.2f   of %d steps\n", what[rubs][i], least[i][1] - least[i][0],
			       (least[i][1] - least[i][0]) / plain, kept[i].count);
	free(state);
	return 0;
}
