#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
#
# run.sh PLGEN [NAME...]: cases as TAP; NAME is a topic, which is a folder beside this script, or a case, or a pattern
# of cases ('load_change_*'). Without names: every case of every topic. A case is files in the folder of its topic:
#   NAME.expect   standard error, in full (empty: nothing may be said)
#   NAME.spec     the spec, or
#   NAME.sh       what prints it, where bytes matter or it would be long; without both, NAME.args says all
#   NAME.mtx      a data file, copied beside the spec
#   NAME.args     options, one a line; the spec comes last
#   NAME.status   exit status, where it is not 1
# Each is run twice: to standard output, which must stay empty; and with -o, where an existing file must stay as it was.
# The specs are named by their base name, so messages do not depend on where this runs.
set -u
here=$(cd "$(dirname "$0")" && pwd) || exit 99
plgen=$1
shift
case $plgen in /*) ;; *) plgen=$PWD/$plgen ;; esac
. "$here/../tap.sh"
limit=''                # seconds for what should take a fraction of one
if command -v timeout >log; then
	limit='timeout 400'
fi
mkdir in && cd in || exit 99
ulimit -s 256           # KiB: what the limits allow needs no more of the stack that a program starts with

# as_text FILE: as comments, shortened, in ASCII
as_text()
{
	head -n 40 "$1" | cut -c 1-200 | tr '\000-\010\013-\037\177-\377' '?' | sed 's/^/#   /'
}

complain()
{
	echo "# $name: $1" >>"$work/complaints"
}

# run_again ARGUMENT...: onto files that exist
run_again()
{
	mkdir "$work/out"
	echo "left as it was" | tee "$work/out/kept.c" >"$work/out/kept.h"
	$limit "$plgen" -o "$work/out/kept.c" "$@" >"$work/stdout" 2>"$work/again" </dev/null
	status=$?
	[ "$status" -eq 1 ] || complain "with -o: exit status $status, expected 1"
	[ -s "$work/stdout" ] && complain "with -o: standard output is not empty"
	cmp -s "$work/stderr" "$work/again" || complain "with -o: other messages than without"
	for file in "$work/out/kept.c" "$work/out/kept.h"; do
		[ "$(cat "$file" 2>&1)" = "left as it was" ] || complain "with -o: ${file##*/} was changed"
	done
	[ "$(ls -A "$work/out" | wc -l)" -eq 2 ] ||
		complain "with -o: files are left over: $(ls -A "$work/out" | tr '\n' ' ')"
}

# run_case PATH: of its expectation, without the ending
run_case()
{
	path=$1
	name=${path##*/}
	wanted=1
	: >"$work/complaints"
	rm -rf "$work/in/"* "$work/out"
	if [ -f "$path.status" ]; then
		read -r wanted <"$path.status"
	fi
	if [ -f "$path.sh" ]; then
		sh "$path.sh" >"$name.spec" || complain "$name.sh failed"
	elif [ -f "$path.spec" ]; then
		cp "$path.spec" .
	fi
	if [ -f "$path.mtx" ]; then
		cp "$path.mtx" .
	fi
	set --
	if [ -f "$path.args" ]; then
		while IFS= read -r argument; do
			set -- "$@" "$argument"
		done <"$path.args"
	fi
	if [ -f "$name.spec" ]; then
		set -- "$@" "$name.spec"
	fi

	$limit "$plgen" "$@" >"$work/stdout" 2>"$work/stderr" </dev/null
	status=$?
	[ "$status" -eq "$wanted" ] || complain "exit status $status, expected $wanted"
	if [ "$wanted" -ne 0 ] && [ -s "$work/stdout" ]; then
		complain "standard output is not empty"
	fi
	if [ "$wanted" -eq 0 ] && ! [ -s "$work/stdout" ]; then
		complain "standard output is empty"
	fi
	if ! cmp -s "$path.expect" "$work/stderr"; then
		complain "standard error differs (- expected, + found)"
		diff -a -U 2 "$path.expect" "$work/stderr" | tail -n +3 >"$work/difference"
		as_text "$work/difference" >>"$work/complaints"
	fi
	if [ "$wanted" -eq 1 ]; then
		run_again "$@"
	fi

	count=$((count + 1))
	if [ -s "$work/complaints" ]; then
		failed=1
		echo "not ok $count - $name"
		cat "$work/complaints"
	else
		echo "ok $count - $name"
	fi
}

[ $# -gt 0 ] || set -- '*/*'
for wanted_name in "$@"; do
	case $wanted_name in
	*/*) ;;
	*) if [ -d "$here/$wanted_name" ]; then wanted_name="$wanted_name/*"; else wanted_name="*/$wanted_name"; fi ;;
	esac
	for expect in "$here"/$wanted_name.expect; do
		[ -f "$expect" ] || { echo "Bail out! no topic or case $wanted_name in ${here##*/}"; exit 99; }
		run_case "${expect%.expect}"
	done
done
tap_end
