#!/bin/sh
# demo_bone: registers the generated bone onto its deformed twin and compares with the known truth.
# SPDX-License-Identifier: MIT
# usage: demo_bone.sh BUILD
set -eu
build=$1
dir=$build/demo-bone
rm -rf "$dir"
mkdir -p "$dir"
"$build/fixture_write" "$dir" 1
echo "source: $dir/source.ply   target: $dir/target.ply (another mesh, bent, twisted, other proportions)"
printf 'before: source to its true place:   '
"$build/fixture_write" --compare "$dir/source.ply" "$dir/truth.ply"
[ -x "$build/smr" ] || { echo "demo_bone: $build/smr was not built"; exit 1; }
begin=$(date +%s.%N)
"$build/smr" register --model "$dir/source.ply" --target "$dir/target.ply" --align similarity -o "$dir/result"
end=$(date +%s.%N)
printf 'after:  result to its true place:   '
"$build/fixture_write" --compare "$dir/result/source.ply" "$dir/truth.ply"
"$build/smr" measure "$dir/result/source.ply" "$dir/target.ply" --source "$dir/source.ply" || true
echo "$begin $end" | awk '{printf "time:   %.2f s from start to end\n", $2 - $1}'
echo "result: $dir/result/source.ply, $dir/result/report.json"
