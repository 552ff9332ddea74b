/* SPDX-License-Identifier: MIT-0 */
/* events.h: impacts, contacts at rest and dry friction beside a series and in regions; part of plreal.h. */

/* ---- events.c: impacts, contacts at rest and dry friction in models with a Taylor series ----------------------- */

/* As pl_series_switching, but a switching function may have the same breakpoint twice, and is held in the interval
 * between, by friction that sticks or by a contact at rest.  Watches are further columns of c, with entries of terms
 * behind those of the switching functions: velocities, conditions of release, states after a jump.
 *
 * An impact occurs where a switching function passes a breakpoint.  One with a constraint is a bounce: it changes the
 * approach speed s to -restitution s. */
typedef struct pl_event_impact {
    int expression, breakpoint, upward;
    int hold;               /* number of the constraint of its contact at rest; -1: it is no bounce */
    int place, speed;       /* watches: penetration and approach speed */
    int jump, still, jumps; /* first assignment of its jump; of that with restitution 0; how many each has.  0: where a
                             * formula jumps; still is -1 then, if that is a time which only params move */
    PL_REAL restitution;
    PL_REAL per; /* change of the switching function for a penetration of 1 */
} pl_event_impact;

/* Derivatives by params that are states beside those that they are of: what events do to them (saltation.h). */
typedef struct pl_moved {
    int columns;
    const int *column, *state; /* of each state the column that it is of, -1: of none; the state that it is of */
    const int *time;           /* of each column the state that is the derivative of t, 0 between events; -1: none */
    const int *velocity;       /* holds x columns: watches; */
    const int *pull;           /* holds x columns x 2, as down and up of pl_hold */
    const int *place;          /* impacts x columns */
    const PL_REAL *back;       /* holds x columns x 2 x states: for a velocity of 1, for a place of 1 */
    const int *back_watch;     /* the same, as of pl_events */
} pl_moved;

/* Why derivatives are in doubt: PL_D_... bits, and of each, from the lowest on, the event that was the first: its
 * switching function, as pl_crossing has it, -1: that is not known, and its time [s]. */
typedef struct pl_doubt {
    unsigned status;
    int function[4];
    PL_REAL time[4];
} pl_doubt;

static inline void pl_doubt_add(pl_doubt *d, unsigned bits, int function, PL_REAL time)
{
    int i;
    for (i = 0; i < 4; i++) {
        if ((bits & ~d->status) >> i & 1u) {
            d->function[i] = function;
            d->time[i] = time;
        }
    }
    d->status |= bits;
}

/* ... of a step that started at this time */
static inline void pl_doubt_join(pl_doubt *d, const pl_doubt *of, PL_REAL start)
{
    int i;
    for (i = 0; i < 4; i++) {
        if (of->status >> i & 1u) {
            pl_doubt_add(d, 1u << i, of->function[i], start + of->time[i]);
        }
    }
}

typedef struct pl_events {
    const pl_series_switching *switching;
    int states;
    const int *watch; /* the column of each watch */
    int holds;        /* number of constraints, at most 64 */
    const pl_hold *hold;
    const PL_REAL *back; /* holds x states: correction of the states for a velocity of 1, which is subtracted */
    int impacts;         /* at most 32, in the order in which they act at one instant */
    const pl_event_impact *impact;
    const PL_REAL *place_back; /* impacts x states: the same for a penetration of 1 */
    const int *state, *value;  /* assignments: a state is set to a watch */
    int conflicts;
    const pl_conflict *conflict;
    PL_REAL h;                /* step [s], the unit of time of c */
    int max_events, most;     /* events in a step: listed, in all */
    /* of an entry of back and place_back that depends on the state its watch, -1: none; NULL: no entry does */
    const int *back_watch, *place_watch;
    const pl_moved *moved; /* NULL: no derivatives are among the states */
} pl_events;

/* Impacts that follow each other in a step. */
typedef struct pl_chain {
    PL_REAL last, most, least; /* last time; largest speed of close ones; speed within the rounding error of forces */
    uint32_t acting;           /* recent impacts, as bits */
    int close, impacts, ended; /* numbers of impacts in negligible time, at this instant; how often they were ended */
    int all, full;             /* number of events in the step; 1: there is no more room */
} pl_chain;

