# SPDX-License-Identifier: GPL-3.0-or-later
# a line one byte over 1 MiB, the second of the file
printf "model m\nparam k = 1"
awk 'BEGIN { for (i = 0; i < 1048576 - 10; i++) printf "0"; print "" }'
printf "coord x\nx'' + k*x = 0\nstep 0.01\n"
