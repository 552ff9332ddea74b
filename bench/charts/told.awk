# SPDX-License-Identifier: GPL-3.0-or-later
# awk -v columns=COLUMN,COLUMN... -f csv.awk -f told.awk NAME_raw.csv: these columns, each different row once.
function quoted(text) { return text ~ /[,"]/ ? "\"" text "\"" : text }
BEGIN { count = split(columns, name, ","); print columns }
NR == 1 { read_head($0, column); next }
{
	split_row($0, f)
	line = ""
	for (i = 1; i <= count; i++) line = line (i > 1 ? "," : "") quoted(f[column[name[i]]])
	if (!seen[line]++) print line
}