/* The start of a Taylor series, and what computes it again. */
typedef struct pl_instant {
    void (*expand)(const void *from, const int *interval, const PL_REAL *y, PL_REAL *c, PL_REAL *terms);
    const void *from;
    PL_REAL *y, *low;  /* the states and their low parts, which are 0 after an assignment */
    PL_REAL *c, *terms;
    PL_REAL *work;      /* PL_EVENT_WORK entries; where nothing happens PL_SERIES_SWITCHING_WORK */
    PL_REAL unit;       /* the unit of time of c, in h */
    int *interval;      /* of each switching function */
    uint64_t *total;    /* number of crossings since the start */
    int *crossings;     /* number in this step */
    int *rested;        /* number of contacts that came to rest after infinitely many bounces */
    pl_crossing *crossing, *last;
    PL_REAL time;       /* [s] after the start of the step */
    pl_crossing next;   /* the event that pl_events_next found */
    int starting, freed; /* the impact that begins there, the constraint that is released; -1: none */
    int crossed, was;   /* the switching function that passed a breakpoint there, or -1; its interval before */
    int unlisted;       /* 1: crossings are not listed */
    int status;         /* 0, PL_UNDECIDED, PL_TOO_MANY_EVENTS, PL_PENETRATED */
    pl_chain chain;     /* before the first impact: last is -h, all else 0 */
    pl_doubt *doubt;    /* of derivatives; times are after the start of the step */
    PL_REAL *moved;     /* PL_MOVED_WORK entries */
} pl_instant;

/* Sets the intervals of a state that was set.  A function on a double breakpoint is held there if its conditions allow
 * it; otherwise it goes to the interval that it moves into. */
void pl_events_place(const pl_events *m, pl_instant *at);

/* Computes the series from here.  Returns 1 if a switching function or a constraint had left its interval and that
 * event was passed; -1 if there were too many; else 0.  Constraints that have drifted by rounding are corrected. */
int pl_events_begin(const pl_events *m, pl_instant *at);

/* Returns the time, at most `end`, of the first event, as pl_series_switching_next does.  *size, the length of the
 * series without an event, becomes shorter after a bounce that returns soon. */
PL_REAL pl_events_next(const pl_events *m, pl_instant *at, PL_REAL *size, int *splits);

/* Passes that event; at->y is the state there.  Returns 0 if there were too many, else 1.  Simultaneous events are
 * resolved as described at pl_guards_advance. */
int pl_events_pass(const pl_events *m, pl_instant *at);

/* Returns 1 if a function or a constraint, then in at->next, is outside its interval where c starts, else 0. */
int pl_events_left(const pl_events *m, pl_instant *at);

/* Sets at->next to this event, which another search found; a constraint that it ends is released. */
void pl_events_meet(const pl_events *m, pl_instant *at, const pl_crossing *event);

/* Returns the time, at most `end`, up to which the computed series at->c has no event; 0: it has one at once. */
PL_REAL pl_events_end(const pl_events *m, pl_instant *at, PL_REAL end, int *splits);

/* Returns PL_PENETRATED if at time s the series is beyond a stop by more than rounding and `least`, else 0. */
int pl_events_places(const pl_events *m, const pl_instant *at, PL_REAL s, PL_REAL least);

/* ---- guards.c: piecewise-linear models with dry friction and impacts -------------------------------------------- */

/* As pl_switching, with guards for each region.  x' = A x; where a guard function rises above its limit x may jump, and
 * goes on in another region.  A switching function may have the same breakpoint twice: in the interval between it is
 * held there, by friction that sticks or by a contact at rest, and states that depend on others are set exactly:
 * x_i = row . x.
 *
 * An impact is a jump of the state at its guard.  It is a bounce if it changes the approach speed s to -restitution s;
 * its contact may rest, in the interval between two equal breakpoints. */
typedef struct pl_impact {
    int expression, breakpoint, upward; /* how its crossing is listed */
    int rest;                           /* the interval of its contact at rest; -1: it is no bounce */
    int jump, still;                    /* sets of assignments: its jump; for a bounce, its jump at restitution 0 */
    PL_REAL restitution;
    PL_REAL amplitude;                  /* sum of sizes of the factors of cos and sin in its speed */
} pl_impact;

