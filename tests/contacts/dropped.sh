#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# A ball is dropped on a ball that lies on the floor, of thirty masses and restitutions: both contacts close at one
# instant without end, and neither ball falls through what is below it, to 1e-12, with status 0. Of two masses
# --solution has the same rows, and both balls at rest in the end. What sticks and lies is still in steps that are cut.
#
#     dropped.sh PLGEN SOURCE_ROOT
root=$2
. "${0%/*}/../plgen.sh"
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
		case $mass in
			1 | 3) ;;
			*) continue ;;
		esac
		"$plgen" --solution 4 balls.spec >solution.csv 2>log
		grep -v '^#' solution.csv | paste -d, rows.csv - >both.csv
		awk -F, 'NR > 1 { for (i = 2; i <= 3; i++) { off = $i - $(i + 3); off = off < 0 ? -off : off
					worst = off > worst ? off : worst } }
				END { printf "# off by %g, rows %d, at the end %s, %s\n", worst, NR, $5, $6
					exit !(NR == 42 && worst <= 1e-12 && $5 == 0 && $6 == 0) }' both.csv >>log
		result $? "a mass of $mass below, restitution $e: --solution"
	done
done

# What rests has the acceleration 0, and not that of its equation alone; so has what is made of it.
for friction in '' ' + friction(a'"'"', 0.2)'; do
	cat >rests.spec <<-END
		model rests
		coord a, b
		init a = 0.2, b' = 0.5
		2*a'' + 0.3*(a' - b') + 12*(a - b) + 30*a$friction = 0
		b'' + 0.3*(b' - a') + 12*(b - a) = 5
		stop between b, ground at 0.02 restitution 0.3
		output a, b, a', b', b'', twice = 2*b'' - a
		step 0.01
	END
	"$plgen" -o rests.c rests.spec >log 2>&1 &&
		$run_cc -I"$root/runtime" -DMODEL=rests "$root/runtime/host/plmain.c" rests.c "$archive" -lm -o rests \
			>>log 2>&1 && ./rests 2 >rows.csv 2>>log &&
		awk -F, 'NR > 1 { rests = $3 == 0.02 && $5 == 0; resting += rests
				expected = rests ? 0 : 5 - 0.3*($5 - $4) - 12*($3 - $2)
				off = $6 - expected; off = off < 0 ? -off : off; worst = off > worst ? off : worst
				off = $7 - (2*expected - $2); off = off < 0 ? -off : off
				worst = off > worst ? off : worst }
			END { printf "# off by %g, at most 1e-12; %d rows rest, at least 50\n", worst, resting
				exit !(worst <= 1e-12 && resting >= 50 && NR == 202) }' rows.csv >>log
	result $? "the acceleration of what rests$friction"
done

# Three that lie on each other are dropped: --solution follows more than a thousand impacts at one instant
cat >three.spec <<-END
	model balls
	coord a, b, c
	init a = 0.618, b = 0.618, c = 0.618
	3.072*a'' = -30.13
	1.562*b'' = -15.32
	2.466*c'' = -24.19
	stop between ground, a at 0 restitution 0.3
	stop between a, b at 0 restitution 0.021
	stop between b, c at 0 restitution 0
	output a, b, c
	step 0.001
END
# follows WHAT SPEC STATES: --solution beside the step, over a second
follows() {
	"$plgen" -o balls.c $2 >log 2>&1 &&
		$run_cc -I"$root/runtime" -DMODEL=balls "$root/runtime/host/plmain.c" balls.c "$archive" -lm \
			-o balls >>log 2>&1 &&
		./balls 1 >rows.csv 2>>log && "$plgen" --solution 1 $2 >solution.csv 2>>log
	grep -v '^#' solution.csv | paste -d, rows.csv - | awk -F, -v n="$3" 'NR > 1 { for (i = 2; i <= n + 1; i++) {
				off = $i - $(i + n + 1); off = off < 0 ? -off : off; worst = off > worst ? off : worst
			} }
			END { printf "# off by %g, rows %d, at the end %s, %s\n", worst, NR, $(n + 3), $(n + 4)
				exit !(NR == 1002 && worst <= 1e-12) }' >>log
	result $? "$1: --solution"
}
follows 'three that are dropped together' three.spec 3
[ "$(tail -n 1 solution.csv)" = 1,0,0,0 ]
result $? 'three that are dropped together: at rest'

