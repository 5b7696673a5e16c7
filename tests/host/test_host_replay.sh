#!/bin/sh
# smr register --log and smr replay: surfaces, .smr, images, landmarks, budgets, on other numbers of threads; changed and missing
# inputs; logs with one number changed; hostile logs.
# SPDX-License-Identifier: MIT
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
log_tool=$build/tests/host/log_tool
blob 12 30 20 60 0.05 >bone.ply
blob 14 33 19 63 0.08 >target.ply
mkdir several
blob 10 20 20 20 0.02 >several/a.ply
blob 10 22 19 21 0.03 >several/b.ply
mkdir others
blob 11 22 20 21 0.02 >others/a.ply

# recorded NAME ARGUMENTS...: registers with a log and repeats it on other numbers of threads.
recorded() {
    recorded_name=$1
    shift
    # what a clock leaves out may tell in the verdict: good or look
    check "$recorded_name: recorded" has_status 0 "$SMR" register "$@" -o results --log run.log --threads 2 --accept look
    hash=$(value results/report.json state_hash)
    ticks=$(value results/report.json ticks)
    for threads in 1 4; do
        rm -f out.txt
        check "$recorded_name: repeated by $threads threads" has_status 0 "$SMR" replay run.log --threads $threads
        check "$recorded_name: one line, all $ticks ticks, the same state" \
            sh -c "[ \$(wc -l <out.txt) -eq 1 ] && grep -q 'run.log: all $ticks ticks agree .*, $threads threads, state $hash\$' out.txt"
    done
    tail -n 1 out.txt | sed "s/^/# $recorded_name: /"
}

recorded "surfaces" --model bone.ply --target target.ply
recorded "a budget" --model bone.ply --target target.ply --budget-ms 0.3 --method polar
recorded "a budget that no iteration keeps" --model bone.ply --target target.ply --budget-ms 0.001
check "with ticks within iterations" sh -c "! grep -q '(0 partial' out.txt"
recorded "an aligned start" --model bone.ply --target target.ply --align similarity --mirror-target x --budget-ms 1
"$SMR" build --model bone.ply -o bone.smr >/dev/null
recorded "a .smr" --model bone.smr --target target.ply --budget-ms 1
recorded "several structures" --model several/a.ply several/b.ply --target others/a.ply several/b.ply --budget-ms 1
gzip -c bone.ply >packed.ply.gz
recorded "a packed file" --model packed.ply.gz --target target.ply

