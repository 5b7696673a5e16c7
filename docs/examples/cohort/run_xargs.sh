#!/bin/sh
# run_xargs.sh: a cohort by xargs, where there is nothing else.
# SPDX-License-Identifier: MIT
here=$(dirname "$0")
printf '%s\0' cases/* | xargs -0 -n 1 -P "${JOBS:-$(getconf _NPROCESSORS_ONLN)}" sh "$here/register.sh"
exec sh "$here/table.sh"
