#!/bin/sh
# run_checks: runs test programs, the golden run and the script checks; the last line is the sum.
# SPDX-License-Identifier: MIT
# usage: BUILD=... CC=... SMR=... FIXTURE_WRITE=... run_checks.sh PROGRAM...
#
# A script ends with 0 passed, 77 skipped, anything else failed, unless its last line is itself a sum
# "N passed, N failed, N skipped". Output is shown only for what did not pass.
set -u
export BUILD CC NM SMR FIXTURE_WRITE
log_dir=$BUILD/log
mkdir -p "$log_dir"
passed=0; failed=0; skipped=0

limit() { if command -v timeout >/dev/null; then timeout 900 "$@"; else "$@"; fi; }

# Adds counts and prints one line; the log follows when something failed.
tell() { # name passed failed skipped log
    passed=$((passed + $2)); failed=$((failed + $3)); skipped=$((skipped + $4))
    verdict=ok
    [ "$4" -gt 0 ] && verdict=skip
    [ "$3" -gt 0 ] && verdict=FAIL
    printf '%-4s  %-44s %s passed, %s failed, %s skipped\n' "$verdict" "$1" "$2" "$3" "$4"
    if [ "$verdict" = FAIL ]; then # what failed, wherever it stands, then the end
        { grep -n -A 5 -E '^not ok |^\[  FAILED|^\[   LINE' "$5" | head -n 40; echo ...; tail -n 30 "$5"; } | sed 's/^/      | /'
    fi
    if [ "$verdict" = skip ]; then grep -i 'skip' "$5" | head -n 3 | sed 's/^/      | /'; fi
    return 0
}

# CMocka: the sum of "[  PASSED  ] n test(s)" and so on over all groups of the program.
count() { sed -n "s/^\[  *$1 *\] \([0-9][0-9]*\) test(s).*/\1/p" "$2" | awk '{n += $1} END {print n + 0}'; }

run_program() {
    name=${1#"$BUILD"/}
    log=$log_dir/$(echo "$name" | tr / _).log
    limit "$1" >"$log" 2>&1
    rc=$?
    p=$(count PASSED "$log"); f=$(count FAILED "$log"); s=$(count SKIPPED "$log")
    if [ "$rc" -ne 0 ] && [ "$f" -eq 0 ]; then
        echo "ended with status $rc" >>"$log"; f=1
    elif [ $((p + f + s)) -eq 0 ]; then
        echo "no test was run" >>"$log"; f=1
    fi
    tell "$name" "$p" "$f" "$s" "$log"
}

run_script() {
    name=$1
    log=$log_dir/$(echo "$name" | tr / _).log
    limit sh "$@" >"$log" 2>&1
    rc=$?
    sum=$(tail -n 1 "$log" | grep -E '^[0-9]+ passed, [0-9]+ failed, [0-9]+ skipped$' || true)
    if [ -n "$sum" ]; then
        # shellcheck disable=SC2046
        set -- $(echo "$sum" | tr -c '0-9\n' ' ')
        [ "$rc" -ne 0 ] && [ "$2" -eq 0 ] && set -- "$1" 1 "$3"
    elif [ "$rc" -eq 0 ]; then set -- 1 0 0
    elif [ "$rc" -eq 77 ]; then set -- 0 0 1
    else set -- 0 1 0
    fi
    tell "$name" "$1" "$2" "$3" "$log"
}

for program in "$@"; do run_program "$program"; done
for script in tests/golden/check_*.sh tests/target/check_*.sh tests/host/*.sh tests/check_*.sh; do
    case $script in
    *'*'* | tests/check_stack.sh) ;;
    *) run_script "$script" ;;
    esac
done
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
