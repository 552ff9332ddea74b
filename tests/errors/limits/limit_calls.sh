# SPDX-License-Identifier: GPL-3.0-or-later
# 1001 calls
printf "model m\nparam k = 100\ncoord x\nx'' + k*x = "
awk 'BEGIN { for (i = 0; i < 1001; i++) printf "abs("; printf "1"; for (i = 0; i < 1001; i++) printf ")"; print "" }'
printf "step 0.01\n"
