#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# fmu.sh PLGEN SOURCE_ROOT: FMUs against the standard's schemas and headers, and driven by an importer.
#
# Headers and schemas of FMI stand in FMI_DIR, by default ../shared/fmi beside the checkout, as 2.0/headers, 2.0/schema,
# 3.0/headers and 3.0/schema; without them what needs them is skipped.
# LONG=1 in the environment: FMUs are compiled as an importer would, and looked at by both compilers; without it those
# of `plant` and of floats not optimised, and by gcc and clang by turns, the others only to be run.
root=$2
standard=$(cd "${FMI_DIR:-$root/../shared/fmi}" 2>/dev/null && pwd)
. "${0%/*}/../plgen.sh"
own=$root/tests/fmu
models=$root/models
warnings='-Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wcast-qual -Werror'
level=-O0
[ -z "${LONG:-}" ] || level=-O1

# unpack FMU FOLDER: by a program that knows zip, which checks sums and lengths
unpack() {
	rm -rf "$2"
	python - "$1" "$2" >>log 2>&1 <<'END'
import sys, zipfile
z = zipfile.ZipFile(sys.argv[1])
bad = z.testzip()
assert bad is None, bad
assert all(i.compress_type == 0 and i.date_time == (1980, 1, 1, 0, 0, 0) for i in z.infolist())
assert len(set(z.namelist())) == len(z.namelist())
z.extractall(sys.argv[2])
END
}

# sources FOLDER: the files that the description lists
sources() {
	if [ -f "$1/sources/buildDescription.xml" ]; then
		sed -n 's/.*<SourceFile name="\([^"]*\)".*/\1/p' "$1/sources/buildDescription.xml"
	else
		sed -n 's/.*<File name="\([^"]*\)".*/\1/p' "$1/modelDescription.xml"
	fi
}

token() {
	sed -n 's/.* \(instantiationToken\|guid\)="\([^"]*\)".*/\2/p' "$1/modelDescription.xml"
}

# ---- without the standard's files ----

"$plgen" --fmu a.fmu "$models/scs.spec" >log 2>&1 && "$plgen" --fmu b.fmu "$models/scs.spec" >>log 2>&1 &&
	cmp a.fmu b.fmu >>log 2>&1
result $? 'the same bytes twice'
: >log
unpack a.fmu a
result $? 'a zip file of stored members, all of the first day'
find a -type f | LC_ALL=C sort | sed 's,^a/,,' >names
cat >expected <<'END'
documentation/licenses/license.txt
modelDescription.xml
sources/buildDescription.xml
sources/fmi.h
sources/fmi3.c
sources/fmi3.h
sources/fmu_model.h
sources/plfmu.h
sources/scs_pl.c
sources/scs_pl.h
END
diff expected names >log
result $? 'the runtime is inside: two files to compile, their headers, and no more'
"$plgen" --fmu c.fmu -D k1=101 "$models/scs.spec" >log 2>&1 && unpack c.fmu c && [ "$(token a)" != "$(token c)" ] &&
	[ -n "$(token a)" ]
result $? 'another model has another token'

cat >taken.spec <<'END'
model taken
coord x
input u
x'' + x = u
output u2 = 2*x
output time = x
step 0.1
END
"$plgen" --fmu t.fmu taken.spec >log 2>&1 && unpack t.fmu t &&
	grep -o ' name="[^"]*"' t/modelDescription.xml >names
printf ' name="%s"\n' logStatusWarning logStatusError time u u2 output.time state.x 'state.x&apos;' >expected
diff expected names >>log
result $? 'every variable has a name of its own'

cat >variables.sed <<'END'
/<ModelVariables>/,/<.ModelVariables>/{
s/^ *//
s/ causality="\([a-z]*\)" variability="\([a-z]*\)"/ \1 \2/p
/<Real/p
}
END
"$plgen" --fmu v.fmu --fmu-version 2 "$own/plant.spec" >log 2>&1 && unpack v.fmu v &&
	sed -n -f variables.sed v/modelDescription.xml >names
