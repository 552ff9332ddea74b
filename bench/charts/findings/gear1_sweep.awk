# SPDX-License-Identifier: GPL-3.0-or-later
# of: gear1_sweep.csv
# Where the largest change between neighbours is, on the way up and on the way down
NF == 0 { block = 1; last = ""; next }
{
	if (last != "") {
		change = $2 > last ? $2 / last : last / $2
		if (change > largest[block + 0]) { largest[block + 0] = change; at[block + 0] = ($1 + before) / 2 }
	}
	last = $2; before = $1
}
END {
	printf "The gear pair jumps at %.3g rad/s when its force is swept up, at %.3g rad/s when it is swept " \
		"down\n", at[0], at[1]
}
