# SPDX-License-Identifier: GPL-3.0-or-later
# line ends of Windows: the place is right and no carriage return is shown
printf "model m\r\nparam k = 1\r\ncoord x\r\nx'' + q*x = 0\r\nstep 0.01\r\n"
