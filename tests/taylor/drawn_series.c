/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random smooth equations, and the Taylor coefficients of their solution by another road than recurrences.
 *
 *     drawn_series spec SEED           a spec `drawn` with 20 coordinates, 12 of them of second order
 *     drawn_series truth SEED ORDER    a line `start TIME`, for each input, if there are some, its sample before and at
 *                                      the end, then for each state its name and value at the start, then for each
 *                                      k <= ORDER and state its name, k, h^k/k! y^(k), and how far that is off, in
 *                                      units of 2^-53, where each operation rounds once
 *
 * The right side is evaluated point by point in complex numbers of many bits on a small circle around the start, with
 * what is known of y (Picard); Cauchy's integral over that circle, as a sum over its points, gives the next
 * coefficient. What lies beyond aliases, by the circle's radius, 2^-16, to the power of the number of points, which is
 * 8 or more. The same a second time, each coefficient of each operation off by a random part of 2^-53 of itself, shows
 * what rounding may do: without that no bound would be right both for e^x and for what cancels. Starts and numbers are
 * binary fractions of few bits, so that they are the same in double. What has another formula in each interval of time
 * is drawn as the whole and as the formula that holds just after the start. */
#include <math.h>
#include <mpc.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    SECOND = 12, COORDS = 20, STATES = COORDS + SECOND, INPUTS = 2, TEXT = 200, MOST_NODES = 4000, MOST_ORDER = 20,
    BITS = 480, RADIUS = 16,
    RUNS = 2,                           /* the plain one, and with rounding */
    MOST_SIZE = 40                      /* of an expression */
};

enum kind {
    NUMBER, TIME, INPUT, STATE,
    PIECES,                             /* a: what holds of a function of t with kinks or jumps, whose text is `text` */
    CHOICE,                             /* a or b, one by `text` and one else */
    ADD, SUBTRACT, MULTIPLY, DIVIDE, POWER, ATAN2, SQRT, EXP, LOG, SIN, COS, TAN, ASIN, ACOS, ATAN,
    SINH, COSH, TANH, KINDS
};
static const char *const name_of[KINDS] = {
    [ATAN2] = "atan2", [SQRT] = "sqrt", [EXP] = "exp", [LOG] = "log", [SIN] = "sin", [COS] = "cos", [TAN] = "tan",
    [ASIN] = "asin", [ACOS] = "acos", [ATAN] = "atan", [SINH] = "sinh", [COSH] = "cosh", [TANH] = "tanh"
};

static struct node {
    enum kind kind;
    int a, b, size;
    bool used, forked;                  /* something in it has another formula at other times */
    bool holds;                         /* of a choice: a, else b */
    double value;                       /* at the start; of a number itself */
    char text[TEXT];
    mpc_t z;
    double rounding[MOST_ORDER + 1];
} node[MOST_NODES];
static int nodes, root[COORDS];
static double start_time, h, tolerance, initial[STATES], mass[COORDS][2];
static bool driven;                     /* by `held` and `ramp` */
static double sample[INPUTS][2];        /* before and at the end */
static uint64_t state;

/* xorshift64* (Vigna 2016) */
static uint64_t draw(void)
{
    state ^= state >> 12;
    state ^= state << 25;
    state ^= state >> 27;
    return state * 0x2545f4914f6cdd1d;
}

static int below(int n) { return (int)(draw() >> 33) % n; }

/* k/16 within these, not 0 */
static double fraction(int low, int high)
{
    int k = 0;
    while (k == 0)
        k = low + below(high - low + 1);
    return k / 16.0;
}

/* ---- the equations ---- */

static double value_of(enum kind kind, double a, double b)
{
    switch (kind) {
    case ADD: return a + b;
    case SUBTRACT: return a - b;
    case MULTIPLY: return a * b;
    case DIVIDE: return a / b;
    case POWER: return pow(a, b);
    case ATAN2: return atan2(a, b);
    case SQRT: return sqrt(a);
    case EXP: return exp(a);
    case LOG: return log(a);
    case SIN: return sin(a);
    case COS: return cos(a);
    case TAN: return tan(a);
    case ASIN: return asin(a);
    case ACOS: return acos(a);
    case ATAN: return atan(a);
    case SINH: return sinh(a);
    case COSH: return cosh(a);
    case TANH: return tanh(a);
    default: abort();
    }
}

