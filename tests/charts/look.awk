# SPDX-License-Identifier: GPL-3.0-or-later
# awk -f look.awk PAGE.html: what a page of the charts lacks: pictures without a text to be read aloud, a caption or a
# size, captions of pictures that are not there, ids that stand twice, parts left open.
{ text = text $0 "\n" }
function count(what,    rest, n, at) {
	rest = text
	while ((at = index(rest, what)) > 0) { n++; rest = substr(rest, at + length(what)) }
	return n + 0
}
END {
	n = split(text, part, "<figure")
	for (i = 2; i <= n; i++) {
		figure = part[i]
		sub(/<\/figure>.*/, "", figure)
		id = figure
		sub(/^ id="/, "", id); sub(/".*/, "", id)
		if (id in seen) print id ": stands twice"
		seen[id] = 1
		if (figure !~ /<img src="[^"]+\.svg"/) print id ": no picture"
		alt = figure
		if (alt !~ / alt="[^"]*"/) print id ": no alt"
		sub(/.* alt="/, "", alt); sub(/".*/, "", alt)
		if (length(alt) < 30 || alt == id) print id ": its alt is \"" alt "\""
		if (figure !~ /width="[0-9]+" height="[0-9]+"/) print id ": no size"
		caption = figure
		sub(/.*<figcaption>/, "", caption); sub(/<\/figcaption>.*/, "", caption)
		if (caption == figure || length(caption) < 60) print id ": its caption is \"" caption "\""
	}
	if (count("<img ") != n - 1) print "pictures outside of figures"
	split("figure details table figcaption picture", tags, " ")
	for (i = 1; i in tags; i++)
		if (count("<" tags[i] ">") + count("<" tags[i] " ") != count("</" tags[i] ">"))
			print tags[i] " is left open"
	if (text ~ /<script/ || text ~ /https?:/) print "something from elsewhere"
	if (text ~ /is missing|has no rows/) print "something is missing"
}
