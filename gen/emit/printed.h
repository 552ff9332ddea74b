/* SPDX-License-Identifier: GPL-3.0-or-later */
/* C that was printed, read and printed again. */
#ifndef PLGEN_EMIT_PRINTED_H
#define PLGEN_EMIT_PRINTED_H

#include "state.h"

/* ---- included.c, single.c, apart.c: C that was printed, printed again, in this order ---- */

typedef void rewriter(FILE *to, const char *text, const char *name); /* of a model of this name */
rewriter print_included;        /* the runtime's algorithms in the place of the lines that include them, for double */
rewriter print_own_functions;   /* functions of the runtime in the place of those of <math.h> */
rewriter print_single;          /* C for double as C for float */
rewriter print_apart;           /* no local is called as the model */
/* emit_kernel.c: C with the runtime inside as that of a device, each function static */
rewriter print_opencl, print_cuda, print_openmp;
bool algorithms_use(const char *text, const char *name);     /* is it a word of what the text includes, or a header? */

/* ---- printed.c: C that was printed, read again ---- */

bool in_name(char c);
size_t name_length(const char *text);
bool is_named(const char *text, size_t length, const char *name); /* is a word of that length this one? */
bool is_member(const char *word, const char *text);               /* in the text, behind . or -> */
bool is_hexadecimal(const char *text);                            /* a number */
const char *behind_number(const char *text);                      /* 1.5e-3, 0x1p-3, 12u */
const char *put_other(FILE *to, const char *text);   /* as it is, what begins with no word; returns behind it */
/* Behind a comment, a string, or a line of the preprocessor that starts here; NULL: none does */
const char *behind_quoted(const char *text, bool line_start);
const char *behind(const char *text, char last);                  /* the first `last` that is in no braces */

#endif
