#!/bin/sh
# results: measures, and writes docs/RESULTS.md and README's table of results.
# SPDX-License-Identifier: MIT
# usage: BUILD=... MAKE=... results.sh all|short
#
# Each part prints "key<TAB>value" lines into $new; what no part measured keeps its last value (write.awk). A part whose data or
# tools are missing says so in a line. Times are measured only where half a processor at most is busy with something else.
set -u
export LC_ALL=C
here=tests/results
build=${BUILD:-build}
make=${MAKE:-make}
smr=$build/smr
compare=$build/fixture_write
data=${SMR_TEST_DATA:-../shared/data}
export SMR="$smr" SMR_TEST_DATA="$data"
mode=${1:-all}
out=$build/results
new=$out/new.txt
rm -rf "$out"
mkdir -p "$out"
: >"$new"

# ---------------------------------------------------------------- helpers

put() { printf '%s\t%s\n' "$1" "$2" >>"$new"; }
say() { echo "results: $*"; }
have() { [ -e "$data/$1" ] || { say "no $data/$1: $2 keeps its last values"; return 1; }; }
# value REPORT PATH FORMAT
value() { awk -f $here/json.awk "$1" | awk -v p="$2" -v f="$3" '$1 == p { printf f, $2; exit }'; }
pair() { echo "$(value "$1" "$2.whole_model_to_target.$3" %.3f) / $(value "$1" "$2.target_to_model.$3" %.3f) mm"; }

# The rows of list.txt that say "<- FIGURE... FORMAT", from a file of "figure value" lines or a report.json.
fill() { # section, file
    case $2 in *.json)
        awk -f $here/json.awk "$2" >"$out/flat.txt"
        awk -v row="$1" -f tests/experiments/report.awk "$out/flat.txt" >>"$out/flat.txt.more"
        grep -v '^table' "$out/flat.txt.more" >>"$out/flat.txt"
        rm "$out/flat.txt.more"
        set -- "$1" "$out/flat.txt" ;;
    esac
    awk -v id="$1" '
        FNR == NR { v[$1] = $2; next }
        /^\* / { on = index($0, "* " id ";") == 1; next }
        on && (at = index($0, " <- ")) {
            n = split(substr($0, at + 4), word, " ")
            f = ""
            known = 1
            x[1] = x[2] = x[3] = x[4] = x[5] = ""
            for (i = 1; i <= n; i++)
                if (f == "" && word[i] !~ /%/) { known = known && (word[i] in v); x[i] = v[word[i]] }
                else f = f (f == "" ? "" : " ") word[i]
            if (f ~ /MB/) x[1] /= 1e6
            if (known) printf id "." substr($0, 1, index($0, ";") - 1) "\t" f "\n", x[1], x[2], x[3], x[4], x[5]
        }' "$2" $here/list.txt >>"$new"
}

# Share of all processors that is busy, over two seconds; 0 where the system does not say.
busy() {
    [ -r /proc/stat ] || { echo 0; return; }
    { head -n 1 /proc/stat; sleep 2; head -n 1 /proc/stat; } |
        awk '{ n = 0; for (i = 2; i <= 9; i++) n += $i; all[NR] = n; idle[NR] = $5 + $6 }
             END { d = all[2] - all[1]; printf "%.2f", (d > 0 ? 1 - (idle[2] - idle[1]) / d : 0) }'
}
processors=$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 1)
load=$(busy)
calm=$(echo "$load $processors" | awk '{print $1 * $2 <= 0.5}')
calm=${TIMES:-$calm}
[ "$calm" = 1 ] || say "times keep their last values (busy: $load of all processors); TIMES=1 measures them all the same"

machine="$(uname -m), $(sed -n 's/^model name[^:]*: *//p' /proc/cpuinfo 2>/dev/null | head -n 1), $processors processors"
commit=$(git rev-parse --short HEAD 2>/dev/null || echo unknown)
git diff --quiet HEAD -- src include port fixtures 2>/dev/null || commit="$commit and changes"

# register NAME ARGUMENT...: into $out/NAME; the exit status tells nothing that the report does not.
register() { name=$1; shift; "$smr" register "$@" --quiet -o "$out/$name"; }

