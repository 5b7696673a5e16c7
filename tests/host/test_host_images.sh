#!/bin/sh
# Registration into an image: refusals and small properties on a computed volume, then the published thigh.
# SPDX-License-Identifier: MIT
# DATA: the directory that holds hip_thigh_vhm and thigh_patient; the parts that need it are skipped without.
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc

DATA=${DATA:-../shared/data}
[ -d "$DATA" ] && DATA=$(cd "$DATA" && pwd)
cd "$scratch" || exit 1
blob 12 30 20 60 0.05 >bone.ply
blob 12 33 19 63 0.08 >target.ply

# has_status STATUS COMMAND...
has_status() {
    wanted=$1
    shift
    "$@" >out.txt 2>err.txt
    got=$?
    [ $got -eq "$wanted" ] || { echo "status $got, not $wanted: $(head -1 err.txt)"; return 1; }
}
# refused NAME FILE COMMAND...: status 2, one line that starts with the file, no directory "out".
refused() {
    refused_name=$1
    refused_file=$2
    shift 2
    "$@" >out.txt 2>err.txt
    got=$?
    if [ $got -eq 2 ] && [ "$(wc -l <err.txt)" -eq 1 ] && [ ! -s out.txt ] && [ ! -e out ] && [ ! -e out.smr ] &&
        grep -qF "smr: $refused_file: " err.txt; then ok "$refused_name"; else
        not_ok "$refused_name"
        echo "#   status $got: $(head -2 err.txt)"
        rm -rf out out.smr
    fi
}
value() { sed -n "s/^ *\"$2\": \"\{0,1\}\([^,\"]*\)\"\{0,1\},\{0,1\}\$/\1/p" "$1" | head -1; }
# The mean below a key of the whole registration, which stands before the structures'.
mean() { sed -n "/\"$2\": {/,/}/s/^ *\"mean\": \([^,]*\),\{0,1\}\$/\1/p" "$1" | head -1; }
less() { awk -v a="$1" -v b="$2" 'BEGIN { exit !(a != "" && a < b) }'; }

# image NAME A B C: an ellipsoid of value 90 in 10, 4 mm voxels, as MetaImage.
image() {
    {
        printf 'ObjectType = Image\nNDims = 3\nDimSize = 32 32 48\nElementSpacing = 4 4 4\nOffset = -62 -62 -94\n'
        printf 'ElementType = MET_UCHAR\nElementDataFile = LOCAL\n'
        awk -v a="$2" -v b="$3" -v c="$4" 'BEGIN {
            for (k = 0; k < 48; k++) for (j = 0; j < 32; j++) for (i = 0; i < 32; i++) {
                x = (4 * i - 62) / a; y = (4 * j - 62) / b; z = (4 * k - 94) / c
                printf "%s", x * x + y * y + z * z < 1 ? "Z" : "\n"
            }
        }'
    } >"$1"
}
image ref.mha 30 20 60
image pat.mha 32 22 63
image4='--reference ref.mha --target pat.mha'
printf 'a,30,0,0\nb,-30,0,0\nc,0,20,0\nd,0,0,60\ne,0,-20,-5\n' >five.csv
printf 'a,32,1,0\nb,-32,0,0\nc,0,22,0\nd,0,0,63\ne,0,-22,-5\n' >five_to.csv
head -3 five.csv >three.csv
head -3 five_to.csv >three_to.csv
head -1 five.csv >one.csv
sed 's/^e/f/' five_to.csv >label.csv
head -c 2000 pat.mha >short.mha
sed 's/a,32/a,nan/' five_to.csv >nan.csv

reg="$SMR register --model bone.ply -o out"
refused "no reference" "--reference" $reg --target pat.mha
refused "reference that is not there" "none.mha" $reg --reference none.mha --target pat.mha
refused "target that is not there" "none.mha" $reg --reference ref.mha --target none.mha
refused "target cut short" "short.mha" $reg --reference ref.mha --target short.mha
refused "reference cut short" "short.mha" $reg --reference short.mha --target pat.mha
refused "a surface as the reference" "target.ply" $reg --reference target.ply --target pat.mha
refused "two volumes" "--target" $reg $image4 ref.mha
refused "a volume and a surface" "--target" $reg $image4 target.ply
refused "a reference for a surface" "--reference" $reg --reference ref.mha --target target.ply
refused "the truth for a surface" "--truth" $reg --target target.ply --truth .
for option in "--align rigid" "--attraction 0.5" "--slide 1" "--even 0" "--normal-angle 60" "--node-budget 100" "--reject-border" "--reject-deviations 3"; do
    refused "$option with a volume" "${option%% *}" $reg $image4 $option
