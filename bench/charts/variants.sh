#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# variants.sh TOPIC PLGEN FOLDER [--quick] [PROGRAM]: the generated code that a topic's program opens, as shared objects
# in FOLDER (variant.sh). A topic is a function below that prints a line for each, FILE SPEC [plgen options]; with a
# list of its own, FOLDER/TOPIC.list, where the program reads what is what. PROGRAM: that says the lines itself. Run at
# the top of the source tree.
set -e
topic=$1 plgen=$2 folder=$3 quick=
shift 3
[ "${1:-}" != --quick ] || { quick=--quick; shift; }
charts=bench/charts
specs=$charts/specs
mkdir -p "$folder"

# 30 s in N intervals, so that the step is 30/N exactly
convergence() {
	intervals='1000 2000 3000 5000 7000 10000 14000 20000 50000 100000'
	[ -z "$quick" ] || intervals='1000 2000 5000 20000'
	for system in scs sdcs sdcsf; do
		for scheme in pl exact; do
			for n in $intervals; do
				echo "convergence_${system}_${scheme}_$n.so models/$system.spec" \
					"--scheme $scheme --step 30/$n"
			done
		done
	done
}

# listed FIELDS FILE SPEC [plgen options]: and a line of the list, FIELDS TAB FILE
listed() {
	fields=$1 file=$2
	shift
	# without a blank at its end: xargs would go on with the next line
	echo "$@"
	printf '%s\t%s\n' "$fields" "$folder/$file" >>"$folder/$topic.list"
}

# kept CASE METHOD REAL H SPEC [plgen options]: of energy
kept() {
	of=$1 method=$2 real=$3 h=$4 spec=$5
	shift 5
	listed "$(printf '%s\t%s\t%s\t%s' "$of" "$method" "$real" "$h")" \
		"$(echo "energy $of $method $h $real" | sed 's/[^a-z0-9.]\{1,\}/_/g').so" "$spec" --step "$h" "$@"
}

# forms CASE REAL H SPEC [plgen options]: the equations, then the form that plgen chooses, then every form
forms() {
	of=$1 real=$2 h=$3 spec=$4
	shift 4
	kept "$of" problem "$real" "$h" "$spec" "$@"
	name=exact
	if [ "$real" = float ]; then
		set -- --real float "$@"
		name='exact, float'
	fi
	kept "$of" "$name" "$real" "$h" "$spec" "$@"
	for form in direct delta kick-drift-kick; do
		kept "$of" "$name, $form" "$real" "$h" "$spec" --form $form "$@"
	done
	kept "$of" "$name, compensated" "$real" "$h" "$spec" --accuracy compensated "$@"
}

energy() {
	for real in double float; do
		forms undamped $real 0.01 models/scs.spec
		forms moving $real 0.01 $specs/free_pair.spec -D v2=0
		forms resting $real 0.01 $specs/free_pair.spec
	done
	forms undamped float 0.0001 models/scs.spec
	for real in double float; do
		forms damped $real 0.0001 models/sdcs.spec -D c1=1e-6 -D c2=1e-6 -D c3=1e-6
	done
}

frame() {
	for parts in 1 2 4; do
		echo "frame-$parts.so models/frame.spec --step 1/50/$parts"
	done
}

friction() {
	for parts in 1 5; do
		echo "friction-$parts.so $specs/friction.spec --step 1/20/$parts"
	done
}

