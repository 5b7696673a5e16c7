#!/bin/sh
# check_api: functions, layouts of structs, values and cookies of the public headers are those of tests/api/expected.txt.
# SPDX-License-Identifier: MIT
# usage: check_api.sh [--update]     A number "8|4" is that of 64-bit pointers and that of 32-bit pointers.
set -u
. tests/checks.inc
cookies=$(grep -rhoE "SMR_COOKIE\('.', *[a-z_]+\)" src | sort -u | sed "s/.*'\(.\)', *\(.*\))/\1:\2/" | paste -s -d ' ')
flags='-std=c11 -ffp-contract=off -Iinclude -Iport/pthread'
# shellcheck disable=SC2086
echo '#include <smr_pthread.h>' | $cc $flags -E -dD -x c - |
    awk -v source="$tmp/numbers.c" -v cookies="$cookies" -f tests/api/list.awk >"$tmp/lines"
sed -n '/define SMR_COOKIE(/,/[^\\]$/p' src/base/base.h | cat - "$tmp/numbers.c" >"$tmp/all.c"
# The sizes of its arrays, as "number value" lines: COMPILER FLAGS... FILE.
numbers() {
    to=$1
    shift
    # shellcheck disable=SC2086
    "$@" $flags -ffreestanding -c "$tmp/all.c" -o "$tmp/all.o" 2>"$tmp/$to.log" &&
        nm -P "$tmp/all.o" | awk '{ sub(/^smr_api_/, ""); print $1, $4 }' >"$tmp/$to" && [ -s "$tmp/$to" ]
}
numbers wide $cc || { not_ok "the interface does not compile"; cat "$tmp/wide.log"; finish; }
numbers narrow arm-none-eabi-gcc || numbers narrow clang --target=armv7m-none-eabi ||
    numbers narrow $cc -m32 -malign-double || rm -f "$tmp/narrow"
touch "$tmp/narrow"
awk 'function value(hex,    v, i) { v = 0
         for (i = 1; i <= length(hex); i++) v = 16 * v + index("0123456789abcdef", tolower(substr(hex, i, 1))) - 1
         return v - 1 }
    FILENAME ~ /wide$/ { wide[$1] = value($2); next }
    FILENAME ~ /narrow$/ { narrow[$1] = value($2); next }
    {
        while (match($0, /@[0-9]+@/)) {
            k = substr($0, RSTART + 1, RLENGTH - 2); shown = wide[k]
            if ($1 == "value") { $0 = "value " $2 " " wide[k] - 1000; break }
            if ((k in narrow) && narrow[k] != wide[k]) shown = shown "|" narrow[k]
            $0 = substr($0, 1, RSTART - 1) shown substr($0, RSTART + RLENGTH)
        }
        print
    }' "$tmp/wide" "$tmp/narrow" "$tmp/lines" | sort >"$tmp/found"
if [ "${1:-}" = --update ]; then
    [ -s "$tmp/narrow" ] || { echo 'api: no compiler for 32-bit pointers'; exit 1; }
    cp "$tmp/found" tests/api/expected.txt
    exit
fi
cp tests/api/expected.txt "$tmp/expected"
if [ ! -s "$tmp/narrow" ]; then
    skip 'layouts of 32-bit pointers' 'no compiler for them'
    for list in found expected; do sed 's/|[0-9]*//g' "$tmp/$list" >"$tmp/cut" && mv "$tmp/cut" "$tmp/$list"; done
fi
gone=$(comm -23 "$tmp/expected" "$tmp/found" | tee "$tmp/gone" | wc -l)
new=$(comm -13 "$tmp/expected" "$tmp/found" | tee "$tmp/new" | wc -l)
sed 's/^/#   - /' "$tmp/gone"
sed 's/^/#   + /' "$tmp/new"
if [ $((gone + new)) -eq 0 ]; then ok "the interface: $(wc -l <"$tmp/found") lines"
else not_ok "the interface has changed: $((gone)) lines gone, $((new)) new; make api-update accepts the change"; fi
# Every function that the headers declare is in the archives.
if [ -f "$build/libsmr_pthread.a" ]; then
    sed -n 's/^call [^(]*[ *]\(smr_[a-z0-9_]*\)(.*/\1/p' "$tmp/found" | sort >"$tmp/declared"
    "${NM:-nm}" -g --defined-only -P "$build/libsmr.a" "$build/libsmr_pthread.a" 2>/dev/null | awk 'NF > 2 { print $1 }' |
        sort -u | comm -23 "$tmp/declared" - >"$tmp/lost"
    same 'functions without a definition' "$(paste -s -d ' ' "$tmp/lost")" ''
fi
finish
