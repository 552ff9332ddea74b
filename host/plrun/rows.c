/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rows of a run: t, then the outputs, as CSV or as doubles. */
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
	double *raw;                            /* a row; NULL: as text */
};

static void check_written(bool written)
{
	if (!written)
		fail(WRONG_DATA, format("cannot write the rows: %s", strerror(errno)));
}

struct rows *rows_new(FILE *to, const struct machine *m, double h, uint64_t every, bool raw)
{
	struct rows *r = need(calloc(1, sizeof *r));
	*r = (struct rows){ to, m, h, every, need(malloc(LONGEST * (size_t)(m->outputs + 2))),
			    raw ? need(malloc(sizeof(double) * (size_t)(m->outputs + 1))) : NULL };
	return r;
}

static void print_names(const struct rows *r)
{
	fputs("t", r->to);
	for (int i = 0; i < r->machine->outputs; i++)
		fprintf(r->to, ",%s", r->machine->output_names[i]);
	check_written(putc('\n', r->to) != EOF);
}

static void add_raw(const struct rows *r, uint64_t k, const double *out)
{
	const size_t outputs = (size_t)r->machine->outputs;
	r->raw[0] = time_number(k, r->h, r->machine->single);
	memcpy(r->raw + 1, out, sizeof *out * outputs);
	check_written(fwrite(r->raw, sizeof *r->raw, outputs + 1, r->to) == outputs + 1);
}

void rows_add(void *who, uint64_t k, const double *out)
{
	struct rows *r = who;
	if (k == 0 && !r->raw)
		print_names(r);
	if (k % r->every)
		return;
	if (r->raw) {
		add_raw(r, k, out);
		return;
	}
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
	free(r->raw);
	free(r);
}
