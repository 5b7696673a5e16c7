#!/bin/sh
# Volumes: one sample in every format, type, order of bytes and packing must come out the same; real files have the
# ranges they are known for; each hostile file gets exit status 2 and one line with file and place.
# SPDX-License-Identifier: MIT
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
. "$top/tests/host/volumes_common.inc"
command -v gzip >/dev/null 2>&1 && gzip=1 || gzip=0

# What every file of the sample must give, by type in memory.
place='5 4 3 o 10.000 -20.000 30.000 s 1.500 2.000 4.000 d 0.866 -0.500 0.000 0.500 0.866 0.000 0.000 0.000 1.000'
plain="$place v 0 87 107150.0 0"
signed="$place v -40 47 33950.0 0"
expected() {
    case $1 in
    uint8 | uint16) echo "$1 $plain" ;;
    uint32 | uint64) echo "float $plain" ;;
    int8 | int16) echo "$1 $signed" ;;
    *) echo "float $signed" ;;
    esac
}
# gives NAME FILE TYPE: the sample came out.
gives() {
    gives_is=$("$volume" info "$2" 2>&1)
    if [ "$gives_is" = "$(expected "$3")" ]; then ok "$1"; else
        not_ok "$1"
        echo "#   $gives_is"
    fi
}
# meta TYPE MSB FILE [LINE]: a MetaImage header.
meta() {
    printf 'ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = %s\n' "$2"
    [ -z "${4:-}" ] || echo "$4"
    printf 'TransformMatrix = 0.8660254038 0.5 0 -0.5 0.8660254038 0 0 0 1\nOffset = 10 -20 30\nAnatomicalOrientation = RAI\n'
    printf 'ElementSpacing = 1.5 2 4\nDimSize = 5 4 3\nElementType = %s\nElementDataFile = %s\n' "$1" "$3"
}
# nrrd TYPE ENDIAN ENCODING [LINE]: an NRRD header without its end.
nrrd() {
    printf 'NRRD0004\n# a remark\ntype: %s\ndimension: 3\nspace: left-posterior-superior\nsizes: 5 4 3\n' "$1"
    printf 'space directions: (1.2990381057,0.75,0) (-1, 1.7320508076, 0) (0,0,4)\nkinds: domain domain domain\n'
    printf 'endian: %s\nencoding: %s\nspace origin: (10,-20,30)\nkey:=value\n' "$2" "$3"
    [ -z "${4:-}" ] || echo "$4"
}

for order in little big; do
    msb=$([ $order = big ] && echo True || echo False)
    for pair in int8:MET_CHAR uint8:MET_UCHAR int16:MET_SHORT uint16:MET_USHORT int32:MET_INT uint32:MET_UINT \
        int64:MET_LONG_LONG uint64:MET_ULONG_LONG float:MET_FLOAT double:MET_DOUBLE; do
        type=${pair%:*}
        "$volume" voxels "$type" $order raw
        { meta "${pair#*:}" $msb LOCAL; cat raw; } >a.mha
        gives "MetaImage, $type, $order" a.mha "$type"
        { nrrd "$type" $order raw; echo; cat raw; } >a.nrrd
        gives "NRRD, $type, $order" a.nrrd "$type"
        for form in s q; do
            "$volume" nifti $form "$type" $order a.nii
            gives "NIfTI, ${form}form, $type, $order" a.nii "$type"
        done
    done
