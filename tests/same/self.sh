#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# self.sh BUILD SOURCE_ROOT: same.sh itself, on a few runs: a build beside itself and beside sums of it, and what is
# spoiled is noticed, measured and excepted.
set -u
build=$(cd "$1" && pwd) || exit 99
root=$(cd "$2" && pwd) || exit 99
. "$root/tests/tap.sh"
# A build outside of the tree does not find the runtime by itself.
export PLGEN_RUNTIME="$root/runtime"

# same ARGUMENT ...: same.sh on five runs, to `log`; sets `status`
same() {
	CASE=models/linear2dof.spec EXCEPT=$except sh "$root/tests/same.sh" "$@" >log 2>&1
	status=$?
}

# says STATUS LINE NAME: that is what same.sh has ended with, and one of its lines matches
says() {
	[ "$status" -eq "$1" ] && grep -q "$2" log
	result $? "$3"
}

# spoiled SED: a build of that name whose emitted code sed has changed
spoiled() {
	mkdir -p spoiled
	ln -sf "$build/libplrt.a" spoiled/libplrt.a
	printf '#!/bin/sh\n"%s" "$@"\nstatus=$?\n[ ! -f model.c ] || sed -i "%s" model.c\nexit $status\n' \
		"$build/plgen" "$1" >spoiled/plgen
	chmod +x spoiled/plgen
}

except=/dev/null
same --text "$build" "$build"
says 0 '^5 texts, 5 the same$' 'a build beside itself: texts'
says 0 '^5 runs, 5 the same, 0 excepted, 0 not$' 'a build beside itself: numbers'
same --keep sums "$build"
same sums "$build"
says 0 '^5 runs, 5 the same, 0 excepted, 0 not$' 'a build beside sums of it'

# One unit in the last place of a factor of two forms of the step
spoiled 's/-0.05927083056963416 /-0.05927083056963417 /'
same --text "$build" "$PWD/spoiled"
says 1 '^5 runs, 2 the same, 0 excepted, 3 not$' 'a factor that is off by rounding is noticed'
says 1 '^5 texts, 2 the same$' 'and so are the texts'
says 1 '^models/linear2dof.spec: differs by [0-9.]* units, by [0-9.]* a step' 'and by how much is said'
same sums "$PWD/spoiled"
says 1 '^models/linear2dof.spec: differs$' 'beside sums too'
printf '*/linear2dof.spec*\ta reason\n' >excepted
except=$PWD/excepted
same "$build" "$PWD/spoiled"
says 0 '^models/linear2dof.spec: differs by .*; a reason$' 'with a reason it may be'

spoiled 's/-0.05927083056963416 /-0.05927083056973416 /'
same "$build" "$PWD/spoiled"
says 1 '^5 runs, 2 the same, 0 excepted, 3 not$' 'no reason is one for more than two units a step'
# A descriptor that has no NAME_at
spoiled 's/^    made_any_at,/    NULL,/'
same "$build" "$PWD/spoiled"
says 1 '^models/linear2dof.spec: no longer tells at$' 'a table that is told no longer'
spoiled 's/int main/int other/; s/made_init(made/made_begin(made/'
same "$build" "$PWD/spoiled"
says 1 '^5 runs, 0 the same, 0 excepted, 5 not$' 'what cannot be linked is not the same'
tap_end
