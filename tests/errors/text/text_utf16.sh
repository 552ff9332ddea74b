# SPDX-License-Identifier: GPL-3.0-or-later
# UTF-16 with its mark
printf "\377\376m\000o\000d\000e\000l\000"
