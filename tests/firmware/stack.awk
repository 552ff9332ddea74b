# SPDX-License-Identifier: GPL-3.0-or-later
# Reads call graphs of gcc's -fcallgraph-info=su and prints FUNCTION OWN DEEPEST for what the objects offer: the bytes
# of its frame, and with those of all that it calls in turn.  What no graph tells of, libgcc above all, counts as 0.
/^node:/ {
	split($0, quoted, "\"")
	title = quoted[2]
	if (match(quoted[4], /[0-9]+ bytes \(/)) {
		split(substr(quoted[4], RSTART), bytes, " ")
		own[title] = bytes[1]
	}
}
/^edge:/ {
	split($0, quoted, "\"")
	if (!seen[quoted[2], quoted[4]]++)
		calls[quoted[2], ++many[quoted[2]]] = quoted[4]
}
function deepest(f,   i, most, one) {   # no call is recursive: freestanding.sh
	if (f in depth)
		return depth[f]
	most = 0
	for (i = 1; i <= many[f]; i++) {
		one = deepest(calls[f, i])
		most = one > most ? one : most
	}
	return depth[f] = own[f] + most
}
END {
	for (f in own)
		if (f !~ /:/)
			print f, own[f], deepest(f)
}
