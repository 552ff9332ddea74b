# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced by grammar.sh and ../combinations/combinations.sh, with $plgen, $source (the project) and $folder (of the
# archives that archive.sh makes) set and $work the current folder: specs become C, many of them one program, each run
# by drive.c.
#
#     batch_new               no models
#     batch_add ID SPEC       SPEC's lines of comment name its options, as grammar.c has them; ID.again.c: its second
#     writing, if it is there
#                             what is wrong goes to ID.wrong; `said` becomes made, refused or broken
#     batch_build             compiles, links and runs
#     batch_run ID            the same of its run
#     batch_coarse ID SPEC    whether that is only further from the truth than a smooth model of a fixed order may be
#
# With eighths=yes such a model is added with one by eighths of a step, that the order may be judged.
# With every=N, and without LONG=1 in the environment, only every Nth model is compiled with sanitizers; by gcc, with
# MERGE=1 or LONG=1 by gcc and clang by turns.
# where memory was asked for is not kept, which takes a sixth of a run: ASAN_OPTIONS=malloc_context_size=30 tells it
ASAN_OPTIONS=exitcode=99:hard_rss_limit_mb=2048:quarantine_size_mb=16:${ASAN_OPTIONS:-}
ASAN_OPTIONS=detect_leaks=0:malloc_context_size=0:$ASAN_OPTIONS
UBSAN_OPTIONS=print_stacktrace=1:exitcode=99:${UBSAN_OPTIONS:-}
export ASAN_OPTIONS UBSAN_OPTIONS
. "$source/tests/run_cc.sh"
warnings='-Werror -Wall -Wextra -Wpedantic -Wconversion -Wdouble-promotion -Wshadow'
# What has no sanitizers is compiled only to be run; with LONG=1 in the environment as a user would, with warnings
level=-O0
[ -z "${LONG:-}" ] || level=-O1
# without what stops anyway at the address where it goes: null, misaligned, out of an object; they double what is
# compiled
sanitizers='-fsanitize=address,undefined -fno-sanitize-recover=all'
merging || sanitizers="$sanitizers -fno-sanitize=null,alignment,object-size,pointer-overflow"
every=1
eighths=
# seconds of a processor that plgen or a program may take
ulimit -S -t 1200

batch_new() {
	turn=0
	for cc in gcc clang; do
		: >"subjects_$cc.list"
		rm -f "./batch_$cc"
	done
}

head_of() { # SPEC WHAT
	sed -n "s/^# $2://p" "$1" | head -n 1
}

# heads_of SPEC: sets of its lines of comment `given`, `class`, `retune`, `more`, `beside`, `instead`, `changes` and
# `impact`, by one program
heads_of() {
	eval "$(awk -v quote="'" 'BEGIN {
			count = split("options class retune plain beside instead changes impact held", word, " ")
			split("given class retune more beside instead changes impact held", name, " ")
			for (i = 1; i <= count; i++)
				to[word[i]] = name[i]
		}
		/^# [a-z]*:/ {
			at = index($0, ":")
			of = substr($0, 3, at - 3)
			if ((of in to) && !(of in found))
				found[of] = substr($0, at + 1)
		}
		END {
			for (of in to) {
				value = found[of]
				gsub(quote, quote "\\" quote quote, value)
				print to[of] "=" quote value quote
			}
		}' "$1")"
}

# make_c ID SPEC OPTIONS: with --rhs, where there is a formula for it; 0, or the status of plgen, in which case
# ID.said has its words
make_c() {
	rhs=--rhs
	! grep -q -e '^# class: sticking$' -e '^# beside:' "$2" || rhs=
	# shellcheck disable=SC2086
	"$plgen" $rhs --prefix "$1" $3 -o "$1.c" "$2" >"$1.out" 2>"$1.said" </dev/null
}

# what plgen said with this status: nothing if all is as it should be
why_refused() { # ID STATUS
	case $2 in
		1|2) if ! grep -q ': error: ' "$1.said"; then
				echo "status $2 without a message"
			elif ! grep -q -E -f "$source/tests/fuzz/refusals.list" "$1.said"; then
				echo "status $2: $(grep -m 1 ': error: ' "$1.said")"
			fi ;;
		152) echo 'plgen takes over 1200 s' ;;
		*) echo "plgen ends with status $2: $(grep -m 3 -e 'ERROR' -e 'runtime error' "$1.said" |
			tr '\n' ' ')" ;;
	esac
}

