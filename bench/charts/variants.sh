#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# variants.sh TOPIC PLGEN FOLDER [--quick] [PROGRAM]: the generated code that a topic's program opens, as shared objects
# in FOLDER (variant.sh). A topic has lines in variants.list, or is a function below that prints one for each, FILE SPEC
# [plgen options], with a list of its own, FOLDER/TOPIC.list, where the program reads what is what. PROGRAM: that says
# the lines itself. Run at the top of the source tree.
set -e
topic=$1 plgen=$2 folder=$3 quick=
shift 3
[ "${1:-}" != --quick ] || { quick=--quick; shift; }
charts=bench/charts
specs=$charts/specs
mkdir -p "$folder"

# expanded TOPIC: its lines of variants.list
expanded() {
	awk -v topic="$1" -v quick="$quick" -v specs="$specs" -v made="$folder" '
		# Each choice of the first set in line, in turn; `number` of them before
		function expand(line, number,    open, close_at, set, parts, each, count, i, rest) {
			open = index(line, "{"); close_at = index(line, "}")
			if (!open) { print line; return }
			set = substr(line, open + 1, close_at - open - 1)
			if (split(set, parts, ";") == 2) set = quick == "" ? parts[1] : parts[2]
			count = split(set, each, ",")
			for (i = 1; i <= count; i++) {
				rest = line
				gsub("[$]" number, each[i], rest)
				expand(substr(rest, 1, open - 1) each[i] substr(rest, close_at + 1), number + 1)
			}
		}
		function take(line) {
			if (line !~ "^" topic " ") return
			sub(/^[^ ]* /, "", line)
			sub(/ specs\//, " " specs "/", line); sub(/ made\//, " " made "/", line)
			expand(line, 1)
		}
		/^\t/ { sub(/^\t+/, ""); kept = kept $0; next }
		{ take(kept); kept = $0 }
		END { take(kept) }' $charts/variants.list
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

# case_of CASE METHOD STEP SPEC [plgen options]: of hard; SPEC -: there is no remainder for that scheme. With
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
		"$plgen" --fast $options "$folder/$name.spec" 2>/dev/null |
			sed -n '/^ \* One step of/{s/.* \([0-9]*\) multiplications.*/\1/p;q;}' >"$folder/$name.cost"
		echo "$name.so $folder/$name.spec $options"
	done
}

# The gears without a clearance, and the beams with operators taken at these speeds
papers() {
	for model in gear1 gear2; do
		sed -e 's/deadzone(\([a-z]\(\[1\]\)*\), -b, b)/\1/' models/$model.spec \
			>"$folder/papers_${model}_plain.spec"
	done
	mkdir -p "$folder/beam"
	cp models/beam/*.mtx "$folder/beam"
	for at in beam4/0 beam4/1 beam4/2 beam4/3 beam4/4 beam4/5 beam4/6 beam15/0 beam15/15; do
		sed -e "s/^operator.*/operator at w = ${at#*/}/" "models/${at%/*}.spec" \
			>"$folder/papers_${at%/*}_A${at#*/}.spec"
	done
	expanded papers
}

program=${1:-}
: >"$folder/$topic.list"
case $topic in
	headline) "$program" --list ;;
	energy | hard | less | papers) $topic ;;
	*) expanded "$topic" ;;
esac >"$folder/$topic.jobs"
case $topic in
	friction) CHARTS_RHS=''; export CHARTS_RHS ;;         # it has none
	less) CHARTS_OPTIMIZE=-O0; export CHARTS_OPTIMIZE ;;
esac
xargs -P "${JOBS:-2}" -L 1 sh -c 'plgen=$1 folder=$2 file=$3; shift 3
	exec sh bench/charts/variant.sh "$plgen" "$folder/$file" "$@"' make "$plgen" "$folder" <"$folder/$topic.jobs"
