# SPDX-License-Identifier: GPL-3.0-or-later
# of: plmap.csv
NR == 1 { read_head($0, column); next }
{
	split_row($0, f)
	n = split(f[column["log10_ratio_pl_over_RK4"]], ratio, " ")
	for (i = 1; i <= n; i++) if (is_number(ratio[i])) { all++; pl += ratio[i] + 0 < 0 }
}
END {
	printf "pl, its coupling held, is more accurate than RK4 at the same step on %.0f %% of this map: where the " \
		"coupling is weak\n", 100 * pl / all
}
