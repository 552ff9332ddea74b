/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bad input, and good input of which something is said: cases as TAP, each run by the generator in a process forked
 * from this one.
 *
 *     cases [NAME...]                  topics, cases, or patterns of cases ('load_change_*'); without: all
 *     cases --write FOLDER [NAME...]   instead of running them as files, each in FOLDER/TOPIC/CASE: CASE.spec and what
 *                                      stands beside it, CASE.args (one a line), CASE.status, CASE.expect
 *
 * A topic is a file here, TOPIC.cases, and a case in it is
 *
 *     === cl_step_division --step '1/(a - 2)'
 *     model m
 *     param m = 1, k = 100, a = 2
 *     coord x
 *     m*x'' + k*x = a
 *     step 0.01
 *     ---
 *     <command line>:1:2: error: division by zero
 *     1/(a - 2)
 *      ^
 *
 * === the name, options (in '' where they have blanks or are empty), -> the exit status where it is not 1;
 *     the spec: it is written to NAME.spec, which comes last on the command line; no line at all: none is named.
 *     Where bytes matter, or it would be long, a shell script that prints it, with #!/bin/sh as its first line.
 * --- all of standard error; nothing: nothing may be said. Empty lines may follow. `3:5: error: ...` has the spec's
 *     name in front and line 3 of the spec and a caret under its 5th character behind it, which do not stand there.
 * +++ FILE, before ---: a file beside the spec; before the first case: beside every spec of the topic.
 * Lines before the first case that begin with # are comments.
 *
 * Each is run twice: to standard output, which has to stay empty, but not of a good case (status 0); and, where the
 * status is 1, with -o, where existing files have to stay as they were and nothing may be left beside them.
 * RUNS=stdout or RUNS=files in the environment: only the one or the other. And where none is named, of all: CASE=TEXT:
 * those with TEXT in their name; DEAR=skip: without those of dear.list, DEAR=only: these; EVERY=N: of what is left
 * every N-th. */
#include "cases.h"

#include <fnmatch.h>
#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *environment(const char *name, const char *otherwise)
{
	const char *value = getenv(name);
	return value && *value ? value : otherwise;
}

static struct cases read_all(void)
{
	struct cases cases = { 0 };
	glob_t found;
	if (glob(CASES_FOLDER "/*.cases", 0, NULL, &found) != 0)
		bail_out("no cases in %s", CASES_FOLDER);
	for (size_t i = 0; i < found.gl_pathc; i++)
		read_topic(found.gl_pathv[i], &cases);
	globfree(&found);
	return cases;
}

/* ---- which ---- */

static bool is_named(const struct one *c, const char *name)
{
	char *whole = print("%s/%s", c->topic->name, c->name);
	bool named = fnmatch(name, strchr(name, '/') ? whole : c->name, 0) == 0;
	free(whole);
	return named;
}

static bool is_of(const struct one *c, const char *topic)
{
	return strcmp(c->topic->name, topic) == 0;
}

/* Marks those of a topic, or of a pattern where it is none. */
static void choose(struct cases *cases, const char *name)
{
	int marked = 0;
	for (int pass = 0; pass < 2 && marked == 0; pass++)
		for (int i = 0; i < cases->count; i++)
			if ((pass == 0 ? is_of : is_named)(&cases->one[i], name)) {
				cases->one[i].chosen = true;
				marked++;
			}
	if (marked == 0)
		bail_out("no topic or case %s", name);
}

static void mark(struct cases *cases, const char *name, bool chosen)
{
	bool known = false;
	for (int i = 0; i < cases->count; i++)
		if (strcmp(cases->one[i].name, name) == 0) {
			cases->one[i].chosen = chosen;
			known = true;
		}
	if (!known)
		bail_out("no case %s, which dear.list names", name);
}

/* Without those of dear.list, or these only */
static void choose_by_list(struct cases *cases, bool only)
{
	char line[200];
	for (int i = 0; i < cases->count && only; i++)
		cases->one[i].chosen = false;
	FILE *list = fopen(CASES_FOLDER "/dear.list", "r");
	while (list && fgets(line, sizeof line, list)) {
		line[strcspn(line, "\n")] = 0;
		if (*line != '#')
			mark(cases, line, only);
	}
	if (!list || fclose(list) != 0)
		bail_out("no dear.list");
}

static void choose_to_run(struct cases *cases)
{
	char *pattern = print("*%s*", environment("CASE", ""));
	choose(cases, pattern);
	free(pattern);
	const char *dear = environment("DEAR", "");
	if (*dear)
		choose_by_list(cases, strcmp(dear, "only") == 0);
	const int every = atoi(environment("EVERY", "1"));
	if (every < 1)
		bail_out("EVERY is a number from 1 on");
	for (int i = 0, place = 0; i < cases->count; i++)
		if (cases->one[i].chosen)
			cases->one[i].chosen = ++place % every == 0;
}

/* ---- what becomes of them ---- */

static int run_all(const struct cases *cases)
{
	const char *runs = environment("RUNS", "both");
	int count = 0, failed = 0;
	run_open();
	for (int i = 0; i < cases->count; i++) {
		const struct one *c = &cases->one[i];
		if (!c->chosen)
			continue;
		char *wrong = run_case(c, strcmp(runs, "files") != 0, strcmp(runs, "stdout") != 0);
		printf("%s %d - %s\n%s", *wrong ? "not ok" : "ok", ++count, c->name, wrong);
		failed += *wrong != 0;
		free(wrong);
	}
	printf("1..%d\n", count);
	return failed != 0;
}

static int write_all(const struct cases *cases, const char *folder)
{
	for (int i = 0; i < cases->count; i++)
		if (cases->one[i].chosen)
			keep(&cases->one[i], folder);
	return 0;
}

int main(int argc, char **argv)
{
	static struct cases cases;
	const bool writes = argc > 2 && strcmp(argv[1], "--write") == 0;
	const int first = writes ? 3 : 1;
	setenv("LC_ALL", "C", 1);
	cases = read_all();
	for (int i = first; i < argc; i++)
		choose(&cases, argv[i]);
	if (argc <= first && writes)
		choose(&cases, "*");
	else if (argc <= first)
		choose_to_run(&cases);
	return writes ? write_all(&cases, argv[2]) : run_all(&cases);
}
