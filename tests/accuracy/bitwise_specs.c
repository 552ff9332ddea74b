/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "bitwise_specs.h"

#define ONE "model m\ncoord x\ninit x = 0.01, x' = 0.3\n"
#define TWO "model m\ncoord x1, x2\ninit x1 = 0.01, x2' = -0.2\n"
#define STEP "step 0.01\n"

const struct bitwise_spec bitwise_specs[] = {
	/* resonance: the load's poles are the system's */
	{ "cosine at the natural frequency", ONE "x'' + 25*x = cos(5*t)\n" STEP, PLAIN },
	{ "cosine at the natural frequency, with a phase", ONE "x'' + 25*x = 3*cos(5*t + 0.7)\n" STEP, PLAIN },
	{ "sine at the natural frequency", ONE "x'' + 25*x = sin(5*t)\n" STEP, PLAIN },
	{ "cosine at the lower frequency of two",
	  TWO "x1'' + 200*x1 - 100*x2 = cos(10*t)\nx2'' + 200*x2 - 100*x1 = 0\n" STEP, PLAIN },
	{ "cosine at the lower frequency of two, mode not excited",
	  TWO "x1'' + 200*x1 - 100*x2 = cos(10*t)\nx2'' + 200*x2 - 100*x1 = -cos(10*t)\n" STEP, PLAIN },
	{ "resonance with an irrational frequency", ONE "x'' + (2*pi*3)^2*x = sin(2*pi*3*t + pi/3)\n" STEP, PLAIN },
	{ "resonance through sqrt", "model m\nparam k = 3, m0 = 2, w = sqrt(k/m0)\ncoord x\nm0*x'' + k*x = "
		"cos(w*t)\n" STEP,
	  PLAIN },
	{ "resonance 1e-9 off", ONE "x'' + 25*x = cos(5.000000001*t) + sin(4.999999999*t)\n" STEP, PLAIN },
	{ "resonance of two waves at once",
	  TWO "x1'' + 4*x1 = cos(2*t + 1) + sin(3*t)\nx2'' + 9*x2 = x1 + cos(3*t - 2)\n" STEP, PLAIN },
	{ "two waves and a constant",
	  ONE "x'' + 0.3*x' + 25*x = cos(5*t) + 2*sin(7*t + 0.1) - 4\noutput x, a = x'' + t\n" STEP, PLAIN },
	{ "damped pole pair met by no load", ONE "x'' + 2*x' + 5*x = cos(2*t)\n" STEP, PLAIN },

	/* repeated poles */
	{ "two equal oscillators", TWO "x1'' + 100*x1 = 0\nx2'' + 100*x2 = 0\n" STEP, PLAIN },
	{ "two equal oscillators at resonance", TWO "x1'' + 100*x1 = cos(10*t)\nx2'' + 100*x2 = sin(10*t + 0.2)\n" STEP,
	  PLAIN },
	{ "two equal oscillators, one driving the other", TWO "x1'' + 100*x1 = 0\nx2'' + 100*x2 = x1\n" STEP, PLAIN },
	{ "defective undamped pair at resonance", TWO "x1'' + 100*x1 = cos(10*t)\nx2'' + 100*x2 = x1\n" STEP, PLAIN },
	{ "critical damping", ONE "x'' + 200*x' + 10000*x = 0\n" STEP, CRITICAL },
	{ "critical damping, with a load", ONE "x'' + 200*x' + 10000*x = 1 + cos(3*t)\n" STEP, CRITICAL },
	{ "critical damping of two", TWO "x1'' + 6*x1' + 9*x1 = 0\nx2'' + 6*x2' + 9*x2 = x1 + 2*x1'\n" STEP, PLAIN },
	{ "defective complex pair", TWO "x1'' + 2*x1' + 5*x1 = 0\nx2'' + 2*x2' + 5*x2 = x1\n" STEP, PLAIN },
	{ "complex pair four times, in a chain",
	  "model m\ncoord a, b, c, d\ninit a = 1\na'' + 2*a' + 5*a = 0\nb'' + 2*b' + 5*b = a\nc'' + 2*c' + 5*c = b\n"
	  "d'' + 2*d' + 5*d = c\n" STEP,
	  PLAIN },

	/* pole 0 */
	{ "free mass", ONE "x'' = 0\n" STEP, EXACT },
	{ "free mass under a constant force", ONE "3*x'' = 7\n" STEP, EXACT },
	{ "free mass under a wave", ONE "3*x'' = 7*cos(2*t + 1) - 1\n" STEP, PLAIN },
	{ "free mass with drag", ONE "x'' + 3*x' = 2 + sin(t)\n" STEP, PLAIN },
	{ "two masses free at both ends", TWO "x1'' + 50*x1 - 50*x2 = 0\nx2'' + 50*x2 - 50*x1 = 0\n" STEP, PLAIN },
	{ "two masses free at both ends, damped, loaded",
	  TWO
	  "2*x1'' + 0.1*x1' - 0.1*x2' + 50*x1 - 50*x2 = 1\n"
	  "3*x2'' - 0.1*x1' + 0.1*x2' + 50*x2 - 50*x1 = cos(4*t + 1)\n" STEP,
	  PLAIN },
	{ "pole 0 four times", TWO "x1'' = 1\nx2'' = x1\n" STEP, EXACT },
	{ "pole 0 six times", "model m\ncoord a, b, c\ninit a' = 1\na'' = 1\nb'' = a + 2*b'\nc'' = b - "
		"a'\n" STEP, PLAIN },
	{ "coupled by velocity alone", TWO "x1'' + 2*x2' = 0\nx2'' - 2*x1' = 1\n" STEP, PLAIN },

	/* close poles */
	{ "poles 1e-3 apart", ONE "x'' + 2.001*x' + 1.001*x = 1\n" STEP, PLAIN },
	{ "poles 1e-6 apart", ONE "x'' + 2.000001*x' + 1.000001*x = 1\n" STEP, PLAIN },
	{ "poles 1e-10 apart", ONE "x'' + 2.0000000001*x' + 1.0000000001*x = 1\n" STEP, PLAIN },
	{ "poles 1e-14 apart", ONE "x'' + 2.00000000000001*x' + 1.00000000000001*x = cos(t)\n" STEP, PLAIN },
	{ "poles 1e-60 apart", "model m\nparam d = 1e-60\ncoord x\ninit x = 1\nx'' + (2 + d)*x' + (1 + d)*x = 0\n" STEP,
	  PLAIN },
	{ "complex pairs 1e-10 apart", TWO "x1'' + 100*x1 = 0\nx2'' + 100.000000002*x2 = 1e-3*x1 + cos(10*t)\n" STEP,
	  PLAIN },
	{ "coupled weakly: 1e-10", TWO "x1'' + 100*x1 - 1e-10*x2 = 0\nx2'' + 100*x2 - 1e-10*x1 = 0\n" STEP, PLAIN },
	{ "poles about 2^-256 apart: sqrt(2)^2 beside 2",
	  "model m\nparam s = sqrt(2)\ncoord x1, x2\ninit x1 = 1\nx1'' + 2*s*x1' + 2*x1 = 0\n"
	  "x2'' + 2*s*x2' + s^2*x2 = x1 + cos(s*t)\n" STEP,
	  PLAIN },
	{ "undamped pairs about 2^-256 apart, and a load",
	  TWO "x1'' + 2*x1 = 0\nx2'' + sqrt(2)^2*x2 = x1 + cos(sqrt(2)*t)\n" STEP, PLAIN },
	{ "clusters 1e-60 wide, six poles",
	  "model m\nparam d = 1e-60\ncoord a, b, c\ninit a = 1\na'' + 2*a' + a = 0\nb'' + (2 + d)*b' + (1 + d)*b = a\n"
	  "c'' + (2 - d)*c' + (1 - d)*c = b + 1\n" STEP,
	  PLAIN },
	{ "stiffness 1e-6", ONE "x'' + 1e-6*x = cos(1e-3*t)\n" STEP, PLAIN },
	{ "stiffness 1e-18", ONE "x'' + 1e-18*x = 1\n" STEP, PLAIN },
	{ "damping 1e-12", ONE "x'' + 1e-12*x' + 25*x = cos(5*t)\n" STEP, PLAIN },
	{ "damping 1e-30", ONE "x'' + 1e-30*x' + 25*x = cos(5*t)\n" STEP, PLAIN },

	/* far apart, growing */
	{ "poles -1e8 and -1e-3", ONE "x'' + 100000000.001*x' + 100000*x = 1\n" STEP, PLAIN },
	{ "springs 1e9 and 1e-3", TWO "x1'' + 1e9*(x1 - x2) + 1e-3*x1 = 0\nx2'' + 1e9*(x2 - x1) = 1\n" STEP, PLAIN },
	{ "masses 1e6 and 1e-6",
	  TWO "1e6*x1'' + 300*x1 - 100*x2 = 0\n1e-6*x2'' + 1e-4*x2' + 100*x2 - 100*x1 = sin(3*t)\n" STEP, PLAIN },
	{ "negative damping", ONE "x'' - 0.3*x' + 25*x = cos(5*t)\n" STEP, PLAIN },
	{ "negative stiffness", ONE "x'' - 0.25*x = 1\n" STEP, PLAIN },
	{ "growth beyond range at h = 1e3", ONE "x'' - 9*x = cos(t)\n" STEP, PLAIN },
	{ "growth to the edge of the range", ONE "x'' - x = 0\nstep 709.78271289338397\n", PLAIN },
	{ "growth just beyond", ONE "x'' - x = 0\nstep 710.48\n", PLAIN },
	{ "decay into the subnormals", ONE "x'' + 3*x' + 2*x = 0\nstep 740.3\n", PLAIN },
	{ "subnormal factors beside a tie, exact", ONE "x'' = (5/2 + 2^(-60))*2^(-1074)\nstep 1\n", EXACT },
	{ "phase with a long sine",
	  ONE "x'' + 4*x = sin(3*t + 3.14159265358979323846264338327950288419716939937510582)\n" STEP, PLAIN },
	{ "flutter", TWO "x1'' + 10*x1 + 3*x2 = 0\nx2'' + 11*x2 - 3*x1 = 0\n" STEP, PLAIN },
	{ "negative mass", ONE "-x'' + 9*x = 1\n" STEP, PLAIN },

	/* as people write them */
	{ "mass matrix with coupling",
	  TWO "2*x1'' + 0.5*x2'' + 30*x1 - 10*x2 = cos(2*t)\n0.5*x1'' + x2'' + 0.1*x2' + 20*x2 - 10*x1 = "
		"1\n" STEP, PLAIN },
	{ "mass matrix without a diagonal", TWO "x2'' + 30*x1 + 0.1*x1' = cos(2*t)\nx1'' + 20*x2 = 1\n" STEP, PLAIN },
	{ "mass matrix with a diagonal entry of 0",
	  TWO "x2'' + 30*x1 = cos(2*t)\nx1'' + 5*x2'' + 0.3*x2' + 20*x2 - x1 = 1\n" STEP, PLAIN },
	{ "irrational parameters",
	  "model m\nparam f = 2, z = 0.02, w0 = 2*pi*f, k = sqrt(3), m2 = exp(1)/7\ncoord x1, x2\n"
	  "init x1 = sin(1), x2' = 1/3\n"
	  "x1'' + 2*z*w0*x1' + w0^2*x1 - k*x2 = sqrt(2)*cos(w0*t + pi/6)\nm2*x2'' + k*(x2 - x1) = log(2)\n"
	  "output x1, a = x2'', b = x1 - 2*x2 + 0.3*cos(w0*t) + 7*t - 1\nstep 1/(100*f)\n",
	  PLAIN },
	{ "fractions", ONE "x'' + x'/3 + 22*x/7 = cos(t/3)/7\nstep 1/3\n", PLAIN },
	{ "fast wave on a slow mass", ONE "x'' + 0.01*x = cos(1e6*t + 0.5)\n" STEP, PLAIN },
	{ "slow wave on a fast mass", ONE "x'' + 1e6*x = cos(1e-6*t + 0.5)\n" STEP, PLAIN },
	{ "loads with factors that cancel",
	  TWO "x1'' + 4*x1 = x2 + cos(t) - cos(t)\nx2'' + x2' + x2 = 2*sin(t + pi/2)\n" STEP, PLAIN },
	{ "wave that only an output sees", ONE "x'' + 4*x = 0\noutput x, y = x + 2*cos(3*t + 1) - t\n" STEP, PLAIN },
	{ "triangular coupling: zeros in Phi",
	  "model m\ncoord a, b, c\ninit a = 1, c' = 1\na'' + a = 0\nb'' + 2*b = a + cos(t)\nc'' + 0.1*c' + 3*c = "
		"b'\n" STEP,
	  PLAIN },
	{ "four masses in a chain",
	  "model m\ncoord a, b, c, d\ninit a = 0.01, d' = 0.5\na'' + 200*a - 100*b = cos(10*t)\n"
	  "b'' + 200*b - 100*a - 100*c + 0.1*b' = 0\n"
	  "c'' + 200*c - 100*b - 100*d = 0\n2*d'' + 200*d - 100*c = 1\n" STEP,
	  PLAIN },

	/* loads: powers, exponentials, products */
	{ "free mass under a ramp load: all exact", ONE "3*x'' = 2*t - 1\n" STEP, EXACT },
	{ "free mass under t^3, exact", ONE "x'' = t^3/7 - 2*t\noutput x, x', a = x''\n" STEP, EXACT },
	{ "free mass under t^2 exp(-t)", ONE "x'' = t^2*exp(-t)\n" STEP, PLAIN },
	{ "oscillator under t^3", ONE "x'' + 0.1*x' + 25*x = t^3 - t + 2\n" STEP, PLAIN },
	{ "t cos at the natural frequency", ONE "x'' + 25*x = t*cos(5*t + 0.3)\n" STEP, PLAIN },
	{ "t^32 cos", ONE "x'' + 0.1*x' + 25*x = t^32*cos(3*t)\n" STEP, PLAIN },
	{ "t^2 sin at the natural frequency", ONE "x'' + 25*x = t^2*sin(5*t)\n" STEP, PLAIN },
	{ "damped resonance", ONE "x'' + 2*x' + 26*x = exp(-t)*cos(5*t)\n" STEP, PLAIN },
	{ "damped resonance with t and a phase", ONE "x'' + 2*x' + 26*x = 3*t*exp(-t)*sin(5*t + 1)\n" STEP, PLAIN },
	{ "damped resonance 1e-9 off",
	  ONE "x'' + 2*x' + 26*x = exp(-1.000000001*t)*cos(5*t) + exp(-t)*cos(4.999999999*t)\n" STEP, PLAIN },
	{ "damped resonance through sqrt",
	  "model m\nparam k = 3, c = 0.2, m0 = 2, a = c/(2*m0), w = sqrt(k/m0 - a^2)\ncoord x\ninit x = 0.1\n"
	  "m0*x'' + c*x' + k*x = "
	  "exp(-a*t)*cos(w*t)\n" STEP,
	  PLAIN },
	{ "damped resonance of a defective pair",
	  TWO "x1'' + 2*x1' + 5*x1 = exp(-t)*sin(2*t)\nx2'' + 2*x2' + 5*x2 = x1\n" STEP, PLAIN },
	{ "exponential at a real pole", ONE "x'' + 3*x' + 2*x = exp(-t) + t*exp(-2*t)\n" STEP, PLAIN },
	{ "exponential at a double pole", ONE "x'' + 2*x' + x = t^3*exp(-t)\n" STEP, PLAIN },
	{ "growing exponential at a growing pole", ONE "x'' - 0.25*x = t*exp(t/2)\n" STEP, PLAIN },
	{ "exponential 1e-10 beside a pole", ONE "x'' + 3*x' + 2*x = exp(-1.0000000001*t)\n" STEP, PLAIN },
	{ "product of waves", ONE "x'' + 9*x = cos(t)*cos(2*t)*sin(3*t + 1)\noutput x, a = x'' - "
		"t*exp(-t)\n" STEP, PLAIN },
	{ "square of a wave at resonance", ONE "x'' + 100*x = cos(5*t)^2\n" STEP, PLAIN },

	/* near zero */
	{ "w = 1e-3", ONE "x'' + 1e-6*x = t^2\n" STEP, PLAIN },
	{ "w = 1e-9", ONE "x'' + 1e-18*x = 1 + t\n" STEP, PLAIN },
	{ "stiffness 1e-18 with a wave", ONE "x'' + 1e-12*x' + 1e-18*x = cos(1e-9*t)\n" STEP, PLAIN },

	/* repeated real poles */
	{ "pole -3 three times", "model m\ncoord a, b, c\ninit a = 1\na' + 3*a = 1\nb' + 3*b = a\nc' + 3*c = b\n" STEP,
	  PLAIN },
	{ "pole -3 four times, with its exponential",
	  "model m\ncoord a, b, c, d\ninit a = 1\na' + 3*a = t*exp(-3*t)\nb' + 3*b = a\nc' + 3*c = b - 2*a\n"
	  "d' + 3*d = c\n" STEP,
	  PLAIN },
	{ "pole -3 four times, twice two",
	  "model m\ncoord a, b, c, d\ninit a = 1, c = 2\na' + 3*a = 0\nb' + 3*b = a\nc' + 3*c = exp(-3*t)\n"
	  "d' + 3*d = c\n" STEP,
	  PLAIN },
	{ "complex pair three times",
	  "model m\ncoord a, b, c\ninit a = 1\na'' + 2*a' + 5*a = exp(-t)*cos(2*t)\nb'' + 2*b' + 5*b = a\n"
	  "c'' + 2*c' + 5*c = b\n" STEP,
	  PLAIN },

	/* coordinates of first order */
	{ "coil beside a mass",
	  "model m\ncoord x, i\ninit x = 0.01, i = 2\n2*x'' + 0.3*x' + 50*x = 0.7*i\n0.05*i' + 4*i + 0.7*x' = "
		"cos(20*t)\n"
	  "output x, i, a "
	  "= x'', d = i'\n" STEP,
	  PLAIN },
	{ "coil and a held voltage, integrating controller",
	  "model m\ncoord i, x, e\ninput u\nx'' + 0.1*x' + 9*x = 2*i - e\n0.02*i' + 3*i + 2*x' = u\ne' = x - u\n"
	  "output x, f = x'' + u, "
	  "e'\n" STEP,
	  PLAIN },
	{ "Maxwell element", "model m\ncoord x, f\nx'' + 10*x + f = sin(3*t)\nf' + 4*f = 7*x'\ninit x = "
		"1\n" STEP, PLAIN },
	{ "Maxwell element with a coordinate of its own",
	  "model m\ncoord x, y\ninit x = 1\nmass 2 at x\nspring 30 between x, ground\nspring 5 between x, y\n"
	  "damper 0.4 between y, "
	  "ground\n" STEP,
	  PLAIN },
	{ "integrator", "model m\ncoord x\ninput u hold first\nx' = u + 2*u' + t\n" STEP, EXACT },
	{ "first order, slow and fast", "model m\ncoord a, b\ninit a = 1\na' + 1e8*a = b\nb' + 1e-3*b = a + t\n" STEP,
	  PLAIN },
	{ "first order with a full leading matrix",
	  "model m\ncoord a, b\ninit a = 1\n2*a' + b' + a = 1\na' - 3*b' + 2*b = cos(t)\n" STEP, PLAIN },
	{ "rotation of first order", "model m\ncoord a, b\ninit a = 1\na' = 5*b\nb' = -5*a + sin(5*t)\n" STEP, PLAIN },
	{ "velocity of another in a first-order equation",
	  "model m\ncoord z, x\ninit x' = 1\nz' + x' + z = 0\nx'' + z' + x = exp(-t)\n" STEP, PLAIN },

	/* sampled inputs */
	{ "held", ONE "input u\nx'' + 0.2*x' + 25*x = u\noutput x, a = x'' + 3*u\n" STEP, PLAIN },
	{ "ramp with its slope, and held",
	  TWO
	  "input u hold first\ninput v\nx1'' + 0.2*x1' + 25*x1 - 5*x2 = u + 0.1*u'\nx2'' + 9*x2 - 5*x1 = v - 2*u\n"
	  "output x1, a = x2'' + "
	  "u'\n" STEP,
	  PLAIN },
	{ "free mass with a ramp: all exact", ONE "input u hold first\nx'' = u\n" STEP, EXACT },
	{ "critically damped with a ramp", ONE "input u hold first\nx'' + 200*x' + 10000*x = u\n" STEP, PLAIN },
	{ "ramp on a defective pair", TWO "input u hold first\nx1'' + 4*x1 = u + cos(2*t)\nx2'' + 4*x2 = x1\n" STEP,
	  PLAIN },

	/* changes in time */
	{ "half a sine, then nothing", ONE "x'' + 0.1*x' + 25*x = t < 0.6 ? 10*sin(pi*t/0.6) : 0\n" STEP, PLAIN },
	{ "a push between samples",
	  ONE
	  "x'' + 25*x = t < 0.0123 ? 3 : t < 0.1 ? -2*t : t^2*exp(-t)\noutput x, y = x + (t < 0.3 ? t : 1), a = "
		"x''\n" STEP,
	  PLAIN },
	{ "table", ONE "x'' + 2*x' + x = table(t; 0, 0; 0.1, 1; 0.25, 1; 0.6, -2)\n" STEP, PLAIN },
	{ "absolute value, least and largest", ONE "x'' + 4*x = abs(t - 1) + min(t, 0.17) - max(2*t - 0.05, 0)\n" STEP,
	  PLAIN },
	{ "free mass, exact through changes", ONE "x'' = t < 1/4 ? t : 1/2 - t\n" STEP, EXACT },
	{ "resonance switched on", ONE "x'' + 25*x = t > 0.17 ? cos(5*t) : 0\n" STEP, PLAIN },
	{ "change in an equation and a sketch",
	  TWO
	  "x1'' + 9*x1 - 4*x2 = t < 0.5 ? 1 : 0\nx2'' + 0.1*x2' + 9*x2 - 4*x1 = t < 0.5 ? exp(-t) : cos(t)\n"
	  "force abs(t - 0.3) on x2\n" STEP,
	  PLAIN },
	{ "changes on a coordinate of first order",
	  "model m\ncoord z, x\nz' + 2*z = t < 0.3 ? 1 : exp(-2*t)\nx'' + 4*x = z\n" STEP, PLAIN },

	/* matrices, by residues (12 states) and by Taylor series (beyond) */
	{ "dense masses, 2",
	  "model m\nmatrix M = [3, 0.1; 0.1, 4]\nmatrix K = [200, -100; -100, 200]\ncoord q[2]\n"
	  "init q[1] = 0.01, q[2]' = -0.3\nM*q'' + "
	  "K*q = [1; 0]*cos(2*t) + [0; -2]\n" STEP,
	  PLAIN },
	{ "dense masses, 3",
	  "model m\nmatrix M = [3, 0.1, 0.1; 0.1, 4, 0.3; 0.1, 0.3, 5]\n"
	  "matrix K = [200, -100, 0; -100, 200, -100; 0, -100, 200]\ncoord "
	  "q[3]\ninit q[1] = 0.01, q[2]' = -0.3\nM*q'' + K*q = [1; 0; 0]*cos(2*t) + [0; 0; -2]\n" STEP,
	  PLAIN },
	{ "six in a chain, damped, loaded",
	  "model m\n"
	  "matrix M = [1, 0, 0, 0, 0, 0; 0, 1, 0, 0, 0, 0; 0, 0, 1, 0, 0, 0; 0, 0, 0, 1, 0, 0; 0, 0, 0, 0, 1, 0; 0, "
		"0, 0, "
	  "0, 0, "
	  "1]\n"
	  "matrix K = [200, -100, 0, 0, 0, 0; -100, 200, -100, 0, 0, 0; 0, -100, 200, -100, 0, 0; 0, 0, -100, 200, "
		"-100, "
	  "0; 0, 0, 0, "
	  "-100, 200, -100; 0, 0, 0, 0, -100, 200]\nmatrix C = 0.1*M + 0.001*K\ncoord q[6]\n"
	  "init q[1] = 0.01, q[2]' = -0.3\nM*q'' + C*q' "
	  "+ K*q = [1; 0; 0; 0; 0; 0]*cos(3*t) + [0; 0; 0; 2; 0; 0]*t*exp(-t)\n" STEP,
	  PLAIN },
	{ "seven in a chain, damped, loaded",
	  "model m\n"
	  "matrix M = [1, 0, 0, 0, 0, 0, 0; 0, 1, 0, 0, 0, 0, 0; 0, 0, 1, 0, 0, 0, 0; 0, 0, 0, 1, 0, 0, 0; 0, 0, 0, "
		"0, 1, "
	  "0, 0; "
	  "0, 0, 0, 0, 0, 1, 0; 0, 0, 0, 0, 0, 0, 1]\n"
	  "matrix K = [200, -100, 0, 0, 0, 0, 0; -100, 200, -100, 0, 0, 0, 0; 0, -100, 200, "
	  "-100, 0, 0, 0; 0, 0, -100, 200, -100, 0, 0; 0, 0, 0, -100, 200, -100, 0; 0, 0, 0, 0, -100, 200, -100; 0, "
		"0, 0, "
	  "0, 0, -100, "
	  "200]\nmatrix C = 0.1*M + 0.001*K\ncoord q[7]\ninit q[1] = 0.01, q[2]' = -0.3\n"
	  "M*q'' + C*q' + K*q = [1; 0; 0; 0; 0; 0; "
	  "0]*cos(3*t) + [0; 0; 0; 2; 0; 0; 0]*t*exp(-t)\n" STEP,
	  PLAIN },
	{ "seven at resonance, repeated and undamped",
	  "model m\n"
	  "matrix M = [1, 0, 0, 0, 0, 0, 0; 0, 1, 0, 0, 0, 0, 0; 0, 0, 1, 0, 0, 0, 0; 0, 0, 0, 1, 0, 0, 0; 0, 0, 0, "
		"0, 1, "
	  "0, 0; "
	  "0, 0, 0, 0, 0, 1, 0; 0, 0, 0, 0, 0, 0, 1]\n"
	  "matrix K = [25, 0, 0, 0, 0, 0, 0; 0, 25, 0, 0, 0, 0, 0; 0, 0, 25, 0, 0, 0, 0; 0, "
	  "0, 0, 25, 0, 0, 0; 0, 0, 0, 0, 25, 0, 0; 0, 0, 0, 0, 0, 25, 0; 0, 0, 0, 0, 0, 0, 25]\ncoord q[7]\n"
	  "init q[1] = 0.01, q[2]' = "
	  "-0.3\nM*q'' + K*q = [1; 0; 0; 0; 1; 0; 0]*cos(5*t) + [0; 0; 0; 0; 0; 0; 1]*t\n" STEP,
	  PLAIN },
	{ "seven free at both ends, ramp input",
	  "model m\n"
	  "matrix M = [1, 0, 0, 0, 0, 0, 0; 0, 2, 0, 0, 0, 0, 0; 0, 0, 3, 0, 0, 0, 0; 0, 0, 0, 1, 0, 0, 0; 0, 0, 0, "
		"0, 2, "
	  "0, 0; "
	  "0, 0, 0, 0, 0, 3, 0; 0, 0, 0, 0, 0, 0, 1]\n"
	  "matrix K = [50, -50, 0, 0, 0, 0, 0; -50, 100, -50, 0, 0, 0, 0; 0, -50, 100, -50, "
	  "0, 0, 0; 0, 0, -50, 100, -50, 0, 0; 0, 0, 0, -50, 100, -50, 0; 0, 0, 0, 0, -50, 100, -50; 0, 0, 0, 0, 0, "
		"-50, "
	  "50]\ncoord "
	  "q[7]\ninput u hold first\ninput v\ninit q[1] = 0.01, q[2]' = -0.3\n"
	  "M*q'' + K*q = [1; 0; 0; 0; 0; 0; 0]*u + [0; 0; 0; 0; 0; 0; "
	  "1]*v\n" STEP,
	  PLAIN },
	{ "eight with dense masses and three loads",
	  "model m\n"
	  "matrix M = [3, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1; 0.1, 4, 0.3, 0.4, 0.5, 0.1, 0.2, 0.3; 0.1, 0.3, 5, 0.2, "
		"0.4, "
	  "0.1, "
	  "0.3, 0.5; 0.1, 0.4, 0.2, 6, 0.3, 0.1, 0.4, 0.2; 0.1, 0.5, 0.4, 0.3, 7, 0.1, 0.5, 0.4; 0.1, 0.1, 0.1, 0.1, "
		"0.1, "
	  "8, 0.1, 0.1; "
	  "0.1, 0.2, 0.3, 0.4, 0.5, 0.1, 9, 0.3; 0.1, 0.3, 0.5, 0.2, 0.4, 0.1, 0.3, 10]\n"
	  "matrix K = [200, -100, 0, 0, 0, 0, 0, 0; -100, "
	  "200, -100, 0, 0, 0, 0, 0; 0, -100, 200, -100, 0, 0, 0, 0; 0, 0, -100, 200, -100, 0, 0, 0; 0, 0, 0, -100, "
		"200, "
	  "-100, 0, 0; 0, "
	  "0, 0, 0, -100, 200, -100, 0; 0, 0, 0, 0, 0, -100, 200, -100; 0, 0, 0, 0, 0, 0, -100, 200]\ncoord q[8]\n"
	  "init q[1] = 0.01, "
	  "q[2]' = -0.3\n"
	  "M*q'' + K*q = [1; 0; 0; 0; 0; 0; 0; 0]*cos(3*t + 0.2) + [0; 0; 0; 2; 0; 0; 0; 0]*exp(-t/2)*sin(t) + [0; 0; "
		"0; "
	  "0; 0; 0; 0; 1]*t^3\n" STEP,
	  PLAIN },
	{ "eight, damped, held input, a change in time",
	  "model m\n"
	  "matrix M = [1, 0, 0, 0, 0, 0, 0, 0; 0, 1, 0, 0, 0, 0, 0, 0; 0, 0, 1, 0, 0, 0, 0, 0; 0, 0, 0, 1, 0, 0, 0, "
		"0; 0, "
	  "0, 0, "
	  "0, 1, 0, 0, 0; 0, 0, 0, 0, 0, 1, 0, 0; 0, 0, 0, 0, 0, 0, 1, 0; 0, 0, 0, 0, 0, 0, 0, 1]\n"
	  "matrix K = [200, -100, 0, 0, 0, 0, 0, "
	  "0; -100, 200, -100, 0, 0, 0, 0, 0; 0, -100, 200, -100, 0, 0, 0, 0; 0, 0, -100, 200, -100, 0, 0, 0; 0, 0, 0, "
	  "-100, 200, -100, "
	  "0, 0; 0, 0, 0, 0, -100, 200, -100, 0; 0, 0, 0, 0, 0, -100, 200, -100; 0, 0, 0, 0, 0, 0, -100, 200]\n"
	  "matrix C = 0.02*K\ncoord "
	  "q[8]\ninput u\ninit q[1] = 0.01, q[2]' = -0.3\n"
	  "M*q'' + C*q' + K*q = [1; 0; 0; 0; 0; 0; 0; 0]*u + [0; 0; 0; 0; 0; 0; 0; 1]*(t "
	  "< 0.3 ? t : exp(-t))\n" STEP,
	  PLAIN },
	{ "seven masses and a coil",
	  "model m\n"
	  "matrix K = [80, -40, 0, 0, 0, 0, 0; -40, 80, -40, 0, 0, 0, 0; 0, -40, 80, -40, 0, 0, 0; 0, 0, -40, 80, "
		"-40, 0, "
	  "0; 0, "
	  "0, 0, -40, 80, -40, 0; 0, 0, 0, 0, -40, 80, -40; 0, 0, 0, 0, 0, -40, 80]\ncoord q[7], i\ninit i = 1\n"
	  "q'' + K*q = [0; 0; 1; 0; "
	  "0; 0; 0]*i\n0.1*i' + i + q[3]' = cos(2*t)\n" STEP,
	  PLAIN },
	{ "fourteen of first order, pole -1 fourteen times",
	  "model m\n"
	  "matrix A = [-1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0; 1, -1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0; 0, 1, "
		"-1, 0, "
	  "0, 0, "
	  "0, 0, 0, 0, 0, 0, 0, 0; 0, 0, 1, -1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0; 0, 0, 0, 1, -1, 0, 0, 0, 0, 0, 0, 0, 0, "
		"0; "
	  "0, 0, 0, 0, 1, "
	  "-1, 0, 0, 0, 0, 0, 0, 0, 0; 0, 0, 0, 0, 0, 1, -1, 0, 0, 0, 0, 0, 0, 0; 0, 0, 0, 0, 0, 0, 1, -1, 0, 0, 0, "
		"0, 0, "
	  "0; 0, 0, 0, 0, "
	  "0, 0, 0, 1, -1, 0, 0, 0, 0, 0; 0, 0, 0, 0, 0, 0, 0, 0, 1, -1, 0, 0, 0, 0; 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, "
		"-1, 0, "
	  "0, 0; 0, 0, 0, "
	  "0, 0, 0, 0, 0, 0, 0, 1, -1, 0, 0; 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, -1, 0; 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, "
		"0, "
	  "0, 1, "
	  "-1]\ncoord z[14]\ninit z[1] = 1\nz' = A*z + [1; 0; 0; 0; 0; 0; 0; 0; 0; 0; 0; 0; 0; 0]*exp(-t)\n" STEP,
	  PLAIN },
	{ "seven overdamped and unstable",
	  "model m\n"
	  "matrix M = [1, 0, 0, 0, 0, 0, 0; 0, 1, 0, 0, 0, 0, 0; 0, 0, 1, 0, 0, 0, 0; 0, 0, 0, 1, 0, 0, 0; 0, 0, 0, "
		"0, 1, "
	  "0, 0; "
	  "0, 0, 0, 0, 0, 1, 0; 0, 0, 0, 0, 0, 0, 1]\n"
	  "matrix K = [1e5, 0, 0, 0, 0, 0, 0; 0, -0.25, 0, 0, 0, 0, 0; 0, 0, 1e-18, 0, 0, 0, "
	  "0; 0, 0, 0, 4, 0, 0, 0; 0, 0, 0, 0, 1, 0, 0; 0, 0, 0, 0, 0, 1e-6, 0; 0, 0, 0, 0, 0, 0, 0]\n"
	  "matrix C = [100000000.001, 0, 0, "
	  "0, 0, 0, 0; 0.001, 0, 0, 0, 0, 0, 0; 0, 0.001, 0, 0, 0, 0, 0; 0, 0, 0.001, 4, 0, 0, 0; 0, 0, 0, 0.001, "
		"-0.3, "
	  "0, 0; 0, 0, 0, "
	  "0, 0.001, 0, 0; 0, 0, 0, 0, 0, 0.001, 3]\ncoord q[7]\ninit q[1] = 0.01, q[2]' = -0.3\n"
	  "M*q'' + C*q' + K*q = [0; 1; 0; 0; 0; 0; "
	  "0]\n" STEP,
	  PLAIN },

	/* e^-718 leaves the step: below full precision, beside a factor of its row that is 2^100 times as large */
	{ "a factor below full precision", "model m\ncoord a, b\ninit b = 1\na' + 718*a = b\nb' + b = 0\nstep "
		"1\n", PLAIN },

	/* sketches */
	{ "three masses, a relative damper, forces",
	  "model m\ncoord a, b, c\ninit b = 1\nmass 2 at a\nmass 1 at b\nmass 0.5 at c\nspring 30 between a, b\n"
	  "spring 30 between b, "
	  "c\nspring 10 between a, ground\ndamper 0.2 between a, c\nforce 3*cos(4*t) on c\nforce t^2 on a\n" STEP,
	  PLAIN },
	{ "sketch beside equations, with an input",
	  "model m\ncoord a, b\ninput u hold first\nmass 2 at a\n2*a'' + b'' + 3*a = 0\nmass 1 at b\n"
	  "spring 40 between a, b\nforce 2*u "
	  "on b\n" STEP,
	  PLAIN },
};
const size_t bitwise_spec_count = sizeof bitwise_specs / sizeof *bitwise_specs;
