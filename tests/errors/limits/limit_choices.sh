# SPDX-License-Identifier: GPL-3.0-or-later
# 1001 conditions
printf "model m\nparam k = 100\ncoord x\nx'' + k*x = "
awk 'BEGIN { for (i = 0; i < 1001; i++) printf "1 < 2 ? 3 : "; print "4" }'
printf "step 0.01\n"
