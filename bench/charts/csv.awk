# SPDX-License-Identifier: GPL-3.0-or-later
# Reading CSV: -f csv.awk before the program. A line into fields; quotes keep commas. Fields are strings, also those
# that look like numbers: "1e-2" is not "0.01", and "0" is not false.
function split_row(line, field,    n, text, pieces, piece, parts, part, i, j) {
	if (index(line, "\"") == 0) {
		n = split(line, field, ",")
		if (n == 0) field[n = 1] = ""
		for (i = 1; i <= n; i++) field[i] = field[i] ""
		return n
	}
	n = 0; text = ""
	pieces = split(line, piece, "\"")
	for (i = 1; i <= pieces; i++) {         # every second is within quotes
		parts = i % 2 ? split(piece[i], part, ",") : 0
		text = text (parts ? part[1] : piece[i])
		for (j = 2; j <= parts; j++) { field[++n] = text ""; text = part[j] }
	}
	field[++n] = text ""
	return n
}
function is_number(text) { return text ~ /^[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?$/ }
# Of a head: column["name"] is its number.
function read_head(line, column,    n, i, head) {
	n = split_row(line, head)
	for (i = 1; i <= n; i++) column[head[i]] = i
	return n
}
