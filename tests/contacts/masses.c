/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "masses.h"

#include <stdint.h>
#include <string.h>

/* ---- random ---- */

static uint64_t dice;

static uint64_t next(void)              /* splitmix64: Steele, Lea, Flood 2014 */
{
	uint64_t z = dice += UINT64_C(0x9e3779b97f4a7c15);
	z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
	z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
	return z ^ (z >> 31);
}

static long among(long from, long to)
{
	return from + (long)(next() % (uint64_t)(to - from + 1));
}

/* Directions between masses are a forest as long as no new one closes a circle; the ground is a node too. */
static int root_of(const int *above, int node)
{
	while (above[node] != node)
		node = above[node];
	return node;
}

static bool join(int *above, int on, int against)
{
	int a = root_of(above, on + 1), b = root_of(above, against + 1);
	above[a] = b;
	return a != b;
}

static struct law steady(long at)
{
	struct law law = { { 0 }, { 0 } };
	for (int k = 0; k < MOST_SEGMENTS; k++)
		law.at[k] = at;
	return law;
}

static struct contact random_contact(const struct scene *s, enum contact_kind kind, int *above)
{
	struct contact c = { .kind = kind, .side = among(0, 1) ? 1 : -1 };
	c.on = (int)among(0, s->n - 1);
	c.against = (int)among(-1, c.on - 1);
	for (int i = 0; kind != STOP && i < 16 && !join(above, c.on, c.against); i++) {
		c.on = (int)among(0, s->n - 1);
		c.against = (int)among(-1, c.on - 1);
	}
	c.gap = steady(among(190, 500));
	c.stiffness = among(2000, 60000);
	c.force = steady(among(200, 3000));
	c.belt = steady(among(0, 2) ? 0 : among(-900, 900));
	c.restitution = among(0, 9) ? among(100, 900) : among(0, 1) * 1000;
	return c;
}

/* Once in so many times */
static bool once(long in)
{
	return among(1, in) == 1;
}

static void make_contact_wild(const struct scene *s, struct contact *c)
{
	c->pad_at = (int)among(0, s->n - 1);
	if (once(3))
		c->restitution = among(0, 1) * 1000;
	const long force = c->force.at[0];
	if (once(3))
		c->more = among(0, force);
	if (once(3))
		c->swing = among(-force, force) / 2;
	if (once(3))
		c->pad = among(-force, force) / 4;
	if (once(8)) {
		c->force = steady(0);
		c->more = c->swing = c->pad = 0;
	}
	if (once(3))
		c->belt = steady(0);
}

/* All masses and what acts on them as the first of them, none coupled */
static void make_alike(struct scene *s)
{
	for (int i = 0; i < s->n; i++) {
		s->spring[i] = s->damper[i] = 0;
		s->mass[i] = s->mass[0];
		s->constant[i] = s->constant[0];
		s->cosine[i] = s->cosine[0];
		s->sine[i] = s->sine[0];
		s->start[i] = s->start[0];
		s->speed[i] = s->speed[0];
	}
	for (int k = 1; k < s->contacts; k++) {
		struct contact *c = &s->contact[k];
		const int on = c->on, against = c->against;
		*c = s->contact[0];
		c->on = on;
		c->against = against;
	}
}

static void make_wild(struct scene *s)
{
	for (int i = 0; i < s->n; i++) {
		if (once(3))
			s->speed[i] = 0;
		if (once(4))
			s->start[i] = 0;
		if (once(5))
			s->spring[i] = s->damper[i] = 0;
		if (once(3))
			s->cosine[i] = s->sine[i] = steady(0);
	}
	for (int k = 0; k < s->contacts; k++)
		make_contact_wild(s, &s->contact[k]);
	if (once(6))
		make_alike(s);
	s->scale = once(4) ? once(2) ? 6 : -6 : 0;
}

/* ---- changes ---- */

static void vary(const struct scene *s, struct law *law, long from, long to, long slope)
{
	for (int k = 0; k < s->segments; k++) {
		if (k > 0)
			law->at[k] = among(0, 2) ? among(from, to) : law->at[k - 1];
		law->slope[k] = among(0, 2) ? 0 : among(slope < 0 ? slope : 0, slope < 0 ? -slope : slope);
	}
}

/* Straight pieces that meet, or open: slopes of 0.04 and times of 0.025 s make whole thousandths. */
static void vary_gap(const struct scene *s, struct law *gap)
{
	for (int k = 0; k < s->segments; k++) {
		gap->slope[k] = 40 * among(-1, 1);
		if (k > 0)
			gap->at[k] = gap->at[k - 1] + (gap->slope[k - 1] - gap->slope[k]) * s->change[k - 1] / 1000 +
				     (among(0, 3) ? 0 : among(1, 100));
	}
}

