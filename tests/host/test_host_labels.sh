#!/bin/sh
# smr surfaces, labels and measure of label maps: there and back in all formats, names, layers, overlaps, refusals; VTK
# fills the same voxels where it is installed.
# SPDX-License-Identifier: MIT
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
# header TYPE "MORE LINES": of an oblique, uneven map of 30 x 26 x 20 voxels as text.
header() {
    printf 'NRRD0005\ntype: %s\ndimension: 3\nspace: left-posterior-superior\nsizes: 30 26 20\n' "$1"
    printf 'space directions: (0.96,0.28,0) (-0.28,0.96,0) (0,0.3,1.4)\nkinds: domain domain domain\nencoding: ascii\n'
    printf 'space origin: (-20,5,100)\n%s\n' "$2"
}
# Two structures that touch, and a third of a few voxels at the border. values A B C
draw() {
    awk -v a="$1" -v b="$2" -v c="$3" 'BEGIN {
        for (z = 0; z < 20; z++) for (y = 0; y < 26; y++) { for (x = 0; x < 30; x++) {
            v = 0
            if (((x - 14) / 11)^2 + ((y - 13) / 9)^2 + ((z - 10) / 6)^2 < 1) v = x + y > 28 ? b : a
            if (x > 26 && y > 22 && z > 16) v = c
            printf "%s ", v } print "" } }'
}
segments='Segment0_ID:=one
Segment0_Name:=Left part/x
Segment0_Color:=1 0.5 0
Segment0_LabelValue:=3
Segment0_Layer:=0
Segment1_ID:=two
Segment1_Name:=right
Segment1_Color:=0 0 1
Segment1_LabelValue:=7
Segment1_Layer:=0
'
{ header uchar "$segments"; draw 3 7 200; } >map.seg.nrrd
dice() { "$SMR" measure "$@" | sed -n 's/.* structures in both: Dice \([0-9.]*\).*/\1/p'; }
# same A B: the structures of both are the same to the voxel.
same() {
    "$SMR" measure "$@" >same.txt 2>&1 || { head -1 same.txt; return 1; }
    grep -q "^3 structures in both: Dice 1.0000" same.txt || { cat same.txt; return 1; }
}

check "surfaces of a segmentation" has_status 0 "$SMR" surfaces map.seg.nrrd -o parts --threads 1
cp out.txt whole.txt
check "each structure by its name" [ "$(ls parts | tr '\n' ' ')" = "Left_part_x.ply label_200.ply labels.ctbl right.ply " ]
check "its colours" sh -c "grep -q '^3 Left_part_x 255 128 0 255' parts/labels.ctbl && grep -q '^7 right 0 0 255 255' parts/labels.ctbl &&
    head -c 400 parts/right.ply | grep -aq 'property uchar blue'"
check "no folds, the volume of the voxels" awk '/^label/ { n++; if ($NF != 0 || $6 < 1 || ($6 - $9)^2 > (($5 > 100 ? 0.01 : 0.02) * $6)^2) bad = 1; }
    END { exit bad || n != 3 }' out.txt
"$SMR" surfaces map.seg.nrrd -o again --threads 3 --quiet >quiet.txt
check "threads change no byte, quiet says nothing" sh -c "cmp parts/right.ply again/right.ply && cmp parts/Left_part_x.ply again/Left_part_x.ply && [ ! -s quiet.txt ]"

# A budget of triangles: closed surfaces, for smr labels takes no others, of the same volume, near the whole ones.
check "at most 300 triangles each" has_status 0 "$SMR" surfaces map.seg.nrrd -o thin --triangles 300 --threads 1
check "have few, the same volume, no folds" awk -v most=300 'NR == FNR { if (/^label/) volume[$3] = $9; next }
    /^label/ { n++; if ($12 > most || $NF != 0 || $9 < 1 || ($9 - volume[$3])^2 > (0.002 * $9)^2) bad = 1; if ($12 == most) met++ }
    END { exit bad || n != 3 || met < 2 }' whole.txt out.txt
