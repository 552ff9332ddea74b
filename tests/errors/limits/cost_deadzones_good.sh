# SPDX-License-Identifier: GPL-3.0-or-later
# 120 deadzones of one coordinate: 241 regions
awk 'BEGIN { printf "model m\ncoord x\nx'"''"' + x";
	for (i = 1; i <= 120; i++) printf " + deadzone(x, -%d, %d)", i, i;
	print " = 0\nstep 0.01" }'
