#!/bin/sh
# check_symbols: the core calls nothing but a short list of functions and holds no writable memory.
# SPDX-License-Identifier: MIT
# usage: BUILD=... check_symbols.sh [archive [tool prefix]]
set -u
archive=${1:-${BUILD:-build}/libsmr.a}
prefix=${2:-}
# bcmp: what clang makes of memcmp(...) == 0. The rest is the compiler's own arithmetic, in its library, which it calls where a
# processor has no instruction: of 64-bit numbers on 32-bit ones, of floats without an FPU, of trailing zeros.
arithmetic='__aeabi_[a-z0-9]+|__(u?div|u?mod|u?divmod|mul|ashl|ashr|lshr|neg|ctz|clz|popcount|u?cmp)[sd]i[234]'
arithmetic="$arithmetic|__(add|sub|mul|div|neg)sf[23]|__(eq|ne|lt|le|gt|ge|cmp|unord)sf2|__fix(uns)?sf[sd]i|__float(un)?[sd]isf"
allowed="^(memcpy|memmove|memset|memcmp|bcmp|sqrtf|$arithmetic)\$"
[ -f "$archive" ] || { echo "skip: no $archive"; exit 77; }
if [ "$("${prefix}ar" t "$archive" | wc -l)" -eq 0 ]; then echo "skip: $archive is empty"; exit 77; fi
tmp=$(mktemp -d) || exit 1
trap 'rm -rf "$tmp"' EXIT
"${prefix}ld" -r --whole-archive "$archive" -o "$tmp/all.o" || { echo "skip: no partial link"; exit 77; }
"${prefix}nm" -P "$tmp/all.o" >"$tmp/symbols"
if grep -qE '__(asan|ubsan|tsan|msan|gcov|llvm_prof)' "$tmp/symbols"; then
    echo "skip: an instrumented build"
    exit 77
fi
bad=0
undefined=$(awk '$2 == "U" || $2 == "w" || $2 == "v" {print $1}' "$tmp/symbols" | grep -v '^_GLOBAL_OFFSET_TABLE_$' |
    grep -vE "$allowed" || true)
[ -z "$undefined" ] || { echo "FORBIDDEN: the core calls:" $undefined; bad=1; }
common=$(awk '$2 == "C" {print $1}' "$tmp/symbols")
[ -z "$common" ] || { echo "FORBIDDEN: common symbols:" $common; bad=1; }
# Sections that would be writable or run code before main; .data.rel.ro is constant after loading.
writable=$("${prefix}size" -A "$tmp/all.o" | awk '$2 > 0 && $1 !~ /^\.data\.rel\.ro/ &&
    $1 ~ /^\.(data|bss|tdata|tbss|init_array|fini_array|ctors|dtors)/ {print $1 "=" $2}')
[ -z "$writable" ] || { echo "FORBIDDEN: writable or start-up sections:" $writable; bad=1; }
names=$(awk '$2 ~ /^[TDBRGSVW]$/ && $1 !~ /^(smr_|__x86\.get_pc_thunk\.)/ {print $1}' "$tmp/symbols") # thunks: GCC's own
[ -z "$names" ] || { echo "FORBIDDEN: external names without smr_:" $names; bad=1; }
[ "$bad" -eq 0 ] && echo "OK: externals:" $(awk '$2 == "U" {print $1}' "$tmp/symbols" | sort)
exit "$bad"
