#!/bin/sh
# check_header: smr.h compiles alone as C99, C11 and C++, and its macros serve static storage.
# SPDX-License-Identifier: MIT
set -u
. tests/checks.inc
strict='-Wall -Wextra -Wconversion -Wshadow -Wcast-qual -pedantic -pedantic-errors -Werror -fsyntax-only -Iinclude'
printf '#include <smr.h>\nint smr_check_header;\n' >"$tmp/alone.c"
cp "$tmp/alone.c" "$tmp/alone.cpp"
{
    cat "$tmp/alone.c"
    echo 'static _Alignas(SMR_ALIGN) unsigned char arena[SMR_ARENA_BYTES(1000, 2000, 3, 2, 500, SMR_METHOD_POLAR)];'
    echo 'unsigned char *smr_check_arena(void); unsigned char *smr_check_arena(void) { return arena; }'
} >"$tmp/static.c"
cxx=
case $cc in *clang*) set -- clang++ g++ c++ ;; *) set -- g++ c++ clang++ ;; esac
for candidate in ${CXX:-} "$@"; do if [ -z "$cxx" ] && have "$candidate"; then cxx=$candidate; fi; done
# Compiler, file and flags; C++98 has no long long in its text, but every compiler has it.
while read -r compiler file flags; do
    [ -n "$compiler" ] || continue
    # shellcheck disable=SC2086
    check "$file $flags" $compiler $strict $flags "$tmp/$file"
done <<END
$cc alone.c -std=c99
$cc alone.c -std=c11
$cc static.c -std=c11
$cxx${cxx:+ alone.cpp -std=c++98 -Wno-long-long}
$cxx${cxx:+ alone.cpp -std=c++11}
$cxx${cxx:+ alone.cpp -std=c++17}
END
[ -n "$cxx" ] || skip 'C++' 'needs g++ or clang++'
finish
