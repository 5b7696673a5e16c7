#!/bin/sh
# run_experiments: runs the experiments one after another and shows their tables; the last line is the sum.
# SPDX-License-Identifier: MIT
# usage: BUILD=... SMR=... SMR_EXPERIMENTS=full run_experiments.sh PROGRAM...
set -u
log_dir=$BUILD/log
mkdir -p "$log_dir"
passed=0; failed=0; skipped=0
count() { sed -n "s/^\[  *$1 *\] \([0-9][0-9]*\) test(s).*/\1/p" "$2" | awk '{n += $1} END {print n + 0}'; }

for program in "$@"; do
    log=$log_dir/${program##*/}.full.log
    "$program" >"$log" 2>&1
    rc=$?
    # The tables, and of CMocka's own lines those that tell what failed.
    grep -vE '^\[( RUN| *OK |=|-| *PASSED)' "$log"
    p=$(count PASSED "$log"); f=$(count FAILED "$log"); s=$(count SKIPPED "$log")
    if [ "$rc" -ne 0 ] && [ "$f" -eq 0 ]; then echo "$program ended with status $rc"; f=1; fi
    if [ $((p + f + s)) -eq 0 ]; then echo "$program ran no test"; f=1; fi
    passed=$((passed + p)); failed=$((failed + f)); skipped=$((skipped + s))
done
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
