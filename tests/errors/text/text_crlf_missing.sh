# SPDX-License-Identifier: GPL-3.0-or-later
# the end of a file with line ends of Windows
printf "model m\r\nparam k = 1\r\ncoord x\r\nx'' + k*x = 0\r\n"
