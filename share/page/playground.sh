#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# playground.sh BUILD: BUILD/playground.html, the generator in a page, for `make playground`. Its libraries are built
# from Debian's sources for wasm32-wasi, once, in BUILD/playground; a source archive that apt does not get can be put
# into BUILD/playground/src. What it takes: clang, lld, llvm, wasi-libc, libclang-rt-dev-wasm32.
# MIRROR chooses another Debian.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
build=$(cd "$1" && pwd)
place=$build/playground
target='--target=wasm32-wasi --sysroot=/ -isystem /usr/include/wasm32-wasi'
emulated='-D_WASI_EMULATED_SIGNAL -D_WASI_EMULATED_PROCESS_CLOCKS -D_WASI_EMULATED_MMAN'

# playground.sh BUILD FILE: one of the generator, by the script itself
if [ $# -gt 1 ]; then
	object=$place/gen/$(echo "$2" | tr / _).o
	case $2 in share/*) short=-O3 ;; *) short=-Os ;; esac   # the emulator is to be fast
	# shellcheck disable=SC2086
	exec clang $target -std=gnu11 $short -w -D_GNU_SOURCE $emulated -I"$place/shim" -I"$place/include" \
		-I"$place/gsl" -I"$place/tcc" -I"$root/gen" -I"$root/runtime" -I"$root" -I"$build/gen" \
		'-DPLGEN_DATA_FROM_BIN="x"' '-DPLGEN_RUNTIME="/"' '-Dflockfile=(void)' '-Dfunlockfile=(void)' \
		-c "$root/$2" -o "$object"
fi

for tool in clang wasm-ld llvm-ar gzip; do
	command -v $tool >/dev/null ||
		{ echo "playground: there is no $tool: Debian's clang, lld, llvm, gzip" >&2; exit 1; }
done
[ -f /usr/include/wasm32-wasi/stdio.h ] && ls /usr/lib/llvm-*/lib/clang/*/lib/wasi/*wasm32* >/dev/null 2>&1 ||
	{ echo 'playground: it takes Debian'"'"'s wasi-libc and libclang-rt-dev-wasm32' >&2; exit 1; }
mkdir -p "$place/src" "$place/gen" "$place/shim" "$place/include"

# ---- sources ----

archive() { ls "$place/src/$1"_*.orig.tar.* 2>/dev/null | head -n 1; }

# fetch SUITE: what is missing, by lists of its own
fetch() {
	lists=$place/apt/$1
	mkdir -p "$lists/partial"
	echo "deb-src ${MIRROR:-http://deb.debian.org/debian} $1 main" >"$place/apt/$1.list"
	options="-o Dir::Etc::sourcelist=$place/apt/$1.list -o Dir::Etc::sourceparts=/dev/null"
	options="$options -o Dir::State::lists=$lists"
	# shellcheck disable=SC2086
	apt-get -q $options update && cd "$place/src" && for name in $missing; do
		apt-get -q $options source --download-only "$name" || :     # its other files are not needed
	done
}

for suite in $(sed -n 's/^VERSION_CODENAME=//p' /etc/os-release) trixie; do
	missing=
	for name in gmp mpfr4 mpclib3 mpfi gsl tcc; do [ -n "$(archive $name)" ] || missing="$missing $name"; done
	[ -z "$missing" ] || fetch "$suite"
done
for name in gmp mpfr4 mpclib3 mpfi gsl tcc; do
	[ -d "$place/$name" ] && continue
	[ -n "$(archive $name)" ] || { echo "playground: no source of $name in $place/src" >&2; exit 1; }
	mkdir "$place/$name.new" && tar -C "$place/$name.new" -xf "$(archive $name)"
	inside=$(ls "$place/$name.new")
	[ -d "$place/$name.new/$inside" ] && mv "$place/$name.new/$inside" "$place/$name" && rmdir "$place/$name.new" ||
		mv "$place/$name.new" "$place/$name"
done

# ---- libraries ----

export CC="clang $target" CC_FOR_BUILD=cc CFLAGS="-O2 -w $emulated" AR=llvm-ar RANLIB=llvm-ranlib NM=llvm-nm
configured="./configure --host=wasm32-unknown-wasi --disable-shared --prefix=$place"

# once NAME COMMAND: in the folder NAME; what it says is in NAME.log
once() {
	[ -f "$place/$1.done" ] && return
	echo "playground: $1"
	(cd "$place/$1" && eval "$2") >"$place/$1.log" 2>&1 || { tail "$place/$1.log" >&2; exit 1; }
	touch "$place/$1.done"
}

# Limbs of 64 bits, as natively: the numbers of bits that a result has follow from them. Debian's archive has no doc.
once gmp 'mkdir -p doc; printf "all install install-am:\n\t@true\n" >doc/Makefile.in
	sed -i "s/^case \$limb_chosen in/limb_chosen=longlong\n&/" configure
	$configured --disable-assembly --disable-cxx && make && make install'
for name in mpfr4 mpclib3 gsl; do
	find "$place/$name" -name config.sub -exec cp "$place/gmp/configfsf.sub" {} \;
done
once mpfr4 '$configured --with-gmp=$place --disable-thread-safe && make -C src && make -C src install'
once mpclib3 '$configured --with-gmp=$place --with-mpfr=$place && make -C src && make -C src install
	cp src/mpc.h $place/include'
once mpfi 'cd src; cp *.h $place/include; echo "#define VERSION \"\"" | tee mpfi_config.h >config.h
	for file in *.c; do
		$CC $CFLAGS -I. -I$place/include -DHAVE_CONFIG_H -DHAVE_STDINT_H -include stdio.h -c $file || :
	done; llvm-ar rcs $place/lib/libmpfi.a *.o'
once gsl '$configured && make -C gsl && for part in err sys complex block vector matrix permutation cblas blas \
	linalg eigen poly ode-initval2 utils; do make -C $part || exit; done'

# A pointer that is loaded on the way to a real register goes through t0; one of the arguments may be in the other.
# A structure that is returned in two registers is copied first; else both get its first member.
once tcc 'sed -i "s|EI(0x03, 3, rr, br, fc); // ld RR, fc(BR)|EI(0x03, 3, is_freg(r) ? 5 : rr, br, fc);|
	s|^            br = rr;|            br = is_freg(r) ? 5 : rr;|" riscv64-gen.c &&
	sed -i "s/&& (align & (ret_align-1))) {/) {/" tccgen.c &&
	grep -q "br = is_freg" riscv64-gen.c && ! grep -q "align & (ret_align-1)" tccgen.c &&
	echo "#define TCC_VERSION \"\"" >config.h
	echo "typedef int pthread_t, pthread_attr_t;
		int pthread_attr_init(pthread_attr_t *), pthread_join(pthread_t, void **),
		pthread_attr_setstacksize(pthread_attr_t *, unsigned long),
		pthread_create(pthread_t *, const pthread_attr_t *, void *(*)(void *), void *);" >../shim/pthread.h
	echo "typedef int jmp_buf[1]; void longjmp(jmp_buf, int);
		#define setjmp(at) 0" >../shim/setjmp.h
	$CC -Os -w $emulated -I. -I../shim -DONE_SOURCE=1 -DTCC_TARGET_RISCV64 -D__riscv -D__LP64__ -DCONFIG_TCCBOOT \
		-DCONFIG_TCC_STATIC -c libtcc.c -o ../libtcc.o'

# ---- the generator; what starts programs is left out ----

cd "$root"
[ -z "$(find gen runtime "$build/gen" -name '*.h' -newer "$place/stamp" 2>&1)" ] || rm -f "$place"/gen/*.o
touch "$place/stamp"
echo 'playground: plgen'
for file in gen/*.c gen/*/*.c gen/*/*/*.c runtime/region.c runtime/dense.c share/page/playground.c; do
	case $file in gen/binary.c | gen/run/native.c | gen/run/symbols.c | gen/report/gnuplot.c) continue ;; esac
	[ "$place/gen/$(echo "$file" | tr / _).o" -nt "$file" ] || echo "$file"
