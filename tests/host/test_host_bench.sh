#!/bin/sh
# smr bench: figures 1 and 2 and the soak: what is written, read back and recomputed; bad options. Times are never judged.
# SPDX-License-Identifier: MIT
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
by_file "nothing to measure" usage "$SMR" bench -o new
by_file "both" usage "$SMR" bench --figure2 --soak -o new
by_file "no -o" usage "$SMR" bench --figure2
by_file "an operand" file "$SMR" bench --figure2 file -o new
for option in "--repeats 0" "--repeats x" "--repeats" "--step 4" "--step 51" "--step 7.5" "--seed 0" "--threads 0" "--method polar" \
    "--active 0.5" "--bad"; do
    # shellcheck disable=SC2086
    by_file "$option" "${option%% *}" "$SMR" bench --figure2 -o new $option
done
for option in "--seconds 0" "--seconds -1" "--seconds nan" "--seconds"; do
    # shellcheck disable=SC2086
    by_file "$option" "${option%% *}" "$SMR" bench --soak -o new $option
done
by_file "--seconds of a figure" --seconds "$SMR" bench --figure2 --seconds 1 -o new
by_file "--repeats of a soak" --repeats "$SMR" bench --soak --repeats 1 -o new
by_file "--step of a soak" --step "$SMR" bench --soak --step 10 -o new

thigh data
check "the data" [ -f data/truth/femur.ply ]
files="--reference data/mri_reference.mha --target data/mri_patient.mha --truth data/truth
    --landmarks data/landmarks_reference.mrk.json data/landmarks_patient.mrk.json"
