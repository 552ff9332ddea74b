# SPDX-License-Identifier: GPL-3.0-or-later
# awk -f csv.awk -f friction.awk friction.csv: TAP
function result(good, name, said) {
	if (!good) { print "# " said; bad = 1 }
	printf "%s %d - %s\n", good ? "ok" : "not ok", ++count, name
}
NR == 1 { read_head($0, column); next }
{
	split("", row)
	split_row($0, row)
	k = row[column["method"]] "," row[column["setting"]] + 0
	error[k] = row[column["largest"]]; wrong[k] = row[column["missed"]] + row[column["false"]]
	late[k] = row[column["at_end"]]
	if (row[column["false"]] > false[row[column["method"]]]) false[row[column["method"]]] = row[column["false"]]
	if (!is_number(error[k]) || !is_number(late[k]) || late[k] + 0 > error[k] + 0) unknown = unknown " " $0
	rows++
	phases = row[column["true_phases"]]
}
function within(k, most) {
	result(k in error && error[k] + 0 <= most, k ": the closed form", \
		"found " error[k] ", expected 0, tolerance " most)
}
# No phase is missed or false
function right(k) {
	result(k in wrong && wrong[k] == 0, k ": every phase", wrong[k] " of " phases " missed or false, expected 0")
}
function order(method, coarse, fine,    found) {
	found = log(error[method "," coarse] / error[method "," fine]) / log(coarse / fine)
	result(found > 0.85 && found < 1.15, method ": of first order from " coarse " to " fine, \
		"found " found ", expected 1, tolerance 0.15")
}
END {
	result(rows == 40 && unknown == "", "all rows, with numbers", rows + 0 " rows, expected 40;" unknown)
	result(phases > 50, "many phases of rest", phases " phases, expected more than 50")
	split("exact,0.05;exact,0.01", exact, ";")
	for (i = 1; i <= 2; i++) { within(exact[i], 1e-13); right(exact[i]) }
	for (e = 3; e <= 11; e++) right("CVODE Adams, roots," 10^-e + 0)
	for (e = 3; e <= 9; e++) right("CVODE BDF, roots," 10^-e + 0)
	within("CVODE Adams, roots," 1e-11, 1e-8)
	within("CVODE BDF, roots," 1e-9, 1e-6)
	order("Moreau and Jean", 0.0125, 0.000195313)
	order("Moreau and Jean", 0.000195313, 3.05176e-06)
	order("tanh, RK4", 0.01, 0.001)
	order("tanh, RK4", 0.001, 0.0001)
	order("tanh, CVODE BDF", 0.01, 0.001)
	order("tanh, CVODE BDF", 0.001, 0.0001)
	order("tanh, CVODE Adams", 0.01, 0.001)
	result(false["tanh, RK4"] > 10, "a large eps shows phases of rest that are none", \
		"found " false["tanh, RK4"] ", expected more than 10")
	print "1.." count
	exit bad
}
