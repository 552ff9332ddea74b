# SPDX-License-Identifier: GPL-3.0-or-later
# awk -v css=style.css -f dark.awk PICTURE.svg: a picture of svg.awk with the style for readers in the dark that
# style.css has for pictures within pages. It names the colours that style.gp gives to text, axes and ground; those of
# methods have enough contrast with either ground (palette.list).
function style(    line, within, last) {
	while ((getline line < css) > 0) {
		last = line == "}"
		sub(/^\t/, "", line); gsub(/, /, ",", line); gsub(/: #/, ":#", line); gsub(/ *{ */, "{", line)
		sub(/ }$/, "}", line)
		if (within) print (within++ == 1 ? "<style>" : "") line (last ? "</style>" : "")
		if (last) within = 0
		if (line ~ /^\/\* Of pictures/) within = 1
	}
}
{ print }
NR == 1 { style() }
