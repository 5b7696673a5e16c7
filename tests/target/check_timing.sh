#!/bin/sh
# check_timing: instructions of an iteration on the emulated boards: what must be fixed is, chunks are small, and nothing has
# changed by more than 2 % from tests/timing/results/boards.txt.
# SPDX-License-Identifier: MIT
# usage: check_timing.sh [--update]     `make timing-update` writes the table; committing it acknowledges the change
set -u
. tests/target/board.sh
board_need
table=tests/timing/results/boards.txt
rows="awk -f tests/timing/table.awk"
new=${BUILD:-build}/timing.txt
compiler=$(arm-none-eabi-gcc --version | head -n 1)
mkdir -p "$(dirname "$new")"
{
    echo '# Instructions on the emulated boards; written by `make timing-update`. See docs/TIMING.md.'
    echo '# kind; step; name; smallest and largest on the M7, then on the M55: surface rigid, surface polar, image rigid, image polar (table.awk)'
    echo '# "whole": units of work (see docs/TIMING.md), instructions; "model" and "single": as the name says'
    echo "# compiler: $compiler, -O2"
    for board in m7 m55; do
        board_set $board
        file=$(board_build target_steps) || exit 1
        board_run 10 "$file" 1024 | sed "s/^/$board; /"
    done
} >"$new" || exit 1
if ! grep -q '^m55; longest; image polar' "$new" || grep -q 'failed' "$new"; then tail -n 5 "$new"; exit 1; fi

# Another compiler may put a branch where this one has none, so what is fixed is asked of the table's only.
same=1
if [ -f "$table" ] && [ "${1:-}" != --update ] && ! grep -qxF "# compiler: $compiler, -O2" "$table"; then same=0; fi
awk -v same=$same -F '; ' '
    /^#/ { next }
    { key = $1 "; " $2 "; " $3; of = $1 "; " $3 }
    ($2 == "elastic" || $2 == "plastic") && ($4 == "average" || ($4 == "match" && $3 ~ /rigid/)) ||
        $2 == "elastic" && $4 == "sums" {
        n++; if (same && $5 != $6) { print "not fixed: " $0; bad = 1 } }
    same && $2 == "plastic" && $4 == "sums" && $6 - $5 > 0.001 * $6 { print "not fixed to 0.1 %: " $0; bad = 1 }
    $2 == "model" && $4 == "vertices, triangles" { vertices[of] = $5 }
    $2 == "still" { still[of] = $6 }
    $2 == "single" && $4 == "all rotations" { all[$1] = $6 }
    ($2 == "elastic" || $2 == "plastic") && $4 == "match" && $3 ~ /polar/ { match_most[of] = match_most[of] > $6 ? match_most[of] : $6 }
    $2 == "bound" || $4 == "longest stretch" { c++
        if ($6 > 100000) { print "a chunk of more than 100,000 instructions: " $0; bad = 1 } }
    END { for (of in match_most) { split(of, b, "; "); p++
              bound = still[of] + vertices[of] * all[b[1]]
              if (match_most[of] > bound) { print "beyond its bound " bound ": match, " of ": " match_most[of]; bad = 1 } }
          if (n != 32 || c < 50 || p != 4) { print "rows are missing: " n " fixed, " c " chunks, " p " bounds"; bad = 1 }
          exit bad }' "$new" || exit 1

# The bound that docs/TIMING.md derives holds for what was measured, and is not far above it: the bound counts all vertices at all radii.
for board in m7 m55; do
    for kind in surface image; do
        for method in rigid polar; do
            numbers=$(awk -F '; ' -v b=$board -v c="$kind $method" '$1 == b && $3 == c && $2 == "model" {
                if ($4 == "vertices, triangles") { n = $5; t = $6 } else { i = $5 } }
                END { print n, t, i / n - 1 }' "$new")
            # shellcheck disable=SC2086
            bound=$(SMR_TIMING_TABLE=$new sh tests/timing/bound.sh $board $kind $method $numbers | awk '/^fixed part, at most/ { print $5 }')
            seen=$(awk -F '; ' -v b=$board -v c="$kind $method" '$1 == b && $2 == "schedule" && $3 == c && $4 == "fixed part" { print $6 }' "$new")
            [ "${bound:-0}" -ge "$seen" ] && [ "$bound" -le $((seen + seen / 3)) ] && continue
            echo "tests/timing/bound.sh: $board, $kind, $method: bound ${bound:-none}, measured $seen"
            exit 1
        done
    done
done

if [ "${1:-}" = --update ]; then $rows -v pack=1 "$new" >"$table" && echo "$table"; exit $?; fi
[ -f "$table" ] || { echo "skip: no $table (make timing-update writes it)"; exit 77; }
if [ $same -eq 0 ]; then
    echo "skip: the table is of another compiler ($(sed -n 's/^# compiler: //p' "$table")); this is $compiler"
    exit 77
fi
tmp=$(mktemp) || exit 1
trap 'rm -f "$tmp"' EXIT
$rows "$table" >"$tmp"
awk -F '; ' '
    function off(a, b) { return a > b ? (a - b) / (b + 50) : (b - a) / (a + 50) }
    /^#/ { next }
    { key = $1 "; " $2 "; " $3 "; " $4 }
    NR == FNR { first[key] = $(NF - 1); last[key] = $NF; next }
    !(key in last) { added++; next }
    { seen++; d = off(last[key], $NF); e = off(first[key], $(NF - 1)); d = d > e ? d : e
      if (d > 0.02) { far++; if (d > worst) { worst = d; what = key ": " last[key] " -> " $NF } } }
    END { for (k in last) kept++
          if (far + added + (kept - seen) > 0) {
              printf "%d of %d figures changed by more than 2 %%, %d rows are new, %d gone; most: %s; if meant: make timing-update, and commit tests/timing/results\n",
                  far, kept, added, kept - seen, what
              exit 1 }
          print kept " rows as recorded" }' "$tmp" "$new"
