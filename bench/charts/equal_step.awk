# SPDX-License-Identifier: GPL-3.0-or-later
# awk -v palette=palette.list -f csv.awk -f equal_step.awk headline_equal_step.csv: gnuplot for a chart with a row for
# each method, the quickest first, and panels: time, error, drift of the energy; `rows`, `tics` (the methods), `blank`
# (without names), and panel(k), what to plot of it.
BEGIN {
	while ((getline line < palette) > 0)
		if (split(line, part, " ") > 1) colour[part[1]] = part[2]
}
NR == 1 { read_head($0, column); next }
{
	split_row($0, f)
	if (!is_number(f[column["ns_median"]])) next
	method[++rows] = f[column["method"]]; ours[rows] = f[column["family"]] == "ours"
	time[rows] = f[column["ns_median"]] + 0; error[rows] = f[column["error"]]
	drift[rows] = f[column["energy_drift_long"]] + 0
	if (drift[rows] < 0) drift[rows] = -drift[rows]
}
END {
	for (k = 1; k <= rows; k++) {
		at = 1
		for (i = 1; i <= rows; i++) at += time[i] < time[k] || (time[i] == time[k] && i < k)
		tics = tics (k > 1 ? ", " : "") "\"" method[k] "\" " at
		blank = blank (k > 1 ? ", " : "") "\"\" " at
		side = ours[k] ? "ours" : "peers"
		block[side] = block[side] time[k] "," error[k] "," drift[k] "," at "\n"
	}
	printf "$ours << EOD\n%sEOD\n$peers << EOD\n%sEOD\n", block["ours"], block["peers"]
	printf "rows = %d\ntics = '%s'\nblank = '%s'\n", rows, tics, blank
	printf "panel(k) = sprintf(\"$peers using %%d:4 with points pt 6 ps 1.1 lw 1.8 lc rgb '%s' notitle, $ours " \
		"using %%d:4 with points pt 7 ps 1.2 lc rgb '%s' notitle\", k, k)\n", colour["matrix"], colour["exact"]
}
