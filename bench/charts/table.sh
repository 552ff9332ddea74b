#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# table.sh NAME [OPTION...] TABLE...: what a section of tables.txt, drawn.txt or findings.txt makes of tables, as their
# heads say; OPTION: of awk. A section is awk after csv.awk, for each row; `f`: its fields; `file`: the number of its
# table.
here=$(dirname "$0")
name=$1
shift
awk -v head="$name" '
	BEGIN {
		print "FNR == 1 { file++; split(\"\", column); columns = read_head($0, column); next }"
		print "{ split(\"\", f); split_row($0, f) }"
	}
	$1 == "===" { on = $2 == head || $2 == head ":"; next } on' "$here/tables.txt" "$here/drawn.txt" \
	"$here/findings.txt" |
	awk -f "$here/csv.awk" -f /dev/stdin "$@"
