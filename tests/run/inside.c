/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The C of a model, run inside the generator:
 *     inside MODEL.spec STEPS REAL [SCHEME]
 * prints time, states and outputs after each step, slopes of NAME_rhs at the end, and the status, as bits. Inputs are
 * those of drive.c. To standard error what the last step took, counted as it ran, and as the program of the step has
 * it. */
#include <stdlib.h>
#include <string.h>
#include "run/run.h"

static void print_row(char name, const double *value, int count)
{
	printf("%c", name);
	for (int i = 0; i < count; i++)
		printf(" %a", value[i]);
	putchar('\n');
}

static struct counted difference(struct counted now, struct counted before)
{
	return (struct counted){now.multiplications - before.multiplications, now.additions - before.additions,
							now.calls - before.calls, now.forcings - before.forcings, 0, 0,
									0, 0};
}

static void print_counts_of(const struct program *program, const struct counted *took)
{
	fprintf(stderr, "counted %llu %llu %llu\n", (unsigned long long)took->multiplications,
			(unsigned long long)took->additions, (unsigned long long)took->calls);
	fprintf(stderr, "written %d %d %d\n", program->multiplications, program->additions, program->calls);
}

struct asked { const char *file, *scheme; long steps; bool single; };

static void run(void *context)
{
	const struct asked *asked = context;
	const struct request request = { .scheme = asked->scheme, .form = FORM_AUTO, .single = asked->single };
	const struct source *source = source_read(asked->file, (struct place){ 0 });
	struct spec *spec = source ? parse_spec(source) : NULL;
	struct model *model = spec ? model_build(spec, &request) : NULL;
	model = model ? stepped_model(model, spec, &request) : NULL;
	struct step *step = model ? step_build(model) : NULL;
	if (!step)
		abandon();
	const char *why;
	struct running *r = running_new((struct place){ source, 0 }, step, WITH_RHS | WITH_COUNTS, &why);
	if (!r)
		error((struct place){ source, 0 }, NULL, "%s", why);
	int states = model->written->system.states;
	double value[600], u[64];
	struct counted took = {0};
	running_start(r, 0, NULL);
	for (long n = 0; n < asked->steps; n++) {
		for (int i = 0; i < model->system.inputs; i++)
			u[i] = (double)((n * 7 + i * 3) % 11 - 5) / 8;
		const struct counted before = running_counted(r);
		running_step(r, u);
		took = difference(running_counted(r), before);
		value[0] = running_time(r);
		print_row('t', value, 1);
		running_state(r, value);
		print_row('y', value, states);
		running_outputs(r, value);
		print_row('o', value, model->outputs);
	}
	running_state(r, value);
	for (int i = 0; i < model->system.inputs; i++)
		u[model->system.inputs + i] = (double)(i + 1) / 4;
	running_rhs(r, running_time(r), value, u, value + 300);
	print_row('r', value + 300, states);
	printf("s %d\n", running_status(r));
	print_counts_of(step->program, &took);
}

int main(int argc, char **argv)
{
	struct asked asked = { .file = argv[1] };
	memory_open();
	if (argc < 4)
		return 2;
	asked.steps = atol(argv[2]);
	asked.single = strcmp(argv[3], "float") == 0;
	asked.scheme = argc > 4 ? argv[4] : NULL;
	if (asked.single)
		target_float();
	bool done = statement_guard(run, &asked);
	diagnostics_print(stderr);
	return !done;
}
