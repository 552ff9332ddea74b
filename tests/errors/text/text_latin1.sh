# SPDX-License-Identifier: GPL-3.0-or-later
# Latin-1
printf "model m\nparam k = 1 # d\344mpfung\ncoord x\nx'' + k*x = 0\nstep 0.01\n"
