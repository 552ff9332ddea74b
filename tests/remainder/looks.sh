#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# looks.sh PLGEN: what looks for crossings at the end of a step evaluates what values and slopes of its switching
# functions read, and nothing else: a load that accelerates has a part in the slope of a velocity, and none in that of a
# position. As TAP.
set -u
plgen=$(realpath "$1")
. "${0%/*}/../tap.sh"

# loads_of WORDS NAME EXPRESSION EXPECTED: how many loads the look of a model evaluates that switches where that is 0
loads_of() {
	cat >kink.spec <<-END
		model kink
		coord x
		init x = 0.4
		x'' + 0.1*x' + 4*x + x^3 + 3*max($2, 0) = cos(3*t) + cos(5*t)
		step 0.02
	END
	"$plgen" --scheme etdrk4 -o kink.c kink.spec 2>log
	# of NAME_ends_at alone
	found=$(sed -n '/^static void kink_ends_at(/,/^}/p' kink.c | grep -c pl_cossin)
	echo "$2: $found loads, expected $3" >>log
	grep -q '^static void kink_ends_at(' kink.c && [ "$found" -eq "$3" ]
	result $? "$1"
}

loads_of 'a position: value and slope are states' 'x' 0
loads_of 'a velocity: its slope reads both loads' "x' + x" 2
tap_end
