#!/bin/sh
# smr track: each frame's files and the table, a frame in several files, what is refused, what stays whole.
# SPDX-License-Identifier: MIT
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
blob 12 30 20 60 0.05 >bone.ply
mkdir frames two
for i in 0 1 2 3; do
    blob 14 33 "$((20 + i))" 60 0.08 >"frames/f$i.ply"
done

# refuses NAME TEXT ARGUMENT...: status 2, one line with the text, and nothing new in "refused".
refuses() {
    refuses_name=$1 refuses_text=$2
    shift 2
    "$SMR" track "$@" -o refused >out.txt 2>err.txt
    refuses_got=$?
    if [ "$refuses_got" -eq 2 ] && [ "$(wc -l <err.txt)" -eq 1 ] && grep -q -- "$refuses_text" err.txt && [ ! -e refused ]; then
        ok "$refuses_name"
    else
        not_ok "$refuses_name"
        echo "#   status $refuses_got: $(head -n 1 err.txt)"
    fi
}

check "follows" has_verdict look "$SMR" track --model bone.ply --frames frames/*.ply --fps 10 -o out
said() { [ "$(tail -n 1 out.txt | cut -c-"${#1}")" = "$1" ] || { tail -n 2 out.txt; return 1; }; } # begin of the last line
check "says of how many frames which are good" grep -q '^4 frames: 4 good, 0 to look at, 0 failed$' out.txt
check "and what the last one is" said "verdict of the last frame, f3: good (probability "
check "no other is worse" [ "$(grep -c '^verdict' out.txt)" -eq 1 ]
check "writes a line for each frame" [ "$(wc -l <out/track.csv)" -eq 5 ]
check "says what is in it" [ "$(head -n 1 out/track.csv)" = "frame,time_s,ticks,residual_mm,verdict,settled,jumped,recovering,target_serial" ]
check "counts the time" grep -q '^f3,0.3000,' out/track.csv
for i in 0 1 2 3; do check "writes frame $i" [ -s "out/f$i/bone.ply" ]; done
check "settles" [ "$(grep -c ',1,0,0,[1-9][0-9]*$' out/track.csv)" -eq 4 ]
check "numbers the targets" awk -F, 'NR > 1 && !($9 > last) { bad = 1 } { last = NR > 1 ? $9 : 0 } END { exit bad }' out/track.csv
check "is near" awk -F, 'NR > 1 && $4 > 1 { bad = 1 } END { exit bad }' out/track.csv
check "moves" sh -c '! cmp -s out/f0/bone.ply out/f3/bone.ply'
"$SMR" track --model bone.ply --frames frames/*.ply --fps 10 --threads 3 --quiet -o again >quiet.txt 2>&1
check "is quiet" [ ! -s quiet.txt ]
check "has the same bits with other threads" cmp out/f3/bone.ply again/f3/bone.ply
check "looks ahead" has_verdict look "$SMR" track --model bone.ply --frames frames/*.ply --track-ahead 1 --ticks 2 --quiet -o ahead
check "and goes another way" sh -c '! cmp -s out/f3/bone.ply ahead/f3/bone.ply'

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
check "follows several structures" has_verdict look "$SMR" track --model left.ply right.ply --frames two/g0 two/g1/ -o pair
check "writes them" [ -s pair/g1/left.ply ]
check "and the other" [ -s pair/g1/right.ply ]

# Points go along, as carry takes them by the same frame.
{
    echo label,x,y,z
    awk 'BEGIN { for (i = 0; i < 20; i++) printf "p%d,%g,%g,%g\n", i, 9 * sin(i), 6 * cos(2 * i), 4 * i - 40 }'
    echo '"left, ""deep""",1,2,3'
} >points.csv
has_places() { "$SMR" carry --result with/f0 --points "$1" -o again.csv --quiet && [ "$(wc -l <again.csv)" -eq 22 ]; }
# carried FRAME DIRECTORY FILE: the table's places of the frame are those of smr carry.
carried() {
    "$SMR" carry --result "$2/$1" --points "$3" -o carried.csv --quiet || return 1
    awk -F, 'NR > 1 { print $(NF - 2); print $(NF - 1); print $NF }' carried.csv >wanted.txt
    grep "^$1," "$2/track.csv" | cut -d, -f10- | tr , '\n' | paste -d, wanted.txt - | awk -F, '
        { d = $1 - $2; if (d * d > 1e-8 || $2 == "") { print NR ": " $0; bad = 1 } } END { exit bad || NR != 63 }'
}
check "takes points along" has_verdict look "$SMR" track --model bone.ply --frames frames/*.ply --points points.csv -o with
check "names them" grep -q '^frame,.*,jumped,recovering,target_serial,p0_x,p0_y,p0_z,p1_x,.*,p19_z,"left, ""deep""_x"' with/track.csv
for i in 0 3; do check "to where carry does, frame $i" carried "f$i" with points.csv; done
check "they move" sh -c '! cmp -s with/f0/points.csv with/f3/points.csv'
check "no other bit changes" cmp out/f3/bone.ply with/f3/bone.ply
for format in fcsv mrk.json; do
    "$SMR" carry --result with/f0 --points points.csv -o "points.$format" --quiet
    check "from .$format" has_verdict look "$SMR" track --model bone.ply --frames frames/f[01].ply --points "points.$format" --threads 3 -o "$format"
    check "to where carry does, .$format" carried f1 "$format" "points.$format"
    check "writes .$format" has_places "$format/f1/points.$format"
done
check "from a surface" has_verdict look "$SMR" track --model bone.ply --frames frames/f[01].ply --points bone.ply -o surface
check "whose vertices go where the model's do" cmp surface/f1/points.ply surface/f1/bone.ply
check "and which have numbers" grep -q '^frame,.*,jumped,recovering,target_serial,1_x,1_y,1_z,2_x' surface/track.csv
check "a mirrored model" has_verdict look "$SMR" track --model bone.ply --mirror-model x --frames frames/f[01].ply --points points.csv -o mirror
check "takes points as its files have them" carried f1 mirror points.csv
refuses "points that are not there" "none.csv" --model bone.ply --frames frames/f0.ply --points none.csv
echo 'p,1e9,0,0' >far.csv
refuses "points too far" "far.csv" --model bone.ply --frames frames/f0.ply --points far.csv
cp bone.ply points.ply
refuses "a structure with the name of their file" "no structure 'points'" --model points.ply --frames frames/f0.ply --points bone.ply
check "unless they are in another format" has_verdict look "$SMR" track --model points.ply --frames frames/f0.ply --points bone.ply --format stl -o beside
check "where both are there" [ -s beside/f0/points.stl -a -s beside/f0/points.ply ]
cp frames/f0.ply 'a, "b".ply'
check "a frame with a comma in its name" has_verdict look "$SMR" track --model bone.ply --frames 'a, "b".ply' frames/f1.ply -o comma
check "has it within quotes" grep -q '^"a, ""b""",0\.0000,' comma/track.csv
check "others have none" grep -q '^f1,' comma/track.csv

# A camera's points: a cloud without normals, another number of them in each frame, and a surface among them.
for i in 0 1 2 3; do
    { echo x,y,z; awk -v every="$((i % 2 + 2))" '/^end_header/ { on = 1; next } on && NF == 3 && n++ % every == 0 { print $1 "," $2 "," $3 }' "frames/f$i.ply"; } >"c$i.csv"
done
check "follows clouds" has_verdict look "$SMR" track --model bone.ply --frames c0.csv c1.csv frames/f2.ply c3.csv -o clouds
check "near them" awk -F, 'NR > 1 && $4 > 1 { bad = 1 } END { exit bad || NR != 5 }' clouds/track.csv
"$SMR" measure clouds/c3/bone.ply out/f3/bone.ply >distance.txt
check "where surfaces lead" awk '/A to B, vertices: mean/ { near = $6 < 1 } END { exit !near }' distance.txt

# A frame whose target is elsewhere, between good ones: the last lines are of both.
awk '/^end_header/ { on = 1; print; next } on && NF == 3 { $1 += 400 } { print }' frames/f1.ply >gone.ply
check "a frame that is lost" has_status 1 "$SMR" track --model bone.ply --frames frames/f0.ply gone.ply frames/f2.ply -o lost
check "is told" grep -q '^3 frames: 2 good, 0 to look at, 1 failed$' out.txt
check "beside the last one" sh -c 'tail -n 2 out.txt | head -n 1 | grep -q "^verdict of the last frame, f2: good"'
check "with the reasons" said "verdict of the worst frame, gone: failed: nothing of the target was seen: look at the start"

# Images: the reference itself, moved a little farther in each frame.
thigh thigh
image() { # name, mm aside, mm along
    LC_ALL=C awk -v aside="$2" -v along="$3" '$1 == "Offset" && !seen { seen = 1; $3 += aside; $5 -= along } { print } /^ElementDataFile/ { exit }' thigh/mri_reference.mha >"$1"
    at=$(LC_ALL=C grep -a -b -o 'ElementDataFile = LOCAL' thigh/mri_reference.mha | head -n 1 | cut -d: -f1)
    tail -c +"$((at + 25))" thigh/mri_reference.mha >>"$1"
}
for i in 0 1 2; do image "i$i.mha" "$((3 * i))" "$((3 * i))"; done
printf 'label,x,y,z\nspot,-80,0,-60\n' >inside.csv
check "follows images" has_verdict look "$SMR" track --model thigh/model/femur.ply thigh/model/vastus_intermedius.ply --reference thigh/mri_reference.mha --frames i0.mha i1.mha i2.mha --points inside.csv -o images
check "as far as they go" awk -F, '
    NR == 2 { x = $10; y = $11; z = $12 }
    function off(a, b) { return a < b ? b - a : a - b }
    END { exit !(NR == 4 && off($10 - x, 6) < 0.5 && off($11, y) < 0.5 && off($12 - z, -6) < 0.7) }' images/track.csv
check "all of them good" awk -F, 'NR > 1 && $5 != "good" { bad = 1 } END { exit bad }' images/track.csv

# A shaft that goes along itself is missed at its ends only.
image along.mha 0 20
check "follows a jump along the thigh" has_status 0 "$SMR" track --model thigh/model/femur.ply thigh/model/vastus_intermedius.ply --reference thigh/mri_reference.mha --frames i0.mha along.mha --points inside.csv --ticks 60 -o along
check "and says so" awk -F, 'NR > 1 { jumps = jumps $7; y = $12 - last; last = $12 } END { exit !(jumps == "01" && y < -19.5 && y > -20.5) }' along/track.csv

# A patient's coarse image again and again: nothing moves, and what the image does not hold is not called good.
for i in 0 1 2 3; do ln -s thigh/mri_patient.mha "still$i.mha"; done
check "a structure that is not held is to be looked at" has_status 3 "$SMR" track --model thigh/model/femur.ply thigh/model/psoas_major.ply thigh/model/vastus_intermedius.ply --reference thigh/mri_reference.mha --landmarks thigh/landmarks_reference.mrk.json thigh/landmarks_patient.mrk.json --frames still0.mha still1.mha still2.mha still3.mha --format obj -o still
check "in each frame" awk -F, 'NR > 1 && $5 != "look" { bad = 1 } END { exit bad || NR != 5 }' still/track.csv
moved() { # structure: mean way of its vertices from the first frame to the last, mm
    awk 'FNR == 1 { file++; i = 0 }
        $1 == "v" && file == 1 { x[++n] = $2; y[n] = $3; z[n] = $4 }
        $1 == "v" && file == 2 { i++; sum += sqrt(($2 - x[i]) ^ 2 + ($3 - y[i]) ^ 2 + ($4 - z[i]) ^ 2) }
        END { print (n > 100 && i == n ? sum / n : 1000) }' "still/still0/$1.obj" "still/still3/$1.obj"
}
for part in femur psoas_major vastus_intermedius; do
    check "$part stays where it is" awk -v mm="$(moved "$part")" 'BEGIN { exit !(mm != "" && mm < 0.8) }'
done
check "says why" sh -c 'tail -n 1 out.txt | grep -q "^verdict of the last frame, still3: look at the result: .*: look at .* (probability [0-9.]*, expected error [0-9.]* mm)\$"'
check "names what was not held" grep -q "in themselves, and in how many frames: .*vastus_intermedius 4" out.txt
refuses "images without a reference" "--reference" --model thigh/model/femur.ply --frames i0.mha i1.mha
refuses "a surface among images" "bone.ply: frame: expected a volume" --model thigh/model/femur.ply --reference thigh/mri_reference.mha --frames i0.mha bone.ply
refuses "an image among surfaces" "i1.mha: frame: expected a surface" --model bone.ply --frames frames/f0.ply i1.mha
head -c 5000 i1.mha >cut.mha
refuses "a broken image, before anything is written" "cut.mha" --model thigh/model/femur.ply --reference thigh/mri_reference.mha --frames i0.mha cut.mha

# The page: whole, without the network, and it changes no bit.
check "no page without --html" [ ! -e out/report.html ]
check "a page with it" has_verdict look "$SMR" track --model bone.ply --frames frames/*.ply --fps 10 --html -o page
check "is named" grep -q '^to look at: page/report.html$' out.txt
check "is whole" sh -c "head -n 1 page/report.html | grep -q '^<!doctype html>\$' && tail -n 1 page/report.html | grep -q '^</html>\$'"
check "has two scripts" [ "$(grep -o '<script' page/report.html | wc -l) $(grep -o '</script>' page/report.html | wc -l)" = "2 2" ]
check "asks no network" [ -z "$(grep -oE '(src|href)="?[a-z]+:|url\(|fetch\(|XMLHttp|@import|^@(include|data)' page/report.html)" ]
check "changes no table" cmp out/track.csv page/track.csv
check "and no result" cmp out/f3/bone.ply page/f3/bone.ply
grep -o '"number":[0-9]*,"name":"[^"]*","time_s":[^,]*,"ticks":[0-9]*,"residual_mm":[^,]*,"verdict":"[a-z]*","settled":[a-z]*,"jumped":[a-z]*' page/report.html |
    sed 's/"[a-z_]*"://g; s/"//g; s/true/1/g; s/false/0/g' | awk -F, '{ printf "%s,%.4f,%s,%.4f,%s,%s,%s\n", $2, $3, $4, $5, $6, $7, $8 }' >rows.txt
check "has the table's rows" sh -c "sed 1d page/track.csv | cut -d, -f1-7 | cmp - rows.txt"
# The last frame's places, decoded, are those of its file to half a step of 16 bits and a rounding.
"$tool" convert page/f3/bone.ply obj last.obj
grep -o '"places":\[{[^}]*}' page/report.html | tail -n 1 >place.json
sed 's/.*"at":"//; s/".*//' place.json | base64 -d >places.bin
{
    sed 's/.*"low":\[\([^]]*\)\],"high":\[\([^]]*\)\].*/box,\1,\2/' place.json
    od -An -v -tu2 -w6 places.bin | sed 's/^ */q,/; s/  */,/g'
    sed -n 's/^v /v,/p' last.obj | tr ' ' ','
} | awk -F, '
    $1 == "box" { for (c = 1; c <= 3; c++) { low[c] = $(c + 1); high[c] = $(c + 4) } }
    $1 == "q" { n++; for (c = 1; c <= 3; c++) q[n, c] = low[c] + $(c + 1) / 65535 * (high[c] - low[c]) }
    $1 == "v" { m++; for (c = 1; c <= 3; c++) { d = $(c + 1) - q[m, c]; if (d < 0) d = -d; if (d > worst) worst = d } }
    END { print n, m, worst; exit !(n > 200 && n == m && worst < 0.002) }' >places.txt
check "has the last frame's places ($(cat places.txt))" awk '{ exit !($1 > 200 && $1 == $2 && $3 < 0.002) }' places.txt
check "one frame" has_verdict look "$SMR" track --model bone.ply --frames c0.csv --html --quiet -o single
check "has a page, too" grep -q '"frames":\[{"number":0,' single/report.html
odd=$(printf 'x<\/script><script>alert(1)' | tr -d /)
cp frames/f1.ply "$odd.ply"
check "a hostile name" has_verdict look "$SMR" track --model bone.ply --frames frames/f0.ply "$odd.ply" --html --quiet -o odd
check "becomes no markup" [ "$(grep -o '<script' odd/report.html | wc -l)" -eq 2 ]
mkdir report.html
cp frames/f0.ply report.html/bone.ply
refuses "a frame with the page's name" "report.html: name" --model bone.ply --frames report.html --html
check "without a page it may have it" has_verdict look "$SMR" track --model bone.ply --frames report.html -o named

refuses "more than the last way" "--track-ahead" --model bone.ply --frames frames/f0.ply --track-ahead 1.5
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
