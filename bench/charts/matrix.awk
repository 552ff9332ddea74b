# SPDX-License-Identifier: GPL-3.0-or-later
# awk -f csv.awk -f matrix.awk precision.csv: for each model and wanted error the cheapest setting of ours and of the
# peers that keeps it (largest error of the history at most that), in double, as CSV. Times are medians, as wherever the
# charts show one. factor: the peer's time over ours; word: who is ahead, by more than the 10 % that times hold.
function offer(key) {
	if (!(key in ns) || cost < ns[key]) {
		ns[key] = cost; who[key] = method; had[key] = error; setting[key] = tried[k] }
}
function found(key) {
	return key in ns ? "\"" who[key] "\"," setting[key] "," had[key] "," ns[key] : "none,none,none,none"
}
BEGIN { errors = split("1e-3 1e-6 1e-9 1e-12", wanted, " ") }
NR == 1 { read_head($0, column); next }
{
	split("", row)
	split_row($0, row)
	model = row[column["model"]]; method = row[column["method"]]
	if (!(model in known)) { known[model] = 1; models[++count] = model }
	side = row[column["family"]] == "ours" ? "ours" : "peer"
	if (method ~ /float/) next
	count_of = split(row[column["setting"]], tried, " ")
	split(row[column["largest"]], largest, " "); split(row[column["ns_median"]], median, " ")
	for (k = 1; k <= count_of; k++) {
		error = largest[k]; cost = median[k] + 0
		for (i = 1; i <= errors && is_number(error) && cost > 0; i++)
			if (error + 0 <= wanted[i] + 0) offer(model SUBSEP i SUBSEP side)
	}
}
END {
	print "model,error,ours,ours_setting,ours_error,ours_ns,peer,peer_setting,peer_error,peer_ns,factor,word"
	for (m = 1; m <= count; m++)
		for (i = 1; i <= errors; i++) {
			ours = models[m] SUBSEP i SUBSEP "ours"; peer = models[m] SUBSEP i SUBSEP "peer"
			factor = "none"
			if (ours in ns && peer in ns) {
				factor = sprintf("%.3g", ns[peer] / ns[ours])
				word = ns[peer] > 1.1 * ns[ours] ? "ours" : ns[ours] > 1.1 * ns[peer] ? "peer" : "even"
			} else word = ours in ns ? "only ours" : peer in ns ? "only peer" : "none"
			print models[m] "," wanted[i] "," found(ours) "," found(peer) "," factor "," word
		}
}
