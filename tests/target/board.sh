# board: the emulated boards, for scripts to read in: `. tests/target/board.sh`, from the project's folder.
# SPDX-License-Identifier: MIT
# board_set BOARD          sets board_name, board_machine, board_emulator, board_tools and board_cflags
# board_missing            prints what the board that is set needs and this machine has not
# board_need               ends the script as skipped where a tool for the Cortex-M is missing
# board_bone_of MM         writes the models that some programs read from the emulator's folder, board_bone
# board_build PROGRAM      prints the program's file; flags for the compiler may follow
# board_run SHIFT FILE     runs it: an instruction takes 2^SHIFT nanoseconds of the board's time; words for it may follow

boards='m3 m4 m7 m33 m55 a53 rv32 rv64'
board_set() {
    board_tools=arm-none-eabi
    sections='-ffunction-sections -fdata-sections'
    virt='virt -m 128 -nic none'
    case $1 in
    m3) board_name=Cortex-M3; board_machine=mps2-an385
        board_cflags="-mthumb -mcpu=cortex-m3 -mfloat-abi=soft $sections" ;;
    m4) board_name=Cortex-M4; board_machine=mps2-an386
        board_cflags="-mthumb -mcpu=cortex-m4 -mfpu=fpv4-sp-d16 -mfloat-abi=hard $sections" ;;
    m7) board_name=Cortex-M7; board_machine=mps2-an500
        board_cflags=${M7_CFLAGS:--mthumb -mcpu=cortex-m7 -mfpu=fpv5-d16 -mfloat-abi=hard $sections -fstack-usage} ;;
    m33) board_name=Cortex-M33; board_machine=mps2-an505
        board_cflags="-mthumb -mcpu=cortex-m33 -mfpu=fpv5-sp-d16 -mfloat-abi=hard $sections" ;;
    m55) board_name=Cortex-M55; board_machine=mps3-an547
        board_cflags=${M55_CFLAGS:--mthumb -mcpu=cortex-m55+nomve.fp -mfloat-abi=hard $sections} ;;
    a53) board_name=Cortex-A53; board_machine="$virt -cpu cortex-a53"; board_tools=aarch64-linux-gnu
        board_cflags="-mcpu=cortex-a53 -mstrict-align -mno-outline-atomics -static -fno-pie -no-pie $sections"
        board_cflags="$board_cflags -fno-asynchronous-unwind-tables -fno-stack-protector -Wl,--build-id=none" ;;
    rv32) board_name=RV32; board_machine="$virt -cpu rv32 -bios none"; board_tools=riscv64-unknown-elf
        board_cflags="-march=rv32imafc -mabi=ilp32f -mcmodel=medany --specs=picolibc.specs $sections" ;;
    rv64) board_name=RV64; board_machine="$virt -cpu rv64 -bios none"; board_tools=riscv64-unknown-elf
        board_cflags="-march=rv64imafdc -mabi=lp64d -mcmodel=medany --specs=picolibc.specs $sections" ;;
    *) echo "no such board: $1"; exit 1 ;;
    esac
    case $1 in m*) board_emulator=qemu-system-arm ;; a53) board_emulator=qemu-system-aarch64 ;;
    *) board_emulator=qemu-system-riscv${1#rv} ;; esac
    board=$1
}

board_missing() {
    for tool in "$board_tools-gcc" "$board_emulator"; do command -v "$tool" >/dev/null || { echo "$tool"; return; }; done
    [ "$board_tools" != riscv64-unknown-elf ] || $board_tools-gcc --specs=picolibc.specs -E -x c /dev/null >/dev/null 2>&1 ||
        echo picolibc-riscv64-unknown-elf
}

board_need() {
    # A run that checks another compiler of this machine need not repeat what the boards' compiler made.
    [ "${SMR_NO_BOARDS:-0}" = 1 ] && { echo 'skip: the boards run once, with the first compiler (SMR_NO_BOARDS=1)'; exit 77; }
    board_set "${1:-m7}"
    missing=$(board_missing)
    [ -z "$missing" ] || { echo "skip: needs $missing"; exit 77; }
    # The host's own flags (a sanitiser, perhaps) are not for the board.
    unset CFLAGS LDFLAGS
}

# A bone's model as C, which the board has in flash.
board_flash() {
    host=${BUILD:-build}
    mkdir -p "$host/flash" "$board_dir/flash" || return 1
    "$host/fixture_write" "$host/flash" 1 12 &&
        "${SMR:-$host/smr}" build --model "$host/flash/source.ply" --radius 90,45 --quiet \
            -o "$board_dir/flash/bone_model.c" --c-array bone_model
}

# Models of a bone of this mean edge, mm, and of a deformed one, in board_bone.
board_bone_of() {
    host=${BUILD:-build} board_bone=${BUILD:-build}/$board-board/bone_$1
    mkdir -p "$board_bone" && "$host/fixture_write" "$board_bone" 1 "$1" &&
        for of in source target; do "${SMR:-$host/smr}" build --model "$board_bone/$of.ply" -o "$board_bone/$of.smr" --quiet; done
}

board_build() {
    board_program=$1; shift
    board_dir=${BUILD:-build}/$board-board
    mkdir -p "$board_dir" || return 1
    [ "$board_program" != target_flash ] || board_flash >&2 || return 1
    set -- ${MAKE:-make} -s BUILD="$board_dir" CC="$board_tools-gcc" AR="$board_tools-ar" \
        CFLAGS="$board_cflags -O2 -DSMR_BAREMETAL $*" "$board_dir/${board_program}_$board.elf"
    if command -v flock >/dev/null; then flock "$board_dir/lock" "$@" >&2 || return 1 # other scripts build here, too
    else "$@" >&2 || return 1; fi
    echo "$board_dir/${board_program}_$board.elf"
}

board_run() {
    board_shift=$1; board_file=$2; shift 2
    board_words=arg=smr
    for word in "$@"; do board_words=$board_words,arg=$word; done
    # shellcheck disable=SC2086
    timeout "${SMR_BOARD_SECONDS:-800}" $board_emulator -M $board_machine -nographic -monitor none -serial none \
        -semihosting-config "enable=on,target=native,$board_words" -icount "shift=$board_shift" \
        -kernel "$board_file" 2>&1 </dev/null
}
