# SPDX-License-Identifier: GPL-3.0-or-later
# 256 equal oscillators
printf "model m\ncoord q[256]\nq'' + q = 0\nstep 0.01\n"
