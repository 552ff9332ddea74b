/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The models of kernels, beside those of files. */
#include "kernels.h"

/* ---- specs that are hard ---- */

#define ONE "model m\ncoord x\ninit x = 0.3\n"
#define TWO "model m\ncoord x, y\ninit x = 0.3\n"
#define THREE "model m\ncoord x, y, z\ninit x = 0.3\n"

const struct hard_spec specs[] = {
	{ "undamped", ONE "x'' + 25*x + x^3 = 0\nstep 0.1\n" },
	{ "undamped, two equal", TWO "x'' + 100*x + x^3 = 0\ny'' + 100*y + y^2 = 0\nstep 0.05\n" },
	{ "no stiffness", ONE "x'' + sin(x) = 0\nstep 0.1\n" },
	{ "no stiffness, a step that is a power of two", ONE "3*x'' + sin(x) = 7 + t\nstep 1/16\n" },
	{ "rigid body",
	  TWO "2*x'' + 50*(x - y) + 3*(x - y)^3 = 1\n3*y'' + 50*(y - x) + 3*(y - x)^3 = cos(4*t + 1)\nstep 0.02\n" },
	{ "pole 0 four times", TWO "x'' + 0.1*y^3 = 1\ny'' = x + x^2\nstep 0.3\n" },
	{ "drag alone", ONE "x'' + 3*x' + x'^3 = 2 + sin(t)\nstep 0.25\n" },
	{ "coupled by velocity alone", TWO "x'' + 2*y' + x^3 = 0\ny'' - 2*x' + y^3 = 1\nstep 0.1\n" },
	{ "critical damping, w h = 1", ONE "x'' + 200*x' + 10000*x + x^3 = 1 + cos(3*t)\nstep 0.01\n" },
	{ "critical damping, w h/2 = 1", ONE "x'' + 200*x' + 10000*x + x^3 = 1\nstep 0.02\n" },
	{ "critical damping, w h/4 = 1", ONE "x'' + 200*x' + 10000*x + x^3 = 1\nstep 0.04\n" },
	{ "defective complex pair", TWO "x'' + 2*x' + 5*x + x^3 = 0\ny'' + 2*y' + 5*y = x + sin(y)\nstep 0.1\n" },
	{ "defective pair at resonance", TWO "x'' + 100*x + x^3 = cos(10*t)\ny'' + 100*y = x\nstep 0.1\n" },
	{ "poles 1e-10 apart", ONE "x'' + 2.0000000001*x' + 1.0000000001*x + x^2 = 1\nstep 0.1\n" },
	{ "poles 1e-30 apart, as those of the load", ONE
	  "x'' + 2.000000000000000000000000000001*x' + 1.000000000000000000000000000001*x + x^2 = exp(-t)\nstep "
		"0.1\n" },
	{ "complex pairs 1e-10 apart",
	  TWO "x'' + 100*x + x^3 = 0\ny'' + 100.000000002*y + 1e-3*x*y = 1e-3*x + cos(10*t)\nstep 0.05\n" },
	{ "poles -1 and -2: e^{-h} twice, and e^{-2 h/2}", ONE "x'' + 3*x' + 2*x + x^3 = 0\nstep 0.5\n" },
	{ "stiff: mu = 1e6", ONE "x'' - 1e6*(1 - x^2)*x' + x = 0\noperator at x = 2, x' = 0\nstep 0.01\n" },
	{ "stiff: mu = 1e6, the linear terms grow", ONE "x'' - 1e6*(1 - x^2)*x' + x = 0\nstep 1e-4\n" },
	{ "stiff: 1e8 beside 1", TWO "x'' + 1e8*x + x^3 = 0\ny'' + 1e-4*y' + y + (y - x)^3 = 0\nstep 0.01\n" },
	{ "a step of 1e-12", TWO "x'' + 25*x + x^3 - 3*y = sin(7*t)\ny'' + 0.3*y' + 4*y - 2*x = 0\nstep 1e-12\n" },
	{ "a step of 1000", TWO "x'' + 25*x + 0.001*x' + x^3 - 3*y = sin(7*t)\ny'' + 0.3*y' + 4*y - 2*x = 0\nstep "
		"1000\n" },
	{ "first order", ONE "x' + 3*x + x^3 = cos(t)\nstep 0.1\n" },
	{ "first order, pole 0", ONE "x' + x^3 = 1\nstep 0.1\n" },
	{ "first order, three in a row", THREE "x' + x + x^2 = 0\n2*y' + y = x\nz' + z/2 - z*x = y\nstep 0.1\n" },
	{ "first order beside a mass",
	  "model m\ncoord x, f, T\ninit x = 0.1, f = 0.5, T = 0.3\n2*x'' + 30*x + f = 3*cos(4*t)\n"
	  "f'/50 + f/4 + 0.05*f^3 = x'\n"
	  "T' + 0.5*T = 0.2 + 0.1*f^2\nstep 0.02\n" },
	{ "first order beside a mass, with an operator",
	  "model m\ncoord x, f, T\ninit x = 0.1, f = 0.5, T = 0.3\n2*x'' + 30*x + f = 3*cos(4*t)\n"
	  "f'/50 + f/4 + 0.05*f^3 = x'\n"
	  "T' + 0.5*T = 0.2 + 0.1*f^2\noperator at x = 0.1, f = 0.5\nstep 0.02\n" },
	{ "first order, mixed derivatives",
	  TWO "3*x' + 2*y' + x + x^3 = sin(2*t)\nx' - 5*y' - y + 0.1*x*y = 0\nstep 0.1\n" },
	{ "a spring shared by two equations",
	  TWO "2*x'' + 30*x + 5*(x - y)^3 = 0\ny'' + 0.1*y' + 20*y - 5*(x - y)^3 = 0\nstep 0.02\n" },
	{ "shared inertia",
	  TWO "2*x'' + 0.5*y'' + 0.1*x' + 0.4*(x' - y')^3 + 30*x + 5*(x - y)^3 = sin(3*t)\n"
		  "0.5*x'' + y'' + 0.2*y' - 0.4*(x' - y')^3 + 20*y - 5*(x - y)^3 + 0.3*x*y' = 0\nstep 0.02\n" },
	{ "shared inertia, with an operator", TWO
	  "2*x'' + 0.5*y'' + 0.1*x' + 0.4*(x' - y')^3 + 30*x + 5*(x - y)^3 = sin(3*t)\n"
	  "0.5*x'' + y'' + 0.2*y' - 0.4*(x' - y')^3 + 20*y - 5*(x - y)^3 + 0.3*x*y' = 0\n"
	  "operator at x = 0.5, y = -0.2, x' = 1, y' = 0\nstep 0.02\n" },
	{ "independent blocks, coupled by the remainder alone",
	  THREE "x'' + 4*x + x*y = 0\ny'' + 0.1*y' + 9*y + y*z = cos(2*t)\nz' + z = x^2\nstep 0.1\n" },
	{ "independent blocks, one without a remainder",
	  TWO "x'' + 4*x + x^3 = sin(t)\ny'' + 0.2*y' + 9*y = cos(2*t)\nstep 0.1\n" },
	{ "one drives the other", TWO "x'' + 4*x + x^3 = 0\ny'' + 0.2*y' + 9*y = x\nstep 0.1\n" },
	{ "a load that changes its formula",
	  ONE "x'' + 0.2*x' + 4*x + x^3 = (t < 0.605 ? 10*sin(pi*t/0.605) : 0)\nstep 0.01\n" },
	{ "loads in three segments of time", TWO
	  "x'' + 0.2*x' + 4*x - y + x^3 = (t < 0.3 ? 2*t : t < 1 ? exp(-t) : cos(5*t))\ny'' + 9*y - x + y^3 = 1\n"
	  "step 0.05\n" },
	{ "powers, growths and waves",
	  ONE "x'' + 0.2*x' + 4*x + x^3 = t^3 + t*exp(-0.2*t)*cos(2*t + 0.3) + exp(0.1*t) - 2\nstep 0.05\n" },
	{ "waves that the remainder alone reads",
	  TWO "x'' + x + x*cos(3*t) = 0\ny'' + 2*y - x + sin(y*exp(-t)) = 0\nstep 0.1\n" },
	{ "held inputs",
	  "model m\ncoord x, y\ninput u, v\ninit x = 0.3\n1.5*x'' + 0.3*x' + 40*x + 200*x^3 - 10*y = 2*u - v\n"
	  "y'' + 0.2*y' + 25*y - 10*x + 30*(y - x)^3 = 3*v + 0.5*u + 0.2*u*y*y'\nstep 0.02\n" },
	{ "ramped inputs and their slopes",
	  "model m\ncoord x, y\ninput u hold first, v hold first\ninit x = 0.1\n"
	  "20*x'' + 0.3*(x' - u') + 400*(x - u) + 2000*(x - u)^3 + 90*(x - y) = 0\n"
	  "y'' + 0.2*(y' - v') + 25*(y - v) + 9*(y - x) + 0.1*u'*y^2 = 0.5*u\nstep 0.02\n" },
	{ "a ramp on a free mass",
	  "model m\ncoord x\ninput u hold first\ninit x = 0.1\n3*x'' + sin(x) = u + 0.1*u'\nstep 0.3\n" },
	{ "held beside ramped, and a first order",
	  "model m\ncoord x, T\ninput u\ninput v hold first\ninit x = 0.1\nx'' + 3*x + T*x = u - 2*v\n"
	  "T' + 0.1*T + x*T = v + v'\nstep 0.1\n" },
	{ "a bank of three",
	  TWO "let w = 6*(1 - exp(-t))\nlet a = 6*exp(-t)\nx'' + 0.1*x' + (40 - w^2)*x - 2*w*y' - a*y = 0\n"
		  "y'' + 0.1*y' + (60 - w^2)*y + 2*w*x' + a*x = 3*cos(2*t)\noperator at w = 0, 2, 4\nstep 0.02\n" },
	{ "a bank through a repeated pole",
	  ONE "x'' + 2*x' + (1 + t)*x = 1\noperator at t = -0.1, 0, 0.1, 1e-10 + 0.2\nstep 0.1\n" },
	{ "seven coordinates, every one with a spring",
	  "model m\ncoord q[7]\ninit q[1] = 0.3\n"
	  "q[1]'' + 20*q[1] - 10*q[2] + q[1]^3 = cos(3*t)\nq[2]'' + 20*q[2] - 10*q[1] - 10*q[3] + q[2]^3 = 0\n"
	  "q[3]'' + 20*q[3] - 10*q[2] - 10*q[4] + q[3]^3 = 0\nq[4]'' + 20*q[4] - 10*q[3] - 10*q[5] + q[4]^3 = 0\n"
	  "q[5]'' + 20*q[5] - 10*q[4] - 10*q[6] + q[5]^3 = 0\nq[6]'' + 20*q[6] - 10*q[5] - 10*q[7] + q[6]^3 = 0\n"
	  "q[7]'' + 10*q[7] - 10*q[6] + q[7]^3 = 1\nstep 0.1\n" },
	{ "seven coordinates, free, held and ramped inputs",
	  "model m\ncoord q[7]\ninput u\ninput v hold first\n"
	  "q[1]'' + 10*q[1] - 10*q[2] + (q[1] - q[2])^3 = u\nq[2]'' + 20*q[2] - 10*q[1] - 10*q[3] - (q[1] - q[2])^3 = "
		"0\n"
	  "q[3]'' + 20*q[3] - 10*q[2] - 10*q[4] = v + v'\nq[4]'' + 20*q[4] - 10*q[3] - 10*q[5] = (t < 0.33 ? t : 0)\n"
	  "q[5]'' + 20*q[5] - 10*q[4] - 10*q[6] = 0\nq[6]'' + 20*q[6] - 10*q[5] - 10*q[7] = 0\n"
	  "q[7]'' + 10*q[7] - 10*q[6] = 1\nstep 0.1\n" },
};
const unsigned long spec_count = sizeof specs / sizeof *specs;

