#!/bin/sh
# check_settings: docs/SETTINGS.md is what the tables say, and so are unit, range and default of each field's comment in smr.h.
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

# Each comment of the two structs ends before the field it is about.
"$page" --header >"$tmp/wanted"
awk '
    FNR == NR { split($0, part, "\t"); wanted[part[1]] = part[2]; next }
    /^typedef struct smr_(prepare_)?config \{/ { on = 1 }
    /^\} smr_(prepare_)?config;/ { on = 0 }
    !on { next }
    /^    \/\*/ { comment = $0; sub(/^ *\/\* */, "", comment) }
    /^    [a-z_0-9 *]+[a-z_0-9\[\]A-Z]*;/ {
        name = $0; sub(/\[.*/, "", name); sub(/;.*/, "", name); sub(/^.*[ *]/, "", name)
        if (name in wanted) {
            want = wanted[name]; have = comment
            if (want ~ /^SMR_\*/) { sub(/^SMR_\*/, "", want); sub(/^SMR_[A-Z_]*_\.\.\./, "", have) }
            next_char = substr(have, length(want) + 1, 1)
            if (index(have, want) != 1 || next_char ~ /[0-9a-z]/) {
                print "smr.h: " name ": the comment starts \"" have "\", the table says \"" want "\""
                bad = 1
            }
            seen[name] = 1
        }
        comment = ""
    }
    END {
        for (name in wanted) if (!(name in seen)) { print "smr.h: no field " name " with a comment above it"; bad = 1 }
        exit bad
    }' "$tmp/wanted" include/smr.h
if [ $? -eq 0 ]; then passed=$((passed + 1)); else failed=$((failed + 1)); fi
echo "$passed passed, $failed failed, 0 skipped"
[ "$failed" -eq 0 ]
