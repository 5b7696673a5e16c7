#!/bin/sh
# run_experiments: runs the experiments, one per processor or SMR_JOBS, and shows their tables; the last line is the sum.
# SPDX-License-Identifier: MIT
# usage: BUILD=... SMR=... SMR_EXPERIMENTS=full run_experiments.sh PROGRAM...
set -u
log_dir=$BUILD/log
mkdir -p "$log_dir"
taken=$(mktemp -d) || exit 1
trap 'rm -rf "$taken"' EXIT
trap 'kill $workers 2>/dev/null; exit 1' HUP INT TERM
jobs=${SMR_JOBS:-$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 1)}
passed=0; failed=0; skipped=0; workers=
count() { sed -n "s/^\[  *$1 *\] \([0-9][0-9]*\) test(s).*/\1/p" "$2" | awk '{n += $1} END {print n + 0}'; }

# Runs what no other worker has taken, until nothing is left.
work() {
    for program in "$@"; do
        name=${program##*/}
        mkdir "$taken/$name" 2>/dev/null || continue
        "$program" >"$log_dir/$name.full.log" 2>&1
        echo $? >"$taken/$name/status"
    done
}
for k in $(seq "$jobs"); do
    work "$@" &
    workers="$workers $!"
done
wait

for program in "$@"; do
    name=${program##*/}
    log=$log_dir/$name.full.log
    rc=$(cat "$taken/$name/status" 2>/dev/null || echo 'that nobody saw')
    # The tables, and of CMocka's own lines those that tell what failed.
    grep -vE '^\[( RUN| *OK |=|-| *PASSED)' "$log"
    p=$(count PASSED "$log"); f=$(count FAILED "$log"); s=$(count SKIPPED "$log")
    if [ "$rc" != 0 ] && [ "$f" -eq 0 ]; then echo "$program ended with status $rc"; f=1; fi
    if [ $((p + f + s)) -eq 0 ]; then echo "$program ran no test"; f=1; fi
    passed=$((passed + p)); failed=$((failed + f)); skipped=$((skipped + s))
done
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
