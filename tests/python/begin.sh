# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced by the scripts of this folder, whose arguments are PLGEN SOURCE_ROOT: paths, a cache of their own with a blank
# in it, and the rows that plmain.c writes of some models, which a binding has to have bit for bit.
set -u
PLGEN=$(realpath "$1")
root=$(realpath "$2")
. "$root/tests/tap.sh"
XDG_CACHE_HOME="$work/a cache"
PLGEN_RUNTIME=$root/runtime
export PLGEN PLGEN_RUNTIME XDG_CACHE_HOME
. "$root/tests/run_cc.sh"
# What is compiled has the same bits by tcc, or without an optimiser; with LONG=1 in the environment as a user has it
cc_given=${CC:-cc}
if [ -n "${LONG:-}" ]; then
	run_cc="${CC:-cc} -O2 -w"
else
	CFLAGS=-O0
	! command -v tcc >log || CC=tcc
	export CC CFLAGS
fi

# rows NAME SPEC TIME [OPTION of plgen ...] -- [NAME=VALUE of plmain ...]: NAME.rows; held.csv is the record
rows() {
	name=$1 spec=$2 until=$3
	shift 3
	options=
	while [ "$1" != -- ]; do
		options="$options $1"
		shift
	done
	shift
	single=
	case $options in *float*) single=-DFLOAT ;; esac
	# shellcheck disable=SC2086
	"$PLGEN" --fast $options "$spec" >"$name.c" 2>said || cat said
	model=$(sed -n 's/^extern const pl_modelf\{0,1\} \(.*\)_model;$/\1/p' "$name.c")
	# shellcheck disable=SC2086
	$run_cc $single -I"$root/runtime" -DMODEL="$model" "$root/runtime/host/plmain.c" "$name.c" "$archive" -lm \
		-o "$name.program" || exit 99
	"./$name.program" "$until" --raw "$@" <held.csv >"$name.rows"
}

prepare() {
	runtime_archive "$root/runtime"
	cat >held.spec <<'X'
model held
param m = 2, k = 80, c = 0.6, a = 3
tunable k, c
coord x, y
input push
input base hold first
init x = 0.1
m*x'' + c*(x' - y') + k*(x - y) = push
1*y'' + c*(y' - x') + k*(y - x) + a*(y - base) = 0
output x, y
output pull = k*(y - base)
output speed = x'
step 1/64
X
	sed -e 's/^model held/model smooth/' -e 's/base hold first/base hold third/' \
		-e '/^tunable/d' held.spec >smooth.spec
	sed -e 's/^model held/model plain/' -e 's/ hold first//' held.spec >plain.spec
	cat >hard.spec <<'X'
model hard
coord x
x'' - x - x^3 = 0
init x = 10
step 0.1
scheme etdrk4
X
	awk 'BEGIN { print "push,base"; srand(3); for (k = 0; k <= 300; k++)
		printf "%.17g,%.17g\n", rand() - 0.5, rand() }' >held.csv
	rows sdcsf "$root/models/sdcsf.spec" 20 --
	rows weaker "$root/models/sdcsf.spec" 5 -D k2=80.5 --
	rows stop "$root/models/stop.spec" 5 --
	rows pendulum "$root/models/pendulum.spec" 10 --
	rows held held.spec 4 --
	rows tuned held.spec 4 -- k=70.25 c=0.1
	rows smooth smooth.spec 4 --
	rows single held.spec 4 --real float --
}
