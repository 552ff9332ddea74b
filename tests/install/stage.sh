# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced behind tap.sh by tests of what is installed: all of it in a folder whose name has blanks, moved once, so that
# nothing can lie where it was configured to. Sets `prefix`, the folder of `bin` and `share`, `libdir` in it, and a
# path that has the commands; `project`, a folder for an outside project, has drive.spec, which reads a matrix, and a
# program main.c that runs it.
#
# Its caller has set `build` and `root`, the folders of build and sources.
source=$root

if ! DESTDIR="$work/first stage" meson install -C "$build" --no-rebuild --quiet >log 2>&1; then
	result 1 'it installs'
	tap_end
fi
mv "$work/first stage" "$work/a stage"
prefix=$(dirname "$(dirname "$(find "$work/a stage" -path '*/bin/plgen')")")
libdir=$(dirname "$(find "$prefix" -name libplrt.a)")
PATH=$prefix/bin:$PATH
PKG_CONFIG_PATH=$libdir/pkgconfig
export PATH PKG_CONFIG_PATH
unset PLGEN_RUNTIME

project="$work/an outside project"
mkdir -p "$project/the models"
cat >"$project/the models/drive.spec" <<'END'
model drive
param d = 0.5
matrix K = "k and k.mtx"
coord q[2]
init q[1] = 0.01
q'' + d*q' + K*q = [cos(5*t); 0]
step 0.01
END
cat >"$project/the models/k and k.mtx" <<'END'
%%MatrixMarket matrix array real general
2 2
200
-100
-100
200
END
# The first state after 10 s. REAL: the type of its numbers
cat >"$project/main.c" <<'END'
#include "drive.h"
#include <stdio.h>

#ifndef REAL
#define REAL double
#endif

int main(void)
{
    REAL y[DRIVE_STATES];
    drive s;
    drive_init(&s);
    drive_run(&s, 1000, NULL);
    drive_get(&s, y);
    printf("%.6f\n", (double)y[0]);
    return drive_status(&s);
}
END
# By the closed form: expected K, the stiffness to the ground in the first row
expected() {
	sed "s/^200/$1/" "$project/the models/k and k.mtx" >"closed k.mtx"
	sed 's/k and k/closed k/' "$project/the models/drive.spec" >closed.spec
	plgen --solution 10 closed.spec | awk -F, 'END { printf "%.6f\n", $2 }'
}

# runs NAME COMMAND ...: writes what `expected` of this stiffness is
runs() {
	name=$1
	stiffness=$2
	shift 2
	"$@" >out 2>>log
	expected "$stiffness" >closed
	cmp -s out closed || echo "found $(cat out), expected $(cat closed)" >>log
	cmp -s out closed
	result $? "$name"
}

# makes_again NAME FOLDER COMMAND ...: the command, which has built all, makes no model; once a matrix is another one it
# makes drive.c in that folder
makes_again() {
	kind=$1
	made=$(find "$2" -name drive.c)
	shift 2
	touch -r "$made" before
	"$@" >log 2>&1
	[ -n "$made" ] && [ -z "$(find "$made" -newer before)" ]
	result $? "$kind: nothing has changed, and no model is made"
	sleep 1
	sed 's/^200/300/' "$project/the models/k and k.mtx" >changed
	cp changed "$project/the models/k and k.mtx"
	"$@" >log 2>&1
	[ -n "$(find "$made" -newer before)" ]
	result $? "$kind: a matrix has changed, and the model is made anew"
}
