#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Measures every form of every linear model on an emulated Cortex-M0 and M4F, and retuning where params are tunable,
# and writes what doc/firmware.md shows of it.
#
#     report.sh SOURCE_ROOT DOC_FOLDER ALL_double.c ALL_float.c MODEL_double.c MODEL_float.c ...
#
# ALL: every form of every linear model; MODEL: the others, of which only the stack is told.
set -eu
LC_ALL=C
export LC_ALL
root=$1
doc=$2
double=$3
float=$4
shift 4
firmware=$root/tests/firmware
. "$firmware/boards.sh"
case $double in /*) ;; *) double=$PWD/$double float=$PWD/$float ;; esac
work=$(mktemp -d "${TMPDIR:-/tmp}/report.XXXXXX")
trap 'rm -rf "$work"' EXIT
trap 'exit 99' HUP INT TERM

compile() {         # compile SOURCE OBJECT [OPTION ...]
	source=$1
	object=$2
	shift 2
	# shellcheck disable=SC2086
	$arm-gcc $optimize $cpu -I"$root/runtime" -I"$firmware" "$@" -c "$source" -o "$object.o"
}

for name in m0 m4f; do
	board $name
	for real in double float; do
		of=$work/$name.$real
		mkdir "$of"
		option=-DREAL_DOUBLE
		models=$double
		[ $real = double ] || { option=-DREAL_FLOAT; models=$float; }
		for f in start semihosting digits; do compile "$firmware/$f.c" "$of/$f"; done
		for f in figures matvec; do compile "$firmware/$f.c" "$of/$f" $option; done
		compile "$models" "$of/models" $option -fcallgraph-info=su
        for f in "$root"/runtime/*.c; do compile "$f" "$of/runtime_$(basename "$f" .c)" -fcallgraph-info=su; done
		for f; do
			case $f in /*) ;; *) f=$PWD/$f ;; esac
			case $f in *_$real.c) (cd "$work" && compile "$f" other -fcallgraph-info=su &&
				mv other.ci "$of/other_$(basename "$f" .c).ci") ;; esac
		done
		awk -f "$firmware/stack.awk" "$of"/*.ci | sort >"$work/stack.$name.$real"
		link "$of/image.elf" "$of"/*.o
		emulate 120 "$of/image.elf" -icount shift=10,align=off,sleep=off >"$of/out"
		tail -n 1 "$of/out" | grep -q '^end' || { echo "report.sh: $name, $real: no end" >&2; exit 1; }
		# Bytes of the step itself, and of a program that has nothing but init, step and get
		while read -r variant rest; do
			case $variant in *_retune) continue ;; esac
			function=${variant}_step
			[ "$variant" != matvec ] || function=matvec_$real
			case $variant in draw | multiply | add | end) continue ;; esac
			bytes=$($arm-nm -S "$of/image.elf" | awk -v f="$function" '$4 == f { print $2 }')
			keep="-Wl,-u,${variant}_init -Wl,-u,${variant}_get"
			[ "$variant" != matvec ] || keep=
			# shellcheck disable=SC2086
			link "$of/one.elf" -Wl,-e,"$function" $keep "$of/models.o" "$of/matvec.o" "$of"/runtime_*.o
			echo "$variant $((0x$bytes)) $($arm-size "$of/one.elf" | awk 'NR == 2 { print $1 + $2 }')"
		done <"$of/out" >"$of/bytes"
		# Bytes of a retune itself, and of a program that has it beside init, step and get
		sed -n 's/_retune .*//p' "$of/out" | uniq | while read -r variant; do
			bytes=$($arm-nm -S "$of/image.elf" | awk -v f="${variant}_retune" '$4 == f { print $2 }')
			link "$of/one.elf" -Wl,-e,"${variant}_step" -Wl,-u,"${variant}_init" -Wl,-u,"${variant}_get" \
				-Wl,-u,"${variant}_retune" -Wl,-u,"${variant}_use" \
				"$of/models.o" "$of"/runtime_*.o
			echo "$variant $((0x$bytes)) $($arm-size "$of/one.elf" | awk 'NR == 2 { print $1 + $2 }')"
		done >"$of/retune_bytes"
	done
done

# ---- figures.csv ----

