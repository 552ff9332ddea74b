# SPDX-License-Identifier: GPL-3.0-or-later
# a hundred errors, in order of lines
printf "model m\n"
awk 'BEGIN { for (i = 1; i <= 100; i++) printf "param a%d = unknown%d\n", i, i;
	for (i = 1; i <= 10; i++) printf "let b%d = a%d\n", i, i }'
