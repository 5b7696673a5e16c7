#!/bin/sh
# check_track: a target that moves, its surfaces and its ticks within budgets, on the emulated boards, one nanosecond an
# instruction.
# SPDX-License-Identifier: MIT
set -u
. tests/target/board.sh
board_need
passed=0; failed=0
for board in m7 m55; do
    board_set $board
    file=$(board_build target_track) || exit 1
    echo "$board_name"
    if board_run 0 "$file"; then passed=$((passed + 1))
    else failed=$((failed + 1)); echo "$board_name: failed"; fi
done
echo "$passed passed, $failed failed, 0 skipped"
[ "$failed" -eq 0 ]
