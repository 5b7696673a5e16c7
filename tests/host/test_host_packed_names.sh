#!/bin/sh
# Files that are not packed get no name of a packed one: one line, status 2, and nothing is written. Directories may.
# SPDX-License-Identifier: MIT
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
cd "$scratch" || exit 1
blob 6 30 20 60 0.05 >a.ply
blob 7 31 20 61 0.05 >b.ply
printf 'label,x,y,z\nx,1,2,3\n' >points.csv
"$SMR" register --model a.ply --target b.ply --ticks 2 -o out.gz --quiet
check "a directory of results may be called so" [ -s out.gz/report.json ]
mv out.gz out
mkdir clean && cd clean || exit 1

# refused NAME OPTION WORD...: no file, no directory, one line that names the file.
refused() {
    name=$1
    shift
    "$SMR" "$@" >../said.txt 2>../err.txt
    got=$?
    [ $got -eq 2 ] && [ ! -s ../said.txt ] && [ "$(wc -l <../err.txt)" -eq 1 ] && grep -q "^smr: $name: name: expected" ../err.txt &&
        [ -z "$(ls -A)" ] && return
    echo "status $got; there is $(ls -A | tr '\n' ' '); it said"
    cat ../said.txt ../err.txt
    rm -rf ./*
    return 1
}
register="register --model ../a.ply --target ../b.ply -o out"
for name in t.gz t.csv.gz T.CSV.GZ; do
    check "summary -o $name" refused $name summary ../out -o $name
    check "summary --html $name" refused $name summary ../out --html $name
    check "summary -o t.csv --html $name" refused $name summary ../out -o t.csv --html $name
    for option in --log --trace --save --slicer; do
        # shellcheck disable=SC2086
        check "register $option $name" refused $name $register $option $name
    done
    check "build -o $name" refused $name build --model ../a.ply -o $name
    check "carry -o $name" refused $name carry --result ../out --points ../points.csv -o $name
done
for name in m.smr.gz m.c.gz; do
    check "build -o $name" refused $name build --model ../a.ply -o $name
    check "build -o $name --c-array" refused $name build --model ../a.ply --c-array array -o $name
done
for name in v.gz v.nrrd.gz v.mha.gz; do
    check "field -o $name" refused $name field --result ../out -o $name
    check "warp -o $name" refused $name warp --result ../out --volume ../v.mha -o $name
    check "labels -o $name" refused $name labels ../out --like ../v.mha -o $name
done
check "in the directory of the results" refused out/x.log.gz register --model ../a.ply --target ../b.ply -o out --log out/x.log.gz
check "a directory in the path may" sh -c "mkdir d.gz && '$SMR' build --model ../a.ply -o d.gz/m.smr && [ -s d.gz/m.smr ]"
finish