{
	printf '%s,' model form accuracy real multiplications additions ram m0_step_bytes m0_flash m0_stack \
		m0_instructions m0_most m0_soft_float m4f_step_bytes m4f_flash m4f_stack m4f_instructions
	echo m4f_most
	for real in double float; do
		[ $real = double ] && models=$double || models=$float
		awk -v real=$real -v folder="$work" '
			function read_board(board, ticks,    file, line, field) {
				file = folder "/" board "." real "/out"
				while ((getline line <file) > 0) {
					if (split(line, field, " ") != 5) continue
					ram[field[1]] = field[2]
					# One instruction of the empty function came off with its call.
                    figures[board, field[1]] = field[5] "," int(field[3] / 200 / ticks + 1.5) "," int(field[4] / ticks \
						+ 1.5)
				}
				file = folder "/" board "." real "/bytes"
				while ((getline line <file) > 0) {
					split(line, field, " ")
					bytes[board, field[1]] = field[2] "," field[3]
				}
			}
			# Soft float alone, on the M0: the counted operations times what one takes.
			function cost(what,    file, line, field, total) {
				file = folder "/m0." real "/out"
				close(file)
				while ((getline line <file) > 0) {
					split(line, field, " ")
					total[field[1]] = field[3]
				}
				return (total[what] - total["draw"]) / 200 / 16.384
			}
			function row(variant, what, multiplications, additions) {
                return what "," real "," multiplications "," additions "," ram[variant] "," bytes["m0", variant] "," \
					figures["m0", variant] "," \
                    int(multiplications * multiply + additions * add + 0.5) "," bytes["m4f", variant] "," \
						figures["m4f", variant] "\n"
			}
            BEGIN { read_board("m0", 16.384); read_board("m4f", 25.6); multiply = cost("multiply"); add = cost("add") }
			/^\/\* [a-z0-9_]*: made by plgen/ {
				variant = $2
				sub(":", "", variant)
				match($0, /from [a-z0-9_]*/)
				model = substr($0, RSTART + 5, RLENGTH - 5)
				accuracy = "plain"
			}
			/^[\/ ]\* .*--accuracy compensated/ { accuracy = "compensated" }
			/^ \* One step of h/ {
				match($0, /form [a-z-]*/)
				form = substr($0, RSTART + 5, RLENGTH - 5)
				match($0, /[0-9]* multiplications/)
				multiplications = substr($0, RSTART) + 0
				match($0, /[0-9]* additions/)
				additions = substr($0, RSTART) + 0
				if (!(model in rows)) order[++models] = model
                rows[model] = rows[model] row(variant, model "," form "," accuracy, multiplications, additions)
			}
			END { for (i = 1; i <= models; i++) printf "%s", rows[order[i]]
				  printf "%s", row("matvec", "matvec,loop,plain", 16, 16) }' "$models"
	done
} >"$doc/firmware/figures.csv"

# ---- retune.csv ----

{
    printf '%s,' model form real coefficients pole_h m0_retune_bytes m0_flash m0_flash_more m0_stack m0_instructions \
		m0_most m4f_retune_bytes m4f_flash m4f_flash_more m4f_stack m4f_instructions
	echo m4f_most
	for real in double float; do
		[ $real = double ] && models=$double || models=$float
		awk -v real=$real -v folder="$work" '
			function read_board(board, ticks,    file, line, field, variant) {
				file = folder "/" board "." real
				while ((getline line <(file "/bytes")) > 0) {
					split(line, field, " ")
					step_flash[field[1]] = field[3]
				}
				while ((getline line <(file "/retune_bytes")) > 0) {
					split(line, field, " ")
					bytes[field[1]] = field[2] "," field[3] "," field[3] - step_flash[field[1]]
				}
				while ((getline line <(file "/out")) > 0)
					if (split(line, field, " ") == 6) {
						variant = field[1]
						sub("_retune", "", variant)
						if (board == "m0")
							times[variant, ++many[variant]] = field[6]
						size[variant] = field[2]
                        figures[board, variant, field[6]] = bytes[variant] "," field[5] "," int(field[3] / 4 / ticks + \
							0.5) "," int(field[4] / ticks + 0.5)
					}
			}
			BEGIN { read_board("m0", 16.384); read_board("m4f", 25.6) }
			/^\/\* [a-z0-9_]*: made by plgen/ {
				variant = $2
				sub(":", "", variant)
				match($0, /from [a-z0-9_]*/)
				model = substr($0, RSTART + 5, RLENGTH - 5)
				pole = 0
			}
			/^ \* .* \+- .* i  / && $(NF - 1) > pole { pole = $(NF - 1) } # Hz
			/^ \* One step of h/ {
				match($0, /form [a-z-]*/)
				form = substr($0, RSTART + 5, RLENGTH - 5)
				for (i = 1; i <= many[variant]; i++)
                    printf "%s,%s,%s,%d,%.2g,%s,%s\n", model, form, real, size[variant], 6.283185307 * pole * $7 * \
						times[variant, i],
                        figures["m0", variant, times[variant, i]], figures["m4f", variant, times[variant, i]]
			}' "$models"
	done
} >"$doc/firmware/retune.csv"

