# SPDX-License-Identifier: GPL-3.0-or-later
# awk -F, -v name=METHOD [-v ylog=1] -f cells.awk MAP.csv: of a map of letters (classes.awk) the cells of one method,
# for gnuplot: log10 w h, what it is over (with ylog log10 of it), the class from 0 on; a cell without a number is NaN.
$1 == name {
	y = ylog ? log($2) / log(10) : $2
	for (i = 1; i <= length($5); i++) {
		class = index("abcdefghijklmnopqrstuvwxyz", substr($5, i, 1)) - 1
		printf "%.6g,%.6g,%s\n", (log($3) + (i - 1) * log($4)) / log(10), y, class < 0 ? "NaN" : class
	}
}
