#!/bin/sh
# Files that are not packed get no name of a packed one: one line, status 2, and nothing is written. Directories may.
# SPDX-License-Identifier: MIT
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
blob 6 30 20 60 0.05 >a.ply
blob 7 31 20 61 0.05 >b.ply
printf 'label,x,y,z\nx,1,2,3\n' >points.csv
"$SMR" register --model a.ply --target b.ply --ticks 2 -o out.gz --quiet
check "a directory of results may be called so" [ -s out.gz/report.json ]
mv out.gz out
mkdir clean && cd clean || exit 1

register="register --model ../a.ply --target ../b.ply -o out"
for name in t.gz t.csv.gz T.CSV.GZ; do
    by_place "summary -o $name" $name name "$SMR" summary ../out -o $name
    by_place "summary --html $name" $name name "$SMR" summary ../out --html $name
    by_place "summary -o t.csv --html $name" $name name "$SMR" summary ../out -o t.csv --html $name
    for option in --log --trace --save --slicer; do
        # shellcheck disable=SC2086
        by_place "register $option $name" $name name "$SMR" $register $option $name
    done
    by_place "build -o $name" $name name "$SMR" build --model ../a.ply -o $name
    by_place "carry -o $name" $name name "$SMR" carry --result ../out --points ../points.csv -o $name
done
for name in m.smr.gz m.c.gz; do
    by_place "build -o $name" $name name "$SMR" build --model ../a.ply -o $name
    by_place "build -o $name --c-array" $name name "$SMR" build --model ../a.ply --c-array array -o $name
done
for name in v.gz v.nrrd.gz v.mha.gz; do
    by_place "field -o $name" $name name "$SMR" field --result ../out -o $name
    by_place "warp -o $name" $name name "$SMR" warp --result ../out --volume ../v.mha -o $name
    by_place "labels -o $name" $name name "$SMR" labels ../out --like ../v.mha -o $name
done
by_place "in the directory of the results" out/x.log.gz name "$SMR" register --model ../a.ply --target ../b.ply -o out --log out/x.log.gz
check "a directory in the path may" sh -c "mkdir d.gz && '$SMR' build --model ../a.ply -o d.gz/m.smr && [ -s d.gz/m.smr ]"
finish
