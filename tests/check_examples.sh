#!/bin/sh
# check_examples: each example in docs/examples is at most 60 lines, compiles without a warning, links and runs.
# SPDX-License-Identifier: MIT
# usage: BUILD=... CC=... check_examples.sh
set -u
build=${BUILD:-build}
[ -f "$build/libsmr.a" ] || { echo "skip: no library"; exit 77; }
tmp=$(mktemp -d) || exit 1
trap 'rm -rf "$tmp"' EXIT
passed=0; failed=0
for file in docs/examples/*.c; do
    [ -f "$file" ] || continue
    # shellcheck disable=SC2086
    if [ "$(wc -l <"$file")" -le 60 ] &&
        ${CC:-cc} -std=c11 -Wall -Wextra -Werror ${CFLAGS:-} -Iinclude -Iport/pthread "$file" -o "$tmp/example" \
            "$build/libsmr_pthread.a" "$build/libsmr.a" -pthread -lm && (cd "$tmp" && ./example) >"$tmp/said"; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "$file: longer than 60 lines, a warning, or it failed: $(head -n 5 "$tmp/said" 2>/dev/null)"
    fi
done
echo "$passed passed, $failed failed, 0 skipped"
[ "$failed" -eq 0 ]
