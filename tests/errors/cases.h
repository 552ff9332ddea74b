/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cases of bad input: read, laid out as files, run. */
#ifndef CASES_H
#define CASES_H

#include <stdbool.h>
#include <stddef.h>

struct text { const char *at; size_t length; };         /* of a file of cases; at NULL: there is none */
struct file { char *name; struct text text; };
struct files { struct file *file; int count; };
struct topic { char *name; struct files shared; };      /* beside the spec of each of its cases */
struct cases { struct one *one; int count; };
struct one {
	const struct topic *topic;
	char *name;
	char **argument;
	int arguments;
	int status;
	bool chosen;
	struct text spec, said;
	struct files beside;
};

/* ---- read.c ---- */

_Noreturn void bail_out(const char *format, ...) __attribute__((format(printf, 1, 2)));
void *more(void *array, int count, size_t size);        /* room for one more than `count` */
char *print(const char *format, ...) __attribute__((format(printf, 1, 2)));
void read_topic(const char *path, struct cases *cases);

/* ---- lay.c: files ---- */

char *scratch(void);                                    /* a new folder */
void empty(const char *folder);
void write_file(const char *folder, const char *name, struct text text);
void lay_out(const struct one *c, const char *folder);  /* its spec and what stands beside it */
void keep(const struct one *c, const char *folder);     /* those, and the rest of it, in FOLDER/TOPIC/NAME */

/* ---- run.c ---- */

void run_open(void);
/* What is wrong, as comments, freed by the caller; empty: nothing */
char *run_case(const struct one *c, bool to_stdout, bool onto_files);

#endif
