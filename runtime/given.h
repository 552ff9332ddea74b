/* SPDX-License-Identifier: MIT-0 */
/* given.h: part of what takes a step: the inputs among parameters and arguments, where a model has inputs. */
#if PL_INPUTS > 0
#define PL_TAKEN , const real u[PL_INPUTS] /* of a step */
#define PL_TAKEN_ROWS , const real *u      /* of many */
#define PL_GIVEN , u
#define PL_THE_INPUTS u
#else
#define PL_TAKEN
#define PL_TAKEN_ROWS
#define PL_GIVEN
#define PL_THE_INPUTS NULL
#endif
