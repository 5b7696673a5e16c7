#!/bin/sh
# check_budget_m7: runs target_budget on the emulated Cortex-M7, one nanosecond per instruction.
# SPDX-License-Identifier: MIT
set -u
build=${BUILD:-build}
for tool in arm-none-eabi-gcc qemu-system-arm; do
    command -v $tool >/dev/null || { echo "skip: needs $tool"; exit 77; }
done
unset CFLAGS LDFLAGS
${MAKE:-make} -s BUILD="$build/m7-golden" CC=arm-none-eabi-gcc AR=arm-none-eabi-ar \
    CFLAGS="${M7_CFLAGS:--mthumb -mcpu=cortex-m7 -mfpu=fpv5-d16 -mfloat-abi=hard} -O2 -DSMR_BAREMETAL" \
    "$build/m7-golden/target_budget_m7.elf" || exit 1
timeout 300 qemu-system-arm -M mps2-an500 -nographic -monitor none -serial none \
    -semihosting-config enable=on,target=native -icount shift=0 \
    -kernel "$build/m7-golden/target_budget_m7.elf" </dev/null
