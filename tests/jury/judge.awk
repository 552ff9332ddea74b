# SPDX-License-Identifier: GPL-3.0-or-later
# What a run reaches of the digits that a case has published:
#
#     awk -v poles=FILE -v spare=FACTOR -f judge.awk NAME.jury ROWS.csv
#
# prints a line a value, `TIME OUTPUT PUBLISHED REACHED VALUE RESULT`. A digit is reached where the result is within
# half a unit of it; of at most 15, which is what a double holds. Of a value 0 decimals count as digits. `spare`: the
# error counts so many times but for the last digit published, which has the rounding of the source, so that what is
# stated of one machine is reached on another. `poles`: a file with the natural frequencies in rad/s, ascending.

function mantissa(text)
{
	sub(/^[-+]/, "", text)
	sub(/[eE].*/, "", text)
	return text
}

# how many digits TEXT gives
function digits(text)
{
	text = mantissa(text)
	if (text + 0 == 0) {
		sub(/^[^.]*\.?/, "", text)
		return length(text)
	}
	sub(/\./, "", text)
	sub(/^0+/, "", text)
	return length(text)
}

function counted(text)
{
	return digits(text) < 15 ? digits(text) : 15
}

# the power of ten of the first digit of VALUE, which is no zero
function decade(value, text)
{
	text = sprintf("%.16e", value)
	sub(/.*e/, "", text)
	return text + 0
}

# how many of the digits of TEXT the number X has, or all within MARGIN
function reached(x, text, margin, error, first, n, k)
{
	error = x - text
	error = error < 0 ? -error : error
	if (!(error < 1e300))
		return 0
	n = counted(text)
	if (margin != "" && error <= margin + 0)
		return n
	first = text + 0 == 0 ? -1 : decade(text)
	for (k = n; k > 0; k--)
		if (error * (k < digits(text) ? spare : 1) <= 0.5000001 * 10 ^ (first - k + 1))
			break
	return k
}

function close_times(a, b)
{
	return a - b <= 1e-9 * b + 1e-300 && b - a <= 1e-9 * b + 1e-300
}

function tell(time, what, text, x, margin)
{
	if (x == "")
		print time, what, digits(text), 0, text, "missing"
	else
		print time, what, digits(text), reached(x, text, margin), text, sprintf("%.17g", x)
}

BEGIN {
	spare = spare ? spare : 1
	while (poles != "" && (getline line < poles) > 0)
		pole[++pole_count] = line
}

FNR == 1 {
	file++
}

file == 1 && /^#/ { next }
file == 1 && $1 == "at" { at = $2; next }
file == 1 && $1 == "rad" { tell("-", $1 "_" $2, $3, pole[$2], $5); next }
file == 1 && $1 == "hertz" { tell("-", $1 "_" $2, $3, pole[$2] / (8 * atan2(1, 1)), $5); next }
file == 1 && at != "" && NF > 0 {
	count++
	time[count] = at
	output[count] = $1
	value[count] = $2
	margin[count] = $3 == "within" ? $4 : ""
}

file == 2 && FNR == 1 {
	columns = split($0, name, ",")
	next
}
file == 2 {
	split($0, field, ",")
	for (i = 1; i <= count; i++)
		if (close_times(field[1] + 0, time[i] + 0))
			for (c = 2; c <= columns; c++)
				if (name[c] == output[i])
					found[i] = field[c]
}

END {
	for (i = 1; i <= count; i++)
		tell(time[i], output[i], value[i], found[i], margin[i])
}
