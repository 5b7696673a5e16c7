#!/bin/sh
# check_replay: a log of 500 ticks, recorded on two threads under a jittering clock, replays to the same bits everywhere.
# SPDX-License-Identifier: MIT
# On 1 and 4 threads, built by clang, on AArch64 (qemu-user), and the small model's on a Cortex-M7 board (QEMU).
set -u
build=${BUILD:-build}
program=$build/replay_run
[ -x "$program" ] || { echo "skip: no $program"; exit 77; }
logs=$build/replay-logs
mkdir -p "$logs"
passed=0; failed=0; skipped=0
have() { command -v "$1" >/dev/null 2>&1; }
skip() { skipped=$((skipped + 1)); echo "skip: $1 needs $2"; }

# agrees NAME STATE COMMAND...: all ticks agree, and the last state is the recorded one.
agrees() {
    name=$1; state=$2; shift 2
    out=$("$@" 2>&1 </dev/null)
    rc=$?
    last=$(echo "$out" | tail -n 1)
    echo "$name: $last"
    if [ "$rc" -eq 0 ] && [ "$last" = "replay-run 500 ticks agree, state $state" ]; then passed=$((passed + 1))
    else failed=$((failed + 1)); echo "$out" | head -n 5; fi
}

for size in small big; do
    log=$logs/$size.log
    more=; [ $size = big ] && more=big
    line=$("$program" record "$log" 500 $more) || { echo "$line"; echo "0 passed, 1 failed, 0 skipped"; exit 1; }
    eval "state_$size=\${line##* }"
    "$program" replay "$log" | head -n 1 | sed "s/^/$size /"
    for n in 1 4; do agrees "$size, $n threads" "${line##* }" "$program" replay "$log" $n; done
done

# The host's own flags (a sanitiser, perhaps) are not for other compilers and processors.
unset CFLAGS LDFLAGS
make=${MAKE:-make}
if have clang; then
    $make -s BUILD="$build/replay-clang" CC=clang CFLAGS=-O2 "$build/replay-clang/replay_run" || failed=$((failed + 1))
    agrees 'big, clang' "$state_big" "$build/replay-clang/replay_run" replay "$logs/big.log" 4
else skip 'big, clang' clang; fi

if ! have aarch64-linux-gnu-gcc; then skip 'big, AArch64' 'gcc-aarch64-linux-gnu libc6-dev-arm64-cross'
elif ! have qemu-aarch64; then skip 'big, AArch64' qemu-user
else
    $make -s BUILD="$build/replay-aarch64" CC=aarch64-linux-gnu-gcc AR=aarch64-linux-gnu-ar CFLAGS=-O2 LDFLAGS=-static \
        "$build/replay-aarch64/replay_run" || failed=$((failed + 1))
    agrees 'big, AArch64' "$state_big" qemu-aarch64 "$build/replay-aarch64/replay_run" replay "$logs/big.log" 2
fi

if ! have arm-none-eabi-gcc; then skip 'small, Cortex-M7' 'gcc-arm-none-eabi libnewlib-arm-none-eabi'
elif ! have qemu-system-arm; then skip 'small, Cortex-M7' qemu-system-arm
else
    $make -s BUILD="$build/m7-golden" CC=arm-none-eabi-gcc AR=arm-none-eabi-ar \
        CFLAGS="${M7_CFLAGS:--mthumb -mcpu=cortex-m7 -mfpu=fpv5-d16 -mfloat-abi=hard} -O2 -DSMR_BAREMETAL" \
        "$build/m7-golden/replay_run_m7.elf" || failed=$((failed + 1))
    board=$(cd "$build/m7-golden" && pwd)/replay_run_m7.elf
    cp "$logs/small.log" "$logs/replay.log" && cd "$logs" || exit 1
    agrees 'small, Cortex-M7' "$state_small" timeout 300 qemu-system-arm -M mps2-an500 -nographic -monitor none \
        -serial none -semihosting-config enable=on,target=native -icount shift=6 -kernel "$board"
fi
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
