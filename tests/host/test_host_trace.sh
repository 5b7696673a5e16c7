#!/bin/sh
# The trace of a registration, and the paper's own configuration: --trace and --paper.
# SPDX-License-Identifier: MIT
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
blob 12 30 20 60 0.05 >bone.ply
blob 14 33 19 63 0.08 >target.ply
mkdir truth
blob 12 32 22 63 0 >truth/bone.ply

image ref.mha 30 20 60
image pat.mha 32 22 63
into="--model bone.ply --reference ref.mha --target pat.mha"
# column FILE NAME: its values, without the header.
column() { awk -F, -v name="$2" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) at = i; next } { print $at }' "$1"; }
last() { column "$1" "$2" | tail -n 1; }
near() { awk -v a="$1" -v b="$2" 'BEGIN { d = a - b; exit !(a != "" && b != "" && (d < 0 ? -d : d) <= 1e-4 + 1e-5 * (b < 0 ? -b : b)) }'; }
# mean REPORT DIRECTION: of the whole registration's distances, which stand before the structures'.
mean() { sed -n "/\"distance_mm\": {/,/^  }/p" "$1" | sed -n "/\"$2\": {/,/}/s/^ *\"mean\": \([^,]*\),\{0,1\}\$/\1/p" | head -1; }

# trace NAME FILE REPORT: rows, columns, and that the last row is what the report says.
trace() {
    check "$1: a header with units" [ "$(head -n 1 "$2")" = "iteration,radius_mm,time_ms,mean_to_mm,mean_from_mm,hausdorff_mm,vertex_mm,likeness,strain_share,moved_mean_mm,moved_max_mm,active,forces,residual_mm,reference_updates,folds" ]
    check "$1: a row for the start and each iteration" awk -F, -v n="$(value "$3" iterations)" '
        NR > 1 { if ($1 != NR - 2 || NF != 16) bad = 1 } END { exit !(!bad && NR == n + 2) }' "$2"
    check "$1: numbers" awk -F, 'NR > 1 { for (i = 1; i <= NF; i++) if ($i !~ /^(-?[0-9.]+(e-?[0-9]+)?)?$/) { print NR ": " $i; bad = 1 } } END { exit bad }' "$2"
    check "$1: time goes on" awk -F, 'NR > 1 { if ($3 < t || (NR > 2 && !($3 > 0))) bad = 1; t = $3 } END { exit bad }' "$2"
    check "$1: movement from the second row on" awk -F, 'NR == 2 { bad = $10 != "" || $11 != "" } NR > 2 { if ($10 == "" || $10 > $11) bad = 1 } END { exit bad }' "$2"
    check "$1: the end is the report's" near "$(last "$2" mean_to_mm)" "$(mean "$3" model_to_target)"
    check "$1: in both directions" near "$(last "$2" mean_from_mm)" "$(mean "$3" target_to_model)"
    check "$1: at most" near "$(last "$2" hausdorff_mm)" "$(value "$3" hausdorff_mm)"
    check "$1: folds" near "$(last "$2" folds)" "$(value "$3" folds)"
    check "$1: movement of the last iteration" near "$(last "$2" moved_max_mm)" "$(value "$3" displacement_max_mm)"
    check "$1: strain" near "$(last "$2" strain_share)" "$(value "$3" strain)"
}

# A surface: the trace changes no bit and lies beside the results or elsewhere.
onto="--model bone.ply --target target.ply --threads 2"
"$SMR" register $onto --quiet -o plain
check "a trace of surfaces" "$SMR" register $onto --quiet -o traced --trace traced/trace.csv
trace surfaces traced/trace.csv traced/report.json
check "the same bits" [ "$(value plain/report.json state_hash)" = "$(value traced/report.json state_hash)" ]
check "and files" cmp plain/bone.ply traced/bone.ply
check "radii fall" awk -F, 'NR > 1 { if (r != "" && $2 > r) bad = 1; if ($2 != r) n++; r = $2 } END { exit !(!bad && n > 3) }' traced/trace.csv
check "nothing left over" [ -z "$(find . -name '*.tmp')" ]
check "no likeness of surfaces" [ -z "$(column traced/trace.csv likeness | tr -d '\n')" ]
check "one more in parts" "$SMR" register $onto --quiet -o parts --trace parts.csv --budget-ms 0.3 --accept look
check "a row for each iteration, not for each tick" [ "$(column parts.csv iteration | tail -n 1)" = "$(value parts/report.json iterations)" ]
"$SMR" register $onto --quiet -o ended --trace ended.csv --ticks 3
check "of a run that ended first" [ "$(wc -l <ended.csv)" -eq 5 ]
check "time without the measuring" awk -v t="$(last traced/trace.csv time_ms)" -v s="$(value traced/report.json register)" 'BEGIN { exit !(t > 0 && t <= 1000 * s + 0.01) }'

