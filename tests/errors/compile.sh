#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
#
# compile.sh PLGEN RUNTIME FOLDER COMPILER...: the C of every good case (status 0, see run.sh) that prints C, as TAP: it
# compiles without a warning, whatever the names in its spec are. FOLDER is a topic, or the folder of all topics. Those
# of dear.list, and every second of the others, only with LONG=1 in the environment, but for those whose names are what
# matters.
set -u
plgen=$1
runtime=$2
folder=$(cd "$3" && pwd) || exit 1
shift 3
dear=$(cd "${0%/*}" && pwd)/dear.list
case $plgen in /*) ;; *) plgen=$PWD/$plgen ;; esac
case $runtime in /*) ;; *) runtime=$PWD/$runtime ;; esac
LC_ALL=C
export LC_ALL
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
mkdir "$work/in" && cd "$work/in" || exit 1

prints_c()      # PATH, without ending
{
	[ "$(cat "$1.status")" = 0 ] || return 1
	! [ -f "$1.args" ] || ! grep -q -e '^--explain' -e '^--solution' -e '^-h' -e '^--help' -e '^--version' "$1.args"
}

warnings='-Wall -Wextra -Wpedantic -Wconversion -Wdouble-promotion -Wshadow -Werror'
failed=0
number=0
place=0
for status in "$folder"/*.status "$folder"/*/*.status; do
	path=${status%.status}
	name=${path##*/}
	if ! [ -f "$status" ] || ! prints_c "$path" ||
	   { [ -z "${LONG:-}" ] && [ "$(basename "${path%/*}")" != names ] && grep -q -x -F "$name" "$dear"; }; then
		continue
	fi
	place=$((place + 1))
	if [ -z "${LONG:-}" ] && [ "$(basename "${path%/*}")" != names ] && [ $((place % 2)) -ne 0 ]; then
		continue
	fi
	number=$((number + 1))
	from=.                  # as run.sh: what has no files of its own stands beside those of its topic
	if [ -f "$path.sh" ]; then
		sh "$path.sh" > "$name.spec"
	elif [ -f "$path.args" ]; then
		cp "$path.spec" .
	else
		from=${path%/*}
	fi
	if [ -f "$path.mtx" ]; then
		cp "$path.mtx" .
	fi
	arguments=''            # one a line; a value may have blanks
	if [ -f "$path.args" ]; then
		arguments=$(cat "$path.args")
	fi
	# shellcheck disable=SC2086
	if (IFS='
'; cd "$from" && exec "$plgen" $arguments "$name.spec") > "$name.c" 2> "$work/messages" < /dev/null &&
	   "$@" -std=c99 $warnings -I"$runtime" -O0 -S "$name.c" -o /dev/null 2> "$work/messages"; then
		echo "ok $number - $name"
	else
		failed=$((failed + 1))
		echo "not ok $number - $name"
		head -n 20 "$work/messages" | cut -c 1-200 | tr '\000-\010\013-\037\177-\377' '?' | sed 's/^/# /'
	fi
	rm -f "$name".*
done
echo "1..$number"
[ "$failed" -eq 0 ]
