#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# functions.sh OUTPUT plrt.h COMPILER...: rows of a table, name and address, of the functions that the header declares.
set -eu
output=$1 header=$2
shift 2
"$@" -E -P "$header" |
	sed -n -e '/inline\|__attribute__/d' \
		-e 's/^[a-z][a-z0-9_ ]*[ *]\(pl_[a-z_]*\)(.*/{ "\1", (const void *)\1 },/p' >"$output"
