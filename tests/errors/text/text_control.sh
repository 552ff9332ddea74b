# SPDX-License-Identifier: GPL-3.0-or-later
# a control character
printf "model m\nparam k = 1 \001\ncoord x\nx'' + k*x = 0\nstep 0.01\n"
