#!/bin/sh
# check_readme: the first C example of README.md compiles, links, runs and prints what docs/RESULTS.md says.
# SPDX-License-Identifier: MIT
set -u
build=${BUILD:-build}
[ -f README.md ] || { echo "skip: no README.md"; exit 77; }
[ -f "$build/libsmr.a" ] || { echo "skip: no library"; exit 77; }
tmp=$(mktemp -d) || exit 1
trap 'rm -rf "$tmp"' EXIT
awk '/^```c[ \t]*$/ && !done {on = 1; next} /^```/ && on {on = 0; done = 1} on' README.md >"$tmp/example.c"
[ -s "$tmp/example.c" ] || { echo "skip: README.md has no \`\`\`c block"; exit 77; }
${CC:-cc} -std=c11 -Wall -Wextra ${CFLAGS:-} -Iinclude -Iport/pthread "$tmp/example.c" -o "$tmp/example" \
    "$build/libsmr_pthread.a" "$build/libsmr.a" -pthread -lm || exit 1
(cd "$tmp" && ./example) >"$tmp/printed" || { echo "the example ended with status $?"; exit 1; }
cat "$tmp/printed"
awk -F ' *[|] *' '$2 == "`example.prints`" {print $4}' docs/RESULTS.md >"$tmp/expected"
cmp -s "$tmp/printed" "$tmp/expected" || { echo "docs/RESULTS.md: example.prints says: $(cat "$tmp/expected")"; exit 1; }
