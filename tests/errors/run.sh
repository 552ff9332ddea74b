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
# RUNS=stdout or RUNS=files in the environment: only the one or the other (of a good case, to standard output).
# DEAR=skip: without the cases of dear.list, unless they are named. EVERY=N: of the others every N-th.
# The specs are named by their base name, so messages do not depend on where this runs. As little as can be is done by
# other programs, whose start costs more than a case.
set -u
here=$(cd "$(dirname "$0")" && pwd) || exit 99
plgen=$1
shift
case $plgen in /*) ;; *) plgen=$PWD/$plgen ;; esac
. "$here/../tap.sh"
runs=${RUNS:-both}
limit=''                # seconds for what should take a fraction of one
if command -v timeout >log; then
	limit='timeout 400'
fi
mkdir in out && cd in || exit 99
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

keep_files()
{
	echo "left as it was" >"$work/out/kept.c"
	echo "left as it was" >"$work/out/kept.h"
}

# is_kept FILE: nothing but the line that keep_files wrote
is_kept()
{
	[ -f "$1" ] && { read -r line && [ "$line" = "left as it was" ] && ! read -r line; } <"$1"
}

# run_onto_files ARGUMENT...: files that exist stay, and nothing comes beside them
run_onto_files()
{
	$limit "$plgen" -o "$work/out/kept.c" "$@" >"$work/stdout" 2>"$work/stderr" </dev/null
	status=$?
	[ "$status" -eq 1 ] || complain "with -o: exit status $status, expected 1"
	[ -s "$work/stdout" ] && complain "with -o: standard output is not empty"
	said_as_expected "with -o: "
	for file in "$work/out/kept.c" "$work/out/kept.h"; do
		is_kept "$file" || complain "with -o: ${file##*/} was changed"
	done
	for file in "$work/out"/* "$work/out"/.[!.]*; do
		case $file in
		*/kept.[ch] | *'/*' | *'/.[!.]*') ;;
		*) complain "with -o: ${file##*/} is left over" ;;
		esac
	done
	if [ -s "$work/complaints" ]; then
		rm -rf "$work/out" && mkdir "$work/out" && keep_files
	fi
}

# run_to_stdout ARGUMENT...
run_to_stdout()
{
	$limit "$plgen" "$@" >"$work/stdout" 2>"$work/stderr" </dev/null
	status=$?
	[ "$status" -eq "$wanted" ] || complain "exit status $status, expected $wanted"
	if [ "$wanted" -ne 0 ] && [ -s "$work/stdout" ]; then
		complain "standard output is not empty"
	fi
	if [ "$wanted" -eq 0 ] && ! [ -s "$work/stdout" ]; then
		complain "standard output is empty"
	fi
	said_as_expected ""
}

# said_as_expected WHEN
said_as_expected()
{
	if ! cmp -s "$path.expect" "$work/stderr"; then
		complain "$1standard error differs (- expected, + found)"
		diff -a -U 2 "$path.expect" "$work/stderr" | tail -n +3 >"$work/difference"
		as_text "$work/difference" >>"$work/complaints"
	fi
}

# folder_of_case: the current one, with the spec in it: that of the topic, or where the case has more, one of its own
folder_of_case()
{
	if [ -f "$path.spec" ] && ! [ -f "$path.args" ]; then
		cd "${path%/*}" || exit 99
		return
	fi
	cd "$work/in" || exit 99
	rm -rf ./*
	if [ -f "$path.sh" ]; then
		sh "$path.sh" >"$name.spec" || complain "$name.sh failed"
	elif [ -f "$path.spec" ]; then
		cp "$path.spec" .
	fi
	if [ -f "$path.mtx" ]; then
		cp "$path.mtx" .
	fi
}

# run_case PATH: of its expectation, without the ending
run_case()
{
	path=$1
	name=${path##*/}
	wanted=1
	: >"$work/complaints"
	if [ -f "$path.status" ]; then
		read -r wanted <"$path.status"
	fi
	folder_of_case
	set --
	if [ -f "$path.args" ]; then
		while IFS= read -r argument; do
			set -- "$@" "$argument"
		done <"$path.args"
	fi
	if [ -f "$name.spec" ]; then
		set -- "$@" "$name.spec"
	fi
	if [ "$wanted" -ne 1 ] || [ "$runs" != files ]; then
		run_to_stdout "$@"
	fi
	if [ "$wanted" -eq 1 ] && [ "$runs" != stdout ]; then
		run_onto_files "$@"
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

# left_out PATH: whether it is a case of dear.list, and those are not wanted
dear=' '
if [ "${DEAR:-}" = skip ] && [ $# -eq 0 ]; then
	while read -r line; do
		case $line in '#'*) continue ;; esac
		for expect in "$here"/*/"$line.expect"; do
			[ -f "$expect" ] || { echo "Bail out! no case $line, which dear.list names"; exit 99; }
		done
		dear="$dear$line "
	done <"$here/dear.list"
fi
place=0
left_out()
{
	case $dear in *" ${1##*/} "*) return 0 ;; esac
	place=$((place + 1))
	[ $((place % ${EVERY:-1})) -ne 0 ]
}

keep_files
[ $# -gt 0 ] || set -- '*/*'
for wanted_name in "$@"; do
	case $wanted_name in
	*/*) ;;
	*) if [ -d "$here/$wanted_name" ]; then wanted_name="$wanted_name/*"; else wanted_name="*/$wanted_name"; fi ;;
	esac
	for expect in "$here"/$wanted_name.expect; do
		[ -f "$expect" ] || { echo "Bail out! no topic or case $wanted_name in ${here##*/}"; exit 99; }
		left_out "${expect%.expect}" || run_case "${expect%.expect}"
	done
done
tap_end
