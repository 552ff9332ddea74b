#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# random.sh PLGEN TRUTH FOLLOW.C SOURCE STOPS FRICTIONS IMPACTS FIRST COUNT [tuned]
#
# COUNT random scenes from seed FIRST on with at most so many contacts of each kind: the emitted code against the same
# scene in multiprecision; `tuned`: from a model with other values of up to 16 params, retuned to those. $CC compiles,
# $PLRT is the runtime. KEEP=FOLDER keeps what fails.
plgen=$(realpath "$1")
truth=$(realpath "$2")
follow=$(realpath "$3")
source=$(realpath "$4")
kinds="$5 $6 $7"
first=$8
shift 8
last=$((first + $1))
tuned=${2:-}
seconds=10
. "$source/tests/tap.sh"
decides=0
seed=$first
while [ $seed -lt $last ]; do
	name="$(echo "$kinds" | tr ' ' '_')_$seed"
	if ! chosen "$name"; then
		seed=$((seed + 1))
		continue
	fi
	$truth $kinds $seed $seconds scene.spec found.txt
	status=$?
	if [ $status -eq 2 ]; then
		echo "# $name: $(head -n 1 found.txt)"
		seed=$((seed + 1))
		continue
	fi
	steps=$(awk -v seconds=$seconds '$1 == "step" { printf "%d", seconds/$2 + 0.5 }' scene.spec)
	until=$(awk -v n="$steps" '$1 == "step" { printf "%.3f", n*$2 }' scene.spec)
	$truth $kinds $seed "$until" scene.spec found.txt
	decides=$((decides + 1))
	echo >values.h
	if [ "$tuned" ]; then
		mv scene.spec plain.spec
		awk -v VALUES=values.h -f "$source/tests/contacts/tuned.awk" plain.spec >scene.spec
	fi
	"$plgen" scene.spec -o scene.c >log 2>&1 &&
		${CC:-cc} -O1 -include ./values.h -I. -I"$source/runtime" -I"$source/tests/emitted" -o follow "$follow" \
			scene.c $PLRT -lm >>log 2>&1 &&
		./follow found.txt "$steps" 1e-12 >>log 2>&1
	status=$?
	result $status "$name"
	grep '^# events' log | sed 's/^# //' >>all
	if [ $status -ne 0 ] && [ "${KEEP:-}" ]; then
		mkdir -p "$KEEP/$name"
		cp scene.* found.txt log "$KEEP/$name/"
	fi
	seed=$((seed + 1))
done
touch all
echo "# $decides of $((last - first)) scenes decide"
awk '{ n += $2; if ($5 + 0 > w) w = $5 + 0 } END { print "#", n + 0, "events, worst state", w + 0 }' all
tap_end
