# SPDX-License-Identifier: GPL-3.0-or-later
# awk -f csv.awk -f refused.awk: of lines of own.csv with what plgen refuses, the reason, once a method
{
	split("", row)
	n = split_row($0, row)
	if (!(row[1] in seen)) print "refused: " row[1] ": " row[n]
	seen[row[1]] = 1
}
