# SPDX-License-Identifier: GPL-3.0-or-later
# of: needs.csv
# Of each scene what the choice costs, of the cheapest in double and of all modes that meets the need.
NR == 1 { read_head($0, column); next }
{
	split("", row)
	split_row($0, row)
	scene = row[column["scene"]]; cost = row[column["cost"]] + 0
	if (!(scene in seen)) scenes[++count] = scene
	seen[scene] = 1
	if (row[column["taken"]] == "true") taken[scene] = cost
	if (row[column["real"]] == "double" && row[column["modes"]] ~ /^(all)?$/ &&
	    row[column["error_over_need"]] + 0 <= 1 && (!(scene in whole) || cost < whole[scene])) whole[scene] = cost
}
END {
	for (i = 1; i <= count; i++) {
		name = scenes[i]
		gsub(/_/, " ", name)
		text = text (i > 1 ? ", " : "") name " " sprintf("%.0f of %.0f", taken[scenes[i]], whole[scenes[i]])
	}
	print "As exact as needed, and no more: " text " operations"
}