"$SMR" surfaces map.seg.nrrd -o thin3 --triangles 300 --threads 3 --quiet
check "threads change no byte of them" sh -c "cmp thin/right.ply thin3/right.ply && cmp thin/Left_part_x.ply thin3/Left_part_x.ply"
check "they are closed" has_status 0 "$SMR" labels thin --like map.seg.nrrd -o thin.mha
check "and near" awk -v d="$(dice map.seg.nrrd thin.mha --names thin/labels.ctbl)" 'BEGIN { exit !(d > 0.95) }'
refused "a budget that no surface has" "map.seg.nrrd: Left_part_x: expected a budget of at least" "$SMR" surfaces map.seg.nrrd -o none --triangles 4
check "leaves nothing" [ ! -e none ]
refused "fewer than four" "--triangles" "$SMR" surfaces map.seg.nrrd -o none --triangles 3

for format in seg.nrrd nrrd mha nii nii.gz; do
    check "labels as .$format" has_status 0 "$SMR" labels parts --like map.seg.nrrd -o "back.$format"
    check "every voxel is back from .$format" same map.seg.nrrd "back.$format"
done
check "threads change no label" sh -c "'$SMR' labels parts --like map.seg.nrrd -o three.mha --threads 3 --quiet && cmp three.mha back.mha"
check "packed, it is small" sh -c "[ \$(wc -c <back.nii.gz) -lt 2000 ] && gzip -t back.nii.gz"
check "the segments' keys are there" sh -c "grep -aq '^Segment1_LabelValue:=200' back.seg.nrrd && grep -aq '^Segment1_Extent:=27 29 23 25 17 19' back.seg.nrrd"
check "a directory of surfaces against the map" sh -c "'$SMR' measure map.seg.nrrd parts | grep -q '^3 structures in both: Dice 1.0000'"
{ header uchar "$segments"; draw 3 0 7; } >other.seg.nrrd
"$SMR" measure map.seg.nrrd other.seg.nrrd >measured.txt
check "what differs is seen" awk '/^Left_part_x / { a = $3 == 1 } /^right / { b = $3 < 0.1 } /^label_200 .*only in A/ { c = 1 }
    END { exit !(a && b && c) }' measured.txt
# The 7 has no name in one map; in the other one it is what the first map has as 3.
{ header uchar 'Segment0_ID:=one
Segment0_Name:=right
Segment0_LabelValue:=3
'; draw 3 7 0; } >plain.seg.nrrd
"$SMR" measure plain.seg.nrrd other.seg.nrrd >measured.txt
check "a structure of B counts once" sh -c "[ \$(grep -c '^right ' measured.txt) -eq 1 ] && grep -q '^label_7 .*only in A' measured.txt"
"$SMR" measure other.seg.nrrd plain.seg.nrrd >measured.txt
check "and one of A" sh -c "[ \$(grep -c '^right ' measured.txt) -eq 1 ] && grep -q '^label_7 .*only in B' measured.txt"
"$SMR" labels parts --like map.seg.nrrd -o packed.nii.GZ --quiet
check "a packed name in capitals is packed" sh -c "gzip -t <packed.nii.GZ && cmp packed.nii.GZ back.nii.gz"
for option in "--names names.txt" "--passes 3"; do
    # shellcheck disable=SC2086
    refused "two surfaces have no ${option% *}" "${option% *}: option: expected a label map" "$SMR" measure parts/right.ply again/right.ply $option
done

# A finer grid: what comes back is near, not the same.
sed 's/^sizes: .*/sizes: 60 26 20/; s/(0.96,0.28,0)/(0.48,0.14,0)/' map.seg.nrrd | sed '/^Segment/d' >fine.nrrd
awk '{ if ($0 == "") { print; body = 1; next } if (!body) { print; next }
    for (i = 1; i <= NF; i++) printf "%s %s ", $i, $i; print "" }' fine.nrrd >finer.nrrd
check "another grid" has_status 0 "$SMR" labels parts --like finer.nrrd -o fine.mha --names parts/labels.ctbl
check "it is near the coarse voxels" awk -v d="$(dice finer.nrrd fine.mha)" 'BEGIN { exit !(d > 0.9 && d < 0.999) }'
check "maps with other voxels are measured on those of A" awk -v d="$(dice map.seg.nrrd fine.mha --names parts/labels.ctbl)" 'BEGIN { exit !(d == 1) }'