done
"$volume" voxels uint16 big raw16
"$volume" nifti none int16 little none.nii
says "NIfTI, pixdim alone" "int16 5 4 3 o 0.000 0.000 0.000 s 1.500 2.000 4.000 d -1.000 0.000 0.000 0.000 -1.000 0.000 0.000 0.000 1.000 v -40 47 33950.0 0" "$volume" info none.nii
"$volume" nifti s int16 little s.nii
"$volume" patch s.nii 112 0000003f00002041 scaled.nii
says "NIfTI, scaled by 0.5 plus 10" "float $place v -10 33.5 35275.0 0" "$volume" info scaled.nii
"$volume" patch s.nii 112 0000c07f0000c07f nan_slope.nii
gives "NIfTI, a slope of NaN is none" nan_slope.nii int16
"$volume" patch s.nii 112 0000803f00000000 one_slope.nii
gives "NIfTI, a slope of 1 is none" one_slope.nii int16
"$volume" patch s.nii 40 04000500040003000100 four.nii
gives "NIfTI, 4 dimensions, the last of 1" four.nii int16
"$volume" patch s.nii 123 00 unit.nii
gives "NIfTI, unit not said" unit.nii int16
cp s.nii s.dat
gives "NIfTI told by its content" s.dat int16
says "mirrored" "int16 5 4 3 o -10.000 -20.000 30.000 s 1.500 2.000 4.000 d -0.866 0.500 0.000 0.500 0.866 0.000 0.000 0.000 1.000 v -40 47 33950.0 0" "$volume" info s.nii 0
says "x runs fastest" "$((3 + 7 * 2 + 31))" sh -c "'$volume' nifti s uint8 little u.nii; '$volume' voxel u.nii 3 2 1"

mkdir -p sub
cp raw16 sub/raw16
meta MET_USHORT True raw16 >sub/a.mhd
gives "MetaImage, detached" sub/a.mhd uint16
meta MET_USHORT True "$scratch/raw16" >sub/absolute.mhd
gives "MetaImage, detached, absolute" sub/absolute.mhd uint16
{ printf 'header of another program\n'; cat raw16; } >sub/long16
meta MET_USHORT True long16 "HeaderSize = -1" >sub/last.mhd
gives "MetaImage, voxels last" sub/last.mhd uint16
meta MET_USHORT True long16 "HeaderSize = 26" >sub/skip.mhd
gives "MetaImage, bytes skipped" sub/skip.mhd uint16
text=$(awk 'BEGIN { for (k = 0; k < 3; k++) for (j = 0; j < 4; j++) for (i = 0; i < 5; i++) print i + 7 * j + 31 * k }')
{ meta MET_USHORT False LOCAL | sed 's/BinaryData = True/BinaryData = False/'; echo "$text"; } >text.mha
gives "MetaImage, text" text.mha uint16
for change in 's/^ElementSpacing/ElementSize = 7 8 9\n&/' 's/^DimSize/ElementSize = 7 8 9\n&/' \
    's/^ElementSpacing.*/DistanceUnits = mm\n&/' 's/^DimSize/DistanceUnits = ?\n&/' 's/^ElementSpacing/ElementSize/'; do
    { meta MET_USHORT True LOCAL | sed "$change"; cat raw16; } >spacing.mha
    gives "MetaImage, $change" spacing.mha uint16
done
{ meta MET_USHORT True LOCAL | sed 's/ = /=/; s/$/\r/'; cat raw16; } >dos.mha
gives "MetaImage, CR LF, no blanks" dos.mha uint16
{ nrrd ushort big ascii; echo; echo "$text"; } >text.nrrd
gives "NRRD, text" text.nrrd uint16
nrrd "unsigned short" big raw "data file: raw16" >sub/a.nhdr
gives "NRRD, detached" sub/a.nhdr uint16
nrrd ushort big raw "data file: long16
byte skip: -1" >sub/last.nhdr
gives "NRRD, voxels last" sub/last.nhdr uint16
nrrd ushort big raw "datafile: long16
lineskip: 1" >sub/skip.nhdr
gives "NRRD, a line skipped" sub/skip.nhdr uint16
{ nrrd ushort big raw; echo; cat raw16; } | sed 's/left-posterior/right-anterior/; s/(1.29.*$/(-1.2990381057,-0.75,0) (1,-1.7320508076,0) (0,0,4)/; s/(10,-20,30)/(-10,20,30)/' >ras.nrrd
gives "NRRD, right-anterior-superior" ras.nrrd uint16
{ nrrd ushort big raw; echo; cat raw16; } | sed 's/^space directions.*/spacings: 1.5 2 4/; /^space/d' >spacings.nrrd
says "NRRD, spacings alone" "uint16 5 4 3 o 0.000 0.000 0.000 s 1.500 2.000 4.000 d 1.000 0.000 0.000 0.000 1.000 0.000 0.000 0.000 1.000 v 0 87 107150.0 0" "$volume" info spacings.nrrd
"$volume" nifti q int16 little q.nii
# The last voxel's centre: 10 -20 30 and 4, 3 and 2 steps along the axes, which are turned by 30 degrees.
for name in spacing.mha dos.mha a.nrrd ras.nrrd s.nii q.nii; do
    "$volume" where $name 4 3 2 >where.txt
    check "$name, the last voxel within 0.0001 mm" awk '{ c = sqrt(3) / 2; x = 10 + 6 * c - 3; y = -20 + 3 + 6 * c
        d = ($1 - x) ^ 2 + ($2 - y) ^ 2 + ($3 - 38) ^ 2; print d; good = NF == 3 && d < 1e-8 } END { exit !good }' where.txt
