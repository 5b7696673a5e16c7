#!/bin/sh
# check_self_test: smr_self_test() names what compiler flags did to float arithmetic; -ffast-math does not compile.
# SPDX-License-Identifier: MIT
# usage: CC=... check_self_test.sh
set -u
cc=${CC:-cc}
tmp=$(mktemp -d) || exit 1
trap 'rm -rf "$tmp"' EXIT
passed=0; failed=0; skipped=0
good='-std=c11 -ffp-contract=off -fno-math-errno'
printf '#include <smr.h>\nint main(void) { return (int)smr_self_test(); }\n' >"$tmp/main.c"
echo 'int main(void) { return 0; }' >"$tmp/nothing.c"

# The sum of SMR_FLOAT_... that the program must return, why it is skipped where it is, and the flags.
expect() { # sum flags...
    want=$1; shift
    # shellcheck disable=SC2086
    if ! $cc $good "$@" "$tmp/nothing.c" -o "$tmp/nothing" 2>/dev/null || ! "$tmp/nothing" 2>/dev/null; then
        skipped=$((skipped + 1)); echo "skipped: $cc or this processor does not know $*"; return
    fi
    # shellcheck disable=SC2086
    $cc $good "$@" -Iinclude -Isrc "$tmp/main.c" src/base/self_test.c -o "$tmp/run" -lm || { failed=$((failed + 1)); return; }
    "$tmp/run"
    got=$?
    if [ "$got" -eq "$want" ]; then passed=$((passed + 1)); else
        failed=$((failed + 1)); echo "$cc $*: smr_self_test() is $got, expected $want"
    fi
}

refuse() { # words of the message, flags...
    words=$1; shift
    # shellcheck disable=SC2086
    if $cc $good "$@" -Iinclude -Isrc -c src/base/self_test.c -o "$tmp/a.o" >"$tmp/log" 2>&1; then
        failed=$((failed + 1)); echo "$cc $*: src/base/self_test.c compiles, expected an error"
    elif grep -q -e "$words" "$tmp/log"; then passed=$((passed + 1)); else
        failed=$((failed + 1)); echo "$cc $*: the error does not say '$words':"; cat "$tmp/log"
    fi
}

for level in -O0 -O1 -O2 -O3 '-O3 -march=native'; do
    # shellcheck disable=SC2086
    expect 0 $level
done
refuse 'ffast-math changes results' -O2 -ffast-math
fma=0
grep -qw fma /proc/cpuinfo 2>/dev/null && fma=1
if [ "$(uname -m)" = x86_64 ] && [ $fma = 1 ]; then
    expect 1 -O2 -ffp-contract=fast -march=haswell
    expect 1 -O3 -ffp-contract=fast -march=haswell
    expect 1 -O2 -ffp-contract=fast -mfma
else
    skipped=$((skipped + 1)); echo "skipped: no fused multiply-add here"
fi
expect 4 -O2 -fassociative-math -fno-signed-zeros -fno-trapping-math
case $(uname -m)-$($cc --version | head -n 1) in
*clang*) ;; # has no x87 for float
x86_64-*)
    refuse 'float arithmetic must be done in float' -O2 -mfpmath=387
    expect 4 -O2 -mfpmath=387 '-D_Static_assert(...)=' ;;
esac
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
