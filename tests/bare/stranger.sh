#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# stranger.sh [check]: in a bare Debian, as one who has never seen plgen: clones it, has it built, draws a first model,
# then types every block of README and tutorial, in order, in the folder of the clone. Writes `bare.md`, a row a
# command, and says it as TAP; beside it blocks.awk and, at /srv/plgen.git, the repository. Called by bare.sh.
set -u
cd "${0%/*}" || exit 99
home=$PWD
: >said
count=0
failed=0

now() { date +%s.%N; }

# row STATUS SECONDS COMMAND
row() {
	count=$((count + 1))
	words='ok'
	[ "$1" -eq 0 ] || { words="not ok" failed=$((failed + 1)); }
	text=$(printf '%s' "$3" | head -n 1 | cut -c 1-90 | sed 's/|/\\|/g')
	[ "$1" -eq 0 ] && note= || note=' **failed**'
	printf '| `%s` | %.1f%s |\n' "$text" "$2" "$note" >>"$home/bare.md"
	printf '%s %d - %s # %.1f s\n' "$words" $count "$text" "$2"
	[ "$1" -eq 0 ] || tail -n 8 "$home/said" | cut -c 1-200 | sed 's/^/# /'
}

# typed COMMAND: what stands in a page, typed; its time goes to `took`
typed() {
	began=$(now)
	printf '$ %s\n' "$1" >>"$home/said"
	sh -euc "$1" >"$home/answer" 2>&1
	status=$?
	took=$(echo "$(now) $began" | awk '{ print $1 - $2 }')
	cat "$home/answer" >>"$home/said"
	row $status "$took" "$1"
	return $status
}

# What apt said it took to fetch what, in seconds
fetched() { sed -n 's/^Fetched .* in \([0-9]*min \)*\([0-9]*\)s .*/\1 \2/p' "$home/said" |
	awk '{ s += NF > 1 ? 60 * $1 + $2 : $1 } END { print s + 0 }'; }

# commands FILE: those of a block of sh, one by one: a line that is not a whole command takes the next ones in
commands() {
	text=
	while IFS= read -r line; do
		text=${text:+$text
}$line
		case $line in *\\) continue ;; esac
		if sh -nc "$text" 2>/dev/null; then
			[ -z "${text%%#*}" ] || typed "$text"
			text=
		fi
	done <"$1"
}

# console FILE: commands, and what the page has them say
console() {
	: >"$home/whole"
	sed -n 's/^\$ //p' "$1" >"$home/lines"
	while IFS= read -r line; do
		typed "$line"
		{ printf '$ %s\n' "$line"; cat "$home/answer"; } >>"$home/whole"
	done <"$home/lines"
	if ! diff "$1" "$home/whole" >>"$home/said"; then
		row 1 0 "what $(basename "$1") of $page says"
	fi
}

# program FILE: a block of C that is a file of its own, or statements for the middle of main
program() {
	file=$(sed -n '1s,^/\* \([A-Za-z0-9_]*\.[ch]\)\([: ].*\)*$,\1,p' "$1")
	if [ -n "$file" ]; then
		cp "$1" "$file"
		return
	fi
	{ grep '^#' "$1"; echo 'int main(void)'; echo '{'; grep -v '^#' "$1"; echo '}'; } >program.c
	typed "cc -Iruntime program.c $(grep -o '[a-z]*_pl' "$1" | head -n 1).c runtime/*.c -o program && ./program"
}

# packages: those that the page has one install by hand; whoever is root needs no sudo
packages() {
	sed -n 's/^`sudo \(apt install [^`]*\)`.*/\1/p' "$page" >"$home/lines"
	while read -r line; do
		typed "DEBIAN_FRONTEND=noninteractive $line -q -y --no-install-recommends"
	done <"$home/lines"
}

# follow PAGE: all of it
follow() {
	page=$1
	printf '\n| %s | s |\n| --- | --- |\n' "$page" >>"$home/bare.md"
	packages
	rm -rf "$home/blocks"
	mkdir "$home/blocks"
	awk -v folder="$home/blocks" -f "$home/blocks.awk" "$page" >"$home/found"
	while read -r number kind line <&3; do
		block=$home/blocks/$number.$kind
		case $kind in
			spec) cp "$block" "$(sed -n 's/^model \([A-Za-z0-9_]*\).*/\1/p' "$block").spec" ;;
			sh) commands "$block" ;;
			console) console "$block" ;;
			c) program "$block" ;;
		esac
	done 3<"$home/found"
}

version() { dpkg-query -W -f='${Version}' "$1" 2>/dev/null; }

printf '| from `git clone` to a picture | s |\n| --- | --- |\n' >bare.md
start=$(now)
typed 'git clone -q /srv/plgen.git plgen' && cd plgen || exit 1
typed make || exit 1
PATH=$PWD/build:$PATH
export PATH
awk -v folder="$home" -f "$home/blocks.awk" README.md >/dev/null
mv "$home/1.spec" two.spec
rm -f "$home"/[0-9].*
typed 'plrun two.spec 30 --plot two.svg >two.csv' && grep -q '<path' two.svg || exit 1
echo "$start $(now) $(fetched)" |
	awk '{ printf "| **all** | **%.1f** |\n| of it apt'\''s downloads | %.0f |\n", $2 - $1, $3 }' >>"$home/bare.md"
tail -n 2 "$home/bare.md"
echo "Debian $(cat /etc/debian_version), $(nproc) cores; gcc $(version gcc), meson $(version meson)," \
	"gnuplot $(version gnuplot-nox), MPFR $(version libmpfr-dev); $(git rev-list --count HEAD) commits" |
	tee -a "$home/versions"
follow README.md
follow doc/tutorial.md
printf '\n| the demo, and the tests | s |\n| --- | --- |\n' >>"$home/bare.md"
typed 'make demo'
if [ "${1:-}" = check ]; then
	typed 'make check'
	tail -n 4 "$home/answer"
fi
cat "$home/versions" >>"$home/bare.md"
echo "$((count - failed)) passed, $failed failed"
[ $failed -eq 0 ]
