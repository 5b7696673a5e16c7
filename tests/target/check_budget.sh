#!/bin/sh
# check_budget: ticks with budgets on the emulated boards, one nanosecond an instruction.
# SPDX-License-Identifier: MIT
# usage: check_budget.sh [ticks]     of random budgets for each board, in ten cases; `make timing` has 10,000
set -u
. tests/target/board.sh
board_need
ticks=${1:-500}
passed=0; failed=0
for board in m7 m55; do
    board_set $board
    file=$(board_build target_budget) || exit 1
    echo "$board_name, $ticks ticks"
    if board_run 0 "$file" $((ticks / 10)); then passed=$((passed + 1))
    else failed=$((failed + 1)); echo "$board_name: failed"; fi
done
echo "$passed passed, $failed failed, 0 skipped"
[ "$failed" -eq 0 ]
