# SPDX-License-Identifier: GPL-3.0-or-later
# 1000 conditions in t, side by side
awk 'BEGIN { printf "model m\ncoord x\nx'"''"' + x = 0";
	for (i = 1; i <= 1000; i++) printf " + (t < %d ? 1 : 0)", i;
	print "\nstep 0.01" }'
