#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Models with loads, stepped in double and in float beside their closed form: what rounding takes (loads.c). Random
# ones, and some in which what the step loses to a load is far larger than what the load leaves in a state.
#
#     loads.sh PLGEN SOURCE_ROOT LOAD_SPECS [FIRST LAST [SEED]]
root=$2
specs=$(realpath "$3")
first=${4-1}
last=${5-3}
seed=${6-1}
. "${0%/*}/../plgen.sh"
echo '#include <math.h>' >models.c
cat >table <<'EOF'
static const struct load_model {
    const char *name;
    const pl_model *model;
    const pl_modelf *modelf;
    double bound, boundf;
} load_models[] = {
EOF

# stated FILE: the bound in its banner
stated() {
	sed -n 's/.* loads included, rounding errors are at most \([^ ]*\) of .*/\1/p' "$1"
}

# add NAME [OPTIONS]: NAME.spec, inputs 0 in the closed form, outputs linear
add() {
	name=$1
	shift
	h=$(sed -n 's/^step //p' "$name.spec")
	sed -e '/^input/d' -e '/^tunable/d' -e 's/= u + /= /' -e 's/log(exp(\(.*\)))/\1/' "$name.spec" >closed.spec
	"$plgen" --prefix "d$name" "$@" "$name.spec" >d.c 2>log &&
		"$plgen" --real float --prefix "f$name" "$@" "$name.spec" >f.c 2>>log &&
		"$plgen" --solution "1000*$h" closed.spec >"$name.csv" 2>>log || {
		result 1 "$name"
		tap_end
	}
	cat d.c f.c >>models.c
	echo "    {\"$name\", &d${name}_model, &f${name}_model, $(stated d.c), $(stated f.c)}," >>table
}

"$specs" "$first" "$last" "$seed" || exit 99
k=$first
while [ "$k" -le "$last" ]; do
	mv "$k.spec" "r$k.spec"
	add "r$k"
	k=$((k + 1))
done

# pair NAME LOAD [STATEMENTS]: the second mass driven far above its poles, the first only through it
pair() {
	cat >"$1.spec" <<-END
		model $1
		coord x1, x2
		${3-}
		x1'' + x1 + 0.1*x1' - 0.5*x2 = 0
		x2'' + x2 + 0.1*x2' - 0.5*x1 = $2
		step 0.01
	END
}
pair power 't^4*cos(968*t)'
add power
pair plain 'cos(968*t)'
add plain
pair direct 't^4*cos(968*t)'
! merging || add direct --form direct
pair compensated 't^4*cos(968*t) + t'
add compensated --accuracy compensated
pair growing 't^2*exp(-0.2*t)*cos(500*t) + 0.001*cos(2*t)'
add growing
pair accelerations 't^4*cos(968*t)' "output x1, x1'', x2', d = x2 - x1"
! merging || add accelerations
pair driven 'u + t^3*cos(700*t)' 'input u'
! merging || add driven
pair ramped 'u + t^3*cos(700*t)' 'input u hold first'
add ramped
pair changing '(t < 3.003 ? t^4*cos(968*t) : t < 5.0071 ? 0 : t^2*sin(400*t))'
add changing
pair doubled '(t < 4.0031 ? t^4*cos(968*t) : t < 5.0071 ? 2*t^4*cos(968*t) : t^4*cos(968*t))'
add doubled
pair passing 't^4*cos(968*t) + (t < 3.003 ? 0 : 1e-9*(t - 3.003))'
add passing
pair passing_driven 'u + (t < 4 ? t^4*cos(968*t) : (1 + 1e-9)*t^4*cos(968*t))' 'input u'
! merging || add passing_driven --form delta
pair passing_compensated 't^4*cos(968*t) + (t < 4 ? 0 : 1e-9)' "output d = x1 - x2, x2'', x1', x2"
add passing_compensated --accuracy compensated
cat >kicked.spec <<-END
	model kicked
	coord x1, x2
	x1'' + x1 - 0.5*x2 = 0
	x2'' + x2 - 0.5*x1 = t^4*cos(968*t)
	step 0.01
END
add kicked
cat >loose.spec <<-END
	model loose
	coord a, b, c
	a'' + 0.1*(a' - b') + (a - b) = t^4*cos(900*t)
	b'' + 0.1*(b' - a') + (b - a) + 2*(b - c) = -t^4*cos(900*t)
	c'' + 2*(c - b) = 0
	output r = a - b, q = b - c, r_rate = a' - b', q_rate = b' - c'
	output centre = (a + b + c)/3, centre_rate = (a' + b' + c')/3
	step 0.01
END
add loose
sed -e 's/^model loose/model loose_passing/' \
	-e 's/t^4\*cos(900\*t)/(t < 4.56 ? t^4*cos(900*t) : 1.000001*t^4*cos(900*t))/' loose.spec >loose_passing.spec
add loose_passing
# chain NAME LOAD [STATEMENTS]: free, driven far above its poles at one mass, whose motion is in all differences
chain() {
	cat >"$1.spec" <<-END
		model $1
		coord x1, x2, x3, x4
		${3-}
		2.05*x1'' + 0.0124*x1' + 1.43*(x1 - x2) = 0
		0.581*x2'' + 0.00831*x2' + 1.43*(x2 - x1) + 1.43*(x2 - x3) = $2
		0.934*x3'' + 0.0143*x3' + 1.43*(x3 - x2) + 1.43*(x3 - x4) = 0
		0.659*x4'' + 0.0431*x4' + 1.43*(x4 - x3) = 0
		step 0.02762
	END
}
fast='1.84*t^3*exp(0.0709*t)*cos(76.54*t + 1.4)'
chain chain "$fast"
add chain
chain chain_passing "(t < 8.3057 ? $fast : t < 11.06 ? 0.3*$fast : 0)"
add chain_passing
chain reads "$fast" "output x4, x1, x3', d = x3 - x4, x4'', x2"
! merging || add reads
chain reads_passing "(t < 8.3057 ? $fast : 1.001*$fast)" "output x4, d = x3 - x4, x4'', x2"
! merging || add reads_passing
chain whole "$fast" "output x1, d = log(exp(x2 - x3))"
! merging || add whole
chain chain_compensated "$fast"
! merging || add chain_compensated --accuracy compensated
awk 'BEGIN {
	print "model large"
	for (i = 1; i <= 10; i++) printf "%s%s", (i == 1 ? "coord x" : ", x"), i
	print ""
	for (i = 1; i <= 10; i++)
		printf "x%d%s + 0.05*x%d%s + 3*x%d%s%s = %s\n", i, "\047\047", i, "\047", i,
			(i == 1 ? "" : " - x" i - 1),
			(i == 10 ? "" : " - x" i + 1), (i == 1 ? "t^3*cos(700*t)" : 0)
	print "step 0.01"
}' >large.spec
! merging || add large
sed -e 's/^model large/model large_passing/' -e 's/= t^3.*/= t^3*cos(700*t) + (t < 2.5 ? 0 : 1e-8*(t - 2.5))/' \
	large.spec >large_passing.spec
! merging || add large_passing --form delta
cat >symmetric.spec <<-END
	model symmetric
	coord x0, x1, x2
	init x0 = -1/3, x2 = 1/3
	x0'' + 2.3*x0 + 100/3*(x0 - x1) = -cos(5*t)
	x1'' + 2.3*x1 + 100/3*(2*x1 - x0 - x2) = 0
	x2'' + 2.3*x2 + 100/3*(x2 - x1) = cos(5*t)
	output x0, x2
	step 0.01
END
add symmetric
echo "$(stated d.c) $(stated f.c)" >log
awk '{ exit !($1 > 0 && $1 < 1e-12 && $2 > 0 && $2 < 1e-3) }' log || {
	result 1 "a state that stays at 0 by symmetry counts for nothing in the bound: $(cat log)"
	tap_end
}

echo '};' >>table
cat models.c table >load_models.h
# without a warning: for `make check` ../warnings asks that
while long && read -r compiler; do
	command -v "${compiler%% *}" >/dev/null || continue
	# shellcheck disable=SC2086
	$compiler -fsyntax-only -Wall -Wextra -Wpedantic -Wconversion -Wdouble-promotion -Wshadow \
		-Werror -I"$root/runtime" \
		models.c >log 2>&1 </dev/null || {
		result 1 "$compiler"
		tap_end
	}
done <<-END
	${CC:-cc} -std=c99
	clang -std=c99
	g++ -std=c++17 -x c++
END
$run_cc -I"$root/runtime" -I"$root/tests/emitted" -I. -o program "$root/tests/forms/loads.c" \
	"$root/tests/emitted/tap.c" "$archive" -lm >log 2>&1 || {
	result 1 'the models compile'
	tap_end
}
./program .
exit $?
