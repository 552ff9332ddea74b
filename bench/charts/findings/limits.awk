# SPDX-License-Identifier: GPL-3.0-or-later
# of: limits.csv
NR == 1 { read_head($0, column); next }
{
	split_row($0, f)
	if (f[column["function"]] == "run_to_memory") next
	x[++n] = f[column["times_bound"]] + 0
}
END {
	for (i = 1; i <= n; i++) {
		below = 0
		for (j = 1; j <= n; j++) below += x[j] < x[i] || (x[j] == x[i] && j < i)
		if (below == int(n / 2)) median = x[i]
		if (low == "" || x[i] < low) low = x[i]
		if (x[i] > high) high = x[i]
	}
	printf "Generated code takes %.2g to %.2g times what the machine allows, half of it at most %.2g times\n",
		low, high, median
}
