# SPDX-License-Identifier: GPL-3.0-or-later
# awk -F, -v name=METHOD -v x=COLUMN -v y=COLUMN -v value=COLUMN -v bounds='-0.5 -1e-12 1e-12 0.5' [-v ylog=1] -f
# cells.awk MAP.csv A map over a regular grid as boxes for gnuplot: the value becomes the number of bounds below it,
# and cells of a row that have the same number become one box: x0,x1,y0,y1,number.  x is drawn as log10 x, y too with
# ylog.  A cell without a number: -1. Rows come as the programs write them: one y after the other, x rising in each.

function flush_row(    i, first) {
	if (cells == 0) return
	half = cells > 1 ? (at[2] - at[1])/2 : 0.5
	for (first = 1; first <= cells; first = i + 1) {
		for (i = first; i < cells && class[i + 1] == class[first]; i++) ;
		# drawn over the next one a little: no seams
		row[++rows] = sprintf("%.6g,%.6g", at[first] - half, at[i] + 1.1*half) 
		row_y[rows] = where; row_class[rows] = class[first]
	}
	lines++; line_y[lines] = where
	cells = 0
}
BEGIN {
	count = split(bounds, bound, " ")
	for (i = 1; i <= count; i++) bound[i] += 0
}
NR == 1 {
	for (i = 1; i <= NF; i++) column[$i] = i
	if (!(x in column) || !(y in column) || !(value in column)) {
		print "cells.awk: no column " x ", " y " or " value > "/dev/stderr"; exit 1 }
	next
}
$1 == name {
	here = ylog ? log($column[y])/log(10) : $column[y] + 0
	if (lines + cells > 0 && here != where) flush_row()
	where = here
	at[++cells] = log($column[x])/log(10)
	class[cells] = -1
	if ($column[value] ~ /^[-+0-9.]/) {
		class[cells] = 0
		for (i = 1; i <= count; i++)
			if ($column[value] + 0 > bound[i]) class[cells] = i
	} else if ($column[value] == "inf") class[cells] = count
}
END {
	flush_row()
	half = lines > 1 ? (line_y[2] - line_y[1])/2 : 0.5
	for (i = 1; i <= rows; i++)
		printf "%s,%.6g,%.6g,%d\n", row[i], row_y[i] - half, row_y[i] + 1.3*half, row_class[i]
}
