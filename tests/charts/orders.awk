# SPDX-License-Identifier: GPL-3.0-or-later
# awk -f csv.awk -f orders.awk convergence_orders.csv: at 0.6 s the order from the last two N, and exact has rounding
# alone.
NR == 1 { read_head($0, column); next }
{
	split("", row)
	split_row($0, row)
	if (row[column["horizon_s"]] != "0.6") next
	count++
	expected = row[column["order_expected"]]; found = row[column["order_at_last"]]
	name = row[column["method"]] " on " row[column["system"]]
	if (expected == "exact" ? found != "rounding" : \
	    !is_number(found) || found - expected > 0.15 || expected - found > 0.15) {
		print name ": found " found ", expected " expected ", tolerance 0.15"
		bad = 1
	}
}
END {
	if (count != 15) { print count + 0 " rows, expected 15"; bad = 1 }
	exit bad
}
