#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# solution.sh PLGEN MODEL.spec STEPS PARTS: the closed form of the states at every h/PARTS, over STEPS steps.  Inputs
# become what the spec says in lines `#closed ...`, and the slope u' is `slope` there.
set -eu
spec=$2
h=$(sed -n 's/^step *\([^ #]*\).*/\1/p' "$spec")
sed -e '/^input/d' -e '/^output/d' -e "s/u'/slope/g" -e 's/^#closed //' "$spec" |
    "$1" --solution "$3*$h" --step "$h/$4" -
