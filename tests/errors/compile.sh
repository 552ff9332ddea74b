#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
#
# compile.sh PLGEN RUNTIME FOLDER COMPILER...: the C of every good case of FOLDER (status 0, see run.sh) that prints C, as
# TAP: it compiles without a warning, whatever the names in its spec are.
set -u
plgen=$1
runtime=$2
folder=$(cd "$3" && pwd) || exit 1
shift 3
case $plgen in /*) ;; *) plgen=$PWD/$plgen ;; esac
case $runtime in /*) ;; *) runtime=$PWD/$runtime ;; esac
LC_ALL=C
export LC_ALL
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
mkdir "$work/in" && cd "$work/in" || exit 1

prints_c()      # NAME
{
	[ "$(cat "$folder/$1.status")" = 0 ] || return 1
	! [ -f "$folder/$1.args" ] || ! grep -q -e '^--explain' -e '^--solution' -e '^--help' -e '^--version' "$folder/$1.args"
}

names=''
count=0
for status in "$folder"/*.status; do
	name=${status##*/}
	name=${name%.status}
	if prints_c "$name"; then
		names="$names $name"
		count=$((count + 1))
	fi
done
echo "1..$count"

failed=0
number=0
for name in $names; do
	number=$((number + 1))
	if [ -f "$folder/$name.sh" ]; then
		sh "$folder/$name.sh" > "$name.spec"
	else
		cp "$folder/$name.spec" .
	fi
	if [ -f "$folder/$name.mtx" ]; then
		cp "$folder/$name.mtx" .
	fi
	arguments=''            # options and names without spaces
	if [ -f "$folder/$name.args" ]; then
		arguments=$(tr '\n' ' ' < "$folder/$name.args")
	fi
	if "$plgen" $arguments "$name.spec" > "$name.c" 2> "$work/messages" < /dev/null &&
	   "$@" -std=c99 -Wall -Wextra -Wpedantic -Wconversion -Wdouble-promotion -Wshadow -Werror -I"$runtime" -c "$name.c" -o "$name.o" 2> "$work/messages"; then
		echo "ok $number - $name"
	else
		failed=$((failed + 1))
		echo "not ok $number - $name"
		head -n 20 "$work/messages" | cut -c 1-200 | tr '\000-\010\013-\037\177-\377' '?' | sed 's/^/# /'
	fi
	rm -f "$name".*
done
[ "$failed" -eq 0 ]
