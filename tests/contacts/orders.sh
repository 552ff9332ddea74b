#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# orders.sh PLGEN SOURCE [FIRST EVERY]: scheme taylor of orders 4, 6 and 8 on the models of orders.cases (each EVERY-th
# of them from FIRST on, counted from 0), with stops, friction and impacts beside curves, beside order 24 at 600 steps a
# second. Errors (orders.c) of some 16 steps, h to 2.5 h, tell the order (orders.awk); one run before tells at which h
# they come down to what is still well above rounding. From 24 starts, with MERGE=1 or LONG=1 in the environment 48.
# TABLE=1: a row for doc/accuracy.md. $CC compiles, $PLRT is the runtime.
root=$2
first=${3:-0}
every=${4:-1}
. "${0%/*}/../plgen.sh"
starts=
merging || starts=-DSTARTS=24
seconds=6

# add ORDER STEPS: a variant of $spec
add() {
	v=v$1_$2
	"$plgen" --scheme "taylor $1" --step "$seconds/$2" --prefix "$v" "$spec" -o "$v.c" >>log 2>&1 || return 1
	cat >>variants.h <<-END
		#include "$v.c"
		static void begin_${v}(void *s) { ${v}_init(s); }
		static void go_${v}(void *s) { ${v}_step(s); }
		static void put_${v}(void *s, double t, const double *y) { ${v}_set(s, t, y); }
		static void give_${v}(const void *s, double *y) { ${v}_get(s, y); }
		static unsigned long events_${v}(const void *s) { return (unsigned long)${v}_crossed(s); }
		static int state_${v}(const void *s) { return ${v}_status(s); }
	END
	states=$(echo "$v" | tr v V)_STATES
	echo "{ $1, $2, sizeof($v), $states," \
		"begin_${v}, put_${v}, go_${v}, give_${v}, events_${v}, state_${v} }," >>rows
}

# errors: of what stands on standard input, ORDER STEPS a line, on standard output
errors() {
	: >rows
	echo >variants.h
	add 24 $((seconds * 600)) || return 1
	while read -r p n; do
		add "$p" "$n" || return 1
	done
	cat >>variants.h <<-END
		enum { SECONDS = $seconds };
		static const struct variant {
			int order, steps;
			size_t size;
			int states;
			void (*init)(void *), (*set)(void *, double, const double *), (*step)(void *);
			void (*get)(const void *, double *);
			unsigned long (*crossed)(const void *);
			int (*status)(const void *);
		} variant[] = {
		$(cat rows)
		};
	END
	$run_cc $starts -I. -I"$root/runtime" -o errors "$root/tests/contacts/orders.c" "$archive" -lm \
		>>log 2>&1 || return 1
	./errors
}

# order NAME: of the model $spec
order() {
	: >log
	printf '%s\n' '4 480' '6 240' '8 120' | errors >once || { result 1 "$1: made"; return; }
	# the finest h has the error 1e-10, 1e-12, 5e-14: the steps are multiples of the seconds
	awk -v t=$seconds '{
		aim = $1 == 4 ? 1e-10 : $1 == 6 ? 1e-12 : 5e-14
		most = $2*exp(log($3/aim)/$1)
		last = 0
		for (i = 15; i >= 0; i--) {
			n = t*int(most*exp(-i*log(2.5)/15)/t)
			if (n > last)
				print $1, n
			last = n
		}
	}' once |
		errors >found || { result 1 "$1: made"; return; }
	row="| \`$1\` | $(awk 'NR == 1 { print $4 }' once)"
	for p in 4 6 8; do
		grep "^$p " found >log
		awk -v p="$p" -f "$root/tests/contacts/orders.awk" log >slope
		read -r slope good <slope
		[ "$good" = yes ]
		result $? "$1: order $p, measured $slope"
		row="$row | $slope"
	done
	[ -z "${TABLE:-}" ] || echo "$row |"
}

at=$((every - first))
awk -f "$root/tests/cases.awk" "$root/tests/contacts/orders.cases" >names
for name in $(cat names); do
	spec=$name.spec
	[ $((at % every)) -ne 0 ] || ! chosen "$name" || order "$name"
	at=$((at + 1))
done
tap_end
