#!/bin/sh
# check_settings: docs/SETTINGS.md is what the tables say, and so are unit, range and default in the comment of each field
# in smr.h.
# SPDX-License-Identifier: MIT
set -u
page=${BUILD:-build}/settings_page
[ -x "$page" ] || { echo "skip: no $page"; exit 77; }
tmp=$(mktemp -d) || exit 1
trap 'rm -rf "$tmp"' EXIT
passed=0; failed=0

"$page" >"$tmp/page"
if cmp -s "$tmp/page" docs/SETTINGS.md; then passed=1; else
    failed=1
    echo "docs/SETTINGS.md is not up to date: make settings-page"
    diff "$tmp/page" docs/SETTINGS.md | head -n 10
fi

# How each comment has to start: of a field by its place in C, group.field, for the table's name.
"$page" --header >"$tmp/wanted"
sed -nE 's/^SMR_SETTING\([A-Z]+, [0-9]+, ([a-z_.]+), ([a-z_]+),.*/\1\t\2/p' src/base/settings_config.def >"$tmp/places"

# Prints where the comments of a header, above a field or behind it, differ from the table. The default ends with its
# sentence, part or comment.
check_header() {
    awk -F '\t' '
    FILENAME == ARGV[1] { wanted[$1] = $2; next }
    FILENAME == ARGV[2] { name_of[$1] = $2; next }
    /^(typedef )?struct smr_[a-z]+_config \{/ { group = $0; sub(/_config.*/, "", group); sub(/^.*struct smr_/, "", group) }
    /^\}/ { group = "" }
    group == "" { next }
    /^    \/\*/ { comment = $0; sub(/^ *\/\* */, "", comment) }
    /^    [a-z][a-z_0-9 *]+[a-z_0-9\[\]A-Z]*;/ {
        name = $0; sub(/\[.*/, "", name); sub(/;.*/, "", name); sub(/^.*[ *]/, "", name)
        if ($0 ~ /; *\/\*/) { comment = $0; sub(/^[^;]*; *\/\* */, "", comment) }
        if (group != "prepare") name = name_of[group "." name]
        if (name in wanted) {
            want = wanted[name]; have = comment
            if (want ~ /^SMR_\*/) { sub(/^SMR_\*/, "", want); sub(/^SMR_[A-Z_]*_\.\.\./, "", have) }
            rest = substr(have, length(want) + 1); sub(/^ \(paper [0-9.]+\)/, "", rest)
            if (index(have, want) != 1 || rest !~ /^([.:]( |$)| *\*\/$|$)/) {
                print "smr.h: " name ": the comment starts \"" have "\", the table says \"" want "\""
                bad = 1
            }
            seen[name] = 1
        }
        comment = ""
    }
    END {
        for (name in wanted) if (!(name in seen)) { print "smr.h: no field " name " with a comment"; bad = 1 }
        exit bad
    }' "$tmp/wanted" "$tmp/places" "$1"
}
if check_header include/smr.h; then passed=$((passed + 1)); else failed=$((failed + 1)); fi

# The check can fail: a wrong default, planted in a copy of the header, is one complaint more.
already=$(check_header include/smr.h | wc -l)
plant() {
    awk -v from="default $1[.:]" -v to="default $2." '!done && sub(from, to) { done = 1 } { print }' \
        include/smr.h >"$tmp/smr.h"
    if [ "$(check_header "$tmp/smr.h" | wc -l)" -eq $((already + 1)) ]; then passed=$((passed + 1)); else
        failed=$((failed + 1))
        echo "check_settings: default $2 in place of $1 in smr.h is not found"
    fi
}
plant 0 0.5
plant 1 '1, 0.3'
plant '60, 40' '60, 40, 12'
echo "$passed passed, $failed failed, 0 skipped"
[ "$failed" -eq 0 ]
