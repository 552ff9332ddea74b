# SPDX-License-Identifier: GPL-3.0-or-later
# of: headline_confluence.csv
NR == 1 { read_head($0, column); next }
{
	split_row($0, f)
	if (f[column["case"]] != "one-way" || f[column["gap"]] + 0 != 0) next
	error = f[column["error"]]
	if (f[column["method"]] ~ /^modal/) modal = error
	if (f[column["method"]] == "exact") exact = error
}
END {
	print "Where two frequencies meet, modal superposition " (is_number(modal) ? "is off by " short(modal) : \
		"fails (" modal ")") "; plgen's exact step is off by " short(exact) " with its poles equal"
}
