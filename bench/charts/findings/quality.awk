# SPDX-License-Identifier: GPL-3.0-or-later
# of: quality.csv
# At the tabled step nearest to a twentieth of the period
NR == 1 { read_head($0, column); next }
{
	split_row($0, f)
	h = f[column["h_over_T"]] + 0; m = f[column["method"]]
	d = h > 0.05 ? h - 0.05 : 0.05 - h
	if (!(m in near) || d < near[m]) { near[m] = d; at = h; long[m] = f[column["period_elongation_percent"]]
		lost[m] = f[column["amplitude_decay_percent_per_period"]] }
}
END {
	if (name == "quality_small")
		print "Small steps: slopes are orders; at h/T = " at " the period is long by " short(long["Newmark"]) \
			" % with Newmark, " short(long["RK4"]) " % with RK4; the exact step has no error to draw"
	else
		print "At h/T = " at " Newmark's period is " short(long["Newmark"]) " % long, central difference's " \
			short(-long["central difference"]) " % short, generalized-alpha loses " \
			short(lost["generalized-alpha"]) " % of amplitude a period; the exact step errs in neither"
}
