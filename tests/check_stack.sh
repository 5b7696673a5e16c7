#!/bin/sh
# check_stack: the largest stack frames of the core; fails when a frame's size is not known at compile time.
# SPDX-License-Identifier: MIT
# usage: check_stack.sh BUILD_DIRECTORY NAME   (built with -fstack-usage)
set -u
tmp=$(mktemp) || exit 1
trap 'rm -f "$tmp"' EXIT
find "$1" -name '*.su' -exec cat {} + >"$tmp"
[ -s "$tmp" ] || { echo "$2: skipped (no .su files in $1)"; exit 0; }
echo "largest stack frames, $2 (bytes, function):"
sort -t "$(printf '\t')" -k2,2nr "$tmp" | head -n 8 | awk -F '\t' '{sub(/^.*:[0-9]+:/, "", $1); printf "%8d  %s\n", $2, $1}'
if grep "dynamic$" "$tmp"; then # "dynamic,bounded" is a realigned frame: the size shown is its largest
    echo "FORBIDDEN: frames above have no fixed size"
    exit 1
fi