static int add_node(enum kind kind, int a, int b)
{
    if (nodes == MOST_NODES)
        abort();
    struct node *n = &node[nodes];
    *n = (struct node){ .kind = kind, .a = a, .b = b, .size = 1 };
    if (a >= 0) {
        n->size += node[a].size + (b >= 0 ? node[b].size : 0);
        n->forked = kind == PIECES || kind == CHOICE || node[a].forked || (b >= 0 && node[b].forked);
    }
    if (kind >= ADD)
        n->value = value_of(kind, node[a].value, b >= 0 ? node[b].value : 0);
    return nodes++;
}

static int number(double value)
{
    int made = add_node(NUMBER, -1, -1);
    node[made].value = value;
    return made;
}

static int time_itself(void)
{
    int made = add_node(TIME, -1, -1);
    node[made].value = start_time;
    return made;
}

/* ---- what has another formula in each interval of time ---- */

static int pieces(int holds, const char *text)
{
    int made = add_node(PIECES, holds, -1);
    node[made].value = node[holds].value;
    snprintf(node[made].text, TEXT, "%s", text);
    return made;
}

/* No multiple of 1/128, as what is compared with it is */
static double border(double near) { return near + (2 * below(32) - 31) / 256.0; }

/* table(text; ...) with nodes half a unit apart, whose first is x */
static int table(int argument, const char *of, double x)
{
    double y[3] = { fraction(-24, 24), fraction(-24, 24), fraction(-24, 24) }, value = node[argument].value;
    int piece = value < x + 0.5 ? 0 : 1;
    double slope = 2 * (y[piece + 1] - y[piece]);
    char text[TEXT];
    snprintf(text, TEXT, "table(%s; %.17g, %g; %.17g, %g; %.17g, %g)", of, x, y[0], x + 0.5, y[1], x + 1, y[2]);
    int shift = number(y[piece] - slope * (x + 0.5 * piece));
    return pieces(add_node(ADD, shift, add_node(MULTIPLY, number(slope), argument)), text);
}

static int in_intervals(void)
{
    double slope = fraction(-24, 24), shift = fraction(-24, 24), value = shift + slope * start_time;
    double low = border(value), high = low + 0.25 * (1 + below(4)), other = fraction(-24, 24);
    int line = add_node(ADD, number(shift), add_node(MULTIPLY, number(slope), time_itself()));
    int second = add_node(ADD, number(low), add_node(MULTIPLY, number(other), time_itself()));
    char of[TEXT / 4], text[TEXT];
    snprintf(of, sizeof of, "%g + (%g)*t", shift, slope);
    switch (below(7)) {
    case 0:
        snprintf(text, TEXT, "abs(%s - (%.17g))", of, low);
        line = add_node(SUBTRACT, line, number(low));
        return pieces(node[line].value > 0 ? line : add_node(MULTIPLY, number(-1), line), text);
    case 1:
        snprintf(text, TEXT, "min(%s, %.17g + (%g)*t)", of, low, other);
        return pieces(node[line].value < node[second].value ? line : second, text);
    case 2:
        snprintf(text, TEXT, "max(%s, %.17g + (%g)*t, %.17g)", of, low, other, high);
        second = node[line].value > node[second].value ? line : second;
        return pieces(node[second].value > high ? second : number(high), text);
    case 3:
        snprintf(text, TEXT, "clip(%s, %.17g, %.17g)", of, low, high);
        return pieces(value < low ? number(low) : value > high ? number(high) : line, text);
    case 4:
        snprintf(text, TEXT, "deadzone(%s, %.17g, %.17g)", of, low, high);
        if (value > low && value < high)
            return pieces(number(0), text);
        return pieces(add_node(SUBTRACT, line, number(value < low ? low : high)), text);
    case 5:
        snprintf(text, TEXT, "sgn(%s - (%.17g))", of, low);
        return pieces(number(value > low ? 1 : -1), text);
    default:
        return table(line, of, low);
    }
}

