#!/bin/sh
# check_self_test: smr_self_test() names what compiler flags did to float arithmetic; -ffast-math does not compile.
# SPDX-License-Identifier: MIT
# usage: CC=... check_self_test.sh
set -u
. tests/checks.inc
need_plain
good='-std=c11 -ffp-contract=off -fno-math-errno -Iinclude -Isrc'
printf '#include <smr.h>\nint main(void) { return (int)smr_self_test(); }\n' >"$tmp/main.c"
refuses() { # words of the message, flags...
    words=$1
    shift
    # shellcheck disable=SC2086
    refuse "$*" "$words" $cc $good "$@" -c src/base/self_test.c -o "$tmp/a.o"
}

# A row: the sum of SMR_FLOAT_... that the program must return, and the flags.
while read -r want flags; do
    [ "$want" != 1 ] || grep -qw fma /proc/cpuinfo 2>/dev/null || { skip "$flags" 'no fused multiply-add here'; continue; }
    # shellcheck disable=SC2086
    known $good $flags || { skip "$flags" "$cc or this processor does not know them"; continue; }
    # shellcheck disable=SC2086
    $cc $good $flags "$tmp/main.c" src/base/self_test.c -o "$tmp/run" -lm || { not_ok "$flags compiles"; continue; }
    "$tmp/run"
    same "$flags: smr_self_test()" $? "$want"
done <<END
0 -O0
0 -O1
0 -O2
0 -O3
0 -O3 -march=native
1 -O2 -ffp-contract=fast -march=haswell
1 -O3 -ffp-contract=fast -march=haswell
1 -O2 -ffp-contract=fast -mfma
4 -O2 -fassociative-math -fno-signed-zeros -fno-trapping-math
END
refuses 'ffast-math changes results' -O2 -ffast-math
case $(uname -m)-$($cc --version | head -n 1) in
*clang*) ;; # has no x87 for float
x86_64-*)
    refuses 'float arithmetic must be done in float' -O2 -mfpmath=387
    # shellcheck disable=SC2086
    $cc $good -O2 -mfpmath=387 '-D_Static_assert(...)=' "$tmp/main.c" src/base/self_test.c -o "$tmp/run" -lm && "$tmp/run"
    same '-mfpmath=387: smr_self_test()' $? 4 ;;
esac
# NEON of Armv7 flushes denormals: clang uses it for lanes.
if have clang && have qemu-arm && have arm-linux-gnueabihf-gcc; then
    for row in 'neon 2' 'vfpv3 0'; do
        # shellcheck disable=SC2086
        clang --target=arm-linux-gnueabihf -mcpu=cortex-a9 -mfpu=${row% *} $good -O2 -static "$tmp/main.c" src/base/self_test.c \
            -o "$tmp/run" -lm && qemu-arm "$tmp/run"
        same "clang, Armv7 with ${row% *}: smr_self_test()" $? "${row#* }"
    done
else
    skip 'clang, Armv7 with NEON' 'needs clang, qemu-arm and gcc-arm-linux-gnueabihf'
fi
finish
