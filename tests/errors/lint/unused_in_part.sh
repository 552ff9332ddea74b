# SPDX-License-Identifier: GPL-3.0-or-later
cat >part_of_unused.spec <<'EOF'
model wheel
param k = 100, c = 3
input road, wind
coord x
x'' + k*(x - road) = 0
output x
step 0.01
EOF
cat <<'EOF'
model car
param c0 = 5
input road
use "part_of_unused.spec" as front, rear with c = c0, road = road
output front.x, rear.x
step 0.01
EOF
