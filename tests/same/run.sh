# SPDX-License-Identifier: GPL-3.0-or-later
# shellcheck shell=sh
# Sourced by what runs the models of runs.list, with $root, the folder of the project.

# list_runs: a line each, SPEC [OPTION ...]
list_runs() {
	awk -F ' *; *' '!/^#/ { for (i = 2; i <= NF; i++) print $1 ($i == "-" ? "" : " " $i) }' \
		"$root/tests/same/runs.list"
}

. "$root/tests/cases.sh"

# emit PLGEN RUN: model.c and model.h of a line of list_runs, here; a PLGEN that has no --fast has its tables always
emit() {
	emit_spec=${2%% *}
	emit_options=${2#"$emit_spec"}
	case $emit_options in
		*--fast*) "$1" --help | grep -q -e --fast ||
			emit_options=${emit_options%%--fast*}${emit_options#*--fast} ;;
	esac
	rm -f model.c model.h
	emit_path=$(path_of "$emit_spec")
	eval "\"\$1\" --prefix made $emit_options -o model.c \"\$emit_path\""
}

# told_by OUT RUNTIME ARCHIVE COMPILER ...: OUT, a program that tells what the model here does
told_by() {
	tell_out=$1 tell_runtime=$2 tell_archive=$3
	shift 3
	tell_flags=$(awk '/const pl_modelf / { print "-DFLOAT" }
		/ made_batch\(/ { print "-DBATCH" }
		/MADE_INPUTS = [1-9]/ { print "-DHAS_INPUTS" }
		/ made_batch_use\(/ { print "-DOWN" }
		/ made_crossings\(/ { print "-DCROSSINGS" }
		/ made_rested\(/ { print "-DRESTED" }
		/ made_selftest\(/ { print "-DSELFTEST" }' model.h)
	# shellcheck disable=SC2086
	"$@" -w -I"$tell_runtime" -I. $tell_flags "$root/tests/same/tell.c" model.c "$tell_archive" -lm -o "$tell_out"
}
