#!/bin/sh
# Hostile files and options: each gets exit status 2 and one line that names the file, the place and what was
# expected, within 2 s and 200 MB, and nothing is written. SMR_TEST_KB: more memory for sanitized builds.
# SPDX-License-Identifier: MIT
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
blob 6 30 20 60 0 >good.ply
"$tool" convert good.ply ply good_binary.ply
limit_ms=2000 # of a processor
case ${CFLAGS:-} in *-fsanitize*) limit_ms=6000 ;; esac # unpacking 300 MB took 1 to 3 s
mkdir kept
echo mark >kept/mark

# hostile NAME FILE PLACE: as a model into a new directory, as a target into one with content.
hostile() {
    by_place "$1, as model" "$2" "$3" "$SMR" register --model "$2" --target good.ply -o fresh
    by_place "$1, as target" "$2" "$3" "$SMR" register --model good.ply --target "$2" -o kept
}

# made NAME FILE PLACE FORMAT: the same of a file with this content.
made() { printf "$4" >"$2"; hostile "$1" "$2" "$3"; }

name63=$(printf 's%062d' 7)
cp good.ply "${name63}8.ply"
cp good.ply "$name63.ply"
by_place "a structure's name of 64 bytes" "${name63}8.ply" "name of structure 0" "$SMR" register --model "${name63}8.ply" --target good.ply -o fresh
by_place "the same, beside one of 63" "${name63}8.ply" "name of structure 1" "$SMR" build --model "$name63.ply" "${name63}8.ply" -o fresh
by_place "one of several targets" "${name63}8.ply" name "$SMR" register --model good.ply --target good.ply "${name63}8.ply" -o fresh
check "a name of 63 bytes, the only target's of 64" sh -c "'$SMR' register --model $name63.ply --target ${name63}8.ply -o long --quiet --iterations 2; [ -s long/$name63.ply ]"

hostile "missing file" none.ply file
mkdir dir.ply
hostile "directory" dir.ply file
: >empty.ply
hostile "empty file" empty.ply file
head -c 60 good_binary.ply >cut_header.ply
hostile "truncated header" cut_header.ply "header line"
size=$(wc -c <good_binary.ply)
head -c $((size - 1)) good_binary.ply >cut1.ply
hostile "one byte short" cut1.ply "header line|face"
head -c $((size / 2)) good_binary.ply >cut2.ply
hostile "half the file" cut2.ply "header line|vertex|face"
head -20 good.ply >cut3.ply
hostile "ASCII, cut in the vertices" cut3.ply "header line|vertex"
ply() { printf 'ply\nformat %s 1.0\nelement vertex %s\nproperty float x\nproperty float y\nproperty float z\nelement face %s\nproperty list %s int vertex_indices\nend_header\n' "$1" "$2" "$3" "$4"; }
body='0 0 0\n1 0 0\n0 1 0\n'
made "4,000,000,000 vertices claimed" claim.ply "header line 3" "$(ply ascii 4000000000 1 uchar)\n$body"
made "the same in binary" claim_binary.ply "header line 3" "$(ply binary_little_endian 4000000000 1 uchar)\n$body"
made "legal counts that the file cannot hold" claim_legal.ply "header line 3" "$(ply binary_little_endian 3999999 7999999 uchar)\n$body"
made "4,000,000,000 faces claimed" claim_faces.ply "header line 7" "$(ply ascii 3 4000000000 uchar)\n$body"
made "negative vertex count" negative.ply "header line 3" "$(ply ascii -3 1 uchar)\n$body"
made "face index out of range" range.ply "face 0" "$(ply ascii 3 1 uchar)\n${body}3 0 1 3\n"
made "face index below 0" minus.ply "face 1" "$(ply ascii 3 2 uchar)\n${body}3 0 1 2\n3 0 1 -1\n"
made "negative list count" list.ply "face 0" "$(ply ascii 3 1 char)\n${body}-3 0 1 2\n"
made "negative list count, binary" list_binary.ply "face 0" "$(ply binary_little_endian 3 1 char)\n"'\000\000\000\000\000\000\000\000\000\000\000\000\000\000\200\077\000\000\000\000\000\000\000\000\000\000\000\000\000\000\200\077\000\000\000\000\375\000\000\000\000\001\000\000\000\002\000\000\000'
made "list count of 4,000,000,000" list_claim.ply "face 0" "$(ply ascii 3 1 uint)\n${body}4000000000 0 1 2\n"
made "face of two vertices" two.ply "face 0" "$(ply ascii 3 1 uchar)\n${body}2 0 1\n"
for value in nan NaN inf -inf 1e30 -100001 abc; do
    { ply ascii 3 1 uchar; printf "0 0 0\n1 0 0\n0 $value 0\n3 0 1 2\n"; } >"bad$value.ply"
    hostile "coordinate $value" "bad$value.ply" "vertex 2"
