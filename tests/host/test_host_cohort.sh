#!/bin/sh
# Cohorts: --json, --skip-done and what makes it compute again, smr summary, and four computed patients that are killed
# and go on (SMR_AGAIN=1: these ran with another compiler).
# SPDX-License-Identifier: MIT
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
examples=$top/docs/examples/cohort
blob 10 30 20 60 0.05 >bone.ply
blob 11 33 19 63 0.08 >target.ply
blob 11 33 19 63 0.09 >other.ply

# ---------------------------------------------------------------- one line of JSON

"$SMR" register --model bone.ply --target target.ply -o out --json >line.json 2>err.txt
check "--json: good" [ $? -eq 0 ]
check "one line" [ "$(wc -l <line.json)" -eq 1 ]
check "nothing on standard error" [ ! -s err.txt ]
same_fact() { # KEY: as in report.json, where it stands on a line of its own
    grep -qF "\"$1\": $(sed -n "s/^  \"$1\": \(.*\)/\1/p" out/report.json | sed 's/,$//')" line.json
}
for key in version verdict expected_error_mm exit_status iterations folds hausdorff_mm state_hash reasons; do
    check "$key is the report's" same_fact $key
done
check "the directory, and that it was computed" grep -q '"output": "out", "exit_status": 0, "skipped": false}$' line.json
if command -v python3 >/dev/null 2>&1; then
    check "it is JSON, and its distances are the report's" python3 -c 'import json
a, b = json.load(open("line.json")), json.load(open("out/report.json"))
assert a["distance_mm"] == b["distance_mm"] and a["seconds"] == b["time_s"]["total"]'
else
    skip "it is JSON" "no python3"
fi
odd=$(printf 'odd\355\240\200\340\200\257\364\220\200\200\303\244') # half a pair, too long, too large, a letter
"$SMR" register --model bone.ply --target target.ply -o "$odd" --json >line.json 2>err.txt
check "bytes that are no text are none there" grep -qF "\"output\": \"odd??????????$(printf '\303\244')\"" line.json
# Every write() to such a socket is a message; the name takes more than stdio would hold back.
if command -v python3 >/dev/null 2>&1; then
    check "a line longer than a buffer is written at once" python3 -c 'import os, socket, subprocess, sys
here, there = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
name = "long/" + "/".join(["\1" * 240] * 4)
os.makedirs(name)
command = [sys.argv[1], "register", "--model", "bone.ply", "--target", "target.ply", "-o", name, "--json"]
status = subprocess.run(command, stdout=there).returncode
line = here.recv(1 << 20)
assert status == 0 and len(line) > 5000 and line.endswith(b"}\n"), (status, len(line))' "$SMR"
else
    skip "a line longer than a buffer" "no python3"
fi
if [ -c /dev/full ]; then
    "$SMR" register --model bone.ply --target target.ply -o out --json >/dev/full 2>err.txt
    check "a line that finds no room" sh -c "[ $? -eq 2 ] && [ \$(wc -l <err.txt) -eq 1 ] && grep -q 'standard output' err.txt"
else
    skip "a line that finds no room" "no /dev/full"
fi
"$SMR" register --model bone.ply --target target.ply -o ended --json --ticks 2 >line.json 2>err.txt
check "exit status 4" sh -c "[ $? -eq 4 ] && grep -q '\"exit_status\": 4' line.json && grep -q '\"exit_status\": 4' ended/report.json"
"$SMR" register --model none.ply --target target.ply -o none --json >line.json 2>err.txt
check "what is refused says nothing there" sh -c "[ $? -eq 2 ] && [ ! -s line.json ] && [ \$(wc -l <err.txt) -eq 1 ]"

# ---------------------------------------------------------------- what is done

