#!/bin/sh
# The verdict on a registration: exit status, report.json, the last line for people; the command and the inputs.
# SPDX-License-Identifier: MIT
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
blob 12 30 20 60 0.05 >bone.ply
blob 14 33 19 63 0.08 >target.ply
"$tool" convert target.ply obj target.obj
"$tool" convert bone.ply obj bone.obj

# ends NAME STATUS VERDICT TEXT ARGUMENT...: a registration into "out" with this status, verdict and last line; its files
# are there in each case.
ends() {
    ends_name=$1 ends_status=$2 ends_verdict=$3 ends_text=$4
    shift 4
    rm -rf out
    "$SMR" register "$@" -o out >out.txt 2>err.txt
    ends_got=$?
    ends_found=$(sed -n 's/^  "verdict": "\(.*\)",$/\1/p' out/report.json)
    if [ $ends_got -eq "$ends_status" ] && [ "$ends_found" = "$ends_verdict" ] && tail -n 1 out.txt | grep -q "^verdict: $ends_text"; then
        ok "$ends_name"
    else
        not_ok "$ends_name"
        echo "#   status $ends_got, $ends_found: $(tail -n 1 out.txt) $(head -n 1 err.txt)"
    fi
}
onto="--model bone.ply --target target.ply"
ends "a good run" 0 good "good" $onto
check "has no reason" grep -q '^  "reasons": \[\],$' out/report.json
check "each structure has a verdict" [ "$(grep -c '^      "verdict": "good",$' out/report.json)" -eq 1 ]
ends "--ticks that end first" 4 look "look at the result: --ticks ended first, after [0-9]* % of the schedule" $onto --ticks 2
check "is a reason of the report" grep -q '^    "--ticks ended first' out/report.json
check "leaves its results" [ -s out/bone.ply ]
ends "no verdict makes that done" 4 look "look" $onto --ticks 2 --accept look

