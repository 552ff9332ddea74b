# SPDX-License-Identifier: GPL-3.0-or-later
# awk -f dark.awk PICTURE.svg: a picture of svg.awk with a style for readers in the dark. It names the colours that
# style.gp gives to text, axes and ground; those of methods have enough contrast with either ground (palette.list).
{ print }
NR == 1 {
	print "<style>@media screen and (prefers-color-scheme: dark) {"
	print "svg > rect:first-of-type, path[fill='#ffffff'] { fill: #14171c }"
	print "[fill='#202020'], [fill='#000'] { fill: #e4e6ea }"
	print "[fill='#404040'], [fill='#505050'] { fill: #b4b8c0 }"
	print "[stroke='#404040'] { stroke: #8a9099 }"
	print "[stroke='#dcdcdc'] { stroke: #343a44 }"
	print "}</style>"
}
