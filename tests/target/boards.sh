#!/bin/sh
# boards: one table of the emulated boards: the golden bits, and a bone's model in flash registered with target_flash.
# SPDX-License-Identifier: MIT
# usage: BUILD=... boards.sh [BOARD...]     (`make boards`)
# Instructions a tick: under -icount one instruction takes one nanosecond. Ends with 1 when a board gives other bits than this
# machine or than another board, or a tick is late.
set -u
. tests/target/board.sh
tmp=$(mktemp -d) || exit 1
trap 'rm -rf "$tmp"' EXIT
unset CFLAGS LDFLAGS
export SMR_BOARD_SECONDS="${SMR_BOARD_SECONDS:-3000}" # without an FPU the golden run takes six minutes
bad=0 state=
value() { sed -n "s/^$1 //p" "$tmp/flash"; }
echo '| board | golden bits | flash | RAM | stack | instructions a tick, mean | largest |'
echo '|---|---|---:|---:|---:|---:|---:|'
for board in ${*:-$boards}; do
    board_set "$board"
    missing=$(board_missing)
    [ -z "$missing" ] || { echo "| $board_name | skipped: needs $missing |"; continue; }
    golden=differ
    file=$(board_build golden) && [ "$(board_run 6 "$file")" = "$(cat tests/golden/expected.txt)" ] && golden=equal
    { file=$(board_build target_flash) && board_run 0 "$file"; } >"$tmp/flash" || golden="$golden, $(tail -n 1 "$tmp/flash")"
    : "${state:=$(value state)}"
    [ "$state" = "$(value state)" ] || golden="$golden, flash: other bits"
    [ "$golden" = equal ] || bad=1
    "$board_tools-size" -A "$file" | awk -v name="$board_name" -v golden="$golden" -v stack="$(value stack)" \
        -v mean="$(value mean)" -v most="$(value most)" '
        { size[$1] = $2 }
        END { print "| " name " | " golden " | " size[".text"] + size[".ARM.exidx"] + size[".data"] " | " \
              size[".data"] + size[".bss"] " | " stack " | " mean " | " most " |" }'
done
exit $bad
