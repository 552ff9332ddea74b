#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# A CMake project outside against what is installed: plgen_add_model, plgen::runtime, float and bundle, and that a model
# is made anew when its data has changed, and only then.
#
#     cmake.sh BUILD SOURCE_ROOT
set -u
build=$(cd "$1" && pwd) || exit 99
root=$(cd "$2" && pwd) || exit 99
. "${0%/*}/../tap.sh"
if ! command -v cmake >/dev/null 2>&1; then
	skip 'a project of CMake' 'cmake is not installed'
	tap_end
fi
. "$root/tests/install/stage.sh"

cat >"$project/CMakeLists.txt" <<'END'
cmake_minimum_required(VERSION 3.16)
project(outside C)
find_package(plgen 0.1 REQUIRED)
plgen_add_model(drive SPEC "the models/drive.spec")
add_executable(app main.c)
target_link_libraries(app PRIVATE drive)
add_subdirectory(single)
add_subdirectory(whole)
END
mkdir "$project/single" "$project/whole"
cat >"$project/single/CMakeLists.txt" <<'END'
plgen_add_model(single SPEC "../the models/drive.spec" REAL float OPTIONS --rhs)
add_executable(app_single ../main_single.c)
target_link_libraries(app_single PRIVATE single)
END
sed 's/drive\.h/single.h/; s/REAL double/REAL float/' "$project/main.c" >"$project/main_single.c"
cat >"$project/whole/CMakeLists.txt" <<'END'
plgen_add_model(whole SPEC "../the models/drive.spec" PREFIX drive BUNDLE)
add_executable(app_whole ../main_whole.c)
target_link_libraries(app_whole PRIVATE whole)
END
sed 's/drive\.h/whole.h/' "$project/main.c" >"$project/main_whole.c"

for generator in Ninja 'Unix Makefiles'; do
	out="$work/out of $generator"
	sed 's/^300/200/' "$project/the models/k and k.mtx" >original
	cp original "$project/the models/k and k.mtx"
	cmake -G "$generator" -S "$project" -B "$out" -DCMAKE_PREFIX_PATH="$prefix" \
		-DCMAKE_BUILD_TYPE=Release >log 2>&1 && cmake --build "$out" >>log 2>&1
	result $? "$generator: it builds"
	runs "$generator: a model in double" 200 "$out/app"
	runs "$generator: the same in float" 200 "$out/single/app_single"
	runs "$generator: the same with its runtime inside" 200 "$out/whole/app_whole"
	nm "$out/whole/libwhole.a" 2>>log | grep ' [UT] pl_' >undefined
	[ ! -s undefined ]
	result $? "$generator: a bundle needs nothing of the runtime"
	makes_again "$generator" "$out" cmake --build "$out"
	runs "$generator: it has the other matrix" 300 "$out/app"
done

# As doc/install.md has it
mkdir page
sed -n '/^```cmake/,/^```/p' "$root/doc/install.md" | sed '/^```/d' >page/CMakeLists.txt
cp "$project/the models/drive.spec" "$project/the models/k and k.mtx" page
sed 's/REAL double/REAL float/' "$project/main.c" >page/main.c
cmake -S page -B page/build -DCMAKE_PREFIX_PATH="$prefix" >log 2>&1 && cmake --build page/build >>log 2>&1
result $? 'it builds as the page has it'
runs 'a model as the page has it' 300 page/build/app

# What cannot be is told
printf 'cmake_minimum_required(VERSION 3.16)\nproject(outside C)\nfind_package(plgen %s REQUIRED)\n' 0.1 >CMakeLists.txt
echo 'plgen_add_model(drive)' >>CMakeLists.txt
cmake -S . -B wrong -DCMAKE_PREFIX_PATH="$prefix" >log 2>&1
[ $? -ne 0 ] && grep -q 'plgen_add_model(drive): SPEC FILE.spec is missing' log
result $? 'a model without a spec is refused by name'
sed -i '/plgen_add/d; s/plgen 0.1/plgen 2.0/' CMakeLists.txt
cmake -S . -B wrong2 -DCMAKE_PREFIX_PATH="$prefix" >log 2>&1
[ $? -ne 0 ] && grep -q 'requested version "2.0"' log
result $? 'a later version is asked for, and not found'
tap_end
