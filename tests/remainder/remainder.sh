#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The emitted C of models with a remainder: the same bytes twice, nothing from <math.h> that the model does not call,
# and what plgen says while it makes them; with LONG=1 no warning in any compiler (without, ../warnings asks that).
#
#     remainder.sh PLGEN SOURCE_ROOT NAME_variants.c ...
set -u
plgen=$(realpath "$1")
root=$2
shift 2
files=$(realpath "$@")
here=$root/tests/remainder
. "${0%/*}/../compilers.sh"
. "${0%/*}/../run_cc.sh"
. "${0%/*}/../tap.sh"

# ---- compilers ----

list_compilers >compilers

for file in $files; do
	by_each "${file##*/}" -I"$here" -I"${file%/*}" "$file"
done

# series: the model of kind.spec by its series too, in float to single.c, of fixed order to all.c; none where it has a
# kink in the states
series() {
	case $kind in
		*'abs(x'*) return 0 ;;
	esac
	"$plgen" --prefix kind_single --scheme taylor --real float kind.spec 2>log >single.c || return 1
	"$plgen" --rhs --prefix kind_taylor --scheme 'taylor 4' --tolerance 1e-6 kind.spec 2>log >>all.c
}

# Each line a model: what its remainder needs (inputs, slopes, times, loads, banks) differs.
cat >kinds <<'END'
coord x; input u hold first; x'' + x + x^3 + u*x = 0
coord x; input u hold first; x'' + x + x^3 + u'*x = 0
coord x; input u; x'' + x + x^3 + u*x = 0
coord x; input u hold first; x'' + x + x^3 = u
coord x; input u hold first; x'' + x + u*u = u'
coord x; x'' + x + t*x = 0
coord x; x'' + x + sin(t^2) = 0
coord x; x'' + x + x^3 = exp(-t)*sin(2*t) + t
coord x; x'' + x + x^3 = (t < 0.3 ? 1 : 0)
coord x; x'' + x + t*x^3 = (t < 0.3 ? 1 : 0); operator at x = 0, 1
coord x; let p = 1 + sin(t); x'' + x + p*x = 0; operator at p = 0.5, 1, 2
coord x; let p = 1 + sin(t); x'' + x + p*p = cos(2*t); operator at p = 0.5, 1, 2
coord x; input u; let p = 1 + sin(t); x'' + x + p*x*u = u; operator at p = 0.5, 1, 2
coord x; input u hold first; let p = 1 + sin(t); x'' + x + p*x*u' = u; operator at p = 0.5, 1, 2
coord x; x' + x^2 = 1
coord x; x' = sin(x)
coord x, y; x'' + y = 0; y' + y*x = 0
coord x; x'' = -x^2
coord x; input u hold first; x'' + x + x^3 + abs(t - 0.3)*u*x = (t < 0.3 ? 1 : t)
coord x; x'' + abs(x')*x' + sgn(x) = t; output x, a = x'', e = x^2 + t
END
while read -r kind; do
	{ echo 'model kind'; printf '%s\n' "$kind; step 0.01" | tr ';' '\n' | sed 's/^ *//'; } >kind.spec
	status=0
	: >all.c
	: >said
	for scheme in etd1 etdrk2 etdrk4 nc2 dq4 bm3; do
		"$plgen" --rhs --prefix "kind_$scheme" --scheme "$scheme" kind.spec 2>log >>all.c ||
			{ status=1; cat log >>said; }
	done
	rm -f single.c
	series || { status=1; cat log >>said; }
	long && cp compilers some || echo "$run_cc -c -o object.o" >some
	while read -r compiler; do
		command -v "${compiler%% *}" >/dev/null 2>&1 || continue
		# shellcheck disable=SC2046,SC2086
		for file in all.c single.c; do
			[ ! -e $file ] || ${compiler%% *} $(! long || echo $warnings) -I"$root/runtime" \
				${compiler#* } $file \
				>>said 2>&1 || status=1
		done
	done <some
	cp said log
	result $status "$kind"
done <kinds

# ---- the same bytes twice ----

# shellcheck disable=SC2086
for file in $files; do
	name=${file##*/}
	list=${name%_variants.c}
	"$here/variants.sh" "$plgen" "$here/$list.list" "$work/$name" "$work/${name%.c}.h" "$here" "$root/models" \
		"$root/tests/emitted/linear" >log 2>&1 &&
		cmp "$file" "$work/$name" >>log 2>&1 && cmp "${file%.c}.h" "$work/${name%.c}.h" >>log 2>&1
	result $? "$list: the same bytes twice"
done

# ---- <math.h> ----

# only SPEC SCHEME FUNCTION ...: what the object may ask for beside the runtime
only() {
	spec=$1
	scheme=$2
	shift 2
	if ! "$plgen" --scheme "$scheme" -o model.c "$spec" 2>log ||
		! $run_cc -I"$root/runtime" -c model.c -o model.o >log 2>&1; then
		result 1 "$(basename "$spec"), $scheme: compiled"
		return
	fi
	# tcc: memmove of an assignment, a conversion of its own library
	"$nm" -u model.o | awk '{ print $NF }' |
		grep -v -E '^(pl_[a-z_]*|mem(cpy|set|move)|__floatun[sd]i[sd]f|_GLOBAL_OFFSET_TABLE_)$' | sort >found
	: >expected
	[ $# -eq 0 ] || printf '%s\n' "$@" | sort >expected
	comm -23 found expected >log       # what the runtime does in its stead (cos(w*t), exp(a*t)) may be missing
	status=0
	[ ! -s log ] || status=1
	if [ $# -eq 0 ] && grep -q '<math\.h>' model.c model.h; then
		echo 'includes <math.h>' >>log
		status=1
	fi
	result $status "$(basename "$spec" .spec), $scheme: calls no function but ${*:-those of the runtime}"
}

for scheme in etd1 etdrk4 bm3; do
	only "$root/models/pendulum.spec" "$scheme" sin
	only "$root/models/vanderpol.spec" "$scheme"
	only "$root/models/quad2dof.spec" "$scheme"
	only "$root/models/duffing.spec" "$scheme"
	only "$root/models/mathieu.spec" "$scheme" cos
	only "$here/held.spec" "$scheme"
	only "$here/rotor.spec" "$scheme" exp
done

# ---- what plgen says ----

# says SPEC PATTERN [OPTION ...]: a warning on standard error that matches, and the C all the same
says() {
	spec=$1
	pattern=$2
	shift 2
	"$plgen" "$@" "$spec" >out.c 2>log && [ -s out.c ] && grep -q -i "warning:.*$pattern" log
	result $? "$(basename "$spec" .spec) $*: warns of $pattern"
}

silent() {
	spec=$1
	shift
	"$plgen" "$@" "$spec" >out.c 2>log && [ -s out.c ] && [ ! -s log ]
	result $? "$(basename "$spec" .spec) $*: says nothing"
}

for scheme in nc2 nc3 dq4 bm3; do
	says "$root/models/vanderpol_stiff.spec" explicit --scheme "$scheme" --step 0.05
	silent "$root/models/vanderpol_stiff.spec" --scheme "$scheme" --step 0.001
done
for scheme in etd1 etdrk2 etdrk4; do
	says "$root/models/scs.spec" exact --scheme "$scheme"
	silent "$root/models/vanderpol_stiff.spec" --scheme "$scheme" --step 0.05
done
silent "$root/models/pendulum.spec"
silent "$root/models/duffing.spec" --step 0.01 --scheme etdrk4
says "$root/models/duffing.spec" softer --scheme etdrk4
silent "$root/models/duffing.spec" --scheme taylor

# notes SPEC SCHEME TERM: without a scheme, one note and nothing else, on the term that kept it from exact steps
notes()
{
	"$plgen" "$1" >out.c 2>log && [ "$(grep -c 'note:' log)" -eq 1 ] && ! grep -q 'warning:' log &&
		grep -q -F "note: scheme $2, not exact: '$3'" log
	result $? "${1##*/}: notes that $3 stands in the way of exact, and scheme $2 is taken"
}
notes "$root/models/vanderpol.spec" 'taylor, tolerance 1e-9' "mu*(1 - x^2)*x'"
notes "$root/models/quad2dof.spec" 'taylor, tolerance 1e-9' '-2*x*y'
notes "$root/models/mathieu.spec" etdrk4 '(a - 2*q*cos(2*t))*x'

# orders SPEC SCHEME ORDER SMOOTH TEXT: the order that holds, in JSON, --explain and the banner
orders()
{
	status=0
	"$plgen" --explain=json --scheme "$2" "$1" >out 2>log || status=1
	grep -q -x "  \"order\": $3," out && grep -q -x "  \"smooth\": \"$4\"," out ||
		{ grep -e '"order"' -e '"smooth"' out >log; status=1; }
	for option in --explain --rhs; do
		"$plgen" $option --scheme "$2" "$1" >out 2>/dev/null || status=1
		if [ -n "$5" ]; then
			grep -q -F "$5" out || { echo "$option does not say: $5" >>log; status=1; }
		else
			! grep -q 'where all is smooth' out || { echo "$option speaks of order" >>log; status=1; }
		fi
	done
	result $status "${1##*/}, $2: order $3, $4"
}
awk -f "$root/tests/cases.awk" "$here/specs.cases" >names
orders kinked.spec etdrk4 4 kink ''
orders kinked.spec dq4 2 kink 'here of order 2 at most: max(x - 0.5, 0) has a kink where x passes 0.5.'
orders kinked.spec etdrk2 2 kink ''
orders kinked.spec exact 0 kink ''
orders jumping.spec bm3 1 jump 'here of order 1 at most: (x > 0.3 ? 2 : 0) jumps where x passes 0.3.'
orders jumping.spec etd1 1 jump ''
orders jumping.spec exact 0 jump ''
orders rates.spec dq4 2 kink "here of order 2 at most: (x' > 0 ? 0.5 : 2)*x' has a kink where x' passes 0."
orders bowed.spec dq4 3 kink 'here of order 3 at most: 6*x*abs(x) is not smooth where x passes 0.'
orders hertz.spec nc2 2 kink 'here of order 2.5 at most: max(x, 0)^1.5 is not smooth where x passes 0.'
orders timed.spec dq4 1 jump 'here of order 1 at most: (t < 1.2345678 ? 8 : 2) jumps where t passes 1.2345678.'
orders "$root/models/duffing.spec" etdrk4 4 smooth ''
orders "$root/models/beam4.spec" etdrk4 4 smooth ''
orders "$root/models/scs.spec" exact 0 smooth ''
orders "$root/models/scs.spec" pl 1 smooth ''

tap_end
