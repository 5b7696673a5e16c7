#!/bin/sh
# check_fused: no fused multiply-add where -ffp-contract=off asked for none: gcc 12 makes vfmaddsub of a difference beside a
# sum for AVX-512 all the same, and such bits are another processor's. Compiles the core and the fixtures for that.
# SPDX-License-Identifier: MIT
# usage: CC=... check_fused.sh
set -u
cc=${CC:-cc}
case ${CFLAGS:-} in *sanitize*) echo "skip: an instrumented build, and its compiler has been asked without"; exit 77 ;; esac
tmp=$(mktemp -d) || exit 1
trap 'rm -rf "$tmp"' EXIT
command -v objdump >/dev/null 2>&1 || { echo "skip: no objdump"; exit 77; }
flags='-std=c11 -ffp-contract=off -fno-math-errno -O3 -march=x86-64-v4'
echo 'int smr_nothing;' >"$tmp/a.c"
# shellcheck disable=SC2086
$cc $flags -c "$tmp/a.c" -o "$tmp/a.o" 2>/dev/null || { echo "skip: $cc does not compile for AVX-512"; exit 77; }
bad=0
n=0
for width in 256 512; do
    for file in $(find src -name "*.c") fixtures/fixture_[!w]*.c; do
        # shellcheck disable=SC2086
        $cc $flags -mprefer-vector-width=$width -Iinclude -Isrc -Ifixtures -c "$file" -o "$tmp/a.o" || exit 1
        n=$((n + 1))
        if objdump -d "$tmp/a.o" | grep -qE 'vfn?m(add|sub)'; then
            echo "FUSED: $file, vectors of $width bits:" "$(objdump -d "$tmp/a.o" | grep -oE 'vfn?m[a-z0-9]+' | sort -u | tr '\n' ' ')"
            bad=1
        fi
    done
done
[ "$bad" -eq 0 ] && echo "OK: $n compilations without fused operations"
exit "$bad"
