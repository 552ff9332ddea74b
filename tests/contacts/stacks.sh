#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# stacks.sh PLGEN STACKS STANDS.C SOURCE FIRST COUNT VARIANT ...
#
# COUNT random scenes from seed FIRST on, or from each of several, the VARIANTs in turn: stacks, walls, wedges. What
# is emitted keeps to what needs no truth: nothing is penetrated, energy never grows, momentum stays, status 0.
# Variants: exact, float, compensated, float_compensated, tunable, taylor, curved (by a series, with a cubic spring),
# float_curved; radau, float_radau (likewise by collocation); etdrk4, float_etdrk4 (without that spring); solution:
# --solution beside the step, to 1e-8; solved: the same, where it is not refused.
# $PLRT is the runtime. KEEP=FOLDER keeps what fails.
stacks=$(realpath "$2")
stands=$(realpath "$3")
root=$4
firsts=$5
many=$6
. "${0%/*}/../plgen.sh"
shift 6

# follows: 2: it is refused
follows() {
	if ! "$plgen" --solution 1 scene.spec >solution.csv 2>>log; then
		grep -q 'it is not known' log && return 2
		return 1
	fi
	$run_cc -I. -I"$root/runtime" -DMODEL=scene -o rows "$root/runtime/host/plmain.c" scene.c $archive -lm \
		>>log 2>&1 && ./rows 1 >rows.csv 2>>log || return 1
	grep -v '^#' solution.csv | paste -d, rows.csv - | awk -F, 'NR > 1 { for (i = 2; i <= NF / 2; i++) {
				off = $i - $(i + NF / 2); off = off < 0 ? -off : off
				worst = off > worst ? off : worst } }
			END { printf "# off by %g in %d rows\n", worst, NR; exit !(NR > 2 && worst <= 1e-8) }' >>log
}

# stands_up VARIANT: whether the scene of this seed does; 2: it has more contacts than such a model may
stands_up() {
	real=double
	digits=1e-11
	scheme=exact
	form=plain
	options=
	case $1 in
		*float*) real=float; digits=5e-4 ;;
	esac
	case $1 in
		*compensated) options="--accuracy compensated" ;;
		tunable) form=tunable ;;
		*taylor) scheme=taylor ;;
		*curved) scheme=curved ;;
		*radau) scheme=curved; options="--scheme radau" ;;
		*etdrk4) scheme=taylor; options="--scheme etdrk4" ;;
	esac
	$stacks $seed $scheme $form $real scene.spec drawn.h || return 1
	case $1 in # of order 4: what moves together on a spring creeps by the scheme's error, 1e-6 at h
		*etdrk4) options="$options --step $(sed -n 's/^step //p' scene.spec)/16" ;;
	esac
	if ! "$plgen" --real $real $options scene.spec -o scene.c >log 2>&1; then
		grep -q 'more regions than the limit' log && return 2
		return 1
	fi
	case $1 in
		solution | solved) follows; return ;;
	esac
	$run_cc $([ $real = float ] && echo -DFLOAT) -I. -I"$root/runtime" -o stands "$stands" scene.c \
		$archive -lm >>log 2>&1 || return 1
	./stands $digits 2 >>log 2>&1
}

for seed in $(for first in $firsts; do seeds "$first" "$many"; done); do
	variant=$1                              # the next one comes first the next time
	shift
	set -- "$@" $variant
	name="${variant}_$seed"
	if chosen "$name"; then
		stands_up $variant
		status=$?
		if [ $status -eq 2 ] && [ $variant != solution ]; then
			skip "$name" "$(head -n 1 log | cut -c 1-80)"
		else
			result $status "$name"
		fi
		if [ $status -eq 1 ] && [ "${KEEP:-}" ]; then
			mkdir -p "$KEEP/$name"
			cp scene.* drawn.h log "$KEEP/$name/"
		fi
	fi
done
tap_end
