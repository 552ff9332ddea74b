# SPDX-License-Identifier: GPL-3.0-or-later
# through.awk SPEC FOUND SOLUTION: whether --solution meets every event in FOUND, in order, and ends where FOUND says,
# to what doubles leave of numbers of 191 bits. Events of one instant count once, as in follow.c.
function size(x) { return x < 0 ? -x : x }
FNR == 1 { file++ }
BEGIN { together = 0.01 / 2^20 }         # of a step of through.sh
file == 2 && $1 == "event" { if (!due || $2 > expected[due] + together) expected[++due] = $2 }
file == 2 && $1 == "slowest" { tolerance = 4e-15 * ($2 < 0.1 ? 0.1 / $2 : 1) }
file == 2 && $1 == "end" { for (i = 2; i <= NF; i++) end[i - 1] = $i; states = NF - 1 }
file == 3 && /^# t = / {
	split($4, time, ":")
	if (!met || time[1] > found[met] + together) found[++met] = time[1] + 0
}
file == 3 && /^[0-9]/ { split($0, row, ",") }
END {
	bad = met != due
	if (bad) printf "# %d events found, %d expected\n", met, due
	for (i = 1; i <= due && i <= met; i++)
		if (!(size(found[i] - expected[i]) <= 1e-12)) {
			printf "# event %d: %.17g found, %.17g expected\n", i, found[i], expected[i]
			bad = 1
		}
	most = 0.1
	for (i = 1; i <= states; i++) most = size(end[i]) > most ? size(end[i]) : most
	for (i = 1; i <= states; i++)
		if (!(size(row[i + 1] - end[i]) <= tolerance * most)) {
			printf "# state %d: %.17g found, %.17g expected\n", i, row[i + 1], end[i]
			bad = 1
		}
	exit bad || states == 0
}
