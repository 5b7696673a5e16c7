#!/bin/sh
# itk.sh: what smr writes, read by ITK: displacement fields against `smr carry`, surfaces, label maps; `make check-itk` runs it.
# SPDX-License-Identifier: MIT
# usage: BUILD=... SMR=... itk.sh      ends with 77 where CMake or ITK is missing; compiling takes about a minute
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
command -v cmake >/dev/null || { echo "skip: needs cmake"; exit 77; }
itk=$build/itk
mkdir -p "$itk" || exit 1
if ! cmake -S "$top/tests/itk" -B "$itk" -DCMAKE_BUILD_TYPE=Release >"$itk/cmake.log" 2>&1; then
    grep -q 'provided by "ITK"' "$itk/cmake.log" && { echo "skip: needs libinsighttoolkit5-dev"; exit 77; }
    cat "$itk/cmake.log"
    exit 1
fi
cmake --build "$itk" >"$itk/make.log" 2>&1 || { tail -n 30 "$itk/make.log"; exit 1; }
blob 12 30 20 60 0.05 >bone.ply
blob 14 33 19 63 0.08 >target.ply
{
    echo label,x,y,z
    awk 'BEGIN { for (i = 0; i < 60; i++) printf "p%d,%g,%g,%g\n", i, 12 * sin(i), 8 * cos(2 * i), i - 30 }'
} >a.csv
check "register" "$SMR" register --model bone.ply --target target.ply -o out --format vtk --vertex-errors --quiet
check "carry" "$SMR" carry --result out --points a.csv -o b.csv --quiet
for file in field.nrrd field.mha; do
    check "$file" "$SMR" field --result out --spacing 1.5 -o $file --quiet
    check "ITK moves points by it as carry does" "$itk/itk_read" field $file a.csv b.csv 0.05
    check "the way back" "$SMR" field --result out --spacing 1.5 --inverse -o $file --quiet
    check "likewise" "$itk/itk_read" field $file b.csv a.csv 0.05
done
check "the comparison can fail" sh -c "! '$itk/itk_read' field field.nrrd a.csv b.csv 0.05"
"$itk/itk_read" mesh out/bone.vtk >itk.obj
check "ITK reads the surface" "$tool" compare out/bone.vtk itk.obj
check "and not another" sh -c "! '$tool' compare bone.ply itk.obj"

# Label maps: one place and label of each voxel in all formats, and the places that smr's own reader gives.
image grid.mha 20 20 20
mkdir parts
mv out/bone.vtk parts
for file in l.nrrd l.seg.nrrd l.mha l.nii l.nii.gz; do
    check "$file" "$SMR" labels parts --like grid.mha -o $file --quiet
    "$itk/itk_read" labels $file | sort >$file.txt
    check "ITK reads labels and places as in l.nrrd" cmp l.nrrd.txt $file.txt
done
check "all labels" [ "$("$SMR" info l.mha | sed -n 's/.* voxels *\([0-9]*\) .*ml$/\1/p')" = "$(wc -l <l.nrrd.txt)" ]
check "where smr has them" grep -qx "$("$volume" where l.nii 16 16 24 | awk '{ printf "%.3f %.3f %.3f 1", $1, $2, $3 }')" l.nrrd.txt
finish