printf '# names\n3 upper  left 9 8 7\n\n200 odd\n' >names.txt
check "names from a file" sh -c "'$SMR' surfaces map.seg.nrrd -o named --names names.txt --quiet && [ -s named/upper_left.ply ] && [ -s named/odd.ply ] &&
    [ -s named/right.ply ] && grep -q '^3 upper_left 9 8 7 255' named/labels.ctbl"
{
    printf '################\n# ITK-SnAP Label Description File\n################\n'
    printf '    0     0    0    0        0  0  0    "Clear Label"\n'
    printf '    3   255    0   16        1  1  1    "Left femur (upper half, as it was drawn on the day before) 2"\r\n'
    printf '    7     0  128  255      0.5  1  0    "7"\n'
} >snap.txt
check "names of ITK-SNAP" sh -c "'$SMR' surfaces map.seg.nrrd -o snap --names snap.txt --quiet && [ -s snap/7.ply ] &&
    grep -q '^3 Left_femur__upper_half__as_it_was_drawn_on_the_day_before__2 255 0 16 255' snap/labels.ctbl && grep -q '^7 7 0 128 255 255' snap/labels.ctbl"
check "and back by the table beside them" sh -c "'$SMR' labels snap --like map.seg.nrrd -o snap.mha --quiet && cmp snap.mha back.mha"
for line in '3 255 0 0 1 1 1 femur' '3 255 0 0 1 1 1' '3 255 0 0 1 1 1 "femur' '3 256 0 0 1 1 1 "femur"' '3 255 0 0 1 1 1 "'; do
    echo "$line" >bad_snap.txt
    refused "not $line" "bad_snap.txt: line 1" "$SMR" surfaces map.seg.nrrd -o no --names bad_snap.txt
