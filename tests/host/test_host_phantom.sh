#!/bin/sh
# smr phantom: all files or none, the same bytes for any number of threads, read back by our own readers, fit for
# a registration; bad options.
# SPDX-License-Identifier: MIT
# SMR_AGAIN=1: another compiler's run has the whole resolution, two threads and another seed; here it is the small one.
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
mean() { sed -n "/\"$2\": {/,/}/s/^ *\"mean\": \([^,]*\),\{0,1\}\$/\1/p" "$1" | head -1; }

# The whole resolution once, the small one in all variations.
mkdir one
check "made small" thigh one/small
if [ "${SMR_AGAIN:-0}" = 1 ]; then
    whole=one/small size='[0-9]{2} [0-9]{2} [0-9]{3}' spacing='3.000 3.000 6.000' most=3.6
    skip "made" "another compiler's run has it, SMR_AGAIN=1"
else
    whole=whole size='2[0-9]{2} 2[0-9]{2} 2[0-9]{2}' spacing='1.000 1.000 3.000' most=1.8
    check "made" "$SMR" phantom -o whole
    check "another seed" "$SMR" phantom -o by --small --seed 2
    check "the same model" diff -r one/small/model by/model
    check "the same reference" cmp one/small/mri_reference.mha by/mri_reference.mha
    check "another patient" sh -c "! cmp -s one/small/mri_patient.mha by/mri_patient.mha && ! cmp -s one/small/truth/femur.ply by/truth/femur.ply"
    check "by two threads, over another one" "$SMR" phantom -o by --small --threads 2
    check "the same bytes" diff -r one/small by
fi
check "--quiet is quiet" [ -z "$("$SMR" phantom -o one_thread --small --quiet --threads 1 --seed 1)" ]
check "one thread, seed 1, the default: the same bytes" diff -r one/small one_thread

check "52 files" [ "$(find $whole -type f | wc -l)" -eq 52 ]
n=0
for file in $whole/model/*.ply; do
    name=${file##*/}
    n=$((n + 1))
    # vertices, triangles
    a=$("$tool" count "$file" 2>&1 | cut -d ' ' -f 1,2)
    b=$("$tool" count "$whole/truth/$name" 2>&1 | cut -d ' ' -f 1,2)
    [ -n "$a" ] && [ "$a" = "$b" ] || { not_ok "$name: model $a, truth $b"; continue; }
    [ $whole = whole ] || continue # coarse surfaces have sharp edges
    for set in model truth; do
        "$SMR" measure $whole/$set/"$name" $whole/$set/"$name" >measure.txt 2>&1
        grep -q '^folds: 0 ' measure.txt || not_ok "$set/$name: $(grep folds measure.txt)"
    done
done
check "24 structures, those of the whole without folds" [ $n -eq 24 ]
for name in femur hip_bone patella gluteus_maximus rectus_femoris vastus_medialis; do
    check "there is $name" [ -f $whole/model/$name.ply ]
done
for image in reference patient; do
    check "mri_$image.mha: $("$volume" info $whole/mri_$image.mha | cut -c 1-60)" sh -c \
        "'$volume' info $whole/mri_$image.mha | grep -qE '^uint8 $size o .* s $spacing d 1.000 0.000 0.000 0.000 1.000'"
done

# near LANDMARKS SET MM: every landmark lies by a vertex of the structure that its description names.
near() {
    sed -n 's/.*"description": "\([^"]*\)", "position": \[\(.*\), \(.*\), \(.*\)\].*/\1 \2 \3 \4/p' "$1" >marks.txt
    [ "$(wc -l <marks.txt)" -eq 15 ] || return 1
    while read -r part x y z; do
        "$tool" convert "$2/$part.ply" obj part.obj || return 1
        awk -v x="$x" -v y="$y" -v z="$z" -v most="$3" -v part="$part" '
            $1 == "v" { d = ($2 - x) ^ 2 + ($3 - y) ^ 2 + ($4 - z) ^ 2; if (!n++ || d < best) best = d }
            END { if (sqrt(best) > most) print part " " x " " y " " z ": " sqrt(best) " mm beside"
                  exit !(n && sqrt(best) <= most) }' part.obj || return 1
    done <marks.txt
}
check "landmarks of the reference are vertices" near $whole/landmarks_reference.mrk.json $whole/model 0.01
check "landmarks of the patient are near vertices" near $whole/landmarks_patient.mrk.json $whole/truth $most
check "the landmarks are pairs" sh -c \
    "[ \$('$volume' pair $whole/landmarks_reference.mrk.json $whole/landmarks_patient.mrk.json | wc -l) -ge 15 ]"

small=one/small
check "a registration with it" "$SMR" register --model $small/model/*.ply --reference $small/mri_reference.mha \
    --target $small/mri_patient.mha --landmarks $small/landmarks_reference.mrk.json \
    $small/landmarks_patient.mrk.json --truth $small/truth -o result --quiet
to=$(mean result/report.json model_to_target)
check "model to truth $to mm in the mean, below a voxel" awk -v a="$to" 'BEGIN { exit !(a != "" && a < 3) }'
check "no folds" [ "$(value result/report.json folds)" = 0 ]

touch file
mkdir -p full/model/femur.ply
for option in "--seed 0" "--seed -1" "--seed 1.5" "--seed x" "--seed 2000000000" "--seed" "--threads 0" "--radius 30" \
    "--model femur.ply" "--bad"; do
    # shellcheck disable=SC2086
    by_file "$option" "${option%% *}" "$SMR" phantom -o new $option
done
by_file "no -o" usage "$SMR" phantom
by_file "an operand" femur.ply "$SMR" phantom femur.ply -o new
by_file "-o a file" file "$SMR" phantom -o file --small
by_file "-o in a file" file/new "$SMR" phantom -o file/new --small
by_file "a directory where a file belongs" full "$SMR" phantom -o full --small
by_file "no room for the images" new/deep sh -c "ulimit -f 100; '$SMR' phantom -o new/deep --small"
finish
