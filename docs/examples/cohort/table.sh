#!/bin/sh
# table.sh: the table and the page of a cohort: table.sh writes table.csv, overview.html and runs.jsonl.
# SPDX-License-Identifier: MIT
# A row for each of cases/*, whether it has a result or not. Exit status 1: some have none yet. SMR: the program.
set -u
for case in cases/*; do
    set -- "$@" "results/${case##*/}"
done
[ ! -d runs ] || cat runs/*.jsonl >runs.jsonl
exec "${SMR:-smr}" summary "$@" -o table.csv --html overview.html
