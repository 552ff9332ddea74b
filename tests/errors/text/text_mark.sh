# SPDX-License-Identifier: GPL-3.0-or-later
# a byte order mark does not count as a column
printf "\357\273\277modle m\nparam k = 1\ncoord x\nx'' + k*x = 0\nstep 0.01\n"
