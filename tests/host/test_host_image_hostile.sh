#!/bin/sh
# Odd and hostile volumes and landmarks through the whole command: as the target and as the reference. What is broken
# is refused with status 2 and one line; what is legal registers, and leaves finite positions.
# SPDX-License-Identifier: MIT
# SMR_TEST_KB: more memory for sanitized builds.
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
blob 12 30 20 60 0.05 >bone.ply
# The distance that the vertices moved at most.
moved() { "$SMR" measure out/bone.ply bone.ply | sed -n 's/^Hausdorff: \([0-9.]*\).*/\1/p'; }

# header TYPE SIZE SPACING MSB: a MetaImage header about the middle.
header() {
    printf 'ObjectType = Image\nNDims = 3\nBinaryDataByteOrderMSB = %s\nTransformMatrix = 1 0 0 0 1 0 0 0 1\n' "$4"
    printf 'Offset = -62 -62 -94\nElementSpacing = %s\nDimSize = %s\nElementType = %s\nElementDataFile = LOCAL\n' "$3" "$2" "$1"
}
# voxels A: 32 x 32 x 48 of an ellipsoid, bytes 'Z' and newline.
voxels() {
    awk -v a="$1" 'BEGIN {
        for (k = 0; k < 48; k++) for (j = 0; j < 32; j++) for (i = 0; i < 32; i++) {
            x = (4 * i - 62) / a; y = (4 * j - 62) / (a - 10); z = (4 * k - 94) / (a + 30)
            printf "%s", x * x + y * y + z * z < 1 ? "Z" : "\n"
        }
    }'
}
voxels 30 >raw
# A big-endian float, as octal escapes, for each 'Z' and another one for the rest.
floats() { # Z REST
    tr '\nZ' '01' <raw | fold -w 1024 | one=$1 zero=$2 awk '{
        line = ""
        for (i = 1; i <= length($0); i++) line = line (substr($0, i, 1) == "1" ? ENVIRON["one"] : ENVIRON["zero"])
        print line
    }' | while IFS= read -r part; do
        # shellcheck disable=SC2059
        printf "$part"
    done
}
hundred='\102\310\000\000' ten='\101\040\000\000' nan='\177\300\000\000'
{ header MET_UCHAR '32 32 48' '4 4 4' False; cat raw; } >good.mha
{ header MET_FLOAT '32 32 48' '4 4 4' True; floats "$hundred" "$ten"; } >float.mha
check "the floats are written as meant" [ "$(wc -c <float.mha)" -eq $((49152 * 4 + $(header MET_FLOAT '32 32 48' '4 4 4' True | wc -c))) ]

# legal NAME ARGUMENTS...: registers; every position is finite.
legal() {
    legal_name=$1
    shift
    rm -rf out
    "$SMR" register --model bone.ply -o out --quiet --accept look "$@" >out.txt 2>err.txt
    legal_status=$?
    if { [ $legal_status -le 1 ] || [ $legal_status -eq 4 ]; } && [ ! -s err.txt ] && "$SMR" measure out/bone.ply bone.ply >/dev/null 2>err.txt; then
        ok "$legal_name"
    else
        not_ok "$legal_name"
        echo "#   status $legal_status: $(head -1 err.txt)"
    fi
}
# still NAME ARGUMENTS...: legal, and nothing to follow: nothing moved, no vertex has a goal or none is shown (null).
still() {
    legal "$@"
    check "$1: nothing moves" awk -v a="$(moved)" 'BEGIN { exit !(a != "" && a < 0.001) }'
    check "$1: no vertex has a goal" sh -c "case $(value out/report.json matched_share) in 0 | null) ;; *) exit 1 ;; esac"
}
legal "the good volume" --reference good.mha --target good.mha
check "has goals" awk -v a="$(value out/report.json matched_share)" 'BEGIN { exit !(a > 0.5) }'
legal "the same as floats" --reference float.mha --target float.mha
check "has goals too" awk -v a="$(value out/report.json matched_share)" 'BEGIN { exit !(a > 0.5) }'

{ header MET_UCHAR '32 32 48' '4 4 4' False; tr 'Z' '\n' <raw; } >constant.mha
{ header MET_FLOAT '32 32 48' '4 4 4' True; floats "$nan" "$nan"; } >nan.mha
{ header MET_FLOAT '32 32 48' '4 4 4' True; floats '\177\200\000\000' '\377\200\000\000'; } >infinite.mha
still "a constant target" --reference good.mha --target constant.mha
still "a constant reference" --reference constant.mha --target good.mha
still "a target of NaN" --reference good.mha --target nan.mha
still "a reference of NaN" --reference nan.mha --target good.mha
legal "an infinite target" --reference good.mha --target infinite.mha
legal "an infinite reference" --reference infinite.mha --target good.mha
{ header MET_FLOAT '32 32 48' '4 4 4' True; floats "$nan" "$ten"; } >hole.mha
legal "a target with NaN inside" --reference good.mha --target hole.mha
legal "a reference with NaN inside" --reference hole.mha --target good.mha
{ header MET_FLOAT '32 32 48' '4 4 4' True; floats '\177\177\377\377' '\377\177\377\377'; } >huge.mha
legal "a target of the largest floats" --reference good.mha --target huge.mha
legal "a reference of the largest floats" --reference huge.mha --target good.mha
legal "both" --reference huge.mha --target huge.mha
# Bytes in the other order than the header says: other numbers, legal ones.
sed 's/OrderMSB = True/OrderMSB = False/' float.mha >swapped.mha
legal "a target in the wrong byte order" --reference float.mha --target swapped.mha
legal "a reference in the wrong byte order" --reference swapped.mha --target float.mha
sed 's/OrderMSB = True/OrderMSB = False/' hole.mha >swapped_hole.mha
legal "NaN in the wrong byte order" --reference float.mha --target swapped_hole.mha

