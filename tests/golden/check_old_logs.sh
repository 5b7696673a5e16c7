#!/bin/sh
# check_old_logs: logs of version 1, recorded by the commit before version 2, replay to the same bits.
# SPDX-License-Identifier: MIT
# logs/run_v1.log: replay_run's surfaces, 500 ticks cut by a jittering clock. files_v1.log and image_v1.log: smr register --log
# of the small phantom with a budget, onto a surface (polar) and into an image.
set -u
build=${BUILD:-build}
smr=${SMR:-$build/smr}
[ -x "$build/replay_run" ] && [ -x "$smr" ] || { echo "skip: no $build/replay_run or $smr"; exit 77; }
logs=$(cd tests/golden/logs && pwd)
case $smr in /*) ;; *) smr=$PWD/$smr ;; esac
tmp=$(mktemp -d) || exit 1
trap 'rm -rf "$tmp"' EXIT
passed=0; failed=0

# ends NAME LINE COMMAND...: the command succeeds and its last line has this text.
ends() {
    name=$1; wanted=$2; shift 2
    out=$("$@" 2>&1)
    rc=$?
    if [ $rc -eq 0 ] && echo "$out" | tail -n 1 | grep -q "$wanted"; then passed=$((passed + 1)); else
        failed=$((failed + 1)); echo "$name: status $rc, not \"$wanted\":"; echo "$out" | tail -n 3
    fi
}
for n in 1 3; do
    ends "surfaces, $n threads" '500 ticks agree, state 98cf44ed520ce9bc$' "$build/replay_run" replay "$logs/run_v1.log" $n
done
cd "$tmp" || exit 1
"$smr" phantom -o thigh --small --quiet || exit 1
ends 'a surface from files' 'all 297 ticks agree .* state 6f3059d17c0ab620$' "$smr" replay "$logs/files_v1.log"
ends 'an image' 'all 101 ticks agree .* state ac9aac34f1a3bfd9$' "$smr" replay "$logs/image_v1.log" --threads 1
echo "$passed passed, $failed failed, 0 skipped"
[ "$failed" -eq 0 ]
