# SPDX-License-Identifier: GPL-3.0-or-later
# multiplied out, this has 6545 terms in 561 waves
printf "model m\ncoord x\nx'' + x = (1+t+exp(-t)+cos(t))^32\nstep 0.01\n"
