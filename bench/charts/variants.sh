#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# variants.sh TOPIC PLGEN FOLDER [--quick] [PROGRAM]: the generated code that a topic's program opens, as shared objects
# in FOLDER (variant.sh). A topic has lines in variants.list, or is a function below that prints one for each, FILE SPEC
# [plgen options]. PROGRAM: that says the lines itself. Run at the top of the source tree.
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
case $topic in
	energy | hard | headline) "$program" --list ;;
	less | papers) $topic ;;
	*) expanded "$topic" ;;
esac >"$folder/$topic.jobs"
case $topic in
	friction) CHARTS_RHS=''; export CHARTS_RHS ;;         # it has none
	less) CHARTS_OPTIMIZE=-O0; export CHARTS_OPTIMIZE ;;
esac
xargs -P "${JOBS:-2}" -L 1 sh -c 'plgen=$1 folder=$2 file=$3; shift 3
	exec sh bench/charts/variant.sh "$plgen" "$folder/$file" "$@"' make "$plgen" "$folder" <"$folder/$topic.jobs"
