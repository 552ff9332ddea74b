#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# finding.sh NAME FOLDER [COLUMNS]: what the picture NAME shows, a sentence made of the tables in FOLDER by its section
# of findings.txt, or that of the longest beginning of NAME that has one; in lines of COLUMNS. Nothing where there is
# no such section, or a table is missing.
set -e
name=$1 folder=$2 columns=${3:-10000}
here=$(dirname "$0")
rest=$name
until said=$(grep "^=== $rest:" "$here/findings.txt"); do
	case $rest in
		*_*) rest=${rest%_*} ;;
		*) exit 0 ;;
	esac
done
tables=
for table in ${said#*: }; do
	[ -f "$folder/$table" ] || exit 0
	tables="$tables $folder/$table"
done
# shellcheck disable=SC2086
sh "$here/table.sh" "$rest" -v name="$name" $tables | fold -s -w "$columns" | sed 's/ *$//'
