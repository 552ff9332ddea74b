# SPDX-License-Identifier: GPL-3.0-or-later
# columns count characters, not bytes
printf "model m\nparam k = 1\ncoord x\n"
printf "x'' + ( # \303\244\303\266\303\274 \342\202\254\n k*x) = 0 + q # \303\244\nlet \303\244 = 3\nstep 0.01\n"
