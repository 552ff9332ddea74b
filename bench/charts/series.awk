# SPDX-License-Identifier: GPL-3.0-or-later
# awk -v palette=palette.list -v where='model=scs;quantity=largest' -v x=ns_median -v y=largest [-v by=method]
#     [-v xfactor=1e-3] [-v yfactor=1] [-v skip=REGEX] [-v with=lines|points] [-v abs=1] [-v any=1] [-v xzero=1e-12]
#     [-v most=10 [-v rank=last] [-v keep=REGEX] [-v rest=no]] -f csv.awk -f series.awk FILE.csv
# prints gnuplot: a data block for each method that has rows with numbers above 0 in both columns (above or below, with
# -v any=1), and `clauses`, what to plot of them; abs: of absolute values of y; xzero: where 0 stands on a log axis.
# A column may hold a list in each row (fold.awk).
# A method has the colour of its group and, in one picture, a mark of its own: ours filled marks and unbroken lines,
# peers open marks and thin lines, dashed by group, so they stay apart in black and white too.
# most: no more entries in the legend than that. Of ours and of the peers those stay that come nearest to the cheapest
# of their side at some error (rank=last: those with the least y at their last x), and peers whose name fits keep; all
# others become one grey entry, or with rest=no nothing.

function group(pattern, name) { groups++; pattern_of[groups] = pattern; group_name[groups] = name }
function wanted(field,    i) {
	for (i = 1; i <= conditions; i++)
		if (field[condition_column[i]] != condition_value[i]) return 0
	return 1
}
# By family where there is one, and then by name
function group_of(name, family,    i) {
	if (family == "ours") return name ~ /^exact/ ? "exact" : "scheme"
	for (i = family == "" ? 1 : 4; i <= groups; i++)
		if (name ~ pattern_of[i]) return group_name[i]
	return family == "propagator" ? "matrix" : family in colour ? family : "other"
}
# The first mark of the group that none of it has in this picture
function mark_of(of,    n, i, mark) {
	n = split(marks[of], mark, ",")
	for (i = 1; i <= n; i++)
		if (!((of, mark[i]) in taken)) { taken[of, mark[i]] = 1; return mark[i] }
	return mark[1 + used[of]++ % n]
}
function clause(k, of,    ours, style) {
	ours = of == "exact" || of == "scheme"
	style = with == "lines" ? "lines" : with == "points" ? "points" : "linespoints"
	return sprintf("$series_%d using 1:2 with %s", k, style) \
		(style == "lines" ? "" : sprintf(" pt %d ps %s", mark_of(of), ours ? 1.1 : 1.0)) \
		sprintf(" lc rgb '%s'", colour[of]) (style == "points" ? "" : " dt " dash[of]) \
		sprintf(" lw %s title \"%s\"", style == "points" ? 1.8 : ours ? 2.4 : 1.5, name_of[k])
}
# The least x at an error of at most 10^-e, and that of the side
function least(k, e,    i, best) {
	best = ""
	for (i = 1; i <= count[k]; i++)
		if (ordinate[k, i] <= 10^-e && (best == "" || abscissa[k, i] < best)) best = abscissa[k, i]
	return best
}
function score_all(    k, e, cost, side, least_of) {
	for (k = 1; k <= names; k++) score[k] = rank == "last" ? ordinate[k, count[k]] : 1e300
	if (rank == "last") return
	for (e = 1; e <= 14; e++) {
		split("", least_of)
		for (k = 1; k <= names; k++) {
			cost = least(k, e); side = family_of[k] == "ours"
			if (cost != "" && (!(side in least_of) || cost < least_of[side])) least_of[side] = cost
		}
		for (k = 1; k <= names; k++) {
			cost = least(k, e); side = family_of[k] == "ours"
			if (cost != "" && cost / least_of[side] < score[k]) score[k] = cost / least_of[side]
		}
	}
}
# The n best of a side stay
function choose(ours, n,    i, k, best) {
	for (i = 1; i <= n; i++) {
		best = 0
		for (k = 1; k <= names; k++)
			if ((family_of[k] == "ours") == ours && !(k in chosen) && (best == 0 || score[k] < score[best]))
				best = k
		if (best) chosen[best] = 1
	}
}
function choose_all(    k, ours, of_ours, of_peers) {
	for (k = 1; k <= names; k++) ours += family_of[k] == "ours"
	if (most == "" || names <= most) { for (k = 1; k <= names; k++) chosen[k] = 1; return }
	score_all()
	of_ours = ours < int((most - 1) / 2) ? ours : int((most - 1) / 2)
	of_peers = most - 1 - of_ours
	if (names - ours < of_peers) { of_peers = names - ours; of_ours = most - 1 - of_peers }
	for (k = 1; keep != "" && k <= names; k++)
		if (family_of[k] == "peer" && name_of[k] ~ keep && of_peers > 0) { chosen[k] = 1; of_peers-- }
	choose(1, of_ours)
	choose(0, of_peers)
}
function point(at, value,    k) {
	if (!is_number(at) || !is_number(value)) return
	if (abs && value < 0) value = -value
	if (xzero != "" && at == 0) at = xzero
	if (!any && (at + 0 <= 0 || value + 0 <= 0)) return
	if (!(name in number)) {
		number[name] = ++names; name_of[names] = name
		of[names] = group_of(name, "family" in column ? row[column["family"]] : "")
		family_of[names] = of[names] == "exact" || of[names] == "scheme" ? "ours" : "peer"
	}
	k = number[name]
	abscissa[k, ++count[k]] = at * xfactor
	ordinate[k, count[k]] = value * yfactor
	points[k] = points[k] sprintf("%.10g,%.10g\n", at * xfactor, value * yfactor)
}
BEGIN {
	by = by == "" ? "method" : by
	xfactor = xfactor == "" ? 1 : xfactor
	yfactor = yfactor == "" ? 1 : yfactor
	while ((getline line < palette) > 0)
		if (split(line, part, " ") == 4 && line !~ /^#/) {
			colour[part[1]] = part[2]; dash[part[1]] = part[3]; marks[part[1]] = part[4] }
	# the first pattern that fits counts; the first three are ours
	group("^modes$", "scheme")
	group("^(exact|modes)", "exact")
	group("^(pl|etd|nc2|nc3|dq4|bm3|taylor|radau|auto|frozen)", "scheme")
	group("implicit trapez|Newmark|alpha|Bathe", "implicit")
	group("Euler|trapez|^RK4|central|fixed step|^CR|Blanes|Kahan", "fixed")
	group("^elements", "fixed")
	group("Dormand|DOP853|ode45|rk8pd|msadams|bsimp|Adams|BDF|ARKODE|RADAU|^balanced", "adaptive")
	group("^exp\\(|odal", "matrix")
}
NR == 1 {
	n = split_row($0, head)
	for (i = 1; i <= n; i++) column[head[i]] = i
	conditions = where == "" ? 0 : split(where, condition, ";")
	for (i = 1; i <= conditions; i++) {
		split(condition[i], part, "=")
		condition_column[i] = column[part[1]]; condition_value[i] = part[2]
	}
	if (!(by in column) || !(x in column) || !(y in column)) {
		print "series.awk: no column " by ", " x " or " y > "/dev/stderr"; exit 1 }
	next
}
{
	split("", row)
	split_row($0, row)
	name = row[column[by]]
	if (!wanted(row) || (skip != "" && name ~ skip)) next
	n = split(row[column[x]], at_of, " ")
	split(row[column[y]], value_of, " ")
	for (i = 1; i <= n; i++) point(at_of[i], value_of[i])
}
END {
	choose_all()
	text = ""
	for (k = 1; k <= names; k++)
		if (!(k in chosen)) { others++; grey = grey (grey == "" ? "" : "\n") points[k] }
	if (others && rest != "no") {
		printf "$others << EOD\n%sEOD\n", grey
		text = "$others using 1:2 with " (with == "points" ? "points pt 7 ps 0.4" : "lines lw 0.7") \
			" lc rgb '" colour["other"] "' title \"" others " others, in the table\""
	}
	# ours last, above all others
	for (side = 0; side < 2; side++)
		for (k = 1; k <= names; k++) {
			if (!(k in chosen) || (family_of[k] == "ours") != side) continue
			printf "$series_%d << EOD\n%sEOD\n", k, points[k]
			text = text (text == "" ? "" : ", ") clause(k, of[k])
		}
	gsub(/"/, "\\\"", text)
	printf "clauses = \"%s\"\n", text != "" ? text : "1/0 notitle"
}
