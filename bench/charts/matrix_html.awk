# SPDX-License-Identifier: GPL-3.0-or-later
# awk [-v only=MODEL] -f csv.awk -f words.awk -f matrix_html.awk matrix.csv: the matrix as an HTML table, models by
# wanted error. only: of that model, without links.
function escaped(text) { gsub(/&/, "\\&amp;", text); gsub(/</, "\\&lt;", text); return text }
# Ours and the peer, each with its time; on narrow screens left out
function both(    text) {
	text = f[column["ours"]] == "none" ? "none of ours" : escaped(f[column["ours"]]) " " \
		time_text(f[column["ours_ns"]])
	return text " : " (f[column["peer"]] == "none" ? "no peer" : escaped(f[column["peer"]]) " " \
		time_text(f[column["peer_ns"]]))
}
function cell(    word, factor, winner) {
	word = f[column["word"]]; factor = f[column["factor"]]; winner = escaped(f[column["peer"]])
	if (word == "ours") return "<td class=ahead><b>" times_text(factor) "×</b> <span>" both() "</span></td>"
	if (word == "only ours") return "<td class=ahead><b>alone</b> <span>" both() "</span></td>"
	if (word == "even") return "<td class=even><b>even</b> <span>" both() "</span></td>"
	if (word == "peer")
		return "<td class=behind><b>" winner "</b> " times_text(1 / factor) "× <span>ahead of " \
			escaped(f[column["ours"]]) " " time_text(f[column["ours_ns"]]) "</span></td>"
	if (word == "only peer")
		return "<td class=behind><b>" winner "</b> alone <span>" time_text(f[column["peer_ns"]]) "</span></td>"
	return "<td class=nobody>nobody</td>"
}
NR == 1 { read_head($0, column); next }
{
	split_row($0, f)
	model = f[column["model"]]
	if (only != "" && model != only) next
	if (!(model in row)) { models[++count] = model; row[model] = "" }
	if (!(f[column["error"]] in known)) { known[f[column["error"]]] = 1; head = head "<th>error at most <em>" \
		f[column["error"]] "</em></th>" }
	row[model] = row[model] cell()
}
END {
	print "<table class=matrix><thead><tr><th>model</th>" head "</tr></thead><tbody>"
	for (m = 1; m <= count; m++) {
		model = models[m]
		gsub(/_/, "_<wbr>", model)
		print "<tr><th>" (only != "" ? model : "<a href=\"model_" models[m] ".html\">" model "</a>") "</th>" \
			row[models[m]] "</tr>"
	}
	print "</tbody></table>"
}
