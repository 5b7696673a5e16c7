#!/bin/sh
# --format and --slicer: surfaces in each format, a scene that leads to all its files; VTK opens them where it is there.
# SPDX-License-Identifier: MIT
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
blob 12 30 20 60 0.05 >bone.ply
blob 14 33 19 63 0.08 >target.ply

python=$(for p in python3 /usr/bin/python3; do "$p" -c 'import xml.etree.ElementTree' 2>/dev/null && { echo "$p"; break; }; done)
vtk=$(for p in /usr/bin/python3 python3; do "$p" -c 'import numpy, vtkmodules' 2>/dev/null && { echo "$p"; break; }; done)
scene() { "$python" "$top/tests/host/scene_check.py" "$@"; }
open_vtk() { "$vtk" "$top/tests/host/scene_check.py" "$@"; }
run() { "$SMR" register --model bone.ply --target target.ply --quiet "$@"; }
listed() { scene list "$1" | grep -q "$2" || { scene list "$1"; return 1; }; }

# Formats of results.
check "PLY by default" has_status 0 run -o ply --vertex-errors
for format in stl vtk obj; do
    check "--format $format" has_status 0 run -o $format --format $format
    check "the directory has it and no PLY" [ "$(ls $format | tr '\n' ' ' | sed 's/ $//')" = \
        "$(printf '%s\n' bone.$format carry.bin report.json | sort | tr '\n' ' ' | sed 's/ $//')" ]
    check "it says LPS" sh -c "head -c 100 $format/bone.$format | grep -qa SPACE=LPS"
    if [ $format = stl ]; then
        check "the same triangles" [ "$("$tool" count stl/bone.stl)" = "$("$tool" count ply/bone.ply)" ]
    else
        check "our reader reads the same bits" "$tool" compare ply/bone.ply $format/bone.$format
    fi
done
check "--vertex-errors in VTK" has_status 0 run -o judged --format vtk --vertex-errors --slicer judged/scene.mrml
check "the surface is the same" "$tool" compare ply/bone.ply judged/bone.vtk
check "carried to VTK" has_status 0 "$SMR" carry --result ply --points bone.ply -o carried.vtk --quiet
check "as the result is" "$tool" compare ply/bone.ply carried.vtk
mkdir frames
cp target.ply frames/a.ply
check "track" has_status 0 "$SMR" track --model bone.ply --frames frames/a.ply --format obj -o track --quiet --accept look
check "writes it, too" test -s track/a/bone.obj
refused "another format" "one of ply" run -o no --format vtp
refused "errors have no room in STL" "ply or vtk" run -o no --format stl --vertex-errors
printf 'v 0 0 0\nv 5 0 0\nv 0 5 0\nv 0 0 5\n' >marks.obj
refused "points are no STL" "points only" "$SMR" register --model bone.ply marks.obj --target target.ply -o no --format stl
echo 'p,1,2,3' >points.csv
refused "nor are carried points" "triangles" "$SMR" carry --result ply --points points.csv -o no.stl
if [ -n "$vtk" ]; then
    check "VTK reads the same from each" open_vtk same 1e-5 ply/bone.ply stl/bone.stl vtk/bone.vtk obj/bone.obj
    check "what is known of vertices are arrays" open_vtk arrays judged/bone.vtk ply/bone.ply
    check "the comparison can fail" sh -c "! '$vtk' '$top/tests/host/scene_check.py' same 1e-4 ply/bone.ply bone.ply"
else
    skip "VTK reads all formats" "no VTK for python3"
fi

