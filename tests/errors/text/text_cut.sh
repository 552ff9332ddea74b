# SPDX-License-Identifier: GPL-3.0-or-later
# a character cut short by the end of the file
printf "model m # \342\202"
