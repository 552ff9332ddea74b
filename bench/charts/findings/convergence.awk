# SPDX-License-Identifier: GPL-3.0-or-later
# of: convergence_orders.csv convergence.csv
# name: convergence_SYSTEM
BEGIN { system_name = substr(name, 13) }
FNR == 1 { file++; split("", column); read_head($0, column); next }
{
	split_row($0, f)
	if (f[column["system"]] != system_name) next
	if (file == 1 && f[column["horizon_s"]] == "30") order[f[column["method"]]] = f[column["order_at_last"]]
	if (file == 2 && f[column["method"]] == "exact") {
		e = f[column["error_over_initial_displacement"]] + 0
		if (e > largest) largest = e
	}
}
END {
	print system_name ": plgen's exact is off by rounding only, at most " short(largest) " at any step; pl, its " \
		"coupling held, is of order " sprintf("%.1f, RK4 of order %.1f", order["pl"], order["RK4"])
}