done
{ header float ""; draw 1 2 4; } >float.nrrd
check "floats that are whole numbers" has_status 0 "$SMR" surfaces float.nrrd -o whole --quiet
check "are labels" [ "$(ls whole | tr '\n' ' ')" = "label_1.ply label_2.ply label_4.ply labels.ctbl " ]
mkdir used
cp parts/right.ply used/label_9.ply
cp parts/right.ply used/zoo.stl
refused "surfaces of another run" "used: surfaces: expected a directory without other surfaces, found label_9.ply" "$SMR" surfaces float.nrrd -o used
check "nothing is written beside them" [ "$(ls used | tr '\n' ' ')" = "label_9.ply zoo.stl " ]
rm used/*
echo 'x,y,z' >used/points.csv
check "other files do not matter" has_status 0 "$SMR" surfaces float.nrrd -o used
check "nor the same run" has_status 0 "$SMR" surfaces float.nrrd -o used
check "more passes change the surface" sh -c "'$SMR' surfaces float.nrrd -o rough --passes 0 --quiet && ! cmp -s rough/label_1.ply whole/label_1.ply"

# Layers: structures that overlap, each in its own; a layer is read where it says, or nowhere.
layered() {
    printf 'NRRD0005\ntype: uchar\ndimension: 4\nspace: left-posterior-superior\nsizes: 2 12 12 12\n'
    printf 'space directions: none (1,0,0) (0,1,0) (0,0,1)\nkinds: %s domain domain domain\nencoding: ascii\nspace origin: (0,0,0)\n' "$1"
    printf 'Segment0_ID:=a\nSegment0_Name:=ball\nSegment0_LabelValue:=1\nSegment0_Layer:=0\n'
    printf 'Segment1_ID:=b\nSegment1_Name:=inner\nSegment1_LabelValue:=1\nSegment1_Layer:=%s\n\n' "$2"
    awk 'BEGIN { for (z = 0; z < 12; z++) for (y = 0; y < 12; y++) for (x = 0; x < 12; x++) {
        d = (x - 5.5)^2 + (y - 5.5)^2 + (z - 5.5)^2; print (d < 25), (d < 9) } }'
}
layered list 1 >layers.seg.nrrd
check "two layers" has_status 0 "$SMR" surfaces layers.seg.nrrd -o two
check "both have their voxels" awk '/ ball / { a = $5 } / inner / { b = $5 } END { exit !(a == 552 && b == 136) }' out.txt
check "of two as deep as they can be the deeper one wins" has_status 0 "$SMR" labels two --like layers.seg.nrrd -o flat.mha
check "info of layers" has_status 0 "$SMR" info layers.seg.nrrd
check "says each segment" sh -c "grep -q '^label map layers.seg.nrrd  voxels 12 x 12 x 12  layers 2  labels 2\$' out.txt && grep -q '^spacing 1 1 1 mm' out.txt &&
    grep -qE '^label     1  layer 0  ball  +voxels       552 +0.552 ml\$' out.txt && grep -qE '^label     1  layer 1  inner +voxels       136 +0.136 ml\$' out.txt"
cp layers.seg.nrrd layers4.nrrd
refused "layers by another name are no image" "dimension: 3" "$SMR" info layers4.nrrd
check "info of one layer" has_status 0 "$SMR" info map.seg.nrrd
check "says names and volumes" sh -c "[ \$(grep -c '^label ' out.txt) -eq 4 ] && grep -qE '^label     7  right +voxels      1034 +1.448 ml\$' out.txt"
"$SMR" labels parts --like map.seg.nrrd -o plain.mha --quiet
check "info of a map without names" has_status 0 "$SMR" info plain.mha
check "says its labels" sh -c "grep -q '^volume plain.mha .*values 0 to 200\$' out.txt && grep -qE '^label     3  label_3 +voxels      1417 +1.984 ml\$' out.txt"
check "by names" sh -c "'$SMR' info plain.mha --names parts/labels.ctbl | grep -qE '^label     3  Left_part_x +voxels      1417 '"
awk '{ if ($0 == "") { print; body = 1; next } if (!body) { print; next } for (i = 1; i <= NF; i++) printf "%d ", (i * 7919 + NR * 104729) % 251; print "" }' map.seg.nrrd | sed '/^Segment/d' >image.nrrd
check "an image has none" sh -c "'$SMR' info image.nrrd >out.txt && grep -q '^volume image.nrrd' out.txt && ! grep -q '^label' out.txt"
{ header uchar "$segments"; draw 0 0 0; } >empty.seg.nrrd
check "an empty segmentation is a volume" sh -c "'$SMR' info empty.seg.nrrd | grep -q '^volume empty.seg.nrrd .*values 0 to 0\$'"
layered vector 1 >vector.seg.nrrd
refused "vectors are no layers" "kinds: list" "$SMR" surfaces vector.seg.nrrd -o no
layered list 2 >beyond.seg.nrrd
refused "a layer that is not there" "Segment1: expected a Layer of 0 to 1" "$SMR" surfaces beyond.seg.nrrd -o no
layered list 0 >twice.seg.nrrd
refused "two segments of one label" "Segment1: expected a label of its own" "$SMR" surfaces twice.seg.nrrd -o no
grep -v '^kinds' layers.seg.nrrd >kinds.seg.nrrd
refused "layers that do not say so" "kinds" "$SMR" surfaces kinds.seg.nrrd -o no

# hostile NAME TEXT TYPE A B C
hostile() {
    hostile_name=$1 hostile_text=$2
    { header "$3" ""; draw "$4" "$5" "$6"; } >hostile.nrrd
    refused "$hostile_name" "$hostile_text" "$SMR" surfaces hostile.nrrd -o no
}
# A table of all values is not cleared for each layer: that takes ten seconds here.
{
    printf 'NRRD0005\ntype: float\ndimension: 4\nspace: LPS\nsizes: 1000 1 1 1\nspace directions: none (1,0,0) (0,1,0) (0,0,1)\n'
    printf 'kinds: list domain domain domain\nencoding: ascii\nspace origin: (0,0,0)\n\n'
    awk 'BEGIN { for (i = 0; i < 1000; i++) print 16777215 }'
} >deep.nrrd
echo none >bad.ctbl
refused "a thousand layers of a large value" "bad.ctbl: line 1" timeout 6 "$SMR" surfaces deep.nrrd -o no --names bad.ctbl

hostile "halves are no labels" "voxel .* expected a label, a whole number from 0 to 16777215, found 0.5" float 1 0.5 2
hostile "negative labels" "found -3" short 1 -3 2
hostile "labels that floats do not tell apart" "found 1.67772e+07" int 1 16777216 2
hostile "not a number" "found -\?nan" float 1 nan 2
hostile "nothing but background" "a voxel that is not 0" uchar 0 0 0
{ printf 'NRRD0005\ntype: ushort\ndimension: 3\nsizes: 256 256 1\nspacings: 1 1 1\nencoding: ascii\n\n'
    awk 'BEGIN { for (i = 0; i < 65536; i++) print i }'; } >many.nrrd
refused "65536 labels" "at most 1024 of them" "$SMR" surfaces many.nrrd -o no
printf 'NRRD0005\ntype: uchar\ndimension: 3\nsizes: 100000 100000 100000\nspacings: 1 1 1\nencoding: raw\n\n' >huge.nrrd
refused "huge counts" "voxels" "$SMR" surfaces huge.nrrd -o no
printf '3 a\n7 a\n200 a\n' >double.txt
check "names that are alike get their labels" sh -c "'$SMR' surfaces map.seg.nrrd -o alike --names double.txt --quiet && ls alike | grep -q '^a_200.ply'"
printf '3 ../../up\n' >up.txt
check "no name leads out of the directory" sh -c "'$SMR' surfaces map.seg.nrrd -o caught --names up.txt --quiet && [ -s caught/_.__.._up.ply -o -s caught/_._.._up.ply ]"
printf 'three left\n' >bad.txt
refused "a name without a label" "bad.txt: line 1" "$SMR" surfaces map.seg.nrrd -o no --names bad.txt
refused "no such file of names" "none.txt" "$SMR" surfaces map.seg.nrrd -o no --names none.txt
refused "no directory" "-o" "$SMR" surfaces map.seg.nrrd
refused "two maps" "one label map" "$SMR" surfaces map.seg.nrrd map.seg.nrrd -o no
refused "labels without a grid" "--like" "$SMR" labels parts -o no.nrrd
refused "labels in a format that is not written" "ends in" "$SMR" labels parts --like map.seg.nrrd -o no.dcm
mkdir open empty
blob 8 20 20 20 0 | sed '$d' | sed "s/^element face .*/element face $(($(blob 8 20 20 20 0 | sed -n 's/^element face //p') - 1))/" >open/cap.ply
refused "open surfaces" "cap.ply: surface: expected a closed one, but 3 edges" "$SMR" labels open --like map.seg.nrrd -o no.nrrd
refused "no surfaces" "empty: frame: expected a surface" "$SMR" labels empty --like map.seg.nrrd -o no.nrrd
printf 'x,y,z\n1,2,3\n' >empty/points.csv
sed 's/^space origin: .*/space origin: (4000,0,0)/' map.seg.nrrd >elsewhere.nrrd
refused "a volume elsewhere" "elsewhere.nrrd: voxels: expected at least one voxel's centre inside the surfaces" "$SMR" labels parts --like elsewhere.nrrd -o no.nrrd
mkdir apart
cp parts/right.ply apart/
blob 8 2 2 2 0 | awk '/^end_header/ { body = 1 } body && NF == 3 { $1 += 900 } { print }' >apart/far.ply
check "one structure elsewhere" has_status 0 "$SMR" labels apart --like map.seg.nrrd -o apart.mha --quiet
check "is told in one line" [ "$(cat err.txt)" = 'smr: structures without a voxel: far' ]
refused "only points" "a surface or more" "$SMR" labels empty --like map.seg.nrrd -o no.nrrd
cp parts/right.ply empty/
check "a table beside a surface" has_status 0 "$SMR" labels empty --like map.seg.nrrd -o beside.mha --quiet
refused "neither is a label map" "one of the two must be" "$SMR" measure parts again

