/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A reader of Matrix Market files, of just the kinds that beam_matrices writes. */
#ifndef MTX_FILE_H
#define MTX_FILE_H

#include <gsl/gsl_matrix.h>

gsl_matrix *mtx_file(const char *prefix, const char *name);     /* PREFIXNAME.mtx; what is wrong with it ends the test */

#endif
