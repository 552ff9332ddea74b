#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Many variants of models as one C file, one header and a table NAME of them.
#
#     variants.sh PLGEN LIST NAME_variants.c NAME_variants.h FOLDER ...
#
# A line of LIST is `NAME SCHEMES STEPS [OPTION ...]`: NAME.spec is looked for in the folders, in their order, each
# with its specs.cases, and becomes the models NAME_SCHEME_0, NAME_SCHEME_1, ... for each of its steps ('-': the spec's
# own scheme, the spec's own step).  Options:
#     as=PREFIX       PREFIX instead of NAME in the names
#     at=TEXT         `operator at TEXT` instead of the spec's own operator ('_' is a blank); at=none: no such statement
#     order=N         of scheme taylor, which N makes fixed
#     over=K          beside it: one expansion is over so many steps
#     stages=N        of the line's scheme, or of etdcol
#     edit=SCRIPT     the spec after `sed SCRIPT`
#     anything else   for plgen
# regions=1 in the environment, as ../switching/variants.sh has it: of piecewise-linear models, without NAME_rhs; their
# table has their functions of regions and is called NAME_table.
set -eu
LC_ALL=C
export LC_ALL
plgen=$(realpath "$1")
list=$2
code=$3
header=$4
shift 4
table=$(basename "$header" _variants.h)${regions:+_table}
rhs=--rhs
[ -z "${regions:-}" ] || rhs=
work=$(mktemp -d "${TMPDIR:-/tmp}/variants.XXXXXX")
trap 'rm -rf "$work"' EXIT
trap 'exit 99' HUP INT TERM
. "${0%/*}/../made.sh"

specs_of "$@"
mkdir "$work/edited"
: >"$work/names"
grep -v -e '^#' -e '^$' "$list" | while read -r name schemes steps options; do
	as=$name
	spec=$work/$name.spec
	given=
	order=
	over=
	stages=
	for option in $options; do
		case $option in
			as=*) as=${option#as=} ;;
			order=*) order=${option#order=} ;;
			over=*) over=" over ${option#over=}" ;;
			stages=*) stages=${option#stages=} ;;
			edit=*)
				sed -e "${option#edit=}" "$spec" >"$work/edited/$name.spec"
				spec=$work/edited/$name.spec ;;
			at=*)
				operator=$(printf '%s' "${option#at=}" | tr '_' ' ')
				{
					grep -v '^operator' "$work/$name.spec"
					[ "$operator" = none ] || echo "operator at $operator"
				} >"$work/${name}_at.spec"
				spec=$work/${name}_at.spec ;;
			*) given="$given $option" ;;
		esac
	done
	schemes=$schemes,
	while [ "$schemes" ]; do
		scheme=${schemes%%,*} schemes=${schemes#*,}
		i=0 left=$steps,
		while [ "$left" ]; do
			step=${left%%,*} left=${left#*,}
			prefix=${as}_${scheme}_$i
			choice="--prefix $prefix"
			if [ "$scheme" = - ]; then
				choice="--prefix ${as}_$i"
				prefix=${as}_$i
			else
				[ "$stages" ] || choice="$choice --scheme $scheme"
			fi
			of_stages=$scheme
			[ "$scheme" = - ] && of_stages=etdcol
			[ "$step" = - ] || choice="$choice --step $step"
			# shellcheck disable=SC2086
			"$plgen" --fast $rhs $choice $given ${order:+--scheme "taylor $order$over"} \
				${stages:+--scheme "$of_stages $stages"} -o "$work/$prefix.c" "$spec" \
				2>"$work/said" ||
				{ cat "$work/said" >&2; exit 1; }
			echo "$prefix" >>"$work/names"
			i=$((i + 1))
		done
	done
done

{
	echo "/* Made by variants.sh from $(basename "$list"). */"
	echo '#include "variant.h"'
	made h
	echo "extern const struct variant ${table}[];  /* up to one without a model */"
} >"$header"
{
	echo "#include \"$(basename "$header")\""
	made c
	members='\&&_Phi[0][0]' none=NULL
	if [ -n "${regions:-}" ]; then
		members='&_region_of, &_crossed_of, &_crossings_of' none='NULL, NULL, NULL'
		while read -r name; do
			echo "static int ${name}_region_of(const void *s)"
			printf '{\n    return %s_region((const %s *)s);\n}\n' "$name" "$name"
			echo "static uint64_t ${name}_crossed_of(const void *s)"
			printf '{\n    return %s_crossed((const %s *)s);\n}\n' "$name" "$name"
			echo "static int ${name}_crossings_of(const void *s, pl_crossing *crossing)"
			printf '{\n    return %s_crossings((const %s *)s, crossing);\n}\n' "$name" "$name"
		done <"$work/names"
	fi
	echo "const struct variant ${table}[] = {"
	sed "s/.*/    {\\&&_model, $members},/" "$work/names"
	echo "    {NULL, $none}};"
} >"$code"
