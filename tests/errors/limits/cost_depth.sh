# SPDX-License-Identifier: GPL-3.0-or-later
# 3000 lets inside each other
awk 'BEGIN { print "model m\ncoord x\nlet a0 = x";
	for (i = 1; i < 3000; i++) printf "let a%d = sin(1 + 2*a%d*x)\n", i, i - 1;
	print "x'"''"' + x + a2999 = 0\nstep 0.01" }'
