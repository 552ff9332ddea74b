#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# sensitivities.sh BUILD [MODEL...]: what derivatives of 10 s of motion cost at errors of 1e-4, 1e-6, 1e-8 and 1e-10 of
# the largest: thousands of instructions by valgrind's callgrind, of plgen's taylor by tolerance and of CVODES, forwards
# and backwards; in BUILD/bench sensitivities.csv and sensitivities.svg, with all errors. The truth is plgen's at 1e-15;
# how far CVODES at its smallest error agrees with it is printed.
set -e
build=$(realpath "$1")
shift
[ $# -gt 0 ] || set -- duffing pendulum springs impacts mechanism
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
mkdir -p "$build/bench"
csv=$build/bench/sensitivities.csv
echo model,method,family,error,thousand_instructions >"$csv"

# described MODEL: params as `k = 1, c = 0.2` in by; coordinates and starts in coords, init; the equations
described() {
	gap= restitution=
	case $1 in
	impacts)
		by='k3 = 1, c = 0.2, F = 2' coords=x init='x = 0.1' gap=0.5 restitution=0.8
		equations="x'' + c*x' + x + k3*x^3 = F*cos(1.4*t)" ;;
	duffing)
		by='k3 = 1, c = 0.2, F = 0.5' coords=x init='x = 1'
		equations="x'' + c*x' + x + k3*x^3 = F*cos(1.4*t)" ;;
	pendulum)
		by='g = 9.81, c = 0.1' coords=q init='q = 1'
		equations="q'' + c*q' + g*sin(q) = 0" ;;
	springs)
		by='k = 10, k3 = 50, c = 0.1' coords='q[8]' init='q = [0.3; 0; 0; 0; 0; 0; 0; 0]' equations=
		for i in 1 2 3 4 5 6 7 8; do
			left="q[$i]" right="-q[$i]"
			[ $i = 1 ] || left="(q[$i] - q[$((i - 1))])"
			[ $i = 8 ] || right="(q[$((i + 1))] - q[$i])"
			equations="$equations
q[$i]'' + c*q[$i]' + k*$left + k3*$left^3 - k*$right - k3*$right^3 = 0"
		done ;;
	mechanism)              # a double pendulum, solved for both accelerations
		by='g = 9.81, r = 1, l = 1' coords='a, b' init='a = 1, b = 0.5'
		equations="a'' = (-g*(2 + r)*sin(a) - r*g*sin(a - 2*b) - 2*sin(a - b)*r*(b'^2*l + a'^2*l*cos(a - b))) \
/(l*(2 + r - r*cos(2*a - 2*b)))
b'' = 2*sin(a - b)*(a'^2*l*(1 + r) + g*(1 + r)*cos(a) + b'^2*l*r*cos(a - b))/(l*(2 + r - r*cos(2*a - 2*b)))" ;;
	esac
}

# count COMMAND...: its derivatives in `found`, its instructions in `count`
count() {
	found=$(valgrind --tool=callgrind --callgrind-out-file=/dev/null --toggle-collect=measured "$@" 2>"$work/log")
	count=$(sed -n 's/.*Collected : //p' "$work/log")
	echo "$found" | awk -v count="$count" 'NR == FNR { split($0, a, " "); next }
		{ for (i = 1; i <= NF; i++) { d = $i - a[i]; d = d < 0 ? -d : d; s = a[i] < 0 ? -a[i] : a[i]
		      e = d > e ? d : e; size = s > size ? s : size }
		  print e/size, count }' "$work/truth" -
}

# points METHOD: lines ERROR COUNT to the instructions at the four errors
points() {
	awk -v method="$1" '{ e[NR] = $1 > 0 ? log($1) : -99; c[NR] = log($2); least = e[NR] < least ? e[NR] : least }
		END { printf "%-16s", method
		      for (k = 4; k <= 10; k += 2) { want = -k*log(10); best = e[1] <= want ? c[1] : ""
		          for (i = 1; i < NR; i++) if (e[i] > want && e[i + 1] <= want)
		              best = c[i] + (c[i + 1] - c[i])*(e[i] - want)/(e[i] - e[i + 1])
		          if (best == "") printf " %7s", "-"; else printf " %7d", exp(best)/1000 }
		      printf "   least error %.0e\n", exp(least) }'
}

# shown METHOD FAMILY: these, and all in the table
shown() {
	tee "$work/all" | points "  $1"
	awk -v head="$model,$1,$2" '{ printf "%s,%.3g,%.3g\n", head, $1, $2/1000 }' "$work/all" >>"$csv"
}

echo 'thousands of instructions at 1e-4, 1e-6, 1e-8, 1e-10; gcc -O2, peers -O3'
for model; do
	described "$model"
	names=$(echo "$by" | sed 's/ = [^,]*//g')
	printf '%s\n' 'model subject' "param $by" "coord $coords" "init $init" 'step 0.1' "$equations" \
		>"$work/subject.spec"
	[ -z "$gap" ] || echo "stop between $coords, ground at $gap restitution $restitution" >>"$work/subject.spec"
	printf '%s\n' 'model peer' "coord $coords, $names" "init $init, $by" 'step 0.1' "$equations" \
		>"$work/peer.spec"
	echo "$names" | tr -d , | tr ' ' '\n' | sed "s/\$/'' = 0/" >>"$work/peer.spec"
	sh bench/charts/equations.sh "$build/plgen" "$work/equations.h" "$work/each.h" "$work/peer.spec"
	start=$(cd "$work" && "$build/plrun" peer.spec 0 2>/dev/null | tail -n 1 | cut -d , -f 2-)
	# shellcheck disable=SC2086
	gcc -std=gnu11 -O3 -w -I"$work" "-DSTART=$start" "-DPARAMS=$(echo "$names" | wc -w)" \
		${gap:+-DGAP=$gap -DRESTITUTION=$restitution} bench/sensitivities.c \
		-o "$work/peer" -lsundials_cvodes -lsundials_nvecserial -lm
	# ours TOLERANCE
	ours() {
		"$build/plgen" --prefix subject --scheme taylor --tolerance "$1" -o "$work/subject_pl.c" \
			--sensitivity "$(echo "$names" | tr -d ' ')" "$work/subject.spec" 2>/dev/null
		gcc -std=gnu11 -O2 -w -DOURS -Iruntime -I"$work" bench/sensitivities.c "$work/subject_pl.c" \
			"$build/libplrt.a" -lm -o "$work/ours"
	}
	ours 1e-15
	"$work/ours" forward >"$work/truth"
	echo "$model, by $names:"
	for e in 1e-2 1e-4 1e-6 1e-8 1e-10 1e-12; do
		ours $e
		for way in forward adjoint; do count "$work/ours" $way >>"$work/ours_$way"; done
	done
	for e in 1e-3 1e-4 1e-5 1e-6 1e-7 1e-8 1e-9 1e-10 1e-11 1e-12 1e-13; do
		for way in forward ${gap:-adjoint}; do
			[ "$way" = "$gap" ] || count "$work/peer" "$way" $e >>"$work/peer_$way"
		done
	done
	for way in forward adjoint; do
		shown "plgen $way" ours <"$work/ours_$way"
		[ ! -f "$work/peer_$way" ] || shown "CVODES $way" adaptive <"$work/peer_$way"
	done
	rm "$work"/ours_* "$work"/peer_*
done
sh bench/charts/picture.sh sensitivities "$build/bench" "$build/bench"
echo "$build/bench/sensitivities.svg"
