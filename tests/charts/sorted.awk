# SPDX-License-Identifier: GPL-3.0-or-later
# awk -f csv.awk -f sorted.awk precision.csv: time, side, model, error, method of what did not fail in double, between
# tabs
NR == 1 { read_head($0, c); next }
{
	split_row($0, f)
	split(f[c["ns_median"]], ns, " ")
	for (i = split(f[c["largest"]], error, " "); i > 0; i--)
		if (is_number(error[i]) && ns[i] + 0 > 0 && !index(f[c["method"]], "float"))
			print ns[i] "\t" (f[c["family"]] == "ours" ? "ours" : "peer") "\t" f[c["model"]] "\t" \
				error[i] + 0 "\t" f[c["method"]]
}
