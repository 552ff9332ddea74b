# SPDX-License-Identifier: GPL-3.0-or-later
# of: pl_map.csv
NR == 1 { read_head($0, column); next }
{ split($0, f, ","); all++; if (f[column["growth"]] + 0 > 0 || f[column["growth"]] !~ /^[-+0-9.]/) grows++ }
END {
	print "Scheme pl, its coupling held over a step, grows on undamped masses at " \
		(grows == all ? "every one" : grows) " of " all " steps and couplings tried"
}
