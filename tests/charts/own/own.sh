#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# own.sh BUILD ROOT [SPEC...]: the chart of any spec, on these, or all models: errors and orders, never times; and what
# it refuses, with the reason.
set -u
build=$1 root=$2
shift 2
here=$root/tests/charts/own
work=$(mktemp -d "${TMPDIR:-/tmp}/own_test.XXXXXX") || exit 99
trap 'rm -rf "$work"' EXIT
trap 'exit 99' HUP INT TERM
cd "$root" || exit 99
LC_ALL=C
export LC_ALL
count=0
failed=0
# what bounces or sticks is refused: below. Words: names of files
# shellcheck disable=SC2046
[ $# -gt 0 ] || set -- $(grep -Le '^when' -e restitution -e '[^a-z]friction(' models/*.spec)

# result STATUS NAME: a line of TAP; what there is to say is in log
result() {
    count=$((count + 1))
    if [ "$1" -eq 0 ]; then
        echo "ok $count - $2"
    else
        echo "not ok $count - $2"
        failed=1
        sed 's/^/# /' "$work/log" | tail -n 20
    fi
}

chart() {
    sh bench/charts/own/own.sh -q "$build/plgen" "$@" >"$work/log" 2>&1
}

for spec; do
    name=$(basename "$spec" .spec)
    chart "$spec" "$work"
    result $? "$name: charted"
    awk -v name="$name" -f bench/charts/csv.awk -f "$here/own.awk" "$work/$name.csv" >"$work/log" 2>&1
    result $? "$name: errors and orders of plgen's steps and of peers"
    {
        grep -q '</svg>' "$work/$name.svg" && grep -q -e '<use ' "$work/$name.svg" || echo "the picture is not whole"
        [ "$(grep -c '^error below 1e-[0-9]*:' "$work/$name.txt")" = 4 ] || cat "$work/$name.txt"
    } >"$work/log" 2>&1
    [ ! -s "$work/log" ]
    result $? "$name: a picture, and a verdict for each wanted error"
done

# refused NAME STATUS TEXT ARGUMENT...: that text is said
refused() {
    what=$1 text=$2
    shift 2
    chart "$@"
    [ $? -eq 1 ] && grep -qF -e "$text" "$work/log"
    result $? "refused: $what"
}
refused 'what plgen refuses, in its words' "unknown.spec:3:11: error: unknown name 'z'" "$here/unknown.spec" "$work"
refused 'inputs joined by cubics' 'inputs that are joined by polynomials of higher degree' "$here/third.spec" "$work"
refused 'what bounces' 'what bounces is not charted' models/bouncing_ball.spec "$work"
refused 'what sticks' 'has no formula for friction' models/stick_slip.spec "$work"
refused 'no such file' 'no file nothing.spec' nothing.spec "$work"
refused 'no output before the end' 'are 0 outputs' models/pendulum.spec "$work" 0.01
refused 'a time that is none' 'error:' models/pendulum.spec "$work" 1 x

echo "1..$count"
exit $failed
