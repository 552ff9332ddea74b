/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of the program grammar share: text in both languages, what is declared, terms and equations. */
#ifndef GRAMMAR_H
#define GRAMMAR_H

#include "random.h"

#include <stdbool.h>

enum { MOST_COORDS = 48, MOST_NAMES = 12, ROOM = 1 << 16 };

/* ---- text in both languages: grammar_terms.c ---- */

struct both {
	char *spec, *c;
};

char *copy(const char *text);
char *text(const char *form, ...);
struct both same(const char *words);
void add(char **to, const char *more);
/* Each @ of the forms is the next of the operands. */
struct both join2(const char *spec, const char *c, int count, const struct both *operand);

#define JOIN2(spec, c, ...)                                                                                            \
    join2(spec, c, (int)(sizeof(struct both[]){ __VA_ARGS__ } / sizeof(struct both)), (struct both[]){ __VA_ARGS__ })
#define JOIN(form, ...) JOIN2(form, form, __VA_ARGS__)

/* ---- what is declared ---- */

struct coord {
	char *name;
	int size, order;        /* size 0: a scalar */
	int first, velocity;    /* entry of y of its first component, and of its velocity */
	int top;                /* entry of `top` of its first component */
};
struct input { char *name; bool ramp; };
struct param { char *name, *value; bool tunable; };
enum class { LINEAR, PIECEWISE, SMOOTH, KINKED };
/* may it move as a whole; and has it done so: positions of 1e4, velocities of 100 */
enum drive { GROUNDED, TURNS, TURNS_FAR };

extern struct coord coord[MOST_COORDS];
extern char *ratio[MOST_COORDS];        /* how far each coordinate moves as a whole */
extern int coords;
extern struct input input[MOST_NAMES];
extern int inputs;
extern struct param param[MOST_NAMES];
extern int params;
extern char changes[400];
extern enum class class;
extern bool tunable;
extern enum drive drive;
extern char *spec_lets, *c_lets;
extern int lets;
extern char *spec_equations, *c_rows, *spec_inner, *c_inner;
extern int inners;

/* ---- terms ---- */

double motion(int which);
struct both derivative(int which, int component, int primes);   /* of a component of a coordinate, -1 of a scalar */
int any_component(int which);
struct both any_state(void);                    /* a position or a velocity that is a state */
struct both factor(double low, double high);    /* positive: a number or a param */
struct both fixed(double low, double high);     /* a number that no tunable param touches */
struct both load(int depth);
struct both sampled(void);
struct both force(void);        /* what a model of this class has beside springs, dampers and masses */

/* ---- equations: grammar_equations.c ---- */

void declare_drive(void);
void equations(void);

#endif