# A scene beside the results.
{
    echo label,x,y,z
    awk 'BEGIN { for (i = 0; i < 12; i++) printf "p%d,%g,%g,%g\n", i, 25 * sin(i), 15 * cos(i), 8 * i - 44 }'
} >a.csv
"$SMR" carry --result ply --points a.csv -o b.csv --quiet
cat >landmarks.mrk.json <<'END'
{"markups": [{"type": "Fiducial", "coordinateSystem": "RAS", "coordinateUnits": "mm", "controlPoints": [
 {"label": "top & \"<end>\"", "position": [0, 0, 60.1234]}, {"label": "low", "position": [0, 0, -63]},
 {"label": "side", "position": [-31.0625, 1, 2]}, {"label": "back", "position": [1, -19, 3]}]}]}
END
check "a scene" has_status 0 "$SMR" register --model bone.ply --target target.ply -o out --landmarks landmarks.mrk.json \
    landmarks.mrk.json --slicer out/scene.mrml
check "it is named" grep -q "^scene for 3D Slicer: out/scene.mrml" out.txt
check "the surface is what it is without" run --landmarks landmarks.mrk.json landmarks.mrk.json -o plain
check "to the bit" cmp out/bone.ply plain/bone.ply
check "nothing else is written" [ "$(ls out | tr '\n' ' ')" = \
    "$(printf '%s\n' bone.ply carry.bin field.nrrd landmarks.mrk.json landmarks_of_the_model.mrk.json report.json scene.mrml | sort | tr '\n' ' ')" ]
check "the field is of a bounded size" [ "$(wc -c <out/field.nrrd)" -lt 800000 ]
if [ -n "$python" ]; then
    check "well-formed, and leads to all files" scene xml out/scene.mrml
    check "the result" listed out/scene.mrml "^Model bone out/bone.ply"
    check "the target" listed out/scene.mrml "^Model target (target) out/../target.ply"
    check "the field" listed out/scene.mrml "^GridTransform model to patient out/field.nrrd"
    check "both landmarks" sh -c "[ \$('$python' '$top/tests/host/scene_check.py' list out/scene.mrml | grep -c ^MarkupsFiducial) -eq 2 ]"
    check "landmarks are JSON, in LPS" "$python" -c "
import json
markup = json.load(open('out/landmarks.mrk.json'))['markups'][0]
point = {p['label']: p['position'] for p in markup['controlPoints']}
assert markup['coordinateSystem'] == 'LPS'
assert max(abs(a - b) for a, b in zip(point['side'], [31.0625, -1, 2])) < 1e-4
assert abs(point['top & \"<end>\"'][2] - 60.1234) < 1e-4"
    check "expected errors can be shown" grep -q 'activeScalarName="expected_error"' judged/scene.mrml
else
    skip "scenes are well-formed" "no python3"
fi
if [ -n "$vtk" ]; then
    "$SMR" carry --result out --points a.csv -o c.csv --quiet
    vertices() { "$tool" convert "$1" obj v.obj && awk 'BEGIN { print "label,x,y,z" } $1 == "v" { print "v," $2 "," $3 "," $4 }' v.obj; }
    vertices bone.ply >v.csv
    vertices out/bone.ply >w.csv
    check "Slicer's way to read the field moves vertices and points as carry does" open_vtk field out/field.nrrd \
        v.csv w.csv 0.1 a.csv c.csv 0.2
    open_vtk field out/field.nrrd a.csv a.csv 0.2 >/dev/null && not_ok "that check can fail" || ok "that check can fail"
else
    skip "Slicer's way to read the field moves points as carry does" "no VTK for python3"
fi

# Elsewhere, by links, and with names that are hostile to XML.
mkdir -p deep/er elsewhere 'odd & "<dir>" %41'
ln -s ../elsewhere deep/link
check "a scene elsewhere" has_status 0 run -o deep/er/out --slicer deep/link/scene.mrml
check "in the working directory" has_status 0 run -o deep/er/out --slicer here.mrml
odd=$(printf 'a&b<c>"d'"'"'%%41 \303\251 \377;e')
wild=$(printf 'f\001\033\n\357\277\276\303g')
cp bone.ply "odd & \"<dir>\" %41/$odd.ply"
cp bone.ply "odd & \"<dir>\" %41/$wild.ply"
check "odd names" has_status 0 "$SMR" register --model "odd & \"<dir>\" %41/$odd.ply" --target "odd & \"<dir>\" %41/$wild.ply" \
    -o "odd & \"<dir>\" %41/$odd" --slicer "odd & \"<dir>\" %41/$odd/s.mrml" --quiet