done | xargs -r -P "$(nproc)" -n 1 sh "$0" "$build"
libraries=$(find "$place/gsl" -name 'libgsl*.a' | sort)
# shellcheck disable=SC2086
clang $target -L/usr/lib/wasm32-wasi "$place"/gen/*.o "$place/libtcc.o" -o "$place/plgen.wasm" -L"$place/lib" \
	-lmpfi -lmpc -lmpfr -lgmp $libraries -lm -lwasi-emulated-signal \
	-lwasi-emulated-mman -lwasi-emulated-process-clocks -lc-printscan-long-double -Wl,--export=call \
	-Wl,--export-table,--export=__stack_pointer,-z,stack-size=33554432 \
	-Wl,--stack-first,--strip-all,--allow-undefined

# ---- the page ----

sh gen/base/texts.sh "$place/texts.h" share/page/load.js share/page/playground.js share/page/page.css

# text NAME: of the list that texts.sh made, and the sum NAME of a list
text() {
	sed -n "/{ \"$1\",\$/,/^}/{/^\"/{s/^\"\(.*\)\"\$/\1/; s/\\\\n\$//; s/\\\\\(.\)/\1/g; p;};}" \
		"$place/texts.h"
}
sum() {
	sed -n "s/.*{ \"$1\", \"\([^\"]*\)\" }.*/'sha256-\1'/p" "$2"
}

