#!/bin/sh
# check_requirements: each requirement of docs/safety has a test that is there and is run, and each tag names a requirement.
# SPDX-License-Identifier: MIT
# usage: check_requirements.sh            the table tests/requirements.txt and the sources
#        check_requirements.sh --ran      what the last `make check` said of each test, as $BUILD/TRACE.md (make trace)
set -u
export LC_ALL=C
. tests/checks.inc
table=tests/requirements.txt
sed -n 's/^| \(R-[A-Z]*-[0-9]*\) |.*/\1/p' docs/safety/REQUIREMENTS.md >"$tmp/all"
sort "$tmp/all" | uniq -d | sed 's/$/ stands twice/' >"$tmp/wrong"
grep -v '^#' "$table" | cut -d ' ' -f 1 | sort >"$tmp/traced"
uniq -d "$tmp/traced" | sed "s|\$| has two lines in $table|" >>"$tmp/wrong"
sort -u "$tmp/all" >"$tmp/known"
comm -23 "$tmp/known" "$tmp/traced" | sed 's/$/ has no test/' >>"$tmp/wrong"
grep -rnoE '\bR-[A-Z]{3}-[0-9]+\b' docs README.md include src port tests --include='*.[ch]' --include='*.md' --include='*.sh' \
    --include='*.txt' | awk -F: 'NR == FNR { known[$1] = 1; next } !($3 in known) { print $1 ":" $2 ": there is no " $3 }' \
    "$tmp/known" - >>"$tmp/wrong"

# Whether `make check` or .ci/run runs a test.
there() {
    case $1 in
    make:*) grep -q "^[a-z -]*\b${1#make:}\b[a-z -]*:" Makefile && grep -qE "make -s .*\b${1#make:}( |\$)" .ci/run ;;
    by_hand:*) grep -q "^${1#by_hand:}:" Makefile && grep -q "make ${1#by_hand:}\`" docs/safety/LIFECYCLE.md ;;
    ci:*) grep -q "^${1#ci:}() {" .ci/run && grep -q "run_step .*${1#ci:}\$" .ci/run ;;
    check_boards.sh:*) grep -q "[ ']${1#check_boards.sh:}[ ']" tests/run_checks.sh && { [ "${1##*:}" = golden ] || [ -f "tests/target/${1##*:}.c" ]; } ;;
    check_timing.sh) grep -q "boards=tests/target/$1" tests/run_checks.sh ;;
    *.sh) [ -f "tests/$1" ] || [ -f "tests/host/$1" ] || [ -f "tests/golden/$1" ] ;;
    *:*) cat tests/*/"${1%%:*}.c" 2>/dev/null | grep -q "^TEST(${1##*:})" ;;
    *) false ;;
    esac
}
# What its log says: ok, skipped, failed, or not run. Logs of other compilers' builds count, too.
said() {
    log=
    case $1 in
    make:* | ci:*) echo 'by .ci/run'; return ;;
    by_hand:*) echo 'before a release'; return ;;
    test_*:*) log=$(cat "$build"/log/tests_*_"${1%%:*}.log" "$build"/*/log/tests_*_"${1%%:*}.log" 2>/dev/null | grep "\] ${1##*:}\$") ;;
    *) log=$(cat "$build"/log/tests_*"$1"*.log.sum "$build"/*/log/tests_*"$1"*.log.sum 2>/dev/null |
        awk '{ print ($2 > 0 ? "FAILED" : $1 > 0 ? " OK " : "SKIPPED") }') ;;
    esac
    case $log in *FAILED*) echo FAILED ;; *' OK '*) echo ok ;; *SKIPPED*) echo skipped ;; *) echo 'not run' ;; esac
}
if [ "${1:-}" = --ran ]; then
    printf '# Requirements and their tests\n\n| id | requirement | test | result |\n|---|---|---|---|\n' >"$build/TRACE.md"
    grep -v '^#' "$table" | while read -r id tests; do
        words=$(sed -n "s/^| $id | \(.*\) | [^|]* |\$/\1/p" docs/safety/REQUIREMENTS.md)
        for name in $tests; do echo "| $id | $words | \`$name\` | $(said "$name") |"; done
    done >>"$build/TRACE.md"
    grep -E '\| (FAILED|not run) \|$' "$build/TRACE.md" | cut -d '|' -f 2,4- >>"$tmp/wrong"
    echo "written: $build/TRACE.md, $(grep -c '| ok |$' "$build/TRACE.md") ok, $(grep -c '| skipped |$' "$build/TRACE.md") skipped"
else
    grep -v '^#' "$table" | while read -r id tests; do
        for name in ${tests:-none}; do there "$name" || echo "$id: $name is not there, or is not run"; done
    done >>"$tmp/wrong"
fi
sed 's/^/#   /' "$tmp/wrong"
if [ -s "$tmp/wrong" ]; then not_ok "$(wc -l <"$tmp/wrong") faults in the trace of requirements"
else ok "$(wc -l <"$tmp/all") requirements, $(grep -v '^#' "$table" | cut -d ' ' -f 2- | wc -w) tests"; fi
finish
