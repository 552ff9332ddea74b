# SPDX-License-Identifier: GPL-3.0-or-later
# awk -v where='model=scs;quantity=largest' -v x=ns_median -v y=largest [-v by=method] [-v xfactor=1e-3] [-v yfactor=1]
# [-v skip=REGEX]
#     [-v with=lines|points] [-v abs=1] [-v xzero=1e-12] -f csv.awk -f series.awk FILE.csv
# prints gnuplot: a data block for each method that has rows with numbers above 0 in both columns (above or below, with
# -v any=1), and `clauses`, what to plot of them; abs: of absolute values of y; xzero: where 0 stands on a log axis. A
# method looks alike in every chart: ours filled marks and thick unbroken lines, peers open marks and thin lines,
# dashed by family, so they stay apart in black and white too. What is not in the table below gets a look by its turn.

function look(pattern, mark, colour, dash) { looks++; pattern_of[looks] = pattern; mark_of[looks] = mark;
	colour_of[looks] = colour; dash_of[looks] = dash }
function wanted(field,    i) {
	for (i = 1; i <= conditions; i++)
		if (field[condition_column[i]] != condition_value[i]) return 0
	return 1
}
function of_table(name,    i) {
	for (i = 1; i <= looks; i++)
		if (name ~ pattern_of[i]) return i
	return 0
}
function clause(k, name,    i, dash, thick, width, size) {
	i = of_table(name)
	if (i == 0) { i = 1 + looks; mark_of[i] = 1 + (k - 1) % 3; colour_of[i] = "#808080"; dash_of[i] = "'--.'" }
	dash = dash_of[i] == "" ? 1 : dash_of[i]
	thick = dash == 1 || dash ~ /^\+/
	sub(/^\+/, "", dash)
	width = thick ? 2.6 : 1.5
	size = thick ? 1.2 : 1.1
	if (with == "lines")
		return sprintf("$series_%d using 1:2 with lines lc rgb '%s' dt %s lw %s title '%s'", k, colour_of[i],
		dash, width, name)
	return sprintf("$series_%d using 1:2 with " (with == "points" ? "points" \
		: "linespoints") " pt %d ps %s lc rgb '%s'" (with == "points" ? "" : " dt " dash) " lw %s title '%s'",
		k, mark_of[i], size, colour_of[i], with == "points" ? 1.6 : width, name)
}
BEGIN {
	by = by == "" ? "method" : by
	xfactor = xfactor == "" ? 1 : xfactor
	yfactor = yfactor == "" ? 1 : yfactor
	# ours: filled marks (5 square, 7 disc, 9 and 11 triangles, 13 diamond, 15 pentagon), thick, unbroken but where
	# marks run out (a dash with +); the first pattern that fits counts
	look("^(exact, )?float.*compensated",   15, "#604000")
	look("^(exact, )?float.*delta",         13, "#f0b000")
	look("^(exact, )?float.*kick",          11, "#b07000")
	look("^(exact, )?float.*direct",         9, "#d08000")
	look("^(exact, )?float",                 5, "#b07000")
	look("^exact in regions",               12, "#007040", "2")
	look("^exact.*compensated",             15, "#a00000")
	look("^exact.*delta",                   13, "#ff6060")
	look("^exact.*kick",                    11, "#c00060")
	look("^exact.*direct",                   5, "#900040")
	look("^exact",                           7, "#d00000")
	look("^pl",                              5, "#000000")
	look("^etd1",                            5, "#f0a000", "+2")
	look("^etdrk2",                          9, "#f07000")
	look("^etdrk4",                         13, "#d03000")
	look("^nc2",                            11, "#905000")
	look("^nc3",                            15, "#c09000")
	look("^dq4",                             5, "#a00050", "+4")
	look("^bm3",                             7, "#203080", "+5")
	look("^taylor$",                         7, "#d000d0")
	look("^taylor",                          9, "#8000a0", "+3")
	# fixed steps: dashed
	look("Euler",                            1, "#007040", "2")
	look("explicit trapez",                  2, "#40a000", "2")
	look("trapez",                           3, "#80a000", "2")
	look("RK4, inlined",                    14, "#00602f", "2")
	look("RK4",                              6, "#00602f", "2")
	look("Blanes",                           3, "#2080a0", "2")
	look("Kahan",                            2, "#2080a0", "2")
	look("central difference, inlined",      1, "#309090", "2")
	look("central difference",               4, "#309090", "2")
	look("Newmark",                         12, "#207020", "2")
	look("alpha",                            8, "#60a060", "2")
	# adaptive: dotted
	look("Dormand",                          4, "#0050c0", "3")
	look("ode45",                            4, "#0050c0", "3")
	look("rk8pd.*fixed",                    14, "#008060", "2")
	look("rk8pd",                            6, "#0090e0", "3")
	look("msadams",                          8, "#6040c0", "3")
	look("Adams, roots",                     6, "#3030a0", "3")
	look("Adams",                           10, "#3030a0", "3")
	look("BDF",                             12, "#8000c0", "3")
	look("ARKODE DIRK",                      1, "#0070a0", "3")
	look("ARKODE",                          14, "#0070a0", "3")
	look("DOP853",                          12, "#0000ff", "3")
	look("RADAU5",                           2, "#a000ff", "3")
	look("RADAU9",                           3, "#a000ff", "3")
	look("RADAU13",                          8, "#a000ff", "3")
	look("bsimp",                            1, "#00a0ff", "3")
	# propagators: dash and dot
	look("^exp\\(.*literals, float",         2, "#a08040", "4")
	look("^exp\\(.*float",                  3, "#c0a060", "4")
	look("^exp\\(.*rounded, literals",      6, "#000000", "4")
	look("^exp\\(.*literals",               4, "#505050", "4")
	look("^exp\\(.*CBLAS",                   14, "#606060", "4")
	look("^exp\\(.*rounded",                12, "#000000", "4")
	look("^exp\\(.*fixed",                    8, "#906000", "4")
	look("^exp\\(",                          10, "#303030", "4")
	look("odal",                             1, "#808080", "4")
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
	name = row[column[by]]; abscissa = row[column[x]]; ordinate = row[column[y]]
	if (!wanted(row) || (skip != "" && name ~ skip)) next
	if (!is_number(abscissa) || !is_number(ordinate)) next
	if (abs && ordinate < 0) ordinate = -ordinate
	if (xzero != "" && abscissa == 0) abscissa = xzero
	if (!any && (abscissa + 0 <= 0 || ordinate + 0 <= 0)) next
	if (!(name in number)) { number[name] = ++names; name_of[names] = name }
	points[number[name]] = points[number[name]] sprintf("%.10g,%.10g\n", abscissa * xfactor, ordinate * yfactor)
}
END {
	text = ""
	for (k = 1; k <= names; k++) {
		printf "$series_%d << EOD\n%sEOD\n", k, points[k]
		text = text (k > 1 ? ", " : "") clause(k, name_of[k])
	}
	printf "clauses = \"%s\"\n", names ? text : "1/0 notitle"
}
