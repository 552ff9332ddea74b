# SPDX-License-Identifier: GPL-3.0-or-later
# awk -f csv.awk -f sorted.awk precision.csv: time, side, model, error, method of what did not fail in double, between
# tabs
NR == 1 { read_head($0, c); next }
{
	split_row($0, f)
	if (f[c["failed"]] != 1 && is_number(f[c["largest"]]) && f[c["ns_median"]] + 0 > 0 &&
	    !index(f[c["method"]], "float"))
		print f[c["ns_median"]] "\t" (f[c["family"]] == "ours" ? "ours" : "peer") "\t" f[c["model"]] "\t" \
			f[c["largest"]] + 0 "\t" f[c["method"]]
}
