#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# precision.sh PLGEN PRECISION OUTDIR [--quick] [--errors] [MODEL...]: the variants, their errors and the table
# OUTDIR/precision_raw.csv; --errors: without the table and its times (OUTDIR/variants/MODEL.errors), which a later run
# without it then takes as they are. Run at the top of the source tree; draw.sh then draws.
set -e
plgen=$1 program=$2 out=$3
shift 3
variants=$out/variants
quick='' errors=''
while :; do
	case ${1:-} in
		--quick) quick=--quick ;;
		--errors) errors=yes ;;
		*) break ;;
	esac
	shift
done

# missing MODEL...: of these, what has no errors yet
missing() {
	for model in $("$program" --names $quick "$@"); do
		[ -f "$variants/$model.errors" ] || echo "$model"
	done
}

mkdir -p "$variants"
# Words: names of models
# shellcheck disable=SC2046
set -- $("$program" --names $quick "$@")
# shellcheck disable=SC2046
[ -z "$errors" ] || rm -f $(printf "$variants/%s.errors\n" "$@")
for model in $(missing "$@"); do
	"$program" --list $quick "$model" |
		xargs -P "${JOBS:-2}" -L1 sh -c 'plgen=$1 folder=$2 file=$3; shift 3
			exec sh bench/charts/variant.sh "$plgen" "$folder/$file" "$@"' make "$plgen" "$variants"
	"$program" --errors $quick "$variants" "$model"
done
[ -n "$errors" ] || "$program" $quick "$variants" "$out/precision_raw.csv" "$@"
