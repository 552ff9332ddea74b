# SPDX-License-Identifier: GPL-3.0-or-later
# awk -f dark.awk PICTURE.svg: the same with a style for readers in the dark. It names the colours that style.gp gives
# to text, axes and ground; those of methods have enough contrast with either ground (palette.list).
{ print }
/^>$/ && !done {
	done = 1
	print "<style>@media screen and (prefers-color-scheme: dark) {"
	print "#gnuplot_canvas > rect:first-of-type { fill: #14171c }"
	print "[fill='rgb(32,32,32)'], [fill='black'] { fill: #e4e6ea }"
	print "[fill='rgb(64,64,64)'], [fill='rgb(80,80,80)'] { fill: #b4b8c0 }"
	print "[stroke='rgb( 64,  64,  64)'] { stroke: #8a9099 }"
	print "[stroke='rgb(220, 220, 220)'] { stroke: #343a44 }"
	print "polygon[fill='rgb(255, 255, 255)'] { fill: #14171c }"
	print "}</style>"
}