done

if [ $gzip -eq 1 ]; then
    gzip -nc raw16 >raw16.gz
    "$volume" zlib raw16 raw16.gz raw16.z
    { meta MET_USHORT True LOCAL "CompressedData = True"; cat raw16.z; } >packed.mha
    gives "MetaImage, packed" packed.mha uint16
    cp raw16.z sub/raw16.zraw
    meta MET_USHORT True raw16.zraw "CompressedData = True
CompressedDataSize = $(wc -c <raw16.z)" >sub/packed.mhd
    gives "MetaImage, packed, detached" sub/packed.mhd uint16
    { nrrd ushort big gzip; echo; cat raw16.gz; } >packed.nrrd
    gives "NRRD, packed" packed.nrrd uint16
    gzip -c <raw16 >sub/raw16.gz
    nrrd ushort big gz "data file: raw16.gz" >sub/packed.nhdr
    gives "NRRD, packed, detached" sub/packed.nhdr uint16
    gzip -c raw16 >named.gz
    { nrrd ushort big gzip; echo; cat named.gz; } >named.nrrd
    gives "NRRD, packed with a name" named.nrrd uint16
    for file in s.nii a.mha a.nrrd; do
        gzip -c $file >$file.gz
        says "$file.gz" "$("$volume" info $file)" "$volume" info $file.gz
    done
    # Larger content: dynamic codes, long copies, and stored blocks.
    awk 'BEGIN { for (i = 0; i < 60000; i++) printf "%c", 65 + (i * i * 7 + int(i / 97)) % 50 }' >big.raw
    head -c 60000 /dev/urandom >noise.raw
    for name in big noise; do
        for level in 1 6 9; do
            gzip -n$level -c $name.raw >$name.gz
            "$volume" zlib $name.raw $name.gz $name.z
            size='s/5 4 3/50 40 30/'
            { meta MET_UCHAR False LOCAL | sed "$size"; cat $name.raw; } >$name.mha
            { meta MET_UCHAR False LOCAL "CompressedData = True" | sed "$size"; cat $name.z; } >$name.packed.mha
            says "unpacked $name, level $level" "$("$volume" info $name.mha)" "$volume" info $name.packed.mha
        done
    done
else
    skip "packed volumes" "no gzip"
fi

for name in a.mha A.MHA x.mhd a.nii a.nii.gz a.nrrd a.nhdr a.dcm; do check "$name is a volume's name" "$volume" name $name; done
for name in a.ply mha nii.ply a.json; do check "$name is none" sh -c "! '$volume' name $name"; done

# Legal though odd.
{ meta MET_FLOAT True LOCAL | sed 's/5 4 3/2 1 1/'; printf '\177\300\000\000\077\200\000\000'; } >nan.mha
says "a voxel of NaN, axes of 1 voxel" "float 2 1 1 o 10.000 -20.000 30.000 s 1.500 2.000 4.000 d 0.866 -0.500 0.000 0.500 0.866 0.000 0.000 0.000 1.000 v 1 1 2.0 1" "$volume" info nan.mha
{ meta MET_UCHAR True LOCAL; head -c 60 /dev/zero; } >constant.mha
says "constant" "uint8 $place v 0 0 0.0 0" "$volume" info constant.mha
{ meta MET_USHORT True LOCAL; cat raw16; echo more; } >longer.mha
gives "more bytes than voxels" longer.mha uint16

