#!/bin/sh
# check_boards: programs on the emulated boards; one that reads the clock has one nanosecond an instruction.
# SPDX-License-Identifier: MIT
# usage: check_boards.sh [BOARD [PROGRAM [TICKS]]]
# golden: this machine's bits, and the core calls nothing foreign there either. target_budget: ticks with random budgets, TICKS of
# them in ten cases. target_interrupt: a registration in a timer's interrupt. target_track: a
# target that moves, its surfaces and ticks within budgets. target_ticks: TICKS of 0.05 to 2 ms at 8 ns an instruction. target_jobs: the longest pieces of calls in pieces. target_flash, for any
# board: a model in flash, the state that the M7 has, and a clock of whole milliseconds.
set -u
. tests/checks.inc
. tests/target/board.sh
board_need "${1:-m7}"
run() { # board, program, ticks
    board_set "$1"
    file=$(board_build "$2") || { not_ok "$board_name: $2 is built"; return; }
    case $2 in
    golden)
        same "$board_name: the golden hash" "$(board_run 6 "$file")" "$(cat tests/golden/expected.txt)"
        emulation= # the linker's default is another one
        [ "$1" != rv32 ] || emulation=LDEMULATION=elf32lriscv
        # shellcheck disable=SC2086
        check "$board_name: symbols" env $emulation sh tests/check_symbols.sh "${file%/*}/libsmr.a" "$board_tools-" ;;
    target_flash)
        check "$board_name: a model in flash, a coarse clock" board_run 0 "$file"
        state=$(grep '^state' "$tmp/check.log")
        board_set m7
        file=$(board_build "$2") && same 'the same state on the Cortex-M7' "$(board_run 0 "$file" | grep '^state')" "$state" ;;
    target_budget) check "$board_name: $3 ticks with budgets" board_run 0 "$file" $(($3 / 10)) ;;
    target_ticks)
        file=$PWD/$file
        board_bone_of 5 >"$tmp/check.log" || { not_ok 'the bone'; cat "$tmp/check.log"; return; }
        here=$PWD
        cd "$board_bone" && check "$board_name: $3 ticks" board_run 3 "$file" "$3"
        cd "$here" && cat "$tmp/check.log" ;;
    *)  check "$board_name: $2" board_run 0 "$file"
        cat "$tmp/check.log" ;;
    esac
}
for board_asked in ${1:-m7 m55}; do
    for program in ${2:-golden target_budget target_interrupt target_track target_jobs}; do run "$board_asked" "$program" "${3:-500}"; done
done
finish