onto="--model bone.ply --target target.ply"
listing() { ls -li --full-time "$1" 2>/dev/null || ls -li "$1"; }
# again NAME WHAT [STATUS] OPTION...: runs with --skip-done; WHAT: skips or computes.
again() {
    again_name=$1 again_what=$2 again_status=$3
    shift 3
    listing "$dir" >before
    "$SMR" register "$@" --skip-done -o "$dir" >out.txt 2>err.txt
    again_got=$?
    listing "$dir" >after
    again_found=computes
    cmp -s before after && again_found=skips
    if [ $again_got -eq "$again_status" ] && [ $again_found = "$again_what" ]; then ok "$again_name"; else
        not_ok "$again_name: status $again_got, $again_found $(cat err.txt)"
    fi
}
dir=out
"$SMR" register $onto -o out --quiet --log out/run.log
again "another command" computes 0 $onto
check "is what it says" grep -q "^smr: out: computed again: another command" err.txt
again "done" skips 0 $onto
check "one line says so" [ "$(cat out.txt)" = "out: done before, verdict good: nothing is computed" ]
again "done, whatever the number of threads" skips 0 $onto --threads 2 --quiet
check "--quiet says nothing" [ ! -s out.txt ]
again "done, as a line of JSON" skips 0 --json $onto
check "of one line that says so" sh -c '[ $(wc -l <out.txt) -eq 1 ] && grep -q "\"skipped\": true}$" out.txt'
again "another setting" computes 0 $onto --accept look
again "one setting fewer" computes 0 $onto
cp other.ply target.ply
again "another input" computes 0 $onto
check "is named" grep -q "^smr: out: computed again: the input is another: target.ply" err.txt
again "which is done then" skips 0 $onto
printf x >>out/bone.ply
again "a result that was changed" computes 0 $onto
check "is named, too" grep -q "the result is not as it was written: bone.ply" err.txt
rm out/carry.bin
again "a result that is gone" computes 0 $onto
rm out/report.json
again "no report: cut off" computes 0 $onto
check "needs no word" [ ! -s err.txt ]
head -c 3000 out/report.json >cut && mv cut out/report.json
again "half a report" computes 0 $onto
sed 's/"version": "/"version": "9/' out/report.json >old && mv old out/report.json
again "a report of another version" computes 0 $onto
sed '/^  "results": \[/,/^  \],/d' out/report.json >old && mv old out/report.json
again "a report that names no results" computes 0 $onto
sed 's/"file": "bone.ply"/"file": "..\/bone.ply"/' out/report.json >odd && mv odd out/report.json
again "one that names files elsewhere" computes 0 $onto
rm -rf out
"$SMR" register $onto --ticks 2 --quiet --log run.log -o ended
dir=ended
again "the same exit status" skips 4 $onto --ticks 2 --log run.log
printf x >>run.log
again "a log elsewhere is a result as well" computes 4 $onto --ticks 2 --log run.log

# ---------------------------------------------------------------- the table and the page

