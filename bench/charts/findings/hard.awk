# SPDX-License-Identifier: GPL-3.0-or-later
# of: hard.csv
NR == 1 { read_head($0, column); next }
{
	split_row($0, f)
	c = f[column["case"]]; m = f[column["method"]]; word = f[column["word"]]
	cases[c] = 1; family[m] = f[column["family"]]
	fair = word == "ok" || word == "as exact"
	if (fair) good[m, c] = 1
	if (word != "linear only" && word != "refused") tried[m, c] = 1
}
END {
	for (c in cases) n++
	for (m in family) {
		count = 0; bad = 0
		for (c in cases) { count += (m, c) in good; bad += ((m, c) in tried) && !((m, c) in good) }
		if (family[m] == "ours") continue
		peers++; whole += count == n
		if (count > most) { most = count; who = m }
	}
	exact = 0; asked = 0
	for (c in cases) { asked += ("exact", c) in tried; exact += ("exact", c) in good }
	printf "Where methods fail: of %d peers %s through all %d hard cases (%s: %d); plgen's exact through %s of " \
		"the %d it takes\n", peers, whole ? whole " get" : "none gets", n, who, most,
		exact == asked ? "all" : exact, asked
}