by_file "a trace in no directory" none/trace.csv "$SMR" register $onto -o new --trace none/trace.csv
by_file "a trace over a result" new/report.json "$SMR" register $onto -o new --trace new/report.json
by_file "a trace over an input" target.ply "$SMR" register $onto -o new --trace target.ply
by_file "a trace over the log" same.csv "$SMR" register $onto -o new --trace same.csv --log same.csv
by_file "no name" --trace "$SMR" register $onto -o new --trace

# An image, as the paper has it.
"$SMR" register $into --truth truth --paper --threads 1 --quiet --accept look -o one
check "--paper" "$SMR" register $into --truth truth --paper --accept look --quiet -o paper --trace paper.csv --log paper.log
trace paper paper.csv paper/report.json
check "one radius of 30 mm" [ "$(column paper.csv radius_mm | sort -u)" = 30 ]
check "120 iterations" [ "$(last paper.csv iteration)" = 120 ]
check "more and more vertices" awk -F, 'NR == 3 { n = $12 } NR > 3 { if ($12 < n) bad = 1; n = $12; if (!first) first = n } END { exit !(!bad && n > 2 * first) }' paper.csv
check "the likeness of an image" awk -F, 'NR > 1 { if (!($8 > -1 && $8 <= 1)) bad = 1 } END { exit bad }' paper.csv
check "nearer to the truth than before" awk -v a="$(column paper.csv mean_to_mm | head -n 1)" -v b="$(last paper.csv mean_to_mm)" 'BEGIN { exit !(b < 0.5 * a) }'
check "its own similarity" [ "$(value paper/report.json similarity)" = ncc ]
check "the same bits from one thread, without a trace" [ "$(value one/report.json state_hash)" = "$(value paper/report.json state_hash)" ]
mv paper.csv image.csv
check "its log repeats" "$SMR" replay paper.log
check "and makes no trace" [ ! -e paper.csv ]
check "other options count beside it, before" "$SMR" register --iterations-last 7 --radius 40 $into --paper --accept look --quiet -o less --trace less.csv
check "or behind" "$SMR" register --paper $into --iterations-last 7 --radius 40 --accept look --quiet -o less2
check "both the same" [ "$(value less/report.json state_hash)" = "$(value less2/report.json state_hash)" ]
check "as they say" [ "$(last less.csv iteration) $(last less.csv radius_mm)" = "7 40" ]
check "no truth, no distance" [ -z "$(column less.csv mean_to_mm | tr -d '\n')" ]
check "a model built so" "$SMR" build --model bone.ply --reference ref.mha --paper --quiet -o bone.smr
"$SMR" register --model bone.smr --target pat.mha --truth truth --paper --accept look --quiet -o built
check "gives the same bits" [ "$(value built/report.json state_hash)" = "$(value paper/report.json state_hash)" ]
check "info says 30 samples" sh -c "'$SMR' info bone.smr | grep -q '30 samples'"
check "--paper onto a surface" "$SMR" register $onto --paper --accept look --quiet -o onto
check "is near it, but not as near as the defaults" awk -v a="$(mean onto/report.json model_to_target)" -v b="$(mean plain/report.json model_to_target)" 'BEGIN { exit !(b < a && a < 2) }'
check "--help tells of both" sh -c "'$SMR' --help | grep -q -e '--paper' && '$SMR' --help | grep -q -e '--trace'"

# Drawings: panels are what the traces have.
if command -v python3 >/dev/null; then
    draws() { # FILE TITLE...: these panels
        file=$1
        shift
        python3 "$top/docs/figures/make_trace.py" drawn.svg "a=$file" || return 1
        [ "$(grep -c 'x="52.0"[^>]*>[a-z]' drawn.svg)" -eq $(($# + 1)) ] || return 1 # a's own title is one
        for title in "$@"; do grep -q ">$title" drawn.svg || return 1; done
    }
    check "a surface's trace is drawn" draws traced/trace.csv "distance to the target" movement
    check "an image's" draws image.csv "distance to the truth" movement likeness
    check "and one without a truth" draws less.csv movement likeness
else skip "traces are drawn" "no python3"; fi
finish
