# SPDX-License-Identifier: GPL-3.0-or-later
# 1001 powers
printf "model m\nparam k = 100\ncoord x\nx'' + k*x = 1"
awk 'BEGIN { for (i = 0; i < 1001; i++) printf "^1"; print "" }'
printf "step 0.01\n"
