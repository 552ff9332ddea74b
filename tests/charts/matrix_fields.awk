# SPDX-License-Identifier: GPL-3.0-or-later
# awk -f csv.awk -f matrix_fields.awk matrix.csv: model, error, our time, the peer's, word, between tabs
NR == 1 { read_head($0, c); next }
{ split_row($0, f); print f[c["model"]] "\t" f[c["error"]] "\t" f[c["ours_ns"]] "\t" f[c["peer_ns"]] "\t" f[c["word"]] }
