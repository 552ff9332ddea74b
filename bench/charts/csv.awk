# SPDX-License-Identifier: GPL-3.0-or-later
# Reading CSV, and numbers in sentences: -f csv.awk before the program. A line into fields; quotes keep commas. Fields
# are strings, also those that look like numbers: "1e-2" is not "0.01", and "0" is not false. `same`, and nothing in the
# first of several columns, or in those of is_left_out, is what the row above has there.
function split_row(line, field,    n, i) {
	n = split_fields(line, field)
	for (i = 1; i <= n; i++) {
		if (field[i] == "same" || (field[i] == "" && n > 1 && is_left_out(i))) field[i] = above[i]
		above[i] = field[i]
	}
	return n
}
function is_left_out(i) {
	return i == 1 || head[i] ~ /^(family|setting_kind|coupling_k2_over_k1|first_wh|ratio_of_wh)$/
}
function split_fields(line, field,    n, text, pieces, piece, parts, part, i, j) {
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
# Of a head: column["name"] is its number, head[number] its name.
function read_head(line, column,    n, i) {
	split("", head)
	n = split_row(line, head)
	split("", above)
	for (i = 1; i <= n; i++) column[head[i]] = i
	return n
}
# Of a section of tables.txt or findings.txt: what its row has there; `low` and `high` of all x so far
function of(name) { return f[column[name]] }
function span(x) { if (low == "" || x < low) low = x; if (high == "" || x > high) high = x }
# Of a list between blanks: what stands at place k, and the place of what is nearest to x
function in_list(list, k,    item) { split(list, item, " "); return item[k] }
function nearest(list, x,    n, i, item, at, d, least) {
	n = split(list, item, " ")
	for (i = 1; i <= n; i++) {
		d = item[i] > x ? item[i] - x : x - item[i]
		if (!at || d < least) { at = i; least = d }
	}
	return at
}
function quoted(text) { return text ~ /[,"]/ ? "\"" text "\"" : text }
# Of as many fields as its table has columns
function put_row(field,    i) {
	for (i = 1; i <= columns; i++) printf "%s%s", quoted(field[i]), i < columns ? "," : "\n"
}
function escaped(text) { gsub(/&/, "\\&amp;", text); gsub(/</, "\\&lt;", text); gsub(/>/, "\\&gt;", text); return text }
# A row of letters as runs, 12c for twelve c, and back
function runs(text,    i, n, line) {
	for (i = 1; i <= length(text); i += n) {
		for (n = 1; substr(text, i + n, 1) == substr(text, i, 1); n++) ;
		line = line (n > 1 ? n : "") substr(text, i, 1)
	}
	return line
}
function letters_of(text,    n, line) {
	for (; text != ""; text = substr(text, 2)) {
		n = match(text, /^[0-9]+/) ? substr(text, 1, RLENGTH) + 0 : 1
		if (RLENGTH > 0) text = substr(text, RLENGTH + 1)
		for (; n > 0; n--) line = line substr(text, 1, 1)
	}
	return line
}
# The place of k among n by rising values
function place_of(k, n, value,    i, at) {
	for (i = at = 1; i <= n; i++) at += value[i] < value[k] || (value[i] == value[k] && i < k)
	return at
}
# palette.list, named by -v palette=
function read_palette(    line, part, n) {
	while ((getline line < palette) > 0) {
		n = split(line, part, " ")
		if (n < 2 || line ~ /^#/) continue
		colour[part[1]] = part[2]; dash[part[1]] = part[3]; marks[part[1]] = part[4]
	}
}

# Two digits, an exponent where zeros would hide the size
function short(x) {
	x += 0
	if (x == 0) return "0"
	if (x < 0) return "-" short(-x)
	if (x >= 9.95 && x < 1e5) return sprintf("%.0f", x)
	if (x >= 0.001 && x < 9.95) return sprintf("%.2g", x)
	x = sprintf("%.1e", x)
	sub(/e\+?/, "e", x); sub(/e-0/, "e-", x); sub(/e0/, "e", x); sub(/\.0e/, "e", x)
	return x
}
function three(x) {
	x += 0
	return x < 9.995 ? sprintf("%.2g", x) : x < 99.95 ? sprintf("%.0f", x) : sprintf("%.3g", x)
}
function time_text(ns) {
	ns += 0
	return ns < 1000 ? three(ns) " ns" : ns < 1e6 ? three(ns / 1e3) " us" : ns < 1e9 ? three(ns / 1e6) " ms" : \
		three(ns / 1e9) " s"
}
function times_text(x) {
	x += 0
	return x < 9.95 ? sprintf("%.1f", x) : x < 1e5 ? sprintf("%.0f", x) : short(x)
}
