# SPDX-License-Identifier: GPL-3.0-or-later
# of: operator_map.csv
# How much of the map grows, with each scheme
NR == 1 { read_head($0, column); next }
{
	split($0, f, ",")
	m = f[1]
	if (!(m in all)) order[++methods] = m
	classes = f[column["class_of_growth"]]
	all[m] += length(classes)
	grows[m] += gsub(/[g-k-]/, "", classes)         # above 1e-6
}
END {
	for (i = 1; i <= methods; i++)
		text = text (i > 1 ? ", " : "") order[i] sprintf(" %.0f %%", 100 * grows[order[i]] / all[order[i]])
	print "With a wrong linear operator schemes grow, on the part of this map: " text
}