# step_of ID: as it is written in its header; of the parts of a step, where a delay makes it of parts
step_of() {
	sed -n "s/^#define [A-Z0-9_]*_H \([-0-9.e]*\).*/\1/p" "$1.h" | head -n 1
}

functions_of() { # ID
	sed -n '/^ \*     switching function [0-9]*: /p' "$1.c"
}

# facts_of ID: of its C sets `scheme`; `inputs`, `pieces`, `own_region`, `selftest` and `lanes`: whether it has them;
# `real`; `adds`, the additions of a step; `tolerance`, 0 where no lengths of steps are chosen by one; `regions`, how
# many numbers NAME_region may give, by the breakpoints of each expression, 0: there is none; `ratio`, at least 1: the
# largest by which its banner measures one coordinate from another, 10*x - y, times the largest by which such states are
# larger than another in the references of the selftest, since that is the sum of them and a difference as large; ten
# times that in form modal: all steps turn modes by the same rounded numbers, and a state may be a difference of modes;
# `lost`, what outputs lose with the modes that are dropped; `written`: 1 where plgen warns that differences lose digits
# `sustains`: whether the state is kept as it is written, less what loads sustain
# `order`: in h, 0 where there is none or steps are chosen by a tolerance
# `few`: "yes" for 3 stages, which for a small tolerance may want more internal steps within h than it tries
facts_of() {
	eval "$(awk -v id="$1" '
		BEGIN {
			real = "double"
			regions = ratio = adds = 1
			may = written = order = 0
			for (count = split("first second third fourth", of, " "); count > 0; count--)
				ordinal[of[count]] = count
		}
		FILENAME ~ /said$/ { written += /keeps coordinates as they are written/; next }
		FILENAME ~ /h$/ {
			own_region += $0 ~ "^int *" id "_region\\("
			selftest += index($0, id "_selftest")
			lanes += index($0, id "_batch(")
			less += / y\[.*; less their forced part/
			other += /as they are kept \*\// || index($0, id "_core")
			inputs += $0 ~ /INPUTS = [1-9]/
			if (index($0, "pl_modelf " id "_model"))
				real = "float"
			next
		}
		/^ \* Scheme [a-z0-9]/ && !scheme {
			if ($6 == "order")
				order = ordinal[$5] + $5
			scheme = $3
			sub(/[^a-z0-9].*/, "", scheme)
		}
		/piecewise linear/ { pieces++ }
		/kick-drift-kick/ { adds = 3 }
		/ 3 stages, of order 5/ { few = "yes" }
		/^ \* / { banner = banner substr($0, 3) }
		/status says PL_INACCURATE/ { may = "PL_INACCURATE" }
		/^ \*     switching function [0-9]+: .*[,;] breakpoints / {
			sub(/.* breakpoints /, "")
			regions *= split($0, at, ",") + 1
		}
		/are kept apart from relative coordinates:/ && !lists++ {
			sub(/;.*/, "")
			apart = $0 " "
			gsub(/[^A-Za-z0-9_]/, " ", apart)
			for (count = split($0, part, /[^0-9.*\/]+/); count > 0; count--) {
				if (split(part[count], of, /[*\/]/) < 2)
					continue
				most = of[1] / (of[2] ? of[2] : 1)
				ratio = most > ratio ? most : ratio
			}
		}
		/_known_unit\[[0-9]+\] = / { units = ""; listing = 1 }
		listing { units = units $0; listing = !/};/ }
		END {
			all = banner
			sub(/.* State y = /, "", all)
			sub(/.*{/, "", units)
			split(all, name, ", ")
			for (count = split(units, unit, ","); count > 0; count--) {
				primes = gsub(/\047/, "", name[count])
				sub(/\..*/, "", name[count])
				if (!index(apart, " " name[count] " "))
					continue
				if (!(primes in least) || unit[count] + 0 < least[primes])
					least[primes] = unit[count] + 0
				if (unit[count] + 0 > most_of[primes])
					most_of[primes] = unit[count] + 0
			}
			sizes = 1
			for (primes in least)
				if (most_of[primes] > sizes * least[primes])
					sizes = most_of[primes] / least[primes]
			ratio *= sizes * (banner ~ /, form modal:/ ? 10 : 1)
			if (match(banner, /outputs lose at most [^(]*/))
				lost = substr(banner, RSTART + 20, RLENGTH - 21)
			match(banner, /(error is|terms are) below [0-9.e-]+ of/)
			split(substr(banner, RSTART, RLENGTH), of)
			tolerance = RLENGTH > 0 ? of[4] : 0
			printf "scheme=%s tolerance=%s inputs=%s pieces=%s own_region=%s selftest=%s lanes=%s ",
				scheme, tolerance, inputs ? "yes" : "", pieces ? "yes" : "",
				own_region ? "yes" : "", selftest ? "yes" : "", lanes ? "yes" : ""
			printf "few=%s sustains=%s order=%d written=%d lost=\"%s,\" may=%s real=%s ",
				few, less && !other ? "yes" : "", order * (tolerance == 0), written, lost, may, real
			printf "adds=%d regions=%.17g ratio=%s",
				adds, own_region ? regions : 0, ratio
		}' "$1.h" "$1.c" "$1.said")"
}

# slopes ID: a function of one form around ID_rhs
slopes() {
	if grep -q "_rhs(double t, const double y\[\], double" "$1.h"; then
		echo "static void $1_slopes(double t, const double *y, const double *u, double *d)"
		echo "{ (void)u; $1_rhs(t, y, d); }"
	else
		echo "static void $1_slopes(double t, const double *y, const double *u, double *d)"
		echo "{ $1_rhs(t, y, u, d); }"
	fi
}

batch_add() {
	id=$1
	spec=$2
	heads_of "$spec"
	said=broken
	: >"$id.wrong"
	make_c "$id" "$spec" "$given"
	status=$?
	if [ $status -ne 0 ]; then
		why_refused "$id" $status >"$id.wrong"
		[ -s "$id.wrong" ] || said=refused
		return
	fi
	# the plain model: no state left out, in double, of the same step
	plain=$(printf '%s\n' "$given" |
		awk '{ for (i = 1; i < NF; i++) if ($i == "-D" || $i == "--step") printf " %s %s",
		$i, $(i + 1) }')
	grep -q '^step' "$spec" || plain="$plain --step $(step_of "$id")"
	plain="$plain$more"
	whole=$id
	code="$id.c"
	grep -v '^need' "$spec" | sed "/^tunable /d; $instead" >"$id.free.spec"
	case $given$(sed -n '/^need/{s/ .*/ --need/p;q;}' "$spec")${instead:+ --instead}${beside:+ --beside} in
		*--real*|*--reduce*|*--modes*|*--need*|*--instead*|*--beside)
			whole=w$id
			# where regions are too many for the scheme that it would have, by that which was asked for
			own=$(printf '%s\n' "$given" | grep -o ' --scheme [^ ]*')
			if ! make_c "$whole" "$id.free.spec" "$plain$beside" &&
			    { [ -z "$beside" ] || ! make_c "$whole" "$id.free.spec" "$plain"; } &&
			    { [ -z "$own" ] || [ -n "$(why_refused "$whole" 1)" ] ||
				! make_c "$whole" "$id.free.spec" "$plain$own"; }; then
				echo "the plain model: $(grep -m 1 error "$whole.said")" >"$id.wrong"
				return
			fi
			code="$code $whole.c" ;;
	esac
	tuned=
	if [ -n "$retune" ]; then
		tuned=t$id
		less=
		case $given in
			*--reduce*) grep -q -e '--reduce stands aside' "$id.c" || less=--reduce ;;
		esac
		case $retune in
			*step=*) ;;
			*) less="$less$(printf '%s\n' "$given" | grep -o ' --step [^ ]*')" ;;
		esac
		if ! make_c "$tuned" "$spec" \
			"$less $(printf '%s\n' "$retune" |
				sed 's/ step=/ --step /; s/ \([A-Za-z_0-9]*=\)/ -D \1/g')"; then
			why=$(why_refused "$tuned" 1)
			[ -z "$why" ] || { echo "with other params: $why" >"$id.wrong" && return; }
			tuned=
		fi
		code="$code${tuned:+ $tuned.c}"
	fi
	varied=
	for way in $(sed -n '/^sensitivity/{s/.*/11.9988 12 12.0012/p;q;}' "$spec"); do
		varied="$varied, &v${way#*.}${id}_model"
		code="$code v${way#*.}$id.c"
		grep -v -e '^sensitivity' -e '^tunable' -e '^need' "$spec" |
			sed "s/^param k = 12$/param k = $way/" >"$id.varied.spec"
		make_c "v${way#*.}$id" "$id.varied.spec" "$(printf '%s\n' "$given" | sed 's/ --real float//')" &&
			continue
		echo "with another k: $(grep -m 1 error "v${way#*.}$id.said")" >"$id.wrong"
		return
	done
	facts_of "$id"
	fine=
	case $eighths:$scheme:$class in
		yes:* | *:pl:*sticking | *:etd1:*sticking) ;;  # of first order the bound of what sticks is narrow
		*) order=0 ;;
	esac
	if [ "$few" ] || [ "$order" -gt 0 ] ||
	    { [ -n "$beside" ] && [ "$tolerance" = 0 ] && [ "$scheme" != exact ]; }; then
		fine=f$id
		shorter="$(printf '%s\n' "$given" | sed 's/ --step [^ ]*//') --step $(step_of "$id")/8"
		if ! make_c "$fine" "$spec" "$shorter"; then
			echo "by eighths of a step: $(grep -m 1 error "$fine.said")" >"$id.wrong"
			return
		fi
		code="$code $fine.c"
	fi
	solution=NULL
	if [ "$scheme" = exact ] && [ -z "$inputs$pieces" ]; then
		horizon=$(step_of "$whole" | awk '{ printf "%.17g", 32.5 * $1 }')
		# shellcheck disable=SC2086
		"$plgen" --solution "$horizon" $plain "$spec" >"$id.csv" 2>"$id.said" </dev/null
		status=$?
		if [ $status -eq 0 ]; then
			solution="\"$id.csv\""
			! grep -q -E '(^|,)-0(,|$)' "$id.csv" || echo 'the closed form has a -0' >"$id.wrong"
		else
			why_refused "$id" $status >"$id.wrong"
			[ -s "$id.wrong" ] && return
		fi
	fi
	turn=$((turn + 1))
	cc=gcc
	merging && [ $((turn % 2)) -eq 0 ] && cc=clang
	echo "$cc" >"$id.cc"
	again='NULL, NULL, NULL'
	if [ -f "$id.again.c" ]; then
		again="${id}_coords, ${id}_residual, ${id}_wanted"
		sed "1i #define AGAIN $id" "$id.again.c" >"$id.again.made.c"
	fi
	{
		for one in $code; do
			echo "#include \"${one%.c}.h\""
		done
		slopes=NULL
		[ -n "$beside" ] || { slopes=${whole}_slopes && slopes "$whole"; }
		region=NULL
		other=NULL
		if [ -n "$beside" ] && [ "$(functions_of "$id")" = "$(functions_of "$whole")" ] &&
		    grep -q "^int *${whole}_region(" "$whole.h"; then
			other=${whole}_where_too
			echo "static int ${whole}_where_too(const void *s) { return ${whole}_region(s); }"
		fi
		if [ "$own_region" ]; then
			region=${id}_where
			echo "static int ${id}_where(const void *s) { return ${id}_region(s); }"
		fi
		derivatives='NULL, NULL'
		[ -z "$varied" ] || derivatives="&${id}_derivatives, NULL"
		model="&${id}_model, NULL"
		by_eighths="${fine:+&}${fine:-NULL}${fine:+_model}, NULL"
		if [ $real = float ]; then
			model="NULL, &${id}_model"
			by_eighths="NULL, ${fine:+&}${fine:-NULL}${fine:+_model}"
			[ -z "$varied" ] || derivatives="NULL, &${id}_derivatives"
		fi
		if [ "$selftest" ]; then
			selftest=${id}_tested
			echo "static double ${id}_tested(void) { return (double)${id}_selftest(); }"
		fi
		if [ "$sustains" ]; then
			sustains=${id}_sustained
			echo "SUSTAINED($id, $(echo "$id" | tr '[:lower:]' '[:upper:]'), $real)"
		fi
		if [ "$lanes" ]; then
			lanes=${id}_lanes
			echo "LANES($id, $(echo "$id" | tr '[:lower:]' '[:upper:]'), $real, ${inputs:+u COMMA})"
		fi
		if [ "$again" != 'NULL, NULL, NULL' ]; then
			echo "extern const int ${id}_coords[];"
			for function in residual wanted; do
				echo "void ${id}_$function(double t, const double *y, const double *u,"
				echo "const double *top,"
				echo "double *out);"
			done
		fi
		echo "SUBJECT {\"$id\", $model, &${whole}_model, $slopes, \"$scheme\", \"${class# }\"," \
			"\"$changes\"," \
			"$solution, ${selftest:-NULL}," \
			"$again, ${tuned:+&}${tuned:-NULL}${tuned:+_model}, \"$retune\", ${lanes:-NULL}," \
			"\"$impact\", $adds, $region, $regions, $other, $ratio, $tolerance," \
			"$by_eighths, \"$lost\", $written, $may, $order," \
			"${sustains:-NULL}, $derivatives, {${varied#, }}, ${held:-0}},"
	} >"$id.subject"
	echo "$code" >"$id.code"
	printf '%s\n' "$id" >>"subjects_$cc.list"
	said=made
}

