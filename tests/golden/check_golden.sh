#!/bin/sh
# check_golden: the state hash is the recorded one for thread counts and hostile schedulers.
# SPDX-License-Identifier: MIT
# The recorded line is tests/golden/expected.txt; `make golden-update` writes it after a wanted change.
set -u
. tests/checks.inc
need_file "$build/golden" tests/golden/expected.txt
modes='plain,threads 1,threads 2,threads 3,threads 4,threads 8,workers 8,reverse,shuffle,interleave'
# Sanitized builds take long, and all modes are the first compiler's.
case ${SMR_AGAIN:-0}${CFLAGS:-} in *sanitize*) modes='threads 2,shuffle' ;; 1*) modes='threads 2,reverse,shuffle,interleave' ;; esac
IFS=,
for mode in $modes; do
    IFS=' '
    # shellcheck disable=SC2086
    same "$mode" "$("$build/golden" ${mode#plain})" "$(cat tests/golden/expected.txt)"
done
finish
