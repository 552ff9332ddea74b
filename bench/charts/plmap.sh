#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# plmap.sh [--quick] PLGEN FOLDER: scheme pl at some points of the map, as FOLDER/plmap_*.so: what plmap.c checks its
# own step with. Run at the top of the source tree.
set -e
[ "$1" != --quick ] || shift
plgen=$1 folder=$2
mkdir -p "$folder"
while read -r name k1 k2 k3 h; do
	echo "$folder/plmap_$name.so models/scs.spec --scheme pl -D k1=$k1 -D k2=$k2 -D k3=$k3 --step $h"
done <<EOT | xargs -P "${JOBS:-2}" -L 1 "$(dirname "$0")/variant.sh" "$plgen"
scs 100 100 100 1/100
weak 4000 40 2000 1/100
slow 1 1/1000 1/2 1/10
fast 1 1/10 1 2
stiff 1 8 1/2 1
EOT
