# SPDX-License-Identifier: GPL-3.0-or-later
# awk -f svg.awk PICTURE.svg: gnuplot's SVG in a fifth of its bytes, to the eye the same. A tenth of a pixel
# is the unit and points within two of a line that goes on are left out; what lines, marks, areas and texts have in
# common is said once; marks that are not drawn are not defined, and a mark at many places is a marker of one path. Of
# what lies between two curves areas come first, then lines and marks; texts come last of all; what is none of these
# stays as it was, ten times as large.
function attribute(name,    value) {
	if (!match(tag, "[ \n\t]" name " *= *('[^']*'|\"[^\"]*\")")) return ""
	value = substr(tag, RSTART, RLENGTH)
	sub(/^[^'"]*['"]/, "", value)
	return substr(value, 1, length(value) - 1)
}
# name="value", where there is one
function said(name, value) { return value == "" ? "" : " " name "=\"" value "\"" }
function colour(text,    part) {
	if (text == "black") return "#000"
	if (text !~ /^rgb/) return text
	gsub(/[rgb() ]/, "", text)
	split(text, part, ",")
	return sprintf("#%02x%02x%02x", part[1], part[2], part[3])
}
function tenths(x) { return x < 0 ? -int(-10 * x + 0.5) : int(10 * x + 0.5) }
function pair(a, b) { return a (b < 0 ? "" : " ") b }
# A list of numbers, each in tenths
function rounded(text,    part, n, i) {
	if (text !~ /^[-+0-9., ]+(px)?$/) return text
	n = split(text, part, ",")
	text = tenths(part[1])
	for (i = 2; i <= n; i++) text = text "," tenths(part[i])
	return text
}

# ---- lines ----

# Whether points from + 1 to to - 1 lie within a tenth of a pixel of the straight one from `from` to `to`, and in order
function straight(from, to,    dx, dy, size, i, along, across) {
	dx = X[to] - X[from]; dy = Y[to] - Y[from]
	size = sqrt(dx * dx + dy * dy)
	if (size == 0) return 0
	for (i = from + 1; i < to; i++) {
		along = (dx * (X[i] - X[from]) + dy * (Y[i] - Y[from])) / size
		across = (dx * (Y[i] - Y[from]) - dy * (X[i] - X[from])) / size
		if (along < 0 || along > size || across > 2 || across < -2) return 0
	}
	return 1
}
# One polyline X, Y of tenths, closed or not, after what its path has, which ends in x_of, y_of; the points of marks all
# stay
function polyline(path, count, closed, all,    text, i, at, last, dx, dy) {
	if (count < 1 || (count == 1 && !all)) return
	text = path in x_of ? "m" pair(X[1] - x_of[path], Y[1] - y_of[path]) : "M" pair(X[1], Y[1])
	x_of[path] = X[closed ? 1 : count]; y_of[path] = Y[closed ? 1 : count]
	last = ""
	for (at = 1; at < count; at = i) {
		for (i = at + 1; !all && i < count && i < at + 60 && straight(at, i + 1); i++) ;
		dx = X[i] - X[at]; dy = Y[i] - Y[at]
		if (!all && dx == 0 && dy == 0) continue
		if (dy == 0) { text = text "h" dx; last = "h" }
		else if (dx == 0) { text = text "v" dy; last = "v" }
		else if (last == "l") text = text (dx < 0 ? "" : " ") pair(dx, dy)
		else { text = text "l" pair(dx, dy); last = "l" }
	}
	if (all && count == 1) text = text "h0"
	hold(path, text (closed ? "z" : ""))
}
# d of a path of straight lines
function lines_of(path, d,    word, words, i, n, at) {
	gsub(/[\n\t]/, " ", d)
	words = split(d, word, " ")
	n = 0
	for (i = 1; i <= words; i++) {
		if (word[i] ~ /^[Zz]$/) { polyline(path, n, 1, 0); n = 0; continue }
		if (word[i] ~ /^M/) { polyline(path, n, 0, 0); n = 0 }
		split(substr(word[i], 2), at, ",")
		n++; X[n] = tenths(at[1]); Y[n] = tenths(at[2])
	}
	polyline(path, n, 0, 0)
}
function area_of(path, points,    word, words, i, at) {
	words = split(points, word, /[ \n\t]+/)
	for (i = 1; i <= words && word[i] != ""; i++) {
		split(word[i], at, ",")
		X[i] = tenths(at[1]); Y[i] = tenths(at[2])
	}
	polyline(path, i - 1, 1, 0)
}

# ---- what stands between two curves ----

# held[place], place: kind, key; of kind area, line or mark
function hold(place, text,    part) {
	if (!(place in held)) {
		split(place, part, SUBSEP)
		held[place] = ""; keys[part[1]]++; key_of[part[1], keys[part[1]]] = part[2]
	}
	held[place] = held[place] text
}
function flush(    kinds, kind, k, i, key, text) {
	kinds = split("area line mark", kind, " ")
	for (k = 1; k <= kinds; k++)
		for (i = 1; i <= keys[kind[k]]; i++) {
			key = key_of[kind[k], i]; text = held[kind[k], key]
			if (text != "") body = body "<path" key " d=\"" text "\"/>\n"
		}
	split("", held); split("", keys); split("", key_of); split("", x_of); split("", y_of)
}
function hold_text(key, text) {
	if (!(key in texts)) { key_of_text[++text_keys] = key; texts[key] = "" }
	texts[key] = texts[key] text
}
function all_texts(    i, key, text) {
	for (i = 1; i <= text_keys; i++) {
		key = key_of_text[i]
		text = text "<g" key ">\n" texts[key] "</g>\n"
	}
	return text
}
function short_id(text) { gsub(/gpPt/, "p", text); return text }
function mark(    where, at, size, key, n) {
	where = attribute("transform")
	size = where; sub(/.*scale\(/, "", size); sub(/\).*/, "", size)
	sub(/.*translate\(/, "", where); sub(/\).*/, "", where)
	split(where, at, ",")
	key = short_id(substr(attribute("xlink:href"), 2)) SUBSEP size SUBSEP colour(attribute("color"))
	if (!(key in marker)) { marker[key] = ++markers; marker_key[markers] = key }
	n = ++marks[marker[key]]
	mark_x[marker[key], n] = tenths(at[1]); mark_y[marker[key], n] = tenths(at[2])
}
function hold_marks(    m, i) {
	for (m = 1; m <= markers; m++) {
		if (!marks[m]) continue
		for (i = 1; i <= marks[m]; i++) { X[i] = mark_x[m, i]; Y[i] = mark_y[m, i] }
		polyline("mark" SUBSEP " style=\"marker:url(#m" m ")\"", marks[m], 0, 1)
		marks[m] = 0
	}
}
function end_of_segment() { hold_marks(); flush() }

# ---- text ----

function text_key() {
	return said("fill", colour(attribute("fill"))) said("font-size", rounded(attribute("font-size"))) \
		said("text-anchor", attribute("text-anchor") == "start" ? "" : attribute("text-anchor")) \
		said("font-weight", attribute("font-weight")) said("font-style", attribute("font-style"))
}
function text_place(    where, at) {
	where = attribute("transform")
	match(where, /\([^)]*\)/)
	split(substr(where, RSTART + 1, RLENGTH - 2), at, ",")
	if (where ~ /rotate/) {
		sub(/.*rotate/, "rotate", where)
		return " transform=\"translate(" pair(tenths(at[1]), tenths(at[2])) ")" where "\""
	}
	return " x=\"" tenths(at[1]) "\" y=\"" tenths(at[2]) "\""
}
function span(    own) {
	own = said("font-size", rounded(attribute("font-size"))) said("dy", rounded(attribute("dy"))) \
		said("fill", colour(attribute("fill"))) said("font-weight", attribute("font-weight")) \
		said("font-style", attribute("font-style"))
	spans++
	plain[spans] = own == ""
	return own == "" ? "" : "<tspan" own ">"
}
# A power's exponent in the letters that there are for it: 10 with a raised -12 takes 9 bytes, not 46
function with_exponent(text,    at, exponent, i) {
	at = match(text, /<tspan font-size="[0-9]+" dy="-[0-9]+">-?[0-9]+<\/tspan>$/)
	if (!at) return text
	exponent = substr(text, at)
	gsub(/<[^>]*>/, "", exponent)
	text = substr(text, 1, at - 1)
	if (sub(/^-/, "", exponent)) text = text "⁻"
	for (i = 1; i <= length(exponent); i++) text = text RAISED[substr(exponent, i, 1)]
	return text
}
function end_of_text() {
	gsub(/<tspan[^>]*><\/tspan>$/, "", content)
	content = with_exponent(content)
	gsub(/\n/, " ", content); gsub(/  /, " \\&#160;", content)
	if (content != "") hold_text(key, "<text" place ">" content "</text>\n")
}

# ---- tag by tag ----

function group() {
	depth++
	if (attribute("id") != "") { kind_of[depth] = "curve"; end_of_segment(); curve = 1; return }
	if (attribute("font-size") != "") {
		kind_of[depth] = "text"; key = text_key(); place = text_place()
		if (family == "") family = attribute("font-family")
		return
	}
	if (attribute("shape-rendering") != "") { kind_of[depth] = "area"; return }
	kind_of[depth] = "state"
	ink = colour(attribute("color")); stroke = colour(attribute("stroke")); width = attribute("stroke-width") + 0
}
function end_of_group() {
	if (kind_of[depth] == "curve") {
		end_of_segment()
		if (titled) body = body "</g>\n"
		titled = 0
	}
	depth--
}
function path(    line, d) {
	d = attribute("d")
	line = colour(attribute("stroke"))
	if (line == "") line = stroke
	if (line == "currentColor") line = ink
	line = said("stroke", line) said("stroke-width", width == 1 ? "" : tenths(width)) \
		said("stroke-dasharray", rounded(attribute("stroke-dasharray")))
	if (attribute("fill") != "") line = line said("fill", colour(attribute("fill")))
	if (d ~ /[^-MLZz0-9., \n\t]/) other()
	else lines_of("line" SUBSEP line, d)
}
function other(    text, i, length_name, part) {
	end_of_segment()
	text = tag
	gsub(/[ \n\t]+/, " ", text)
	if (name == "image") sub(/ preserve/, " image-rendering=\"pixelated\"&", text)
	if (name == "path") text = text " transform=\"scale(10)\""
	else for (i = split("x y width height cx cy r", length_name, " "); i > 0; i--)
		if (match(text, " " length_name[i] " ?= ?'[0-9.]+'")) {
			split(substr(text, RSTART, RLENGTH), part, "'")
			text = substr(text, 1, RSTART - 1) said(length_name[i], tenths(part[2])) \
				substr(text, RSTART + RLENGTH)
		}
	body = body "<" text ">\n"
}
BEGIN {
	RS = "<"
	split("⁰ ¹ ² ³ ⁴ ⁵ ⁶ ⁷ ⁸ ⁹", raised, " ")
	for (i = 0; i < 10; i++) RAISED[i] = raised[i + 1]
}
{
	end = index($0, ">")
	tag = substr($0, 1, end - 1); text = substr($0, end + 1)
	name = tag; sub(/[ \n\t].*/, "", name)
}
name == "svg" {
	view = attribute("viewBox"); wide = attribute("width"); high = attribute("height")
	gsub(/[1-9][0-9]*/, "&0", view)
	next
}
name == "defs" && !defined { defining = 1; next }
name == "/defs" && defining { defining = 0; defined = 1; next }
defining {
	if (tag ~ /id='gp/) {
		gsub(/[ \n\t]+/, " ", tag)
		gsub(/ c[xy]='0'/, "", tag)                     # these are so anyway, and a shape has its own stroke
		if (tag ~ /href/) gsub(/ stroke='(none|currentColor)'/, "", tag)
		gsub(/,-/, "-", tag); gsub(/,0\./, ",.", tag); gsub(/'0\./, "'.", tag); gsub(/-0\./, "-.", tag)
		gsub(/ L/, "L", tag); gsub(/ z/, "z", tag)
		shape[short_id(attribute("id"))] = "<" short_id(tag) ">"
	}
	next
}
name == "rect" && ground == "" {
	ground = "<rect width=\"100%\" height=\"100%\"" said("fill", attribute("fill")) "/>"
	next
}
# A curve's name, where it is not how it was plotted
name == "title" && curve {
	curve = 0
	if (text !~ /using|gnuplot_plot/) { body = body "<g><title>" text "</title>\n"; titled = 1 }
	next
}
name == "title" || name == "/title" || name == "desc" || name == "/desc" || name == "/svg" || name == "/text" {
	if (name == "/text") { writing = 0; end_of_text() }
	next
}
name == "g" && tag ~ /gnuplot_canvas/ { next }
name == "g" { group(); next }
name == "/g" { if (depth > 0) end_of_group(); next }
name == "text" || name == "text/" { content = text; writing = 1; spans = 0; next }
writing && name == "tspan" { content = content span() text; next }
writing && name == "/tspan" { content = content (plain[spans--] ? "" : "</tspan>") text; next }
name == "path" { path(); next }
name == "use" { mark(); next }
name == "polygon" {
	area_of("area" SUBSEP said("fill", colour(attribute("fill"))) said("fill-opacity", \
		attribute("fill-opacity")) " shape-rendering=\"crispEdges\"", attribute("points"))
	next
}
# the head of the file
defined { other() }
function define(id,    within) {
	if (id in given) return ""
	given[id] = 1
	within = ""
	if (shape[id] ~ /href='#/) {
		within = shape[id]; sub(/.*href='#/, "", within); sub(/'.*/, "", within)
		within = define(within)
	}
	sub(/xlink:href/, "href", shape[id])
	return within shape[id] "\n"
}
END {
	end_of_segment()
	print "<svg" said("width", wide) said("height", high) said("viewBox", view) \
		" xmlns=\"http://www.w3.org/2000/svg\">"
	if (markers) {
		printf "<style>marker { overflow: visible; fill: none }</style>\n<defs>\n"
		for (m = 1; m <= markers; m++) {
			split(marker_key[m], part, SUBSEP)
			printf "%s", define(part[1])
		}
		for (m = 1; m <= markers; m++) {
			split(marker_key[m], part, SUBSEP)
			print "<marker" said("id", "m" m) "><use" \
				said("href", "#" part[1]) said("transform", "scale(" part[2] ")") \
				said("color", part[3]) "/></marker>"
		}
		print "</defs>"
	}
	print ground
	printf "<g fill=\"none\" stroke-width=\"10\"%s>\n%s%s</g>\n</svg>\n", said("font-family", family), body, \
		all_texts()
}
