# SPDX-License-Identifier: GPL-3.0-or-later
# no line end at the end
printf "model m\nparam k = 1\ncoord x\nx'' + k*x = 0\nstep 0.01"
