#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# variants.sh PLGEN MODELS_FOLDER REAL OUT.c LIST ...: every variant of the lists as one C file, with a table of them at
# its end.
#
# A line of a list is `NAME MODEL [OPTION ...]`, with options for plgen; as the first of them `untested` for what can
# have no selftest, `tunable` for what has tunable params and outputs that depend on them, `anchored` for what keeps its
# loads in tables: the others are as small as can be, and NAME_run goes step by step; as the last `order=N` for scheme
# taylor of that order, `order=N over K` for one series over K steps.  A model that is not in the folder is in this one.
set -eu
plgen=$1
folder=$2
real=$3
out=$4
shift 4
cat "$@" | grep -v '^#' >"$out.lines"
echo '#include "variant.h"' >"$out.part"
while read -r name model options; do
	selftest=--selftest
	refresh='--anchors 1'
	case $options in untested*) selftest= options=${options#untested} ;; esac
	case $options in anchored*) refresh= options=${options#anchored} ;; esac
	order=
	case $options in *order=*) order=${options#*order=} options=${options%order=*} ;; esac
	spec=$folder/$model.spec
	[ -f "$spec" ] || spec=${0%/*}/$model.spec
	# shellcheck disable=SC2086
	"$plgen" $selftest $refresh --rows 1 --real "$real" --prefix "${name}_$real" ${options#tunable} \
		${order:+--scheme "taylor $order"} "$spec" >>"$out.part"
done <"$out.lines"
{
	echo 'const struct variant variants_'"$real"'[] = {'
	sed -e "s/\([^ ]*\) [^ ]* untested.*/    UNTESTED(\1_$real),/; t" \
		-e "s/\([^ ]*\) [^ ]* tunable.*/    TUNABLE(\1_$real),/; t" \
		-e "s/ .*//; s/.*/    VARIANT(&_$real),/" "$out.lines"
	echo '    {0, 0, 0, 0}};'
} >>"$out.part"
rm "$out.lines"
mv "$out.part" "$out"