done
made "coordinate NaN, binary" nan_binary.ply "vertex 0" "$(ply binary_little_endian 3 1 uchar)\n"'\000\000\300\177\000\000\000\000\000\000\000\000\000\000\200\077\000\000\000\000\000\000\000\000\000\000\000\000\000\000\200\077\000\000\000\000\003\000\000\000\000\001\000\000\000\002\000\000\000'
{ ply ascii 0 0 uchar; } >no_vertex.ply
hostile "no vertices" no_vertex.ply "header"
{ ply ascii 3 0 uchar; printf "$body"; } >no_face.ply
by_place "no triangles, as model" no_face.ply "faces" "$SMR" register --model no_face.ply --target good.ply -o fresh
sed '/element face/d; /property list/d' no_face.ply >points.ply
by_place "no face element, as model" points.ply "faces" "$SMR" register --model points.ply --target good.ply -o fresh
made "no z" no_z.ply "header line 3" 'ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n0 0\n'
made "unknown PLY format" format.ply "header line 2" 'ply\nformat ebcdic 1.0\nelement vertex 1\n'
made "unknown PLY type" type.ply "header line 4" 'ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\nend_header\n'
made "list counted by floats" list_float.ply "header line 4" 'ply\nformat ascii 1.0\nelement vertex 1\nproperty list float int x\nend_header\n'
made "unknown format" hello.txt content 'hello world\n'
made "no PLY in a .ply" hello.ply "header line 1" 'hello world\n'
made "no VTK in a .vtk" hello.vtk "line 1" 'hello world\n'
made "no STL in a .stl" hello.stl header 'hello world\n'
made "OBJ index out of range" range.obj "line 4" 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n'
made "OBJ index 0" zero.obj "line 4" 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n'
made "OBJ index before the first" minus.obj "line 4" 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf -4 2 1\n'
made "OBJ vertex of two numbers" short.obj "line 2" 'v 0 0 0\nv 1 0\n'
made "OBJ face of two" two.obj "line 4" 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n'
made "STL ASCII, truncated" cut.stl line 'solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n'
made "STL coordinate 1e30" far.stl "line 6" 'solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1e30 0\nendloop\nendfacet\nendsolid\n'
made "STL without triangles" none.stl "vert" 'solid a\nendsolid a\n'
{ printf '%80s' x; printf '\377\377\377\377'; printf "$body"; } >claim.stl
hostile "STL binary, 4,294,967,295 faces claimed" claim.stl header
vtk='# vtk DataFile Version 3.0\nt\nASCII\nDATASET'
made "VTK, not polydata" grid.vtk "line 4" "$vtk UNSTRUCTURED_GRID\n"
made "VTK, 4,000,000,000 points claimed" claim.vtk "line 5" "$vtk POLYDATA\nPOINTS 4000000000 float\n0 0 0\n"
made "VTK index out of range" range.vtk "face 0" "$vtk POLYDATA\nPOINTS 3 float\n0 0 0 1 0 0 0 1 0\nPOLYGONS 1 4\n3 0 1 3\n"
made "VTK negative count" minus.vtk "face 0" "$vtk POLYDATA\nPOINTS 3 float\n0 0 0 1 0 0 0 1 0\nPOLYGONS 1 4\n-3 0 1 2\n"
made "VTK coordinate NaN" nan.vtk "vertex 2" "$vtk POLYDATA\nPOINTS 3 float\n0 0 0 1 0 0 0 nan 0\nPOLYGONS 1 4\n3 0 1 2\n"
made "VTK offset beyond the array" offset.vtk "face 1" "$vtk POLYDATA\nPOINTS 3 float\n0 0 0 1 0 0 0 1 0\nPOLYGONS 2 3\nOFFSETS vtktypeint64\n0 9\nCONNECTIVITY vtktypeint64\n0 1 2\n"
printf '\037\213junk' >junk.ply.gz
mkfifo pipe.ply && hostile "named pipe without a writer" pipe.ply file
hostile "device" /dev/zero file
if command -v gzip >/dev/null 2>&1; then
    hostile "damaged .gz" junk.ply.gz file
    gzip -c good.ply | head -c 300 >cut.ply.gz
    hostile "truncated .gz" cut.ply.gz file
    head -c 300000000 /dev/zero | gzip -1 >bomb.ply.gz
    hostile ".gz of 300 MB of zeros" bomb.ply.gz "header line 1|content|file"
    { printf 'ply\nformat ascii 1.0\ncomment '; head -c 300000000 /dev/zero; } | gzip -1 >bomb2.ply.gz
    hostile ".gz of 300 MB that starts like a PLY" bomb2.ply.gz "file"
