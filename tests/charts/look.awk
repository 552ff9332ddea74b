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
		alt = figure
		if (figure ~ / role="img"/) {
			within++
			if (figure !~ /<svg class=broad viewBox=/ || figure !~ /<\/svg>\n<svg class=narrow viewBox=/)
				print id ": not drawn for both widths"
			sub(/.* aria-label="/, "", alt)
		} else {
			if (figure !~ /<img src="[^"]+\.svg"/) print id ": no picture"
			if (alt !~ / alt="[^"]*"/) print id ": no alt"
			if (figure !~ /width="[0-9]+" height="[0-9]+"/) print id ": no size"
			sub(/.* alt="/, "", alt)
		}
		sub(/".*/, "", alt)
		if (length(alt) < 30 || alt == id) print id ": its alt is \"" alt "\""
		caption = figure
		sub(/.*<figcaption>/, "", caption); sub(/<\/figcaption>.*/, "", caption)
		if (caption == figure || length(caption) < 60) print id ": its caption is \"" caption "\""
	}
	if (count("<img ") != n - 1 - within) print "pictures outside of figures"
	split("figure details table figcaption picture", tags, " ")
	for (i = 1; i in tags; i++)
		if (count("<" tags[i] ">") + count("<" tags[i] " ") != count("</" tags[i] ">"))
			print tags[i] " is left open"
	at = split(text, part, " id=")
	for (i = 2; i <= at; i++) {
		sub(/^["']?/, "", part[i]); sub(/[^-_A-Za-z0-9].*/, "", part[i])
		if (part[i] in given) print "id " part[i] " stands twice"
		given[part[i]] = 1
	}
	if (text ~ /<script/ || text ~ /https?:/) print "something from elsewhere"
	if (text ~ /is missing|has no rows/) print "something is missing"
}
