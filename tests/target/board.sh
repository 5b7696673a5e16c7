# board: the emulated boards, for scripts to read in: `. tests/target/board.sh`, from the project's folder.
# SPDX-License-Identifier: MIT
# board_set BOARD          m7 or m55: sets board_name, board_machine, board_cflags
# board_need               ends the script as skipped where a tool is missing
# board_build PROGRAM      prints the program's file; flags for the compiler may follow
# board_run SHIFT FILE     runs it: an instruction takes 2^SHIFT nanoseconds of the board's time; words for it may follow

board_set() {
    case $1 in
    m7) board_name=Cortex-M7; board_machine=mps2-an500
        board_cflags=${M7_CFLAGS:--mthumb -mcpu=cortex-m7 -mfpu=fpv5-d16 -mfloat-abi=hard -ffunction-sections -fdata-sections -fstack-usage} ;;
    m55) board_name=Cortex-M55; board_machine=mps3-an547
        board_cflags=${M55_CFLAGS:--mthumb -mcpu=cortex-m55+nomve.fp -mfloat-abi=hard -ffunction-sections -fdata-sections} ;;
    *) echo "no such board: $1"; exit 1 ;;
    esac
    board=$1
}

board_need() {
    # A run that checks another compiler of this machine need not repeat what the boards' compiler made.
    [ "${SMR_NO_BOARDS:-0}" = 1 ] && { echo 'skip: the boards run once, with the first compiler (SMR_NO_BOARDS=1)'; exit 77; }
    for tool in arm-none-eabi-gcc qemu-system-arm; do
        command -v $tool >/dev/null || { echo "skip: needs $tool"; exit 77; }
    done
    # The host's own flags (a sanitiser, perhaps) are not for the board.
    unset CFLAGS LDFLAGS
}

board_build() {
    board_program=$1; shift
    board_dir=${BUILD:-build}/$board-board
    mkdir -p "$board_dir" || return 1
    set -- ${MAKE:-make} -s BUILD="$board_dir" CC=arm-none-eabi-gcc AR=arm-none-eabi-ar \
        CFLAGS="$board_cflags -O2 -DSMR_BAREMETAL $*" "$board_dir/${board_program}_$board.elf"
    if command -v flock >/dev/null; then flock "$board_dir/lock" "$@" >&2 || return 1 # other scripts build here, too
    else "$@" >&2 || return 1; fi
    echo "$board_dir/${board_program}_$board.elf"
}

board_run() {
    board_shift=$1; board_file=$2; shift 2
    board_words=arg=smr
    for word in "$@"; do board_words=$board_words,arg=$word; done
    timeout "${SMR_BOARD_SECONDS:-800}" qemu-system-arm -M "$board_machine" -nographic -monitor none -serial none \
        -semihosting-config "enable=on,target=native,$board_words" -icount "shift=$board_shift" \
        -kernel "$board_file" 2>&1 </dev/null
}
