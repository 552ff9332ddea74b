# SPDX-License-Identifier: GPL-3.0-or-later
# 18 states, one clearance: a piecewise-linear step in two words is a loop over its tables
echo 'model m'
echo 'coord a, b, c, d, e, f, g, h, i'
last=a
echo "a'' + 4*a + deadzone(a, -1, 1) = 0"
for next in b c d e f g h i; do
	echo "$next'' + 4*$next - $last = 0"
	last=$next
done
echo 'step 0.01'