# meta_refused NAME PLACE SED: the good MetaImage with one change.
meta_refused() {
    { meta MET_USHORT True LOCAL | sed "$3"; cat raw16; } >bad.mha
    lost "MetaImage, $1" bad.mha "$2"
}
meta_refused "spacing 0" "header line 8" 's/1.5 2 4/1.5 0 4/'
meta_refused "spacing negative" "header line 8" 's/1.5 2 4/1.5 -2 4/'
meta_refused "spacing NaN" "header line 8" 's/1.5 2 4/1.5 nan 4/'
meta_refused "spacing infinite" "header line 8" 's/1.5 2 4/1.5 inf 4/'
meta_refused "two spacings" "header line 8" 's/1.5 2 4/1.5 2/'
meta_refused "size of a voxel 0" "header line 8" 's/^ElementSpacing.*/ElementSize = 1.5 0 4/'
for unit in um cm m in; do meta_refused "unit $unit" "header line 8" "s/^ElementSpacing/DistanceUnits = $unit\n&/"; done
meta_refused "no unit" "header line 8" 's/^ElementSpacing/DistanceUnits =\n&/'
meta_refused "singular matrix" TransformMatrix 's/^TransformMatrix.*/TransformMatrix = 1 0 0 1 0 0 0 0 1/'
meta_refused "matrix of 0" TransformMatrix 's/^TransformMatrix.*/TransformMatrix = 0 0 0 0 0 0 0 0 0/'
meta_refused "matrix with NaN" TransformMatrix 's/^TransformMatrix.*/TransformMatrix = nan 0 0 0 1 0 0 0 1/'
meta_refused "matrix of 4" "header line 5" 's/^TransformMatrix.*/TransformMatrix = 1 0 0 1/'
meta_refused "offset NaN" Offset 's/10 -20 30/10 nan 30/'
meta_refused "offset far away" Offset 's/10 -20 30/10 1e20 30/'
meta_refused "10^12 voxels" "header line 9" 's/5 4 3/10000 10000 10000/'
meta_refused "2^64 voxels" "header line 9" 's/5 4 3/4294967296 4294967296 4/'
meta_refused "10^8 voxels" voxels 's/5 4 3/1000 1000 100/'
meta_refused "one voxel too many" voxels 's/5 4 3/61 1 1/'
meta_refused "size 0" "header line 9" 's/5 4 3/5 0 3/'
meta_refused "size negative" "header line 9" 's/5 4 3/5 -4 3/'
meta_refused "size of 2" "header line 9" 's/5 4 3/5 4/'
meta_refused "no size" header '/DimSize/d'
meta_refused "no type" header '/ElementType/d'
meta_refused "4 dimensions" "header line 2" 's/NDims = 3/NDims = 4/'
meta_refused "colour" "header line 10" 's/^ElementType/ElementNumberOfChannels = 3\nElementType/'
meta_refused "unknown type" "header line 10" 's/MET_USHORT/MET_USHORT_ARRAY/'
meta_refused "byte order unknown" "header line 4" 's/MSB = True/MSB = Middle/'
meta_refused "no file of voxels" "header line" '/ElementDataFile/d'
meta_refused "list of files" "header line 11" 's/LOCAL/LIST/'
meta_refused "pattern of files" "header line 11" 's/LOCAL/a%03d.raw 1 3 1/'
meta_refused "file that is not there" "ElementDataFile none.raw" 's/LOCAL/none.raw/'
meta_refused "file that is a directory" "ElementDataFile sub" 's/LOCAL/sub/'
meta_refused "not packed at all" voxels 's/^ElementType/CompressedData = True\nElementType/'
meta_refused "an object of another kind" "header line 1" 's/= Image/= Mesh/'
meta_refused "text that is none" "voxel 0" 's/BinaryData = True/BinaryData = False/'
meta MET_USHORT True LOCAL >short.mha
lost "MetaImage, no voxels" short.mha voxels
meta MET_USHORT True LOCAL | head -c 100 >cut.mha
lost "MetaImage, header longer than the file" cut.mha "header line"
{ meta MET_UCHAR True LOCAL | sed 's/BinaryData = True/BinaryData = False/'; echo "$text" | sed 's/^87$/256/'; } >range.mha
lost "MetaImage, number beyond its type" range.mha "voxel"