# Times of a registration: best of three from files to files, the median iteration with 1 and 2 threads.
best_times() { # key, argument...
    [ "$calm" = 1 ] || return 0
    key=$1; shift
    for k in 1 2 3; do
        register timed "$@" --threads 2
        value "$out/timed/report.json" time_s.total '%.6f\n' >>"$out/$key.times"
    done
    put "$key.time" "$(sort -n "$out/$key.times" | awk 'NR == 1 {printf "%.1f s", $1}')"
    case $key in femur_pair | thigh_patient)
        put "$key.tick_2" "$(value "$out/timed/report.json" tick_ms.median '%.1f ms')"
        register timed "$@" --threads 1
        put "$key.tick_1" "$(value "$out/timed/report.json" tick_ms.median '%.1f ms')" ;;
    esac
}

surfaces() { # key, argument...
    key=$1; shift
    say "$key"
    register "$key" "$@"
    fill "$key" "$out/$key/report.json"
    best_times "$key" "$@"
}

# ---------------------------------------------------------------- parts

part_pairs() {
    have femurs "femur_pair, mirrored_pair" || return 0
    surfaces femur_pair --model "$data/femurs/femur_2008_0019_left_3k.ply" \
        --target "$data/femurs/femur_2007_5028_left_3k.ply" --align similarity
    surfaces mirrored_pair --model "$data/femurs/femur_m_right.ply" --target "$data/femurs/femur_vhm_left.ply" \
        --align similarity --mirror-target x
}

