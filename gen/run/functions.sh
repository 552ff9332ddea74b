#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# functions.sh OUTPUT plrt.h: rows of a table, name and address, of the functions that the header declares.
set -eu
sed -n '/inline\|__attribute__/!s/^[a-z][a-z0-9_ ]*[ *]\(pl_[a-z_]*\)(.*/{ "\1", (const void *)\1 },/p' "$2" >"$1"
