# SPDX-License-Identifier: GPL-3.0-or-later
# half a surrogate pair
printf "model m # \355\240\200\n"
