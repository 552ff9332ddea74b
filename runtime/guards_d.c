/* SPDX-License-Identifier: MIT-0 */
/* guards.c with the derivatives of x beside it. */
#define WITH_DERIVATIVES
#include "guards.c"