# Overlaps go to the deepest: of two balls of 20 mm, 20 mm apart, each keeps its half, to the plane between them.
mkdir balls
blob 24 20 20 20 0 >balls/a.ply
awk 'NF == 3 && $1 != "element" && $1 != "format" && !/property/ { printf "%.6f %s %s\n", $1 + 20, $2, $3; next } { print }' balls/a.ply >balls/b.ply
printf 'NRRD0005\ntype: uchar\ndimension: 3\nspace: LPS\nsizes: 74 52 52\nspace directions: (0.9,0,0) (0,0.9,0) (0,0,0.9)\nspace origin: (-23,-23,-23)\nencoding: ascii\n\n' >box.nrrd
awk 'BEGIN { for (i = 0; i < 74 * 52; i++) { for (k = 0; k < 52; k++) printf "0 "; print "" } }' >>box.nrrd
check "overlapping balls" has_status 0 "$SMR" labels balls --like box.nrrd -o balls.mha
check "share what both have" awk '/ a / { a = $5 } / b / { b = $5 } / voxels in several/ { n = $(NF - 8) } / labels; / { for (i = 1; i < NF; i++) if ($(i) == "labels;") n = $(i + 1) }
    END { exit !((a - b)^2 < (0.03 * a)^2 && n > 8000 && a > 30000) }' out.txt

