#!/bin/sh
# check_without: each capability left out, and all six: the library builds, refuses what it must, and its runs keep their bits.
# SPDX-License-Identifier: MIT
# usage: BUILD=... CC=... check_without.sh
# The golden run prints "-" for a run that needs what is left out, and ends with 2; every other word is as expected. With a
# compiler and an emulator for Cortex-M7 the golden run without all six is run there, too.
set -u
. tests/checks.inc
. tests/without/same.inc
. tests/target/board.sh
need_plain
[ "${SMR_AGAIN:-0}" = 0 ] || { echo "skip: checked with the first compiler"; exit 77; }
capabilities='image partial track contact dynamics references'
jobs=$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 1)

# make_without DIR WORDS TARGET...: a build in $build/without/DIR. What sees a capability compiles sooner with -O0.
make_without() {
    place=$build/without/$1 left_out=$2
    shift 2
    # shellcheck disable=SC2086
    same_objects "$build" "$place" $left_out
    env -u MAKEFLAGS -u MFLAGS "${MAKE:-make}" -s -j"$jobs" BUILD="$place" WITHOUT="$left_out" CC="$cc" CFLAGS=-O0 "$@"
}

# as_expected LINE WORDS: the golden line but for "-", some words among them are there, and what was left out is named.
as_expected() {
    awk -v left_out="$2" '
        NR == FNR { n = split($0, want, " "); next }
        FNR == 1 { for (i = 1; i <= n; i++) if ($i == want[i]) same++; else if ($i != "-") wrong = 1 }
        FNR == 2 { named = $0 == "built without " left_out }
        END { exit !(!wrong && same >= 4 && named) }' tests/golden/expected.txt "$1"
}

mkdir -p "$build/without"
$cc -std=c11 -Wall -Wextra -O1 -Iinclude tests/without/refusals.c "$build/libsmr.a" -o "$tmp/whole" &&
    "$tmp/whole" write "$tmp/saved" || { not_ok 'saves and logs of the whole library'; finish; }
check 'the whole library refuses nothing' "$tmp/whole" check "$tmp/saved"
env -u MAKEFLAGS -u MFLAGS "${MAKE:-make}" -s BUILD="$build" amalgamation || { not_ok 'the amalgamation'; finish; }
all_six=$build/without/$(echo "$capabilities" | tr ' ' -)
for words in $capabilities "$capabilities"; do
    place=$(echo "$words" | tr ' ' -)
    library=$build/without/$place/libsmr.a golden=$build/without/$place/golden
    make_without "$place" "$words" "$library" "$golden" >"$tmp/make" 2>&1 || { not_ok "$words: does not build"; cat "$tmp/make"; continue; }
    [ "$words" = "$capabilities" ] || check "$words: the amalgamation compiles" $cc -std=c11 -Wall -Wextra -Werror -fsyntax-only \
        "-DSMR_WITHOUT_$(echo "$words" | tr a-z A-Z)" "$build/amalgamation/smr.c"
    "$golden" >"$tmp/golden"
    check "$words: the golden run ends with 2" [ $? -eq 2 ]
    check "$words: the golden run" as_expected "$tmp/golden" "$words"
    $cc -std=c11 -O1 -Iinclude tests/without/refusals.c "$library" -lm -o "$tmp/part" || exit 1
    # shellcheck disable=SC2086
    check "$words: refusals" "$tmp/part" check "$tmp/saved" $words
done

check 'the program builds' make_without "$(basename "$all_six")" "$capabilities" "$all_six/smr"
"$all_six/smr" info x >"$tmp/said" 2>&1
check 'the program ends with 2' [ $? -eq 2 ]
check 'the program says what it was built without' grep -qx "smr: built without $capabilities" "$tmp/said"
for o in -O0 -O1; do
    check "amalgamation without all six, $o" $cc -std=c11 -Wall -Wextra -Werror $o -ffp-contract=off -fno-math-errno \
        -DSMR_WITHOUT_IMAGE -DSMR_WITHOUT_PARTIAL -DSMR_WITHOUT_TRACK -DSMR_WITHOUT_CONTACT -DSMR_WITHOUT_DYNAMICS \
        -DSMR_WITHOUT_REFERENCES \
        "$build/amalgamation/smr.c" tests/without/refusals.c -Iinclude -lm -o "$tmp/one"
    # shellcheck disable=SC2086
    check "amalgamation without all six, $o: refusals" "$tmp/one" check "$tmp/saved" $capabilities
done

# CMake's options.
if full && have cmake; then
    root=$(pwd)
    mkdir "$tmp/cmake"
    printf '%s\n' 'cmake_minimum_required(VERSION 3.13)' 'project(without C)' "add_subdirectory($root/port/cmake smr)" \
        "add_executable(refusals $root/tests/without/refusals.c)" 'target_link_libraries(refusals smr::smr)' \
        >"$tmp/cmake/CMakeLists.txt"
    configure() { cmake -S "$tmp/cmake" -B "$tmp/cmake/build" -DCMAKE_C_COMPILER="$cc" -DSMR_WITHOUT_IMAGE=ON -DSMR_WITHOUT_TRACK=ON "$@"; }
    check 'CMake: configures' configure
    check 'CMake: -O3 without a build type' grep -q -e ' -O3' "$tmp/cmake/build/smr/CMakeFiles/smr.dir/flags.make"
    check 'CMake: configures for a quick build' configure -DCMAKE_C_FLAGS=-O0
    check 'CMake: builds' cmake --build "$tmp/cmake/build" -j "$jobs"
    check 'CMake: refusals' "$tmp/cmake/build/refusals" check "$tmp/saved" image track
fi

if [ "${SMR_NO_BOARDS:-0}" = 1 ] || [ -z "${M7_CFLAGS:-}" ] || ! have arm-none-eabi-gcc || ! have qemu-system-arm; then
    skip 'Cortex-M7' 'needs arm-none-eabi-gcc and qemu-system-arm'
else
    board=$build/without/m7
    board_set m7
    # shellcheck disable=SC2086
    board_build golden >/dev/null && same_objects "$build/m7-board" "$board" $capabilities
    check 'Cortex-M7 without all six builds' env -u MAKEFLAGS -u MFLAGS "${MAKE:-make}" -s -j"$jobs" BUILD="$board" \
        CC=arm-none-eabi-gcc AR=arm-none-eabi-ar CFLAGS="$M7_CFLAGS -O2 -DSMR_BAREMETAL" WITHOUT="$capabilities" \
        "$board/golden_m7.elf"
    timeout 300 qemu-system-arm -M mps2-an500 -nographic -monitor none -serial none \
        -semihosting-config enable=on,target=native -icount shift=6 -kernel "$board/golden_m7.elf" >"$tmp/board" 2>&1
    check 'Cortex-M7: the golden run ends with 2' [ $? -eq 2 ]
    check 'Cortex-M7: the golden run' as_expected "$tmp/board" "$capabilities"
fi
finish