static void choose_changes(struct scene *s, int most)
{
	bool moving = false;
	s->segments = 1 + (int)among(1, most);
	for (int k = 0; k < s->contacts; k++)
		moving = moving || s->contact[k].kind == IMPACT;
	for (int k = 0; k + 1 < s->segments; k++) {
		const long steps = (among(500, 3000) + (k ? s->change[k - 1] : 0)) / s->step + 1;
		s->change[k] = among(0, 2) ? among(1, 2500) + (k ? s->change[k - 1] : 0) : steps * s->step;
		if (moving)
			s->change[k] = (s->change[k] / 25 + 1) * 25;
	}
}

static void random_changes(struct scene *s, int most)
{
	s->step = 100;                          /* a multiple of all that random.sh takes */
	choose_changes(s, most);
	for (int i = 0; i < s->n; i++) {
		vary(s, &s->constant[i], -3000, 3000, -600);
		vary(s, &s->cosine[i], -6000, 6000, 0);
		vary(s, &s->sine[i], -6000, 6000, 0);
	}
	for (int k = 0; k < s->contacts; k++) {
		struct contact *c = &s->contact[k];
		if (c->kind == STOP && among(0, 1))
			vary(s, &c->gap, 190, 500, -20);
		if (c->kind == FRICTION && among(0, 1))
			vary(s, &c->force, 200, 3000, 100);
		if (c->kind == FRICTION && among(0, 1))
			vary(s, &c->belt, -900, 900, -200);
		if (c->kind == IMPACT && among(0, 1))
			vary_gap(s, &c->gap);
	}
}

struct scene scene_random(unsigned seed, const int most[4], bool wild)
{
	struct scene s = { .segments = 1 };
	int above[MOST_MASSES + 1], bound = 0;
	for (int i = 0; i <= MOST_MASSES; i++)
		above[i] = i;
	dice = UINT64_C(1000003) * seed + 17;
	s.n = (int)among(1, wild ? MOST_MASSES : 3);
	s.frequency = among(500, 6000);
	s.step = among(2, 40) * 5;
	for (int i = 0; i < s.n; i++) {
		s.mass[i] = among(500, 3000);
		s.spring[i] = among(1000, 30000);
		s.damper[i] = among(0, 600);
		s.constant[i] = steady(among(0, 1) * among(-3000, 3000));
		s.cosine[i] = steady(among(-6000, 6000));
		s.sine[i] = steady(among(0, 1) * among(-6000, 6000));
		s.start[i] = among(-90, 90);
		s.speed[i] = among(-2000, 2000);
	}
	for (int kind = STOP; kind <= IMPACT; kind++)
		for (long count = most[kind] ? among(s.contacts == 0 && kind == IMPACT, most[kind]) : 0;
		     count > 0 && s.contacts < MOST_CONTACTS - !wild && (kind == STOP || bound < s.n); count--) {
			s.contact[s.contacts++] = random_contact(&s, (enum contact_kind)kind, above);
			bound += kind != STOP;
		}
	if (s.contacts == 0)
		s.contact[s.contacts++] = random_contact(&s, most[FRICTION] ? FRICTION : STOP, above);
	if (wild)
		make_wild(&s);
	else if (most[IMPACT + 1] > 0)
		random_changes(&s, most[IMPACT + 1]);
	return s;
}

/* ---- the text ---- */

enum { LONG = 512 };

static const char *text(char *into, long thousandths)
{
	long size = thousandths < 0 ? -thousandths : thousandths;
	sprintf(into, thousandths < 0 ? "(-%ld.%03ld)" : "%ld.%03ld", size / 1000, size % 1000);
	return into;
}

/* Sign times a law: (t < 1.250 ? 0.300 + 0.040*t : 0.350); into: LONG */
static const char *law_text(char *into, const struct scene *s, const struct law *law, long sign)
{
	char a[32], b[32], *at = into;
	at += sprintf(at, "(");
	for (int k = 0; k < s->segments; k++) {
		bool lasts = true;
		for (int i = k + 1; i < s->segments; i++)
			lasts = lasts && law->at[i] == law->at[k] && law->slope[i] == law->slope[k];
		if (!lasts)
			at += sprintf(at, "t < %s ? ", text(a, s->change[k]));
		at += sprintf(at, "%s", text(a, sign * law->at[k]));
		if (law->slope[k])
			at += sprintf(at, " + %s*t", text(b, sign * law->slope[k]));
		at += sprintf(at, lasts ? ")" : " : ");
		if (lasts)
			break;
	}
	return into;
}

/* Its slope likewise */
static const char *slope_text(char *into, const struct scene *s, const struct law *law, long sign)
{
	struct law slope = { { 0 }, { 0 } };
	for (int k = 0; k < s->segments; k++)
		slope.at[k] = law->slope[k];
	return law_text(into, s, &slope, sign);
}

/* q2 - q1, or its derivative */
static const char *between(char *into, const struct contact *c, const char *primes)
{
	const char *unit = *primes ? "T*" : "";
	if (c->against == GROUND)
		sprintf(into, "%sq%d%s", unit, c->on + 1, primes);
	else
		sprintf(into, "%s(q%d%s - q%d%s)", unit, c->on + 1, primes, c->against + 1, primes);
	return into;
}

