#!/bin/sh
# smr-register: the description that 3D Slicer asks for, and runs with the arguments that Slicer makes of it.
# SPDX-License-Identifier: MIT
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
mkdir -p root/bin root/lib/smr/slicer 'a dir'
ln -s "$SMR" root/bin/smr
cp "$top/port/host/slicer/smr-register.sh" root/lib/smr/slicer/smr-register
chmod +x root/lib/smr/slicer/smr-register
module=$scratch/root/lib/smr/slicer/smr-register
blob 12 30 20 60 0.05 >bone.ply
blob 14 33 19 63 0.08 >'a dir/target.ply'
python=$(for p in python3 /usr/bin/python3; do "$p" -c 'import xml.etree.ElementTree' 2>/dev/null && { echo "$p"; break; }; done)

check "--xml" has_status 0 env -u SMR "$module" --xml
cp out.txt module.xml
check "nothing on the error stream" [ ! -s err.txt ]
check "it starts as XML does" sh -c "head -c 5 module.xml | grep -q '<?xml'"
check "--xml of smr is the same" sh -c "'$SMR' register --xml | cmp - module.xml"
{ "$SMR" --help; "$SMR" register --help; } >help.txt
cat >module.py <<'END'
import re, sys
import xml.etree.ElementTree as tree
root = tree.parse("module.xml").getroot()
help_text = open("help.txt").read()
assert root.tag == "executable"
assert [e.tag for e in root][:4] == ["category", "title", "description", "version"]
known = {"image", "geometry", "pointfile", "transform", "directory", "string", "float", "double", "integer", "boolean",
         "string-enumeration"}
within = {"name", "flag", "longflag", "label", "description", "channel", "default", "element", "constraints"}
parameters = [p for group in root.findall("parameters") for p in group if p.tag not in ("label", "description")]
names = [p.findtext("name") for p in parameters]
flags = [p.findtext("longflag") for p in parameters if p.find("longflag") is not None]
assert len(parameters) > 40 and len(set(names)) == len(names) and len(set(flags)) == len(flags)
for group in root.findall("parameters"):
    assert [e.tag for e in group][:2] == ["label", "description"]
for p in parameters:
    assert p.tag in known, p.tag
    assert {e.tag for e in p} <= within, [e.tag for e in p]
    assert re.fullmatch("[A-Za-z_][A-Za-z0-9_]*", p.findtext("name")), p.findtext("name")
    assert p.findtext("label") and p.findtext("description"), p.findtext("name")
    if p.tag in ("image", "geometry", "pointfile", "transform", "directory"):
        assert p.findtext("channel") in ("input", "output")
    if p.tag == "string-enumeration":
        assert p.findtext("default") in [e.text for e in p.findall("element")], p.findtext("name")
    if p.find("constraints") is not None:
        low, high = (float(p.findtext("constraints/" + k)) for k in ("minimum", "maximum"))
        assert low <= float(p.findtext("default")) <= high, p.findtext("name")
for flag in flags:
    assert re.search(r"--" + re.escape(flag) + r"\b", help_text), flag
for name in ("model", "target", "image", "output", "field", "iterations", "attraction", "radius"):
    assert name in flags, name
# What Slicer makes of it when nobody changes a value: numbers and words are passed, empty texts and false are not.
line = []
for p in parameters:
    if p.tag in ("float", "double", "integer", "string-enumeration") or (p.tag == "string" and p.findtext("default")):
        line += ["--" + p.findtext("longflag"), p.findtext("default")]
