#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Models of some modes: against sums over modes in closed form (closed.c), and against the whole model (whole.c).
#
#     modes.sh PLGEN SOURCE_ROOT DROPPED
root=$2
dropped=$(realpath "$3")
. "${0%/*}/../plgen.sh"
here=$root/tests/modes
cp "$here"/*.spec "$here"/*.mtx .
cp -r "$root/models/beam" .

# made PREFIX OPTION ... SPEC
made() {
	prefix=$1
	shift
	"$plgen" --prefix "$prefix" -o "$prefix.c" "$@" &&
		$compiler -I"$root/runtime" -c "$prefix.c" -o "$prefix.o"
}

# compiled PROGRAM FLAGS AND FILES ...
compiled() {
	program=$1
	shift
	$compiler -I"$root/runtime" -I"$root/tests/emitted" -I. "$@" -lm -o "$program"
}

# closed NAME MODES KEPT FLAGS
closed() {
	{
		made m --modes "$2" "$1.spec" &&
			compiled m -DKEPT="$3" $4 "$here/closed.c" m.o "$archive" && ./m
	} >log 2>&1
	result $? "$1, modes $2: closed form"
}

compiler="${CC:-cc} -std=c99 -O0"       # tcc has no complex numbers
closed chain 6 63 ''
closed chain '1, 2, 3' 7 ''
closed chain '1, 2, 3 without static' 7 -DWITHOUT
closed chain '2, 6' 34 ''
closed chain '5,' 16 ''
closed blocks 4 15 -DBLOCKS
closed blocks '1, 2' 3 -DBLOCKS
closed blocks '3, 4 without static' 12 '-DBLOCKS -DWITHOUT'
closed blocks '2,' 2 -DBLOCKS

compiler=$run_cc
echo none >whole_is
# against NAME MODES FLAGS OPTION ...
against() {
	name=$1
	modes=$2
	flags=$3
	shift 3
	{
		lost=$("$plgen" --modes "$modes" --explain=json "$@" "$name.spec" |
			sed -n 's/null/HUGE_VAL/g; s/^  "lost": \[\(.*\)\],$/\1/p')
		# once for all modes
		[ "$(cat whole_is)" = "$name $*" ] ||
			{ made whole "$@" "$name.spec" && echo "$name $*" >whole_is; } || echo none >whole_is
		made part --modes "$modes" "$@" "$name.spec" &&
			compiled whole -DLOST="{$lost}" $flags "$here/whole.c" whole.o part.o $archive && ./whole
	} >log 2>&1
	result $? "$name, modes $modes${*:+, $*}: the whole model"
}

against chain 6 -DALL
against chain 2 -DSETTLES=100
against local_dampers 3 -DALL
against local_dampers 2 -DSETTLES=150
against local_dampers 1 -DSETTLES=150
against mixed 5 '-DALL -DINPUTS'
against mixed 4 -DINPUTS
against mixed 2 '-DINPUTS -DSETTLES=40'
against repeated 4 '-DALL -DINPUTS'
against repeated 2 '-DINPUTS -DSETTLES=250'
# loses NAME MODES FLAGS: modes_dropped, too
loses() {
	{
		"$dropped" "$1.spec" "$2" dropped >dropped.c && "$dropped" "$1.spec" "$2" dropped header >dropped.h &&
			$run_cc -I"$root/runtime" -c dropped.c -o dropped.o
	} >log 2>&1
	result $? "$1, modes $2: a model of what is lost"
	archive="dropped.o $whole_archive"
	against "$1" "$2" "-DDROPPED $3"
}

whole_archive=$archive
loses chain 3 ''
loses local_dampers 2 ''
loses mixed 2 -DINPUTS
loses beam 6 ''
archive=$whole_archive
for form in direct delta modal; do
	against chain 3 '' --form $form
done
tap_end
