#!/bin/sh
# Landmarks: the same ones in every format come out the same; what is damaged or ambiguous gets exit status 2 and one line
# with file and place.
# SPDX-License-Identifier: MIT
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
. "$top/tests/host/volumes_common.inc"

json() { printf '{"markups": [{"type": "Fiducial", "controlPoints": [%s], "coordinateSystem": "%s"}]}\n' "$2" "$1"; }
point() { printf '{"label": "%s", "position": [%s]}' "$1" "$2"; }
json LPS "$(point 'tip, low' '1, -2.5, 3e1'), $(point b\\u00e9 '0,0,0')" >a.mrk.json
both='tip, low: 1.000 -2.500 30.000
bé: 0.000 0.000 0.000'
says "markups, LPS" "$both" "$volume" landmarks a.mrk.json
json RAS "$(point 'tip, low' '-1, 2.5, 30'), $(point bé '0,0,0')" >ras.mrk.json
says "markups, RAS" "$both" "$volume" landmarks ras.mrk.json
fcsv() { printf '# Markups fiducial file version = 4.11\n# CoordinateSystem = %s\n# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n%s\n' "$1" "$2"; }
for pair in LPS:1,-2.5,30 1:1,-2.5,30 RAS:-1,2.5,30 0:-1,2.5,30; do
    fcsv "${pair%:*}" "n_0,${pair#*:},0,0,0,1,1,1,0,\"tip, low\",,
n_1,0,0,0,0,0,0,1,1,1,0,bé,,vtkMRMLModelNode4" >a.fcsv
    says "fcsv, ${pair%:*}" "$both" "$volume" landmarks a.fcsv
done
printf '\357\273\277label,x,y,z\r\n"tip, low",1,-2.5,30\r\nb\303\251, 0, 0, 0\r\n' >a.csv
says "CSV with names of columns" "$both" "$volume" landmarks a.csv
printf '"tip, low",1,-2.5,30\n\n# remark\nb\303\251,0,0,0' >b.csv
says "CSV without" "$both" "$volume" landmarks b.csv
for head in label,x,y,z:'"tip, low",1,-2.5,30' label,z,y,x:'"tip, low",30,-2.5,1' Z,Label,X,Y:'30,"tip, low",1,-2.5' \
    label,R,A,S:'"tip, low",-1,2.5,30' '"label","s","l","p":"tip, low",30,1,-2.5'; do
    printf '%s\n%s\n' "${head%%:*}" "${head#*:}" >head.csv
    says "CSV, names ${head%%:*}" "tip, low: 1.000 -2.500 30.000" "$volume" landmarks head.csv
    { echo "# columns = ${head%%:*}"; cat head.csv; } >column.csv
    says "CSV, names ${head%%:*}, as a comment, too" "tip, low: 1.000 -2.500 30.000" "$volume" landmarks column.csv
done
printf '# CoordinateSystem = RAS\nlabel,z,y,x\na,3,2,-1\n' >head.csv
says "CSV, names and a system" "a: 1.000 -2.000 3.000" "$volume" landmarks head.csv
printf '# CoordinateSystem = 0\nlabel,S,A,R\na,3,2,-1\n' >head.csv
says "CSV, names and the same system" "a: 1.000 -2.000 3.000" "$volume" landmarks head.csv
fcsv LPS '1,1,2,3,0,0,0,1,1,1,0,a,,,2,0
2,0,0,0,0,0,0,1,1,1,0,b,,,0,0
3,7,7,7,0,0,0,1,1,1,0,c,,,1,1' >status.fcsv
says "fcsv, status of a point" "a: 1.000 2.000 3.000" "$volume" landmarks status.fcsv
fcsv LPS '30,-2.5,1,tip' | sed 's/columns = .*/columns = z,y,x,label/' >columns.fcsv
says "fcsv, other columns" "tip: 1.000 -2.500 30.000" "$volume" landmarks columns.fcsv
for units in '"mm"' '["mm", "UCUM", "millimeter"]' '["mm"]'; do
    json LPS "$(point a 1,2,3)" | sed "s/\"Fiducial\"/&, \"coordinateUnits\": $units/" >units.mrk.json
    says "markups, units $units" "a: 1.000 2.000 3.000" "$volume" landmarks units.mrk.json