/* a until a time near the start, perhaps the start itself, and b from then on */
static int choice(int a, int b)
{
    static const char *const sign[] = { "<", "<=", ">", ">=" };
    double when = start_time + (below(4) ? (2 * below(32) - 31) / 64.0 : 0);
    int which = below(4), made = add_node(CHOICE, a, b);
    struct node *n = &node[made];
    n->holds = (when <= start_time) == (which >= 2);
    n->value = node[n->holds ? a : b].value;
    snprintf(n->text, TEXT, "t %s %.17g", sign[which], when);
    return made;
}

/* ---- expressions ---- */

static int input(void)
{
    int made = add_node(INPUT, -1, -1), i = node[made].b = below(INPUTS + 1);
    node[made].value = i == 0 ? sample[0][1] : i == 1 ? sample[1][0] : (sample[1][1] - sample[1][0]) / h;
    return made;
}

static int leaf(bool varies)
{
    int which = below(15);
    if (which == 0 && !varies)
        return number(fraction(-24, 24));
    if (which <= 2)
        return time_itself();
    if (which == 3)
        return in_intervals();
    if (which == 4 && driven)
        return input();
    int made = add_node(STATE, -1, -1);
    node[made].b = below(STATES);
    node[made].value = initial[node[made].b];
    node[made].a = -1;
    return made;
}

/* What a function may be of: smooth, and no closer to where it is not than its series needs; where that is forked, at
 * all times */
static int positive(int a)
{
    return node[a].value > 0.2 && !node[a].forked ? a : add_node(ADD, add_node(MULTIPLY, a, a), number(0.5));
}

static int small(int a)
{
    return fabs(node[a].value) < 0.7 && !node[a].forked ? a : add_node(MULTIPLY, number(0.5), add_node(SIN, a, -1));
}

static int moderate(int a)
{
    return fabs(node[a].value) < 1.25 && !node[a].forked ? a : add_node(TANH, a, -1);
}

static int divisor(int a)
{
    return fabs(node[a].value) > 0.3 && !node[a].forked ? a : add_node(ADD, number(1.25), add_node(MULTIPLY, a, a));
}

static int power(int a, int b)
{
    static const double exponent[] = { 2, 3, 4, 5, 7, -1, -2, -3, 0.5, 1.5, -0.5, 2.75, -1.25 };
    int which = below(17);
    if (which == 13)
        return add_node(POWER, number(fraction(4, 48)), moderate(b));
    if (which >= 14)
        return add_node(POWER, positive(a), moderate(b));
    double n = exponent[which];
    int base = floor(n) != n ? positive(a) : n < 0 ? divisor(a) : fabs(node[a].value) < 1.6 ? a : moderate(a);
    return add_node(POWER, base, number(n));
}

static int angle(int y, int x)
{
    bool forked = node[x].forked || node[y].forked;
    bool far = !forked && (node[x].value > 0.3 || fabs(node[y].value) > 0.3);
    return add_node(ATAN2, y, far ? x : divisor(x));
}

static int combine(int a, int b)
{
    enum kind kind = (enum kind)(ADD + below(KINDS - ADD));
    switch (kind) {
    case DIVIDE: return add_node(kind, a, divisor(b));
    case POWER: return power(a, b);
    case ATAN2: return angle(a, b);
    case SQRT: case LOG: return add_node(kind, positive(a), -1);
    case ASIN: case ACOS: return add_node(kind, small(a), -1);
    case EXP: case TAN: case SINH: case COSH: return add_node(kind, moderate(a), -1);
    case ADD: case SUBTRACT: case MULTIPLY: return add_node(kind, a, b);
    default: return add_node(kind, a, -1);
    }
}

static int expression(int depth)
{
    if (depth == 0 || below(8) == 0)
        return leaf(true);
    if (nodes > 20 && below(6) == 0) {              /* one that stands elsewhere too */
        int again = below(nodes);
        if (node[again].size < MOST_SIZE / 4)
            return again;
    }
    int a = expression(depth - 1), b = below(3) ? expression(depth - 1) : leaf(false);
    bool fork = below(12) == 0 && !node[a].forked && !node[b].forked;
    int made = fork ? choice(a, b) : combine(a, b);
    if (node[made].size > MOST_SIZE)
        return leaf(true);
    return fabs(node[made].value) < 8 ? made : add_node(ATAN, made, -1);
}