for missing in --reference --target --truth; do
    some=$(echo $files | awk -v drop="$missing" '{ for (i = 1; i <= NF; i++) if ($i == drop) i++; else printf "%s ", $i }')
    # shellcheck disable=SC2086
    by_file "no $missing" $missing "$SMR" bench --figure2 -o new --model data/model/*.ply $some
done
by_file "data without a model" --landmarks "$SMR" bench --figure2 -o new $files
by_file "a truth alone" --truth "$SMR" bench --soak -o new --truth data/truth
# shellcheck disable=SC2086
by_file "--seed of files" --seed "$SMR" bench --figure2 -o new --seed 2 --model data/model/*.ply $files
# shellcheck disable=SC2086
by_file "--small of files" --small "$SMR" bench --soak -o new --small --model data/model/*.ply $files
by_file "a surface as the target" --target "$SMR" bench --figure2 -o new --model data/model/femur.ply \
    --reference data/mri_reference.mha --target data/truth/femur.ply --truth data/truth
by_file "truth that is not there" none "$SMR" bench --figure2 -o new --model data/model/femur.ply \
    --reference data/mri_reference.mha --target data/mri_patient.mha --truth none
"$SMR" build --quiet --model data/model/femur.ply --reference data/mri_reference.mha -o femur.smr
by_file "a prepared model" --reference "$SMR" bench --figure2 -o new --model femur.smr \
    --reference data/mri_reference.mha --target data/mri_patient.mha --truth data/truth
by_file "-o a file" femur.smr "$SMR" bench --soak -o femur.smr

# figure NAME DIR: the table is one, its lines are those of its points.
figure() {
    check "$1: columns and rows" awk -F, 'NR == 1 { n = NF } NF != n { print "line " NR ": " NF " columns"; bad = 1 }
        NR > 1 { rows[$1]++; for (i = 4; i <= NF; i++) if ($i !~ /^-?[0-9.]*$/) { print "line " NR ": " $i; bad = 1 } }
        END { exit !(!bad && n == 15 && rows["time"] == 6 * 4 && rows["error"] == 3 * 3 && rows["fit"] == 6 && rows["fit_all"] == 6) }' "$2/figure2.csv"
    check "$1: the fits are those of the points" awk -F, '
        function near(a, b, d) { d = a - b; return (d < 0 ? -d : d) <= 2e-4 }
        # Sums of all points, and of those before the last.
        $1 == "time" { k = $2 $3; n[k]++; for (i = 1; i <= 5; i++) all[k, i] += before[k, i] = value(i)
                       if ($6 <= 0 || $7 > $6) { print "line " NR; bad = 1 } }
        function value(i) { return i == 1 ? $4 : i == 2 ? $6 : i == 3 ? $4 * $4 : i == 4 ? $4 * $6 : $6 * $6 }
        $1 ~ /^fit/ { k = $2 $3; m = n[k] - ($1 == "fit"); for (i = 1; i <= 5; i++) s[i] = all[k, i] - ($1 == "fit" ? before[k, i] : 0)
                      sxx = s[3] - s[1] * s[1] / m; sxy = s[4] - s[1] * s[2] / m; syy = s[5] - s[2] * s[2] / m
                      slope = sxy / sxx; at = (s[2] - slope * s[1]) / m; fits++
                      if (!near(slope, $14) || !near(at, $12) || !near(at + 100 * slope, $13) ||
                          !near(sxy * sxy / (sxx * syy), $15)) { print $1 " " k ": " at " " slope; bad = 1 } }
        END { exit !(!bad && fits == 12) }' "$2/figure2.csv"
    check "$1: fewer and fewer vertices" awk -F, '
        $1 == "time" && $3 == "with_forces" { if ($2 in active && $5 >= active[$2]) bad = 1
                                              active[$2] = $5 }
        END { exit bad }' "$2/figure2.csv"
    check "$1: parts are less than the whole" awk -F, '
        $1 == "time" { ms[$2 $3 $5] = $6; part[$3] = 1; at[$2 "," $5] = 1 }
        END { for (k in at) { split(k, w, ",")
                  if (!(ms[w[1] "matching" w[2]] < ms[w[1] "without_forces" w[2]] &&
                        ms[w[1] "without_forces" w[2]] < ms[w[1] "with_forces" w[2]])) bad = 1 }
              exit bad }' "$2/figure2.csv"
    check "$1: errors are distances" awk -F, '
        $1 == "error" { n++; if (!($9 > 0 && $9 < 20 && $10 > 0 && $10 < 20)) bad = 1 } END { exit !(n && !bad) }' "$2/figure2.csv"
}

case ${CFLAGS:-} in
*sanitize*) skip "figure 2" "too slow in an instrumented build" ;;
*)
    check "figure 2 of files" "$SMR" bench --figure2 --repeats 1 --step 45 -o files --model data/model/[a-f]*.ply $files
    figure "files" files
    ;;
esac
# Figure 1: of two femurs, from files and computed.
for option in "--repeats 1" "--step 10" "--seconds 1" "--reference data/mri_reference.mha" "--truth data/truth"; do
    # shellcheck disable=SC2086
    by_file "$option of figure 1" "${option%% *}" "$SMR" bench --figure1 -o new $option
done
by_file "two figures" usage "$SMR" bench --figure1 --figure2 -o new
by_file "a model alone" --target "$SMR" bench --figure1 -o new --model data/model/femur.ply
by_file "a volume as the target of figure 1" --target "$SMR" bench --figure1 -o new --model data/model/femur.ply \
    --target data/mri_patient.mha
by_file "--align of figure 2" --align "$SMR" bench --figure2 -o new --model data/model/femur.ply $(echo $files) --align rigid
by_file "--align of the computed femur" --align "$SMR" bench --figure1 -o new --align rigid
# figure1 NAME DIR: 2 methods, elastic and plastic, 4 radii, 16 points; what the paper's figure 1 shows.
figure1() {
    check "$1: columns and rows" awk -F, 'NF != 9 { bad = 1 } NR > 1 { n[$1 $2 $3]++; if (!($6 > 0) || !($7 >= 0) || $7 > $6) bad = 1 }
        END { for (k in n) { if (n[k] != 16) bad = 1; m++ } exit !(!bad && m == 16) }' "$2/figure1.csv"
    check "$1: time goes on with the iterations" awk -F, 'NR > 1 { if ($4 == 0 ? $5 != 0 : $4 <= i || $5 <= t) bad = 1; i = $4; t = $5 } END { exit bad }' "$2/figure1.csv"
    check "$1: all start from one place" [ "$(awk -F, '$4 == 0 { print $6 }' "$2/figure1.csv" | sort -u | wc -l)" -eq 1 ]
    check "$1: x^r follows where it is plastic" awk -F, 'NR > 1 && $4 == 150 && ($9 > 0) != ($2 == "plastic") { bad = 1 } END { exit bad }' "$2/figure1.csv"
    check "$1: the stiffer, the farther in the end" awk -F, 'NR > 1 && $4 == 150 && $2 == "elastic" { if ($3 != 100 && $7 >= d) bad = 1; d = $7 } END { exit bad }' "$2/figure1.csv"
    check "$1: plastic is nearer than elastic" awk -F, 'NR > 1 && $4 == 150 { d[$1 $3 $2] = $7; k[$1 $3] = 1 }
        END { for (i in k) { n++; if (d[i "plastic"] >= d[i "elastic"]) bad = 1 } exit !(!bad && n == 8) }' "$2/figure1.csv"
    check "$1: both methods agree" awk -F, 'NR > 1 && $4 == 150 && $3 > 20 { k = $2 $3; if (k in d) { e = d[k] / $7; n++; if (e < 0.8 || e > 1.25) bad = 1 } d[k] = $7 } END { exit !(!bad && n == 6) }' "$2/figure1.csv"
}
case ${CFLAGS:-} in
*sanitize*) skip "figure 1" "too slow in an instrumented build" ;;
*)
    blob 5 30 20 60 0.05 >bone.ply
    blob 6 33 19 63 0.08 >target.ply
    check "figure 1 of files" "$SMR" bench --figure1 --align similarity -o bones --model bone.ply --target target.ply --threads 1
    check "has all curves" [ "$(wc -l <bones/figure1.csv)" -eq 257 ]
    check "figure 1 of the computed femur" sh -c "[ -z \"\$('$SMR' bench --figure1 --small --quiet -o deep/femur)\" ]"
    figure1 "computed" deep/femur
    ;;
esac

check "--quiet is quiet" sh -c "[ -z \"\$('$SMR' bench --soak --seconds 0.01 --small --quiet -o soak)\" ]"
check "a soak: bins of both targets" awk -F, 'NR == 1 { bad = NF != 6; next } { n[$1]++; ticks[$1 $2 $3] += $6; bad += NF != 6 }
    END { for (k in ticks) bad += ticks[k] == 0; exit !(!bad && n["surface"] == 144 && n["image"] == 144) }' soak/soak.csv
check "both clocks saw the same ticks" awk -F, 'NR > 1 { if ($3 == "wall") d[$1 $2] += $6; else d[$1 $2] -= $6; n++ }
    END { for (k in d) bad += d[k] != 0; exit !(n == 288 && !bad) }' soak/soak.csv
[ "${SMR_AGAIN:-0}" = 1 ] || check "a soak with one thread" sh -c "'$SMR' bench --soak --seconds 0.01 --small --threads 1 -o one | grep -q '^image *33 ms'"
finish
