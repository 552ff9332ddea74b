# SPDX-License-Identifier: GPL-3.0-or-later
# of: energy.csv
NR == 1 { read_head($0, column); next }
{
	split_row($0, f)
	if (f[column["case"]] != "moving" || f[column["real"]] != "double") next
	n = split(f[column["steps"]], after, " ")
	split(f[column["largest"]], largest, " ")
	for (i = 1; i <= n; i++)
		if (is_number(largest[i])) { last[f[column["method"]]] = largest[i]; steps = after[i] }
}
END {
	print "Momentum of a free pair changed over " short(steps) " steps: matrix exponential " \
		short(last["exp(A h), loop"]) ", plgen's exact " short(last["exact"]) ", compensated " \
		short(last["exact, compensated"])
}
