# SPDX-License-Identifier: GPL-3.0-or-later
# nothing but a byte order mark
printf "\357\273\277"
