#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# report.sh PLGEN ROOT: poles, natural frequencies and damping ratios as plgen tells them, of a model whose modes are
# known before.
set -u
plgen=$(cd "$(dirname "$1")" && pwd)/$(basename "$1") || exit 99
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

tap_end
