#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Two frictions, each felt by the other mass twice, come to rest at t = 1. From there both can stick, and one can turn
# round while the other slides on: both agree, and that is taken which changes less. What turns round changes once, so
# it is the second, in a closed form: by steps of regions and by series.  Two that hold more than they bear, by both.
#
#     turned.sh PLGEN SOURCE_ROOT
root=$2
. "${0%/*}/../plgen.sh"

# beside the closed form: rows of t, x, y; the largest difference
judge() {
	awk -F, -v bound="$1" 'NR > 1 { t = $1; s = t - 1
			x = t < 1 ? 4.25*t - 2.125*t*t : 2.125 - 1.125*s*s
			y = t < 1 ? 3.25*t - 1.625*t*t : 1.625 + 0.375*s*s
			off = ($2 > x ? $2 - x : x - $2) + ($3 > y ? $3 - y : y - $3)
			worst = off > worst ? off : worst }
		END { printf "# off by %g, bound %g, rows %d\n", worst, bound, NR; exit !(NR > 6 && worst <= bound) }'
}

# turns NAME BOUND CURVED STEP OPTION ...
turns() {
	name=$1
	bound=$2
	curved=$3
	step=$4
	shift 4
	chosen "$name, h = $step" || return 0
	cat >turned.spec <<-END
		model turned
		coord x, y${curved:+, z}
		init x' = 4.25, y' = 3.25${curved:+, z = 1}
		x'' + friction(x', 1) + 2*friction(y', 1) = -1.25
		y'' + friction(y', 1) + 2*friction(x', 1) = -0.25
		$curved
		output x, y
		step $step
	END
	made turned "$@" && ./turned 3 >rows.csv 2>>log && judge "$bound" <rows.csv >>log
	result $? "$name, h = $step"
}

# made NAME OPTION ...: NAME.spec as a program
made() {
	name_of=$1
	shift
	float=''
	case $* in *float*) float=-DFLOAT ;; esac
	"$plgen" "$@" -o "$name_of.c" "$name_of.spec" >log 2>&1 &&
		$run_cc -I"$root/runtime" "-DMODEL=$name_of" $float "$root/runtime/host/plmain.c" "$name_of.c" \
			"$archive" -lm -o "$name_of" >>log 2>&1
}

# releases OPTION ...: rows of two frictions that hold more than they bear when they slide, and feel each other: what
# one bears falls where the other one slips, so that it slips under less than would hold it.
releases() {
	cat >held.spec <<-END
		model held
		coord x, y${curved:+, z}
		init x = -0.192, x' = -0.256
		init y = 0.108, y' = -0.032${curved:+, z = 1}
		0.516*x'' + 12*x - 3*y + friction(x' - y', 1.458, 2) + friction(x', 0.588, 1.6) = 3*cos(2*t)
		0.711*y'' + 32.401*y + 3*(y - x) - friction(x' - y', 1.458, 2) = 3.15*cos(1.88*t + 1)
		$curved
		output x, y, x', y'
		step 0.015625
	END
	made held "$@" && ./held 40 2>>log
}

for h in 0.125 0.3 0.5; do
	turns exact 1e-14 '' $h
	turns compensated 1e-14 '' $h --accuracy compensated
	turns 'exact, float' 1e-5 '' $h --real float
	turns series 1e-12 "z'' + z^3 = 0" $h --scheme taylor
	turns 'series, float' 1e-5 "z'' + z^3 = 0" $h --scheme taylor --real float
done
if chosen 'releases, series'; then
	curved=
	releases >regions.csv
	curved="z'' + z^3 = 0"
	releases --scheme taylor --tolerance 1e-13 >series.csv && paste -d , regions.csv series.csv |
		awk -F, 'NR > 1 {
				for (i = 1; i <= 5; i++) {
					d = $i - $(i + 5)
					worst = d > worst ? d : -d > worst ? -d : worst
				}
			}
			END {
				printf "# off by %g, rows %d\n", worst, NR
				exit !(NR == 2562 && worst <= 1e-12)
			}' >>log &&
		! grep "no answer" log
	result $? 'releases, series'
fi
tap_end
