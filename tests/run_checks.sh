#!/bin/sh
# run_checks: runs test programs, the golden run and the script checks; the last line is the sum.
# SPDX-License-Identifier: MIT
# usage: BUILD=... CC=... SMR=... FIXTURE_WRITE=... run_checks.sh PROGRAM...
#
# A script ends with 0 passed, 77 skipped, anything else failed, unless its last line is itself a sum
# "N passed, N failed, N skipped". Output is shown only for what did not pass.
# As many run at a time as there are processors, or SMR_JOBS. Each leaves its sum beside its log. Without flock one at a time:
# scripts share the boards' build directories.
set -u
export BUILD CC NM SMR FIXTURE_WRITE
log_dir=$BUILD/log
rm -rf "$log_dir"
mkdir -p "$log_dir/taken" || exit 1
jobs=1
if command -v flock >/dev/null; then jobs=${SMR_JOBS:-$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 1)}; fi

limit() { if command -v timeout >/dev/null; then timeout 900 "$@"; else "$@"; fi; }

# Notes counts and prints one line; the log follows when something failed. All at once: others print, too.
tell() { # name passed failed skipped log
    verdict=ok
    [ "$4" -gt 0 ] && verdict=skip
    [ "$3" -gt 0 ] && verdict=FAIL
    echo "$2 $3 $4" >"$5.sum"
    {
        printf '%-4s  %-44s %s passed, %s failed, %s skipped\n' "$verdict" "$1" "$2" "$3" "$4"
        if [ "$verdict" = FAIL ]; then # what failed, wherever it stands, then the end
            { grep -n -A 5 -E '^not ok |^\[  FAILED|^\[   LINE' "$5" | head -n 40; echo ...; tail -n 30 "$5"; } | sed 's/^/      | /'
        fi
        if [ "$verdict" = skip ]; then grep -i 'skip' "$5" | head -n 3 | sed 's/^/      | /'; fi
    } >"$5.told"
    cat "$5.told"
}

log_of() { echo "$log_dir/$(echo "${1#"$BUILD"/}" | tr / _).log"; }

# CMocka: the sum of "[  PASSED  ] n test(s)" and so on over all groups of the program.
count() { sed -n "s/^\[  *$1 *\] \([0-9][0-9]*\) test(s).*/\1/p" "$2" | awk '{n += $1} END {print n + 0}'; }

run_program() {
    name=${1#"$BUILD"/}
    log=$(log_of "$1")
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
    log=$(log_of "$1")
    limit sh "$1" >"$log" 2>&1
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

# Takes what no other worker has taken, until nothing is left.
work() {
    k=0
    for item in "$@"; do
        k=$((k + 1))
        mkdir "$log_dir/taken/$k" 2>/dev/null || continue
        case $item in
        *.sh) run_script "$item" ;;
        *) run_program "$item" ;;
        esac
    done
}

# The longest first.
for script in tests/check_*.sh tests/host/*.sh tests/golden/check_*.sh tests/target/check_*.sh; do
    case $script in
    *'*'* | tests/check_stack.sh) ;;
    *) set -- "$script" "$@" ;;
    esac
done
workers=
trap 'kill $workers 2>/dev/null; exit 1' HUP INT TERM # they end with what they are at
for k in $(seq "$jobs"); do
    work "$@" &
    workers="$workers $!"
done
wait
passed=0; failed=0; skipped=0
for item in "$@"; do
    if read -r p f s <"$(log_of "$item").sum"; then passed=$((passed + p)); failed=$((failed + f)); skipped=$((skipped + s))
    else failed=$((failed + 1)); echo "FAIL  $item: did not end"; fi
done
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
