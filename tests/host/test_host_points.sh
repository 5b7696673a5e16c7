#!/bin/sh
# smr register onto clouds of points: every format with and without normals gives the same bits, part of a bone, start
# poses, logs, several structures, what report.json says, and what is refused.
# SPDX-License-Identifier: MIT
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
blob 12 30 20 60 0.08 >bone.ply
# Every point of a finer blob on one side, moved a little; its normal is about its direction from the axis.
blob 24 31 20.5 61 0.08 | awk 'started && NF == 3 && $1 > -3 { print $1 + 2, $2 - 1, $3 + 2, $1, $2, 0.1 * $3 } /^end_header/ { started = 1 }' >all.txt
n=$(wc -l <all.txt)

ply() { # ply NAME... : an ASCII PLY of these columns
    printf 'ply\nformat ascii 1.0\nelement vertex %d\n' "$n"
    for name in "$@"; do echo "property float $name"; done
    echo end_header
}
awk '{ print $1 "," $2 "," $3 }' all.txt >bare.csv
{ echo 'x;y;z'; awk '{ print $1 ";" $2 "; " $3 }' all.txt; } >bare_semi.csv
{ ply x y z; cut -d' ' -f1-3 all.txt; } >bare.ply
awk '{ print "v", $1, $2, $3 }' all.txt >bare.obj
{ printf '# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS %d float\n' "$n"; cut -d' ' -f1-3 all.txt; } >bare.vtk
{ echo 'x,y,z,nx,ny,nz'; tr ' ' , <all.txt; } >with.csv
{ ply x y z nx ny nz; cat all.txt; } >with.ply
{ ply nz x y z nx ny; awk '{ print $6, $1, $2, $3, $4, $5 }' all.txt; } >with_other.ply
awk '{ print "v", $1, $2, $3; print "vn", $4, $5, $6 }' all.txt >with.obj
{ cat bare.vtk; printf 'POINT_DATA %d\nNORMALS n float\n' "$n"; cut -d' ' -f4-6 all.txt; } >with.vtk
{ echo '# SPACE=RAS'; awk '{ printf "%.6f,%.6f,%s,%.6f,%.6f,%s\n", -$1, -$2, $3, -$4, -$5, $6 }' all.txt; } >with_ras.csv

run() { # run TARGET WORDS...: 0 when the result was written
    "$SMR" register --model bone.ply --target "$@" -o out >out.txt 2>&1
    case $? in 0 | 3) ;; *) cat out.txt; return 1 ;; esac
}
for kind in bare with; do
    check "a cloud, $kind" run $kind.csv
    hash=$(value out/report.json state_hash)
    cp out/report.json $kind.json
    for file in $kind*.ply $kind*.obj $kind*.vtk ${kind}_*.csv; do
        check "$file is taken" run "$file"
        check "$file gives the same bits" [ "$(value out/report.json state_hash)" = "$hash" ]
    done
done
check "normals change the result" [ "$(value bare.json state_hash)" != "$(value with.json state_hash)" ]
check "the model to points is not measured" grep -q '"model_to_target": null' with.json
check "nor a Hausdorff distance" grep -q '"hausdorff_mm": null' with.json
mean=$(sed -n '/"target_to_model"/,/}/s/.*"mean": \([0-9.]*\).*/\1/p' with.json | head -1)
check "points to the model: $mean mm" awk "BEGIN { exit !($mean < 0.4) }"
seen=$(value with.json seen_share)
check "a share is seen: $seen" awk "BEGIN { exit !($seen > 0.4 && $seen < 0.8) }"
check "normals are judged where there are some" awk "BEGIN { exit !($(value with.json normals_agree) > 0.9 && $(value bare.json normals_agree) == -1) }"
check "coverage is measured without normals" awk "BEGIN { exit !($(value bare.json target_covered) > 0.9) }"

