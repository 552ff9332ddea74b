# SPDX-License-Identifier: GPL-3.0-or-later
# awk -f csv.awk -f hard_table.awk hard.csv: the hard cases across, methods down, as an HTML table; where a method was
# tried with two steps, the longer stands first.
function class_of(word) { return word == "ok" ? "n" : word == "poor" ? "poor" : word == "linear only" ||
	word == "as exact" ? "none" : "bad" }
# 0.0078125: 1/128
function step_text(h) { return length(h) > 6 && h < 1 ? "1/" 1 / h : h }
NR == 1 { next }
{
	split("", row)
	split_row($0, row)
	of = row[1]; method = row[2]; family = row[3]; kind = row[4]; setting = row[5]; error = row[6]; word = row[7]
	if (!(of in known_case)) { known_case[of] = 1; cases[++case_count] = of }
	if (!(method in known_method)) { known_method[method] = family; methods[++method_count] = method }
	if (kind == "step") setting = step_text(setting)
	shown = error == "failed" ? word : word == "ok" ? error : error " " word
	cells[of, method] = cells[of, method] "<div class=" class_of(word) (kind == "step" ? " title=\"h = " \
		setting " s\"" : " title=\"relative tolerance " setting "\"") ">" shown "</div>"
	if (kind == "step" && index(steps[of] " ", " " setting " ") == 0) steps[of] = steps[of] " " setting
}
END {
	print "<div class=wide><table class=hard><tr><th>method</th>"
	for (c = 1; c <= case_count; c++) {
		text = steps[cases[c]]
		sub(/^ /, "", text)
		gsub(/ /, ", ", text)
		printf "<th>%s<br><small>h = %s s</small>", cases[c], text
	}
	print ""
	split("ours fixed adaptive propagator", order, " ")
	for (f = 1; f <= 4; f++)
		for (m = 1; m <= method_count; m++) {
			if (known_method[methods[m]] != order[f]) continue
			printf "<tr class=%s><th>%s", order[f], methods[m]
			for (c = 1; c <= case_count; c++) printf "<td>%s", cells[cases[c], methods[m]]
			print ""
		}
	print "</table></div>"
}