done
refused "--search 61" "--search" $reg $image4 --search 61
refused "--search -1" "--search" $reg $image4 --search -1
refused "--search 0 for a surface" "--search" $reg --target target.ply --search 0
refused "landmarks of unequal count" "three_to.csv" $reg $image4 --landmarks five.csv three_to.csv
refused "landmarks of other labels" "label.csv" $reg $image4 --landmarks five.csv label.csv
refused "landmarks of NaN" "nan.csv" $reg $image4 --landmarks five.csv nan.csv
refused "landmarks that are not there" "none.csv" $reg $image4 --landmarks five.csv none.csv
refused "one file of landmarks" "--landmarks" $reg $image4 --landmarks five.csv
refused "three files of landmarks" "--landmarks" $reg $image4 --landmarks five.csv five_to.csv five.csv
refused "landmarks and --align" "--landmarks" $reg --target target.ply --align rigid --landmarks five.csv five_to.csv
refused "truth that is not there" "none" $reg $image4 --truth none
mkdir -p truth bad
cp target.ply truth/bone.ply
echo ply >bad/bone.ply
refused "damaged truth" "bad" $reg $image4 --truth bad
refused "a model without profiles" "plain.smr" sh -c "'$SMR' build --model bone.ply -o plain.smr --quiet && '$SMR' register --model plain.smr --target pat.mha -o out"
refused "build with a damaged reference" "short.mha" "$SMR" build --model bone.ply --reference short.mha -o out.smr
refused "build with a .smr and a reference" "--reference" "$SMR" build --model plain.smr --reference ref.mha -o out.smr

check "register into an image" has_status 0 $SMR register --model bone.ply -o plain $image4
check "without a truth distance_mm is null" [ "$(value plain/report.json distance_mm)" = null ]
check "matched_share" sh -c "awk -v a='$(value plain/report.json matched_share)' 'BEGIN { exit !(a > 0 && a <= 1) }'"
check "the volume's bytes" [ "$(value plain/report.json volume)" -eq 49152 ]
check "build with a reference" has_status 0 "$SMR" build --model bone.ply --reference ref.mha -o bone.smr
check "info tells the profiles" sh -c "'$SMR' info bone.smr | grep -q profiles"
check "the .smr as the model" has_status 0 "$SMR" register --model bone.smr --target pat.mha -o image
check "gives the same bytes" cmp plain/bone.ply image/bone.ply
refused "a .smr with a reference" "--reference" "$SMR" register --model bone.smr $image4 -o out
for threads in 1 3; do
    "$SMR" register --model bone.smr --target pat.mha -o threads --quiet --threads $threads
    check "$threads threads: the same state" [ "$(value threads/report.json state_hash)" = "$(value plain/report.json state_hash)" ]
done
check "--search 0" has_status 0 "$SMR" register --model bone.smr --target pat.mha -o zero --search 0
check "landmarks" has_status 0 $SMR register --model bone.ply -o spline $image4 --landmarks five.csv five_to.csv --truth truth
check "a spline is no news" sh -c "! grep -q 'fit instead' out.txt"
check "a summary of at most 8 lines" [ "$(wc -l <out.txt)" -le 8 ]
check "vertex to vertex" [ -n "$(mean spline/report.json vertex_to_vertex_mm)" ]
check "three landmarks" has_status 0 $SMR register --model bone.ply -o weak $image4 --landmarks three.csv three_to.csv
check "a weaker fit is named" grep -q 'similarity fit instead' out.txt
check "one landmark" has_status 0 $SMR register --model bone.ply -o weak --target target.ply --landmarks one.csv one.csv
check "is a translation" grep -q 'translation fit instead' out.txt
check "landmarks for a surface" has_status 0 $SMR register --model bone.ply -o surface --target target.ply --landmarks five.csv five_to.csv
check "both sides mirrored" has_status 0 $SMR register --model bone.ply -o mirror $image4 --mirror-model x --mirror-target x --landmarks five.csv five_to.csv --truth truth
check "measure the same as unmirrored" awk -v a="$(mean spline/report.json vertex_to_vertex_mm)" -v b="$(mean mirror/report.json vertex_to_vertex_mm)" 'BEGIN { d = a - b; exit !(d < 0.1 && d > -0.1) }'

thigh=$DATA/thigh_patient
if [ -d "$DATA/hip_thigh_vhm" ] && [ -f "$thigh/mri_patient.mha" ]; then
    check "thigh_patient: status 0" has_status 0 "$SMR" register --model "$DATA"/hip_thigh_vhm/*.ply \
        --reference "$thigh/mri_reference.mha" --target "$thigh/mri_patient.mha" --landmarks \
        "$thigh/landmarks_reference.mrk.json" "$thigh/landmarks_patient.mrk.json" --truth "$thigh/truth" -o thigh
    to=$(mean thigh/report.json model_to_target)
    from=$(mean thigh/report.json target_to_model)
    folds=$(value thigh/report.json folds)
    check "thigh_patient: model to truth $to mm, below 0.5" less "$to" 0.5
    check "thigh_patient: truth to model $from mm, below 0.5" less "$from" 0.5
    # Edges a right angle sharp at rest fold by this count in the truth itself; the result must not fold more.
    mkdir -p own && cp "$thigh"/truth/*.ply own
    true_folds=0
    for file in own/*.ply; do
        one=$("$SMR" measure "$file" "$file" --source "$DATA/hip_thigh_vhm/${file##*/}" | sed -n 's/^folds: *\([0-9]*\).*/\1/p')
        true_folds=$((true_folds + one))
    done
    check "thigh_patient: $folds folds, the truth has $true_folds" [ "$folds" -le "$true_folds" ]
    check "thigh_patient: vertex to vertex $(mean thigh/report.json vertex_to_vertex_mm) mm" [ -s thigh/femur.ply ]
else
    skip "thigh_patient" "the data are not there (DATA=$DATA)"
fi
finish
