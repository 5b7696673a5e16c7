#!/bin/sh
# register.sh: one patient of a cohort: register.sh cases/p7 writes results/p7 and a line in runs/p7.jsonl.
# SPDX-License-Identifier: MIT
# Every engine calls this one script, and may call it again at any time: what is done is not done twice. SMR: the program;
# SMR_OPTIONS: more options.
set -u
export LC_ALL=C # the order of model/*.ply is part of the command that --skip-done compares
case=${1%/}
mkdir -p results runs || exit 2
# shellcheck disable=SC2086
"${SMR:-smr}" register ${SMR_OPTIONS:-} --model "$case"/model/*.ply --reference "$case/mri_reference.mha" \
    --target "$case/mri_patient.mha" --landmarks "$case/landmarks_reference.mrk.json" \
    "$case/landmarks_patient.mrk.json" --truth "$case/truth" --threads 1 --skip-done --json \
    -o "results/${case##*/}" >>"runs/${case##*/}.jsonl"
status=$?
# A verdict, good or not, is a result: trying again changes nothing. The table says which are to be looked at.
case $status in
0 | 1 | 3) exit 0 ;;
*) exit $status ;;
esac
