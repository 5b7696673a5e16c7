#!/bin/sh
# check_cortex_m7: the golden run on an emulated Cortex-M7 board gives this machine's bits.
# SPDX-License-Identifier: MIT
set -u
build=${BUILD:-build}
for tool in arm-none-eabi-gcc qemu-system-arm; do
    command -v $tool >/dev/null || { echo "skip: needs $tool"; exit 77; }
done
[ -x "$build/golden" ] || { echo "skip: no $build/golden"; exit 77; }
want=$("$build/golden") || { echo "$want"; exit 1; }
# The host's own flags (a sanitiser, perhaps) are not for the board.
unset CFLAGS LDFLAGS
${MAKE:-make} -s BUILD="$build/m7-golden" CC=arm-none-eabi-gcc AR=arm-none-eabi-ar \
    CFLAGS="${M7_CFLAGS:--mthumb -mcpu=cortex-m7 -mfpu=fpv5-d16 -mfloat-abi=hard} -O2 -DSMR_BAREMETAL" \
    "$build/m7-golden/golden_m7.elf" || exit 1
got=$(timeout 300 qemu-system-arm -M mps2-an500 -nographic -monitor none -serial none \
    -semihosting-config enable=on,target=native -icount shift=6 \
    -kernel "$build/m7-golden/golden_m7.elf" 2>&1 </dev/null)
rc=$?
echo "board:        $got (status $rc)"
echo "this machine: $want"
[ "$rc" -eq 0 ] && [ "$got" = "$want" ]
