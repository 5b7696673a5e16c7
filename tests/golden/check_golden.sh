#!/bin/sh
# check_golden: the state hash is the same for thread counts and hostile schedulers, and the recorded one.
# SPDX-License-Identifier: MIT
# The recorded line is tests/golden/expected.txt; `make golden-update` writes it after a wanted change.
set -u
golden=${BUILD:-build}/golden
[ -x "$golden" ] || { echo "skip: no $golden"; exit 77; }
passed=0; failed=0; skipped=0
first=$("$golden") || { echo "golden: $first"; echo "0 passed, 1 failed, 0 skipped"; exit 1; }
same() { # name, line
    if [ "$2" = "$first" ]; then passed=$((passed + 1)); else
        failed=$((failed + 1)); echo "$1: $2, plain loop: $first"
    fi
}
threads="1 2 3 4 8"
case ${CFLAGS:-} in *sanitize*) threads="2 8" ;; esac # they take long, and other builds run all
for n in $threads; do same "$n threads" "$("$golden" threads $n)"; done
for mode in 'workers 8' reverse shuffle interleave; do
    # shellcheck disable=SC2086
    same "$mode" "$("$golden" $mode)"
done
if [ -f tests/golden/expected.txt ]; then same 'tests/golden/expected.txt' "$(cat tests/golden/expected.txt)"
else skipped=1; echo 'skip: no tests/golden/expected.txt (make golden-update writes it)'; fi
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
