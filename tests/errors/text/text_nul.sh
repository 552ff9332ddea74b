# SPDX-License-Identifier: GPL-3.0-or-later
# a NUL in the third line
printf "model m\nparam k = 1\ncoord x\000y\nx'' + k*x = 0\nstep 0.01\n"
