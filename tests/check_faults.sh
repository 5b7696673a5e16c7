#!/bin/sh
# check_faults: a short campaign of bit flips (tests/faults): without a crash, a run without end or a write beside; and with
# smr_set_scrub() also without a wrong result that is called good.
# SPDX-License-Identifier: MIT
# `make faults N=100000` runs the long one.
set -u
. tests/checks.inc
need_plain # sanitisers have handlers of their own for what a fault may do
need_file "$build/faults"
for kind in bare seal; do
    n=1200
    check "$n flips, $kind" "$build/faults" $n 1 $kind
    cat "$tmp/check.log"
done
finish
