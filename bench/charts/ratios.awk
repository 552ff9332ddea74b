# SPDX-License-Identifier: GPL-3.0-or-later
# awk -f csv.awk -f ratios.awk plmap_raw.csv: log10 of the ratio of errors over the grid, a row of it a line, in
# hundredths and within 4 decades; -: both are off by more than half the initial displacement, so there is nothing to
# compare.
function beyond(error) { return !is_number(error) || error + 0 > 0.5 }
function unload(    k, i) {
	for (k = 1; k <= maps; k++) {
		printf "%s,%s,%.6g,%s\n", map[k], first, (last / first) ^ (1 / (count[k] - 1)), substr(cells[k], 2)
		count[k] = 0; cells[k] = ""
	}
	maps = 0; split("", number)
}
NR == 1 {
	read_head($0, c)
	print "layout,periods,coupling_k2_over_k1,first_wh,ratio_of_wh,log10_ratio_pl_over_RK4"
	next
}
{
	split_row($0, f)
	if (f[c["coupling_k2_over_k1"]] != coupling) {
		unload()
		coupling = f[c["coupling_k2_over_k1"]]; first = f[c["w_h"]]
	}
	last = f[c["w_h"]]
	key = f[c["layout"]] "," f[c["periods"]] "," coupling
	if (!(key in number)) { number[key] = ++maps; map[maps] = key }
	k = number[key]
	ratio = f[c["ratio_pl_over_RK4"]]
	if (beyond(f[c["error_pl"]]) && beyond(f[c["error_RK4"]])) text = "-"
	else {
		r = is_number(ratio) ? log(ratio) / log(10) : ratio == "none" ? "-" : 4
		text = r == "-" ? r : sprintf("%.2f", r > 4 ? 4 : r < -4 ? -4 : r) + 0
	}
	count[k]++
	cells[k] = cells[k] " " text
}
END { unload() }
