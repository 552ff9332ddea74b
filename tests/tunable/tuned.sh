#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Models with tunable params as one C file, one header and a table `tuned` of them (see tuned.h).
#
#     tuned.sh PLGEN REAL CODE.c HEADER.h MODEL.spec ...
#
# Each is there as NAME and, with --form direct, as direct_NAME; as plain_NAME and plain_direct_NAME: the same spec
# without `tunable`; and where its line `#there OPTION ...`, or this script, gives other
# values, with these as there_NAME and there_direct_NAME, again without `tunable`. A line `#always OPTION ...` gives
# options of all of them.
set -eu
LC_ALL=C
export LC_ALL
plgen=$(realpath "$1")
real=$2
code=$3
header=$4
shift 4
work=$(mktemp -d "${TMPDIR:-/tmp}/tuned.XXXXXX")
trap 'rm -rf "$work"' EXIT
trap 'exit 99' HUP INT TERM
. "${0%/*}/../made.sh"
: >"$work/names"
: >"$work/functions"
: >"$work/table"

# make SPEC PREFIX OPTION ...
make() {
	from=$1
	prefix=$2
	shift 2
	# shellcheck disable=SC2086
	"$plgen" --real "$real" --prefix "$prefix" $always "$@" -o "$work/$prefix.c" "$from" 2>"$work/said" ||
		{ cat "$work/said" >&2; exit 1; }
	echo "$prefix" >>"$work/names"
}

# has NAME MEMBER: a line of the table, where the coefficients have such a member
has() {
	grep -q "^    [a-z_]* $2\\[" "$work/$1.h" || return 0
	echo "    .$2 = offsetof($1_coeffs, $2), .$2_entries = (int)(sizeof $1_nominal.$2 / sizeof $1_nominal.$2[0]),"
}

# entry NAME PLAIN THERE FORM: what tuned.h says of one
entry() {
	{
		echo "static int $1_any_coeffs(void *c, const real *params, real h)"
		echo "{"
		echo "    return $1_retune(($1_coeffs *)c, params, h);"
		echo "}"
	} >>"$work/functions"
	echo "static void $1_any_use(void *s, const void *c) { $1_use(($1 *)s, (const $1_coeffs *)c); }" \
		>>"$work/functions"
	{
		echo "    {\"$1\", &$1_model, &$2_model, $3, \"$there\", $4, sizeof($1_coeffs), offsetof($1, coeffs),"
		echo "    &$1_nominal, $1_any_coeffs, $1_any_use,"
		echo "    .h = offsetof($1_coeffs, h), .params = offsetof($1_coeffs, params),"
		echo "    .columns = (int)(sizeof $1_nominal.step[0] / sizeof $1_nominal.step[0][0]),"
		has "$1" step
		has "$1" out
		has "$1" phase_step
		has "$1" envelope_step
		echo '    },'
	} >>"$work/table"
}

for spec; do
	name=$(basename "$spec" .spec)
	there=$(sed -n 's/^#there //p' "$spec")
	always=$(sed -n 's/^#always //p' "$spec")
	[ "$name" != oscillator ] || there='-D w=12 -D zeta=1/10 --step 1/250'       # of models/
	grep -v '^tunable' "$spec" >"$work/without.spec"
	for form in delta direct; do
		if [ $form = delta ]; then before='' direct=0; else before=direct_ direct=1; fi
		make "$spec" "$before$name" --form $form
		make "$work/without.spec" "plain_$before$name" --form $form
		other=NULL
		if [ -n "$there" ]; then
			# shellcheck disable=SC2086
			make "$work/without.spec" "there_$before$name" --form $form $there
			other="&there_$before${name}_model"
		fi
		entry "$before$name" "plain_$before$name" "$other" $direct
	done
done

{
	echo '/* Made by tuned.sh. */'
	echo '#include "tuned.h"'
	made h
} >"$header"
{
	echo "#include \"$(basename "$header")\""
	echo '#include <stddef.h>'
	made c
	cat "$work/functions"
	echo 'const struct tuned tuned[] = {'
	cat "$work/table"
	echo '    {.name = NULL}};'
} >"$code"
