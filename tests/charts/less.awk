# SPDX-License-Identifier: GPL-3.0-or-later
# awk -f csv.awk -f less.awk less.csv: TAP
function result(good, name, said) {
	if (!good) { print "# " said; bad = 1 }
	printf "%s %d - %s\n", good ? "ok" : "not ok", ++count, name
}
function error_of(scene, model, kept) { return error[scene, model, kept] + 0 }
# Each further mode, or pair of states, helps, or does no harm beyond what is between two signs of the same size
function falls(scene, model, from, step, to,    k, off) {
	for (k = from + step; k <= to; k += step)
		if (error_of(scene, model, k) > 1.1 * error_of(scene, model, k - step))
			off = off " " k - step ": " error_of(scene, model, k - step) ", " k ": " \
				error_of(scene, model, k)
	result(off == "", scene ": errors fall, " model, off)
}
NR == 1 { read_head($0, column); next }
{
	split("", row)
	split_row($0, row)
	scene = row[column["scene"]]; model = row[column["model"]]; kept = row[column["kept"]]
	error[scene, model, kept] = row[column["error_over_peak"]]
	cost[scene, model, kept] = row[column["multiplications"]] + 0
	if (cost[scene, model, kept] <= 0 || !is_number(error[scene, model, kept])) unknown = unknown " " $0
	rows++
}
function whole(scene, model, kept) {
	result((scene, model, kept) in error && error_of(scene, model, kept) < 1e-12, scene ": " model ", all " kept \
		", is the closed form", "found " error_of(scene, model, kept) ", expected 0, tolerance 1e-12")
}
function order(coarse, fine,    found) {
	found = error_of("beam", "elements, all modes", coarse) / error_of("beam", "elements, all modes", fine)
	found = log(found) / log(2)
	result(found > 3.7 && found < 4.3, "beam: meshes of " coarse " and " fine " elements, of order 4", \
		"found " found ", tolerance 0.3")
}
function near(scene, kept,    a, b) {
	a = error_of(scene, "modes, static rest", kept); b = error_of(scene, "modes, static rest, float", kept)
	result(b < a + 1e-5, scene ": float, " kept " modes: as double but for rounding", "double " a ", float " b \
		", tolerance 1e-5")
}
END {
	result(rows == 116 && unknown == "", "all rows, with numbers", rows + 0 " rows, expected 116;" unknown)
	whole("building", "modes", 12)
	whole("drivetrain", "modes", 5)
	whole("drivetrain", "balanced truncation", 10)
	order(5, 10)
	order(10, 20)
	falls("beam", "modes", 1, 1, 10)
	falls("beam", "modes, static rest", 1, 1, 10)
	falls("building", "modes", 1, 1, 12)
	falls("building", "modes, static rest", 1, 1, 11)
	falls("drivetrain", "modes", 1, 1, 5)
	falls("drivetrain", "modes, static rest", 1, 1, 4)
	falls("beam", "balanced truncation", 2, 2, 12)
	falls("building", "balanced truncation", 2, 2, 12)
	falls("drivetrain", "balanced truncation", 2, 2, 10)
	for (k = 1; k <= 4; k++) { near("beam", k); near("building", k); near("drivetrain", k) }
	result(error_of("drivetrain", "modes, static rest", 2) < 0.1 * error_of("drivetrain", "modes", 2), \
		"drivetrain: the static rest gains a digit", error_of("drivetrain", "modes, static rest", 2) " and " \
		error_of("drivetrain", "modes", 2))
	print "1.." count
	exit bad
}
