#!/bin/sh
# smr carry of points with an orientation: turned as the model is, there and back, in LPS and RAS; refusals.
# SPDX-License-Identifier: MIT
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
blob 12 30 20 60 0.05 >bone.ply

# A model that is turned by 25 degrees about z and shifted, by points.
awk 'BEGIN { pi = 3.14159265358979; c = cos(25 * pi / 180); s = sin(25 * pi / 180)
    print "label,x,y,z" >"rest.csv"; print "label,x,y,z" >"now.csv"
    for (i = 0; i < 20; i++) {
        x = 28 * sin(i); y = 18 * cos(1.7 * i); z = 5.5 * i - 52
        printf "p%d,%.6f,%.6f,%.6f\n", i, x, y, z >"rest.csv"
        printf "p%d,%.6f,%.6f,%.6f\n", i, c * x - s * y + 7, s * x + c * y - 3, z + 40 >"now.csv"
    } }'
"$SMR" register --model bone.ply --landmark-goals rest.csv now.csv -o out --quiet --accept look >/dev/null 2>&1
check "register" [ -s out/carry.bin ]

# markups FILE SYSTEM ORIENTATION...: a point for each.
markups() {
    file=$1; system=$2
    shift 2
    {
        printf '{"markups": [{"type": "Fiducial", "coordinateSystem": "%s", "controlPoints": [\n' "$system"
        k=0
        for o in "$@"; do
            k=$((k + 1))
            [ $k -eq 1 ] || echo ,
            printf '{"label": "f%d", "position": [%d, %d, 10]%s}' $k $((3 * k)) $((2 * k)) "${o:+, \"orientation\": $o}"
        done
        echo ']}]}'
    } >"$file"
}
# turned FILE ROW DEGREES: the point's orientation is a turn about z by so much, to 0.2 degrees.
turned() {
    grep '"orientation"' "$1" | sed -n "$2p" | sed 's/.*"orientation": \[\([^]]*\)\].*/\1/' | awk -F, -v d="$3" '
        function off(a, b) { return a - b > 0.0035 || b - a > 0.0035 }
        { d *= 3.14159265358979 / 180; n = NF
          bad = n != 9 || off($1, cos(d)) || off($2, -sin(d)) || off($4, sin(d)) || off($5, cos(d)) ||
                off($3, 0) || off($6, 0) || off($7, 0) || off($8, 0) || off($9, 1) }
        END { if (bad || NR != 1) { print $0; exit 1 } }'
}
axes='[1, 0, 0, 0, 1, 0, 0, 0, 1]'
quarter='[0, -1, 0, 1, 0, 0, 0, 0, 1]'
markups lps.mrk.json LPS "$axes" "$quarter"
check "carry" "$SMR" carry --result out --points lps.mrk.json -o a.mrk.json --quiet
check "the axes are turned by 25 degrees" turned a.mrk.json 1 25
check "and those of a quarter turn to 115" turned a.mrk.json 2 115
check "back" "$SMR" carry --result out --points a.mrk.json -o b.mrk.json --inverse --quiet
check "to where they were" turned b.mrk.json 1 0
check "both" turned b.mrk.json 2 90
# The same in RAS: positions and the rows of x and y are negated.
sed 's/"LPS"/"RAS"/; s/"position": \[\([0-9]*\), \([0-9]*\),/"position": [-\1, -\2,/
    s/"orientation": \[1, 0, 0, 0, 1, 0,/"orientation": [-1, 0, 0, 0, -1, 0,/
    s/"orientation": \[0, -1, 0, 1, 0, 0,/"orientation": [0, 1, 0, -1, 0, 0,/' lps.mrk.json >ras.mrk.json
check "RAS" "$SMR" carry --result out --points ras.mrk.json -o c.mrk.json --quiet
check "says the same" cmp a.mrk.json c.mrk.json
markups some.mrk.json LPS "" "$quarter"
check "one of two" "$SMR" carry --result out --points some.mrk.json -o d.mrk.json --quiet
check "is turned" turned d.mrk.json 2 115
markups none.mrk.json LPS "" null
check "none" "$SMR" carry --result out --points none.mrk.json -o e.mrk.json --quiet
check "stays none" sh -c "! grep -q orientation e.mrk.json"
check "positions do not depend on it" sh -c "
    '$SMR' carry --result out --points lps.mrk.json -o x.csv --quiet && '$SMR' carry --result out --points none.mrk.json -o y.csv --quiet && cmp x.csv y.csv"
"$SMR" register --model bone.ply --target bone.ply --mirror-model x -o mirror --quiet --accept look >/dev/null 2>&1
check "a mirrored model" "$SMR" carry --result mirror --points lps.mrk.json -o m.mrk.json --quiet
check "has none" sh -c "! grep -q orientation m.mrk.json"
for bad in '[1, 0, 0]' '[1, 0, 0, 0, 1, 0, 0, 0, 1, 0]' '[1, 0, 0, 0, 7, 0, 0, 0, 1]' '[1, 0, 0, 0, "x", 0, 0, 0, 1]'; do
    markups bad.mrk.json LPS "$axes" "$bad"
    check "refused: $bad" sh -c "'$SMR' carry --result out --points bad.mrk.json -o no.mrk.json 2>err.txt; [ \$? -eq 2 ] && [ \$(wc -l <err.txt) -eq 1 ] && [ ! -e no.mrk.json ]"
done
finish
