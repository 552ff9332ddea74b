# SPDX-License-Identifier: GPL-3.0-or-later
# of: matrix.csv
# name: precision_MODEL
BEGIN { wanted = substr(name, 11) }
NR == 1 { read_head($0, column); next }
{
	split_row($0, f)
	if (f[column["model"]] != wanted) next
	word = f[column["word"]]; error = f[column["error"]]
	ours = f[column["ours"]] " " time_text(f[column["ours_ns"]]); peer = f[column["peer"]] " " \
		time_text(f[column["peer_ns"]])
	if (word == "none") next
	if (word == "ours") ahead = ahead (ahead == "" ? "" : ", ") error
	if (word == "only ours") alone = alone (alone == "" ? "" : ", ") error
	if (word == "peer" || word == "only peer") behind = behind (behind == "" ? "" : ", ") error
	if (word == "even") even = even (even == "" ? "" : ", ") error
	if ((word == "ours" || word == "peer" || word == "even") && (error == "1e-6" || example == ""))
		example = "; at " error " " ours " an output, " peer
}
END {
	text = (ahead == "" ? "" : "; plgen is ahead at errors of " ahead) \
		(alone == "" ? "" : "; it alone gets to " alone) (even == "" ? "" : "; as fast at " even) \
		(behind == "" ? "" : "; a peer is ahead at " behind)
	print wanted ": " (text == "" ? "nothing gets to 1e-3" : substr(text, 3)) example
}
