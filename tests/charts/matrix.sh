#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# matrix.sh PRECISION.csv: the matrix by another road, rows sorted by time and filtered, a search for each cell:
# model error ours-or-none ns peer-or-none ns word
precision=$1
csv=$(dirname "$0")/../../bench/charts/csv.awk
# time, family, model, error, method: what did not fail, the quickest first
awk -f "$csv" -f "$(dirname "$0")/sorted.awk" "$precision" | LC_ALL=C sort -s -t '	' -k1,1g >sorted
awk -F, 'NR > 1 && $1 != "" && !seen[$1]++ { print $1 }' "$precision" | while read -r model; do
	for error in 1e-3 1e-6 1e-9 1e-12; do
		for side in ours peer; do
			awk -F '\t' -v m="$model" -v e="$error" -v s="$side" '$3 == m && $2 == s && $4 <= e + 0 {
				print $5 "\t" $1; found = 1; exit }
				END { if (!found) print "none\tnone" }' sorted >"$side"
		done
		paste ours peer | awk -F '\t' -v m="$model" -v e="$error" '{
			if ($2 == "none" && $4 == "none") word = "none"
			else if ($4 == "none") word = "only ours"
			else if ($2 == "none") word = "only peer"
			else { r = $4 / $2; word = r > 1.1 ? "ours" : r < 1 / 1.1 ? "peer" : "even" }
			print m "\t" e "\t" $1 "\t" $2 "\t" $3 "\t" $4 "\t" word }'
	done
done
