#!/bin/sh
# check_settings: the generated page of settings has each setting once, complete, and names options that smr has; unit,
# range and default in the comment of each field in smr.h are those of the tables.
# SPDX-License-Identifier: MIT
set -u
page=${BUILD:-build}/settings_page
[ -x "$page" ] || { echo "skip: no $page"; exit 77; }
tmp=$(mktemp -d) || exit 1
trap 'rm -rf "$tmp"' EXIT
passed=0; failed=0

"$page" >"$tmp/page" || { echo "not ok $page ends with status $?"; echo "0 passed, 1 failed, 0 skipped"; exit 1; }

# Prints what a page lacks: a row of six full cells for each setting of the tables, none twice, and options of smr.
check_page() {
    sed -n 's/^SMR_SETTING([A-Z]*, *[0-9]*, *[a-z_0-9.]*, *\([a-z_0-9]*\),.*/\1/p' \
        src/base/settings_config.def src/base/settings_prepare.def >"$tmp/names"
    "${SMR:-${BUILD:-build}/smr}" --help >"$tmp/help"
    awk -F ' *[|] *' '
    FILENAME == ARGV[1] { wanted[$1]++; next }
    FILENAME == ARGV[2] { help = help $0 " "; next }
    /^\| `/ {
        name = $2; gsub(/`/, "", name)
        rows[name]++
        option = $3; gsub(/`/, "", option)
        if (NF != 8 || $7 == "") print "the row of " name " is not complete"
        if (option != "-" && index(help, option " ") == 0) print "smr --help has no " option " (" name ")"
    }
    END {
        for (name in wanted) if (rows[name] != wanted[name]) print name ": " rows[name] + 0 " rows, expected " wanted[name]
        for (name in rows) if (!(name in wanted)) print "no setting " name
    }' "$tmp/names" "$tmp/help" "$1"
}
check_page "$tmp/page" >"$tmp/lacks"
if [ ! -s "$tmp/lacks" ] && [ "$(wc -l <"$tmp/names")" -gt 60 ]; then passed=1; else
    failed=1
    echo "not ok the page of settings is not complete:"
    cat "$tmp/lacks"
fi

# The check of the page can fail: without one row it complains.
grep -v '^| `search_mm`' "$tmp/page" >"$tmp/short"
if [ -n "$(check_page "$tmp/short")" ]; then passed=$((passed + 1)); else
    failed=$((failed + 1))
    echo "not ok a row that is missing is not found"
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
plant '30, 40' '30, 40, 12'
echo "$passed passed, $failed failed, 0 skipped"
[ "$failed" -eq 0 ]
