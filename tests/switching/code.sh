#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The emitted C of piecewise-linear models: the same bytes twice, nothing from <math.h>; with LONG=1 no warning in any
# compiler (without, ../warnings asks that).
#
#     code.sh PLGEN SOURCE_ROOT NAME_variants.c ...
root=$2
files=$(shift 2; realpath "$@")
. "${0%/*}/../compilers.sh"
. "${0%/*}/../plgen.sh"
here=$root/tests/switching
awk -f "$root/tests/cases.awk" "$root/tests/switching/specs.cases" >names || exit 99

list_compilers >compilers

for file in $files; do
	by_each "${file##*/}" -I"$here" -I"${file%/*}" "$file"
done
# shellcheck disable=SC2086
for file in $(third 2 $files); do
	name=${file##*/}
	list=${name%_variants.c}
	"$here/variants.sh" "$plgen" "$here/$list.list" "$work/$name" "$work/${name%.c}.h" "$here" \
		"$root/models" >log 2>&1 &&
		cmp "$file" "$work/$name" >>log 2>&1 && cmp "${file%.c}.h" "$work/${name%.c}.h" >>log 2>&1
	result $? "$list: the same bytes twice"
done

# Each line a model: what its step needs (inputs, slopes, times, loads) differs.
cat >kinds <<'END'
coord x; x'' + x + max(x, 0) = 0
coord x; x'' + x + max(x, 0) = t
coord x; x'' + x + max(x - t, 0) = 0
coord x; x'' + x + max(x, 0) = exp(-t)*sin(2*t) + t^2
coord x, y; x' + y + max(x, 0) = t; y'' + y = x
coord x, q[9]; x'' + x + max(x, 0) = 0; q'' + q = 0
coord x, y, z; input u, v hold first; x'' + x + max(x - u, 0) = t^2; y' + abs(y) = v; z'' + z = cos(t) + t^3 + v'
coord x; x'' + x + abs(x - cos(t)) = 1
coord x; input u; x'' + x + max(x, 0) = u
coord x; input u; x'' + x + max(x - u, 0) = 0
coord x; input u hold first; x'' + x + max(x - u, 0) = u'
coord x; input u hold first; x'' + x + max(x' - u', 0) = 0
coord x; input u, v; x'' + x + max(u - v, 0) = 0
coord x; x'' + x = max(sin(t) - 0.5, 0)
coord x; x' + max(x, 0) = sin(t)
coord x, y; x'' + x + max(x - y, 0) = 0; y' + y - max(x' - 1, 0) = 0
coord q[3]; q'' + [2, -1, 0; -1, 2, -1; 0, -1, 1]*q + deadzone(q, -1, 1) = [1; 0; 0]*cos(t)
coord x; mass 1 at x; spring 2 between x, ground; force -10*max(x - 1, 0) on x
coord x; x'' + x + 3*max(x - 1, 0) = 0; output x, e = max(x - 1, 0), a = x''
coord x; x'' + abs(x) = 0
coord x; x'' = -max(x, 0)
coord x; x'' + 0.1*x' + max(min(x, 1), -1) + clip(x, -2, 2) + table(2*x; 0, 0; 1, 1; 3, 2) = 0
END
number=0
while read -r kind; do
	number=$((number + 1))
	{ echo 'model kind'; printf '%s\n' "$kind; step 0.01; scheme exact" | tr ';' '\n' | sed 's/^ *//'; } >kind.spec
	# ';' divides the points of a table and rows of a matrix too: those lines are joined again
	awk '{ line = line $0; open = gsub(/[([]/, "&", line) - gsub(/[])]/, "&", line)
		if (open > 0) { line = line "; ";
		next } print line; line = "" }' \
		kind.spec >joined.spec
	: >log
	status=0
	"$plgen" --rhs joined.spec >kind.c 2>log || status=1
	"$plgen" --rhs joined.spec >again.c 2>>log
	cmp kind.c again.c >>log 2>&1 || status=1
	long && cp compilers some || echo "$run_cc -c -o object.o" >some
	while read -r compiler; do
		command -v "${compiler%% *}" >/dev/null 2>&1 || continue
		# shellcheck disable=SC2046,SC2086
		${compiler%% *} $(! long || echo $warnings) -I"$root/runtime" ${compiler#* } kind.c >>log 2>&1 ||
			status=1
	done <some
	result $status "$kind"
done <kinds

# ---- a factor that switches is what its branches are ----

# code EQUATION: the C of it, comments apart
code()
{
	printf 'model kind\ncoord x, y\n%s\ny'"''"' + y = 0\nstep 0.01\nscheme exact\n' "$1" >kind.spec
	"$plgen" kind.spec 2>>log | grep -v '^ \*' | grep -v '^/\*'
}

while IFS='|' read -r product branches; do
	: >log
	code "$product" >product.c && code "$branches" >branches.c && [ -s product.c ] &&
		cmp product.c branches.c >>log 2>&1 && [ ! -s log ]
	result $? "$product: as $branches"
done <<'END'
x'' + (x' > 0 ? 2 : 3)*x' + x = 0|x'' + (x' > 0 ? 2*x' : 3*x') + x = 0
x'' + x + (x > 0)*x = 0|x'' + x + (x > 0 ? x : 0) = 0
x'' + x + 2*x*sgn(x) = 0|x'' + x + 2*abs(x) = 0
x'' + x + (x > 0.5 ? 3 : 1)*(x - 0.5) = 0|x'' + x + (x > 0.5 ? 3*x - 1.5 : x - 0.5) = 0
x'' + x = (x > y)*(y > 1)*cos(t)|x'' + x = (x > y ? (y > 1 ? cos(t) : 0) : 0)
x'' + x + (2 - sgn(x - y))*y = 0|x'' + x + (x > y ? y : 3*y) = 0
END

# ---- <math.h>, and what stands alone ----

for name in gear1 gear2 gear3 bilinear stop two_masses quarter_car_bumps; do
	status=1
	if "$plgen" -o model.c "$root/models/$name.spec" >log 2>&1 &&
		$run_cc -I"$root/runtime" -c model.c -o model.o >>log 2>&1; then
		# tcc: memmove of an assignment, a conversion of its own library
		"$nm" -u model.o | awk '{ print $NF }' |
			grep -v -E '^(pl_[a-z_]*|mem(cpy|set|move)|__floatun[sd]i[sd]f|_GLOBAL_OFFSET_TABLE_)$' >>log
		! grep -q '<math\.h>' model.c model.h && [ ! -s log ]
		status=$?
	fi
	result $status "$name: calls nothing but the runtime"
done
gcc -std=c99 -O2 -ffreestanding -fno-builtin -I"$root/runtime" -c "$root/runtime/crossings.c" -o part.o >log 2>&1 &&
	"$nm" -u part.o | awk '{ print $NF }' | grep -v -E '^(pl_[a-z_]*|memcpy|memset|_GLOBAL_OFFSET_TABLE_)$' >>log
[ ! -s log ]
result $? "crossings.c: freestanding"

# ---- expressions as written; what a run that ends early says ----

"$plgen" --explain bump.spec 2>&1 | grep '^    switching function' >log
printf '    switching function 0: -w + x, breakpoints 0.1, 0.2\n    switching function 1: 3*y, breakpoints 3, 6, 15\n' |
	diff - log >>log 2>&1
result $? 'bump: sign and scale of switching functions as first written'

# told SPEC T MESSAGE: plmain ends with status 1 and this message, whatever the time in it
told() {
	name=$(sed -n 's/^model //p' "$1")
	"$plgen" -o told.c "$1" >log 2>&1 && $run_cc -I"$root/runtime" -DMODEL="$name" told.c \
		"$root/runtime/host/plmain.c" "$archive" -o told >>log 2>&1
	./told "$2" >rows 2>message
	status=$?
	sed 's/t = [^:]*:/t = ...:/' message >>log
	[ $status -eq 1 ] && [ "$(cat log)" = "$name: error: t = ...: $3" ]
	result $? "plmain of $name: $3"
}
printf 'model grows\ncoord x\ninit x = 0.5\nx%s - 4*x + max(x - 1, 0) = 0\nstep 0.5\nscheme exact\n' "''" >grows.spec
told grows.spec 1000 'the step has left the finite numbers'
told chatter.spec 100 'the step has met more crossings, or needed a longer search for them, than its bound'

# The comment that explains how an event is found, 25 lines at most, names tables and functions that there are.
for name in gear1 stick_slip two_masses impact_oscillator; do
	"$plgen" "$root/models/$name.spec" >noted.c 2>log
	sed -n '/^\/\* How an event is found/,/^ \*\/$/p' noted.c >note
	sed '/^\/\* How an event is found/,/^ \*\/$/d' noted.c >rest
	lines=$(wc -l <note)
	grep -o "${name}_[a-z_]*" note | sort -u >named
	missing=$(while read -r word; do grep -q "[^A-Za-z_]$word[^A-Za-z_]" rest || printf ' %s' "$word"; done <named)
	echo "$lines lines, $(wc -l <named) names; not there:$missing" >log
	[ "$lines" -gt 5 ] && [ "$lines" -le 25 ] && [ "$(wc -l <named)" -gt 5 ] && [ -z "$missing" ]
	result $? "$name: how an event is found is explained by what there is"
done
tap_end
