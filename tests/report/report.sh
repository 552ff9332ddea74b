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

tap_end
