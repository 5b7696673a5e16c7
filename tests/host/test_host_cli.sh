#!/bin/sh
# The commands on small computed surfaces: results, reports, exit status, names, legal oddities.
# SPDX-License-Identifier: MIT
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
blob 12 30 20 60 0.05 >bone.ply
blob 14 33 19 63 0.08 >target.ply
"$tool" convert bone.ply ply bone_binary.ply

# The mean of a line of smr measure.
mean() { "$SMR" measure "$1" "$2" | sed -n "s/^$3: mean \([0-9.]*\).*/\1/p"; }

check "--help" has_status 0 "$SMR" --help
check "--help names every command" sh -c "for c in register build info measure; do grep -q \"smr \$c\" out.txt || exit 1; done"
check "--version" has_status 0 "$SMR" --version
check "--version prints one line" [ "$(wc -l <out.txt)" -eq 1 ]

check "register" has_status 0 "$SMR" register --model bone_binary.ply --target target.ply -o out
check "nothing on the error stream when it is no terminal" [ ! -s err.txt ]
check "a summary of at most 8 lines" [ "$(wc -l <out.txt)" -le 8 ]
check "the directory holds the results and nothing else" [ "$(ls -A out | tr '\n' ' ')" = "bone_binary.ply carry.bin report.json " ]
check "the result's comment says SPACE=LPS" grep -qa "comment SPACE=LPS" out/bone_binary.ply
"$tool" convert out/bone_binary.ply obj result.obj
"$tool" convert bone.ply obj source.obj
check "same number of vertices" [ "$(grep -c ^v result.obj)" = "$(grep -c ^v source.obj)" ]
grep ^f result.obj >result.f
grep ^f source.obj >source.f
check "same triangles in the same order" cmp result.f source.f
for key in version structures vertices clusters indexes_per_cluster indexes_per_cluster_direct ticks converged threads \
    method radius_mm time_s prepare start register tick_ms min median p99 max budget_ms overruns memory_bytes model \
    arena volume verdict reasons probability expected_error_mm command inputs path bytes crc32 distance_mm vertex_distance_mm model_to_target target_to_model mean rms p95 folds folds_deepest_mm state_hash; do
    grep -q "\"$key\":" out/report.json || echo "$key" >>missing.txt
done
check "report.json has every promised key" [ ! -e missing.txt ]
check "the hash has 16 hex digits" sh -c "grep -qE '\"state_hash\": \"[0-9a-f]{16}\"' out/report.json"
if command -v python3 >/dev/null 2>&1; then
    check "report.json is JSON" python3 -c "import json; json.load(open('out/report.json'))"
else
    skip "report.json is JSON" "no python3"
fi
check "closer than before" less "$(value out/report.json mean)" "$(mean bone.ply target.ply 'A to B')"
check "the report agrees with smr measure" sh -c "
    awk -v a='$(value out/report.json mean)' -v b='$(mean out/bone_binary.ply target.ply 'A to B')' 'BEGIN { d = a - b; exit !(d < 0.001 && d > -0.001) }'"

check "again into the same directory" has_status 0 "$SMR" register --model bone_binary.ply --target target.ply -o out2 --quiet
check "--quiet prints nothing" sh -c "[ ! -s out.txt ] && [ ! -s err.txt ]"
check "the same bytes" cmp out/bone_binary.ply out2/bone_binary.ply
check "over old results" has_status 0 "$SMR" register --model bone_binary.ply --target target.ply -o out2 --quiet
hash=$(value out/report.json state_hash)
for threads in 1 2 3 4 8; do
    "$SMR" register --model bone_binary.ply --target target.ply -o threads --quiet --threads $threads
    check "$threads threads: the same state" [ "$(value threads/report.json state_hash)" = "$hash" ]
