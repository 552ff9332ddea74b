#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# machine.sh BUILD COMMAND: on what the charts are measured, as CSV.
build=$1 command=$2
row() {
	printf '%s,"%s"\n' "$1" "$2"
}
echo what,value
row processor "$(sed -n 's/^model name[^:]*: *//p' /proc/cpuinfo | sed -n 1p), $(nproc --all) cores"
row system "$(uname -s) $(uname -r | sed 's/-.*//') $(uname -m)$(
	sed -n 's/^PRETTY_NAME="\(.*\)"/, \1/p' /etc/os-release 2>/dev/null)"
row compiler "$(${CC:-cc} --version | sed -n 1p)"
row flags '-O2 for all, generated code and peers alike; no -march=native, no -ffast-math'
sundials=$(awk '$2 == "SUNDIALS_VERSION" { gsub(/"/, "", $3); print $3 }' /usr/include/sundials/sundials_config.h \
	2>/dev/null)
row libraries "GSL $(gsl-config --version 2>/dev/null), SUNDIALS $sundials, $(gnuplot --version)"
row plgen "$("$build/plgen" --version)"
row command "$command"
