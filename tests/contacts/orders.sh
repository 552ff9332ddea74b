#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# orders.sh PLGEN SOURCE: scheme taylor of orders 4, 6 and 8 on models with friction, stops and impacts beside curves.
# The state after 6 s is compared with that of order 24; the order is the slope of a line through the logarithms of the
# errors. An event ends a piece wherever it falls, so errors scatter about the line, which has to rise no less than
# 0.4 below what is stated. $CC compiles, $PLRT is the runtime.
plgen=$(realpath "$1")
source=$(realpath "$2")
. "$source/tests/tap.sh"
cat >drive.c <<'END'
#include "m.h"
#include <stdio.h>
#include <stdlib.h>
int main(int count, char **argument)
{
	m s;
	m_init(&s);
	for (long k = count > 1 ? atol(argument[1]) : 0; k > 0; k--)
		m_step(&s);
	for (int i = 0; i < M_STATES; i++)
		printf("%.17g ", s.y[i]);
	printf("%lu %d\n", (unsigned long)m_crossed(&s), m_status(&s));
	return 0;
}
END

# state SCHEME STEPS: after 6 s
state() {
	"$plgen" --scheme "$1" --step "6/$2" m.spec -o m.c >log 2>&1 &&
		${CC:-cc} -O1 -I. -I"$source/runtime" -o drive drive.c m.c $PLRT -lm >>log 2>&1 && ./drive "$2"
}

# order NAME: of the model m.spec
order() {
	chosen "$1" || return
	state 'taylor 24' 1200 >exact
	for p in 4 6 8; do
		case $p in
			4) steps='96 120 144 192 288 384 480 576' ;;
			6) steps='60 72 90 120 144 180 200 240' ;;
			8) steps='40 48 60 72 80 96 120 144' ;;
		esac
		: >errors
		for n in $steps; do
			state "taylor $p" "$n" >found
			cat exact found | awk -v n="$n" 'NR == 1 { events = $(NF - 1) }
				NR == 1 { for (i = 1; i < NF - 1; i++) x[i] = $i }
				NR == 2 { for (i = 1; i < NF - 1; i++) { d = $i - x[i]; e = d*d > e ? d*d : e }
					print n, sqrt(e), $(NF - 1) == events, $NF == 0 }' >>errors
		done
		awk -v p=$p '$2 > 1e-13 { u = log($1); v = -log($2); n++; a += u; b += v; c += u*u; d += u*v }
			!$3 || !$4 || NF != 4 { bad = 1 }
			END { s = n > 3 ? (n*d - a*b)/(n*c - a*a) : 0
				printf "%.2f %s\n", s, bad || NR != 8 || s < p - 0.4 ? "no" : "yes" }' errors >slope
		read -r slope good <slope
		cp errors log
		[ "$good" = yes ]
		result $? "$1: order $p, measured $slope"
	done
}

# model NAME: what stands on standard input
model() {
	{ echo 'model m'; cat; } >m.spec
	order "$1"
}

model stop <<'END'
coord x
x'' + 0.1*x' + x + x^3 = cos(1.3*t)
stop between x, ground at 0.4 restitution 0.7
init x = 0.05, x' = 1
END
model pendulum <<'END'
coord x
x'' + 0.05*x' + 4*sin(x) = 0
when x >= 0.5: x' = -0.9*x'
init x' = 2.5
END
model belt <<'END'
coord x
x'' - 0.8*(1 - x^2)*x' + x + friction(x' - 0.5, 0.4) = 0
init x = 0.1
END
model duffing <<'END'
coord x
x'' + x + x^3 + friction(x', 0.6, 0.8) = 1.5*cos(0.9*t)
init x = 1
END
model drag <<'END'
coord x
x'' + 3*x + 0.2*abs(x')*x' + friction(x', 0.3) = cos(2*t)
init x = 1
END
model pair <<'END'
coord x, y
x'' + 2*x + x^3 - 3*(y - x) + friction(x' - y', 0.5) = cos(1.1*t)
2*y'' + 3*(y - x) + y^3 - friction(x' - y', 0.5) + friction(y', 0.2) = 0
init x = 1
END
model cart <<'END'
coord x, q
2*x'' + x + friction(x', 0.4) = 0.8*cos(1.7*t)
q'' + 5*sin(q) - x = 0
when q >= 0.6: q' = -0.5*q'
init q = 0.5, q' = 1
END
model moving <<'END'
coord x
x'' + exp(x) - 1 + friction(x', 0.5 + 0.2*cos(t)) = sin(1.5*t)
init x = 0.7
END
tap_end
