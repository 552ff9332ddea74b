#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# What plgen emits compiles without a warning, beside its header, as C99 and as C++17, by gcc, g++, clang or
# clang++ by turns: of ../same/runs.list the first model of each folder, and of each kind, which is a heading of the
# list, the first with each option. With MERGE=1 all; with LONG=1 all by all, and with code by
# gcc, whose optimiser warns too.
#
#     warnings.sh PLGEN SOURCE_ROOT
#
# The compilers are those of GCCS and CLANGS (default: gcc g++, clang clang++); what is not installed is skipped.
set -u
plgen=$(realpath "$1")
root=$(realpath "$2")
. "$root/tests/compilers.sh"
warnings="$warnings -Wcast-qual"
. "$root/tests/tap.sh"
. "$root/tests/same/run.sh"

languages >compilers

# Lines NUMBER; RUN, the kind by its number: all, or those whose folder, or whose options of that kind, no line before
# has
awk -F ' *; *' -v all="$(merging && echo yes)" '
	NR > 1 && /^#/ { kind++; next }
	{
		folder = $1
		sub(/\/[^\/]*$/, "", folder)
		for (i = 2; i <= NF; i++) {
			fresh = !seen[folder]++
			options = split($i, option, /--/)
			for (k = 1 + (options > 1); k <= options; k++)
				fresh += !seen[kind, option[k]]++
			if (all || fresh)
				print kind "; " $1 ($i == "-" ? "" : " " $i)
		}
	}' "$root/tests/same/runs.list" >chosen

# effort COMPILER: what it makes of a file; what is unused gcc says of the same text
effort() {
	case $1 in
		gcc) long && echo '-O1 -c -o object.o' || without_code "$1" ;;
		g++) merging && without_code "$1" || echo '-fsyntax-only' ;;
		*) without_code "$1" ;;
	esac
}

# compiled FILE NAME: by the compilers of `some`
compiled() {
	while read -r compiler options; do
		if ! command -v "$compiler" >log 2>&1; then
			skip "$2, $compiler" "$compiler is not installed"
			continue
		fi
		# shellcheck disable=SC2046,SC2086
		$compiler $warnings -I"$root/runtime" -I. $(effort "$compiler") $options "$1" >log 2>&1
		result $? "$2, $compiler"
	done <some
}

# A file for each kind, or with MERGE=1 for each run; the header stands alone, and twice
number=0
while read -r line; do
	run=${line#*; }
	spec=${run%% *}
	number=$((number + 1))
	name=model$number
	path=$(path_of "$spec")
	if ! eval "\"\$plgen\" --prefix $name ${run#"$spec"} -o $name.c \"\$path\"" >log 2>&1; then
		result 1 "$run: made"
		continue
	fi
	file=kind${line%%; *}.c
	! merging || file=one.c
	! merging || rm -f one.c
	printf '#include "%s"\n' $name.h $name.h $name.c >>$file
	if merging; then
		by_turns compilers >some
		compiled one.c "$run"
	fi
done <chosen
for file in kind*.c; do
	[ -e "$file" ] || continue
	number=${file#kind}
	by_turns compilers >some
	title=$(sed -n "s/^# \([^:,]*\).*/\1/p" "$root/tests/same/runs.list" | sed 1d | sed -n "${number%.c}p")
	compiled "$file" "$title: $(grep -c "^${number%.c}; " chosen) models with options"
done
tap_end