cat >expected <<'END'
<ScalarVariable name="time" valueReference="0" independent continuous>
<Real/>
<ScalarVariable name="pull" valueReference="1" input continuous>
<Real start="0.0"/>
<ScalarVariable name="base" valueReference="2" input continuous>
<Real start="0.0"/>
<ScalarVariable name="x" valueReference="3" output continuous>
<Real/>
<ScalarVariable name="spring_force" valueReference="4" output continuous>
<Real/>
<ScalarVariable name="m" valueReference="5" parameter tunable initial="exact">
<Real start="2.0"/>
<ScalarVariable name="k" valueReference="6" parameter tunable initial="exact">
<Real min="10.0" max="1000.0" start="40.0"/>
<ScalarVariable name="state.x" valueReference="7" local continuous initial="exact">
<Real start="0.1"/>
<ScalarVariable name="state.x&apos;" valueReference="8" local continuous initial="exact">
<Real start="-0.2"/>
<ScalarVariable name="c" valueReference="9" local constant initial="exact" description="&lt;damper&apos;s&gt; [Ns/m]">
<Real start="0.3"/>
END
diff expected names >>log
result $? 'names, causalities and start values'

cat >ahead.spec <<'END'
model ahead
coord x
input u hold third
x'' + x = u
step 0.1
END
"$plgen" --fmu ahead.fmu ahead.spec >log 2>&1
[ $? -eq 1 ] && [ ! -e ahead.fmu ] && grep -q "ahead.spec:3:7: error: an FMU cannot have input 'u'" log
result $? 'samples further ahead are refused, with their place'

"$plgen" --fmu away/a.fmu "$models/scs.spec" >log 2>&1
[ $? -eq 1 ] && grep -q 'away/a.fmu: error: cannot write' log && [ ! -e away ]
result $? 'a folder that is not there is told'

# refused NAME WORDS OPTION ...: the command line is wrong, and nothing is written
refused() {
	said=$1
	shift
	"$plgen" "$@" "$models/scs.spec" >out 2>log
	[ $? -eq 2 ] && [ ! -s out ] && [ ! -e no.fmu ] && grep -q -e "$said" log
	result $? "refused: $*"
}
refused 'FILE.fmu, found' --fmu no.zip
refused 'FILE.fmu, found' --fmu .fmu
refused '-o does not go with --fmu' --fmu no.fmu -o no.c
for option in --header --explain --rhs --selftest --batch --bundle --report '--solution 1' '--plot poles' \
	'--response 1:2'; do
	# shellcheck disable=SC2086
	refused "${option% *} does not go with --fmu" --fmu no.fmu $option
done
refused '--fmu-version goes with --fmu' --fmu-version 2
refused '--fmu-binary goes with --fmu' --fmu-binary
refused '--fmu-version takes 2 or 3' --fmu no.fmu --fmu-version 1

CC=not-there "$plgen" --fmu no.fmu --fmu-binary "$models/scs.spec" >out 2>log
[ $? -eq 1 ] && [ ! -e no.fmu ] && grep -q "error: .*'not-there'" log
result $? 'a compiler that is not there is told, and nothing is written'
mkdir empty
TMPDIR=$work/empty CC=false "$plgen" --fmu no.fmu --fmu-binary "$models/scs.spec" >out 2>log
[ $? -eq 1 ] && [ ! -e no.fmu ] && grep -q "'false' could not make" log && [ -z "$(ls -A empty)" ]
result $? 'a compiler that fails is told, and leaves nothing'
"$plgen" --fmu d.fmu --depfile d.d "$models/scs.spec" >log 2>&1 && grep -q '^d\.fmu: .*scs\.spec' d.d
result $? 'a dependency file names the FMU'

# ---- with them ----

if [ -z "$standard" ] || [ ! -f "$standard/3.0/headers/fmi3Functions.h" ]; then
	skip 'schemas, headers, importer' 'headers and schemas of FMI are not there: FMI_DIR names their folder'
	tap_end
