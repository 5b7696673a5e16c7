#!/bin/sh
# check_style: lengths of lines, functions and files, first lines, names of macros, no paths of a machine.
# SPDX-License-Identifier: MIT
set -u

# What does not keep the limits yet: patterns of `path: message`, one a line.
exempt='
'

tmp=$(mktemp) || exit 1
trap 'rm -f "$tmp"' EXIT
files=$(find src include port fixtures tests -name '*.[ch]' | sort)
scripts=$(find tests port -name '*.sh' | sort; [ -f .ci/run ] && echo .ci/run)

for file in $files $scripts; do
    case $file in
    include/smr.h) most=1355 ;;
    src/registration/shape/schedule_state.h) most=150 ;;
    *) most=420 ;;
    esac
    lines=$(wc -l <"$file")
    [ "$lines" -le $most ] || echo "$file: $lines lines, at most $most"
    head -n 40 "$file" | grep -q 'SPDX-License-Identifier: MIT' || echo "$file: no SPDX-License-Identifier"
    # What it is: its name and words in a C file's first line, words in a script's second one.
    case $file in
    *.[ch]) head -n 1 "$file" | grep -qE "^/\* ${file##*/}: [[:alnum:]]" ;;
    *) sed -n '2p' "$file" | grep -qE '^# .*[[:alpha:]]{2,}.*[[:alpha:]]{2,}' ;;
    esac || echo "$file: the first line does not say what it is"
done >"$tmp"

# shellcheck disable=SC2086
awk 'length($0) > 120 { print FILENAME ": line " FNR " has " length($0) " columns, at most 120" }' $files >>"$tmp"

# A function's body runs from a brace in the first column to the next one: 60 lines at most, nine in ten at most 25.
bodies='/^{/ { start = FNR; next } /^}/ && start { print FNR - start + 1, FILENAME, start; start = 0 }'
find src port fixtures tests -name '*.c' -exec awk "$bodies" {} + | sort -n >"$tmp.bodies"
awk '$1 > 60 { print $2 ": function at line " $3 " has " $1 " lines, at most 60" }' "$tmp.bodies" >>"$tmp"
awk '$2 ~ /^(src|port)\// { length_of[++n] = $1 }
    END { at = int(0.9 * n + 0.999999); if (length_of[at] > 25)
          print "src, port: nine in ten functions have at most " length_of[at] " lines, wanted: at most 25" }' \
    "$tmp.bodies" >>"$tmp"
rm -f "$tmp.bodies"

grep -rnE --include='*.[ch]' '^[[:space:]]*#[[:space:]]*define[[:space:]]' src include port/pthread port/template port/baremetal |
    grep -vE 'define[[:space:]]+(SMR_|smr_|_GNU_SOURCE|_POSIX_C_SOURCE)' | sed 's/$/   (macro without SMR_)/' >>"$tmp"
# Host code: macros that only one file sees may be short; those in a header carry the prefix.
grep -rnE --include='*.h' '^[[:space:]]*#[[:space:]]*define[[:space:]]' port/host |
    grep -vE 'define[[:space:]]+(HOST_|host_|SMR_|_[A-Z]|[A-Z0-9_]+_H$)' | sed 's/$/   (macro without HOST_)/' >>"$tmp"

# A slot of a registration says whether a save keeps it.
grep -rn 'smr_arena_take' src/registration src/options src/log src/verdict | sed 's/$/   (a slot without smr_slot_..., see base\/save_fields.h)/' >>"$tmp"

# The patterns are in pieces so that this file does not find itself.
root='/(home|root|work|Users|mnt)'
grep -rnE --exclude-dir=build --exclude-dir=.git "(^|[^[:alnum:]_./])$root/[[:alnum:]]" \
    src include port fixtures tests docs Makefile README.md CHANGELOG.md .ci 2>/dev/null |
    sed 's/$/   (path of a machine)/' >>"$tmp"

pattern=$(echo "$exempt" | sed '/^$/d' | paste -s -d '|')
! grep -vE "${pattern:-^$}" "$tmp"
