# SPDX-License-Identifier: GPL-3.0-or-later
# Numbers in sentences: -f words.awk after csv.awk. Findings are sentences that awk makes from tables.

# Two digits, an exponent where zeros would hide the size
function short(x) {
	x += 0
	if (x == 0) return "0"
	if (x < 0) return "-" short(-x)
	if (x >= 99.5 && x < 1e5) return sprintf("%.0f", x)
	if (x >= 9.95 && x < 99.5) return sprintf("%.0f", x)
	if (x >= 0.001 && x < 9.95) return sprintf("%.2g", x)
	x = sprintf("%.1e", x)
	sub(/e\+?/, "e", x); sub(/e-0/, "e-", x); sub(/e0/, "e", x); sub(/\.0e/, "e", x)
	return x
}
function time_text(ns) {
	ns += 0
	return ns < 1000 ? three(ns) " ns" : ns < 1e6 ? three(ns / 1e3) " us" : ns < 1e9 ? three(ns / 1e6) " ms" : \
		three(ns / 1e9) " s"
}
function three(x) {
	x += 0
	return x < 9.995 ? sprintf("%.2g", x) : x < 99.95 ? sprintf("%.0f", x) : sprintf("%.3g", x)
}
function times_text(x) {
	x += 0
	return x < 9.95 ? sprintf("%.1f", x) : x < 1e5 ? sprintf("%.0f", x) : short(x)
}

# Of a finding: each row of its tables
function of(head) { return f[column[head]] }
function span(x) { if (low == "" || x < low) low = x; if (high == "" || x > high) high = x }
