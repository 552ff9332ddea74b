# SPDX-License-Identifier: GPL-3.0-or-later
# line ends of the old Macintosh: one line
printf "model m\rparam k = 1\rcoord x\rx'' + k*x = 0\rstep 0.01\r"
