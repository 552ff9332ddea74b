#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# What the pages tell a reader to type is typed: every block of every page, as TAP, each page in an empty folder that
# has but `runtime`, `models`, `tests`, `build/plgen` and `build/plrun`, as a clone has.
#
#     commands.sh PLGEN SOURCE_ROOT PLRUN RUNTIME_M4F.a
#
# The runtime's sources, most of the work of a compiler, are compiled before: PLRT, and the runtime for Cortex-M4F. `cc`
# is what run_cc.sh says, but with MERGE=1 in the environment: then all is compiled as typed, the runtime for the host
# the first time only.
#
# ```spec       a model: plgen makes NAME_pl.c and NAME_pl.h of it; elsewhere, of pages that are typed from their first
#               line on: what they need of it they have to make themselves
# ```sh         commands: run one after the other; all succeed, nothing they write is empty
# ```console    `$ command` and what it says, to the last letter
# ```c          statements, with the headers that they name: compiled with the models of the page, linked and run;
#               a block that begins with a comment `NAME.c` or `NAME.h` is that file, for the commands after it
#
# A picture in letters is named in `pictures`. Any other block fails.
set -u
plgen=$(realpath "$1")
root=$2
plrun=$(realpath "$3")
board=$(realpath "$4")
. "${0%/*}/../sparing.sh"
. "${0%/*}/../run_cc.sh"
. "${0%/*}/../tap.sh"
here=$root/tests/docs
warnings='-Wall -Wextra -Wpedantic -Werror'
# What a page draws, by its first line
pictures='doc/design.md:      gen/base      memory
doc/tutorial.md:      +------------+'

mkdir bin
ln -s "$plgen" bin/plgen
ln -s "$plrun" bin/plrun
XDG_CACHE_HOME=$work/cache
export XDG_CACHE_HOME
runtime_archive "$root/runtime"
cp "$archive" runtime.a || exit 99

ln -s "$root/runtime" runtime
if merging; then
	sparing cc runtime "$work/runtime.a" "$work/typed"
else
	mkdir quick
	# shellcheck disable=SC2016
	printf '#!/bin/sh\nexec %s "$@"\n' "$run_cc" >quick/cc
	chmod +x quick/cc
	PATH=$PWD/quick:$PATH
	sparing cc runtime "$work/runtime.a"
fi
sparing arm-none-eabi-gcc runtime "$board"
PATH=$PWD/bin:$PATH

# In the folder of the page, with PAGE, NUMBER and KIND of a block:

run_spec() {
	name=$(sed -n 's/^model \([A-Za-z0-9_]*\).*/\1/p' "$block")
	made=.
	case $page in README.md | doc/tutorial.md | doc/cookbook.md) made=../made ;; esac
	cp "$block" "$name.spec" && plgen -o "$made/${name}_pl.c" "$name.spec" >>../log 2>&1 &&
		[ -s "$made/${name}_pl.h" ]
}

run_sh() {
	sh -eu "$block" >../said 2>>../log || return 1
	find . -type f -size 0 | sed 's/$/ is empty/' >>../log
	for picture in ./*.svg; do
		[ ! -f "$picture" ] || grep -q '<path' "$picture" || echo "$picture has no lines" >>../log
	done
	[ ! -s ../log ]
}

run_console() {
	sed -n 's/^\$ //p' "$block" >../commands
	while IFS= read -r line; do
		printf '$ %s\n' "$line"
		sh -c "$line" 2>&1
	done <../commands >../said
	[ -s ../commands ] && diff "$block" ../said >>../log
}

run_c() {
	file=$(sed -n '1s,^/\* \([A-Za-z0-9_]*\.[ch]\)\([: ].*\)*$,\1,p' "$block")
	if [ -n "$file" ]; then
		cp "$block" "$file"
		return
	fi
	{
		grep '^#' "$block"
		echo 'int main(void)'
		echo '{'
		grep -v '^#' "$block"
		echo '}'
	} >program.c
	# shellcheck disable=SC2086
	${CC:-cc} -std=c99 $warnings -Iruntime program.c ./*_pl.c ../runtime.a -lm -o program >>../log 2>&1 &&
		./program >>../log 2>&1
}

# absent FILE: a program that its commands name, and that is not installed
absent() {
	for program in arm-none-eabi-gcc qemu-system-arm; do
		if grep -q "^\(\$ \)*$program " "$1" && ! command -v "$program" >/dev/null; then
			echo "$program"
			return
		fi
	done
	return 1
}

# try PAGE NUMBER KIND LINE
try() {
	: >log
	block=$PWD/blocks/$2.$3
	case $3 in
		spec | sh | console | c) ;;
		text)
			echo "$pictures" | grep -qF -e "$1:$(sed 's/,.*//; q' "$block")"
			result $? "$1:$4: a picture"
			return ;;
		*)
			echo 'spec, sh, console and c are tried' >log
			result 1 "$1:$4: a block that is $3"
			return ;;
	esac
	title=$(grep -v -e '^#' -e '^$' "$block" | head -n 1 | sed 's,^/\* ,,; s, *[#/*].*,,' | cut -c 1-60)
	title="$1:$4: $3: $title"
	if program=$(absent "$block"); then
		skip "$title" "no $program"
		return
	fi
	(cd page && "run_$3")
	result $? "$title"
}

