# SPDX-License-Identifier: GPL-3.0-or-later
# awk -f csv.awk -f matrix.awk precision.csv: for each model and wanted error the cheapest of ours and the cheapest peer
# (least time of samples taken in turns, ns a unit) among those whose largest error over the history is not above it,
# and how many times ours the peer's is. In double only. word: ours, or what the peer is called where it is ahead; only
# ours, only a peer, nobody.
function side(m, name, setting, error, ns) {
	return m in name ? ",\"" name[m] "\"," setting[m] "," error[m] "," ns[m] : ",none,none,none,none"
}
function say(k, model, wanted,    m, fields) {
	m = model SUBSEP wanted
	fields = models[k] "," wanted
	fields = fields side(m, ours, ours_setting, ours_error, ours_ns)
	fields = fields side(m, peer, peer_setting, peer_error, peer_ns)
	if ((m in ours) && (m in peer))
		fields = fields "," sprintf("%.3g", peer_ns[m]/ours_ns[m]) "," \
			(peer_ns[m] + 0 >= ours_ns[m] + 0 ? "ours" : "\"" peer[m] "\"")
	else
		fields = fields ",none," (m in ours ? "only ours" : m in peer ? "only a peer" : "nobody")
	print fields
}
BEGIN { levels = split("1e-3 1e-6 1e-9 1e-12", level, " ") }
NR == 1 {
	read_head($0, column)
	print "model,error,ours,ours_setting,ours_error,ours_ns,peer,peer_setting,peer_error,peer_ns,factor,word"
	next
}
{
	split("", row)
	split_row($0, row)
	model = row[column["model"]]; method = row[column["method"]]
	if (!(model in seen)) { seen[model] = 1; models[++count] = model }
	ns = row[column["ns_min"]]; error = row[column["largest"]]
	if (!is_number(ns) || !is_number(error) || method ~ /float/) next
	for (k = 1; k <= levels; k++) {
		m = model SUBSEP level[k]
		if (error + 0 > level[k] + 0) continue
		if (row[column["family"]] == "ours") {
			if (!(m in ours) || ns + 0 < ours_ns[m] + 0) {
				ours[m] = method; ours_ns[m] = ns; ours_error[m] = error
				ours_setting[m] = row[column["setting"]]
			}
		} else if (!(m in peer) || ns + 0 < peer_ns[m] + 0) {
			peer[m] = method; peer_ns[m] = ns; peer_error[m] = error
			peer_setting[m] = row[column["setting"]]
		}
	}
}
END {
	for (k = 1; k <= count; k++)
		for (l = 1; l <= levels; l++) say(k, models[k], level[l])
}
