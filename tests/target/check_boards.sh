#!/bin/sh
# check_boards: the golden run on emulated Cortex-M7 and Cortex-M55 boards gives this machine's bits, and the core calls nothing
# foreign there either.
# SPDX-License-Identifier: MIT
set -u
. tests/target/board.sh
board_need
golden=${BUILD:-build}/golden
[ -x "$golden" ] || { echo "skip: no $golden"; exit 77; }
want=$("$golden") || { echo "$want"; exit 1; }
echo "this machine: $want"
passed=0; failed=0
for board in m7 m55; do
    board_set $board
    file=$(board_build golden) || exit 1
    got=$(board_run 6 "$file"); rc=$?
    echo "$board_name: $got (status $rc)"
    if [ "$rc" -eq 0 ] && [ "$got" = "$want" ]; then passed=$((passed + 1)); else failed=$((failed + 1)); fi
    if sh tests/check_symbols.sh "${file%/*}/libsmr.a" arm-none-eabi-; then passed=$((passed + 1)); else failed=$((failed + 1)); fi
done
echo "$passed passed, $failed failed, 0 skipped"
[ "$failed" -eq 0 ]
