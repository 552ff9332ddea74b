/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the machine can do in the instructions that this is compiled for, and what a model takes beside it: both in
 * short samples that take turns, so that all meet the same machine, and of each the least.
 *
 *     limits              as lines `machine WHAT ns`, WHAT being
 *         lanes           doubles in a vector (a count)
 *         add multiply fused forward     latency of one; forward: what is stored and loaded again
 *         adds multiplies mixed fuseds loads stores   time of each of many, vectors that wait for nothing
 *         memset          of as many bytes in memory as a vector has
 *     and as lines `model WHAT ns`: a step, a row of `run` that stays near, a row of `run` that goes to memory
 *
 * Compiled with -DMODEL=NAME, and linked with the model and the runtime. */
#include "plrt.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define JOIN(a, b) a##b
#define DESCRIPTOR(name) JOIN(name, _model)
extern const pl_model DESCRIPTOR(MODEL);
static const pl_model *const model = &DESCRIPTOR(MODEL);

#if defined __AVX512F__
enum { LANES = 8 };
#elif defined __AVX__
enum { LANES = 4 };
#else
enum { LANES = 2 };
#endif
typedef double lanes __attribute__((vector_size(8 * LANES)));

/* The compiler takes it for changed */
#if defined __AVX512F__
#define HOLD(x) __asm__ volatile("" : "+v"(x))
#elif defined __x86_64__
#define HOLD(x) __asm__ volatile("" : "+x"(x))
#else
#define HOLD(x) __asm__ volatile("" : "+w"(x))
#endif
#define FENCE() __asm__ volatile("" : : : "memory")

#if defined __FMA__ || defined __ARM_FEATURE_FMA
#define HAS_FUSED 1
#endif

enum { TIMES = 400, SAMPLES = 400, ROWS = 256, FAR_BYTES = 1 << 25, FAR_ROWS = 1 << 14,
	   FAR_SAMPLES = 16 };

