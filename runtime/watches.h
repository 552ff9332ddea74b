/* SPDX-License-Identifier: MIT-0 */
/* watches.h: what is watched beside a series, as its columns have it: a part of series_impacts.h. */

static column watched(const pl_events *m, const pl_instant *at, int watch)
{
    column w;
    w.m = m->switching;
    w.first = at->c + m->watch[watch];
    w.terms = at->terms[m->switching->expressions + watch];
    return w;
}

static real value_of(const pl_events *m, const pl_instant *at, int watch)
{
    return at->c[m->watch[watch]];
}

/* Its value, 0 where that is but rounding */
static real certain(const column *w)
{
    const real value = column_at(w, 0);
    return magnitude(value) <= noise_of(w->terms) + TINY ? 0 : value;
}

static real speed_terms(const pl_events *m, const pl_instant *at, int k, real along)
{
    const pl_event_impact *p = &m->impact[k];
    const pl_hold *h = &m->hold[p->hold];
    const column speed = watched(m, at, p->speed), pull = watched(m, at, p->upward ? h->down : h->up);
    return speed.terms + along * pull.terms;
}

/* What lets go of a hold to this side; of a contact what over h does not show in its speed is rounding, too: where
 * states pass 0 it is that of the way there. */
static column pull_of(const pl_events *m, const pl_instant *at, int hold, int up)
{
    const int impact = m->hold[hold].impact;
    column w = watched(m, at, up ? m->hold[hold].up : m->hold[hold].down);
    w.terms += impact < 0 ? 0 : speed_terms(m, at, impact, 0) / m->h;
    return w;
}

static int is_still(const pl_events *m, const pl_instant *at, int watch)
{
    const column w = watched(m, at, watch);
    real noise;
    return magnitude(off_start(&w, 0, &noise)) <= noise;
}

static void renew(const pl_events *m, pl_instant *at)
{
    (void)m;
    at->expand(at->from, at->interval, at->y, at->c, at->terms);
}
