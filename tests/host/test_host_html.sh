#!/bin/sh
# The page of a report: --html writes one file of bounded size, which no name can break.
# SPDX-License-Identifier: MIT
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
blob 12 30 20 60 0.05 >bone.ply
blob 14 33 19 63 0.08 >target.ply
# page NAME FILE: what holds for each page: whole, bounded, two scripts and none of the data's.
page() {
    check "$1: a whole page" sh -c "head -n 1 '$2' | grep -q '^<!doctype html>\$' && tail -n 1 '$2' | grep -q '^</html>\$'"
    check "$1: at most 15 MB" [ "$(wc -c <"$2")" -le 15000000 ]
    check "$1: two scripts" [ "$(grep -o '<script' "$2" | wc -l) $(grep -o '</script>' "$2" | wc -l)" = "2 2" ]
    check "$1: no network" [ -z "$(grep -oE '(src|href)="?[a-z]+:|url\(|fetch\(|XMLHttp|@import' "$2")" ]
    check "$1: all parts are in it" sh -c "! grep -qE '^@(include|data)' '$2'"
}

onto="--model bone.ply --target target.ply --threads 2 --quiet"
"$SMR" register $onto -o plain
check "no page without --html" [ ! -e plain/report.html ]
check "a page with it" "$SMR" register $onto --html -o out
page "a surface" out/report.html
check "changes no bit" [ "$(value plain/report.json state_hash)" = "$(value out/report.json state_hash)" ]
check "and no result" cmp plain/bone.ply out/bone.ply
check "has the report's figures" grep -q "\"state_hash\":\"$(value out/report.json state_hash)\"" out/report.html
check "a row for each iteration" [ "$(grep -o '"iteration":' out/report.html | wc -l)" -eq "$(value out/report.json iterations)" ]
check "nothing is left over" [ -z "$(find . -name '*.tmp')" ]

# The result's places, decoded from the page, are those of the result's file to half a step and a rounding: the second
# frame's. Places come as {low, high, at}.
"$tool" convert out/bone.ply obj result.obj
grep -o '"places":\[{[^}]*}' out/report.html | sed -n 2p >place.json
sed 's/.*"at":"//; s/".*//' place.json | base64 -d >places.bin
{
    sed 's/.*"low":\[\([^]]*\)\],"high":\[\([^]]*\)\].*/box,\1,\2/' place.json
    od -An -v -tu2 -w6 places.bin | sed 's/^ */q,/; s/  */,/g'
    sed -n 's/^v /v,/p' result.obj | tr ' ' ','
} | awk -F, '
    $1 == "box" { for (c = 1; c <= 3; c++) { low[c] = $(c + 1); high[c] = $(c + 4) } }
    $1 == "q" { n++; for (c = 1; c <= 3; c++) q[n, c] = low[c] + $(c + 1) / 65535 * (high[c] - low[c]) }
    $1 == "v" { m++; for (c = 1; c <= 3; c++) { d = $(c + 1) - q[m, c]; if (d < 0) d = -d; if (d > worst) worst = d } }
    END { print n, m, worst; exit !(n > 200 && n == m && worst < 0.002) }' >places.txt
check "has the result's places ($(cat places.txt))" awk '{ exit !($1 > 200 && $1 == $2 && $3 < 0.002) }' places.txt

# Hostile names: of files, of folders, and bytes that are no UTF-8.
mkdir -p 'a</script><script>alert(1)<'
odd=$(printf 'x<!--<script>"\\&'"'"'\303\251\377')
cp bone.ply "a</script><script>alert(1)</$odd.ply"
check "hostile names" "$SMR" register --model "a</script><script>alert(1)</$odd.ply" --target target.ply --quiet --html -o odd
page "hostile names" odd/report.html
check "are there, escaped" grep -qF 'a\u003c/script>\u003cscript>alert(1)\u003c/x\u003c!--\u003cscript>\"\\&'"'"'é?' odd/report.html
check "and nowhere else" sh -c "! grep -q 'alert(1)<' odd/report.html"

# All kinds of targets and ends.
"$tool" convert target.ply obj target.obj
grep '^v ' target.obj >cloud.obj
"$SMR" register --model bone.ply --target cloud.obj --html --quiet --accept look -o cloud
page "a cloud" cloud/report.html
check "has points, no triangles" [ "$(grep -oE '"path":"cloud.obj","vertices":[0-9]+,"triangles":0' cloud/report.html | wc -l)" -eq 1 ]
"$SMR" register $onto --html --budget-ms 0.2 --ticks 3 -o ended
check "a run that ended within an iteration" [ $? -eq 4 ]
page "a run that ended" ended/report.html
"$SMR" build --model bone.ply --quiet -o bone.smr
check "a prepared model" "$SMR" register --model bone.smr --target target.ply --html --quiet -o built
page "a prepared model" built/report.html
check "says so" grep -q '"prepared":true' built/report.html

# An image: 4 mm voxels around an ellipsoid; the truth.
mkdir truth
blob 12 32 22 63 0 >truth/bone.ply
image ref.mha 30 20 60
image pat.mha 32 22 63
"$SMR" register --model bone.ply --reference ref.mha --target pat.mha --truth truth --html --quiet --accept look -o image
page "an image" image/report.html
check "has its voxels" sh -c "grep -o '\"voxels\":\"[^\"]*' image/report.html | sed 's/.*\"//' | base64 -d | LC_ALL=C tr -d '\n2Z' | wc -c | grep -qx 0"
check "and the truth" grep -q '"path":"truth/bone.ply"' image/report.html

by_file "a trace in the page's place" new/report.html "$SMR" register $onto --html -o new --trace new/report.html
mkdir -p new/report.html
by_file "a directory in its place" new "$SMR" register $onto --html -o new
check "leaves nothing" [ "$(ls new)" = report.html ]
check "--help tells of it" sh -c "'$SMR' --help | grep -q -e '--html'"
finish
