#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# energy.sh PLGEN FOLDER: the generated code that energy.c follows, FOLDER/energy_*.so, and its list
# FOLDER/energy.list. Run at the top of the source tree.
set -e
plgen=$1 folder=$2
charts=bench/charts
mkdir -p "$folder"
: >"$folder/energy.list"
: >"$folder/energy.jobs"

# variant CASE METHOD REAL H SPEC [plgen options]
variant() {
	of=$1 method=$2 real=$3 h=$4 spec=$5
	shift 5
	file=$(echo "energy $of $method $h $real" | sed 's/[^a-z0-9.]\{1,\}/_/g').so
	# without a blank at its end: xargs would go on with the next line
	echo "$folder/$file $spec --step $h" "$@" >>"$folder/energy.jobs"
	printf '%s\t%s\t%s\t%s\t%s\n' "$of" "$method" "$real" "$h" "$folder/$file" >>"$folder/energy.list"
}

# forms CASE REAL H SPEC [plgen options]: the equations, then the form that plgen chooses, then every form
forms() {
	of=$1 real=$2 h=$3 spec=$4
	shift 4
	variant "$of" problem "$real" "$h" "$spec" "$@"
	name=exact
	if [ "$real" = float ]; then
		set -- --real float "$@"
		name='exact, float'
	fi
	variant "$of" "$name" "$real" "$h" "$spec" "$@"
	for form in direct delta kick-drift-kick; do
		variant "$of" "$name, $form" "$real" "$h" "$spec" --form $form "$@"
	done
	variant "$of" "$name, compensated" "$real" "$h" "$spec" --accuracy compensated "$@"
}

free=$charts/specs/free_pair.spec
for real in double float; do
	forms undamped $real 0.01 models/scs.spec
	forms moving $real 0.01 "$free" -D v2=0
	forms resting $real 0.01 "$free"
done
forms undamped float 0.0001 models/scs.spec
for real in double float; do
	forms damped $real 0.0001 models/sdcs.spec -D c1=1e-6 -D c2=1e-6 -D c3=1e-6
done
xargs -P "${JOBS:-2}" -L 1 $charts/variant.sh "$plgen" <"$folder/energy.jobs"
