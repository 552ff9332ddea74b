# SPDX-License-Identifier: GPL-3.0-or-later
# awk -f csv.awk -f verdict.awk matrix.csv: how many cells of the matrix go to whom, as HTML
NR == 1 { read_head($0, column); next }
{ split_row($0, f); cells++; count[f[column["word"]]]++; models[f[column["model"]]] = 1 }
END {
	for (m in models) n++
	printf "<p>The cheapest of plgen's against the cheapest peer, on %d models at four wanted errors: plgen is " \
		"ahead in %d of the %d cells (in %d of them it alone gets there), even in %d; a peer is ahead in %d " \
		"(%d alone)", n,
		count["ours"] + count["only ours"], cells, count["only ours"], count["even"],
		count["peer"] + count["only peer"], count["only peer"]
	if (count["none"]) printf "; in %d nobody gets there", count["none"]
	print ". Each is at its cheapest setting, in double, whose largest error over the whole history, at " \
		"outputs and between them, is not above the wanted one. Times are for one output; even: within " \
		"the 10 % that times hold.</p>"
}
