# SPDX-License-Identifier: GPL-3.0-or-later
# the derivative of a product of 160 factors
awk 'BEGIN { printf "model m\ncoord x\nx'"''"' + x + sin(x)";
	for (i = 2; i <= 160; i++) printf "*sin(%d*x)", i;
	print " = 0\noperator at x = 1\nstep 0.01" }'