fi

validate() {
	command -v xmllint >/dev/null 2>&1 || return 77
	xmllint --noout --schema "$standard/$1.0/schema/fmi$1$2.xsd" "$3" >>log 2>&1
}

# described VERSION FOLDER NAME
described() {
	: >log
	validate "$1" ModelDescription "$2/modelDescription.xml"
	status=$?
	if [ $status -eq 0 ] && [ "$1" -eq 3 ]; then
		validate 3 BuildDescription "$2/sources/buildDescription.xml"
		status=$?
	fi
	if [ $status -eq 77 ]; then
		skip "$3: valid against the schema" 'xmllint is not installed'
	else
		result $status "$3: valid against the schema"
	fi
}

# warned VERSION FOLDER NAME: each source alone, as C99, with nothing but its own headers
next=gcc
warned() {
	case $next in gcc) now=gcc next=clang ;; *) now=clang next=gcc ;; esac
	[ -z "${LONG:-}" ] || now='gcc clang'
	for compiler in $now; do
		if ! command -v $compiler >/dev/null 2>&1; then
			skip "$3: no warning of $compiler" "$compiler is not installed"
			continue
		fi
		: >log
		for file in $(sources "$2"); do
			# shellcheck disable=SC2086
			$compiler -std=c99 $warnings -fsyntax-only "$2/sources/$file" >>log 2>&1 ||
				echo "$file does not compile" >>log
		done
		[ ! -s log ]
		result $? "$3: no warning of $compiler"
	done
}

# build VERSION FOLDER OBJECT: as an importer would, or only to be run
build() {
	files=$(sources "$2" | sed "s,^,$2/sources/,")
	compiler=$run_cc
	[ "$looked_at" = no ] ||
		compiler="${CC:-cc} -std=c99 $level -w -Wl,--no-undefined -fvisibility=hidden"
	# shellcheck disable=SC2086
	$compiler -fPIC -shared -DFMI$1_OVERRIDE_FUNCTION_PREFIX $files -o "$3" -lm >>log 2>&1
}

# The standard's functions are all there, and nothing else can be seen.
exported() {
	sed -n "s/.*FMI$1_Export *fmi$1[A-Za-z0-9]*TYPE *\(fmi$1[A-Za-z0-9]*\);.*/\1/p" \
		"$standard/$1.0/headers/fmi$1Functions.h" | LC_ALL=C sort >expected
	nm -D --defined-only "$2" | awk '$2 ~ /[A-Z]/ && $3 !~ /^_/ { print $3 }' | LC_ALL=C sort >names
	[ -s expected ] && diff expected names >>log
}

