# SPDX-License-Identifier: GPL-3.0-or-later
echo 'model many'
echo 'coord x, y'
echo "x'' + x = 0"
echo "y'' + y = 0"
for k in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28 29 30; do
	echo "when x' >= 0.02*$k: y = y + 1"
done
echo 'step 0.01'
