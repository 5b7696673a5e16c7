#!/bin/sh
# hashes: one table of state hashes over threads, schedulers, compilers, optimisation and processors.
# SPDX-License-Identifier: MIT
# usage: MAKE=... BUILD=... hashes.sh     (called by `make hashes`)
# What other checks compile is not compiled again: the plain build itself, BUILD/clang of a check with clang, BUILD/layers of
# check_layers.sh, and BUILD/hashes, which check_replay.sh and check_traps.sh share.
# Ends with 1 when a configuration gives another hash or does not build. Configurations are built and run side by side, one per
# processor or SMR_JOBS. SMR_NO_BOARDS=1: without the boards, and SMR_AGAIN=1: without
# threads, schedulers, Armv7 and clang -O0, for `make check` compares them with the same run.
set -u
make=${MAKE:-make}
own=${BUILD:-build}
build=$own/hashes
jobs=${SMR_JOBS:-$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 1)}
rows=$build/rows
rm -rf "$rows"
mkdir -p "$rows" || exit 1
have() { command -v "$1" >/dev/null 2>&1; }
. tests/target/board.sh

# ---------------------------------------------------------------- configurations

# A row of the table: what a run printed, or why it was skipped. Rows stand in the order of their configurations.
row() { printf '%s\t%s\n' "$1" "$2" >>"$rows/$configuration"; }
again() { [ "${SMR_AGAIN:-0}" = 1 ] && row "$1" "skipped ($2, SMR_AGAIN=1)"; } # name, what has it
skip() { row "$1" "skipped (needs $2)"; }

# Builds golden in its own directory; 1 and a row when that fails.
compile() { # name, directory below BUILD/hashes, target, make variables...
    name=$1; dir=$(cd "$build" && mkdir -p "$2" && cd "$2" && pwd); target=$3; shift 3
    dir=${dir#"$PWD/"}
    $make -s -j"${compile_jobs:-1}" BUILD="$dir" "$@" "$dir/$target" >"$dir/hashes.log" 2>&1 && return 0
    row "$name" "FAILED to build: $(tail -n 5 "$dir/hashes.log" | tr '\n\t' '  ')"; return 1
}

plain_loop() {
    compile_jobs=$jobs compile 'gcc -O3' .. golden CC="${CC:-gcc}" || return
    row 'plain loop (gcc -O3)' "$("$host/golden")"
    row 'with saves' "$("$host/golden" saves "$build/saves")"
}

schedulers() {
    [ -x "$host/golden" ] || return
    ! again 'threads and schedulers' 'check_golden.sh runs them' || return 0
    for n in 1 2 3 4 8; do row "$n threads" "$("$host/golden" threads $n)"; done
    row 'reverse order' "$("$host/golden" reverse)"
    row 'shuffled order, 8 workers' "$("$host/golden" shuffle)"
    row 'interleaved, 8 workers' "$("$host/golden" interleave)"
}

compiler() { # compiler, flags, directory
    if ! have "$1"; then skip "$1 $2" "$1"; return; fi
    compile "$1 $2" "$3" golden CC="$1" CFLAGS="$2" && row "$1 $2" "$("$dir/golden" threads 2)"
}

run='threads 2' all_of=golden
cross() { # name, compiler prefix, qemu, package of the C library, more flags
    if ! have "$2-gcc"; then skip "$1" "gcc-$2 $4"; return; fi
    if ! have "$3"; then skip "$1" qemu-user; return; fi
    for part in $all_of; do compile "$1" "$2" "$part" CC="$2-gcc" AR="$2-ar" CFLAGS="-O2 $5" LDFLAGS=-static || return; done
    row "$1" "$("$3" "$build/$2/golden" $run)"
    [ "$all_of" = golden ] && return
    "$3" "$build/$2/answers" few >"$build/answers" || echo "ended with $?" >>"$build/answers"
    said=$(grep -vxFf tests/golden/answers.txt "$build/answers") && row "$1" "FAILED: answers: $(echo "$said" | tr '\n\t' '  ')"
}

# The whole run, whose saves must be this machine's, and which goes on from those; and some answers. Strict C11 would evaluate floats in double there.
big_endian() {
    run="restores $build/saves" all_of='golden answers'
    cross 's390x, big-endian (qemu-user)' s390x-linux-gnu qemu-s390x libc6-dev-s390x-cross -fexcess-precision=fast
    run='threads 2' all_of=golden
}

on_board() { # m7 or m55
    board_set "$1"
    name="$board_name bare metal ($board_machine)"
    if [ "${SMR_NO_BOARDS:-0}" = 1 ]; then row "$name" 'skipped (tests/target/check_boards.sh runs it, SMR_NO_BOARDS=1)'
    elif ! have arm-none-eabi-gcc; then skip "$name" 'gcc-arm-none-eabi libnewlib-arm-none-eabi'
    elif ! have qemu-system-arm; then skip "$name" qemu-system-arm
    elif compile "$name" "../$1-board" "golden_$1.elf" CC=arm-none-eabi-gcc AR=arm-none-eabi-ar \
        CFLAGS="$board_cflags -O2 -DSMR_BAREMETAL"; then
        row "$name" "$(board_run 6 "$dir/golden_$1.elf" | tail -n 1)"
    fi
}

configure() { # number: its place in the table
    configuration=$1
    case $1 in
    11) schedulers ;;
    20) compiler gcc '-O0 -w' ../layers ;;
    21) compiler gcc -O2 gcc-O2 ;;
    22) compiler gcc '-O3 -march=native' gcc-O3-marchnative ;;
    30) again 'clang -O0' 'tests/check_link.sh has -O1' || compiler clang -O0 clang-O0 ;;
    31) compiler clang -O2 clang-O2 ;;
    32) compiler clang -O3 ../clang ;;
    33) compiler clang '-O3 -march=native' clang-O3-marchnative ;;
    40) cross 'AArch64 (qemu-user)' aarch64-linux-gnu qemu-aarch64 libc6-dev-arm64-cross '' ;;
    41) again 'Armv7 hard float (qemu-user)' 'the Cortex-M7 and M55 have its arithmetic' ||
            cross 'Armv7 hard float (qemu-user)' arm-linux-gnueabihf qemu-arm libc6-dev-armhf-cross '' ;;
    42) cross 'RISC-V 64 (qemu-user)' riscv64-linux-gnu qemu-riscv64 libc6-dev-riscv64-cross '' ;;
    43) big_endian ;;
    50) on_board m7 ;;
    51) on_board m55 ;;
    esac
}

