#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# plgen --bundle: a model with the runtime inside compiles alone and without a warning, has the bits of one that is
# linked with the runtime, needs nothing of it and shows no name but its own.
#
#     bundle.sh PLGEN SOURCE_ROOT
#
# Compiled to be run, and with MERGE=1 for warnings: by gcc and clang as C99, g++ and clang++ as C++17, all four for the
# first model, for the others one of them in turn, with LONG=1 all; what is not installed is skipped.
root=$2
. "${0%/*}/../compilers.sh"
. "${0%/*}/../plgen.sh"
warnings="$warnings -Wcast-qual"
! long || run_cc="${CC:-cc} -std=c99 -O1 -ffp-contract=off -w"

cat >compilers <<'EOT'
gcc -std=c99
clang++ -std=c++17 -x c++
clang -std=c99
g++ -std=c++17 -x c++
EOT

# What a model has after some steps, and in one, by its bits; with a leap where it has one
cat >show.c <<'EOT'
#include "model.h"
#include <stdio.h>
#include <string.h>

#ifdef FLOAT
typedef float real;
typedef pl_modelf descriptor;
#else
typedef double real;
typedef pl_model descriptor;
#endif
extern const descriptor MODEL;

static void show(const real *y, int n)
{
	unsigned char byte[sizeof(real)];
	int i, k;
	for (i = 0; i < n; i++) {
		memcpy(byte, y + i, sizeof byte);
		for (k = 0; k < (int)sizeof byte; k++)
			printf("%02x", byte[k]);
		putchar('\n');
	}
}

int main(void)
{
	static union { double d; unsigned char bytes[1 << 20]; } s;
	static real y[2000];
	const descriptor *m = &MODEL;
	real u[64] = {1};
	int k;
	if (m->size > sizeof s)
		return 2;
	m->init(&s);
	for (k = 0; k < 40; k++) {
		m->step(&s, m->inputs ? u : NULL);
		m->out(&s, y);
		show(y, m->outputs);
	}
	if (m->at) {
		m->at(&s, m->inputs ? u : NULL, m->h / 3, y);
		show(y, m->states);
	}
	if (m->jump)
		m->jump(&s, 1000);
	m->get(&s, y);
	show(y, m->states);
	if (m->retune)
		printf("%d\n", m->retune(&s, m->param_values, m->h / 2));
	m->step(&s, m->inputs ? u : NULL);
	m->get(&s, y);
	show(y, m->states);
	printf("%d\n", m->status(&s));
	return 0;
}
EOT

# own_names OBJECT: what it shows beside names of its own
own_names() {
	"$nm" "$1" | grep -E ' ([A-TV-Z] |U pl_)' | grep -v -E ' ([A-TV-Z] _?scene_|V DW\.ref\.__gxx_personality)' >>log
}

# warns: what the compilers say of model.c
warns() {
	line=0
	: >log
	while read -r compiler options; do
		line=$((line + 1))
		long || [ $number -eq 1 ] || [ $line -eq $((number % 4 + 1)) ] || continue
		command -v "$compiler" >/dev/null 2>&1 || continue
		# shellcheck disable=SC2086
		"$compiler" $warnings $options -c model.c -o warned.o >>log 2>&1 || echo "$compiler" >>log
		own_names warned.o
	done <compilers
	[ ! -s log ]
	result $? "$title, $real: no warning"
}

number=0
kinds=0
# bundles TITLE SPEC OPTIONS: in double and float; of every second kind in double alone, with MERGE=1 or LONG=1 of none
bundles() {
	title=$1
	spec=$2
	shift 2
	kinds=$((kinds + 1))
	reals='double float'
	merging || [ $((kinds % 2)) -eq 1 ] || reals=double
	for real in $reals; do
		own=
		[ $real = double ] || own=-DFLOAT
		rm -f model.c model.h
		if ! "$plgen" --bundle --real $real --prefix scene "$@" -o model.c "$spec" >log 2>&1; then
			result 1 "$title, $real: a bundle"
			continue
		fi
		number=$((number + 1))
		: >log
		# shellcheck disable=SC2086
		$run_cc $own -c model.c -o model.o >>log 2>&1 && own_names model.o
		[ ! -s log ]
		result $? "$title, $real: no name of the runtime outside"
		! merging || warns
		# shellcheck disable=SC2086
		$run_cc $own -DMODEL=scene_model -c show.c -o show.o >log 2>&1 &&
			$run_cc show.o model.o -lm -o inside >>log 2>&1 && ./inside >inside.bits
		# shellcheck disable=SC2086
		"$plgen" --real $real --prefix scene "$@" -o model.c "$spec" >>log 2>&1 &&
			$run_cc $own -DMODEL=scene_model -I"$root/runtime" show.c model.c "$archive" -lm \
				-o linked >>log 2>&1 &&
			./linked >linked.bits
		cmp inside.bits linked.bits >>log 2>&1 && [ "$(wc -l <inside.bits)" -gt 40 ]
		result $? "$title, $real: the bits of a model that is linked with the runtime"
	done
}
bundles 'loads' "$root/models/sdcsf.spec" --rhs
bundles 'loads that change and grow' "$(path_of tests/emitted/linear/switched.spec)"
bundles 'two words' "$root/models/scs.spec" --accuracy compensated --selftest
bundles 'regions' "$root/models/quarter_car_bumps.spec"
bundles 'crossings and loads' "$root/models/gear1.spec"
bundles 'friction' "$root/models/brake.spec"
bundles 'impacts' "$root/models/bouncing_ball.spec"
bundles 'delays' "$(path_of tests/delays/echo.spec)"
bundles 'tunable' "$(path_of tests/tunable/changes.spec)"
bundles 'many instances' "$root/models/quarter_car.spec" --batch
bundles 'a remainder' "$root/models/quad2dof.spec" --scheme etdrk4
bundles 'series' "$root/models/pendulum.spec"
bundles 'stiff' "$root/models/vanderpol_stiff.spec" --scheme radau
bundles 'friction by series' "$(path_of tests/contacts/rubbed.spec)" --tolerance 1e-5
bundles 'tunable regions' "$(path_of tests/tunable/regions/rubbing.spec)"
bundles 'crossings by parts' "$(path_of tests/series_switching/gap_cubic.spec)" --scheme etdrk4
bundles 'crossings, where it is stiff or not' "$(path_of tests/series_switching/stop_cubic.spec)" --scheme auto

