#!/bin/sh
# calls: what each call that depends on the model's size takes on the Cortex-M7, in instructions; writes tests/timing/results/calls.txt.
# SPDX-License-Identifier: MIT
# usage: calls.sh     `make timing-calls`; names pieces of more than 100,000 instructions
# The board is the M55's, which has the memory for large models; the code and its instructions are the M7's.
set -u
. tests/target/board.sh
board_need
flags='-mthumb -mcpu=cortex-m7 -mfpu=fpv5-d16 -mfloat-abi=hard -ffunction-sections -fdata-sections'
host=${BUILD:-build}
mkdir -p "$host/calls"
cp "$host/fixture_write" "$host/smr" "$host/calls/" || exit 1
BUILD=$(cd "$host/calls" && pwd)
export BUILD M55_CFLAGS="$flags" SMR_BOARD_SECONDS="${SMR_BOARD_SECONDS:-3000}"
table=tests/timing/results/calls.txt
board_set m55
file=$(board_build target_calls) || exit 1
for mm in 5 3 2; do
    board_bone_of $mm >"$BUILD/log" 2>&1 || { cat "$BUILD/log"; exit 1; }
    (cd "$board_bone" && board_run 0 "$file") >"$BUILD/$mm" || { tail -n 3 "$BUILD/$mm"; exit 1; }
done
{
    echo '# Instructions of calls on the Cortex-M7; written by `make timing-calls`. See docs/TIMING.md, section 2.'
    echo "# compiler: $(arm-none-eabi-gcc --version | head -n 1), -O2"
    awk -F '; ' '
        FNR == 1 { file++ }
        { time[file, $2] = $5; count[file, $2] = $4; place[file, $2] = $6 }
        file == 1 { call[++n] = $2; kind[n] = $1; element[n] = $3 }
        END { print "# bones of " count[1, "smr_init_begin"] ", " count[2, "smr_init_begin"] ", " count[3, "smr_init_begin"] " vertices"
              print "# piece; call; instructions of the longest piece, for each bone; stage of the job, or step of the tick, with that piece"
              print "# whole; call; instructions of the call; instructions an element of the call, of the largest bone"
              for (i = 1; i <= n; i++) {
                  c = call[i]
                  printf "%s; %s; %.0f; %.0f; %.0f; ", kind[i], c, time[1, c], time[2, c], time[3, c]
                  if (kind[i] == "piece") printf "%d %d %d\n", place[1, c], place[2, c], place[3, c]
                  else printf "%.0f a %s\n", time[3, c] / count[3, c], element[i] } }' "$BUILD/5" "$BUILD/3" "$BUILD/2"
} >"$table"
awk -F '; ' '$1 == "piece" && ($3 > 100000 || $4 > 100000 || $5 > 100000) { print "longer than 100,000: " $0 }' "$table"
