# SPDX-License-Identifier: GPL-3.0-or-later
# of: headline_integrators.csv
NR == 1 { read_head($0, column); next }
{
	split_row($0, f)
	if (f[column["reached"]] != "reached" || f[column["method"]] ~ /float/) next
	e = f[column["target"]] + 0; ns = f[column["ns_median"]] + 0
	side = f[column["family"]]
	if (side != "ours" && side != "propagator") side = "peer"
	if (!((e, side) in least) || ns < least[e, side]) { least[e, side] = ns; who[e, side] = f[column["method"]] }
}
function cost(e, side, without) {
	return (e, side) in least ? time_text(least[e, side]) " (" who[e, side] ")" : without
}
END {
	print "Two coupled masses, an output at an error of 1e-9: plgen " cost(1e-9, "ours", "none") \
		", matrix of a step " cost(1e-9, "propagator", "none") ", integrator " cost(1e-9, "peer", "none") \
		"; of 1e-12: " cost(1e-12, "ours", "no plgen") ", " cost(1e-12, "propagator", "no matrix") ", " \
		cost(1e-12, "peer", "no integrator")
}
