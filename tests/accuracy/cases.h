/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Specs and cases, for the programs that hold what the generator finds against another road. */
#ifndef CASES_H
#define CASES_H

#include "read/read.h"

const char *base_name(const char *path);
char *read_text(const char *path);                          /* the whole file; bails out */
struct spec *spec_of(const char *path, const char *text);   /* parsed; `path`: where its data files stand */
const char *diagnostics(void);                              /* all that the generator has said */
const char *first_line(const char *text);
void show_spec(const char *text);                           /* as comments */

/* A case in a process of its own, so that a crash or an endless loop is one failed case, and what the generator refuses
 * once does not stay refused: `work` is true if all is well. `seconds`: how long it may take; 0: as long as it likes.
 * Prints its line of TAP and counts it. */
bool run_case(const char *name, unsigned seconds, bool (*work)(void *context), void *context);
void report_case(const char *name, bool good);              /* of one that needed no process */
int cases_reported(void);
int cases_failed(void);

/* Before other arguments, which stand from optind on: numbers and switches; letter 0: the end. What is none of them
 * ends the program. */
struct command_option { char letter; unsigned long *number; bool *on; };
void take_options(int argc, char **argv, const struct command_option *options);

#endif