# The types and values of runtime/fmi/fmi2.h and fmi3.h, against the standard's own: types with another name each, after
# the standard's enumerations, whose enumerators are compared as numbers.
types_agree() {
	header=$root/runtime/fmi/fmi$1.h
	sed -n -e '/^typedef enum/d' -e "s/^typedef [a-z][^(]*[ *]\(fmi$1[A-Za-z0-9]*\);\$/\1/p" \
		-e "s/^typedef.*(\*\(fmi$1[A-Za-z0-9]*\))(.*/\1/p" "$header" >names
	awk '/^typedef enum/ { inside = 1 } !inside { print } /;$/ { inside = 0 }' "$header" |
		sed -e "$(sed 's/.*/s,\\<&\\>,own_&,g/' names)" -e 's/^} fmi/} own_fmi/' >own_types.h
	{
        printf '#include "fmi%sFunctionTypes.h"\n#include "own_types.h"\n#include "fmi%sFunctions.h"\n' "$1" "$1"
        awk '{ printf "_Static_assert(_Generic((%s *)0, own_%s *: 1, default: 0), \"%s\");\n", $1, $1, $1 }' names
		sed -n '/^typedef struct/,/^}/p' "$header" | tr -d ';' | awk '/^    / { member[++n] = $2 } /^}/ {
			for (k = 1; k <= n; k++)
                printf "_Static_assert(offsetof(%s, %s) == offsetof(own_%s, %s), \"%s\");\n", $2, member[k], $2,
					member[k], member[k]
			n = 0 }'
		echo 'int main(void) { return 0; }'
	} >types.c
	awk '/^typedef enum/ { inside = 1 } inside { print } /;$/ { inside = 0 }' "$header" |
		grep -o "[ {]fmi$1[A-Za-z]*[ ,]" | tr -d '{ ,' >enumerators
	{
		echo '#include <stdio.h>'
		echo 'int main(void) {'
		sed 's/.*/printf("& %d\\n", &);/' enumerators
		echo 'return 0; }'
	} >values.c
	[ "$(wc -l <names)" -gt 8 ] && [ "$(wc -l <enumerators)" -gt 11 ] &&
		gcc -std=c11 -Wall -Werror -I"$standard/$1.0/headers" -I. types.c -o types >>log 2>&1 &&
		gcc -I"$standard/$1.0/headers" -include "fmi$1Functions.h" values.c -o values >>log 2>&1 &&
        ./values >expected && gcc -include "$header" values.c -o values >>log 2>&1 && ./values | diff expected - >>log
}
for version in 2 3; do
	: >log
	types_agree $version
	result $? "FMI $version: the runtime's types and values are the standard's"
done

own_cc=$run_cc driver_cc=$run_cc
! long || own_cc="${CC:-cc} -std=c99 $level -w" driver_cc="${CC:-cc} -std=gnu11 -Wall -Wextra -Werror"
for version in 2 3; do
	for single in '' -DSINGLE; do
		$driver_cc $single -DFMI=$version -I"$standard/$version.0/headers" -I"$root/runtime" "$own/drive.c" \
			-o "drive$version$single" -ldl || exit 99
	done
done

# make NAME SPEC VERSION OPTIONS: the FMU NAME.fmu, its object, and the model's own functions as another
make_both() {
	: >log
	"$plgen" --fmu "$1.fmu" --fmu-version "$3" $4 "$2" >>log 2>&1 && unpack "$1.fmu" "$1" &&
		build "$3" "$1" "./$1.so" && "$plgen" --fast $4 "$2" >"$1.c" 2>>log &&
		$own_cc -fPIC -shared -I"$root/runtime" "$1.c" "$archive" -o "$1_own.so" -lm >>log 2>&1
}

# drive LABEL PROGRAM ARGUMENT ...: its results become ours
drive() {
	label=$1
	shift
	"$@" >said 2>&1
	status=$?
	grep -q '^ok' said || echo "not ok - it ended with status $status" >>said
	[ $status -le 1 ] || echo "not ok - it ended with status $status" >>said
	grep '^#' said >log
	grep -E '^(not )?ok - ' said >judged
	while IFS= read -r line; do
		case $line in
			ok*) result 0 "$label: ${line#ok - }" ;;
			*) result 1 "$label: ${line#not ok - }" ;;
		esac
	done <judged
}

# one NAME SPEC VERSION OPTIONS; not where CASE asks for others
one() {
	label="$1, FMI $3${4:+, $4}"
	wanted=${CASE:-}
	case $label in *"${wanted%%: *}"*) ;; *) return ;; esac
	looked_at=no
	case $1,$4 in plant,* | *float*) looked_at=yes ;; esac
	[ -z "${LONG:-}" ] || looked_at=yes
	make_both m "$2" "$3" "$4"
	status=$?
	result $status "$label: made and compiled"
	[ $status -eq 0 ] || return
	described "$3" m "$label"
	if [ $looked_at = yes ]; then
		warned "$3" m "$label"
		: >log
		exported "$3" ./m.so
		result $? "$label: the standard's functions, and no others"
	fi
	: >log
	early=no
	grep '^uint64_t [a-z0-9_]*_crossed(' m.c | grep -q -v _core_ && [ "$3" -eq 3 ] && early=yes
	grep -o 'mightReturnEarlyFromDoStep="[a-z]*"' m/modelDescription.xml >names
	[ "$early$(cat names)" = no ] || [ "$early$(cat names)" = 'yesmightReturnEarlyFromDoStep="true"' ]
	result $? "$label: early returns are announced where there are any"
	single=
	case $4 in *float*) single=-DSINGLE ;; esac
	drive "$label" "./drive$3$single" ./m.so "$(token m)" ./m_own.so "$1"
}

