# SPDX-License-Identifier: GPL-3.0-or-later
# gnuplot -c headline.gp TABLES OUTDIR: the pictures of headline_integrators.csv, headline_equal_step.csv,
# headline_confluence.csv.
here = system("dirname '".ARG0."'"); folder = ARG1; out = ARG2
size = '900,940'
load here.'/style.gp'
small(n, y, text) = sprintf("set label %d \"%s\" at screen 0.01,%g left font ',8' textcolor rgb '#505050'", n, text, y)
flags = "gcc -O2 for all, no -march=native, no -ffast-math. Medians of whole histories taken in turns."
chosen = "Layout deduced, parameters chosen: the source's did not survive."

# ---- each integrator at the setting that reaches an error ----
csv = folder.'/headline_integrators.csv'
load "< awk -f '".here."/csv.awk' -f '".here."/headline.awk' '".csv."'"
name = 'headline_integrators'
set title "scs, 1000 s, output every 0.01 s: time for an output at equal error"
set xlabel 'CPU time per output [ns]'
unset ylabel
unset logscale y
set format y '%s'
set yrange [0.3:rows + 0.7] reverse
set xrange [1:1e5]
set grid noytics
set lmargin 25
set key inside top right box lc rgb '#c0c0c0' opaque spacing 1.2
eval small(1, 0.012, chosen." ".flags)
eval small(2, 0.035, "Largest error over the history, relative to the largest value. Beside a method that does not ".\
	"get there: the least error found, or what it would take by its order.")
eval "plot ".clauses
eval write
unset label
set key default
size = '1000,600'
load here.'/style.gp'
unset lmargin
set xrange [*:*]
set yrange [*:*] noreverse
set grid xtics ytics
set ytics autofreq

# ---- at equal step ----
csv = folder.'/headline_equal_step.csv'
set title "scs at equal step, 0.01 s: time and drift of the energy"
set xlabel 'CPU time per step with its output [ns], median'
set ylabel 'relative change of the energy after '.system("awk -F, '$1 == \"\\\"exact\\\"\" { print $7 }' ".\
	"'".csv."'").' steps'
set xrange [1:100]
set yrange [1e-16:1]
eval small(1, 0.012, chosen." ".flags)
eval small(2, 0.05, "Filled: plgen's. Open: a precomputed matrix exponential, and modal superposition.")
name = 'headline_drift'
load series(csv, "-v x=ns_median -v y=energy_drift_long -v abs=1 -v with=points")
eval "plot ".clauses
eval write
set title "scs at equal step, 0.01 s: time and error over the history"
set ylabel 'largest error over the history, relative to the largest value'
name = 'headline_equal_step'
load series(csv, "-v x=ns_median -v y=error -v with=points")
eval "plot ".clauses
eval write

# ---- where frequencies nearly meet ----
csv = folder.'/headline_confluence.csv'
set xlabel 'relative gap between the two frequencies'
set ylabel 'largest error over 100 s, relative to the largest value'
set xrange [3e-4:3e-13] reverse
set yrange [1e-17:10]
set xtics ('10^{-4}' 1e-4, '10^{-6}' 1e-6, '10^{-8}' 1e-8, '10^{-10}' 1e-10, '0' 1e-12)
set title "One mass drives the next and feels nothing of it: the two modes become one"
eval small(1, 0.02, "Frequencies 10 and 10 (1 + gap) rad/s, step 0.01 s (chosen). At gap 0 the matrix is defective: ".\
	"it has no second mode.")
name = 'headline_confluence'
load series(csv, "-v where=case=one-way -v x=gap -v y=error -v xzero=1e-12")
eval "plot ".clauses
eval write
set title "scs, its coupling spring nearly gone: two frequencies meet, the modes stay apart"
eval small(1, 0.02, "k2 = 100 gap N/m, k1 = k3 = 100 N/m, step 0.01 s (chosen). At gap 0 the masses no longer feel ".\
	"each other.")
name = 'headline_twins'
load series(csv, "-v where=case=twins -v x=gap -v y=error -v xzero=1e-12")
eval "plot ".clauses
eval write
