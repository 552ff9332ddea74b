# SPDX-License-Identifier: GPL-3.0-or-later
echo 'model m'
for i in $(seq 41); do echo "coord x$i"; done
for i in $(seq 41); do echo "x$i' + x$i^3 = 0"; done
echo 'step 0.1'
echo 'scheme radau'
