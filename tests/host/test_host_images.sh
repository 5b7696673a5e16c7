#!/bin/sh
# Registration into an image: refusals and small properties on a computed volume, then the published thigh.
# SPDX-License-Identifier: MIT
# SMR_AGAIN=1: another compiler did the thigh.
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
blob 12 30 20 60 0.05 >bone.ply
blob 12 33 19 63 0.08 >target.ply

# The mean below a key of the whole registration, which stands before the structures'.
mean() { sed -n "/\"$2\": {/,/}/s/^ *\"mean\": \([^,]*\),\{0,1\}\$/\1/p" "$1" | head -1; }

image ref.mha 30 20 60 hard
image pat.mha 32 22 63 hard
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
by_file "no reference" "--reference" $reg --target pat.mha
by_file "reference that is not there" "none.mha" $reg --reference none.mha --target pat.mha
by_file "target that is not there" "none.mha" $reg --reference ref.mha --target none.mha
by_file "target cut short" "short.mha" $reg --reference ref.mha --target short.mha
by_file "reference cut short" "short.mha" $reg --reference short.mha --target pat.mha
by_file "a surface as the reference" "target.ply" $reg --reference target.ply --target pat.mha
by_file "two volumes" "--target" $reg $image4 ref.mha
by_file "a volume and a surface" "--target" $reg $image4 target.ply
by_file "a reference for a surface" "--reference" $reg --reference ref.mha --target target.ply
by_file "the truth for a surface" "--truth" $reg --target target.ply --truth .
for option in "--align rigid" "--attraction 0.5" "--slide 1" "--even 0" "--normal-angle 60" "--node-budget 100" "--reject-border" "--reject-deviations 3"; do
    by_file "$option with a volume" "${option%% *}" $reg $image4 $option
done
by_file "--search 61" "--search" $reg $image4 --search 61
by_file "--search -1" "--search" $reg $image4 --search -1
by_file "--search 0 for a surface" "--search" $reg --target target.ply --search 0
by_file "landmarks of unequal count" "three_to.csv" $reg $image4 --landmarks five.csv three_to.csv
by_file "landmarks of other labels" "label.csv" $reg $image4 --landmarks five.csv label.csv
by_file "landmarks of NaN" "nan.csv" $reg $image4 --landmarks five.csv nan.csv
by_file "landmarks that are not there" "none.csv" $reg $image4 --landmarks five.csv none.csv
by_file "one file of landmarks" "--landmarks" $reg $image4 --landmarks five.csv
by_file "three files of landmarks" "--landmarks" $reg $image4 --landmarks five.csv five_to.csv five.csv
by_file "--smoothing without landmarks" "--smoothing" $reg $image4 --smoothing 5
by_file "--smoothing of a fit that is no spline" "--smoothing" $reg $image4 --landmarks five.csv five_to.csv --align rigid --smoothing 5
by_file "--smoothing -1" "--smoothing" $reg $image4 --landmarks five.csv five_to.csv --smoothing -1
for option in "--gradient 3" "--similarity ssd" "--confidence 0.2" "--sideways 0.2" "--search 9,1" "--profile-samples 20" "--profile-step 1"; do
    by_file "$option for a surface" "${option%% *}" $reg --target target.ply $option
done
for option in "--gradient 61" "--gradient 3,-1" "--gradient 3," "--gradient 1,2,3" "--search 9,61" "--similarity sad" "--confidence 1.1" "--sideways 1.1" \
    "--profile-samples 2" "--profile-samples 65" "--profile-step 0" "--profile-step nan" "--profile-inward 1.5"; do
    by_file "$option" "${option%% *}" $reg $image4 $option
done
for option in "--active 1.1" "--active -0.1" "--active nan" "--active-first 2" "--active-first x" "--active-enough -1" "--active-enough 1.5"; do
    by_file "$option" "${option%% *}" $reg $image4 $option
done
by_file "--active for a build" "--active" "$SMR" build --model bone.ply --active 0.5 -o out.smr
by_file "--profile-step without a reference" "--profile-step" "$SMR" build --model bone.ply --profile-step 1 -o out.smr
by_file "truth that is not there" "none" $reg $image4 --truth none
mkdir -p truth bad
cp target.ply truth/bone.ply
echo ply >bad/bone.ply
by_file "damaged truth" "bad" $reg $image4 --truth bad
"$SMR" build --model bone.ply -o plain.smr --quiet
by_file "a model without profiles" "plain.smr" "$SMR" register --model plain.smr --target pat.mha -o out
by_file "build with a damaged reference" "short.mha" "$SMR" build --model bone.ply --reference short.mha -o out.smr
by_file "build with a .smr and a reference" "--reference" "$SMR" build --model plain.smr --reference ref.mha -o out.smr

