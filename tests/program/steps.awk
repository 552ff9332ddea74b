# SPDX-License-Identifier: GPL-3.0-or-later
# Reads the closed form as CSV, then the text of --explain=program, whose assignments it does `steps` times from the
# first row on; every state that both name must then be within 1e-13 of its largest value. Velocities that are no
# column of the CSV start from 0.
FNR == 1 {
	file++
}

file == 1 && FNR == 1 {
	columns = split($0, name, ",")
	next
}

file == 1 {
	split($0, last, ",")
	for (i = 2; i <= columns; i++) {
		value = last[i] < 0 ? -last[i] : last[i]
		if (FNR == 2)
			state[name[i]] = last[i]
		if (value > largest[name[i]])
			largest[name[i]] = value
	}
	next
}

/^Assignments, in order/ {
	in_order = 1
}

/^    [^ ]+ \+?= / {
	target[++count] = $1
	adds[count] = $2 == "+="
	for (i = 3; i <= NF; i += 2) {
		split($i, part, "*")
		factor[count, ++terms[count]] = part[1]
		operand[count, terms[count]] = part[2]
	}
}

function sum(a,   k, total) {
	total = 0
	for (k = 1; k <= terms[a]; k++)
		total += factor[a, k] * (operand[a, k] == "1" ? 1 : in_order ? state[operand[a, k]] : old[operand[a,
			k]])
	return total
}

END {
	for (s = 0; s < steps; s++) {
		for (x in state)
			old[x] = state[x]
		for (a = 1; a <= count; a++) {
			value = sum(a)
			state[target[a]] = adds[a] ? state[target[a]] + value : value
		}
	}
	for (i = 2; i <= columns; i++) {
		if (!(name[i] in old) || !is_target(name[i]))
			continue
		error = state[name[i]] - last[i]
		error = error < 0 ? -error : error
		compared++
		printf "%s %.17g, closed form %.17g, difference %.3g of %.3g\n", name[i], state[name[i]], last[i],
			error, largest[name[i]]
		if (!(error <= 1e-13 * largest[name[i]]))
			bad = 1
	}
	exit bad || !compared || !count
}

function is_target(x,   a) {
	for (a = 1; a <= count; a++)
		if (target[a] == x)
			return 1
	return 0
}
