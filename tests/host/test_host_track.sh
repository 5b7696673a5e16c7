#!/bin/sh
# smr track: each frame's files and the table, a frame in several files, what is refused, what stays whole.
# SPDX-License-Identifier: MIT
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc

build_tool || { not_ok "the helper compiles"; finish; exit 1; }
tool=$scratch/tool
cd "$scratch" || exit 1
blob 12 30 20 60 0.05 >bone.ply
mkdir frames two
for i in 0 1 2 3; do
    blob 14 33 "$((20 + i))" 60 0.08 >"frames/f$i.ply"
done

status() { "$SMR" "$@" >out.txt 2>err.txt; echo $?; }
# refuses NAME TEXT ARGUMENT...: status 2, one line with the text, and nothing new in "refused".
refuses() {
    refuses_name=$1 refuses_text=$2
    shift 2
    refuses_got=$(status track "$@" -o refused)
    if [ "$refuses_got" -eq 2 ] && [ "$(wc -l <err.txt)" -eq 1 ] && grep -q -- "$refuses_text" err.txt && [ ! -e refused ]; then
        ok "$refuses_name"
    else
        not_ok "$refuses_name"
        echo "#   status $refuses_got: $(head -n 1 err.txt)"
    fi
}

status track --model bone.ply --frames frames/*.ply --fps 10 -o out >status.txt
[ "$(cat status.txt)" -le 3 ] || cat err.txt out.txt
check "follows" [ "$(cat status.txt)" -le 3 ]
check "writes a line for each frame" [ "$(wc -l <out/track.csv)" -eq 5 ]
check "says what is in it" [ "$(head -n 1 out/track.csv)" = "frame,time_s,ticks,residual_mm,verdict,settled,jumped" ]
check "counts the time" grep -q '^f3,0.3000,' out/track.csv
for i in 0 1 2 3; do check "writes frame $i" [ -s "out/f$i/bone.ply" ]; done
check "settles" [ "$(grep -c ',1,0$' out/track.csv)" -eq 4 ]
check "is near" awk -F, 'NR > 1 && $4 > 1 { bad = 1 } END { exit bad }' out/track.csv
check "moves" sh -c '! cmp -s out/f0/bone.ply out/f3/bone.ply'
"$SMR" track --model bone.ply --frames frames/*.ply --fps 10 --threads 3 --quiet -o again >quiet.txt 2>&1
check "is quiet" [ ! -s quiet.txt ]
check "has the same bits with other threads" cmp out/f3/bone.ply again/f3/bone.ply

# A directory is a frame; a structure that it lacks is carried.
cp bone.ply left.ply
sed 's/^\([-0-9.e]*\) /\1 /' bone.ply >right.ply
for i in 0 1; do
    mkdir -p "two/g$i"
    cp "frames/f$i.ply" "two/g$i/left.ply"
    cp "frames/f$i.ply" "two/g$i/right.ply"
done
mkdir two/g2
cp frames/f2.ply two/g2/left.ply
check "follows several structures" [ "$(status track --model left.ply right.ply --frames two/g0 two/g1/ -o pair)" -le 3 ]
check "writes them" [ -s pair/g1/left.ply ]
check "and the other" [ -s pair/g1/right.ply ]

refuses "no frames" "--frames" --model bone.ply
refuses "no model" "--model" --frames frames/f0.ply
refuses "a frame that is not there" "frames/none.ply: frame" --model bone.ply --frames frames/f0.ply frames/none.ply
printf 'ply\n' >broken.ply
refuses "a broken frame, before anything is written" "broken.ply" --model bone.ply --frames frames/f0.ply broken.ply
mkdir empty
refuses "an empty directory" "empty: frame" --model bone.ply --frames empty
refuses "a name twice" "'f0' is there twice" --model bone.ply --frames frames/f0.ply two/../frames/f0.ply
mkdir strange
cp frames/f0.ply strange/bone.ply
cp frames/f0.ply strange/other.ply
refuses "a structure that is not there" "strange/other.ply: name" --model bone.ply --frames frames/f0.ply strange
refuses "no rate" "--fps" --model bone.ply --frames frames/f0.ply --fps 0
finish
