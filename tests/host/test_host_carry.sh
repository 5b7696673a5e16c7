#!/bin/sh
# smr carry, field and warp: formats, there and back, grids, hostile files; VTK reads the field where it is installed.
# SPDX-License-Identifier: MIT
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
blob 12 30 20 60 0.05 >bone.ply
blob 14 33 19 63 0.08 >target.ply
"$tool" convert bone.ply ply bone_binary.ply

# near A B MM: two tables label,x,y,z with the same points.
near() {
    paste -d, "$1" "$2" | awk -F, -v most="$3" 'NR > 1 { d = ($2-$6)^2 + ($3-$7)^2 + ($4-$8)^2
        if (!(sqrt(d) <= most)) { print "row " NR ": " sqrt(d) " mm"; bad = 1 } n++ } END { exit bad || n < 2 }'
}
{
    echo label,x,y,z
    awk 'BEGIN { for (i = 0; i < 40; i++) printf "p%d,%g,%g,%g\n", i, 9 * sin(i), 6 * cos(2 * i), i - 20 }'
} >points.csv

check "register leaves what it takes" has_status 0 "$SMR" register --model bone_binary.ply --target target.ply -o out --quiet
"$SMR" carry --result out --points points.csv -o told.csv >told.txt
check "each point has expected errors, whose squares add up" awk '/expected error/ { n++; a = $5; b = $10; c = $13
    if (!(b > 0 && (d = a * a - b * b - c * c) < 0.03 && d > -0.03)) exit bad = 1 } END { exit bad || n != 40 }' told.txt
check "carry" has_status 0 "$SMR" carry --result out --points points.csv -o a.csv
check "other places" sh -c "! cmp -s points.csv a.csv"
check "and back" has_status 0 "$SMR" carry --result out --points a.csv -o back.csv --inverse --quiet
check "to where they were" near points.csv back.csv 0.01
"$SMR" carry --result out --points bone_binary.ply -o vertices.ply --quiet
check "vertices go to the result" cmp vertices.ply out/bone_binary.ply
"$SMR" carry --result out --points points.csv -o a.csv --quiet 2>good.txt
"$SMR" register --model bone_binary.ply --target target.ply -o short --ticks 1 --quiet
"$SMR" carry --result short --points points.csv -o short.csv --quiet 2>short.txt
check "a verdict that is not good is told" grep -q '^smr: the verdict on short is look: --ticks ended' short.txt
check "a good one is not" test ! -s good.txt
printf '{' >short/report.json
check "nor one that cannot be read" sh -c '"$0" carry --result short --points points.csv -o short.csv --quiet 2>&1 | cmp - /dev/null' "$SMR"
for format in fcsv mrk.json; do
    check "to .$format" has_status 0 "$SMR" carry --result out --points points.csv -o "a.$format"
    check "from .$format" has_status 0 "$SMR" carry --result out --points "a.$format" -o "b.csv" --inverse
    check "the same points" near points.csv b.csv 0.01
done
for threads in 1 3; do
    "$SMR" carry --result out --points points.csv -o "t$threads.csv" --threads "$threads" --quiet
done
check "threads change no digit" cmp t1.csv t3.csv

check "mirrored models take points as their files have them" has_status 0 "$SMR" register --model bone_binary.ply \
    --target target.ply --mirror-model x -o mirror --quiet
"$SMR" carry --result mirror --points bone_binary.ply -o mirrored.ply --quiet
"$SMR" measure mirrored.ply mirror/bone_binary.ply >distance.txt
check "they go to the result" grep -q "A to B, vertices: mean 0.0000" distance.txt
"$SMR" carry --result mirror --points points.csv -o m.csv --quiet
"$SMR" carry --result mirror --points m.csv -o mback.csv --inverse --quiet
check "and come back" near points.csv mback.csv 0.01

# volume NAME OFFSET SPACING SIZE BYTES
volume() {
    printf 'ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = False\nTransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = %s\nElementSpacing = %s\nDimSize = %s\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n' "$2" "$3" "$4" >"$1"
    awk -v n="$5" 'BEGIN { for (i = 0; i < n; i++) printf "%c", 40 + (i * 7) % 80 }' >>"$1"
}
volume grid.mha "-18 -15 -30" "1.5 1.5 1.5" "25 21 41" 21525
check "a field" has_status 0 "$SMR" field --result out --spacing 6 -o field.mha
check "that nowhere folds, as it says" grep -q "; 0 cells fold" out.txt
check "a field as NRRD" has_status 0 "$SMR" field --result out --spacing 6 -o field.nrrd
check "in LPS, vector first" sh -c "head -c 600 field.nrrd | grep -aq 'space: left-posterior-superior' &&
    head -c 600 field.nrrd | grep -aq 'kinds: vector domain domain domain'"
