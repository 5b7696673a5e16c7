#!/bin/sh
# itk.sh: a displacement field of `smr field`, read and applied by ITK, against `smr carry`; `make check-itk` runs it.
# SPDX-License-Identifier: MIT
# usage: BUILD=... SMR=... itk.sh      ends with 77 where CMake or ITK is missing; compiling takes about a minute
cd "$(dirname "$0")/../.." || exit 1
command -v cmake >/dev/null || { echo "skip: needs cmake"; exit 77; }
build=$(pwd)/${BUILD:-build}/itk
mkdir -p "$build" || exit 1
if ! cmake -S tests/itk -B "$build" -DCMAKE_BUILD_TYPE=Release >"$build/cmake.log" 2>&1; then
    grep -q 'provided by "ITK"' "$build/cmake.log" && { echo "skip: needs libinsighttoolkit5-dev"; exit 77; }
    cat "$build/cmake.log"
    exit 1
fi
cmake --build "$build" >"$build/make.log" 2>&1 || { tail -n 30 "$build/make.log"; exit 1; }
. tests/host/host_common.inc
blob 12 30 20 60 0.05 >bone.ply
blob 14 33 19 63 0.08 >target.ply
{
    echo label,x,y,z
    awk 'BEGIN { for (i = 0; i < 60; i++) printf "p%d,%g,%g,%g\n", i, 12 * sin(i), 8 * cos(2 * i), i - 30 }'
} >a.csv
check "register" "$SMR" register --model bone.ply --target target.ply -o out --quiet
check "carry" "$SMR" carry --result out --points a.csv -o b.csv --quiet
for file in field.nrrd field.mha; do
    check "$file" "$SMR" field --result out --spacing 1.5 -o $file --quiet
    check "ITK moves points by it as carry does" "$build/itk_field" $file a.csv b.csv 0.05
    check "the way back" "$SMR" field --result out --spacing 1.5 --inverse -o $file --quiet
    check "likewise" "$build/itk_field" $file b.csv a.csv 0.05
done
check "the comparison can fail" sh -c "! '$build/itk_field' field.nrrd a.csv b.csv 0.05"
finish
