#!/bin/sh
# check_old_logs: logs of version 1, recorded by the commit before version 2, are read.
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
# A row: what, status, the end of its last line, the command. Goals are others since outliers are weighed and, in images,
# since searches along the surface are shorter; and models prepared anew hold a relief. Such a log is read, its model differs.
while IFS='|' read -r name status wanted words; do
    out=$(eval "$words" 2>&1)
    rc=$?
    case "$rc $(echo "$out" | tail -n 1)" in "$status "*"$wanted"*) ok "$name" ;; *) not_ok "$name: status $rc, not '$wanted': $out" ;; esac
done <<'END'
surfaces, 1 thread|1|replay SMR_E_MODEL|"$replay_run" replay "$logs/run_v1.log" 1
surfaces, 3 threads|1|replay SMR_E_MODEL|"$replay_run" replay "$logs/run_v1.log" 3
a surface from files|2|expected inputs that prepare to the model|"$smr" replay "$logs/files_v1.log"
an image|2|expected inputs that prepare to the model|"$smr" replay "$logs/image_v1.log" --threads 1
END
finish
