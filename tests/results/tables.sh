# shellcheck shell=sh
# tables: targets in part, points, verdicts and moving targets; read by results.sh, whose helpers and names it uses.
# SPDX-License-Identifier: MIT

# Of case_tool's tables the lines "sum NAME N runs, M missed: surface mean A worst B, vertex mean C"; persons' say besides how many
# lie the wrong way, and hold their bounds in brackets.
part_parts() {
    have femurs "parts, points" || return 0
    say "targets in part, points"
    table() { "$tool" table "$@" --seeds 1-3 >"$out/table_$1.txt" 2>&1; }
    table side patches end outliers &
    table person length thigh points
    wait
    sed -n 's/([^)]*) //g; s/[,:]//g; s/^sum //p' "$out/table_side.txt" "$out/table_person.txt" | awk '
        { name = $1
          for (i = 2; $(i + 1) != "runs"; i++) name = name "_" $i
          sub(/[+]/, "_", name)
          key = name ~ /^points/ ? name : "parts." name
          sub(/^points_/, "points.", key)
          sub(/^points$/, "points.with_normals", key)
          deformed = key ~ /^parts[.](whole|side|patches|end)$/ # their vertices are told, too
          if ($(i + 3) == "missed" && key ~ /^parts/ && name != "whole") printf "%s_held\t%d of %d\n", key, $i - $(i + 2), $i
          for (; i < NF; i++) {
              if ($i == "surface") printf "%s_surface\t%s / %s mm\n", key, $(i + 2), $(i + 4)
              if ($i == "vertex" && deformed) printf "%s_vertex\t%s mm\n", key, $(i + 2)
              if ($(i + 1) == "the" && $(i + 2) == "wrong") printf "%s_wrong\t%d\n", key, $i
          } }' >>"$new"
}

# 1,000 generated runs, a half by each process.
part_verdict() {
    have femurs verdict || return 0
    say "verdicts"
    "$tool" verdicts 0 499 "$out/verdicts_a" "$out/verdicts_a.csv" >"$out/verdicts_a.txt" 2>&1 &
    "$tool" verdicts 500 999 "$out/verdicts_b" "$out/verdicts_b.csv" >"$out/verdicts_b.txt" 2>&1
    wait
    { cat "$out/verdicts_a.csv"; tail -n +2 "$out/verdicts_b.csv"; } >"$out/verdicts.csv"
    "$tool" judge "$out/verdicts.csv" >"$out/verdicts.txt"
    sed -n 's/[(),;%=<]/ /g; s/ seeds / /p' "$out/verdicts.txt" | awk '
        $2 == "by" { key = "verdict." $1 "_" $3
                     printf "%s_far\t%d of %d (%s %%)\n", key, $11, $9, $13
                     printf "%s_near\t%d of %d (%s %%)\n", key, $20, $17, $22 }
        $2 == "expected" { printf "verdict.%s_spearman\t%s\n", $1, $6
                           printf "verdict.%s_ratio\t%s %% of %d\n", $1, $(NF - 2), $NF }' >>"$new"
}

# Lines "ok|MISS WHAT VALUE, at most LIMIT" of moving targets, the first runs by surfaces, the second by points.
part_track() {
    have femurs track || return 0
    say "moving targets"
    SMR=$smr SMR_EXPERIMENTS=all "$build/tests/experiments/test_experiment_track" >"$out/track.txt" 2>&1
    awk 'function most(key) { if (!(key in worst) || v > worst[key]) worst[key] = v; sum[key] += v; n[key]++ }
        / are there after / { for (i = 1; i < NF; i++) if ($i == "of") { there += $(i - 1); jumps += $(i + 1) } }
        !/, at most / { next }
        { v = $(NF - 3) + 0; kind = /: surface/ ? "surface" : /: vertices/ ? "vertex" : "" }
        /femur.*,/ && kind != "" { most((/two fifths/ ? "part_" : "whole_") kind) }
        /thigh, whole/ && kind != "" { most("thigh_" kind) }
        /thigh by images, seed/ { most((/ 0 points/ ? "images_" : "clouds_") kind) }
        /drift of the vertices/ { most("drift") }
        END { if (jumps) printf "track.jumps\t%d of %d\n", there, jumps
              for (k in worst) printf "track.%s\t%.3f / %.3f mm\n", k, sum[k] / n[k], worst[k] }' "$out/track.txt" >>"$new"
}