cat >block.spec <<-END
	model balls
	coord x, y
	init y = 1, y' = -2
	x'' + 100*x + friction(x', 3) = 0
	y'' = -9.81
	stop between x, y at 0 restitution 0.5
	output x, y
	step 0.001
END
follows 'a ball on a block that sticks' block.spec 2

# What sticks and what lies on the ground in steps that are cut, whose forces are polynomials: from 5 s to 200 s neither
# moves by more than rounding.
cat >still.spec <<-END
	model still
	coord x, y, z
	init x = 0.05, y = 0.1
	x'' + 100*x + 300*x^3 + friction(x', 12) = 5*cos(7*t) + 0.4*z
	y'' + 20*sin(y) + 2*(y - z) = -9.81 + cos(3*t)*x + 2*z^2
	z'' + 4*z + 3*z^3 = 2*cos(t)
	stop between ground, y at 0 restitution 0.5
	output v = x'
	output y
	output w = y'
	step 0.05
END
for scheme in etdrk4 nc3 etdcol; do
	"$plgen" --scheme $scheme -o still.c still.spec >log 2>&1 &&
		$run_cc -I"$root/runtime" -DMODEL=still "$root/runtime/host/plmain.c" still.c "$archive" -lm -o still \
			>>log 2>&1 && ./still 200 >rows.csv 2>>log
	awk -F, 'NR > 1 && $1 >= 5 { for (i = 2; i <= 4; i++) { size = $i < 0 ? -$i : $i
				worst = size > worst ? size : worst }; rows++ }
			END { printf "# off by %g in %d rows\n", worst, rows
				exit !(rows > 3900 && worst <= 1e-12) }' rows.csv >>log
	result $? "$scheme: what sticks and what lies is still"
done

# Friction of a belt starts with the velocity that is given, 0: x' = 1.5 t up to 0.2, in closed form.
printf '%s\n' 'model belt' 'coord x' "x'' + friction(x' - 0.2, 1.5) = 0" "output x, x'" 'step 0.1' >belt.spec
"$plgen" --solution 0.2 belt.spec | grep -v '^#' >solution.csv
awk -F, 'NR == 3 { first = $3 } NR == 4 { last = $3 }
	END { print "# " first ", " last; exit !(first - 0.15 <= 1e-16 && 0.15 - first <= 1e-16 && last == 0.2) }' \
	solution.csv >log
result $? 'friction of a belt that the start does not share: --solution'

# A jump that does not bounce, of a linear oscillator, x'' + 4 x = 0 from 1: x passes -0.5 and is 0.7, by each scheme
# that stops there, beside the closed form from jump to jump.
printf '%s\n' 'model jumps' 'coord x' 'init x = 1' "x'' + 4*x = 0" 'when x <= -0.5: x = 0.7' 'step 0.05' >jumps.spec
for scheme in exact pl etd1 etdrk2 etdrk4 nc2 nc3 dq4 bm3 taylor 'radau --tolerance 1e-13' auto etdcol; do
	"$plgen" --scheme $scheme -o jumps.c jumps.spec >log 2>&1 &&
		$run_cc -I"$root/runtime" -DMODEL=jumps "$root/runtime/host/plmain.c" jumps.c "$archive" -lm -o jumps \
			>>log 2>&1 && ./jumps 5 >rows.csv 2>>log
	awk -F, 'function arc(c) { return atan2(sqrt(1 - c*c), c) }
		BEGIN { size = 1 }
		NR > 1 { while (2*($1 - from) + phase > arc(-0.5/size)) {
				from += (arc(-0.5/size) - phase)/2; v = 2*size*sin(arc(-0.5/size))
				size = sqrt(0.49 + v*v/4); phase = arc(0.7/size); jumps++ }
			off = $2 - size*cos(2*($1 - from) + phase); off = off < 0 ? -off : off
			worst = off > worst ? off : worst }
		END { printf "# off by %g, %d jumps\n", worst, jumps
			exit !(NR == 102 && jumps > 6 && worst <= 1e-11) }' \
		rows.csv >>log
	result $? "${scheme%% *}: a jump that does not bounce"
done
tap_end
