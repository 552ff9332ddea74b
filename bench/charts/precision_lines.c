/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "precision_lines.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const struct method *method_of(const struct line *line)
{
	return line->method ? line->method : &line->ours;
}

/* ---- errors: what is no time ---- */

static void put_word(char *text, size_t room, const char *word, int columns)
{
	for (int i = 0; i < columns; i++) {
		const size_t length = strlen(text);
		snprintf(text + length, room - length, "%s,", word);
	}
}

static void find_error(struct line *line, const struct problem *p, const struct truth *t)
{
	char *found = line->found;
	const size_t room = sizeof line->found;
	found[0] = '\0';
	if (!line->run) {
		put_word(found, room, line->refused ? "refused" : "cannot", 6);
		put_word(found, room, "none", 1);
		return;
	}
	const struct error e = error_of(line->run, t);
	const long evaluations = line->run->evaluations(line->run);
	if (e.failed)
		snprintf(found, room, "failed,failed,failed,failed,failed,1,");
	else
		snprintf(found, room, "%.4g,%.4g,%.4g,%.4g,%.4g,0,", e.q_end, e.q_between, e.v_end, e.v_between,
		         e.largest);
	const size_t length = strlen(found);
	if (e.failed || evaluations < 0)
		put_word(found, room, "none", 1);
	else
		snprintf(found + length, room - length, "%.6g,", (double)evaluations / p->units);
}

/* The largest error: the fifth column; what is no number there has failed */
static void read_largest(struct line *line)
{
	const char *at = line->found;
	for (int comma = 0; comma < 4 && at; comma++)
		at = strchr(at, ',') ? strchr(at, ',') + 1 : NULL;
	char *end = NULL;
	line->largest = at ? strtod(at, &end) : NAN;
	if (!at || end == at || *end != ',')
		line->largest = NAN;
}

void find_errors(struct lines *lines, const struct problem *p, const struct truth *t)
{
	lines->agreement = t->agreement;
	for (struct line *line = lines->line; line < lines->line + lines->count; line++) {
		say_progress("%s: error of %s, %g", p->name, method_of(line)->name, line->setting);
		find_error(line, p, t);
		read_largest(line);
	}
}

static FILE *open_errors(const char *folder, const char *name, const char *mode)
{
	char path[4096];
	snprintf(path, sizeof path, "%s/%s.errors", folder, name);
	return fopen(path, mode);
}

void keep_errors(const struct lines *lines, const struct problem *p, const char *folder)
{
	FILE *out = open_errors(folder, p->name, "w");
	if (!out)
		leave(folder, "cannot be written to");
	fprintf(out, "%d %.17g %.17g %.17g\n", p->units, p->scale_q, p->scale_v, lines->agreement);
	for (const struct line *line = lines->line; line < lines->line + lines->count; line++)
		fprintf(out, "%s\t%.6g\t%s\n", method_of(line)->name, line->setting, line->found);
	table_close(out, p->name);
}

bool read_scales(struct lines *lines, struct problem *p, const char *folder)
{
	FILE *in = open_errors(folder, p->name, "r");
	int units;
	if (!in)
		return false;
	if (fscanf(in, "%d %lf %lf %lf", &units, &p->scale_q, &p->scale_v, &lines->agreement) != 4 ||
	    units != p->units)
		leave(p->name, "its .errors is of another history");
	fclose(in);
	return true;
}

void read_errors(struct lines *lines, const struct problem *p, const char *folder)
{
	char text[400], expected[200];
	FILE *in = open_errors(folder, p->name, "r");
	bool good = in && fgets(text, sizeof text, in);
	for (struct line *line = lines->line; good && line < lines->line + lines->count; line++) {
		snprintf(expected, sizeof expected, "%s\t%.6g\t", method_of(line)->name, line->setting);
		good = fgets(text, sizeof text, in) && strncmp(text, expected, strlen(expected)) == 0;
		snprintf(line->found, sizeof line->found, "%s", good ? text + strlen(expected) : "");
		line->found[strcspn(line->found, "\n")] = '\0';
		read_largest(line);
	}
	if (!good || fgets(text, sizeof text, in))
		leave(p->name, "its .errors has not the runs that there are");
	fclose(in);
}

