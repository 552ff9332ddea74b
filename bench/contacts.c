/* SPDX-License-Identifier: GPL-3.0-or-later */
/* contacts NAME: times of a step of a model with friction or impacts, by what happens in it, beside a step of the same
 * model without, in short samples that take turns so that all meet the same machine: the least of each, and ratios. Of
 * each kind of step there are up to STEPS, from where a run meets them; those without an event some way apart, and
 * CHAIN of them wait for each other, as those of the other model do. */
#include "contacts_pl.h"
#include "timing.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

extern const pl_model plain_model, contacts_model;

enum { SAMPLES = 501, STEPS = 20, CHAIN = 5, LOOKED_AT = 1000000, APART = 101 };
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

/* Whether CHAIN steps from there are of one kind */
static int goes_on(const contacts *from, enum kind kind, int rubs)
{
	contacts s = *from;
	for (int k = 0; k < CHAIN; k++) {
		const contacts before = s;
		contacts_model.step(&s, NULL);
		if (kind_of(&before, &s, rubs) != kind)
			return 0;
	}
	return 1;
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
		const enum kind kind = kind_of(&before, &s, rubs);
		struct kept *of = &kept[kind];
		const int eventful = kind != FREE && kind != STICKS;
		if (of->count < STEPS && (eventful || (k % APART == 0 && goes_on(&before, kind, rubs))))
			of->from[of->count++] = before;
	}
}

/* So many steps from each; none: what putting the state there costs */
static __attribute__((noinline)) double sample_each(const struct kept *kept, int steps)
{
	contacts s;
	const double start = nanoseconds();
	for (int k = 0; k < STEPS; k++) {
		memcpy(&s, &kept->from[k % kept->count], sizeof s);
		__asm__ volatile("" : : "r"(&s) : "memory");
		for (int i = 0; i < steps; i++)
			contacts_model.step(&s, NULL);
		__asm__ volatile("" : : "r"(&s) : "memory");
	}
	return (nanoseconds() - start) / STEPS;
}

/* Steps that wait for each other, as they do in use */
static __attribute__((noinline)) double sample_plain(void *state, const void *begun)
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
	const int chain[KINDS] = {CHAIN, CHAIN, 1, 1, 1};
	double least[KINDS][2], plain = INFINITY;
	char *state = calloc(2, plain_model.size);
	if (argc < 3 || !state)
		return 2;
	const int rubs = strcmp(argv[2], "friction") == 0;
	look(kept, rubs);
	if (argc > 3) { /* one kind alone, for a count of instructions: KIND STEPS; KINDS: the model without */
		const int kind = atoi(argv[3]);
		if (kind == KINDS)
			plain_model.init(state), sample_plain(state + plain_model.size, state);
		else if (kept[kind].count > 0)
			sample_each(&kept[kind], atoi(argv[4]) * chain[kind]);
		free(state);
		return kind < KINDS && kept[kind].count == 0;
	}
	plain_model.init(state + plain_model.size);
	plain_model.step(state + plain_model.size, NULL);
	for (int i = 0; i < KINDS; i++)
		least[i][0] = least[i][1] = INFINITY;
	for (int sample = 0; sample < SAMPLES; sample++) {
		plain = fmin(plain, sample_plain(state, state + plain_model.size));
		for (int i = 0; i < KINDS; i++)
			for (int k = 0; k < 2 && kept[i].count > 0; k++)
				least[i][k] = fmin(least[i][k], sample_each(&kept[i], k * chain[i]) / chain[i]);
	}
	printf("%s\n    %-20s %8.1f ns\n", argv[1], "without contacts", plain);
	for (int i = 0; i < KINDS; i++)
		if (kept[i].count > 0)
			printf("    %-20s %8.1f ns   %6.2f   of %d steps\n", what[rubs][i], least[i][1] - least[i][0],
			       (least[i][1] - least[i][0]) / plain, kept[i].count);
	free(state);
	return 0;
}
