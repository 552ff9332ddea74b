#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Do the models of same/runs.list have the same numbers by two builds of plgen?
#
#     same.sh [--text] OLD NEW        build folders, with plgen and libplrt.a
#     same.sh --keep FILE BUILD       writes a line of sums for each run, for
#     same.sh [--text] FILE NEW       so that the old build need not be kept; what differs is then not measured
#
# What each build emits is compiled with the headers and linked with the runtime of that build, and told to 17 digits by
# same/tell.c. Where numbers differ, by how much: in units in the last place of the largest value of the column, and the
# same over the steps taken until there. A line of same/except.list (pattern of runs, tab, reason) lets runs differ by
# two units a step. --text: how many of the emitted texts are the same, too. In the environment CASE=TEXT: only runs
# with TEXT in them; EXCEPT=FILE: another list.
set -u
root=$(cd "$(dirname "$0")/.." && pwd)
here=$root/tests/same
except=${EXCEPT:-$here/except.list}
tab=$(printf '\t')
. "$root/tests/run_cc.sh"
. "$here/run.sh"

# one BUILD FOLDER NUMBER: that run of FOLDER/../runs, its numbers to FOLDER/NUMBER.csv, their sum and that of the text
# to FOLDER/NUMBER.sums. A run that fails has a line of its own in place of numbers.
one() {
	run=$(sed -n "$3p" "$2/../runs")
	mkdir "$2/$3" && cd "$2/$3" || exit 1
	: >text
	# shellcheck disable=SC2086
	emit "$1/plgen" "$run" >log 2>&1 && cat model.c model.h >text &&
		told_by tell "$("$1/plgen" --runtime-dir)" "$1/libplrt.a" $run_cc >log 2>&1 &&
		timeout 60 ./tell >"$2/$3.csv" 2>log || echo "failed, status $?: $(head -n 1 log)" >"$2/$3.csv"
	echo "$(sha256sum <"$2/$3.csv" | cut -c 1-24) $(sha256sum <text | cut -c 1-24) $run" >"$2/$3.sums"
	rm -r "${2:?}/$3"
}

usage() {
	echo 'usage: same.sh [--text] OLD NEW, or same.sh --keep FILE BUILD' >&2
	exit 2
}

# all BUILD SIDE: $work/SIDE.sums, in the order of the runs
all() {
	[ -x "$1/plgen" ] && [ -f "$1/libplrt.a" ] || { echo "same.sh: no plgen and libplrt.a in $1" >&2; exit 2; }
	mkdir "$work/$2"
	seq "$runs" | xargs -P "$(nproc)" -I '{}' sh "$0" --one "$(cd "$1" && pwd)" "$work/$2" '{}'
	for number in $(seq "$runs"); do
		cat "$work/$2/$number.sums"
	done >"$work/$2.sums"
}

# is_excepted RUN: sets `reason`
is_excepted() {
	while IFS=$tab read -r pattern reason; do
		# shellcheck disable=SC2254
		case $1 in
			$pattern) return 0 ;;
		esac
	done <"$except"
	return 1
}

# shared ONE OTHER: of OTHER the tables that ONE has, too: one build may tell more, values between steps for one
shared() {
	awk -F , 'NR == FNR { has[$1] = 1; next } $1 in has' "$1" "$2"
}

# gone NEW OLD: a blank and the name of each table of OLD that NEW no longer tells
gone() {
	awk -F , 'NR == FNR { has[$1] = 1; next } !($1 in has) { has[$1] = 1; printf " %s", $1 }' "$1" "$2"
}

# judge NUMBER WAS IS RUN: counts the run, and tells of one that is not the same
judge() {
	new=$work/new/$1.csv
	if grep -q '^failed' "$new"; then
		words=$(cat "$new")
	elif [ "$2" = "$3" ]; then
		same=$((same + 1))
		return
	elif [ -f "$work/old/$1.csv" ] && [ -n "$(gone "$new" "$work/old/$1.csv")" ]; then
		words="no longer tells$(gone "$new" "$work/old/$1.csv")"
	elif [ -f "$work/old/$1.csv" ]; then
		shared "$new" "$work/old/$1.csv" >"$work/was.csv"
		shared "$work/old/$1.csv" "$new" >"$work/is.csv"
		if cmp -s "$work/was.csv" "$work/is.csv"; then
			same=$((same + 1))
			return
		fi
		words=$(awk -F , -f "$here/differ.awk" "$work/was.csv" "$work/is.csv")
	else
		words=differs
	fi
	if [ "${words% within}" != "$words" ] && is_excepted "$4"; then
		excepted=$((excepted + 1))
		echo "$4: ${words% within}; $reason"
	else
		others=$((others + 1))
		echo "$4: ${words% within}"
	fi
}

text=
keep=
case ${1:-} in
	--one) one "$2" "$3" "$4"; exit ;;
	--text) text=1; shift ;;
	--keep) [ $# -eq 3 ] || usage; keep=$2; shift ;;
esac
[ $# -eq 2 ] || usage
work=$(mktemp -d "${TMPDIR:-/tmp}/plgen.XXXXXX") || exit 99
trap 'rm -rf "$work"' EXIT
trap 'exit 99' HUP INT TERM
list_runs | grep -F -e "${CASE:-}" >"$work/runs"
runs=$(wc -l <"$work/runs")
all "$2" new
if [ -n "$keep" ]; then
	cp "$work/new.sums" "$keep"
	exit
elif [ -f "$1" ]; then
	awk 'NR == FNR { sum = $1 " " $2; sub(/^[^ ]+ [^ ]+ /, ""); sums[$0] = sum; next }
		{ print ($0 in sums ? sums[$0] : "none none") " " $0 }' "$1" "$work/runs" >"$work/old.sums"
else
	all "$1" old
fi

number=0 same=0 excepted=0 others=0 texts=0
while read -r was was_text run && read -r is is_text _ <&3; do
	number=$((number + 1))
	[ "$was_text" != "$is_text" ] || texts=$((texts + 1))
	judge $number "$was" "$is" "$run"
done <"$work/old.sums" 3<"$work/new.sums"
[ -z "$text" ] || echo "$number texts, $texts the same"
echo "$number runs, $same the same, $excepted excepted, $others not"
[ $number -gt 0 ] && [ $others -eq 0 ]
