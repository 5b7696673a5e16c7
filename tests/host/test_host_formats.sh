#!/bin/sh
# Mesh files: round trips through every format, byte orders, odd but legal files, packed files, speed.
# SPDX-License-Identifier: MIT
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
blob 20 30 20 60 0.1 >blob.ply
base=$("$tool" count blob.ply)

for format in ply ply-ascii obj vtk; do
    "$tool" convert blob.ply $format "trip.${format%-ascii}"
    check "round trip $format keeps every bit and the order" "$tool" compare blob.ply "trip.${format%-ascii}"
done
"$tool" convert blob.ply stl trip.stl
check "STL: corners welded, same shape" [ "$("$tool" count trip.stl)" = "$base" ]
"$tool" convert trip.stl stl again.stl
"$tool" convert again.stl ply again.ply
check "STL again: same vertices and triangles" "$tool" compare trip.stl again.ply
for name in trip.obj trip.vtk trip.stl; do
    cp "$name" "${name#trip.}.unknown"
    check "told by content, not by extension: ${name#trip.}" "$tool" compare "$name" "${name#trip.}.unknown"
done
if command -v gzip >/dev/null 2>&1; then
    for name in trip.ply trip.obj trip.stl trip.vtk; do
        gzip -c "$name" >"$name.gz"
        check "packed $name.gz" "$tool" compare "$name" "$name.gz"
    done
else
    skip "packed files" "no gzip"
fi

# The unit tetrahedron as the reference of all handmade files.
ascii='ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n'
printf "$ascii" >tetra.ply
check "tetrahedron: four vertices, volume 1/6" [ "$("$tool" count tetra.ply)" = "4 4 2.366 0.167" ]
same() { check "$1" "$tool" compare tetra.ply "$2"; }

printf "$ascii" | awk '{ printf "%s\r\n", $0 }' >crlf.ply
same "ASCII PLY with CR LF line ends" crlf.ply
printf "$ascii" | tr '\n' '\r' >mac.ply
same "ASCII PLY with CR line ends" mac.ply
printf "$ascii" | awk '{ printf "%s%s", (NR > 1 ? "\n" : ""), $0 }' >no_end.ply
same "ASCII PLY without a last line end" no_end.ply
printf 'ply\nformat ascii 1.0\ncomment x\nobj_info y\nelement camera 2\nproperty list uchar float views\nproperty int id\nelement vertex 4\nproperty uchar red\nproperty double z\nproperty list int short extra\nproperty double y\nproperty short x\nelement face 4\nproperty int tag\nproperty list int uint vertex_index\nproperty float w\nelement edge 1\nproperty int a\nproperty int b\nend_header\n2 0.5 1 7\n0 8\n9 0 0 0 0\n9 0 1 5 0 1\n9 0 2 5 6 1 0\n9 1e0 0 0.0 0\n1 3 0 2 1 0\n1 3 0 1 3 0\n1 3 1 2 3 0\n1 3 0 3 2 0\n0 1\n' >odd.ply
same "PLY: other order, types, properties and elements" odd.ply

z='\000\000\000\000'; one='\000\000\200\077'; head='element vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n'
i0='\000\000\000\000'; i1='\001\000\000\000'; i2='\002\000\000\000'; i3='\003\000\000\000'
printf "ply\nformat binary_little_endian 1.0\n$head$z$z$z$one$z$z$z$one$z$z$z$one\003$i0$i2$i1\003$i0$i1$i3\003$i1$i2$i3\003$i0$i3$i2" >little.ply
same "PLY binary little-endian" little.ply
one='\077\200\000\000'; i1='\000\000\000\001'; i2='\000\000\000\002'; i3='\000\000\000\003'
printf "ply\nformat binary_big_endian 1.0\n$head$z$z$z$one$z$z$z$one$z$z$z$one\003$i0$i2$i1\003$i0$i1$i3\003$i1$i2$i3\003$i0$i3$i2" >big.ply
same "PLY binary big-endian" big.ply
printf "# vtk DataFile Version 3.0\nt\nBINARY\nDATASET POLYDATA\nPOINTS 4 float\n$z$z$z$one$z$z$z$one$z$z$z$one\nPOLYGONS 4 16\n$i3$i0$i2$i1$i3$i0$i1$i3$i3$i1$i2$i3$i3$i0$i3$i2\n" >binary.vtk
same "VTK binary" binary.vtk
i4='\000\000\000\000'
o0=$i4$i0; o1=$i4$i3; o2="$i4\000\000\000\006"; o3="$i4\000\000\000\011"; o4="$i4\000\000\000\014"
printf "# vtk DataFile Version 5.1\nt\nBINARY\nDATASET POLYDATA\nPOINTS 4 float\n$z$z$z$one$z$z$z$one$z$z$z$one\nMETADATA\nINFORMATION 0\n\nPOLYGONS 5 12\nOFFSETS vtktypeint64\n$o0$o1$o2$o3$o4\nCONNECTIVITY vtktypeint64\n$i4$i0$i4$i2$i4$i1$i4$i0$i4$i1$i4$i3$i4$i1$i4$i2$i4$i3$i4$i0$i4$i3$i4$i2\nPOINT_DATA 4\n" >binary51.vtk
same "VTK 5.1 binary, OFFSETS and CONNECTIVITY" binary51.vtk
printf '# vtk DataFile Version 5.1\nt\nASCII\nDATASET POLYDATA\nFIELD FieldData 1\nt 1 2 double\n1 2\nPOINTS 4 double\n0 0 0 1 0 0\n0 1 0 0 0 1\nPOLYGONS 5 12\nOFFSETS vtktypeint64\n0 3 6 9 12\nCONNECTIVITY vtktypeint64\n0 2 1 0 1 3 1 2 3 0 3 2\nPOINT_DATA 4\nSCALARS s float\n' >ascii51.vtk
same "VTK 5.1 ASCII" ascii51.vtk
printf '# vtk DataFile Version 2.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n0 0 0 1 0 0 0 1 0 0 0 1\nTRIANGLE_STRIPS 2 10\n4 0 2 1 3\n4 2 1 0 3\n' >strip.vtk
check "VTK strips: every second triangle turned" [ "$("$tool" count strip.vtk | cut -d' ' -f1,2)" = "4 4" ]
printf '# c\nmtllib a.mtl\no t\nv 0 0 0\nv 1 0 0\nvt 0 0\nvn 0 0 1\nv 0 1 0\nv 0 0 1 0.5 0.5 0.5\nf 1/1/1 3/1 2//1\nf -4 -3 -1\nl 1 2\nf 2 3 4 # x\nf 1 4 3\n' >tetra.obj
same "OBJ: v/vt/vn, v//vn, negative indexes" tetra.obj
for name in ply obj; do
    { printf '\357\273\277'; cat tetra.$name; } >mark.$name
    same "$name with a byte order mark" mark.$name