# Out of reach.
awk '$1 == "v" { $2 += 900 } { print }' target.obj >far.obj
ends "nothing seen" 1 failed "failed: nothing of the target was seen: no vertex had a goal" --model bone.ply --target far.obj
check "of the structure, too" grep -q '^      "verdict": "failed",$' out/report.json
ends "is not accepted" 1 failed "failed" --model bone.ply --target far.obj --accept look
mkdir two
cp bone.obj two/bone.obj && awk '$1 == "v" { $2 += 200 } { print }' bone.obj >two/other.obj
mkdir goal
cp target.obj goal/bone.obj && cp far.obj goal/other.obj
ends "one structure of two" 3 look "look at the result: no vertex of other had a goal at the end" --model two/*.obj --target goal/*.obj
check "is the one that failed" [ "$(sed -n 's/^      "verdict": "\(.*\)",$/\1/p' out/report.json | tr '\n' ' ')" = "good failed " ]
ends "accepted" 0 look "look" --model two/*.obj --target goal/*.obj --accept look
"$SMR" register $onto --accept all -o none >out.txt 2>err.txt
check "--accept takes good or look" sh -c "[ $? -eq 2 ] && grep -q 'one of good|look' err.txt && [ ! -e none ]"

# Inputs that can hardly be meant.
awk '$1 == "f" { t = $3; $3 = $4; $4 = t } { print }' target.obj >inside.obj
check "a target that is inside out is not good" has_status 1 "$SMR" register --model bone.ply --target inside.obj -o out --quiet
check "and its report says why" grep -q '"the target inside.obj is a closed surface that is inside out"' out/report.json
awk '$1 == "v" { $2 /= 10; $3 /= 10; $4 /= 10 } { print }' target.obj >small.obj
check "nor is a target in centimetres that the start scales to" has_status 3 "$SMR" register --model bone.ply --target small.obj --align similarity -o out --quiet
check "whose units are named" grep -q '"the start makes the model 0.1[01].* times as large: look at the units' out/report.json
awk '$1 == "v" { $2 *= 10; $3 *= 10; $4 *= 10 } { print }' target.obj >large.obj
ends "a target in another unit" 1 failed ".*the target is 10[.0-9]* times as large as the model" --model bone.ply --target large.obj --search 5

# Starts that can be doubted: a body of revolution, but for the pose that it is given in; one that has a handedness.
awk '$1 == "v" { x = $2; $2 = 5 - $3; $3 = x; $4 += 40 } { print }' bone.obj >turned.obj
ends "a start that could be another" 3 look "look at the result: [2-9] clearly different start poses" --model bone.obj --target turned.obj --align rigid
ends "where the files agree they say which" 0 good "good" --model bone.ply --target target.ply --align rigid
awk '$1 == "v" { d = $4 - 40; $3 += 0.004 * $4 * $4; $2 += 15 * exp(-d * d / 400) } { print }' bone.obj >right.obj
ends "a body of one side" 0 good "good" --model right.obj --target right.obj --align rigid
ends "onto one of the other side" 3 look "look at the result: the model's mirror image starts nearer, 0.0 instead of [1-9]" --model right.obj --target right.obj --mirror-target x --align rigid

# A limb of 400 mm that has bent by 60 degrees at a joint.
blob 30 18 28 200 0.05 >limb.ply
"$tool" convert limb.ply obj limb.obj
awk '$1 == "v" {
    z = $4 - 20; t = 0.5 + z / 60; t = t < 0 ? 0 : t > 1 ? 1 : t; a = t * t * (3 - 2 * t) * 60 * 3.14159265 / 180
    x = $2; $2 = x * cos(a) + z * sin(a); $4 = 20 + z * cos(a) - x * sin(a)
} { print }' limb.obj >bent.obj
rm -rf out
"$SMR" register --model limb.obj --target bent.obj --align rigid -o out --quiet 2>err.txt
check "a bent limb starts bent" grep -q '^  "start_kind": "surfaces rigid, articulated",$' out/report.json
check "which is a reason" grep -q '^    "parts of the model have turned about joints' out/report.json
"$tool" convert out/limb.ply obj moved.obj
far=$(paste -d ' ' moved.obj bent.obj | awk '$1 == "v" { s += sqrt(($2 - $6)^2 + ($3 - $7)^2 + ($4 - $8)^2); n++ } END { print s / n }')
check "and its vertices end 5 mm off at most, in the mean ($far)" less "$far" 5

# Landmarks: exchanged, or one far off.
printf 'a,30,0,0\nb,-30,0,0\nc,0,20,0\nd,0,0,60\ne,0,-20,-5\nf,0,3,-60\n' >from.csv
printf 'a,33,1,0\nb,-32,0,0\nc,0,20,0\nd,0,0,63\ne,0,-19,-5\nf,0,3,-63\n' >to.csv
landmarks="$onto --smoothing 0 --landmarks from.csv"
ends "landmarks that agree" 0 good "good" $landmarks to.csv
sed 's/^a,/x,/; s/^d,/a,/; s/^x,/d,/' to.csv >swapped.csv
check "two landmarks exchanged" has_status 1 "$SMR" register $landmarks swapped.csv -o out --quiet
check "are named" grep -q '"landmarks \\"a\\" and \\"d\\" fit far better exchanged' out/report.json
sed 's/^c,0,20,0/c,0,110,0/' to.csv >off.csv
check "a landmark 90 mm off" has_status 1 "$SMR" register $landmarks off.csv -o out --quiet
check "is named, and how far" grep -qE '"landmark \\"c\\" is (8|9)[0-9] mm from where the others put it' out/report.json

# A target without the model's upper end: what it does not show is left out of the distances, but not of those of the
# whole model.
figure() { sed -n "/^  \"$1\": {/,/^  }/p" out/report.json | sed -n "s/^ *\"$2\": \([^,]*\),\{0,1\}$/\1/p" | head -n 1; }
between() { awk -v a="$1" -v b="$2" -v c="$3" 'BEGIN { exit !(b != "" && a <= b && b <= c) }'; }
awk '$1 == "v" { z[++n] = $4; print } $1 == "f" && z[$2 + 0] < 25 && z[$3 + 0] < 25 && z[$4 + 0] < 25 { print }' target.obj >low.obj
ends "a target that lacks an end" 0 good "good" --model bone.ply --target low.obj
whole() { sed -n '/"whole_model_to_target": {/,/}/s/^ *"mean": \([^,]*\),$/\1/p' out/report.json | sed -n "$1p"; }
check "the end is far from it" between 3 "$(whole 1)" 10
check "at the vertices, too" between 3 "$(whole 2)" 10
check "what it shows is near" between 0 "$(figure distance_mm mean)" 0.3
check "and its vertices are" between 0 "$(figure vertex_distance_mm mean)" 0.35
check "as beside the surplus" [ "$(figure overlap_distance_mm mean)" = "$(figure distance_mm mean)" ]
check "a third is surplus" between 0.28 "$(figure overlap_distance_mm surplus)" 0.38
check "and the summary says so" grep -q '^the 6[0-9] % of the model that the target shows: mean 0\.[0-2]' out.txt
check "of the structure, too" [ "$(grep -c '^ *"surplus": 0\.3' out/report.json)" -eq 2 ]
ends "a target that lacks nothing" 0 good "good" $onto
check "has no surplus" [ "$(figure overlap_distance_mm surplus)" = 0 ]
check "nor another distance" [ "$(whole 1)" = "$(figure distance_mm mean)" ]
check "nor a line of its own" sh -c '! grep -q "that the target shows" out.txt'

# The command and the inputs; gzip keeps the same checksum, low byte first.
"$SMR" register $landmarks to.csv -o out --quiet
check "the command is the report's" sh -c "sed -n '/\"command\": \[/,/\]/p' out/report.json | tr -d ' \n' |
    grep -qF '\"command\":[\"smr\",\"register\",\"--model\",\"bone.ply\",\"--target\",\"target.ply\",\"--smoothing\",\"0\",\"--landmarks\",\"from.csv\",\"to.csv\",\"-o\",\"out\",\"--quiet\"]'"
check "the inputs are sorted" [ "$(sed -n 's/^      "path": "\(.*\)",$/\1/p' out/report.json | tr '\n' ' ')" = "bone.ply from.csv target.ply to.csv " ]
for file in bone.ply from.csv; do
    check "$file: bytes" sh -c "grep -A1 '\"path\": \"$file\"' out/report.json | grep -q '\"bytes\": $(wc -c <$file | tr -d ' '),'"
    if command -v gzip >/dev/null 2>&1 && command -v od >/dev/null 2>&1; then
        sum=$(gzip -c $file | tail -c 8 | od -An -tx1 -N4 | awk '{ print $4 $3 $2 $1 }')
        check "$file: CRC-32" sh -c "grep -A2 '\"path\": \"$file\"' out/report.json | grep -q '\"crc32\": \"$sum\"'"
    else
        skip "$file: CRC-32" "needs gzip and od"
    fi
done
if command -v gzip >/dev/null 2>&1; then
    gzip -c bone.ply >packed.ply.gz
    "$SMR" register --model packed.ply.gz --target target.ply -o out --quiet
    check "a packed file counts as it lies on the disk" grep -q "\"bytes\": $(wc -c <packed.ply.gz | tr -d ' ')," out/report.json
else
    skip "a packed file" "no gzip"
fi
finish
