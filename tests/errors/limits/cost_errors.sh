# SPDX-License-Identifier: GPL-3.0-or-later
# 20000 errors
awk 'BEGIN { print "model m\ncoord x\nx'"''"' + x = 0\nstep 0.01"; for (i = 0; i < 20000; i++) print "step 1" }'