done
printf 'b\303\251,7,8,9\n"tip, low",4,5,6\n' >target.csv
says "pairs by label" "1.000 -2.500 30.000 -> 4.000 5.000 6.000
0.000 0.000 0.000 -> 7.000 8.000 9.000" "$volume" pair a.mrk.json target.csv
says "64 landmarks" 64 sh -c "seq 1 64 | sed 's/.*/p&,&,0,0/' >64.csv; '$volume' landmarks 64.csv | wc -l"
printf '{"markups":[{"coordinateSystem":"LPS","controlPoints":[%s,{"label":"x","positionStatus":"undefined","position":null}]}]}' "$(point a 1,2,3)" >undefined.mrk.json
says "markups, a point not placed" "a: 1.000 2.000 3.000" "$volume" landmarks undefined.mrk.json

printf '{"markups":[{"coordinateSystem":"LPS","controlPoints":[%s,{"label":"x","position":"","positionStatus":"undefined"}]}]}' "$(point a 1,2,3)" >undefined.mrk.json
says "markups, a position of no text" "a: 1.000 2.000 3.000" "$volume" landmarks undefined.mrk.json

bad() { lost "landmarks, $1" "$2" "$3" landmarks "$2"; }
# Bad rows and points, by the line that is told: bad_json SYSTEM POINTS NAME, bad_fcsv ROW NAME, bad_csv TEXT NAME LINE.
bad_json() { json "$1" "$2" >bad.mrk.json; bad "$3" bad.mrk.json "line 1"; }
bad_fcsv() { fcsv LPS "$1" >bad.fcsv; bad "fcsv, $2" bad.fcsv "line 4"; }
# shellcheck disable=SC2059
bad_csv() { printf "$1" >bad.csv; bad "CSV, $2" bad.csv "line $3"; }
for units in '"um"' '["um", "UCUM", "micrometer"]' '["mm", "other"]' '[]' '{"code": "um"}' '{"code": "mm"}' null 1 '[["mm"]]'; do
    json LPS "$(point a 1,2,3)" | sed "s/\"Fiducial\"/&, \"coordinateUnits\": $units/" >bad.mrk.json
    bad "units $units" bad.mrk.json "line 1"
done
bad_json LPS '{"label": "a", "position": ""}' "position of no text"
bad_json LPS '{"label": "a", "position": [1,2,3], "positionStatus": "lost"}' "unknown status"
bad_json LPI "$(point a 1,2,3)" "unknown system"
bad_json LPS "$(point a 1,2,3), $(point a 4,5,6)" "label twice"
bad_json LPS "$(point a 1,2)" "two coordinates"
bad_json LPS "$(point a 1,2,3,4)" "four coordinates"
bad_json LPS "$(point a 1,NaN,3)" "NaN"
bad_json LPS "$(point a 1,1e300,3)" "far away"
bad_json LPS "$(point a 01,2,3)" "number that is none"
bad_json LPS "$(point '' 1,2,3)" "empty label"
bad_json LPS "$(point "$(printf '%064d' 0)" 1,2,3)" "label of 64 bytes"
bad_json LPS "$(point 'a\q' 1,2,3)" "unknown escape"
bad_json LPS "$(point 'a\ud800' 1,2,3)" "half a character"
bad_json LPS "$(point a 1,2,3)," "comma too many"
json LPS "" >bad.mrk.json; bad "none" bad.mrk.json landmarks
echo '{}' >bad.mrk.json; bad "no markups" bad.mrk.json landmarks
printf '{"markups":[{"controlPoints":[%s]}]}' "$(point a 1,2,3)" >bad.mrk.json; bad "no system" bad.mrk.json "line 1"
json LPS "$(point a 1,2,3)" | head -c 60 >bad.mrk.json; bad "cut off" bad.mrk.json "line 1"
{ json LPS "$(point a 1,2,3)"; echo more; } >bad.mrk.json; bad "more behind" bad.mrk.json "line 2"
{ printf '{"a":'; head -c 100000 /dev/zero | tr '\0' '['; } >bad.mrk.json; bad "100,000 lists" bad.mrk.json "line 1"
fcsv LIP "1,1,2,3,0,0,0,1,1,1,0,a,," >bad.fcsv; bad "fcsv, unknown system" bad.fcsv "line 2"
fcsv LPS "1,1,2,3,0,0,0,1,1,1,0,a,," | sed 2d >bad.fcsv; bad "fcsv, no system" bad.fcsv header
echo "1,1,2,3,0,0,0,1,1,1,0,a,," >bad.fcsv; bad "fcsv, no header" bad.fcsv header
bad_fcsv "1,1,2" "cut row"
bad_fcsv "1,1,2,3,0,0,0,1,1,1,0,,," "no label"
bad_fcsv "1,1,5,2,3,0,0,0,1,1,1,0,a,," "a decimal comma"
bad_fcsv "1,1,5,2,5,3,0,0,0,1,1,1,0,a,," "two decimal commas"
bad_fcsv "1,1,5,2,5,3,5,0,0,0,1,1,1,0,a,," "three decimal commas"
bad_fcsv "1,1,2,3,0,0,0,1,1,1,0,a" "twelve fields"
bad_fcsv "1,1,2,3,0,0,0,1,1,1,0,a,,,3,0" "unknown status"
bad_fcsv "1,1,2,3,0,0,0,1,1,1,0,a,,,2" "fifteen fields"
fcsv LPS "1,1,2,3,0,0,0,1,1,1,0,a,," | sed 's/,oz/,x/' >bad.fcsv; bad "fcsv, a column twice" bad.fcsv "line 3"
for head in label,a,b,c label,x,y name,x,y,z label,x,y,z,w label,x,A,S label,x,x,y label,i,j,k 'label;x;y;z' 'label,x (mm),y,z' a,b,c,d; do
    printf '%s\na,1,2,3\n' "$head" >bad.csv; bad "CSV, names $head" bad.csv "line 1"
