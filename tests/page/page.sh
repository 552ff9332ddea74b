#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# page.sh PLGEN PLRUN ROOT: pages of `plgen --page`. Their numbers are plrun's to the last bit, run by node; text of
# the model stays text; what stands in the way is reported. With MERGE=1 ten models, and a page in a browser without a
# network; with FIREFOX=1 too in that one.
set -u
plgen=$(realpath "$1") || exit 99
plrun=$(realpath "$2") || exit 99
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
	[ "$name" = oscillator ] && [ ! -f page.record ] && cp page.csv page.record
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
	for kind in sine noise; do
		set="{\"inputs\": {\"ground_acc\": {\"kind\": \"$kind\", \"level\": 0.1, \"size\": 2, \"rate\": 3}}}"
		node "$page" samples oscillator.html 300 "$set" >record.csv 2>log
		equal oscillator 1.4 "$set" '' ''
	done
	for name in axle sdcsf; do
		"$plgen" --page $name.html "$root/models/$name.spec" 2>log
		node "$page" response $name.html 12000 >log 2>&1
		result $? "$name: frequency responses are those of steps"
	done
	echo "$samples" | tr ' ' '\n' | sed '1i u' >record.csv
	root=$PWD/late equal late 5.6 "{\"inputs\": {\"u\": {\"kind\": \"record\", \"record\": [$(echo "$samples" |
		tr ' ' ',')]}}}" '' ''
fi

# Whatever names, comments and titles have in them is text.
cat >text.spec <<'END'
model text                      # </script><script>alert(1)</script> & "quoted" 'single' <!--
param k = 4 "N/m", m = 1 "kg"   # </script> \u003c stays as it is
coord x "m"
m*x'' + k*x = 0
init x = 1 "mm"
output x
tunable k in [1, 16]
step 0.01 "s"
END
title='</script><b>"t" & <!--'
if [ -n "$missing" ]; then
	skip 'text stays text' "there is no$missing"
else
	{ echo "$title"; cat text.spec; echo; } >expected
	"$plgen" --page text.html --title "$title" text.spec 2>log &&
		node "$page" text text.html 2>log | diff expected - >>log && [ "$(grep -o '</script' text.html |
		wc -l)" -eq 4 ] && [ "$(grep -o '<script' text.html | wc -l)" -eq 4 ]
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

# seen PAGE [WIDTH]: of standard input blocks of a line "# name" and a script, which comes to true; and the browser has
# nothing to complain of
seen() {
	cat >scripts
	node "$page" browse "$1" scripts "${2:-1400}" >all 2>&1
	for block in $(seq "$(grep -c '^# ' scripts)"); do
		{ sed -n "${block}p" all; grep '^log' all; } >log
		[ "$(cat log)" = true ]
		result $? "$(grep '^# ' scripts | sed -n "${block}s/^# //p")"
	done
}
if merging && [ -z "$missing" ] && [ -n "$browser" ]; then
	seen text.html <<'END'
# a page runs, and what is text stays text
page.engine.count > 20 && document.title === page.model.title && !document.querySelector("b, script[src]") &&
	document.querySelector("h1").textContent === page.model.title && document.querySelector("pre").textContent
	.includes("</script>") && [...document.querySelectorAll("[title]")].some((e) => e.title.includes("</script>"))
# every control has a name
[...document.querySelectorAll("button, input, select, canvas")].every((c) => c.textContent.trim() || c.ariaLabel ||
	c.closest("label") || (c.labels || "").length > 0)
# the frequency response follows a slider
(() => {
	const peak = () => Number(page.response.said.textContent.match(/peaks: ([0-9.]+) Hz/)[1]);
	const near = (f) => Math.abs(peak() / (Math.sqrt(f) / 2 / Math.PI) - 1) < 1e-4;
	page.run(false);
	page.draw(0);
	const before = near(4);
	page.controls.sliders[0].slider.value = 9;
	page.controls.sliders[0].slider.dispatchEvent(new Event("input"));
	page.draw(0);
	return before && near(9);
})()
# what is too slow is no sound
(page.controls.sound(), page.controls.said.textContent.includes("heard is what is from 20 to 20000 Hz"))
# CSV has every row that is shown, to the last bit
(async () => {
	const make = URL.createObjectURL;
	let blob;
	URL.createObjectURL = (b) => make.call(URL, blob = b);
	page.controls.save();
	const rows = (await blob.text()).trim().split("\n").map((l) => l.split(",")), h = page.history;
	return rows[0].join() === "t,x,x'" && rows.length === h.count - h.first + 1 && rows.slice(1).every((row, k) =>
		Number(row[0]) === h.when(h.first + k) && page.channels.every((c, i) =>
			Number(row[1 + i]) === h.at(h.first + k, c.column)));
})()
# what a link has is restored
(() => {
	const c = page.controls, e = page.engine;
	c.tune(0, 6.5);
	c.place(1, 0.375);
	c.change("window", 3);
	c.change("to", "x'");
	c.link();
	c.tune(0, 5);
	c.place(1, 0);
	c.change("window", 8);
	c.change("to", "x");
	c.restore();
	return e.params[0] === 6.5 && e.start[1] === 0.375 && page.set.window === 3 && page.set.to === "x'" &&
		c.selects.to.value === "x'";
})()
# a hidden page stands still
new Promise((done) => {
	page.run(true);
	Object.defineProperty(document, "hidden", {value: true});
	document.dispatchEvent(new Event("visibilitychange"));
	setTimeout(() => {
		const at = page.engine.count;
		setTimeout(() => done(page.engine.count === at), 300);
	}, 300);
})
END
	seen 'two_masses.html#{"p":{"k1":150},"y":{"x2":0.25},"s":{"speed":0.5,"window":-1}}' 400 <<END
