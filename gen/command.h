/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The command: what was asked for on its line, and files that are published when all went well. */
#ifndef PLGEN_COMMAND_H
#define PLGEN_COMMAND_H

#include "emit/emit.h"

/* ---- options.c: the command line ---- */

enum print { PRINT_C, PRINT_HEADER, PRINT_EXPLAIN, PRINT_JSON, PRINT_PROGRAM, PRINT_SOLUTION };
struct options {
	const char *spec, *output, *depfile, *solution;
	const char *header;             /* beside the C file `output`; NULL: none is written */
	enum print print;
	bool rhs;
	struct request request;
	const char *banner;             /* what of them belongs in a banner */
};
void read_options(int argc, char **argv, struct options *options); /* ends the program where they are wrong */

/* ---- choose.c: the cheapest step that is as exact as needed ---- */

/* Of this model, the one that is stepped: what the request leaves open is chosen, and kept in the request and in the
 * models; NULL: it was said why there is none */
struct step *choose_step(struct model *written, struct model *stepped, struct request *request);

/* ---- measured.c: the same of what no bound is known for ---- */

struct step *choose_measured(struct model *stepped, struct request *request);

/* ---- sampling.c: steps that nothing is said of ---- */

const char *round_step(double h);  /* [s] 1, 2 or 5 times a power of 10: the largest that is not above h */
/* Of a linear model with needs, the longest, to be tried first; NULL: what was taken may stay, else a shorter one */
const char *first_step(const struct model *stepped);
const char *shorter_step(const struct step *taken);

/* ---- publish.c: texts in memory, then files ---- */

struct file {
	const char *path;               /* NULL: standard output */
	const char *volatile temporary;
	FILE *to;                       /* open: its text grows */
	char *text;                     /* ends with a 0 */
	size_t length;
	bool lost;                      /* there was no memory for some of it */
};
bool same_file(const char *a, const char *b);               /* one file under two names */
void publish_open(void);                                    /* what is not published goes when the program ends */
struct file *file_new(const char *path);                    /* open; published in this order */
void file_close(struct file *f);
/* C becomes other C: for the target float, or with locals apart from the model's name. */
void file_rewrite(struct file *f, const char *name, void (*print)(FILE *to, const char *text, const char *name));
void mark_pair(struct file *code, struct file *header);     /* of two runs they must not compile; code NULL: alone */
bool spares(int count, const char *const *path);            /* is nothing written over them? Else it says so */
void publish(void);

#endif
