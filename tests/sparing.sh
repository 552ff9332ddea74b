# SPDX-License-Identifier: GPL-3.0-or-later
# shellcheck shell=sh
# Sourced by tests that run command lines as a reader types them: the runtime's sources are most of what a compiler has
# to do there, and need not be compiled by every one of them.

# sparing COMPILER RUNTIME ARCHIVE [TYPED]: bin/COMPILER, which where it is given all sources of the folder RUNTIME
# takes the archive for them; the first time as it is typed, if TYPED, a file that is then made, is given
sparing() {
	real=$(command -v "$1") || return 0
	# a cache of compilers would look for the compiler in PATH, and find what is made here
	case $(readlink -f "$real") in
		*/ccache)
			without=$(echo "$PATH" | tr ':' '\n' | grep -v ccache | paste -s -d :)
			real=$(PATH=$without && command -v "$1") ;;
	esac
	sources=$(echo "$2"/*.c)
	cat >"bin/$1" <<END
#!/bin/sh
case "\$*" in
	*" $sources "*) [ -z "${4-}" ] || [ -e "${4-}" ] || { : >"${4-}"; exec "$real" "\$@"; } ;;
	*) exec "$real" "\$@" ;;
esac
for one; do
	shift
	case \$one in
		${sources%% *}) set -- "\$@" "$3" ;;
		$2/*.c) ;;
		*) set -- "\$@" "\$one" ;;
	esac
done
exec "$real" "\$@"
END
	chmod +x "bin/$1"
}
