/* SPDX-License-Identifier: MIT-0 */
/* parts.h: region and crossings of a piecewise-linear model of independent parts, each of which has regions and
 * crossings of its own.
 *
 * Included by the file of the model, which defines before it
 *
 *     PL(name), PL_TYPE     the model, with members contact[PL_PARTS] and crossing[PL_PARTS][]
 *     PL_PARTS              those that have switching functions
 *     PL_MAX_EVENTS         crossings of all of them in a step
 *     PL(shares)[part]      what each region of a part adds to the number of the model's
 *     PL(numbers)[part]     of its switching functions among the model's */
#include "numbers.h"

int PL(region)(const PL_TYPE *s)
{
    int part, region = 0;
    for (part = 0; part < PL_PARTS; part++) {
        region += PL(shares)[part][s->contact[part].region];
    }
    return region;
}

uint64_t PL(crossed)(const PL_TYPE *s)
{
    uint64_t total = 0;
    int part;
    for (part = 0; part < PL_PARTS; part++) {
        total += s->contact[part].total;
    }
    return total;
}

/* Those of all parts, by time */
int PL(crossings)(const PL_TYPE *s, pl_crossing crossing[PL_MAX_EVENTS])
{
    int next[PL_PARTS] = {0}, count = 0, part, first;
    for (;;) {
        first = -1;
        for (part = 0; part < PL_PARTS; part++) {
            if (next[part] < s->contact[part].crossings &&
                (first < 0 || s->crossing[part][next[part]].time < s->crossing[first][next[first]].time)) {
                first = part;
            }
        }
        if (first < 0) {
            return count;
        }
        crossing[count] = s->crossing[first][next[first]++];
        crossing[count].expression = PL(numbers)[first][crossing[count].expression];
        count++;
    }
}

#include "undef.h"