if [ -n "$python" ]; then
    check "leads to its files" scene xml elsewhere/scene.mrml
    check "and so does that" scene xml here.mrml
    check "and that" scene xml "odd & \"<dir>\" %41/$odd/s.mrml"
    command -v xmllint >/dev/null && check "another parser takes it" xmllint --noout "odd & \"<dir>\" %41/$odd/s.mrml"
fi

# Images: referenced where they are, the reference moved by the field.
volume() {
    printf 'ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = False\nTransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = -44 -34 -74\nElementSpacing = 4 4 4\nDimSize = 23 18 38\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n'
    awk -v bump="$1" 'BEGIN { for (z = 0; z < 38; z++) for (y = 0; y < 18; y++) for (x = 0; x < 23; x++) {
        r = sqrt(((4 * x - 44) / (30 + bump))^2 + ((4 * y - 34) / 20)^2 + ((4 * z - 74) / (60 + bump))^2)
        printf "%c", r < 1 ? 120 : 60 + (x * 7 + y * 3 + z) % 9 } }'
}
volume 0 >reference.mha
volume 2 >patient.mha
check "into an image" has_verdict failed "$SMR" register --model bone.ply --reference reference.mha --target patient.mha -o image --slicer image/scene.mrml --quiet
gzip -c patient.mha >packed.mha.GZ
check "a packed one" sh -c "'$SMR' register --model bone.ply --reference reference.mha --target packed.mha.GZ -o packed --slicer packed/scene.mrml --ticks 1 >out.txt 2>err.txt; [ \$? -eq 4 ]"
check "is left out, which is said" grep -q "packed.mha.GZ: left out" err.txt
if [ -n "$python" ]; then
    check "well-formed" scene xml image/scene.mrml
    check "the image, as it lies" listed image/scene.mrml "^Volume patient image/../patient.mha"
    check "the reference, deformed" listed image/scene.mrml "^Volume moved reference (deformed) image/../reference.mha"
    check "the slices show the image" grep -q '<SliceComposite.*backgroundVolumeID="vtkMRMLScalarVolumeNode1"' image/scene.mrml
    check "without the packed one" scene xml packed/scene.mrml
fi
{ sed '/^end_header/q' target.ply; awk 'on && NF == 3 { $1 += 70 } on { print } /^end_header/ { on = 1 }' target.ply; } >wall.ply
check "kept out of a fixed surface" has_status 0 run -o kept --contact-with wall.ply --html --slicer kept/scene.mrml
check "which is an input" grep -q '^ *"path": "wall.ply",$' kept/report.json
check "on the page, too" grep -q '"path": *"wall.ply"' kept/report.html
[ -z "$python" ] || check "and in the scene" listed kept/scene.mrml "^Model wall (fixed) kept/../wall.ply"
check "a mirrored target" has_status 0 run -o mirrored --mirror-target x --slicer mirrored/scene.mrml --accept look
check "its file is left out" sh -c "! grep -q target.ply mirrored/scene.mrml"

refused "another ending" "ends in .mrml" run -o no --slicer scene.xml
refused "a packed one" "ends in .mrml" run -o no --slicer scene.mrml.gz
refused "no such directory" "directory" run -o no --slicer nowhere/scene.mrml
refused "the log's name" "another file" run -o no --slicer x.mrml --log x.mrml
mkdir -p d.mrml
refused "a directory" "not a directory" "$SMR" register --model bone.ply --target target.ply -o no --slicer d.mrml
refused "its own field's name" "no result has" run -o no --trace no/field.nrrd
finish
