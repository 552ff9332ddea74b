/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a run comes to: of each output the last value, mean, root mean square and extremes of all rows, from t = 0 on.
 * The rows are those at the ends of steps, each of the same weight. */
#include "plrun.h"

#include <math.h>
#include <stdlib.h>

struct stats stats_new(int outputs)
{
	return (struct stats){ outputs, 0, need(calloc((size_t)outputs + 1, sizeof(struct output_stats))) };
}

void stats_column(struct stats *stats, int output, uint64_t k, size_t rows, const double *value, size_t apart)
{
	struct output_stats *s = &stats->of[output];
	double squares = s->squares, low = s->low, peak = k == 0 ? fabs(value[0]) : s->peak;
	for (size_t i = 0; i < rows; i++) {
		const double now = value[i * apart], size = fabs(now), square = now * now;
		const double whole = squares + square, part = whole - squares;
		low += (squares - (whole - part)) + (square - part);
		squares = whole;
		if (size > peak) {
			peak = size;
			s->peak_at = k + i;
		}
	}
	s->squares = squares;
	s->low = low;
	s->peak = peak;
	s->last = value[(rows - 1) * apart];
}

void stats_add(void *who, uint64_t k, const double *out)
{
	struct stats *stats = who;
	for (int i = 0; i < stats->outputs; i++) {
		struct output_stats *s = &stats->of[i];
		stats_column(stats, i, k, 1, out + i, 1);
		s->sum += (long double)out[i];
		s->wide += (long double)out[i] * (long double)out[i];
		s->least = k == 0 || out[i] < s->least ? out[i] : s->least;
		s->most = k == 0 || out[i] > s->most ? out[i] : s->most;
	}
	stats->rows = k + 1;
}

/* Are squares of its values neither above the range of doubles nor all but below it? */
static bool in_range(const struct output_stats *s)
{
	return isfinite(s->squares) && (s->peak > 0x1p-450 || s->peak == 0);
}

bool stats_in_range(const struct stats *s)
{
	bool all = true;
	for (int i = 0; i < s->outputs; i++)
		all = all && in_range(&s->of[i]);
	return all;
}

double stats_rms(const struct stats *s, int output)
{
	const struct output_stats *of = &s->of[output];
	return in_range(of) ? sqrt((of->squares + of->low) / (double)s->rows)
			    : (double)sqrtl(of->wide / (long double)s->rows);
}

void stats_print(FILE *to, const struct stats *stats, const struct machine *m, double h, uint64_t crossed)
{
	char when[LONGEST];
	fprintf(to, "output,final,mean,rms,least,largest,peak,t of peak%s\n", m->crossed ? ",crossings" : "");
	for (int i = 0; i < stats->outputs && stats->rows; i++) {
		const struct output_stats *s = &stats->of[i];
		const double value[] = { s->last, (double)(s->sum / (long double)stats->rows), stats_rms(stats, i),
					 s->least, s->most, s->peak };
		fputs(m->output_names[i], to);
		for (size_t k = 0; k < sizeof value / sizeof *value; k++)
			fprintf(to, ",%s", shortest(value[k], m->single));
		*put_time(when, s->peak_at, h, m->single) = 0;
		fprintf(to, m->crossed ? ",%s,%llu\n" : ",%s\n", when, (unsigned long long)crossed);
	}
}
