# SPDX-License-Identifier: GPL-3.0-or-later
# awk -v model=MODEL -f csv.awk -f words.awk -f ranking.awk precision.csv: every method's cheapest setting at each
# wanted error as an HTML table, the cheapest at the finest error first; what does not get there has its least error,
# and what gets there at more than 20 times the cheapest time (without one of its own in the table) is called dear.
function escaped(text) { gsub(/&/, "\\&amp;", text); gsub(/</, "\\&lt;", text); return text }
function before(a, b,    i) {
	for (i = errors; i >= 1; i--) {
		if (((a, i) in ns) != ((b, i) in ns)) return (a, i) in ns
		if (((a, i) in ns) && ns[a, i] != ns[b, i]) return ns[a, i] < ns[b, i]
	}
	return a < b
}
BEGIN { errors = split("1e-3 1e-6 1e-9 1e-12", wanted, " ") }
NR == 1 { read_head($0, column); next }
{
	split_row($0, f)
	if (f[column["model"]] != model) next
	name = f[column["method"]]
	if (!(name in number)) { number[name] = ++rows; method[rows] = name; family[rows] = f[column["family"]] }
	k = number[name]
	count = split(f[column["setting"]], tried, " ")
	split(f[column["largest"]], largest, " "); split(f[column["ns_median"]], median, " ")
	for (s = 1; s <= count; s++) {
		error = largest[s]; cost = median[s] + 0
		if (!is_number(error) || (cost <= 0 && median[s] != "dear")) continue
		if (!(k in least) || error + 0 < least[k]) least[k] = error + 0
		for (i = 1; i <= errors; i++) {
			if (error + 0 > wanted[i] + 0) continue
			if (cost <= 0) dear[k, i] = 1
			else if (!((k, i) in ns) || cost < ns[k, i]) { ns[k, i] = cost; setting[k, i] = tried[s] }
		}
	}
}
END {
	for (k = 1; k <= rows; k++) {
		at = 1
		for (i = 1; i <= rows; i++) at += i != k && before(i, k)
		place[at] = k
	}
	print "<div class=wide><table class=ranking><tr><th>method"
	for (i = 1; i <= errors; i++) print "<th>error at most " wanted[i]
	print "<th>least error"
	for (r = 1; r <= rows; r++) {
		k = place[r]
		printf "<tr class=%s><th>%s", family[k], escaped(method[k])
		for (i = 1; i <= errors; i++)
			if ((k, i) in ns) printf "<td title=%s>%s", setting[k, i], time_text(ns[k, i])
			else printf "<td class=none>%s", (k, i) in dear ? "dear" : "not reached"
		print "<td" (k in least ? ">" short(least[k]) : " class=bad>failed")
	}
	print "</table></div>"
}
