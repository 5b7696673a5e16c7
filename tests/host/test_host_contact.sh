#!/bin/sh
# Structures that keep apart: --contact and --contact-with, the report's figures with the force on and off, the log, a
# save, and what is refused.
# SPDX-License-Identifier: MIT
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
mkdir model target || exit 1
blob 14 24 20 40 0 >blob.ply
"$tool" convert blob.ply obj blob.obj

# blob.obj moved along x.
moved() { awk -v by="$1" '$1 == "v" { printf "v %.6f %s %s\n", $2 + by, $3, $4; next } { print }' blob.obj; }
wide=$(awk '$1 == "v" { if (n++ == 0 || $2 < lo) lo = $2; if (n == 1 || $2 > hi) hi = $2 }
            END { printf "%.3f", hi - lo }' blob.obj)
by() { awk -v w="$wide" -v less="$1" 'BEGIN { print w - less }'; }
for way in model target; do
    moved 0 >"$way/left.obj"
    moved "$(by 3)" >"$way/right.obj"
done
moved "-$(by 2)" >wall.obj

# The first of these is of the whole.
field() { sed -n '/"contact": {/,$p' out/report.json | sed -n "s/^ *\"$1\": \(.*[^,]\),*$/\1/p" | head -n 1; }
below() { awk -v a="$1" -v b="$2" 'BEGIN { exit !(a != "" && a + 0 < b) }'; }
run() {
    rm -rf out
    "$SMR" register --model model/left.obj model/right.obj --target target/left.obj target/right.obj --align none "$@" \
        -o out --quiet >out.txt 2>err.txt
}

run
off=$(field volume_mm3)
check "off: the overlap is measured" below 50 "$off"
check "off: and said to be" [ "$(field on)" = false ]
check "off: 3 mm deep" below 2 "$(field deepest_mm)"
check "the pair by its names" sh -c "grep -q '\"a\": \"left\"' out/report.json && grep -q '\"b\": \"right\"' out/report.json"
run --contact --log run.log
check "on: nearly nothing of it is left" below "$(field volume_mm3)" "$(awk -v v="$off" 'BEGIN { print v / 10 }')"
check "on: nor of its depth" below "$(field deepest_mm)" 0.5
check "on: they touch" below 10 "$(field area_mm2)"
check "on" [ "$(field on)" = true ]
check "a log replays" sh -c "'$SMR' replay run.log --threads 3 | grep -q 'ticks agree'"
run --contact-with wall.obj --log wall.log
check "a fixed surface is in the report" grep -q '"b": "wall"' out/report.json
check "and nothing is in it" below "$(field deepest_mm)" 0.5
check "with it a log replays" sh -c "'$SMR' replay wall.log --threads 3 | grep -q 'ticks agree'"
cp out/left.ply whole.ply
run --contact-with wall.obj --ticks 20 --save half.sav
run --contact-with wall.obj --resume half.sav
check "saved and resumed: the same" cmp -s whole.ply out/left.ply
run --contact-with blob.ply --resume half.sav
check "another fixed surface is refused" [ $? -eq 2 ]
run --contact --contact-mm 1
check "a distance is kept" below "$(field volume_mm3)" 1

# What contact cannot part is no good result; what lies in another by design is.
judged() { # STATUS MODEL OPTION...: a registration onto itself; its last line stays in out.txt
    judged_status=$1 judged_model=$2
    shift 2
    rm -rf out
    # shellcheck disable=SC2086
    "$SMR" register --model $judged_model --target $judged_model --align none "$@" -o out >out.txt 2>err.txt
    [ $? -eq "$judged_status" ] || { tail -n 1 out.txt err.txt; return 1; }
}
blob 24 60 8 8 0 >stem.ply
blob 14 10 9 25 0 >marrow.ply
cp blob.ply bone.ply
check "a stem through a bone" judged 3 bone.ply --contact-with stem.ply --html
reason='bone and stem, which contact should part, overlap by [2-9][.][0-9] mm'
check "is the last line" sh -c "tail -n 1 out.txt | grep -q '^verdict: look at the result: $reason'"
check "in the report" [ "$(grep -cE "^    \"$reason\",?\$" out/report.json)" -eq 1 ]
check "the bone's" grep -qE '^ +"still [2-9][.][0-9] mm deep in contact with stem",?$' out/report.json
check "on the page" grep -q "$reason" out/report.html
check "its target lies there, too" [ "$(grep -cE '^ +"the target of bone lies [2-9][.][0-9] mm deep in stem: contact keeps' out/report.json)" -eq 1 ]
check "the bone's target" grep -qE '^ +"its target lies [2-9][.][0-9] mm deep in stem, which contact keeps it out of",?$' out/report.json
"$SMR" summary out -o table.csv --quiet
check "in the table" grep -q ",look,.*$reason" table.csv
check "accepted" judged 0 bone.ply --contact-with stem.ply --accept look
check "nobody asked for it" judged 0 "bone.ply stem.ply"
check "marrow in a bone" judged 0 "bone.ply marrow.ply" --contact --contact-mm 1
check "deep, by design" below 10 "$(field deepest_mm)"
check "a stem as a structure" judged 3 "bone.ply stem.ply" --contact
check "both are to look at" [ "$(grep -cE '^ +"still [0-9.]+ mm deep in contact with (bone|stem)",?$' out/report.json)" -eq 2 ]
# Frames are followed alike.
mkdir next
for part in left right; do awk '$1 == "v" { $2 += 2 } { print }' target/$part.obj >next/$part.obj; done
awk '$1 == "v" { $2 += 1 } { print }' wall.obj >near.obj
follow() { "$SMR" track --model model/left.obj model/right.obj --frames target next --quiet -o "$@"; }
depth() { "$SMR" measure "$1" "$2" | sed -n 's/^contact: deepest \([0-9.]*\) mm .*/\1/p'; }
check "surfaces of one body have no contact" [ -z "$(depth bone.ply bone.ply)" ]
check "a body inside another one has" [ -n "$(depth bone.ply marrow.ply)" ]
check "frames" has_verdict look follow loose
check "overlap" below 2 "$(depth loose/next/left.ply loose/next/right.ply)"
check "frames with contact" has_verdict look follow apart --contact --contact-with near.obj --track-ahead 0.5
for frame in target next; do check "do not: $frame" below "$(depth apart/$frame/left.ply apart/$frame/right.ply)" 0.5; done
check "nor with what is fixed" below "$(depth apart/target/left.ply near.obj)" 0.5
follow pierced --contact-with stem.ply --html >out.txt 2>err.txt
check "frames with a stem through them" [ $? -eq 3 ]
check "are all to look at" [ "$(cut -d, -f5 pierced/track.csv | tr '\n' ' ')" = "verdict look look " ]
check "for that" grep -q 'surfaces that contact should part overlap by [2-9]' pierced/report.html
check "and without the force are not" has_verdict good follow loose --accept good
check "which they did" below 1 "$(depth loose/target/left.ply near.obj)"

run --contact-with nothing.obj
check "a file that is not there is refused" [ $? -eq 2 ]
printf '1,2,3\n' >points.csv
run --contact-with points.csv
check "points are refused" [ $? -eq 2 ]
check "one structure alone is refused" sh -c "'$SMR' register --model bone.ply --target bone.ply --contact -o none 2>err.txt;
    [ \$? -eq 2 ] && [ ! -e none ] && grep -q '^smr: --contact: option: expected a model of several' err.txt"
run --contact-mm 1
check "a distance between what may meet is refused" [ $? -eq 2 ]
awk '$1 == "f" { print $1, $3, $2, $4; next } { print }' wall.obj >inwards.obj
run --contact-with inwards.obj
check "a surface that looks inwards is refused" sh -c "[ $? -eq 2 ] && grep -q 'inwards.obj: faces' err.txt"
run --contact --contact-mm -1
check "a negative distance is refused" [ $? -eq 2 ]
finish