typedef struct pl_guards {
    int size;          /* entries of x */
    PL_REAL h;         /* step [s] */
    int switches;      /* number of switching functions */
    const PL_REAL *row; /* switches x size: e = row . x */
    const int *breaks; /* of each switching function the number of breakpoints */
    const PL_REAL *at; /* the breakpoints: those of the first, not falling; those of the second; ... */
    const int *matrix; /* of each region the number of its A; -1: it cannot occur */
    /* The following are of each linear system, as for pl_switching. */
    const int *halvings;
    const PL_REAL *A, *Phi;
    pl_ladder ladder;
    const PL_REAL *tangent; /* switches x size */
    /* The guards of a region are guard[first[region]] to guard[first[region + 1] - 1]; hold[region] is the set of
     * assignments for its constraints, or -1. */
    const int *first;
    const pl_guard *guard;
    const PL_REAL *limit; /* of each guard */
    const int *hold;
    /* Guard functions g = row . x; d/3 times their slopes; bounds as for pl_switching; in rows of `size`.  amplitude,
     * of each and of switching functions: the sum of sizes of its factors of cos and sin, which bounds the error when
     * it is made again */
    struct { const PL_REAL *row, *tangent, *chord_error, *cubic_error, *amplitude; } guards;
    const PL_REAL *amplitude;
    /* Assignments x[state] = value . x; set k is set[k] to set[k + 1] - 1, all computed from the same x. */
    const int *set, *state;
    const PL_REAL *value;
    int impacts; /* at most 30, in the order in which they act at one instant */
    const pl_impact *impact;
    /* impacts x size, for bounces: the approach speed is speed . x; x - (e - b) back is on the breakpoint b. */
    const PL_REAL *speed, *back;
    int degree, max_events, max_splits; /* as for pl_switching */
    pl_cached *cached;
    int most; /* events in a step, listed or not */
} pl_guards;

/* Sets *c to the region of x, as pl_switching_start; on a double breakpoint x is held if its conditions allow it. */
void pl_guards_start(const pl_guards *m, const PL_REAL *x, pl_contact *c, PL_REAL *work);

/* Advances x over tau [s], 0 <= tau <= h, as pl_switching_advance.  At an event where several contacts may stick or
 * slip, the combination is taken that is consistent: no friction that sticks exceeds its stick limit, and each that
 * slips moves in its direction.  Of several it is the one with the fewest changes, then with the most that stick.
 *
 * Impacts at one instant act in their order, each on the state after the one before, and again from the first, until no
 * contact closes.  An impact slower than 2^-48 of the fastest (float: 2^-20) ends its bounces, and the contact rests;
 * so does, with e < 1, one that still acts after 1000 impacts.  The first 12 are listed; once the list is half full,
 * the first 12 within 2^-10 h (float: 2^-8).
 *
 * After a bounce with departure speed v, pressed back by the acceleration a, all further bounces take T = 2 v/(a (1 -
 * e)).  With e < 1 the contact rests, listed T later, if T <= PL_BRIEF h, or, once the list of crossings is nearly
 * full, if T <= 2^-10 h (float: 2^-8).  Contacts that touch and pass impacts to each other rest together if that holds
 * for each with the largest a, or if their bounces are lower than rounding, and all are pressed then.  Their speeds
 * follow from impacts with e = 0, so momentum is conserved.  A contact rests until its force would become a pull.
 *
 * Impacts with e < 1 go on when the list is full, up to 65536 events in a step.  A penetration within rounding counts
 * as none; c->status receives PL_PENETRATED if there is more at the end of a step. */
void pl_guards_advance(const pl_guards *m, PL_REAL tau, PL_REAL *x, pl_contact *c, pl_crossing *crossing,
                       PL_REAL *work);

/* Resolves contacts at this time [s] of a step, when loads have changed their formula and m holds the tables from then
 * on.  A switching function that has left its interval by a jump of a load passes its breakpoints, in the order of
 * functions, without impacts; then contacts that touch and close bounce, and what sticks and rests is found again. */
void pl_guards_change(const pl_guards *m, PL_REAL time, PL_REAL *x, pl_contact *c, pl_crossing *crossing,
                      PL_REAL *work);

/* The same functions for a double-double x, as pl_switching_compensated_step; m->value has of each assignment `size`
 * high parts, then as many low parts. */
void pl_guards_compensated_start(const pl_guards *m, const PL_REAL *x, pl_contact *c, PL_REAL *work);
void pl_guards_compensated_advance(const pl_guards *m, PL_REAL tau, PL_REAL *x, pl_contact *c, pl_crossing *crossing,
                                   PL_REAL *work);
void pl_guards_compensated_change(const pl_guards *m, PL_REAL time, PL_REAL *x, pl_contact *c, pl_crossing *crossing,
                                  PL_REAL *work);