# compile_code CHECKS FILES
compile_code() {
	if [ -n "${LONG:-}${1}" ]; then
		# shellcheck disable=SC2086
		$cc -std=c99 $level $warnings $1 -I"$source/runtime" -c $2 2>"$id.cc_said"
		return
	fi
	for file in $2; do
		$run_cc -I"$source/runtime" -c "$file" 2>"$id.cc_said" || return
		echo "${file%.c}.o" >>run_only.list
	done
}

# compile CC: what does not compile is left out
compile() {
	cc=$1
	place=0
	while read -r id; do
		read -r code <"$id.code"
		place=$((place + 1))
		checks=$sanitizers
		[ -n "${LONG:-}" ] || [ $((place % every)) -eq 0 ] || checks=
		# the models that it is held against are plain: of their kind others have sanitizers
		others=
		if [ -n "$checks" ] && [ -z "${LONG:-}" ]; then
			others=${code#*.c}
			code=${code%% *}
		fi
		if ! compile_code "$checks" "$code" || { [ -n "${others# }" ] && ! compile_code '' "$others"; }; then
			{
				echo "$cc: the C does not compile"
				grep -m 3 -e 'error' "$id.cc_said"
			} >"$id.wrong"
			continue
		fi
		if [ -f "$id.again.c" ]; then
			$run_cc -I"$source/tests/fuzz" -c "$id.again.made.c" -o "$id.again.o" \
				2>"$id.cc_said" ||
				{ { echo "$cc: the second writing does not compile"; grep -m 3 error "$id.cc_said"; } \
					>"$id.wrong"; continue; }
			echo "$id.again.o" >>run_only.list
		fi
		echo "$id" >>"compiled_$cc.list"
	done <"subjects_$cc.list"
}

batch_build() {
	for cc in gcc clang; do
		: >"compiled_$cc.list"
		: >run_only.list
		[ -s "subjects_$cc.list" ] || continue
		compile "$cc"
		[ -s "compiled_$cc.list" ] || continue
		{
			echo '#include "drive.h"'
			sed 's/$/.subject/' "compiled_$cc.list" | xargs sed '/^SUBJECT/d'
			echo 'const struct subject subjects[] = {'
			sed 's/$/.subject/' "compiled_$cc.list" | xargs sed -n 's/^SUBJECT //p'
			echo '{0}};'
		} >"subjects_$cc.c"
		objects=
		while read -r id; do
			read -r code <"$id.code"
			objects="$objects $code"
			[ -f "$id.again.c" ] && objects="$objects $id.again.c"
		done <"compiled_$cc.list"
		# those by run_cc as an archive, of which the linker takes what belongs to a program
		rm -rf run_only.a passing && mkdir passing
		xargs "$ar" rcsD run_only.a <run_only.list && finish_archive run_only.a passing
		objects=$(echo "$objects" | sed 's/\.c\>/.o/g' | tr ' ' '\n' | grep -v -x -F -f run_only.list)
		# shellcheck disable=SC2086
		$cc -std=gnu11 $level -w $sanitizers -I. -I"$source/tests/fuzz" -I"$source/runtime" "subjects_$cc.c" \
			$objects run_only.a "$folder/drive_$cc.a" \
			-lsundials_cvode -lsundials_arkode -lsundials_nvecserial -lm -o "batch_$cc" >"link_$cc.said" \
				2>&1 ||
				sed 's/^/# /' "link_$cc.said" | head -n 20
		[ ! -x "batch_$cc" ] || xargs "./batch_$cc" <"compiled_$cc.list"
	done
}

batch_run() {
	id=$1
	[ -s "$id.wrong" ] && return
	read -r cc <"$id.cc"
	if ! [ -x "batch_$cc" ]; then
		echo "$cc: the program does not link" >"$id.wrong"
		return
	fi
	status=99
	[ ! -s "$id.ended" ] || read -r status <"$id.ended"
	if [ "$status" -ne 0 ]; then
		{
			if [ "$status" -gt 1 ]; then
				said=$(grep -m 2 -e ERROR -e 'runtime error' "$id.err" | tr '\n' ' ')
				echo "$cc: ends with status $status: $said"
			fi
			head -n 6 "$id.ran"
		} >"$id.wrong"
	fi
}

batch_coarse() {
	grep -q 'against CVODE' "$1.wrong" && grep -q '^# class: \(smooth\|linear\)$' "$2" || return
	facts_of "$1"
	[ "$order" -gt 0 ]
}
