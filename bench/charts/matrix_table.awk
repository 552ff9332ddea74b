# SPDX-License-Identifier: GPL-3.0-or-later
# awk -f csv.awk -f matrix_table.awk matrix.csv: models down, wanted errors across, as an HTML table: the cheapest of
# ours and the cheapest peer with their times [ns], and how many times ours the peer's is; red with the winner's name
# where a peer is ahead.
function rounded(ns) { return ns + 0 < 100 ? sprintf("%.3g", ns) : sprintf("%.0f", ns) }
NR == 1 { read_head($0, column); next }
{
	split("", row)
	split_row($0, row)
	model = row[column["model"]]; error = row[column["error"]]; word = row[column["word"]]
	if (!(model in known)) { known[model] = 1; models[++count] = model }
	if (!(error in wanted)) { wanted[error] = 1; errors[++levels] = error }
	ours = row[column["ours"]] == "none" ? "none" : row[column["ours"]] " " rounded(row[column["ours_ns"]])
	peer = row[column["peer"]] == "none" ? "none" : row[column["peer"]] " " rounded(row[column["peer_ns"]])
	first = word == "ours" || word ~ /^(only|nobody)/ ? word : word " ahead"
	if (row[column["factor"]] != "none" && word == "ours") first = row[column["factor"]] " times"
	class = word == "ours" || word == "only ours" ? "good" : word == "nobody" ? "none" : "bad"
	cell[model, error] = "<td class=" class "><b>" first "</b><br><small>" ours "; " peer "</small></td>"
}
END {
	print "<div class=wide><table><tr><th>model</th>"
	for (l = 1; l <= levels; l++) printf "<th>%s</th>", errors[l]
	print "</tr>"
	for (m = 1; m <= count; m++) {
		printf "<tr><th><a href=\"#model_%s\">%s</a></th>", models[m], models[m]
		for (l = 1; l <= levels; l++) printf "%s", cell[models[m], errors[l]]
		print "</tr>"
	}
	print "</table></div>"
}
