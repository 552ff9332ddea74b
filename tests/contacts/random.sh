#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# random.sh PLGEN TRUTH FOLLOW.C SOURCE STOPS FRICTIONS IMPACTS CHANGES WILD FIRST COUNT
#     [tuned | compensated | radau | auto | etdrk4 ...]
#
# COUNT random scenes from seed FIRST on with at most so many contacts of each kind and changes of the loads: the
# emitted code against the same scene in multiprecision. WILD 1: of the wilder ones (masses.h), each at steps from a ten
# thousandth of its shortest period to ten of it, and in float; 2: with forces that are not piecewise linear, 3: as they
# are, by a Taylor series. tuned: from a model with other values of up to 16 params, retuned to those of the scene;
# compensated: with --accuracy compensated; radau, auto: by collocation, or both in turns; others: by that scheme, of
# fourth order, in 8 times as many steps. $CC compiles, $PLRT is the
# runtime. KEEP=FOLDER keeps what fails.
plgen=$(realpath "$1")
truth=$(realpath "$2")
follow=$(realpath "$3")
source=$(realpath "$4")
wild=$9
kinds="$5 $6 $7 $8 $((wild % 3))"
changes=$8
shift 9
first=$1
many=$2
tuned=${3:-}
seconds=10
[ $wild -ne 2 ] || seconds=4
options=
series="taylor --tolerance 1e-13"
digits=1e-12
finer=1
case $tuned in
	radau | auto) series="$tuned --tolerance 1e-14"; digits=1e-11 ;;
	etd* | nc* | dq4 | bm3) series=$tuned; digits=1e-7; finer=8 ;;
esac
[ $wild -lt 2 ] || options="--scheme $series"
[ "$tuned" != compensated ] || options="$options --accuracy compensated"
. "$source/tests/run_cc.sh"
. "$source/tests/tap.sh"
decides=0

# truths STEPS_BITS ...: the motion of this seed's scene, once for all these steps: STEPS.spec, STEPS.txt
truths() {
	for view; do
		set -- "$@" ${view%_*} ${view#*_} ${view%_*}.spec ${view%_*}.txt
		shift
	done
	$truth $kinds $seed $seconds "$@"
}

# follows STEPS TOLERANCE REAL: status 0, or 2 where the scene decides nothing, or 3 where a step is too long
follows() {
	mv $1.spec scene.spec && mv $1.txt found.txt || return 1
	! head -n 1 found.txt | grep -q ^doubtful || return 2
	echo >values.h
	if [ "$tuned" = tuned ]; then
		mv scene.spec plain.spec
		awk -v VALUES=values.h -f "$source/tests/contacts/tuned.awk" plain.spec >scene.spec
	fi
	if ! "$plgen" $options --real $3 scene.spec -o scene.c >log 2>&1; then
		grep 'more regions than the limit\|one formula for all time\|both stand in one' log >found.txt &&
			return 2
		return 1
	fi
	# a stop alone is a kink to a scheme that splits no step there, which says so
	! grep -q MAX_EVENTS scene.h && grep 'has a kink where' log >found.txt && return 2
	$run_cc -include ./values.h $([ $3 = float ] && echo -DFLOAT) -I. -I"$source/runtime" \
		-I"$source/tests/emitted" -o follow "$follow" scene.c $PLRT -lm >>log 2>&1 || return 1
	./follow found.txt $1 $2 >>log 2>&1
}

# one NAME STEPS TOLERANCE REAL
one() {
	chosen "$1" || return 0
	follows $2 $3 $4
	status=$?
	if [ $status -ge 2 ]; then
		[ $status -eq 3 ] || echo "# $1: $(head -n 1 found.txt)"
		return 0
	fi
	result $status "$1"
	[ $4 = float ] || grep '^# events' log | sed 's/^# //' >>all
	decides=$((decides + 1))
	if [ $status -ne 0 ] && [ "${KEEP:-}" ]; then
		mkdir -p "$KEEP/$1"
		cp scene.* found.txt log "$KEEP/$1/"
	fi
}

for seed in $(seeds $first $many); do
	name="$(echo "$kinds" | tr ' ' '_')_$seed"
	if [ $changes -gt 0 ]; then             # of which some are at the end of a step
		set -- $((100 * finer)) $((250 * finer)) $((500 * finer)) $((1000 * finer)) $((2000 * finer))
		shift $((seed % 5))
		truths $1_23
		one "$name" $1 $digits double
	elif [ $wild -ne 1 ]; then
		steps=$(((50 + seed * 37 % 950) * finer))
		truths ${steps}_23
		one "$name" $steps $digits double
	else
		truths 2_23 12_23 90_23 1200_23 100000_23 400_10
		for steps in 2 12 90 1200; do
			one "${name}_$steps" $steps $digits double
		done
		one "${name}_100000" 100000 2e-11 double        # each rounds
		one "${name}_float" 400 1e-4 float
	fi
done
touch all
echo "# $decides runs of $many scenes decide"
awk '{ n += $2; if ($5 + 0 > w) w = $5 + 0 } END { print "#", n + 0, "events, worst state", w + 0 }' all
tap_end
