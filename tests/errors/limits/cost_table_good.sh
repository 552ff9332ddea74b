# SPDX-License-Identifier: GPL-3.0-or-later
# a table in t of 1000 points
awk 'BEGIN { printf "model m\ncoord x\nx'"''"' + x = table(t; 0, 0";
	for (i = 1; i < 1000; i++) printf "; %d, %d", i, i * i % 17;
	print ")\nstep 0.01" }'
