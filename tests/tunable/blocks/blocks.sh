#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# blocks.sh PLGEN ROOT CHAINS, the runtime's library in PLRT: tunable params of models of more than 16 states. What
# NAME_retune makes of an instance, beside the same equations with the values written, and beside the series of the
# solution for random models; what it returns for bad values; what keeps its tables. With MERGE=1 in the environment in
# float too, at other steps, and from 150 starts instead of 40.
set -u
plgen=$(realpath "$1") || exit 99
root=$(cd "$2" && pwd) || exit 99
chains=$(realpath "$3") || exit 99
library=$PLRT
here=$root/tests/tunable/blocks
. "$root/tests/run_cc.sh"
. "$root/tests/tap.sh"
cp "$here"/*.spec . && awk -f "$root/tests/cases.awk" "$here/specs.cases" >names || exit 99

# plain NAME VALUES [OPTION ...]: plain.c, of the same equations with these values; VALUES: k=80 F=2
plain() {
	defines=$(echo "$2" | sed 's/[^ ]*=/-D &/g')
	sed '/^tunable/d; s/^model .*/model plain/' "$1.spec" >plain.spec
	shift 2
	# shellcheck disable=SC2086
	"$plgen" $defines "$@" -o plain.c plain.spec >>log 2>&1
}

starts=
merging || starts=-DSTARTS=40

# driver NAME REAL: ./beside, of NAME.c and plain.c
driver() {
	# shellcheck disable=SC2086
	$run_cc $([ "$2" = float ] && echo -DREAL_FLOAT) $starts -I"$root/runtime" -DTUNED="$1_model" \
		-DPLAIN=plain_model "$here/beside.c" "$1.c" plain.c "$library" -lm -o beside >>log 2>&1
}

# beside TOLERANCE NAME VALUES H [OPTION ...]: retuned, to units of rounding as with the values written; H 0: its own
beside() {
	: >log
	tolerance=$1
	name=$2
	values=$3
	h=$4
	shift 4
	step=$([ "$h" = 0 ] || echo "--step $h")
	real=$(case $* in *float*) echo float ;; *) echo double ;; esac)
	# shellcheck disable=SC2086
	"$plgen" "$@" -o "$name.c" "$name.spec" >>log 2>&1 && plain "$name" "$values" $step "$@" &&
		driver "$name" "$real" && ./beside 0 "$tolerance" "$h" $(echo "$values" | sed 's/[^ ]*=//g') >>log 2>&1
	result $? "$name${*:+ }$* retuned to $values${step:+ }$step is as written"
}

# refused STATUS H WHAT VALUE ...: of the model that was compiled last
refused() {
	status=$1
	h=$2
	what=$3
	shift 3
	./beside "$status" 0 "$h" "$@" >log 2>&1
	result $? "$what"
}

all="m=3 k=90 k2=70 F=2 g=1.5 w=7"
for form in '' '--form direct' '--real float' '--form direct --real float'; do
	# shellcheck disable=SC2086
	! one_of 2 || beside 10 oscillators "$all" 0 $form
done
refused 1 0 'a param that is not a number: PL_NOT_FINITE' 2 nan 60 3 2 5
refused 1 0 'one that is infinite' 2 100 60 3 inf 5
refused 1 0 'a stiffness beyond what a step can be of' 2 1e30 60 3 2 5
refused 4 0 'a mass of 0 that something is divided by: PL_SINGULAR' 0 100 60 3 2 5
refused 8 0.02 'another step where a block keeps its table: PL_NO_STEP' 2 100 60 3 2 5
refused 16 0 'a frequency below 0: PL_NO_RATE' 2 100 60 3 2 -1
beside 3 oscillators "m=2 k=100 k2=60 F=3 g=2 w=5" 0
beside 3 oscillators "m=2 k=100 k2=61 F=3 g=2 w=5" 0

types=double
steps=0
if merging; then
	types='double float'
	steps='0 0.03125'
fi
solved="m=3 J=0.25 k=130 F=2"
for h in $steps; do
	beside 20 solved "$solved" "$h"
	! merging || beside 20 solved "$solved" "$h" --real float --form direct
done
refused 4 0 'a mass matrix without inverse: PL_SINGULAR' 0 0 100 3
refused 1 0 'one that is not a number' nan 0.5 100 3
refused 8 -1 'a step below 0: PL_NO_STEP' 2 0.5 100 3

beside 30 taps "k=30 c=0.5 g=1 d=2" 0
! merging || beside 30 taps "k=30 c=0.5 g=1 d=2" 0.015625 --form direct
for real in $types; do
	beside 10 ends "g=2 F=5 w=4" 0 --real $real
	beside 60 train "m=3 k=1500 F=4" 0 --real $real
	beside 20 gusts "k=80 F=2 w=4" 0 --real $real
	beside 10 red "k=90 g=1" 0 --reduce --real $real
done
! merging || beside 20 gusts "k=80 F=2 w=4" 0 --form direct
! merging || beside 60 train "m=3 k=1500 F=4" 0.0625
! merging || beside 10 wide "k=90" 0

: >log
"$plgen" -o wide.c "wide.spec" >>log 2>&1
grep -q 'There is no wide_at: an independent block has more than 64 states' wide.c && ! grep -q 'void wide_at' wide.c
result $? 'a block beyond the limit that no param touches: no NAME_at, with the reason'
"$plgen" -o oscillators.c "oscillators.spec" >log 2>&1
"$plgen" --explain "oscillators.spec" >explained 2>>log
grep -q 'They touch 7 of 8 independent blocks' oscillators.c && grep -q '7 of 8 independent blocks' explained &&
	[ "$(grep -c 'oscillators_retune_group(&oscillators_block_group' oscillators.c)" = 2 ] &&
	grep -q 's->y\[8\] = q0 + (*-0.0049947' oscillators.c
result $? 'blocks that no param touches keep their constants'

# random SEED REAL: a random model of several blocks beside the series of the solution of its equations
random() {
	: >log
	# shellcheck disable=SC2086
	"$chains" "$1" chained.spec chained.truth >>log 2>&1 &&
		"$plgen" --real "$2" -o chained_pl.c chained.spec >>log 2>&1 &&
		$run_cc $([ "$2" = float ] && echo -DREAL_FLOAT) -I"$root/runtime" -I. "$here/stepped.c" \
			chained_pl.c "$library" -lm -o stepped >>log 2>&1 && ./stepped chained.truth >>log 2>&1
	result $? "random $1 $2: $(sed -n 's/^# //p' chained.spec)"
}

seed=1
merging && most=6 || most=3
while [ $seed -le "${RANDOM_MODELS:-$most}" ]; do
	random $seed $([ $((seed % 3)) = 0 ] && echo float || echo double)
	seed=$((seed + 1))
done
tap_end
