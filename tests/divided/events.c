/* SPDX-License-Identifier: MIT-0 */
/* Steps that go from crossing to crossing beside the equations by hand, located in long double: the order that is
 * stated, errors by the tolerance, every crossing. TABLE=1: figures. */
#ifndef VARIANTS                            /* of the schemes that are tested: taylor; radau and auto */
#define VARIANTS "events_variants.h"
#define VARIANT_TABLE events_table
#endif
#ifndef SYSTEMS
#define SYSTEMS divided_systems
#define SYSTEM_COUNT divided_count
#endif
#include VARIANTS
#include "systems.h"
#include "tap.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SECONDS = 6, PARTS = 2, SAMPLES = SECONDS * PARTS, ROOM = 400 };

struct truth {
    real y[SAMPLES + 1][MOST_OF_STATES], crossed[ROOM];
    int count;
    double most;
};

static struct truth truth_of(const struct divided_system *s)
{
    struct truth truth = { .most = 0 };
    real y[HAND_MOST] = { 0 };
    memcpy(y, s->start, sizeof s->start);
    after_change = 0;
    place_divided(s, 0, y);
    /* exactly on a breakpoint: where it is going */
    if (s->start[1] == 0 && s->states == 2) {
        real ahead[HAND_MOST] = { 0 };
        memcpy(ahead, y, sizeof s->start);
        gragg(s->f, s->states, 0, 1e-6L, 1, 0, NULL, ahead);
        place_divided(s, 1e-6L, ahead);
    }
    memcpy(truth.y[0], y, sizeof truth.y[0]);
    for (int k = 1; k <= SAMPLES; k++) {
        truth.count += follow_divided(s, (real)(k - 1) / PARTS, (real)k / PARTS, y, truth.crossed + truth.count,
                                      ROOM - truth.count);
        memcpy(truth.y[k], y, sizeof truth.y[k]);
        for (int i = 0; i < s->states; i++)
            truth.most = fmax(truth.most, (double)fabsl(y[i]));
    }
    return truth;
}

struct found {
    double error, time;                 /* largest of a state, over the largest state; of a crossing's time */
    int count, status;
};

static struct found follow(const struct variant *v, const struct divided_system *s, const struct truth *truth)
{
    const pl_model *m = v->model;
    const int steps = (int)lround(1 / m->h);
    struct found found = { 0, 0, 0, 0 };
    pl_crossing crossing[MOST_EVENTS];
    double y[MOST_STATES];
    void *state = calloc(1, m->size);
    m->init(state);
    for (int k = 1; k <= SECONDS * steps; k++) {
        m->step(state, NULL);
        const int count = v->crossings(state, crossing);
        for (int i = 0; i < count && found.count + i < truth->count; i++)
            found.time = worse(found.time, fabs((k - 1) * m->h + crossing[i].time -
                                                (double)truth->crossed[found.count + i]));
        found.count += count;
        if (k * PARTS % steps != 0)
            continue;
        m->get(state, y);
        for (int i = 0; i < s->states; i++)
            found.error = worse(found.error,
                                (double)fabsl(y[i] - truth->y[k * PARTS / steps][i]) / truth->most);
    }
    found.status = m->status(state);
    if (found.count != (int)v->crossed(state))
        found.count = -1;
    free(state);
    return found;
}

static const struct variant *variant_called(const char *name)
{
    const struct variant *v = VARIANT_TABLE;
    while (v->model && strcmp(v->model->name, name) != 0)
        v++;
    return v->model ? v : NULL;
}

/* The three steps of one order */
static void check_order(const struct divided_system *s, const struct truth *truth, int order)
{
    struct found found[3];
    bool counted = true;
    for (int k = 0; k < 3; k++) {
        char name[64];
        (void)snprintf(name, sizeof name, "%s_order%d_%d", s->name, order, k);
        if (!variant_called(name))
            return;
        found[k] = follow(variant_called(name), s, truth);
        counted = counted && found[k].count == truth->count && found[k].status == 0;
    }
    const double measured = log2(found[0].error / found[2].error) / 2;
    if (!ok(fabs(measured - order) < 0.15, "%s: order %d", s->name, order))
        note("measured %.3f, from errors %.3g, %.3g, %.3g", measured, found[0].error, found[1].error,
             found[2].error);
    if (!ok(counted, "%s, order %d: %d crossings", s->name, order, truth->count))
        note("found %d, %d, %d; status %d, %d, %d", found[0].count, found[1].count, found[2].count,
             found[0].status, found[1].status, found[2].status);
    if (getenv("TABLE"))
        printf("| %s | %d | %.3f | %.2g | %.2g | %.2g |\n", s->name, order, measured, found[0].error, found[1].error,
               found[2].error);
}

/* Whether there is such a variant */
static int check_tolerance(const struct divided_system *s, const struct truth *truth, const char *scheme, int digits)
{
    char name[64];
    (void)snprintf(name, sizeof name, "%s_%s%d_0", s->name, scheme, digits);
    if (!variant_called(name))
        return 0;
    const struct found found = follow(variant_called(name), s, truth);
    const double tolerance = pow(10, -digits);
    if (!ok(found.error < 100 * tolerance && found.count == truth->count && found.status == 0,
            "%s, %s 1e-%d: error, %d crossings", s->name, scheme, digits, truth->count))
        note("error %.3g, %d crossings, status %d", found.error, found.count, found.status);
    if (!ok(found.time < 1000 * tolerance, "%s, %s 1e-%d: times of crossings", s->name, scheme, digits))
        note("off by %.3g s", found.time);
    if (getenv("TABLE"))
        printf("| %s | %s | 1e-%d | %.2g | %.2g | %d |\n", s->name, scheme, digits, found.error, found.time,
               found.count);
    return 1;
}

int main(void)
{
    for (int i = 0; i < SYSTEM_COUNT; i++) {
        const struct divided_system *s = &SYSTEMS[i];
        const struct truth truth = truth_of(s);
        for (int order = 4; order <= 8; order += 2)
            check_order(s, &truth, order);
        int tolerances = 0;
        for (int digits = 4; digits <= 13; digits++)
            tolerances += check_tolerance(s, &truth, "by", digits) + check_tolerance(s, &truth, "radau", digits) +
                check_tolerance(s, &truth, "auto", digits);
        ok(tolerances >= 3, "%s: %d tolerances", s->name, tolerances);
    }
    return tap_end();
}
