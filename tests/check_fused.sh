#!/bin/sh
# check_fused: no fused multiply-add where -ffp-contract=off asked for none: gcc 12 makes vfmaddsub of a difference beside a
# sum for AVX-512 all the same, and such bits are another processor's. Compiles the core and the fixtures for that.
# SPDX-License-Identifier: MIT
# Vectors of 512 bits; SMR_FULL=1: of 256, too, and clang. For a processor with AVX-512 check_traps.sh has the library of
# -march=native, whose vectors have 256 bits, and looks at that; the fixtures are left.
set -u
. tests/checks.inc
need_plain
top=$PWD
fixtures=$(ls "$top"/fixtures/fixture_[!w]*.c)
core=$(find "$top/src" -name '*.c') least=$core
echo 'int smr_nothing;' >"$tmp/a.c"
fused() { # compiler, bits of a vector, sources
    flags="-std=c11 -ffp-contract=off -fno-math-errno -O3 -march=x86-64-v4 -mprefer-vector-width=$2 -I$top/include -I$top/src -I$top/fixtures"
    # shellcheck disable=SC2086
    $1 $flags -c "$tmp/a.c" -o "$tmp/a.o" 2>/dev/null || { skip "$1, $2" "$1 does not compile for AVX-512"; return; }
    mkdir "$tmp/$1$2"
    # shellcheck disable=SC2086
    (cd "$tmp/$1$2" && $1 $flags -S $3) || { not_ok "$1, $2: compiles"; return; }
    same "$1, vectors of $2 bits, $(ls "$tmp/$1$2" | wc -l) files" "$(cd "$tmp/$1$2" && grep -oE "$fused" ./*.s | sort -u | tr '\n' ' ')" ''
}
fused "$cc" 512 "$core $fixtures"
if full; then
    $cc -march=native -dM -E -x c /dev/null 2>/dev/null | grep -q __AVX512VL__ && least=
    fused "$cc" 256 "$least $fixtures"
    ! have clang || fused clang 512 "$core $fixtures"
fi
finish