for version in 2 3; do
	one plant "$own/plant.spec" $version ''
	one absorber "$own/absorber.spec" $version ''
	one gear1 "$models/gear1.spec" $version ''
done
one oscillator "$models/oscillator.spec" 3 ''
one pendulum "$models/pendulum.spec" 3 ''
one drivetrain "$models/drivetrain.spec" 3 ''
one vanderpol_stiff "$models/vanderpol_stiff.spec" 3 ''
one beam4 "$models/beam4.spec" 3 ''
one brake "$models/brake.spec" 2 ''
one brake "$models/brake.spec" 3 ''
one gap_cubic "$(path_of tests/series_switching/gap_cubic.spec)" 3 ''
one ramped "$own/ramped.spec" 3 ''
one bouncing_ball "$models/bouncing_ball.spec" 3 ''
one slider_crank "$models/slider_crank.spec" 2 ''
sed -n '/^=== cart_stops$/,/^---$/{/^[=-]/!p;}' "$root/tests/mechanisms/mechanisms.cases" >cart_stops.spec
one cart_stops cart_stops.spec 3 ''
one tuned "$root/tests/remainder/tuned.spec" 3 ''
one gaps "$root/tests/remainder/tuned_gaps.spec" 3 ''
one plant "$own/plant.spec" 3 '--real float'
one echo "$(path_of tests/delays/echo.spec)" 2 ''
one stopped "$(path_of tests/delays/stopped.spec)" 3 ''
one bouncing_ball "$models/bouncing_ball.spec" 2 '--real float'
one gear1 "$models/gear1.spec" 2 '--real float'
one absorber "$own/absorber.spec" 3 '--real float --prefix absorber'

looked_at=no
! long || looked_at=yes
for version in 2 3; do
	make_both plant "$own/plant.spec" $version '' && make_both absorber "$own/absorber.spec" $version '' &&
		drive "a pair, FMI $version" "./drive$version" ./plant.so "$(token plant)" ./plant_own.so plant \
			./absorber.so "$(token absorber)" ./absorber_own.so absorber
	# the compiled one; with LONG=1 optimised
	: >log
	printf '#!/bin/sh\nexec %s "$@" %s\n' "${CC:-cc}" "$(long || echo -O0)" >own_cc && chmod +x own_cc
	case $version in 2) place=linux64 ;; *) place=$(uname -m)-linux ;; esac
	CC=$PWD/own_cc "$plgen" --fmu p.fmu --fmu-version $version --fmu-binary "$own/plant.spec" \
		>>log 2>&1 && CC=$PWD/own_cc "$plgen" --fmu q.fmu --fmu-version $version \
		"--fmu-binary=$standard/$version.0/headers" "$own/plant.spec" >>log 2>&1 && cmp p.fmu q.fmu >>log &&
		unpack p.fmu p && exported $version "p/binaries/$place/plant.so"
	result $? "FMI $version: the compiled one, the same bytes by the standard's headers and by the runtime's"
	CONSTANT=0.3 drive "compiled, FMI $version" "./drive$version" "p/binaries/$place/plant.so" "$(token p)" \
		./plant_own.so plant
done

# ---- names for calibration tools ----

