#!/bin/sh
# check_format: every C file is as clang-format writes it with the tree's .clang-format.
# SPDX-License-Identifier: MIT
# Another major version breaks lines elsewhere, so only the one the tree was formatted with judges.
set -u
version=14

formatter=
for candidate in "clang-format-$version" clang-format; do
    if [ -z "$formatter" ] && "$candidate" --version 2>/dev/null | grep -q "version $version\."; then formatter=$candidate; fi
done
[ -n "$formatter" ] || { echo "skip: needs clang-format $version"; exit 77; }
tmp=$(mktemp) || exit 1
trap 'rm -f "$tmp"' EXIT
find src include port fixtures tests -name '*.[ch]' -exec "$formatter" --dry-run --Werror {} + >"$tmp" 2>&1
result=$?
sed -n 's/^\([^: ]*\):\([0-9]*\):.*/\1:\2: clang-format writes this line another way/p' "$tmp" | sort -u
exit "$result"
