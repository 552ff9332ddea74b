/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The command: what was asked for on its line, and files that are published when all went well. */
#ifndef PLGEN_COMMAND_H
#define PLGEN_COMMAND_H

#include "emit/printed.h"
#include "fmu/fmu.h"
#include "host/picture.h"

/* ---- main.c: the pipeline ---- */

int plgen(int argc, char **argv);       /* what the program's main returns; it may end the process. Once in each */

/* ---- options.c: the command line ---- */

enum print { PRINT_C, PRINT_HEADER, PRINT_KERNEL, PRINT_EXPLAIN, PRINT_JSON, PRINT_PROGRAM, PRINT_SOLUTION,
	     PRINT_RESPONSE, PRINT_PLOT, PRINT_REPORT };
struct options {
	const char *spec, *output, *depfile, *a2l, *solution, *tunable;
	const char *value;              /* of --response, --plot */
	const char *params;             /* a file with values of params, which come before those of -D; */
	int definitions;
	const char **definition;        /* NAME=EXPR */
	const char *target;             /* of a kernel that is printed: opencl, cuda or openmp */
	const char *at;                 /* where a nonlinear model is linearised; NULL: not said */
	bool equilibrium;               /* equilibria are listed, as text or JSON */
	struct {                        /* the picture of --plot; what is not given is NULL */
		bool wanted;
		const char *sweep, *orders, *whirl;
	} campbell;
	struct picture_look look;       /* of pictures and of a page */
	const char *amplitude;          /* of the excitation; NULL: not given */
	const char *header;             /* beside the C file `output`; NULL: none is written */
	enum print print;
	const char *page;               /* the page that is written instead; NULL: none */
	bool page_in_report;            /* as part of the page of --report */
	struct {                        /* the FMU that is written instead */
		const char *path;       /* NULL: none */
		int version;            /* 2 or 3; 0: not said */
		bool binary;            /* with the compiled one; */
		const char *headers;    /* the folder of the standard's own headers; NULL: the runtime's count */
	} fmu;
	bool rhs;
	bool bundle;                    /* with the runtime inside */
	bool strict;                    /* warnings are errors */
	struct request request;
	const char *banner;             /* what of them belongs in a banner */
};
void read_options(int argc, char **argv, struct options *options); /* ends the program where they are wrong */

/* ---- together.c: which of them go together ---- */

_Noreturn void wrong_usage(const char *message);
bool ends_in(const char *text, const char *end);            /* and is longer */
const char *base_name(const char *path);                    /* without its folders; NULL of NULL */
void find_together(struct options *options);                /* and the name of the header */

/* ---- choose.c: the cheapest step that is as exact as needed ---- */

/* Of this model, the one that is stepped: what the request leaves open is chosen, and kept in the request and in the
 * models; NULL: it was said why there is none */
struct step *choose_step(struct model *written, struct model *stepped, struct request *request);

/* ---- measured.c: the same of what no bound is known for ---- */

struct step *choose_measured(struct model *stepped, struct request *request);

/* ---- binary.c: the compiler ---- */

/* adds the shared object to an FMU; false: it was said why there is none */
bool add_binary(struct fmu *fmu, const char *headers);
/* C that exports what is called, as WebAssembly; NULL: it was said why there is none */
char *wasm_of(const char *code, size_t *length);

/* ---- sampling.c: steps that nothing is said of, and those to a time ---- */

const char *round_step(double h);  /* [s] 1, 2 or 5 times a power of 10: the largest that is not above h */
/* Of a linear model with needs, the longest, to be tried first; NULL: what was taken may stay, else a shorter one */
const char *first_step(const struct model *stepped);
const char *shorter_step(const struct step *taken);
/* The step as it was asked for, made shorter so that a whole number of them, which is returned, ends there */
long divide_motion(struct request *request, mpq_srcptr h, mpq_srcptr end);
/* Of what the C would have none changes the motion, and its states are the written ones. */
struct request request_of_motion(const struct request *given);

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
struct file *file_inside(void);                             /* open; part of another, not published; freed by: */
void file_drop(struct file *f);
void file_close(struct file *f);
/* C becomes other C: for the target float, or with locals apart from the model's name. */
void file_rewrite(struct file *f, const char *name, rewriter *print);
/* Another text for it, made of the one it has */
void file_replace(struct file *f, void (*print)(FILE *to, const char *text, const void *context), const void *context);
void mark_pair(struct file *code, struct file *header);     /* of two runs they must not compile; code NULL: alone */
bool spares(int count, const char *const *path);            /* is nothing written over them? Else it says so */
void publish(void);
/* what was read, for make and ninja, where a file is asked for that says it */
void print_depfile(const struct options *options, const struct spec *spec, const struct model *model);

/* ---- page.c: a model that runs in a browser ---- */

/* of a page one for each number that a drawing reads, behind all others */
void add_drawn_outputs(const struct options *options, struct spec *spec);
/* where one is asked for: of C that has what it needs of the runtime inside; false: it was said why there is none */
bool write_page(const struct options *options, const struct step *step, struct file *code);

/* ---- pieces.c: the runtime, cut ---- */

struct piece {                  /* a declaration, a definition, or lines of the preprocessor */
	const char *file;       /* where it stands, without the ending */
	const char *comment, *text;
	const char **name;      /* what it declares; none: a check of the compiler */
	int names;
	bool shared, typed;     /* of plrt.h; of what that has of each type */
	bool function, local;   /* declared or defined; static */
	bool in_code, in_header;
};
struct include { const char *file, *header; };      /* both without the ending */
struct owner { const char *name; int piece; };
struct runtime {
	bool single;            /* for models in float */
	/* files of piecewise-linear ones: "_compensated" whose state has two words, "_d" that have derivatives; NULL:
	 * neither */
	const char *variant;
	struct piece *piece;
	int pieces;
	struct owner *owner;    /* who has a name, by names, of the same in the order of the pieces */
	int owners;
	struct include *include;
	int includes;
	const char **from, **to; /* names that stand for others in float, or of states in two words */
	int aliases, floats;    /* so many; of those in float the first */
};
struct runtime *runtime_read(bool single, const char *variant);
const char *next_word(const char **at, size_t *length);     /* of C outside comments and strings; NULL: no more */

/* ---- bundle.c: a model with the runtime inside ---- */

/* Header NULL: the C has all. `more`: C that includes the header and finds there what it uses; NULL: none is known;
 * variant: as of struct runtime */
void bundle(struct file *code, struct file *header, const char *more, bool single, const char *variant);

#endif
