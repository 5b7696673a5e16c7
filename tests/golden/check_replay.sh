#!/bin/sh
# check_replay: a log of 500 ticks, recorded on two threads under a jittering clock, replays to the same bits everywhere.
# SPDX-License-Identifier: MIT
# On 1 and 4 threads, built by clang, on AArch64, and the small model's on big-endian s390x (both qemu-user) and a Cortex-M7
# board (QEMU).
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

# Other builds of it are the same whichever compiler and flags the host's program has.
if [ "${SMR_NO_BOARDS:-0}" = 1 ]; then
    echo 'skip: other processors replay once, with the first compiler (SMR_NO_BOARDS=1)'
    echo "$passed passed, $failed failed, 1 skipped"
    exit $((failed > 0))
fi
# The host's own flags (a sanitiser, perhaps) are not for other compilers and processors. The directories are those of
# `make hashes`, which has the same flags: the library is compiled once for both.
unset CFLAGS LDFLAGS
make=${MAKE:-make}
others=$build/hashes
mkdir -p "$others"
if have clang; then
    $make -s BUILD="$others/clang-O2" CC=clang CFLAGS=-O2 "$others/clang-O2/replay_run" || failed=$((failed + 1))
    agrees 'big, clang' "$state_big" "$others/clang-O2/replay_run" replay "$logs/big.log" 4
else skip 'big, clang' clang; fi

cross() { # name, log, state, compiler prefix, qemu, package of the C library, more flags
    if ! have "$4-gcc"; then skip "$1" "gcc-$4 $6"; return; fi
    if ! have "$5"; then skip "$1" qemu-user; return; fi
    $make -s BUILD="$others/$4" CC="$4-gcc" AR="$4-ar" CFLAGS="-O2 $7" LDFLAGS=-static \
        "$others/$4/replay_run" || failed=$((failed + 1))
    agrees "$1" "$3" "$5" "$others/$4/replay_run" replay "$logs/$2.log" 2
}
cross 'big, AArch64' big "$state_big" aarch64-linux-gnu qemu-aarch64 libc6-dev-arm64-cross ''
# s390x, big-endian: strict C11 would evaluate floats in double there.
cross 'small, s390x' small "$state_small" s390x-linux-gnu qemu-s390x libc6-dev-s390x-cross -fexcess-precision=fast

if ! have arm-none-eabi-gcc; then skip 'small, Cortex-M7' 'gcc-arm-none-eabi libnewlib-arm-none-eabi'
elif ! have qemu-system-arm; then skip 'small, Cortex-M7' qemu-system-arm
else
    . tests/target/board.sh
    board_set m7
    program=$(board_build replay_run) || failed=$((failed + 1))
    case $program in /*) ;; *) program=$PWD/$program ;; esac
    cp "$logs/small.log" "$logs/replay.log" && cd "$logs" || exit 1
    agrees 'small, Cortex-M7' "$state_small" timeout 300 qemu-system-arm -M mps2-an500 -nographic -monitor none \
        -serial none -semihosting-config enable=on,target=native -icount shift=6 -kernel "$program"
fi
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