/* t^k cos(wt), e^{at}, t^k: what is linear in loads is taken apart by the generator */
static int smooth_load(void)
{
    int t = time_itself(), w = number(fraction(-40, 40)), turned = add_node(MULTIPLY, w, t);
    node[turned].value = node[w].value * start_time;
    int which = below(3), wave = add_node(which ? which == 1 ? COS : SIN : EXP, which ? turned : moderate(turned), -1);
    if (below(2))
        return wave;
    return add_node(MULTIPLY, wave, below(2) ? t : add_node(POWER, t, number(2 + below(3))));
}

static int load(void)
{
    int which = below(4);
    if (which == 0)
        return in_intervals();
    return which == 1 ? choice(smooth_load(), smooth_load()) : smooth_load();
}

/* Of coordinate i, which holds it: what moves as a whole would have other states */
static int right_side(int i)
{
    int own = add_node(STATE, -1, -1);
    node[own].b = i;
    node[own].value = initial[i];
    int made = add_node(SUBTRACT, expression(1 + below(4)), add_node(MULTIPLY, number(fraction(1, 40)), own));
    if (below(3) == 0)
        made = add_node(ADD, made, load());
    if (below(3) == 0)
        made = add_node(SUBTRACT, made, add_node(MULTIPLY, number(fraction(1, 40)), leaf(true)));
    return made;
}

static void mark_used(int i)
{
    struct node *n = &node[i];
    if (n->used)
        return;
    n->used = true;
    if (n->kind == CHOICE) {
        mark_used(n->holds ? n->a : n->b);
    } else if (n->kind > STATE) {
        mark_used(n->a);
        if (n->b >= 0)
            mark_used(n->b);
    }
}

static void draw_all(uint64_t seed)
{
    state = seed * 0x9e3779b97f4a7c15 + 1;
    for (int i = 0; i < 8; i++)
        draw();
    start_time = below(3) ? below(16) / 8.0 : 0;
    h = ldexp(1, -2 - below(4));
    tolerance = pow(10, -3 - below(10));
    driven = below(2);
    for (int i = 0; i < INPUTS; i++)
        for (int k = 0; k < 2; k++)
            sample[i][k] = fraction(-20, 20);
    for (int i = 0; i < STATES; i++)
        initial[i] = fraction(-20, 20);
    for (int i = 0; i < COORDS; i++) {
        root[i] = right_side(i);
        mark_used(root[i]);
        mass[i][0] = fraction(8, 40);
        mass[i][1] = i < SECOND && below(4) == 0 ? fraction(-4, 4) : 0;     /* of its neighbour, i ^ 1 */
    }
}

/* ---- the spec ---- */

static const char *state_name(int i)
{
    static char text[4][16];
    static int turn;
    turn = (turn + 1) % 4;
    snprintf(text[turn], sizeof text[turn], i < COORDS ? "q%d" : "q%d'", i % COORDS + 1);
    return text[turn];
}

static void print(int i)
{
    static const char *const input_name[] = { "held", "ramp", "ramp'" };
    static const char sign[] = { [ADD] = '+', [SUBTRACT] = '-', [MULTIPLY] = '*', [DIVIDE] = '/', [POWER] = '^' };
    const struct node *n = &node[i];
    switch (n->kind) {
    case NUMBER:
        printf(n->value < 0 ? "(%.17g)" : "%.17g", n->value);
        break;
    case TIME:
        putchar('t');
        break;
    case STATE:
        fputs(state_name(n->b), stdout);
        break;
    case INPUT:
        fputs(input_name[n->b], stdout);
        break;
    case PIECES:
        fputs(n->text, stdout);
        break;
    case CHOICE:
        printf("(%s ? ", n->text);
        print(n->a);
        fputs(" : ", stdout);
        print(n->b);
        putchar(')');
        break;
    case ADD: case SUBTRACT: case MULTIPLY: case DIVIDE: case POWER:
        putchar('(');
        print(n->a);
        putchar(sign[n->kind]);
        print(n->b);
        putchar(')');
        break;
    default:
        printf("%s(", name_of[n->kind]);
        print(n->a);
        if (n->kind == ATAN2) {
            fputs(", ", stdout);
            print(n->b);
        }
        putchar(')');
    }
}

