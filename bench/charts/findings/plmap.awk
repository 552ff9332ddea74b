# SPDX-License-Identifier: GPL-3.0-or-later
# of: plmap.csv
NR == 1 { read_head($0, column); next }
{
	split_row($0, f)
	r = f[column["ratio_pl_over_RK4"]]
	a = f[column["error_pl"]]; b = f[column["error_RK4"]]
	if (!is_number(r) || ((!is_number(a) || a + 0 > 0.5) && (!is_number(b) || b + 0 > 0.5))) next
	all++; if (r + 0 < 1) pl++
}
END {
	printf "pl, its coupling held, is more accurate than RK4 at the same step on %.0f %% of this map: where the " \
		"coupling is weak\n", 100 * pl / all
}
