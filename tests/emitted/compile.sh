#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# What plgen emits needs nothing but the runtime, runs, and goes into a C++ program; with LONG=1 it compiles without a
# warning, as C99 and as C++17, every file with code by every compiler (without, ../warnings asks that).
#
#     compile.sh PLGEN SOURCE_ROOT SOLUTIONS MODEL ...
#
# SOLUTIONS is a folder with MODEL_solution.csv, of --solution 30.
#
# The compilers are those of GCCS and CLANGS (default: gcc g++, clang clang++); what is not installed is skipped.
root=$2
solutions=$(realpath "$3")
. "${0%/*}/../compilers.sh"
. "${0%/*}/../plgen.sh"
shift 3
models=$*

installed() {
	command -v "$1" >/dev/null 2>&1
}

languages >compilers

# all_compile FILE.c NAME [OPTIONS]: with LONG=1, or `always`, without code, as one result
all_compile() {
	long || [ -n "${always-}" ] || return 0
	status=0
	: >log
	while read -r compiler options; do
		installed "$compiler" || continue
		# shellcheck disable=SC2046,SC2086
        $compiler $warnings -I"$root/runtime" ${3-} -fsyntax-only $([ -n "${3-}" ] || ahead "$compiler" "$1") \
			$options "$1" >>log 2>&1 || status=1
	done <compilers
	result $status "$2"
}

# only_runtime NAMES: does nm -u name anything but pl_*, memcpy, memset?
only_runtime() {
	awk '$1 == "U" { print $NF }' "$1" | grep -v -E '^(pl_[a-z_]*|memcpy|memset)$' >log
	[ ! -s log ]
}

# same_columns FOUND.csv EXPECTED.csv
same_columns() {
	awk -F, -f "$root/tests/emitted/columns.awk" "$2" "$1" >>log 2>&1
}

# driver FILE.c NAME PROGRAM [FLAGS [LIBRARIES]]: with MERGE=1 or LONG=1 in the compiler's own dialect, else only to run
driver() {
	if ! merging; then
		# shellcheck disable=SC2086
        $run_cc -I"$root/runtime" "-DMODEL=$2" "$root/runtime/host/plmain.c" "$1" "$archive" ${5-} -o "$3" >>log 2>&1
		return
	fi
	main_of "$2" "${4-}" >>log 2>&1
	# shellcheck disable=SC2086
	${CC:-cc} ${4-} -I"$root/runtime" $main "$1" "$archive" ${5-} -o "$3" >>log 2>&1
}

# ---- every model ----

for m in $models; do
	spec=$root/models/$m.spec
	mkdir "$m" "$m.rhs"
	: >log
	"$plgen" "$spec" >"$m/stdout.c" 2>log && "$plgen" --rhs "$spec" >"$m.rhs/stdout.c" 2>>log &&
        "$plgen" -o "$m/$m.c" "$spec" >log 2>&1 && "$plgen" --rhs -o "$m.rhs/$m.c" "$spec" >log 2>&1 && [ ! -s log ]
	result $? "$m: plgen writes it in four ways and says nothing"
	"$plgen" --header "$spec" >"$m/header.h" 2>log && cmp "$m/header.h" "$m/$m.h" >>log 2>&1
	result $? "$m: --header is FILE.h"
	for kind in "$m" "$m.rhs"; do
		by_each "$kind: standard output" -O1 -c -o "$kind/stdout.o" "$kind/stdout.c"
		all_compile "$kind/$m.c" "$kind: -o FILE.c with FILE.h"
		grep -q '^#include "'"$m"'.h"$' "$kind/$m.c" && [ -s "$kind/$m.h" ]
		result $? "$kind: FILE.c includes FILE.h"
		# the header by itself, twice, and together with the complete C
		printf '#include "%s.h"\n#include "%s.h"\n%s *unused;\n' "$m" "$m" "$m" >"$kind/twice.c"
		all_compile "$kind/twice.c" "$kind: the header stands alone, twice"
		printf '#include "%s.h"\n#include "stdout.c"\n' "$m" >"$kind/both.c"
		all_compile "$kind/both.c" "$kind: the C on standard output repeats the header under the same guard"
	done
	all_compile "$m/stdout.c" "$m: freestanding" -ffreestanding