/* ---- random models: linear ones with springs, dampers and products added ---- */

/* 1 to 9 digits times 10^(low..high) */
static char *number(int low, int high)
{
	return format("%u.%0*ue%d", 1 + below(9), 1 + (int)below(8), below(10),
				  low + (int)below((unsigned)(high - low) + 1));
}

/* A force between i and j, or on i alone: `force` adds to the equations that stand there. */
static char *nonlinear_force(unsigned i, unsigned j)
{
	char *k = number(-2, 2);
	if (i == j)
		return chance(60) ? format("force -%s*x%u^3 on x%u\n", k, i, i) : format("force %s*sin(x%u) on "
			"x%u\n", k, i, i);
	if (chance(20))
		return format("force %s*x%u*x%u on x%u\n", k, i, j, i);
	return format("force -%s*(x%u - x%u)^3 on x%u\nforce %s*(x%u - x%u)^3 on x%u\n", k, i, j, i, k, i, j, j);
}

static char *remainders(unsigned n)
{
	char *text = "";
	for (unsigned k = 1 + below(n); k; k--)
		text = format("%s%s", text, nonlinear_force(1 + below(n), 1 + below(n)));
	return text;
}

static char *operator_at(unsigned n)
{
	char *text = format("operator at x1 = %s", number(-2, 0));
	for (unsigned i = 2; i <= n; i++)
		if (chance(60))
			text = format("%s, x%u = %s", text, i, number(-2, 0));
	return format("%s\n", text);
}

