#!/bin/sh
# hashes: one table of state hashes over threads, schedulers, compilers, optimisation and processors.
# SPDX-License-Identifier: MIT
# usage: MAKE=... BUILD=... hashes.sh     (called by `make hashes`)
# Ends with 1 when a configuration gives another hash or does not build.
set -u
make=${MAKE:-make}
build=${BUILD:-build}/hashes
jobs=$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 1)
mkdir -p "$build"
first=; passed=0; failed=0; skipped=0

row() { printf '%-34s %s\n' "$1" "$2"; }
judge() { # name, line
    line=${2#smr-hash }
    case $2 in 'smr-hash error'* | '') row "$1" "FAILED ${line:-(no output)}"; failed=$((failed + 1)); return ;; esac
    [ -n "$first" ] || first=$line
    if [ "$line" = "$first" ]; then row "$1" "$line"; passed=$((passed + 1))
    else row "$1" "$line   DIFFERS"; failed=$((failed + 1)); fi
}
skip() { row "$1" "skipped (needs $2)"; skipped=$((skipped + 1)); }
have() { command -v "$1" >/dev/null 2>&1; }

# Builds golden in its own directory; 1 and a row when that fails.
compile() { # name, directory, target, make variables...
    name=$1; dir=$build/$2; target=$3; shift 3
    mkdir -p "$dir"
    $make -s -j"$jobs" BUILD="$dir" "$@" "$dir/$target" >"$dir/log" 2>&1 && return 0
    row "$name" 'FAILED to build:'; tail -n 5 "$dir/log"; failed=$((failed + 1)); return 1
}

host=$build/gcc-O3
if compile 'gcc -O3' gcc-O3 golden CC=gcc CFLAGS=-O3; then
    judge 'plain loop (gcc -O3)' "$("$host/golden")"
    for n in 1 2 3 4 8; do judge "$n threads" "$("$host/golden" threads $n)"; done
    judge 'reverse order' "$("$host/golden" reverse)"
    judge 'shuffled order, 8 workers' "$("$host/golden" shuffle)"
    judge 'interleaved, 8 workers' "$("$host/golden" interleave)"
    judge 'with saves' "$("$host/golden" saves "$build/saves")"
fi
for cc in gcc clang; do
    for flags in -O0 -O2 -O3 '-O3 -march=native'; do
        if ! have $cc; then skip "$cc $flags" $cc; continue; fi
        [ "$cc$flags" = gcc-O3 ] && continue
        id=$cc$(echo "$flags" | tr -d ' =')
        compile "$cc $flags" "$id" golden CC=$cc CFLAGS="$flags" &&
            judge "$cc $flags" "$("$build/$id/golden" threads 2)"
    done
done

cross() { # name, compiler prefix, qemu, package of the C library, more flags
    if ! have "$2-gcc"; then skip "$1" "gcc-$2 $4"; return; fi
    if ! have "$3"; then skip "$1" qemu-user; return; fi
    compile "$1" "$2" golden CC="$2-gcc" AR="$2-ar" CFLAGS="-O2 $5" LDFLAGS=-static &&
        judge "$1" "$("$3" "$build/$2/golden" threads 2)"
}
cross 'AArch64 (qemu-user)' aarch64-linux-gnu qemu-aarch64 libc6-dev-arm64-cross ''
cross 'Armv7 hard float (qemu-user)' arm-linux-gnueabihf qemu-arm libc6-dev-armhf-cross ''
cross 'RISC-V 64 (qemu-user)' riscv64-linux-gnu qemu-riscv64 libc6-dev-riscv64-cross ''
# s390x: strict C11 would evaluate floats in double there.
cross 's390x, big-endian (qemu-user)' s390x-linux-gnu qemu-s390x libc6-dev-s390x-cross -fexcess-precision=fast
if [ -x "$build/s390x-linux-gnu/golden" ] && have qemu-s390x && [ -s "$build/saves" ]; then
    judge 's390x, from the saves of this machine' "$(qemu-s390x "$build/s390x-linux-gnu/golden" restores "$build/saves")"
fi

. tests/target/board.sh
for board in m7 m55; do
    board_set $board
    name="$board_name bare metal ($board_machine)"
    if ! have arm-none-eabi-gcc; then skip "$name" 'gcc-arm-none-eabi libnewlib-arm-none-eabi'
    elif ! have qemu-system-arm; then skip "$name" qemu-system-arm
    elif compile "$name" $board golden_$board.elf CC=arm-none-eabi-gcc AR=arm-none-eabi-ar \
        CFLAGS="$board_cflags -O2 -DSMR_BAREMETAL"; then
        judge "$name" "$(board_run 6 "$build/$board/golden_$board.elf" | tail -n 1)"
    fi
done
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
