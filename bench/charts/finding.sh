#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# finding.sh NAME FOLDER [COLUMNS]: what the picture NAME shows, a sentence made of the tables in FOLDER by
# findings/NAME.awk, or that of the longest beginning of NAME that has one; in lines of COLUMNS. The comment `# of:` in
# it names the tables. Nothing where there is no such file, or a table is missing.
set -e
name=$1 folder=$2 columns=${3:-10000}
here=$(dirname "$0")
rest=$name
while [ ! -f "$here/findings/$rest.awk" ]; do
	case $rest in
		*_*) rest=${rest%_*} ;;
		*) exit 0 ;;
	esac
done
program=$here/findings/$rest.awk
tables=
for table in $(sed -n 's/^# of: //p' "$program"); do
	[ -f "$folder/$table" ] || exit 0
	tables="$tables $folder/$table"
done
# shellcheck disable=SC2086
awk -v name="$name" -f "$here/csv.awk" -f "$here/words.awk" -f "$program" $tables | fold -s -w "$columns" |
	sed 's/ *$//'
