# SPDX-License-Identifier: GPL-3.0-or-later
# Reading CSV: -f csv.awk before the program. A line into fields; quotes keep commas.
function split_row(line, field,    n, c, i, quoted, text) {
	n = 0; text = ""; quoted = 0
	for (i = 1; i <= length(line); i++) {
		c = substr(line, i, 1)
		if (c == "\"") quoted = !quoted
		else if (c == "," && !quoted) { field[++n] = text; text = "" }
		else text = text c
	}
	field[++n] = text
	return n
}
function is_number(text) { return text ~ /^[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?$/ }
# Of a head: column["name"] is its number.
function read_head(line, column,    n, i, head) {
	n = split_row(line, head)
	for (i = 1; i <= n; i++) column[head[i]] = i
	return n
}
