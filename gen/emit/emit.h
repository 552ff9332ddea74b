/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A step as C. */
#ifndef PLGEN_EMIT_EMIT_H
#define PLGEN_EMIT_EMIT_H

#include "state.h"

/* ---- emit.c and emit_step, _out, _run, _loads, _forced, _refresh, _time, _rhs: a step as C ---- */

void emit_header(FILE *to, const struct step *step, const char *options, bool rhs);
/* NAME_kernel for opencl, cuda or openmp; leaves the statement where there can be none */
void emit_device(FILE *to, const struct step *step, const char *options, const char *target);
/* header_name NULL: all in one */
void emit_code(FILE *to, const struct step *step, const char *options, const char *header_name, bool rhs);

#endif