static void print_spec(uint64_t seed)
{
    printf("model drawn  # seed %llu\ncoord q1", (unsigned long long)seed);
    for (int i = 1; i < COORDS; i++)
        printf(", %s", state_name(i));
    if (driven)
        fputs("\ninput held\ninput ramp hold first", stdout);
    printf("\nscheme taylor\ntolerance %.0e\nstep %.17g\n", tolerance, h);
    for (int i = 0; i < COORDS; i++) {
        printf("%.17g*%s%s", mass[i][0], state_name(i), i < SECOND ? "''" : "'");
        if (mass[i][1] != 0)
            printf(" + (%.17g)*%s''", mass[i][1], state_name(i ^ 1));
        printf(" = ");
        print(root[i]);
        putchar('\n');
    }
}

/* ---- the truth ---- */

static mpfr_t series[RUNS][MOST_ORDER + 2][STATES], slope[COORDS];
static double growth;

static void angle_between(mpc_t z, const struct node *n)
{
    mpc_t y, part;
    bool turned = fabs(node[n->b].value) < fabs(node[n->a].value);
    double from = turned ? (node[n->a].value > 0 ? M_PI_2 : -M_PI_2)
                         : node[n->b].value > 0 ? 0 : node[n->a].value >= 0 ? M_PI : -M_PI;
    mpc_init2(y, BITS);
    mpc_init2(part, BITS);
    mpc_div(y, node[turned ? n->b : n->a].z, node[turned ? n->a : n->b].z, MPC_RNDNN);
    mpc_atan(z, y, MPC_RNDNN);
    if (turned)
        mpc_neg(z, z, MPC_RNDNN);
    mpfr_const_pi(mpc_realref(part), MPFR_RNDN);
    mpfr_mul_d(mpc_realref(part), mpc_realref(part), round(2 * from / M_PI) / 2, MPFR_RNDN);
    mpfr_add(mpc_realref(z), mpc_realref(z), mpc_realref(part), MPFR_RNDN);
    mpc_clear(y);
    mpc_clear(part);
}

static void raise_to(mpc_t z, const struct node *n)
{
    const struct node *b = &node[n->b];
    if (b->kind == NUMBER && floor(b->value) == b->value) {
        mpc_pow_si(z, node[n->a].z, (long)b->value, MPC_RNDNN);
        return;
    }
    mpc_log(z, node[n->a].z, MPC_RNDNN);
    mpc_mul(z, z, b->z, MPC_RNDNN);
    mpc_exp(z, z, MPC_RNDNN);
}

