# SPDX-License-Identifier: GPL-3.0-or-later
# Two outputs of tell.c: by how much the second differs from the first, in units in the last place of the largest value
# of a column of a table, and the same over the steps of that row; "within" behind it where that is at most 2 a step.
# Of a self-test, which counts such units itself, nothing is measured.

function unit(of,  place) {
	for (place = 1; place > of; place /= 2)
		;
	for (; place * 2 <= of; place *= 2)
		;
	return place / digits
}
function is_number(word) {
	return word !~ /nan|inf/
}
function size_of(value) {
	return value < 0 ? -value : value
}

FNR == 1 { digits = $3 == 4 ? 2 ^ 23 : 2 ^ 52 }
NR == FNR {
	first[FNR] = $0
	for (i = 3; i <= NF; i++)
		if (is_number($i) && size_of($i) > largest[$1, i])
			largest[$1, i] = size_of($i)
	lines = FNR
	next
}
{
	if (split(first[FNR], was, ",") != NF || was[1] != $1 || was[2] != $2) {
		other = FNR
		exit
	}
	for (i = 3; i <= NF && $1 != "selftest"; i++) {
		if (was[i] "" == $i "")
			continue
		if (!is_number(was[i]) || !is_number($i) || largest[$1, i] == 0) {
			other = FNR
			exit
		}
		apart = size_of(was[i] - $i) / unit(largest[$1, i])
		steps = $2 > 0 ? $2 : 1
		if (apart > most)
			most = apart
		if (apart / steps >= most_a_step) {
			most_a_step = apart / steps
			where = $1 " " $2 ", column " i - 2 ", " was[i] " and " $i
		}
	}
}
END {
	if (other || FNR != lines)
		printf "differs in line %d: %s and %s\n", FNR, first[FNR], $0
	else
		printf "differs by %.3g units, by %.3g a step (%s)%s\n", most, most_a_step, where,
			most_a_step <= 2 ? " within" : ""
}
