# SPDX-License-Identifier: GPL-3.0-or-later
# gnuplot -c precision.gp precision.csv OUTDIR: for each model in the table its error against time, and against
# evaluations.
here = system("dirname '".ARG0."'"); csv = ARG1; out = ARG2
size = '1000,720'                       # room for some thirty methods in the legend
load here.'/style.gp'
set key font ',9' spacing 1.0

models = system("awk -F, 'NR > 1 && !($1 in seen) { seen[$1] = 1; printf \"%s \", $1 }' '".csv."'")
title_of(m) = \
	m eq 'pendulum' ? 'Pendulum from 60 degrees, g/l = 1 (chosen)' : \
	m eq 'vanderpol' ? 'Van der Pol, mu = 1, x(0) = 2 (chosen)' : \
	m eq 'vanderpol\_stiff' ? 'Van der Pol, stiff: mu = 100, x(0) = 2 (chosen)' : \
	m eq 'quad2dof' ? 'Two oscillators with quadratic coupling (Hénon and Heiles; equations deduced)' : \
	m eq 'duffing' ? 'Duffing under a cosine (parameters chosen)' : \
	m eq 'mathieu' ? 'Mathieu with damping, unstable (parameters chosen)' : \
	m eq 'henon\_heiles' ? 'Hénon and Heiles at an energy of 1/8 (start chosen)' : \
	m eq 'coupled\_vanderpol' ? 'Two coupled oscillators of van der Pol (values chosen)' : \
	m eq 'double\_pendulum' ? 'Double pendulum, g/l = 1 (start chosen)' : \
	m eq 'rayleigh' ? 'Rayleigh, x(0) = 1 (chosen)' : \
	m eq 'duffing\_pair' ? 'Two coupled Duffing oscillators, quadratic damping (values chosen)' : \
	m eq 'spherical\_pendulum' ? 'Spherical pendulum in two angles, g/l = 1 (start chosen)' : \
	m eq 'beam4' ? 'Rotating beam, 15 coordinates, spun up to 4 rad/s (matrices deduced)' : \
	m eq 'beam15' ? 'Rotating beam, 15 coordinates, spun up to 15 rad/s (matrices deduced)' : \
	m eq 'gear1' ? 'gear1: one pair of wheels with backlash' : \
	m eq 'gear2' ? 'gear2: two meshes, clearance in one' : \
	m eq 'gear3' ? 'gear3: three free wheels, clearance in both meshes' : \
	m eq 'scs' ? 'scs: two masses, coupled by a spring, undamped' : \
	m eq 'sdcs' ? 'sdcs: two masses, spring and damper coupling' : \
	m eq 'sdcsf' ? 'sdcsf: as sdcs, with a cosine force' : \
	m eq 'scs\_weak' ? 'scs\_weak: weakly coupled and fast (k = 4000, 40, 2000)' : \
	m eq 'linear2dof' ? 'linear2dof: Bathe and Wilson, from rest' : \
	m eq 'tuned\_floor' ? 'Floor with a tuned mass damper' : m
source_note(m) = strstrt(' gear1 gear2 gear3 ', ' '.m.' ') > 0 ? "Parameters chosen: the source's did not survive. " : \
	strstrt(' scs sdcs sdcsf scs_weak ', ' '.m.' ') > 0 ? \
	"Layout deduced, parameters chosen: the source's did not survive. " : ''
plain(m) = system("echo '".m."' | sed 's/_/\\\\_/g'")

set ylabel 'largest error over the history, relative to the largest value'
set yrange [1e-16:10]
do for [m in models] {
	last = system("awk -F, '$1 == \"".m."\" { print $(NF - 1), $NF; exit }' '".csv."'")
	set title title_of(plain(m)).', '.word(last, 2).' s'
	set label 1 source_note(m)."Displacements and velocities, at outputs and between; gcc -O2 for all, no ".\
		"-march=native or -ffast-math." \
		at screen 0.01,0.02 left font ',7.5' textcolor rgb '#505050'
	set label 2 "Filled, thick: plgen's. Open, thin: peers; dashed: fixed step, dotted: adaptive, dash-dot: ".\
		"propagators. Errors above 10, refused and failed runs: in the table." \
		at screen 0.01,0.05 left font ',7.5' textcolor rgb '#505050'
	set xlabel "CPU time per output, every ".word(last, 1)." s [µs], median"
	name = 'precision_'.m
	load series(csv, sprintf("-v 'where=model=%s' -v x=ns_median -v y=largest -v xfactor=1e-3", m))
	eval "plot ".clauses
	eval write
	set xlabel "evaluations of the right-hand side per output, every ".word(last, \
		1)." s (what needs none is left out)"
	name = 'evaluations_'.m
	load series(csv, sprintf("-v 'where=model=%s' -v x=evaluations_per_unit -v y=largest", m))
	eval "plot ".clauses
	eval write
}