static void evaluate(struct node *n, mpc_srcptr time, mpc_t y[STATES])
{
    mpc_ptr a = n->a >= 0 ? node[n->a].z : NULL, b = n->b >= 0 && n->kind > STATE ? node[n->b].z : NULL;
    switch (n->kind) {
    case NUMBER: mpc_set_d(n->z, n->value, MPC_RNDNN); break;
    case TIME: mpc_set(n->z, time, MPC_RNDNN); break;
    case STATE: mpc_set(n->z, y[n->b], MPC_RNDNN); break;
    case PIECES: mpc_set(n->z, a, MPC_RNDNN); break;
    case CHOICE: mpc_set(n->z, n->holds ? a : b, MPC_RNDNN); break;
    case INPUT:
        mpc_set_d(n->z, n->value, MPC_RNDNN);
        if (n->b == 1) {                /* all of few bits */
            mpc_t change;
            mpc_init2(change, BITS);
            mpc_set_d(change, start_time, MPC_RNDNN);
            mpc_sub(change, time, change, MPC_RNDNN);
            mpfr_mul_d(mpc_realref(change), mpc_realref(change), (sample[1][1] - sample[1][0]) / h, MPFR_RNDN);
            mpfr_mul_d(mpc_imagref(change), mpc_imagref(change), (sample[1][1] - sample[1][0]) / h, MPFR_RNDN);
            mpc_add(n->z, n->z, change, MPC_RNDNN);
            mpc_clear(change);
        }
        break;
    case ADD: mpc_add(n->z, a, b, MPC_RNDNN); break;
    case SUBTRACT: mpc_sub(n->z, a, b, MPC_RNDNN); break;
    case MULTIPLY: mpc_mul(n->z, a, b, MPC_RNDNN); break;
    case DIVIDE: mpc_div(n->z, a, b, MPC_RNDNN); break;
    case POWER: raise_to(n->z, n); break;
    case ATAN2: angle_between(n->z, n); break;
    case SQRT: mpc_sqrt(n->z, a, MPC_RNDNN); break;
    case EXP: mpc_exp(n->z, a, MPC_RNDNN); break;
    case LOG: mpc_log(n->z, a, MPC_RNDNN); break;
    case SIN: mpc_sin(n->z, a, MPC_RNDNN); break;
    case COS: mpc_cos(n->z, a, MPC_RNDNN); break;
    case TAN: mpc_tan(n->z, a, MPC_RNDNN); break;
    case ASIN: mpc_asin(n->z, a, MPC_RNDNN); break;
    case ACOS: mpc_acos(n->z, a, MPC_RNDNN); break;
    case ATAN: mpc_atan(n->z, a, MPC_RNDNN); break;
    case SINH: mpc_sinh(n->z, a, MPC_RNDNN); break;
    case COSH: mpc_cosh(n->z, a, MPC_RNDNN); break;
    case TANH: mpc_tanh(n->z, a, MPC_RNDNN); break;
    default: abort();
    }
}

/* plus 2^-53 (d0 v0 + d1 v1 tau + d2 v2 tau^2 + ...), 1/2 <= |d| <= 1, v the sizes of its own coefficients */
static void round_once(struct node *n, mpc_srcptr tau, int order)
{
    mpc_t sum;
    mpc_init2(sum, BITS);
    mpc_set_ui(sum, 0, MPC_RNDNN);
    for (int k = order; k >= 0; k--) {
        mpc_mul(sum, sum, tau, MPC_RNDNN);
        mpfr_add_d(mpc_realref(sum), mpc_realref(sum), n->rounding[k], MPFR_RNDN);
    }
    mpc_mul_2si(sum, sum, -53, MPC_RNDNN);
    mpc_add(n->z, n->z, sum, MPC_RNDNN);
    mpc_clear(sum);
}

/* The right sides at h tau after the start, where the series has terms up to `known` */
static void right_sides(int run, mpc_srcptr tau, int known)
{
    mpc_t y[STATES], time;
    mpc_init2(time, BITS);
    mpc_mul_2si(time, tau, (long)log2(h), MPC_RNDNN);
    mpfr_add_d(mpc_realref(time), mpc_realref(time), start_time, MPFR_RNDN);
    for (int i = 0; i < STATES; i++) {
        mpc_init2(y[i], BITS);
        mpc_set_ui(y[i], 0, MPC_RNDNN);
        for (int k = known; k >= 0; k--) {
            mpc_mul(y[i], y[i], tau, MPC_RNDNN);
            mpfr_add(mpc_realref(y[i]), mpc_realref(y[i]), series[run][k][i], MPFR_RNDN);
        }
    }
    for (int i = 0; i < nodes; i++) {
        if (!node[i].used)
            continue;
        evaluate(&node[i], time, y);
        if (run > 0 && node[i].kind >= ADD)
            round_once(&node[i], tau, known);
    }
    for (int i = 0; i < STATES; i++)
        mpc_clear(y[i]);
    mpc_clear(time);
}

static void circle_point(mpc_t tau, int p, int N)
{
    mpfr_t angle;
    mpfr_init2(angle, BITS);
    mpfr_const_pi(angle, MPFR_RNDN);
    mpfr_mul_si(angle, angle, 2 * p, MPFR_RNDN);
    mpfr_div_si(angle, angle, N, MPFR_RNDN);
    mpfr_sin_cos(mpc_imagref(tau), mpc_realref(tau), angle, MPFR_RNDN);
    mpfr_clear(angle);
}

