# SPDX-License-Identifier: GPL-3.0-or-later
# awk -f csv.awk -f exact.awk precision_raw.csv: on scs every form of exact in double that plgen does not refuse
NR == 1 { read_head($0, column); next }
{
	split("", row)
	split_row($0, row)
	method = row[column["method"]]; value = row[column["largest"]]
	if (row[column["model"]] != "scs" || method !~ /^exact/ || method ~ /float/ || value == "refused") next
	count++
	if (!is_number(value) || value + 0 > 1e-11) {
		print method " on scs: found " value ", expected 0, tolerance 1e-11"
		bad = 1
	}
}
END {
	if (count == 0) { print "no exact form on scs"; bad = 1 }
	exit bad
}