thigh thigh
set -- --reference thigh/mri_reference.mha --target thigh/mri_patient.mha --truth thigh/truth --iterations 8 --iterations-last 12
landmarks="--landmarks thigh/landmarks_reference.mrk.json thigh/landmarks_patient.mrk.json"
# shellcheck disable=SC2086
recorded "an image and a spline" --model thigh/model/femur.ply thigh/model/patella.ply $landmarks "$@" --budget-ms 2
# shellcheck disable=SC2086
recorded "an image and a fitted pose" --model thigh/model/femur.ply thigh/model/patella.ply $landmarks --align rigid "$@"
mv thigh/truth thigh/elsewhere
check "the truth is not needed" has_status 0 "$SMR" replay run.log
mv thigh/elsewhere thigh/truth
if [ "${SMR_AGAIN:-0}" = 1 ]; then skip "an image, all structures" "another compiler's run has it, SMR_AGAIN=1"
else recorded "an image, all structures" --model thigh/model/*.ply "$@" $landmarks --budget-ms 5; fi

# What is in the way: nothing else is touched by recording, and a log that cannot be written stops a run before it starts.
"$SMR" register --model bone.ply --target target.ply -o plain --quiet --ticks 30 >/dev/null
"$SMR" register --model bone.ply --target target.ply -o logged --quiet --ticks 30 --log short.log >/dev/null
check "recording changes no result" cmp plain/bone.ply logged/bone.ply
check "a run that did not converge repeats, too" has_status 0 "$SMR" replay short.log
check "all of its ticks" grep -q "all 30 ticks agree" out.txt
check "a log into the directory of the results" has_status 0 "$SMR" register --model bone.ply --target target.ply -o new/dir --log new/dir/run.log --quiet
check "which was made" has_status 0 "$SMR" replay new/dir/run.log
check "a log in a directory that is not there" has_status 2 "$SMR" register --model bone.ply --target target.ply -o never --log none/run.log
check "is refused before anything is done" [ ! -e never ]
check "a log over an input" has_status 2 "$SMR" register --model bone.ply --target target.ply -o never --log bone.ply
check "is refused, with the results" [ ! -e never ]
refused_early() { # NAME LOG: before the model is prepared, so with one that is not even there
    "$SMR" register --model absent.ply --target target.ply -o never --log "$2" >out.txt 2>err.txt
    check "$1 is refused before anything is done" sh -c "grep -q '^smr: $2: output: expected a ' err.txt && [ ! -e never ]"
}
refused_early "a log over a result" never/bone.ply
refused_early "a log over the report" never/report.json
refused_early "a log with a directory's name" none/
refused_early "a log in place of the results" never
mkdir here
"$SMR" register --model absent.ply --target target.ply -o here --log here/../here/bone.ply 2>err.txt
check "a log over a result, under another name" grep -q ': output: expected a name that no result has' err.txt

# Inputs that changed: the line names the file.
"$SMR" register --model several/a.ply several/b.ply --target others/a.ply several/b.ply -o results --quiet --log run.log --budget-ms 1
limit_ms=2000
lost() { by_place "$1" "$2" "$3" "$SMR" replay "${4:-run.log}"; } # NAME FILE PLACE: what smr replay run.log must say
cp others/a.ply kept.ply
printf 7 | dd of=others/a.ply bs=1 seek=300 conv=notrunc 2>dd.txt
lost "one byte of a target" others/a.ply file
echo >>kept.ply
mv kept.ply others/a.ply
lost "a longer target" others/a.ply file
head -c -1 others/a.ply >kept.ply
cp kept.ply others/a.ply
check "as it was" has_status 0 "$SMR" replay run.log
mv several/b.ply b.ply
lost "a model that is gone" several/b.ply file
mkdir several/b.ply
lost "a directory in its place" several/b.ply file
rmdir several/b.ply
mkfifo several/b.ply
lost "a pipe in its place" several/b.ply file
rm several/b.ply
mv b.ply several/b.ply

# One number changed, with right checksums: the tick is named.
"$SMR" register --model bone.ply --target target.ply -o results --quiet --log run.log --ticks 40 >/dev/null
for tick in 1 17 40; do
    "$log_tool" taken run.log changed.log $tick -64
    check "n_taken of tick $tick" has_status 1 "$SMR" replay changed.log
    check "is found at that tick" sh -c "[ \$(wc -l <out.txt) -eq 1 ] && grep -q '^changed.log: tick $tick of 40 differs: ' out.txt"
done
"$log_tool" taken run.log changed.log 17 0
check "sealed without a change it agrees" has_status 0 "$SMR" replay changed.log
"$log_tool" cut run.log changed.log 17
check "an honest log that stops early agrees" has_status 0 "$SMR" replay changed.log
check "with as many ticks" grep -q "all 17 ticks agree" out.txt

# Hostile logs.
lost "no such log" none.log file none.log
lost "a directory" several file several
: >empty.log
lost "an empty file" empty.log file empty.log
lost "another file" bone.ply "line 1" bone.ply
size=$(wc -c <run.log)
for cut in 1 9 12 30 40 100 $((size / 2)) $((size - 2)) $((size - 1)); do
    head -c "$cut" run.log >cut.log
    lost "cut after $cut bytes" cut.log "line 1|byte|content" cut.log
done
for at in 3 15 36 60 200 $((size / 2)) $((size - 3)); do
    cp run.log turned.log
    printf '\377' | dd of=turned.log bs=1 seek="$at" conv=notrunc 2>dd.txt
    lost "byte $at turned" turned.log "line 1|byte" turned.log
done
forge() { # NAME SED PLACE: an edit of the text with a right checksum
    LC_ALL=C sed "$2" run.log >edited.log
    "$log_tool" seal edited.log forged.log
    lost "$1" "${4:-forged.log}" "$3" forged.log
}
forge "a length of 2^63" 's/^argument 8$/argument 9223372036854775808/' byte
forge "a length of 2^64 + 8" 's/^argument 8$/argument 18446744073709551624/' byte
forge "a negative length" 's/^argument 8$/argument -8/' byte
forge "a length with more behind it" 's/^argument 8$/argument 8 8/' byte
forge "a log as long as all memory" 's/^log [0-9]*$/log 18446744073709551615/' byte
forge "a log that is shorter" 's/^log [0-9]*$/log 300/' byte
forge "a checksum that is none" 's/^\(input [0-9]* [0-9]*\) .*/\1 nothing/' byte
forge "a piece of another kind" 's/^input /inputs /' byte
forge "the library's log is noise" 's/SMRL/SMRX/' log
forge "an input that is a device" 's/^target.ply$/\/\/dev\/zero/' file //dev/zero
LC_ALL=C sed '/^argument 7$/,$d' run.log >edited.log
"$log_tool" seal edited.log forged.log
lost "no library's log" forged.log byte forged.log
{ head -n 1 run.log; yes 'argument 1
x' | head -n 200000; } >edited.log
"$log_tool" seal edited.log forged.log
lost "a hundred thousand arguments" forged.log byte forged.log
LC_ALL=C sed 's/^--target$/--targit/' run.log >edited.log
"$log_tool" seal edited.log forged.log
lost "an option that is none" --targit option forged.log
LC_ALL=C sed 's/^target.ply$/absent.ply/' run.log >edited.log
"$log_tool" seal edited.log forged.log
lost "a file that is not there" absent.ply file forged.log
check "no log at all" has_status 2 "$SMR" replay
check "two logs" has_status 2 "$SMR" replay run.log run.log
check "an option of register" has_status 2 "$SMR" replay run.log --ticks 3
finish
[ "$failed" -eq 0 ]
