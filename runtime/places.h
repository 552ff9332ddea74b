/* SPDX-License-Identifier: MIT-0 */
/* places.h: where contacts are at one instant, and how far they fly from there: a part of contacts.h, which includes it
 * behind what it asks of its file. */

/* The interval before the guard of a bounce */
static int free_of(const contacts *m, int k)
{
    return rest_of(m, k) + (m->impact[k].upward ? -1 : 1);
}

static int rests(const contacts *m, const instant *at, int k)
{
    return interval_of(m, at, m->impact[k].expression) == rest_of(m, k);
}

/* Whether a bounce flies before its guard, or rests */
static int is_before(const contacts *m, const instant *at, int k)
{
    const int rest = rest_of(m, k), interval = rest < 0 ? -1 : interval_of(m, at, m->impact[k].expression);
    return rest >= 0 && (interval == rest || interval == free_of(m, k));
}

/* Whether a bounce is on its guard, but for so much at least, flying or at rest, or where rounding has taken it */
static int touches_by(const contacts *m, const instant *at, int k, real least)
{
    real noise, beyond_it;
    if (!is_before(m, at, k)) {
        return 0;
    }
    beyond_it = depth(m, at, k, &noise);
    return beyond_it >= -larger(noise, least);
}

static int touches(const contacts *m, const instant *at, int k)
{
    return touches_by(m, at, k, 0);
}

#ifdef ROUNDS
/* The most that rounding in a step does to the guard of any bounce.  All of them count: of balls in a row those that
 * lie still have places and speeds of the size of rounding, which say nothing of how it came about. */
static real rounding_of_places(const contacts *m, const instant *at)
{
    real largest = 0;
    int k;
    for (k = 0; k < m->impacts; k++) {
        real noise;
        if (rest_of(m, k) >= 0) {
            (void)depth(m, at, k, &noise);
            largest = larger(largest, noise + m->h * noise_of(speed_terms(m, at, k, m->h)));
        }
    }
    return largest;
}
#endif

/* Whether a bounce stops a switching function that would go this way */
static int is_stopped(const contacts *m, const instant *at, int expression, int way)
{
    int k;
    for (k = 0; k < m->impacts; k++) {
        if (m->impact[k].expression == expression && m->impact[k].upward == (way > 0) && is_before(m, at, k)) {
            return 1;
        }
    }
    return 0;
}

/* How long it flies that leaves the guard of k, from how it is pressed back there [unit]; -1: for good */
static real flight(const contacts *m, const instant *at, int k)
{
    const real speed = rest_of(m, k) < 0 ? 1 : speed_of(m, at, k), press = speed > 0 ? 0 : press_of(m, at, k);
    return press > 0 ? -2 * speed / press : -1;
}

/* A length [unit] not much longer than the shortest flight that begins there */
static inline real shortened(const contacts *m, const instant *at, real length)
{
    int k;
    for (k = 0; k < m->impacts; k++) {
        const int flies = speed_of(m, at, k) < 0 && touches(m, at, k) && !rests(m, at, k);
        const real along = flies ? flight(m, at, k) : 0;
        if (along > 0) {
            length = smaller(length, 2 * along);
        }
    }
    return length;
}
