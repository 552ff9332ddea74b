# SPDX-License-Identifier: GPL-3.0-or-later
# awk [-v narrow=1] -f csv.awk -f hard_grid.awk hard.csv: gnuplot data of a grid, ours first and then
# those that get through most: $cells: case, method, colour, word; of a method tried with several settings the best
# (narrow: its letter); `tics`, `cases_tics`, `rows`, `cases`.
function better(a, b) { return worth[a] > worth[b] }
function before(a, b) {
	if (family[a] != family[b] && (family[a] == "ours" || family[b] == "ours")) return family[a] == "ours"
	return good[a] > good[b] || (good[a] == good[b] && a < b)
}
BEGIN {
	n = split("ok,as exact,poor,wrong,diverged,gave up,refused,linear only", words, ",")
	split(narrow ? " , ,p,w,d,q,r,-" : "ok,exact,poor,wrong,div.,quit,ref.,-", short_word, ",")
	split("0x9cc4f5,0x9cc4f5,0xf2d27c,0xe3a06a,0xc9958f,0xc9958f,0xc4b4d0,0xe8e8ec", colour, ",")
	for (i = 1; i <= n; i++) {
		worth[words[i]] = n - i; text[words[i]] = short_word[i]; shade[words[i]] = colour[i] }
}
NR == 1 { read_head($0, column); next }
{
	split_row($0, f)
	of = f[column["case"]]; name = f[column["method"]]; word = f[column["word"]]
	if (!(of in case_number)) { case_number[of] = ++cases; case_name[cases] = of }
	if (!(name in number)) { number[name] = ++rows; method[rows] = name; family[rows] = f[column["family"]] }
	k = number[name]; c = case_number[of]
	if (!((k, c) in result) || better(word, result[k, c])) result[k, c] = word
}
END {
	for (k = 1; k <= rows; k++)
		for (c = 1; c <= cases; c++) good[k] += result[k, c] == "ok" || result[k, c] == "as exact"
	print "$cells << EOD"
	for (k = 1; k <= rows; k++) {
		at = 1
		for (i = 1; i <= rows; i++) at += i != k && before(i, k)
		tics = tics (k > 1 ? ", " : "") "\"" method[k] "\" " at
		for (c = 1; c <= cases; c++)
			if ((k, c) in result) print c "," at "," shade[result[k, c]] "," text[result[k, c]]
	}
	print "EOD"
	for (c = 1; c <= cases; c++) cases_tics = cases_tics (c > 1 ? ", " : "") "\"" case_name[c] "\" " c
	printf "tics = '%s'\ncases_tics = '%s'\nrows = %d\ncases = %d\n", tics, cases_tics, rows, cases
}
