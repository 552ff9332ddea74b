/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "bitwise_specs.h"

#define ONE "model m\ncoord x\ninit x = 0.01, x' = 0.3\n"
#define TWO "model m\ncoord x1, x2\ninit x1 = 0.01, x2' = -0.2\n"
#define STEP "step 0.01\n"

const struct bitwise_spec bitwise_specs[] = {
    /* resonance: the load's poles are the system's */
    { "cosine at the natural frequency", ONE "x'' + 25*x = cos(5*t)\n" STEP, 0 },
    { "cosine at the natural frequency, with a phase", ONE "x'' + 25*x = 3*cos(5*t + 0.7)\n" STEP, 0 },
    { "sine at the natural frequency", ONE "x'' + 25*x = sin(5*t)\n" STEP, 0 },
    { "cosine at the lower frequency of two", TWO "x1'' + 200*x1 - 100*x2 = cos(10*t)\nx2'' + 200*x2 - 100*x1 = 0\n" STEP, 0 },
    { "cosine at the lower frequency of two, mode not excited",
      TWO "x1'' + 200*x1 - 100*x2 = cos(10*t)\nx2'' + 200*x2 - 100*x1 = -cos(10*t)\n" STEP, 0 },
    { "resonance with an irrational frequency", ONE "x'' + (2*pi*3)^2*x = sin(2*pi*3*t + pi/3)\n" STEP, 0 },
    { "resonance through sqrt", "model m\nparam k = 3, m0 = 2, w = sqrt(k/m0)\ncoord x\nm0*x'' + k*x = cos(w*t)\n" STEP, 0 },
    { "resonance 1e-9 off", ONE "x'' + 25*x = cos(5.000000001*t) + sin(4.999999999*t)\n" STEP, 0 },
    { "resonance of two waves at once", TWO "x1'' + 4*x1 = cos(2*t + 1) + sin(3*t)\nx2'' + 9*x2 = x1 + cos(3*t - 2)\n" STEP, 0 },
    { "two waves and a constant", ONE "x'' + 0.3*x' + 25*x = cos(5*t) + 2*sin(7*t + 0.1) - 4\noutput x, a = x'' + t\n" STEP, 0 },
    { "damped pole pair met by no load", ONE "x'' + 2*x' + 5*x = cos(2*t)\n" STEP, 0 },

    /* repeated poles */
    { "two equal oscillators", TWO "x1'' + 100*x1 = 0\nx2'' + 100*x2 = 0\n" STEP, 0 },
    { "two equal oscillators at resonance", TWO "x1'' + 100*x1 = cos(10*t)\nx2'' + 100*x2 = sin(10*t + 0.2)\n" STEP, 0 },
    { "two equal oscillators, one driving the other", TWO "x1'' + 100*x1 = 0\nx2'' + 100*x2 = x1\n" STEP, 0 },
    { "defective undamped pair at resonance", TWO "x1'' + 100*x1 = cos(10*t)\nx2'' + 100*x2 = x1\n" STEP, 0 },
    { "critical damping", ONE "x'' + 200*x' + 10000*x = 0\n" STEP, 1 },
    { "critical damping, with a load", ONE "x'' + 200*x' + 10000*x = 1 + cos(3*t)\n" STEP, 1 },
    { "critical damping of two", TWO "x1'' + 6*x1' + 9*x1 = 0\nx2'' + 6*x2' + 9*x2 = x1 + 2*x1'\n" STEP, 0 },
    { "defective complex pair", TWO "x1'' + 2*x1' + 5*x1 = 0\nx2'' + 2*x2' + 5*x2 = x1\n" STEP, 0 },
    { "complex pair four times, in a chain",
      "model m\ncoord a, b, c, d\ninit a = 1\na'' + 2*a' + 5*a = 0\nb'' + 2*b' + 5*b = a\nc'' + 2*c' + 5*c = b\nd'' + 2*d' + 5*d = c\n" STEP, 0 },

    /* pole 0 */
    { "free mass", ONE "x'' = 0\n" STEP, 0 },
    { "free mass under a constant force", ONE "3*x'' = 7\n" STEP, 0 },
    { "free mass under a wave", ONE "3*x'' = 7*cos(2*t + 1) - 1\n" STEP, 0 },
    { "free mass with drag", ONE "x'' + 3*x' = 2 + sin(t)\n" STEP, 0 },
    { "two masses free at both ends", TWO "x1'' + 50*x1 - 50*x2 = 0\nx2'' + 50*x2 - 50*x1 = 0\n" STEP, 0 },
    { "two masses free at both ends, damped, loaded",
      TWO "2*x1'' + 0.1*x1' - 0.1*x2' + 50*x1 - 50*x2 = 1\n3*x2'' - 0.1*x1' + 0.1*x2' + 50*x2 - 50*x1 = cos(4*t + 1)\n" STEP, 0 },
    { "pole 0 four times", TWO "x1'' = 1\nx2'' = x1\n" STEP, 0 },
    { "pole 0 six times", "model m\ncoord a, b, c\ninit a' = 1\na'' = 1\nb'' = a + 2*b'\nc'' = b - a'\n" STEP, 0 },
    { "coupled by velocity alone", TWO "x1'' + 2*x2' = 0\nx2'' - 2*x1' = 1\n" STEP, 0 },

    /* close poles */
    { "poles 1e-3 apart", ONE "x'' + 2.001*x' + 1.001*x = 1\n" STEP, 0 },
    { "poles 1e-6 apart", ONE "x'' + 2.000001*x' + 1.000001*x = 1\n" STEP, 0 },
    { "poles 1e-10 apart", ONE "x'' + 2.0000000001*x' + 1.0000000001*x = 1\n" STEP, 0 },
    { "poles 1e-14 apart", ONE "x'' + 2.00000000000001*x' + 1.00000000000001*x = cos(t)\n" STEP, 0 },
    { "poles 1e-60 apart", "model m\nparam d = 1e-60\ncoord x\ninit x = 1\nx'' + (2 + d)*x' + (1 + d)*x = 0\n" STEP, 0 },
    { "complex pairs 1e-10 apart", TWO "x1'' + 100*x1 = 0\nx2'' + 100.000000002*x2 = 1e-3*x1 + cos(10*t)\n" STEP, 0 },
    { "coupled weakly: 1e-10", TWO "x1'' + 100*x1 - 1e-10*x2 = 0\nx2'' + 100*x2 - 1e-10*x1 = 0\n" STEP, 0 },
    { "poles about 2^-256 apart: sqrt(2)^2 beside 2",
      "model m\nparam s = sqrt(2)\ncoord x1, x2\ninit x1 = 1\nx1'' + 2*s*x1' + 2*x1 = 0\nx2'' + 2*s*x2' + s^2*x2 = x1 + cos(s*t)\n" STEP, 0 },
    { "undamped pairs about 2^-256 apart, and a load", TWO "x1'' + 2*x1 = 0\nx2'' + sqrt(2)^2*x2 = x1 + cos(sqrt(2)*t)\n" STEP, 0 },
    { "clusters 1e-60 wide, six poles",
      "model m\nparam d = 1e-60\ncoord a, b, c\ninit a = 1\na'' + 2*a' + a = 0\nb'' + (2 + d)*b' + (1 + d)*b = a\n"
      "c'' + (2 - d)*c' + (1 - d)*c = b + 1\n" STEP, 0 },
    { "stiffness 1e-6", ONE "x'' + 1e-6*x = cos(1e-3*t)\n" STEP, 0 },
    { "stiffness 1e-18", ONE "x'' + 1e-18*x = 1\n" STEP, 0 },
    { "damping 1e-12", ONE "x'' + 1e-12*x' + 25*x = cos(5*t)\n" STEP, 0 },
    { "damping 1e-30", ONE "x'' + 1e-30*x' + 25*x = cos(5*t)\n" STEP, 0 },

    /* far apart, growing */
    { "poles -1e8 and -1e-3", ONE "x'' + 100000000.001*x' + 100000*x = 1\n" STEP, 0 },
    { "springs 1e9 and 1e-3", TWO "x1'' + 1e9*(x1 - x2) + 1e-3*x1 = 0\nx2'' + 1e9*(x2 - x1) = 1\n" STEP, 0 },
    { "masses 1e6 and 1e-6", TWO "1e6*x1'' + 300*x1 - 100*x2 = 0\n1e-6*x2'' + 1e-4*x2' + 100*x2 - 100*x1 = sin(3*t)\n" STEP, 0 },
    { "negative damping", ONE "x'' - 0.3*x' + 25*x = cos(5*t)\n" STEP, 0 },
    { "negative stiffness", ONE "x'' - 0.25*x = 1\n" STEP, 0 },
    { "growth beyond range at h = 1e3", ONE "x'' - 9*x = cos(t)\n" STEP, 0 },
    { "growth to the edge of the range", ONE "x'' - x = 0\nstep 709.78271289338397\n", 0 },
    { "growth just beyond", ONE "x'' - x = 0\nstep 710.48\n", 0 },
    { "decay into the subnormals", ONE "x'' + 3*x' + 2*x = 0\nstep 740.3\n", 0 },
    { "subnormal factors beside a tie, exact", ONE "x'' = (5/2 + 2^(-60))*2^(-1074)\nstep 1\n", 0 },
    { "phase with a long sine", ONE "x'' + 4*x = sin(3*t + 3.14159265358979323846264338327950288419716939937510582)\n" STEP, 0 },
    { "flutter", TWO "x1'' + 10*x1 + 3*x2 = 0\nx2'' + 11*x2 - 3*x1 = 0\n" STEP, 0 },
    { "negative mass", ONE "-x'' + 9*x = 1\n" STEP, 0 },

    /* as people write them */
    { "mass matrix with coupling", TWO "2*x1'' + 0.5*x2'' + 30*x1 - 10*x2 = cos(2*t)\n0.5*x1'' + x2'' + 0.1*x2' + 20*x2 - 10*x1 = 1\n" STEP, 0 },
    { "mass matrix without a diagonal", TWO "x2'' + 30*x1 + 0.1*x1' = cos(2*t)\nx1'' + 20*x2 = 1\n" STEP, 0 },
    { "mass matrix with a diagonal entry of 0", TWO "x2'' + 30*x1 = cos(2*t)\nx1'' + 5*x2'' + 0.3*x2' + 20*x2 - x1 = 1\n" STEP, 0 },
    { "irrational parameters",
      "model m\nparam f = 2, z = 0.02, w0 = 2*pi*f, k = sqrt(3), m2 = exp(1)/7\ncoord x1, x2\ninit x1 = sin(1), x2' = 1/3\n"
      "x1'' + 2*z*w0*x1' + w0^2*x1 - k*x2 = sqrt(2)*cos(w0*t + pi/6)\nm2*x2'' + k*(x2 - x1) = log(2)\n"
      "output x1, a = x2'', b = x1 - 2*x2 + 0.3*cos(w0*t) + 7*t - 1\nstep 1/(100*f)\n", 0 },
    { "fractions", ONE "x'' + x'/3 + 22*x/7 = cos(t/3)/7\nstep 1/3\n", 0 },
    { "fast wave on a slow mass", ONE "x'' + 0.01*x = cos(1e6*t + 0.5)\n" STEP, 0 },
    { "slow wave on a fast mass", ONE "x'' + 1e6*x = cos(1e-6*t + 0.5)\n" STEP, 0 },
    { "loads with factors that cancel", TWO "x1'' + 4*x1 = x2 + cos(t) - cos(t)\nx2'' + x2' + x2 = 2*sin(t + pi/2)\n" STEP, 0 },
    { "wave that only an output sees", ONE "x'' + 4*x = 0\noutput x, y = x + 2*cos(3*t + 1) - t\n" STEP, 0 },
    { "triangular coupling: zeros in Phi",
      "model m\ncoord a, b, c\ninit a = 1, c' = 1\na'' + a = 0\nb'' + 2*b = a + cos(t)\nc'' + 0.1*c' + 3*c = b'\n" STEP, 0 },
    { "four masses in a chain",
      "model m\ncoord a, b, c, d\ninit a = 0.01, d' = 0.5\na'' + 200*a - 100*b = cos(10*t)\nb'' + 200*b - 100*a - 100*c + 0.1*b' = 0\n"
      "c'' + 200*c - 100*b - 100*d = 0\n2*d'' + 200*d - 100*c = 1\n" STEP, 0 },
};
const size_t bitwise_spec_count = sizeof bitwise_specs / sizeof *bitwise_specs;
