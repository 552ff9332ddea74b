# SPDX-License-Identifier: GPL-3.0-or-later
# Thin: packages through apt, everything else through Meson.

BUILD = build
PACKAGES = gcc g++ clang make meson ninja-build pkgconf \
	libgmp-dev libmpfr-dev libmpfi-dev libmpc-dev libgsl-dev \
	libsundials-dev libcmocka-dev valgrind gnuplot-nox \
	gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm

.PHONY: all setup deps demo check bench charts charts-quick firmware-report fuzz accuracy faults install clean

all: setup
	ninja -C $(BUILD)

setup: deps
	@test -f $(BUILD)/build.ninja || meson setup $(BUILD) >$(BUILD).log || { cat $(BUILD).log; exit 1; }
	@rm -f $(BUILD).log

# Asks apt only for what is not there.
deps:
	@missing=; for p in $(PACKAGES); do \
		dpkg-query -W -f='$${Status}' $$p 2>/dev/null | grep -q 'ok installed' || missing="$$missing $$p"; \
	done; \
	if [ -n "$$missing" ]; then \
		echo "installing:$$missing"; \
		root=; [ "$$(id -u)" = 0 ] || root=sudo; \
		$$root apt-get update -q && \
		$$root env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends $$missing; \
	fi

# Only what it shows: the tests are built by `make check`.
demo: setup
	ninja -C $(BUILD) plgen bench/demo_cvode
	sh bench/demo/demo.sh $(BUILD)

check: all
	sh tests/check.sh $(BUILD)

# Benchmarks: never part of a test.
bench: all
	sh bench/generate.sh $(BUILD)
	sh bench/growth.sh $(BUILD)
	$(BUILD)/bench/apply
	sh bench/beam.sh $(BUILD)
	sh bench/switching.sh $(BUILD)
	$(BUILD)/bench/crossings
	sh bench/retune.sh $(BUILD)
	sh bench/sweep.sh $(BUILD)

# Speed against accuracy, and stability where methods fail: charts/index.html with its pictures and tables. 20 minutes;
# quick: 4.
charts charts-quick: setup
	ninja -C $(BUILD) charts
	sh bench/charts/charts.sh $(BUILD) charts $(if $(findstring quick,$@),--quick)

# Bytes, stack and instructions on emulated boards: doc/firmware.md
firmware-report: setup
	ninja -C $(BUILD) firmware_report

# The long forms of what `make check` runs briefly.
accuracy: all
	$(BUILD)/tests/accuracy/bitwise -n 2000 tests/accuracy/exponentials.txt models/*.spec
	ninja -C $(BUILD) long

fuzz: all
	ninja -C $(BUILD) fuzz_long
	ninja -C $(BUILD) grammar_long

# Does the suite that should notice a fault notice it?  each is put into a copy: tests/faults
faults: setup
	sh tests/faults/faults.sh -j 2

install: all
	meson install -C $(BUILD)

clean:
	rm -rf $(BUILD) charts
