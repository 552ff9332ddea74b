#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# papers.sh [--quick] PLGEN FOLDER: the generated code that papers.c compares with what the four sources report, as
# FOLDER/papers_*.so. Run at the top of the source tree. --quick: the beam at h = 0.01 only.
set -e
beam_rates='10 100 1000 10000' fine_rates='100 1000'
if [ "$1" = --quick ]; then
	beam_rates=100 fine_rates=100
	shift
fi
plgen=$1 folder=$2
charts=$(dirname "$0")
mkdir -p "$folder"
jobs=$folder/papers.jobs
: >"$jobs"
make_later() { # NAME SPEC OPTIONS ...
	name=$1
	shift
	echo "$folder/papers_$name.so $*" >>"$jobs"
}

# 000: the coupled systems; 100 and 1000 steps a second
for system in scs sdcs sdcsf; do
	for scheme in pl exact; do
		for rate in 100 1000; do
			make_later "${system}_${scheme}_$rate" "models/$system.spec" --scheme $scheme --step 1/$rate
		done
	done
done
for k in 4000,40,2000 4000,40,4000 4000,400,4000 100,100,100; do
	set -- $(echo $k | tr , ' ')
	for scheme in pl exact; do
		make_later "k$1_$2_$3_$scheme" models/scs.spec --scheme $scheme -D k1=$1 -D k2=$2 -D k3=$3 --step 1/100
	done
done

# 001: precise integration
for scheme in nc2 nc3 dq4 bm3; do
	make_later linear2dof_${scheme}_5 models/linear2dof.spec --scheme $scheme --loads leftover --step 1/5
	for model in pendulum vanderpol quad2dof; do
		make_later ${model}_${scheme}_10 models/$model.spec --scheme $scheme --step 1/10
	done
	make_later quad2dof_${scheme}_2 models/quad2dof.spec --scheme $scheme --step 1/2
	for rate in 100 1000; do
		make_later vanderpol_stiff_${scheme}_$rate models/vanderpol_stiff.spec --scheme $scheme --step 1/$rate
	done
done

# 002: clearances; the same gears without one, for the cost of a step
for tenths in 8 10 12; do
	make_later gear1_$tenths models/gear1.spec -D eta=$tenths/10
done
make_later gear2 models/gear2.spec
for model in gear1 gear2; do
	sed -e 's/deadzone(\([a-z]\(\[1\]\)*\), -b, b)/\1/' models/$model.spec >"$folder/papers_${model}_plain.spec"
	make_later ${model}_plain "$folder/papers_${model}_plain.spec"
done

# 004: the rotating beam, by the speed at which the operator is taken
mkdir -p "$folder/beam"
cp models/beam/*.mtx "$folder/beam"
operator() { # MODEL SPEED: the spec, in $spec
	spec=$folder/papers_$1_A$2.spec
	sed -e "s/^operator.*/operator at w = $2/" "models/$1.spec" >"$spec"
}
for speed in 0 1 2 3 4 5 6; do
	operator beam4 $speed
	for rate in $beam_rates; do
		make_later beam4_A${speed}_etd1_$rate "$spec" --scheme etd1 --step 1/$rate
	done
done
operator beam4 4
make_later beam4_A4_etdrk4_10000 "$spec" --scheme etdrk4 --step 1/10000
for speed in 0 15; do
	operator beam15 $speed
	for scheme in etd1 etdrk2 etdrk4; do
		make_later beam15_A${speed}_${scheme}_100 "$spec" --scheme $scheme --step 1/100
	done
done
for scheme in etdrk2 etdrk4; do
	[ "$fine_rates" = 100 ] || make_later beam15_A15_${scheme}_1000 "$spec" --scheme $scheme --step 1/1000
	for rate in $fine_rates; do
		make_later beam15_left_${scheme}_$rate "$spec" --scheme $scheme --loads leftover --step 1/$rate
	done
done
make_later beam15_A15_etdrk4_10000 "$spec" --scheme etdrk4 --step 1/10000

xargs -P "${JOBS:-2}" -L 1 "$charts/variant.sh" "$plgen" <"$jobs"
