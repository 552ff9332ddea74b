# SPDX-License-Identifier: GPL-3.0-or-later
# of: frame.csv
# Largest errors of the roof at the record's own step, the largest of the table
NR == 1 { read_head($0, column); next }
{
	split_row($0, f)
	h = f[column["h_s"]] + 0; e = f[column["roof_error_over_peak"]] + 0
	if (h > step) { step = h; low = high = "" }
	if (h < step) next
	if (f[column["method"]] == "exact") { exact = e; next }
	if (low == "" || e < low) low = e
	if (high == "" || e > high) high = e
}
END {
	printf "An earthquake on three storeys: at the record's own step the integrators are %.0f to %.0f %% " \
		"off, the exact step %s\n", 100 * low, 100 * high, short(exact)
}
