#!/bin/sh
# demo: the computed thigh's model onto the patient's image, from 15 landmarks; compared with the known truth.
# SPDX-License-Identifier: MIT
# usage: demo.sh BUILD
set -eu
build=$1
dir=$build/demo
smr=$build/smr
rm -rf "$dir"
[ -x "$smr" ] || { echo "demo: $smr was not built"; exit 1; }
"$smr" phantom -o "$dir"
"$smr" register --model "$dir"/model/*.ply --reference "$dir/mri_reference.mha" --target "$dir/mri_patient.mha" \
    --landmarks "$dir/landmarks_reference.mrk.json" "$dir/landmarks_patient.mrk.json" \
    --truth "$dir/truth" --html -o "$dir/result" --quiet

# "NAME vertices surface-distance vertex-distance" of every structure before, then the report's figures.
for file in "$dir"/model/*.ply; do
    name=${file##*/}
    surface=$("$smr" measure "$file" "$dir/truth/$name" | sed -n 's/^A to B: mean \([0-9.]*\).*/\1/p')
    vertex=$("$build/fixture_write" --compare "$file" "$dir/truth/$name" | sed 's/mean \([0-9.]*\) mm.* over \([0-9]*\) .*/\1 \2/')
    echo "before ${name%.ply} $surface $vertex"
done | cat - "$dir/result/report.json" | awk -v dir="$dir/result" '
    $1 == "before" { n += $5; surface += $3 * $5; vertex += $4 * $5
                     if ($3 > worst) { worst = $3; worst_name = $2 }; next }
    { key = $1; gsub(/[":]/, "", key); text = $2; gsub(/[",]/, "", text) }
    key == "name" { name = text }
    key == "distance_mm" || key == "vertex_distance_mm" { distance = key }
    (key == "model_to_target" && distance == "distance_mm") || key == "vertex_to_vertex_mm" { part = key }
    key == "mean" && part != "" { # of the whole first, then of each structure
        if (name == "") after[part] = text
        else if (part == "model_to_target" && text + 0 > last) { last = text + 0; last_name = name }
        part = ""
    }
    key == "iterations" || key == "threads" || key == "total" { if (!(key in whole)) whole[key] = text }
    key == "folds" { if (!("folds" in whole)) whole["folds"] = text }
    END {
        printf "%-34s %22s   %s\n", "distance to the truth, mm", "before", "after"
        printf "%-34s %22.2f   %.2f\n", "surface, mean", surface / n, after["model_to_target"]
        printf "%-34s %22.2f   %.2f\n", "vertex to vertex, mean", vertex / n, after["vertex_to_vertex_mm"]
        printf "%-34s %22s   %s\n", "worst structure", sprintf("%.2f %s", worst, worst_name), sprintf("%.2f %s", last, last_name)
        printf "%d iterations, %d threads, %.1f s from files to files; folds: %d\n", whole["iterations"], whole["threads"],
               whole["total"], whole["folds"]
        print "result: " dir "/NAME.ply and report.json"
        print "to look at, in a browser: " dir "/report.html"
        exit !(after["model_to_target"] > 0 && after["model_to_target"] < surface / n) # nothing read is no result
    }'
