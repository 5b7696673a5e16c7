#!/bin/sh
# smr register --save and --resume: surfaces, several structures, an image, budgets, other numbers of threads; the same bits as
# in one run; other inputs, other options, damaged and forged saves.
# SPDX-License-Identifier: MIT
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
blob 8 30 20 60 0.05 >bone.ply
blob 9 33 19 63 0.08 >target.ply
blob 9 33 19 63 0.09 >other.ply
mkdir several others
blob 10 20 20 20 0.02 >several/a.ply
blob 10 22 19 21 0.03 >several/b.ply
blob 11 22 20 21 0.02 >others/a.ply

# in_three NAME ARGUMENTS...: one run, and the same in three on other numbers of threads.
in_three() {
    name=$1
    shift
    rm -rf whole part rest
    "$SMR" register "$@" -o whole --threads 2 >out.txt 2>&1
    status=$?
    check "$name: 7 ticks" has_status 4 "$SMR" register "$@" --ticks 7 --save 1.save -o part --threads 1
    check "$name: 5 more" has_status 4 "$SMR" register "$@" --ticks 5 --resume 1.save --save 2.save -o part --threads 4
    check "$name: to the end" has_status $status "$SMR" register "$@" --resume 2.save -o rest --threads 2
    check "$name: the same state" [ "$(value whole/report.json state_hash)" = "$(value rest/report.json state_hash)" ]
    check "$name: the same verdict" [ "$(value whole/report.json verdict)" = "$(value rest/report.json verdict)" ]
    for file in whole/*.ply; do
        check "$name: $(basename "$file")" cmp "$file" "rest/$(basename "$file")"
    done
}

short="--iterations 4 --iterations-last 8"
# shellcheck disable=SC2086
{
    in_three "surfaces" --model bone.ply --target target.ply --align rigid $short
    in_three "several structures" --model several/a.ply several/b.ply --target others/a.ply several/b.ply $short
    in_three "one target for two" --model several/a.ply several/b.ply --target others/a.ply --method polar $short
}
case ${SMR_EXPERIMENTS:-} in
full | all)
    thigh thigh
    in_three "an image" --model thigh/model/femur.ply thigh/model/patella.ply --reference thigh/mri_reference.mha \
        --target thigh/mri_patient.mha --landmarks thigh/landmarks_reference.mrk.json thigh/landmarks_patient.mrk.json \
        --iterations 3 --iterations-last 5
    ;;
*) skip "an image" "SMR_EXPERIMENTS=full, to compute the phantom" ;;
esac

# shellcheck disable=SC2086
set -- --model bone.ply --target target.ply --accept look $short
check "a budget that no iteration keeps: saved between iterations" \
    has_status 4 "$SMR" register "$@" --budget-ms 0.001 --ticks 5 --save b.save -o part
check "and resumed" has_status 0 "$SMR" register "$@" --resume b.save -o rest
check "the end itself can be saved" has_status 0 "$SMR" register "$@" --save end.save -o whole
check "and resumed" has_status 0 "$SMR" register "$@" --resume end.save -o rest
check "with the same result" cmp whole/bone.ply rest/bone.ply
cp whole/bone.ply before.ply
check "into the results' directory" has_status 4 "$SMR" register "$@" --ticks 3 --save new/run.save -o new
check "is there" [ -s new/run.save ]

refused "another target" 'b.save: options: ' "$SMR" register --model bone.ply --target bone.ply $short --resume b.save -o refused
"$SMR" register "$@" --ticks 3 --save 1.save -o part >out.txt 2>&1
refused "another target of as many vertices" '1.save: targets: ' "$SMR" register --model bone.ply --target other.ply $short --resume 1.save -o refused
refused "another model" '1.save: model: ' "$SMR" register --model other.ply --target target.ply $short --resume 1.save -o refused
refused "another option" '1.save: options: ' "$SMR" register "$@" --resume 1.save --stiffness 0.5 -o refused
refused "a log beside it" 'option' "$SMR" register "$@" --resume 1.save --log run.log -o refused
refused "a log of what is saved" 'option' "$SMR" register "$@" --save 3.save --log run.log -o refused
refused "not there" 'nowhere.save' "$SMR" register "$@" --resume nowhere.save -o refused
refused "not a save" 'bone.ply: header: ' "$SMR" register "$@" --resume bone.ply -o refused
head -c 3000 1.save >cut.save
refused "cut off" 'cut.save: content: ' "$SMR" register "$@" --resume cut.save -o refused
{ head -c 3000 1.save; printf x; tail -c +3002 1.save; } >changed.save
refused "one byte changed" 'changed.save: content: ' "$SMR" register "$@" --resume changed.save -o refused
refused "not over what is read" '1.save' "$SMR" register "$@" --resume 1.save --save 1.save -o refused
refused "nowhere to write" 'missing' "$SMR" register "$@" --save missing/1.save -o refused

finish