/* ---- times ---- */

enum { DEAR = 20 };
static const double long_pass = 0.25e9;         /* ns of a history */

struct timed { struct line **line; };

static bool is_dear(int k, const struct samples *so_far, void *of)
{
	const struct timed *timed = of;
	struct line *const line = timed->line[k], *const before = line - 1;
	if (line->rung == 0 || !line->method->tolerance)
		return false;
	line->dear = before->dear;
	const struct samples *last = &so_far[k - 1];
	if (k == 0 || timed->line[k - 1] != before || last->count == 0 ||
	    last->min * line->run->problem->units < long_pass)
		return line->dear;
	for (int i = 0; i < k && !line->dear; i++)
		line->dear = timed->line[i]->largest <= line->largest && so_far[i].count > 0 &&
		             DEAR * so_far[i].min <= last->min;
	return line->dear;
}

/* First what has no ladder, so that it is known which of their settings are dear */
static int in_turn(struct lines *lines, struct line **turn)
{
	int count = 0;
	for (int ladders = 0; ladders < 2; ladders++)
		for (struct line *line = lines->line; line < lines->line + lines->count; line++)
			if (line->run && !isnan(line->largest) &&
			    ladders == (line->method && line->method->tolerance))
				turn[count++] = line;
	return count;
}

void find_times(struct lines *lines, double seconds)
{
	const size_t room = (size_t)lines->count;
	struct run **run = room_for(room, sizeof *run);
	struct samples *samples = room_for(room, sizeof *samples);
	struct line **line = room_for(room, sizeof *line);
	const int count = in_turn(lines, line);
	struct timed timed = { line };
	for (int k = 0; k < count; k++)
		run[k] = line[k]->run;
	sample_ladders(count, run, seconds, is_dear, &timed, samples);
	for (int k = 0; k < count; k++) {
		line[k]->samples = samples[k];
		if (samples[k].count > 0 && samples[k].median * run[k]->problem->units < long_pass)
			line[k]->pass = sample_pass(run[k]);
	}
	free(run);
	free(samples);
	free(line);
}

/* ---- the table ---- */

static void put_settings(FILE *out, const struct line *line)
{
	const struct method *method = method_of(line);
	char text[400];
	snprintf(text, sizeof text, "%s; %s", method->settings, line->run &&
	         !line->method ? generated_between(line->run) : "");
	put_quoted(out, line->refused ? line->refused : line->method ? method->settings : text);
}

void put_head(FILE *out)
{
	fputs("model,method,family,setting_kind,setting,q_end,q_between,v_end,v_between,largest,failed,"
	      "evaluations_per_unit,ns_min,ns_median,ns_max,ns_samples,ns_units,ns_pass,settings,"
	      "truth_agreement,unit_s,history_s\n", out);
}

void put_line(FILE *out, const struct lines *lines, const struct line *line, const struct problem *p)
{
	const struct method *method = method_of(line);
	const struct samples *ns = &line->samples;
	fprintf(out, "%s,", p->name);
	put_quoted(out, method->name);
	fprintf(out, ",%s,%s,%.6g,%s", family_names[method->family], method->tolerance ? "tolerance" : "step",
	        line->setting, line->found);
	if (ns->count > 0)
		fprintf(out, "%.5g,%.5g,%.5g,%d,%d,", ns->min, ns->median, ns->max, ns->count, p->units);
	else
		for (int i = 0; i < 5; i++)
			fputs(line->dear ? "dear," : "none,", out);
	if (line->pass > 0)
		fprintf(out, "%.5g,", line->pass);
	else
		fputs(line->dear ? "dear," : "none,", out);
	put_settings(out, line);
	fprintf(out, ",%.2g,%g,%g\n", lines->agreement, p->unit, p->unit * p->units);
}
