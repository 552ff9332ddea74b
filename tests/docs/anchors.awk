# SPDX-License-Identifier: GPL-3.0-or-later
# The anchors of a page: of headings as GitHub makes them, of HTML the ids.
{
	if ($0 ~ /^```/)
		inside = !inside
	if (!inside && $0 ~ /^#+ /) {
		anchor = tolower($0)
		sub(/^#+ */, "", anchor)
		gsub(/[^a-z0-9 _-]/, "", anchor)
		gsub(/ /, "-", anchor)
		print anchor
	}
	for (rest = $0; match(rest, / id="[^"]*"/); rest = substr(rest, RSTART + RLENGTH))
		print substr(rest, RSTART + 5, RLENGTH - 6)
}