# ---- names: of a model that is called as something in the runtime ----

: >log
for name in real two add multiply rounded envelope point walk words_pair sizes clear found; do
	for spec in "$root/models/quarter_car_bumps.spec" "$(path_of tests/tunable/changes.spec)"; do
		"$plgen" --bundle --prefix $name -o $name.c "$spec" 2>>log &&
			$run_cc -c $name.c -o named.o >>log 2>&1 || echo "$name" >>log
	done
done
[ ! -s log ]
result $? 'models called as functions and types inside the runtime'

# ---- headers beside each other ----

"$plgen" --bundle --prefix one -o one.c "$root/models/sdcsf.spec" 2>log
"$plgen" --bundle --prefix other --real float -o other.c "$root/models/quarter_car_bumps.spec" 2>>log
"$plgen" --prefix plain -o plain.c "$root/models/pendulum.spec" 2>>log
echo '#include "plain.h"
#include "one.h"
#include "other.h"
#include "one.h"
typedef struct { plain p; one o; other q; } all;' >beside.c
echo '#include "other.h"
#include "one.h"
#include "plain.h"' >before.c
: >log
while read -r compiler options; do
	command -v "$compiler" >/dev/null 2>&1 || continue
	# shellcheck disable=SC2086
	"$compiler" $warnings $options -I"$root/runtime" -fsyntax-only beside.c >>log 2>&1 || echo "$compiler" >>log
done <compilers
[ ! -s log ]
result $? 'two bundles and a model without stand in one file'
${CC:-cc} -I"$root/runtime" -fsyntax-only before.c >said 2>&1
[ $? -ne 0 ] && grep -q 'goes before headers of bundles' said
result $? 'plrt.h behind a bundle is refused by name'
sed 's/PL_BUNDLED 0x/&1/; s/PL_BUNDLED != 0x/&1/' one.h >later.h
printf '#include "other.h"\n#include "later.h"\n' >versions.c
${CC:-cc} -fsyntax-only versions.c >said 2>&1
[ $? -ne 0 ] && grep -q 'different versions do not go together' said
result $? 'bundles of different versions are refused by name'

# ---- standard output; what it does not go with ----

"$plgen" --bundle "$root/models/sdcsf.spec" >alone.c 2>log && ${CC:-cc} $warnings -std=c99 -c alone.c >>log 2>&1
result $? 'a bundle on standard output is one file'
: >log
for option in --header --explain '--solution 1'; do
	# shellcheck disable=SC2086
	"$plgen" --bundle $option "$root/models/sdcsf.spec" >out 2>said
	[ $? -eq 2 ] && [ ! -s out ] && grep -q 'bundle is of C' said || echo "$option" >>log
done
[ ! -s log ]
result $? '--bundle goes with C alone'

# ---- sizes: printed, and never larger ----

merging || tap_end
: >log
mkdir small
# small_runtime: into plrt.a what the linker takes of the runtime's sources for model.o, compiled when it is first taken
small_runtime() {
	for name in $(${CC:-cc} -r -nostdlib -Wl,-t,-t model.o "$archive" -o linked.o 2>>log |
		sed -n 's/^(.*)\(runtime_\)*\(.*\)\.c\.o$/\2/p'); do
		[ -e "small/$name.o" ] ||
			${CC:-cc} -Os -I"$root/runtime" -c "$root/runtime/$name.c" -o "small/$name.o" 2>>log
	done
	rm -f plrt.a
	"$ar" rcs plrt.a small/*.o
}
for spec in sdcsf pendulum quarter_car_bumps; do
	for real in double float; do
		"$plgen" --real $real --bundle --prefix scene -o model.c "$root/models/$spec.spec" 2>>log
		${CC:-cc} -Os -c model.c -o inside.o 2>>log
		lines=$(cat model.c model.h | wc -l)
		"$plgen" --real $real --prefix scene -o model.c "$root/models/$spec.spec" 2>>log
		${CC:-cc} -Os -I"$root/runtime" -c model.c -o model.o 2>>log
		small_runtime
		# all that the linker takes of the library
		${CC:-cc} -r -nostdlib model.o plrt.a -o linked.o 2>>log
		inside=$(size inside.o | awk 'NR == 2 { print $1 + $2 }')
		linked=$(size linked.o | awk 'NR == 2 { print $1 + $2 }')
		separate=$(cat model.c model.h "$root"/runtime/*.[ch] | wc -l)
		echo "# $spec, $real: $inside bytes, $lines lines; with the library $linked bytes, $separate lines"
		[ "$inside" -le $((linked + linked / 50)) ] || echo "$spec $real: $inside bytes, linked $linked" >>log
	done
done
[ ! -s log ]
result $? 'a bundle is no larger than what is linked'
tap_end
