# SPDX-License-Identifier: GPL-3.0-or-later
# Thin: packages through apt, everything else through Meson.

BUILD = build
# The commands and their pictures; then what the demo shows, and what the tests compare with and run on
PACKAGES = gcc libc6-dev make meson ninja-build pkgconf libgmp-dev libmpfr-dev libmpfi-dev libmpc-dev libgsl-dev \
	libtcc-dev gnuplot-nox
DEMO_PACKAGES = $(PACKAGES) libsundials-dev
CHECK_PACKAGES = $(DEMO_PACKAGES) g++ clang lld tcc libcmocka-dev valgrind \
	gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm libxml2-utils python3-scipy python3-pip python3-venv \
	python3-wheel mypy octave octave-dev octave-control libopenmpi-dev openmpi-bin cmake cppcheck

.PHONY: all setup deps demo-deps check-deps demo tests check quick check-merge check-long check-firefox faults bench \
	charts charts-quick charts-twice charts-page chart gallery playground firmware-report bare install clean

all: setup
	ninja -C $(BUILD) plgen plrun libplrt.a

# Asks apt only for what is not there.
define need
@missing=; for p in $(1); do \
	dpkg-query -W -f='$${Status}' $$p 2>/dev/null | grep -q 'ok installed' || missing="$$missing $$p"; \
done; \
if [ -n "$$missing" ]; then \
	echo "installing:$$missing"; \
	root=; [ "$$(id -u)" = 0 ] || root=sudo; \
	$$root apt-get update -q && \
	$$root env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends $$missing; \
fi
endef

# configure TEST,OPTIONS: the build folder, unless TEST finds in it what is wanted; what was set up before a package
# came, once more
define configure
@if ! { $(1); } >/dev/null 2>&1; then \
	again=; [ ! -f $(BUILD)/build.ninja ] || again=--reconfigure; \
	meson setup $$again $(2) $(BUILD) >$(BUILD).log || { cat $(BUILD).log; exit 1; }; \
	rm -f $(BUILD).log; \
fi
endef

deps:
	$(call need,$(PACKAGES))

demo-deps:
	$(call need,$(DEMO_PACKAGES))

check-deps:
	$(call need,$(CHECK_PACKAGES))

setup: deps
	$(call configure,test -f $(BUILD)/build.ninja)

# Only what it shows: the tests are built by `make check`.
demo: demo-deps
	$(call configure,ninja -C $(BUILD) -t query bench/demo_cvode)
	ninja -C $(BUILD) plgen bench/demo_cvode
	sh bench/demo/demo.sh $(BUILD)

# With every test: what is missing for one stops it here.
tests: check-deps
	$(call configure,test -f $(BUILD)/tests_enabled,-Dtests=enabled)
	@touch $(BUILD)/tests_enabled

check: tests
	sh tests/check.sh $(BUILD)

# After each change, in half a minute from a built tree: units, rooms, lines, a model of each kind by closed forms, an
# eighth of the cases of bad input
QUICK = runtime_double runtime_float memory mtx math walk modes poles number atoms program positive digits rooms \
	docs_lines docs_words compilers values history_sdcsf remainder_figures switching_figures radau_numbers_3 \
	friction_closed contacts_closed delays peaks
quick: tests
	DEAR=skip EVERY=8 sh tests/check.sh $(BUILD) $(QUICK) errors

# More compilers, boards and random models, charts, installations: before a piece of work is finished
check-merge: tests
	sh tests/check.sh $(BUILD) --suite merge

# Pages in firefox-esr too, which is not among the packages that the tests take
check-firefox: setup
	ninja -C $(BUILD) plgen plrun
	MERGE=1 FIREFOX=1 sh tests/page/page.sh $(BUILD)/plgen $(BUILD)/plrun .

# What only long runs show: more random models, more seeds
check-long: tests
	sh tests/check.sh $(BUILD) --suite long

# Benchmarks: never part of a test.
bench: tests
	ninja -C $(BUILD) benchmarks
	sh bench/generate.sh $(BUILD)
	sh bench/steps.sh $(BUILD)
	sh bench/retune.sh $(BUILD)
	sh bench/retune_blocks.sh $(BUILD)
	sh bench/sweep.sh $(BUILD)
	sh bench/large.sh $(BUILD)
	sh bench/rows.sh $(BUILD)
	sh bench/python.sh $(BUILD)
	sh bench/limits/limits.sh $(BUILD)
	sh bench/spectrum.sh $(BUILD)

# Speed against accuracy, and stability where methods fail: charts/index.html with its pictures and tables. Half an
# hour, quick less: doc/performance.md.
charts charts-quick: tests
	ninja -C $(BUILD) charts
	sh bench/charts/charts.sh $(BUILD) charts $(if $(findstring quick,$@),--quick)

# What of these measures no time, two times from nothing: tables that are the same bytes
charts-twice: tests
	ninja -C $(BUILD) charts
	sh bench/charts/twice.sh $(BUILD) $(BUILD)/charts-twice

# Pictures and pages once more from tables that are there, by default those kept in doc/charts: nothing is measured
charts-page: demo-deps
	sh bench/charts/draw.sh $(or $(TABLES),doc/charts)

# The same for a model of your own: make chart SPEC=my.spec [UNTIL=10] [EVERY=0.1], in seconds
chart: demo-deps
	$(call configure,test -f $(BUILD)/build.ninja)
	@ninja -C $(BUILD) plgen >/dev/null
	@sh bench/charts/own/own.sh $(BUILD)/plgen "$(SPEC)" charts/own "$(UNTIL)" "$(EVERY)"

# $(BUILD)/playground.html, the generator in a page (doc/page.md); its libraries take ten minutes, once
playground: all
	sh share/page/playground.sh $(BUILD)
	if command -v node && command -v chromium; then \
		node tests/page/page.js playground $(BUILD)/playground.html $(BUILD)/plgen models; fi

# The pictures of doc/gallery.md, by plrun; with clang and wasm-ld also $(BUILD)/pages/index.html, models that run
gallery: all
	sh bench/gallery.sh $(BUILD)/plrun doc/gallery \
		$(if $(shell command -v clang && command -v wasm-ld),$(BUILD)/pages)

# Bytes, stack and instructions on emulated boards: doc/firmware.md
firmware-report: tests
	ninja -C $(BUILD) firmware_report

# Does the suite that should notice a fault notice it?  each is put into a copy: tests/faults
faults: check-deps
	sh tests/faults/faults.sh -j 2

# README and tutorial, typed by one who has nothing but make, in a Debian of its own under $(BARE): doc/tests.md
BARE = $(BUILD)-bare
bare:
	sh tests/bare/bare.sh $(BARE) .

install: all
	meson install -C $(BUILD) --no-rebuild

clean:
	rm -rf $(BUILD) charts
