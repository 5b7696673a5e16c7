#!/bin/sh
# analyse: the analyser of GCC or clang over src; each finding stands in explained.txt with a reason, or is a failure.
# SPDX-License-Identifier: MIT
# usage: analyse.sh [clang]      half a minute of processor time with GCC, two with clang
set -u
export LC_ALL=C
. tests/checks.inc
case ${1:-gcc} in
clang) tool='clang --analyze -Xclang -analyzer-output=text -o /dev/null' ;;
*) tool='gcc -O1 -fanalyzer -fdiagnostics-plain-output -S -o /dev/null' ;;
esac
need "${tool%% *}"
find src -name '*.c' | sort | xargs -P "$(getconf _NPROCESSORS_ONLN)" -n 8 sh -c 'for f; do
    '"$tool"' -std=c11 -ffp-contract=off -fno-math-errno -Iinclude -Isrc "$f" 2>&1 || echo "$f:0: warning: not compiled"; done' sh |
    sed -n 's/^\([^ ]*\.[ch]\):[0-9:]* warning: /\1|/p' | sort -u >"$tmp/found"
awk -F '|' 'NR == FNR { if (!/^#/) { file[++n] = $1; words[n] = $2 } next }
    {
        for (i = 1; i <= n; i++) if ($1 ~ file[i] "$" && index($2, words[i])) { explained++; next }
        print "not ok " $1 ": " $2; bad = 1
    }
    END { print explained + 0 " findings explained"; exit bad }' tests/misra/explained.txt "$tmp/found"
