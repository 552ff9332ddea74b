/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Masses in a chain with stops, friction and impacts, as numbers and as the text of a spec: what is integrated in
 * multiprecision by truth.c, and what plgen is given, are written from one description and share nothing else. */
#ifndef MASSES_H
#define MASSES_H

#include <stdbool.h>
#include <stdio.h>

enum { MOST_MASSES = 4, MOST_CONTACTS = 5, GROUND = -1, MOST_SEGMENTS = 4 };

/* All numbers are whole thousandths, so that text and numbers are the same. Between mass `on` and mass `against`, or
 * the ground, p = side (q_on - q_against) and v = q_on' - q_against' */
struct law { long at[MOST_SEGMENTS], slope[MOST_SEGMENTS]; };   /* at + slope t, in each segment of time */
struct contact {
	enum contact_kind { STOP, FRICTION, IMPACT } kind;
	int on, against;
	long side;              /* of stop and impact: 1 or -1 */
	struct law gap;         /* of stop and impact: met where p comes to it; that of an impact jumps only to open */
	long stiffness;         /* of a stop: it pushes back with stiffness (p - gap) */
	/* of friction: at most this while it slides, and `more` above it while it sticks; beyond that */
	struct law force;
	long more, swing, pad;  /* swing cos(w t), and pad times the position of mass pad_at */
	int pad_at;
	struct law belt;        /* of friction: it slides with v - belt */
	long restitution;       /* of an impact */
};
struct scene {
	int n, contacts;
	long mass[MOST_MASSES];
	long spring[MOST_MASSES], damper[MOST_MASSES];  /* to the mass before, of the first to the ground */
	/* loads; the last two without slope */
	struct law constant[MOST_MASSES], cosine[MOST_MASSES], sine[MOST_MASSES];
	long frequency;
	int segments;           /* of time, */
	long change[MOST_SEGMENTS - 1]; /* and where they end [1e-3 s] */
	bool left;              /* forces that are not piecewise linear: */
	long cubic[MOST_MASSES], excited[MOST_MASSES], swing[MOST_MASSES];      /* q^3, (q^2 - 1) q', sin q */
	long start[MOST_MASSES], speed[MOST_MASSES];
	struct contact contact[MOST_CONTACTS];
	long step;              /* [1e-3 s] */
	int scale;              /* the spec is written in units of time of 10^-scale s */
};

/* most: how many contacts of each kind, at least one in all; changes of the loads. Contacts with friction and impacts
 * are along directions of which none follows from the others. wild: more masses, forces of friction that change, that
 * are higher at rest or zero, restitutions of 0 and 1, masses at rest, without springs, several that do the same at one
 * instant, other units of time; without changes of the loads. */
struct scene scene_random(unsigned seed, const int most[4], bool wild);
/* to one that is neither wild nor changes: forces that are not piecewise linear */
void scene_leave(struct scene *s);
void scene_write(const struct scene *s, const char *step, FILE *to);    /* as a spec, whose model is called scene */

#endif