# a link restores params and initial values
page.engine.params[0] === 150 && page.engine.start[1] === 0.25 && page.set.speed === 0.5 && page.set.window > 0
# at 400 points nothing is wider than the window
document.documentElement.scrollWidth <= innerWidth
# a mass that is dragged starts where the pointer leaves it
(() => {
	const s = page.sketch, at = s.canvas.getBoundingClientRect(), scale = s.perUnit, x = s.bodyAt(1), y = s.middle;
	const send = (type, x) => s.canvas.dispatchEvent(new PointerEvent(type, {clientX: at.left + x,
		clientY: at.top + y}));
	s.canvas.setPointerCapture = () => {};
	send("pointerdown", x);
	send("pointermove", s.restAt(1) + 20);
	send("pointerup", x);
	return Math.abs(page.engine.start[1] - 20 / scale) < 0.02 / scale && page.engine.start[1] === page.history.at(0,
		page.byName.get("x2").column) && Number(page.controls.startFields[1].value) > 0;
})()
# sliders, initial values, a reset: the numbers of node and plrun
(page.controls.forget(), page.controls.tune(0, 137.25), page.controls.tune(1, 0.03), page.controls.place(1, 0.125),
	page.run(false), page.forgetPast(), page.advance(1000),
	page.value(1) === $(sed -n 1002p page.two | cut -d, -f2))
END
	seen double_pendulum.html <<'END'
# a rod that is dragged ends where the pointer is
(() => {
	const s = page.sketch, rod = page.model.draw[1].at, at = (k) => s.drawn(rod[k]);
	page.run(false);
	page.forgetPast();
	page.draw(0);
	s.held = s.grabbed(s.left + s.scale * at(2), s.base - s.scale * at(3));
	s.drag(s.left + s.scale * 0.9, s.base + s.scale * 1.3);
	page.forgetPast();
	return s.held >= 0 && Math.hypot(at(2) - 0.9, at(3) + 1.3) < 0.01;
})()
END
	seen oscillator.html <<END
# a CSV file that is dropped drives the model as plrun's does
(async () => {
	const drop = (text) => {
		const data = new DataTransfer();
		data.items.add(new File([text], "record.csv"));
		document.dispatchEvent(new DragEvent("drop", {dataTransfer: data}));
		return new Promise((done) => setTimeout(done, 300));
	};
	page.run(false);
	await drop("1\n2\nno\n");
	const wrong = page.controls.wrong.textContent;
	await drop("ground_acc\n$(echo "$samples" | sed 's/ /\\n/g')\n");
	page.run(false);
	page.forgetPast();
	page.advance(280);
	return wrong === "the column of ground_acc has no number in row 3" && page.controls.wrong.textContent === "" &&
		page.value(1) === $(sed -n 282p page.record | cut -d, -f2);
})()
END
	sed 's/k = 4 /k = 7643166.0485968 /; s/init x = 1 "mm"/init x = 1 "mm"/; s/step .*/step 1e-5 "s"/
		/^tunable/d' text.spec >tone.spec
	"$plgen" --page tone.html tone.spec 2>log
	seen tone.html <<'END'
# the sound of an output has its frequency
(() => {
	page.run(false);
	page.controls.change("window", 0.1);
	page.begin();
	page.advance(10000);
	page.controls.sound();
	const s = page.controls.source.buffer, x = s.getChannelData(0);
	let crossings = 0;
	for (let i = 1; i < x.length; i++) crossings += x[i - 1] < 0 && x[i] >= 0;
	return page.controls.said.textContent.startsWith("sound of x: ") && Math.abs(crossings / s.duration - 440) < 12;
})()
END
	node "$page" bits two_masses.html double_pendulum.html sdcsf.html linear2dof.html gear1.html stick_slip.html \
		brake.html impact_oscillator.html bouncing_ball.html crane.html duffing.html >log 2>&1
	result $? 'eleven models: the bits of node'
	if [ "${FIREFOX:-0}" = 1 ]; then
		node "$page" firefox two_masses.html double_pendulum.html sdcsf.html linear2dof.html gear1.html \
			stick_slip.html brake.html impact_oscillator.html bouncing_ball.html crane.html duffing.html \
			>log 2>&1
		result $? 'eleven models in Firefox: the bits of node'
	fi
	cat >scripts <<'END'
# blocked
Promise.allSettled([fetch("https://example.org/"), import("data:text/javascript,1"), new Promise((done, fail) => {
	const image = new Image();
	image.onload = done;
	image.onerror = fail;
	image.src = "data:image/gif;base64,R0lGODlhAQABAAAAACH5BAEKAAEALAAAAAABAAEAAAICTAEAOw==";
}), new Promise((done) => done(eval("1")))]).then((all) => all.every((one) => one.status === "rejected"))
END
	node "$page" browse text.html scripts >log 2>&1
	[ "$(head -n 1 log)" = true ] && grep -q 'Content Security Policy' log
	result $? 'the policy lets nothing be fetched, imported, shown or evaluated'
	"$plgen" --report --dark --page report.html text.spec >out 2>log && [ ! -s out ] && seen report.html <<'END'
# a report has the page in a frame
document.querySelectorAll("iframe").length === 1 && document.querySelectorAll("h2").length > 5 &&
	document.querySelector("iframe").srcdoc.includes("Content-Security-Policy")
END
elif merging; then
	skip 'a page in a browser' "there is no${missing}${browser:- chromium}"
fi

tap_end
