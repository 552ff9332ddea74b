# SPDX-License-Identifier: GPL-3.0-or-later
# 20000 params
awk 'BEGIN { print "model m";
	for (i = 0; i < 20000; i++) printf "param p%d = %d\n", i, i;
	print "coord x\nx'"''"' + p7*x = 0\nstep 0.01" }'