# Takes what no other worker has taken; what takes longest is first.
work() {
    for number in 43 50 51 42 41 40 33 32 31 30 22 21 20 11; do
        mkdir "$rows/taken$number" 2>/dev/null && configure $number
    done
}

# ---------------------------------------------------------------- run, then the table

host=$own
configuration=10
plain_loop # first: the saves of this machine are for another one
workers=
trap 'kill $workers 2>/dev/null; exit 1' HUP INT TERM
for k in $(seq "$jobs"); do
    work &
    workers="$workers $!"
done
wait

first=; passed=0; failed=0; skipped=0
tab=$(printf '\t')
judge() { # name, line
    line=${2#smr-hash }
    case $2 in
    'smr-hash error'* | '') line="FAILED ${line:-(no output)}"; failed=$((failed + 1)) ;;
    FAILED*) failed=$((failed + 1)) ;;
    'skipped '*) skipped=$((skipped + 1)) ;;
    *)
        [ -n "$first" ] || first=$line
        if [ "$line" = "$first" ]; then passed=$((passed + 1)); else failed=$((failed + 1)); line="$line   DIFFERS"; fi ;;
    esac
    printf '%-34s %s\n' "$1" "$line"
}
cat "$rows"/[1-9]* >"$rows/all"
while IFS="$tab" read -r name line; do judge "$name" "$line"; done <"$rows/all"
for number in 10 11 20 21 22 30 31 32 33 40 41 42 43 50 51; do
    [ -s "$rows/$number" ] || { echo "configuration $number: no row"; failed=$((failed + 1)); }
done
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
