# SPDX-License-Identifier: GPL-3.0-or-later
# awk -v palette=palette.list -f csv.awk -f headline.awk headline_integrators.csv: gnuplot for a chart with a row for
# each method that reaches one of the two errors, the quickest first: its median time at each, or the word that it does
# not get there; `rows` and `clauses`. How many reach neither stands below.
function place_of(k,    i, n) {
	for (i = 1; i <= methods; i++)
		if (cost[i] < cost[k] || (cost[i] == cost[k] && i < k)) n++
	return n + 1
}
# Where words stand beside a mark at so many ns: right of it, or left where that would leave the picture
function beside(ns, y) { return ns < 200 ? ns * 1.5 "," y " left" : ns / 1.5 "," y " right" }
BEGIN {
	while ((getline line < palette) > 0)
		if (split(line, part, " ") > 1) colour[part[1]] = part[2]
}
NR == 1 { read_head($0, column); next }
{
	split_row($0, f)
	name = f[column["method"]]
	if (!(name in place)) { place[name] = ++methods; method[methods] = name; cost[methods] = 1e300 }
	k = place[name]
	family[k] = f[column["family"]] == "ours" ? "ours" : f[column["family"]] == "propagator" ? "matrix" : "peer"
	which = (f[column["target"]] + 0 < 1e-10 ? "fine" : "coarse")
	if (f[column["reached"]] == "reached") {
		time[k, which] = f[column["ns_median"]] + 0
		if (which == "coarse" || cost[k] == 1e300)
			cost[k] = time[k, which] * (which == "coarse" ? 1 : 1e9)
	} else {
		why[k, which] = f[column["error"]] == "failed" ? "failed" : \
			sprintf("%.2g at best", f[column["error"]])
		if (f[column["parts_estimated"]] != "none")
			why[k, which] = sprintf("%s would take %d steps", f[column["target"]],
				f[column["parts_estimated"]])
	}
}
END {
	split("coarse fine", targets, " ")
	for (k = 1; k <= methods; k++) {
		if (cost[k] == 1e300) { neither++; continue }
		at = place_of(k)
		tics = tics (rows++ ? ", " : "") "\"" method[k] "\" " at
		for (i = 1; i <= 2; i++) {
			which = targets[i]
			y = at + (i == 2 ? 0.19 : -0.19)
			if ((k, which) in time)
				block[which "_" family[k]] = block[which "_" family[k]] time[k, which] "," y "\n"
			else if ((k, which) in why)
				words = words "set label " ++labels " '" why[k, which] \
					"' at first " beside(time[k, targets[3 - i]], 2 * at - y) \
					" font ',9' textcolor rgb '#505050'\n"
		}
	}
	if (neither)
		words = words "set label " ++labels " '" neither " other" (neither > 1 ? "s reach" : " reaches") \
			" neither error: in the table' at first 1.3," rows + 0.95 \
			" left font ',9' textcolor rgb '#505050'\n"
	n = split("coarse_ours fine_ours coarse_matrix fine_matrix coarse_peer fine_peer", name_of, " ")
	of["ours"] = "exact"; of["matrix"] = "matrix"; of["peer"] = "adaptive"
	who["ours"] = "plgen"; who["matrix"] = "matrix of a step"; who["peer"] = "integrator"
	for (i = 1; i <= n; i++) {
		b = name_of[i]
		if (block[b] == "") continue
		split(b, part, "_")
		coarse = part[1] == "coarse"
		printf "$%s << EOD\n%sEOD\n", b, block[b]
		text = text (text == "" ? "" : ", ") "$" b " using 1:2 with points pt " \
			(part[2] == "ours" ? (coarse ? 5 : 7) : coarse ? 8 : 6) " ps 1.1 lw 1.6 lc rgb '" \
			colour[of[part[2]]] "' title '" who[part[2]] ", error " (coarse ? "10^{-9}" : "10^{-12}") "'"
	}
	printf "%stics = '%s'\nrows = %d\nclauses = \"%s\"\n", words, tics, rows, text
}
