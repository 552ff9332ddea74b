/* SPDX-License-Identifier: GPL-3.0-or-later */
/* papers [--quick] [--times] VARIANTS FOLDER: the findings of the four sources beside what is measured:
 * FOLDER/papers_000.csv (coupled systems), papers_001.csv (precise integration), papers_002.csv (clearances) and
 * papers_004.csv (rotating beam); --times: their times alone, papers_times.csv. VARIANTS: what variants.sh made. The
 * sources' parameter values did not survive: those of the models are chosen. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "papers.h"

const char *percent(double part)
{
	if (!isfinite(part))
		return "diverged";
	return part < 10 ? text("%.3g %%", 100 * part) : text("%.3g times x1(0)", part);
}

/* Quoted where a comma is */
static void print_fields(FILE *f, int count, const char *const *field)
{
	for (int i = 0; i < count; i++) {
		const char *quote = field[i] && strchr(field[i], ',') ? "\"" : "";
		fprintf(f, "%s%s%s%s", i > 0 ? "," : "", quote, field[i] ? field[i] : "", quote);
	}
}

FILE *table_begin(const struct papers *papers, const char *name)
{
	return table_open(papers->folder, name, "source,model,method,quantity,reported,recovered,measured,settings");
}

void row_of(FILE *table, const char *source, const char *model, const char *method, const char *quantity,
            const char *reported, const char *recovered, const char *measured, const char *settings)
{
	const char *const field[] = { source, model, method, quantity, reported ? reported : "not stated", recovered,
	                              measured, settings };
	print_fields(table, sizeof field / sizeof *field, field);
	fputc('\n', table);
}

void time_of(const struct papers *papers, const char *source, const char *model, const char *method,
             const char *quantity, const char *reported, const char *measured, const char *settings, struct samples ns)
{
	const char *const field[] = { source, model, method, quantity, reported ? reported : "not stated", measured };
	print_fields(papers->times, sizeof field / sizeof *field, field);
	fprintf(papers->times, ",%.6g,%.6g,%.6g,", ns.min, ns.median, ns.max);
	print_fields(papers->times, 1, &settings);
	fputc('\n', papers->times);
}

void times_of(const struct papers *papers, const char *source, const char *model, const char *quantity, int count,
              struct run *const *run, double seconds, const char *const *reported, const char *settings)
{
	struct samples ns[count];
	say_progress("papers: %s, times of %s", source, model);
	sample_runs(count, run, seconds, ns);
	for (int i = 0; i < count; i++) {
		time_of(papers, source, model, run[i]->method->name, quantity, reported ? reported[i] : NULL,
		        text("%.3g", ns[i].median / ns[0].median), settings, ns[i]);
		run[i]->close(run[i]);
	}
}

double *rows_of(struct run *run)
{
	double *rows = history_rows(run, run->problem->units);
	run->close(run);
	return rows;
}

struct problem *papers_problem(const struct papers *papers, const char *variant, const char *name, double unit,
                               int units, double frequency)
{
	return problem_load(text("%s/papers_%s.so", papers->variants, variant), name, unit, units, frequency >= 0,
	                    frequency >= 0 ? frequency : 0);
}

struct run *papers_run(const struct papers *papers, const struct method *method, const struct problem *p,
                       const char *variant)
{
	const char *file = text("%s/papers_%s.so", papers->variants, variant);
	struct run *run = generated_open(method, p, file);
	if (!run)
		leave(file, variant_refused(file) ? variant_refused(file) : "cannot be used");
	return run;
}

static int by_error(const void *a, const void *b)
{
	const double x = ((const struct placing *)a)->error, y = ((const struct placing *)b)->error;
	return (x > y) - (x < y);
}

const char *ordering(int count, struct placing *placing)
{
	char all[400] = "";
	for (int i = 0; i < count; i++)
		if (!isfinite(placing[i].error))
			placing[i].error = INFINITY;
	qsort(placing, (size_t)count, sizeof *placing, by_error);
	for (int i = 0; i < count; i++) {
		const size_t length = strlen(all);
		snprintf(all + length, sizeof all - length, "%s%s", i > 0 ? " < " : "", placing[i].method);
	}
	return text("%s", all);
}

int main(int argc, char **argv)
{
	const unsigned flags = flags_of(argc, &argv, "--quick --times", 2, 2, "papers [--quick] [--times] "
		"VARIANTS FOLDER");
	struct papers papers = { .variants = argv[0], .folder = argv[1], .quick = flags & 1 };
	if (flags & 2) {
		papers.times = table_open(papers.folder, "papers_times.csv",
		                          "source,model,method,quantity,reported,measured,"
		                          "ns_min,ns_median,ns_max,settings");
		coupled_times(&papers);
		integration_times(&papers);
		clearance_times(&papers);
		beam_times(&papers);
		table_close(papers.times, "papers_times.csv");
		return 0;
	}
	coupled_systems(&papers);
	precise_integration(&papers);
	clearances(&papers);
	rotating_beam(&papers);
	return 0;
}