# case_of CASE METHOD STEP SPEC [plgen options]: of hard; SPEC -: nothing is left over for that scheme. With
# CHARTS_PROBLEMS in the environment the cases alone
case_of() {
	of=$1 method=$2 step=$3 spec=$4
	shift 4
	[ -z "$CHARTS_PROBLEMS" ] || [ "$method" = problem ] || return 0
	fields=$(printf '%s\t%s\t%s' "$of" "$method" "$(awk "BEGIN { printf \"%.17g\", $step }")")
	if [ "$spec" = - ]; then
		printf '%s\t-\n' "$fields" >>"$folder/hard.list"
	else
		listed "$fields" "$(echo "hard $of $method $step" | sed 's/[^a-zA-Z0-9.-]\{1,\}/_/g').so" "$spec" \
			--step "$step" "$@"
	fi
}

# tried KIND CASE 'STEPS' SPEC [plgen options]
tried() {
	kind=$1 of=$2 steps=$3 from=$4
	shift 4
	case_of "$of" problem "${steps%% *}" "$from" "$@"
	for at in $steps; do
		case_of "$of" exact "$at" "$from" --scheme exact "$@"
		case_of "$of" 'exact, compensated' "$at" "$from" --scheme exact --accuracy compensated "$@"
		case_of "$of" 'exact, float' "$at" "$from" --scheme exact --real float "$@"
		case_of "$of" pl "$at" "$from" --scheme pl "$@"
		for scheme in etd1 etdrk2 etdrk4 bm3; do
			if [ "$kind" = linear ]; then
				case_of "$of" $scheme "$at" -
			else
				case_of "$of" $scheme "$at" "$from" --scheme $scheme "$@"
			fi
		done
	done
}

hard() {
	tried other 'stiff van der Pol' '0.1 0.01' models/vanderpol_stiff.spec
	tried linear 'stiff spring' '1/8 1/128' $specs/stiff_spring.spec
	tried linear resonance 1/128 $specs/resonance.spec
	tried linear 'resonance, 1e-9 off' 1/128 $specs/resonance.spec -D off=1e-9
	tried linear 'equal poles' 1/128 $specs/confluent.spec
	tried linear 'poles 1e-10 apart' 1/128 $specs/confluent.spec -D w2=10.0000000001
	tried linear 'critical damping' 1/128 $specs/critical.spec
	tried linear 'rigid body' 1/128 $specs/rigid.spec
	tried linear 'long run' 1/1024 models/scs.spec
	tried other 'grazing contact' 1/128 $specs/graze.spec
	tried linear 'poles -1e8 and -1e-3' 1024 $specs/fast_slow.spec
	tried linear 'the same, long step' 1048576 $specs/fast_slow.spec
}

# Its specs, and what plgen counts for a step of each: NAME.cost
less() {
	"$program" --specs "$folder"
	cut -f 1,6 "$folder/less.list" | while read -r name options; do
		# shellcheck disable=SC2086
		"$plgen" $options "$folder/$name.spec" 2>/dev/null |
			sed -n '/^ \* One step of/{s/.* \([0-9]*\) multiplications.*/\1/p;q;}' >"$folder/$name.cost"
		echo "$name.so $folder/$name.spec $options"
	done
}

# Some points of the map
plmap() {
	while read -r name k1 k2 k3 h; do
		echo "plmap_$name.so models/scs.spec --scheme pl -D k1=$k1 -D k2=$k2 -D k3=$k3 --step $h"
	done <<-EOT
	scs 100 100 100 1/100
	weak 4000 40 2000 1/100
	slow 1 1/1000 1/2 1/10
	fast 1 1/10 1 2
	stiff 1 8 1/2 1
	EOT
}

stability() {
	grep -v '^#' $charts/stability.variants | sed 's/ /.so /'
}

# What the papers found: the coupled systems, precise integration, clearances, the rotating beam. --quick: the beam at
# h = 0.01 only
papers() {
	beam_rates='10 100 1000 10000' fine_rates='100 1000'
	[ -z "$quick" ] || { beam_rates=100 fine_rates=100; }
	for scheme in pl exact; do
		for system in scs sdcs sdcsf; do
			for rate in 100 1000; do
				echo "${system}_${scheme}_$rate models/$system.spec --scheme $scheme --step 1/$rate"
			done
		done
		for k in '4000 40 2000' '4000 40 4000' '4000 400 4000' '100 100 100'; do
			# shellcheck disable=SC2086
			set -- $k
			echo "k$1_$2_$3_$scheme models/scs.spec --scheme $scheme" \
				"-D k1=$1 -D k2=$2 -D k3=$3 --step 1/100"
		done
	done
	for scheme in nc2 nc3 dq4 bm3; do
		echo "linear2dof_${scheme}_5 models/linear2dof.spec --scheme $scheme --loads remainder --step 1/5"
		for at in pendulum/10 vanderpol/10 quad2dof/10 quad2dof/2 vanderpol_stiff/100 vanderpol_stiff/1000; do
			echo "${at%/*}_${scheme}_${at#*/} models/${at%/*}.spec --scheme $scheme --step 1/${at#*/}"
		done
	done
	for tenths in 8 10 12; do
		echo "gear1_$tenths models/gear1.spec -D eta=$tenths/10"
	done
	echo 'gear2 models/gear2.spec'
	# the same gears without a clearance, for the cost of a step
	for model in gear1 gear2; do
		sed -e 's/deadzone(\([a-z]\(\[1\]\)*\), -b, b)/\1/' models/$model.spec \
			>"$folder/papers_${model}_plain.spec"
		echo "${model}_plain $folder/papers_${model}_plain.spec"
	done
	# by the speed at which the operator is taken
	mkdir -p "$folder/beam"
	cp models/beam/*.mtx "$folder/beam"
	for at in beam4/0 beam4/1 beam4/2 beam4/3 beam4/4 beam4/5 beam4/6 beam15/0 beam15/15; do
		sed -e "s/^operator.*/operator at w = ${at#*/}/" "models/${at%/*}.spec" \
			>"$folder/papers_${at%/*}_A${at#*/}.spec"
	done
	for speed in 0 1 2 3 4 5 6; do
		for rate in $beam_rates; do
			beam 4 $speed etd1 "$rate"
		done
	done
	beam 4 4 etdrk4 10000
	for speed in 0 15; do
		for scheme in etd1 etdrk2 etdrk4; do
			beam 15 $speed $scheme 100
		done
	done
	for scheme in etdrk2 etdrk4; do
		[ "$fine_rates" = 100 ] || beam 15 15 $scheme 1000
		for rate in $fine_rates; do
			beam 15 15 $scheme "$rate" left --loads remainder
		done
	done
	beam 15 15 etdrk4 10000
}

# beam MODEL SPEED SCHEME RATE [NAME plgen options]
beam() {
	spec=$folder/papers_beam$1_A$2.spec name=${5:-A$2} scheme=$3 rate=$4 model=$1
	shift $(($# > 4 ? 5 : 4))
	echo "beam${model}_${name}_${scheme}_$rate $spec --scheme $scheme $* --step 1/$rate"
}

program=${1:-}
: >"$folder/$topic.list"
case $topic in
	headline) "$program" --list ;;
	papers) papers | sed 's/^\([^ ]*\)/papers_\1.so/' ;;
	*) $topic ;;
esac >"$folder/$topic.jobs"
case $topic in
	friction) CHARTS_RHS=''; export CHARTS_RHS ;;         # it has none
	less) CHARTS_OPTIMIZE=-O0; export CHARTS_OPTIMIZE ;;
esac
xargs -P "${JOBS:-2}" -L 1 sh -c 'plgen=$1 folder=$2 file=$3; shift 3
	exec sh bench/charts/variant.sh "$plgen" "$folder/$file" "$@"' make "$plgen" "$folder" <"$folder/$topic.jobs"
