# SPDX-License-Identifier: GPL-3.0-or-later
# A page of --report: every element is closed, in the order in which it was opened; all its sections are there, and each
# link leads to one; nothing is fetched from elsewhere. nonlinear=1: of a model without poles.
{
	text = text $0 "\n"
}

function wrong(what) {
	print what
	failed = 1
}

END {
	if (text !~ /^<!DOCTYPE html>\n<html lang="en">/)
		wrong("no page of HTML")
	gsub(/<!DOCTYPE html>/, "", text)
	gsub(/<!\[CDATA\[[^\]]*\]\]>/, "", text)
	rest = text
	while (match(rest, /<[^>]*>/)) {
		tag = substr(rest, RSTART, RLENGTH)
		between = substr(rest, 1, RSTART - 1)
		rest = substr(rest, RSTART + RLENGTH)
		if (between ~ />/ && name[depth] != "style")
			wrong("a > that is no tag's: " substr(between, 1, 60))
		if (tag ~ /^<!--/ || tag ~ /\/>$/)
			continue
		match(tag, /^<\/?[A-Za-z0-9]+/)
		word = substr(tag, 2, RLENGTH - 1)
		if (word !~ /^\//)
			name[++depth] = word
		else if (depth < 1 || "/" name[depth--] != word)
			wrong("not closed in order: " tag)
	}
	if (depth != 0)
		wrong("not closed: " name[depth])
	linear = "Poles and modes;Poles in the plane;Mode shapes"
	other = "What is not reported, and why"
	n = split("Equations;Matrices;What was chosen, and why;Cost and error of a step;" \
	          (nonlinear ? other : linear), section, ";")
	m = split((nonlinear ? linear ";Static gains and zeros;Frequency responses" : other), absent, ";")
	for (i = 1; i <= m; i++)
		if (text ~ (">" absent[i] "<"))
			wrong("a section " absent[i])
	for (i = 1; i <= n; i++)
		if (text !~ ("<h2 id=\"s[0-9]+\">" section[i] "</h2>") ||
		    text !~ ("<a href=\"#s[0-9]+\">" section[i] "</a>"))
			wrong("no section " section[i])
	gsub(/xmlns(:xlink)?="[^"]*"/, "", text)
	if (text ~ /(src|href)="[^#]/ || text ~ /https?:/)
		wrong("something is fetched")
	exit failed
}
