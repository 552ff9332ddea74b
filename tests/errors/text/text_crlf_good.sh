# SPDX-License-Identifier: GPL-3.0-or-later
# line ends of Windows are accepted
printf "model m\r\nparam k = 1\r\ncoord x\r\nx'' + (k*x +\r\n 2*x) = 0\r\nstep 0.01\r\n"