check "register into an image" has_status 0 $SMR register --model bone.ply -o plain $image4
check "without a truth distance_mm is null" [ "$(value plain/report.json distance_mm)" = null ]
check "matched_share" sh -c "awk -v a='$(value plain/report.json matched_share)' 'BEGIN { exit !(a > 0 && a <= 1) }'"
check "the volume's bytes" [ "$(value plain/report.json volume)" -eq 49152 ]
check "build with a reference" has_status 0 "$SMR" build --model bone.ply --reference ref.mha -o bone.smr
check "info tells the profiles" sh -c "'$SMR' info bone.smr | grep -q profiles"
check "the .smr as the model" has_status 0 "$SMR" register --model bone.smr --target pat.mha -o image
check "gives the same bytes" cmp plain/bone.ply image/bone.ply
by_file "a .smr with a reference" "--reference" "$SMR" register --model bone.smr $image4 -o out
# differs NAME OPTION...: the options are taken, and change the result.
differs() {
    differs_name=$1
    shift
    check "$differs_name" has_status 0 "$SMR" register --model bone.smr --target pat.mha -o changed --quiet "$@"
    check "$differs_name: another result" sh -c "[ -f changed/bone.ply ] && ! cmp -s image/bone.ply changed/bone.ply"
    rm -rf changed
}
differs "few vertices take part" --active 0.5 --active-enough 0
differs "goals on the normals" --sideways 0
differs "few vertices at the start" --active-first 0.3 --active-enough 0
check "the defaults of both shares" has_status 0 "$SMR" register --model bone.smr --target pat.mha -o shares --active 1 --active-first 1 --active-enough 30
check "change nothing" cmp image/bone.ply shares/bone.ply
"$tool" convert bone.ply obj bone.obj
awk '$1 == "v" && n++ % 3 == 0 { print "v", 0.7 * $2, 0.7 * $3, 0.7 * $4 }' bone.obj >marks.obj
{
    printf 'ply\nformat ascii 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\nend_header\n' "$(wc -l <marks.obj)"
    cut -d ' ' -f 2- marks.obj
} >truth/marks.ply
check "points in an image" has_status 0 $SMR register --model bone.ply marks.obj -o marks $image4 --truth truth
check "are carried" grep -q '^carried along without a target: marks' out.txt
check "and compared point by point" sh -c "sed -n '/\"name\": \"marks\"/,\$p' marks/report.json | grep -A1 vertex_to_vertex_mm | grep -q '\"mean\": [0-9]'"
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
check "with its pose and what it leaves; a spline has none" sh -c "grep -q '\"start_pose\": \[' weak/report.json &&
    grep -q '\"start_rms_mm\": [0-9]' weak/report.json && grep -q '\"start_rms_mm\": null' spline/report.json"
