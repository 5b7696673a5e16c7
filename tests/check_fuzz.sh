#!/bin/sh
# check_fuzz: the kept corpora of the fuzz targets (tests/fuzz/corpus.tar.xz) run without a finding.
# SPDX-License-Identifier: MIT
set -u
. tests/checks.inc
need tar xz
need_file "$build/libsupport.a"
tar -xJf tests/fuzz/corpus.tar.xz -C "$tmp" || exit 1
for target in log mesh model_open save; do
    # shellcheck disable=SC2086
    check "$target compiles" $cc -std=c11 -O1 -ffp-contract=off -fno-math-errno ${CFLAGS:-} -DSMR_FUZZ_FILES -Isrc -Iinclude \
        -Ifixtures -Itests "tests/fuzz/fuzz_$target.c" "$build/libsupport.a" "$build/libsmr.a" -lm -o "$tmp/fuzz_$target" || continue
    check "$target: $(find "$tmp/$target" -type f | wc -l) inputs" "$tmp/fuzz_$target" "$tmp/$target"/*
done
finish
