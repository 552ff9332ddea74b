/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A reader of Matrix Market files, of just the kinds that beam_matrices writes. */
#ifndef MTX_FILE_H
#define MTX_FILE_H

#include <gsl/gsl_matrix.h>

/* PREFIXNAME.mtx; what is wrong with it ends the test */
gsl_matrix *mtx_file(const char *prefix, const char *name);

#endif
