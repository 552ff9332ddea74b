# SPDX-License-Identifier: GPL-3.0-or-later
# awk -F, -f columns.awk EXPECTED.csv FOUND.csv: same header, same number of rows, every value within 1e-11 of its
# column's largest.
FNR == NR {
	expected[FNR] = $0
	rows = FNR
	for (i = 1; i <= NF && FNR > 1; i++) {
		v = $i < 0 ? -$i : +$i
		if (v > most[i])
			most[i] = v
	}
	next
}
FNR == 1 {
	if ($0 != expected[1]) {
		print "header: found " $0 ", expected " expected[1]
		bad = 1
	}
	next
}
{
	n = split(expected[FNR], e)
	if (n != NF) {
		print "row " FNR ": found " NF " columns, expected " n
		bad = 1
		exit
	}
	for (i = 1; i <= NF; i++) {
		d = $i - e[i]
		if (d < 0)
			d = -d
		if (!(d <= 1e-11 * most[i]) && ++bad < 10)
			print "row " FNR " column " i ": found " $i ", expected " e[i] ", tolerance " 1e-11 * most[i]
	}
}
END {
	if (FNR != rows) {
		print "rows: found " FNR ", expected " rows
		bad = 1
	}
	exit bad ? 1 : 0
}