tail -c 30000 field.mha >mha.tail
tail -c 30000 field.nrrd >nrrd.tail
check "both have the same vectors" cmp mha.tail nrrd.tail
check "a field on another grid" has_status 0 "$SMR" field --result out --like grid.mha -o field.mha
check "the way back" has_status 0 "$SMR" field --result out --like grid.mha --inverse -o inverse.mha
python=$(for p in /usr/bin/python3 python3; do "$p" -c 'import vtkmodules' 2>/dev/null && { echo "$p"; break; }; done)
if [ -n "$python" ]; then
    cat >grid.py <<'END'
import csv, sys
from vtkmodules.vtkIOImage import vtkMetaImageReader
from vtkmodules.vtkFiltersHybrid import vtkGridTransform
def points(path): return [[float(r[k]) for k in "xyz"] for r in csv.DictReader(open(path))]
reader = vtkMetaImageReader()
reader.SetFileName(sys.argv[1])
reader.Update()
grid = vtkGridTransform()
grid.SetDisplacementGridData(reader.GetOutput())
grid.SetInterpolationModeToLinear()
worst = max(sum((a - b) ** 2 for a, b in zip(grid.TransformPoint(p), q)) ** 0.5
            for p, q in zip(points(sys.argv[2]), points(sys.argv[3])))
print("worst", worst)
sys.exit(worst > 0.05)
END
    check "VTK moves points by the field as carry does" "$python" grid.py field.mha points.csv a.csv
    check "and back by the inverse" "$python" grid.py inverse.mha a.csv points.csv
else
    skip "VTK moves points by the field as carry does" "no VTK for python3"
fi

volume image.mha "-40 -30 -70" "8 6 10" "10 10 14" 1400
check "warp" has_status 0 "$SMR" warp --result out --volume image.mha --spacing 8 -o warped.mha
check "warp onto another grid" has_status 0 "$SMR" warp --result out --volume image.mha --like image.mha -o like.nrrd
check "that grid" sh -c "head -c 400 like.nrrd | grep -aq 'sizes: 10 10 14'"
"$SMR" info like.nrrd >info.txt
check "which smr reads" grep -q "10 x 10 x 14  uint8" info.txt

refused "no result" "$(printf '')" "$SMR" carry --result nowhere --points points.csv -o no.csv
refused "no points" "" "$SMR" carry --result out --points nothing.csv -o no.csv
printf 'label,x,y,z\n"a\377b\\\303\251\177",1,2,3\n' >odd.csv
check "labels that are no UTF-8" has_status 0 "$SMR" carry --result out --points odd.csv -o odd.mrk.json --quiet
check "become some" grep -qF "$(printf '"label": "a?b\\\\\303\251\\u007f"')" odd.mrk.json
for name in p.ply.gz p.csv.GZ p.mrk.json.gz; do
    refused "points are not written packed, $name" "$name: name: expected an output that ends in" "$SMR" carry --result out --points points.csv -o $name
done
refused "nor fields" "f.nrrd.gz: name: expected an output that ends in" "$SMR" field --result out --spacing 6 -o f.nrrd.gz
refused "an unknown format" "mrk.json" "$SMR" carry --result out --points points.csv -o no.txt
refused "no --points" "points" "$SMR" carry --result out -o no.csv
refused "no --volume" "volume" "$SMR" warp --result out -o no.mha
refused "--spacing beside --like" "like" "$SMR" field --result out --like image.mha --spacing 2 -o no.mha
refused "too fine a grid" "voxels" "$SMR" field --result out --spacing 0.0001 -o no.mha
echo 'p,1e9,0,0' >far.csv
refused "points too far" "within" "$SMR" carry --result out --points far.csv -o no.csv
echo 'p,1,nan,0' >far.csv
refused "no numbers" "finite" "$SMR" carry --result out --points far.csv -o no.csv
refused "its own input" "input" "$SMR" carry --result out --points points.csv -o points.csv

mkdir broken
size=$(wc -c <out/carry.bin)
for at in 0 4 8 12 16 20 30 40 100 200 $((size - 2)); do
    cp out/carry.bin broken/carry.bin
    printf '\377' | dd of=broken/carry.bin bs=1 seek="$at" conv=notrunc 2>/dev/null
    refused "byte $at damaged" "" "$SMR" carry --result broken --points points.csv -o no.csv
done
for n in 0 3 31 32 99 500 $((size - 1)); do
    head -c "$n" out/carry.bin >broken/carry.bin
    refused "cut off after $n" "" "$SMR" carry --result broken --points points.csv -o no.csv
done
{ cat out/carry.bin; echo; } >broken/carry.bin
refused "a byte too many" "size" "$SMR" carry --result broken --points points.csv -o no.csv
finish
