#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# page.sh PLGEN PLRUN ROOT: pages of `plgen --page`. Their numbers are plrun's to the last bit, run by node; text of
# the model stays text; what stands in the way is reported. With MERGE=1 ten models, and a page in a browser without a
# network.
set -u
plgen=$(cd "$(dirname "$1")" && pwd)/$(basename "$1") || exit 99
plrun=$(cd "$(dirname "$2")" && pwd)/$(basename "$2") || exit 99
root=$(cd "$3" && pwd) || exit 99
. "$root/tests/tap.sh"
XDG_CACHE_HOME=$work/cache
export XDG_CACHE_HOME
page=$root/tests/page/page.js

missing=
for tool in clang wasm-ld node; do
	command -v $tool >found 2>&1 || missing="$missing $tool"
done
browser=
command -v chromium >found 2>&1 && browser=chromium

# equal NAME T SETTINGS PARAMS SED: of models/NAME.spec with `tunable` PARAMS, k=2 c=3. The page gets SETTINGS; plrun
# gets the params by -D, as a slider gives them, and by SED a spec with the initial values
equal() {
	name=$1 end=$2 settings=$3 tuned=$4
	sed "s|\"beam/|\"$root/models/beam/|" "$root/models/$name.spec" >"$name.spec"
	[ -z "$tuned" ] || echo "tunable $(echo "$tuned" | sed 's/=[^ ]*//g; s/ /, /g')" >>"$name.spec"
	sed "$5" "$name.spec" >moved.spec
	# shellcheck disable=SC2046
	"$plrun" --math own $([ -z "$tuned" ] || printf -- '-D %s ' $tuned) ${record:+--input "$record"} moved.spec \
		"$end" >plrun.csv 2>log ||
		{ result 1 "$name: plrun"; return; }
	"$plgen" --page "$name.html" "$name.spec" 2>log || { result 1 "$name: a page"; return; }
	node "$page" rows "$name.html" $(($(wc -l <plrun.csv) - 2)) "$settings" >page.csv 2>log ||
		{ result 1 "$name: the page runs"; return; }
	[ "$name" = two_masses ] && cp page.csv page.two
	node "$page" equal page.csv plrun.csv >log 2>&1
	result $? "$name: $(head -n 1 log)"
	size=$(wc -c <"$name.html")
	[ "$size" -le 100000 ] || echo "$size bytes" >log
	[ "$size" -le 100000 ]
	result $? "$name: at most 100 kB"
}

if [ -n "$missing" ]; then
	skip 'numbers of pages' "there is no$missing"
else
	equal two_masses 15 '{"start": {"x2": 0.125}, "params": {"k1": 137.25, "gap": 0.03}}' 'k1=137.25 gap=0.03' \
		"s/^init .*/init x1' = 0.5, x2 = 0.125/"
	equal double_pendulum 5 '{"start": {"a": 0.75}}' '' 's/^init .*/init a = 0.75, b = 1/'
fi
if [ -z "$missing" ] && merging; then
	equal sdcsf 10 '{"start": {"x1": 0.5}, "params": {"k2": 71.5, "F": 3.25}}' 'k2=71.5 F=3.25' \
		's/^init .*/init x1 = 0.5/'
	equal linear2dof 20 '{}' '' ''
	equal gear1 50 '{}' '' ''
	equal stick_slip 10 '{}' '' ''
	equal brake 5 '{}' '' ''
	equal impact_oscillator 20 '{}' '' ''
	equal bouncing_ball 5 '{}' '' ''
	equal crane 5 '{}' '' ''
	equal duffing 20 '{}' '' ''
	samples=$(awk 'BEGIN { for (k = 0; k < 300; k++) printf "%s%.6f", k ? " " : "", sin(k * k / 900) / 8 }')
	echo "$samples" | tr ' ' '\n' | sed '1i ground_acc' >record.csv
	record=$PWD/record.csv
	equal oscillator 1.4 "{\"inputs\": {\"ground_acc\": {\"kind\": \"record\", \"record\": [$(echo "$samples" |
		tr ' ' ',')]}}}" '' ''
	mkdir -p late/models
	printf '%s\n' 'model late' 'coord z' 'input u hold first' "z'' + 0.4*z' + 9*z = u + 0.5*u(t - 0.26)" \
		'output z' 'step 1/50' >late/models/late.spec
	sed -i 's/ground_acc/u/' record.csv
	root=$PWD/late equal late 5.6 "{\"inputs\": {\"u\": {\"kind\": \"record\", \"record\": [$(echo "$samples" |
		tr ' ' ',')]}}}" '' ''
fi

# Whatever names, comments and titles have in them is text.
cat >text.spec <<'END'
model text                      # </script><script>alert(1)</script> & "quoted" 'single' <!--
param k = 4 "N/m", m = 1 "kg"   # \u003c stays as it is
coord x "m"
m*x'' + k*x = 0
init x = 1 "mm"
output x
step 0.01 "s"
END
title='</script><b>"t" & <!--'
if [ -n "$missing" ]; then
	skip 'text stays text' "there is no$missing"
else
	{ echo "$title"; cat text.spec; echo; } >expected
	"$plgen" --page text.html --title "$title" text.spec 2>log &&
		node "$page" text text.html 2>log | diff expected - >>log && [ "$(grep -o '</script' text.html |
		wc -l)" -eq 3 ] && [ "$(grep -o '<script' text.html | wc -l)" -eq 3 ]
	result $? 'text stays text'
	node "$page" policy text.html >log 2>&1
	result $? 'the policy names the script and the style by their sums'
	"$plgen" --page again.html --title "$title" text.spec 2>log && cmp text.html again.html >log 2>&1
	result $? 'the same model, the same bytes'