# nifti_refused NAME PLACE OFFSET HEX: the good little-endian file with one change.
nifti_refused() {
    "$volume" patch "${5:-s.nii}" "$3" "$4" bad.nii
    lost "NIfTI, $1" bad.nii "$2"
}
nifti_refused "header size wrong" sizeof_hdr 0 00000000
nifti_refused "header size in the other order" 'dim\[0\]' 0 0000015c
nifti_refused "second version" sizeof_hdr 0 1c020000
nifti_refused "no magic" magic 344 00
nifti_refused "pair of files" magic 344 6e6931
nifti_refused "0 dimensions" 'dim\[0\]' 40 0000
nifti_refused "2 dimensions" 'dim\[0\]' 40 0200
nifti_refused "a series" dim 40 04000500040003000200
nifti_refused "size 0" dim 42 0000
nifti_refused "size negative" dim 42 ffff
nifti_refused "3*10^13 voxels" dim 42 ff7fff7fff7f
nifti_refused "more than the file" voxels 42 0600
nifti_refused "colour" datatype 70 80001800
nifti_refused "complex" datatype 70 20004000
nifti_refused "bits that disagree" bitpix 72 0800
nifti_refused "row of 0" srow 280 000000000000000000000000
nifti_refused "row of NaN" srow 280 0000c07f
"$volume" patch s.nii 288 0000803f row.nii
nifti_refused "rows singular" srow 320 00000000 row.nii
nifti_refused "spacing 0" pixdim 80 00000000 q.nii
nifti_refused "spacing negative" pixdim 80 000080bf q.nii
nifti_refused "spacing NaN" pixdim 80 0000c07f q.nii
nifti_refused "quaternion NaN" quatern 256 0000c07f q.nii
nifti_refused "slope infinite" scl_slope 112 0000807f
nifti_refused "voxels inside the header" vox_offset 108 0000803f
nifti_refused "voxels beyond the file" vox_offset 108 00007a49
nifti_refused "voxels at NaN" vox_offset 108 0000c07f
nifti_refused "unit of 7" xyzt_units 123 07
head -c 347 s.nii >short.nii
lost "NIfTI, header longer than the file" short.nii header
head -c 400 s.nii >half.nii
lost "NIfTI, half the voxels" half.nii voxels

nrrd_refused() {
    { nrrd ushort big raw | sed "$3"; echo; cat raw16; } >bad.nrrd
    lost "NRRD, $1" bad.nrrd "$2"
}
nrrd_refused "version 9" "header line 1" 's/NRRD0004/NRRD0009/'
nrrd_refused "unknown type" "header line 3" 's/ushort/block/'
nrrd_refused "4 dimensions" "header line 4" 's/dimension: 3/dimension: 4/'
nrrd_refused "unknown space" "header line 5" 's/left-posterior-superior/scanner-xyz/'
nrrd_refused "no space" header '/^space:/d'
nrrd_refused "10^12 voxels" "header line 6" 's/5 4 3/10000 10000 10000/'
nrrd_refused "more than the file" voxels 's/5 4 3/5 4 4/'
nrrd_refused "size 0" "header line 6" 's/5 4 3/5 4 0/'
nrrd_refused "colour" "header line 7" 's/^space directions: (1[^)]*)/space directions: none/'
nrrd_refused "directions singular" "space directions" 's/(0,0,4)/(1,0,0)/; s/^space dir.*/space directions: (1,0,0) (1,0,0) (0,0,1)/'
nrrd_refused "direction of 0" "space directions" 's/(0,0,4)/(0,0,0)/'
nrrd_refused "direction with NaN" "space directions" 's/(0,0,4)/(0,nan,4)/'
nrrd_refused "broken vector" "header line 7" 's/(0,0,4)/(0,0,4/'
nrrd_refused "kind of vector" "header line 8" 's/domain domain domain/vector domain domain/'
nrrd_refused "unknown order" "header line 9" 's/big/middle/'
nrrd_refused "no order" header '/^endian/d'
nrrd_refused "unknown encoding" "header line 10" 's/raw/bzip2/'
nrrd_refused "no encoding" header '/^encoding/d'
nrrd_refused "not packed at all" voxels 's/encoding: raw/encoding: gzip/'
nrrd_refused "origin broken" "header line 11" 's/(10,-20,30)/(10,-20)/'
nrrd_refused "list of files" "header line 11" 's/^space origin.*/data file: LIST/'
nrrd_refused "file that is not there" "data file none.raw" 's/^space origin.*/data file: none.raw/'
nrrd_refused "skip beyond the file" voxels 's/^space origin.*/byte skip: 100000000000/'
nrrd_refused "lines beyond the file" voxels 's/^space origin.*/line skip: 1000/'
nrrd_refused "other units" "header line 11" 's/^space origin.*/space units: "cm" "cm" "cm"/'
nrrd_refused "spacing 0" "header line 6" 's/^space directions.*/spacings: 1 0 1/; /^space/d'
nrrd ushort big raw >short.nrrd
lost "NRRD, header longer than the file" short.nrrd "header line"