awk '{ print $1 + 300 "," $3 "," (-$2) }' all.txt >far.csv
check "--align rigid" run far.csv --align rigid
mean=$(sed -n '/"target_to_model"/,/}/s/.*"mean": \([0-9.]*\).*/\1/p' out/report.json | head -1)
check "it finds the place: $mean mm" awk "BEGIN { exit !($mean < 0.6) }"
check "--attraction 0 with a cloud" run with.csv --attraction 0
check "is said to change nothing" grep -qF -- "--attraction: option: expected a target surface" out.txt
check "and changes nothing" [ "$(value out/report.json state_hash)" = "$(value with.json state_hash)" ]
check "--noise-mm" run with.csv --noise-mm 1
check "it pulls less" [ "$(value out/report.json state_hash)" != "$(value with.json state_hash)" ]

check "a log" run with.csv --log run.log --threads 2
check "is repeated" "$SMR" replay run.log --threads 1
sed '$s/1/2/' with.csv >changed.csv && cp with.csv kept.csv && mv changed.csv with.csv
"$SMR" replay run.log >out.txt 2>&1
check "not with another cloud" [ $? -eq 2 ]
mv kept.csv with.csv

mkdir several goals
cp bone.ply several/a.ply
blob 8 12 12 12 0.02 | awk 'started && NF == 3 && !/^3 / { $1 += 60 } { print } /^end_header/ { started = 1 }' >several/b.ply
cp with.csv goals/a.csv
cp several/b.ply goals/b.ply
check "a cloud and a surface" sh -c "'$SMR' register --model several/*.ply --target goals/* -o both >out.txt 2>&1; [ \$? -eq 0 ] || [ \$? -eq 3 ]"

# Damaged copies of a small cloud are refused, or read as legal points and normals.
head -n 40 all.txt >few.txt && mv all.txt every.txt && mv few.txt all.txt && n=40
{ echo 'x,y,z,nx,ny,nz'; tr ' ' , <all.txt; } >few.csv
{ ply x y z nx ny nz; cat all.txt; } >few.ply
awk '{ print "v", $1, $2, $3; print "vn", $4, $5, $6 }' all.txt >few.obj
{ printf '# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 40 float\n'; cut -d' ' -f1-3 all.txt; printf 'POINT_DATA 40\nNORMALS n float\n'; cut -d' ' -f4-6 all.txt; } >few.vtk
for file in few.csv few.ply few.obj few.vtk; do
    check "2,000 damaged copies of $file" "$build/tests/host/fuzz_tool" $file 2000 1
done

echo '1,2' >two.csv
refused "two numbers" "line 1: expected x,y,z" "$SMR" register --model bone.ply -o refused --target two.csv
printf '1,2,3\n1,2,3,0,0,1\n' >mixed.csv
refused "columns that change" "line 2: expected x,y,z" "$SMR" register --model bone.ply -o refused --target mixed.csv
printf '1,2,nan\n' >nan.csv
refused "no number" "finite coordinates" "$SMR" register --model bone.ply -o refused --target nan.csv
printf '1,2,3e9\n' >large.csv
refused "a coordinate beyond the limit" "finite coordinates" "$SMR" register --model bone.ply -o refused --target large.csv
printf 'x,y,z\n' >names.csv
refused "no point" "at least one vertex" "$SMR" register --model bone.ply -o refused --target names.csv
: >empty.csv
refused "an empty file" "the file is empty" "$SMR" register --model bone.ply -o refused --target empty.csv
printf 'a\001b' >bytes.bin
refused "other bytes" "PLY, STL, OBJ, legacy VTK polydata or CSV" "$SMR" register --model bone.ply -o refused --target bytes.bin
"$SMR" register --model bare.csv --target with.csv -o refused >out.txt 2>err.txt
check "a model of CSV points: refused" [ $? -eq 2 ]
"$SMR" register --model bare.ply --target with.csv -o refused >out.txt 2>err.txt
check "a model without triangles: refused" [ $? -eq 2 ]
finish