/* sum += what point p of N adds to the k-th coefficient of a real series, which is z there: points lie in pairs.
 * turn: the point to the power -k */
static void add_point(mpfr_t sum, mpc_srcptr z, mpc_srcptr turn, int k, int p, int N)
{
    mpfr_t part;
    mpfr_init2(part, BITS);
    mpfr_fmms(part, mpc_realref(z), mpc_realref(turn), mpc_imagref(z), mpc_imagref(turn), MPFR_RNDN);
    mpfr_mul_2si(part, part, RADIUS * k + (p == 0 || p == N / 2 ? 0 : 1), MPFR_RNDN);
    mpfr_div_si(part, part, N, MPFR_RNDN);
    mpfr_add(sum, sum, part, MPFR_RNDN);
    mpfr_clear(part);
}

static int points_for(int k) { return k < 4 ? 8 : k + 4 + k % 2; }

/* slope[i]: the k-th coefficient of each right side */
static void coefficients_of_slopes(int run, int k)
{
    int N = points_for(k);
    mpc_t tau, point, turn;
    mpc_init2(tau, BITS);
    mpc_init2(point, BITS);
    mpc_init2(turn, BITS);
    for (int i = 0; i < COORDS; i++)
        mpfr_set_ui(slope[i], 0, MPFR_RNDN);
    for (int p = 0; p <= N / 2; p++) {
        circle_point(point, p, N);
        mpc_mul_2si(tau, point, -RADIUS, MPC_RNDNN);
        mpc_pow_si(turn, point, -k, MPC_RNDNN);
        right_sides(run, tau, k);
        for (int i = 0; i < COORDS; i++)
            add_point(slope[i], node[root[i]].z, turn, k, p, N);
    }
    mpc_clear(tau);
    mpc_clear(point);
    mpc_clear(turn);
}

/* Of each operation its coefficients up to k, or if that is more what the one before grows to, times random numbers */
static void draw_rounding(int k)
{
    int N = points_for(k);
    mpc_t tau, point, turn[MOST_ORDER];
    static mpfr_t sum[MOST_NODES][MOST_ORDER];
    mpc_init2(tau, BITS);
    mpc_init2(point, BITS);
    for (int j = 0; j <= k; j++) {
        mpc_init2(turn[j], BITS);
        for (int i = 0; i < nodes; i++) {
            mpfr_init2(sum[i][j], BITS);
            mpfr_set_ui(sum[i][j], 0, MPFR_RNDN);
        }
    }
    for (int p = 0; p <= N / 2; p++) {
        circle_point(point, p, N);
        mpc_mul_2si(tau, point, -RADIUS, MPC_RNDNN);
        for (int j = 0; j <= k; j++)
            mpc_pow_si(turn[j], point, -j, MPC_RNDNN);
        right_sides(0, tau, k);
        for (int i = 0; i < nodes; i++)
            for (int j = 0; j <= k && node[i].used && node[i].kind >= ADD; j++)
                add_point(sum[i][j], node[i].z, turn[j], j, p, N);
    }
    for (int i = 0; i < nodes; i++) {
        double size = 0;
        for (int j = 0; j <= k; j++) {
            size = fmax(size * growth, fabs(mpfr_get_d(sum[i][j], MPFR_RNDN)));
            node[i].rounding[j] = size * (below(2) ? 1 : -1) * (1 + below(1001) / 1000.0) / 2;
            mpfr_clear(sum[i][j]);
        }
    }
    for (int j = 0; j <= k; j++)
        mpc_clear(turn[j]);
    mpc_clear(tau);
    mpc_clear(point);
}

