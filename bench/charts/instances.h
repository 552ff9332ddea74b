/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Includes the file STEPPER once for each model of equations.h, with these set, which the file takes back:
 *     INSTANCE(part)      the model's own name of a function of the file; of its equations too: INSTANCE(slopes)
 *     COORDINATES         a constant
 *     EXTENT              most coordinates that an array of it must hold
 *     SLOPES(t, y, f)     its right-hand side
 *     JACOBIAN(t, y, Jq, Jv)
 * What includes this may add an instance of its own for any other problem. */
#ifdef MODEL
#define INSTANCE(part) OF_MODEL(MODEL, part)
#define COORDINATES OF_MODEL(MODEL, coordinates)
#define EXTENT COORDINATES
#define SLOPES(t, y, f) OF_MODEL(MODEL, slopes)(t, y, f)
#define JACOBIAN(t, y, Jq, Jv) OF_MODEL(MODEL, jacobian)(t, y, Jq, Jv)
#include STEPPER
#undef MODEL
#else
#define JOINED(model, part) model##_##part
#define OF_MODEL(model, part) JOINED(model, part)
#include "each_model.h"
#endif
