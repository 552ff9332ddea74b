# SPDX-License-Identifier: GPL-3.0-or-later
# Reads `nm -A` of the generator's objects, and lines `declares FOLDER HEADER NAME` of headers that others than the
# folder include; rooms="base math ..." in their order. Prints calls from a room to a later one, circles of files, and
# what such a header declares though its folder alone calls it.

# gen_emit_state.c.o: emit/state; gen_step_linear_loads.c.o: step/linear_loads; gen_main.c.o: main, which stands
# after all rooms
function file_of(object,   name) {
	name = object
	sub(/^.*gen_/, "", name)
	sub(/\.c\.o$/, "", name)
	if (match(name, /^[a-z]+_/) && (substr(name, 1, RLENGTH - 1) in place))
		return substr(name, 1, RLENGTH - 1) "/" substr(name, RLENGTH + 1)
	return name
}

# of step/linear_loads step/linear; of step/cost, whatever it is called, step/cost
function folder_of(file) {
	sub(/_.*$/, "", file)
	return file
}

function place_of(file,   parts) {
	return split(file, parts, "/") == 2 ? place[parts[1]] : count + 1
}

# A circle is what is left when files that call nothing left are taken away, again and again, and then files that
# nothing left calls.
function reduce(forwards,   again, a, b, bound) {
	do {
		again = 0
		for (a in left) {
			bound = 0
			for (b in left)
				bound = bound || (forwards ? (a, b) in calls : (b, a) in calls)
			if (!bound) {
				delete left[a]
				again = 1
			}
		}
	} while (again)
}

BEGIN {
	count = split(rooms, name, " ")
	for (i = 1; i <= count; i++)
		place[name[i]] = i
}

$1 == "declares" {
	declared[$2, $4] = $3
	next
}

NF >= 3 {
	split($1, at, ":")
	object = at[1] ~ /\.o$/ ? at[1] : at[2]
	file = file_of(object)
	files[file] = 1
	kind = $(NF - 1)
	if (kind == "U")
		wants[file, $NF] = 1
	else if (kind ~ /^[TDBRVWC]$/)
		home[$NF] = file
}

END {
	for (pair in wants) {
		split(pair, part, SUBSEP)
		if (!(part[2] in home) || home[part[2]] == part[1])
			continue
		calls[part[1], home[part[2]]] = part[2]
		if (place_of(home[part[2]]) > place_of(part[1]))
			print "upwards: " part[1] " calls " part[2] " of " home[part[2]]
	}
	for (pair in wants) {
		split(pair, part, SUBSEP)
		callers[part[2]]++
		inside[part[2], folder_of(part[1])]++
	}
	for (pair in declared) {
		split(pair, part, SUBSEP)
		if (callers[part[2]] > 0 && inside[part[2], part[1]] == callers[part[2]] &&
		    folder_of(home[part[2]]) == part[1])
			print "wall: " declared[pair] " declares " part[2] ", which nobody outside calls"
	}
	for (a in files)
		left[a] = 1
	reduce(1)
	reduce(0)
	for (a in left)
		for (b in left)
			if ((a, b) in calls)
				print "circle: " a " calls " calls[a, b] " of " b
	for (a in files)
		known++
	if (known < 2)
		print "nothing was read"
}
