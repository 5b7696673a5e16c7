#!/bin/sh
# prove: readers, indexes and sums of the core for hostile bytes, by frama-c; what that cannot show, by all values.
# SPDX-License-Identifier: MIT
# usage: prove.sh [MAIN...]      mains of tests/prove, all unless named; logs in BUILD/prove
# explained.txt has the alarms of Eva that are none: source, words of the line, why. Other alarms fail, and so does a row without one.
set -u
export LC_ALL=C
. tests/checks.inc
logs=$build/prove
mkdir -p "$logs" || exit 1
parse='-c11 -machdep gcc_x86_64 -warn-special-float none
    -cpp-extra-args=-Iinclude -cpp-extra-args=-Isrc -cpp-extra-args=-Itests/prove'

# Parts of a main, each analysed by itself.
parts_of() { [ "$1" = model ] && seq 0 27 || echo 0; }

# States that Eva keeps apart, and functions that it reads as if they stood in their callers.
options_of() {
    case $1 in
    tree) echo '-eva-slevel 100 -eva-slevel-function set_from:0 -inline-calls smr_triangle_at' ;;
    lists) echo '-eva-slevel 3000' ;;
    *) echo '-eva-slevel 5000 -eva-split-return full' ;;
    esac
}

eva() {
    : >"$logs/$1.log"
    for part in $(parts_of "$1"); do
        # shellcheck disable=SC2046,SC2086
        frama-c $parse -cpp-extra-args=-DPROVE_PART="$part" -eva -eva-ilevel 64 -eva-no-show-progress \
            -eva-msg-key=-initial-state,-final-states $(options_of "$1") "tests/prove/prove_$1.c" >"$logs/part.log" 2>&1
        cat "$logs/part.log" >>"$logs/$1.log"
        grep -q 'ANALYSIS SUMMARY' "$logs/part.log" || { tail -n 5 "$logs/part.log"; return 1; }
    done
    grep 'Neither code nor' "$logs/$1.log" | grep -v __builtin_sqrtf && return 1
    sed -n 's/^\[eva:alarm\] \([^:]*\):\([0-9]*\): Warning:.*/\1 \2/p' "$logs/$1.log" | sort -u >"$tmp/alarms"
    while read -r file line; do
        awk -F '|' -v file="$file" -v text="$(sed -n "${line}p" "$file")" '
            !/^#/ && substr(file, length(file) - length($1) + 1) == $1 && index(text, $2) { print FNR; found = 1 }
            END { exit !found }' tests/prove/explained.txt >>"$tmp/used" || { echo "$file:$line: not explained"; return 1; }
    done <"$tmp/alarms"
}

# Functions without a loop, for all numbers.
contracts() {
    # shellcheck disable=SC2086
    frama-c $parse -wp -wp-rte -wp-fct smr_le32,smr_index,smr_ceil_div,section -wp-prover z3 -wp-timeout 20 \
        tests/prove/prove_contracts.c >"$logs/contracts.log" 2>&1
    awk '/Proved goals:/ { n = $4; all = $6 } END { print n, all; exit !(n > 0 && n == all) }' "$logs/contracts.log"
}

all_values() {
    $cc -std=c11 -O2 -ffp-contract=off -Iinclude -Isrc tests/prove/exhaustive.c -o "$logs/exhaustive" && "$logs/exhaustive"
}

each_row_is_used() {
    awk 'NR == FNR { used[$1] = 1; next } !/^#/ && !(FNR in used) { print "no alarm: " $0; bad = 1 } END { exit bad }' \
        "$tmp/used" tests/prove/explained.txt
}

: >"$tmp/used"
all=$([ $# -gt 0 ] || echo yes)
[ $# -gt 0 ] || set -- exhaustive contracts fixed tree log save model lists
for main; do
    if [ "$main" = exhaustive ]; then check 'all values of small numbers' all_values
    elif ! have frama-c; then skip "$main" 'needs frama-c (frama-c-base)'
    elif [ "$main" != contracts ]; then check "$main: no alarm but explained ones" eva "$main"
    elif have z3 && have why3 && { why3 config detect >"$tmp/why3" 2>&1 || :; }; then check 'contracts hold' contracts
    else skip 'contracts' 'needs why3 and z3'; fi
done
if [ -n "$all" ] && have frama-c; then check 'each explained alarm is there' each_row_is_used; fi
finish
