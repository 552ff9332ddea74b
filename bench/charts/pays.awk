# SPDX-License-Identifier: GPL-3.0-or-later
# awk -f csv.awk -f pays.awk break_even.csv: gnuplot data, steps and the model's number: $cheapest, of the peer that is
# cheapest in double, and $others. Never is 1e10.
NR == 1 { read_head($0, column); next }
{
	split_row($0, f)
	if (!(f[1] in model)) model[f[1]] = ++models
	m = model[f[1]]
	steps = f[column["break_even_steps"]]; ns = f[column["rival_ns_per_unit"]]
	if (steps == "never") steps = 1e10
	if (!is_number(steps) || !is_number(ns)) next
	rows++
	at[rows] = steps + 0 < 1 ? 1 : steps; of[rows] = m
	if (f[column["real"]] == "double" && (!(m in least) || ns + 0 < least[m])) { least[m] = ns + 0; best[m] = rows }
}
END {
	print "$cheapest << EOD"
	for (m = 1; m <= models; m++) if (m in best) print at[best[m]] "," m
	print "EOD\n$others << EOD"
	for (i = 1; i <= rows; i++) if (best[of[i]] != i) print at[i] "," of[i]
	print "EOD"
}