# The models and the parts as JSON, by their names
models() {
	for file in models/*.spec models/beam/*.mtx share/parts/*.spec; do
		name=${file#models/}
		awk -v name="${name##*parts/}" -v first="${comma-}" '
			BEGIN { printf "%s\"%s\":\"", first, name }
			{ gsub(/\\/, "\\\\"); gsub(/"/, "\\\""); gsub(/\t/, "\\t"); gsub(/</, "\\u003c") }
			{ printf "%s\\n", $0 }
			END { printf "\"" }' "$file"
		comma=,
	done
}

{
	cat <<-END
	<!DOCTYPE html>
	<!-- SPDX-License-Identifier: GPL-3.0-or-later. Has plgen, GMP, MPFR, MPC, MPFI, GSL and TCC inside; its sources
	are those of plgen and Debian's. -->
	<html lang="en">
	<head>
	<meta charset="utf-8"/>
	<meta http-equiv="Content-Security-Policy" content="default-src 'none'; script-src
	$(sum load.sum "$place/texts.h") $(sum script.sum "$place/texts.h")
	$(sum script.sum "$build/gen/runtime_texts.h")
	'wasm-unsafe-eval'; style-src $(sum style.sum "$place/texts.h"); base-uri 'none'; form-action 'none'"/>
	<meta name="viewport" content="width=device-width,initial-scale=1"/>
	<title>plgen in a page</title>
	END
	printf '<style>%s\n</style>\n' "$(text page.css)"
	cat <<-END
	</head>
	<body>
	<noscript>This page runs plgen by a script, and scripts are turned off.</noscript>
	<header><h1>plgen</h1></header>
	<div class="bar"><label for="from">Model</label><select id="from"></select>
	<button type="button" id="run">Run (Ctrl+Enter)</button><button type="button" id="save">Save the spec</button>
	<label for="open">Open</label><input type="file" id="open" accept=".spec"/></div>
	<div id="edit"><div id="lines" aria-hidden="true"></div>
	<textarea id="spec" aria-label="The spec" spellcheck="false" wrap="off" rows="24"></textarea></div>
	<pre id="said" role="status" aria-label="Messages"></pre>
	<details id="code"><summary>The C</summary><button type="button" id="keep">Save the C</button><pre id="c"></pre>
	</details>
	<iframe id="shown" title="The model runs"></iframe>
	END
	printf '<script type="application/json" id="models">{%s}</script>\n' "$(models)"
	printf '<script type="text/plain" id="plgen">'
	gzip -9nc "$place/plgen.wasm" | base64 -w 0
	printf '</script>\n<script type="text/plain" id="script">%s</script>\n' "$(text script.gz)"
	printf '<script>%s\n</script>\n</body>\n</html>\n' "$(text load.js)"
} >"$place/page.html"
mv "$place/page.html" "$build/playground.html"
echo "playground: $build/playground.html, $(($(wc -c <"$build/playground.html") / 1000)) kB"
