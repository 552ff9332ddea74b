#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Robertson's reaction to 1e11 s, whose second species is 8e-14 at the end and 4e-5 at most: with an absolute tolerance
# its published values (Mazzia, Magherini, Test set for IVP solvers, 2008) at coarse tolerances; without one its course
# has no digit left, and a range tells so.
#
#     small.sh PLGEN SOURCE_ROOT PLRUN
root=$2
plrun=$(realpath "$3")
. "${0%/*}/../plgen.sh"
main_of reaction

# reaction SCHEME STATEMENTS [OPTIONS]: into out.csv
reaction() {
    cat >reaction.spec <<EOF
model reaction
param least = 1e-12
coord a, b, c
a' = -0.04*a + 1e4*b*c
b' = 0.04*a - 1e4*b*c - 3e7*b^2
c' = 3e7*b^2
init a = 1
step 1e10
scheme $1
$2
EOF
    shift 2
    # shellcheck disable=SC2086
    "$plgen" "$@" reaction.spec >reaction.c 2>log &&
        ${CC:-cc} -std=c99 -O0 -I"$root/runtime" $main reaction.c "$archive" -o reaction 2>>log &&
        ./reaction 1e11 >out.csv 2>>log
}

# near BOUND: the last row, each species relative to its published value
near() {
    tail -n 1 out.csv >>log
    tail -n 1 out.csv | awk -F, -v bound="$1" '
        function off(a, b) { return a > b ? a / b - 1 : 1 - a / b }
        { worst = off($2, 0.2083340149701255e-07); if (off($3, 0.8333360770334713e-13) > worst)
            worst = off($3, 0.8333360770334713e-13); if (off($4, 0.9999999791665050) > worst)
            worst = off($4, 0.9999999791665050); print "off by", worst
          exit !($1 == 1e11 && worst <= bound) }' >>log
}

for scheme in radau auto; do
    for digits in 4 5 6; do
        [ -z "${LONG:-}" ] && [ $scheme$digits != radau4 ] && [ $scheme$digits != auto6 ] && continue
        reaction $scheme "tolerance 1e-$digits, absolute least" && near "1e-$digits"
        result $? "$scheme, tolerance 1e-$digits, absolute 1e-12: the published values"
    done
done
reaction radau 'tolerance 1e-4, absolute 1e-12' --tolerance 1e-9 && near 1e-7
result $? 'a tolerance on the command line: the absolute one stays'
reaction radau 'tolerance 1e-5
tolerance of b = least/100, a = 1e-12' -D least=1e-12 && near 1e-5
result $? 'of two species each'
for digits in 4 6; do
    ! reaction radau "tolerance 1e-$digits
range a in [0, 1], b in [0, 1]" && grep -q 'a state has left the range that the spec gives it' log
    result $? "tolerance 1e-$digits alone: a species leaves its range, and that is told"
done

# ---- plrun, which runs it by itself, says which state is too small for its measure ----

told() {
    CC=${run_cc%% *} CFLAGS=${run_cc#* } XDG_CACHE_HOME=$work/cache "$plrun" reaction.spec 1e8 2>&1 >log |
        grep '^note: before t = ' >>log
    grep -q 'b was at most .*tolerance of b = ' log
}
reaction radau 'tolerance 1e-4' --step 1e6 && sed -i.bak 's/^step.*/step 1e6/' reaction.spec && told
result $? 'plrun: a species without a digit is named'
echo 'tolerance of b = 1e-15' >>reaction.spec
! told
result $? 'plrun: with an absolute tolerance of its own it is not'

# ---- more coordinates than matrices of 40: a chain of cubic springs keeps its energy, and goes as by a series ----
run_here() {
    CC=${run_cc%% *} CFLAGS=${run_cc#* } XDG_CACHE_HOME=$work/cache "$plrun" "$@"
}
awk -v n=42 'BEGIN {
    print "model row\ncoord x[" n "]"
    for (i = 1; i <= n; i++) {
        a = i > 1 ? "(x[" i "] - x[" i - 1 "])" : "x[1]"
        b = i < n ? " - (x[" i + 1 "] - x[" i "]) - (x[" i + 1 "] - x[" i "])^3" : ""
        print "x[" i "]'"''"' + " a " + " a "^3" b " = 0"
        e = e (i > 1 ? " + " : "") "x[" i "]'"'"'^2/2 + " a "^2/2 + " a "^4/4"
    }
    print "init x[1] = 0.5\noutput x[1], x[4], e = " e "\nstep 0.1\nscheme taylor 16"
}' >row.spec
run_here row.spec 2 --every 1 >series.csv 2>log
for scheme in radau auto; do
    sed "s/^scheme.*/scheme $scheme\ntolerance 1e-9/" row.spec >row_$scheme.spec
    run_here row_$scheme.spec 2 --every 1 >out.csv 2>log
    paste -d , series.csv out.csv | awk -F, 'function off(a, b, d) { d = a - b; return d < 0 ? -d : d }
        NR > 1 { for (i = 2; i <= 3; i++) if (off($i, $(i + 4)) > worst) worst = off($i, $(i + 4))
            if (off($8, first ? first : first = $8) > drift) drift = off($8, first) }
        END { print "off by", worst, "energy by", drift; exit !(NR == 4 && worst < 1e-8 && drift < 1e-8) }' >>log
    result $? "$scheme, 42 coordinates: within 1e-8 of a series, energy within 1e-8"
done

# ---- a root of t has no Taylor series at 0, and without a scheme a collocation is taken: x = t^1.5 ----

cat >root.spec <<'EOF'
model root
coord x
x' + x + x^3 = 1.5*sqrt(t) + t^1.5 + t^4.5
step 0.1
tolerance 1e-10
EOF
run_here root.spec 3 >out.csv 2>log
awk -F, 'NR > 1 { d = $2 - $1^1.5; worst = d > worst ? d : -d > worst ? -d : worst }
    END { print "off by", worst; exit !(NR == 32 && worst < 1e-8) }' out.csv >>log && grep -q 'scheme auto' log
result $? 'a root of t that starts from 0'

# ---- from rest in all states a series measures none by the rounding that it is ----

awk -v only=ring_modulator -f "$root/tests/cases.awk" "$root/tests/jury/testset.cases" >>log
run_here --scheme taylor --tolerance 1e-12 ring_modulator.spec 3e-6 >out.csv 2>log && [ "$(wc -l <out.csv)" -eq 5 ]
result $? 'taylor: a circuit at rest starts'
tap_end
