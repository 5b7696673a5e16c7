#!/bin/sh
# check_header: smr.h compiles alone as C99, C11 and C++, and its macros serve static storage.
# SPDX-License-Identifier: MIT
set -u
cc=${CC:-cc}
tmp=$(mktemp -d) || exit 1
trap 'rm -rf "$tmp"' EXIT
passed=0; failed=0; skipped=0
strict='-Wall -Wextra -Wconversion -Wshadow -Wcast-qual -pedantic -pedantic-errors -Werror -fsyntax-only'

printf '#include <smr.h>\nint smr_check_header;\n' >"$tmp/alone.c"
cp "$tmp/alone.c" "$tmp/alone.cpp"
{
    cat "$tmp/alone.c"
    echo 'static _Alignas(SMR_ALIGN) unsigned char arena[SMR_ARENA_BYTES(1000, 2000, 3, 2, 500, SMR_METHOD_POLAR)];'
    echo 'unsigned char *smr_check_arena(void); unsigned char *smr_check_arena(void) { return arena; }'
} >"$tmp/static.c"

try() { # what, command...
    what=$1; shift
    # shellcheck disable=SC2086
    if "$@" $strict -Iinclude >"$tmp/log" 2>&1; then passed=$((passed + 1)); else
        failed=$((failed + 1)); echo "$what:"; cat "$tmp/log"
    fi
}
try 'C99' $cc -std=c99 "$tmp/alone.c"
try 'C11' $cc -std=c11 "$tmp/alone.c"
try 'static storage' $cc -std=c11 "$tmp/static.c"
cxx=
case $cc in *clang*) set -- clang++ g++ c++ ;; *) set -- g++ c++ clang++ ;; esac
for candidate in ${CXX:-} "$@"; do
    if [ -z "$cxx" ] && command -v "$candidate" >/dev/null; then cxx=$candidate; fi
done
if [ -n "$cxx" ]; then
    for std in c++98 c++11 c++17; do
        extra=
        # C++98 has no long long in its text; every compiler has it.
        [ "$std" = c++98 ] && extra=-Wno-long-long
        # shellcheck disable=SC2086
        try "$std" "$cxx" -std=$std $extra "$tmp/alone.cpp"
    done
else
    skipped=1
    echo "C++: skipped (needs g++ or clang++)"
fi
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
