#!/bin/sh
# check_golden: the state hash is the recorded one for thread counts and hostile schedulers, and the answers are the recorded ones.
# SPDX-License-Identifier: MIT
# The recorded lines are tests/golden/expected.txt and answers.txt; `make golden-update` writes them after a wanted change.
set -u
. tests/checks.inc
need_file "$build/golden" tests/golden/expected.txt "$build/answers" tests/golden/answers.txt
modes='plain,threads 1,threads 2,threads 3,threads 4,threads 8,workers 8,reverse,shuffle,interleave'
# Sanitized builds take long, and all modes are the first compiler's.
case ${SMR_AGAIN:-0}${CFLAGS:-} in *sanitize*) modes='threads 2,shuffle' ;; 1*) modes='threads 2,reverse,shuffle,interleave' ;; esac
IFS=,
for mode in $modes; do
    IFS=' '
    # shellcheck disable=SC2086
    same "$mode" "$("$build/golden" ${mode#plain})" "$(cat tests/golden/expected.txt)"
done
"$build/answers" >"$tmp/answers"
check answers diff tests/golden/answers.txt "$tmp/answers"
finish
