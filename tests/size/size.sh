#!/bin/sh
# size: bytes of the library; of the smallest program for a Cortex-M7 with each capability left out; of arenas.
# SPDX-License-Identifier: MIT
# usage: BUILD=... MAKE=... CC=... CFLAGS=... SIZE=... M7_CFLAGS=... size.sh          (`make size`)
#
# Code is .text and .rodata after --gc-sections, as the linker's map has it: what comes from libsmr.a, and what from libc,
# libm and libgcc. The program itself (tests/size/smallest.c, some hundred bytes) counts in the total only.
set -eu
export LC_ALL=C
unset MAKEFLAGS MFLAGS
. tests/without/same.inc
build=$BUILD/size
whole=$BUILD/m7-board rest=$BUILD/without/m7 # what the boards' checks compile with -O2, too
capabilities='image partial track contact dynamics references'
jobs=$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 1)
mkdir -p "$build"

# library DIRECTORY OPTIMISATION [CAPABILITY...]: builds libsmr.a for the Cortex-M7 there, without the capabilities.
library() {
    dir=$1 flags="$M7_CFLAGS $2"
    shift 2
    [ $# -eq 0 ] || same_objects "$whole" "$dir" "$@"
    ${MAKE:-make} -s -j"$jobs" BUILD="$dir" CC=arm-none-eabi-gcc AR=arm-none-eabi-ar CFLAGS="$flags" WITHOUT="$*" "$dir/libsmr.a"
}

# code MAP: bytes from the library, from libc and its like, and in all.
code() {
    awk '
        function number(hex,   i, n) {
            for (i = 3; i <= length(hex); i++) n = 16 * n + index("0123456789abcdef", substr(hex, i, 1)) - 1
            return n
        }
        /^Linker script and memory map/ { on = 1 }
        !on { next }
        /^\.[a-zA-Z]/ { counted = $1 == ".text" || $1 == ".rodata"; if (counted && NF >= 3) all += number($3) }
        /^ \.[^ ]+$/ { long_name = 1; next }
        counted && (long_name || /^ \.[^ ]+ +0x/) {
            size = long_name ? $2 : $3
            file = long_name ? $3 : $4
            if (file ~ /libsmr\.a\(/) library += number(size)
            else if (file ~ /lib(c|c_nano|m|g|g_nano|gcc)\.a\(/) other += number(size)
        }
        { long_name = 0 }
        END { print library + 0, other + 0, all + 0 }' "$1"
}

# program DIRECTORY TEXT: links the smallest program with the library there, and prints a row.
program() {
    # shellcheck disable=SC2086
    arm-none-eabi-gcc -std=c11 -ffp-contract=off -fno-math-errno $M7_CFLAGS -O2 -Iinclude -nostartfiles -Wl,--gc-sections \
        -Wl,-e,main -Wl,-Map,"$1/smallest.map" tests/size/smallest.c "$1/libsmr.a" -lm -o "$1/smallest.elf"
    row=$(code "$1/smallest.map")
    : "${first:=$row}"
    echo "$2 $row $first" | awk '{ printf "  %-12s %9d %9d %9d %9d\n", $1, $4, $7 - $4, $2, $3 }'
}

echo "libsmr.a, $($CC -dumpmachine), -O3:"
$SIZE -t "$BUILD/libsmr.a" | sed -n '1p;$p'
if command -v arm-none-eabi-gcc >/dev/null; then
    for o in -O2 -Os; do
        [ $o = -O2 ] && dir=$whole || dir=$build/m7-Os
        library "$dir" $o
        echo "libsmr.a, Cortex-M7, $o:"
        arm-none-eabi-size -t "$dir/libsmr.a" | sed -n '1p;$p'
    done
    echo 'The smallest program, Cortex-M7, -O2, bytes of code and constants:'
    printf '  %-12s %9s %9s %9s %9s\n' 'left out' total less libsmr.a libc
    program "$whole" nothing
    for one in $capabilities; do
        library "$build/no-$one" -O2 "$one"
        program "$build/no-$one" "$one"
    done
    # shellcheck disable=SC2086
    library "$rest" -O2 $capabilities
    program "$rest" 'all-six'
else echo 'Cortex-M7: skipped (needs gcc-arm-none-eabi)'; fi

# shellcheck disable=SC2086
$CC -std=c11 $CFLAGS -DSMALLEST_RAM -Iinclude tests/size/smallest.c "$BUILD/libsmr.a" -lm -o "$build/smallest"
echo 'smr_arena_bytes() of a closed surface of 3,500 vertices, one worker; and what settings add:'
"$build/smallest"