mkdir made

for page in README.md doc/tutorial.md doc/cookbook.md doc/running.md doc/spec.md doc/contacts.md doc/schemes.md \
	doc/api.md doc/accuracy.md doc/performance.md doc/firmware.md doc/design.md; do
	rm -rf page blocks
	mkdir -p page/build blocks
	ln -s "$root/runtime" "$root/models" "$root/tests" page
	ln -s "$plgen" page/build/plgen
	ln -s "$plrun" page/build/plrun
	awk -v folder=blocks -f "$here/blocks.awk" "$root/$page" >found || exit 99
	while read -r number kind line; do
		try "$page" "$number" "$kind" "$line"
	done <found
done

# Of options --help and the man page name the same ones; `--raw` is of plmain.
options_in() {
	grep -o -e '--*[a-zD][a-z]*' | grep -x -e '--[a-z]\{3,\}' -e '-[oD]' | sort -u
}
: >log
plgen --help | sed -n '/^  -/p' | cut -c 1-26 | options_in >asked
sed -n '/^\.SH OPTIONS/,/^\.SH GENERATED/{/^\.B/{s/\\f.//g;s/\\//gp}}' "$root/doc/plgen.1" | options_in >man
diff asked man >>log
[ "$(wc -l <asked)" -gt 15 ] || cat asked >>log
[ ! -s log ]
result $? "$(wc -l <asked) options: --help and doc/plgen.1 have the same"

# Words of the reference: statements, functions and schemes of the reader, bits of the runtime
# as_code PAGE: what stands in that page as code; named PAGE: which of `words` does not stand in `written`
as_code() {
	awk '/^```/ { block = !block; next }
		block { print; next }
		{ for (; match($0, /`[^`]*`/); $0 = substr($0, RSTART + RLENGTH))
			print substr($0, RSTART, RLENGTH) }' "$root/doc/$1" | sed 's/#.*//'
}
named() {
	tr -c 'A-Za-z0-9_' '\n' <written | sort -u >there
	sort -u words | comm -23 - there | sed "s,\$, is not in doc/$1," >>log
	[ "$(wc -l <words)" -gt "$2" ] || cat words >>log
}
: >log
grep -o '{ "[a-z]*", read_' "$root/gen/read/parse.c" | cut -d '"' -f 2 >words
sed -n '/^## Statements/,/^## Expressions/s/^| \(`.*`\) | .*/\1/p' "$root/doc/spec.md" >written
named spec.md 20
{
	grep -o '"[a-z0-9]*"' "$root/gen/read/names.c" | tr -d '"' | sed -n '/^atan2$/,/^friction$/p'
	sed -n 's/^REAL_FUNCTION([A-Z0-9]*, \([a-z0-9]*\),.*/\1/p' "$root/gen/read/functions.def"
	sed -n 's/^SCHEME(.*\.name = "\([a-z0-9]*\)".*/\1/p' "$root/gen/read/schemes.def"
} >words
{ as_code spec.md; as_code schemes.md; } >written
named spec.md 30
sed -n '/^enum {$/,/^}/s/^ *\(PL_[A-Z_]*\) = [0-9].*/\1/p' "$root/runtime/plrt.h" >words
as_code api.md >written
named api.md 9
[ ! -s log ]
result $? 'every statement, function and scheme is in doc/spec.md, every bit of a status in doc/api.md'
: >log
plrun --help | sed -n '/^  /p' | options_in | grep -v -e '^--help$' -e '^--version$' >asked
sed -n '/^\.SH OPTIONS/,/^\.SH ENVIRON/{/^\.B/{s/\\f.//g;s/\\//gp}}' "$root/doc/plrun.1" | options_in |
	grep -v -e '^--help$' -e '^--version$' >man
diff asked man >>log && [ "$(wc -l <asked)" -gt 15 ]
result $? "$(wc -l <asked) options of plrun: --help and doc/plrun.1 have the same"
tap_end
