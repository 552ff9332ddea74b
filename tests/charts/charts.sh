#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# charts.sh BUILD ROOT: a quick run of all charts; its tables, orders and failures, its pictures and its page. Times are
# never looked at.
set -u
build=$1 root=$2
here=$root/tests/charts
charts=$root/bench/charts
csv=$charts/csv.awk
. "$root/tests/tap.sh"
out=$work/out
log=$work/log

(cd "$root" && exec sh bench/charts/charts.sh "$build" "$out" --quick) >"$log" 2>&1
result $? "charts.sh --quick"

# ---- the tables ----

while read -r name head; do
    sed -n 1p "$out/$name.csv" >head 2>&1
    { printf 'found    '; cat head; echo "expected $head"; } >"$log"
    [ "$(cat head)" = "$head" ] && [ "$(wc -l <"$out/$name.csv")" -gt 1 ]
    result $? "$name.csv: its columns, and rows"
done <"$here/tables.list"

awk -v list="$here/methods.list" -v special="$here/special.list" -f "$csv" -f "$here/methods.awk" \
    "$out/precision_raw.csv" >"$log" 2>&1
result $? "precision_raw.csv: every model and method, each with its errors or a word"
awk -f "$csv" -f "$here/exact.awk" "$out/precision_raw.csv" >"$log" 2>&1
result $? "precision_raw.csv: exact forms in double are below 1e-11 on linear models"
awk -v list="$here/methods.list" -f "$csv" -f "$here/hard.awk" "$out/hard.csv" >"$log" 2>&1
result $? "hard.csv: every method on every case, each failure with its word"
awk -f "$csv" -f "$here/orders.awk" "$out/convergence_orders.csv" >"$log" 2>&1
result $? "convergence_orders.csv: orders within 0.15"
sh "$charts/table.sh" fold -v by=model,method,family,setting_kind,unit_s -v lists=setting,largest,ns_median \
    "$here/break_even/precision.csv" >folded.csv 2>&1
sh "$charts/table.sh" after "$here/break_even/generation.csv" folded.csv >break_even.csv 2>&1
diff break_even.csv "$here/break_even/expect.csv" >"$log" 2>&1
result $? "break-even of given times: as worked out by hand"
awk -f "$csv" -f "$here/break_even/check.awk" "$out/break_even_raw.csv" >"$log" 2>&1
result $? "break_even_raw.csv: like beside like, never where it never pays"
for name in stability_check quality_check operator_check integrators_check; do
    grep -v ',ok$' "$out/$name.csv" | sed 1d >"$log"
    [ ! -s "$log" ]
    result $? "$name.csv: what is known of the boundaries"
done

# ---- pictures and page ----

for file in "$out"/*.svg; do
    name=$(basename "$file" .svg)
    case $name in
        *_narrow) link="srcset=\"$name.svg\"" ;;
        *) link="src=\"$name.svg\"" ;;
    esac
    {
        grep -q '</svg>' "$file" || echo "$name.svg is not whole"
        [ "${name%_narrow}" != "$name" ] ||
            [ "$(dd if="$out/$name.png" bs=1 skip=1 count=3 2>/dev/null)" = PNG ] || echo "$name.png is none"
        grep -q "$link" "$out"/*.html || echo "no page shows $name.svg"
        # Of what is drawn at least one line or mark
        grep -q -e '<path stroke' -e '<path style="marker' -e '<image' "$file" ||
            echo "$name.svg is empty"
    } >"$log" 2>&1
    [ ! -s "$log" ]
    result $? "$name: a picture in both forms, on a page"
done
while read -r name; do
    [ -f "$out/$name.svg" ] || grep -q "^<figure id=\"$name\"><div .*role=" "$out"/model_*.html || echo "no $name.svg"
done <"$here/pictures.list" >"$log"
[ ! -s "$log" ]
result $? "every picture is there"
for page in "$out"/*.html; do
    awk -f "$here/look.awk" "$page" | sed "s/^/$(basename "$page"): /"
done >"$log"
for file in "$out"/*.csv; do
    case $file in *_raw.csv) continue ;; esac
    grep -q "href=\"$(basename "$file")\"" "$out"/*.html || echo "no page has the table $(basename "$file")" >>"$log"
done
[ -s "$out/index.html" ] && [ ! -s "$log" ]
result $? "pages: every picture with its text and caption, every table, nothing from elsewhere"

# ---- the same again ----

mkdir again
for name in quality_check convergence hard_raw; do
    case $name in
        quality_check) "$build/bench/charts/integrators" --quick again >progress 2>&1 ;;
        *) "$build/bench/charts/${name%_raw}" --quick "$out/variants" again >progress 2>&1 ;;
    esac
    # this one is drawn from fewer digits, bench/charts/draw.sh
    [ $name != convergence ] || { sh "$charts/table.sh" digits -v to=4 again/$name.csv >digits &&
        mv digits again/$name.csv; }
    diff "$out/$name.csv" "again/$name.csv" >"$log" 2>&1
    result $? "$name.csv: the same bytes twice"
done
# Without the errors that the first run has kept
rm -f "$out/variants/pendulum.errors" "$out/variants/scs.errors"
"$build/bench/charts/precision" --quick "$out/variants" again/precision_raw.csv pendulum scs >"$log" 2>&1 &&
    awk -v without="^ns_" -f "$csv" -f "$here/columns.awk" again/precision_raw.csv >second &&
    awk -v without="^ns_" -f "$csv" -f "$here/columns.awk" "$out/precision_raw.csv" |
        grep -e '^model' -e '^pendulum,' -e '^scs,' >first &&
    cmp first second >>"$log" 2>&1
result $? "precision_raw.csv: the same but for times"

tap_end
