# SPDX-License-Identifier: GPL-3.0-or-later
# tabs: one column each; the caret stands under the token all the same
printf "model m\n\tparam\tk = 1\n\tcoord x\n\tx''\t+ k*q = 0\nstep 0.01\n"
