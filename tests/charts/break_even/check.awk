# SPDX-License-Identifier: GPL-3.0-or-later
# awk -f csv.awk -f check.awk break_even.csv: float beside float and double beside double;
# steps, or never where ours are not cheaper
function type_of(method) { return method ~ /float/ ? "float" : "double" }
NR == 1 { read_head($0, column); next }
{
	split("", row)
	split_row($0, row)
	rival = row[column["rival"]]; ours = row[column["ours"]]; real = row[column["real"]]
	steps = row[column["break_even_steps"]]
	theirs = row[column["rival_ns_per_unit"]]; mine = row[column["our_ns_per_unit"]]
	counted[real]++
	if (type_of(rival) != real || (ours != "none" && type_of(ours) != real)) {
		print row[1] ": in " real " " ours " beside " rival
		bad = 1
	}
	expected = !is_number(theirs) ? "none" : !is_number(mine) || theirs + 0 <= 1.1 * mine ? "never" : "a number"
	if ((is_number(steps) ? "a number" : steps) != expected) {
		print row[1] ", " rival ": found " steps ", expected " expected " (" theirs " ns, ours " mine ")"
		bad = 1
	}
}
END {
	if (!counted["double"] || !counted["float"]) {
		print counted["double"] + 0 " rows in double, " counted["float"] + 0 " in float"
		bad = 1
	}
	exit bad
}
