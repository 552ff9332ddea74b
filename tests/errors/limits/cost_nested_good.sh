# SPDX-License-Identifier: GPL-3.0-or-later
# 999 conditions in t inside each other
awk 'BEGIN { printf "model m\ncoord x\nx'"''"' + x = ";
	for (i = 1; i < 1000; i++) printf "t < %d ? %d : ", i, i % 7;
	print "0\nstep 0.01" }'
