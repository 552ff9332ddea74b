# SPDX-License-Identifier: GPL-3.0-or-later
# of: headline_equal_step.csv
NR == 1 { read_head($0, column); next }
{
	split_row($0, f)
	name = f[column["method"]]; ns = f[column["ns_median"]] + 0
	if (name ~ /float/ || ns <= 0) next
	side = f[column["family"]] == "ours" ? "ours" : "peer"
	if (!(side in least) || ns < least[side]) {
		least[side] = ns; who[side] = name; error[side] = f[column["error"]] }
	if (name == "exact") { chosen = ns; its = f[column["error"]] }
}
END {
	printf "At equal step: %s takes %s (error %s), plgen's choice exact %s (%s), the quickest matrix or modal " \
		"peer, %s, %s (%s)\n", who["ours"], time_text(least["ours"]), short(error["ours"]), time_text(chosen),
		short(its),
		who["peer"], time_text(least["peer"]), short(error["peer"])
}