/* random_spec, whose last line is the step: another one, since e^{1e3 growth} has a limit and --step is no part of what
 * is shown */
char *random_text(uint64_t seed)
{
	const char *linear = random_spec(seed), *step = strstr(linear, "\nstep ");
	unsigned n = 1;
	random_state = seed * UINT64_C(0x9e3779b97f4a7c15) + 5;
	below(2);
	while (strstr(linear, format(", x%u", n + 1)))
		n++;
	char *text = format("%.*s\n%s", (int)(step - linear), linear, remainders(n));
	return format("%s%sstep %s\n", text, chance(40) ? operator_at(n) : "", number(chance(10) ? -9 : -3, -1));
}

/* A chain of 7 or 8, beyond the residues, free or held, damped or not, with a load and an input */
char *large_text(uint64_t seed)
{
	random_state = seed * UINT64_C(0xd1342543de82ef95) + 11;
	below(2);
	const unsigned n = 7 + below(2), first = chance(30) ? 1 + below(n) : 0;
	const bool damped = chance(50), free_ends = chance(40), ramp = chance(40), load = chance(60);
	char *text = "model made\ncoord x1";
	for (unsigned i = 2; i <= n; i++)
		text = format("%s, x%u", text, i);
	text = format("%s\n%s", text, ramp ? "input v hold first\n" : "");
	for (unsigned i = 1; i <= n; i++)
		text = format("%s%s*x%u%s = %s%s\n", text, number(-1, 1), i, i == first ? "'" : "''",
					  load && i == 1 ? "3*cos(2*t)" : "0", ramp && i == n ? " + 2*v - v'" : "");
	for (unsigned i = 1; i < n; i++) {
		text = format("%sspring %s between x%u, x%u\n", text, number(0, 2), i, i + 1);
		text = format("%s%s", text, damped ? format("damper %s between x%u, "
			"x%u\n", number(-2, 0), i, i + 1) : "");
	}
	text = format("%s%s%s", text, free_ends ? "" : "spring 3 between x1, ground\n", remainders(n));
	return format("%s%sstep %s\n", text, chance(40) ? operator_at(n) : "", number(-3, -1));
}
