#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
#
# fuzz.sh PLGEN MUTATE FIRST COUNT GOOD CASES: COUNT mutated specs from FIRST on, STRIDE in the environment apart,
# through PLGEN (built with sanitizers), as TAP, one line for each hundred. They are made from the specs in the folder
# GOOD (drawn more often) and those of the cases of ../errors that are no longer than people write them. What fails is
# kept if KEEP names a folder. With CHECK_C (a compiler and its options) the C is compiled as well. Every finding
# belongs into ../errors as a case of its own.
set -u
plgen=$1
mutate=$2
first=$3
stride=${STRIDE:-1}
past=$(($3 + $4 * stride))
good=$5
cases=$6
block=100
LC_ALL=C
ASAN_OPTIONS=malloc_context_size=0:quarantine_size_mb=16:${ASAN_OPTIONS:-}
ASAN_OPTIONS=exitcode=99:hard_rss_limit_mb=2048:allocator_may_return_null=1:$ASAN_OPTIONS
UBSAN_OPTIONS=print_stacktrace=1:exitcode=99:${UBSAN_OPTIONS:-}
export LC_ALL ASAN_OPTIONS UBSAN_OPTIONS
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM

if ! command -v timeout > "$work/path" 2>&1; then
	echo '1..0 # SKIP no timeout command'
	exit 0
fi
bad=$work/bad
mkdir "$bad" && "$cases" --write "$bad" && find "$bad" -name '*.spec' -size +20k -exec rm '{}' + || exit 1
echo "1..$((($4 + block - 1) / block))"

check()         # STATUS: prints what is wrong
{
	case $1 in
	0) [ -s "$work/out" ] || echo 'status 0 without output' ;;
	1) [ -s "$work/out" ] && echo 'output with status 1'
	   grep -q ': error: ' "$work/err" || echo 'status 1 without a message' ;;
	2) [ -s "$work/out" ] && echo 'output with status 2'
	   grep -q '^plgen: error: ' "$work/err" || echo 'status 2 without a message' ;;
	124) echo 'takes over 600 s' ;;
	*) echo "exit status $1" ;;
	esac
	grep -q 'Sanitizer\|runtime error' "$work/err" && echo 'the sanitizer complains'
	grep -q 'inf\.0\|nan\.0' "$work/out" && echo 'a number that is none in the output'
	if [ "$1" -eq 0 ] && [ "$printed" = C ] && [ -n "${CHECK_C:-}" ]; then
		cp "$work/out" "$work/out.c"
		$CHECK_C -c "$work/out.c" -o "$work/out.o" > "$work/cc" 2>&1 || echo 'the C does not compile'
	fi
}

options()       # SEED: sets the arguments, printed
{
	printed=C
	scheme=$(echo etd1 etdrk2 etdrk4 nc2 nc3 dq4 bm3 exact | cut -d ' ' -f $(($1 / 17 % 8 + 1)))
	case $(($1 % 17)) in
	0) set -- --explain=json; printed=json ;;
	1) set -- --solution 0.05; printed=csv ;;
	2) set -- --scheme pl ;;
	3) set -- --rhs ;;
	4) set -- --step 0.01 --rhs ;;
	5) set -- --explain; printed=text ;;
	6) set -- --reduce ;;
	7) set -- --reduce --explain=json; printed=json ;;
	8) set -- --reduce --solution 0.03; printed=csv ;;
	9) set -- --loads remainder ;;
	10) set -- --scheme "$scheme" ;;
	11) set -- --scheme "$scheme" --rhs --loads remainder ;;
	12) set -- --scheme "$scheme" --explain=json --loads remainder; printed=json ;;
	13) set -- --scheme "$scheme" --explain; printed=text ;;
	*) set -- ;;
	esac
	arguments=$*
}

for data in "$bad"/*/*/*.mtx "$good"/*/*.mtx; do    # beside the spec, as the specs name them
	if [ -f "$data" ]; then
		folder=$work/$(basename "$(dirname "$data")")
		case $data in "$bad"/*) folder=$work ;; esac
		mkdir -p "$folder"
		cp "$data" "$folder"
	fi
done
seed=$first
number=0
broken=0
while [ "$seed" -lt "$past" ]; do
	number=$((number + 1))
	end=$((seed + block * stride))
	[ "$end" -gt "$past" ] && end=$past
	from=$seed
	failed=0
	: > "$work/complaints"
	while [ "$seed" -lt "$end" ]; do
		"$mutate" "$seed" "$good"/*.spec -- "$bad"/*/*/*.spec > "$work/in.spec" || exit 1
		options "$seed"
		timeout 600 "$plgen" $arguments "$work/in.spec" > "$work/out" 2> "$work/err" < /dev/null
		why=$(check $?)
		if [ -n "$why" ]; then
			failed=$((failed + 1))
			{
				echo "seed $seed, options '$arguments': $why"
				grep -v '^==[0-9]*==$' "$work/err" | head -n 6
				[ -s "$work/cc" ] && head -n 3 "$work/cc"
			} >> "$work/complaints"
			[ -n "${KEEP:-}" ] && cp "$work/in.spec" "$KEEP/$seed.spec"
		fi
		: > "$work/cc"
		seed=$((seed + stride))
	done
	if [ "$failed" -eq 0 ]; then
		echo "ok $number - seeds $from to $((end - 1))"
	else
		broken=$((broken + 1))
		echo "not ok $number - seeds $from to $((end - 1)): $failed failed"
		head -n 60 "$work/complaints" | cut -c 1-200 | tr '\000-\010\013-\037\177-\377' '?' | sed 's/^/# /'
	fi
done
[ "$broken" -eq 0 ]