# ASAP2: /begin and /end in pairs, identifiers that are some and no two alike, each element of each array once
cat >names.py <<'END'
import re, sys
text = re.sub(r'/\*.*?\*/', ' ', open(sys.argv[1]).read(), flags=re.S)
tokens = re.findall(r'"(?:[^"\\]|\\.)*"|[^\s"]+', text)
assert tokens[:3] == ['ASAP2_VERSION', '1', '61'], tokens[:3]
open_now, blocks = [], []
for place, token in enumerate(tokens):
    if token == '/begin':
        open_now.append((tokens[place + 1], place + 2))
    elif token == '/end':
        kind, first = open_now.pop()
        assert tokens[place + 1] == kind, (kind, tokens[place + 1])
        blocks.append((kind, tokens[first:place]))
assert not open_now and [k for k, b in blocks][-2:] == ['MODULE', 'PROJECT']
things = [b for k, b in blocks if k in ('MEASUREMENT', 'CHARACTERISTIC')]
names = [b[0] for b in things]
assert len(set(names)) == len(names), names
for name in names:
    assert all(re.fullmatch(r'[A-Za-z_][A-Za-z0-9_]*(\[[0-9]+\])?', part) for part in name.split('.')), name
places = sorted((b[b.index('SYMBOL_LINK') + 1].strip('"'), int(b[b.index('SYMBOL_LINK') + 2])) for b in things)
count = {w.split('=')[0]: int(w.split('=')[1]) for w in sys.argv[3:]}
size = int(sys.argv[2])
assert places == sorted((a, size * i) for a, n in count.items() for i in range(n)), places
listed = sorted(n for k, b in blocks if k.startswith('REF_') for n in b)
assert listed == sorted(names), listed
limits = {b[0].split('.')[-1]: (b[7], b[8]) for k, b in blocks if k == 'CHARACTERISTIC'}
print(len(names), 'names;', limits)
END
printf '%s\n' 'model cal' 'param k = 18 "kN/m", c = 3, m = 1 "kg" # stiff "as built" \ kN/m' 'coord x, x_dot' \
	'coord q[2]' 'input u' "m*x'' + c*x' + k*x = u" "x_dot' = x'" "q'' = [u; 0]" "output a = x'', x, x'" \
	'tunable k in [10 "kN/m", 20 "kN/m"], c' 'step 0.01' >cal.spec
"$plgen" --a2l cal.a2l -o cal.c cal.spec >log 2>&1 &&
	python names.py cal.a2l 8 cal_states=7 cal_outputs=3 cal_params=2 >>log 2>&1 &&
	grep -q "'k': ('10000.0', '20000.0')" log && grep -q 'PHYS_UNIT "N/m"' cal.a2l && grep -q 'x_dot_ ' cal.a2l
result $? 'names for calibration: blocks, identifiers, places, ranges and units'
"$plgen" --real float --a2l plain.a2l "$models/stop.spec" >plain.c 2>log &&
    python names.py plain.a2l 4 "stop_states=$(sed -n 's/.*STOP_STATES = \([0-9]*\).*/\1/p' plain.c | head -n 1)" \
		"stop_outputs=$(sed -n 's/.*STOP_OUTPUTS = \([0-9]*\).*/\1/p' plain.c | head -n 1)" >>log 2>&1
result $? 'names for calibration in float, of a model with regions'
"$plgen" --a2l cal.a2l --explain cal.spec >log 2>&1
[ $? -eq 2 ] && grep -q 'error: --a2l goes with C: it does not go with --explain' log
result $? 'names for calibration without C'

# ---- derivatives at a communication point, against those of the equations by hand ----