open("defaults.txt", "w").write("\n".join(line) + "\n")
END
if [ -n "$python" ]; then
    check "well-formed, complete, of known words, each flag in --help" "$python" module.py
    set -f
    # shellcheck disable=SC2046
    set -- $(cat defaults.txt)
    set +f
    check "all its values are passed" [ $# -gt 60 ]
else
    skip "well-formed" "no python3"
    set -- --attraction 0.50 --iterations 9 --align none --sideways 0.5
fi
check "what Slicer runs" has_status 0 env -u SMR "$module" --returnparameterfile values.txt --model bone.ply --target 'a dir/target.ply' \
    --output 'a dir/out.ply' --field 'a dir/field.nrrd' "$@"
check "nothing on its error stream" [ ! -s err.txt ]
"$SMR" register --model bone.ply --target 'a dir/target.ply' -o plain --quiet
check "the result is that of smr" cmp 'a dir/out.ply' plain/bone.ply
check "the field is there" sh -c "head -c 100 'a dir/field.nrrd' | grep -qa left-posterior-superior"
check "the verdict is returned" grep -qx "verdict = good" values.txt
check "and the expected error" grep -q "^expected_error = [0-9]" values.txt
check "progress is told" grep -q "<filter-start>" out.txt
check "no scratch is left" sh -c "TMPDIR=. '$module' --model bone.ply --target 'a dir/target.ply' --output x.stl >/dev/null && ! ls -d tmp.* 2>/dev/null"
check "STL by its name" sh -c "head -c 30 x.stl | grep -qa '^smr SPACE=LPS' && '$SMR' measure x.stl plain/bone.ply | grep -q '^Hausdorff: 0.0000 mm'"
check "a value that is no default is passed" has_status 0 env -u SMR "$module" --model bone.ply --target 'a dir/target.ply' \
    --output y.ply --iterations 3 --attraction 0.25 --align none
check "and counts" sh -c "! cmp -s y.ply plain/bone.ply"
"$SMR" register --model bone.ply --target 'a dir/target.ply' -o given --quiet --iterations 3 --attraction 0.25
check "as it does for smr" cmp y.ply given/bone.ply
check "a folder keeps all" has_status 0 env -u SMR "$module" --model bone.ply --target 'a dir/target.ply' -o 'a dir/kept'
check "which carries points" has_status 0 env -u SMR "$SMR" carry --result 'a dir/kept' --points bone.ply -o z.ply --quiet
check "with its report" [ -s 'a dir/kept/report.json' ]

mkdir held
cp bone.ply held/older.ply
check "an existing folder keeps all, too" has_status 0 env -u SMR "$module" --model bone.ply --target 'a dir/target.ply' -o held \
    --output held.ply --field held.nrrd
check "the surface is this run's" cmp held.ply plain/bone.ply
check "beside what lay there" cmp held/older.ply bone.ply
check "the field is that of the folder" cmp held.nrrd held/field.nrrd
check "the kept scene leads to what lies beside it" sh -c "grep -q 'fileName=\"bone.ply\"' held/scene.mrml &&
    grep -q 'fileName=\"field.nrrd\"' held/scene.mrml && ! grep -q '\.\./\.\./' held/scene.mrml"
check "the report's command says where" sh -c "sed -n '/\"command\"/,/\]/p' held/report.json | grep -qx ' *\"held\"'"
check "outputs that are results of the folder" has_status 0 env -u SMR "$module" --model bone.ply --target 'a dir/target.ply' -o held \
    --output held/bone.ply --field held/field.nrrd
check "are left as they are" cmp held/bone.ply plain/bone.ply

# No output may be an input.
cp bone.ply bone_before.ply
cp 'a dir/target.ply' target_before.ply
ln -s bone.ply link.ply
for option in "--output bone.ply" "--output link.ply" "--field a dir/target.ply" "--returnparameterfile ./bone.ply"; do
    check "an input as ${option%% *}" has_status 2 env -u SMR "$module" --model bone.ply --target 'a dir/target.ply' "${option%% *}" "${option#* }"
    check "is refused in one line" sh -c "[ \$(grep -c . err.txt) -eq 1 ] && grep -q 'none of the inputs' err.txt"
    check "and kept" sh -c "cmp bone.ply bone_before.ply && cmp 'a dir/target.ply' target_before.ply"
    cp bone_before.ply bone.ply
    cp target_before.ply 'a dir/target.ply'
done
check "an input as a result of -o" has_status 2 env -u SMR "$module" --model bone.ply --target 'a dir/target.ply' -o .
check "is kept" cmp bone.ply bone_before.ply

printf 'label,x,y,z\na,0,0,60\nb,0,0,-60\nc,30,0,0\nd,0,20,0\n' >a.csv
printf 'label,x,y,z\na,0,0,63\nb,0,0,-63\nc,33,0,0\nd,0,19,0\n' >b.csv
check "landmarks" has_status 0 env -u SMR "$module" --model bone.ply --target 'a dir/target.ply' --model-landmarks a.csv \
    --target-landmarks b.csv --output l.ply
"$SMR" register --model bone.ply --target 'a dir/target.ply' --landmarks a.csv b.csv -o marks --quiet
check "are smr's" cmp l.ply marks/bone.ply
check "one set alone" has_status 2 env -u SMR "$module" --model bone.ply --target 'a dir/target.ply' --model-landmarks a.csv --output n.ply
check "an output of another kind" has_status 2 env -u SMR "$module" --model bone.ply --target 'a dir/target.ply' --output n.vtp
check "no model" has_status 2 env -u SMR "$module" --target 'a dir/target.ply' --output n.ply
check "says what smr says" grep -q "^smr: .*--model" err.txt
check "an option without its value" has_status 2 env -u SMR "$module" --model bone.ply --output
check "none of them leaves a file" [ ! -e n.ply ]
awk '/^end_header/ { behind = 1; print; next } behind && NF == 3 { $1 += 900 } { print }' 'a dir/target.ply' >far.ply
check "a failed result is no success" has_status 1 env -u SMR "$module" --returnparameterfile values.txt --model bone.ply --target far.ply --output far_out.ply
check "and says so" grep -qx "verdict = failed" values.txt
finish
