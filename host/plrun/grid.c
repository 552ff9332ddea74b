/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of a sweep over ranges, k=1:10:5 or k=1:1000:4:log: every combination of their values, those of the last
 * range changing fastest. */
#define _GNU_SOURCE
#include "plrun.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_ROWS = 10000000 };

static const char FORM[] = "--sweep takes FILE.csv or NAME=FROM:TO:COUNT[:log], found '%s'";

bool is_range(const char *text)
{
	const size_t name = strspn(text, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789.");
	return name > 0 && text[name] == '=';
}

struct range range_of(const char *text)
{
	struct range r = { .name = need(strndup(text, strcspn(text, "="))) };
	char *copy = need(strdup(text + strlen(r.name) + 1)), *word[4] = { NULL }, *rest = copy;
	int words = 0;
	double count = 0;
	for (char *part; (part = strsep(&rest, ":")) != NULL; words++)
		if (words < 4)
			word[words] = part;
	r.log = words == 4 && strcmp(word[3], "log") == 0;
	if (words < 3 || words > 4 || (words == 4 && !r.log) || !read_number(word[0], &r.from) ||
	    !read_number(word[1], &r.to) || !read_number(word[2], &count))
		wrong_usage(format(FORM, text));
	if (r.from == r.to)
		wrong_usage(format("--sweep %s: a range ends elsewhere than it begins", text));
	if (count < 2 || count > MOST_ROWS || count != floor(count))
		wrong_usage(format("--sweep %s: a range has 2 to %d values", text, MOST_ROWS));
	if (r.log && !(r.from > 0 && r.to > 0))
		wrong_usage(format("--sweep %s: a logarithmic range is above 0", text));
	r.count = (size_t)count;
	free(copy);
	return r;
}

/* Value `i` in 15 digits, of which a range in tenths has one; the ends are as they were given. */
static void print_value(FILE *to, const struct range *r, size_t i)
{
	const long double part = (long double)i / (long double)(r->count - 1), from = r->from, end = r->to;
	const long double value = i == 0 ? from : i == r->count - 1 ? end
				: r->log ? from * powl(end / from, part) : from + (end - from) * part;
	fprintf(to, "%.15Lg", value);
}

char *grid_text(const struct range *range, size_t ranges, size_t *length)
{
	char *text;
	size_t rows = 1;
	FILE *to = need(open_memstream(&text, length));
	for (size_t i = 0; i < ranges; i++) {
		fprintf(to, "%s%s", i ? "," : "", range[i].name);
		if (range[i].count > MOST_ROWS / rows)
			wrong_usage(format("--sweep: more than %d runs", MOST_ROWS));
		rows *= range[i].count;
	}
	putc('\n', to);
	for (size_t row = 0; row < rows; row++) {
		size_t each = rows;
		for (size_t i = 0; i < ranges; i++) {
			each /= range[i].count;
			if (i)
				putc(',', to);
			print_value(to, &range[i], row / each % range[i].count);
		}
		putc('\n', to);
	}
	fclose(to);
	return need(text);
}