cat >derived.spec <<'END'
model derived
param m = 2, k = 50
tunable k
coord x
input u, v
sensitivity v, k, u
m*x'' + 0.5*x' + k*x = 3*cos(4*t) + u
output x, acc = x'', q = k*x + 2*u - v
step 0.01
END
cat >derive.c <<'END'
#include FACE
#include <math.h>
enum { U = 1, V, X, ACC, Q, K, STATE };
int main(void)
{
    const uint32_t known[] = {U, V, K}, out[] = {X, ACC, Q}, set[] = {U, V, K}, state[] = {STATE, STATE + 1};
    const double value[] = {0.7, -0.2, 60};
    fmu_instance *i = fmu_new("derive", FMU_TOKEN);
    bool early;
    double y[2], found, worst = 0;
    fmu_enter(i, "");
    fmu_initialize(i, 0.0);
    fmu_leave(i, "");
    fmu_set(i, set, 3, value);
    fmu_step(i, 0.0, 0.05, "", &early);
    fmu_get(i, state, 2, y);
    const double own[3][3] = {{0, 0, 0}, {0.5, 0, -y[0] / 2}, {2, -1, y[0]}};
    for (int k = 0; k < 3; k++)
        for (int o = 0; o < 3; o++) {
            const double seed = 3;
            if (!DIRECTIONAL(i, &out[o], 1, &known[k], 1, &seed, &found)) return 1;
            worst = fmax(worst, fabs(found - 3 * own[o][k]));
            printf("output %d by %d: %.17g, %.17g\n", o, k, found / 3, own[o][k]);
        }
    double all[3];
    if (!DIRECTIONAL(i, out, 3, known, 3, value, all)) return 1;
    for (int o = 0; o < 3; o++)
        worst = fmax(worst, fabs(all[o] - (0.7 * own[o][0] - 0.2 * own[o][1] + 60 * own[o][2])));
#ifdef ADJOINT
    const double weight[3] = {1, -2, 0.5};
    double back[3];
    if (!ADJOINT(i, out, known, weight, back)) return 1;
    for (int k = 0; k < 3; k++)
        worst = fmax(worst, fabs(back[k] - (own[0][k] - 2 * own[1][k] + 0.5 * own[2][k])));
#endif
    return !(y[0] != 0 && worst < 1e-14) || DIRECTIONAL(i, &state[0], 1, &known[0], 1, value, &found) ||
           DIRECTIONAL(i, &out[0], 1, &state[0], 1, value, &found);
}
END
for version in 3 2; do
	: >log
	"$plgen" --fmu-version $version --fmu derived.fmu derived.spec >log 2>&1 && unpack derived.fmu derived
	face=fmi$version.c
	if [ $version = 3 ]; then
		ways="-DDIRECTIONAL(i,o,m,k,n,s,f)=(FMI3(GetDirectionalDerivative)(i,o,m,k,n,s,n,f,m)==fmi3OK)"
		back="-DADJOINT(i,o,k,s,f)=(FMI3(GetAdjointDerivative)(i,o,3,k,3,s,3,f,3)==fmi3OK)"
		provided='providesDirectionalDerivatives="true" providesAdjointDerivatives="true"'
		depends='<Output dependencies="1 2" valueReference="3"/>'
	else
		ways="-DDIRECTIONAL(i,o,m,k,n,s,f)=(FMI2(GetDirectionalDerivative)(i,o,m,k,n,s,f)==fmi2OK)"
		back=-DBACK
		provided='providesDirectionalDerivative="true"'
		depends='<Unknown dependencies="2 3" index="4"/>'
	fi
	for declared in "$provided" "$depends"; do
		grep -q "$declared" derived/modelDescription.xml || echo "$declared: not there" >>log
	done
    $run_cc -Iderived/sources "-DFACE=\"$face\"" "$ways" "$back" derive.c derived/sources/derived_pl.c -lm -o derive \
		>>log 2>&1 && ./derive >>log
	result $? "derivatives of FMI $version: of outputs by inputs and tunables, within 1e-14"
	! grep 'not there' log
	result $? "derivatives of FMI $version are declared"
done
sed 's/^sensitivity.*/sensitivity u/' derived.spec >few.spec
"$plgen" --fmu few.fmu few.spec >log 2>&1 && unpack few.fmu few && ! grep -q providesD few/modelDescription.xml &&
	grep -q '<Output dependencies="" valueReference="3"/>' few/modelDescription.xml
result $? 'derivatives by some alone are not declared'
tap_end
