/* SPDX-License-Identifier: GPL-3.0-or-later */
/* steps LABEL RUBS: times of steps of two models, `subject` and `plain`, by what happens in them, in short samples that
 * take turns so that all meet the same machine: the least of each, and how many times as long the subject's are. Of
 * each kind there are up to STEPS, from where a run meets them; those without an event some way apart, and CHAIN of
 * them wait for each other, as steps do in use. RUBS: 1 where the model has one friction force, else 0.
 *
 * steps LABEL RUBS MODEL KIND PARTS: of one model (0: the subject) and kind so many parts of a sample, 0 or 1, for a
 * count of instructions; status 1 where the model has no such step. */
#include "plrt.h"
#include "timing.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SAMPLES = 501, STEPS = 20, CHAIN = 20, RUN = 2000, LOOKED_AT = 400000, APART = 101, MODELS = 2 };
enum kind { CLEAR, STICKS, TO_STICK, EVENT, CHANGE, AS_IT_COMES, ROWS, KINDS };
static const char *const names[2][KINDS] = {
	{"clear", "", "", "an event", "a change of the load", "a run", "a row of run"},
	{"slips", "sticks", "slip to stick", "stick to slip", "a change of the load", "a run", "a row of run"}};

/* What a model has of these; steps.sh adds NAME_segment */
#define OF_MODEL(name)                                                             \
	extern const pl_model name##_model;                                        \
	__attribute__((weak)) uint64_t name##_crossed(const void *s);              \
	__attribute__((weak)) int name##_region(const void *s), name##_segment(const void *s);
OF_MODEL(subject)
OF_MODEL(plain)

struct measured {
	const pl_model *model;
	uint64_t (*crossed)(const void *s);
	int (*region)(const void *s), (*segment)(const void *s);        /* each NULL: it has none */
	char *state, *from[KINDS];      /* STEPS states of each kind */
	double *rows;
	int count[KINDS];
	double least[KINDS][2];         /* ns; of putting the state there, with the steps */
};

/* Of a friction law the interval between its two breakpoints, number 1, is where it sticks; KINDS: of none */
static enum kind kind_of(const struct measured *m, const void *before, const void *after, int rubs)
{
	const uint64_t events = m->crossed ? m->crossed(after) - m->crossed(before) : 0;
	const int sticks = rubs && m->region && m->region(after) == 1;
	if (m->segment && m->segment(after) != m->segment(before))
		return events ? KINDS : CHANGE;
	if (events == 0)
		return sticks ? STICKS : CLEAR;
	return events > 1 ? KINDS : sticks ? TO_STICK : EVENT;
}

/* Whether CHAIN steps from there are of one kind */
static int goes_on(const struct measured *m, const char *from, enum kind kind, int rubs)
{
	char state[m->model->size], before[m->model->size];
	memcpy(state, from, sizeof state);
	for (int k = 0; k < CHAIN; k++) {
		memcpy(before, state, sizeof state);
		m->model->step(state, NULL);
		if (kind_of(m, before, state, rubs) != kind)
			return 0;
	}
	return 1;
}

static void look(struct measured *m, int rubs)
{
	const size_t size = m->model->size;
	char before[size];
	m->state = calloc(1 + KINDS * STEPS, size);
	m->rows = calloc(RUN, (size_t)m->model->outputs * sizeof *m->rows);
	if (!m->state || !m->rows)
		exit(1);
	for (int i = 0; i < KINDS; i++) {
		m->from[i] = m->state + (size_t)(1 + i * STEPS) * size;
		m->least[i][0] = m->least[i][1] = INFINITY;
	}
	m->model->init(m->state);
	for (int i = AS_IT_COMES; i <= ROWS; i++) {
		memcpy(m->from[i], m->state, size);
		m->count[i] = 1;
	}
	for (int k = 0; k < LOOKED_AT; k++) {
		memcpy(before, m->state, size);
		m->model->step(m->state, NULL);
		const enum kind kind = kind_of(m, before, m->state, rubs);
		if (kind != KINDS && m->count[kind] < STEPS &&
		    (kind > STICKS || (k % APART == 0 && goes_on(m, before, kind, rubs))))
			memcpy(m->from[kind] + (size_t)m->count[kind]++ * size, before, size);
	}
}

/* A sample begins with so many states, and takes so many steps from each */
static int states_of(enum kind kind)
{
	return kind >= AS_IT_COMES ? 1 : STEPS;
}

static int chain_of(enum kind kind)
{
	return kind <= STICKS ? CHAIN : kind < AS_IT_COMES ? 1 : RUN;
}

/* Of a step, parts 0: what putting its state there costs */
static __attribute__((noinline)) double sample(const struct measured *m, enum kind kind, int parts)
{
	const int from = states_of(kind), chain = chain_of(kind);
	const double start = own_nanoseconds();
	for (int k = 0; k < from; k++) {
		memcpy(m->state, m->from[kind] + (size_t)(k % m->count[kind]) * m->model->size, m->model->size);
		__asm__ volatile("" : : "r"(m->state) : "memory");
		if (kind == ROWS && parts)
			m->model->run(m->state, RUN, NULL, m->rows);
		for (int i = 0; kind != ROWS && i < parts * chain; i++)
			m->model->step(m->state, NULL);
	}
	return (own_nanoseconds() - start) / (from * chain);
}

static double took(const struct measured *m, enum kind kind)
{
	return m->least[kind][1] - m->least[kind][0];
}

/* Over the same of the other model, or over a step of it without an event */
static void report(const struct measured *m, const char *label, int rubs)
{
	printf("%s:\n", label);
	for (int i = 0; i < KINDS; i++) {
		const double own = took(m, i), other = took(&m[1], m[1].count[i] > 0 ? i : CLEAR);
		if (m->count[i] > 0)
			printf("    %-20s %8.1f ns, of the other %8.1f, %6.2f times\n", names[rubs][i], own, other,
			       own / other);
	}
}

int main(int argc, char **argv)
{
	static struct measured m[MODELS] = {
		{&subject_model, subject_crossed, subject_region, subject_segment, NULL, {NULL}, NULL, {0}, {{0}}},
		{&plain_model, plain_crossed, plain_region, plain_segment, NULL, {NULL}, NULL, {0}, {{0}}}};
	if (argc != 3 && argc != 6)
		return 2;
	const int rubs = atoi(argv[2]);
	if (argc == 6) {
		struct measured *one = &m[atoi(argv[3])];
		const int kind = atoi(argv[4]);
		look(one, rubs);
		if (one->count[kind] > 0)
			sample(one, kind, atoi(argv[5]));
		printf("%d\n", states_of(kind) * chain_of(kind));
		return one->count[kind] == 0;
	}
	for (int of = 0; of < MODELS; of++)
		look(&m[of], rubs);
	for (int k = 0; k < SAMPLES; k++)
		for (int i = 0; i < KINDS; i++)
			for (int j = 0; j < 2 * MODELS; j++)
				if (m[j / 2].count[i] > 0) {
					double *least = &m[j / 2].least[i][j % 2];
					*least = fmin(*least, sample(&m[j / 2], i, j % 2));
				}
	report(m, argv[1], rubs);
	return 0;
}
