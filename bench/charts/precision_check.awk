# SPDX-License-Identifier: GPL-3.0-or-later
# awk -f csv.awk -f precision_check.awk precision.csv: of each model how many of its times (ns_median) are within 10
# percent of one more pass through the whole history, taken by itself (ns_pass), and which of them is farthest from it.
NR == 1 { read_head($0, column); print "model,times,within_10_percent,farthest_percent,method,setting"; next }
{
	split("", row)
	split_row($0, row)
	model = row[column["model"]]; median = row[column["ns_median"]]; pass = row[column["ns_pass"]]
	if (!is_number(median) || !is_number(pass)) next
	if (!(model in times)) models[++count] = model
	off = 100 * (median / pass - 1)
	size = off < 0 ? -off : off
	times[model]++
	if (size <= 10) within[model]++
	if (!(model in farthest) || size > farthest[model]) {
		farthest[model] = size
		of[model] = sprintf("%.1f,\"%s\",%s", off, row[column["method"]], row[column["setting"]])
	}
}
END {
	for (m = 1; m <= count; m++)
		printf "%s,%d,%d,%s\n", models[m], times[models[m]], within[models[m]], of[models[m]]
}