/* Its force on `on`, written once: what it is in each segment of time has one place in the text */
static void write_limit(const struct scene *s, const struct contact *c, long more, FILE *to)
{
	char a[LONG], b[32];
	fprintf(to, ", %s", law_text(a, s, &c->force, 1));
	if (more)
		fprintf(to, " + %s", text(b, more));
	if (c->swing)
		fprintf(to, " + %s*cos(w*t/T)", text(b, c->swing));
	if (c->pad)
		fprintf(to, " + %s*q%d", text(b, c->pad), c->pad_at + 1);
}

static void write_force(const struct scene *s, int index, FILE *to)
{
	const struct contact *c = &s->contact[index];
	char a[32], b[LONG], p[32];
	if (c->kind == STOP)
		fprintf(to, "let c%d = %s%s*max(%s%s - %s, 0)\n", index, c->side < 0 ? "-" : "", text(a, c->stiffness),
			c->side < 0 ? "-" : "", between(p, c, ""), law_text(b, s, &c->gap, 1));
	if (c->kind != FRICTION)
		return;
	fprintf(to, "let c%d = friction(%s - %s", index, between(p, c, "'"), law_text(b, s, &c->belt, 1));
	write_limit(s, c, 0, to);
	if (c->more)
		write_limit(s, c, c->more, to);
	fprintf(to, ")\n");
}

static void write_equation(const struct scene *s, int i, FILE *to)
{
	char a[32], b[32];
	fprintf(to, "%s*T*T*q%d''", text(a, s->mass[i]), i + 1);
	for (int k = i; k < s->n && k <= i + 1; k++) {
		const struct contact link = { .on = k, .against = k - 1 };
		char p[32], v[32];
		fprintf(to, " %c %s*%s %c %s*%s", k == i ? '+' : '-', text(a, s->spring[k]), between(p, &link, ""),
			k == i ? '+' : '-', text(b, s->damper[k]), between(v, &link, "'"));
	}
	for (int k = 0; k < s->contacts; k++)
		if (s->contact[k].kind != IMPACT && (s->contact[k].on == i || s->contact[k].against == i))
			fprintf(to, " %c c%d", s->contact[k].on == i ? '+' : '-', k);
	char e[LONG], c[LONG], d[LONG];
	fprintf(to, " = %s + %s*cos(w*t/T) + %s*sin(w*t/T)\n", law_text(e, s, &s->constant[i], 1),
		law_text(c, s, &s->cosine[i], 1), law_text(d, s, &s->sine[i], 1));
}

/* Velocities behind an impact: momentum stays, and v turns to -e v, seen from where the gap is */
static void write_impact(const struct scene *s, const struct contact *c, FILE *to)
{
	char gap[LONG], slope[LONG], e[32], p[32];
	fprintf(to, "when %s %s %s: ", between(p, c, ""), c->side > 0 ? ">=" : "<=",
		law_text(gap, s, &c->gap, c->side));
	slope_text(slope, s, &c->gap, c->side);
	if (c->against == GROUND) {
		fprintf(to, "q%d' = %s - %s*(q%d' - %s)\n", c->on + 1, slope, text(e, c->restitution), c->on + 1,
			slope);
		return;
	}
	long on = s->mass[c->on], against = s->mass[c->against];
	int a = c->on + 1, b = c->against + 1;
	fprintf(to, "q%d' = q%d' - (1 + %s)*%ld/%ld*(q%d' - q%d' - %s), ", a, a, text(e, c->restitution), against,
		on + against, a, b, slope);
	fprintf(to, "q%d' = q%d' + (1 + %s)*%ld/%ld*(q%d' - q%d' - %s)\n", b, b, e, on, on + against, a, b, slope);
}

void scene_write(const struct scene *s, const char *step, FILE *to)
{
	char a[32];
	fprintf(to, "model scene\nparam w = %s, T = 1e%d\ncoord q1", text(a, s->frequency), s->scale);
	for (int i = 1; i < s->n; i++)
		fprintf(to, ", q%d", i + 1);
	for (int i = 0; i < s->n; i++)
		fprintf(to, "%sq%d = %s", i ? ", " : "\ninit ", i + 1, text(a, s->start[i]));
	for (int i = 0; i < s->n; i++)
		fprintf(to, ", q%d' = %s/T", i + 1, text(a, s->speed[i]));
	fprintf(to, "\n");
	for (int k = 0; k < s->contacts; k++)
		write_force(s, k, to);
	for (int i = 0; i < s->n; i++)
		write_equation(s, i, to);
	for (int i = 0; i < s->contacts; i++)
		if (s->contact[i].kind == IMPACT)
			write_impact(s, &s->contact[i], to);
	fprintf(to, "step T*%s\n", step);
}
