#!/bin/sh
# check_interrupt: a registration in a timer's interrupt on the emulated boards, twice: every run is the same.
# SPDX-License-Identifier: MIT
set -u
. tests/target/board.sh
board_need
passed=0; failed=0
for board in m7 m55; do
    board_set $board
    file=$(board_build target_interrupt) || exit 1
    first=$(board_run 0 "$file"); rc=$?
    echo "$board_name"; echo "$first"
    if [ "$rc" -ne 0 ]; then failed=$((failed + 1)); echo "$board_name: failed"
    elif second=$(board_run 0 "$file") && [ "$second" = "$first" ]; then passed=$((passed + 1))
    else failed=$((failed + 1)); echo "$board_name: another run differs:"; echo "$second"; fi
done
echo "$passed passed, $failed failed, 0 skipped"
[ "$failed" -eq 0 ]
