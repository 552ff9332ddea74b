# SPDX-License-Identifier: GPL-3.0-or-later
# 40 lets of conditions, each with the one before it three times
awk 'BEGIN { print "model m\ncoord x\nlet a0 = x";
	for (i = 1; i <= 20; i++) printf "let a%d = a%d > %d ? a%d + 1 : 2*a%d\n", i, i - 1, i, i - 1, i - 1
print "x'"''"' + x + a20 = 0\nstep 0.01" }'
