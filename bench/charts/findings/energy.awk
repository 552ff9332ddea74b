# SPDX-License-Identifier: GPL-3.0-or-later
# of: energy.csv
# name: energy_double, energy_float, energy_float_short: after the last number of steps
NR == 1 { read_head($0, column); next }
{
	split_row($0, f)
	real = name ~ /float/ ? "float" : "double"; h = name ~ /short/ ? 0.0001 : 0.01
	if (f[column["case"]] != "undamped" || f[column["real"]] != real || f[column["step_s"]] + 0 != h) next
	m = f[column["method"]]
	n = split(f[column["steps"]], after, " ")
	split(f[column["largest"]], largest, " ")
	for (i = 1; i <= n; i++) if (is_number(largest[i])) { last[m] = largest[i] + 0; steps = after[i] + 0 }
	family[m] = f[column["family"]]
}
function part(x) { return x >= 0.001 ? short(100 * x) " %" : short(x) }
END {
	for (m in last) {
		if (m ~ /compensated/) compensated = last[m]
		if (family[m] == "propagator" && m !~ /rounded/ && (matrix == "" || last[m] > matrix)) matrix = last[m]
	}
	text = "Energy changed over " short(steps) " steps"
	if (real == "float") text = text " in float" (name ~ /short/ ? ", the step 100 times shorter" : "")
	if ("RK4" in last) text = text ": RK4 " part(last["RK4"]) ","
	else text = text ":"
	print text " matrix exponential " part(matrix) ", plgen's exact " part(last[real == "float" ? \
		"exact, float" : "exact"]) ", compensated " part(compensated)
}
