#!/bin/sh
# run_bench: runs the benchmarks and gathers their "key value" lines in BUILD/bench.json.
# SPDX-License-Identifier: MIT
# usage: BUILD=... run_bench.sh PROGRAM...
#
# A benchmark prints lines `name number`; lines of another form are shown and left out of the file.
set -eu
out=$BUILD/bench.json
lines=$BUILD/bench.txt
mkdir -p "$BUILD"
: >"$lines"
for program in "$@"; do "$program" | tee -a "$lines"; done
awk '
    BEGIN { printf "{" }
    NF == 2 && $1 ~ /^[a-z][a-z0-9_]*$/ && $2 ~ /^-?[0-9.]+(e[-+]?[0-9]+)?$/ {
        printf "%s\n  \"%s\": %s", (n++ ? "," : ""), $1, $2
    }
    END { print "\n}" }' "$lines" >"$out"
echo "written: $out"
