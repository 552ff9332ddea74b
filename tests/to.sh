#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# to.sh FILE COMMAND ...: what the command says becomes FILE. Meson's `capture` starts a Python for it, which takes ten
# times as long as most of these commands.
file=$1
shift
exec "$@" >"$file"