part_sides() {
    have hip_thigh_vhm_otherside thigh_sides || return 0
    surfaces thigh_sides --model "$data"/hip_thigh_vhm/*.ply --target "$data"/hip_thigh_vhm_otherside/*.ply
}

# A figure of both directions from what smr measure prints.
measured() { # file, word before the figure, what stands behind "A to B", format
    awk -v word="$2" -v tail="$3: " -v f="$4" '
        /^[AB] to [AB]/ && index($0, tail) == 7 { for (i = 1; i < NF; i++) if ($i == word) v[++n] = $(i + 1) }
        END { printf f " / " f " mm", v[1], v[2] }' "$1"
}

# The second pair's target is mirrored: one iteration of it onto itself, which moves nothing, writes it so.
part_peers() {
    have peers peers || return 0
    say peers
    for p in P1 P2; do
        target=$data/femurs/femur_2007_5028_left_3k.ply
        if [ $p = P2 ]; then
            register mirrored --model "$data/femurs/femur_vhm_left.ply" --mirror-model x \
                --target "$data/femurs/femur_vhm_left.ply" --mirror-target x --ticks 1
            target=$out/mirrored/femur_vhm_left.ply
        fi
        for name in spare meshmonk_pyramid90 meshmonk_nonrigid200; do
            "$smr" measure "$data/peers/${p}_$name.ply" "$target" >"$out/peer.txt" || { say "peers: $p $name not measured"; continue; }
            key=peers.$(echo "${p}_$name" | tr P p)
            put "$key" "$(measured "$out/peer.txt" mean '' %.3f)"
            [ "$name" = spare ] || continue
            put "${key}_max" "$(measured "$out/peer.txt" max '' %.2f)"
            put "${key}_vertices" "$(measured "$out/peer.txt" mean ', vertices' %.3f)"
        done
    done
}

part_elastix() {
    say elastix
    /usr/bin/python3 $here/peers.py "$smr" "$data" "$out/elastix" >"$out/elastix.txt" || { say "$(tail -n 1 "$out/elastix.txt")"; return 0; }
    sed 's/^/elastix./; s/ /\t/' "$out/elastix.txt" >>"$new"
}

# "mean / largest" of fixture_write --compare
moved() { "$compare" --compare "$1" "$2" | sed -E 's/mean ([0-9.]+) mm, max ([0-9.]+) mm.*/\1 \2/' | awk '{printf "%.2f / %.1f mm", $1, $2}'; }

part_bone() {
    say bone
    folds=0
    for s in 0.5 1 1.5 2; do
        mkdir -p "$out/bone_$s"
        "$compare" "$out/bone_$s" "$s" >/dev/null
        register "bone_$s/result" --model "$out/bone_$s/source.ply" --target "$out/bone_$s/target.ply" --align similarity
        r=$out/bone_$s/result/report.json
        put "bone.before_$s" "$(moved "$out/bone_$s/source.ply" "$out/bone_$s/truth.ply")"
        put "bone.error_$s" "$(moved "$out/bone_$s/result/source.ply" "$out/bone_$s/truth.ply")"
        folds=$((folds + $(value "$r" folds %d)))
        [ $s != 1 ] || fill bone "$r"
    done
    put bone.folds "$folds"
}

part_example() {
    say example
    awk '/^```c[ \t]*$/ && !done {on = 1; next} /^```/ && on {on = 0; done = 1} on' README.md >"$out/example.c"
    ${CC:-cc} -std=c11 -ffp-contract=off -O2 -Iinclude -Iport/pthread "$out/example.c" -o "$out/example" \
        "$build/libsmr_pthread.a" "$build/libsmr.a" -pthread -lm && put example.prints "$("$out/example" | tail -n 1)"
}

part_demo() {
    say demo
    sh tests/demo.sh "$build" >"$out/demo.txt" || return 0
    awk '/^surface, mean/ { print "demo.surface_before\t" $3 " mm"; print "demo.surface_after\t" $4 " mm" }
         /^vertex to vertex/ { print "demo.vertex_before\t" $5 " mm"; print "demo.vertex_after\t" $6 " mm" }
         /^worst structure/ { print "demo.worst_before\t" $3 " mm (" $4 ")"; print "demo.worst_after\t" $5 " mm (" $6 ")" }
         / structures, [0-9]+ vertices/ { for (i = 2; i < NF; i++) if ($(i + 1) ~ /^vertices/) print "demo.vertices\t" $i }
         /folds: / { print "demo.iterations\t" $1; print "demo.folds\t" $NF }' "$out/demo.txt" >>"$new"
}

still='--search 0,0 --gradient 0,0 --iterations 1 --iterations-last 1' # no force acts: the start comes out

part_images() {
    for who in patient person; do
        have "thigh_$who" "thigh_$who" || continue
        key=thigh_$who
        say "$key"
        set -- --model "$data"/hip_thigh_vhm/*.ply --reference "$data/thigh_patient/mri_reference.mha" \
            --target "$data/thigh_$who/mri_$who.mha" --truth "$data/thigh_$who/truth" \
            --landmarks "$data/thigh_patient/landmarks_reference.mrk.json" "$data/thigh_$who/landmarks_$who.mrk.json"
        # shellcheck disable=SC2086
        register "${key}_start" "$@" $still
        put "$key.start" "$(value "$out/${key}_start/report.json" distance_mm.whole_model_to_target.mean '%.1f mm')"
        register "$key" "$@"
        r=$out/$key/report.json
        fill "$key" "$r"
        best_times "$key" "$@"
        [ $who = patient ] || continue
        part_budgets "$@"
    done
}

part_budgets() {
    [ "$calm" = 1 ] || return 0
    for ms in 16 8 4 2; do
        register budget "$@" --budget-ms $ms --threads 2
        put "budgets.ticks_$ms" "$(value "$out/budget/report.json" ticks %d)"
        put "budgets.mean_$ms" "$(pair "$out/budget/report.json" distance_mm mean)"
    done
}

# Groups of experiments; their figures go to build/experiments/GROUP.figures.
experiments() { # form, group...
    [ -d "$data" ] || { say "no $data: experiments are not run"; return 1; }
    form=$1; shift
    say "experiments, $*"
    BUILD=$build sh tests/experiments/experiments.sh "$form" "$@" >"$out/$1.txt" 2>&1 || say "$(tail -n 1 "$out/$1.txt"): see $out/$1.txt"
}
fill_from() { group=$1; shift; for section; do fill "$section" "$build/experiments/$group.figures"; done; } # group, section...

part_ct() { experiments short ct && fill_from ct ct; }
part_thigh() { experiments all thigh mri && fill_from thigh patient_spoiled person_spoiled shares methods && fill_from mri mri; }
part_noise() { experiments all noise && fill_from noise noise; }
part_parts() { experiments all parts persons points && fill_from parts parts && fill_from persons parts && fill_from points points; }
part_references() { experiments all references && fill_from references references; }
part_scene() { experiments all scene && fill_from scene scene; }
part_verdict() { experiments all verdict && fill_from verdict verdict; }
part_track() { experiments all track && fill_from track track; }

part_moved() {
    say "inputs moved together"
    SMR_TEST_SHOW=1 "$build/tests/property/test_properties" >"$out/moved.txt" 2>&1
    awk '/no momentum/ { next }
         { key = ""; at = match($0, /largest [0-9.e-]+ mm/) ? substr($0, RSTART + 8, RLENGTH - 8) : "" }
         /^translated inputs/ { key = "translated"; at = $3 " mm" }
         /^one iteration/ { key = "one_iteration"; at = $(NF - 1) " mm" }
         /^rotated and translated/ { key = "turned" }
         /^rounded moved/ { key = "rounded" }
         /^femurs  / { key = "femurs" }
         /^femurs, the other/ { key = "femurs_back" }
         /^slivers/ { key = "slivers" }
         /^mirrored/ { key = "mirrored" }
         /^vertices and triangles/ { key = "reordered" }
         key != "" { sub(/ mm/, "", at); printf "moved.%s\t%.1e mm\n", key, at }' "$out/moved.txt" >>"$new"
}

part_clusters() {
    have hip_thigh_vhm clusters || return 0
    say clusters
    info() { "$smr" info --radius 30 --clusters shared "$@" "$data"/hip_thigh_vhm/*.ply | grep '^radius'; }
    word() { awk -v w="$1" '{for (i = 1; i < NF; i++) if ($i == w) print $(i + 1)}'; }
    info >"$out/info.txt"
    put clusters.forest "$(sed 's/indexes per cluster/indexes/' "$out/info.txt" | word indexes)"
    put clusters.direct "$(word direct <"$out/info.txt")"
    put clusters.active_min "$(word needs <"$out/info.txt")"
    put clusters.breadth_first "$(info --order breadth-first | sed 's/indexes per cluster/indexes/' | word indexes)"
    put clusters.forest_whole "$(info --block 65536 | sed 's/indexes per cluster/indexes/' | word indexes)"
}

part_bench() {
    [ "$calm" = 1 ] || return 0
    have hip_thigh_vhm bench || return 0
    say bench
    "$build/tests/bench/bench_core" >"$out/bench.txt" || return 0
    awk '/^(prepare_s|priority_s) / { u = " s" } /_ms / { u = " ms" } /_over_/ { u = " times" }
         /^(prepare_s|priority_s|match_rigid_ms|tick_ms|tick_2_threads_ms|match_[a-z]+_over_rigid) / { printf "bench.%s\t%.3g%s\n", $1, $2, u }' \
        "$out/bench.txt" >>"$new"
}

part_figure2() {
    say "figure 2"
    "$smr" bench --figure2 -o "$out/figure2" --quiet || return 0
    awk -F , -v calm="$calm" 'function tell(key, f, v, unit) {
            if (unit == " mm" || calm + 0 == 1) printf "figure2.%s\t" f "%s\n", key, v, unit }
        $1 == "time" && $4 == 0 { all[$2, $3] = $6 }
        $1 == "time" { last[$2, $3] = $6 }
        $1 == "fit" { r2[$2, $3] = $15 }
        $1 == "error" && $2 == "rigid" && $4 < 1 { tell("error_all", "%.3f", $9, " mm") }
        $1 == "error" && $2 == "rigid" && $4 > 49 && $4 < 51 { tell("error_" $3 "_50", "%.3f", $9, " mm") }
        END { tell("rigid_all_ms", "%.1f", all["rigid", "with_forces"], " ms"); tell("rigid_least_ms", "%.1f", last["rigid", "with_forces"], " ms")
              tell("polar_all_ms", "%.1f", all["polar", "with_forces"], " ms"); tell("polar_least_ms", "%.1f", last["polar", "with_forces"], " ms")
              tell("rigid_r2", "%.3f", r2["rigid", "with_forces"], ""); tell("polar_r2", "%.3f", r2["polar", "with_forces"], "")
              tell("match_rigid_ms", "%.1f", all["rigid", "matching"], " ms"); tell("match_polar_ms", "%.1f", all["polar", "matching"], " ms") }' \
        "$out/figure2/figure2.csv" >>"$new"
}

# As the paper has it; its figure 1 on two femurs.
part_paper() {
    have thigh_patient paper || return 0
    say paper
    for who in patient person; do
        have "thigh_$who" "paper.$who" || continue
        set -- --model "$data"/hip_thigh_vhm/*.ply --reference "$data/thigh_patient/mri_reference.mha" \
            --target "$data/thigh_$who/mri_$who.mha" --truth "$data/thigh_$who/truth" --paper \
            --landmarks "$data/thigh_patient/landmarks_reference.mrk.json" "$data/thigh_$who/landmarks_$who.mrk.json"
        register "paper_$who" "$@"
        [ $who = person ] || register paper_start "$@" --ticks 1 --trace "$out/paper_start.csv"
    done
    r=$out/paper_patient/report.json
    put paper.start "$(awk -F , 'NR == 2 { printf "%.2f mm", $4 }' "$out/paper_start.csv")"
    fill paper "$r"
    [ ! -f "$out/paper_person/report.json" ] || put paper.person "$(pair "$out/paper_person/report.json" distance_mm mean)"
    have femurs "paper.femurs, paper.figure1" || return 0
    set -- --model "$data/femurs/femur_2008_0019_left_3k.ply" --target "$data/femurs/femur_2007_5028_left_3k.ply" \
        --align similarity
    register paper_femurs "$@" --paper
    put paper.femurs "$(pair "$out/paper_femurs/report.json" distance_mm mean)"
    "$smr" bench --figure1 "$@" --quiet -o "$out/figure1" || return 0
    awk -F , '$1 == "rigid" { end[$2, $3] = $6; radius[$3] = 1 }
        END { for (r in radius) printf "paper.figure1_%d\t%.2f / %.2f mm\n", r, end["elastic", r], end["plastic", r] }' \
        "$out/figure1/figure1.csv" >>"$new"
}

part_sizes() {
    say "size, stack"
    $make -s size >"$out/size.txt" 2>&1
    awk '/^libsmr.a/ { key = /x86_64/ ? "x86_64" : /M7, -O2/ ? "m7_O2" : /M7, -Os/ ? "m7_Os" : "" }
         /TOTALS/ && key != "" { printf "size.%s\t%.0f kB\n", key, $1 / 1000
                                 if (key == "x86_64") printf "size.x86_64_data\t%.1f kB\n", ($2 + $3) / 1000 }' "$out/size.txt" >>"$new"
    $make -s stack >"$out/stack.txt" 2>&1
    awk '/^largest stack/ { key = /x86_64/ ? "x86_64" : /M7/ ? "m7" : ""; next }
         key != "" && $1 + 0 > 0 { printf "stack.%s\t%.1f kB (%s)\n", key, $1 / 1000, $2; key = "" }' "$out/stack.txt" >>"$new"
}

# ---------------------------------------------------------------- all of them, cheap ones first

parts='clusters bone example pairs sides peers demo images ct paper sizes bench moved'
[ "$mode" = short ] || parts="$parts elastix thigh noise figure2 parts references verdict track"
for part in ${PARTS:-$parts}; do "part_$part"; done

old=docs/RESULTS.md
[ -f "$old" ] || old=/dev/null
{ [ -s "$old" ] && cat "$old" || echo; } >"$out/old.md" # an empty file would not count as the second
[ -s "$new" ] || { say "nothing was measured"; exit 1; }
awk -v command="\`make results$([ "$mode" = short ] && echo -short)\`${PARTS:+ with PARTS=\"$PARTS\"}, $(echo "$load" | awk '{printf "%.0f", 100 * $1}') % busy before" \
    -v date="$(date -u +%Y-%m-%d)" -v commit="$commit" -v machine="$machine" \
    -f $here/write.awk $here/list.txt "$out/old.md" "$new" >"$out/RESULTS.md" || exit 1
cp "$out/RESULTS.md" docs/RESULTS.md
sh $here/readme_table.sh --update || exit 1
say "written: docs/RESULTS.md ($(wc -l <"$new" | tr -d ' ') results measured), README.md's table"
