# SPDX-License-Identifier: GPL-3.0-or-later
# awk -v column=NAME -v value=TEXT -f csv.awk -f rows_of.awk FILE.csv: whether that column has that text: exit status
NR == 1 { read_head($0, place); next }
{ split_row($0, f); if (f[place[column]] == value) { found = 1; exit } }
END { exit !found }
