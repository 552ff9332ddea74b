#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# texts.sh OLD NEW: do two builds of plgen say the same, byte for byte?  C, header, --explain, --solution of every
# model and every spec of the tests under the options below, and what is said of every case of tests/errors: exit
# status, standard output and standard error. OLD or NEW may be a file of sums that `texts.sh PLGEN >SUMS` has written
# before. Ends with a line that counts; lists what differs.  CASES is the program of tests/errors, where it is not that
# of build/.
set -u
tests=$(cd "$(dirname "$0")" && pwd)
cases=${CASES:-$tests/../build/tests/errors/cases}
work=$(mktemp -d "${TMPDIR:-/tmp}/plgen.XXXXXX") || exit 99
trap 'rm -rf "$work"' EXIT
trap 'exit 99' HUP INT TERM

# Of every spec
each='--header
--header --rhs
--explain
--explain=json
--solution 2
--rhs
--rhs --real float
--form direct
--form delta
--form delta --accuracy compensated
--form kick-drift-kick --real float
--scheme pl
--scheme etd1 --loads remainder
--scheme etdrk4
--scheme bm3 --rhs --real float
--reduce --prefix small
--selftest
--step 1/100 --selftest --real float'

commands() {
	find "$tests" -name specs.cases -o -name orders.cases -o -name linear.cases -o -name regions.cases \
		-o -name contacts.cases | while IFS= read -r file; do
		folder=$work/specs/$(echo "${file#"$tests/"}" | tr / _)
		mkdir -p "$folder" && awk -v into="$folder/" -f "$tests/cases.awk" "$file" >"$folder/names"
	done
	find "$tests/../models" "$tests" "$work/specs" -name '*.spec' | grep -v '/errors/' | LC_ALL=C sort |
		while IFS= read -r spec; do
		printf '%s\n' "$each" | while IFS= read -r options; do
			printf '%s|%s|%s\n' "${spec%/*}" "${spec##*/}" "$options"
		done
	done
	mkdir "$work/cases" && "$cases" --write "$work/cases" || exit 99
	for folder in "$work/cases"/*/*; do
		printf '%s|%s|=\n' "$folder" "${folder##*/}"
	done
}

# one: a line of `commands` for "$1", the generator, to its sum
cat >"$work/one.sh" <<'END'
plgen=$1
folder=${2%%|*}
rest=${2#*|}
spec=${rest%%|*}
options=${rest#*|}
here=$(mktemp -d "$3/XXXXXX") || exit 1
if [ "$options" = '=' ]; then
	cd "$folder" || exit 1
	set --
	while IFS= read -r argument; do
		set -- "$@" "$argument"
	done <"$spec.args"
	[ -f "$spec.spec" ] && set -- "$@" "$spec.spec"
	timeout 600 "$plgen" "$@" >"$here/said" 2>"$here/told" </dev/null
else
	cd "$folder" || exit 1
	# shellcheck disable=SC2086
	timeout 600 "$plgen" $options "$spec" >"$here/said" 2>"$here/told" </dev/null
fi
echo "status $?" >>"$here/told"
echo "$(cat "$here/said" "$here/told" | sha256sum | cut -c 1-24) $spec $options"
rm -rf "$here"
END

sums() {
	if [ -x "$1" ]; then
		plgen=$(realpath "$1")
		mkdir -p "$work/runs"
		xargs -d '\n' -P "$(nproc)" -I '{}' sh "$work/one.sh" "$plgen" '{}' "$work/runs" <"$work/commands" |
			LC_ALL=C sort -k 2 >"$2"
	else
		cp "$1" "$2"
	fi
}

commands >"$work/commands"
if [ $# -eq 1 ]; then
	sums "$1" /dev/stdout
	exit 0
fi
[ $# -eq 2 ] || { echo 'usage: texts.sh OLD NEW, or texts.sh PLGEN' >&2; exit 2; }
sums "$1" "$work/old"
sums "$2" "$work/new"
for side in old new; do
	LC_ALL=C sort "$work/$side" >"$work/$side.sorted"
done
LC_ALL=C comm -13 "$work/old.sorted" "$work/new.sorted" >"$work/differ"
cut -d ' ' -f 2- "$work/differ" | head -n 50
count=$(wc -l <"$work/new")
differ=$(wc -l <"$work/differ")
echo "$count outputs, $differ differ"
[ "$count" -gt 0 ] && [ "$differ" -eq 0 ] && [ "$count" -eq "$(wc -l <"$work/old")" ]
