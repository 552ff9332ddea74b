# SPDX-License-Identifier: GPL-3.0-or-later
# lets that square each other: 2^39 waves; none is looked at twice
awk 'BEGIN { print "model m\ncoord x\nlet a0 = 1 + exp(-t)";
	for (i = 1; i < 40; i++) printf "let a%d = a%d*a%d\n", i, i - 1, i - 1
print "x'"''"' + x = a39\nstep 0.01" }'
