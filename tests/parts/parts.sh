#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Scenes of parts against the same equations written in one text by hand: the same C to the byte behind the banner, but
# for the point in names. Which files are read; and what is told of parts.
#
#     parts.sh PLGEN SOURCE_ROOT
set -u
plgen=$(realpath "$1")
root=$(realpath "$2")
here=$root/tests/parts
. "$root/tests/tap.sh"
awk -f "$root/tests/cases.awk" "$here/specs.cases" >flats && cp "$here/stiffness.mtx" . || exit 99

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
		"$plgen" "$@" "$root/$scene" >scene.c && "$plgen" "$@" "${name}_flat.spec" >flat.c &&
			names scene.c >scene && names flat.c >flat && [ "$(wc -l <flat)" -gt 100 ] && diff flat scene
	} >log 2>&1
	result $? "$name${*:+ $*}: as in one text"
}

while read -r scene options; do
	# shellcheck disable=SC2086
	[ -z "$scene" ] || ! one_of 2 || is_flat "$scene" $options
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

# Derivatives of lets, accelerations in lets: the C of the same terms written by hand
while IFS='|' read -r name coord lets left right written_left written_right output written options; do
	for way in let hand; do
		printf 'model m\nparam k = 100, c = 3\ncoord %s\ninput u hold first\ninit x = 1\n' "$coord"
		if [ $way = let ]; then
			printf "%b\n%s = cos(3*t)\n%s = 0\noutput x, o = %s\n" "$lets" "$left" "$right" "$output"
		else
			printf "%s = cos(3*t)\n%s = 0\noutput x, o = %s\n" "$written_left" "$written_right" "$written"
		fi
		echo 'step 0.01'
	done >both.spec
	# shellcheck disable=SC2086
	sed '/^step/q' both.spec >m.spec && "$plgen" $options m.spec >let.c 2>log &&
		sed '1,/^step/d' both.spec >m.spec &&
		"$plgen" $options m.spec >hand.c 2>>log &&
		sed '1,/^ \*\/$/d' let.c >lets && sed '1,/^ \*\/$/d' hand.c >hand &&
		[ "$(wc -l <hand)" -gt 50 ] && diff lets hand >>log 2>&1
	result $? "$name: as written by hand"
done <<'END'
d'|x, y|let d = x - u|x'' + k*d + c*d'|y'' + y - d'|x'' + k*(x - u) + c*(x' - u')|y'' + y - (x' - u')|d'|x' - u'
d''|x, y|let d = x - y|x'' + d'' + x|y'' + c*d'|x'' + (x'' - y'') + x|y'' + c*(x' - y')|d''|x'' - y''
an acceleration|x, y|let a = x''\nlet f = 2*a|f + k*x|y'' + a + y|2*x'' + k*x|y'' + x'' + y|f|2*x''
a product|x, y|let p = x*y|x'' + k*x + p'|y'' + y|x'' + k*x + x'*y + x*y'|y'' + y|x'|x'|--scheme radau
a sine|x, y|let p = sin(x)|x'' + k*x + p'|y'' + y|x'' + k*x + cos(x)*x'|y'' + y|p'|cos(x)*x'|--scheme taylor
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

echo '{"left": {"e": 5e-1, "one": {"e": "0.5*e"}}, "w": 7}' >values.json
printf 'name,value\r\n# as above\nleft.one.e, "0.5*e"\nw,7\nleft.e,5e-1\n' >values.csv
"$plgen" -D left.e=0.5 -D 'left.one.e=0.5*e' -D w=3 chain.spec 2>log | sed -e '1,/^ \*\/$/d' >defined
for kind in json csv; do
	"$plgen" --depfile d --params values.$kind -D w=3 chain.spec 2>>log | sed -e '1,/^ \*\/$/d' >from_file
	diff from_file defined >>log && [ -s defined ] && grep -q " values.$kind" d
	result $? "--params FILE.$kind is as -D for each of its values, of which -D wins; the dependency file has it"
done

# is_needed NAME NEED: with this need the same choice is made as of one text, and the same C
cp "$root"/models/*.spec . && cp "$here"/*.spec . || exit 99
is_needed() {
	{ cat "$1.spec" && echo "need $2"; } >needed.spec
	{ cat "$1_flat.spec" && echo "need $2" | sed 's/\./_/g'; } >needed_flat.spec
	{
		"$plgen" needed.spec >scene.c && "$plgen" needed_flat.spec >flat.c && grep ' certified ' scene.c &&
			names scene.c >scene && names flat.c >flat && [ "$(wc -l <flat)" -gt 60 ] && diff flat scene
	} >log 2>&1
	result $? "$1, need $2: as in one text"
}
merging && is_needed drivetrain 'drive within 1 % until 1'
is_needed street 'n1.roof within 1 % until 10 for |quake| <= 3'
merging && is_needed street 'n10.base within 1e4 until 10 for |quake| <= 3'

# What is left of the street for one output: the modes of the one building that it sees
{ sed '/^output/,$d' street.spec && printf 'output n3.roof\nstep 0.02\n' &&
	printf 'need n3.roof within 1 %% until 10 for |quake| <= 3\n'
} >one.spec
"$plgen" --explain=json one.spec >json 2>log && cat json >>log &&
	grep -qF '{"name": "n4", "file": "building.spec", "modelled": false}' json &&
	[ "$(grep -c '"modelled": true' json)" -eq 1 ] &&
	! "$plgen" one.spec 2>>log | sed -e '1,/^ \*\/$/d' | grep 'n[124-9][._]' >>log
result $? 'a need: parts that no output sees are not modelled'

{ echo 'need speed within 1e-3 until 1'; echo 'budget 100 instructions on cortex-m0'; } >>inertia.spec
"$plgen" drivetrain.spec >needs_apart.c 2>log && head -n 60 needs_apart.c >>log &&
	grep -q 'inertia.spec as .*not used of it: step, need, budget\.' needs_apart.c &&
	! grep -q certified needs_apart.c
result $? 'needs and the budget of a part are of the part by itself'

"$plgen" --explain=json chain.spec >json 2>log &&
	grep -qF '"dropped": ["spare.x", "spare.x'"'"'"],' json &&
	grep -qF '{"name": "spare", "file": "link.spec", "modelled": false}' json &&
	grep -qF '{"name": "left.two", "file": "link.spec", "modelled": true}' json &&
	grep -qF '"states": ["left.one.x", "left.two.x", "right.one.x", "right.two.x", ' json
result $? '--explain=json: parts, what is not modelled, names'

"$plgen" chain.spec 2>log | head -n 40 >banner &&
	grep -qF 'link.spec as left.one, left.two, right.one, right.two; not used of it: step, scheme.' banner &&
	grep -qF 'link.spec as spare, which no output sees: not modelled.' banner &&
	grep -qF 'left.one: x' banner
result $? 'the banner names the parts'

"$plgen" --depfile links.spec chain.spec >out 2>log
[ $? -eq 1 ] && grep -qF 'links.spec: error: the spec reads this file' log && cmp links.spec "$here/links.spec" >>log
result $? 'a part is not written over'
tap_end
