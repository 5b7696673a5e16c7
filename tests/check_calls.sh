#!/bin/sh
# check_calls: docs/TIMING.md has the longest measured piece of each call in pieces. None is longer than its bound or 100,000.
# SPDX-License-Identifier: MIT
set -u
. tests/checks.inc
tr -d , <docs/TIMING.md >"$tmp/page"
tr -d , <tests/timing/results/calls.txt |
    awk -F '; ' '$1 == "piece" { most = $3 > $4 ? $3 : $4; print (most > $5 ? most : $5), $2 }' >"$tmp/calls"
while read -r most call; do
    if awk -F '|' -v call="$call" -v most="$most" '
        index($2, "`" call "`") && $3 + 0 == most && $4 + 0 >= most && $4 + 0 <= 100000 { n++ }
        END { exit n != 1 }' "$tmp/page"; then ok "$call: $most"; else not_ok "docs/TIMING.md: the longest piece of $call is $most"; fi
done <"$tmp/calls"
for word in SMR_START_PIECE SMR_TRIANGLE_CHUNK SMR_KEEP_PIECE SMR_OPEN_PIECE SMR_OPEN_BYTES SMR_SLICE SMR_WORK_MOST; do
    value=$(grep -rh "define $word " src | sed 's/^[^ ]* *[^ ]* *\([0-9]*\).*/\1/')
    if grep -q "\`$word\` = $value\b" "$tmp/page"; then ok "$word = $value"; else not_ok "docs/TIMING.md: $word is $value"; fi
done
finish