summary() { "$SMR" summary "$@" -o table.csv --html page.html >out.txt 2>err.txt; }
mkdir -p many
for n in 1 2 10; do "$SMR" register $onto --quiet -o many/p$n --iterations 3; done
awk '$1 ~ /^-?[0-9.]+$/ && NF == 3 { $1 += 900 } { print }' target.ply >far.ply
"$SMR" register --model bone.ply --target far.ply --quiet -o many/p3
summary many/*
check "a table of all" [ $? -eq 0 ]
check "in natural order" [ "$(sed 1d table.csv | cut -d , -f 1 | tr '\n' ' ')" = "many/p1 many/p2 many/p3 many/p10 " ]
check "with verdicts" [ "$(sed 1d table.csv | cut -d , -f 2 | sort | uniq -c | tr -s ' \n' ' ')" = " 1 failed 3 good " ] ||
    sed 's/^/#   /' table.csv
cp table.csv first.csv
summary many/p10/ many/p3 many/p2// many/p1
check "the same whatever the order and slashes" cmp table.csv first.csv
rm -rf many/p2 && "$SMR" register $onto --quiet -o many/p2 --iterations 3 --threads 1
summary many/*
check "and after another run" cmp table.csv first.csv
summary many/* --times
check "times are a column of their own" [ "$(head -n 1 table.csv)" = "$(head -n 1 first.csv | sed 's/reasons/seconds,reasons/')" ]
check "all are on the page" [ "$(grep -o '"verdict":"[a-z]*","path":"[^"]*"' page.html | cut -d '"' -f 8 | tr '\n' ' ')" = "many/p1 many/p2 many/p3 many/p10 " ]
check "with four surfaces for their pictures" [ "$(grep -o '"surfaces":\[{"level":"[a-z]*","vertices":[1-9]' page.html | wc -l)" -eq 4 ]
check "its links lead there" sh -c 'n=0; for to in $(grep -o "\"link\":\"[^\"]*" page.html | cut -d \" -f 4); do [ -s "$to" ] || exit 1; n=$((n+1)); done; [ $n -eq 4 ]'
check "nothing from elsewhere" [ -z "$(grep -oE '(src|href)="?[a-z]+:|url\(|fetch\(|XMLHttp|@import|<link' page.html)" ]
touch many/p1/report.html && mkdir pages
"$SMR" summary many/* --html pages/page.html --quiet
check "a page elsewhere leads to reports that are there" grep -q '"link":"../many/p1/report.html"' pages/page.html
mkdir many/p4 'many/a "b", c' many/old many/cut many/pipe
sed 's/"version": "/"version": "9/' many/p1/report.json >many/old/report.json
head -c 2000 many/p1/report.json >many/cut/report.json
mkfifo many/pipe/report.json
sed 's/"reasons": \[/"reasons": ["x\\u0001,\\n\\"<b>", /' many/p3/report.json >'many/a "b", c/report.json'
summary many/*
check "what lacks a report: exit status 1" [ $? -eq 1 ]
check "one line says how many" grep -q '^9 results: 3 good, 0 look, 2 failed, 3 unreadable, 1 missing$' out.txt
check "is missing" grep -q '^many/p4,missing,,,,,,,,,,"no report.json"$' table.csv
check "of another version" grep -q '^many/old,unreadable,.*version [0-9.]*: register again"$' table.csv
check "cut off" grep -q '^many/cut,unreadable,' table.csv
check "no file" grep -q '^many/pipe,unreadable,' table.csv
check "fields are quoted" grep -q '^"many/a ""b"", c",failed,.*,"x , ""<b>; ' table.csv
check "and what is no HTML is none" sh -c '! grep -q "<b>" page.html && grep -qF "x , \\\"\\u003cb>" page.html'
cp many/p1/report.json kept
"$SMR" summary many/p1 -o many/p1/report.json >out.txt 2>err.txt
check "a report is not replaced by the table" sh -c "[ $? -eq 2 ] && cmp kept many/p1/report.json"
"$SMR" summary -o table.csv >out.txt 2>err.txt
check "no directory" [ $? -eq 2 ]
"$SMR" summary many/p1 >out.txt 2>err.txt
check "no file for it" [ $? -eq 2 ]
printf 'ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int i\nend_header\n0 0 0\n0 0 0\n0 0 0\n3 0 1 2\n' >many/p1/bone.ply
check "surfaces without extent are drawn" "$SMR" summary many/p1 --html page.html
printf junk >many/p1/bone.ply
check "damaged ones are left out" "$SMR" summary many/p1 --html page.html
check "and said to be" grep -q '"surfaces":\[\]' page.html

# ---------------------------------------------------------------- four patients, killed and resumed

if [ "${SMR_AGAIN:-0}" = 1 ]; then
    skip "four patients, killed and resumed" "another compiler's run has it, SMR_AGAIN=1"
    finish
    exit
fi
mkdir cohort && cd cohort || exit 1
export SMR
export SMR_OPTIONS='--iterations 3 --iterations-last 3' # no better, but sooner
engine=run_xargs.sh
if command -v parallel >/dev/null 2>&1 && parallel --version 2>/dev/null | grep -q GNU; then engine=run_parallel.sh; fi
sh "$examples/cases.sh" 4
JOBS=2 sh "$examples/run_xargs.sh" >out.txt 2>err.txt
check "four patients by xargs" sh -c "[ $? -eq 0 ] && [ \$(grep -c . table.csv) -eq 5 ]"
cp table.csv ../whole.csv
rm -rf results runs runs.jsonl table.csv

if ! command -v ps >/dev/null 2>&1 || ! command -v setsid >/dev/null 2>&1; then
    skip "four patients, killed and resumed" "no ps or no setsid"
    finish
    exit
fi
# Killed without warning as soon as one is done: the program itself, whatever starts it, keeps nothing half.
setsid sh -c 'JOBS=2 exec sh "$0"' "$examples/$engine" >out.txt 2>err.txt &
leader=$!
for tick in $(seq 200); do
    cat runs/*.jsonl 2>/dev/null | grep -q . && break
    sleep 0.05
done
for try in $(seq 200); do # jobs may have process groups of their own, be started meanwhile, and outlive the first
    pids=$(ps -o pid=,stat= -s $leader | awk '$2 !~ /^Z/ { print $1 }')
    [ -n "$pids" ] || break
    # shellcheck disable=SC2086
    kill -KILL $pids 2>/dev/null
    sleep 0.02
done
wait $leader 2>/dev/null
early=$(cat runs/*.jsonl | grep -c .)
check "killed in the middle" test "$early" -ge 1 -a "$early" -lt 4
sh "$examples/table.sh" >out.txt 2>err.txt
check "the table says what is missing" sh -c "[ $? -eq 1 ] && [ \$(grep -c ',missing,' table.csv) -ge 1 ]"
JOBS=2 sh "$examples/$engine" >out.txt 2>err.txt
check "and resumed by $engine" [ $? -eq 0 ]
check "the same table" cmp table.csv ../whole.csv
check "nothing lost" [ "$(grep -o '"output": "[^"]*"' runs.jsonl | sort -u | wc -l)" -eq 4 ]
check "nothing done twice" sh -c '[ -z "$(grep "skipped\": false" runs.jsonl | grep -o "output\": \"[^\"]*" | sort | uniq -d)" ]'
finish
