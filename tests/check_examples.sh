#!/bin/sh
# check_examples: README.md's first C block prints what docs/RESULTS.md says; each example in docs/examples is at most 60 lines.
# SPDX-License-Identifier: MIT
# All compile without a warning, link and run.
set -u
. tests/checks.inc
need_file "$build/libsmr.a"
awk '/^```c[ \t]*$/ && !done {on = 1; next} /^```/ && on {on = 0; done = 1} on' README.md >"$tmp/README.c"
for file in "$tmp/README.c" docs/examples/*.c; do
    name=$(basename "$file" .c)
    # shellcheck disable=SC2086
    check "$name compiles" $cc -std=c11 -Wall -Wextra -Werror ${CFLAGS:-} -Iinclude -Iport/pthread "$file" -o "$tmp/$name" \
        "$build/libsmr_pthread.a" "$build/libsmr.a" -pthread -lm || continue
    check "$name runs" sh -c "cd '$tmp' && './$name' >'$name.txt'"
    [ "$name" = README ] || check "$name has at most 60 lines" [ "$(wc -l <"$file")" -le 60 ]
done
same 'README.md prints example.prints' "$(cat "$tmp/README.txt")" \
    "$(awk -F ' *[|] *' '$2 == "`example.prints`" {print $4}' docs/RESULTS.md)"
finish