done

# ---- the runtime ----

runtime=
for f in "$root"/runtime/*.c; do
	f=$(basename "$f" .c)
	runtime="$runtime $f"
	cp "$root/runtime/$f.c" "$f.c"
	all_compile "$f.c" "runtime: $f.c" -ffreestanding
done

mkdir runtime models
for m in $models; do cp "$m/$m.c" "$m/$m.h" models; done
for f in $runtime; do cp "$f.c" "runtime/$f.c"; done

# needs FOLDER TITLE NAME ...: do these files of the folder need the runtime, memcpy and memset at most?
needs() {
	folder=$1
	title=$2
	shift 2
	rm -f "$folder"/*.o
	# shellcheck disable=SC2046
	(cd "$folder" && "$compiler" -std=c99 "$level" -I"$root/runtime" -c $(printf '%s.c\n' "$@")) >said 2>&1
	status=$?
	"$nm" -u "$folder"/*.o >names && only_runtime names || status=1
	cat said >>log
	result $status "$title, $compiler $level"
}

if ! merging; then
	"$nm" -u "$archive" >names && only_runtime names
	result $? 'runtime: needs memcpy and memset at most, as it was built'
	compiler=${GCCS:-gcc} level=-O2
	compiler=${compiler% *}
	# shellcheck disable=SC2086
	needs models 'models without --rhs: need the runtime, memcpy and memset at most' $models
else
	for pair in "${GCCS:-gcc g++}" "${CLANGS:-clang clang++}"; do
		compiler=${pair% *}
		for level in -O0 -O2 -Os; do
			if ! installed "$compiler"; then
				skip "nm, $compiler $level" "$compiler is not installed"
				continue
			fi
			# shellcheck disable=SC2086
			needs runtime 'runtime: needs memcpy and memset at most' $runtime
			# shellcheck disable=SC2086
			needs models 'models without --rhs: need the runtime, memcpy and memset at most' $models
		done
	done
fi

# ---- force code only where there is a force ----

for m in $models; do
	# the banner may speak of phases
	sed '1,/^ \*\/$/d' "$m/stdout.c" | grep -E 'pl_cossin|phase|pl_phase|pl_rate|wave' >log
	found=$?
	sed 's/#.*//' "$root/models/$m.spec" | grep -q -E '(cos|sin)\('
	forced=$?
	[ "$found" -eq "$forced" ]
	result $? "$m: force code $([ $forced -eq 0 ] && echo is there || echo is not there)"
done

# ---- into a C++ program, all models at once ----

{
	for m in $models; do echo "#include \"$m.h\""; done
	cat <<'EOF'
#include <cstdio>

template<class S> static double last(void (*init)(S *), void (*step)(S *), const pl_model &model)
{
    S s;
    double out[16];
    init(&s);
    for (int k = 0; k < 100; k++)
        step(&s);
    S saved = s;
    model.out(&saved, out);
    return out[0];
}

int main()
{
EOF
    for m in $models; do printf '    std::printf("%%.17g\\n", last(%s_init, %s_step, %s_model));\n' "$m" "$m" "$m"; done
	printf '    return 0;\n}\n'
} >main.cpp
# step_of MODEL
step_of() {
	"$plgen" --explain=json "$root/models/$1.spec" | sed -n 's/^ *"step": \(.*\),$/\1/p'
}

for m in $models; do
	: >log
	driver "$m/stdout.c" "$m" "$m/one" "-std=c99 $warnings"
	cp log "$m/said"
	h=$(step_of "$m") && "$m/one" "$(awk "BEGIN { print 100 * $h }")" | tail -n 1 | cut -d, -f2
done | awk '{ printf "%.17g\n", $1 }' >expected
mkdir program_c
for pair in "${GCCS:-gcc g++}" "${CLANGS:-clang clang++}"; do
	merging || [ "$pair" = "${GCCS:-gcc g++}" ] || continue
	c=${pair% *}
	cpp=${pair#* }
	if ! installed "$c" || ! installed "$cpp"; then
		skip "C++ program, $cpp" "$cpp is not installed"
		continue
	fi
	includes=
	sources=
	for m in $models; do
		sources="$sources ../$m/$m.c"
		includes="$includes -I$m"
	done
	long && for f in $runtime; do sources="$sources ../$f.c"; done
	# shellcheck disable=SC2086
	if merging; then
		(cd program_c && "$c" -std=c99 -I"$root/runtime" -c $sources)
	else
		cp models/*.o program_c         # of these files, by that compiler
	fi >log 2>&1 &&
		"$cpp" -std=c++17 $warnings -I"$root/runtime" $includes main.cpp program_c/*.o "$archive" \
			-o program >>log 2>&1 &&
		./program >values 2>>log
	result $? "all models link into one C++ program, which runs, $cpp"
	diff values expected >log 2>&1
	result $? "its values are those of the models one by one, $cpp"
done

# ---- the driver ----

for m in $models; do
	cp "$m/said" log
	"$m/one" 30 >found.csv 2>>log &&
		same_columns found.csv "$solutions/${m}_solution.csv"
	result $? "$m: the driver's 30 s agree with --solution 30"
	rows=$(($(wc -l <found.csv) - 1))
	h=$(step_of "$m")
	expected=$(awk "BEGIN { printf \"%d\", 30 / $h + 1.5 }")
	echo "found $rows rows, expected $expected" >log
	[ "$rows" -eq "$expected" ]
	result $? "$m: $expected rows for h = $h"
done

# ---- same input, same bytes ----

cp -r "$root/models" elsewhere
for m in $models; do
	: >log
	"$plgen" --rhs "$root/models/$m.spec" | cmp - "$m.rhs/stdout.c" >>log 2>&1 &&
		(cd elsewhere && "$plgen" --rhs "$m.spec") | cmp - "$m.rhs/stdout.c" >>log 2>&1 &&
		(cd / && "$plgen" --rhs "$work/elsewhere/$m.spec") | cmp - "$m.rhs/stdout.c" >>log 2>&1 &&
        LC_ALL=C.UTF-8 TZ=Asia/Tokyo "$plgen" --rhs "$root/models/$m.spec" | cmp - "$m.rhs/stdout.c" >>log 2>&1
	result $? "$m: the same bytes twice, from other directories, in another locale"
	"$plgen" --rhs -o "elsewhere/$m.c" "elsewhere/$m.spec" && cmp "elsewhere/$m.c" "$m.rhs/$m.c" >log 2>&1 &&
		cmp "elsewhere/$m.h" "$m.rhs/$m.h" >>log 2>&1
	result $? "$m: -o writes the same bytes into another directory"
	! grep -n -F -e "$root" -e "$work" "$m.rhs/stdout.c" "$m.rhs/$m.h" "elsewhere/$m.c" >log 2>&1
	result $? "$m: no path in it"
done

# ---- names ----

# right FILE.spec NAME TITLE: it compiles, and what its driver says is what --solution says
right() {
	: >log
	"$plgen" --rhs "$1" >collide.c 2>log
	status=$?
	result $status "$3: plgen takes it"
	[ $status -eq 0 ] || return
	all_compile collide.c "$3: compiles"
	: >log
	"$plgen" --solution 1 "$1" >expected.csv 2>>log && driver collide.c "$2" m "$warnings" -lm &&
		./m 1 >found.csv 2>>log && same_columns found.csv expected.csv
	result $? "$3: runs right, in the compiler's own dialect"
}

# Words that the emitted C or its headers might use themselves.
locals='s y u n k i j x z w h tau out dydt t0 power work wave wave1 wave2 load residual series slope phase
    phase_start phase_step phase_rate start power_entry row column value state_names output_names any_init any_step
	any_out unused size states degree halvings A M C K x_dot y_dot s_dot v_dot double_ pl_cossin
	pl_phase pl_phase_add pl_series_advance pl_power_apply
	uint64_t size_t int64_t
	PROBE_STATES PROBE_H probe probe_time probe_get probe_out probe_slope probe_phase_step'
macros='NAN INFINITY HUGE_VAL M_PI M_E INT_MAX UINT64_MAX SIZE_MAX UINT64_C INT64_C FP_NAN MATH_ERRNO NULL EOF I
    unix linux i386 errno assert OVERFLOW DOMAIN SING PLRT_H PL_COSSIN_MUL DBL_MAX LONG_MAX CHAR_BIT SHRT_MIN isnan
	isinf signbit fpclassify isless signgam _x __x _Complex'
functions='j0 j1 jn y0 y1 yn gamma lgamma pow fabs fmin fmax floor ceil fmod hypot erf cbrt exp2 log2 round trunc
	div abort memcpy memset time main index read write std NAN_ double_t float_t complex'

# The specs below use every name beside functions of <math.h>, in outputs of both kinds.

as_coordinates() {      # NAME ...: a chain
	awk 'BEGIN {
		for (i = 1; i < ARGC; i++) list = list (i > 1 ? ", " : "") ARGV[i]
		print "model names\nparam stiff = 3, power2 = 2\ncoord " list
		print "init " ARGV[1] " = 1, " ARGV[ARGC - 1] "\047 = 0.5"
		for (i = 1; i < ARGC; i++) {
			c = ARGV[i]; next_one = ARGV[i % (ARGC - 1) + 1]
			load = i % 2 ? "cos(3*t)" : "power2^2*sin(2*t) + 1"
			print c "\047\047 + " i " * stiff*" c " + 0.1*" c "\047 - 0.5*(" next_one " - " c ") = " load
			print "output acceleration" i " = " c "\047\047"
			print "output bent" i " = max(abs(" c "), abs(" c ")^2.5, min(" c "\047, " next_one "))"
			print "output cut" i " = clip(" c ", -1, 1) + t + " c "\047"
		}
		print "step 0.01" }' "$@"
}

as_params() {
	awk 'BEGIN {
		for (i = 1; i < ARGC; i++) { print "param " ARGV[i] " = " i "/7"; sum = sum " + " ARGV[i] }
		print "coord first_mass, second_mass\ninit first_mass = 1"
		print "first_mass\047\047 + first_mass*(1 " sum ")/50 = (1" sum ")*cos(3*t)"
		print "second_mass\047\047 + 4*second_mass - first_mass = sin(" ARGV[1] "*t)"
		for (i = 1; i < ARGC; i++)
			print "output a" i " = abs(" ARGV[i] "*first_mass)\noutput b" i " = " ARGV[i] \
				"*max(first_mass\047, second_mass, " ARGV[i] "^0.5*first_mass) + t"
		print "step 0.01" }' "$@" | sed '1i\
model names'
}

as_lets() {
	awk 'BEGIN {
		print "model names\ncoord first_mass, second_mass\ninit first_mass = 1"
		for (i = 1; i < ARGC; i++) { print "let " ARGV[i] " = " i "*second_mass - first_mass\047/10";
			sum = sum " + " ARGV[i] }
		print "first_mass\047\047 + 20*first_mass + (" ARGV[1] sum ")/10000 = cos(3*t)"
		print "second_mass\047\047 + 4*second_mass - first_mass = 0"
		for (i = 1; i < ARGC; i++)
			print "output a" i " = " ARGV[i] ", b" i " = abs(" ARGV[i] ")^1.5 + max(t, " ARGV[i] ")"
		print "step 0.01" }' "$@"
}

# The same without any such name.
neutral() {
	i=0
	while [ $i -lt $# ]; do
		i=$((i + 1))
		printf ' neutral%d' $i
	done
}

# Prints outputs and NAME_rhs over 100 steps.
cat >probe.c <<'EOF'
#include "plrt.h"
#include <stdio.h>
#define JOIN(a, b) a##b
#define OF(name, what) JOIN(name, what)
extern const pl_model OF(PROBE, _model);
void OF(PROBE, _rhs)(double t, const double *y, double *dydt);
int main(void)
{
    const pl_model *m = &OF(PROBE, _model);
    static double state[200], y[100], out[1000], dydt[100];
    int i, k;
    if (m->size > sizeof state || m->states > 100 || m->outputs > 1000)
        return 1;
    m->init(state);
    for (k = 0; k <= 200; k++) {
        m->get(state, y);
        m->out(state, out);
        OF(PROBE, _rhs)(m->time(state), y, dydt);
        printf("%.17g", m->time(state));
        for (i = 0; i < m->outputs; i++)
            printf(",%.17g", out[i]);
        for (i = 0; i < m->states; i++)
            printf(",%.17g", dydt[i]);
        if (m->at)
            m->at(state, NULL, m->h / 3, y);
        for (i = 0; i < m->states; i++)
            printf(",%.17g", y[i]);
        printf("\n");
        if (k < 100)
            m->step(state, NULL);
        else
            m->jump(state, 3);
    }
    return 0;
}
EOF

# one object for all: the linker gives it the names of the model
${CC:-cc} -I"$root/runtime" -DPROBE=PROBED -c probe.c 2>log || exit 99

# probe FILE.c NAME OUT.csv: in the compiler's own dialect, as a user would; or only to be run
probe() {
	if ! merging && [ -z "${always-}" ]; then
        $run_cc -I"$root/runtime" "-DPROBE=$2" probe.c "$1" "$archive" -lm -o probed >>log 2>&1 && ./probed >"$3"
		return
	fi
	# shellcheck disable=SC2086
	${CC:-cc} $warnings -I"$root/runtime" probe.o "$1" "$archive" -lm \
		"-Wl,--defsym=PROBED_model=$2_model,--defsym=PROBED_rhs=$2_rhs" -o probed >>log 2>&1 && ./probed >"$3"
}

# alike NAME NEUTRAL.spec TITLE: names.spec compiles and does what NEUTRAL.spec does
alike() {
	"$plgen" --rhs --prefix "$1" names.spec >collide.c 2>log
	status=$?
	result $status "$3: plgen takes it"
	[ $status -eq 0 ] || return
	all_compile collide.c "$3: compiles"
	: >log
	# the same neutral model often
	cmp -s "$2" probed.spec || { "$plgen" --rhs --prefix probe "$2" >probed.c 2>>log &&
		probe probed.c probe probed.csv && cp "$2" probed.spec; }
	probe collide.c "$1" found.csv && cmp -s "$2" probed.spec && same_columns found.csv probed.csv
	result $? "$3: runs right, in the compiler's own dialect"
}

# shellcheck disable=SC2046,SC2086
{
	as_params $locals $macros $functions >names.spec
	always=yes
	as_params $(neutral $locals $macros $functions) >neutral.spec
	alike probe neutral.spec 'params with names of every kind'
	as_lets $locals $macros $functions >names.spec
	as_lets $(neutral $locals $macros $functions) >neutral.spec
	alike probe neutral.spec 'lets with names of every kind'
	always=
	set -- $locals $macros $functions
	while [ $# -ge 6 ]; do
		one_of 2 || { shift 6; continue; }
		as_coordinates "$1" "$2" "$3" "$4" "$5" "$6" >names.spec
		as_coordinates n1 n2 n3 n4 n5 n6 >neutral.spec
		alike probe neutral.spec "coordinates $1, $2, $3, $4, $5, $6"
		shift 6
	done
	[ $# -eq 0 ] || as_coordinates "$@" >names.spec
	[ $# -eq 0 ] || as_coordinates $(neutral "$@") >neutral.spec
	[ $# -eq 0 ] || alike probe neutral.spec "coordinates $*"
}

# All of them at once claim names from each other.
cat >crowd.spec <<'EOF'
model crowd
param x_dot = 2, x_dot_ = 3, INT = 4, vINT = 5, k_ = 6, k = 7, y_ = 8
coord x, y, x_, s, s_, x__dot
init x = 1, y = 2, s' = 1
x'' + x_dot*x + x' = cos(k*t)
y'' + x_dot_*y = INT
x_'' + vINT*x_ - x = 0
s'' + k_*s - x_' = sin(k_*t)
s_'' + y_*s_ - s - y' = 0
x__dot'' + x__dot - x = 1
output a = x + y + x_ + s + s_ + x__dot, b = 2*(x' - y') + x_' + s' - s_' + x__dot'
step 0.01
EOF
right crowd.spec crowd 'coordinates and params that shadow each other'

# As models: compiled and right, or refused with a way out.
as_model() {
	cat <<EOF
model $1
coord x, y
init x = 1
x'' + 4*x - y = cos(3*t)
y'' + 9*y - x = 0
output x, y, e = abs(x') + t
step 0.01
EOF
}

as_model neutral >neutral.spec
# Some; with MERGE=1 every third of them, with LONG=1 all.
names='k y M states unix M_PI scs x_'
! merging || names=$(third 0 a b c i h k m n r s u w x y z A H I K M N S T X Y a1 pl1 Pl PL plrt PLRT \
	STATES INPUTS OUTPUTS states tau out any phase slope series power \
    power_entry state state_names output_names phase_step phase_start phase_rate work start wave wave1 residual dydt \
	model_ scs Scs \
    NAN INFINITY INT_MAX NULL EOF UINT64_C M_PI unix linux i386 errno bool_ uint64_t size_t double_t pl_model sem re \
	hash list queue thread x_ x1 names_test)
for name in $names; do
	as_model "$name" >model.spec
	: >log
	if "$plgen" --rhs model.spec >/dev/null 2>log; then
		cp model.spec names.spec
		alike "$name" neutral.spec "model $name"
	else
		grep -q -e '--prefix' log
		result $? "model $name: refused, and --prefix is named"
		"$plgen" --rhs --prefix other_name model.spec >collide.c 2>log &&
			all_compile collide.c "model $name: with --prefix it compiles"
	fi
done

# In C++ members have a scope of their own; around a model with delays stands another.
always=yes
as_model y >model.spec
"$plgen" --batch model.spec >collide.c 2>log && all_compile collide.c 'model y, in batches'
printf "model s\ninput u\ncoord x\nx'' + 4*x = u(t - 0.05)\nstep 0.01\n" >model.spec
"$plgen" model.spec >collide.c 2>log && all_compile collide.c 'model s, of an input as it was'
always=

# The same name for everything, and functions of the model as names inside it.
for name in x same; do
    printf "model %s\nparam %s_time = 2, %s_get = 3\ncoord %s, %s_out, %s_step\ninit %s = 1\n" $name $name $name $name \
		$name $name $name >same.spec
    printf "%s'' + %s_time*%s = cos(t)\n%s_out'' + %s_get*%s_out - %s = 0\n%s_step'' + %s_step = 0\n" $name $name \
		$name $name $name $name $name $name $name >>same.spec
	printf "output a = %s + t, b = 2*%s_out + %s_get\nstep 0.01\n" $name $name $name >>same.spec
	right same.spec $name "model $name, coordinates and params called after it and its functions"
done

# The spec's text in the banner: nothing in it may end or open a comment.
printf "model banner\nparam k = 4\ncoord x\ninit x = 1\n" >banner.spec
printf "x'' + (k # a comment */ broken( /* in a comment\n + 0)*x = 0\nstep 0.01\n" >>banner.spec
right banner.spec banner 'an equation with the signs of C comments in its own comment'
cp banner.spec 'odd*.spec'
sed -i '/# a comment/s/#.*//' 'odd*.spec'
right './odd*.spec' banner 'a star in the name of the file'
if "$plgen" -D 'k=4#*/ broken( /*' --rhs 'odd*.spec' >option.c 2>log; then
	all_compile option.c 'the signs of C comments in an option'
else
	result 0 'the signs of C comments in an option: refused'
fi

# Very small and very large constants, a load in phase with nothing else, one mass, many masses.
cat >wide.spec <<'EOF'
model wide
coord q, r
init q = 1e-300, r = 1e200
1e-20*q'' + 1e-18*q = 1e-320*cos(t)
1e30*r'' + 3e30*r + 1e29*r' = 0
step 1/3
EOF
right wide.spec wide 'very small and very large constants'

{
	echo 'model chain'
	printf 'coord '
	i=1
	while [ $i -le 12 ]; do
		printf '%sa_rather_long_name_for_mass_%d' "$([ $i -gt 1 ] && echo ', ')" $i
		i=$((i + 1))
	done
	printf '\ninit a_rather_long_name_for_mass_1 = 1\n'
	i=1
	while [ $i -le 12 ]; do
		next=$((i % 12 + 1))
		long=a_rather_long_name_for_mass
		printf "${long}_%d'' + 20*${long}_%d - 5*${long}_%d = 0\n" $i $i $next
		i=$((i + 1))
	done
	echo 'step 0.05'
} >chain.spec
right chain.spec chain 'twelve masses with long names'

tap_end
