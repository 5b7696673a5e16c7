#!/bin/sh
# run_slurm.sh: submits a cohort to Slurm and waits for it: a task for each patient, then the table.
# SPDX-License-Identifier: MIT
# Stopped, or the cluster went down? Call it again.
HERE=$(cd "$(dirname "$0")" && pwd)
export HERE
mkdir -p logs # Slurm makes no directories for its output
sbatch --wait --array="1-$(printf '%s\n' cases/* | wc -l)" "$HERE/job.sbatch"
exec sh "$HERE/table.sh"
