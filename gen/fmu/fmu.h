/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A step as an FMU for co-simulation: its C, the runtime that it needs, and what describes it, in one archive. */
#ifndef PLGEN_FMU_H
#define PLGEN_FMU_H

#include "base/base.h"

struct step;
struct model;

/* ---- archive.c: files in one file ---- */

struct member {
	const char *name;           /* with '/' between folders */
	const char *bytes;
	size_t length;
};
struct archive {
	int members;
	struct member *member;
};
void archive_add(struct archive *a, const char *name, const char *bytes, size_t length);
/* zip, stored as it is: the same members, the same bytes */
void archive_write(FILE *to, const struct archive *a);

/* ---- variables.c: what the importer sees ---- */

enum fmu_kind { FMU_TIME, FMU_INPUT, FMU_OUTPUT, FMU_PARAM, FMU_STATE, FMU_CONSTANT };
struct fmu_variable {               /* its place in the list is its value reference */
	enum fmu_kind kind;
	const char *name;           /* as no other */
	double start;               /* of inputs, params, states and constants */
	const char *description;    /* the comment of the line that declares it; NULL: none */
	const struct param_range *range; /* of a param that has one; else NULL */
	const struct unit *unit, *shown; /* of its value, and in which it is shown; NULL: none is known, or as it is */
};
struct fmu_variables {
	int count, constants;       /* constants: of these, the last ones */
	struct fmu_variable *variable;
};
/* in the order of runtime/fmi/plfmu.h: time, inputs, outputs, tunable params, states, params that nothing changes */
struct fmu_variables variables_of(const struct step *step);

/* ---- a2l.c: for calibration tools ---- */

void print_a2l(FILE *to, const struct step *step);

/* ---- description.c: modelDescription.xml, and of FMI 3.0 sources/buildDescription.xml ---- */

enum { FMU_SOURCES = 2 };           /* the standard's functions, the model */
struct fmu {
	int version;                /* 2 or 3 */
	const char *name;           /* of the model: its identifier */
	const char *title;          /* the spec's name for it */
	const char *worst;          /* the most instructions of a step; NULL: there is no bound */
	const char *token;          /* instantiationToken, guid */
	bool single;                /* it is in float */
	double h;
	bool math;                  /* its C needs the library of <math.h> */
	bool crosses;               /* it has breakpoints, and counts how often they are crossed */
	bool derives;               /* it has derivatives by every input and tunable param */
	struct fmu_variables variables;
	const char *source[FMU_SOURCES]; /* of sources/: those that are compiled */
	struct archive archive;
};
const char *model_description(const struct fmu *f);
const char *build_description(const struct fmu *f);

/* ---- fmu.c: the whole ---- */

/* NAME_pl.h, which the C includes */
const char *fmu_header_name(const struct model *model);
/* of this C and its header, which have what they need of the runtime inside; NULL: it was said why there is none */
struct fmu *fmu_new(const struct step *step, int version, const char *code, const char *header);

#endif
