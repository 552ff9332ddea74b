# SPDX-License-Identifier: GPL-3.0-or-later
# of: friction_times.csv
# The least time with an error of at most 1e-3, by friction that is smoothed and from event to event
NR == 1 { read_head($0, column); next }
{
	split_row($0, f)
	method = f[column["method"]]; e = f[column["largest"]]; over = f[column["ns_min_over_exact"]] + 0
	if (method == "exact") { if (!seen++) exact = e + 0; next }
	side = method ~ /^tanh/ ? "tanh" : "roots"
	if (is_number(e) && e + 0 <= 1e-3 && (!(side in least) || over < least[side])) least[side] = over
}
END {
	printf "Stick and slip: exact to %s; to 1e-3, tanh takes %.0f times its time, CVODE with roots %.0f times\n", \
		short(exact), least["tanh"], least["roots"]
}
