# SPDX-License-Identifier: GPL-3.0-or-later
# a line of 1 MiB is allowed: a comment
printf "model m\nparam k = 1 #"
awk 'BEGIN { for (i = 0; i < 1048576 - 13; i++) printf "-"; print "" }'
printf "coord x\nx'' + k*x = 0\nstep 0.01\n"
