#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Many variants of piecewise-linear models as one C file, one header and a table NAME of them.
#
#     variants.sh PLGEN LIST NAME_variants.c NAME_variants.h FOLDER ...
#
# A line of LIST is `NAME STEPS [OPTION ...]`: NAME.spec is looked for in the folders, in their order, each with its
# specs.cases, and becomes the models NAME_0, NAME_1, ... for each of its steps ('-': the spec's own step).  Options:
#     as=PREFIX       PREFIX instead of NAME in the names
#     edit=SCRIPT     the spec after `sed SCRIPT`
#     anything else   for plgen
set -eu
LC_ALL=C
export LC_ALL
case $1 in
    /*) plgen=$1 ;;
    *) plgen=$PWD/$1 ;;
esac
list=$2
code=$3
header=$4
shift 4
table=$(basename "$header" _variants.h)
work=$(mktemp -d "${TMPDIR:-/tmp}/variants.XXXXXX")
trap 'rm -rf "$work"' EXIT
trap 'exit 99' HUP INT TERM
. "${0%/*}/../made.sh"

specs_of "$@"
mkdir "$work/edited"
: >"$work/names"
grep -v -e '^#' -e '^$' "$list" | while read -r name steps options; do
    as=$name
    edit=
    given=
    for option in $options; do
        case $option in
            as=*) as=${option#as=} ;;
            edit=*) edit=${option#edit=} ;;
            *) given="$given $option" ;;
        esac
    done
    spec=$work/edited/$name.spec
    sed -e "$edit" "$work/$name.spec" >"$spec"
    i=0 steps=$steps,
    while [ "$steps" ]; do
        step=${steps%%,*} steps=${steps#*,}
        prefix=${as}_$i
        choice="--prefix $prefix"
        [ "$step" = - ] || choice="$choice --step $step"
        # shellcheck disable=SC2086
        "$plgen" --fast $choice $given -o "$work/$prefix.c" "$spec" 2>"$work/said" || { cat "$work/said" >&2; exit 1; }
        echo "$prefix" >>"$work/names"
        i=$((i + 1))
    done
done

{
    echo "/* Made by variants.sh from $(basename "$list"). */"
    echo '#include "variant.h"'
    made h
    echo "extern const struct variant ${table}_table[];  /* up to one without a model */"
} >"$header"
{
    echo "#include \"$(basename "$header")\""
    made c
    while read -r name; do
        echo "static int ${name}_region_of(const void *s)"
        echo '{'
        echo "    return ${name}_region((const $name *)s);"
        echo '}'
        echo "static uint64_t ${name}_crossed_of(const void *s)"
        echo '{'
        echo "    return ${name}_crossed((const $name *)s);"
        echo '}'
        echo "static int ${name}_crossings_of(const void *s, pl_crossing *crossing)"
        echo '{'
        echo "    return ${name}_crossings((const $name *)s, crossing);"
        echo '}'
    done <"$work/names"
    echo "const struct variant ${table}_table[] = {"
    sed 's/.*/    {\&&_model, &_region_of, &_crossed_of, &_crossings_of},/' "$work/names"
    echo '    {NULL, NULL, NULL, NULL}};'
} >"$code"