/* By the masses of a pair of coordinates: Cramer */
static void solve_masses(void)
{
    mpfr_t det, first, second, part;
    mpfr_inits2(BITS, det, first, second, part, NULL);
    for (int i = 0; i < COORDS; i += 2) {
        const double m[2][2] = { { mass[i][0], mass[i][1] }, { mass[i + 1][1], mass[i + 1][0] } };
        mpfr_set_d(det, m[0][0] * m[1][1] - m[0][1] * m[1][0], MPFR_RNDN);      /* exact: few bits */
        mpfr_mul_d(first, slope[i], m[1][1], MPFR_RNDN);
        mpfr_mul_d(part, slope[i + 1], m[0][1], MPFR_RNDN);
        mpfr_sub(first, first, part, MPFR_RNDN);
        mpfr_mul_d(second, slope[i + 1], m[0][0], MPFR_RNDN);
        mpfr_mul_d(part, slope[i], m[1][0], MPFR_RNDN);
        mpfr_sub(second, second, part, MPFR_RNDN);
        mpfr_div(slope[i], first, det, MPFR_RNDN);
        mpfr_div(slope[i + 1], second, det, MPFR_RNDN);
    }
    mpfr_clears(det, first, second, part, NULL);
}

static void expand(int run, int order)
{
    for (int i = 0; i < STATES; i++)
        mpfr_set_d(series[run][0][i], initial[i], MPFR_RNDN);
    for (int k = 0; k < order; k++) {
        coefficients_of_slopes(run, k);
        solve_masses();
        for (int i = 0; i < STATES; i++) {
            mpfr_ptr next = series[run][k + 1][i];
            mpfr_mul_d(next, i >= COORDS ? slope[i - COORDS] : i < SECOND ? series[run][k][COORDS + i] : slope[i], h,
                MPFR_RNDN);
            mpfr_div_si(next, next, k + 1, MPFR_RNDN);
        }
    }
}

static void print_truth(int order)
{
    printf("start %a\n", start_time);
    for (int i = 0; i < INPUTS && driven; i++)
        printf("%a %a\n", sample[i][0], sample[i][1]);
    for (int i = 0; i < STATES; i++)
        printf("%s %a\n", state_name(i), initial[i]);
    mpfr_t difference;
    mpfr_init2(difference, BITS);
    for (int k = 0; k <= order; k++)
        for (int i = 0; i < STATES; i++) {
            /* what aliases stays below */
            double unit = fmax(fabs(mpfr_get_d(series[0][k][i], MPFR_RNDN)), ldexp(pow(growth, k), -40));
            for (int run = 1; run < RUNS; run++) {
                mpfr_sub(difference, series[run][k][i], series[0][k][i], MPFR_RNDN);
                unit = fmax(unit, ldexp(fabs(mpfr_get_d(difference, MPFR_RNDN)), 53));
            }
            printf("%s %d %.17g %.3g\n", state_name(i), k, mpfr_get_d(series[0][k][i], MPFR_RNDN), unit);
        }
    mpfr_clear(difference);
}

static void make_truth(int order)
{
    for (int run = 0; run < RUNS; run++)
        for (int k = 0; k <= order; k++)
            for (int i = 0; i < STATES; i++)
                mpfr_init2(series[run][k][i], BITS);
    for (int i = 0; i < COORDS; i++)
        mpfr_init2(slope[i], BITS);
    for (int i = 0; i < nodes; i++)
        mpc_init2(node[i].z, BITS);
    expand(0, order);
    for (int k = 1; k <= order; k++)
        for (int i = 0; i < STATES; i++) {
            double size = fabs(mpfr_get_d(series[0][k][i], MPFR_RNDN)) / fmax(1, fabs(initial[i]));
            growth = fmax(growth, pow(size, 1.0 / k));
        }
    for (int run = 1; run < RUNS; run++) {
        draw_rounding(order - 1);
        expand(run, order);
    }
    print_truth(order);
}

int main(int argc, char **argv)
{
    if (argc != 3 && argc != 4) {
        fprintf(stderr, "usage: drawn_series spec SEED, drawn_series truth SEED ORDER\n");
        return 2;
    }
    uint64_t seed = strtoull(argv[2], NULL, 10);
    draw_all(seed);
    if (strcmp(argv[1], "spec") == 0)
        print_spec(seed);
    else
        make_truth(atoi(argv[3]));
    return 0;
}
