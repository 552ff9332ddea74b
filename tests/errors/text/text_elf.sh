# SPDX-License-Identifier: GPL-3.0-or-later
# the start of a program
printf "\177ELF\002\001\001\000\000\000"
