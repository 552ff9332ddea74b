#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Scenes of parts against the same equations written in one text by hand: the same C to the byte behind the banner, but
# for the point in names. Which files are read; and what is told of parts.
#
#     parts.sh PLGEN SOURCE_ROOT
set -u
plgen=$1
root=$2
case $plgen in /*) ;; *) plgen=$PWD/$plgen ;; esac
case $root in /*) ;; *) root=$PWD/$root ;; esac
here=$root/tests/parts
. "$root/tests/tap.sh"

# names FILE: without banner; front.body as front_body
names='front|rear|engine|flywheel|gearbox|prop|axle|wheels|n[0-9]+|left|right|one|two|a|b|m|n'
names() {
    sed -e '1,/^ \*\/$/d' "$1" | sed -E ":again; s/(^|[^A-Za-z0-9_.])((($names)_)*($names))\./\1\2_/g; t again"
}

# is_flat SCENE OPTION ...
is_flat() {
    scene=$1
    name=${scene##*/}
    name=${name%.spec}
    shift
    {
        "$plgen" "$@" "$root/$scene" >scene.c && "$plgen" "$@" "$here/${name}_flat.spec" >flat.c &&
            names scene.c >scene && names flat.c >flat && [ "$(wc -l <flat)" -gt 100 ] && diff flat scene
    } >log 2>&1
    result $? "$name${*:+ $*}: as in one text"
}

while read -r scene options; do
    # shellcheck disable=SC2086
    [ -z "$scene" ] || is_flat "$scene" $options
done <<'END'
models/half_car.spec
models/half_car.spec --rhs
models/half_car.spec --real float
models/half_car.spec --accuracy compensated
models/half_car.spec --scheme pl
models/drivetrain.spec
models/drivetrain.spec --real float --selftest
models/drivetrain.spec --batch
models/street.spec --rhs
tests/parts/chain.spec --rhs
tests/parts/chain.spec --scheme radau
tests/parts/chain.spec --scheme etdrk4 --real float
tests/parts/stops.spec --rhs
tests/parts/stops.spec --scheme etdrk4
tests/parts/cells.spec --rhs
END

"$plgen" --depfile d "$here/cells.spec" >log 2>&1 &&
    sed "s|$here/||g" d >>log &&
    grep -qx 'cells_pl.c: cells.spec cell.spec stiffness.mtx' log
result $? 'files of parts are in the dependency file'

cp "$here"/*.spec "$here"/*.mtx . && "$plgen" cells.spec >from_file 2>log &&
    "$plgen" - <cells.spec >from_stdin 2>>log &&
    sed 's/cells\.spec/<stdin>/' from_file | diff - from_stdin >>log
result $? 'standard input: parts are relative to the working directory'

"$plgen" -D left.e=0.5 chain.spec 2>log | sed -e '1,/^ \*\/$/d' >defined &&
    sed 's/^param e = 0.25/param e = 0.5/' links.spec >other.spec &&
    sed 's/"links.spec" as left/"other.spec" as left/' chain.spec >chain_other.spec &&
    "$plgen" chain_other.spec 2>>log | sed -e '1,/^ \*\/$/d' | diff - defined >>log
result $? '-D gives a param of a part another value, and what is made of it'

"$plgen" --explain=json chain.spec >json 2>log &&
    grep -qF '"dropped": ["spare.x", "spare.x'"'"'"],' json &&
    grep -qF '{"name": "spare", "file": "link.spec", "modelled": false}' json &&
    grep -qF '{"name": "left.two", "file": "link.spec", "modelled": true}' json &&
    grep -qF '"states": ["left.one.x", "left.two.x", "right.one.x", "right.two.x", ' json
result $? '--explain=json: parts, what is not modelled, names'

"$plgen" chain.spec 2>log | head -n 40 >banner &&
    grep -qF 'link.spec as left.one, left.two, right.one, right.two; not read here: its step, scheme.' banner &&
    grep -qF 'link.spec as spare, which no output sees: not modelled.' banner &&
    grep -qF 'left.one: x' banner
result $? 'the banner names the parts'

"$plgen" --depfile links.spec chain.spec >out 2>log
[ $? -eq 1 ] && grep -qF 'links.spec: error: the spec reads this file' log && cmp links.spec "$here/links.spec" >>log
result $? 'a part is not written over'
tap_end
