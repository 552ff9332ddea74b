# SPDX-License-Identifier: GPL-3.0-or-later
# of: stability_map.csv
# Stable: no cell with a spectral radius above 1 + 1e-12
NR == 1 { read_head($0, column); next }
{
	split(f_line = $0, f, ",")
	m = f[1]
	if (!(m in bad)) { bad[m] = 0; order[++methods] = m }
	if (f[column["class_of_growth"]] ~ /[g-k-]/) bad[m]++
}
END {
	for (i = 1; i <= methods; i++)
		if (!bad[order[i]]) { stable++; list = list (list == "" ? "" : ", ") order[i] }
	print stable " of " methods " methods are stable at every step and damping: " list
}
