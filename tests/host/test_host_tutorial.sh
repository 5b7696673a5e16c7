#!/bin/sh
# docs/TUTORIAL.md: its commands run as they stand there, one block after another, and say what the text says. The table of
# reasons in docs/GUIDE.md is complete.
# SPDX-License-Identifier: MIT
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
page=$top/docs/TUTORIAL.md
guide=$top/docs/GUIDE.md
writer=$build/fixture_write
[ -x "$writer" ] || { skip "the tutorial" "no fixture_write"; finish; }
mkdir "$scratch/bin" "$scratch/work"
ln -s "$SMR" "$scratch/bin/smr"
ln -s "$writer" "$scratch/bin/fixture_write"
PATH=$scratch/bin:$PATH
export PATH

# Each ```sh block becomes a file; the heading above it its name.
awk -v dir="$scratch" '/^## / { title = substr($0, 4) }
    /^```sh$/ { file = sprintf("%s/block%02d", dir, ++n); print "# " title >file; on = 1; next }
    /^```/ { on = 0 } on { print >file }' "$page"
n=0
for block in "$scratch"/block*; do
    n=$((n + 1))
    # A block that calls smr more than once stops where it fails; || echo "status" stands where it must.
    (cd "$scratch/work" && sh -eu "$block") >"$block.out" 2>&1
    check "block $n, $(sed -n '1s/^# //p' "$block"): $(sed -n 2p "$block" | cut -c1-60)" [ $? -eq 0 ]
    [ -s "$block.out" ] && tail -3 "$block.out" | cut -c1-110 | sed 's/^/#   /'
done
check "there are blocks" [ $n -ge 10 ]
cd "$scratch/work" || exit 1
verdict() { sed -n 's/^  "verdict": "\(.*\)",$/\1/p' "$1/report.json"; }
for result in first second found; do check "$result is good" [ "$(verdict $result)" = good ]; done
check "the image is good: $(verdict image)" [ "$(verdict image)" = good ]
check "the lost one failed" [ "$(verdict lost)" = failed ]
check "with the status that the text says" grep -q '^status 1$' "$scratch"/block*.out
check "and the first reason of the table" grep -q 'nothing of the target was seen' lost/report.json
check "every structure has its verdict" [ "$(cat "$scratch"/block*.out | grep -c '^[a-z_]* \(good\|look\|failed\)$')" -ge 5 ]
check "all frames are followed" [ "$(awk -F, 'NR > 1 && $6 == 1 && $7 == 0' moving/track.csv | wc -l)" -eq 6 ]
check "the point is carried" grep -q '^"tumour"' points_now.csv

# The table has every reason that the library gives, by its first words, and options that exist.
grep -o 'return "[^"]*:' "$top/src/verdict/verdict.c" | sed 's/^return "//; s/:$//' >reasons.txt
check "the library has reasons" [ "$(wc -l <reasons.txt)" -ge 14 ]
lost=
while read -r reason; do
    short=$(echo "$reason" | cut -d' ' -f1-6)
    grep -q "^| $short" "$guide" || lost="$lost; $short"
done <reasons.txt
check "the table has them all$lost" [ -z "$lost" ]
lost=
while read -r reason; do
    grep -q -e "$reason" "$top/port/host/register/register_verdict.c" && grep -q -e "^| [^|]*$reason" "$guide" || lost="$lost; $reason"
done <<'END'
clearly different start poses explain the surfaces alike
the model's mirror image starts nearer
a closed surface that is inside out
the start makes the model
folds are left
had a goal at the end
--ticks ended first
END
check "and those of the program$lost" [ -z "$lost" ]
"$SMR" --help >help.txt
lost=
for option in $(grep -o -e '`--[a-z-]*' "$page" "$guide" | sed 's/.*://' | tr -d '`' | sort -u); do
    case $option in --help) continue ;; esac
    grep -q -e "$option\b" help.txt || lost="$lost $option"
done
check "options that the text names are there$lost" [ -z "$lost" ]
finish