done
bad_csv '# columns = label,x,y,z\nlabel,z,y,x\na,1,2,3\n' "names that differ" 2
bad_csv 'a,1,2,3\n# columns = label,z,y,x\n' "names after a landmark" 2
bad_csv '# CoordinateSystem = LPS\nlabel,R,A,S\na,1,2,3\n' "names of another system" 1
bad_csv 'a,1,5,2,3\n' "a decimal comma" 1
bad_csv 'a;1,5;2,5;3,5\n' "semicolons" 1
bad_csv 'label,x,y,z\nlabel,x,y,z\na,1,2,3\n' "names twice" 2
bad_csv 'a,1,2,3\na,4,5,6\n' "label twice" 2
bad_csv 'a,1,2,3\nb,4,5\n' "three fields" 2
bad_csv 'a,1,2,3\nb,4,x,6\n' "no number" 2
bad_csv 'a,1,2,nan\n' "NaN" 1
bad_csv 'a, b,1,2,3\n' "comma without quotes" 1
bad_csv '"a,1,2,3\n' "open quote" 1
bad_csv '# CoordinateSystem = IJK\na,1,2,3\n' "unknown system" 1
printf 'label,x,y,z\n' >bad.csv; bad "CSV, none" bad.csv landmarks
seq 1 65 | sed 's/.*/p&,&,0,0/' >bad.csv; bad "65" bad.csv "line 65"
bad "missing" none.csv file
"$volume" nifti s int16 little a.nii
bad "a volume" a.nii content
printf 'a,1,2,3\nb,4,5,6\n' >two.csv
printf 'a,1,2,3\nc,4,5,6\n' >other.csv
printf 'a,1,2,3\n' >one.csv
lost "landmarks, counts differ" one.csv landmarks pair two.csv one.csv
lost "landmarks, label missing" other.csv landmarks pair two.csv other.csv

# Damaged files: refused or read, never a crash (which gives another status).
for file in a.mrk.json units.mrk.json a.fcsv status.fcsv a.csv column.csv; do check "damaged $file" "$volume" fuzz-landmarks $file "${SMR_TEST_FUZZ:-3000}" 1; done

if [ -d "$data/thigh_patient" ]; then
    for file in thigh_patient/landmarks_patient thigh_person/landmarks_person; do
        says "$file, pairs" 15 sh -c "'$volume' pair '$data/thigh_patient/landmarks_reference.mrk.json' '$data/$file.mrk.json' | wc -l"
    done
else
    skip "real landmarks" "not there"
fi
finish
