#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# A ball is dropped on a ball that lies on the floor, of thirty masses and restitutions: both contacts close at one
# instant without end, and neither ball falls through what is below it, to 1e-12, with status 0.
#
#     dropped.sh PLGEN SOURCE_ROOT
plgen=$(realpath "$1")
root=$(realpath "$2")
. "$root/tests/run_cc.sh"
. "$root/tests/tap.sh"
runtime_archive "$root/runtime"
for mass in 0.3 0.5 1 2 3 5; do
	for e in 0 0.1 0.2 0.5 0.8; do
		cat >balls.spec <<-END
			model balls
			coord a, b
			init b = 1
			$mass*a'' = -$mass*9.81
			b'' = -9.81
			stop between ground, a at 0 restitution 0
			stop between a, b at 0 restitution $e
			output a, b
			step 0.1
		END
		"$plgen" -o balls.c balls.spec >log 2>&1 &&
			$run_cc -I"$root/runtime" -DMODEL=balls "$root/runtime/host/plmain.c" balls.c "$archive" -lm \
				-o balls >>log 2>&1 && ./balls 4 >rows.csv 2>>log &&
			awk -F, 'NR > 1 && !($2 >= -1e-12 && $3 - $2 >= -1e-12 && $3 <= 1) { print; bad = 1 }
				END { exit bad || NR != 42 }' rows.csv >>log
		result $? "a mass of $mass below, restitution $e"
	done
done
tap_end