check "one landmark" has_status 0 $SMR register --model bone.ply -o weak --target target.ply --landmarks one.csv one.csv
check "is a translation" grep -q 'translation fit instead' out.txt
check "--align rigid with landmarks" has_status 0 $SMR register --model bone.ply -o rigid $image4 --landmarks five.csv five_to.csv --align rigid
check "is what the report says" [ "$(value rigid/report.json start_kind)$(value rigid/report.json fit)" = "landmarks rigidrigid" ]
check "and no weaker fit" sh -c "! grep -q 'fit instead' out.txt"
check "--align similarity with landmarks" has_status 0 $SMR register --model bone.ply -o same $image4 --landmarks five.csv five.csv --align similarity
check "of themselves: nothing moved at the start" less "$(value same/report.json start_rms_mm)" 0.001
check "--align rigid with landmarks of a surface" has_status 0 $SMR register --model bone.ply -o same --target target.ply --landmarks five.csv five_to.csv --align rigid
# A spline that is smoothed without end is an affine map; one that is not passes through the landmarks.
LC_ALL=C sed 's/^Offset = -62 /Offset = 938 /' pat.mha >far.mha
check "an image that the model never meets ends with status 1" has_status 1 $SMR register --model bone.ply -o far --reference ref.mha --target far.mha
check "and says so" grep -q '^verdict: failed: nothing of the target was seen: ' out.txt
check "in the report, too" [ "$(value far/report.json converged) $(value far/report.json target_seen)" = "false false" ]
rm -rf far
check "--confidence 1 accepts no goal" has_status 1 $SMR register --model bone.ply -o far $image4 --confidence 1
check "and says so, too" grep -q '^verdict: failed: nothing of the target was seen: ' out.txt
check "no residual was measured" [ "$(value far/report.json residual_mean_mm) $(value far/report.json matched_share)" = "null 0" ]
rm -rf far
# An image of noise: what the model was moved by is chance, so the start is what is written.
LC_ALL=C awk '/^ElementDataFile/ { print; exit } { print }' pat.mha >noise.mha
awk 'BEGIN { s = 1; for (i = 0; i < 32 * 32 * 48; i++) { s = (s * 69069 + 5) % 4294967296; printf "%c", 33 + int(s / 16777216) % 90 } }' >>noise.mha
check "an image of noise ends with status 1" has_status 1 "$SMR" register --model bone.ply -o noise --reference ref.mha --target noise.mha \
    --vertex-errors --html
check "and says what is written" grep -q '^verdict: failed: .*; the start is written instead of what was found' out.txt
check "and has few goals" less "$(value noise/report.json matched_share)" 0.3
check "they are where they began" sh -c "[ '$(value noise/report.json start_kept)' = true ] && '$SMR' measure noise/bone.ply bone.ply | grep -q '^Hausdorff: 0.0000 mm'"
"$SMR" carry --result noise --points bone.ply -o carried.ply --quiet
header=$(LC_ALL=C sed '/^end_header$/q' noise/bone.ply | wc -c)
tail -c +$((header + 1)) noise/bone.ply | head -c "$((29 * $(value noise/report.json vertices)))" | od -An -v -tu1 -w29 >vertices.txt
check "nothing is said of their vertices" awk '$13 != 0 || $14 != 0 || $15 != 0 || $16 != 128 || $17 != 191 { bad = 1 } END { exit bad || NR < 200 }' vertices.txt
check "nor in the page" [ -z "$(grep -o '"expected":{"unit":[^,]*,"at":"[^"]*' noise/report.html | sed 's/.*"at":"//' | tr -d '/8w=\n')" ]
check "points are carried to what is written" sh -c "'$SMR' measure carried.ply noise/bone.ply | grep -q '^Hausdorff: 0.0000 mm'"
check "no error is expected of them" [ "$(value noise/report.json expected_error_mm)" = null ]
check "a result that was found is no start" [ "$(value spline/report.json start_kept)" = false ]

check "a search that ends before the schedule" has_status 0 $SMR register --model bone.ply -o ends $image4 --search 8,0 --gradient 4,0 --quiet
check "has the share of its last search" less 0.5 "$(value ends/report.json matched_share)"
check "for each structure" less 0.5 "$(sed '1,/per_structure/d' ends/report.json | value /dev/stdin matched_share)"
check "and no residual of an iteration that did not look" [ "$(value ends/report.json residual_mean_mm)" = null ]
check "--smoothing" has_status 4 $SMR register --model bone.ply -o smooth $image4 --landmarks five.csv five_to.csv --smoothing 1e6 --ticks 1
check "is another start" sh -c "'$SMR' register --model bone.ply -o sharp $image4 --landmarks five.csv five_to.csv --ticks 1 --quiet; ! cmp -s smooth/bone.ply sharp/bone.ply"
check "--smoothing 100 is the default with an image" sh -c "'$SMR' register --model bone.ply -o smooth $image4 --landmarks five.csv five_to.csv --smoothing 100 --ticks 1 --quiet; cmp -s smooth/bone.ply sharp/bone.ply"
# Twelve landmarks that move by a shear, each 8 mm off, or as a whole: the start follows as much as they foretell.
for kind in spline rigid similarity; do
    for to in 0 1; do
        awk -v kind=$kind -v to=$to 'BEGIN { for (i = 0; i < 12; i++) {
            x = 12 * sin(2.4 * i); y = 12 * cos(2.4 * i); z = 5 * i - 28; s = kind == "similarity" ? 1.2 : 1
            if (kind == "spline") x += to * z / 2
            if (kind == "rigid") { x += to * 8 * sin(7.1 * i * i); y += to * 8 * cos(5.3 * i * i) }
            printf "p%d,%g,%g,%g\n", i, to ? s * x + 1 : x, to ? s * y : y, to ? s * z : z } }' >$kind$to.csv
    done
    $SMR register --model bone.ply -o kind $image4 --landmarks ${kind}0.csv ${kind}1.csv --ticks 1 --quiet
    check "landmarks carry a start: $kind" [ "$(value kind/report.json start_kind)" = "landmarks $kind" ]
    $SMR register --model bone.ply -o kind $image4 --landmarks ${kind}0.csv ${kind}1.csv --ticks 1 --quiet --smoothing 100
    check "with --smoothing it is a spline" [ "$(value kind/report.json start_kind)" = "landmarks spline" ]
