#!/bin/sh
# run_checks: runs test programs and the scripts that check; the last line is the sum.
# SPDX-License-Identifier: MIT
# usage: BUILD=... CC=... SMR=... run_checks.sh [--quick | --tables] PROGRAM...     (V=1: a line for each)
# --quick: unit tests and what checks sources; --tables: the programs alone, and the tables that they print (make experiments).
# SMR_SKIP: words; what has one of them in its name is not run, and counts as skipped.
#
# A script ends with 0 (passed), 77 (skipped) or another status (failed), unless its last line is a sum of its own,
# "N passed, N failed, N skipped". The terminal shows progress, what failed with the lines that matter, what was
# skipped and why, and the sum; $BUILD/log holds everything.
# Programs run in parallel, one per processor or SMR_JOBS, those that take longest first. Without flock they run one after
# another, because scripts share the boards' build directories. `script.sh:word:word` is a script with words.
set -u
export BUILD CC NM SMR
log_dir=$BUILD/log
rm -rf "$log_dir"
mkdir -p "$log_dir/taken" || exit 1
jobs=1
if command -v flock >/dev/null; then jobs=${SMR_JOBS:-$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 1)}; fi
terminal=0
if [ -t 1 ]; then terminal=1; fi

limit() { if command -v timeout >/dev/null; then timeout 1800 "$@"; else "$@"; fi; }

log_of() { echo "$log_dir/$(echo "${1#"$BUILD"/}" | tr / _).log"; }

# Prints one line for a program, and the lines of its log that matter when it failed.
describe() { # name passed failed skipped log
    verdict=ok
    [ "$4" -gt 0 ] && verdict=skip
    [ "$3" -gt 0 ] && verdict=FAIL
    printf '%-4s  %-44s %s passed, %s failed, %s skipped\n' "$verdict" "$1" "$2" "$3" "$4"
    if [ "$verdict" = FAIL ]; then # what failed, wherever it stands, then the end
        { grep -n -A 5 -E '^not ok |^\[  FAILED|^\[   LINE' "$5" | head -n 40; echo ...; tail -n 30 "$5"; } |
            sed 's/^/      | /'
    fi
}

# Counts the programs that have ended: one line that is overwritten, or a new one every ten programs.
progress() { # total
    set -- "$1" "$log_dir"/*.sum
    ended=$(($# - 1))
    if [ "$terminal" = 1 ]; then printf '\r\033[K%s of %s' "$ended" "$1"
    elif [ "${V:-0}" != 1 ] && [ $((ended % 10)) -eq 0 ]; then echo "$ended of $1"; fi
}

# Writes the sum of a program and prints it. Only one worker at a time does so.
tell() { # name passed failed skipped log
    [ "$jobs" = 1 ] || flock 9
    echo "$2 $3 $4" >"$5.sum"
    describe "$@" >"$5.told"
    if [ "$3" -gt 0 ] || [ "${V:-0}" = 1 ]; then
        [ "$terminal" = 1 ] && printf '\r\033[K'
        cat "$5.told"
    fi
    progress "$total"
    [ "$jobs" = 1 ] || flock -u 9
}

# CMocka: the sum of "[  PASSED  ] n test(s)" and so on over all groups of the program.
count() { sed -n "s/^\[  *$1 *\] \([0-9][0-9]*\) test(s).*/\1/p" "$2" | awk '{n += $1} END {print n + 0}'; }

run_program() {
    name=${1#"$BUILD"/}
    log=$(log_of "$1")
    limit "$1" >"$log" 2>&1 9>&-
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
    # shellcheck disable=SC2046
    limit sh $(echo "$1" | tr : ' ') >"$log" 2>&1 9>&-
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
        *.sh | *.sh:*) run_script "$item" ;;
        *) run_program "$item" ;;
        esac
    done
}

# The M7 has the golden run, budgets and tracking. SMR_FULL=1: its interrupt, the M55, the A53, the table of instructions, all
# ways to link; `make boards` has the others. 250 ticks are for all cases of target_budget, which the M7 has.
items='m7:golden m7:target_budget m7:target_track'
boards='' without=tests/check_link.sh ticks=200
if [ "${SMR_FULL:-0}" = 1 ]; then
    items="$items m7:target_interrupt m7:target_jobs m55:golden m55:target_budget m55:target_interrupt m55:target_track"
    items="$items a53:target_flash"
    boards=tests/target/check_timing.sh without=none ticks=250
fi
for item in $items; do boards="$boards tests/target/check_boards.sh:$item:$(case $item in m55*) echo 100 ;; *) echo $ticks ;; esac)"; done
# shellcheck disable=SC2010
scripts="$boards $(ls tests/check_*.sh tests/host/*.sh tests/golden/check_*.sh | grep -v "$without")"
tables=
case ${1:-} in
--tables) shift; scripts=; tables=1 ;;
--quick)
    shift
    scripts=
    for name in check_style check_structs check_format check_layers check_symbols golden/check_golden; do
        scripts="$scripts tests/$name.sh"
    done ;;
esac
# What takes longest, in this order; the rest as it comes.
long='target_budget check_replay check_link test_host_bench experiments/ test_properties check_fused check_traps
    test_sums_exact test_align_parts check_layers check_timing check_boards'
rest=
set -- $scripts "$@"
for item in "$@"; do [ "$item" = tests/check_stack.sh ] || rest="$rest $item"; done
set --
for word in $long ''; do
    later=
    for item in $rest; do case $item in *$word*) set -- "$@" "$item" ;; *) later="$later $item" ;; esac; done
    rest=$later
done
passed=0; failed=0; skipped=0
for item in "$@"; do
    shift
    for word in ${SMR_SKIP:-}; do
        case $item in *"$word"*) skipped=$((skipped + 1)); echo "skip  ${item#"$BUILD"/}: SMR_SKIP has $word"; continue 2 ;; esac
    done
    set -- "$@" "$item"
done
total=$#
workers=
trap 'kill $workers 2>/dev/null; exit 1' HUP INT TERM # they end with what they are at
for k in $(seq "$jobs"); do
    work "$@" 9>"$log_dir/lock" &
    workers="$workers $!"
done
wait
[ "$terminal" = 1 ] && printf '\r\033[K'
reason='s/^\[  SKIPPED \] //; s/^skip[a-z]*: *//'
for item in "$@"; do
    log=$(log_of "$item")
    [ -z "$tables" ] || grep -vE '^\[( RUN| *OK |=|-| *PASSED)' "$log" # and of CMocka's own lines those that tell what failed
    if read -r p f s <"$log.sum"; then
        passed=$((passed + p)); failed=$((failed + f)); skipped=$((skipped + s))
        [ "$s" -eq 0 ] || echo "skip  ${item#"$BUILD"/}, $s: $(grep -i 'skip' "$log" | head -n 1 | sed "$reason")"
    else
        failed=$((failed + 1)); echo "FAIL  $item: did not end"
    fi
done
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
