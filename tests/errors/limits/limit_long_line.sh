# SPDX-License-Identifier: GPL-3.0-or-later
# an error far along a long line: what is shown of the line is the surroundings of the place
printf "model m\ncoord x\nx'' + x = 0"
awk 'BEGIN { for (i = 0; i < 2000; i++) printf " + 1"; print " + q + 2 + 3" }'
printf "step 0.01\n"
