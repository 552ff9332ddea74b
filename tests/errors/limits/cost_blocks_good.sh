# SPDX-License-Identifier: GPL-3.0-or-later
# 128 equal oscillators
printf "model m\ncoord q[128]\nq'' + q = 0\nstep 0.01\n"
