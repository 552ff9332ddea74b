# SPDX-License-Identifier: GPL-3.0-or-later
# of: break_even.csv
# Against the cheapest peer in double
NR == 1 { read_head($0, column); next }
{
	split_row($0, f)
	m = f[column["model"]]; ns = f[column["rival_ns_per_unit"]]
	if (f[column["real"]] != "double" || !is_number(ns)) next
	if (!(m in least) || ns + 0 < least[m]) { least[m] = ns + 0; steps[m] = f[column["break_even_steps"]] }
}
END {
	for (m in least) {
		models++
		if (!is_number(steps[m])) { never++; continue }
		if (low == "" || steps[m] + 0 < low) low = steps[m] + 0
		if (steps[m] + 0 > high) high = steps[m] + 0
	}
	print "Generating and compiling is won back after " short(low) " to " short(high) " steps against the " \
		"cheapest peer" (never ? ", and never on " never " of " models " models" : ", on all " models \
		" models") " (error 1e-6)"
}