done
check "--ticks 1 ends with status 4" has_status 4 "$SMR" register --model bone.ply --target target.ply -o one --ticks 1
check "and writes its results" [ -s one/bone.ply ]
check "and says so" [ "$(value one/report.json converged)" = false ]
# A target out of reach: the schedule comes to its end, but nothing was registered.
awk '/^end_header/ { behind = 1; print; next } behind && NF == 3 { $1 += 900 } { print }' target.ply >far.ply
check "a target that is never seen ends with status 1" has_status 1 "$SMR" register --model bone.ply --target far.ply -o far
check "and says so in the last line" sh -c "tail -n 1 out.txt | grep -q '^verdict: failed: nothing of the target was seen: '"
check "and in the report" [ "$(value far/report.json converged) $(value far/report.json settled) $(value far/report.json target_seen)" = "false false false" ]
check "its results are there, the model as it was" [ -s far/bone.ply ]
check "one that is seen is" [ "$(value out/report.json converged) $(value out/report.json target_seen)" = "true true" ]
check "a deeper directory is made" has_status 0 "$SMR" register --model bone.ply --target target.ply -o deep/er/out --quiet
check "a budget" has_status 0 "$SMR" register --model bone.ply --target target.ply -o budget --quiet --budget-ms 1
check "polar" has_status 0 "$SMR" register --model bone.ply --target target.ply -o polar --quiet --method polar
check "all that the library takes" has_status 4 "$SMR" register --model bone.ply --target target.ply -o ranges --quiet --ticks 2 --reject-deviations 1000000 --plastic-um 1e8
check "--help has the sentences of the library's table" sh -c "\"$SMR\" --help | grep -q 'plastic-every N .*many iterations; 0: only at rest'"
check "several radii" has_status 0 "$SMR" register --model bone.ply --target target.ply -o radii --quiet --radius 60,30,15 --clusters shared
check "they are the report's" [ "$(grep -c radius_mm radii/report.json)" -ge 1 ]
check "separate clusters" has_status 0 "$SMR" info bone.ply target.ply --radius 99999,30 --clusters separate
check "all of them" [ "$(grep -c ' separate ' out.txt)" = 2 ]

# A model image gives what its surfaces give.
check "build" has_status 0 "$SMR" build --model bone_binary.ply -o bone.smr
check "register with a .smr" has_status 0 "$SMR" register --model bone.smr --target target.ply -o image --quiet
check "the same state" [ "$(value image/report.json state_hash)" = "$hash" ]
check "the file carries the structure's name" [ -s image/bone_binary.ply ]
check "prepare options with a .smr are refused" has_status 2 "$SMR" register --model bone.smr --target target.ply -o image --radius 10
check "info of a .smr" has_status 0 "$SMR" info bone.smr
check "info names vertices and indexes per cluster" grep -q "indexes per cluster" out.txt
check "info of surfaces" has_status 0 "$SMR" info bone.ply target.ply --radius 30
check "--c-array beside the image" has_status 0 "$SMR" build --model bone_binary.ply -o carray.smr --c-array bone_model
check "the same image" cmp carray.smr bone.smr
printf '#include <stdio.h>\n#include "carray.h"\nint main(void) { return fwrite(bone_model, 1, sizeof bone_model, stdout) != bone_model_bytes; }\n' >dump.c
check "the C array compiles" "$CC" -std=c11 -Wall -Wextra -Werror dump.c carray.c -o dump
check "and holds the image" sh -c "./dump | cmp - bone.smr"
check "--c-array alone" has_status 0 "$SMR" build --model bone_binary.ply -o alone.c --c-array bone_model
check "gives the same source and sizes" sh -c 'cmp alone.c carray.c && cmp alone.h carray.h'
check "which are the model's" grep -q "define bone_model_VERTICES $(grep -a '^element vertex' bone_binary.ply | tr -cd 0-9)u" alone.h
check "a name that is no identifier" has_status 2 "$SMR" build --model bone_binary.ply -o x.c --c-array 7up
check "a name that is C's own" has_status 2 "$SMR" build --model bone_binary.ply -o x.c --c-array while
check "C source without a name" has_status 2 "$SMR" build --model bone_binary.ply -o x.c
check "neither leaves a file" test ! -e x.c
for cut in 1 40 300 -1; do
    if [ $cut -gt 0 ]; then head -c $cut bone.smr >cut.smr; else head -c $(($(wc -c <bone.smr) - 1)) bone.smr >cut.smr; fi
    check "image cut ($cut) is refused" has_status 2 "$SMR" info cut.smr
done

# Mirroring: a mirrored copy comes back.
"$tool" convert bone.ply obj bone.obj
awk '$1 == "v" { $2 = -$2 } $1 == "f" { t = $3; $3 = $4; $4 = t } { print }' bone.obj >mirrored.obj
check "--mirror-target x" has_status 0 "$SMR" register --model bone.obj --target mirrored.obj -o mirror --mirror-target x --quiet
check "nothing had to move" less "$(value mirror/report.json hausdorff_mm)" 0.05
awk '$1 == "v" { $4 = -$4 } $1 == "f" { t = $3; $3 = $4; $4 = t } { print }' bone.obj >down.obj
check "--mirror-model z" has_status 0 "$SMR" register --model bone.obj --target down.obj -o mirror --mirror-model z --quiet
check "nothing had to move then" less "$(value mirror/report.json hausdorff_mm)" 0.05

