# SPDX-License-Identifier: GPL-3.0-or-later
# 257 coordinates are 514 states
printf "model m\ncoord x0"
awk 'BEGIN { for (i = 1; i < 257; i++) printf ", x%d", i;
	print "";
	for (i = 0; i < 257; i++) printf "x%d'"''"' + x%d = 0\n", i, i;
	print "step 0.01" }'
