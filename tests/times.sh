#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Processor time of tests, of doc/tests.md:
#
#     meson test -C BUILD --wrapper "sh $PWD/tests/times.sh $PWD/LOG"    runs them; of each SECONDS COMMAND to LOG
#     sh tests/times.sh --sum LOG                               seconds by folder of tests, most first, and in all
if [ "$1" = --sum ]; then
	awk '{
		# the first word that is in a folder of tests: some are given to a shell
		for (i = 2; i < NF && $i !~ /\/tests\/[a-z_]+\//; i++)
			;
		folder = $i
		sub(/.*\/tests\//, "", folder)
		sub(/\/.*/, "", folder)
		time[folder] += $1
		all += $1
	}
	END {
		for (folder in time)
			printf "%.1f %s\n", time[folder], folder
		printf "%.1f in all, of %d tests\n", all, NR
	}' "$2" | sort -rn
	exit
fi
log=$1
shift
"$@"
status=$?
# not in a pipe, where it would be of another shell; the second line is of what this one has waited for: 0m1.25s 0m0.5s
times >"$log.$$"
awk -v command="$*" 'NR == 2 {
	split($1 " " $2, part, /[ms ]+/)
	printf "%.2f %.500s\n", part[1] * 60 + part[2] + part[3] * 60 + part[4], command
}' "$log.$$" >>"$log"
rm -f "$log.$$"
exit $status
