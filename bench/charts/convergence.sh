#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# convergence.sh [--quick] PLGEN FOLDER: the generated code that convergence.c compares, as
# FOLDER/convergence_SYSTEM_SCHEME_N.so: 30 s in N intervals, so that the step is 30/N exactly. Run at the top of the
# source tree.
set -e
intervals='1000 2000 3000 5000 7000 10000 14000 20000 50000 100000'
if [ "$1" = --quick ]; then
	intervals='1000 2000 5000 20000'
	shift
fi
plgen=$1 folder=$2
mkdir -p "$folder"
for system in scs sdcs sdcsf; do
	for scheme in pl exact; do
		for n in $intervals; do
			echo "$folder/convergence_${system}_${scheme}_$n.so" \
				"models/$system.spec --scheme $scheme --step 30/$n"
		done
	done
done | xargs -P "${JOBS:-2}" -L 1 "$(dirname "$0")/variant.sh" "$plgen"