# A label map as the truth: the report has the overlap, and distances like those to the surfaces it was made from.
thigh thigh
check "the truth as a label map" has_status 0 "$SMR" labels thigh/truth --like thigh/mri_patient.mha -o truth.seg.nrrd
into="--model thigh/model/femur.ply thigh/model/vastus_lateralis.ply --reference thigh/mri_reference.mha --target thigh/mri_patient.mha --landmarks thigh/landmarks_reference.mrk.json thigh/landmarks_patient.mrk.json --quiet --iterations 4"
# shellcheck disable=SC2086
"$SMR" register $into --truth truth.seg.nrrd -o by_labels 2>err.txt
# shellcheck disable=SC2086
"$SMR" register $into --truth thigh/truth -o by_surfaces 2>>err.txt
check "the report has Dice of each structure" sh -c "[ \$(grep -c '\"dice\": 0\\.[89]' by_labels/report.json) -eq 2 ] && grep -q hausdorff95_mm by_labels/report.json && ! grep -q dice by_surfaces/report.json"
first_mean() { grep -A8 '"distance_mm"' "$1/report.json" | sed -n 's/.*"mean": \([0-9.]*\).*/\1/p' | head -1; }
check "distances are those to the surfaces, within voxels" awk -v a="$(first_mean by_labels)" -v b="$(first_mean by_surfaces)" 'BEGIN { d = a - b; print a, b; exit !(a > 0 && d < 0.7 && d > -0.7) }'
# A file's name is not always a label's: "Left femur" becomes Left_femur in a map.
LC_ALL=C sed 's/^\(Segment[0-9]*_Name:=\)femur$/\1Left femur/; s/^\(Segment[0-9]*_Name:=\)vastus_lateralis$/\1other/' truth.seg.nrrd >left.seg.nrrd
mkdir two_bones
cp thigh/model/femur.ply 'two_bones/Left femur.ply'
cp thigh/model/vastus_lateralis.ply two_bones/
"$SMR" register --model two_bones/*.ply --reference thigh/mri_reference.mha --target thigh/mri_patient.mha --landmarks thigh/landmarks_reference.mrk.json \
    thigh/landmarks_patient.mrk.json --quiet --ticks 1 --truth left.seg.nrrd -o left >/dev/null 2>err.txt
check "names are compared as labels have them" [ "$(grep -c '"dice": 0' left/report.json)" -eq 1 ]
check "who has no label is told" [ "$(cat err.txt)" = 'smr: --truth: no label is named like vastus_lateralis' ]
# shellcheck disable=SC2086
refused "a truth without the model's names" "the name of one of the model's structures" "$SMR" register $into --truth map.seg.nrrd -o no

python=$(for p in /usr/bin/python3 python3; do "$p" -c 'import vtkmodules, numpy' 2>/dev/null && { echo "$p"; break; }; done)
if [ -z "$python" ]; then
    skip "VTK fills the same voxels" "python3-vtk9 is not installed"
else
    mkdir one && cp balls/a.ply one/ && "$SMR" labels one --like box.nrrd -o one.mha --quiet
    cat >fill.py <<'END'
import sys
from vtkmodules.vtkIOImage import vtkMetaImageReader
from vtkmodules.vtkIOPLY import vtkPLYReader
from vtkmodules.vtkImagingStencil import vtkPolyDataToImageStencil, vtkImageStencilToImage
from vtkmodules.util.numpy_support import vtk_to_numpy
image = vtkMetaImageReader()
image.SetFileName(sys.argv[2])
image.Update()
ours = vtk_to_numpy(image.GetOutput().GetPointData().GetScalars()) > 0
mesh = vtkPLYReader()
mesh.SetFileName(sys.argv[1])
stencil = vtkPolyDataToImageStencil()
stencil.SetInputConnection(mesh.GetOutputPort())
stencil.SetOutputOrigin(image.GetOutput().GetOrigin())
stencil.SetOutputSpacing(image.GetOutput().GetSpacing())
stencil.SetOutputWholeExtent(image.GetOutput().GetExtent())
fill = vtkImageStencilToImage()
fill.SetInputConnection(stencil.GetOutputPort())
fill.SetInsideValue(1)
fill.Update()
theirs = vtk_to_numpy(fill.GetOutput().GetPointData().GetScalars()) > 0
dice = 2.0 * (ours & theirs).sum() / (ours.sum() + theirs.sum())
print(dice, ours.sum(), theirs.sum())
sys.exit(not (dice >= 0.995 and ours.sum() > 40000))
END
    check "VTK fills the same voxels" "$python" fill.py one/a.ply one.mha
fi
finish
