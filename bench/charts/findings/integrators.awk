# SPDX-License-Identifier: GPL-3.0-or-later
# of: integrators.csv
# Elongations at the step nearest to a tenth of the period
NR == 1 { read_head($0, column); next }
{
	split_row($0, f)
	h = f[column["h_over_T"]] + 0; d = h > 0.1 ? h - 0.1 : 0.1 - h; m = f[column["method"]]
	if (!(m in near) || d < near[m]) { near[m] = d; long[m] = f[column["period_elongation_percent"]] + 0
		lost[m] = f[column["amplitude_decay_percent_per_period"]] + 0 }
}
END {
	for (m in long) {
		if (m == "exact") continue
		if (low == "" || long[m] < low) low = long[m]
		if (high == "" || long[m] > high) high = long[m]
		if (lost[m] > most) most = lost[m]
	}
	print "At ten steps a period the integrators of structural dynamics change the period by " short(low) " to " \
		short(high) " % and lose up to " short(most) " % of amplitude in each, the exact step " \
		short(long["exact"]) " and " short(lost["exact"])
}
