# SPDX-License-Identifier: GPL-3.0-or-later
# awk -v record=CKSUM -f csv.awk -f structural.awk integrators_check.csv frame.csv: TAP
function result(good, name, said) {
	if (!good) { print "# " said; bad = 1 }
	printf "%s %d - %s\n", good ? "ok" : "not ok", ++count, name
}
# Errors of the roof at 0.02, 0.01, 0.005 s by an independent program on another record of this kind: its period's
# elongation over twice the damping decides them, the record hardly
function expect(method, a, b, c) { wanted[method, "0.02"] = a; wanted[method, "0.01"] = b; wanted[method, "0.005"] = c }
BEGIN {
	expect("Newmark", 0.16, 0.046, 0.012)
	expect("generalized-alpha", 0.17, 0.048, 0.013)
	expect("rho-Bathe 0.5", 0.063, 0.017, 0.0043)
	expect("CR", 0.16, 0.045, 0.012)
	expect("KR-alpha 0.5", 0.23, 0.065, 0.018)
	tolerance = 0.25
	result(record == "771989467 6405", "frame_record.csv: its bytes", "found " record)
}
FNR == 1 { file++; read_head($0, column); next }
{
	split("", row)
	split_row($0, row)
}
file == 1 {
	result(row[column["result"]] == "ok", row[column["what"]], "known " row[column["known"]] ", measured " \
		row[column["measured"]] ", tolerance " row[column["tolerance"]])
	checks++
}
file == 2 {
	method = row[column["method"]]; h = row[column["h_s"]]; error = row[column["roof_error_over_peak"]]
	agreement = row[column["truth_agreement"]]
	name = "frame: " method ", h = " h
	if (!is_number(error) || !is_number(agreement) || agreement + 0 > 1e-11)
		result(0, name, "error " error ", two roads to what is true " agreement " apart, tolerance 1e-11")
	else if (method == "exact")
		result(error + 0 < 1e-13, name ": no error but rounding", "found " error ", tolerance 1e-13")
	else if ((method, h) in wanted) {
		off = error / wanted[method, h] - 1
		result(off < tolerance && off > -tolerance, name, "found " error ", expected " wanted[method, h] \
			", tolerance 25 %")
		seen++
	} else
		result(error + 0 > 0.003 && error + 0 < 0.25, name, "found " error ", expected 0.003 to 0.25")
	rows++
}
END {
	result(checks == 187 && rows == 27 && seen == 15, "all of it", "checks " checks ", rows " rows \
		", compared " seen)
	print "1.." count
	exit bad
}
