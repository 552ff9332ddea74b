/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Includes the file STEPPER once for each model of equations.h, with these set, which the file takes back:
 *     INSTANCE(part)      the model's own name of a function of the file; of its equations too: INSTANCE(slopes)
 *     COORDINATES         a constant
 *     EXTENT              most coordinates that an array of it must hold
 *     SLOPES(t, y, f)     its right-hand side
 *     JACOBIAN(t, y, Jq, Jv)
 * What includes this may add an instance of its own for any other problem. */

#define INSTANCE(part) pendulum_##part
#define COORDINATES 1
#define EXTENT 1
#define SLOPES(t, y, f) pendulum_slopes(t, y, f)
#define JACOBIAN(t, y, Jq, Jv) pendulum_jacobian(t, y, Jq, Jv)
#include STEPPER

#define INSTANCE(part) vanderpol_##part
#define COORDINATES 1
#define EXTENT 1
#define SLOPES(t, y, f) vanderpol_slopes(t, y, f)
#define JACOBIAN(t, y, Jq, Jv) vanderpol_jacobian(t, y, Jq, Jv)
#include STEPPER

#define INSTANCE(part) vanderpol_stiff_##part
#define COORDINATES 1
#define EXTENT 1
#define SLOPES(t, y, f) vanderpol_stiff_slopes(t, y, f)
#define JACOBIAN(t, y, Jq, Jv) vanderpol_stiff_jacobian(t, y, Jq, Jv)
#include STEPPER

#define INSTANCE(part) vanderpol_stiffer_##part
#define COORDINATES 1
#define EXTENT 1
#define SLOPES(t, y, f) vanderpol_stiffer_slopes(t, y, f)
#define JACOBIAN(t, y, Jq, Jv) vanderpol_stiffer_jacobian(t, y, Jq, Jv)
#include STEPPER

#define INSTANCE(part) quad2dof_##part
#define COORDINATES 2
#define EXTENT 2
#define SLOPES(t, y, f) quad2dof_slopes(t, y, f)
#define JACOBIAN(t, y, Jq, Jv) quad2dof_jacobian(t, y, Jq, Jv)
#include STEPPER

#define INSTANCE(part) duffing_##part
#define COORDINATES 1
#define EXTENT 1
#define SLOPES(t, y, f) duffing_slopes(t, y, f)
#define JACOBIAN(t, y, Jq, Jv) duffing_jacobian(t, y, Jq, Jv)
#include STEPPER

#define INSTANCE(part) mathieu_##part
#define COORDINATES 1
#define EXTENT 1
#define SLOPES(t, y, f) mathieu_slopes(t, y, f)
#define JACOBIAN(t, y, Jq, Jv) mathieu_jacobian(t, y, Jq, Jv)
#include STEPPER

#define INSTANCE(part) henon_heiles_##part
#define COORDINATES 2
#define EXTENT 2
#define SLOPES(t, y, f) henon_heiles_slopes(t, y, f)
#define JACOBIAN(t, y, Jq, Jv) henon_heiles_jacobian(t, y, Jq, Jv)
#include STEPPER

#define INSTANCE(part) coupled_vanderpol_##part
#define COORDINATES 2
#define EXTENT 2
#define SLOPES(t, y, f) coupled_vanderpol_slopes(t, y, f)
#define JACOBIAN(t, y, Jq, Jv) coupled_vanderpol_jacobian(t, y, Jq, Jv)
#include STEPPER

#define INSTANCE(part) double_pendulum_##part
#define COORDINATES 2
#define EXTENT 2
#define SLOPES(t, y, f) double_pendulum_slopes(t, y, f)
#define JACOBIAN(t, y, Jq, Jv) double_pendulum_jacobian(t, y, Jq, Jv)
#include STEPPER

#define INSTANCE(part) rayleigh_##part
#define COORDINATES 1
#define EXTENT 1
#define SLOPES(t, y, f) rayleigh_slopes(t, y, f)
#define JACOBIAN(t, y, Jq, Jv) rayleigh_jacobian(t, y, Jq, Jv)
#include STEPPER

#define INSTANCE(part) duffing_pair_##part
#define COORDINATES 2
#define EXTENT 2
#define SLOPES(t, y, f) duffing_pair_slopes(t, y, f)
#define JACOBIAN(t, y, Jq, Jv) duffing_pair_jacobian(t, y, Jq, Jv)
#include STEPPER

#define INSTANCE(part) spherical_pendulum_##part
#define COORDINATES 2
#define EXTENT 2
#define SLOPES(t, y, f) spherical_pendulum_slopes(t, y, f)
#define JACOBIAN(t, y, Jq, Jv) spherical_pendulum_jacobian(t, y, Jq, Jv)
#include STEPPER
