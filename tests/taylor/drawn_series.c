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
#include "drawn_series.h"

static const char *const name_of[KINDS] = {
	[ATAN2] = "atan2", [SQRT] = "sqrt", [EXP] = "exp", [LOG] = "log", [SIN] = "sin", [COS] = "cos", [TAN] = "tan",
	[ASIN] = "asin", [ACOS] = "acos", [ATAN] = "atan", [SINH] = "sinh", [COSH] = "cosh", [TANH] = "tanh"
};

struct node node[MOST_NODES];
int nodes, root[COORDS];
double start_time, h, initial[STATES], mass[COORDS][2], sample[INPUTS][2];
static double tolerance;
bool driven;
static uint64_t state;

/* xorshift64* (Vigna 2016) */
static uint64_t draw(void)
{
	state ^= state >> 12;
	state ^= state << 25;
	state ^= state >> 27;
	return state * 0x2545f4914f6cdd1d;
}

int below(int n) { return (int)(draw() >> 33) % n; }

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
	int which = below(3),
			wave = add_node(which ? which == 1 ? COS : SIN : EXP, which ? turned : moderate(turned), -1);
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

const char *state_name(int i)
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