lost "missing" none.mha file
lost "directory" sub file
: >empty.mha
lost "empty" empty.mha file
echo hello >hello.txt
lost "no volume" hello.txt content
{ head -c 128 /dev/zero; printf 'DICM....'; } >a.dcm
lost "DICOM" a.dcm content
check "and says which tool converts it" grep -q dcm2niix err.txt
if [ $gzip -eq 1 ]; then
    damaged() { { meta MET_USHORT True LOCAL "CompressedData = True" | sed "${3:-}"; cat "$2"; } >bad.mha; lost "MetaImage, packed, $1" bad.mha "${4:-voxels}"; }
    head -c 30 raw16.z >cut.z
    damaged "cut off" cut.z
    "$volume" patch raw16.z 20 ffffffff flipped.z
    damaged "damaged" flipped.z
    "$volume" patch raw16.z $(($(wc -c <raw16.z) - 4)) 00000000 sum.z
    damaged "checksum wrong" sum.z
    damaged "more than the header says" raw16.z 's/5 4 3/5 4 2/'
    damaged "less than the header says" raw16.z 's/5 4 3/5 4 4/'
    damaged "10^8 voxels claimed" raw16.z 's/5 4 3/1000 1000 100/'
    damaged "size beyond the file" raw16.z 's/^DimSize/CompressedDataSize = 100000\nDimSize/' CompressedDataSize
    gzip -c raw16 | head -c 40 >sub/cut.gz
    nrrd ushort big gzip "data file: cut.gz" >sub/cut.nhdr
    lost "NRRD, packed, detached, cut off" sub/cut.nhdr "data file cut.gz"
fi

# Damaged files: refused or read, never a crash (which gives another status).
for file in a.mha text.mha packed.mha s.nii q.nii a.nrrd packed.nrrd text.nrrd; do
    [ -f $file ] && check "damaged $file" "$volume" fuzz $file "${SMR_TEST_FUZZ:-3000}" 1
done

# Real files.
identity='d 1.000 0.000 0.000 0.000 1.000 0.000 0.000 0.000 1.000 v'
real() { if [ -f "$data/$1" ]; then check "$1" sh -c "'$volume' info '$data/$1' | grep -qF '$2'"; else skip "$1" "not there"; fi; }
real volumes/ct_hips.mha "int16 122 101 68 o -185.044 -311.319 94.302 s 3.000 3.000 3.000 $identity -1207 3382"
real volumes/ct_hips_label.mha "uint8 122 101 68 o -185.044 -311.319 94.302 s 3.000 3.000 3.000 $identity 0 89"
real volumes/mri_hip_thigh_m.mha "uint8 100 200 120 o -188.574 -113.047 -344.723 s 1.381 1.296 3.900 $identity 0 228"
real volumes/mri_thighs.mha "int16 261 134 31 o -673.500 -589.500 93.000 s 1.500 1.500 6.000 $identity 0 4362"
real thigh_patient/mri_reference.mha "uint8 257 270 273 o -229.019 -120.573 -494.369 s 1.000 1.000 3.000 $identity 0"
real thigh_patient/mri_patient.mha "uint8 245 282 259 o -202.026 -117.333 -443.184 s 1.000 1.000 3.000 $identity 0"
finish
