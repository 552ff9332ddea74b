# SPDX-License-Identifier: GPL-3.0-or-later
# an overlong slash, as in broken UTF-8
printf "model m\nparam k = 1\300\257\ncoord x\n"
