#!/bin/sh
# check_old_logs: logs of version 1, recorded by the commit before version 2, replay to the same bits.
# SPDX-License-Identifier: MIT
# logs/run_v1.log: replay_run's surfaces, 500 ticks cut by a jittering clock. files_v1.log and image_v1.log: smr register --log
# of the small phantom with a budget, onto a surface (polar) and into an image.
set -u
. tests/checks.inc
smr=${SMR:-$build/smr}
need_file "$build/replay_run" "$smr"
logs=$PWD/tests/golden/logs
case $smr in /*) ;; *) smr=$PWD/$smr ;; esac
replay_run=$PWD/$build/replay_run
case $build in /*) replay_run=$build/replay_run ;; esac
cd "$tmp" || exit 1
"$smr" phantom -o thigh --small --quiet || exit 1
# A row: what, the end of its last line, the command.
while IFS='|' read -r name wanted words; do
    out=$(eval "$words" 2>&1)
    rc=$?
    case "$rc $(echo "$out" | tail -n 1)" in "0 "*"$wanted") ok "$name" ;; *) not_ok "$name: status $rc, not '$wanted': $out" ;; esac
done <<'END'
surfaces, 1 thread|500 ticks agree, state 98cf44ed520ce9bc|"$replay_run" replay "$logs/run_v1.log" 1
surfaces, 3 threads|500 ticks agree, state 98cf44ed520ce9bc|"$replay_run" replay "$logs/run_v1.log" 3
a surface from files|state 6f3059d17c0ab620|"$smr" replay "$logs/files_v1.log" | grep 'all 297 ticks agree'
an image|state ac9aac34f1a3bfd9|"$smr" replay "$logs/image_v1.log" --threads 1 | grep 'all 101 ticks agree'
END
finish
