#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# hard.sh PLGEN FOLDER [problems]: the generated code of the hard cases, FOLDER/hard_*.so, and its list FOLDER/hard.list
# (see hard.c). Run at the top of the source tree. problems: without the methods, the cases alone.
set -e
plgen=$1 folder=$2 only=$3
charts=bench/charts
specs=$charts/specs
mkdir -p "$folder"
: >"$folder/hard.list"
: >"$folder/hard.jobs"

# variant CASE METHOD STEP SPEC [plgen options]
variant() {
	case=$1 method=$2 step=$3 spec=$4
	shift 4
	[ "$only" != problems ] || [ "$method" = problem ] || return 0
	file=$folder/$(echo "hard $case $method $step" | sed 's/[^a-zA-Z0-9.-]\{1,\}/_/g').so
	# without a blank at its end: xargs would go on with the next line
	echo "$file $spec --step $step" "$@" >>"$folder/hard.jobs"
	printf '%s\t%s\t%s\t%s\n' "$case" "$method" "$(awk "BEGIN { printf \"%.17g\", $step }")" "$file" \
		>>"$folder/hard.list"
}

# nothing_left CASE METHOD STEP
nothing_left() {
	printf '%s\t%s\t%s\t-\n' "$1" "$2" "$(awk "BEGIN { printf \"%.17g\", $3 }")" >>"$folder/hard.list"
}

# ours KIND CASE 'STEPS' SPEC [plgen options]
ours() {
	kind=$1 of=$2 steps=$3 from=$4
	shift 4
	variant "$of" problem "${steps%% *}" "$from" "$@"
	for at in $steps; do
		variant "$of" exact "$at" "$from" --scheme exact "$@"
		variant "$of" 'exact, compensated' "$at" "$from" --scheme exact --accuracy compensated "$@"
		variant "$of" 'exact, float' "$at" "$from" --scheme exact --real float "$@"
		variant "$of" pl "$at" "$from" --scheme pl "$@"
		for scheme in etd1 etdrk2 etdrk4 bm3; do
			if [ "$kind" = linear ]; then
				nothing_left "$of" $scheme "$at"
			else
				variant "$of" $scheme "$at" "$from" --scheme $scheme "$@"
			fi
		done
	done
}

ours other 'stiff van der Pol' '0.1 0.01' models/vanderpol_stiff.spec
ours linear 'stiff spring' '1/8 1/128' $specs/stiff_spring.spec
ours linear resonance 1/128 $specs/resonance.spec
ours linear 'resonance, 1e-9 off' 1/128 $specs/resonance.spec -D off=1e-9
ours linear 'equal poles' 1/128 $specs/confluent.spec
ours linear 'poles 1e-10 apart' 1/128 $specs/confluent.spec -D w2=10.0000000001
ours linear 'critical damping' 1/128 $specs/critical.spec
ours linear 'rigid body' 1/128 $specs/rigid.spec
ours linear 'long run' 1/1024 models/scs.spec
ours other 'grazing contact' 1/128 $specs/graze.spec
ours linear 'poles -1e8 and -1e-3' 1024 $specs/fast_slow.spec
ours linear 'the same, long step' 1048576 $specs/fast_slow.spec
xargs -P "${JOBS:-2}" -L 1 $charts/variant.sh "$plgen" <"$folder/hard.jobs"
