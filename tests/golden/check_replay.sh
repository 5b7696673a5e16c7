#!/bin/sh
# check_replay: a log of 500 ticks, recorded on two threads under a jittering clock, replays to the same bits everywhere.
# SPDX-License-Identifier: MIT
# On 1 and 4 threads, built by clang, and the small model's on AArch64, big-endian s390x (both qemu-user) and a Cortex-M7 board
# (QEMU). The libraries of other compilers and processors are those of `make hashes`.
set -u
. tests/checks.inc
program=$build/replay_run
need_file "$program"
logs=$build/replay-logs
mkdir -p "$logs"

# agrees NAME SIZE COMMAND...: all ticks agree, and the last state is the recorded one.
agrees() {
    name="$2, $1"; eval "state=\$state_$2"; shift 2
    same "$name" "$("$@" 2>&1 </dev/null | tail -n 1)" "replay-run 500 ticks agree, state $state"
}
sizes='small big'
case ${CFLAGS:-} in *sanitize*) sizes=small ;; esac # the big one goes through the same code, and takes long there
for size in $sizes; do
    line=$("$program" record "$logs/$size.log" 500 ${size#small}) || { not_ok "$line"; finish; }
    eval "state_$size=\${line##* }"
    "$program" replay "$logs/$size.log" | head -n 1 | sed "s/^/$size /"
    for n in 1 4; do agrees "$n threads" $size "$program" replay "$logs/$size.log" $n; done
done
if [ "${SMR_NO_BOARDS:-0}" = 1 ]; then skip 'other processors' 'they replay once, with the first compiler, SMR_NO_BOARDS=1'; finish; fi

unset CFLAGS LDFLAGS # the host's own, a sanitiser's perhaps
# other NAME SIZE COMPILER QEMU PACKAGE DIRECTORY FLAGS [VARIABLE...]
other() {
    name=$1 size=$2 compiler=$3 qemu=$4 package=$5 dir=$build/hashes/$6 flags=$7
    shift 7
    have "$compiler" && have "${qemu:-sh}" || { skip "$name" "needs $package"; return; }
    mkdir -p "$dir"
    check "$name is built" ${MAKE:-make} -s BUILD="$dir" CC="$compiler" CFLAGS="$flags" "$@" "$dir/replay_run" &&
        agrees "$name" "$size" $qemu "$dir/replay_run" replay "$logs/$size.log" 2
}
other clang big clang '' clang clang-O2 -O2
for row in 'AArch64 small aarch64-linux-gnu qemu-aarch64 arm64' 's390x small s390x-linux-gnu qemu-s390x s390x -fexcess-precision=fast'; do
    # shellcheck disable=SC2086
    set -- $row # s390x: strict C11 would evaluate floats in double there
    other "$1" "$2" "$3-gcc" "$4" "gcc-$3, libc6-dev-$5-cross and qemu-user" "$3" "-O2 ${6:-}" AR="$3-ar" LDFLAGS=-static
done
if have arm-none-eabi-gcc && have qemu-system-arm; then
    . tests/target/board.sh
    board_set m7
    program=$(board_build replay_run) || not_ok 'Cortex-M7: replay_run is built'
    case $program in /*) ;; *) program=$PWD/$program ;; esac
    cp "$logs/small.log" "$logs/replay.log" && cd "$logs" || exit 1
    agrees 'Cortex-M7' small timeout 300 qemu-system-arm -M mps2-an500 -nographic -monitor none -serial none \
        -semihosting-config enable=on,target=native -icount shift=6 -kernel "$program"
else skip 'Cortex-M7' 'needs gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm'; fi
finish
