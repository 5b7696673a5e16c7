#!/bin/sh
# check_traps: the golden run with traps on for division by zero, invalid operations and overflow: the library raises none,
# not in unused lanes of vectors either; nor has it a fused multiply-add (check_fused.sh). Fixtures are compiled without vectors: they are no part of the library.
# SPDX-License-Identifier: MIT
# The library is the one that `make hashes` compiles for its row of -O3 -march=native; SMR_FULL=1: clang's, too.
set -u
. tests/checks.inc
need_plain
flags='-std=c11 -ffp-contract=off -fno-math-errno -Iinclude -Isrc -Ifixtures -Iport/pthread'
cat >"$tmp/traps.c" <<'END'
#define _GNU_SOURCE
#include <fenv.h>
__attribute__((constructor)) static void traps_on(void) { (void)feenableexcept(FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW); }
END
echo 'int main(void) { volatile float zero = 0.0f; zero = 1.0f / zero; return 0; }' >"$tmp/divides.c"
$cc "$tmp/traps.c" "$tmp/divides.c" -lm -o "$tmp/divides" 2>/dev/null || { echo "skip: no feenableexcept"; exit 77; }
sh -c '"$0"; exit $?' "$tmp/divides" 2>/dev/null && { echo "skip: this processor does not trap"; exit 77; }
for file in fixtures/fixture_[!w]*.c tests/golden/golden*.c tests/golden/print.c "$tmp/traps.c"; do
    # shellcheck disable=SC2086
    $cc $flags -Itests/golden -O1 -fno-tree-vectorize -c "$file" -o "$tmp/$(basename "$file" .c).o" || exit 1
done
unset CFLAGS LDFLAGS
compilers=gcc
full && compilers='gcc clang'
for compiler in $compilers; do
    have $compiler || { skip $compiler "needs $compiler"; continue; }
    dir=$build/hashes/$compiler-O3-marchnative
    check "$compiler: built" ${MAKE:-make} -s BUILD="$dir" CC=$compiler CFLAGS='-O3 -march=native' "$dir/libsmr.a" "$dir/libsmr_pthread.a" &&
        $compiler "$tmp"/*.o "$dir/libsmr_pthread.a" "$dir/libsmr.a" -pthread -lm -o "$tmp/golden" || { not_ok "$compiler: links"; continue; }
    have objdump && same "$compiler -O3 -march=native: no fused multiply-add" "$(objdump -d "$dir/libsmr.a" | grep -oE "$fused" | sort -u | tr '\n' ' ')" ''
    ("$tmp/golden") >"$tmp/line" 2>&1
    same "$compiler -O3 -march=native, status and hash" "$? $(cat "$tmp/line")" "0 $(cat tests/golden/expected.txt)"
done
finish