/* Long samples in time of the processor: others take it away in between */
static double nanoseconds(int samples)
{
	struct timespec t;
	clock_gettime(samples == FAR_SAMPLES ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC, &t);
	return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

/* ---- the machine ---- */

static double one = 1, almost = 1 - 1e-16, little = 1e-30;
static lanes near_by[128];
static double *far_away;

#define FOUR(x) x x x x
#define TEN(m) m(0) m(1) m(2) m(3) m(4) m(5) m(6) m(7) m(8) m(9)

#define CHAIN(name, operation)                                   \
	static int name(void)                                    \
	{                                                        \
		double x = one, a = almost, b = little;          \
		HOLD(a);                                         \
		HOLD(b);                                         \
		for (int k = 0; k < TIMES; k++) {                \
			FOUR(operation; HOLD(x);)                \
		}                                                \
		one = x != x ? x : 1;                            \
		return 4 * TIMES;                                \
	}
CHAIN(chain_add, x += b)
CHAIN(chain_multiply, x *= a)
#ifdef HAS_FUSED
CHAIN(chain_fused, x = __builtin_fma(x, a, b))
#endif

static int chain_forward(void)
{
	static double place[8];
	double x = one;
	for (int k = 0; k < TIMES; k++) {
		FOUR(place[0] = x; FENCE(); x = place[0]; HOLD(x);)
	}
	one = x != x ? x : 1;
	return 4 * TIMES;
}

#define START(i) lanes x##i = near_by[i]; HOLD(x##i);
#define KEEP(i) near_by[i] = x##i;
#define ADD(i) x##i += b; HOLD(x##i);
#define MULTIPLY(i) x##i *= a; HOLD(x##i);
#define MIX(i) if (i % 2) x##i += b; else x##i *= a; HOLD(x##i);
#define LOAD(i) x##i = near_by[16 + i]; HOLD(x##i);
#define STORE(i) near_by[16 + i] = x##i; FENCE();

#define STREAM(name, operation)                                  \
	static int name(void)                                    \
	{                                                        \
		lanes a = near_by[100], b = near_by[101];        \
		TEN(START)                                       \
		HOLD(a);                                         \
		HOLD(b);                                         \
		for (int k = 0; k < TIMES; k++) {                \
			TEN(operation)                           \
		}                                                \
		TEN(KEEP)                                        \
		return 10 * TIMES;                               \
	}
STREAM(stream_add, ADD)
STREAM(stream_multiply, MULTIPLY)
STREAM(stream_mixed, MIX)
STREAM(stream_load, LOAD)
STREAM(stream_store, STORE)
#ifdef HAS_FUSED
/* Contracted as the compiler does by itself */
#define FUSE(i) x##i = x##i * a + b; HOLD(x##i);
STREAM(stream_fused, FUSE)
#endif

static int fill_memory(void)
{
	memset(far_away, 1, FAR_BYTES);
	FENCE();
	return FAR_BYTES / (int)sizeof(lanes);
}

/* ---- the model ---- */

static void *state;
static double *u, *out;

static int steps(void)
{
	for (int k = 0; k < ROWS; k++)
		model->step(state, model->inputs > 0 ? u : NULL);
	return ROWS;
}

static int rows(void)
{
	model->run(state, ROWS, model->inputs > 0 ? u : NULL, out);
	return ROWS;
}

/* The next part of the memory, in turn */
static int far_rows(void)
{
	const int columns = model->outputs > 0 ? model->outputs : 1, count = FAR_BYTES / 8 / columns;
	static int from;
	if (from + FAR_ROWS > count)
		from = 0;
	for (int done = 0; done < FAR_ROWS; done += ROWS, from += ROWS)
		model->run(state, ROWS, model->inputs > 0 ? u : NULL, far_away + (long)from * columns);
	return FAR_ROWS;
}

static struct probe {
	const char *kind, *name;
	int (*take)(void);          /* how many it took */
	int samples;
	double least;
} probe[] = {
	{ "machine", "add", chain_add, SAMPLES, 1e300 },
	{ "machine", "multiply", chain_multiply, SAMPLES, 1e300 },
#ifdef HAS_FUSED
	{ "machine", "fused", chain_fused, SAMPLES, 1e300 },
	{ "machine", "fuseds", stream_fused, SAMPLES, 1e300 },
#endif
	{ "machine", "forward", chain_forward, SAMPLES, 1e300 },
	{ "machine", "adds", stream_add, SAMPLES, 1e300 },
	{ "machine", "multiplies", stream_multiply, SAMPLES, 1e300 },
	{ "machine", "mixed", stream_mixed, SAMPLES, 1e300 },
	{ "machine", "loads", stream_load, SAMPLES, 1e300 },
	{ "machine", "stores", stream_store, SAMPLES, 1e300 },
	{ "machine", "memset", fill_memory, FAR_SAMPLES, 1e300 },
	{ "model", "step", steps, SAMPLES, 1e300 },
	{ "model", "run", rows, SAMPLES, 1e300 },
	{ "model", "run_to_memory", far_rows, FAR_SAMPLES, 1e300 }
};
enum { PROBES = sizeof probe / sizeof *probe };

static void sample(struct probe *p)
{
	if (strcmp(p->kind, "model") == 0)
		model->init(state);         /* as long a run from the same start, whatever it grows to */
	double start = nanoseconds(p->samples);
	int taken = p->take();
	double each = (nanoseconds(p->samples) - start) / taken;
	if (each < p->least)
		p->least = each;
}

int main(void)
{
	state = malloc(model->size);
	u = calloc((size_t)ROWS * (size_t)model->inputs + 1, sizeof *u);
	out = calloc((size_t)ROWS * (size_t)model->outputs + 1, sizeof *out);
	far_away = malloc(FAR_BYTES);
	if (!state || !u || !out || !far_away)
		return 1;
	memset(far_away, 1, FAR_BYTES);
	for (int k = 0; k < SAMPLES; k++)
		for (int i = 0; i < PROBES; i++)
			if (k < probe[i].samples)
				sample(&probe[i]);
	printf("machine lanes %d\n", LANES);
	for (int i = 0; i < PROBES; i++)
		printf("%s %s %.6g\n", probe[i].kind, probe[i].name, probe[i].least);
	return 0;
}
