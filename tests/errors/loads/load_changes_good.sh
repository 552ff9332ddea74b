# SPDX-License-Identifier: GPL-3.0-or-later
# 300 breakpoints
printf 'model m\ncoord x\n'
awk 'BEGIN { printf "x'"''"' + x = table(t; 0, 0";
	for (i = 1; i < 301; i++) printf "; %d, %d", i, i % 7;
	print ")";
	print "step 0.01" }'
