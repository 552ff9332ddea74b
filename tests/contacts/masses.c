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

static struct contact random_contact(const struct scene *s, enum contact_kind kind, int *above)
{
	struct contact c = { .kind = kind, .side = among(0, 1) ? 1 : -1 };
	c.on = (int)among(0, s->n - 1);
	c.against = (int)among(-1, c.on - 1);
	for (int i = 0; kind != STOP && i < 16 && !join(above, c.on, c.against); i++) {
		c.on = (int)among(0, s->n - 1);
		c.against = (int)among(-1, c.on - 1);
	}
	c.gap = among(190, 500);
	c.stiffness = among(2000, 60000);
	c.force = among(200, 3000);
	c.belt = among(0, 2) ? 0 : among(-900, 900);
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
	if (once(3))
		c->more = among(0, c->force);
	if (once(3))
		c->swing = among(-c->force, c->force) / 2;
	if (once(3))
		c->pad = among(-c->force, c->force) / 4;
	if (once(8))
		c->force = c->more = c->swing = c->pad = 0;
	if (once(3))
		c->belt = 0;
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
			s->cosine[i] = s->sine[i] = 0;
	}
	for (int k = 0; k < s->contacts; k++)
		make_contact_wild(s, &s->contact[k]);
	if (once(6))
		make_alike(s);
	s->scale = once(4) ? once(2) ? 6 : -6 : 0;
}

struct scene scene_random(unsigned seed, const int most[3], bool wild)
{
	struct scene s = { .n = 0 };
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
		s.constant[i] = among(0, 1) * among(-3000, 3000);
		s.cosine[i] = among(-6000, 6000);
		s.sine[i] = among(0, 1) * among(-6000, 6000);
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
	return s;
}

/* ---- the text ---- */

static const char *text(char *into, long thousandths)
{
	long size = thousandths < 0 ? -thousandths : thousandths;
	sprintf(into, thousandths < 0 ? "(-%ld.%03ld)" : "%ld.%03ld", size / 1000, size % 1000);
	return into;
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

static void write_force(const struct contact *c, long force, FILE *to)
{
	char a[32], b[32], p[32];
	fprintf(to, ", %s", text(a, force));
	if (c->swing)
		fprintf(to, " + %s*cos(w*t/T)", text(b, c->swing));
	if (c->pad)
		fprintf(to, " + %s*q%d", text(p, c->pad), c->pad_at + 1);
}

static void write_contact(const struct contact *c, int on, FILE *to)
{
	char a[32], b[32], p[32];
	const char *sign = on == c->on ? "+" : "-", *turned = on == c->on ? "-" : "+";
	if (c->kind == STOP && c->side > 0)
		fprintf(to, " %s %s*max(%s - %s, 0)", sign, text(a, c->stiffness), between(p, c, ""), text(b, c->gap));
	if (c->kind == STOP && c->side < 0)
		fprintf(to, " %s %s*max(-%s - %s, 0)", turned, text(a, c->stiffness), between(p, c, ""),
			text(b, c->gap));
	if (c->kind != FRICTION)
		return;
	fprintf(to, " %s friction(%s - %s", sign, between(p, c, "'"), text(a, c->belt));
	write_force(c, c->force, to);
	if (c->more)
		write_force(c, c->force + c->more, to);
	fprintf(to, ")");
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
		if (s->contact[k].on == i || s->contact[k].against == i)
			write_contact(&s->contact[k], i, to);
	fprintf(to, " = %s + %s*cos(w*t/T)", text(a, s->constant[i]), text(b, s->cosine[i]));
	fprintf(to, " + %s*sin(w*t/T)\n", text(a, s->sine[i]));
}

/* Velocities behind an impact: momentum stays, and v turns to -e v */
static void write_impact(const struct scene *s, const struct contact *c, FILE *to)
{
	char gap[32], e[32], p[32];
	fprintf(to, "when %s %s %s: ", between(p, c, ""), c->side > 0 ? ">=" : "<=", text(gap, c->side * c->gap));
	if (c->against == GROUND) {
		fprintf(to, "q%d' = -%s*q%d'\n", c->on + 1, text(e, c->restitution), c->on + 1);
		return;
	}
	long on = s->mass[c->on], against = s->mass[c->against];
	int a = c->on + 1, b = c->against + 1;
	fprintf(to, "q%d' = q%d' - (1 + %s)*%ld/%ld*(q%d' - q%d'), ", a, a, text(e, c->restitution), against,
		on + against, a, b);
	fprintf(to, "q%d' = q%d' + (1 + %s)*%ld/%ld*(q%d' - q%d')\n", b, b, e, on, on + against, a, b);
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
	for (int i = 0; i < s->n; i++)
		write_equation(s, i, to);
	for (int i = 0; i < s->contacts; i++)
		if (s->contact[i].kind == IMPACT)
			write_impact(s, &s->contact[i], to);
	fprintf(to, "step T*%s\n", step);
}
