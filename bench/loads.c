/* SPDX-License-Identifier: GPL-3.0-or-later */
/* loads: what a load costs in a step: sdcsf by anchors, with its functions in every step, and without its load; each
 * through calls, with its outputs after each step, and by run. Minima of interleaved samples, as nanoseconds a step and
 * as ratios to the step without a load. */
#define _POSIX_C_SOURCE 199309L
#include "anchored.h"
#include "direct.h"
#include "none.h"
#include "timing.h"

#include <stdio.h>

enum { STEPS = 4096, SAMPLES = 300 }; /* from the start each time: what has decayed is slow */

static double out[STEPS * 4];

#define WAYS(name)                                                                                                     \
    static name name##_state;                                                                                          \
    static void name##_calls(void)                                                                                     \
    {                                                                                                                  \
        name##_init(&name##_state);                                                                                    \
        for (int i = 0; i < STEPS; i++)                                                                                \
            name##_step(&name##_state);                                                                                \
    }                                                                                                                  \
    static void name##_read(void)                                                                                      \
    {                                                                                                                  \
        name##_init(&name##_state);                                                                                    \
        for (int i = 0; i < STEPS; i++) {                                                                              \
            name##_step(&name##_state);                                                                                \
            name##_out(&name##_state, out);                                                                            \
        }                                                                                                              \
    }                                                                                                                  \
    static void name##_runs(void)                                                                                      \
    {                                                                                                                  \
        name##_init(&name##_state);                                                                                    \
        name##_run(&name##_state, STEPS, NULL);                                                                        \
    }
WAYS(anchored)
WAYS(direct)
WAYS(none)

int main(void)
{
    static void (*const way[3][3])(void) = {
        {none_calls, refreshed_calls, direct_calls}, {none_read, refreshed_read, direct_read},
        {none_runs, refreshed_runs, direct_runs}
    };
    static const char *const name[] = {"step", "step, out", "run"};
    for (int w = 0; w < 3; w++) {
        double least[3] = {1e9, 1e9, 1e9};
        for (int sample = 0; sample < SAMPLES; sample++)
            for (int m = 0; m < 3; m++) {
                const double start = own_nanoseconds();
                double took;
                way[w][m]();
                took = (own_nanoseconds() - start) / STEPS;
                least[m] = took < least[m] ? took : least[m];
            }
        printf("    %-10s without %6.2f ns   by anchors %6.2f, %.2f of that (target 1.15)   "
               "in every step %6.2f, %.2f\n",
            name[w], least[0], least[1], least[1] / least[0], least[2], least[2] / least[0]);
    }
    return 0;
}
