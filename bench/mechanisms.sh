#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# mechanisms.sh BUILD [MODEL...]: what a second of motion of mechanisms costs at errors of 1e-6, 1e-9 and 1e-12 of the
# last state, relative to the larger of its value and 1: instructions by valgrind's callgrind, of plgen's taylor, DOP853
# and RADAU5 of the kept charts, and IDA. Peers have the best right-hand side that is known: NAME_rhs, which factors M
# by L D L^T, and solves for multipliers; of chains a recursion over the links.
# MODEL: a number of links, or the name of a file of models/; andrews: 0.03 s of it
set -e
build=$1
shift
[ $# -gt 0 ] || set -- cart_pole 2 3 5 10 four_bar slider_crank andrews
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
units=10

# A chain of point masses: the forces in its links are a tridiagonal system
cat >"$work/recursion.h" <<'EOT'
INLINE void rhs_double(double t, const double *y, double *f)
{
	enum { n = STATES / 2 };
	const double g = 9.81, *w = y + n;
	double s[n], c[n], T[n], B[n], d[n], x[n];
	(void)t;
	for (int i = 0; i < n; i++) {
		s[i] = sin(y[i]);
		c[i] = cos(y[i]);
		d[i] = i ? s[i - 1] * s[i] + c[i - 1] * c[i] : 0.0;
		x[i] = i ? c[i - 1] * s[i] - s[i - 1] * c[i] : 0.0;
	}
	B[0] = -1.0;
	T[0] = -w[0] * w[0] - g * c[0];
	for (int i = 1; i < n; i++) {
		const double factor = d[i] / B[i - 1];
		B[i] = -2.0 - factor * d[i];
		T[i] = -w[i] * w[i] - factor * T[i - 1];
	}
	T[n - 1] /= B[n - 1];
	for (int i = n - 2; i >= 0; i--)
		T[i] = (T[i] - d[i + 1] * T[i + 1]) / B[i];
	for (int i = 0; i < n; i++) {
		f[i] = w[i];
		f[n + i] = (i < n - 1 ? T[i + 1] * x[i + 1] : 0.0) - (i ? T[i - 1] * x[i] : g * s[i]);
	}
}
EOT

# count COMMAND...: its last state in `state`, its instructions in `count`
count() {
	state=$(valgrind --tool=callgrind --callgrind-out-file=/dev/null --toggle-collect=measured "$@" 2>"$work/log")
	count=$(sed -n 's/.*Collected : //p' "$work/log")
}

# points METHOD: lines ERROR COUNT to the instructions a second at the three errors
points() {
	awk -v method="$1" '{ e[NR] = $1 > 0 ? log($1) : -99; c[NR] = log($2) }
		END { printf "%s", method
		      for (k = 6; k <= 12; k += 3) { want = -k*log(10); best = e[1] <= want ? c[1] : ""
		          for (i = 1; i < NR; i++) if (e[i] > want && e[i + 1] <= want)
		              best = c[i] + (c[i + 1] - c[i])*(e[i] - want)/(e[i] - e[i + 1])
		          if (best == "") printf " -"; else printf " %d", exp(best)/1000 }
		      print "" }'
}

echo "thousands of instructions a second of motion at 1e-6, 1e-9, 1e-12, gcc -O2"
for model; do
	every=0.1
	case $model in
		andrews)
			every=0.003
			awk '/^===/ { on = $2 == "andrews" } /^---/ { on = 0 } on && !/^(===|tolerance|output)/' \
				tests/jury/testset.cases >"$work/m.spec"
			;;
		[0-9]*)
			first=$(seq -s '; ' 1 0.1 "$(awk -v n="$model" 'BEGIN { print 1 + (n - 1)/10 }')")
			sed -e "s/q\[10\]/q[$model]/; s/^init.*/init q = [$first]/; /^output/d" models/chain.spec \
				>"$work/m.spec"
			;;
		*) sed '/^output/d' "models/$model.spec" >"$work/m.spec" ;;
	esac
	"$build/plgen" --prefix subject --rhs --step $every --tolerance 1e-15 "$work/m.spec" >"$work/subject_pl.c" \
		2>/dev/null
	states=$(sed -n 's/^enum {.*SUBJECT_STATES = \([0-9]*\).*/\1/p' "$work/subject_pl.c")
	awk '/^void subject_rhs\(/ && !/;/ { on = 1 } on { print } on && /^}/ { exit }' "$work/subject_pl.c" |
		sed 's/^void subject_rhs(/INLINE void rhs_double(/' >"$work/rhs_double.h"
	case $model in [0-9]*) cp "$work/recursion.h" "$work/rhs_double.h" ;; esac
	: >"$work/rhs_long.h"
	# ours TOLERANCE
	ours() {
		"$build/plgen" --prefix subject --step $every --tolerance "$1" --scheme taylor -o "$work/subject_pl.c" \
			"$work/m.spec" 2>/dev/null
		gcc -std=gnu11 -w -DOURS "${2:--O2}" -Iruntime -I"$work" bench/mechanisms.c "$work/subject_pl.c" \
			"$build/libplrt.a" -lm -o "$work/ours"
	}
	ours 1e-15 -O0
	"$work/ours" $units taylor >"$work/truth"
	start=$("$work/ours" 0 taylor | tr ' ' ,)
	gcc -std=gnu11 -O2 -w -fcx-limited-range -Iruntime -Ibench/charts/own -I"$work" -DSTATES="$states" -DINPUTS=0 \
		-DSECOND_ORDER=1 -DEVERY=$every "-DSTART=$start" bench/mechanisms.c bench/charts/own/kept_dop853.c \
		bench/charts/own/kept_radau.c -o "$work/peers" -lsundials_ida -lsundials_nvecserial -lgsl -lgslcblas -lm
	# error: of the last state
	error() {
		echo "$state" | awk 'NR == FNR { n = split($0, a, " "); next }
			{ split($0, b, " ")
			  for (i = 1; i <= n; i++) { d = a[i] - b[i]; d = d < 0 ? -d : d
			      size = a[i] < 0 ? -a[i] : a[i]; d /= size > 1 ? size : 1; if (d > e) e = d }
			  print e + 0 }' "$work/truth" -
	}
	echo "$model:"
	for e in 1e-3 1e-5 1e-7 1e-9 1e-11 1e-13; do
		ours $e
		count "$work/ours" $units taylor
		echo "$(error) $count"
	done | points "  taylor"
	for method in dop853 radau5 ida; do
		for e in 1e-4 1e-5 1e-6 1e-7 1e-8 1e-9 1e-10 1e-11 1e-12 1e-13; do
			count "$work/peers" $units $method $e
			echo "$(error) $count"
		done | points "  $method"
	done
done
