#!/bin/sh
# The true cause of what goes wrong: the line on the error stream names it, for files of another kind, units, places
# and surfaces that are inside out. And smr info describes volumes and landmarks.
# SPDX-License-Identifier: MIT
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
blob 6 30 20 60 0.05 >bone.ply
"$tool" convert bone.ply obj bone.obj

# says NAME STATUS TEXT ARGUMENTS...: the status, and one line on the error stream with this text.
says() {
    says_name=$1 says_status=$2 says_text=$3
    shift 3
    rm -rf out
    "$SMR" "$@" >out.txt 2>err.txt
    says_got=$?
    if [ $says_got -eq "$says_status" ] && [ "$(wc -l <err.txt)" -eq 1 ] && grep -qF "$says_text" err.txt; then
        ok "$says_name"
    else
        not_ok "$says_name (status $says_got)"
        sed 's/^/#   /' err.txt | head -3
    fi
}
# A volume of 8 x 8 x 8 bytes: OFFSET SPACING.
volume() {
    printf 'ObjectType = Image\nNDims = 3\nOffset = %s\nElementSpacing = %s\nDimSize = 8 8 8\n' "$1" "$2"
    printf 'ElementType = MET_UCHAR\nElementDataFile = LOCAL\n'
    head -c 512 /dev/zero | tr '\0' 'Z'
}
volume '-70 -70 -70' '20 20 20' >image.mha
cp image.mha unnamed
printf '# Markups fiducial file version = 4.11\n' >points.fcsv
printf 'label,x,y,z\na,1,2,3\nb,4,5,6\n' >points.csv

# DICOM: a file and folders.
mkdir -p series/deep/er
{ head -c 128 /dev/zero; printf 'DICM\002\000\000\000'; head -c 400 /dev/zero; } >series/deep/er/IM0001
cp series/deep/er/IM0001 slice.dcm
dicom="dcm2niix -z y -o . 'series'"
says "a DICOM folder as the target" 2 "$dicom" register --model bone.ply --target series -o out
says "as the model" 2 "$dicom" build --model series -o out
says "as the reference" 2 "$dicom" build --model bone.ply --reference series -o out
says "to info" 2 "$dicom" info series
says "a DICOM file as the target" 2 "dcm2niix -z y -o . '.'" register --model bone.ply --reference image.mha --target slice.dcm -o out
says "one without an extension" 2 "dcm2niix -z y -o . 'series/deep/er'" register --model bone.ply --target series/deep/er/IM0001 -o out
mkdir empty && echo a >empty/a
says "another folder" 2 "expected a regular file, not a directory" register --model bone.ply --target empty -o out

# One kind in the place of another.
says "a volume as the model" 2 "found a MetaImage volume" build --model image.mha -o out
says "a volume without an extension as the target" 2 "found a MetaImage volume" register --model bone.ply --target unnamed -o out
says "a surface as the reference" 2 "found a PLY surface" build --model bone.ply --reference bone.ply -o out
"$SMR" build --model bone.ply -o model.smr --quiet
says "a model as the target" 2 "found a model made by smr build" register --model bone.ply --target model.smr -o out
says "landmarks as the model" 2 "found a file of landmarks" build --model points.fcsv -o out
says "a model as the landmarks" 2 "found a model made by smr build" register --model bone.ply --target bone.ply --landmarks model.smr points.csv -o out
if command -v gzip >/dev/null 2>&1; then
    gzip -c image.mha >packed.gz
    says "a packed volume as the model" 2 "found a MetaImage volume" build --model packed.gz -o out
else
    skip "a packed volume as the model" "no gzip"
fi

# Units and places.
awk '$1 == "v" { $2 /= 1000; $3 /= 1000; $4 /= 1000 } { print }' bone.obj >metres.obj
says "a model in metres" 2 "a ratio of 1000" register --model metres.obj --target bone.obj -o out
says "a target in metres" 2 "a ratio of 0.001" register --model bone.obj --target metres.obj -o out
says "both in metres: a result, and a warning" 0 "the model's diagonal is only 0.138 mm" register --model metres.obj --target metres.obj -o out --quiet
check "the result is there" [ -s out/report.json ]
says "a model in metres is built with a warning" 0 "is it in metres?" build --model metres.obj -o metres.smr --quiet
says "a model in metres, an image" 2 "metres or micrometres" register --model metres.obj --reference image.mha --target image.mha -o out
says "and built" 2 "metres or micrometres" build --model metres.obj --reference image.mha -o out
volume '500 500 500' '20 20 20' >elsewhere.mha
"$SMR" register --model bone.obj --reference elsewhere.mha --target image.mha -o out >out.txt 2>err.txt
check "a reference elsewhere" grep -q "^verdict: failed: nothing of the target was seen: none of the model's vertices lies in the reference" out.txt
says "and built" 0 "none of its vertices lies in it" build --model bone.obj --reference elsewhere.mha -o beside.smr --quiet
volume '0 -70 -70' '20 20 20' >half.mha
"$SMR" register --model bone.obj --reference half.mha --target image.mha -o out --ticks 2 >out.txt 2>err.txt
check "one that covers a part" grep -qE "^verdict: .*[:;] [56][0-9]\.[0-9] % of the model's vertices lie in the reference image: look" out.txt
check "one that fits is taken" "$SMR" build --model bone.obj --reference image.mha -o fits.smr --quiet

# Inside out.
awk '$1 == "f" { t = $3; $3 = $4; $4 = t } { print }' bone.obj >inside.obj
says "a model that is inside out is named" 0 "inside.obj: faces: expected normals that point outwards" build --model inside.obj -o inside.smr --quiet
"$SMR" register --model bone.obj --target inside.obj -o out --ticks 2 --quiet >out.txt 2>err.txt
check "a target, too" grep -qF "inside.obj: faces: expected normals that point outwards" err.txt
check "with its volume" grep -qF "(volume -" err.txt
awk '$1 == "f" && n++ == 0 { next } { print }' inside.obj >open.obj
"$SMR" build --model open.obj -o open.smr --quiet >out.txt 2>err.txt
check "an open surface has no inside" [ ! -s err.txt ]

# smr info.
check "info of a volume" "$SMR" info image.mha
"$SMR" info image.mha >out.txt 2>err.txt
check "its voxels" grep -q '^volume image.mha  voxels 8 x 8 x 8  uint8  values 90 to 90$' out.txt
check "its geometry" grep -q '^spacing 20 20 20 mm  first voxel at -70 -70 -70 mm, LPS$' out.txt
check "its place" grep -q '^centres of voxels from -70 -70 -70 to 70 70 70 mm, LPS$' out.txt
"$SMR" info points.csv bone.ply unnamed >out.txt 2>err.txt
check "landmarks, a surface and a volume at once" [ $? -eq 0 ]
check "the landmarks" grep -q '^landmark b  *4.000  *5.000  *6.000$' out.txt
check "the surface" grep -q '^structure bone ' out.txt
check "the volume without an extension" grep -q '^volume unnamed ' out.txt
says "broken landmarks" 2 "points.fcsv: header: expected" info points.fcsv
finish
