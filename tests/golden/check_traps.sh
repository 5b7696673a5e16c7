#!/bin/sh
# check_traps: the golden run with traps on for division by zero, invalid operations and overflow: the library raises none,
# not in unused lanes of vectors either. Fixtures are compiled without vectors: they are no part of the library.
# SPDX-License-Identifier: MIT
# usage: CC=... check_traps.sh [levels]
set -u
cc=${CC:-cc}
case ${CFLAGS:-} in *sanitize*) echo "skip: an instrumented build, and its compiler has been asked without"; exit 77 ;; esac
tmp=$(mktemp -d) || exit 1
trap 'rm -rf "$tmp"' EXIT
passed=0; failed=0
flags='-std=c11 -ffp-contract=off -fno-math-errno -Iinclude -Isrc -Ifixtures -Iport/pthread'
cat >"$tmp/traps.c" <<'END'
#define _GNU_SOURCE
#include <fenv.h>
__attribute__((constructor)) static void traps_on(void) { (void)feenableexcept(FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW); }
END
cat >"$tmp/divides.c" <<'END'
int main(void) { volatile float zero = 0.0f; zero = 1.0f / zero; return 0; }
END
$cc "$tmp/traps.c" "$tmp/divides.c" -lm -o "$tmp/divides" 2>/dev/null || { echo "skip: no feenableexcept"; exit 77; }
sh -c '"$0"; exit $?' "$tmp/divides" 2>/dev/null && { echo "skip: this processor does not trap"; exit 77; }
# shellcheck disable=SC2086
for file in fixtures/fixture_[!w]*.c tests/golden/golden*.c tests/golden/print.c port/pthread/smr_pthread.c "$tmp/traps.c"; do
    $cc $flags -Itests/golden -O1 -fno-tree-vectorize -c "$file" -o "$tmp/$(basename "$file" .c).o" || exit 1
done
for level in "${@:--O3 -march=native}"; do
    mkdir -p "$tmp/core"
    for file in $(find src -name '*.c'); do
        # shellcheck disable=SC2086
        $cc $flags $level -c "$file" -o "$tmp/core/$(basename "$file" .c).o" || exit 1
    done
    $cc "$tmp"/*.o "$tmp"/core/*.o -pthread -lm -o "$tmp/golden" || exit 1
    ("$tmp/golden") >"$tmp/line" 2>&1
    status=$?
    if [ $status -eq 0 ] && cmp -s "$tmp/line" tests/golden/expected.txt; then passed=$((passed + 1)); else
        failed=$((failed + 1))
        echo "$cc $level: status $status, '$(cat "$tmp/line")', expected '$(cat tests/golden/expected.txt)'"
    fi
done
echo "$passed passed, $failed failed, 0 skipped"
[ "$failed" -eq 0 ]
