#!/bin/sh
# readme_table: README's table of results, made from docs/RESULTS.md; --update puts it between README's markers, --check compares.
# SPDX-License-Identifier: MIT
set -eu
tmp=$(mktemp) || exit 1
trap 'rm -f "$tmp"' EXIT
awk -f tests/results/fill.awk docs/RESULTS.md tests/results/readme_table.md >"$tmp"
case ${1:---check} in
--update)
    awk -v table="$tmp" '
        /^<!-- \/results -->$/ { while ((getline line < table) > 0) print line; skip = 0 }
        !skip { print }
        /^<!-- results -->$/ { skip = 1 }' README.md >"$tmp.new"
    grep -q '^<!-- /results -->$' "$tmp.new" || { echo "README.md has no results markers"; rm -f "$tmp.new"; exit 1; }
    cat "$tmp.new" >README.md
    rm -f "$tmp.new" ;;
--check)
    awk '/^<!-- \/results -->$/ { on = 0 } on { print } /^<!-- results -->$/ { on = 1 }' README.md | diff "$tmp" - ;;
esac
