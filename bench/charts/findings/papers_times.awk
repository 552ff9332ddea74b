# SPDX-License-Identifier: GPL-3.0-or-later
# of: papers_times.csv
NR == 1 { read_head($0, column); next }
{
	split_row($0, f)
	if (f[column["source"]] != "000" || f[column["method"]] != "pl") next
	r = f[column["reported"]]; t = f[column["measured"]]
	if (is_number(r)) { if (low == "" || r + 0 < low) low = r + 0; if (r + 0 > high) high = r + 0 }
	if (is_number(t)) { if (least == "" || t + 0 < least) least = t + 0; if (t + 0 > most) most = t + 0 }
}
END {
	print "A step of pl takes " short(least) " to " short(most) " of RK4's time in compiled C; its source " \
		"reports " short(low) " to " short(high)
}