done
surface="--target target.ply --landmarks five.csv five_to.csv --ticks 1 --quiet"
check "--smoothing 0 with a surface" sh -c "'$SMR' register --model bone.ply -o smooth $surface --smoothing 0; '$SMR' register --model bone.ply -o sharp $surface; cmp -s smooth/bone.ply sharp/bone.ply"
for key in start_kind similarity method residual_mean_mm residual_max_mm moved_mean_mm moved_max_mm matched_share folds; do
    check "the report has $key" [ -n "$(value plain/report.json $key)" ]
done
check "of structures too" [ "$(sed '1,/per_structure/d' plain/report.json | grep -cE '"(residual_mean_mm|residual_max_mm|moved_mean_mm|moved_max_mm|matched_share|folds)"')" -eq 6 ]
for option in "--search 14.5,1.25" "--gradient 3.25,0.25" "--similarity ssd" "--profile-samples 21" \
    "--profile-step 0.9" "--profile-inward 0.3"; do
    check "$option" has_status 0 $SMR register --model bone.ply -o plain2 $image4 $option
    check "$option is heard" [ "$(value plain2/report.json state_hash)" != "$(value plain/report.json state_hash)" ]
done
check "landmarks for a surface" has_status 0 $SMR register --model bone.ply -o surface --target target.ply --landmarks five.csv five_to.csv
five="--landmarks five.csv five_to.csv --truth truth --ticks 5" # later on, rounding leads smooth bodies apart
check "neither side mirrored" has_status 4 $SMR register --model bone.ply -o straight $image4 $five
check "both sides mirrored" has_status 4 $SMR register --model bone.ply -o mirror $image4 --mirror-model x --mirror-target x $five
check "measure the same as unmirrored" awk -v a="$(mean straight/report.json vertex_to_vertex_mm)" -v b="$(mean mirror/report.json vertex_to_vertex_mm)" 'BEGIN { d = a - b; exit !(a > 1 && d < 0.001 && d > -0.001) }'