else
    skip "packed hostile files" "no gzip"
fi
printf 'SMR1xxxxxxxxxxxxxxxxxxxxxxxxxx' >junk.smr
by_place "damaged model" junk.smr model "$SMR" register --model junk.smr --target good.ply -o fresh
by_place "damaged model, info" junk.smr model "$SMR" info junk.smr
by_place "not a model" hello.smr "file" "$SMR" info hello.smr

# Options: --name value, as register's.
for pair in "--radius 0" "--radius -5" "--radius nan" "--radius inf" "--radius x" "--radius 10,20" "--radius 10,," \
    "--radius 1e-60" "--radius 1e9" "--search 0" "--search -1" "--search NaN" "--search 10mm" "--threads 0" "--threads -1" \
    "--threads 65" "--threads 1.5" "--ticks 0" "--ticks -1" "--ticks 1e3" "--budget-ms -1" "--budget-ms nan" \
    "--stiffness 0" "--stiffness 1e-40" "--search 1e-40" "--stiffness 1.01" "--stiffness nan" "--attraction -0.1" "--attraction 2" "--slide 1.1" "--even -1" "--align maybe" \
    "--method polar2" "--mirror-target w" "--clusters none" "--relaxation 0" "--node-budget 7" "--iterations 0" \
    "--radius 1e-7" "--plastic-um 1.1e8" "--reject-deviations 1000001" "--active-enough 1000001"; do
    set -- $pair
    by_place "option $pair" "$1" "" "$SMR" register --model good.ply --target good.ply -o fresh "$1" "$2"
done
by_place "unknown option" --frobnicate option "$SMR" register --model good.ply --target good.ply -o fresh --frobnicate
by_place "option of another command" --c-array option "$SMR" register --model good.ply --target good.ply -o fresh --c-array a
by_place "option without its value" --radius value "$SMR" register --model good.ply --target good.ply -o fresh --radius
by_place "no model" usage --model "$SMR" register --target good.ply -o fresh
by_place "no target" usage --target "$SMR" register --model good.ply -o fresh
by_place "no output" usage -o "$SMR" register --model good.ply --target good.ply
by_place "unknown command" dance command "$SMR" dance
by_place "no command" usage command "$SMR"
by_place "measure of one" usage measure "$SMR" measure good.ply
by_place "two structures of one name" ./good.ply name "$SMR" register --model good.ply ./good.ply --target good.ply -o fresh
cp good.ply other_a.ply; cp good.ply other_b.ply
by_place "several targets, none named like a structure" --target names "$SMR" register --model good.ply --target other_a.ply other_b.ply -o fresh

# Output that cannot be written.
echo file >plain
by_place "output is a file" plain output "$SMR" register --model good.ply --target good.ply -o plain
by_place "output below a file" plain/sub output "$SMR" register --model good.ply --target good.ply -o plain/sub
by_place "output in /proc" /proc/smr output "$SMR" register --model good.ply --target good.ply -o /proc/smr
mkdir taken && mkdir taken/report.json
by_place "a result's name is a directory" taken report.json "$SMR" register --model good.ply --target good.ply -o taken
check "nothing is left behind then" [ "$(ls -A taken)" = report.json ]
if [ -c /dev/full ]; then
    by_place "full disk" /dev/full output "$SMR" build --model good.ply -o /dev/full
    check "the device is still there" [ -c /dev/full ]
    mkdir full && ln -s /dev/full full/report.json
    by_place "full disk at the last file" full output "$SMR" register --model good.ply --target good.ply -o full
    check "nothing is left behind then either" [ "$(ls -A full)" = report.json ]
    "$SMR" --help >/dev/full 2>err.txt
    check "full standard output" [ $? -eq 2 ]
else
    skip "full disk" "no /dev/full"
fi
(ulimit -f 8 && "$SMR" build --model good.ply -o limited.smr) >out.txt 2>err.txt
check "file size limit: exit status 2" [ $? -eq 2 ]
check "and no file" [ ! -e limited.smr ]

# The checks can fail: a good run is not "refused".
check "a good run is told from a refused one" has_verdict look "$SMR" register --model good.ply --target good.ply -o fine --quiet
finish
