#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# NAME_selftest beside lists of crossings that leave some out: balls that are dropped on each other, of many masses and
# restitutions, bounce more often in a step, or at one instant, than is listed; or sooner again than floats tell; or
# are left by impacts with speed 0, which rounding makes some speed of. And beside jumps that do not bounce. Below 200
# units in the last place.
#
#     listed.sh PLGEN SOURCE_ROOT
root=$2
. "${0%/*}/../plgen.sh"

# compared NAME SPEC: in double and in float
compared() {
	for real in double float; do
		value=$(selftest_of "$2" $real)
		echo "returns $value, expected below 200" >>log
		awk -v v="$value" 'BEGIN { exit !(v != "" && v + 0 == v && v < 200) }'
		result $? "$1, in $real"
	done
}

# dropped MASS E GROUND [HEIGHT STEP]: the mass below, restitutions
dropped() {
	cat >balls.spec <<-END
		model balls
		coord a, b
		init b = ${4:-1}
		$1*a'' = -$1*9.81
		b'' = -9.81
		stop between ground, a at 0 restitution $3
		stop between a, b at 0 restitution $2
		step ${5:-0.1}
	END
	compared "a mass of $1 below, restitution $2, of the ground $3${4:+, from $4, steps of $5}" balls.spec
}

for mass in 0.5 1 2 3 20; do
	for e in 0 0.2 0.5; do
		one_of 3 || continue
		dropped $mass $e 0
		dropped $mass $e 0.3
	done
done
dropped 1 0.3 0.1
dropped 1 0.9 0.5
dropped 1 1 0.9
dropped 0.5 0.3 0.3
dropped 1 0.5 0.1
dropped 0.5 0.7 0.1 2 0.01              # where the crossing before the last of an instant blurs with the next
for jumps in thrown counted; do
	compared "$jumps" "$(path_of "tests/contacts/$jumps.spec")"
done
tap_end
