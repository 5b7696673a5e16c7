#!/bin/sh
# Landmark goals of the command line: alone, beside a target, hard; the start, the report, the log, and what is refused.
# SPDX-License-Identifier: MIT
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
blob 12 30 20 60 0.05 >bone.ply
"$tool" convert bone.ply obj bone.obj

# Every 15th vertex, and where it goes: a quarter turn about z, 100 mm along x, and a bend along z.
awk '$1 == "v" && ++n % 15 == 1 { printf "p%d,%s,%s,%s\n", n, $2, $3, $4 }' bone.obj >model.csv
awk -F, '{ printf "%s,%.4f,%.4f,%.4f\n", $1, 100 - $3, $2 + 0.001 * $4 * $4, $4 }' model.csv >now.csv
awk '$1 == "v" { printf "v %.6f %.6f %.6f\n", 100 - $3, $2 + 0.001 * $4 * $4, $4; next } { print }' bone.obj >target.obj

field() { sed -n "s/^ *\"$1\": \(.*[^,]\),*$/\1/p" out/report.json | head -n 1; }
below() { awk -v a="$1" -v b="$2" 'BEGIN { exit !(a != "" && a < b) }'; }
run() { rm -rf out; "$SMR" register --model bone.ply "$@" -o out --quiet >out.txt 2>err.txt; }

run --landmark-goals model.csv now.csv --log run.log
check "alone: good" [ $? -eq 0 ]
check "the start is fitted to them" [ "$(field start_kind)" = '"landmarks rigid"' ]
check "residuals are in the report" below "$(field residual_max_mm)" 1
check "one for each point" [ "$(grep -c '"residual_mm"' out/report.json)" -gt "$(wc -l <model.csv)" ]
check "a log replays" sh -c "'$SMR' replay run.log --threads 3 | grep -q 'ticks agree'"
run --landmark-goals model.csv now.csv --landmark-weight hard
check "hard: each in its place" below "$(field residual_max_mm)" 0.05
run --landmark-goals model.csv now.csv --align none
check "--align none: no start" [ "$(field start_kind)" = '"none"' ]
run --target target.obj --landmark-goals model.csv now.csv --landmark-weight 2.5
check "beside a target: good" [ $? -eq 0 ]
check "with its weight" [ "$(field weight)" = 2.5 ]
check "the points are there" below "$(field residual_max_mm)" 1
awk -F, 'NR == 2 { printf "%s,%.4f,%.4f,%.4f\n", $1, $2 + 60, $3, $4; next } { print }' now.csv >off.csv
run --landmark-goals model.csv off.csv
check "a point that is far off: not good" [ $? -eq 1 ]

rm -rf out
refused "one file" 'two of them' "$SMR" register --model bone.ply -o out --quiet --landmark-goals model.csv
head -n 3 now.csv >few.csv
refused "too few labels" 'few.csv' "$SMR" register --model bone.ply -o out --quiet --landmark-goals model.csv few.csv
refused "a weight that is none" 'or hard' "$SMR" register --model bone.ply -o out --quiet --landmark-goals model.csv now.csv --landmark-weight soft
refused "a weight out of range" 'or hard' "$SMR" register --model bone.ply -o out --quiet --landmark-goals model.csv now.csv --landmark-weight 0
refused "a weight alone" 'landmark-goals beside' "$SMR" register --model bone.ply -o out --quiet --target target.obj --landmark-weight 2
refused "nothing to go to" 'target' "$SMR" register --model bone.ply -o out --quiet
finish