# ---- stack.csv, of every function: in the build folder, as it is long ----

stack=${MESON_BUILD_ROOT:-$PWD}/tests/firmware/stack.csv
mkdir -p "${stack%/*}" || exit 99
{
	echo function,m0_own,m0_deepest,m4f_own,m4f_deepest
	sort -u "$work/stack.m0.double" "$work/stack.m0.float" >"$work/m0"
	sort -u "$work/stack.m4f.double" "$work/stack.m4f.float" >"$work/m4f"
	join "$work/m0" "$work/m4f" | tr ' ' ,
} >"$stack"

# ---- the tables of firmware.md: a part of the rows of figures.csv, retune.csv and stack.csv ----

{
	echo "\`$arm-gcc\` $($arm-gcc -dumpfullversion), \`-O2 -ffp-contract=off\`:"
	echo
	echo '|model|form|type|operations|RAM|M0: flash|stack|instr.|M4F: flash|stack|instr.|'
	echo '|---|---|---|---|---|---|---|---|---|---|---|'
	awk -F, '$1 == "matvec" || $1 == "scs" && $2 ~ /^kick/ ||
			 $1 ~ /^(sdcs|sdcsf|retuned)$/ && $2 == "delta" && $3 == "plain" {
				 form = $2 ($3 == "compensated" ? ", compensated" : "")
				 print "|" $1 "|" form "|" $4 "|" $5 " + " $6 "|" $7 "|" $9 "|" $10 "|" $11 "|" \
					 $15 "|" $16 "|" $17 "|" }' "$doc/firmware/figures.csv"
} >"$work/figures"
{
	echo '|model|M0: step|at|retune|selftest|M4F: step|at|retune|selftest|'
	echo '|---|---|---|---|---|---|---|---|---|'
	awk -F, 'BEGIN { count = split("scs retuned gear1 pendulum beam15", models, " ") }
			 { m0[$1] = $3; m4f[$1] = $5 }
			 function of(table, f) { return f in table ? table[f] : "" }
			 function row(m) {
				 print "|" m "|" of(m0, m "_step") "|" of(m0, m "_at") "|" of(m0, m "_retune") "|" \
					 of(m0, m "_selftest") "|" of(m4f, m "_step") "|" of(m4f, m "_at") "|" \
					 of(m4f, m "_retune") "|" of(m4f, m "_selftest") "|" }
			 END { for (i = 1; i <= count; i++) { row(models[i] "_double"); row(models[i] "_float") } }' \
		"$stack"
} >"$work/model_stack"
{
	echo '|type|RAM|\|pole\| h|M0: flash|stack|instr.|M4F: flash|stack|instr.|'
	echo '|---|---|---|---|---|---|---|---|---|'
	awk -F, '$2 == "delta" { print "|" $3 "|" $4 "|" $5 "|+" $8 "|" $9 "|" $10 "|+" $14 "|" $15 "|" \
		$16 "|" }' "$doc/firmware/retune.csv"
} >"$work/retune"
# One multiplication and one addition of soft float, calls included
for name in m0 m4f; do
	ticks=16.384
	[ $name = m0 ] || ticks=25.6
	for real in double float; do
		awk -v ticks=$ticks -v what="$name, $real" '{ total[$1] = $3 }
            END { printf "| %s | %.0f | %.0f |\n", what, (total["multiply"] - total["draw"]) / 200 / ticks, \
				(total["add"] - total["draw"]) / 200 / ticks }' "$work/$name.$real/out"
	done
done >"$work/soft.rows"
{ echo '| | multiplication | addition |'; echo '| --- | --- | --- |'; sed 's/^| m0/| M0/; s/^| m4f/| M4F/' \
	"$work/soft.rows"; } >"$work/operations"

# Between <!-- table NAME --> and <!-- end --> stands table NAME.
awk -v folder="$work" '
	/^<!-- end -->/ { inside = 0 }
	!inside { print }
	/^<!-- table / { inside = 1; print ""; while ((getline line <(folder "/" $3)) > 0) print line; print "" \
		}' "$doc/firmware.md" >"$work/firmware.md"
cp "$work/firmware.md" "$doc/firmware.md"
