#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# A Makefile outside against what is installed, by pkg-config: with the library, with the runtime's sources, with a
# bundle; a model is made anew when its data has changed, and only then.
#
#     make.sh BUILD SOURCE_ROOT
set -u
build=$(cd "$1" && pwd) || exit 99
root=$(cd "$2" && pwd) || exit 99
. "${0%/*}/../tap.sh"
. "$root/tests/install/stage.sh"

# As doc/install.md has it; make itself knows no blanks in what it makes
sed -n '/^```make/,/^```/p' "$root/doc/install.md" | sed '/^```/d' >"$project/Makefile"
mv "$project/the models/drive.spec" "$project/drive.spec"
sed -i 's,"k and k.mtx","the models/k and k.mtx",' "$project/drive.spec"
cd "$project" || exit 99
[ "$(wc -l <Makefile)" -gt 5 ] && make >"$work/log" 2>&1
status=$?
cd "$work" || exit 99
result $status 'it builds'
cp "$project/drive.spec" "$project/the models/drive.spec"
sed -i 's,"the models/,",' "$project/the models/drive.spec"
runs 'a model in double' 200 "$project/app"
makes_again 'make' "$project" make -C "$project"
runs 'it has the other matrix' 300 "$project/app"

# The runtime as sources, and as the man page has it
: >log
mkdir sources
plgen -o sources/drive.c "$project/drive.spec" 2>>log &&
	${CC:-cc} -std=c99 -I"$(plgen --runtime-dir)" -Isources "$project/main.c" sources/drive.c \
		"$(plgen --runtime-dir)"/*.c -o sources/app 2>>log
runs 'the runtime compiled of its sources' 300 sources/app
[ "$(pkg-config --variable=runtimedir plgen | tr -d '\\')" -ef "$(plgen --runtime-dir)" ]
result $? 'plgen.pc and plgen name the same runtime'

# Two bundles and a model that is linked with the library, in one program
mkdir both
for name in one two; do
	plgen --bundle --prefix $name -o both/$name.c "$project/drive.spec" 2>>log
done
plgen -o both/drive.c "$project/drive.spec" 2>>log
cat >both/app.c <<'END'
#include "drive.h"
#include "two.h"
#include "one.h"
#include <stdio.h>

int main(void)
{
    double y[3][DRIVE_STATES];
    drive a;
    one b;
    two c;
    drive_init(&a), one_init(&b), two_init(&c);
    drive_run(&a, 1000, NULL), one_run(&b, 1000, NULL), two_run(&c, 1000, NULL);
    drive_get(&a, y[0]), one_get(&b, y[1]), two_get(&c, y[2]);
    if (y[0][0] != y[1][0] || y[0][0] != y[2][0])
        return 1;
    printf("%.6f\n", y[0][0]);
    return one_model.version != drive_model.version;
}
END
for language in c c++; do
	sh -c '${CC:-cc} -x '$language' -Wall -Wextra -Werror both/*.c -x none '"$(pkg-config --cflags --libs plgen)"' \
		-lm -o both/app' 2>>log
	runs "two bundles beside a model with the library, $language" 300 both/app
done
tap_end
