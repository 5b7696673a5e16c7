#!/bin/sh
# Kept volumes and smoothing of the command line: the report, the log, and what is refused.
# SPDX-License-Identifier: MIT
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
blob 12 30 20 60 0.05 >bone.ply
"$tool" convert bone.ply obj bone.obj
awk '$1 == "v" { printf "v %.6f %.6f %.6f\n", 1.04 * $2, 1.04 * $3, 1.04 * $4; next } { print }' bone.obj >target.obj
awk '$1 == "f" && ++n < 3 { next } { print }' bone.obj >open.obj

# Of the structure: the verdict's measures have a volume_ratio, too, and come first.
of() { sed -n "s/^ *\"$1\": \([^,]*\),\{0,1\}\$/\1/p" out/report.json | tail -1; }
near() { awk -v a="$1" -v b="$2" 'BEGIN { exit !(a != "" && a - b < 0.005 && b - a < 0.005) }'; }
run() { rm -rf out; "$SMR" register --model "$model" --target target.obj "$@" -o out --quiet >out.txt 2>err.txt; }

model=bone.ply
run
check "off: the report has the volume" near "$(of volume_ratio)" 1.125
check "off: nothing is asked" [ "$(of volume_ratio_asked)" = null ]
run --volume --log run.log
check "--volume: as at rest" near "$(of volume_ratio)" 1
check "a log replays" sh -c "'$SMR' replay run.log --threads 3 | grep -q 'ticks agree'"
run --volume-ratio bone=1.1 --smooth 0.3 --log run.log
check "--volume-ratio: what is asked" near "$(of volume_ratio)" 1.1
check "and is in the report" near "$(of volume_ratio_asked)" 1.1
check "its log replays" sh -c "'$SMR' replay run.log --threads 2 | grep -q 'ticks agree'"
run --volume-ratio bone=0.9 --ticks 3 --save stop.sav
run --volume-ratio bone=0.9 --resume stop.sav
check "stopped on the way and resumed" near "$(of volume_ratio)" 0.9
# Frames are followed alike.
volume() { awk '$1 == "v" { x[++n] = $2; y[n] = $3; z[n] = $4 } $1 == "f" { a = $2 + 0; b = $3 + 0; c = $4 + 0
    v += x[a] * (y[b] * z[c] - z[b] * y[c]) + y[a] * (z[b] * x[c] - x[b] * z[c]) + z[a] * (x[b] * y[c] - y[b] * x[c]) }
    END { print v / 6 }' "$1"; }
awk '$1 == "v" { $2 += 1 } { print }' target.obj >next.obj
"$SMR" track --model bone.obj --frames target.obj next.obj --volume-ratio bone=1.05 --format obj --accept look --quiet -o frames
ratio=$(awk -v a="$(volume frames/next/bone.obj)" -v b="$(volume bone.obj)" 'BEGIN { print a / b }')
check "frames keep what is asked ($ratio)" near "$ratio" 1.05
model=open.obj
run --volume
check "open: none" [ "$(of volume_rest_mm3)" = null ]

rm -rf out
refused "a ratio of an open structure" 'closed' "$SMR" register --model open.obj --target target.obj -o out --quiet --volume-ratio open=1.1
refused "an unknown structure" 'name of a structure' "$SMR" register --model open.obj --target target.obj -o out --quiet --volume-ratio femur=1.1
refused "no ratio" 'NAME=R' "$SMR" register --model open.obj --target target.obj -o out --quiet --volume-ratio open
refused "a ratio that is none" 'NAME=R' "$SMR" register --model open.obj --target target.obj -o out --quiet --volume-ratio open=big
refused "a ratio out of range" 'NAME=R' "$SMR" register --model open.obj --target target.obj -o out --quiet --volume-ratio open=0.01
refused "two ratios of one structure" 'one ratio for each' "$SMR" register --model open.obj --target target.obj -o out --quiet --volume-ratio open=1.1 open=1.2
refused "too much smoothing" 'smooth' "$SMR" register --model open.obj --target target.obj -o out --quiet --smooth 1.5
finish
