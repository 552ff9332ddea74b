#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# report.sh PLGEN ROOT: poles, natural frequencies and damping ratios as plgen tells them, of a model whose modes are
# known before.
set -u
plgen=$(realpath "$1") || exit 99
root=$(cd "$2" && pwd) || exit 99
here=$root/tests/report
. "$root/tests/tap.sh"

# told WHAT NAME OPTION ...: see modes.awk
told() {
	what=$1
	name=$2
	shift 2
	"$plgen" "$@" "$here/modes.spec" >text 2>log && awk -v what="$what" -f "$here/modes.awk" text >log
	result $? "$name"
}
told text 'the table of --explain' --explain
told text 'the table of the banner'
told poles 'the poles of --explain=json' --explain=json
told modes 'the modes of --explain=json' --explain=json
told polynomial 'B(s) of --explain' --explain
told polynomial 'B(s) of the banner'

# keys NAME SPEC OPTION ...: none of --explain=json stands twice, and modes are frequencies and ratios
keys() {
	name=$1
	spec=$2
	shift 2
	"$plgen" --explain=json "$@" "$spec" 2>log >json && python -c '
import json, sys
def once(members):
    names = [name for name, value in members]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        sys.exit("twice: " + ", ".join(twice))
    return dict(members)
told = json.load(sys.stdin, object_pairs_hook=once)
if not all(set(mode) == {"frequency_hz", "damping_ratio"} for mode in told["modes"]):
    sys.exit("modes are not frequencies and damping ratios: %s" % told["modes"][:2])' <json 2>log
	result $? "keys of --explain=json, once each: $name"
}
keys linear "$here/modes.spec"
keys 'some modes' "$root/models/drivetrain.spec" --modes 2
keys 'normal modes' "$root/models/beam4.spec" --scheme etdam4
keys 'a series' "$root/models/pendulum.spec" --scheme taylor
keys regions "$root/models/gear1.spec"
keys parts "$root/models/half_car.spec"

# (2 + 1/4) x'' + x'/2 + (100 + 50/4) x = 0, and a pole where what misses the constraints decays, which is of the model
printf '%s\n' 'model held' 'coord x, y, v, w, z' 'mass 2 at x' 'mass 1 at y' 'spring 100 between x, ground' \
	'damper 0.5 between x, ground' 'spring 50 between y, ground' 'mass 1 at v' 'mass 2 at w' "z' = -400*z" \
	'damper 6 between v, ground' 'init x = 1, y = 0.5' \
	'constraint rod: x = 2*y' "constraint belt: v' = w'" 'step 0.01' >held.spec
"$plgen" --explain held.spec >log 2>&1
sed -n '/^    pole/,/^$/{s/^\(.\{41\}\).*/\1/;s/ *$//;p;}' log | tail -n +2 >poles
grep -q 'B(s) = s^6 + 3620/9 s^5 ' log && [ "$(cat poles)" = "    0  (2-fold)
    -2
    -0.11111111 +- 7.0701948 i
    -400" ] && "$plgen" --explain=json held.spec | grep -q '"re": -400, "im": 0, "multiplicity": 1}'
result $? 'beside eliminated constraints, the poles of what they leave'
sed -i "s/, v, w, z$//; / at [vw]$/d; /belt/d; /^z'/d; /^damper 6/d; s/^step.*/output x, y, rod/" held.spec
echo 'need x within 1e-4 until 10' >>held.spec
"$plgen" --explain held.spec >log 2>&1
grep -q 'Modes 1 of 2 are kept' log && grep -q 'dropped *none: it is of the constraints' log &&
	grep -q 'B(s) = s^2 + 0.222222222222 s + 50' log &&
	grep -q '^    -0.11111111 +- 7.0701948 i' log && ! grep -q '2-fold' log
result $? 'of some modes, too'
tap_end
