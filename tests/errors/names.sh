#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
#
# names.sh PLGEN RUNTIME COMPILER...: no model may bear a name that gives it a function, type or macro of the C library.
# What generated code names after a model is read from models of every kind, and what the library has from its headers;
# so a new suffix is looked at too.
set -u
plgen=$(realpath "$1")
runtime=$(realpath "$2")
shift 2
LC_ALL=C
export LC_ALL
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
cd "$work" || exit 1
failed=0

result()        # NUMBER NAME: good if the file `wrong` is empty
{
	if [ -s wrong ]; then
		failed=1
		echo "not ok $1 - $2"
		head -n 40 wrong | sed 's/^/# /'
	else
		echo "ok $1 - $2"
	fi
}

echo 1..4

# ---- suffixes: after qqq_ and QQQ_ in the text of each kind of model ----

model()         # NAME OPTIONS: its text on standard input
{
	cat > "$1.spec"
	# shellcheck disable=SC2086
	"$plgen" $2 -o "$1.c" "$1.spec" 2> log || { cat log >> wrong; return; }
	cat "$1.c" "$1.h" >> text
}
: > wrong
printf "model qqq\ncoord x\ninput u\nx'' + x + 0.1*x' = u + t*exp(-t)*cos(t)\nstep 0.1\n" | model inputs '--rhs'
printf "model qqq\ncoord x\nx'' + x = t < 3 ? cos(t) : 1\nstep 0.1\n" | model changes '--rhs --selftest'
printf "model qqq\ncoord x\nx'' + x + x^3 = cos(t)\noperator at x = 0, 1\nstep 0.1\n" | model operator --rhs
printf "model qqq\ncoord x\nx'' + x + x^3 = cos(t)\nstep 0.1\n" | model nodes '--scheme nc3'
printf "model qqq\ncoord x\ninput u\nx'' + x + max(x - 1, 0) = u\nstep 0.1\n" | model regions ''
printf "model qqq\nparam k = 1\ntunable k\ncoord x\nx'' + k*x = cos(t)\noutput o = k*x\nstep 0.1\n" |
	model tunable '--rhs'
grep -o -E '\b(qqq|QQQ)_[A-Za-z_0-9]+' text | sed 's/^...//' | sort -u > suffixes
[ "$(wc -l < suffixes)" -ge 40 ] || echo "only $(wc -l < suffixes) suffixes were found" >> wrong
result 1 "models of every kind: $(wc -l < suffixes) suffixes"

# ---- the library: identifiers of the headers that are here ----

: > headers.c
for header in aio complex ctype dirent dlfcn errno fcntl fenv float fnmatch ftw glob iconv inttypes langinfo limits \
	locale math mqueue netdb poll pthread pwd regex sched search semaphore setjmp signal spawn stdarg stdatomic \
		stddef \
	stdint stdio stdlib string strings sys/mman sys/resource sys/select sys/sem sys/socket sys/stat sys/time \
		sys/types \
	sys/wait syslog termios threads time uchar unistd wchar wctype fts obstack envz sys/inotify sys/epoll; do
	printf '#if __has_include(<%s.h>)\n#include <%s.h>\n#endif\n' "$header" "$header" >> headers.c
done
{ "$@" -D_GNU_SOURCE -std=gnu11 -E -P headers.c; "$@" -D_GNU_SOURCE -std=gnu11 -E -dM headers.c; } 2> log |
	grep -o -E '\b[A-Za-z][A-Za-z0-9_]*\b' | sort -u > identifiers
: > wrong
awk 'NR == FNR { suffix[$1]; next }
{
	for (n = 2; n <= length($1); n++)
		if (substr($1, n) in suffix) print tolower(substr($1, 1, n - 1)), $1
}
' suffixes identifiers | sort -u > met
[ -s met ] || echo 'no identifier of the library ends as generated ones do' > wrong
while read -r name meets; do
	case $name in [!a-z]*) continue ;; esac
	"$plgen" --prefix "$name" inputs.spec > out 2> log &&
		echo "a model may be called $name, which meets $meets" >> wrong
done < met
result 2 "$(wc -l < met) identifiers of the library that end as generated ones do"

# ---- names of the library as names of models and of coordinates ----

: > wrong
for name in sinf cosl FILE strdup signgam errno stdin EOF NAN FP_NAN HUGE_VAL math_errhandling complex requires \
	concept co_await consteval char8_t pid_t \
	sem mtx cnd tss fts aio pthread_attr strlcpy sigaction mkdir getline; do
	"$plgen" --prefix "$name" inputs.spec > out 2> log && echo "a model may be called $name" >> wrong
done
result 3 'names that no model may have'

: > wrong
: > all.c               # all of them, which is compiled in the time of one
for name in sinf FILE strdup signgam errno stdin stdout EOF NAN FP_NAN HUGE_VAL math_errhandling complex imaginary I \
	assert index time y0 gamma NULL DOMAIN; do
	{
		printf "model with_%s\ncoord %s, other\ninput NAN_\nparam INFINITY_ = 1\n" "$name" "$name"
		printf "%s'' + sin(%s)*other = NAN_\nother'' + INFINITY_*other = 0\n" "$name" "$name"
		printf "output o = sqrt(%s)\nstep 0.1\n" "$name"
	} > name.spec
	"$plgen" --rhs name.spec > "with_$name.c" 2> log || { grep -q 'reserved\|is kept' log ||
		head -n 2 log >> wrong; continue; }
	echo "#include \"with_$name.c\"" >> all.c
done
[ "$(wc -l < all.c)" -ge 10 ] || echo "only $(wc -l < all.c) may be coordinates" >> wrong
for flags in -std=c99 -std=gnu11 '-x c++ -std=c++20'; do
	# shellcheck disable=SC2086
	"$@" -Wall -Wextra -Wshadow -Werror $flags -I"$runtime" -fsyntax-only all.c > log 2>&1 ||
		echo "coordinates, $flags: $(grep -m 1 error: log)" >> wrong
done
result 4 'names of the library as coordinates'
[ "$failed" -eq 0 ]
