#!/bin/sh
# check_reference: the page of `make reference` has every declaration of smr.h, and each of its links leads somewhere.
# SPDX-License-Identifier: MIT
set -u
. tests/checks.inc
# Ids and links of a page, and what of the header has no id.
look() { # header
    sh tests/docs/reference.sh "$1" >"$tmp/page.html" || return 1
    grep -o 'id="\{0,1\}[A-Za-z_0-9.]*' "$tmp/page.html" | sed 's/id="\{0,1\}//' | sort >"$tmp/ids"
    grep -o 'href="#[^"]*' "$tmp/page.html" | sed 's/href="#//' | sort -u >"$tmp/links"
    {
        sed -n 's/^[a-z][a-z_0-9 ]*[ *]\(smr_[a-z_0-9]*\)(.*/\1/p; s/^} \(smr_[a-z_0-9]*\);.*/\1/p' "$1"
        sed -n 's/^typedef struct \(smr_*[a-z_0-9]*\) .*/\1/p; s/^#define \(SMR_[A-Z_0-9]*[A-Z0-9]\).*/\1/p' "$1"
    } | grep -v '^SMR_H$' | sort -u >"$tmp/declared"
}
check "the page is made" look include/smr.h
check "declarations were found" [ "$(wc -l <"$tmp/declared")" -gt 120 ]
lost=$(comm -23 "$tmp/declared" "$tmp/ids" | tr '\n' ' ')
check "declarations without a place: $lost" [ -z "$lost" ]
dead=$(comm -23 "$tmp/links" "$tmp/ids" | tr '\n' ' ')
check "links that lead nowhere: $dead" [ -z "$dead" ]
check "there are links" [ "$(wc -l <"$tmp/links")" -gt 100 ]
check "no place is named twice" [ -z "$(uniq -d "$tmp/ids")" ]
check "settings are linked from afar" grep -q 'href="#smr_basic_config.n_target_vertices"' "$tmp/page.html"
# Every comment is there: as many words as the header has, but for the guard and the sections' lines.
for word in barycentric Bookstein 'digitises\|kriging\|pseudo' residual 'Not while smr_tick'; do
    want=$(grep -c "$word" include/smr.h)
    check "$word: as often as in the header" [ "$(sed 's/<[^>]*>//g' "$tmp/page.html" | grep -c "$word")" -eq "$want" ]
done
open_=$(grep -o '<section>' "$tmp/page.html" | wc -l)
check "elements are closed" [ "$open_" -gt 100 -a "$open_" -eq "$(grep -o '</section>' "$tmp/page.html" | wc -l)" ]
printf '/* x.h: a header.\n */\n#ifndef SMR_H\n\n/* ---------- 1. a < b & c */\n\n/* Errors: E_X. */\nint smr_f(int a);\n' >"$tmp/x.h"
sh tests/docs/reference.sh "$tmp/x.h" >"$tmp/page.html"
check "marks are escaped" grep -q 'a &lt; b &amp; c' "$tmp/page.html"
finish