# Axes of one voxel: a plane, a line, a point. Nothing lies between voxel centres across such an axis.
head -c 1536 raw >plane
for size in '1 32 48' '32 1 48' '32 48 1' '1 1 1536' '1536 1 1'; do
    { header MET_UCHAR "$size" '4 4 4' False; cat plane; } >flat.mha
    legal "a target of $size voxels" --reference good.mha --target flat.mha
    legal "a reference of $size voxels" --reference flat.mha --target good.mha
done
{ header MET_UCHAR '1 1 1' '100 100 100' False; printf Z; } >point.mha
legal "a target of one voxel" --reference good.mha --target point.mha
legal "a reference of one voxel" --reference point.mha --target good.mha
sed 's/^Offset.*/Offset = 9000 9000 9000/' good.mha >far.mha
still "a target elsewhere" --reference good.mha --target far.mha
still "a reference elsewhere" --reference far.mha --target good.mha

limit_ms=4000
rm -rf out
register() { by_name=$1 by=$2 by_in=$3; shift 3; by_place "$by_name" "$by" "$by_in" "$SMR" register --model bone.ply -o out "$@"; }
# hostile NAME PLACE SED: the good volume with one change, as target and as reference.
hostile() {
    sed "$3" good.mha >bad.mha
    register "$1, as target" bad.mha "$2" --reference good.mha --target bad.mha
    register "$1, as reference" bad.mha "$2" --reference bad.mha --target good.mha
}
hostile "singular direction matrix" TransformMatrix 's/^TransformMatrix.*/TransformMatrix = 1 0 0 0 1 0 1 1 0/'
hostile "a matrix of NaN" TransformMatrix 's/^TransformMatrix.*/TransformMatrix = nan 0 0 0 1 0 0 0 1/'
hostile "10^12 voxels claimed" "header line 7" 's/32 32 48/10000 10000 10000/'
hostile "more voxels than the file holds" voxels 's/32 32 48/32 32 49/'
hostile "an axis of 0 voxels" "header line 7" 's/32 32 48/0 32 48/'
hostile "a spacing of 0" "header line 6" 's/4 4 4/4 0 4/'
hostile "a byte order that is none" "header line 3" 's/OrderMSB = False/OrderMSB = Maybe/'
head -c 150 good.mha >bad.mha
register "header longer than the file, as target" bad.mha "header line" --reference good.mha --target bad.mha
register "header longer than the file, as reference" bad.mha "header line" --reference bad.mha --target good.mha

# Landmarks, on either side.
seq 1 65 | awk '{ print "p" $1 "," $1 ",0," $1 * $1 % 7 }' >many.csv
head -64 many.csv >most.csv
head -5 many.csv >five.csv
head -4 many.csv >four.csv
sed 's/^p5/q5/' five.csv >label.csv
sed 's/^p5/p4/' five.csv >twice.csv
{ echo '# CoordinateSystem = IJK'; cat five.csv; } >system.csv
printf '{"markups":[{"coordinateSystem":"SCANNER","controlPoints":[{"label":"p1","position":[1,2,3]}]}]}' >system.mrk.json
images='--reference good.mha --target good.mha'
landmarks() { # NAME FILE PLACE
    # shellcheck disable=SC2086
    register "$1, the model's" "$2" "$3" $images --landmarks "$2" five.csv
    # shellcheck disable=SC2086
    register "$1, the target's" "$2" "$3" $images --landmarks five.csv "$2"
}
# shellcheck disable=SC2086
legal "64 landmarks" $images --landmarks most.csv most.csv
landmarks "65 landmarks" many.csv "line 65"
landmarks "a label twice" twice.csv "line 5"
landmarks "an unknown coordinate system" system.csv "line 1"
landmarks "an unknown coordinate system in markups" system.mrk.json "line 1"
# shellcheck disable=SC2086
register "one is missing" four.csv landmarks $images --landmarks five.csv four.csv
# shellcheck disable=SC2086
register "one is missing in the other file" four.csv landmarks $images --landmarks four.csv five.csv
# shellcheck disable=SC2086
register "labels that do not pair" label.csv landmarks $images --landmarks five.csv label.csv
finish