# Names: several structures and targets.
shift_x() { awk -v d="$2" '$1 == "v" { $2 += d } { print }' "$1"; }
mkdir m t
for i in 0 1 2; do
    shift_x bone.obj $((i * 80)) >m/part$i.obj
    [ $i -eq 2 ] || shift_x bone.obj $((i * 80 + 1)) >t/part$i.obj
done
shift_x bone.obj 500 >t/stranger.obj
check "three structures, two targets" has_status 0 "$SMR" register --model m/*.obj --target t/*.obj -o named
check "the one without a target is said to be carried" grep -q "carried along.*part2" out.txt
check "the target without a structure is named" grep -q "stranger" out.txt
check "every structure has its file" [ "$(ls named | tr '\n' ' ')" = "carry.bin part0.ply part1.ply part2.ply report.json " ]
check "the report says so too" [ "$(grep -c '"carried": true' named/report.json)" -eq 1 ]
check "one target serves all, of which two that lie beside it see nothing" has_status 1 "$SMR" register --model m/*.obj --target target.ply -o served --quiet
check "none is carried" [ "$(grep -c '"carried": true' served/report.json)" -eq 0 ]
for mode in rigid similarity; do
    check "--align $mode" has_status 3 "$SMR" register --model bone.obj --target t/stranger.obj -o "align_$mode" --align $mode --quiet
    check "--align $mode says that either end may be up" grep -q "clearly different start poses" "align_$mode/report.json"
    check "--align $mode finds it" less "$(value align_$mode/report.json hausdorff_mm)" 0.5
done
check "--align with several" has_status 0 "$SMR" register --model m/*.obj --target t/*.obj -o aligned --align rigid --quiet --accept look

# Points as a structure of the model: carried, and written as points again.
awk '$1 == "v" && n++ % 3 == 0 { print "v", 0.8 * $2, 0.8 * $3, 0.8 * $4 }' bone.obj >marks.obj
check "points beside a surface" has_status 0 "$SMR" register --model bone.obj marks.obj --target target.ply -o marks
check "are carried along" grep -q "^carried along without a target: marks" out.txt
check "the report says so" sh -c "grep -A4 '\"name\": \"marks\"' marks/report.json | tr -d ' \n' | grep -q '\"triangles\":0,\"has_target\":false,\"carried\":true'"
check "as many points" grep -qa "^element vertex $(grep -c ^v marks.obj)\$" marks/marks.ply
check "without faces" grep -qa '^element face 0$' marks/marks.ply
check "they have moved" sh -c "! '$tool' compare marks/marks.ply marks.obj >/dev/null 2>\&1"
check "to the same depth" sh -c "awk -v a=$(mean marks/marks.ply target.ply 'A to B') -v b=$(mean marks.obj bone.obj 'A to B') 'BEGIN { exit !(a > 0.85 * b && a < 1.2 * b) }'"
check "onto several targets, too" has_status 0 "$SMR" register --model m/part0.obj m/part1.obj marks.obj --target t/part0.obj t/part1.obj -o marks2 --quiet
check "with --align" has_status 0 "$SMR" register --model bone.obj marks.obj --target t/stranger.obj --align rigid -o marks3 --quiet --accept look
check "a .smr of both" has_status 0 "$SMR" build --model bone.obj marks.obj -o marks.smr --quiet
check "gives the same" sh -c "'$SMR' register --model marks.smr --target target.ply -o marks4 --quiet; cmp marks/marks.ply marks4/marks.ply"
check "points alone are refused" has_status 2 "$SMR" register --model marks.obj --target target.ply -o none
check "for their faces" grep -q "^smr: marks.obj: faces: " err.txt
check "as a target they are a cloud" has_status 0 "$SMR" register --model bone.obj --target marks.obj -o cloud --quiet --accept look

# File names with anything in them.
odd_name=$(printf 'q"\\ \303\274\377 #')
cp bone.ply "$odd_name.ply"
check "a strange file name" has_status 0 "$SMR" register --model "$odd_name.ply" --target target.ply -o strange --quiet
check "its result" [ -s "strange/$odd_name.ply" ]
if command -v python3 >/dev/null 2>&1; then
    check "its report is JSON" python3 -c "import json; json.load(open('strange/report.json', encoding='utf-8'))"
else
    skip "its report is JSON" "no python3"
fi

# The progress line: only on a terminal.
if script -qec true /dev/null >/dev/null 2>&1; then
    script -qec "'$SMR' register --model bone.ply --target target.ply -o slow --slide 1 --even 0 --iterations-last 20000 --ticks 3000" \
        /dev/null >progress.txt 2>&1 </dev/null
    check "progress on a terminal: iteration, residual, time left" grep -qE "iteration [0-9]+  residual [0-9.]+ mm  [0-9.]+ s left" progress.txt
else
    skip "progress on a terminal" "no script command"
fi
check "none when piped" has_status 4 "$SMR" register --model bone.ply --target target.ply -o slow --slide 1 --even 0 --iterations-last 20000 --ticks 50
check "the error stream stays empty" [ ! -s err.txt ]

# Legal oddities: all of them in one surface.
awk '{ print } $1 == "v" && !n++ { keep = $0 }
    END { print "v 5 5 5"; print keep; print "v 0 0 100"; print "v 3 0 100"; print "v 0 3 100"; print "v 0 3 103"
          print "f 300 301 1"; print "f 1 2 2"; print "f 1 1 1"; print "f 1 2 5"; print "f 1 2 7"; print "f 1 2 9" }' \
    bone.obj >odd.tmp
n=$(grep -c ^v bone.obj)
sed "s/^f 300 301 1\$/f $((n + 3)) $((n + 4)) $((n + 5))/" odd.tmp >odd.obj
echo "f $((n + 3)) $((n + 5)) $((n + 6))" >>odd.obj
check "isolated, duplicate, zero-area, non-manifold, several components: as model" has_status 0 "$SMR" register --model odd.obj --target target.ply -o odd --quiet
check "as target" has_status 0 "$SMR" register --model bone.obj --target odd.obj -o odd2 --quiet
check "with --align" has_status 0 "$SMR" register --model odd.obj --target odd.obj -o odd3 --align similarity --quiet
check "measured" has_status 0 "$SMR" measure odd.obj target.ply
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >one.obj
printf 'v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n' >point.obj
check "a single triangle, of which no error can be expected" has_status 3 "$SMR" register --model one.obj --target one.obj -o tiny --quiet
check "a triangle without area, of which nothing is seen" has_status 1 "$SMR" register --model point.obj --target one.obj -o tiny2 --quiet
check "onto it" has_status 1 "$SMR" register --model one.obj --target point.obj -o tiny3 --quiet

# smr measure against known numbers: two squares 2 mm apart, one larger by 3 mm on one side.
square='v 0 0 %s\nv %s 0 %s\nv %s 10 %s\nv 0 10 %s\nf 1 2 3\nf 1 3 4\n'
printf "$square" 0 10 0 10 0 0 >a.obj
printf "$square" 2 13 2 13 2 2 >b.obj
check "measure" has_status 0 "$SMR" measure a.obj b.obj
check "A to B: 2 mm everywhere" grep -q "^A to B: mean 2.0000  rms 2.0000  p95 2.0000  max 2.0000" out.txt
check "B to A: half of the vertices sqrt(13)" grep -q "^B to A, vertices: mean 2.8028 .* max 3.6056 mm  (4 vertices)" out.txt
# 27/60 at centroids, 8/60 at midpoints, 3/60 at corners: of two triangles of 65 mm^2 the means are 2.374628 and 2.080278
check "B to A over the area" grep -q "^B to A: mean 2.2275 .* max 3.6056 mm  (over the area)" out.txt
check "Hausdorff" grep -q "^Hausdorff: 3.6056" out.txt
printf 'v 0 0 0\nv 10 0 0\nv 10 10 0\nv 9 1 0.1\nf 1 2 3\nf 1 3 4\n' >fold.obj
check "measure --source" has_status 0 "$SMR" measure fold.obj b.obj --source a.obj
check "one fold" grep -q "^folds: 1 " out.txt
check "a fold of the source does not count" sh -c "'$SMR' measure fold.obj b.obj --source fold.obj | grep -q '^folds: 0  (edges turned back in A: 1)'"
check "a source of another size is refused" has_status 2 "$SMR" measure fold.obj b.obj --source bone.obj
grep ^v b.obj >points.obj
check "points to a surface" has_status 0 "$SMR" measure points.obj a.obj
check "one direction only, over the points" [ "$(grep -c ' to ' out.txt) $(grep -c '^A to B: mean 2.8028 .* (4 points)' out.txt)" = "1 1" ]
check "points to points are refused" has_status 2 "$SMR" measure points.obj points.obj

check "the checks can fail" sh -c "! '$SMR' measure none.obj a.obj 2>/dev/null"
# Results never replace an input.
mkdir keep && cp bone.ply keep/bone.ply 2>/dev/null || cp "$(ls *.ply | head -n 1)" keep/bone.ply
sum=$(cksum <keep/bone.ply)
check "an input is not overwritten by its result" has_status 2 $SMR register --model keep/bone.ply --target keep/bone.ply -o keep
check "nor by an image" has_status 2 $SMR build --model keep/bone.ply -o keep/bone.ply
check "it is as it was" [ "$sum" = "$(cksum <keep/bone.ply)" ]
finish
