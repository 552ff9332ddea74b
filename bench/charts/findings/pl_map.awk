# SPDX-License-Identifier: GPL-3.0-or-later
# of: pl_map.csv
NR == 1 { read_head($0, column); next }
# From the class f on it grows
{
	split($0, f, ",")
	classes = f[column["class_of_growth"]]
	all += length(classes)
	grows += gsub(/[f-k-]/, "", classes)
}
END {
	print "Scheme pl, its coupling held over a step, grows on undamped masses at " \
		(grows == all ? "every one" : grows) " of " all " steps and couplings tried"
}
