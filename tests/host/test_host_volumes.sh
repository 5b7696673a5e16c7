#!/bin/sh
# Volumes and landmarks: one sample in every format, type, order of bytes and packing must come out the same; real
# files have the ranges they are known for; each hostile file gets exit status 2 and one line with file and place.
# SPDX-License-Identifier: MIT
# SMR_TEST_KB: more memory for sanitized builds. SMR_TEST_CFLAGS: for the helper. SMR_TEST_DATA: where real data lies.
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc

build_tool || { not_ok "the mesh helper compiles"; finish; exit 1; }
compile_tool volume_tool "$scratch/volume" base files meshes volumes landmarks || { not_ok "the helper compiles"; finish; exit 1; }
data=${SMR_TEST_DATA:-../shared/data}
[ -d "$data" ] && data=$(cd "$data" && pwd)
tool=$scratch/tool
volume=$scratch/volume
cd "$scratch" || exit 1
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
# says NAME EXPECTED COMMAND...: prints exactly that.
says() {
    says_name=$1 says_expected=$2
    shift 2
    says_is=$("$@" 2>&1)
    if [ "$says_is" = "$says_expected" ]; then ok "$says_name"; else
        not_ok "$says_name"
        echo "#   $says_is"
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

# refused NAME FILE PLACE [COMMAND [FILE]]: status 2 and one line that names file, place and expectation.
refused() {
    refused_name=$1 refused_file=$2 refused_place=$3
    if [ $# -gt 3 ]; then shift 3; else shift 3; set -- info "$refused_file"; fi
    "$tool" run 2000 "${SMR_TEST_KB:-204800}" "$volume" "$@" >out.txt 2>err.txt
    refused_status=$?
    refused_why=
    [ $refused_status -eq 2 ] || refused_why="status $refused_status"
    [ "$(wc -l <err.txt)" -eq 1 ] || refused_why="$refused_why, $(wc -l <err.txt) lines"
    grep -qF "smr: $refused_file: " err.txt || refused_why="$refused_why, no file"
    grep -qE "^smr: [^:]*: .*$refused_place.*: expected ." err.txt || refused_why="$refused_why, no place like $refused_place"
    [ -s out.txt ] && refused_why="$refused_why, standard output not empty"
    if [ -z "$refused_why" ]; then ok "refused: $refused_name"; else
        not_ok "refused: $refused_name ($refused_why)"
        sed 's/^/#   /' err.txt | head -3
    fi
}
# meta_refused NAME PLACE SED: the good MetaImage with one change.
meta_refused() {
    { meta MET_USHORT True LOCAL | sed "$3"; cat raw16; } >bad.mha
    refused "MetaImage, $1" bad.mha "$2"
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
refused "MetaImage, no voxels" short.mha voxels
meta MET_USHORT True LOCAL | head -c 100 >cut.mha
refused "MetaImage, header longer than the file" cut.mha "header line"
{ meta MET_UCHAR True LOCAL | sed 's/BinaryData = True/BinaryData = False/'; echo "$text" | sed 's/^87$/256/'; } >range.mha
refused "MetaImage, number beyond its type" range.mha "voxel"

# nifti_refused NAME PLACE OFFSET HEX: the good little-endian file with one change.
nifti_refused() {
    "$volume" patch "${5:-s.nii}" "$3" "$4" bad.nii
    refused "NIfTI, $1" bad.nii "$2"
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
refused "NIfTI, header longer than the file" short.nii header
head -c 400 s.nii >half.nii
refused "NIfTI, half the voxels" half.nii voxels

nrrd_refused() {
    { nrrd ushort big raw | sed "$3"; echo; cat raw16; } >bad.nrrd
    refused "NRRD, $1" bad.nrrd "$2"
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
refused "NRRD, header longer than the file" short.nrrd "header line"

refused "missing" none.mha file
refused "directory" sub file
: >empty.mha
refused "empty" empty.mha file
echo hello >hello.txt
refused "no volume" hello.txt content
{ head -c 128 /dev/zero; printf 'DICM....'; } >a.dcm
refused "DICOM" a.dcm content
check "and says which tool converts it" grep -q dcm2niix err.txt
if [ $gzip -eq 1 ]; then
    damaged() { { meta MET_USHORT True LOCAL "CompressedData = True" | sed "${3:-}"; cat "$2"; } >bad.mha; refused "MetaImage, packed, $1" bad.mha "${4:-voxels}"; }
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
    refused "NRRD, packed, detached, cut off" sub/cut.nhdr "data file cut.gz"
fi

# Landmarks.
json() { printf '{"markups": [{"type": "Fiducial", "controlPoints": [%s], "coordinateSystem": "%s"}]}\n' "$2" "$1"; }
point() { printf '{"label": "%s", "position": [%s]}' "$1" "$2"; }
json LPS "$(point 'tip, low' '1, -2.5, 3e1'), $(point b\\u00e9 '0,0,0')" >a.mrk.json
both='tip, low: 1.000 -2.500 30.000
bé: 0.000 0.000 0.000'
says "markups, LPS" "$both" "$volume" landmarks a.mrk.json
json RAS "$(point 'tip, low' '-1, 2.5, 30'), $(point bé '0,0,0')" >ras.mrk.json
says "markups, RAS" "$both" "$volume" landmarks ras.mrk.json
fcsv() { printf '# Markups fiducial file version = 4.11\n# CoordinateSystem = %s\n# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n%s\n' "$1" "$2"; }
for pair in LPS:1,-2.5,30 1:1,-2.5,30 RAS:-1,2.5,30 0:-1,2.5,30; do
    fcsv "${pair%:*}" "n_0,${pair#*:},0,0,0,1,1,1,0,\"tip, low\",,
n_1,0,0,0,0,0,0,1,1,1,0,bé,,vtkMRMLModelNode4" >a.fcsv
    says "fcsv, ${pair%:*}" "$both" "$volume" landmarks a.fcsv
done
printf '\357\273\277label,x,y,z\r\n"tip, low",1,-2.5,30\r\nb\303\251, 0, 0, 0\r\n' >a.csv
says "CSV with names of columns" "$both" "$volume" landmarks a.csv
printf '"tip, low",1,-2.5,30\n\n# remark\nb\303\251,0,0,0' >b.csv
says "CSV without" "$both" "$volume" landmarks b.csv
for head in label,x,y,z:'"tip, low",1,-2.5,30' label,z,y,x:'"tip, low",30,-2.5,1' Z,Label,X,Y:'30,"tip, low",1,-2.5' \
    label,R,A,S:'"tip, low",-1,2.5,30' '"label","s","l","p":"tip, low",30,1,-2.5'; do
    printf '%s\n%s\n' "${head%%:*}" "${head#*:}" >head.csv
    says "CSV, names ${head%%:*}" "tip, low: 1.000 -2.500 30.000" "$volume" landmarks head.csv
    { echo "# columns = ${head%%:*}"; cat head.csv; } >column.csv
    says "CSV, names ${head%%:*}, as a comment, too" "tip, low: 1.000 -2.500 30.000" "$volume" landmarks column.csv
done
printf '# CoordinateSystem = RAS\nlabel,z,y,x\na,3,2,-1\n' >head.csv
says "CSV, names and a system" "a: 1.000 -2.000 3.000" "$volume" landmarks head.csv
printf '# CoordinateSystem = 0\nlabel,S,A,R\na,3,2,-1\n' >head.csv
says "CSV, names and the same system" "a: 1.000 -2.000 3.000" "$volume" landmarks head.csv
fcsv LPS '1,1,2,3,0,0,0,1,1,1,0,a,,,2,0
2,0,0,0,0,0,0,1,1,1,0,b,,,0,0
3,7,7,7,0,0,0,1,1,1,0,c,,,1,1' >status.fcsv
says "fcsv, status of a point" "a: 1.000 2.000 3.000" "$volume" landmarks status.fcsv
fcsv LPS '30,-2.5,1,tip' | sed 's/columns = .*/columns = z,y,x,label/' >columns.fcsv
says "fcsv, other columns" "tip: 1.000 -2.500 30.000" "$volume" landmarks columns.fcsv
for units in '"mm"' '["mm", "UCUM", "millimeter"]' '["mm"]'; do
    json LPS "$(point a 1,2,3)" | sed "s/\"Fiducial\"/&, \"coordinateUnits\": $units/" >units.mrk.json
    says "markups, units $units" "a: 1.000 2.000 3.000" "$volume" landmarks units.mrk.json
done
printf 'b\303\251,7,8,9\n"tip, low",4,5,6\n' >target.csv
says "pairs by label" "1.000 -2.500 30.000 -> 4.000 5.000 6.000
0.000 0.000 0.000 -> 7.000 8.000 9.000" "$volume" pair a.mrk.json target.csv
says "64 landmarks" 64 sh -c "seq 1 64 | sed 's/.*/p&,&,0,0/' >64.csv; '$volume' landmarks 64.csv | wc -l"
printf '{"markups":[{"coordinateSystem":"LPS","controlPoints":[%s,{"label":"x","positionStatus":"undefined","position":null}]}]}' "$(point a 1,2,3)" >undefined.mrk.json
says "markups, a point not placed" "a: 1.000 2.000 3.000" "$volume" landmarks undefined.mrk.json

printf '{"markups":[{"coordinateSystem":"LPS","controlPoints":[%s,{"label":"x","position":"","positionStatus":"undefined"}]}]}' "$(point a 1,2,3)" >undefined.mrk.json
says "markups, a position of no text" "a: 1.000 2.000 3.000" "$volume" landmarks undefined.mrk.json

lost() { refused "landmarks, $1" "$2" "$3" landmarks "$2"; }
for units in '"um"' '["um", "UCUM", "micrometer"]' '["mm", "other"]' '[]' '{"code": "um"}' '{"code": "mm"}' null 1 '[["mm"]]'; do
    json LPS "$(point a 1,2,3)" | sed "s/\"Fiducial\"/&, \"coordinateUnits\": $units/" >bad.mrk.json
    lost "units $units" bad.mrk.json "line 1"
done
json LPS '{"label": "a", "position": ""}' >bad.mrk.json; lost "position of no text" bad.mrk.json "line 1"
json LPS '{"label": "a", "position": [1,2,3], "positionStatus": "lost"}' >bad.mrk.json; lost "unknown status" bad.mrk.json "line 1"
json LPI "$(point a 1,2,3)" >bad.mrk.json; lost "unknown system" bad.mrk.json "line 1"
json LPS "$(point a 1,2,3), $(point a 4,5,6)" >bad.mrk.json; lost "label twice" bad.mrk.json "line 1"
json LPS "$(point a 1,2)" >bad.mrk.json; lost "two coordinates" bad.mrk.json "line 1"
json LPS "$(point a 1,2,3,4)" >bad.mrk.json; lost "four coordinates" bad.mrk.json "line 1"
json LPS "$(point a 1,NaN,3)" >bad.mrk.json; lost "NaN" bad.mrk.json "line 1"
json LPS "$(point a 1,1e300,3)" >bad.mrk.json; lost "far away" bad.mrk.json "line 1"
json LPS "$(point a 01,2,3)" >bad.mrk.json; lost "number that is none" bad.mrk.json "line 1"
json LPS "$(point '' 1,2,3)" >bad.mrk.json; lost "empty label" bad.mrk.json "line 1"
json LPS "$(point "$(printf '%064d' 0)" 1,2,3)" >bad.mrk.json; lost "label of 64 bytes" bad.mrk.json "line 1"
json LPS "$(point 'a\q' 1,2,3)" >bad.mrk.json; lost "unknown escape" bad.mrk.json "line 1"
json LPS "$(point 'a\ud800' 1,2,3)" >bad.mrk.json; lost "half a character" bad.mrk.json "line 1"
json LPS "$(point a 1,2,3)," >bad.mrk.json; lost "comma too many" bad.mrk.json "line 1"
json LPS "" >bad.mrk.json; lost "none" bad.mrk.json landmarks
echo '{}' >bad.mrk.json; lost "no markups" bad.mrk.json landmarks
printf '{"markups":[{"controlPoints":[%s]}]}' "$(point a 1,2,3)" >bad.mrk.json; lost "no system" bad.mrk.json "line 1"
json LPS "$(point a 1,2,3)" | head -c 60 >bad.mrk.json; lost "cut off" bad.mrk.json "line 1"
{ json LPS "$(point a 1,2,3)"; echo more; } >bad.mrk.json; lost "more behind" bad.mrk.json "line 2"
{ printf '{"a":'; head -c 100000 /dev/zero | tr '\0' '['; } >bad.mrk.json; lost "100,000 lists" bad.mrk.json "line 1"
fcsv LIP "1,1,2,3,0,0,0,1,1,1,0,a,," >bad.fcsv; lost "fcsv, unknown system" bad.fcsv "line 2"
fcsv LPS "1,1,2,3,0,0,0,1,1,1,0,a,," | sed 2d >bad.fcsv; lost "fcsv, no system" bad.fcsv header
echo "1,1,2,3,0,0,0,1,1,1,0,a,," >bad.fcsv; lost "fcsv, no header" bad.fcsv header
fcsv LPS "1,1,2" >bad.fcsv; lost "fcsv, cut row" bad.fcsv "line 4"
fcsv LPS "1,1,2,3,0,0,0,1,1,1,0,,," >bad.fcsv; lost "fcsv, no label" bad.fcsv "line 4"
fcsv LPS "1,1,5,2,3,0,0,0,1,1,1,0,a,," >bad.fcsv; lost "fcsv, a decimal comma" bad.fcsv "line 4"
fcsv LPS "1,1,5,2,5,3,0,0,0,1,1,1,0,a,," >bad.fcsv; lost "fcsv, two decimal commas" bad.fcsv "line 4"
fcsv LPS "1,1,5,2,5,3,5,0,0,0,1,1,1,0,a,," >bad.fcsv; lost "fcsv, three decimal commas" bad.fcsv "line 4"
fcsv LPS "1,1,2,3,0,0,0,1,1,1,0,a" >bad.fcsv; lost "fcsv, twelve fields" bad.fcsv "line 4"
fcsv LPS "1,1,2,3,0,0,0,1,1,1,0,a,,,3,0" >bad.fcsv; lost "fcsv, unknown status" bad.fcsv "line 4"
fcsv LPS "1,1,2,3,0,0,0,1,1,1,0,a,,,2" >bad.fcsv; lost "fcsv, fifteen fields" bad.fcsv "line 4"
fcsv LPS "1,1,2,3,0,0,0,1,1,1,0,a,," | sed 's/,oz/,x/' >bad.fcsv; lost "fcsv, a column twice" bad.fcsv "line 3"
for head in label,a,b,c label,x,y name,x,y,z label,x,y,z,w label,x,A,S label,x,x,y label,i,j,k 'label;x;y;z' 'label,x (mm),y,z' a,b,c,d; do
    printf '%s\na,1,2,3\n' "$head" >bad.csv; lost "CSV, names $head" bad.csv "line 1"
done
printf '# columns = label,x,y,z\nlabel,z,y,x\na,1,2,3\n' >bad.csv; lost "CSV, names that differ" bad.csv "line 2"
printf 'a,1,2,3\n# columns = label,z,y,x\n' >bad.csv; lost "CSV, names after a landmark" bad.csv "line 2"
printf '# CoordinateSystem = LPS\nlabel,R,A,S\na,1,2,3\n' >bad.csv; lost "CSV, names of another system" bad.csv "line 1"
printf 'a,1,5,2,3\n' >bad.csv; lost "CSV, a decimal comma" bad.csv "line 1"
printf 'a;1,5;2,5;3,5\n' >bad.csv; lost "CSV, semicolons" bad.csv "line 1"
printf 'label,x,y,z\nlabel,x,y,z\na,1,2,3\n' >bad.csv; lost "CSV, names twice" bad.csv "line 2"
printf 'a,1,2,3\na,4,5,6\n' >bad.csv; lost "CSV, label twice" bad.csv "line 2"
printf 'a,1,2,3\nb,4,5\n' >bad.csv; lost "CSV, three fields" bad.csv "line 2"
printf 'a,1,2,3\nb,4,x,6\n' >bad.csv; lost "CSV, no number" bad.csv "line 2"
printf 'a,1,2,nan\n' >bad.csv; lost "CSV, NaN" bad.csv "line 1"
printf 'a, b,1,2,3\n' >bad.csv; lost "CSV, comma without quotes" bad.csv "line 1"
printf '"a,1,2,3\n' >bad.csv; lost "CSV, open quote" bad.csv "line 1"
printf '# CoordinateSystem = IJK\na,1,2,3\n' >bad.csv; lost "CSV, unknown system" bad.csv "line 1"
printf 'label,x,y,z\n' >bad.csv; lost "CSV, none" bad.csv landmarks
seq 1 65 | sed 's/.*/p&,&,0,0/' >bad.csv; lost "65" bad.csv "line 65"
lost "missing" none.csv file
lost "a volume" a.nii content
printf 'a,1,2,3\nb,4,5,6\n' >two.csv
printf 'a,1,2,3\nc,4,5,6\n' >other.csv
printf 'a,1,2,3\n' >one.csv
refused "landmarks, counts differ" one.csv landmarks pair two.csv one.csv
refused "landmarks, label missing" other.csv landmarks pair two.csv other.csv

# Damaged files: refused or read, never a crash (which gives another status).
for file in a.mha text.mha packed.mha s.nii q.nii a.nrrd packed.nrrd text.nrrd; do
    [ -f $file ] && check "damaged $file" "$volume" fuzz $file "${SMR_TEST_FUZZ:-3000}" 1
done
for file in a.mrk.json units.mrk.json a.fcsv status.fcsv a.csv column.csv; do check "damaged $file" "$volume" fuzz-landmarks $file "${SMR_TEST_FUZZ:-3000}" 1; done

# Real files.
identity='d 1.000 0.000 0.000 0.000 1.000 0.000 0.000 0.000 1.000 v'
real() { if [ -f "$data/$1" ]; then check "$1" sh -c "'$volume' info '$data/$1' | grep -qF '$2'"; else skip "$1" "not there"; fi; }
real volumes/ct_hips.mha "int16 122 101 68 o -185.044 -311.319 94.302 s 3.000 3.000 3.000 $identity -1207 3382"
real volumes/ct_hips_label.mha "uint8 122 101 68 o -185.044 -311.319 94.302 s 3.000 3.000 3.000 $identity 0 89"
real volumes/mri_hip_thigh_m.mha "uint8 100 200 120 o -188.574 -113.047 -344.723 s 1.381 1.296 3.900 $identity 0 228"
real volumes/mri_thighs.mha "int16 261 134 31 o -673.500 -589.500 93.000 s 1.500 1.500 6.000 $identity 0 4362"
real thigh_patient/mri_reference.mha "uint8 257 270 273 o -229.019 -120.573 -494.369 s 1.000 1.000 3.000 $identity 0"
real thigh_patient/mri_patient.mha "uint8 245 282 259 o -202.026 -117.333 -443.184 s 1.000 1.000 3.000 $identity 0"
if [ -d "$data/thigh_patient" ]; then
    for file in thigh_patient/landmarks_patient thigh_person/landmarks_person; do
        says "$file, pairs" 15 sh -c "'$volume' pair '$data/thigh_patient/landmarks_reference.mrk.json' '$data/$file.mrk.json' | wc -l"
    done
else
    skip "real landmarks" "not there"
fi
finish
