# SPDX-License-Identifier: GPL-3.0-or-later
# awk -v bounds='-0.9 -0.1 0.1 1' -f classes.awk MAP_raw.csv: method,wh,ACROSS,rho,growth over a grid, w h rising in
# each row by one ratio, as a row of the grid a line: a letter a cell, a for a growth of at most the first bound, b for
# one of at most the second and so on; -: a cell without a number.
function letter(growth,    i, class) {
	if (growth == "inf") return substr(letters, count + 1, 1)
	if (growth !~ /^[-+0-9.]/) return "-"
	for (i = 1; i <= count; i++) class += growth + 0 > bound[i] + 0
	return substr(letters, class + 1, 1)
}
function unload() {
	if (classes != "")
		printf "%s,%s,%s,%.6g,%s\n", method, across, first, (last / first) ^ (1 / (length(classes) - 1)),
			classes
	classes = ""
}
BEGIN { FS = ","; letters = "abcdefghijklmnopqrstuvwxyz"; count = split(bounds, bound, " ") }
NR == 1 { print $1 "," $3 ",first_wh,ratio_of_wh,class_of_growth"; next }
{
	if ($1 != method || $3 != across) { unload(); method = $1; across = $3; first = $2 }
	last = $2
	classes = classes letter($5)
}
END { unload() }
