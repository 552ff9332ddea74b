# SPDX-License-Identifier: GPL-3.0-or-later
# A page of --report: every element is closed, in the order in which it was opened; all its sections are there, and each
# link leads to one; nothing is fetched from elsewhere. nonlinear=1: of a model without poles. A record is a tag without
# its <, and the text behind it.
function wrong(what) {
	print what
	failed = 1
}

BEGIN {
	RS = "<"
}

NR < 4 {
	if (substr($0, 1, 16) != (NR == 1 ? "" : NR == 2 ? "!DOCTYPE html>\n" : "html lang=\"en\">\n"))
		wrong("no page of HTML")
	if (NR < 3)
		next
}

/^!\[CDATA\[/ {
	cdata = 1
}
cdata {
	cdata = !index($0, "]]>")
	next
}

{
	end = index($0, ">")
	tag = substr($0, 1, end - 1)
	between = substr($0, end + 1)
	if (end == 0)
		wrong("no end of a tag: " substr($0, 1, 60))
	gsub(/xmlns(:xlink)?="[^"]*"/, "")
	if (/(src|href)="[^#]/ || /https?:/)
		wrong("something is fetched")
	if (match(tag, /^h2 id="s[0-9]+"$/))
		headed[between] = 1
	if (match(tag, /^a href="#s[0-9]+"$/))
		linked[between] = 1
	there[between] = 1
}

tag !~ /^!--/ && tag !~ /\/$/ {
	match(tag, /^\/?[A-Za-z0-9]+/)
	word = substr(tag, 1, RLENGTH)
	if (word !~ /^\//)
		name[++depth] = word
	else if (depth < 1 || "/" name[depth--] != word)
		wrong("not closed in order: " tag)
}

between ~ />/ && name[depth] != "style" {
	wrong("a > that is no tag's: " substr(between, 1, 60))
}

END {
	if (depth != 0)
		wrong("not closed: " name[depth])
	linear = "Poles and modes;Poles in the plane;Mode shapes"
	other = "What is not reported, and why"
	n = split("Equations;Matrices;What was chosen, and why;Cost and error of a step;" \
	          (nonlinear ? other : linear), section, ";")
	m = split((nonlinear ? linear ";Static gains and zeros;Frequency responses" : other), absent, ";")
	for (i = 1; i <= m; i++)
		if (absent[i] in there)
			wrong("a section " absent[i])
	for (i = 1; i <= n; i++)
		if (!(section[i] in headed) || !(section[i] in linked))
			wrong("no section " section[i])
	exit failed
}
