# SPDX-License-Identifier: GPL-3.0-or-later
# a literal of 310000 digits is over a million bits
printf "model m\nparam k = 1"
awk 'BEGIN { for (i = 0; i < 310000; i++) printf "0"; print "" }'
printf "coord x\nx'' + k*x = 0\nstep 0.01\n"
