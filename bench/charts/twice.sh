#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# twice.sh BUILD FOLDER [--quick] [JOB...]: what measures no time (untimed.sh), or these jobs of it, made two times from
# nothing, in FOLDER/first and FOLDER/second: every table and all errors are to be equal byte for byte. A line for each
# that differs, and then the exit status is 1. Run at the top of the source tree.
set -e
build=$1 folder=$2
shift 2
if [ -e "$folder" ] && ! [ -d "$folder/first" ]; then
	echo "twice.sh: $folder is there, and not from here" >&2
	exit 1
fi
rm -rf "$folder"
for time in first second; do
	sh bench/charts/untimed.sh "$build" "$folder/$time" "$@"
done

tables() {
	(cd "$folder/$1" && find . -name '*.csv' -o -name '*.errors' -o -name settings) | sort
}
tables first >"$folder/tables"
tables second >"$folder/tables_again"
bad=0
cmp "$folder/tables" "$folder/tables_again" || bad=1
[ -s "$folder/tables" ] || { echo 'twice.sh: there is no table'; bad=1; }
while read -r table; do
	cmp "$folder/first/$table" "$folder/second/$table" || bad=1
done <"$folder/tables"
[ $bad -ne 0 ] || echo "$(wc -l <"$folder/tables") tables without times: the same bytes twice"
exit $bad
