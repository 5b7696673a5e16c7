#!/bin/sh
# bound: how long the fixed part of an iteration takes at most, in instructions, from the table of this folder.
# SPDX-License-Identifier: MIT
# usage: sh tests/timing/bound.sh m7|m55 surface|image rigid|polar VERTICES TRIANGLES INDEXES [NODE_BUDGET]
#        sh tests/timing/bound.sh m7|m55 chunks [VERTICES]     the bound of each step's tasks, and the longest stretch of tasks seen
#   VERTICES, TRIANGLES and INDEXES (per cluster, of one radius) as `smr info MODEL.smr` prints them
# Every step takes so much for each vertex, triangle, or vertex and index: the dearer of the two models that were measured. See
# docs/TIMING.md.
set -u
table=${SMR_TIMING_TABLE:-tests/timing/results/boards.txt}
if [ "${2:-}" = chunks ]; then
    awk -f tests/timing/table.awk "$table" | awk -F '; ' -v board="$1" -v n="${3:-10000}" '
        $1 != board { next }
        { step = $3; sub(/.*, /, "", step) }
        $2 == "bound" { name[step] = $4; bound[step] = $6; steps[++k] = step }
        $2 == "longest" && $6 > seen[step] + 0 { seen[step] = $6 }
        $2 == "longest" && $4 == "becoming current" { step = $3; sub(/,.*/, "", step); if ($6 / vertices[step] > pass) pass = $6 / vertices[step] }
        $2 == "model" && $4 == "vertices, triangles" { vertices[$3] = $5 }
        ($2 == "schedule" || $2 == "blind") && $4 == "longest stretch" && $6 > most { most = $6 }
        END { for (i = 1; i <= k; i++) printf "    %-26s %7d a task at most%s\n", name[steps[i]], bound[steps[i]],
                  (steps[i] in seen) ? sprintf(", %6d seen in a stretch", seen[steps[i]]) : ""
              printf "longest stretch seen %d; the pass that makes an iteration current: %.0f a vertex, %.0f for %d vertices\n", most, pass, n * pass, n }'
    exit
fi
[ $# -ge 6 ] || { sed -n '4,6s/^# //p' "$0"; exit 2; }
awk -f tests/timing/table.awk "$table" | awk -F '; ' -v board="$1" -v kind="$2" -v method="$3" -v n="$4" -v nt="$5" -v per="$6" -v nodes="${7:-512}" '
    /^#/ || $1 != board { next }
    $2 == "model" && $4 == "vertices, triangles" { vertices[$3] = $5; triangles[$3] = $6 }
    $2 == "model" && $4 ~ /^vertices and indexes/ { both[$3] = $5 }
    $2 == "still" { still[$3] = $6 }
    $2 == "single" && $4 == "all rotations" { rotations = $6 }
    $2 == "single" && $3 == "closest point" { node = $5; triangle = $6 }
    $2 == "longest" && $4 == "goals" && $3 == "image " method ", " substr($3, length($3) - 6) { goal = $6 }
    $2 == "whole" { split($3, of, ", "); step = of[2]
        if (of[1] == "surface " method || of[1] == "image " method) {
            name[step] = $4; cost[of[1], step] = $6; units[of[1], step] = $5 } }
    # a step in proportion to one number
    function each(step,   s, m) {
        s = cost["surface " method, step] / vertices["surface " method]
        m = cost["image " method, step] / vertices["image " method]
        if (kind == "surface" && name[step] ~ /evening|positions|facets|upper/) return s
        if (kind == "image" && name[step] ~ /evening|positions|facets|upper/) return m
        return s > m ? s : m }
    function each_triangle(step,   s, m) {
        s = cost["surface " method, step] / triangles["surface " method]
        m = cost["image " method, step] / triangles["image " method]
        if (kind == "surface" && name[step] ~ /evening|facets|upper/) return s
        if (kind == "image" && name[step] ~ /evening|facets|upper/) return m
        return s > m ? s : m }
    # so much a vertex and so much an index: from two models
    function forest(step,   s, m, vs, vm, is, im, a, b, c) {
        s = cost["surface " method, step]; m = cost["image " method, step]
        vs = vertices["surface " method]; is = both["surface " method] - vs
        vm = vertices["image " method]; im = both["image " method] - vm
        b = (m * vs - s * vm) / (im * vs - is * vm); a = (s - is * b) / vs
        if (a < 0 || b < 0) { a = s / (vs + is); c = m / (vm + im); a = b = a > c ? a : c }
        printf "    %-24s %9.1f a vertex, %.1f an index\n", name[step], a, b
        return n * a + n * per * b }
    END {
        if (!(("surface " method) in vertices) || (kind != "surface" && kind != "image")) { print "no such row in the table"; exit 2 }
        for (i = 0; i < 100; i++) {
            step = sprintf("step %02d", i)
            if (!(step in name) || name[step] ~ /^(target pulls|outliers|neighbours.|goals|forces|mending|opening)/) continue
            if (name[step] ~ /^forest/) sum += forest(step)
            else if (name[step] == "match" && method == "polar")
                { printf "    %-24s %9.1f a vertex\n", name[step], still["surface polar"] / vertices["surface polar"] + rotations
                  sum += n * (still["surface polar"] / vertices["surface polar"] + rotations) }
            else if (name[step] ~ /(facets|upper|folds|sums)/) {
                printf "    %-24s %9.1f a triangle\n", name[step], each_triangle(step); sum += nt * each_triangle(step) }
            else { printf "    %-24s %9.1f a vertex\n", name[step], each(step); sum += n * each(step) }
        }
        printf "sum of the steps          %12.0f instructions\n", sum
        printf "fixed part, at most       %12.0f   (10 %% more: readings of the clock, what is not in proportion)\n", 1.10 * sum
        if (kind == "surface") printf "a goal, at most           %12.0f   (%d nodes)\n", nodes * (node + 8 * triangle), nodes
        else printf "a goal, dearest seen      %12.0f   (20 samples, searched over 30 mm; see docs/TIMING.md)\n", goal
    }'
