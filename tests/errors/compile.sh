#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
#
# compile.sh PLGEN CASES RUNTIME COMPILER...: the C of every good case (status 0, see cases.c) that prints C, as TAP: it
# compiles without a warning, whatever the names in its spec are. Those about names; with MERGE=1 in the environment
# every second of the others but those of dear.list too, with LONG=1 all.
set -u
plgen=$(realpath "$1")
cases=$(realpath "$2")
runtime=$(realpath "$3")
shift 3
dear=$(cd "${0%/*}" && pwd)/dear.list
LC_ALL=C
export LC_ALL
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
topics=names
[ -z "${LONG:-}${MERGE:-}" ] || topics=
# shellcheck disable=SC2086
mkdir "$work/cases" "$work/out" && "$cases" --write "$work/cases" $topics && cd "$work/out" || exit 1

prints_c()      # PATH, without ending
{
	[ "$(cat "$1.status")" = 0 ] || return 1
	! grep -q -e '^--explain' -e '^--solution' -e '^-h' -e '^--help' -e '^--version' "$1.args"
}

# Of what is only written for a later optimiser gcc says all that it says of code, in half of the time.
unwritten='-O0 -S -o /dev/null'
if [ -z "${LONG:-}" ] && "$@" --version 2>/dev/null | grep -q 'Free Software'; then
	unwritten="$unwritten -flto -fno-fat-lto-objects"
fi
warnings='-Wall -Wextra -Wpedantic -Wconversion -Wdouble-promotion -Wshadow -Werror'
failed=0
number=0
place=0
for folder in "$work/cases"/*/*; do
	name=${folder##*/}
	topic=${folder%/*}
	topic=${topic##*/}
	if ! prints_c "$folder/$name" ||
	   { [ -z "${LONG:-}" ] && [ "$topic" != names ] && grep -q -x -F "$name" "$dear"; }; then
		continue
	fi
	place=$((place + 1))
	if [ -z "${LONG:-}" ] && [ "$topic" != names ] && [ $((place % 2)) -ne 0 ]; then
		continue
	fi
	number=$((number + 1))
	arguments=$(cat "$folder/$name.args")   # one a line; a value may have blanks
	# shellcheck disable=SC2086
	if (IFS='
'; cd "$folder" && exec "$plgen" $arguments "$name.spec") > "$name.c" 2> "$work/messages" < /dev/null &&
	   "$@" -std=c99 $warnings -I"$runtime" $unwritten "$name.c" 2> "$work/messages"; then
		echo "ok $number - $name"
	else
		failed=$((failed + 1))
		echo "not ok $number - $name"
		head -n 20 "$work/messages" | cut -c 1-200 | tr '\000-\010\013-\037\177-\377' '?' | sed 's/^/# /'
	fi
	rm -f "$name.c"
done
echo "1..$number"
[ "$failed" -eq 0 ]
