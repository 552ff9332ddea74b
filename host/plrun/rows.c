/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rows of a run as CSV: t, then the outputs. */
#include "plrun.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

struct rows {
	FILE *to;
	const struct machine *machine;
	double h;
	uint64_t every;
	char *text;
};

static void check_written(bool written)
{
	if (!written)
		fail(WRONG_DATA, format("cannot write the rows: %s", strerror(errno)));
}

struct rows *rows_new(FILE *to, const struct machine *m, double h, uint64_t every)
{
	struct rows *r = need(calloc(1, sizeof *r));
	*r = (struct rows){ to, m, h, every, need(malloc(LONGEST * (size_t)(m->outputs + 2))) };
	return r;
}

static void print_names(const struct rows *r)
{
	fputs("t", r->to);
	for (int i = 0; i < r->machine->outputs; i++)
		fprintf(r->to, ",%s", r->machine->output_names[i]);
	check_written(putc('\n', r->to) != EOF);
}

void rows_add(void *who, uint64_t k, const double *out)
{
	struct rows *r = who;
	if (k == 0)
		print_names(r);
	if (k % r->every)
		return;
	char *end = put_time(r->text, k, r->h, r->machine->single);
	for (int i = 0; i < r->machine->outputs; i++) {
		*end++ = ',';
		end = put_shortest(end, out[i], r->machine->single);
	}
	*end++ = '\n';
	size_t length = (size_t)(end - r->text);
	check_written(fwrite(r->text, 1, length, r->to) == length);
}

void rows_end(struct rows *r)
{
	check_written(fflush(r->to) == 0 && !ferror(r->to));
	free(r->text);
	free(r);
}
