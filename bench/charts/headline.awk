# SPDX-License-Identifier: GPL-3.0-or-later
# awk -f csv.awk -f headline.awk headline_integrators.csv: gnuplot for a chart with a row for each method: its median
# time at each of the two errors, or the word that it does not get there; `rows` and `clauses`.
NR == 1 { read_head($0, column); next }
{
	split_row($0, f)
	name = f[column["method"]]
	if (!(name in place)) { place[name] = ++rows; tics = tics (rows > 1 ? ", " : "") "'" name "' " rows }
	family = f[column["family"]] == "ours" ? "ours" : f[column["family"]] == "propagator" ? "matrix" : "peer"
	which = (f[column["target"]] + 0 < 1e-10 ? "fine" : "coarse")
	y = place[name] + (which == "fine" ? 0.17 : -0.17)
	if (f[column["reached"]] == "reached")
		block[which "_" family] = block[which "_" family] f[column["ns_median"]] "," y "\n"
	else {
		least = f[column["error"]] == "failed" ? "failed" : "not reached: " sprintf("%.2g",
			f[column["error"]]) " at best"
		if (f[column["parts_estimated"]] != "none")
			least = "not reached: would take some " sprintf("%d",
			f[column["parts_estimated"]]) " steps per output"
		words = words "set label " (100 + ++labels) " '" (which == "fine" ? "10^{-12}" : "10^{-9}") " " \
			least "' at first 1.3," y " left font ',8' textcolor rgb '#707070'\n"
	}
}
END {
	split("coarse_ours fine_ours coarse_matrix fine_matrix coarse_peer fine_peer", name_of, " ")
	title["coarse_ours"] = "plgen, error 10^{-9}"; title["fine_ours"] = "plgen, error 10^{-12}"
	title["coarse_matrix"] = "matrix of a step, error 10^{-9}"
	title["fine_matrix"] = "matrix of a step, error 10^{-12}"
	title["coarse_peer"] = "integrator, error 10^{-9}"; title["fine_peer"] = "integrator, error 10^{-12}"
	look["coarse_ours"] = "pt 9 ps 1.3 lw 1.4 lc rgb '#d00000'";
	look["fine_ours"] = "pt 7 ps 1.3 lw 1.4 lc rgb '#a00000'"
	look["coarse_matrix"] = "pt 8 ps 1.2 lw 1.4 lc rgb '#007040'"
	look["fine_matrix"] = "pt 6 ps 1.2 lw 1.4 lc rgb '#00402a'"
	look["coarse_peer"] = "pt 8 ps 1.2 lw 1.4 lc rgb '#0050c0'";
	look["fine_peer"] = "pt 6 ps 1.2 lw 1.4 lc rgb '#303030'"
	for (i = 1; i <= 6; i++) {
		b = name_of[i]
		if (block[b] == "") continue
		printf "$%s << EOD\n%sEOD\n", b, block[b]
		text = text (text == "" ? "" : ", ") "$" b " using 1:2 with points " look[b] " title '" title[b] "'"
	}
	printf "%sset ytics (%s)\nrows = %d\nclauses = \"%s\"\n", words, tics, rows, text
}
