#!/bin/sh
# check_fused: no fused multiply-add where -ffp-contract=off asked for none: gcc 12 makes vfmaddsub of a difference beside a
# sum for AVX-512 all the same, and such bits are another processor's. Compiles the core and the fixtures for that.
# SPDX-License-Identifier: MIT
# Vectors of 512 bits; SMR_FULL=1: of 256, too, and clang.
set -u
. tests/checks.inc
need_plain
need objdump
echo 'int smr_nothing;' >"$tmp/a.c"
fused() { # compiler, bits of a vector
    flags="-std=c11 -ffp-contract=off -fno-math-errno -O3 -march=x86-64-v4 -mprefer-vector-width=$2 -Iinclude -Isrc -Ifixtures"
    # shellcheck disable=SC2086
    $1 $flags -c "$tmp/a.c" -o "$tmp/a.o" 2>/dev/null || { skip "$*" "$1 does not compile for AVX-512"; return; }
    for file in $(find src -name "*.c") fixtures/fixture_[!w]*.c; do
        # shellcheck disable=SC2086
        $1 $flags -c "$file" -o "$tmp/a.o" || exit 1
        same "$1, vectors of $2 bits: $file" "$(objdump -d "$tmp/a.o" | grep -oE 'vfn?m(add|sub)[a-z0-9]*' | sort -u | tr '\n' ' ')" ''
    done
}
fused "$cc" 512
if full; then
    fused "$cc" 256
    have clang && fused clang 512
fi
finish
