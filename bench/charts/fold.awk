# SPDX-License-Identifier: GPL-3.0-or-later
# awk -v by=COLUMN,COLUMN... -v lists=COLUMN,... -f csv.awk -f fold.awk NAME_raw.csv: what follows one another with the
# same in the columns of `by` as one row, in which each column of `lists` is a list between spaces; other columns are
# left out.
function quoted(text) { return text ~ /[,"]/ ? "\"" text "\"" : text }
function unload(    i, line) {
	if (key == "") return
	line = key
	for (i = 1; i <= lists_count; i++) line = line "," substr(values[i], 2)
	print line
	split("", values)
}
BEGIN {
	by_count = split(by, by_name, ","); lists_count = split(lists, list_name, ",")
	print by "," lists
}
NR == 1 { read_head($0, column); next }
{
	split_row($0, f)
	now = ""
	for (i = 1; i <= by_count; i++) now = now (i > 1 ? "," : "") quoted(f[column[by_name[i]]])
	if (now != key) { unload(); key = now }
	for (i = 1; i <= lists_count; i++) values[i] = values[i] " " f[column[list_name[i]]]
}
END { unload() }