fi

# ---- what stands in the way ----

# refused TEXT NAME OPTION...: exit 1, and what stood in the file stays
refused() {
	text=$1 name=$2
	shift 2
	echo kept >kept.html
	"$@" >out 2>log
	[ $? -eq 1 ] && grep -qF -- "$text" log && [ "$(cat kept.html)" = kept ] && [ ! -s out ]
	result $? "$name"
}
refused "Debian's packages clang and lld" 'no clang' env PLGEN_CLANG=./none "$plgen" --page kept.html text.spec
printf '#!/bin/sh\necho "wasm-ld is not there" >&2\nexit 1\n' >failing
chmod +x failing
refused "Debian's packages clang and lld" 'clang fails' env PLGEN_CLANG=./failing "$plgen" --page kept.html text.spec
[ -n "$missing" ] || refused 'cannot write' 'a folder that cannot be written' "$plgen" --page /proc/none.html text.spec
sed '/^output/d' text.spec >none.spec
if [ -z "$missing" ]; then
	"$plgen" --page none.html none.spec 2>log && grep -q 'note: .*no outputs.*the page shows its states' log
	result $? 'a model without outputs'
fi

cat >many.spec <<'END'
model many
coord q[256]
q'' + 100*q = 0
init q[1] = 1
output q
step 0.01
END
if merging && [ -z "$missing" ]; then
	"$plgen" --page many.html many.spec 2>log && node "$page" rows many.html 3 '{}' >rows 2>>log &&
		[ "$(wc -l <rows)" -eq 5 ] && sed -n 5p rows | grep -q '^0.03,0.95533648912560'
	result $? '512 states'
fi

# wrong TEXT OPTION...: the command line, exit 2
wrong() {
	text=$1
	shift
	"$plgen" "$@" text.spec >out 2>log
	[ $? -eq 2 ] && [ ! -s out ] && grep -qF -- "$text" log
	result $? "$text"
}
for option in '-o a.c' '--fmu a.fmu' --header --explain --rhs --selftest --batch --dark '--sensitivity k'; do
	# shellcheck disable=SC2086
	wrong "${option% *} does not go with --page" --page kept.html $option
done
wrong '--real float does not go with --page' --page kept.html --real float
wrong "--page takes the name of a page, FILE.html, found 'a.c'" --page a.c
wrong "--math takes own, found 'other'" --math other
wrong '--math own is of doubles: it does not go with --real float' --math own --real float

# ---- in a browser ----

# seen NAME PAGE SCRIPT [WIDTH]: SCRIPT comes to true, and the browser has nothing to complain of
seen() {
	node "$page" browse "$2" "$3" "${4:-1400}" >log 2>&1
	[ "$(cat log)" = true ]
	result $? "$1"
}
if merging && [ -z "$missing" ] && [ -n "$browser" ]; then
	seen 'a page runs, without a complaint of the policy' text.html 'page.engine.count > 50 &&
		document.title === page.model.title && document.querySelector("h1").textContent === page.model.title &&
		!document.querySelector("b") && document.querySelector("pre").textContent
			.includes("</script>")'
	seen 'every control has a name' text.html '[...document.querySelectorAll("button, input, select, canvas")].
		every((c) => c.textContent.trim() || c.ariaLabel || c.closest("label") || (c.labels || "").length > 0)'
	seen 'a hidden page stands still' text.html 'new Promise((done) => {
		Object.defineProperty(document, "hidden", {value: true});
		document.dispatchEvent(new Event("visibilitychange"));
		setTimeout(() => {
			const at = page.engine.count;
			setTimeout(() => done(page.engine.count === at), 300);
		}, 300);
	})'
	seen 'a link restores params and initial values' \
		'two_masses.html#{"p":{"k1":150},"y":{"x2":0.25},"s":{"speed":0.5,"window":-1}}' \
		'page.engine.params[0] === 150 && page.engine.start[1] === 0.25 && page.set.speed === 0.5 &&
		page.set.window > 0'
	seen 'sliders, initial values, a reset: the numbers of node and plrun' two_masses.html 'page.tune(0, 137.25),
		page.tune(1, 0.03), page.place(1, 0.125), page.run(false), page.forgetPast(), page.advance(1000),
		page.value(1) === '"$(sed -n 1002p page.two 2>/dev/null | cut -d, -f2)"
	# shellcheck disable=SC2016
	seen 'a rod that is dragged ends where the pointer is' double_pendulum.html '(() => {
		page.run(false);
		page.forgetPast();
		page.draw(0);
		const rod = page.model.draw[1].at, at = (k) => page.drawn(rod[k]);
		page.held = page.grabbed(page.left + page.scale * at(2), page.base - page.scale * at(3));
		page.drag(page.left + page.scale * 0.9, page.base + page.scale * 1.3);
		page.forgetPast();
		return page.held >= 0 && Math.hypot(at(2) - 0.9, at(3) + 1.3) < 0.01;
	})()'
	seen 'at 400 points nothing is wider than the window' two_masses.html \
		'document.documentElement.scrollWidth <= innerWidth' 400
elif merging; then
	skip 'a page in a browser' "there is no${missing}${browser:- chromium}"
fi

tap_end