done
printf '\357\273\277v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n' >mark.unknown
cp mark.unknown first.obj
same "OBJ with a byte order mark before the first vertex" first.obj
same "OBJ with a byte order mark before the first vertex, told by content" mark.unknown
printf '# a folder\\\nv 0 0 \\\n0\nv 1 \\\r\n\\\r\n  0 0\nv\\\n0 1 0\no a\\\nf 1 2 3\nv 0 0 1\\\n0.5\nf 1 3\\\n2\nf 1 2 4 # x\\\nf 2 3 \\\n\\\n4\nf 1 \\\n4 3\\' >lines.obj
same "OBJ: lines that a backslash continues" lines.obj
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 \\ 3\n' >backslash.obj
check "OBJ: a backslash within a line is refused" sh -c "! '$tool' count backslash.obj 2>err.txt && grep -q 'line 4: expected vertex indexes' err.txt"
printf 'solid a b\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nvertex 1 0 0\nendloop\nendfacet\nendsolid\nSOLID c\nFACET NORMAL 0 0 0\nOUTER LOOP\nVERTEX 0 0 -0\nVERTEX 1 0 0\nVERTEX 0 0 1\nENDLOOP\nENDFACET\nENDSOLID c\n' >ascii.stl
check "STL ASCII, two solids, corners welded" [ "$("$tool" count ascii.stl | cut -d' ' -f1,2)" = "4 2" ]
tr '[:lower:]' '[:upper:]' <ascii.stl >upper.stl
check "STL ASCII in capitals" "$tool" compare ascii.stl upper.stl
cp upper.stl upper.unknown
check "STL ASCII in capitals, told by content" "$tool" compare ascii.stl upper.unknown
"$tool" convert ascii.stl stl plain.stl
{ printf 'SOLID of a scanner   '; tail -c +22 plain.stl; echo more; } >capital.stl
check "binary STL whose title says SOLID, more bytes than triangles" "$tool" compare ascii.stl capital.stl
printf 'ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 1 0 0 1 1 0 0.5 1.5 0 0 1 0\n5 0 1 2 3 4\n' >pentagon.ply
check "polygons become fans" [ "$("$tool" count pentagon.ply)" = "5 3 1.250 0.000" ]
printf "$ascii" | sed 's/^format.*/&\ncomment SPACE=RAS/' >ras.ply
printf "$ascii" | sed 's/^1 0 0$/-1 0 0/; s/^0 1 0$/0 -1 0/' >lps.ply
check "SPACE=RAS is turned to LPS" [ "$("$tool" count ras.ply)" = "$("$tool" count lps.ply)" ]
check "points without faces are read" [ "$(sed -e '/face/d;/^property list/d;/^3 /d' tetra.ply >p.ply; "$tool" count p.ply)" = "4 0 0.000 0.000" ]
check "the comparison can fail" sh -c "! '$tool' compare tetra.ply pentagon.ply"

# Damaged copies of all of these: refused with a place, or read as a legal mesh.
blob 4 30 20 60 0.1 >small.ply
for format in ply ply-ascii stl obj vtk; do
    "$tool" convert small.ply $format "damage.$format"
    check "3,000 damaged copies, $format" "$build/tests/host/fuzz_tool" "damage.$format" 3000 1
done
for name in odd.ply big.ply binary.vtk binary51.vtk ascii51.vtk strip.vtk tetra.obj lines.obj ascii.stl; do
    check "3,000 damaged copies of $name" "$build/tests/host/fuzz_tool" $name 3000 2
done

blob 42 30 20 60 0.1 >speed_ascii.ply
"$tool" convert speed_ascii.ply ply speed.ply
"$tool" time speed.ply 20 >time.txt
echo "# reading $("$tool" count speed.ply | cut -d' ' -f1) vertices takes $(cat time.txt)"
check "a binary PLY of 3,500 vertices is read in less than 20 ms" awk '{ exit !($1 < 20) }' time.txt
finish
