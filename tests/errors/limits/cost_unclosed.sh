# SPDX-License-Identifier: GPL-3.0-or-later
# 150 brackets that are not closed: each is told, and the limit counts them too
awk 'BEGIN { print "model m\ncoord x\nx'"''"' + x = 0\nstep 0.01"; for (i = 0; i < 150; i++) print "let a" i " = (1" }'
