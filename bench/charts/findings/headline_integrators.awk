# SPDX-License-Identifier: GPL-3.0-or-later
# of: headline_integrators.csv
NR == 1 { read_head($0, column); next }
{
	split_row($0, f)
	if (f[column["reached"]] != "reached" || f[column["family"]] == "propagator") next
	e = f[column["target"]] + 0; ns = f[column["ns_median"]] + 0
	side = f[column["family"]] == "ours" ? "ours" : "peer"
	if (side == "ours" && f[column["method"]] ~ /float/) next
	if (!((e, side) in least) || ns < least[e, side]) { least[e, side] = ns; who[e, side] = f[column["method"]] }
	errors[e] = 1
}
END {
	printf "Two coupled masses at equal error: %s takes %s an output", who[1e-9, "ours"],
		time_text(least[1e-9, "ours"])
	printf "; the quickest integrator %s at 1e-9 (%s, %s times), %s at 1e-12 (%s)\n",
		time_text(least[1e-9, "peer"]),
		who[1e-9, "peer"], times_text(least[1e-9, "peer"] / least[1e-9, "ours"]),
		time_text(least[1e-12, "peer"]), who[1e-12, "peer"]
}
