#!/bin/sh
# run_parallel.sh: a cohort by GNU parallel, one job a processor.
# SPDX-License-Identifier: MIT
# Stopped or killed? Call it again. Other machines: --sshlogin, over a shared directory.
here=$(dirname "$0")
parallel --will-cite --jobs "${JOBS:-100%}" sh "$here/register.sh" {} ::: cases/*
exec sh "$here/table.sh"