# Mirroring a volume in patient space: with oblique axes only the header changes, and mirrored back every bit is the
# same; voxels stored the other way round give the same field. Landmarks of a mirrored side go along.
oblique() { # FILE SIGN: axes turned by 30 degrees about z, off the middle
    { printf 'ObjectType = Image\nNDims = 3\nDimSize = 32 32 48\nElementSpacing = 4 4 4\n'
      printf 'TransformMatrix = %s0.8660254 0.5 0 %s-0.5 0.8660254 0 0 0 1\n' "$2" "$2" | sed 's/--//g; s/ -0 / 0 /g'
      printf 'Offset = %s-20 -85 -94\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n' "$2" | sed 's/--//'
      tail -c 49152 pat.mha; } >"$1"
}
oblique oblique.mha ''
oblique oblique_x.mha -
negate() { awk -F, -v OFS=, '{ $2 = -$2 } { print }' "$1"; }
negate five_to.csv >five_to_x.csv
negate five.csv >five_x.csv
hash() { value "$1/report.json" state_hash; }
check "oblique volume" has_status 0 $SMR register --model bone.ply -o oblique --reference ref.mha --target oblique.mha --landmarks five.csv five_to.csv
check "its mirror image, mirrored" has_status 0 $SMR register --model bone.ply -o oblique_x --reference ref.mha --target oblique_x.mha --landmarks five.csv five_to_x.csv --mirror-target x
check "is the same to the bit" [ "$(hash oblique)" = "$(hash oblique_x)" ]
check "the mirror image alone" has_status 0 $SMR register --model bone.ply -o oblique_x --reference ref.mha --target oblique_x.mha --landmarks five.csv five_to.csv
check "is another" [ "$(hash oblique)" != "$(hash oblique_x)" ]
"$tool" convert bone.ply obj bone.obj
awk '$1 == "v" { $2 = substr($2, 1, 1) == "-" ? substr($2, 2) : "-" $2 } $1 == "f" { t = $3; $3 = $4; $4 = t } { print }' bone.obj >m.obj
mkdir plain_m mirror_m && cp bone.obj plain_m/bone.obj && cp m.obj mirror_m/bone.obj
oblique ref_x.mha -
check "an oblique reference" has_status 0 $SMR register --model plain_m/bone.obj -o oblique --reference oblique.mha --target pat.mha --landmarks five.csv five_to.csv
check "model, reference and landmarks mirrored" has_status 0 $SMR register --model mirror_m/bone.obj -o oblique_x --reference ref_x.mha --target pat.mha --landmarks five_x.csv five_to.csv --mirror-model x
check "are the same to the bit" [ "$(hash oblique)" = "$(hash oblique_x)" ]
# the same field, stored from the other end along x
{ head -n 7 pat.mha | sed 's/^Offset = -62/Offset = -56/'; tail -c 49152 pat.mha; } >off.mha
{ head -n 7 pat.mha | sed 's/^Offset = -62/Offset = -68/'
  tail -c 49152 pat.mha | tr '\nZ' '01' | fold -w 32 | rev | tr -d '\n' | tr '01' '\nZ'; } >off_x.mha
check "voxels off the middle" has_status 4 $SMR register --model bone.ply -o off --reference ref.mha --target off.mha --ticks 1
check "stored the other way round" has_status 4 $SMR register --model bone.ply -o off_x --reference ref.mha --target off_x.mha --mirror-target x --ticks 1
apart=$("$SMR" measure off/bone.ply off_x/bone.ply | sed -n 's/^Hausdorff: \([0-9.]*\).*/\1/p')
check "are the same field: a step differs by $apart mm" less "$apart" 0.001
apart=$("$SMR" measure off/bone.ply bone.ply | sed -n 's/^Hausdorff: \([0-9.]*\).*/\1/p')
check "and it moved: $apart mm" less 0.01 "$apart"

# A .smr and its surfaces start from the same bits, far from the origin too.
awk '$1 == "v" { $2 += 300.3; $4 -= 77.7 } { print }' bone.obj >away.obj
awk -F, -v OFS=, '{ $2 += 300.3; $4 -= 77.7 } { print }' five.csv >five_away.csv
check "build of a model far away" has_status 0 "$SMR" build --model away.obj -o away.smr
check "landmarks with it" has_status 0 "$SMR" register --model away.smr --target target.ply --landmarks five_away.csv five_to.csv -o away_smr
check "landmarks with its surface" has_status 0 "$SMR" register --model away.obj --target target.ply --landmarks five_away.csv five_to.csv -o away
check "the same state" [ "$(hash away_smr)" = "$(hash away)" ]

thigh=$data/thigh_patient
if [ "${SMR_AGAIN:-0}" = 1 ]; then
    skip "thigh_patient" "another compiler's run has it, SMR_AGAIN=1"
elif [ -d "$data/hip_thigh_vhm" ] && [ -f "$thigh/mri_patient.mha" ]; then
    check "thigh_patient: status 0" has_status 0 "$SMR" register --model "$data"/hip_thigh_vhm/*.ply \
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
        one=$("$SMR" measure "$file" "$file" --source "$data/hip_thigh_vhm/${file##*/}" | sed -n 's/^folds: *\([0-9]*\).*/\1/p')
        true_folds=$((true_folds + one))
    done
    check "thigh_patient: $folds folds, the truth has $true_folds" [ "$folds" -le "$true_folds" ]
    check "thigh_patient: vertex to vertex $(mean thigh/report.json vertex_to_vertex_mm) mm" [ -s thigh/femur.ply ]
else
    skip "thigh_patient" "the data are not there (SMR_TEST_DATA=$data)"
fi
finish
