#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
#
# run.sh PLGEN FOLDER: every case of FOLDER, as TAP. A case is dropped files:
#   NAME.expect   standard error, in full (empty: nothing may be said)
#   NAME.spec     the spec, or
#   NAME.sh       what prints it, where bytes matter or it would be long; without both, NAME.args says all
#   NAME.mtx      a data file, copied beside the spec
#   NAME.args     options, one a line; the spec comes last
#   NAME.status   exit status, where it is not 1
# Each is run twice: to standard output, which must stay empty; and with -o, where an existing file must stay as it was.
# The specs are named by their base name, so messages do not depend on where this runs.
set -u
plgen=$1
folder=$(cd "$2" && pwd) || exit 1
case $plgen in /*) ;; *) plgen=$PWD/$plgen ;; esac
LC_ALL=C
export LC_ALL
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
limit=''                # seconds for what should take a fraction of one
if command -v timeout > "$work/path" 2>&1; then
	limit='timeout 20'
fi
mkdir "$work/in" && cd "$work/in" || exit 1
ulimit -s 256           # KiB: what the limits allow needs no more of the stack that a program starts with

count=0
for expect in "$folder"/*.expect; do
	count=$((count + 1))
done
echo "1..$count"

# comment TEXT-FILE: as TAP comments, shortened, in ASCII
comment()
{
	head -n 40 "$1" | cut -c 1-200 | tr '\000-\010\013-\037\177-\377' '?' | sed 's/^/#   /'
}

complain()
{
	good=false
	echo "# $name: $1" >> "$work/complaints"
}

# check_case NAME: sets `good`
check_case()
{
	name=$1
	good=true
	wanted=1
	: > "$work/complaints"
	rm -rf "$work/in/"* "$work/out"
	if [ -f "$folder/$name.status" ]; then
		read -r wanted < "$folder/$name.status"
	fi
	if [ -f "$folder/$name.sh" ]; then
		sh "$folder/$name.sh" > "$name.spec" || complain "$name.sh failed"
	elif [ -f "$folder/$name.spec" ]; then
		cp "$folder/$name.spec" .
	fi
	if [ -f "$folder/$name.mtx" ]; then
		cp "$folder/$name.mtx" .
	fi
	set --
	if [ -f "$folder/$name.args" ]; then
		while IFS= read -r argument; do
			set -- "$@" "$argument"
		done < "$folder/$name.args"
	fi
	if [ -f "$name.spec" ]; then
		set -- "$@" "$name.spec"
	fi

	$limit "$plgen" "$@" > "$work/stdout" 2> "$work/stderr" < /dev/null
	status=$?
	[ "$status" -eq "$wanted" ] || complain "exit status $status, expected $wanted"
	if [ "$wanted" -ne 0 ] && [ -s "$work/stdout" ]; then
		complain "standard output is not empty"
	fi
	if [ "$wanted" -eq 0 ] && ! [ -s "$work/stdout" ]; then
		complain "standard output is empty"
	fi
	if ! cmp -s "$folder/$name.expect" "$work/stderr"; then
		complain "standard error differs (- expected, + found)"
		diff -a -U 2 "$folder/$name.expect" "$work/stderr" | tail -n +3 > "$work/difference"
		comment "$work/difference" >> "$work/complaints"
	fi

	# Again, onto files that exist.
	if [ "$wanted" -eq 1 ]; then
		mkdir "$work/out"
		echo "left as it was" | tee "$work/out/kept.c" > "$work/out/kept.h"
		$limit "$plgen" -o "$work/out/kept.c" "$@" > "$work/stdout" 2> "$work/again" < /dev/null
		status=$?
		[ "$status" -eq 1 ] || complain "with -o: exit status $status, expected 1"
		[ -s "$work/stdout" ] && complain "with -o: standard output is not empty"
		cmp -s "$work/stderr" "$work/again" || complain "with -o: other messages than without"
		for file in "$work/out/kept.c" "$work/out/kept.h"; do
			[ "$(cat "$file" 2>&1)" = "left as it was" ] || complain "with -o: ${file##*/} was changed"
		done
		[ "$(ls -A "$work/out" | wc -l)" -eq 2 ] || complain "with -o: files are left over: $(ls -A "$work/out" | tr '\n' ' ')"
	fi
}

failed=0
number=0
for expect in "$folder"/*.expect; do
	number=$((number + 1))
	case_name=${expect##*/}
	check_case "${case_name%.expect}"
	if $good; then
		echo "ok $number - $name"
	else
		failed=$((failed + 1))
		echo "not ok $number - $name"
		cat "$work/complaints"
	fi
done
[ "$failed" -eq 0 ]
