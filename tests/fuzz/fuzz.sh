#!/bin/sh
# fuzz.sh: make fuzz SECONDS=n: each target of this directory for n seconds of libFuzzer under the address and undefined-behaviour
# sanitisers, from its kept corpus (corpus.tar.xz) and the seeds of test_fuzz.
# SPDX-License-Identifier: MIT
# usage: BUILD=... MAKE=... fuzz.sh SECONDS [keep]      keep: afterwards corpus.tar.xz holds the minimal corpora
# A finding stays in $BUILD/fuzz as crash-...; the status is 1 then.
set -u
. tests/checks.inc
need clang
seconds=$1
out=$build/fuzz
# Tracing comparisons, and the default choice of inputs by rare features, took three quarters of the time.
flags='-O1 -g1 -fsanitize=address,undefined -fno-sanitize-recover=all'
${MAKE:-make} -s BUILD="$out" CC=clang CFLAGS="$flags -fsanitize-coverage=inline-8bit-counters,pc-table" \
    "$out/libsmr.a" "$out/libsupport.a" &&
    ${MAKE:-make} -s BUILD="$build" "$build/tests/unit/test_fuzz" || exit 1
rm -rf "$out/kept" && mkdir -p "$out/seeds" "$out/kept" "$out/corpus"
[ ! -e tests/fuzz/corpus.tar.xz ] || tar -xJf tests/fuzz/corpus.tar.xz -C "$out/corpus" || exit 1
SMR_FUZZ_CORPUS=$out/seeds "$build/tests/unit/test_fuzz" >/dev/null 2>&1
bad=0
# Processor time of ended children, s.
children() { times >"$tmp/times"; awk 'NR == 2 { split($1, t, /[ms]/); print 60 * t[1] + t[2] }' "$tmp/times"; }
echo 'target             runs  runs a s of processor time    edges   corpus'
for target in log mesh model_open save; do
    # shellcheck disable=SC2086
    clang -std=c11 -ffp-contract=off -fno-math-errno $flags -fsanitize=fuzzer -fno-sanitize-coverage=trace-cmp -DSMR_LIBFUZZER \
        -Isrc -Iinclude -Ifixtures -Itests "tests/fuzz/fuzz_$target.c" "$out/libsupport.a" "$out/libsmr.a" -lm -o "$out/fuzz_$target" || exit 1
    corpus=$out/corpus/$target
    mkdir -p "$corpus"
    cp "$out/seeds/${target%_open}"-* "$corpus"
    children >"$tmp/before"
    "$out/fuzz_$target" -max_total_time="$seconds" -entropic=0 -max_len=4096 -timeout=10 -print_final_stats=1 \
        -artifact_prefix="$out/" "$corpus" >"$out/$target.txt" 2>&1 || { bad=1; grep -E 'ERROR|SUMMARY|runtime error|fuzz_' "$out/$target.txt"; }
    children >"$tmp/after"
    runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$out/$target.txt")
    edges=$(sed -n 's/.* cov: \([0-9]*\).*/\1/p' "$out/$target.txt" | tail -n 1)
    mkdir "$out/kept/$target"
    "$out/fuzz_$target" -merge=1 -use_counters=0 -max_len=4096 "$out/kept/$target" "$corpus" >"$out/merge.txt" 2>&1
    paste "$tmp/before" "$tmp/after" | awk -v target="$target" -v runs="$runs" -v edges="$edges" \
        -v n="$(find "$out/kept/$target" -type f | wc -l)" \
        '{ printf "%-12s %10d %28.0f %8d %8d\n", target, runs, runs / ($2 - $1), edges, n }'
done
[ "${2:-}" != keep ] || tar -C "$out/kept" --sort=name --owner=0 --group=0 --numeric-owner --mtime=@0 -cJf \
    tests/fuzz/corpus.tar.xz .
exit $bad
