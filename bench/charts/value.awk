# SPDX-License-Identifier: GPL-3.0-or-later
# awk -v model=NAME -v wanted=COLUMN -f csv.awk -f value.awk FILE.csv: what the model's first row has in that column
NR == 1 { read_head($0, place); next }
{ split_row($0, f); if (f[place["model"]] == model) { print f[place[wanted]]; exit } }
