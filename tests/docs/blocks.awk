# SPDX-License-Identifier: GPL-3.0-or-later
# Writes every fenced block of a page to FOLDER/N.KIND and a line `N KIND LINE` about each to standard output. What
# would pass unseen is told as a block of no kind: an indented block (an item of a list may be indented), and one that
# does not end.
/^```/ && !inside {
	inside = 1
	number++
	kind = substr($0, 4)
	sub(/ .*/, "", kind)
	if (kind == "")
		kind = "unnamed"
	file = folder "/" number "." kind
	printf "" >file
	print number, kind, NR
	next
}
/^```/ {
	inside = 0
	close(file)
	next
}
inside { print >file; next }
/^    / && before == "" && !list { print 0, "indented", NR }
/^[^ ]/ { list = /^([-*]|[0-9]+\.) / }
{ before = $0 }
END { if (inside) print 0, "unclosed", NR }
