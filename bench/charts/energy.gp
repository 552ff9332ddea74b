# SPDX-License-Identifier: GPL-3.0-or-later
# energy.gp energy.csv OUTDIR: energy_double, energy_float, energy_float_short, momentum_double, momentum_float
here = system("dirname '".ARG0."'"); csv = ARG1; out = ARG2
load here.'/style.gp'
set xlabel 'steps taken'
set xrange [1:*]
source = "Layout deduced, parameters chosen: the source's did not survive. "
flags = "gcc -O2 for all, no -march=native, no -ffast-math."
set label 2 "Largest of the changes met so far at five numbers of steps a decade; what never changed is in the ".\
	"table alone." at screen 0.01,0.05 left font ',9' textcolor rgb '#505050'
eval note." source.flags"

set ylabel 'largest change of energy so far, relative to the start'
set yrange [1e-17:10]
name = 'energy_double'
set title "scs, undamped, h = 0.01 s, double: energy that is lost or won"
load series(csv, "-v where='case=undamped;real=double;step_s=0.01' -v x=steps -v y=largest")
eval "plot ".clauses
eval write

set yrange [1e-9:10]
name = 'energy_float'
set title "scs, undamped, h = 0.01 s, float: energy that is lost or won"
load series(csv, "-v where='case=undamped;real=float;step_s=0.01' -v x=steps -v y=largest")
eval "plot ".clauses
eval write

name = 'energy_float_short'
set title "scs, undamped, h = 0.0001 s, float: energy that is lost or won"
load series(csv, "-v where='case=undamped;real=float;step_s=0.0001' -v x=steps -v y=largest")
eval "plot ".clauses
eval write

set ylabel 'largest change of momentum so far, relative to the start'
eval note." 'Parameters chosen: 1 and 2 kg, 100 N/m, v_1(0) = 1 m/s. '.flags"
set yrange [1e-17:10]
name = 'momentum_double'
set title "two free masses joined by a spring, h = 0.01 s, double: momentum"
load series(csv, "-v where='case=moving;real=double' -v x=steps -v y=largest")
eval "plot ".clauses
eval write

set yrange [1e-9:10]
name = 'momentum_float'
set title "two free masses joined by a spring, h = 0.01 s, float: momentum"
load series(csv, "-v where='case=moving;real=float' -v x=steps -v y=largest")
eval "plot ".clauses
eval write
