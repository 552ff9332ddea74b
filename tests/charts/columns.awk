# SPDX-License-Identifier: GPL-3.0-or-later
# awk -v without='^ns_' -f csv.awk -f columns.awk FILE.csv: the file without the columns whose names match
NR == 1 { read_head($0, column) }
{
	split("", row)
	n = split_row($0, row)
	for (name in column) if (name ~ without) row[column[name]] = "-"
	for (i = 1; i <= n; i++) printf "%s%s", row[i], i < n ? "," : "\n"
}
