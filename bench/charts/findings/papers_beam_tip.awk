# SPDX-License-Identifier: GPL-3.0-or-later
# of: papers_beam_tip.csv
# Gone: beyond 1000 m, or no number
NR == 1 { read_head($0, column); next }
{
	split_row($0, f)
	h = f[1]; o = f[2]; tip = f[column["largest_tip_in_last_second_m"]]
	if (largest == "" || h + 0 > largest) { largest = h + 0 }
	if (!((h + 0, o) in gone) && (!is_number(tip) || tip + 0 > 1000)) gone[h + 0, o] = f[column["t_s"]]
	if (!(o in known)) { known[o] = 1; order[++n] = o }
}
END {
	for (i = 1; i <= n; i++)
		if ((largest, order[i]) in gone) list = list (list == "" ? "" : ", ") order[i]
	print "etd1 on the spun-up beam at h = " largest " s: past 1000 m with the operators " list ", of a slower " \
		"beam; bounded with those of full speed and above"
}
