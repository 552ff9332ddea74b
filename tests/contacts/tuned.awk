# SPDX-License-Identifier: GPL-3.0-or-later
# tuned.awk -v VALUES=FILE: a scene's spec again, up to 16 of its numbers as tunable params that have other values;
# into FILE those that it had, as a macro. Frequencies of loads, initial values and the step stay, and masses where two
# of them strike each other, since they stand in the jumps too.
function param(number, other)
{
	if (number + 0 == 0 || (!(number in name) && count == 16))
		return number
	if (!(number in name)) {
		name[number] = "p" ++count
		params = params (count > 1 ? ", " : "") "p" count " = " other
		names = names (count > 1 ? ", " : "") "p" count
		values = values (count > 1 ? ", " : "") number
	}
	return name[number]
}
# Each number of the text that stands alone, but for those before *t, and after a slash or before one
function swapped(text,  result, number, before, after)
{
	while (match(text, /[0-9]+(\.[0-9]+)?/)) {
		before = RSTART > 1 ? substr(text, RSTART - 1, 1) : ""
		number = substr(text, RSTART, RLENGTH)
		after = substr(text, RSTART + RLENGTH)
		result = result substr(text, 1, RSTART - 1)
		result = result (before ~ /[a-z\/]/ || after ~ /^(\*t|\/)/ || (masses && after ~ /^\*q[0-9]''/) \
			? number : param(number, number * 1.25))
		text = after
	}
	return result text
}
{ line[NR] = $0 }
/^when/ && /\// { masses = 1 }
END {
	for (i = 1; i <= NR; i++)       # e first: it stays within 0 and 1
		if (line[i] ~ /^when/ && match(line[i], /(1 \+ |= -)[0-9.]+/)) {
			number = substr(line[i], RSTART, RLENGTH)
			sub(/1 \+ |= -/, "", number)
			param(number, number * 0.8 + 0.05)
		}
	for (i = 1; i <= NR; i++) {
		if (line[i] ~ /^when/) {
			text = line[i]
			sub(/^when [^:]*: /, "", text)
			gsub(/\(1 \+ /, "(one + ", text)
			head = substr(line[i], 1, length(line[i]) - length(line[i]) + index(line[i], ": ") - 1)
			line[i] = swapped(head) ": " swapped(text)
			gsub(/\(one \+ /, "(1 + ", line[i])
		} else if (line[i] ~ /''/)
			line[i] = swapped(line[i])
	}
	print line[1]
	print "param " params
	print "tunable " names
	for (i = 2; i <= NR; i++)
		print line[i]
	print "#define SCENE_VALUES " values >VALUES
}
